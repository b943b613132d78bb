"""Fig. 6.4: design loop of the isolated bridge."""

from matplotlib.figure import Figure

from thermobearing.design.case import make_design_case
from thermobearing.design.run import run_design
from thermobearing.reproduce.runs import Runs

CAPTION = (
    "Fig. 6.4: design loop of the isolated bridge. Run: the design of section 6.2 from 178 mm "
    "until assumed and found displacement are within 10 %. Drawn: both displacements, round by "
    "round. A flow chart in the source; its loop, run."
)


def draw(_runs: Runs) -> Figure:
    """The figure."""
    case = make_design_case({}, "Fig. 6.4", start=178.0, tolerance=0.1)
    return run_design(case).plot.rounds()
