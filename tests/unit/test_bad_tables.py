"""Broken CSV files: recordings, ambient series, measured histories; see test_bad_input.py."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

import thermobearing as tb
from tests.unit.inputs import QUICK_CASE, assert_told, by_name, refusal, steps_case, write_toml
from thermobearing.cli import app

HEADER = "time_s,displacement_mm\n"
COLUMN = "displacement_mm"

RECORDINGS: list[tuple[str, bytes | str, list[str]]] = [
    ("empty", "", ["is empty"]),
    ("blank lines", "\n \n", ["is empty"]),
    ("header only", HEADER, ["0 rows", "at least 2"]),
    ("one row", HEADER + "0,0\n", ["1 rows", "at least 2"]),
    ("missing column", "time_s,force_kN\n0,0\n1,1\n", ["like a displacement", "force_kN"]),
    ("unknown unit", "time_s,displacement_foo\n0,0\n1,1\n", ['"displacement_foo"', '"foo"', "mm"]),
    ("unit of another kind", "time_s,displacement [kg]\n0,0\n1,1\n", ['"kg"', "to mm"]),
    ("NaN", HEADER + "0,0\n1,nan\n2,1\n", [f'line 3, {COLUMN}: "nan"', "finite"]),
    ("text", HEADER + "0,0\n1,x\n", [f'line 3, {COLUMN}: "x"', "not a number"]),
    ("underscore", HEADER + "0,0\n1,1_0\n", [f'line 3, {COLUMN}: "1_0"', "not a number"]),
    ("gap", HEADER + "0,0\n1\n", [f'line 3, {COLUMN}: ""']),
    ("after blank lines", HEADER + "\n\n0,0\n1,x\n", [f'line 5, {COLUMN}: "x"']),
    ("beyond doubles", "time_s,displacement_m\n0,0\n1,1e308\n", ["line 3", "too large"]),
    ("commas for both", HEADER + "0,0,0,0\n0,5,1,0\n", ["2 titles and 4 numbers", "semicolons"]),
    ("both marks", "time_s;displacement_mm\n0.5;0\n1,5;1\n", ["decimal point", "decimal comma"]),
    ("thousand", "time_s;displacement_mm\n1,234;2,345\n", ["may be a thousand", "decimal ="]),
    ("no date", "time;displacement_mm\n31.31.2024 12:00;0\n31.31.2024 12:01;1\n", ["not a date"]),
    ("old workbook", b"\xd0\xcf\x11\xe0" + bytes(20), ["old Excel", "save it as .xlsx"]),
    ("no workbook", b"PK\x03\x04" + bytes(20), ["not an .xlsx workbook"]),
    ("open quote", HEADER + '0,0\n1,"1\n', ["line 3"]),
    ("endless cell", HEADER + "0,0\n1," + "1" * 200_000 + "\n", ["line 3", "larger than"]),
    ("null bytes", HEADER.encode() + b"0,0\n1,\0\n", ["null bytes"]),
    ("no text", bytes(range(1, 256)), ["neither UTF-8 nor cp932"]),
    ("UTF-16 without its mark", (HEADER + "0,0\n1,1\n").encode("utf-16-le"), ["null bytes"]),
    ("UTF-16 cut off", (HEADER + "0,0\n").encode("utf-16")[:-1], ["no text", "utf-16"]),
    ("time stands still", HEADER + "0,0\n1,1\n1,2\n", ["does not increase from 1 to 1 s"]),
    ("time runs back", HEADER + "0,0\n2,1\n1,2\n", ["from 2 to 1 s", "rows 2 and 3"]),
    ("starts elsewhere", HEADER + "0,5\n1,6\n", ["starts at 5 mm", "at 0 mm", "ramp"]),
    ("slip of a unit", "time_s,displacement_m\n0,0\n1,20\n", ["20000 mm", "500%", "unit right"]),
]


@pytest.mark.parametrize(("content", "pieces"), by_name(RECORDINGS))
def test_broken_recording(tmp_path: Path, content: bytes | str, pieces: list[str]) -> None:
    csv = tmp_path / "moved.csv"
    csv.write_bytes(content if isinstance(content, bytes) else content.encode())
    path = steps_case(tmp_path / "case.toml", {"step": "recorded", "file": "moved.csv"})
    message = refusal(path, tb.load_case)
    assert_told(message, [f"{path}: ", "test.steps[0]: ", str(csv), *pieces])


def test_every_broken_recording_of_a_test_is_told(tmp_path: Path) -> None:
    given = [{"step": "recorded", "file": name} for name in ("one.csv", "two.csv", ".")]
    path = steps_case(tmp_path / "case.toml", *given)
    told = ["3 problems", "one.csv: no such file", "two.csv: no such file", "is a directory"]
    assert_told(refusal(path, tb.load_case), told)


SERIES: list[tuple[str, str, list[str]]] = [
    ("empty", "", ["is empty"]),
    ("no temperature", "time_s,wind_m\n0,0\n1,1\n", ['no column "temperature_degC"']),
    ("NaN", "time_s,temperature_degC\n0,0\n1,nan\n", ["line 3, temperature_degC"]),
    ("time runs back", "time_s,temperature_degC\n0,0\n2,1\n1,2\n", ["from 2 to 1 s"]),
    ("kelvin taken for degC", "time_s,temperature_degC\n0,273\n1,274\n", ["273 degC", "100 degC"]),
]


@pytest.mark.parametrize(("content", "pieces"), by_name(SERIES))
def test_broken_ambient_series(tmp_path: Path, content: str, pieces: list[str]) -> None:
    (tmp_path / "night.csv").write_text(content)
    table = {key: value for key, value in QUICK_CASE.items() if key != "ambient"}
    path = write_toml(tmp_path / "case.toml", table | {"ambient_series": "night.csv"})
    assert_told(refusal(path, tb.load_case), [f"{path}: ", "ambient_series: ", *pieces])


@pytest.mark.parametrize(
    ("content", "pieces"),
    [
        ("displacement_mm,force_kN\n0,0\n1,x\n", ["line 3, force_kN"]),
        ("displacement_mm,force_mm\n0,0\n1,1\n", ['"mm"', "to kN"]),
        ("displacement_mm,force_kN\n0,0\n1,1\n2,2\n", ["no full cycle"]),
        ("displacement_mm,force_kN\n0,0\n0,1\n0,2\n", ["no full cycle"]),
    ],
    ids=["text", "unit of another kind", "no cycle", "no motion"],
)
def test_broken_measurement(tmp_path: Path, content: str, pieces: list[str]) -> None:
    csv = tmp_path / "measured.csv"
    csv.write_text(content)
    done = CliRunner().invoke(app, ["measure", str(csv), "--bearing", "shen-hdr-specimen"])
    assert done.exit_code == 2
    assert not done.stdout
    assert_told(done.stderr, [str(csv), *pieces])
