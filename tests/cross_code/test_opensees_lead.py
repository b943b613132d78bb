"""Lead heating against LeadRubberX of OpenSees: the same core, the same motion, while it heats.

OpenSees knows one lead temperature above an ambient that never changes, so it is compared with
our `lead-alone` model. Its motion must be imposed with velocities (MultipleSupport), its clock
counts from domain time zero, and its cooling runs at half the rate of its own equations: only
the heating is compared, from time zero.
"""

import numpy as np
from numpy.typing import NDArray

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.opensees import needs_opensees
from tests.reference.opensees_lead import lead_rubber_x, stiff_example

pytestmark = needs_opensees

AMPLITUDE, PERIOD, CYCLES, DT = 160.0, 4.0, 3, 0.005  # mm, s
AMBIENT = 20.0  # degC, where the strength is that of the file
Floats = NDArray[np.float64]


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
