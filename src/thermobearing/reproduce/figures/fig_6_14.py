"""Fig. 6.14: largest shear strain with LHDR bearings."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.bars import draw_bars
from thermobearing.reproduce.figures.words import BRIDGE_LHDR, bridge_study
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 6.14: largest shear strain with LHDR bearings. Run: pier P1 under the four Level 2 "
    "motions (made to the spectra I-I-1, I-I-2, II-I-1, II-I-2) at 23, 0 and −20 °C. Drawn: bars,"
    " a group a motion."
)
SHOWN = [("bearing_strain_max", "largest shear strain [%]", 100.0)]


def draw(runs: Runs) -> Figure:
    """The figure."""
    return draw_bars(bridge_study(runs, BRIDGE_LHDR), "bridge on LHDR bearings", SHOWN)
