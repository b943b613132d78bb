"""
An integrator of your own
=========================

`tb.element` is the bearing with trial, commit and revert, and with heat and memory inside. Any
solver can use it; here the simplest one moves a single mass, at -20 and at 23 °C.
"""

import numpy as np
from matplotlib.figure import Figure

import thermobearing as tb

motion = tb.load_motion("jra-ii-i-1")
mass = 785 / 9810  # kN s2/mm


def shaken(ambient: float) -> np.ndarray:
    """Return displacement [mm] and force [kN] of every step."""
    bearing = tb.element("shen-hdr-bridge", ambient=ambient)
    x, v, force, rows = 0.0, 0.0, 0.0, []
    for acceleration in motion.acceleration:  # mm/s2
        v -= (acceleration + force / mass) * motion.dt
        x += v * motion.dt
        force = bearing.set_trial(x, motion.dt).force
        bearing.commit()
        rows.append((x, force))
    return np.array(rows)


figure = Figure(figsize=(5.0, 3.6), layout="constrained")
axes = figure.add_subplot(xlabel="displacement [mm]", ylabel="force [kN]")
for ambient, colour in ((-20, "#0077BB"), (23, "#CC3311")):
    axes.plot(*shaken(ambient).T, color=colour, lw=0.8, label=f"{ambient} degC")
axes.legend(frameon=False)
figure
