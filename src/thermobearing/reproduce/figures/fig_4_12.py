"""Fig. 4.12: G_e and h_eq of the largest loop of the HDR specimen in real time."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.two_models import both_models, draw_measures
from thermobearing.reproduce.figures.words import HDR
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 4.12: G_e and h_eq of the largest loop of the HDR specimen in real time, multi-layer "
    "model and single temperature. Run: the hybrid test (pier of Table 3.5 on eight bearings, "
    "motion II-II-1 made to the spectrum, 20 s) at 23, 0 and −20 °C, in real time, by both "
    "models. Drawn: bars, a group a temperature. The source lays the test over it, whose records "
    "are not public."
)
SHOWN = [("G_e_MPa", "equivalent modulus $G_e$ [MPa]"), ("h_eq", "damping ratio $h_{eq}$ [-]")]


def draw(runs: Runs) -> Figure:
    """The figure."""
    results = both_models(runs, HDR, "rt")
    return draw_measures(results, "largest loop of the HDR specimen", SHOWN)
