"""Weather by the hour: the hours before an earthquake, files, and made up from a climate."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.climate.generator import (
    MONTH_OF,
    YEAR,
    Climate,
    ColdSpells,
    _autoregressive,
    _daily_cycle,
    _hour_of_year,
    _mean_of_spells,
    _seasonal,
    _spells,
    load_climate,
)

STEPS = tb.Hourly([5.0, 4.0, 2.0, 3.0])
ALIKE = {"monthly_mean": [-3.0] * 12, "daily_range": [0.0] * 12, "weather_deviation": [0.0] * 12}
SPELLS = ColdSpells(months=[12, 1, 2], per_year=4.0, depth=6.0, length=96.0)


def test_air_before_an_earthquake() -> None:
    air = STEPS.before(2, history=1.5)  # in full hours
    assert_array_equal(air.time, [0.0, 3600.0, 7200.0])
    assert_array_equal(air.temperature, [5.0, 4.0, 2.0])


def test_typical_year_follows_itself() -> None:
    year = tb.Hourly(STEPS.temperature, recurs=True)
    assert_array_equal(year.before(1, history=3).temperature, [2.0, 3.0, 5.0, 4.0])
    assert_array_equal(year.hours_at(np.array([0.0, 0.99]), history=3), [0, 3])


def test_every_hour_is_as_probable() -> None:
    hours = STEPS.hours_at((np.arange(300) + 0.5) / 300, history=1)
    assert_array_equal(np.bincount(hours), [0, 100, 100, 100])


def test_dates_and_months() -> None:
    weather = tb.Hourly(np.zeros(48), begins=np.datetime64("2024-02-29T00"))
    assert_array_equal(weather.months, np.repeat([2, 3], 24))
    assert str(weather.to_frame()["date"].iloc[24]) == "2024-03-01 00:00:00"


@pytest.mark.parametrize(
    ("act", "told"),
    [
        (lambda: tb.Hourly([1.0]), "needs 2 to"),
        (lambda: tb.Hourly([1.0, np.nan]), "hour 1: nan degC is outside -100 to 100 degC"),
        (lambda: tb.Hourly([120.0, 1.0]), "hour 0: 120 degC"),
        (lambda: tb.Hourly(["a", "b"]), "needs a list of temperatures"),
        (lambda: STEPS.before(2, history=3), "hour 2 with 3 h before it: must be 3 to 3"),
        (lambda: STEPS.before(4, history=1), "must be 1 to 3"),
        (lambda: STEPS.before(2, history=0), "history = 0: must be 1 to"),
        (lambda: STEPS.hours_at([1.0]), "less than 1"),
        (lambda: STEPS.hours_at([0.5], history=4), "has 4 hours; a history of 4 h needs more"),
        (lambda: STEPS.months, "has no dates"),
        (lambda: load_climate("cold-twon"), 'did you mean "cold-town"?'),
        (lambda: tb.generate_weather("cold-town", years=0), "years = 0"),
        (lambda: tb.generate_weather("cold-town", seed=-1), "seed = -1"),
        (lambda: tb.generate_weather("cold-town", seed=0.5), "seed = 0.5"),
        (lambda: Climate(**{**ALIKE, "monthly_mean": [1.0] * 11}), "at least 12"),
        (lambda: Climate(**ALIKE, coldest_hour=14.0, warmest_hour=14.0), "the same"),
        (lambda: ColdSpells(**{**SPELLS.model_dump(), "months": [1, 1]}), "than once"),
    ],
)
def test_refused(act, told: str) -> None:
    with pytest.raises(tb.InputError) as caught:
        act()
    assert told in str(caught.value)


def test_file_of_a_climate_says_its_units(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    means = ", ".join(["-3.0"] * 12)
    file.write_text(f"monthly_mean = [{means}]\ndaily_range = []\n", encoding="utf-8")
    with pytest.raises(tb.InputError) as caught:
        load_climate(file)
    assert "weather_deviation" in str(caught.value)
    assert "degC" in str(caught.value)


def test_same_seed_same_weather() -> None:
    one, two, other = (tb.generate_weather("cold-town", 1, seed) for seed in (1, 1, 2))
    assert_array_equal(one.temperature, two.temperature)
    assert np.abs(one.temperature - other.temperature).max() > 1.0
    assert len(tb.generate_weather("cold-town", 4)) == 4 * 8760 + 24


def test_monthly_means_of_the_seasons_are_as_told() -> None:
    climate = load_climate("cold-town")
    curve = _seasonal(climate)
    means = [curve[month == MONTH_OF].mean() for month in range(12)]
    assert_allclose(means, climate.monthly_mean, atol=tol.MEAN)
    assert np.abs(np.diff(curve)).max() < 3.0  # no step between months


def test_day_goes_from_the_coldest_to_the_warmest_hour() -> None:
    cycle = _daily_cycle(6.0, 14.0)
    assert (int(cycle.argmin()), int(cycle.argmax())) == (6, 14)
    assert_allclose([cycle.mean(), np.ptp(cycle)], [0.0, 2.0], atol=tol.MEAN)


def test_place_in_the_year() -> None:
    dates = np.array(["2001-01-01T00", "2004-02-28T05", "2004-02-29T05", "2004-03-01T00"])
    places = _hour_of_year(dates.astype("datetime64[h]"))
    assert places.tolist() == [0, 58 * 24 + 5, 58 * 24 + 5, 59 * 24]
    assert _hour_of_year(np.datetime64("2004-12-31T23", "h")[None]).tolist() == [YEAR - 1]


def test_weather_has_its_deviation_and_memory() -> None:
    """Of a million hours: variance one, correlation 1/e after the memory."""
    series = _autoregressive(1_000_000, 48.0, np.random.default_rng(5))
    told = [series.std(), np.mean(series[48:] * series[:-48])]
    assert_allclose(told, [1.0, np.exp(-1.0)], atol=tol.MILLION_HOURS)


def test_weather_of_days_begins_as_it_goes_on() -> None:
    """Of 2000 series the first hour has the deviation of all: six standard errors are 0.1."""
    first = [_autoregressive(1, 48.0, np.random.default_rng(seed))[0] for seed in range(2000)]
    assert 0.9 < np.std(first) < 1.1


def test_spells_take_what_they_are_expected_to() -> None:
    """Of 1000 years; and nothing long after the months they begin in."""
    place = np.tile(np.arange(YEAR), 1000)
    taken = _spells(SPELLS, place, np.random.default_rng(6)).reshape(1000, YEAR)
    expected = _mean_of_spells(SPELLS)
    assert_allclose(expected.sum(), 4.0 * 6.0 * 96.0 / 2.0, rtol=tol.SUM_OF_HOURS)
    assert_allclose(taken.sum(axis=1).mean(), expected.sum(), rtol=tol.SPELLS)
    of_months = [
        [row[m == MONTH_OF].mean() for m in range(12)] for row in (taken.mean(0), expected)
    ]
    assert_allclose(*of_months, atol=tol.SPELLS)
    assert of_months[1][6] == 0.0


def test_weather_of_a_climate_has_its_monthly_means() -> None:
    """Of 100 years, spells and all; the standard error of a January is 0.2 K."""
    climate = load_climate("cold-town")
    weather = tb.generate_weather(climate, years=100, seed=8)
    means = [weather.temperature[weather.months == m].mean() for m in range(1, 13)]
    assert_allclose(means, climate.monthly_mean, atol=tol.MONTHLY_MEAN)
    january = weather.temperature[weather.months == 1]
    hours = january.reshape(-1, 24).mean(axis=0)
    assert_allclose(np.ptp(hours), climate.daily_range[0], atol=tol.MONTHLY_MEAN)


def test_nothing_but_the_mean() -> None:
    weather = tb.generate_weather(Climate(**ALIKE), years=1)
    assert_allclose(weather.temperature, -3.0, atol=tol.MEAN)
