"""Tables as laboratories write them, right and broken, read alike by every command."""

import datetime
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from typer.testing import CliRunner

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.inputs import QUICK_CASE, assert_mentions, by_name, refusal, steps_case, write_toml
from thermobearing.cli import app
from thermobearing.identify.records.record import load_test
from thermobearing.tables import columns
from thermobearing.tables.laboratory import read_laboratory
from thermobearing.tables.text import read_sheets

PLAIN = "time_s,displacement_mm,force_kN\n0,0,0\n0.5,1.25,3\n1,-1250,-3.5\n"
VALUES = {"time": [0.0, 0.5, 1.0], "displacement": [0.0, 1.25, -1250.0], "force": [0.0, 3.0, -3.5]}
HEAD = "time_s{0}displacement_mm{0}force_kN\n"
FORMS: dict[str, str | bytes] = {
    "plain": PLAIN,
    "semicolons, decimal commas": HEAD.format(";") + "0;0;0\n0,5;1,25;3\n1;-1250;-3,5\n",
    "tabs": PLAIN.replace(",", "\t"),
    "tabs, decimal commas": HEAD.format("\t") + "0\t0\t0\n0,5\t1,25\t3\n1\t-1250\t-3,5\n",
    "blanks": PLAIN.replace(",", "   "),
    "quoted decimal commas": HEAD.format(",") + '0,0,0\n"0,5","1,25",3\n1,-1250,"-3,5"\n',
    "marks of thousands": HEAD.format(";") + "0;0;0\n0,5;1,25;3\n1;-1.250,0;-3,5\n",
    "exponents of Fortran": PLAIN.replace("0.5,", "5.0D-1,"),
    "blank and comment lines": "# logger 7\n\n" + PLAIN.replace("\n1,", "\n\n# pause\n1,"),
    "titles in a comment": "# " + PLAIN,
    "free head": "Operator: A. B.\nSpecimen;HDR 1\n" + PLAIN.replace(",", ";"),
    "row of units": "Time;Disp;Load\ns;mm;kN\n" + PLAIN.replace(",", ";").split("\n", 1)[1],
    "rows of channels and units": "time,displacement,force\nCH1,CH2,CH3\n[s],[mm],[kN]\n"
    + PLAIN.split("\n", 1)[1],
    "Japanese": PLAIN.replace(PLAIN.split("\n")[0], "時間(秒),変位[mm],荷重(kN)").encode("cp932"),
    "UTF-16": PLAIN.encode("utf-16"),
    "units as written": "Zeit [sec];Weg;Kraft\n" + PLAIN.replace(",", ";").split("\n", 1)[1],
    "title repeated": PLAIN.replace("1,-1250", "time_s,displacement_mm,force_kN\n1,-1250"),
    "word between": PLAIN.replace("1,-1250", "Block 2,,\n1,-1250"),
}


def lies(folder: Path, content: str | bytes, name: str = "t.csv", sidecar: str = "") -> Path:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    if sidecar:
        path.with_suffix(".toml").write_text(sidecar, encoding="utf-8")
    return path


@pytest.mark.parametrize("form", FORMS)
def test_the_same_numbers_in_any_form(tmp_path: Path, form: str) -> None:
    sidecar = ""
    if form == "units as written":
        sidecar = 'columns = { displacement = "Weg", force = "Kraft" }\n'
        sidecar += 'units = { displacement = "mm", force = "kN" }'
    result = read_laboratory(lies(tmp_path, FORMS[form], sidecar=sidecar)).values
    assert {name: values.tolist() for name, values in result.items()} == VALUES


@pytest.mark.parametrize(
    ("title", "parts"),
    [
        ("temp_ambient_C", ("temp_ambient", "C")),
        ("T_amb", ("T_amb", "")),
        ("Force, kN", ("Force", "kN")),
        ("温度（℃）", ("温度", "℃")),
        ("acc_m/s2", ("acc", "m/s2")),
    ],
)
def test_name_and_unit_of_a_title(title: str, parts: tuple[str, str]) -> None:
    assert columns.name_and_unit(title) == parts


@pytest.mark.parametrize(
    ("title", "cells", "ambient"),
    [
        ("temp_ambient_C", ("-20", "-19.8"), -19.9),
        ("ambient_degC", ("-20", "-19.8"), -19.9),
        ("Ambient temp [°F]", ("50", "50"), 10.0),
        ("chamber [K]", ("253.15", "253.15"), -20.0),
        ("槽内温度(℃)", ("5", "5"), 5.0),
        ("恒温槽温度 (℃)", ("-25", "-25"), -25.0),
    ],
)
def test_ambient_of_a_column(
    tmp_path: Path, title: str, cells: tuple[str, str], ambient: float
) -> None:
    text = f"time_s,displacement_mm,force_kN,{title},T3\n0,0,0,{cells[0]},1\n1,1,1,{cells[1]},2\n"
    record = load_test(lies(tmp_path, text))
    assert_allclose(record.ambient, ambient, atol=tol.ZERO_DEGREES)
    assert not record.assumptions
    assert record.unused == ("T3",)


def test_brackets_above_a_row_of_units_are_a_part_of_the_title(tmp_path: Path) -> None:
    path = tmp_path / "layers.csv"
    path.write_text("Zeit;Weg;Kraft;TE1 (Lage 1)\ns;mm;kN;K\n0;0;0;296\n1;5;9;296\n2;0;-1;296\n")
    columns = {c.title: c.unit for c in read_laboratory(path).recognised.columns}
    assert columns["TE1 (Lage 1)"] == "K"


def test_ambient_under_another_title_and_thermocouples_without_units(tmp_path: Path) -> None:
    text = "time_s,displacement_mm,force_kN,CH4,CH5\n0,0,0,-20,10\n1,1,1,-20,11\n"
    sidecar = '[columns]\nambient = "CH4"\n[units]\nambient = "degC"\nCH5 = "degC"\n'
    record = load_test(lies(tmp_path, text, sidecar=sidecar + '[thermocouples]\nCH5 = "rubber 1"'))
    assert record.ambient == -20.0
    assert record.temperatures["CH5"].tolist() == [10.0, 11.0]
    assert record.unused == ()


STAMPS = {
    "ISO": ["2024-03-01T23:59:59.5", "2024-03-02T00:00:00", "2024-03-02T00:00:01.25"],
    "day first": ["31.01.2024 23:59:59.5", "01.02.2024 00:00:00", "01.02.2024 00:00:01.25"],
    "month first": ["01/31/2024 23:59:59.5", "02/01/2024 00:00:00", "02/01/2024 00:00:01.25"],
    "clock over midnight": ["23:59:59,5", "00:00:00", "00:00:01,25"],
    "hours beyond a day": ["25:00:00.5", "25:00:01", "25:00:02.25"],
    "minutes and seconds": ["01:10.5", "01:11.0", "01:12.25"],
    "Japanese order": ["2024/03/01 12:00:00.5", "2024/03/01 12:00:01", "2024/03/01 12:00:02.25"],
}


@pytest.mark.parametrize("kind", STAMPS)
def test_time_stamps(kind: str) -> None:
    assert_allclose(
        columns._seconds_and_start(STAMPS[kind])[0], [0.0, 0.5, 1.75], atol=tol.CONVERSION * 1e5
    )


def test_day_and_month_are_in_the_order_that_makes_the_record_short() -> None:
    assert columns._seconds_and_start(["01/02/2024 12:00", "02/02/2024 12:00"])[0][-1] == 86400.0
    assert columns._seconds_and_start(["02/01/2024 12:00", "02/02/2024 12:00"])[0][-1] == 86400.0


def test_stamps_coarser_than_the_sampling_are_spread(tmp_path: Path) -> None:
    stamps = [f"12:00:{k // 4:02d}" for k in range(2, 40)]
    rows = [f"{stamp},{k},{k}" for k, stamp in enumerate(stamps)]
    record = load_test(lies(tmp_path, "Time,disp_mm,load_kN\n" + "\n".join(rows)))
    assert_allclose(np.diff(record.time), 0.25, rtol=tol.CONVERSION * 1e3)
    assert any("spread evenly" in text for text in record.assumptions)


def test_date_and_time_in_two_columns(tmp_path: Path) -> None:
    text = "Date,Time,disp_mm,load_kN\n2024-03-01,23:59:59,0,0\n2024-03-02,00:00:01,1,1\n"
    record = load_test(lies(tmp_path, text))
    assert record.time.tolist() == [0.0, 2.0]
    assert record.unused == ()


def blocks(gap: float) -> str:
    one = "".join(f"{k},{k},{k}\n" for k in range(4))
    two = "".join(f"{k + gap:g},{k},{k}\n" for k in range(4))
    return HEAD.format(",") + one + "\n" + HEAD.format(",") + two


def test_blocks_of_one_file(tmp_path: Path) -> None:
    on = load_test(lies(tmp_path, blocks(60.0)))
    assert on.block.tolist() == [0] * 4 + [1] * 4
    assert on.time[4] == 60.0
    anew = load_test(lies(tmp_path, blocks(0.0), "anew.csv"))
    assert anew.time[4] == 4.0
    assert any("rest_before" in text for text in anew.assumptions)
    parts = '{ file = "anew.csv", part = 1 }, { file = "anew.csv", part = 2, rest_before = "1 h" }'
    rested = load_test(
        lies(tmp_path, blocks(0.0), "anew.csv", f'blocks = [{parts}]\nambient = "0 degC"')
    )
    assert rested.time[4] == 3603.0
    assert not rested.assumptions
    path = lies(tmp_path, blocks(0.0), "b.csv", 'blocks = [{ file = "b.csv", part = 3 }]')
    with pytest.raises(tb.InputError, match="has 2 parts, not 3"):
        load_test(path)


def test_a_clock_that_starts_anew_begins_a_block(tmp_path: Path) -> None:
    text = HEAD.format(",") + "".join(f"{k % 4},{k},{k}\n" for k in range(8))
    assert load_test(lies(tmp_path, text)).block.tolist() == [0] * 4 + [1] * 4


def workbook(path: Path) -> Path:
    openpyxl = pytest.importorskip("openpyxl", reason="pip install 'thermobearing[xlsx]'")
    book = openpyxl.Workbook()
    about, first = book.active, book.create_sheet("50 %")
    about.title = "about"
    about.append(["operator", "A. B."])
    second = book.create_sheet("100 %")
    for sheet, size in ((first, 1.0), (second, 2.0)):
        sheet.append(["Specimen HDR 1"])
        sheet.append(["Time", "Disp [cm]", "Force [kN]", "T_amb [°C]", "note"])
        for k in range(3):
            at = datetime.datetime(2024, 3, 1, 12, 0, k)
            sheet.append([at, 0.1 * size * k, size * k, -20, None])
    book.save(path)
    return path


def test_workbook(tmp_path: Path) -> None:
    path = workbook(tmp_path / "t.xlsx")
    record = load_test(path)
    assert record.block.tolist() == [0, 0, 0, 1, 1, 1]
    assert_allclose(record.displacement[:3], [0.0, 1.0, 2.0], atol=tol.CONVERSION)
    assert record.ambient == -20.0
    assert any('"100 %"' in text for text in record.assumptions)
    text = 'blocks = [{ file = "t.xlsx", sheet = "50 %" }, { file = "t.xlsx", sheet = "100 %" }]'
    path.with_suffix(".toml").write_text(text)
    both = load_test(path.with_suffix(".toml"))
    assert_allclose(both.force, [0.0, 1.0, 2.0, 0.0, 2.0, 4.0])
    path.with_suffix(".toml").write_text('file = "t.xlsx"\nsheet = "50"')
    with pytest.raises(tb.InputError, match='no sheet "50"'):
        load_test(path)


def test_workbook_without_its_reader(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "openpyxl", None)
    with pytest.raises(tb.InputError, match=r"pip install 'thermobearing\[xlsx\]'"):
        load_test(lies(tmp_path, b"PK\x03\x04", "t.xlsx"))


def test_a_degree_sign_of_windows_is_found(tmp_path: Path) -> None:
    text = "time_s;displacement_mm;force_kN;T [°C]\n0;0;0;1\n1;1;1;1\n"
    (sheet,) = read_sheets(lies(tmp_path, text.encode("cp1252")))
    result = columns.list_columns(
        columns.usable_table(sheet), {"time": "s", "force": "kN"}, (), columns.Layout()
    )
    assert result.unused == ["displacement_mm", "T [°C]"]


@pytest.mark.parametrize(
    ("sidecar", "reported"),
    [
        ('separator = "|"', "separator = '|': must be one of"),
        ('decimal = ";"', "decimal = ';': must be one of"),
        ('encoding = "no-such"', 'not text in the encoding "no-such"'),
        ('[units]\nT9 = "degC"', "units: unknown 'T9'"),
        ("blocks = [{ file = 't.csv', part = 0 }]", "part"),
    ],
)
def test_faults_of_a_sidecar(tmp_path: Path, sidecar: str, reported: str) -> None:
    with pytest.raises(tb.InputError, match=reported):
        load_test(lies(tmp_path, PLAIN, sidecar=sidecar))


def test_what_a_sidecar_tells_is_not_looked_for(tmp_path: Path) -> None:
    text = HEAD.format(";") + "0;1,234;2\n1;2,345;3\n"
    for decimal, displacement in ((",", [1.234, 2.345]), (".", [1234.0, 2345.0])):
        path = lies(tmp_path, text, sidecar=f'decimal = "{decimal}"\nseparator = ";"')
        assert load_test(path).displacement.tolist() == displacement


def test_a_head_of_words_and_numbers_is_no_table(tmp_path: Path) -> None:
    rows = "".join(f"{k / 10};{k % 7};{2 * (k % 7)};-10,2\n" for k in range(40)).replace(".", ",")
    head = "Prüfling A7\nDatum;05.02.2026\nAbtastrate [Hz];20\n\n"
    titles = "Zeit [s];Verschiebung [cm];Kraft [N];Raumtemperatur [°C]\n"
    record = load_test(lies(tmp_path, head + titles + rows))
    assert (len(record.time), record.ambient) == (40, pytest.approx(-10.2))
    assert_allclose(record.displacement[:3], [0.0, 10.0, 20.0])


WANTED = {"time": "s", "displacement": "mm"}


def write_and_read(
    tmp_path: Path, text: str | bytes, wanted: dict[str, str] = WANTED
) -> dict[str, list]:
    path = tmp_path / "table.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return {name: values.tolist() for name, values in tb.read_columns(path, wanted).items()}


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp932"])
def test_encodings_and_line_ends(tmp_path: Path, encoding: str, end: str) -> None:
    lines = ["time_s,備考,displacement_mm", "0,初期,0", "", "1,載荷,5", ""]
    data = write_and_read(tmp_path, end.join(lines).encode(encoding))
    assert data == {"time": [0.0, 1.0], "displacement": [0.0, 5.0]}


@pytest.mark.parametrize(
    ("title", "encoding"),
    [
        *((title, "cp1252") for title in ("Kräfte", "Fläche mm²", "mesuré “à côté”", "Weg–Kraft")),
        *((title, "cp932") for title in ("変位", "力 (kN)", "温度 ℃", "面圧", "ﾋｽﾃﾘｼｽ")),
    ],
)
def test_japanese_and_western_titles_are_read(tmp_path: Path, title: str, encoding: str) -> None:
    raw = f"time_s;{title}\n0;0\n1;1\n".encode(encoding)
    (sheet,) = read_sheets(lies(tmp_path, raw))
    assert sheet.rows[0][1][1] == title


def test_column_in_the_wanted_unit_comes_first(tmp_path: Path) -> None:
    """Converted twice by the laboratory, rounded once: the column that needs no conversion."""
    data = write_and_read(tmp_path, "force_tonf,force_kN\n1,9.8\n2,19.6\n", {"force": "kN"})
    assert data == {"force": [9.8, 19.6]}


@pytest.mark.parametrize(
    ("unit", "cells"),
    [("degC", (0, 100)), ("K", (273.15, 373.15)), ("degF", (32, 212)), ("°C", (0, 100))],
)
def test_temperatures_are_converted_with_their_offset(
    tmp_path: Path, unit: str, cells: tuple[float, float]
) -> None:
    text = f"temperature [{unit}]\n{cells[0]}\n{cells[1]}\n"
    data = write_and_read(tmp_path, text, {"temperature": "degC"})
    assert_allclose(data["temperature"], [0, 100], rtol=tol.CONVERSION, atol=tol.ZERO_DEGREES)


def test_many_rows_keep_their_bits(tmp_path: Path) -> None:
    values = np.random.default_rng(1).normal(size=(5000, 2))
    rows = "\n".join(f"{a!r},{b!r}" for a, b in values.tolist())
    data = write_and_read(tmp_path, "time_s,displacement_mm\n" + rows)
    assert_array_equal(np.column_stack([data["time"], data["displacement"]]), values)


def test_faults_are_reported_with_the_line_of_the_file(tmp_path: Path) -> None:
    text = "laboratory\nnumber 7\ntime_s,force_kN\n[s],[kN]\n0,1\n1,lost\n2,3\n"
    path = lies(tmp_path, text)
    layout = columns.Layout(lines_before=2, lines_after=1)
    with pytest.raises(tb.InputError, match='line 6, force_kN: "lost" is not a number'):
        tb.read_columns(path, {"time": "s", "force": "kN"}, layout=layout)


HEADER = "time_s,displacement_mm\n"
COLUMN = "displacement_mm"

RECORDINGS: list[tuple[str, bytes | str, list[str]]] = [
    ("empty", "", ["is empty"]),
    ("header only", HEADER, ["0 rows", "at least 2"]),
    ("one row", HEADER + "0,0\n", ["1 rows", "at least 2"]),
    ("missing column", "time_s,force_kN\n0,0\n1,1\n", ["as displacement", "force_kN"]),
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
    ("UTF-16 cut off", (HEADER + "0,0\n").encode("utf-16")[:-1], ["not text", "utf-16"]),
    ("time stands still", HEADER + "0,0\n1,1\n1,2\n", ["does not increase from 1 to 1 s"]),
    ("time runs back", HEADER + "0,0\n2,1\n1,2\n", ["from 2 to 1 s", "rows 2 and 3"]),
    ("starts elsewhere", HEADER + "0,5\n1,6\n", ["starts at 5 mm", "at 0 mm", "ramp"]),
    ("slip of a unit", "time_s,displacement_m\n0,0\n1,20\n", ["20000 mm", "500%", "unit right"]),
]


@pytest.mark.parametrize(("content", "pieces"), by_name(RECORDINGS))
def test_broken_recording(tmp_path: Path, content: bytes | str, pieces: list[str]) -> None:
    csv = lies(tmp_path, content, "moved.csv")
    path = steps_case(tmp_path / "case.toml", {"step": "recorded", "file": "moved.csv"})
    message = refusal(path, tb.load_case)
    assert_mentions(message, [f"{path}: ", "test.steps[0]: ", str(csv), *pieces])


def test_every_broken_recording_of_a_test_is_reported(tmp_path: Path) -> None:
    given = [{"step": "recorded", "file": name} for name in ("one.csv", "two.csv", ".")]
    path = steps_case(tmp_path / "case.toml", *given)
    reported = ["3 problems", "one.csv: no such file", "two.csv: no such file", "is a directory"]
    assert_mentions(refusal(path, tb.load_case), reported)


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
    assert_mentions(refusal(path, tb.load_case), [f"{path}: ", "ambient_series: ", *pieces])


@pytest.mark.parametrize(
    ("content", "pieces"),
    [
        ("displacement_mm,force_kN\n0,0\n1,x\n", ["line 3, force_kN"]),
        ("displacement_mm,force_mm\n0,0\n1,1\n", ['"mm"', "to kN"]),
        ("displacement_mm,force_kN\n0,0\n1,1\n2,2\n", ["no full cycle"]),
        ("displacement_mm,force_kN\n0,0\n0,1\n0,2\n", ["displacement is constant"]),
    ],
    ids=["text", "unit of another kind", "no cycle", "no motion"],
)
def test_broken_measurement(tmp_path: Path, content: str, pieces: list[str]) -> None:
    csv = lies(tmp_path, content)
    done = CliRunner().invoke(app, ["measure", str(csv), "--bearing", "shen-hdr-specimen"])
    assert done.exit_code == 2
    assert not done.stdout
    assert_mentions(done.stderr, [str(csv), *pieces])


BEARING = "shen-hdr-specimen"
TURN = np.linspace(0.0, 4.0 * np.pi, 401)
TIME, WAY = 0.05 * np.arange(401), 30.0 * np.sin(TURN)
FORCE = 60.0 * np.sin(TURN) + 15.0 * np.cos(TURN)


def laboratory(path: Path, *, strain: float | None = None, head: str = "") -> Path:
    """Semicolons, decimal commas, cm and tonf, the force against the displacement, a chamber."""
    more = "" if strain is None else ";shear_strain"
    lines = [head or f"Zeit [s];Weg SPS [cm];Kraft [tonf];Chamber temp.{more}"]
    for t, x, f in zip(TIME, WAY, FORCE, strict=True):
        cells = [f"{t:.2f}", f"{x / 10.0:.5f}", f"{-f / 9.80665:.6f}", "-20,0"]
        cells += [] if strain is None else [f"{x / strain:.6f}"]
        lines.append(";".join(cells).replace(".", ","))
    path.write_text("\n".join(lines), encoding="cp1252")
    return path


def command(*words: object) -> tuple[int, dict[str, Any]]:
    done = CliRunner().invoke(app, [str(word) for word in words])
    assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
    return done.exit_code, {"text": done.output}


def test_every_command_takes_the_column_of_the_chamber(tmp_path: Path) -> None:
    file, out = laboratory(tmp_path / "lab.csv"), tmp_path / "out"
    (taken,) = tb.inspect_files(file).files
    record = load_test(file)
    assert record.ambient == taken.record.ambient == -20.0
    assert_allclose(record.force, FORCE, atol=tol.FOUR_DECIMALS)
    assert_allclose(record.displacement, WAY, atol=tol.FOUR_DECIMALS)
    status, _ = command("validate", BEARING, file, "-o", out, "--no-figures", "-q")
    output = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert status in (0, 4)
    assert output["comparisons"][0]["ambient_degC"] == -20.0
    status, shown = command("identify", file, "--bearing", BEARING, "--check")
    assert "no ambient temperature" not in shown["text"]
    assert command("measure", file, "--bearing", BEARING)[0] == 0


def test_a_reversed_force_is_reported_by_every_command(tmp_path: Path) -> None:
    file, out = laboratory(tmp_path / "lab.csv"), tmp_path / "out"
    assert sum("opposite sign" in text for text in load_test(file).assumptions) == 1
    for words in (
        ("intake", file, "-o", tmp_path / "taken", "--no-figures"),
        ("identify", file, "--bearing", BEARING, "--check"),
        ("measure", file, "--bearing", BEARING),
    ):
        status, shown = command(*words)
        assert (status, "opposite sign" in shown["text"].replace("\n", " ")) == (0, True), shown
    command("validate", BEARING, file, "-o", out, "--no-figures", "-q")
    output = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert any("opposite sign" in text for text in output["warnings"])
    taken = json.loads((tmp_path / "taken" / "summary.json").read_text(encoding="utf-8"))
    assert taken["files"][0]["sidecar"]["flip_force"] is True


def test_a_sign_that_the_sidecar_states_is_kept(tmp_path: Path) -> None:
    file = laboratory(tmp_path / "lab.csv")
    file.with_suffix(".toml").write_text("flip_force = false\n")
    assert_allclose(load_test(file).force, -FORCE, atol=tol.FOUR_DECIMALS)


def test_an_unknown_ambient_temperature_is_a_warning(tmp_path: Path) -> None:
    file = tmp_path / "bare.csv"
    rows = "".join(f"{t},{x},{f}\n" for t, x, f in zip(TIME, WAY, FORCE, strict=True))
    file.write_text("time_s,displacement_mm,force_kN\n" + rows)
    command("validate", BEARING, file, "-o", tmp_path / "out", "--no-figures", "-q")
    output = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert any("23 degC" in text and "assumed" in text for text in output["warnings"])


def test_strains_are_compared_with_the_displacement(tmp_path: Path) -> None:
    """The specimen has 30 mm of rubber; a column of strains tells how much the file has."""
    right, wrong = (
        tb.check_test(laboratory(tmp_path / f"{size}.csv", strain=size), BEARING)
        for size in (30.0, 25.0)
    )
    assert_allclose(wrong.record.rubber_thickness, 25.0, rtol=tol.FOUR_DECIMALS)
    levels = [
        [f.level for f in report.findings if f.check == "rubber"] for report in (right, wrong)
    ]
    assert levels == [["note"], ["note", "warning"]]
    percent = laboratory(tmp_path / "percent.csv", strain=0.25)
    assert_allclose(load_test(percent).rubber_thickness, 25.0, rtol=tol.FOUR_DECIMALS)


def test_a_recording_reads_the_same_table(tmp_path: Path) -> None:
    laboratory(tmp_path / "lab.csv")
    case = tb.load_case(steps_case(tmp_path / "case.toml", {"step": "recorded", "file": "lab.csv"}))
    gaps, way, assumed = case.test.steps[0].points(0.0)
    assert_allclose(way, WAY, atol=tol.FOUR_DECIMALS)
    assert_allclose(gaps, 0.05, rtol=tol.FOUR_DECIMALS)
    assert assumed == []


def test_what_a_recording_assumes_is_a_warning(tmp_path: Path) -> None:
    (tmp_path / "h.csv").write_text("Zeit;Weg\n0;0\n1;10\n2;0\n")
    case = steps_case(tmp_path / "case.toml", {"step": "recorded", "file": "h.csv"})
    result = tb.run_case(tb.load_case(case))
    assert sum("has no unit" in text for text in result.warnings) == 2


@pytest.mark.parametrize(
    ("titles", "rows", "air"),
    [
        ("Datum;Uhrzeit;Lufttemperatur [°C];Feuchte", "01.02.2024;{h:02d}:00;-{h},5;80", -1.5),
        ("Zeit [h];T_amb [°C]", "{h};-{h},5", -1.5),
        ("Messzeit [h];Kanal 4 [°C]", "{h};-{h},5", -1.5),
    ],
)
def test_weather_reads_the_same_tables(tmp_path: Path, titles: str, rows: str, air: float) -> None:
    file = tmp_path / "town.csv"
    file.write_text("\n".join([titles, *(rows.format(h=h) for h in range(1, 6))]))
    weather = tb.read_weather(file)
    assert weather.temperature[0] == air
    assert len(weather) == 5


def test_weather_with_two_air_temperatures_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "town.csv"
    file.write_text("time [h];air 1 [degC];air 2 [degC]\n1;2;3\n2;3;4\n")
    with pytest.raises(tb.InputError, match="may each be"):
        tb.read_weather(file)


MOTIONS = {
    "German": "Zeit (s);Beschleunigung (cm/s2)\n{rows}",
    "units below": "Zeit;Beschleunigung\ns;cm/s2\n{rows}",
    "title above": "Messung 3\nZeit [ms];Beschleunigung [gal]\n{ms}",
    "time last": "Beschleunigung [gal];Zeit [s]\n{turned}",
}


@pytest.mark.parametrize("form", MOTIONS)
def test_a_motion_reads_the_same_tables(tmp_path: Path, form: str) -> None:
    values = 300.0 * np.sin(0.3 * np.arange(40))
    pairs = [(0.01 * k, a) for k, a in enumerate(values)]
    text = MOTIONS[form].format(
        rows="\n".join(f"{t:.2f};{a:.4f}" for t, a in pairs).replace(".", ","),
        ms="\n".join(f"{1e3 * t:.0f};{a:.4f}" for t, a in pairs).replace(".", ","),
        turned="\n".join(f"{a:.4f};{t:.2f}" for t, a in pairs).replace(".", ","),
    )
    file = tmp_path / "wave.csv"
    file.write_text(text)
    motion = tb.load_motion(file)
    assert motion.dt == 0.01
    assert_allclose(motion.acceleration, 10.0 * values, atol=1e-3)


def test_a_motion_in_a_workbook(tmp_path: Path) -> None:
    openpyxl = pytest.importorskip("openpyxl", reason="pip install 'thermobearing[xlsx]'")
    book = openpyxl.Workbook()
    book.active.append(["時間(s)", "加速度(gal)"])
    values = 300.0 * np.sin(0.3 * np.arange(40))
    for k, a in enumerate(values):
        book.active.append([0.01 * k, float(a)])
    book.save(tmp_path / "wave.xlsx")
    assert_allclose(tb.load_motion(tmp_path / "wave.xlsx").acceleration, 10.0 * values, rtol=1e-12)


def test_a_guessed_place_that_the_bearing_does_not_have_is_not_used(tmp_path: Path) -> None:
    """A title with "core" is no lead in a bearing without; a sidecar that says so is refused."""
    file = laboratory(tmp_path / "lab.csv")
    lines = file.read_text(encoding="cp1252").splitlines()
    more = [f"{lines[0]};core [degC];rubber 9 [degC];layer 2 [degC]"]
    file.write_text("\n".join(more + [f"{line};-19;-19;-19" for line in lines[1:]]))
    record = load_test(file)
    assert len(record.places) == 3
    assert record.of_bearing(tb.load_bearing(BEARING)).places == {"layer 2 [degC]": "rubber 2"}
    result = tb.validate_bearing(BEARING, file)
    assert list(result.thermocouples["thermocouple"]) == ["layer 2 [degC]"]
    file.with_suffix(".toml").write_text('[thermocouples]\n"core [degC]" = "lead"\n')
    with pytest.raises(tb.InputError, match="no lead"):
        tb.validate_bearing(BEARING, file)


@pytest.mark.parametrize("title", ["Kraft－１ [kN]", "kraft-1", "KRAFT‐1", "Ｋｒａｆｔ－１"])
def test_a_column_is_chosen_by_title_in_any_width_and_hyphen(title: str, tmp_path: Path) -> None:
    path = tmp_path / "test.csv"
    path.write_text("time_s,Kraft－１ [kN],Kraft－２ [kN]\n0,1,4\n1,2,5\n", encoding="utf-8")
    layout = columns.Layout(titles={"force": title})
    table = columns.read_columns(path, {"time": "s", "force": "kN"}, layout=layout)
    assert table["force"].tolist() == [1.0, 2.0]
