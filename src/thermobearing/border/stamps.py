"""Dates and times of day as seconds; pandas reads them."""

import re
import warnings

import numpy as np
from numpy.typing import NDArray

from thermobearing.border.errors import InputError, shortened

Floats = NDArray[np.float64]

DAY = 86400.0  # [s]
_COMMA = re.compile(r"(:\d+),(\d+)")
_YEAR_LAST = re.compile(r"^\d{1,2}[./-]\d{1,2}[./-]\d{4}\b")


def elapsed_seconds(stamps: list[str]) -> Floats:
    """Seconds since the first of some stamps.

    Parameters
    ----------
    stamps : all dates with times, or all times ("23:59:58.5", also hours of a running clock). A
        clock without dates that passes midnight goes on. Of day and month, whose order a stamp may
        leave open, that order is taken which makes the record shorter.

    Returns
    -------
    ndarray : [s]; not checked to increase.

    Raises
    ------
    InputError : one of them is not a stamp.

    Examples
    --------
    >>> elapsed_seconds(["23:59:59.5", "00:00:00,5"]).tolist()
    [0.0, 1.0]
    >>> elapsed_seconds(["31.01.2024 23:59", "01.02.2024 00:01"]).tolist()
    [0.0, 120.0]
    """
    return seconds_and_start(stamps)[0]


def seconds_and_start(stamps: list[str]) -> tuple[Floats, np.datetime64 | None]:
    """The same, and the date of the first stamp; None for a clock without dates.

    Parameters
    ----------
    stamps : as in `elapsed_seconds`. A time zone is dropped.

    Raises
    ------
    InputError : as in `elapsed_seconds`.
    """
    cells = [_COMMA.sub(r"\1.\2", cell.strip().replace("/", "-")) for cell in stamps]
    if all(re.match(r"^\d+:", cell) for cell in cells):
        return _clock(cells), None
    orders = (True, False) if _YEAR_LAST.match(cells[0]) else (False,)
    found = [_parsed(cells, day_first) for day_first in orders]
    some = [one for one in found if one is not None]
    if not some:
        raise InputError(f'"{shortened(cells[0])}" or a stamp below it is not a date and time')
    forward = [one for one in some if (np.diff(one[0]) >= 0.0).all()] or some
    return min(forward, key=lambda one: float(np.ptp(one[0])))


def _clock(cells: list[str]) -> Floats:
    import pandas as pd

    whole = [cell if cell.count(":") > 1 else f"{cell}:00" for cell in cells]
    if all(cell.count(":") == 1 and "." in cell for cell in cells):
        whole = [f"00:{cell}" for cell in cells]  # minutes and seconds with decimals
    try:
        values = pd.to_timedelta(pd.Series(whole)).dt.total_seconds().to_numpy(dtype=float)
    except (ValueError, OverflowError):
        raise InputError("holds a cell that is not a time of day such as 23:59:58.5") from None
    if not np.isfinite(values).all():
        raise InputError("holds a cell that is not a time of day such as 23:59:58.5")
    midnights = np.cumsum(np.concatenate([[0.0], np.diff(values) < -0.5 * DAY]))
    shifted = values + DAY * midnights
    return np.asarray(shifted - shifted[0], dtype=np.float64)


def _parsed(cells: list[str], day_first: bool) -> tuple[Floats, np.datetime64] | None:
    """Seconds since the first, and its date; None if they are not all dates of this order."""
    import pandas as pd

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # pandas says how it guessed, which is judged here
        for form in ("ISO8601", None, "mixed"):
            try:
                when = pd.to_datetime(pd.Series(cells), format=form, dayfirst=day_first)
                values = (when - when.iloc[0]).dt.total_seconds().to_numpy(dtype=float)
            except (ValueError, TypeError, OverflowError, AttributeError):
                continue
            if np.isfinite(values).all():
                start = when.iloc[0].tz_localize(None).to_datetime64()
                return np.asarray(values, dtype=np.float64), start
    return None
