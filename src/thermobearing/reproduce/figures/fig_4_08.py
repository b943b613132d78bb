"""Fig. 4.8: modulus and damping ratio of the HDR specimen in the cyclic test, by the model."""

from matplotlib.figure import Figure

from thermobearing.reproduce.figures.words import HDR
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 4.8: equivalent modulus and damping ratio by the multi-layer model of the HDR specimen "
    "in the cyclic test. Run: the cyclic test of Table 3.4 at 23, 0 and −20 °C. Drawn: G_e and "
    "h_eq against the amplitude, cycles 1, 2 and 5. The source lays the test over it, whose "
    "records are not public."
)


def draw(runs: Runs) -> Figure:
    """The figure."""
    return runs.cyclic(HDR).plot.measures()
