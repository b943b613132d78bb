"""Values of runs that became unstable: until when they are results, and how tables mark them.

The shear law under an axial force is not valid beyond the critical load, so that force and
displacement after its first exceedance are not quoted as results.
"""

from collections.abc import Iterable
from dataclasses import replace
from typing import Final

from thermobearing.border.lazy import pd
from thermobearing.quantities.tables import Table

VALID_UNTIL: Final = "valid_until_s"  # column: when a run first became unstable; else NaN
FAILED: Final = "NG"  # verdict of a check whose limit is exceeded
NOT_MODELLED: Final = "outside the model"  # verdict of a check without a model for the value
NOTE: Final = 'Marked: of unstable runs; values later than "Valid until" are no results.'


def has_invalid(frame: "pd.DataFrame") -> bool:
    """Return whether rows of a frame are of unstable runs."""
    return VALID_UNTIL in frame and bool(frame[VALID_UNTIL].notna().any())


def stable_rows(frame: "pd.DataFrame") -> "pd.DataFrame":
    """Return the rows of runs that stayed stable, from which the largest are chosen.

    All rows where none stayed stable.

    >>> stable_rows(pd.DataFrame({"strain": [9.0, 1.5], VALID_UNTIL: [2.0, float("nan")]})).index[0]
    1
    """
    if not has_invalid(frame) or frame[VALID_UNTIL].notna().all():
        return frame
    return frame[frame[VALID_UNTIL].isna()]


def with_invalid_marked(table: Table, frame: "pd.DataFrame", names: Iterable[str]) -> Table:
    """Return a table of a frame with marks on columns of the rows of unstable runs, and a note.

    >>> from thermobearing.quantities.tables import make_table
    >>> rows = pd.DataFrame({"motion": ["a", "b"], "force_max_kN": [3.0, 4.0]})
    >>> rows = rows.assign(valid_until_s=[float("nan"), 1.5])
    >>> table = make_table(rows, ["motion", "force_max_kN"], "Runs")
    >>> with_invalid_marked(table, rows, ["force_max_kN"]).marked
    frozenset({(1, 1)})
    """
    if not has_invalid(frame) or not len(table):
        return table
    invalid = frame[VALID_UNTIL].notna().tolist()
    displayed = [column.name for column in table.columns]
    places = [displayed.index(name) for name in names if name in displayed]
    marks = {(row, place) for row, flag in enumerate(invalid) if flag for place in places}
    return replace(table, marked=table.marked | marks, note=f"{NOTE} {table.note}".strip())
