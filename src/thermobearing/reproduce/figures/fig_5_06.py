"""Fig. 5.6: loops of the LHDR specimen in the cyclic test."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import LHDR
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 5.6: loops of the LHDR specimen in the cyclic test. Run: the cyclic test of Table 3.4 "
    "at 23, 0 and −20 °C. Drawn: stress against strain, a panel a temperature. The source lays "
    "the test over it, whose records are not public."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return runs.cyclic(LHDR).plot.loops()
