"""Laws of a user's own: registration, checks, and their use in every analysis."""

import math
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from typer.testing import CliRunner

import thermobearing as tb
from tests.unit.studies import small_study
from thermobearing import laws
from thermobearing.cli import app
from thermobearing.core.hysteresis import plane_increment
from thermobearing.core.step import tabled
from thermobearing.identify.fit.parameters import M_T, N_T
from thermobearing.live.data import engine_data
from thermobearing.model.constants import _law_pieces
from thermobearing.model.options import build_model
from thermobearing.studies.definition.designs import plan
from thermobearing.studies.run.engine import run_study
from thermobearing.studies.run.shard import run_shard
from thermobearing.studies.store import Store

HDR = "shen-hdr-specimen"
SHORT = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
ROUNDING = 1e-7  # of a table that replaces the exponential law exactly, relative to the peak
ARRHENIUS = """
import math

import thermobearing as tb


def arrhenius(temperature, elastic=300.0, hysteretic=900.0):
    inverse = 1.0 / (temperature + 273.15) - 1.0 / 296.15
    return math.exp(elastic * inverse), math.exp(hysteretic * inverse)


tb.laws.register("arrhenius", temperature=arrhenius)
"""


@pytest.fixture(autouse=True)
def no_other_laws(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(laws, "_KNOWN", {})
    yield
    assert not laws.laws_to_apply()


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "my_law.py"
    path.write_text(ARRHENIUS)
    return path


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
        tables.append(run_shard(study, plan(study)))
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
    found = np.exp([tabled(pieces, float(t)) for t in at])
    assert_allclose(found, [williams_landel_ferry(t, 5.0) for t in at], rtol=2e-7)
    below = [tabled(pieces, t) for t in (-40.0, -50.0, -60.0)]  # with the slope at the end
    assert_allclose(np.diff(below, 2, axis=0), 0.0, atol=1e-9)
    assert law.parameters == {"c1": 4.0, "c2": 80.0}


def test_a_jump_becomes_a_short_ramp() -> None:
    tb.laws.register("frozen", temperature=lambda t: ((1.5 if t < -10.0 else 1.0), 1.0))
    pieces = _law_pieces(tb.changed_bearing(HDR, law="frozen").temperature_law)
    assert_allclose(np.exp(tabled(pieces, -10.05)[0]), 1.5, rtol=1e-6)
    assert_allclose(np.exp(tabled(pieces, -9.95)[0]), 1.0, rtol=1e-6)


def no_default(temperature: float, slope: float) -> tuple[float, float]:
    return 1.0, slope * temperature


@pytest.mark.parametrize(
    ("function", "more", "pieces"),
    [
        (lambda t: (1.0, -t), {}, ["the hysteretic factor is -0.001: must be 0.001 to 1000"]),
        (lambda t: 1.0, {}, ["at -60 degC", "TypeError"]),
        (lambda t: (1.0, math.nan), {}, ["nan"]),
        (lambda t: (1.0, math.sqrt(t)), {}, ["at -60 degC", "ValueError"]),
        (lambda t: (1.0, 1.5 + math.sin(100.0 * t)), {}, ["too abruptly", "pieces"]),
        (no_default, {}, ["slope", "default"]),
        (lambda: (1.0, 1.0), {}, ["1 arguments"]),
        (1.0, {}, ["give one function"]),
        (lambda t, a=1.0: (1.0, a), {"bounds": {"b": (0, 1)}}, ['no parameter "b"']),
        (lambda t, a=1.0: (1.0, a), {"bounds": {"a": (2, 3)}}, ["contain its default 1"]),
        (lambda t: (1.0, 1.0), {"range": (0, 400)}, ["-150 to 300"]),
    ],
)
def test_a_law_that_cannot_be_is_refused(
    function: Callable[..., Any], more: dict[str, Any], pieces: list[str]
) -> None:
    with pytest.raises(tb.InputError) as caught:
        tb.laws.register("mine", temperature=function, **more)
    for piece in pieces:
        assert piece in str(caught.value)
    assert not laws._KNOWN


def test_names_parameters_and_digests_are_checked(file: Path) -> None:
    with pytest.raises(tb.InputError, match="known: closed, published"):
        tb.changed_bearing(HDR, law="arrhenius")
    assert tb.laws.load(file) == ["arrhenius"]
    with pytest.raises(tb.InputError, match="did you mean"):
        tb.changed_bearing(HDR, law="arhenius")
    wrong = {"law": "arrhenius", "parameters": {"elasticity": 1.0}}
    with pytest.raises(tb.InputError, match=r'no parameter "elasticity".*"elastic"'):
        build_model(tb.changed_bearing(HDR, temperature_law=wrong))
    named = tb.changed_bearing(HDR, law="arrhenius")
    assert named.temperature_law is not None
    assert named.temperature_law.law == laws.find_law("arrhenius").reference
    file.write_text(ARRHENIUS.replace("300.0", "310.0"))
    tb.laws.load(file)
    with pytest.raises(tb.InputError, match="the registered law differs"):
        tb.run(named, SHORT)
    with pytest.raises(tb.InputError, match="a table or a law"):
        tb.changed_bearing(
            HDR, temperature_law={"law": "x", "temperatures": [0, 1], "elastic": [1, 1]}
        )


@pytest.mark.parametrize(
    ("text", "piece"),
    [("import nothing_of_that_name", "ModuleNotFoundError"), ("x = 1", "registers no law")],
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


def test_a_bearing_file_loads_no_code(file: Path, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(
        f'based_on = "{HDR}"\nname = "mine"\n[temperature_law]\nlaw = "{file}"\n'
        "parameters = { elastic = 200.0 }\n"
    )
    bearing = tb.load_bearing(path)
    with pytest.raises(tb.InputError, match="is not registered"):
        tb.run(bearing, SHORT)


def test_the_command(file: Path, tmp_path: Path) -> None:
    words = ["cyclic", "--strain", "1", "--cycles", "1", "--ambient", "-20", "--no-figures"]
    out = tmp_path / "out"
    done = CliRunner().invoke(app, [*words, "--law", str(file), "-o", str(out)])
    assert done.exit_code == 0, done.output
    law = laws.find_law("arrhenius")
    resolved = out / "case.resolved.toml"
    assert f'law = "{law.reference}"' in resolved.read_text()
    test = tb.cyclic_test(strain=[1.0], cycles=1)
    mine = tb.run(tb.changed_bearing(HDR, law="arrhenius"), test, ambient=-20)
    again = tb.load_result(out)
    assert_array_equal(again["force"].values[0, -1], mine["force"].values[0, -1])
    laws._KNOWN.clear()
    failed = CliRunner().invoke(app, ["cyclic", str(resolved), "-o", str(tmp_path / "again")])
    assert failed.exit_code == 2
    assert "--law FILE" in re.sub(r"\s+", " ", failed.output)
    assert tb.load_result(out).outcome == "completed"


def test_processes_of_a_study_load_the_file_again(file: Path, tmp_path: Path) -> None:
    tb.laws.load(file)
    bearing = tb.changed_bearing("shen-hdr-bridge", law="arrhenius")
    study = small_study({"duration": "1 s"}, bearing=[bearing])
    tables = []
    for jobs in (1, 2):
        run_study(study, tmp_path / str(jobs), jobs=jobs)
        tables.append(Store(tmp_path / str(jobs)).table())
    assert (tables[0]["outcome"] == "completed").all()
    assert_array_equal(tables[0]["bearing_force_max_kN"], tables[1]["bearing_force_max_kN"])


def test_parameters_are_calibrated(file: Path) -> None:
    tb.laws.load(file)
    start = tb.changed_bearing(HDR, law="arrhenius")
    truth = tb.changed_bearing(
        start, temperature_law={"parameters": {"elastic": 400.0, "hysteretic": 700.0}}
    )
    records = [tb.synthetic_record(truth, at, SHORT, noise=0.002) for at in (-20.0, 20.0)]
    found = tb.identify_bearing(records, start, starts=1, blind=False)  # free by default
    estimates = found.uncertainty.estimates
    assert not {M_T, N_T} & set(estimates)
    error = estimates["temperature_law.parameters.hysteretic"].stderr
    assert (
        abs(estimates["temperature_law.parameters.hysteretic"].value - 700.0) < 4.0 * error < 80.0
    )
    law = found.bearing.temperature_law
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
    return tb.laws.register("eq-4.35", hysteresis=closed_form, bounds={"shape": (-0.95, 0.9)})


@pytest.fixture
def with_own(own: laws.Law, monkeypatch: pytest.MonkeyPatch) -> tb.Bearing:
    monkeypatch.setitem(laws._KNOWN, own.name, own)
    return tb.changed_bearing(HDR, law=own.name)


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
    tables = [run_shard(one, plan(one)) for one in (study, other)]
    assert_allclose(
        tables[0]["bearing_force_max_kN"], tables[1]["bearing_force_max_kN"], rtol=OWN_ERROR
    )


def test_in_a_plane(with_own: tb.Bearing) -> None:
    circle = tb.cyclic_test(strain=[1.0], cycles=1, path="circle")
    with pytest.raises(tb.InputError, match="function plane"):
        tb.run(with_own, circle)
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
        (closed_form, {"plane": closed_form}, "the function needs"),
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
    assert not laws._KNOWN


def test_what_a_law_of_hysteresis_does_not_go_with(with_own: tb.Bearing) -> None:
    for more in ({"small_loops": "closed"}, {"integrator": "euler"}):
        with pytest.raises(tb.InputError, match=f"{next(iter(more))}.*hysteresis_law"):
            tb.run(with_own, SHORT, **more)
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


def test_built_in_laws_use_the_same_door(with_own: tb.Bearing, tmp_path: Path) -> None:
    test = tb.cyclic_test(strain=[1.0, 0.2], cycles=1, rest=None)
    closed = tb.changed_bearing(with_own, law="closed")
    assert closed.hysteresis_law is None
    mine, same = tb.run(closed, test), tb.run(HDR, test, small_loops="closed")
    assert_array_equal(mine["force"], same["force"])
    published = tb.run(tb.changed_bearing(with_own, law="published"), test)
    assert_array_equal(published["force"], tb.run(HDR, test)["force"])
    words = ["cyclic", "--strain", "0.2", "--cycles", "1", "--law", "closed", "--no-figures"]
    done = CliRunner().invoke(app, [*words, "-o", str(tmp_path / "out")])
    assert done.exit_code == 0, done.output
    assert 'small_loops = "closed"' in (tmp_path / "out" / "case.resolved.toml").read_text()
    with pytest.raises(tb.InputError, match="built-in"):
        tb.laws.register("closed", hysteresis=closed_form)


def test_a_parameter_of_hysteresis_is_calibrated(with_own: tb.Bearing) -> None:
    truth = tb.changed_bearing(with_own, hysteresis_law={"parameters": {"shape": -0.6}})
    record = tb.synthetic_record(truth, 20.0, SHORT, noise=0.002)
    found = tb.identify_bearing(
        record, with_own, free=["eq-4.35.shape", "K_r"], starts=1, blind=False
    )
    law = found.bearing.hysteresis_law
    assert law is not None
    assert law.parameters is not None
    assert law.parameters["shape"] == pytest.approx(-0.6, abs=0.01)
