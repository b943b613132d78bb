"""Hourly files: EPW as building simulation has them, and tables with time and temperature."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.cyclic.case import make_case
from thermobearing.cyclic.run import run_case
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.earthquake.run import build_tasks

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
    starts = np.datetime64(first, "h") + np.arange(hours)
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
    assert weather.assumptions == ("3 hours without a temperature lie on straight lines",)


def _long_gap(rows: list[list[str]]) -> None:
    for row in rows[10:17]:
        row[6] = "99.9"


@pytest.mark.parametrize(
    ("change", "told"),
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
def test_bad_epw(tmp_path: Path, change: Change, told: str) -> None:
    rows = epw_lines(hours=48)
    change(rows)
    file = write(tmp_path, rows)
    with pytest.raises(tb.InputError) as caught:
        tb.read_weather(file)
    assert told in str(caught.value)


def test_no_epw_inside(tmp_path: Path) -> None:
    file = tmp_path / "town.epw"
    file.write_text("time_s,temperature_degC\n0,1\n", encoding="utf-8")
    with pytest.raises(tb.InputError, match="is not an EPW file"):
        tb.read_weather(file)
    with pytest.raises(tb.InputError, match="no such file"):
        tb.read_weather(tmp_path / "other.csv")


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
    assert "straight lines" in weather.assumptions[0]


def test_table_without_dates(tmp_path: Path) -> None:
    weather = tb.read_weather(table(tmp_path, ["0,20", "1,30"], "time_hour,temperature_degF"))
    assert_allclose(weather.temperature, [-20.0 / 3.0, -10.0 / 9.0], atol=tol.CONVERSION)
    assert weather.begins is None
    assert weather.assumptions == ()


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        ([f"2024-10-27 0{h}:00,1" for h in (1, 2, 1)], "from reading 2 to 3; give it in one zone"),
        ([f"2024-01-01 0{h}:00,1" for h in (0, 1, 8)], "7 h without a reading after reading 2"),
        (["2024-01-01 00:00,1", "2024-01-01 01:00,"], "line 3"),
        ([f"2024-01-01 0{h}:00,{99 + h}" for h in range(3)], "hour 2: 101 degC is outside -100"),
    ],
)
def test_bad_table(tmp_path: Path, rows: list[str], told: str) -> None:
    file = table(tmp_path, rows)
    with pytest.raises(tb.InputError) as caught:
        tb.read_weather(file)
    assert told in str(caught.value)
    assert "town" in str(caught.value)


def test_any_analysis_reads_the_files_that_studies_read(tmp_path: Path) -> None:
    """A week of EPW before an earthquake, at a line, in a test: as the same hours in a table."""
    epw = write(tmp_path, epw_lines("1990-01-10", 168))
    hourly = tb.read_weather(epw)
    table = tmp_path / "town.csv"
    rows = [f"{date};{air:.4f}".replace(".", ",") for date, air in _rows(hourly)]
    table.write_text("\n".join(["time;temperature_degC", *rows]))
    found = []
    for file in (epw, table):
        words = {"duration": "1 s", "analysis": {"keep": ["rubber", "cells"]}}
        line = [{"line": "G1-G5", "weather": str(file)}]
        for changes in ({"weather": str(file)}, {"lines": line, "ambient": ["20 degC"]}):
            case = {"bearings": ["shen-lhdr-bridge"], "motions": ["jra-ii-i-1"]} | words | changes
            (task,) = build_tasks(make_earthquake_case(case, "test"))
            found.append((task.reported.temperature, task.reported.lead))
        test = tb.cyclic_test(strain=[0.2], cycles=1)
        done = make_case(
            {"ambient_series": str(file)}, "test", bearing="shen-hdr-specimen", test=test
        )
        found.append((run_case(done)["temperature"].values, None))
    for (cells, lead), (other, other_lead) in zip(found[:3], found[3:], strict=True):
        assert_array_equal(cells, other)
        assert lead == other_lead
    assert found[0][0][0] < -28.0  # it is as cold as the file


def _rows(hourly: tb.Hourly) -> list[tuple[str, float]]:
    dates = [str(date).replace("T", " ") + ":00" for date in hourly.dates]
    return list(zip(dates, hourly.temperature.tolist(), strict=True))


def test_faults_of_an_epw_file_are_told_by_any_analysis(tmp_path: Path) -> None:
    rows = epw_lines("1990-01-10", 48)
    file = write(tmp_path, rows[:10] + rows[20:])
    with pytest.raises(tb.InputError, match=r"weather: .*town\.epw: line 19: .* does not follow"):
        make_earthquake_case({"weather": str(file)}, "test")
