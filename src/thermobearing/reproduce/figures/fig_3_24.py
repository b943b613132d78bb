"""Fig. 3.24: temperature of the LHDR specimen at −20 °C after 5, 10, 15 and 20 s."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import LHDR, MOMENTS, hybrid_tests
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 3.24: temperature of the LHDR specimen at −20 °C after 5, 10, 15 and 20 s. Prediction, "
    "where the source shows a test. Run: the hybrid test (pier of Table 3.5 on eight bearings, "
    "motion II-II-1 made to the spectrum, 20 s) at 23, 0 and −20 °C, in real time; −20 °C is "
    "shown. Drawn: profiles through the height: the source's figure goes over the plan of the "
    "first and third layer, and heat flows through the height only here."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return hybrid_tests(runs, LHDR, "rt").sel(ambient=-20.0).plot.profiles(MOMENTS)
