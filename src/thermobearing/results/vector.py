"""Figures as SVG: lines stay lines, and what has too many points becomes a picture inside."""

import io

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

MOST_POINTS = 3000  # of a line; what has more is drawn as points at the fineness below
FINENESS = 200  # points an inch of what is no vector
# Letters as outlines: a document shows them without the font. Names of parts do not change.
LOOK = {"svg.fonttype": "path", "svg.hashsalt": "thermobearing"}


def vector_bytes(figure: Figure) -> bytes:
    """A figure as SVG; the same bytes for the same figure.

    Examples
    --------
    >>> figure = Figure()
    >>> _ = figure.subplots().plot([0.0, 1.0])
    >>> vector_bytes(figure) == vector_bytes(figure)
    True
    """
    for ax in figure.axes:
        for line in ax.get_lines():
            if np.size(line.get_xdata()) > MOST_POINTS:
                line.set_rasterized(True)
    drawn = io.BytesIO()
    with mpl.rc_context(LOOK):  # type: ignore[arg-type]
        figure.savefig(drawn, format="svg", dpi=FINENESS, metadata={"Date": None, "Creator": None})
    return drawn.getvalue()
