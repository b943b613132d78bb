"""Every function that takes what a user gives, and examples of what it may be given. No tests."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import strategies as st

import thermobearing as tb
from tests.fuzz import families, grammar, sheets
from tests.fuzz.judge import COMPLETED, TYPED, Example, check_numbers
from tests.fuzz.mutations import UNITS, damaged, plain_numbers, rows_of_numbers, toml_files
from tests.verification.frames import TWO_PIERS
from thermobearing.bearing.bilinear import load_bilinear
from thermobearing.border.units import parse_quantity
from thermobearing.commands.check import check_file
from thermobearing.cyclic.case import load_case, make_case
from thermobearing.cyclic.protocol import survey
from thermobearing.design.case import load_design_case, make_design_case
from thermobearing.design.factors import scaled_bearing, temperature_factors
from thermobearing.earthquake.case import load_earthquake_case, make_earthquake_case
from thermobearing.identify.case import make_identify_case
from thermobearing.identify.fit.parameters import parameter_set
from thermobearing.identify.records.checks import check_test
from thermobearing.identify.records.record import TestRecord, load_test, record_from_arrays
from thermobearing.motions import process
from thermobearing.motions.measures import measure_motion
from thermobearing.motions.pair import make_pair
from thermobearing.motions.readers import read_motion
from thermobearing.motions.record import GroundMotion
from thermobearing.motions.run import make_motion_case
from thermobearing.motions.spectrum import response_spectrum, rotated_spectrum
from thermobearing.motions.targets import standard_spectrum
from thermobearing.results.metrics import measure_history
from thermobearing.sequences.case import load_sequence_case
from thermobearing.structure.model import load_structure
from thermobearing.tables.columns import Layout, read_columns

Files = dict[str, bytes]


@dataclass(frozen=True)
class Border:
    """A way into the package.

    Attributes
    ----------
    name : of the border.
    examples : what is tried there.
    weight : how many examples of two thousand; a quick border gets more.
    """

    name: str
    examples: st.SearchStrategy[Example]
    weight: int


def companion_files(raw: bytes) -> Files:
    return {name: text for name, text in grammar.companions().items() if name.encode() in raw}


def done(call: Callable[[Path], Any]) -> Callable[[Path], str]:
    def finished(folder: Path) -> str:
        call(folder)
        return COMPLETED

    return finished


def toml_border(name: str, load: Callable[[Path], Any], weight: int) -> Border:
    """Return the border of a kind of file, by the name of its entry in valid.toml."""

    def example(raw: bytes) -> Example:
        about = f"{name}: {raw.decode('utf-8', 'replace')}"
        call = done(lambda folder: load(folder / "a.toml"))
        return Example({"a.toml": raw, **companion_files(raw)}, call, about)

    tables = grammar.valid(name.replace(" ", "_")) if name != "check" else _any_table()
    return Border(name, tables.flatmap(toml_files).map(example), weight)


def _check_and_describe(path: Path) -> None:
    """The command `check` reads any of them."""
    kind, facts, _ = check_file(path)
    assert kind
    assert all("nan" not in fact.split() for fact in facts.values()), facts


def _whole(load: Callable[[Path], Any]) -> Callable[[Path], None]:
    def again(path: Path) -> None:
        text = load(path).to_toml()
        other = path.parent / "again.toml"
        other.write_text(text, encoding="utf-8")
        assert load(other).to_toml() == text

    return again


def _checked_record(path: Path) -> None:
    record = load_test(path)
    report = check_test(record, tb.load_bearing("shen-hdr-specimen"))
    assert report.outcome in ("good", "warning", "refused")


def _any_table() -> st.SearchStrategy[dict[str, Any]]:
    kinds = ("bearing", "bilinear_bearing", "structure", "cyclic_case", "earthquake_case",
             "sequence_case", "design_case", "sidecar")  # fmt: skip
    return st.one_of([grammar.valid(kind) for kind in kinds])


def _record_file(raw: bytes) -> Example:
    call = done(lambda folder: _checked_record(folder / "a.csv"))
    return Example({"a.csv": raw}, call, f"load_test: {raw[:200]!r}")


def _sidecar_file(raw: bytes) -> Example:
    call = done(lambda folder: _checked_record(folder / "test.toml"))
    files = {"test.toml": raw, "test.csv": sheets.TEST.encode(), **companion_files(raw)}
    return Example(files, call, f"load_test, sidecar: {raw.decode('utf-8', 'replace')}")


@st.composite
def _tables(draw: st.DrawFn) -> Example:
    use = draw(st.sampled_from(["recording", "weather", "measured", "columns"]))
    if use == "recording":
        raw = draw(rows_of_numbers(sheets.MOVED))
        step = {"step": "recorded", "file": "a.csv"}
        test = {"dt": "0.1 s", "steps": [step]}
        call = done(lambda folder: make_case({"test": test}, "case"))
    elif use == "weather":
        raw = draw(rows_of_numbers(sheets.NIGHT))
        call = done(lambda folder: tb.Ambient.from_csv(str(folder / "a.csv")))
    elif use == "measured":
        raw = draw(rows_of_numbers(sheets.MEASURED))

        def measure(folder: Path) -> None:
            data = read_columns(folder / "a.csv", {"displacement": "mm", "force": "kN"})
            x, force = data["displacement"], data["force"]
            result = measure_history(x, force, area=57600.0, total_rubber_thickness=30.0)
            assert np.isfinite([cycle.energy_kN_mm for cycle in result]).all()

        call = done(measure)
    else:
        raw = draw(rows_of_numbers(sheets.TEST))
        layout = Layout(
            draw(st.integers(0, 3)),
            draw(st.integers(0, 3)),
            {"force": draw(st.sampled_from(["force_kN", "inner_degC", "x", ""]))},
            {"force": draw(st.sampled_from(["kN", "tonf", "mm", "", "kN**9", "N N"]))},
        )
        wanted = {"time": "s", "force": "kN"}
        call = done(lambda folder: read_columns(folder / "a.csv", wanted, layout=layout))
    return Example({"a.csv": raw}, call, f"{use}: {raw[:300]!r}")


@st.composite
def _frames(draw: st.DrawFn) -> Example:
    raw = draw(rows_of_numbers(TWO_PIERS))

    def read(folder: Path) -> None:
        imported = tb.import_frame(folder / "a.csv")
        assert np.isfinite(imported.table["period_s"]).all()
        assert imported.mass > 0.0

    return Example({"a.csv": raw}, done(read), f"import_frame: {raw[:300]!r}")


@st.composite
def _motion_files(draw: st.DrawFn) -> Example:
    name = draw(st.sampled_from(sorted(grammar.MOTIONS)))
    raw = draw(rows_of_numbers(grammar.MOTIONS[name]))
    options: dict[str, Any] = {}
    if draw(st.booleans()):
        options["component"] = draw(st.sampled_from(["NS", "EW", "1", "3", "²", "", "9" * 5000]))
    if draw(st.integers(0, 3)) == 0:
        options["unit"] = draw(st.sampled_from(["g", "gal", "m/s2", "furlong", "", "kN"]))
    if draw(st.integers(0, 3)) == 0:
        options["dt"] = draw(st.one_of(st.just(0.01), plain_numbers()))
    options["trust_unit"] = draw(st.booleans())

    def read(folder: Path) -> None:
        motion = read_motion(folder / name, **options)
        assert np.isfinite(motion.acceleration).all()
        measures = measure_motion(motion)
        assert np.isfinite(list(vars(measures).values())).all()

    return Example({name: raw}, done(read), f"read_motion {name} {options}: {raw[:200]!r}")


@st.composite
def _motion_arithmetic(draw: st.DrawFn) -> Example:
    count, dt = draw(st.sampled_from([2, 17, 300])), draw(st.sampled_from([0.001, 0.01, 0.1]))
    size = draw(st.sampled_from([1e-5, 1.0, 3e3, 1e9]))
    values = size * np.sin(0.3 * np.arange(count) + draw(st.sampled_from([0.0, 1.0])))
    motion = GroundMotion("made", dt, values)
    a, b = draw(plain_numbers()), draw(plain_numbers())
    across = replace(motion, dt=draw(st.sampled_from([dt, 0.02])), name="across")
    calls: dict[str, Callable[[], Any]] = {
        "corrected": lambda: process.baseline_corrected(motion, high_pass=a),
        "resampled": lambda: process.resampled(motion, a),
        "padded": lambda: process.padded(motion, a, b),
        "spectrum": lambda: response_spectrum(motion, [min(a, 1e6), 1.0], b),
        "standard": lambda: standard_spectrum("II", "I", [a], zone_factor=b),
        "pair": lambda: make_pair(motion, across, a, resample=b > 0.0).along("y"),
        "rotated": lambda: rotated_spectrum(make_pair(motion, across), [min(a, 1e6), 1.0], b),
    }
    name = draw(st.sampled_from(list(calls)))

    def call(_: Path) -> None:
        made = calls[name]()
        if isinstance(made, GroundMotion):
            assert np.isfinite(made.acceleration).all()

    return Example({}, done(call), f"{name}({a!r}, {b!r}) of {count} samples, dt {dt}")


@st.composite
def _results(draw: st.DrawFn) -> Example:
    raw = draw(damaged(grammar.earlier_result())) if draw(st.booleans()) else b""
    if not raw:
        raw = draw(st.one_of(st.binary(max_size=50), st.just(grammar.earlier_result())))
    file = draw(st.sampled_from(["result.nc", "a.nc", "a b 免.nc"]))
    start = draw(st.booleans())

    def read(folder: Path) -> None:
        path = folder if file == "result.nc" else folder / file
        if start:
            make_case({"initial_result": str(path)}, "case")
        else:
            assert tb.load_result(path).outcome == "completed"

    return Example({file: raw}, done(read), f"load_result: {len(raw)} bytes")


@st.composite
def _quantities(draw: st.DrawFn) -> Example:
    number = draw(st.one_of(plain_numbers().map(repr), st.text("0123456789.eE+- ,", max_size=8)))
    odd = st.one_of(st.text("mkNs/^*()2 -°CPa", max_size=12), st.text(max_size=6))
    unit = draw(st.one_of(st.sampled_from(UNITS), st.sampled_from(UNITS), odd))
    text = draw(
        st.sampled_from([f"{number} {unit}", f"{number}{unit}", unit, f" {number}  {unit} "])
    )
    wanted = draw(st.sampled_from(["mm", "kN/mm", "degC", "K", "s", "Hz", "W/(m K)"]))

    def parse(_: Path) -> None:
        assert np.isfinite(parse_quantity(text, wanted))

    return Example({}, done(parse), f"parse_quantity({text!r}, {wanted!r})")


def _values() -> st.SearchStrategy[Any]:
    return st.one_of(
        plain_numbers(),
        st.sampled_from([None, True, "x", "", "23 degC", [], [1.0], {}, 3, -1, 0, 10**400, b"x"]),
        st.lists(plain_numbers(), max_size=3),
        st.text(max_size=5),
    )


RUN_OPTIONS = (
    "ambient", "dt", "scheme", "integrator", "heat_source", "lead_ends", "upper_face", "initial",
    "initial_lead", "keep", "keep_every", "stack", "model", "test", "bearing",
)  # fmt: skip
DESIGN_OPTIONS = ("start", "weight", "compound", "compound_kind", "tolerance", "dt", "motions")
FIT_OPTIONS = ("seed", "starts", "loss", "polish", "free", "bounds")
FACTOR_OPTIONS = ("temperatures", "strains", "period", "cycles", "scheme")
TEST_OPTIONS = ("strain", "cycles", "wave", "speed", "rest", "closing_strain", "dt")
STUDY_OPTIONS = ("bearings", "motions", "ambient", "weather", "duration", "dt", "method", "mass",
                 "damping", "structure", "scheme", "laboratory", "keep_every", "zzz")  # fmt: skip


@cache
def _record() -> TestRecord:
    t = np.linspace(0.0, 2.0, 81)
    return record_from_arrays(t, 30.0 * np.sin(np.pi * t), 60.0 * np.sin(np.pi * t + 0.2), 23.0)


@st.composite
def _arguments(draw: st.DrawFn) -> Example:
    name = draw(
        st.sampled_from(
            ["case", "cyclic_test", "study", "design", "fit", "motion", "factors", "series",
             "arrays", "parameters", "scaled", "face"]
        )
    )  # fmt: skip
    one, two = draw(_values()), draw(_values())

    def options(names: tuple[str, ...]) -> dict[str, Any]:
        chosen = draw(st.lists(st.sampled_from(names), max_size=3, unique=True))
        return {key: draw(_values()) for key in chosen}

    if name == "case":
        given = options(RUN_OPTIONS)
        call: Callable[[], Any] = lambda: make_case({}, "run()", **given)  # noqa: E731
    elif name == "cyclic_test":
        given = options(TEST_OPTIONS)
        call = lambda: survey(tb.cyclic_test(**given), 30.0)  # noqa: E731
    elif name == "study":
        given = {"duration": 0.1, **options(STUDY_OPTIONS)}
        call = lambda: make_earthquake_case({"command": "bridge"}, "bridge()", **given)  # noqa: E731
    elif name == "design":
        given = options(DESIGN_OPTIONS)
        call = lambda: make_design_case({}, "design", **given)  # noqa: E731
    elif name == "fit":
        given = options(FIT_OPTIONS)
        call = lambda: make_identify_case(_record(), "shen-hdr-specimen", **given)  # noqa: E731
    elif name == "motion":
        given = options(("kind", "ground", "seed", "record", "dt", "zone_factor", "component"))
        call = lambda: make_motion_case(**given)  # noqa: E731
    elif name == "factors":
        given = {"reference_temperature": one, **options(FACTOR_OPTIONS)}
        call = lambda: temperature_factors("shen-hdr-specimen", **given)  # noqa: E731
    else:
        given = {"one": one, "two": two}
        specimen = tb.load_bearing("shen-hdr-specimen")
        calls: dict[str, Callable[[], Any]] = {
            "series": lambda: tb.Ambient.series(one, two),
            "arrays": lambda: check_test(record_from_arrays(one, two, one, 23.0)),
            "parameters": lambda: parameter_set(specimen, [str(one), f"n_T={two}*m_T"], [0.0]),
            "scaled": lambda: scaled_bearing(specimen, one),
            "face": lambda: tb.EndFace(eta=one, film=two),
        }
        call = calls[name]
    return Example({}, done(lambda _: call()), f"{name}({given!r})")


def _calm_files(table: dict[str, Any]) -> st.SearchStrategy[bytes]:
    return toml_files(table, calm=True)


def _run_file(raw: bytes) -> Example:
    def run(folder: Path) -> str:
        from thermobearing.cyclic.run import run_case

        result = run_case(load_case(folder / "a.toml"))
        check_numbers(result.summary(), result.outcome)
        return COMPLETED if result.outcome == "completed" else TYPED

    return Example(
        {"a.toml": raw, **companion_files(raw)}, run, f"run: {raw.decode('utf-8', 'replace')}"
    )


def library_borders() -> list[Border]:
    sidecars = grammar.valid("sidecar").flatmap(toml_files).map(_sidecar_file)
    records = sheets.laboratory_files().flatmap(rows_of_numbers).map(_record_file)
    return [
        toml_border("bearing", tb.load_bearing, 160),
        toml_border("bilinear bearing", load_bilinear, 60),
        toml_border("structure", load_structure, 120),
        toml_border("cyclic case", _whole(load_case), 200),
        toml_border("earthquake case", _whole(load_earthquake_case), 120),
        toml_border("sequence case", _whole(load_sequence_case), 80),
        toml_border("design case", load_design_case, 60),
        toml_border("check", _check_and_describe, 120),
        Border("test sidecar", sidecars, 140),
        Border("test record", records, 100),
        Border("table", _tables(), 180),
        Border("frame", _frames(), 120),
        Border("motions file", _motion_files(), 240),
        Border("motions arithmetic", _motion_arithmetic(), 100),
        Border("result", _results(), 80),
        Border("quantity", _quantities(), 150),
        Border("arguments", _arguments(), 150),
        Border("run", grammar.valid("cyclic_case").flatmap(_calm_files).map(_run_file), 40),
        Border("run in a plane", families.plane_tables().flatmap(_calm_files).map(_run_file), 40),
        Border("law", families.laws(), 60),
        Border("export", families.exports(), 60),
        Border("motion pair", families.pairs(), 60),
        Border("posterior", families.posteriors(), 60),
        Border("quoFEM", families.folders_of_quofem(), 60),
        Border("address", families.addresses(), 60),
        Border("template", families.templates(), 40),
        Border("limits", families.limits(), 60),
    ]
