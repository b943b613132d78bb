"""Fig. 3.17: shear strain with the HDR specimen, real time over pseudo-dynamic."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.both_modes import draw_both_modes
from thermobearing.reproduce.figures.words import HDR, hybrid_tests
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 3.17: shear strain with the HDR specimen, real time over pseudo-dynamic. Prediction, "
    "where the source shows a test. Run: the hybrid test (pier of Table 3.5 on eight bearings, "
    "motion II-II-1 made to the spectrum, 20 s) at 23, 0 and −20 °C, in both modes. Drawn: shear "
    "strain [%] against the time of the earthquake, a panel a temperature."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    result = hybrid_tests(runs, HDR)
    title = "shear strain, HDR specimen"
    return draw_both_modes(result, "bearing_strain", title, "shear strain [%]", 100.0)
