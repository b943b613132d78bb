"""LeadRubberX of OpenSees with its lead heating on, under an imposed motion.

Units are N, m, s inside, kN and mm outside. Motion must come with velocities (MultipleSupport):
an imposed displacement alone leaves the nodal velocity, and so the heat, at zero.
"""

import numpy as np
from numpy.typing import NDArray

import thermobearing as tb
from tests.opensees import analyse, ops

Floats = NDArray[np.float64]
STIFF = 165.0  # kN/mm: so stiff that yielding is sharp in both (Bouc-Wen there, bilinear here)


def stiff_example() -> tb.Bearing:
    example = tb.load_bearing("lrb-example")
    assert example.lead is not None
    return example.model_copy(update={"lead": example.lead.model_copy(update={"stiffness": STIFF})})


def _element(b: tb.Bearing) -> None:
    g, lead = b.geometry, b.lead
    assert lead is not None
    assert g.plan.shape == "circular"
    area = b.area - b.lead_area
    shear = b.hysteresis.layer_stiffness * g.rubber_thickness / area * 1e9  # kN/mm2 -> Pa
    elastic = b.hysteresis.layer_stiffness / g.rubber_layers
    strength = [lead.core_strength * 1e3, elastic / (STIFF + elastic), shear, 2e9]
    size = [lead.diameter, g.plan.diameter, g.shim_thickness, g.rubber_thickness]
    axes = [0.0, 0.0, 1.0, 1.0, 0.0, 0.0]
    vertical = [10.0, 0.5, 1.0, 0.5, 0.0, 0.0, 0.0]  # cavitation, shear distance, mass, damping
    heat = [11200.0, 130.0, 50.0, 1.41e-5]  # of lead and steel
    switches = [0, 0, 0, 0, 1]  # the last: lead heats
    metres = [value / 1e3 for value in size]
    numbers = [*strength, *metres, g.rubber_layers, *axes, *vertical, *heat, *switches]
    ops.element("LeadRubberX", 1, 1, 2, *numbers)


def lead_rubber_x(
    b: tb.Bearing, motion: tuple[Floats, Floats, Floats], dt: float, start: float = 0.0
) -> tuple[Floats, Floats]:
    """Lead temperature rise [K] and strength [kN] after each step of an imposed motion.

    `motion` is displacement, velocity, acceleration [mm, s] at steps of dt [s] from zero; `start`
    is the time of the domain at which it begins [s].
    """
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    ops.node(1, 0.0, 0.0, 0.0)
    ops.node(2, 0.0, 0.0, 0.0)
    ops.fix(1, 1, 1, 1, 1, 1, 1)
    ops.fix(2, 0, 1, 0, 1, 1, 1)  # the free height is the one equation that OpenSees needs
    ops.mass(2, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0)
    _element(b)
    ops.setTime(start)
    for tag, values in enumerate(motion, 1):
        ops.timeSeries("Path", tag, "-dt", dt, "-values", *(values / 1e3), "-startTime", start)
    ops.pattern("MultipleSupport", 1)
    ops.groundMotion(1, "Plain", "-disp", 1, "-vel", 2, "-accel", 3)
    ops.imposedMotion(2, 1, 1)
    analyse()
    rows = []
    for _ in range(len(motion[0]) - 1):
        if ops.analyze(1, dt) != 0:
            raise RuntimeError("OpenSees did not converge")
        answer = ops.eleResponse(1, "parameters")
        rows.append((answer[4], answer[5] / 1e3))
    ops.wipe()
    rise, strength = np.array(rows).T
    return rise, strength
