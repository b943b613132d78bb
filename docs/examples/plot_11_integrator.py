"""
An integrator of your own
=========================

`tb.element` is the bearing with trial and commit, and with heat and memory inside. Any solver can
use it; here Newmark's method (average acceleration) moves a single mass at -20 and at 23 °C. With
the tangent, Newton's iterations find equilibrium in every step.

Command: none, since the solver is a program of your own.
"""

import numpy as np
from matplotlib.figure import Figure

import thermobearing as tb

motion = tb.load_motion("jra-ii-i-1")
mass = 785 / 9810  # kN s2/mm


def shaken(ambient: float) -> np.ndarray:
    """Return displacement [mm] and force [kN] of every step."""
    bearing, dt = tb.element("shen-hdr-bridge", ambient=ambient), motion.dt
    x = v = a = 0.0
    rows = []
    for ground in motion.acceleration:  # mm/s2
        new = x
        for _ in range(20):
            acceleration = 4.0 * (new - x - dt * v) / dt**2 - a
            trial = bearing.set_trial(new, dt)  # from the committed state, as often as needed
            residual = -mass * (acceleration + ground) - trial.force
            step = residual / (4.0 * mass / dt**2 + trial.tangent)
            new += step
            if abs(step) < 1e-9:
                break
        force = bearing.set_trial(new, dt).force
        bearing.commit()
        v, a, x = 2.0 * (new - x) / dt - v, 4.0 * (new - x - dt * v) / dt**2 - a, new
        rows.append((x, force))
    return np.array(rows)


figure = Figure(figsize=(5.0, 3.6), layout="constrained")
axes = figure.add_subplot(xlabel="displacement [mm]", ylabel="force [kN]")
for ambient, colour in ((-20, "#013aa8"), (23, "#e67502")):
    axes.plot(*shaken(ambient).T, color=colour, lw=0.8, label=f"{ambient} degC")
axes.legend(frameon=False)
figure
