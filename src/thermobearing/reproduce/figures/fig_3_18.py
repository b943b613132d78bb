"""Fig. 3.18: loops of the LHDR specimen, real time over pseudo-dynamic."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import LHDR, hybrid_tests
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 3.18: loops of the LHDR specimen, real time over pseudo-dynamic. Prediction, where the "
    "source shows a test. Run: the hybrid test (pier of Table 3.5 on eight bearings, motion II-"
    "II-1 made to the spectrum, 20 s) at 23, 0 and −20 °C, in both modes, on a virgin specimen. "
    "Drawn: force against strain, a panel a temperature. First and second tests are alike here: "
    "the model without a scragging table knows no first loading."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return hybrid_tests(runs, LHDR).plot.modes()
