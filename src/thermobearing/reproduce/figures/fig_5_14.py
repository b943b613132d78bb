"""Fig. 5.14: largest loop of the LHDR specimen pseudo-dynamically: F+."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.two_models import both_models, draw_ratios
from thermobearing.reproduce.figures.words import LHDR
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 5.14: largest loop of the LHDR specimen pseudo-dynamically: F+, F−, D+, D−, energy, and"
    " R2 of the force. Run: the hybrid test (pier of Table 3.5 on eight bearings, motion II-II-1 "
    "made to the spectrum, 20 s) at 23, 0 and −20 °C, pseudo-dynamically, by both models. Drawn: "
    "the measures with a single temperature over those with layers. The source divides by the "
    "test, whose records are not public; here the earlier model is divided by the multi-layer "
    "one: no measure of either's error."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    title = "largest loop of the LHDR specimen pseudo-dynamically"
    return draw_ratios(both_models(runs, LHDR, "pd"), title)
