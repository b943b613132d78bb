"""Fig. 3.20: temperatures of the HDR specimen pseudo-dynamically."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import HDR, hybrid_tests
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 3.20: temperatures of the HDR specimen pseudo-dynamically. Prediction, where the source"
    " shows a test. Run: the hybrid test (pier of Table 3.5 on eight bearings, motion II-II-1 "
    "made to the spectrum, 20 s) at 23, 0 and −20 °C, pseudo-dynamically. Drawn: rise of the "
    "rubber layers over the start."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return hybrid_tests(runs, HDR, "pd").plot.temperature()
