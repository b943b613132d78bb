"""Fig. 5.10: strain of the LHDR specimen in real time, multi-layer model and single temperature."""

from matplotlib.figure import Figure

from thermobearing.earthquake.comparison import comparison_strains
from thermobearing.reproduce.figures.two_models import both_models
from thermobearing.reproduce.figures.words import LHDR
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 5.10: strain of the LHDR specimen in real time, multi-layer model and single "
    "temperature. Run: the hybrid test (pier of Table 3.5 on eight bearings, motion II-II-1 made "
    "to the spectrum, 20 s) at 23, 0 and −20 °C, in real time, by both models; each drives its "
    "own pier. Drawn: strain in time, a panel a temperature. The source lays the test over it, "
    "whose records are not public."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return comparison_strains(both_models(runs, LHDR, "rt"))
