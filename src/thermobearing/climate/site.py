"""Cold of a site: design temperature for stiffening, and cold days in a row for crystallization.

The two statistics are those of the study of low-temperature exposure of bearings in Canada (see
docs/exposure.md): rubber stiffens at once with its temperature, and crystallizes in days in a row
below a temperature. Means of days stand for the rubber, which lags hours behind the air.
"""

from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np

from thermobearing.border.errors import InputError, nearest
from thermobearing.border.lazy import pd
from thermobearing.border.opener import is_file, is_folder
from thermobearing.climate.generator import CLIMATES, generate_weather
from thermobearing.climate.hourly import DAY, Hourly
from thermobearing.climate.readers import read_weather
from thermobearing.core.records import Floats, Ints
from thermobearing.quantities.governing import place_of_least

YEAR = 365  # days of a winter year, at least
RETURN_PERIOD = 50  # of the design temperature [year]
PERIODS = (2, 10, RETURN_PERIOD)
FEWEST = 10  # winters for return periods
LIMITS = tuple(range(0, -41, -5))  # of cold days [degC]
SAMPLES, ENDS = 1000, (0.05, 0.95)  # of the bootstrap
EULER = float(np.euler_gamma)


def as_weather(weather: str | Path | Hourly) -> Hourly:
    """Return hourly weather, read from a file or generated from a climate."""
    if isinstance(weather, Hourly):
        return weather
    name = str(weather)
    if name in CLIMATES.names() or name.endswith(".toml"):
        return generate_weather(name)
    if not (is_file(Path(name)) or is_folder(Path(name))):
        raise InputError(f'no file "{name}", and no climate{nearest(name, CLIMATES.names())}')
    return read_weather(name)


@dataclass(frozen=True)
class Site:
    """Statistics of the cold of a site.

    The design temperature for instantaneous stiffening is a daily mean: that of the return period,
    or the lowest on record where there are fewer than ten winters.
    """

    name: str  # of the weather
    winters: int  # complete years from summer to summer
    design_temperature: float  # [degC]
    return_period: int | None  # [year]; None for the lowest on record
    stiffening: "pd.DataFrame"  # coldest daily mean of a winter by return period, 90 % interval
    cold_days: "pd.DataFrame"  # number and longest run of days below temperatures


def find_cold(weather: str | Path | Hourly, return_period: int = RETURN_PERIOD) -> Site:
    """Return the cold of a site: for instantaneous stiffening, and for crystallization.

    The coldest daily mean of each winter follows a Gumbel distribution (L-moments; interval from
    1000 bootstrap samples). A day is cold if its mean is below a limit, or its highest temperature
    ("all day"). Return periods of runs of days are those of the record (Weibull's plotting
    positions) and are left out where the record is too short. `return_period` is that of the design
    temperature [year].

    >>> site = find_cold("cold-town")
    >>> site.winters, site.return_period, -40.0 < site.design_temperature < -25.0
    (50, 50, True)
    """
    if not 2 <= return_period <= 1000:
        raise InputError(f"return_period = {return_period}: must be from 2 to 1000 years")
    series = as_weather(weather)
    winters = _winters(series)
    coldest = np.array([winter.mean(axis=1).min() for winter in winters])
    design = float(coldest.min())
    nothing = dict.fromkeys(("return_period_years", "daily_mean_low_degC"), float("nan"))
    rows = [nothing | {"daily_mean_degC": design, "daily_mean_high_degC": float("nan")}]
    rows[0]["hour_degC"] = min(float(winter.min()) for winter in winters)
    if has_periods := len(winters) >= FEWEST:
        # A fixed seed: the same weather has the same interval.
        random = np.random.default_rng(0)
        resampled = coldest[random.integers(0, len(coldest), (SAMPLES, len(coldest)))]
        for period in sorted({*PERIODS, return_period}):
            low, high = np.quantile(_gumbel_minimum(resampled, period), ENDS)
            level = float(_gumbel_minimum(coldest, period))
            rows.append({"return_period_years": float(period), "daily_mean_degC": level})
            rows[-1] |= {"daily_mean_low_degC": float(low), "daily_mean_high_degC": float(high)}
            design = level if period == return_period else design
    return Site(
        series.name,
        len(winters),
        design,
        return_period if has_periods else None,
        pd.DataFrame(rows),
        _cold_days(winters),
    )


def _winters(series: Hourly) -> list[Floats]:
    """Return the temperature of the complete winter years, [days, 24] each.

    A year begins half a year after its coldest month, so that no winter is cut; without dates, at
    the first hour.
    """
    values = series.temperature
    if series.begins is None:
        days = values[: len(values) // DAY * DAY].reshape(-1, DAY)
        starts = np.arange(0, len(days) - YEAR + 1, YEAR)
        winters = [days[start : start + YEAR] for start in starts]
    else:
        dates = series.dates
        if series.recurs:  # a typical year twice holds one complete winter
            values = np.tile(values, 2)
            dates = series.begins + np.arange(len(values), dtype="m8[h]")
        # Days begin at midnight; hours before the first midnight are left out.
        first = int(-(dates[0] - dates[0].astype("datetime64[D]")).astype(np.int64) % DAY)
        days = values[first : first + (len(values) - first) // DAY * DAY].reshape(-1, DAY)
        dates = dates[first::DAY][: len(days)].astype("datetime64[D]")
        months = dates.astype("datetime64[M]").astype(np.int64)
        monthly = [days[months % 12 == k] for k in range(12)]
        means = [month.mean() if len(month) else np.inf for month in monthly]
        # Half a year after the coldest month, in either hemisphere.
        begins = (place_of_least(means) + 6) % 12
        years = (months - begins) // 12
        winters = [days[years == year] for year in np.unique(years)]
        winters = [winter for winter in winters if len(winter) >= YEAR][
            : 1 if series.recurs else None
        ]
    if not winters:
        raise InputError(
            f"has {len(series) / DAY:.0f} days; the cold of a site needs a complete year from "
            "summer to summer",
            series.name,
        )
    return winters


def _gumbel_minimum(lowest: Floats, period: float) -> Floats:
    """Return the level that minima fall below once in a period, along the last axis.

    L-moments of the negative values: scale = l2 / ln 2, location = l1 - 0.5772 scale.
    """
    values = np.sort(-lowest, axis=-1)
    count = values.shape[-1]
    weights = (2.0 * np.arange(count) - (count - 1)) / (count * (count - 1))
    scale = (values @ weights) / np.log(2.0)
    location = values.mean(axis=-1) - EULER * scale
    return np.asarray(-(location - scale * np.log(-np.log1p(-1.0 / period))))


def _cold_days(winters: list[Floats]) -> "pd.DataFrame":
    """Return number and longest run of days below each temperature that some day is below."""
    means = [winter.mean(axis=1) for winter in winters]
    highest = [winter.max(axis=1) for winter in winters]
    rows = []
    for limit in LIMITS:
        counts = np.array([int((winter < limit).sum()) for winter in means])
        runs, all_day = (
            np.array([_longest_run(winter < limit) for winter in daily])
            for daily in (means, highest)
        )
        # Limits that no day reaches have no row.
        if counts.any():
            row = {"limit_degC": float(limit), "days_per_year": float(counts.mean())}
            row |= {"run_mean_days": float(runs.mean()), "run_10_years_days": _once_in(runs, 10)}
            row |= {"run_50_years_days": _once_in(runs, 50), "run_longest_days": int(runs.max())}
            rows.append(row | {"run_all_day_days": int(all_day.max())})
    return pd.DataFrame(rows)


def _longest_run(below: "np.typing.NDArray[np.bool_]") -> int:
    """Return the largest number of days in a row."""
    return max((sum(1 for _ in days) for cold, days in groupby(below) if cold), default=0)


def _once_in(runs: Ints, period: int) -> float:
    """Return the run that is exceeded once in a period [year]; NaN if the record is too short."""
    if len(runs) < period - 1:
        return float("nan")
    return float(np.quantile(runs, 1.0 - 1.0 / period, method="weibull"))
