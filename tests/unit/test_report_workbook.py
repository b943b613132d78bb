"""The workbook: units in the heads, numbers as numbers, no formulas, the same bytes again."""

import dataclasses
import io
import sys
import zipfile
from typing import Any

import numpy as np
import openpyxl
import pytest

from tests.unit.report_pieces import EVIL, PIECES
from thermobearing.border.errors import InputError
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table
from thermobearing.report import workbook
from thermobearing.report.workbook import History, _history_tables, sheet_name, workbook_bytes

COLUMNS = [Quantity("time", "s"), Quantity("force", "kN")]
HISTORIES = {
    name: History({"Motion": name}, COLUMNS, np.arange(8.0).reshape(4, 2)) for name in ("a", EVIL)
}


def opened(raw: bytes) -> Any:
    return openpyxl.load_workbook(io.BytesIO(raw))


@pytest.fixture(scope="module")
def book() -> Any:
    return opened(workbook_bytes(PIECES, HISTORIES))


def test_a_sheet_for_each_thing(book: Any) -> None:
    assert book.sheetnames == ["Answer", "Checks", "bearing", "peaks", "Histories"]


def test_the_first_sheet_says_what_was_asked_and_found(book: Any) -> None:
    rows = [(a.value, b.value) for a, b in book["Answer"].iter_rows(min_row=4)]
    assert ("Answer", "313 kN at -20 °C.") in rows  # without the stars of its Markdown
    assert ("Warning", "it is cold") in rows
    assert ("Version", "thermobearing 0.2.0") in rows


def test_heads_have_units_and_stay_in_view(book: Any) -> None:
    sheet = book["peaks"]
    assert [cell.value for cell in sheet[3]] == ["Run", "Force [kN]", "Strain [%]"]
    assert sheet.freeze_panes == "B4"
    assert book["Histories"].freeze_panes == "C4"
    assert sheet.auto_filter.ref == "A3:C6"
    assert sheet.column_dimensions["A"].width > 20


def test_numbers_are_numbers_with_the_digits_of_their_column(book: Any) -> None:
    sheet = book["peaks"]
    assert (sheet["B4"].value, sheet["B4"].number_format) == (-312.64, "0.0")
    assert (sheet["C4"].value, sheet["C4"].number_format) == (175.0, "0")
    assert sheet["C5"].value is None
    assert sheet["B6"].value is None
    assert sheet["C6"].fill.fgColor.rgb.endswith(workbook.MARKED)
    assert not sheet["C4"].fill.fgColor.rgb.endswith(workbook.MARKED)


def test_no_formula_is_made_of_text(book: Any) -> None:
    assert book["peaks"]["A4"].value == EVIL
    assert book["peaks"]["A4"].data_type == "s"
    raw = zipfile.ZipFile(io.BytesIO(workbook_bytes(PIECES, HISTORIES)))
    sheets = [raw.read(n) for n in raw.namelist() if n.startswith("xl/worksheets/")]
    assert len(sheets) == 5
    assert not any(b"<f>" in sheet or b"<f " in sheet for sheet in sheets)


def test_the_same_result_has_the_same_bytes() -> None:
    first = workbook_bytes(PIECES, HISTORIES)
    assert workbook_bytes(PIECES, HISTORIES) == first
    raw = zipfile.ZipFile(io.BytesIO(first))
    assert {item.date_time for item in raw.infolist()} == {workbook.STAMP}
    assert b"dcterms:created" not in raw.read("docProps/core.xml")  # nor is the hour in there


def test_runs_stand_below_each_other_and_long_ones_are_thinned(monkeypatch: Any) -> None:
    (table,) = _history_tables(HISTORIES).values()
    assert [column.title for column in table.columns] == ["Motion", "time [s]", "force [kN]"]
    assert len(table.rows) == 8
    assert table.note == ""
    monkeypatch.setattr(workbook, "MOST_HISTORY_ROWS", 4)
    (thinned,) = _history_tables(HISTORIES).values()
    assert [row[1] for row in thinned.rows] == [0.0, 4.0, 0.0, 4.0]
    assert thinned.note == "Every 2. of the samples that the result keeps."


def test_histories_with_other_columns_have_a_sheet_of_their_own() -> None:
    other = History({"Motion": "c"}, COLUMNS[:1], np.arange(3.0).reshape(3, 1))
    assert list(_history_tables(HISTORIES | {"c": other})) == ["Histories 1", "Histories 2"]


def test_tables_longer_than_a_sheet_go_on_in_another(monkeypatch: Any) -> None:
    monkeypatch.setattr(workbook, "ROWS", 6)
    table = Table("Long", [Quantity("n", "", "d")], [(k,) for k in range(5)])
    pieces = dataclasses.replace(PIECES, tables={"long": table}, inputs={}, checks=())
    book = opened(workbook_bytes(pieces, {}))
    told = {name: [c.value for c in book[name]["A"][3:]] for name in book.sheetnames[-3:]}
    assert told == {"long": [0, 1], "long 2": [2, 3], "long 3": [4]}


@pytest.mark.parametrize(
    ("wanted", "name"),
    [
        ("peaks", "peaks 2"),
        ("PEAKS", "PEAKS 2"),
        ("a/b:c*[d]?", "a b c d"),
        ("x" * 40, "x" * 31),
        ("", "Sheet"),
        ("History", "History 2"),
    ],
)
def test_names_of_sheets_are_such_as_excel_takes(wanted: str, name: str) -> None:
    assert sheet_name(wanted, {"peaks"}) == name


@pytest.mark.parametrize(
    ("value", "form", "shown"),
    [
        (312.64, ".4g", "0.0"),
        (0.01234, ".3g", "0.0000"),
        (1e-7, ".3g", "0.00E+00"),
        (12.0, ".4g", "0"),
        ("x", ".1f", "General"),
    ],
)
def test_formats_of_numbers(value: Any, form: str, shown: str) -> None:
    table = Table("T", [Quantity("a", "", form)], [(value,)])
    book = opened(workbook_bytes(dataclasses.replace(PIECES, tables={"t": table}), {}))
    assert book["t"]["A4"].number_format == shown


def test_without_the_library_a_sentence_says_what_to_install(monkeypatch: Any) -> None:
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    with pytest.raises(InputError, match=r'pip install "thermobearing\[report\]"'):
        workbook_bytes(PIECES, {})
