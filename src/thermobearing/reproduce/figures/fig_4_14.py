"""Fig. 4.14: temperature through the height of the HDR specimen in real time."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import HDR, MOMENTS, hybrid_tests
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 4.14: temperature through the height of the HDR specimen in real time. Run: the hybrid "
    "test (pier of Table 3.5 on eight bearings, motion II-II-1 made to the spectrum, 20 s) at 23,"
    " 0 and −20 °C, in real time. Drawn: profiles after 5, 10, 15 and 20 s. The source lays the "
    "test over it, whose records are not public."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return hybrid_tests(runs, HDR, "rt").plot.profiles(MOMENTS)
