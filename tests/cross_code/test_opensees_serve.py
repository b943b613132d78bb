"""Bearings as elements of OpenSees models, against our own integrators."""

import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.opensees import analyse, needs_opensees, ops
from tests.reference.opensees_pier import compare_bearings
from tests.verification.structures import follow, read_ground, real_bearing
from thermobearing.core.types import Floats
from thermobearing.opensees.case import linear_stiffness
from thermobearing.opensees.line import Line, serve
from thermobearing.structure.model import load_structure

pytestmark = needs_opensees

BEARING, AMBIENT = "shen-hdr-bridge", -20.0
MASS, DT = 785 / 9810, 0.01  # kN s2/mm, s
GROUND = read_ground("jra-ii-i-1", DT, 12.0)
PLAIN = {"constraints": "Plain", "system": "FullGeneral"}


@pytest.fixture(scope="module")
def line() -> Iterator[Line]:
    """A server that several tests share, each with an own tag."""
    with serve(BEARING, ambient=AMBIENT) as made:
        yield made
        ops.wipe()


def one_mass(arguments: tuple[object, ...], scale: float = 1.0) -> None:
    """A mass on a bearing under a ground motion, ready to be analysed."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    ops.node(1, 0.0)
    ops.node(2, 0.0, "-mass", MASS)
    ops.fix(1, 1)
    ops.element(*arguments)
    ops.timeSeries("Path", 1, "-dt", DT, "-values", *(scale * GROUND))
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    analyse(tolerance=1e-11, **PLAIN)


def shake(steps: int) -> Floats:
    """Displacement of the mass after each step."""
    result = []
    for _ in range(steps):
        assert ops.analyze(1, DT) == 0
        result.append(ops.nodeDisp(2, 1))
    return np.array(result)


def own(ground: Floats) -> tuple[Floats, tb.BearingElement]:
    """The same with Newmark's method here."""
    bearing = tb.element(BEARING, ambient=AMBIENT)
    x = v = a = 0.0
    result = []
    for acceleration in ground[1:]:
        new = x
        for _ in range(50):
            mine = 4.0 * (new - x - DT * v) / DT**2 - a
            trial = bearing.set_trial(new, dt=DT)
            residual = -MASS * (mine + acceleration) - trial.force
            step = residual / (4.0 * MASS / DT**2 + trial.tangent)
            new += step
            if abs(step) < 1e-11:
                break
        bearing.set_trial(new, dt=DT)
        bearing.commit()
        v, a, x = 2.0 * (new - x) / DT - v, 4.0 * (new - x - DT * v) / DT**2 - a, new
        result.append(x)
    return np.array(result), bearing


@pytest.fixture(scope="module")
def expected() -> tuple[Floats, tb.BearingElement]:
    return own(GROUND)


def off(result: Floats, right: Floats) -> float:
    return float(np.abs(result - right).max() / np.abs(right).max())


@pytest.mark.thorough
def test_one_mass_against_our_integrator(
    line: Line, expected: tuple[Floats, tb.BearingElement], measured: Recorder, tmp_path: Path
) -> None:
    right, bearing = expected
    one_mass(line.element(1, (1, 2)))
    actual = shake(len(right))
    result = line.results()
    error = off(actual, right)
    assert error < tol.OPENSEES_SERVED
    measured("one mass on a served bearing in OpenSees", f"{error:.1e}", f"{tol.OPENSEES_SERVED:g}")
    assert off(result["displacement"].values[0, 1:], right) < tol.OPENSEES_SERVED
    warm = result["final_temperature"].values[0]
    assert np.abs(warm - bearing.state.temperature).max() < 1e-8
    assert result.energy["mechanical_residual"][0] < 1e-12
    assert result.outcome == "completed"
    saved = result.save(tmp_path / "served")
    again = tb.load_result(saved)
    assert (again["force"].values == result["force"].values).all()
    assert [f.name for f in tb.make_report(saved, pdf=False)] == ["report.html"]
    assert (saved / "figures" / "elements.png").exists()


def test_units_of_the_model_and_bearings_side_by_side(
    expected: tuple[Floats, tb.BearingElement],
) -> None:
    right, count = expected[0][:300], 3
    with serve(BEARING, ambient=AMBIENT, count=count, units="N-m") as line:
        ops.wipe()
        ops.model("basic", "-ndm", 2, "-ndf", 3)
        ops.node(1, 0.0, 0.0)
        ops.node(2, 0.0, 0.0, "-mass", count * MASS * 1e6, 0.0, 0.0)  # kg
        ops.fix(1, 1, 1, 1)
        ops.fix(2, 0, 1, 1)
        ops.element(*line.element(7, (1, 2)))
        ops.timeSeries("Path", 1, "-dt", DT, "-values", *(GROUND / 1e3))
        ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
        analyse(tolerance=1e-14, **PLAIN)
        result = 1e3 * shake(len(right))
        shear = 1e-3 * ops.eleForce(7)[3] / count
        ops.wipe()
        force = line.results()["force"].values[0, -1]
    assert off(result, right) < tol.OPENSEES_SERVED
    assert shear == pytest.approx(force, rel=1e-12)  # on the upper node, of one bearing


@pytest.mark.thorough
def test_pier_p1_against_our_structure(measured: Recorder) -> None:
    count = load_structure("pier-p1").bearings[0].count
    with serve(BEARING, ambient=AMBIENT, count=count, units="N-m") as line:

        def make(tag: int, lower: int, upper: int) -> None:
            ops.element(*line.element(tag, (lower, upper)))

        ours, theirs = compare_bearings("pier-p1", real_bearing(BEARING), make)
    for quantity, values in ours.items():
        peak = abs(np.abs(theirs[quantity]).max() / np.abs(values).max() - 1.0)
        assert peak < tol.OPENSEES_SERVED_PIER, quantity
        measured(
            f"pier P1 on served bearings, peak of {quantity} against our structure",
            f"{peak:.1e}",
            f"{tol.OPENSEES_SERVED_PIER:g}",
        )


def test_a_second_model_and_a_reset_begin_again(line: Line) -> None:
    """`wipe` and a model of the same tag; `reset`, which OpenSees does not send."""
    one_mass(line.element(2, (1, 2)))
    first = shake(60)
    one_mass(line.element(2, (1, 2)))
    assert (shake(60) == first).all()
    ops.reset()
    assert (shake(60) == first).all()
    ops.wipe()
    data = line.results().dataset
    mine = data["element"].values[data["tag"].values == 2].tolist()
    assert mine == ["2, run 1", "2, run 2", "2, run 3"]


def test_failed_steps_and_substeps_leave_no_trace(line: Line) -> None:
    """Steps that do not converge are repeated in halves; the bearing forgets the attempts."""
    one_mass(line.element(3, (1, 2)), scale=2.0)
    ops.test("NormDispIncr", 1e-11, 3)
    path = [(0.0, 0.0)]
    for _ in range(250):
        for part in (1, 2, 4, 16):
            failed = ops.analyze(1, DT / part)
            if not failed:
                break
        assert not failed
        path.append((ops.getTime(), ops.nodeDisp(2, 1)))
    data = line.results().dataset
    (run,) = np.flatnonzero(data["tag"].values == 3)
    ops.wipe()
    times = np.array(path)[:, 0]
    assert len(np.unique(np.diff(times).round(6))) > 1, "no step failed"
    forces, _ = follow(tb.element(BEARING, ambient=AMBIENT), np.array(path)[1:, 1], np.diff(times))
    served = data["force"].values[run, 1 : len(path)]
    assert off(served, forces) < tol.OPENSEES_SERVED


def test_gravity_then_displacement_control_then_earthquake_in_space() -> None:
    """Nodes with six degrees of freedom; load factors are no clock, so that a rate is given."""
    weight, rate = 785.0, 10.0  # kN, mm/s
    with serve(BEARING, ambient=AMBIENT, rate=rate) as line:
        ops.wipe()
        ops.model("basic", "-ndm", 3, "-ndf", 6)
        ops.node(1, 0.0, 0.0, 0.0)
        ops.node(2, 0.0, 0.0, 0.0, "-mass", *[MASS] * 3, *[MASS * 1e6] * 3)
        ops.fix(1, *[1] * 6)
        ops.element(*line.element(101, (1, 2), directions=(2,), vertical=3))
        assert min(ops.eigen("-fullGenLapack", 6)) > 0.0
        ops.timeSeries("Linear", 1)
        ops.pattern("Plain", 1, 1)
        ops.load(2, 0.0, 0.0, -weight, 0.0, 0.0, 0.0)
        analyse("LoadControl", 0.1, **PLAIN)
        ops.test("NormUnbalance", 1e-8, 20)
        assert ops.analyze(10) == 0
        sinking = ops.nodeDisp(2, 3)
        ops.loadConst("-time", 0.0)
        ops.timeSeries("Linear", 2)
        ops.pattern("Plain", 2, 2)
        ops.load(2, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0)
        shears, factors = [0.0], [0.0]
        for increment in [2.0] * 15 + [-2.0] * 30 + [2.0] * 15:
            ops.integrator("DisplacementControl", 2, 2, increment)
            assert ops.analyze(1) == 0
            shears.append(ops.nodeDisp(2, 2))
            factors.append(ops.getTime())
        ops.wipe()
        result = line.results()
    known = linear_stiffness(line.case)
    assert sinking == pytest.approx(-weight / known.vertical, rel=1e-9)
    assert min(factors) < 0.0 < max(factors)
    forces, _ = follow(tb.element(BEARING, ambient=AMBIENT), shears[1:], 2.0 / rate)
    assert factors[1:] == pytest.approx(forces, rel=1e-6)
    assert result["clock"].values[0, -1] == pytest.approx(120.0 / rate)
    assert result.energy["heat_released_kN_mm"][0] > 0.5 * result.energy["work_in_kN_mm"][0]


def test_axial_force_of_a_model_in_space(measured: Recorder) -> None:
    """A dead load on a slender bearing that shakes, against a cyclic test along the same way."""
    slender = tb.new_bearing("slender", "shen-hdr", plan="350x350mm", layers="8x17mm", shim="4 mm")
    weight, steps, shears, ways = 1200.0, 400, [], [0.0]
    with serve(slender, ambient=AMBIENT, axial="node") as line:
        ops.wipe()
        ops.model("basic", "-ndm", 3, "-ndf", 6)
        ops.node(1, 0.0, 0.0, 0.0)
        ops.node(2, 0.0, 0.0, 0.0, "-mass", MASS, *[0.0] * 5)
        ops.fix(1, *[1] * 6)
        ops.fix(2, 0, 1, 0, 1, 1, 1)
        ops.element(*line.element(101, (1, 2), vertical=3))
        ops.timeSeries("Linear", 1)
        ops.pattern("Plain", 1, 1)
        ops.load(2, 0.0, 0.0, -weight, 0.0, 0.0, 0.0)
        analyse("LoadControl", 0.25, tolerance=1e-11, **PLAIN)
        assert ops.analyze(4) == 0
        ops.loadConst("-time", 0.0)
        ops.wipeAnalysis()
        ops.timeSeries("Path", 2, "-dt", DT, "-values", *GROUND)
        ops.pattern("UniformExcitation", 2, 1, "-accel", 2)
        analyse(tolerance=1e-11, **PLAIN)
        for _ in range(steps):
            assert ops.analyze(1, DT) == 0
            ways.append(ops.nodeDisp(2, 1))
            shears.append(ops.eleForce(101)[6])
        ops.wipe()
        result = line.results()
    assert result["axial_force"].values[0, -steps:] == pytest.approx(weight, rel=1e-6)
    history = DT * np.arange(steps + 1), np.array(ways)
    options = {"ambient": AMBIENT, "dt": 1.5 * DT, "axial_force": weight}
    right = tb.run(slender, history, axial="constant", **options)
    plain = tb.run(slender, history, **options)
    error = off(np.array(shears), right["force"].values[0, 1:])
    effect = off(plain["force"].values[0, 1:], right["force"].values[0, 1:])
    assert error < tol.OPENSEES_SERVED
    assert effect > 0.01
    measured("axial force of a node in OpenSees", f"{error:.1e}", f"{tol.OPENSEES_SERVED:g}")


INTERRUPTED = """
import signal, sys
from tests.cross_code.test_opensees_serve import *
signal.signal(signal.SIGINT, lambda *_: None)
with serve(BEARING, ambient=AMBIENT) as line:
    one_mass(line.element(1, (1, 2)))
    print("start", flush=True)
    print("analysed", ops.analyze(50, DT / 4), flush=True)
    ops.wipe()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
"""


def test_signals_lose_no_bytes_of_an_answer() -> None:
    """A receiving call that a signal interrupts would leave OpenSees waiting for ever."""
    words = [sys.executable, "-c", INTERRUPTED]
    done = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    assert done.stdout is not None
    assert done.stdout.readline() == "start\n"
    end = time.monotonic() + 20.0
    while done.poll() is None and time.monotonic() < end:
        done.send_signal(signal.SIGINT)
        time.sleep(0.002)
    done.kill()
    assert done.communicate()[0] == "analysed 0\n"


KILLED = """
import sys
from tests.cross_code.test_opensees_serve import *
with serve(BEARING, ambient=AMBIENT) as line:
    one_mass(line.element(1, (1, 2)))
    shake(20)
    line._process.kill()
    print("failed", [ops.analyze(1, DT) for _ in range(3)], flush=True)
"""


@pytest.mark.thorough
def test_a_killed_server_ends_the_analysis_with_a_message() -> None:
    done = subprocess.run(
        [sys.executable, "-c", KILLED], capture_output=True, text=True, timeout=60, check=False
    )
    assert "failed [-3, -3, -3]" in done.stdout
    assert "receives NaN" in done.stderr
    assert "ServingError: the server of the bearings has ended" in done.stderr
    assert done.returncode == 1


@pytest.mark.thorough
def test_two_interpreters_side_by_side() -> None:
    code = KILLED.replace("    line._process.kill()\n", "")
    both = [
        subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
        for _ in range(2)
    ]
    for one in both:
        out, _ = one.communicate(timeout=60)
        assert "failed [0, 0, 0]" in out
