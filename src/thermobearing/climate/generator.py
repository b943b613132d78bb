"""Climates as data, and a stochastic generator of hourly weather: seasons, days, cold spells.

    T(t) = M(t) + R(t)/2 c(h) + S(t) w(t) + S_s w_s(t) - spells(t) + their mean

M is linear between the middles of months and has the monthly means; c(h) is two half cosines
between the coldest and the warmest hour of the day; w and w_s are autoregressive of the first order
(an hour of white noise keeps exp(-1 h/memory)), of variance one: the weather of days, and whether a
season is mild. Cold spells are a Poisson process in their months; each deepens and fades as
sin^2 over its length; depth and length have gamma distributions. The mean effect of all spells is
added back, so that the monthly means stay as given.
"""

from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, field_validator

from thermobearing.bearing.ambient import COLDEST, HOTTEST
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.library import Library
from thermobearing.border.schema import OneLine, Strict, check_seed, in_unit, validated
from thermobearing.climate.hourly import DAY, Dates, Hourly
from thermobearing.core.records import Floats, Ints

DAYS = np.array([31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31])
FIRST_DAY = np.concatenate([[0], np.cumsum(DAYS)[:-1]])
MONTH_OF = np.repeat(np.arange(12), DAY * DAYS)  # of each hour of the year, from 0
YEAR = 365 * DAY  # of the tables below: 29 February equals the day before [h]
BEGINS = np.datetime64("2001-07-01T00", "h")  # so that winters are complete
LEAD_IN = 90 * DAY  # before the first hour, for spells that began earlier
SHAPE = 4.0  # of the gamma distributions of depth and length: half the mean as deviation
LENGTHS = 400  # of spells, that their mean is taken over

Temperature = Annotated[float, in_unit("degC"), Field(ge=COLDEST, le=HOTTEST)]
Difference = Annotated[float, in_unit("K"), Field(ge=0, le=60)]
Memory = Annotated[float, in_unit("h"), Field(ge=1, le=10_000)]
OfDay = Annotated[float, in_unit("h"), Field(ge=0, lt=24)]
Month = Annotated[int, Field(ge=1, le=12)]


class ColdSpells(Strict):
    """Cold spells added to the usual weather: mean number, depth [K] and length [h]."""

    months: Annotated[tuple[Month, ...], Field(min_length=1, max_length=12)]
    per_year: Annotated[float, Field(ge=0, le=50)]
    depth: Difference
    length: Annotated[float, in_unit("h"), Field(ge=6, le=1000)]

    @field_validator("months")
    @classmethod
    def _each_once(cls, months: tuple[int, ...]) -> tuple[int, ...]:
        if len(set(months)) < len(months):
            raise ValueError("one is given more than once")
        return months


class Climate(Strict):
    """Parameters of the weather generator; lists run from January to December.

    `daily_range` is the mean difference of the warmest and the coldest hour of a day; the
    deviations are standard deviations, and their memory the time in which the correlation falls to
    1/e.
    """

    name: Annotated[str, Field(min_length=1, max_length=60), OneLine] = "climate"
    description: str = ""
    note: str = ""
    monthly_mean: Annotated[tuple[Temperature, ...], Field(min_length=12, max_length=12)]
    daily_range: Annotated[tuple[Difference, ...], Field(min_length=12, max_length=12)]
    coldest_hour: OfDay = 6.0
    warmest_hour: OfDay = 14.0
    weather_deviation: Annotated[tuple[Difference, ...], Field(min_length=12, max_length=12)]
    weather_memory: Memory = 48.0
    season_deviation: Difference = 0.0
    season_memory: Memory = 1440.0
    cold_spells: ColdSpells | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        hours = [values.get("coldest_hour", "6 h"), values.get("warmest_hour", "14 h")]
        return ["coldest_hour and warmest_hour are the same"] if hours[0] == hours[1] else []


CLIMATES = Library("climate", "climates")


def load_climate(name_or_path: str | Path) -> Climate:
    """Return a climate of the library by name, or from your own TOML file."""
    table, where = CLIMATES.read(name_or_path)
    return validated(Climate, table, where)


@checked
def generate_weather(climate: str | Path | Climate, years: int = 50, seed: int = 0) -> Hourly:
    """Return hourly weather of a climate; the same numbers give the same weather.

    Parameters
    ----------
    climate : a name, a path, or a climate from `load_climate`.
    years : from 1 July to 30 June, 1 to 1000.
    seed : of the random numbers, 0 or more.

    Raises
    ------
    InputError : no such climate, a number of years or a seed outside its range.

    Examples
    --------
    >>> weather = generate_weather("cold-town", years=2, seed=3)
    >>> len(weather), bool(weather.temperature.min() < -15.0)
    (17520, True)
    """
    parameters = climate if isinstance(climate, Climate) else load_climate(climate)
    hours = _hours(years)
    check_seed(seed, parameters.name)
    random = np.random.default_rng(seed)
    # Spells that begin before the first hour count, so the series begins earlier.
    dates = BEGINS - np.timedelta64(LEAD_IN, "h") + np.arange(LEAD_IN + hours, dtype="m8[h]")
    place = _hour_of_year(dates)
    temperature = _seasonal(parameters)[place]
    for deviation, memory in (
        (_through_year(parameters.weather_deviation), parameters.weather_memory),
        (np.full(YEAR, parameters.season_deviation), parameters.season_memory),
    ):
        temperature += deviation[place] * _autoregressive(len(dates), memory, random)
    if parameters.cold_spells is not None:
        temperature += _mean_of_spells(parameters.cold_spells)[place]
        temperature -= _spells(parameters.cold_spells, place, random)
    return Hourly(temperature[LEAD_IN:], BEGINS, name=parameters.name)


def _hours(years: int) -> int:
    if isinstance(years, bool) or not isinstance(years, int) or not 1 <= years <= 1000:
        raise InputError(f"years = {years!r}: must be an integer from 1 to 1000")
    later = BEGINS.astype("datetime64[M]") + np.timedelta64(12 * years, "M")
    return int((later.astype("datetime64[h]") - BEGINS) // np.timedelta64(1, "h"))


def _hour_of_year(dates: Dates) -> Ints:
    """Return the index of each date in a common year, 0 to 8759; 29 February equals the 28th."""
    months = dates.astype("datetime64[M]")
    month = months.astype(np.int64) % 12
    into = ((dates - months.astype("datetime64[h]")) // np.timedelta64(1, "h")).astype(np.int64)
    into = np.where((month == 1) & (into >= 28 * DAY), into - DAY, into)
    return np.asarray(DAY * FIRST_DAY[month] + into)


def _through_year(monthly: Any) -> Floats:
    """Return monthly values interpolated linearly between mid-months, for each hour of the year."""
    middles = DAY * (FIRST_DAY + 0.5 * DAYS)
    hours = np.arange(YEAR) + 0.5
    return np.asarray(np.interp(hours, middles, np.asarray(monthly), period=YEAR))


def _seasonal(climate: Climate) -> Floats:
    """Return the expected temperature at each hour of a year [degC]; monthly means are exact."""
    # Straight lines through monthly means would miss them: values at mid-months are solved for, so
    # that the means over months are exact.
    units = np.array([_through_year(row) for row in np.eye(12)])
    means = np.array([[row[m == MONTH_OF].mean() for row in units] for m in range(12)])
    curve = np.linalg.solve(means, np.asarray(climate.monthly_mean)) @ units
    cycle = _daily_cycle(climate.coldest_hour, climate.warmest_hour)
    ranges = np.asarray(climate.daily_range)[MONTH_OF]
    return np.asarray(curve + 0.5 * ranges * np.tile(cycle, YEAR // DAY))


def _daily_cycle(coldest: float, warmest: float) -> Floats:
    """Return 24 values: -1 at the coldest hour 1 at the warmest, and a mean of zero."""
    rise = (warmest - coldest) % DAY
    since = (np.arange(DAY) - coldest) % DAY
    phase = np.where(since < rise, since / rise, 1.0 + (since - rise) / (DAY - rise))
    wave = -np.cos(np.pi * phase)
    return np.asarray(wave - wave.mean())


def _autoregressive(count: int, memory: float, random: np.random.Generator) -> Floats:
    """Return a stationary series of variance one whose correlation falls to 1/e in `memory` [h]."""
    from scipy.signal import lfilter

    kept = float(np.exp(-1.0 / memory))
    noise = random.standard_normal(count + 1)
    # The filter begins in its stationary state, so that the first hour is like any other.
    begin = np.array([kept * noise[0]])
    series, _ = lfilter([np.sqrt(1.0 - kept * kept)], [1.0, -kept], noise[1:], zi=begin)
    return np.asarray(series)


def _spell_rate(spells: ColdSpells) -> Floats:
    """Return the mean number of spells that begin in each hour of the year."""
    eligible = np.isin(MONTH_OF + 1, spells.months)
    return np.asarray(spells.per_year * eligible / eligible.sum())


def _shape(since: Floats, length: float | Floats) -> Floats:
    """Return the share of its depth that a spell has reached some hours after it began."""
    return np.where(since < length, np.sin(np.pi * since / length) ** 2, 0.0)


def _mean_of_spells(spells: ColdSpells) -> Floats:
    """Return the mean reduction by all spells at each hour of the year [K]."""
    from scipy.stats import gamma

    shares = (np.arange(LENGTHS) + 0.5) / LENGTHS
    lengths = gamma.ppf(shares, SHAPE, scale=spells.length / SHAPE)
    since = np.arange(np.ceil(lengths.max()))
    mean_spell = spells.depth * _shape(since[:, None], lengths[None, :]).mean(axis=1)
    # Two years, since spells of December reach into January.
    rate = np.concatenate([_spell_rate(spells), _spell_rate(spells)])
    return np.asarray(np.convolve(rate, mean_spell)[YEAR : 2 * YEAR])


def _spells(spells: ColdSpells, place: Ints, random: np.random.Generator) -> Floats:
    """Return the reduction by random spells at each hour of a series [K]."""
    rate = _spell_rate(spells)[place]
    eligible = np.flatnonzero(rate > 0.0)
    reduction = np.zeros(len(place))
    if not len(eligible):
        return reduction
    count = random.poisson(rate.sum())
    starts = eligible[random.integers(0, len(eligible), count)]
    depths = random.gamma(SHAPE, spells.depth / SHAPE, count)
    lengths = random.gamma(SHAPE, spells.length / SHAPE, count)
    for start, depth, length in zip(starts, depths, lengths, strict=True):
        # Spells overlap, and those at the end are cut.
        part = reduction[start : start + int(np.ceil(length))]
        part += depth * _shape(np.arange(len(part), dtype=np.float64), length)
    return reduction
