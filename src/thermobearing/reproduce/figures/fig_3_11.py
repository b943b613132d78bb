"""Fig. 3.11: temperatures of the HDR specimen in the cyclic test."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import HDR
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 3.11: temperatures of the HDR specimen in the cyclic test. Prediction, where the source"
    " shows a test. Run: the cyclic test of Table 3.4 at 23, 0 and −20 °C. Drawn: the three "
    "rubber layers of the half stack in time, rests shortened; one temperature a layer where the "
    "test has thermocouples at centre, side and corner."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return runs.cyclic(HDR).plot.layer_temperatures()
