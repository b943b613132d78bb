"""Laws of a user's own: registration, checks, and their use in every analysis."""

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
import tomli_w
from numpy.testing import assert_allclose, assert_array_equal
from typer.testing import CliRunner

import thermobearing as tb
from tests.quick import quick_cases
from tests.unit.laws import ARRHENIUS
from tests.unit.studies import small_study
from thermobearing import laws
from thermobearing.bearing.library import BEARINGS, bearing_from_table
from thermobearing.bearing.model import Hardening, SmallLoops
from thermobearing.border.library import _built_in_entries
from thermobearing.border.toml import to_table, with_sources
from thermobearing.cli import app
from thermobearing.core.hysteresis import plane_increment
from thermobearing.core.step import tabled
from thermobearing.identify.fit.parameters import M_T, N_T, available, keys_by_name, parameter_set
from thermobearing.live.data import engine_data
from thermobearing.model.constants import _law_pieces
from thermobearing.model.options import build_model
from thermobearing.studies.definition.designs import Plan
from thermobearing.studies.run.engine import run_study
from thermobearing.studies.run.shard import run_shard
from thermobearing.studies.store import Store, open_or_make

HDR = "shen-hdr-specimen"
SHORT = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
ROUNDING = 1e-7  # of a table that replaces the exponential law exactly, relative to the peak
GUIDE = Path(__file__).parents[2] / "docs" / "guide" / "own_law.md"
pytestmark = pytest.mark.usefixtures("no_other_laws")


def exponential(bearing: tb.Bearing) -> str:
    """Register the exponential law of a bearing as a new law."""
    h = bearing.hysteresis
    m, n, zero = (
        h.elastic_temperature_coefficient / 100.0,
        h.hysteretic_temperature_coefficient / 100.0,
        h.reference_temperature,
    )
    tb.laws.register(
        "own", temperature=lambda t: (math.exp(m * (t - zero)), math.exp(n * (t - zero)))
    )
    return "own"


def same_force(one: Any, other: Any, name: str = "force") -> None:
    peak = np.abs(other[name].values).max()
    assert_allclose(one[name].values, other[name].values, rtol=0.0, atol=ROUNDING * peak)


@pytest.mark.parametrize("path", [None, "circle"], ids=["line", "plane"])
def test_the_exponential_law_as_a_law_of_ones_own(path: Any) -> None:
    bearing = tb.load_bearing(HDR)
    test = SHORT if path is None else tb.cyclic_test(strain=[1.0], cycles=1, path=path)
    same, own = (
        tb.run(one, test, -20.0)
        for one in (bearing, tb.changed_bearing(bearing, law=exponential(bearing)))
    )
    same_force(own, same)
    assert own.outcome == "completed"


def test_in_an_earthquake_and_in_lockstep() -> None:
    bearing = tb.load_bearing("shen-hdr-bridge")
    own = tb.changed_bearing(bearing, law=exponential(bearing))
    same_force(
        *(tb.bridge(one, "jra-ii-i-1", -20, duration=3) for one in (own, bearing)), "bearing_force"
    )
    tables = []
    for one in (own, bearing):
        study = small_study({"duration": "3 s"}, bearing=[one])
        tables.append(run_shard(Plan(study), Plan(study).runs))
    name = "bearing_force_max_kN"
    assert_allclose(tables[0][name], tables[1][name], rtol=1e-6)


def williams_landel_ferry(
    temperature: float, c1: float = 4.0, c2: float = 80.0
) -> tuple[float, float]:
    shift = 10.0 ** (-c1 * (temperature - 23.0) / (c2 + temperature - 23.0))
    return shift**0.05, shift**0.1


def test_the_table_is_the_function() -> None:
    law = tb.laws.register("wlf", temperature=williams_landel_ferry, range=(-40, 100))
    bearing = tb.changed_bearing(HDR, temperature_law={"law": "wlf", "parameters": {"c1": 5.0}})
    pieces = build_model(bearing).constants.law
    at = np.random.default_rng(1).uniform(-40.0, 100.0, 200)
    result = np.exp([tabled(pieces, float(t))[:2] for t in at])
    assert_allclose(result, [williams_landel_ferry(t, 5.0) for t in at], rtol=2e-7)
    below = [tabled(pieces, t)[:2] for t in (-40.0, -50.0, -60.0)]  # with the slope at the end
    assert_allclose(np.diff(below, 2, axis=0), 0.0, atol=1e-9)
    assert law.parameters == {"c1": 4.0, "c2": 80.0}


def test_a_law_may_bend() -> None:
    tb.laws.register("bent", temperature=lambda t: (math.exp(0.1 * max(1.7 - t, 0.0)), 1.0))
    pieces = _law_pieces(tb.changed_bearing(HDR, law="bent").temperature_law)
    at = [1.7 + step for step in (-1.0, -1e-2, -1e-4, -1e-6, 0.0, 1e-6, 1e-4, 1e-2, 1.0)]
    result = [tabled(pieces, t)[0] for t in at]
    assert_allclose(result, [0.1 * max(1.7 - t, 0.0) for t in at], rtol=0.0, atol=2e-7)


def no_default(temperature: float, slope: float) -> tuple[float, float]:
    return 1.0, slope * temperature


async def waits(temperature: float) -> tuple[float, float]:
    return 1.0, 1.0


@pytest.mark.parametrize(
    ("function", "more", "pieces"),
    [
        (lambda t: (1.0, -t), {}, ["the hysteretic factor is -0.0001: must be 0.001 to 1000"]),
        (lambda t: (1.0 if t > 3.37 else 2.0, 1.0), {}, ["abruptly, at 3.37 degC"]),
        (lambda t: (1.0, 1.0 if t >= -20.0 else 1.001), {}, ["abruptly, at -20 degC"]),
        (lambda t: 1.0, {}, ["at -60 degC", "must return 2 numbers"]),
        (waits, {}, ["at -60 degC", "2 numbers", "async"]),
        (lambda t: waits(t + 1.0), {}, ["at -60 degC", "2 numbers", "async"]),
        (lambda t: (1.0, math.nan), {}, ["nan"]),
        (lambda t: (1.0, math.sqrt(t)), {}, ["at -60 degC", "ValueError"]),
        (lambda t: (1.0, 1.5 + math.sin(100.0 * t)), {}, ["-59.63 degC", "1000 pieces"]),
        (no_default, {}, ["slope", "default"]),
        (lambda: (1.0, 1.0), {}, ["must take the temperature"]),
        (1.0, {}, ["give one function"]),
        (lambda t, a=1.0: (1.0, a), {"bounds": {"b": (0, 1)}}, ['no parameter "b"']),
        (lambda t, a=1.0: (1.0, a), {"bounds": {"a": (2, 3)}}, ["contain its default 1"]),
        (lambda t: (1.0, 1.0), {"range": (0, 400)}, ["-150 to 300"]),
        (lambda t: (1.0, 1.0), {"range": "cold"}, ["range = 'cold': must be two numbers"]),
        (lambda t, a=1.0: (1.0, a), {"bounds": {"a": 2}}, ["bounds of a = 2: must be two numbers"]),
    ],
)
def test_a_law_that_cannot_be_is_refused(
    function: Callable[..., Any], more: dict[str, Any], pieces: list[str]
) -> None:
    with pytest.raises(tb.InputError) as caught:
        tb.laws.register("mine", temperature=function, **more)
    for piece in pieces:
        assert piece in str(caught.value)
    assert not laws._REGISTERED


def test_names_parameters_and_digests_are_checked(law_file: Path) -> None:
    with pytest.raises(tb.InputError, match="known: closed, constant-lead, monotone"):
        tb.changed_bearing(HDR, law="arrhenius")
    assert tb.laws.load(law_file) == ["arrhenius"]
    with pytest.raises(tb.InputError, match="did you mean"):
        tb.changed_bearing(HDR, law="arhenius")
    wrong = {"law": "arrhenius", "parameters": {"elasticity": 1.0}}
    with pytest.raises(tb.InputError, match=r'no parameter "elasticity".*"elastic"'):
        build_model(tb.changed_bearing(HDR, temperature_law=wrong))
    named = tb.changed_bearing(HDR, law="arrhenius")
    assert named.temperature_law is not None
    assert named.temperature_law.law == laws.find_law("arrhenius").value
    law_file.write_text(ARRHENIUS.replace("300.0", "310.0"))
    tb.laws.load(law_file)
    with pytest.raises(tb.InputError, match="the registered law differs"):
        tb.run(named, SHORT)
    with pytest.raises(tb.InputError, match="a table or a law"):
        tb.changed_bearing(
            HDR, temperature_law={"law": "x", "temperatures": [0, 1], "elastic": [1, 1]}
        )


@pytest.mark.parametrize(
    ("text", "piece"),
    [
        ("import nothing_of_that_name", "line 1: cannot be run: ModuleNotFoundError"),
        ("x = 1", "registers no law"),
        (
            ARRHENIUS.replace("temperature=", "temprature="),
            r'line 13: .*"temprature"; did you mean "temperature"',
        ),
        (ARRHENIUS.replace("300.0", "3e5"), "line 13: .* the elastic factor is"),
    ],
)
def test_files_that_cannot_be_used(tmp_path: Path, text: str, piece: str) -> None:
    path = tmp_path / "my_law.py"
    path.write_text(text)
    with pytest.raises(tb.InputError, match=piece):
        tb.laws.load(path)
    with pytest.raises(tb.InputError, match="no such file"):
        tb.laws.load(tmp_path / "other.py")
    with pytest.raises(tb.InputError, match=r"ending in \.py"):
        tb.laws.load(tmp_path / "law.toml")


def test_a_bearing_file_loads_no_code(law_file: Path, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(
        f'based_on = "{HDR}"\nname = "mine"\n[temperature_law]\nlaw = "{law_file}"\n'
        "parameters = { elastic = 200.0 }\n"
    )
    bearing = tb.load_bearing(path)
    with pytest.raises(tb.InputError, match="is not registered"):
        tb.run(bearing, SHORT)


def test_the_command(law_file: Path, tmp_path: Path) -> None:
    words = ["cyclic", "--strain", "1", "--cycles", "1", "--ambient", "-20", "--no-figures"]
    out = tmp_path / "out"
    done = CliRunner().invoke(app, [*words, "--law", str(law_file), "-o", str(out)])
    assert done.exit_code == 0, done.output
    assert not laws._REGISTERED  # the law ended with the command
    tb.laws.load(law_file)
    law = laws.find_law("arrhenius")
    resolved = out / "case.resolved.toml"
    assert f'law = "{law.value}"' in resolved.read_text()
    test = tb.cyclic_test(strain=[1.0], cycles=1)
    mine = tb.run(tb.changed_bearing(HDR, law="arrhenius"), test, ambient=-20)
    again = tb.load_result(out)
    assert_array_equal(again["force"].values[0, -1], mine["force"].values[0, -1])
    laws._REGISTERED.clear()
    failed = CliRunner().invoke(app, ["cyclic", str(resolved), "-o", str(tmp_path / "again")])
    assert failed.exit_code == 2
    assert "--law FILE" in re.sub(r"\s+", " ", failed.output)
    assert tb.load_result(out).outcome == "completed"


def test_processes_of_a_study_load_the_file_again(law_file: Path, tmp_path: Path) -> None:
    tb.laws.load(law_file)
    bearing = tb.changed_bearing("shen-hdr-bridge", law="arrhenius")
    study = small_study({"duration": "1 s"}, bearing=[bearing])
    tables = []
    for jobs in (1, 2):
        run_study(study, tmp_path / str(jobs), jobs=jobs)
        tables.append(Store(tmp_path / str(jobs)).table())
    assert (tables[0]["outcome"] == "completed").all()
    assert_array_equal(tables[0]["bearing_force_max_kN"], tables[1]["bearing_force_max_kN"])


def test_parameters_of_a_law_are_known_of_its_bearing_only() -> None:
    tb.laws.register("mine", temperature=lambda t, slope=0.1: (1.0, 1.0 - slope * t / 100.0))
    plain = tb.load_bearing(HDR)
    own = tb.changed_bearing(HDR, law="mine")
    assert "mine.slope" in {kind.symbol for kind in available(own)}
    assert parameter_set(own, ["mine.slope"], [-20.0, 23.0]).values(np.array([0.5]))
    assert "mine.slope" not in keys_by_name(plain)
    with pytest.raises(tb.InputError, match="no parameter"):
        parameter_set(plain, ["mine.slope"], [-20.0, 23.0])


def test_parameters_are_calibrated(law_file: Path) -> None:
    tb.laws.load(law_file)
    start = tb.changed_bearing(HDR, law="arrhenius")
    truth = tb.changed_bearing(
        start, temperature_law={"parameters": {"elastic": 400.0, "hysteretic": 700.0}}
    )
    records = [tb.synthetic_record(truth, at, SHORT, noise=0.002) for at in (-20.0, 20.0)]
    result = tb.identify_bearing(records, start, starts=1, start_from="bearing")  # free by default
    estimates = result.uncertainty.estimates
    assert not {M_T, N_T} & set(estimates)
    error = estimates["temperature_law.parameters.hysteretic"].stderr
    assert (
        abs(estimates["temperature_law.parameters.hysteretic"].value - 700.0) < 4.0 * error < 80.0
    )
    law = result.bearing.temperature_law
    assert law is not None
    assert law.parameters is not None
    assert law.parameters["elastic"] == pytest.approx(400.0, rel=0.02)
    assert law.parameters["hysteretic"] == pytest.approx(700.0, rel=0.02)


def closed_form(z: float, d: float, shape: float = -0.864) -> tuple[float, float]:
    """The law of Eq. 4.35 relative to d_y, for shape < 1."""
    sigma = 1.0 if d >= 0.0 else -1.0
    u, e = sigma * z, abs(d)
    c = (1.0 - shape) / (1.0 + shape)
    if u < 0.0:
        k = math.sqrt(c)
        way = math.atan(-k * u) / k
        if e < way:
            t = math.tan(k * e)
            u, e = (u + t / k) / (1.0 - k * u * t), 0.0
        else:
            u, e = 0.0, e - way
    if u >= 0.0:
        t = math.tanh(e)
        u = (u + t) / (1.0 + u * t)
    return sigma * u, 1.0 - u * u if u >= 0.0 else 1.0 + c * u * u


def closed_form_in_plane(
    zx: float, zy: float, dx: float, dy: float, shape: float = -0.864
) -> tuple[float, float, float, float, float, float]:
    """The same in a plane, by the kernel of the package."""
    z, slope = plane_increment.py_func((zx, zy), (dx, dy), 1.0, (1.0 - shape) / (1.0 + shape))
    return (*z, *slope[0], *slope[1])


OWN_ERROR = 1e-9  # of the same law by another function, relative to the peak


@pytest.fixture(scope="module")
def own() -> laws.Law:
    with pytest.MonkeyPatch.context() as patch:  # other files of tests do not have it
        patch.setattr(laws, "_REGISTERED", {})
        return tb.laws.register("eq-4.35", hysteresis=closed_form, bounds={"shape": (-0.95, 0.9)})


@pytest.fixture
def with_own(own: laws.Law, monkeypatch: pytest.MonkeyPatch) -> tb.Bearing:
    monkeypatch.setitem(laws._REGISTERED, own.name, own)
    return tb.changed_bearing(HDR, law=own.name)


@pytest.mark.thorough
def test_the_published_law_as_a_law_of_ones_own(with_own: tb.Bearing) -> None:
    for ambient in (-20.0, 23.0):
        test = tb.cyclic_test(strain=[2.5, 0.3], cycles=2, rest=None)  # -20: layers soften
        mine, same = (tb.run(one, test, ambient) for one in (with_own, HDR))
        peak = np.abs(same["force"].values).max()
        assert_allclose(mine["force"].values, same["force"].values, atol=OWN_ERROR * peak)
        assert abs(mine.energy["mechanical_residual"].iloc[0]) < 1e-12
    other = tb.changed_bearing(with_own, hysteresis_law={"parameters": {"shape": 0.0}})
    assert not np.allclose(tb.run(other, SHORT)["force"], tb.run(HDR, SHORT)["force"], atol=1.0)


def test_a_law_of_hysteresis_in_an_earthquake_and_in_lockstep(own: laws.Law, with_own: Any) -> None:
    shape = tb.load_bearing("shen-hdr-bridge").hysteresis.shape
    mine = tb.changed_bearing(
        "shen-hdr-bridge", hysteresis_law={"law": own.name, "parameters": {"shape": shape}}
    )
    runs = [tb.bridge(one, "jra-ii-i-1", -20, duration=3) for one in (mine, "shen-hdr-bridge")]
    same_force(*runs, "bearing_force")
    study = small_study({"duration": "3 s"}, bearing=["shen-hdr-bridge"])
    other = small_study({"duration": "3 s"}, bearing=[mine])
    tables = [run_shard(Plan(one), Plan(one).runs) for one in (study, other)]
    assert_allclose(
        tables[0]["bearing_force_max_kN"], tables[1]["bearing_force_max_kN"], rtol=OWN_ERROR
    )


def test_in_a_plane(with_own: tb.Bearing) -> None:
    circle = tb.cyclic_test(strain=[1.0], cycles=1, path="circle")
    sentence = r'law "eq-4\.35" has no function for two directions; register it with plane=\.\.\.$'
    with pytest.raises(tb.InputError, match=sentence):
        tb.run(with_own, circle)
    with pytest.raises(tb.InputError, match=sentence):
        tb.bridge(with_own, "jra-ii-i-1", structure="five-span-bridge", components=2)
    with pytest.raises(tb.InputError, match="function plane"):
        tb.element(with_own, components=2)


def test_a_law_in_a_plane_without_a_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(laws, "has_numba", lambda: False)
    tb.laws.register("slow", hysteresis=closed_form, plane=closed_form_in_plane)
    mine = tb.changed_bearing(HDR, law="slow")
    for path in (None, "circle"):
        test = tb.cyclic_test(strain=[0.5], cycles=1, path=path, dt=0.02)
        runs = [tb.run(one, test, 0.0) for one in (mine, HDR)]
        peak = np.abs(runs[1]["force"].values).max()
        assert_allclose(*(one["force"].values for one in runs), atol=OWN_ERROR * peak)


PLANE = plane_increment.dispatcher


def compiled_in_plane(
    zx: float, zy: float, dx: float, dy: float, shape: float = -0.864
) -> tuple[float, float, float, float, float, float]:
    """`closed_form_in_plane` as numba compiles it."""
    z, slope = PLANE((zx, zy), (dx, dy), 1.0, (1.0 - shape) / (1.0 + shape))
    return z[0], z[1], slope[0][0], slope[0][1], slope[1][0], slope[1][1]


@pytest.fixture(scope="module")
def own_in_plane() -> laws.Law:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(laws, "_REGISTERED", {})
        return tb.laws.register("plane", hysteresis=closed_form, plane=compiled_in_plane)


@pytest.fixture
def both(own_in_plane: laws.Law, monkeypatch: pytest.MonkeyPatch) -> tb.Bearing:
    """The bridge bearing whose laws of temperature and hysteresis are registered ones."""
    monkeypatch.setitem(laws._REGISTERED, "plane", own_in_plane)
    bearing = tb.load_bearing("shen-hdr-bridge")
    named = {"law": "plane", "parameters": {"shape": bearing.hysteresis.shape}}
    return tb.changed_bearing(bearing, law=exponential(bearing), hysteresis_law=named)


@pytest.mark.parametrize("structure", quick_cases(["pier-p1", "five-span-bridge"], 1))
def test_laws_in_a_bridge_on_a_line_and_in_plan(structure: str, both: tb.Bearing) -> None:
    one, other = map(tb.load_motion, ("jra-ii-i-1", "jra-ii-i-2"))
    motion = one if structure == "pier-p1" else tb.MotionPair(one, other)
    how: dict[str, Any] = {"structure": structure, "duration": 3}
    runs = [tb.bridge(one, motion, -20, **how) for one in (both, "shen-hdr-bridge")]
    same_force(*runs, "bearing_force")
    assert runs[0].outcome == "completed"


def test_laws_in_a_hybrid_test(both: tb.Bearing) -> None:
    runs = [tb.hybrid(one, "jra-ii-i-1", -20, duration=3) for one in (both, "shen-hdr-bridge")]
    same_force(*runs, "bearing_force")


@pytest.mark.thorough
def test_a_law_of_hysteresis_in_processes_of_a_study(tmp_path: Path) -> None:
    path = tmp_path / "dahl.py"
    result = re.search(r"```python\n(# dahl\.py\n.*?)```", GUIDE.read_text(), re.DOTALL)
    assert result is not None
    path.write_text(result[1])
    tb.laws.load(path)
    mine = tb.changed_bearing("shen-hdr-bridge", law="dahl")
    study = small_study({"duration": "1 s"}, bearing=[mine])
    run_study(study, tmp_path / "study", jobs=2)
    table, alone = Store(tmp_path / "study").table(), run_shard(Plan(study), Plan(study).runs)
    assert (table["outcome"] == "completed").all()
    assert_array_equal(table["bearing_force_max_kN"], alone["bearing_force_max_kN"])


def gaining(z: float, d: float) -> tuple[float, float]:
    after = -math.tanh(d) + z / math.cosh(d)
    return after, -1.0 / math.cosh(d) ** 2 - z * math.sinh(d) / math.cosh(d) ** 2


def saturating(z: float, d: float) -> tuple[float, float]:
    """Lose some Z in each increment, however short it is."""
    after = math.tanh(z + d)
    return after, 1.0 - after * after


@pytest.mark.parametrize(
    ("function", "more", "piece"),
    [
        (lambda z, d: (closed_form(z, d)[0], 1.0), {}, "dZ/dd is 1, but differences give"),
        (gaining, {}, "returns more energy than it takes"),
        (saturating, {}, "does not converge with shorter increments"),
        (lambda z, d: (z + d, 1.0), {}, "must be finite, and Z from -4 to 4"),
        (lambda z, d: (math.nan, 1.0), {}, "returns nan"),
        (lambda z, d: z, {}, "must return 2 numbers"),
        (lambda z, d: (math.log(z), 1.0), {}, "ValueError"),
        (lambda z, d, a=1.0, b=1.0, c=1.0, e=1.0, f=1.0: (z, 0.0), {}, "at most 4 parameters"),
        (closed_form, {"temperature": lambda t: (1.0, 1.0)}, "one function"),
        (closed_form, {"plane": closed_form}, "plane: the function must take Z_x"),
        (
            closed_form,
            {"plane": lambda x, y, dx, dy, shape=-0.864: (x, y, 1.0, 0.0, 0.0, 1.0)},
            "differs from hysteresis on the line",
        ),
    ],
)
def test_a_law_of_hysteresis_that_cannot_be_is_refused(
    function: Callable[..., Any], more: dict[str, Any], piece: str
) -> None:
    with pytest.raises(tb.InputError) as caught:
        tb.laws.register("mine", hysteresis=function, **more)
    assert piece in str(caught.value)
    assert not laws._REGISTERED


def test_what_a_law_of_hysteresis_does_not_go_with(with_own: tb.Bearing) -> None:
    for more in ({"small_loops": "closed"}, {"integrator": "euler"}):
        with pytest.raises(tb.InputError, match=f"{next(iter(more))}.*hysteresis_law"):
            tb.run(with_own, SHORT, model=tb.ModelOptions(**more))
    element = tb.element(with_own)
    with pytest.raises(tb.InputError, match="cannot hold"):
        tb.opensees.write_material("x", element)
    state = element.__getstate__() | {"_process": -1}
    with pytest.raises(tb.InputError, match="another process"):
        tb.BearingElement.__new__(tb.BearingElement).__setstate__(state)
    with pytest.raises(tb.InputError, match="live page"):
        engine_data([(with_own, build_model(with_own))])
    with pytest.raises(tb.InputError, match="is a hysteresis law, not a temperature law"):
        tb.run(tb.changed_bearing(HDR, temperature_law={"law": "eq-4.35"}), SHORT)


@pytest.mark.parametrize(
    ("name", "bearing", "options", "changes"),
    quick_cases(
        [
            ("published", HDR, {"small_loops": "published"}, {}),
            ("closed", HDR, {"small_loops": "closed"}, {}),
            ("printed", HDR, {"hardening": "printed"}, {}),
            ("monotone", HDR, {"hardening": "monotone"}, {}),
            (
                "constant-lead",
                "shen-lhdr-softening",
                {},
                {"lead": {"softening": 0.0, "softening_beyond_tests": 0.0}},
            ),
            ("softening-lead", "shen-lhdr-specimen", {}, {"lead": {"softening": 0.0069}}),
        ],
        0,
        5,
    ),
)
def test_a_law_of_the_package_is_chosen_by_name(
    name: str, bearing: str, options: Any, changes: Any, tmp_path: Path
) -> None:
    law = laws.known_laws()[name]
    strain = 2.5 if law.kind == "hardening" else 1.0  # where a layer softens in the cold
    words = ["cyclic", "--bearing", bearing, "--strain", str(strain), "--cycles", "1"]
    out = tmp_path / "out"
    done = CliRunner().invoke(
        app, [*words, "--ambient", "-20", "--law", name, "--no-figures", "-o", str(out)]
    )
    assert done.exit_code == 0, done.output
    test = tb.cyclic_test(strain=[strain], cycles=1)
    reference = tb.changed_bearing(bearing, **changes)
    same = tb.run(reference, test, -20, model=tb.ModelOptions(**options))["force"]
    mine = tb.run(tb.changed_bearing(bearing, law=name), test, -20)["force"]
    assert_array_equal(mine, same)
    assert_array_equal(tb.load_result(out)["force"].values[0, -1], same.values[0, -1])
    others = [one for one in laws.built_in_laws().values() if one.kind == law.kind]
    other = tb.changed_bearing(bearing, law=next(one.name for one in others if one is not law))
    if law.kind != "hysteresis":  # a test without small loops
        assert not np.array_equal(tb.run(other, test, -20)["force"], same)
    key = law.key.partition(".")[2]
    assert f'{key} = "{law.value}"' in (out / "case.resolved.toml").read_text()


def test_sources_are_those_of_the_law() -> None:
    name, key = "shen-lhdr-specimen", "lead.softening"
    source = laws.built_in_laws()["softening-lead"].source
    _built_in_entries.cache_clear()  # what is in the file has to be read while the law applies
    with laws.applied(["softening-lead"]):
        bearing = tb.load_bearing(name)
        kept = BEARINGS.sources(tb.Bearing, to_table(bearing))
    assert bearing.sources[key] == source
    assert key not in kept  # the file states another value
    assert tb.changed_bearing(name, law="softening-lead").sources[key] == source
    assert BEARINGS.sources(tb.Bearing, to_table(tb.load_bearing(name)))[key] != source


def test_the_register_states_every_choice() -> None:
    result = [(law.key, law.value) for law in laws.built_in_laws().values()]
    expected = {"small_loops": SmallLoops, "hardening_form": Hardening}
    for key, choices in expected.items():
        values = tuple(value for one, value in result if one == f"hysteresis.{key}")
        assert values == get_args(choices)


def test_a_built_in_law_takes_the_place_of_a_registered_one(with_own: tb.Bearing) -> None:
    test = tb.cyclic_test(strain=[1.0, 0.2], cycles=1, rest=None)
    closed = tb.changed_bearing(with_own, law="closed")
    assert closed.hysteresis_law is None
    assert_array_equal(
        tb.run(closed, test)["force"],
        tb.run(HDR, test, model=tb.ModelOptions(small_loops="closed"))["force"],
    )
    with pytest.raises(tb.InputError, match="built-in"):
        tb.laws.register("closed", hysteresis=closed_form)


@pytest.mark.parametrize(
    ("words", "piece"),
    [
        (["--law", "closed", "--law", "published"], "closed: is a hysteresis law, and so is publ"),
        (["--law", "monoton"], 'did you mean "monotone"?'),
        (["--law", "softening-lead"], 'law = "softening-lead": needs a bearing with lead'),
    ],
)
def test_laws_that_cannot_be_chosen(words: list[str], piece: str, tmp_path: Path) -> None:
    given = ["cyclic", "--strain", "0.2", *words, "--no-figures", "-o", str(tmp_path / "out")]
    done = CliRunner().invoke(app, given)
    assert done.exit_code == 2
    assert piece in re.sub(r"\s+", " ", done.output)


def test_a_registered_law_is_not_a_key_and_a_key_is_no_registered_law() -> None:
    named = tb.changed_bearing(HDR, hysteresis_law={"law": "closed"})
    with pytest.raises(tb.InputError, match=r'built in; write hysteresis.small_loops = "closed"'):
        tb.run(named, SHORT)


def test_check_and_list_state_laws(law_file: Path, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(
        f'based_on = "{HDR}"\nname = "mine"\n[temperature_law]\nlaw = "arrhenius"\n'
        "parameters = { elastic = 200.0 }\n"
    )
    failed = CliRunner().invoke(app, ["check", str(path)])
    assert failed.exit_code == 2
    assert "is not registered" in failed.output
    done = CliRunner().invoke(app, ["check", str(path), "--law", str(law_file)])
    assert "printed, published, arrhenius (elastic = 200, hysteretic = 900)" in done.output
    done = CliRunner().invoke(app, ["list", "--law", str(law_file)])
    assert re.search(r"arrhenius +law of temperature +The parameters .*elastic = 300", done.output)


@pytest.mark.parametrize(
    ("parameters", "pieces"),
    [
        ({"elastic": "x"}, ["law.parameters.elastic = 'x'", "at least -1e+12 and at most 1e+12"]),
        ({"intercept": "x"}, ["law.parameters.intercept = 'x'", "at most 1e+12"]),
        ({"elastic": "300"}, ["law.parameters.elastic = '300'"]),
        ({"elastic": True}, ["law.parameters.elastic = True"]),
        ({"elastic": 1e5}, ["at -60 degC with elastic = 100000", "must be 0.001 to 1000"]),
    ],
)
def test_check_refuses_parameters(
    parameters: Any, pieces: list[str], law_file: Path, tmp_path: Path
) -> None:
    table = {"law": "arrhenius", "parameters": parameters}
    mine, case = tmp_path / "mine.toml", tmp_path / "case.toml"
    mine.write_text(tomli_w.dumps({"based_on": HDR, "name": "mine", "temperature_law": table}))
    bridge = {"command": "bridge", "structure": "pier-p1", "motions": ["jra-ii-i-1"]}
    case.write_text(tomli_w.dumps(bridge | {"bearings": ["mine.toml"], "ambient": ["0 degC"]}))
    for path in (mine, case):
        done = CliRunner().invoke(app, ["check", str(path), "--law", str(law_file)])
        assert done.exit_code == 2
        for piece in pieces:
            assert piece in re.sub(r"\s+", " ", done.output)


def test_a_bearing_that_names_a_law_gets_no_other(own: laws.Law, law_file: Path) -> None:
    tb.laws.load(law_file)
    laws._REGISTERED[own.name] = own
    named = tb.changed_bearing(HDR, hysteresis_law={"law": own.name})
    table = with_sources(to_table(named), named.sources)
    with laws.applied(["arrhenius", own.name, "monotone"]):
        kept, given = bearing_from_table(table, "kept"), tb.load_bearing(HDR)
    assert to_table(kept) == to_table(tb.changed_bearing(named, law="monotone"))
    both = tb.changed_bearing(HDR, law=["arrhenius", own.name, "monotone"])
    assert to_table(given) == to_table(both)
    assert kept.sources["hysteresis.hysteretic_temperature_coefficient"]


def test_of_two_laws_of_a_file_one_is_chosen_by_its_name(law_file: Path) -> None:
    law_file.write_text(f"{ARRHENIUS}tb.laws.register('flat', temperature=lambda t: (1.0, 1.0))\n")
    for names, expected in ([], []), (["flat"], ["flat"]), (["flat", "closed"], ["flat", "closed"]):
        with laws.applied([law_file, *names]):
            assert laws.laws_to_apply() == expected
    with (
        pytest.raises(tb.InputError, match="and so is"),
        laws.applied([law_file, "flat", "arrhenius"]),
    ):
        pass


def test_a_law_that_is_not_registered_is_compared_with_its_kind(law_file: Path) -> None:
    missing = tb.changed_bearing(HDR, temperature_law={"law": "printer"})
    with pytest.raises(tb.InputError) as caught:
        tb.run(missing, SHORT)
    assert "did you mean" not in str(caught.value)
    tb.laws.load(law_file)
    with pytest.raises(tb.InputError, match=r"known: arrhenius$"):
        tb.run(missing, SHORT)


def test_a_python_file_is_no_toml(law_file: Path) -> None:
    done = CliRunner().invoke(app, ["check", str(law_file)])
    assert done.exit_code == 2
    assert "--law" in done.output


def test_a_study_without_its_law_is_another_study(law_file: Path, tmp_path: Path) -> None:
    how: dict[str, Any] = {"bearing": ["shen-hdr-bridge"], "motion": ["jra-ii-i-1"]}
    with laws.applied([law_file]):
        study = small_study(**how)
        open_or_make(tmp_path / "study", Plan(study), None)
    with pytest.raises(tb.InputError, match=r"'arrhenius@\w+' \(give the same file by --law\)"):
        run_study(small_study(**how), tmp_path / "study")


def test_a_parameter_of_hysteresis_is_calibrated(with_own: tb.Bearing) -> None:
    truth = tb.changed_bearing(with_own, hysteresis_law={"parameters": {"shape": -0.6}})
    record = tb.synthetic_record(truth, 20.0, SHORT, noise=0.002)
    result = tb.identify_bearing(
        record, with_own, free=["eq-4.35.shape", "K_r"], starts=1, start_from="bearing"
    )
    law = result.bearing.hysteresis_law
    assert law is not None
    assert law.parameters is not None
    assert law.parameters["shape"] == pytest.approx(-0.6, abs=0.01)
