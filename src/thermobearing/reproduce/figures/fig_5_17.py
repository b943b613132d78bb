"""Fig. 5.17: temperature through the height of the LHDR specimen in real time."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import LHDR, MOMENTS, hybrid_tests
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 5.17: temperature through the height of the LHDR specimen in real time. Run: the hybrid"
    " test (pier of Table 3.5 on eight bearings, motion II-II-1 made to the spectrum, 20 s) at "
    "23, 0 and −20 °C, in real time. Drawn: profiles after 5, 10, 15 and 20 s; the lead dashed."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return hybrid_tests(runs, LHDR, "rt").plot.profiles(MOMENTS)
