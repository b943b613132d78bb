"""Fig. 3.14: input ground motion II-II-1."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.ground import draw_ground
from thermobearing.reproduce.figures.words import HYBRID_MOTION
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 3.14: input ground motion II-II-1. Run: nothing: the stand-in of the library, made to "
    "the standard spectrum, since the record is not free to ship. Drawn: acceleration of the "
    "ground; the source's record has 687 gal and its peak at 8 s."
)


def draw(_runs: Runs) -> Figure:
    """The figure."""
    return draw_ground([HYBRID_MOTION], "input ground motion (stand-in)")
