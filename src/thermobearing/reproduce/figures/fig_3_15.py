"""Fig. 3.15: loading rates of both kinds of hybrid test."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import HDR, LHDR, hybrid_tests
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 3.15: loading rates of both kinds of hybrid test. Prediction, where the source shows a "
    "test. Run: the hybrid test (pier of Table 3.5 on eight bearings, motion II-II-1 made to the "
    "spectrum, 20 s) at 23, 0 and −20 °C, in both modes, both specimens. Drawn: speed of the "
    "specimen on the clock of the laboratory, a column a mode."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return hybrid_tests(runs, [HDR, LHDR]).plot.speed()
