"""Fig. 5.15: shares of rubber, lead and rate dependence in the force of the LHDR specimen."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import LHDR, hybrid_tests
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 5.15: shares of rubber, lead and rate dependence in the force of the LHDR specimen. "
    "Run: the hybrid test (pier of Table 3.5 on eight bearings, motion II-II-1 made to the "
    "spectrum, 20 s) at 23, 0 and −20 °C, in both modes. Drawn: forces of the parts in the "
    "largest loop, a panel a temperature; pseudo-dynamic dashed."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return hybrid_tests(runs, LHDR).plot.shares()
