"""Structures and lead heating against OpenSees.

OpenSees knows one lead temperature above an ambient that never changes, so it is compared with
our `lead-alone` model. Its motion must be imposed with velocities (MultipleSupport), its clock
counts from domain time zero, and its cooling runs at half the rate of its equations: only
the heating is compared, from time zero.
"""

import numpy as np
import pytest

import thermobearing as tb
from benchmarks.opensees_pier_figure import draw
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.opensees import needs_opensees, ops
from tests.quick import quick_cases
from tests.reference.opensees_lead import lead_rubber_x, stiff_example
from tests.reference.opensees_p_delta import Pier, push
from tests.reference.opensees_p_delta import shake as shake_pier
from tests.reference.opensees_pier import build, compare, spring_bearing
from tests.verification.structures import linear_bearing, read_ground, shaken
from tests.verification.test_devices import HEIGHT, LOAD, MASS, TOP_MASS, TURN, pier
from thermobearing.core.types import Floats
from thermobearing.structure.fields import GRAVITY
from thermobearing.structure.matrices import total_stiffness
from thermobearing.structure.run import prepare_structure

pytestmark = needs_opensees

DT = 0.005


@pytest.mark.parametrize("name", ["pier-p1", "hybrid-pier"])
@pytest.mark.parametrize("kind", quick_cases(["linear", "bilinear"], 1))
def test_structure_against_opensees(name: str, kind: str, measured: Recorder) -> None:
    ours, theirs = compare(name, kind)
    for quantity, values in ours.items():
        reference = theirs[quantity]
        largest = np.abs(reference).max()
        peak = abs(np.abs(values).max() / largest - 1.0)
        whole = np.abs(values - reference).max() / largest
        assert peak < tol.OPENSEES_PEAK, quantity
        assert whole < tol.OPENSEES_HISTORY, quantity
        measured(
            f"{name}, {kind} bearings, {quantity} against OpenSees: peak, complete history",
            f"{peak:.1e}, {whole:.1e}",
            f"{tol.OPENSEES_PEAK:g}, {tol.OPENSEES_HISTORY:g}",
        )


def test_periods_of_pier_p1_against_opensees(measured: Recorder) -> None:
    ground: Floats = np.zeros(3)
    prepared, _ = shaken("pier-p1", linear_bearing(2.6153), ground, DT)
    build(prepared, spring_bearing(2.6153, 5), ground, DT, (0.0, 0.0))
    theirs = 2.0 * np.pi / np.sqrt(np.array(ops.eigen("-fullGenLapack", 4)))
    ops.wipe()
    worst = float(np.abs(prepared.modes.periods / theirs - 1.0).max())
    assert worst < tol.OPENSEES_PERIODS
    measured(
        "four periods of pier P1 against OpenSees", f"{worst:.1e}", f"{tol.OPENSEES_PERIODS:g}"
    )


def test_figure_of_both() -> None:
    """The figure of docs/verification.md is drawn from the same runs."""
    assert len(draw("hybrid-pier", "bilinear").axes) == 4


BEARING = 4.0  # kN/mm
WITH_GRAVITY = Pier(HEIGHT, TURN, BEARING, LOAD, GRAVITY * TOP_MASS)


@pytest.fixture(scope="module")
def pushed() -> dict[float, Floats]:
    """Deck and pier under horizontal forces on the deck, OpenSees over here."""
    prepared = prepare_structure(pier(p_delta=True))
    stiffness = total_stiffness(prepared.structure, prepared.matrices, np.array([BEARING]))
    return {
        force: np.array(push(WITH_GRAVITY, force)) / np.linalg.solve(stiffness, [force, 0.0])
        for force in (400.0, 800.0, 1600.0)
    }


def test_pier_with_gravity_is_pushed(pushed: dict[float, Floats], measured: Recorder) -> None:
    """Gravity in the displaced position of OpenSees against its second derivatives here."""
    off = float(np.abs(pushed[400.0] - 1.0).max())
    assert off < tol.OPENSEES_P_DELTA
    measured(
        "P-delta: pier and deck pushed to a drift of 1 % against OpenSees",
        f"{off:.1e}",
        f"{tol.OPENSEES_P_DELTA:g}",
    )
    # Without gravity they would move less by far more than the difference.
    plain = prepare_structure(pier(p_delta=False))
    stiffness = total_stiffness(plain.structure, plain.matrices, np.array([BEARING]))
    deck, turned = np.linalg.solve(stiffness, [400.0, 0.0])
    theirs = push(WITH_GRAVITY, 400.0)
    assert theirs[0] > 1.2 * deck
    assert theirs[1] > 1.5 * turned
    without = np.array(push(WITH_GRAVITY._replace(load=0.0, weight=0.0), 400.0))
    assert np.abs(without / (deck, turned) - 1.0).max() < tol.OPENSEES_P_DELTA


def test_difference_of_pushed_piers_is_that_of_finite_angles(pushed: dict[float, Floats]) -> None:
    """Cosines of rotations, of the second order: twice the angle gives four times as much."""
    first, second, third = pushed.values()
    assert (third - second) / (second - first) == pytest.approx([4.0, 4.0], rel=0.1)


def test_pier_with_gravity_in_an_earthquake(measured: Recorder) -> None:
    ground = 0.3 * read_ground("jra-ii-i-1", DT, 15.0)
    histories = []
    for p_delta in (True, False):
        _, history = shaken(pier(p_delta=p_delta), linear_bearing(BEARING), ground, DT)
        histories.append(history.rows.q[1:])
    theirs = shake_pier(WITH_GRAVITY, (MASS, TOP_MASS), ground, DT)
    largest = np.abs(theirs).max(axis=0)
    off, effect = (np.abs(q - theirs).max(axis=0) / largest for q in histories)
    assert off.max() < tol.OPENSEES_P_DELTA_HISTORY
    assert effect.min() > 0.3
    measured(
        "P-delta: displacement of deck, rotation of pier in an earthquake against OpenSees",
        f"{off[0]:.1e}, {off[1]:.1e}",
        f"{tol.OPENSEES_P_DELTA_HISTORY:g}",
    )


AMPLITUDE, PERIOD, CYCLES = 160.0, 4.0, 3  # mm, s
AMBIENT = 20.0  # degC, where the strength is that of the file


def motion() -> tuple[Floats, Floats, Floats]:
    """Displacement, velocity and acceleration [mm, s] at the steps, from zero."""
    t = np.arange(0.0, PERIOD * CYCLES + DT / 2, DT)
    w = 2.0 * np.pi / PERIOD
    return (
        AMPLITUDE * np.sin(w * t),
        AMPLITUDE * w * np.cos(w * t),
        -AMPLITUDE * w**2 * np.sin(w * t),
    )


def test_lead_temperature_and_strength_while_heating(measured: Recorder) -> None:
    test = tb.CyclicTest(
        dt=DT,
        steps=[
            {
                "step": "cycles",
                "amplitude": AMPLITUDE,
                "wave": "sine",
                "period": PERIOD,
                "count": CYCLES,
            }
        ],
    )
    bearing = stiff_example()
    ours = tb.run(bearing, test, ambient=AMBIENT, model="lead-alone")
    rise = ours["lead_temperature"].values[0, 1:] - AMBIENT
    theirs, strength = lead_rubber_x(bearing, motion(), DT)
    assert theirs[-1] > 30.0, "LeadRubberX did not heat: nothing was compared"
    hot = theirs > 0.2 * theirs[-1]
    off = float(np.abs(rise[hot] / theirs[hot] - 1.0).max())
    lead = bearing.lead
    assert lead is not None
    ours_strength = lead.core_strength * np.exp(-lead.softening * rise)
    weaker = float(np.abs(ours_strength[hot] / strength[hot] - 1.0).max())
    measured("lead rise against OpenSees LeadRubberX while heating", f"{off:.2%}", "2 %")
    measured("lead strength against OpenSees LeadRubberX while heating", f"{weaker:.2%}", "2 %")
    assert off <= tol.OPENSEES_LEAD
    assert weaker <= tol.OPENSEES_LEAD
