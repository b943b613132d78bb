"""Fig. 3.10: equivalent modulus and damping ratio of the LHDR specimen in the cyclic test."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import LHDR
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 3.10: equivalent modulus and damping ratio of the LHDR specimen in the cyclic test. "
    "Prediction, where the source shows a test. Run: the cyclic test of Table 3.4 at 23, 0 and "
    "−20 °C. Drawn: G_e (Eq. 3.1) and h_eq (Eq. 3.2) against the amplitude, cycles 1, 2 and 5."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return runs.cyclic(LHDR).plot.measures()
