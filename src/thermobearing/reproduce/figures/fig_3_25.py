"""Fig. 3.25: energy dissipated by both specimens."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import HDR, LHDR, hybrid_tests
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 3.25: energy dissipated by both specimens. Prediction, where the source shows a test. "
    "Run: the hybrid test (pier of Table 3.5 on eight bearings, motion II-II-1 made to the "
    "spectrum, 20 s) at 23, 0 and −20 °C, in both modes. Drawn: work done on the specimen in "
    "time, HDR above LHDR; pseudo-dynamic dashed."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return hybrid_tests(runs, [HDR, LHDR]).plot.energy()
