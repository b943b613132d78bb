"""Fig. 5.8: temperatures of rubber and lead of the LHDR specimen in the cyclic test."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import LHDR
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 5.8: temperatures of rubber and lead of the LHDR specimen in the cyclic test. Run: the "
    "cyclic test of Table 3.4 at 23, 0 and −20 °C. Drawn: lead, innermost and outermost layer in "
    "time, rests shortened. The source lays the test over it, whose records are not public."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return runs.cyclic(LHDR).plot.lead_temperature()
