"""
A ground motion and its spectrum
================================

A built-in synthetic motion, which matches the Level 2 standard spectrum of Japanese road bridges,
compared with that spectrum. Read your own with `tb.load_motion("record.csv", unit="gal")`.

Command: ``thermobearing motions spectrum jra-ii-i-1 --kind II --ground I -o motion``
"""

import numpy as np
from matplotlib.figure import Figure

import thermobearing as tb
from thermobearing.motions.targets import standard_spectrum

motion = tb.load_motion("jra-ii-i-1")
figure = Figure(figsize=(7.0, 2.6), layout="constrained")
axes = figure.add_subplot(xlabel="time [s]", ylabel="acceleration [m/s²]")
axes.plot(np.arange(len(motion.acceleration)) * motion.dt, motion.acceleration / 1000.0, lw=0.7)
figure

# %%
# Response spectrum with 5 % damping.

periods = np.geomspace(0.1, 5.0, 60)
spectrum = tb.response_spectrum(motion, periods)
figure = Figure(figsize=(5.0, 3.4), layout="constrained")
axes = figure.add_subplot(xscale="log", xlabel="period [s]", ylabel="acceleration [m/s²]")
axes.plot(periods, spectrum.acceleration / 1000.0, label=motion.name)
axes.plot(periods, standard_spectrum("II", "I", periods) / 1000.0, "--", label="standard")
axes.legend(frameon=False)
figure
