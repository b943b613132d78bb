"""Weather from files: EPW of building simulation, or any table with time and temperature.

An EPW file has eight lines of header, the first beginning with LOCATION; then a line an hour: year,
month, day, hour 1 to 24 (its end), minute, flags, dry bulb [degC], ...; 99.9 and more is missing
(EnergyPlus, Auxiliary Programs, "EnergyPlus Weather File (EPW) Data Dictionary"). A typical year is
put together from months of different years, so the year of a line may be any.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from thermobearing.bearing.ambient import Ambient
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, shortened
from thermobearing.border.opener import read_bytes
from thermobearing.climate.hourly import HOUR, Dates, Hourly
from thermobearing.core.records import Floats
from thermobearing.tables.guess import read_air_columns
from thermobearing.tables.text import LARGEST_FILE, read_text

FIRST = "LOCATION,"  # of an EPW file
DRY_BULB, MINUTE = 6, 4  # columns, from 0
MISSING = 99.9  # [degC] or more
LONGEST_GAP = 6  # longest gap that is interpolated [h]
COMMON_YEAR, LEAP_YEAR = 2001, 2004  # of dates without meaningful years


@checked
def read_weather(path: str | Path) -> Hourly:
    r"""Return hourly weather from an EPW file, or from a table with time and temperature.

    Parameters
    ----------
    path : `.epw`; or text or `.xlsx` with a column `time` (dates with times in one zone without
        summer time, or hours, days, seconds with their unit) and one `temperature_degC`. Readings
        that are not at full hours from the first are interpolated linearly.

    Returns
    -------
    Hourly : an EPW file of a complete year recurs, a table does not.

    Raises
    ------
    InputError : unreadable file, no such column, time that goes back, gaps of more than 6 h.

    Examples
    --------
    >>> import tempfile
    >>> file = Path(tempfile.mkdtemp()) / "town.csv"
    >>> rows = ["time,temperature_degC", "2024-01-31 22:00,-8", "2024-02-01 00:00,-12"]
    >>> _ = file.write_text("\n".join(rows))
    >>> weather = read_weather(file)
    >>> weather.temperature.tolist(), str(weather.begins)
    ([-8.0, -10.0, -12.0], '2024-01-31T22')
    """
    path = Path(path)
    if _is_epw(path):
        return _read_epw(path)
    columns = read_air_columns(path)
    time, values = columns.values["time"], columns.values["temperature"]
    gaps = np.diff(time)
    if not (gaps > 0.0).all():
        k = int(np.argmin(gaps > 0.0))
        raise InputError(
            f"time does not increase from reading {k + 1} to {k + 2}; use one time zone, "
            "without daylight saving time",
            str(path),
        )
    if gaps.max() > LONGEST_GAP * HOUR:
        k = int(np.argmax(gaps))
        raise InputError(
            f"{gaps[k] / HOUR:g} h without a reading after reading {k + 1}; gaps are "
            f"interpolated up to {LONGEST_GAP} h",
            str(path),
        )
    hours = np.arange(np.floor((time[-1] - time[0]) / HOUR + 1e-6) + 1.0)
    temperature = np.interp(time[0] + HOUR * hours, time, values)
    even = len(hours) == len(time) and bool(np.allclose(gaps, HOUR, rtol=1e-6))
    notes = () if even else ("readings were interpolated linearly to full hours from the first",)
    return Hourly(temperature, columns.begins, False, path.stem, notes)


def read_air(path: str | Path) -> Ambient:
    """Return ambient temperature in time from any weather file; readings of a table are kept."""
    if not _is_epw(Path(path)):
        return Ambient.from_csv(path)
    weather = _read_epw(Path(path))
    return weather.before(len(weather) - 1, len(weather) - 1)


class _Line(NamedTuple):
    number: int  # of the line, from 1
    year: int
    month: int
    day: int
    hour: int
    dry_bulb: float


def _is_epw(path: Path) -> bool:
    """Return whether a file is an EPW file, by its ending or its first word."""
    begins = read_bytes(path, LARGEST_FILE).lstrip().upper()
    return path.suffix.lower() == ".epw" or begins.startswith(FIRST.encode())


def _read_epw(path: Path) -> Hourly:
    """Return the dry-bulb temperature of an EPW file; a complete year (the usual case) recurs."""
    text = read_text(path)
    if not text.lstrip().upper().startswith(FIRST):
        raise InputError(f'is not an EPW file: its first line must begin with "{FIRST}"', str(path))
    rows = text.splitlines()
    place = rows[0].split(",")[1].strip()
    try:
        data = ((number, row) for number, row in enumerate(rows, 1) if row.strip()[:1].isdigit())
        read = [_line(number, row) for number, row in data]
        lines = [line for line in read if line is not None]
        if len(lines) < 2:
            raise InputError(f"has {len(lines)} hours; at least 2 are needed")
        dates, notes = _dates(lines)
        values, filled = _filled_gaps(np.array([line.dry_bulb for line in lines]), lines[0].number)
    except InputError as error:
        raise error.located(path) from None
    begins = dates[0]
    # A year is complete if the hour after its last is its first, one year later.
    year = begins.astype("datetime64[Y]")
    later = (year + np.timedelta64(1, "Y")).astype("datetime64[h]") + (
        begins - year.astype("datetime64[h]")
    )
    full_year = dates[-1] + np.timedelta64(1, "h") == later
    return Hourly(values, begins, bool(full_year), place or path.stem, (*notes, *filled))


def _line(number: int, row: str) -> _Line | None:
    """Return the numbers of a line; None for a line within an hour."""
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
    # Values at full hours only; minute 60 is the end of the hour as well.
    if minute not in (0, 60):
        return None
    return _Line(number, year, month, day, hour, dry_bulb)


def _dates(lines: list[_Line]) -> tuple[Dates, list[str]]:
    """Return the dates of the lines, or of a typical year if months are of several years."""
    hour = np.timedelta64(1, "h")
    leap = any((line.month, line.day) == (2, 29) for line in lines)
    nominal = LEAP_YEAR if leap else COMMON_YEAR
    stated = [line.year for line in lines]
    # Years as stated, or, in a typical year of months from several, one year for all.
    for years in (stated, [nominal] * len(lines)):
        dates = np.array([_date(line, year) for line, year in zip(lines, years, strict=True)])
        follows = np.diff(dates) == hour
        if follows.all():
            note = "its months are from several years; the dates of a typical year are used"
            return dates, [] if years is stated else [note]
    k = int(np.argmin(follows))
    earlier, later = lines[k], lines[k + 1]
    raise InputError(
        f"line {later.number}: {later.month}/{later.day} hour {later.hour} does not follow "
        f"{earlier.month}/{earlier.day} hour {earlier.hour} of line {earlier.number}"
    )


def _date(line: _Line, year: int) -> np.datetime64:
    """Return the date of the end of the hour."""
    try:
        day = np.datetime64(f"{year:04d}-{line.month:02d}-{line.day:02d}T00", "h")
    except ValueError:  # 29 February of another year, 31 April
        raise InputError(
            f"line {line.number}: there is no day {line.day} in month {line.month} of {year}"
        ) from None
    return day + np.timedelta64(line.hour, "h")


def _filled_gaps(values: Floats, first: int = 0) -> tuple[Floats, list[str]]:
    """Interpolate missing hours linearly, and return a sentence about them.

    99.9 degC and more, or not a number, is missing; `first` is the line of the first value.
    """
    missing = ~(values < MISSING)
    if not missing.any():
        return values, []
    if missing[0] or missing[-1]:
        raise InputError("the first and the last hour must have a temperature")
    # Gaps begin and end at edges in turn, because neither end of the series is missing.
    edges = np.flatnonzero(np.diff(missing.astype(np.int8)))
    lengths = edges[1::2] - edges[::2]
    if lengths.max() > LONGEST_GAP:
        k = int(np.argmax(lengths > LONGEST_GAP))
        raise InputError(
            f"line {first + edges[2 * k] + 1}: no temperature for {lengths[k]} h in a row; "
            f"gaps are interpolated up to {LONGEST_GAP} h"
        )
    present = np.flatnonzero(~missing)
    values = np.interp(np.arange(len(values)), present, values[present])
    return values, [f"{missing.sum()} hours without a temperature were interpolated linearly"]
