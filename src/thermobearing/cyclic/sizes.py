"""How large the files of a cyclic test can get, known before it runs."""

from thermobearing.core.records import labels
from thermobearing.core.types import Books
from thermobearing.cyclic.case import Case
from thermobearing.cyclic.protocol import Cycles, survey
from thermobearing.cyclic.thinning import COMPLETE, POINTS

DOUBLE, SINGLE = 8, 4  # [bytes] of a number in result.nc; those of cells are single
TEXT = 11  # [bytes] of a number in history.csv, with its comma
CSV_COLUMNS = 7  # besides the layers
COUNTERS = 8  # [bytes] of the numbers of segment and cycle


def rows_of(case: Case) -> float:
    """Rows of a history that are written of one run, at most."""
    _, steps = survey(case.test, case.bearing.total_rubber_thickness, case.starts_at)
    steps = 1.0 + steps / case.analysis.keep_every
    if case.analysis.histories == COMPLETE or any(s.step == "recorded" for s in case.test.steps):
        return steps
    parts = sum(step.count + 1 if isinstance(step, Cycles) else 1 for step in case.test.steps)
    return min(steps, parts * (POINTS + 4.0))


def expected_size(case: Case) -> float:
    """Bytes of result.nc without compression, and of history.csv, at most.

    Parameters
    ----------
    case : a complete case.

    Examples
    --------
    >>> from thermobearing.cyclic.case import make_case
    >>> short = expected_size(make_case({}, "example"))
    >>> short < 0.5 * expected_size(make_case({}, "example", histories="complete"))
    True
    """
    keep = case.analysis.keep
    stack = case.analysis.build_stack(case.bearing)
    layers = sum(part == "rubber" for part in stack.part) // max(case.bearing.cells.rubber, 1)
    layers = max(layers, 1)
    wide = sum(layers for name in keep if name != "cells")
    row = DOUBLE * (len(labels(Books)) + 2 + wide) + COUNTERS
    row += SINGLE * len(stack.part) if "cells" in keep else 0
    row += TEXT * (CSV_COLUMNS + (layers if "rubber" in keep else 0))
    return float(row) * rows_of(case) * len(case.ambient)
