"""Fig. 3.7: shear stress and strain of the HDR specimen in the cyclic test."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import HDR
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 3.7: shear stress and strain of the HDR specimen in the cyclic test. Prediction, where "
    "the source shows a test. Run: the cyclic test of Table 3.4 at 23, 0 and −20 °C. Drawn: "
    "stress against strain, a panel a temperature."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return runs.cyclic(HDR).plot.loops()
