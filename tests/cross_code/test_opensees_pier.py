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
from tests.reference.opensees_pier import build, compare, spring_bearing
from tests.verification.structures import linear_bearing, shaken
from thermobearing.core.types import Floats

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
