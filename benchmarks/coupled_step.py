"""Time of one coupled step: sharing, heat, conduction, books, one kept row."""

from benchmarks.rows import Row, at_most
from benchmarks.specimen import AMBIENTS, step_microseconds

LIMIT = 0.6  # [us]
LEAD = "shen-lhdr-specimen"
LEAD_LIMIT = 1.0  # [us]


def rows() -> list[Row]:
    """One row per ambient temperature; the fastest of many runs counts, the median is noted."""
    found = []
    for ambient in AMBIENTS:
        fastest, median = step_microseconds(ambient, repeats=30)
        what = f"coupled step, 19 cells, 3 layers, Table 3.4 at {ambient:g} degC"
        found.append(at_most(what, fastest, LIMIT, "us", f"median {median:.3f} us"))
    for ambient in AMBIENTS:
        fastest, median = step_microseconds(ambient, 15, LEAD, "finite-plate")
        what = f"coupled step with lead, 29 cells, 3 layers and core, Table 3.4 at {ambient:g} degC"
        found.append(at_most(what, fastest, LEAD_LIMIT, "us", f"median {median:.3f} us"))
    fastest, median = step_microseconds(-20.0, repeats=15, name=LEAD)
    what = "the same on a half-space, at -20 degC"
    found.append(at_most(what, fastest, LEAD_LIMIT, "us", f"median {median:.3f} us"))
    return found
