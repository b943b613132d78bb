"""Fig. 6.9: loops of the HDR bearing."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.beside_bilinear import draw_beside_bilinear
from thermobearing.reproduce.figures.words import BRIDGE_HDR, bilinear_study, bridge_study
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 6.9: loops of the HDR bearing. Run: pier P1 under the four Level 2 motions (made to the"
    " spectra I-I-1, I-I-2, II-I-1, II-I-2) at 23, 0 and −20 °C, and on the bilinear bearing at "
    "23 °C. Drawn: force against displacement of one bearing, a panel a motion."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return draw_beside_bilinear(bridge_study(runs, BRIDGE_HDR), bilinear_study(runs))
