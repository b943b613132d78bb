"""Demand of the runs by classes of temperature.

The band of a median is that between two ordered values that holds the true one with the asked
confidence whatever the distribution (binomial: Conover 1999, Practical Nonparametric Statistics,
3.2); it takes the runs as independent.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.stats import binom

from thermobearing.studies.definition.columns import AMBIENT
from thermobearing.studies.statistics.bootstrap import LEVEL, check_level, quantile
from thermobearing.studies.statistics.failed_runs import Failed, column, counted, numbers

Floats = NDArray[np.float64]
MOST_LEVELS = 20  # that are told apart; more numbers are put into classes
MOST_TEMPERATURES = 8  # with a curve each; more are put into classes
CLASSES = 4
CLASS = "temperature"  # column of such a class


def equal_classes(values: NDArray[np.float64], count: int) -> NDArray[np.int64]:
    """Class of each number, from 0, of so many that are equally filled.

    Examples
    --------
    >>> equal_classes(np.array([5.0, -1.0, 3.0, 8.0]), 2)
    array([1, 0, 0, 1])
    """
    rank = np.argsort(np.argsort(values, kind="stable"), kind="stable")
    return np.asarray(rank * count // len(values))


def in_classes(table: pd.DataFrame, by: str) -> tuple[pd.DataFrame, str]:
    """A table whose runs have curves by a column: by classes of it, where it is a temperature with
    many values.

    Parameters
    ----------
    table : of runs.
    by : column.

    Returns
    -------
    the table and the column to take, in order of the classes.

    Examples
    --------
    >>> table, by = in_classes(pd.DataFrame({"ambient_degC": range(-20, 20)}), "ambient_degC")
    >>> by, table[by].unique().tolist()[1:]
    ('temperature', ['−10 to −1 °C', '0 to 9 °C', '10 to 19 °C'])
    """
    if by != AMBIENT or table[AMBIENT].nunique() <= MOST_TEMPERATURES:
        return table, by
    ordered = table.sort_values(AMBIENT, kind="stable")
    air = ordered[AMBIENT].to_numpy(dtype=float)
    place = equal_classes(air, CLASSES)
    names = np.empty(CLASSES, dtype=object)
    for k in range(CLASSES):
        mine = air[place == k]
        names[k] = f"{mine[0]:.0f} to {mine[-1]:.0f} °C".replace("-", "\N{MINUS SIGN}")
    return ordered.assign(**{CLASS: names[place]}), CLASS


FRACTILES = (0.05, 0.16, 0.5, 0.84, 0.95)
TEMPERATURE_CLASSES = 12  # of temperatures that are more than `MOST_LEVELS`


def demand_against(
    table: pd.DataFrame,
    demand: str,
    across: str = AMBIENT,
    *,
    by: Sequence[str] = (),
    failed: Failed = "left-out",
    shares: Sequence[float] = FRACTILES,
    level: float = LEVEL,
) -> pd.DataFrame:
    """How a demand is spread at each temperature (or value of any other column of numbers).

    Parameters
    ----------
    table : of runs.
    demand : column that is looked at.
    across : column of numbers along which; more than 20 different ones are put into 12 classes of
        equally many runs, at their mean.
    by : columns whose values are told apart, such as ("bearing",).
    failed : runs that failed are "left-out", or count as "collapse" (an infinite demand).
    shares : of the runs below each fractile.
    level : confidence of the band of the median, a share in (0, 1).

    Returns
    -------
    DataFrame : the columns of `by`, the column `across`, `runs`, `failed`, `mean`, a column for
        each share (`0.16`), `median_low` and `median_high`.

    Raises
    ------
    InputError : a column is missing.

    Examples
    --------
    >>> runs = pd.DataFrame({"ambient_degC": [-20, -20, 23, 23], "drift": [3.0, 5.0, 1.0, 2.0]})
    >>> demand_against(runs, "drift")[["ambient_degC", "runs", "mean"]].values.tolist()
    [[-20.0, 2.0, 4.0], [23.0, 2.0, 1.5]]
    """
    check_level(level)
    runs = counted(table, demand, failed)
    at = numbers(table, across)
    place, values = _classes(at)
    apart = list(zip(*(column(table, name) for name in by), strict=True)) or [()] * len(table)
    every = np.full(len(table), np.nan)
    every[runs.kept] = runs.demand
    cells: dict[tuple[Any, ...], list[int]] = {}
    for run, label in enumerate(apart):
        cells.setdefault((label, int(place[run])), []).append(run)
    rows = []
    order = {label: number for number, label in enumerate(dict.fromkeys(apart))}
    for label, cell in sorted(cells, key=lambda key: (order[key[0]], key[1])):
        mine = np.array(cells[label, cell])
        known = np.sort(every[mine][~np.isnan(every[mine])])
        row: dict[str, Any] = {**dict(zip(by, label, strict=True)), across: values[cell]}
        row |= {"runs": len(known), "failed": int((~runs.through[mine]).sum())}
        rows.append(row | _spread(known, shares, level))
    return pd.DataFrame(rows)


def _classes(at: Floats) -> tuple[NDArray[np.int64], Floats]:
    """Class of each run, and the value that stands for each class."""
    different, place = np.unique(at, return_inverse=True)
    if len(different) <= MOST_LEVELS:
        return place, different
    place = equal_classes(at, TEMPERATURE_CLASSES)
    return place, np.bincount(place, at) / np.bincount(place)


def _spread(known: Floats, shares: Sequence[float], level: float) -> dict[str, float]:
    """Mean, fractiles and band of the median of ordered values."""
    if len(known) == 0:
        names = ["mean", *(f"{share:g}" for share in shares), "median_low", "median_high"]
        return dict.fromkeys(names, np.nan)
    found = {"mean": float(known.mean())}
    found |= {f"{share:g}": quantile(known, share) for share in shares}
    low, high = median_places(len(known), level)
    found["median_low"] = float(known[low]) if low >= 0 else -np.inf
    found["median_high"] = float(known[high]) if high < len(known) else np.inf
    return found


def median_places(count: int, level: float) -> tuple[int, int]:
    """Places of ordered values between which the median lies with at least that confidence.

    Examples
    --------
    >>> median_places(20, 0.95)  # the 6th and the 15th
    (5, 14)
    """
    rest = int(binom.ppf(0.5 * (1.0 - level), count, 0.5))
    return rest - 1, count - rest
