"""A pier with gravity in OpenSees: rigid bodies that turn by finite angles (units kN, mm, s).

Loads are vertical and elements corotational, so that P-delta follows from equilibrium in the
displaced position. The bearing slides along a plate that turns by the mean of the rotations of its
two ends: the deck, which does not turn, sinks by the sway times half of the rotation of the pier,
and half of the moment of load and sway acts on either end.
"""

from typing import NamedTuple

import numpy as np

from tests.opensees import analyse, ops
from thermobearing.core.types import Floats

RIGID = 1e3, 1e14  # modulus and second moment of area of bodies
ARM = 500.0  # length of the sliding plate: its stiffness in tension is that of the bearing
GROUND, FOOT, TOP, PLATE, EDGE, DECK, LEVER, PIVOT = range(1, 9)
PENALTY = 1e14
SYSTEM = {"system": "FullGeneral", "constraints": ("Penalty", PENALTY, PENALTY)}


class Pier(NamedTuple):
    """A rigid pier on a rotational spring, with a deck on a bearing on its top."""

    height: float
    turn: float  # of the spring [kN mm/rad]
    bearing: float  # [kN/mm]
    load: float  # dead load of the bearing [kN]
    weight: float  # of the pier, at its top [kN]


def build(pier: Pier) -> None:
    """Make the model, and let gravity act."""
    top = pier.height
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    for node in (GROUND, FOOT, PIVOT):
        ops.node(node, 0.0, 0.0)
    for node in (TOP, PLATE, DECK):
        ops.node(node, 0.0, top)
    ops.node(EDGE, -ARM, top)
    ops.node(LEVER, 2.0, 0.0)
    ops.fix(GROUND, 1, 1, 1)
    ops.fix(FOOT, 1, 1, 0)
    ops.equalDOF(TOP, PLATE, 1, 2)
    # A lever of two units, of which one end rises by the rotation of the pier, turns by half of it.
    ops.fix(PIVOT, 1, 1, 0)
    ops.fix(LEVER, 1, 0, 0)
    ops.equalDOF_Mixed(TOP, LEVER, 1, 3, 2)
    ops.equalDOF(LEVER, PLATE, 3)
    ops.uniaxialMaterial("Elastic", 1, pier.turn)
    ops.element("zeroLength", 1, GROUND, FOOT, "-mat", 1, "-dir", 6)
    ops.geomTransf("Corotational", 1)
    ops.geomTransf("Linear", 2)
    slides = pier.bearing * ARM / RIGID[0]
    ops.element("elasticBeamColumn", 2, FOOT, TOP, 1e6, *RIGID, 1)
    ops.element("elasticBeamColumn", 3, PLATE, EDGE, 1e6, *RIGID, 1)
    ops.element("elasticBeamColumn", 4, EDGE, DECK, slides, *RIGID, 1)
    ops.element("elasticBeamColumn", 5, PIVOT, LEVER, 1.0, *RIGID, 2)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    ops.load(DECK, 0.0, -pier.load, 0.0)
    ops.load(TOP, 0.0, -pier.weight, 0.0)
    analyse("LoadControl", 0.1, tolerance=1e-8, **SYSTEM)
    assert ops.analyze(10) == 0
    ops.loadConst("-time", 0.0)
    ops.wipeAnalysis()


def _moved() -> tuple[float, float]:
    """Displacement of the deck [mm] and rotation of the pier [rad], towards the deck."""
    return ops.nodeDisp(DECK, 1), -ops.nodeDisp(FOOT, 3)


def push(pier: Pier, force: float, steps: int = 20) -> tuple[float, float]:
    """Deck and pier under a horizontal force on the deck [kN]."""
    build(pier)
    ops.timeSeries("Linear", 2)
    ops.pattern("Plain", 2, 2)
    ops.load(DECK, 1.0, 0.0, 0.0)
    analyse("LoadControl", force / steps, tolerance=1e-8, **SYSTEM)
    assert ops.analyze(steps) == 0
    moved = _moved()
    ops.wipe()
    return moved


def shake(pier: Pier, masses: tuple[float, float], ground: Floats, dt: float) -> Floats:
    """Deck and pier in time; masses of the deck and of the top of the pier [kN s2/mm]."""
    build(pier)
    for node, mass in zip((DECK, TOP), masses, strict=True):
        ops.mass(node, mass, 0.0, 0.0)
    ops.timeSeries("Path", 2, "-dt", dt, "-values", *ground, 0.0)
    ops.pattern("UniformExcitation", 2, 1, "-accel", 2)
    analyse(tolerance=1e-8, **SYSTEM)
    rows = []
    for _ in range(len(ground) - 1):
        assert ops.analyze(1, dt) == 0
        rows.append(_moved())
    ops.wipe()
    return np.array(rows)
