"""Fig. 4.1: layers of different temperature shear differently."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import HDR
from thermobearing.reproduce.runs import Runs
from thermobearing.results.drawing import COLD

CAPTION = (
    "Fig. 4.1: layers of different temperature shear differently. Run: the cyclic test of Table "
    "3.4 at −20 °C, HDR specimen. Drawn: displacement of each layer at the last peak of each "
    "amplitude. A sketch in the source."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return runs.cyclic(HDR, COLD, keep=("rubber", "layer_displacement")).plot.layer_shear()
