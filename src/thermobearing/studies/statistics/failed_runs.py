"""Which runs of a study a figure is made of: failed ones never count as collapse in silence."""

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from thermobearing.border.errors import InputError, nearest
from thermobearing.model.outcomes import PIER_BEYOND_LIMIT
from thermobearing.studies.run.demand_parameters import BAD_INPUT, BROKEN, COMPLETED

Floats = NDArray[np.float64]
Failed: TypeAlias = Literal["left-out", "collapse"]
OUTCOME = "outcome"
NEVER_RUN = (BAD_INPUT, BROKEN)  # they say nothing of the structure


@dataclass(frozen=True)
class Counted:
    """The runs that an estimate is made of.

    Attributes
    ----------
    table : their rows.
    demand : of each of them; infinite for a run that failed and counts as collapse.
    left_out, collapsed : how many runs failed and are not among them, or count as collapse.
    kept, through : whether each row of the whole table is among them, and whether it got through.
    """

    table: pd.DataFrame
    demand: Floats
    left_out: int
    collapsed: int
    kept: NDArray[np.bool_]
    through: NDArray[np.bool_]

    @property
    def sentence(self) -> str:
        """How many runs there are, and what became of those that failed."""
        return describe_all(len(self.table) + self.left_out, self.left_out, self.collapsed)


def describe_all(runs: int, left_out: int, collapsed: int) -> str:
    """How many of so many runs failed, and what became of them.

    Examples
    --------
    >>> describe_all(40, 2, 0)
    '2 of 40 runs failed and are left out'
    """
    done = [
        f"{count} of {runs} runs failed and {what}"
        for count, what in ((left_out, "are left out"), (collapsed, "count as collapse"))
        if count
    ]
    return "; ".join(done) or f"all {runs} runs completed"


def counted(table: pd.DataFrame, demand: str, failed: Failed = "left-out") -> Counted:
    """Rows that count, with their demand.

    Parameters
    ----------
    table : of runs; a column `outcome` says "completed" of those that got through. Without that
        column all of them did.
    demand : name of a column of numbers.
    failed : "left-out" of the count, or counted as "collapse"; runs that could not be begun for
        their input, or for a fault of the program, are left out in any case. A run whose pier
        exceeded its limits exceeds every capacity of a pier; its other demands are those computed,
        but for "collapse".

    Raises
    ------
    InputError : no such column, or no run got through.

    Examples
    --------
    >>> runs = pd.DataFrame({"outcome": ["completed", "not_converged"], "drift": [0.01, np.nan]})
    >>> counted(runs, "drift").sentence
    '1 of 2 runs failed and are left out'
    >>> counted(runs, "drift", "collapse").demand
    array([0.01,  inf])
    """
    if failed not in get_args(Failed):
        raise InputError(f'failed is "left-out" or "collapse", not {failed!r}')
    values = numbers(table, demand)
    through = np.ones(len(table), dtype=bool)
    pier = ~through  # runs whose pier exceeded its limits; all else in them was computed
    if OUTCOME in table:
        through = (table[OUTCOME] == COMPLETED).to_numpy(dtype=bool)
        pier = (table[OUTCOME] == PIER_BEYOND_LIMIT).to_numpy(dtype=bool)
    if failed == "left-out" and not demand.startswith("pier_"):
        through = through | pier
    missing = through & ~np.isfinite(values)
    if missing.any():
        raise InputError(
            f"{missing.sum()} of {through.sum()} runs that got through have no number in "
            f'"{demand}"; take the runs that have one'
        )
    if not (through | pier).any():
        raise InputError(f"none of {len(table)} runs completed")
    kept = through | pier
    if failed == "collapse" and OUTCOME in table:
        kept = kept | ~table[OUTCOME].isin(NEVER_RUN).to_numpy(dtype=bool)
    demands = np.where(through, values, np.inf)[kept]
    collapsed = int(kept.sum() - through.sum())
    return Counted(table[kept], demands, int((~kept).sum()), collapsed, kept, through)


def numbers(table: pd.DataFrame, name: str) -> Floats:
    """A column of a table as numbers.

    Parameters
    ----------
    table : of runs.
    name : of the column.

    Raises
    ------
    InputError : no such column, or no numbers in it.
    """
    column(table, name)
    try:
        return np.asarray(table[name].to_numpy(), dtype=float)
    except (TypeError, ValueError):
        raise InputError(f'column "{name}" does not hold numbers') from None


def column(table: pd.DataFrame, name: str) -> list[Any]:
    """A column of a table as it is; InputError with the nearest name if there is none."""
    if name not in table:
        raise InputError(f'no column "{name}"{nearest(name, [str(k) for k in table.columns])}')
    return table[name].tolist()


def positive(table: pd.DataFrame, name: str) -> Floats:
    """A column of positive numbers, whose logarithm is taken."""
    values = numbers(table, name)
    if not (np.isfinite(values) & (values > 0.0)).all():
        worst = values[~(np.isfinite(values) & (values > 0.0))][0]
        raise InputError(f'column "{name}" has {worst:g}; its logarithm is taken: above 0 only')
    return values
