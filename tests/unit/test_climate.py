"""Ambient series, weather by the hour, weather files, and weather made up from a climate."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.inputs import SPECIMEN, assert_refused
from thermobearing.climate import generator
from thermobearing.climate.site import find_cold
from thermobearing.cyclic.case import make_case
from thermobearing.cyclic.run import run_case
from thermobearing.design.run import run_factors
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.earthquake.run import build_tasks

STEPS = tb.Hourly([5.0, 4.0, 2.0, 3.0])
ALIKE = {"monthly_mean": [-3.0] * 12, "daily_range": [0.0] * 12, "weather_deviation": [0.0] * 12}
SPELLS = generator.ColdSpells(months=[12, 1, 2], per_year=4.0, depth=6.0, length=96.0)


def test_hours_before_an_earthquake_and_a_typical_year() -> None:
    air = STEPS.before(2, history=1.5)  # in full hours
    assert_array_equal(air.time, [0.0, 3600.0, 7200.0])
    assert_array_equal(air.temperature, [5.0, 4.0, 2.0])
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
    ("act", "reported"),
    [
        (lambda: tb.Hourly([1.0]), "needs 2 to"),
        (lambda: tb.Hourly([1.0, np.nan]), "hour 1: nan degC is outside -100 to 100 degC"),
        (lambda: tb.Hourly([120.0, 1.0]), "hour 0: 120 degC"),
        (lambda: tb.Hourly(["a", "b"]), "must be a list of numbers"),
        (lambda: STEPS.before(2, history=3), "hour 2 with 3 h before it: must be 3 to 3"),
        (lambda: STEPS.before(4, history=1), "must be 1 to 3"),
        (lambda: STEPS.before(2, history=0), "history = 0: must be 1 to"),
        (lambda: STEPS.hours_at([1.0]), "less than 1"),
        (lambda: STEPS.hours_at([0.5], history=4), "has 4 hours; a history of 4 h needs more"),
        (lambda: STEPS.months, "has no dates"),
        (lambda: generator.load_climate("cold-twon"), 'did you mean "cold-town"?'),
        (lambda: tb.generate_weather("cold-town", years=0), "years = 0"),
        (lambda: tb.generate_weather("cold-town", seed=-1), "seed = -1"),
        (lambda: tb.generate_weather("cold-town", seed=0.5), "seed = 0.5"),
        (lambda: generator.Climate(**{**ALIKE, "monthly_mean": [1.0] * 11}), "at least 12"),
        (lambda: generator.Climate(**ALIKE, coldest_hour=14.0, warmest_hour=14.0), "the same"),
        (lambda: generator.ColdSpells(**{**SPELLS.model_dump(), "months": [1, 1]}), "than once"),
    ],
)
def test_refused(act, reported: str) -> None:
    assert_refused(act, reported)


def test_same_seed_same_weather() -> None:
    one, two, other = (tb.generate_weather("cold-town", 1, seed) for seed in (1, 1, 2))
    assert_array_equal(one.temperature, two.temperature)
    assert np.abs(one.temperature - other.temperature).max() > 1.0
    assert len(tb.generate_weather("cold-town", 4)) == 4 * 8760 + 24


def test_monthly_means_of_the_seasons_are_as_given() -> None:
    climate = generator.load_climate("cold-town")
    curve = generator._seasonal(climate)
    means = [curve[month == generator.MONTH_OF].mean() for month in range(12)]
    assert_allclose(means, climate.monthly_mean, atol=tol.MEAN)
    assert np.abs(np.diff(curve)).max() < 3.0  # no step between months


def test_day_goes_from_the_coldest_to_the_warmest_hour() -> None:
    cycle = generator._daily_cycle(6.0, 14.0)
    assert (int(cycle.argmin()), int(cycle.argmax())) == (6, 14)
    assert_allclose([cycle.mean(), np.ptp(cycle)], [0.0, 2.0], atol=tol.MEAN)


def test_place_in_the_year() -> None:
    dates = np.array(["2001-01-01T00", "2004-02-28T05", "2004-02-29T05", "2004-03-01T00"])
    places = generator._hour_of_year(dates.astype("datetime64[h]"))
    assert places.tolist() == [0, 58 * 24 + 5, 58 * 24 + 5, 59 * 24]
    assert generator._hour_of_year(np.datetime64("2004-12-31T23", "h")[None]).tolist() == [
        generator.YEAR - 1
    ]


def test_weather_has_its_deviation_and_memory() -> None:
    """Of a million hours: variance one, correlation 1/e after the memory."""
    series = generator._autoregressive(1_000_000, 48.0, np.random.default_rng(5))
    reported = [series.std(), np.mean(series[48:] * series[:-48])]
    assert_allclose(reported, [1.0, np.exp(-1.0)], atol=tol.MILLION_HOURS)


def test_weather_of_days_begins_as_it_goes_on() -> None:
    """Of 2000 series the first hour has the deviation of all: six standard errors are 0.1."""
    first = [
        generator._autoregressive(1, 48.0, np.random.default_rng(seed))[0] for seed in range(2000)
    ]
    assert 0.9 < np.std(first) < 1.1


def test_spells_take_what_they_are_expected_to() -> None:
    """Of 1000 years; and nothing long after the months they begin in."""
    place = np.tile(np.arange(generator.YEAR), 1000)
    taken = generator._spells(SPELLS, place, np.random.default_rng(6)).reshape(1000, generator.YEAR)
    expected = generator._mean_of_spells(SPELLS)
    assert_allclose(expected.sum(), 4.0 * 6.0 * 96.0 / 2.0, rtol=tol.SUM_OF_HOURS)
    assert_allclose(taken.sum(axis=1).mean(), expected.sum(), rtol=tol.SPELLS)
    of_months = [
        [row[m == generator.MONTH_OF].mean() for m in range(12)]
        for row in (taken.mean(0), expected)
    ]
    assert_allclose(*of_months, atol=tol.SPELLS)
    assert of_months[1][6] == 0.0


def test_weather_of_a_climate_has_its_monthly_means() -> None:
    """Of 100 years, spells and all; the standard error of a January is 0.2 K."""
    climate = generator.load_climate("cold-town")
    weather = tb.generate_weather(climate, years=100, seed=8)
    means = [weather.temperature[weather.months == m].mean() for m in range(1, 13)]
    assert_allclose(means, climate.monthly_mean, atol=tol.MONTHLY_MEAN)
    january = weather.temperature[weather.months == 1]
    hours = january.reshape(-1, 24).mean(axis=0)
    assert_allclose(np.ptp(hours), climate.daily_range[0], atol=tol.MONTHLY_MEAN)


def test_nothing_but_the_mean() -> None:
    weather = tb.generate_weather(generator.Climate(**ALIKE), years=1)
    assert_allclose(weather.temperature, -3.0, atol=tol.MEAN)


HEADER = [
    "LOCATION,Cold Town,-,XXX,example,000000,43.0,143.0,9.0,100.0",
    "DESIGN CONDITIONS,0",
    "TYPICAL/EXTREME PERIODS,0",
    "GROUND TEMPERATURES,0",
    "HOLIDAYS/DAYLIGHT SAVINGS,No,0,0,0",
    "COMMENTS 1,made for a test",
    "COMMENTS 2,",
    "DATA PERIODS,1,1,Data,Sunday, 1/ 1,12/31",
]
Change = Callable[[list[list[str]]], object]


def epw_lines(first: str = "1990-01-01", hours: int = 8760, year: int | None = None) -> list[list]:
    """Cells of hours whose temperature is their number, from -30 degC on."""
    starts = np.datetime64(first, "h") + np.arange(hours, dtype="m8[h]")
    rows = []
    for k, start in enumerate(starts):
        day = start.astype("datetime64[D]")
        hour = int((start - day.astype("datetime64[h]")).astype(int)) + 1
        y, m, d = str(day).split("-")
        rows.append(
            [year or y, int(m), int(d), hour, 0, "?9", f"{-30 + 0.005 * k:.3f}", "-40", "9"]
        )
    return rows


def write(folder: Path, rows: list[list], name: str = "town.epw") -> Path:
    file = folder / name
    lines = [*HEADER, *(",".join(str(cell) for cell in row) for row in rows)]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return file


def test_year_of_an_epw_file(tmp_path: Path) -> None:
    weather = tb.read_weather(write(tmp_path, epw_lines()))
    assert (weather.name, len(weather), weather.recurs) == ("Cold Town", 8760, True)
    assert str(weather.begins) == "1990-01-01T01"  # a line tells the end of its hour
    assert_allclose(weather.temperature, -30.0 + 0.005 * np.arange(8760), atol=tol.MEAN)
    assert weather.assumptions == ()


def test_months_of_several_years(tmp_path: Path) -> None:
    """A typical year: January of 1995, the rest of a leap year without its 29 February."""
    rows = epw_lines()
    for row in rows:
        row[0] = 1995 if row[1] == 1 else 1992
    weather = tb.read_weather(write(tmp_path, rows, "typical.csv"))
    assert weather.recurs
    assert "several years" in weather.assumptions[0]
    assert str(weather.begins) == "2001-01-01T01"


def test_leap_year_and_part_of_a_year(tmp_path: Path) -> None:
    leap = tb.read_weather(write(tmp_path, epw_lines("1992-01-01", 8784)))
    assert (len(leap), leap.recurs) == (8784, True)
    part = tb.read_weather(write(tmp_path, epw_lines("1992-02-20", 480)))
    assert (len(part), part.recurs, str(part.dates[-1])) == (480, False, "1992-03-11T00")


def _set(row: int, cell: int, value: object) -> Change:
    return lambda rows: rows[row].__setitem__(cell, value)


def test_missing_hours_lie_on_a_line(tmp_path: Path) -> None:
    rows = epw_lines(hours=48)
    for k in (5, 6, 20):
        rows[k][6] = "99.9"
    weather = tb.read_weather(write(tmp_path, rows))
    assert_allclose(weather.temperature, -30.0 + 0.005 * np.arange(48), atol=tol.MEAN)
    assert weather.assumptions == ("3 hours without a temperature were interpolated linearly",)


def _long_gap(rows: list[list[str]]) -> None:
    for row in rows[10:17]:
        row[6] = "99.9"


@pytest.mark.parametrize(
    ("change", "reported"),
    [
        (_long_gap, "line 19: no temperature for 7 h in a row"),
        (_set(0, 6, "99.9"), "the first and the last hour"),
        (_set(3, 6, "cold"), "line 12: not a number"),
        (_set(3, 3, 25), "line 12: no such time: month 1, day 1, hour 25"),
        (_set(3, 3, 9), "line 12: 1/1 hour 9 does not follow 1/1 hour 3 of line 11"),
        (lambda rows: rows.pop(7), "line 16: 1/1 hour 9 does not follow 1/1 hour 7 of line 15"),
        (_set(3, 2, 31), "does not follow"),
        (lambda rows: [row.__setitem__(1, 4) or row.__setitem__(2, 31) for row in rows], "no day"),
        (lambda rows: rows.clear(), "has 0 hours"),
        (lambda rows: rows[4].__delitem__(slice(4, None)), "line 13: has 4 columns"),
        (_set(4, 6, "-140"), "hour 4: -140 degC is outside"),
    ],
)
def test_bad_epw(tmp_path: Path, change: Change, reported: str) -> None:
    rows = epw_lines(hours=48)
    change(rows)
    file = write(tmp_path, rows)
    assert_refused(lambda: tb.read_weather(file), reported)


def table(folder: Path, rows: list[str], title: str = "time,temperature_degC") -> Path:
    file = folder / "town.csv"
    file.write_text("\n".join([title, *rows]) + "\n", encoding="utf-8")
    return file


def test_table_with_stamps(tmp_path: Path) -> None:
    rows = ["30.01.2024 23:00,-8", "30.01.2024 23:10,-9", "31.01.2024 00:00,-4"]
    rows += [f"31.01.2024 {hour:02d}:00,{hour - 4}" for hour in range(1, 4)]
    weather = tb.read_weather(table(tmp_path, rows))
    assert_array_equal(weather.temperature, [-8.0, -4.0, -3.0, -2.0, -1.0])
    assert (str(weather.begins), weather.recurs) == ("2024-01-30T23", False)
    assert "interpolated" in weather.assumptions[0]


def test_table_without_dates(tmp_path: Path) -> None:
    weather = tb.read_weather(table(tmp_path, ["0,20", "1,30"], "time_hour,temperature_degF"))
    assert_allclose(weather.temperature, [-20.0 / 3.0, -10.0 / 9.0], atol=tol.CONVERSION)
    assert weather.begins is None
    assert weather.assumptions == ()


@pytest.mark.parametrize(
    ("rows", "reported"),
    [
        ([f"2024-10-27 0{h}:00,1" for h in (1, 2, 1)], "from reading 2 to 3; use one time zone"),
        ([f"2024-01-01 0{h}:00,1" for h in (0, 1, 8)], "7 h without a reading after reading 2"),
        (["2024-01-01 00:00,1", "2024-01-01 01:00,"], "line 3"),
        ([f"2024-01-01 0{h}:00,{99 + h}" for h in range(3)], "hour 2: 101 degC is outside -100"),
    ],
)
def test_bad_table(tmp_path: Path, rows: list[str], reported: str) -> None:
    file = table(tmp_path, rows)
    assert_refused(lambda: tb.read_weather(file), reported, "town")


def test_any_analysis_reads_the_files_that_studies_read(tmp_path: Path) -> None:
    """A week of EPW before an earthquake, at a line, in a test: as the same hours in a table."""
    epw = write(tmp_path, epw_lines("1990-01-10", 168))
    hourly = tb.read_weather(epw)
    table = tmp_path / "town.csv"
    rows = [f"{date};{air:.4f}".replace(".", ",") for date, air in _rows(hourly)]
    table.write_text("\n".join(["time;temperature_degC", *rows]))
    result = []
    for file in (epw, table):
        words = {"duration": "1 s", "analysis": {"keep": ["rubber", "cells"]}}
        line = [{"line": "G1-G5", "weather": str(file)}]
        for changes in ({"weather": str(file)}, {"lines": line, "ambient": ["20 degC"]}):
            case = {"bearings": ["shen-lhdr-bridge"], "motions": ["jra-ii-i-1"]} | words | changes
            (task,) = build_tasks(make_earthquake_case(case, "test"))
            result.append((task.reported.temperature, task.reported.lead))
        test = tb.cyclic_test(strain=[0.2], cycles=1)
        done = make_case(
            {"ambient_series": str(file)}, "test", bearing="shen-hdr-specimen", test=test
        )
        result.append((run_case(done)["temperature"].values, None))
    for (cells, lead), (other, other_lead) in zip(result[:3], result[3:], strict=True):
        assert_array_equal(cells, other)
        assert lead == other_lead
    assert result[0][0][0] < -28.0  # it is as cold as the file


def _rows(hourly: tb.Hourly) -> list[tuple[str, float]]:
    dates = [str(date).replace("T", " ") + ":00" for date in hourly.dates]
    return list(zip(dates, hourly.temperature.tolist(), strict=True))


def test_faults_of_an_epw_file_are_reported_by_any_analysis(tmp_path: Path) -> None:
    rows = epw_lines("1990-01-10", 48)
    file = write(tmp_path, rows[:10] + rows[20:])
    with pytest.raises(tb.InputError, match=r"weather: .*town\.epw: line 19: .* does not follow"):
        make_earthquake_case({"weather": str(file)}, "test")


NIGHT = tb.Ambient.series(np.array([10.0, 20.0, 40.0]), np.array([0.0, -10.0, 10.0]))


def test_points_between_and_beyond() -> None:
    assert [NIGHT.at(t) for t in (0.0, 10.0, 15.0, 20.0, 30.0, 99.0)] == [0, 0, -5, -10, 0, 10]


@pytest.mark.parametrize(
    ("start", "dt", "mean"),
    [
        (0.0, 5.0, 0.0),  # before the series begins
        (10.0, 5.0, -2.5),
        (8.0, 4.0, -0.5),  # over the first point: (2 * 0 + 2 * -1) / 4
        (15.0, 10.0, -7.5),  # over a turn: (5 * -7.5 + 5 * -7.5) / 10
        (10.0, 30.0, -5.0 / 3.0),  # the whole series in one step: (-50 + 0) / 30
        (0.0, 100.0, 5.5),  # and far beyond: (-50 + 60 * 10) / 100
        (90.0, 1.0, 10.0),
    ],
)
def test_means_by_hand(start: float, dt: float, mean: float) -> None:
    assert_allclose(NIGHT.means(start, np.array([dt])), [mean], rtol=tol.MEAN, atol=tol.MEAN)


def test_means_add_up_whatever_the_steps() -> None:
    """Sums over uneven steps that hit no point of the series equal the integral."""
    rng = np.random.default_rng(4)
    series = tb.Ambient.series(np.cumsum(rng.uniform(0.1, 9.0, 50)), rng.uniform(-40.0, 40.0, 50))
    dt = rng.uniform(0.001, 30.0, 40)
    span = dt.sum()
    fine = series.means(1.7, np.full(1000, span / 1000))
    total = float(series.means(1.7, dt) @ dt)
    assert_allclose(total, fine.sum() * span / 1000, rtol=tol.MEAN)
    inside = series.time[(series.time > 1.7) & (series.time < 1.7 + span)]
    nodes = np.concatenate([[1.7], inside, [1.7 + span]])
    values = [series.at(node) for node in nodes]
    assert_allclose(total, np.trapezoid(values, nodes), rtol=tol.MEAN)


def test_run_begins_at_the_start_of_the_series_and_follows_it() -> None:
    """After a long rest under a steady end of the series, the bearing has its temperature."""
    series = tb.Ambient.series([0.0, 600.0], [5.0, -15.0])
    test = tb.CyclicTest(steps=[{"step": "rest", "duration": 1e6}])
    result = tb.run(SPECIMEN, test, ambient=series)
    assert result["ambient"].values.tolist() == [5.0]
    assert_array_equal(result["initial_temperature"].values[0], 5.0)
    assert_allclose(result["final_temperature"].values[0], -15.0, atol=tol.SETTLED)


@pytest.mark.parametrize(
    ("time", "temperature", "words"),
    [
        ([0.0, 5.0, 5.0], [0.0, 1.0, 2.0], "does not increase from 5 to 5 s"),
        ([0.0, 5.0, 4.0], [0.0, 1.0, 2.0], "does not increase from 5 to 4 s"),
        ([0.0, 5.0], [0.0, 101.0], "101 degC is outside -100 to 100 degC"),
        ([0.0, 5.0], [-101.0, 0.0], "-101 degC is outside"),
        ([0.0], [0.0], "at least 2 numbers"),
        ([0.0, np.inf], [0.0, 0.0], "not finite"),
    ],
)
def test_unusable_series(time: list[float], temperature: list[float], words: str) -> None:
    with pytest.raises(tb.InputError, match=words):
        tb.Ambient.series(np.array(time), np.array(temperature))


def _winters(lowest: list[float]) -> tb.Hourly:
    """Return years of 10 degC with one cold day each, on 1 January."""
    ends = [np.datetime64(f"{2001 + k}-07-01") for k in range(len(lowest) + 1)]
    days = np.full((int((ends[-1] - ends[0]).astype(int)), 24), 10.0)
    for end, cold in zip(ends, lowest, strict=False):
        days[int((end - ends[0]).astype(int)) + 184] = cold
    return tb.Hourly(days.ravel(), begins=ends[0])


def test_design_temperature_of_a_gumbel_distribution() -> None:
    """Quantiles of a Gumbel distribution (-20 degC, scale 3 K) come back, and their order."""
    place, scale, count = -20.0, 3.0, 400
    shares = (np.arange(count) + 0.5) / count
    lowest = place + scale * np.log(-np.log(shares))
    result = find_cold(_winters(lowest.tolist()), return_period=50)
    exact = place + scale * np.log(-np.log(1.0 - 1.0 / 50.0))
    assert result.winters == count
    assert_allclose(result.design_temperature, exact, atol=0.05)
    assert result.stiffening["daily_mean_degC"].iloc[0] == lowest.min()
    rows = result.stiffening.iloc[1:]
    assert rows["return_period_years"].tolist() == [2.0, 10.0, 50.0]
    assert (np.diff(rows["daily_mean_degC"]) < 0.0).all()
    assert (rows["daily_mean_low_degC"] < rows["daily_mean_degC"]).all()
    assert (rows["daily_mean_degC"] < rows["daily_mean_high_degC"]).all()


def test_consecutive_cold_days() -> None:
    """A run counts by daily means, "all day" by highest temperatures; winters are not cut."""
    days = np.full((365, 24), 10.0)
    days[100:103] = -7.0  # three days, of which the second has a mild hour
    days[101, 14] = 1.0
    days[200] = -7.0
    series = tb.Hourly(np.tile(days.ravel(), 2))
    result = find_cold(series).cold_days.set_index("limit_degC")
    assert result.index.tolist() == [0.0, -5.0]
    assert result.loc[-5.0, ["days_per_year", "run_mean_days"]].tolist() == [4.0, 3.0]
    assert result.loc[-5.0, ["run_longest_days", "run_all_day_days"]].tolist() == [3, 1]
    assert np.isnan(result["run_10_years_days"]).all()  # two winters
    ten = find_cold(tb.Hourly(np.tile(days.ravel(), 10))).cold_days
    assert ten["run_10_years_days"].tolist() == [3.0, 3.0]


def test_a_typical_year_has_one_winter_and_no_return_period() -> None:
    days = np.full((365, 24), 10.0)
    days[:2] = days[-3:] = -12.0  # a cold spell over the turn of the year
    days[331:338] = -12.0  # another one, over the first of December, the coldest month
    year = tb.Hourly(days.ravel(), begins=np.datetime64("2001-01-01T00"), recurs=True)
    result = find_cold(year)
    assert (result.winters, result.return_period, result.design_temperature) == (1, None, -12.0)
    assert result.cold_days["run_longest_days"].tolist() == [7, 7, 7]
    assert result.cold_days["days_per_year"].tolist() == [12.0] * 3
    with pytest.raises(tb.InputError, match="needs a complete year"):
        find_cold(tb.Hourly(days[:200].ravel(), begins=np.datetime64("2001-01-01T00")))
    with pytest.raises(tb.InputError, match="from 2 to 1000 years"):
        find_cold(year, return_period=1)


def test_factors_at_the_design_temperature_of_a_site() -> None:
    report = run_factors(
        ["shen-hdr-bridge"], temperatures=[0], strains=[1.0], weather=_winters([-18.0, -22.5])
    )
    assert -22.5 in report.table["ambient_degC"].to_numpy()
    assert {"compared", "site_stiffening", "site_cold_days"} <= set(report.tables())
    assert "-22.5" in "".join(report.tables()["site_stiffening"].note).replace(
        "\N{MINUS SIGN}", "-"
    )
