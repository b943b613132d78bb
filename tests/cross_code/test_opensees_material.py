"""Bearings as materials that OpenSees runs itself, compared with `tb.element` step by step."""

import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests.fixtures.kernels import c_compiler
from tests.opensees import analyse, needs_opensees, ops
from tests.verification.structures import follow
from thermobearing.core.compiled import native
from thermobearing.opensees import material
from thermobearing.opensees.element import SHORTEST_STEP
from thermobearing.opensees.material import Material, add_material, write_material

pytestmark = needs_opensees
MASS = 150e3  # [kg] on a bearing of a bridge
DT = 0.02  # [s]
NEWTON: dict[str, Any] = {"tolerance": 1e-12, "most": 30, "constraints": "Plain"}
CLOSE = 1e-9  # of forces, relative to the largest: rounding
BEARING = "shen-lhdr-bridge"


@pytest.fixture(scope="module", autouse=True)
def folder(request: pytest.FixtureRequest) -> Iterator[Path]:
    """The folder of `make kernels`; in a clone, one with the step alone."""
    if native.open_library()[0] is not None:
        yield native.FOLDER
        return
    directory = request.getfixturevalue("library_with_step")
    library = native._load(directory, native.library_name()), ""
    built = SimpleNamespace(
        FOLDER=directory, open_library=lambda: library, library_name=native.library_name
    )
    material._material_library.cache_clear()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(material, "native", built)
        yield directory
    material._material_library.cache_clear()


@pytest.fixture
def new_model() -> Iterator[Callable[..., Material]]:
    """Return what builds a mass on one or more bearings in parallel, in m and N."""

    def build(elements: int = 1, bearing: str = BEARING, **options: Any) -> Material:
        ops.wipe()
        ops.model("basic", "-ndm", 2, "-ndf", 3)
        ops.node(1, 0.0, 0.0)
        ops.node(2, 0.0, 0.0)
        ops.fix(1, 1, 1, 1)
        ops.fix(2, 0, 1, 1)
        ops.mass(2, MASS, 0.0, 0.0)
        result = add_material(ops, 7, tb.element(bearing, ambient=-20), units="N-m", **options)
        for k in range(elements):
            ops.element("zeroLength", 1 + k, 1, 2, "-mat", 7, "-dir", 1)
        return result

    yield build
    ops.wipe()


def shake() -> None:
    t = DT * np.arange(400)
    ops.timeSeries("Path", 1, "-dt", DT, "-values", *(3.0 * np.sin(4.0 * t)))
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    analyse(**NEWTON)


def steps(count: int, dt: float = DT) -> np.ndarray:
    """Displacement [mm] and force of the first bearing [kN] at the end of each step."""
    result = []
    for _ in range(count):
        assert ops.analyze(1, dt) == 0
        result.append((1e3 * ops.nodeDisp(2, 1), 1e-3 * ops.basicForce(1)[0]))
    return np.array(result)


def followed(path: Any, dt: Any = DT, bearing: str = BEARING) -> tuple[np.ndarray, Any]:
    """Forces of `tb.element` along displacements [kN], and the element."""
    return follow(tb.element(bearing, ambient=-20), path, dt)


@pytest.mark.parametrize("bearing", ["shen-lhdr-bridge", "shen-hdr-bridge"])
def test_an_earthquake_gives_the_forces_and_temperatures_of_the_element(
    new_model: Any, bearing: str
) -> None:
    result = new_model(bearing=bearing)
    shake()
    x, force = steps(200).T
    expected, twin = followed(x, bearing=bearing)
    assert np.abs(x).max() > 20.0
    assert_allclose(force, expected, rtol=0.0, atol=CLOSE * np.abs(expected).max())
    (state,) = result.states()
    assert_allclose(state.temperature, twin.state.temperature, rtol=0.0, atol=1e-9)
    assert state.temperature.max() > -19.99
    assert state.response["clock"][0] == pytest.approx(200 * DT)


def test_elements_have_states_of_their_own(new_model: Any) -> None:
    result = new_model(elements=3)
    ops.remove("ele", 2)
    shake()
    steps(40)
    one, other = result.states()
    assert_allclose(one.temperature, other.temperature, rtol=0.0, atol=0.0)
    one.temperature[:] = 0.0
    assert result.states()[0].temperature[0] != 0.0
    ops.wipe()
    assert not result.states()


def test_reset_starts_again(new_model: Any) -> None:
    result = new_model()
    shake()
    first = steps(50)
    ops.reset()
    (state,) = result.states()
    assert state.temperature == pytest.approx(-20.0)
    assert state.response["clock"][0] == 0.0
    assert_allclose(steps(50), first, rtol=0.0, atol=CLOSE * np.abs(first).max())


def test_time_set_back_after_gravity_is_no_step(new_model: Any) -> None:
    result = new_model()
    ops.timeSeries("Linear", 9)
    ops.pattern("Plain", 9, 9)
    ops.load(2, 0.0, -1.0, 0.0)
    analyse("LoadControl", 0.1, **NEWTON)
    assert ops.analyze(10) == 0
    ops.loadConst("-time", 0.0)
    ops.wipeAnalysis()
    assert result.states()[0].response["clock"][0] == pytest.approx(1.0)
    shake()
    x, force = steps(50).T
    expected, _ = followed(np.append(np.zeros(10), x), np.repeat([0.1, DT], [10, 50]))
    assert result.states()[0].response["clock"][0] == pytest.approx(1.0 + 50 * DT)
    assert_allclose(force, expected[10:], rtol=0.0, atol=CLOSE * np.abs(expected).max())


def test_a_failed_step_leaves_no_trace(new_model: Any) -> None:
    new_model()
    shake()
    first = steps(30)
    ops.test("NormDispIncr", 1e-30, 2)
    assert ops.analyze(1, DT) != 0
    ops.test("NormDispIncr", 1e-12, 30)
    x, force = np.concatenate([first, steps(4, DT / 2)]).T
    expected = followed(x, np.repeat([DT, DT / 2], [30, 4]))[0]
    assert_allclose(force, expected, rtol=0.0, atol=CLOSE * np.abs(expected).max())


def static(goals: list[tuple[float, float]]) -> np.ndarray:
    """Displacement [mm] and force [kN] under displacement control, to goals [mm] by steps [m]."""
    ops.timeSeries("Linear", 9)
    ops.pattern("Plain", 9, 9)
    ops.load(2, 1.0, 0.0, 0.0)
    analyse("LoadControl", 0.0, **NEWTON)
    rows = []
    for goal, step in goals:
        ops.integrator("DisplacementControl", 2, 1, step)
        while abs(1e3 * ops.nodeDisp(2, 1) - goal) > 0.5:
            rows.append(steps(1)[0])
    return np.array(rows)


def test_a_static_analysis_has_the_rate_that_is_given(new_model: Any) -> None:
    result = new_model(rate=2.0, count=3)
    x, force = static([(30, 0.001), (-30, -0.001), (0, 0.001)]).T
    assert len(x) == 120
    expected = 3.0 * followed(x, dt=0.5)[0]
    assert_allclose(force, expected, rtol=0.0, atol=CLOSE * np.abs(expected).max())
    assert result.states()[0].response["clock"][0] == pytest.approx(60.0)


def test_a_load_factor_that_falls_is_no_time(
    new_model: Any, capfd: pytest.CaptureFixture[str]
) -> None:
    new_model()
    static([(5, 0.001)])
    ops.integrator("DisplacementControl", 2, 1, -0.001)
    assert ops.analyze(1) != 0
    assert "rate" in capfd.readouterr().err


def test_zero_of_the_model_is_where_the_bearing_starts() -> None:
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    ops.node(1, 0.0)
    ops.node(2, 0.0)
    ops.fix(1, 1)
    start = tb.element(BEARING, ambient=-20)
    start.set_trial(12.0, dt=10.0)
    start.commit()
    add_material(ops, 7, start)
    force = start.set_trial(12.0, dt=SHORTEST_STEP).force
    ops.element("zeroLength", 1, 1, 2, "-mat", 7, "-dir", 1)
    assert ops.basicForce(1)[0] == pytest.approx(force, rel=1e-9)
    assert force > 50.0
    ops.wipe()


def test_initial_stiffness_is_that_of_the_first_moment(new_model: Any) -> None:
    new_model()
    frequency = np.sqrt(ops.eigen("-fullGenLapack", 1)[0])
    first = tb.element(BEARING, ambient=-20).set_trial(0.0, dt=SHORTEST_STEP)
    assert frequency == pytest.approx(np.sqrt(first.tangent * 1e6 / MASS), rel=1e-9)


def test_what_cannot_be_added_is_an_error(
    new_model: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    new_model()
    bearing = tb.element(BEARING, ambient=-20)
    with pytest.raises(tb.InputError) as result:
        add_material(ops, 7, bearing)
    assert "7" in str(result.value)
    for options in ({"count": 0}, {"rate": -1.0}, {"units": "N-stone"}):
        with pytest.raises(tb.InputError) as result:
            write_material(tmp_path / "file", bearing, **options)
        assert next(iter(options)) in str(result.value)
    assert not (tmp_path / "file").exists()
    whole = material._pack
    for cut, word in (
        (lambda c: c[:-1], "whole"),
        (lambda c: c.replace(b".so\0", b".no\0"), ".no"),
    ):
        monkeypatch.setattr(
            material, "_pack", lambda *a, cut=cut: (cut(whole(*a)[0]), whole(*a)[1])
        )
        with pytest.raises(tb.InputError) as result:
            add_material(ops, 8, bearing)
        assert word in str(result.value)


@pytest.mark.parametrize("wrong", [False, True])
def test_a_program_that_loads_materials_by_name(wrong: bool, folder: Path, tmp_path: Path) -> None:
    """As xara does: other names of functions than in openseespy, arguments by its own functions."""
    file = write_material(tmp_path / "pier", tb.element(BEARING, ambient=-20), units="N-m")
    source = Path(__file__).parents[1] / "fixtures" / "opensees_host.c"
    # Without -O, zig would first build its checks of undefined behaviour, for 16 CPU s.
    flags = ("-O1", "-Wall", "-Werror", "-rdynamic", "-o", "host")
    subprocess.run([*c_compiler(), *flags, str(source), "-ldl"], cwd=tmp_path, check=True)
    done = subprocess.run(
        [tmp_path / "host", file, *(["wrong"] if wrong else [])],
        env={"LD_LIBRARY_PATH": str(folder)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == (3 if wrong else 0), done.stderr
    if wrong:
        assert "10getTangent" in done.stderr
        return
    *rows, strain = map(float, done.stdout.split())
    one, copy = 1e-3 * np.reshape(rows, (3, 2)).T
    assert_allclose(one, followed([10.0, 20.0, 30.0], 0.1)[0], rtol=CLOSE)
    assert_allclose(copy, followed([0.0, 10.0, 20.0], 0.1)[0], rtol=CLOSE, atol=CLOSE)
    assert strain == pytest.approx(3 * 0.03)
