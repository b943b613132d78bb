"""Fig. 4.11: loops of the HDR specimen in real time, multi-layer model and single temperature."""

from matplotlib.figure import Figure

from thermobearing.earthquake.comparison import comparison_loops
from thermobearing.reproduce.figures.two_models import both_models
from thermobearing.reproduce.figures.words import HDR
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 4.11: loops of the HDR specimen in real time, multi-layer model and single temperature."
    " Run: the hybrid test (pier of Table 3.5 on eight bearings, motion II-II-1 made to the "
    "spectrum, 20 s) at 23, 0 and −20 °C, in real time, by both models; each drives its own pier."
    " Drawn: force against strain, a panel a temperature. The source lays the test over it, whose"
    " records are not public."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return comparison_loops(both_models(runs, HDR, "rt"))
