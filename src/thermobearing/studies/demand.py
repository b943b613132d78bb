"""Demand against temperature: mean, median and fractiles, with what is known of the median.

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

from thermobearing.studies.classes import MOST_LEVELS, equal_classes
from thermobearing.studies.columns import AMBIENT
from thermobearing.studies.counted import Failed, column, counted, numbers
from thermobearing.studies.resampling import LEVEL, check_level, quantile

Floats = NDArray[np.float64]
FRACTILES = (0.05, 0.16, 0.5, 0.84, 0.95)
CLASSES = 12  # of temperatures that are more than `MOST_LEVELS`


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
    place = equal_classes(at, CLASSES)
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
