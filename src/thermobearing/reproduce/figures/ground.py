"""Accelerograms: a panel a motion."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from thermobearing.motions.figures import BINS, MOTION_COLOUR
from thermobearing.motions.library import load_motion
from thermobearing.motions.record import MM_S2_PER_GAL
from thermobearing.results import drawing


def draw_ground(names: Sequence[str], title: str) -> Figure:
    """Acceleration of the ground in time, all with the same axes; the largest one is printed."""
    size = (drawing.WIDEST, 1.5 * len(names) + 1.2)
    figure, axes = drawing.panels(len(names), 1, size, title, share=True)
    for ax, name in zip(axes, names, strict=True):
        motion = load_motion(name)
        gal = motion.acceleration / MM_S2_PER_GAL
        kept = drawing.thin(gal, BINS)
        ax.plot(motion.time[kept], gal[kept], color=MOTION_COLOUR, linewidth=0.7)
        peak = int(np.abs(gal).argmax())
        told = f"{gal[peak]:.0f} gal at {motion.time[peak]:.2f} s"
        ax.margins(y=0.15)
        drawing.note_values(ax, "largest", [told], [MOTION_COLOUR])
        drawing.name_axes(ax, "time [s]" if name == names[-1] else "", "acceleration [gal]")
    drawing.head_grid(axes, [""], list(names))
    return figure
