"""Numbers put into classes of equally many runs; temperatures that were drawn, likewise."""

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from thermobearing.studies.columns import AMBIENT

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
