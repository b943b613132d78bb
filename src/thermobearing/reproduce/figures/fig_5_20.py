"""Fig. 5.20: acceleration of the pier top with the LHDR specimen pseudo-dynamically."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import LHDR, hybrid_tests
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 5.20: acceleration of the pier top with the LHDR specimen pseudo-dynamically. Run: the "
    "hybrid test (pier of Table 3.5 on eight bearings, motion II-II-1 made to the spectrum, 20 s)"
    " at 23, 0 and −20 °C, pseudo-dynamically. Drawn: strong part of the history, temperatures "
    "over each other. The source lays the test over it, whose records are not public."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return hybrid_tests(runs, LHDR, "pd").plot.pier_acceleration()
