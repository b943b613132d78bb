"""Fig. 4.10: temperature through the height of the HDR specimen in the cyclic test."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import HDR
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 4.10: temperature through the height of the HDR specimen in the cyclic test. Run: the "
    "cyclic test of Table 3.4 at 23, 0 and −20 °C. Drawn: profiles at the end of each amplitude. "
    "The source lays the test over it, whose records are not public."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return runs.cyclic(HDR).plot.profiles()
