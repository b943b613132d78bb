"""Fig. 4.16: displacement of the pier top with the HDR specimen in real time."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import HDR, hybrid_tests
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 4.16: displacement of the pier top with the HDR specimen in real time. Run: the hybrid "
    "test (pier of Table 3.5 on eight bearings, motion II-II-1 made to the spectrum, 20 s) at 23,"
    " 0 and −20 °C, in real time. Drawn: strong part of the history, temperatures over each "
    "other. The source lays the test over it, whose records are not public."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return hybrid_tests(runs, HDR, "rt").plot.pier()
