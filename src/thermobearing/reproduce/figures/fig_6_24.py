"""Fig. 6.24: largest acceleration of the superstructure with HDR bearings."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.bars import draw_bars
from thermobearing.reproduce.figures.words import BRIDGE_HDR, bridge_study
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 6.24: largest acceleration of the superstructure with HDR bearings. Run: pier P1 under "
    "the four Level 2 motions (made to the spectra I-I-1, I-I-2, II-I-1, II-I-2) at 23, 0 and −20"
    " °C. Drawn: bars, a group a motion."
)
SHOWN = [("deck_acceleration_max_m_s2", "largest acceleration [m/s2]", 1.0)]


def draw(runs: Runs) -> Figure:
    """The figure."""
    return draw_bars(bridge_study(runs, BRIDGE_HDR), "bridge on HDR bearings", SHOWN)
