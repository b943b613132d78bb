"""Weather from files: EPW, or any table with time and temperature."""

from pathlib import Path

import numpy as np

from thermobearing.bearing.ambient import Ambient
from thermobearing.border.errors import InputError
from thermobearing.climate.epw import LONGEST_GAP, is_epw, read_epw
from thermobearing.climate.hourly import HOUR, Hourly
from thermobearing.tables.guess import read_air_columns


def read_weather(path: str | Path) -> Hourly:
    r"""Hourly weather from an EPW file, or from a table with time and temperature.

    Parameters
    ----------
    path : `.epw`; or text or `.xlsx` with a column `time` (dates with times in one zone without
        summer time, or hours, days, seconds with their unit) and one `temperature_degC`. Readings
        that are not at full hours from the first are put there on straight lines.

    Returns
    -------
    Hourly : an EPW file of a whole year recurs, a table does not.

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
    if is_epw(path):
        return read_epw(path)
    found = read_air_columns(path)
    time, values = found.values["time"], found.values["temperature"]
    gaps = np.diff(time)
    if not (gaps > 0.0).all():
        k = int(np.argmin(gaps > 0.0))
        raise InputError(
            f"time does not increase from reading {k + 1} to {k + 2}; give it in one zone, without "
            "summer time",
            str(path),
        )
    if gaps.max() > LONGEST_GAP * HOUR:
        k = int(np.argmax(gaps))
        raise InputError(
            f"{gaps[k] / HOUR:g} h without a reading after reading {k + 1}; a straight line may "
            f"stand for {LONGEST_GAP} h",
            str(path),
        )
    hours = np.arange(np.floor((time[-1] - time[0]) / HOUR + 1e-6) + 1.0)
    air = np.interp(time[0] + HOUR * hours, time, values)
    even = len(hours) == len(time) and bool(np.allclose(gaps, HOUR, rtol=1e-6))
    said = () if even else ("readings lie on straight lines between full hours from the first",)
    return Hourly(air, found.begins, False, path.stem, said)


def read_air(path: str | Path) -> Ambient:
    """Air in time from any file that `read_weather` reads; of a table the readings as they are.

    Parameters
    ----------
    path : EPW, or a table; its readings need not be hourly, and lie on straight lines.

    Returns
    -------
    Ambient : from the first reading to the last.

    Raises
    ------
    InputError : unreadable file, no such column, time that goes back.
    """
    if not is_epw(Path(path)):
        return Ambient.from_csv(path)
    weather = read_epw(path)
    return weather.before(len(weather) - 1, len(weather) - 1)
