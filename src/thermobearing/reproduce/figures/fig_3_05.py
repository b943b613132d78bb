"""Fig. 3.5: imposed displacement of the HDR specimen."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import HDR
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 3.5: imposed displacement of the HDR specimen. Run: the cyclic test of Table 3.4, "
    "triangles, as sampled for the model. Drawn: displacement and shear strain against time, "
    "rests cut out."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return runs.cyclic(HDR).plot.displacement()
