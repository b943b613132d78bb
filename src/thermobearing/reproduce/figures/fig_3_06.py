"""Fig. 3.6: imposed displacement of the LHDR specimen."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import LHDR
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 3.6: imposed displacement of the LHDR specimen. Run: the cyclic test of Table 3.4, "
    "sines, as sampled for the model. Drawn: displacement and shear strain against time, rests "
    "cut out."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return runs.cyclic(LHDR).plot.displacement()
