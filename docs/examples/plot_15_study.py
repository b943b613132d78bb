"""
A parameter study with labelled dimensions
==========================================

Every combination of bearings, motions and temperatures as one xarray dataset: select, divide and
plot by name. On soft ground (right) cold bearings of high-damping rubber move so much less that
their force is smaller too.

Command: ``thermobearing study run CASE.toml -o study``
"""

from matplotlib.figure import Figure

import thermobearing as tb

bearings = ["shen-hdr-bridge", "shen-lhdr-bridge", "lrb-example"]
motions = ["jra-ii-i-1", "jra-ii-iii-1"]
peaks = tb.sweep(bearings, motion=motions, ambient=[-30, -20, 0, 23], keep=tb.Keep(every=50))
ratio = peaks.bearing_force_max / peaks.bearing_force_max.sel(ambient=23)

figure = Figure(figsize=(7.0, 3.2), layout="constrained")
panels = figure.subplots(1, len(motions), sharey=True)
for axes, motion in zip(panels, motions, strict=True):
    for bearing in bearings:
        curve = ratio.sel(motion=motion, bearing=bearing)
        axes.plot(curve.ambient, curve, "o-", label=bearing)
    axes.set(title=motion, xlabel="ambient temperature [degC]")
panels[0].set_ylabel("largest bearing force over that at 23 degC")
panels[-1].legend(frameon=False)
figure
