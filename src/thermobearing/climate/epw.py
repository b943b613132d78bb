"""Weather files of building simulation (EnergyPlus, `.epw`): their dry-bulb temperature.

Eight lines of header, the first beginning with LOCATION; then a line an hour: year, month, day,
hour 1 to 24 (its end), minute, flags, dry bulb [degC], ...; 99.9 and more is missing (EnergyPlus,
Auxiliary Programs, "EnergyPlus Weather File (EPW) Data Dictionary"). A typical year is put together
from months of different years, so the year of a line may be any.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from thermobearing.border.errors import InputError, read_bytes, shortened
from thermobearing.climate.hourly import Dates, Floats, Hourly
from thermobearing.tables.text import LARGEST_FILE, read_text

FIRST = "LOCATION,"  # of the file
DRY_BULB, MINUTE = 6, 4  # columns, from 0
MISSING = 99.9  # [degC] or more
LONGEST_GAP = 6  # hours that a straight line may stand for
COMMON_YEAR, LEAP_YEAR = 2001, 2004  # of dates whose years say nothing


class Line(NamedTuple):
    """What is read from one line; `number` as an editor counts it."""

    number: int
    year: int
    month: int
    day: int
    hour: int
    dry_bulb: float


def is_epw(path: Path) -> bool:
    """Whether a file is one of building simulation, by its ending or its first word."""
    begins = read_bytes(path, LARGEST_FILE).lstrip().upper()
    return path.suffix.lower() == ".epw" or begins.startswith(FIRST.encode())


def read_epw(path: str | Path) -> Hourly:
    """The dry-bulb temperature of an EPW file.

    Parameters
    ----------
    path : the file. A whole year, as most of them are, recurs.

    Returns
    -------
    Hourly : `assumptions` says what was filled, and where years are not to be taken literally.

    Raises
    ------
    InputError : not an EPW file, hours that do not follow each other, gaps of more than 6 h.
    """
    path = Path(path)
    text = read_text(path)
    if not text.lstrip().upper().startswith(FIRST):
        raise InputError(f'is not an EPW file: its first line must begin with "{FIRST}"', str(path))
    rows = text.splitlines()
    place = rows[0].split(",")[1].strip()
    try:
        read = [_line(number, row) for number, row in enumerate(rows, 1) if _has_data(row)]
        lines = [line for line in read if line is not None]
        if len(lines) < 2:
            raise InputError(f"has {len(lines)} hours; at least 2 are needed")
        dates, said = _dates(lines)
        values, filled = _filled_gaps(np.array([line.dry_bulb for line in lines]), lines[0].number)
    except InputError as error:
        raise InputError(error.problems, str(path)) from None
    begins = dates[0]
    whole = dates[-1] + np.timedelta64(1, "h") == begins + _one_year(begins)
    return Hourly(values, begins, bool(whole), place or path.stem, (*said, *filled))


def _one_year(begins: np.datetime64) -> np.timedelta64:
    """From a date to the same one a year later."""
    year = begins.astype("datetime64[Y]")
    here = begins - year.astype("datetime64[h]")
    return np.timedelta64((year + 1).astype("datetime64[h]") + here - begins, "h")


def _has_data(row: str) -> bool:
    """Whether a line begins with a year; the header begins with words."""
    return row.strip()[:1].isdigit()


def _line(number: int, row: str) -> Line | None:
    """One line in numbers; None for a line within an hour."""
    cells = [cell.strip() for cell in row.split(",")]
    if len(cells) <= DRY_BULB:
        raise InputError(f"line {number}: has {len(cells)} columns; dry bulb is the seventh")
    try:
        year, month, day, hour, minute = (int(float(cell)) for cell in cells[: MINUTE + 1])
        dry_bulb = float(cells[DRY_BULB])
    except (ValueError, OverflowError):
        raise InputError(f"line {number}: not a number among {shortened(row)!r}") from None
    if not (1 <= month <= 12 and 1 <= day <= 31 and 1 <= hour <= 24):
        raise InputError(f"line {number}: no such time: month {month}, day {day}, hour {hour}")
    if minute not in (0, 60):
        return None
    return Line(number, year, month, day, hour, dry_bulb)


def _dates(lines: list[Line]) -> tuple[Dates, list[str]]:
    """Dates of the lines as they are, or of a year of no meaning where months are of several."""
    hour = np.timedelta64(1, "h")
    leap = any((line.month, line.day) == (2, 29) for line in lines)
    nominal = LEAP_YEAR if leap else COMMON_YEAR
    as_told = [line.year for line in lines]
    for years in (as_told, [nominal] * len(lines)):
        dates = np.array([_date(line, year) for line, year in zip(lines, years, strict=True)])
        follows = np.diff(dates) == hour
        if follows.all():
            said = "its months are of several years; dates are those of a typical year"
            return dates, [] if years is as_told else [said]
    k = int(np.argmin(follows))
    one, two = lines[k], lines[k + 1]
    raise InputError(
        f"line {two.number}: {two.month}/{two.day} hour {two.hour} does not follow "
        f"{one.month}/{one.day} hour {one.hour} of line {one.number}"
    )


def _date(line: Line, year: int) -> np.datetime64:
    """Date of the end of the hour."""
    try:
        day = np.datetime64(f"{year:04d}-{line.month:02d}-{line.day:02d}T00", "h")
    except ValueError:  # 29 February of another year, 31 April
        raise InputError(
            f"line {line.number}: there is no day {line.day} in month {line.month} of {year}"
        ) from None
    return day + np.timedelta64(line.hour, "h")


def _filled_gaps(values: Floats, first: int = 0) -> tuple[Floats, list[str]]:
    """Missing hours on straight lines between those that are there, and a sentence about them.

    Parameters
    ----------
    values : [degC]; 99.9 and more, or not a number, is missing.
    first : line of the file that the first value stands in, for messages.

    Raises
    ------
    InputError : more than 6 h missing in a row, or the first or last hour.
    """
    missing = ~(values < MISSING)
    if not missing.any():
        return values, []
    if missing[0] or missing[-1]:
        raise InputError("the first and the last hour must have a temperature")
    edges = np.flatnonzero(np.diff(missing.astype(np.int8)))
    lengths = edges[1::2] - edges[::2]
    if lengths.max() > LONGEST_GAP:
        k = int(np.argmax(lengths > LONGEST_GAP))
        raise InputError(
            f"line {first + edges[2 * k] + 1}: no temperature for {lengths[k]} h in a row; a "
            f"straight line may stand for {LONGEST_GAP} h"
        )
    known = np.flatnonzero(~missing)
    values = np.interp(np.arange(len(values)), known, values[known])
    return values, [f"{missing.sum()} hours without a temperature lie on straight lines"]
