"""Structures in plan in earthquakes: lines as a special case, turned plans, energy, exactness."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests import tolerances as tol
from tests.conftest import Recorder
from tests.verification.structures import (
    energy_residual,
    exact_linear,
    linear_bearing,
    read_ground,
    real_bearing,
    shaken,
)
from tests.verification.test_plane import turned
from tests.verification.test_structures_in_plan import eccentric_deck
from thermobearing.core.types import Floats
from thermobearing.structure import run
from thermobearing.structure.model import DIRECTIONS, Structure, along, load_structure

DT = 0.005
BEARINGS = ["shen-hdr-bridge", "shen-lhdr-bridge"]


def pair(duration: float, scale: float = 1.0) -> Floats:
    """Two standard motions, one in each direction [steps + 1, 2]."""
    names = ("jra-ii-i-1", "jra-ii-i-2")
    return scale * np.stack([read_ground(name, DT, duration) for name in names], axis=-1)


def pier_in_plan() -> Structure:
    """Pier P1, the same in both directions."""
    return load_structure("pier-p1").model_copy(update={"plan": True})


@pytest.mark.parametrize("name", BEARINGS)
def test_a_plan_in_one_direction_is_the_line(
    name: str, measured: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The motion across is zero to the bit; along, the bearing rounds otherwise than on a line.

    Iterations go on further than usual: the last one moves as much as the usual tolerance says.
    """
    monkeypatch.setattr(run, "TOLERANCE", 1e-12)
    constants, ground = real_bearing(name), read_ground("jra-ii-i-1", DT, 12.0)
    _, line = shaken("pier-p1", constants, ground, DT, damping="element")
    worst = 0.0
    for axis, way in enumerate(DIRECTIONS):
        both = np.zeros((len(ground), 2))
        both[:, axis] = ground
        prepared, plan = shaken(pier_in_plan(), constants, both, DT, damping="element")
        mine = [n.endswith(f" {way}") for n in prepared.matrices.coordinates]
        for result, wanted in zip(plan.rows[1:3], line.rows[1:3], strict=True):
            worst = max(worst, np.abs(result[:, mine] - wanted).max() / np.abs(wanted).max())
            assert not result[:, np.logical_not(mine)].any()
        force = plan.bearing()["force"]
        assert not force[:, 1 - axis].any()
        assert_allclose(force[:, axis], line.bearing()["force"], atol=1e-9)
        assert_allclose(plan.layers(), line.layers(), atol=1e-9)
    measured(
        f"pier P1 in plan, shaken in one direction, {name}: difference from the line",
        f"{worst:.1e}",
        f"{tol.PLAN_LINE:g}",
    )
    assert worst < tol.PLAN_LINE


def turned_deck(angle: float) -> Structure:
    """A deck with an eccentric mass on four lines, turned about the origin."""
    deck = eccentric_deck()

    def moved(part: Any) -> Any:
        x, y = turned(np.array([deck.point(part)]), angle)[0]
        return part.model_copy(update={"x": float(x), "y": float(y)})

    changes = {
        "masses": [moved(mass) for mass in deck.masses],
        "bearings": [moved(line) for line in deck.bearings],
    }
    return deck.model_copy(update=changes)


@pytest.mark.parametrize("name", BEARINGS)
def test_a_turned_plan_moves_as_turned(name: str, measured: Recorder) -> None:
    constants, ground = real_bearing(name), 0.5 * pair(10.0)
    _, first = shaken(turned_deck(0.0), constants, ground, DT)
    largest = np.abs(first.bearing()["force"]).max()
    worst = 0.0
    for angle in (0.7, 0.5 * math.pi, 4.0):
        _, other = shaken(turned_deck(angle), constants, turned(ground, angle), DT)
        for line in range(4):
            wanted = turned(np.asarray(first.bearing(line)["force"]), angle)
            apart = np.abs(other.bearing(line)["force"] - wanted).max()
            worst = max(worst, float(apart / largest))
        assert_allclose(other.rows.q[:, 2], first.rows.q[:, 2], atol=1e-12)
    measured(f"a turned plan, {name}: force, of the peak", f"{worst:.1e}", f"{tol.PLANE_TURNED:g}")
    assert worst < tol.PLANE_TURNED


def test_uncoupled_directions_are_two_runs(measured: Recorder) -> None:
    """On linear bearings the directions do not feel each other, though hinges yield in both."""
    ground, linear = pair(15.0, 1.5), linear_bearing(2.6)
    prepared, both = shaken(pier_in_plan(), linear, ground, DT)
    worst, bent = 0.0, []
    for axis, way in enumerate(DIRECTIONS):
        _, single = shaken(along(pier_in_plan(), way), linear, ground[:, axis].copy(), DT)
        mine = [n.endswith(f" {way}") for n in prepared.matrices.coordinates]
        apart = np.abs(both.rows.q[:, mine] - single.rows.q).max()
        worst = max(worst, float(apart / np.abs(single.rows.q).max()))
        bent.append(np.abs(single.hinge()["rotation"]).max())
    measured("two uncoupled directions, of the peak", f"{worst:.1e}", f"{tol.SAME_MOTION:g}")
    assert worst < tol.SAME_MOTION
    assert min(bent) > prepared.structure.hinges[0].yield_rotation


@pytest.mark.parametrize("name", BEARINGS)
def test_energy_of_a_pier_in_plan(name: str, measured: Recorder) -> None:
    """Input = kinetic + damping + springs + hinges + bearings, with yielding piers."""
    prepared, history = shaken(pier_in_plan(), real_bearing(name), pair(15.0, 1.5), DT)
    assert history.outcome == "completed"
    rotations = np.abs(history.rows.hinges["rotation"]).max(axis=0)
    assert rotations.max() > prepared.structure.hinges[0].yield_rotation
    left = energy_residual(history)
    measured(f"energy balance of pier P1 in plan, {name}, of the input", f"{left:.1e}", "1e-10")
    assert left < tol.PLAN_BALANCE
    work = 5.0 * history.bearing()[-1].work_in
    assert_allclose(history.rows.energies[-1].bearings, work, rtol=tol.LOOP)


def test_eccentric_linear_deck_against_its_exact_solution(measured: Recorder) -> None:
    """Free vibration after a push in both directions: second order in time."""
    deck = eccentric_deck()
    linear = linear_bearing(deck.bearings[0].equivalent_stiffness)
    t = np.array([0.0, 0.24, 0.48, 6.0])
    errors = []
    for dt in (0.02, 0.01, 0.005):
        time = dt * np.arange(round(t[-1] / dt) + 1)
        push = np.interp(time, t, [0.0, 4000.0, 0.0, 0.0])
        ground = push[:, None] * [0.6, 1.0]
        prepared, history = shaken(deck, linear, ground, dt)
        # The tangent is exact: one step of Newton's method, and a look at what is left.
        assert history.iterations <= 2 * history.steps
        exact = exact_linear(prepared, prepared.predictor, ground, dt)
        assert np.abs(exact[:, 2]).max() > 4e-3  # rad: the ends of the deck move by 40 mm
        errors.append(np.abs(history.rows.q - exact).max(axis=0) / np.abs(exact).max(axis=0))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])[-1]
    measured(
        "eccentric deck in free vibration: order in time, error at 5 ms",
        f"{orders.min():.3f}, {errors[-1].max():.1e}",
        f"2 +- {tol.NEWMARK_ORDER:g}",
    )
    assert np.abs(orders - 2.0).max() < tol.NEWMARK_ORDER


def test_the_predictor_has_no_plan() -> None:
    with pytest.raises(ValueError, match="predictor-corrector"):
        shaken(pier_in_plan(), linear_bearing(2.6), pair(0.1), DT, method="predictor-corrector")
