"""Fig. 6.6: largest loops of the bilinear, the HDR and the LHDR bearing at 23 °C."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import bilinear_study
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 6.6: largest loops of the bilinear, the HDR and the LHDR bearing at 23 °C. Run: pier P1"
    " under the four Level 2 motions at 23 °C, on each of the three bearings. Drawn: force "
    "against displacement in the largest loop, a panel a motion. The source does not say which "
    "motion it shows."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return bilinear_study(runs).plot.largest_loops()
