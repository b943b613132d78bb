"""Fig. 6.8: the four Level 2 ground motions."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.ground import draw_ground
from thermobearing.reproduce.figures.words import MOTIONS
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 6.8: the four Level 2 ground motions. Run: nothing: the stand-ins of the library, made "
    "to the standard spectra, since the records are not free to ship. Drawn: accelerations of the"
    " ground."
)


def draw(_runs: Runs) -> Figure:
    """The figure."""
    return draw_ground(MOTIONS, "Level 2 ground motions (stand-ins)")
