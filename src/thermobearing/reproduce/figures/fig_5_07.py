"""Fig. 5.7: equivalent modulus and damping ratio of the LHDR specimen in the cyclic test."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import LHDR
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 5.7: equivalent modulus and damping ratio of the LHDR specimen in the cyclic test. Run:"
    " the cyclic test of Table 3.4 at 23, 0 and −20 °C. Drawn: G_e and h_eq against the "
    "amplitude, cycles 1, 2 and 5. The source lays the test over it, whose records are not "
    "public."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return runs.cyclic(LHDR).plot.measures()
