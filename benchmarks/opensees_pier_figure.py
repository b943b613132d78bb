"""Figure: a structure on bilinear bearings here and in OpenSees."""

import numpy as np
from matplotlib.figure import Figure

from tests.reference.opensees_pier import DT, compare
from thermobearing.results import drawing

LABELS = {
    "deck": "deck [mm]",
    "pier": "pier top [mm]",
    "force": "force of all bearings [kN]",
    "acceleration": "deck, relative [mm/s2]",
}


def draw(name: str = "pier-p1", kind: str = "bilinear") -> Figure:
    """Four histories, ours over theirs."""
    ours, theirs = compare(name, kind)
    title = f"{name}, {kind} bearings: OpenSees (grey) and this package (dashed)"
    figure, axes = drawing.panels(4, 1, (8.0, 7.5), title)
    for ax, (quantity, label) in zip(axes, LABELS.items(), strict=True):
        time = DT * np.arange(1, len(ours[quantity]) + 1)
        ax.plot(time, theirs[quantity], color="#bbbbbb", linewidth=2.4)
        ax.plot(time, ours[quantity], color="#CC3311", linewidth=0.8, linestyle="--")
        drawing.name_axes(ax, "time [s]" if ax is axes[-1] else "", label)
    return figure
