"""Compare the lead temperature in OpenSees with ours.

Heating agrees. Cooling in LeadRubberX runs at half the rate of its own equations (the second
of its two stages is never allowed to cool), and its clock counts from the domain's time zero
instead of the start of the motion, so the same motion later heats more.
"""

import numpy as np
from matplotlib.figure import Figure

import thermobearing as tb
from tests.reference.opensees_lead import lead_rubber_x, stiff_example

AMPLITUDE, PERIOD, CYCLES, DT, REST = 160.0, 4.0, 5, 0.01, 200.0  # mm, s
AMBIENT = 20.0  # degC


def draw() -> Figure:
    """Draw the rise of the lead temperature in both programs."""
    moving = np.arange(0.0, PERIOD * CYCLES + DT / 2, DT)
    w, still = 2.0 * np.pi / PERIOD, np.zeros(round(REST / DT))
    shapes = (np.sin(w * moving), w * np.cos(w * moving), -(w**2) * np.sin(w * moving))
    motion = tuple(np.concatenate([AMPLITUDE * shape, still]) for shape in shapes)
    bearing = stiff_example()
    cycles = {"step": "cycles", "amplitude": AMPLITUDE, "wave": "sine", "period": PERIOD}
    steps = [cycles | {"count": CYCLES}, {"step": "rest", "duration": REST}]
    ours = tb.run(bearing, tb.CyclicTest(dt=DT, steps=steps), ambient=AMBIENT, model="lead-alone")
    figure = Figure(figsize=(7.5, 4.2), layout="constrained")
    ax = figure.subplots()
    lead = ours["lead_temperature"].values[0] - AMBIENT
    ax.plot(ours.time(0), lead, color="#222222", linewidth=2.0, label="this package, lead-alone")
    for start, colour in ((0.0, "#0072B2"), (100.0, "#D55E00")):
        rise, _ = lead_rubber_x(bearing, motion, DT, start)  # type: ignore[arg-type]
        label = f"OpenSees LeadRubberX, motion from domain time {start:g} s"
        ax.plot(DT * np.arange(1, len(rise) + 1), rise, color=colour, linewidth=1.2, label=label)
    ax.axvspan(0.0, PERIOD * CYCLES, color="#eeeeee", zorder=0)
    ax.set_xlabel("time from the start of the motion [s]; shaded: in motion")
    ax.set_ylabel("lead temperature above ambient [K]")
    ax.set_title("Lead core heating and cooling", loc="left")
    ax.legend(frameon=False)
    ax.grid(True, color="#dddddd", linewidth=0.6)
    return figure
