"""Fig. 6.19: displacement of the pier top relative to its base with LHDR bearings."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import BRIDGE_LHDR, bridge_study
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 6.19: displacement of the pier top relative to its base with LHDR bearings. Run: pier "
    "P1 under the four Level 2 motions (made to the spectra I-I-1, I-I-2, II-I-1, II-I-2) at 23, "
    "0 and −20 °C. Drawn: strong part of each motion, its peak printed."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return bridge_study(runs, BRIDGE_LHDR).plot.pier()
