"""Fig. 3.22: temperatures of the LHDR specimen pseudo-dynamically."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import LHDR, hybrid_tests
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 3.22: temperatures of the LHDR specimen pseudo-dynamically. Prediction, where the "
    "source shows a test. Run: the hybrid test (pier of Table 3.5 on eight bearings, motion II-"
    "II-1 made to the spectrum, 20 s) at 23, 0 and −20 °C, pseudo-dynamically. Drawn: rise of the"
    " rubber layers and of the lead over the start."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return hybrid_tests(runs, LHDR, "pd").plot.temperature()
