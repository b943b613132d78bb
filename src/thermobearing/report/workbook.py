"""A document's numbers as an Excel workbook: a sheet a table, units in the heads, main histories.

Text of users is written as text: a name that begins with "=" is no formula.
"""

import io
import math
import re
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from thermobearing.border.errors import InputError, printable
from thermobearing.report.layout import split_runs
from thermobearing.report.pieces import Check, Column, Pieces, ReportTable

ROWS, COLUMNS, NAME, LETTERS = 1_048_576, 16_384, 31, 32_767  # what a sheet can hold
MOST_HISTORY_ROWS = 20_000  # of all histories together: what opens quickly
FORMATTED = 5_000  # rows of a sheet up to which every number has a format of its own
STAMP = (1980, 1, 1, 0, 0, 0)  # of every part of the file: the same bytes for the same result
MARKED, HEAD = "F6DEDE", "E8ECF1"  # fills
CHECKED = ("Check", "Value", "Limit", "Unit", "Source of the limit", "Verdict")
CREATED = re.compile(rb"<dcterms:(created|modified)[^>]*>[^<]*</dcterms:\1>")


@dataclass(frozen=True)
class History:
    """Histories of a run, or of a bearing line.

    Attributes
    ----------
    keys : what the run is, by the head of a column, such as {"Motion": "jra-ii-i-1"}.
    columns : heads and units.
    values : a row a sample, a column each; shape (samples, columns).
    """

    keys: Mapping[str, Any]
    columns: Sequence[Column]
    values: np.ndarray[Any, np.dtype[np.float64]]


def workbook_bytes(pieces: Pieces, histories: Mapping[str, History]) -> bytes:
    """A workbook of a result.

    Parameters
    ----------
    pieces : of the result.
    histories : by the name of their run; thinned evenly where they are long, which is said.

    Returns
    -------
    bytes : of an .xlsx file, the same for the same result.

    Raises
    ------
    InputError : openpyxl is not installed.
    """
    book = the_writer()(write_only=True)
    names: set[str] = set()
    _front(book, pieces, names)
    if pieces.checks:
        _sheet(book, "Checks", _checks(pieces.checks), names)
    tables = {**pieces.inputs, **pieces.tables}
    if pieces.books is not None:
        tables["energy books"] = pieces.books
    for name, table in tables.items():
        for number, part in enumerate(_split_sheets(table)):
            _sheet(book, f"{name} {number + 1}" if number else name, part, names)
    for name, table in history_tables(histories).items():
        _sheet(book, name, table, names)
    written = io.BytesIO()
    book.save(written)
    return _restamped(written.getvalue())


def the_writer() -> Any:
    """What makes a workbook.

    Raises
    ------
    InputError : openpyxl is not installed.
    """
    try:
        from openpyxl import Workbook
    except ImportError:
        raise InputError('a workbook needs openpyxl: pip install "thermobearing[report]"') from None
    return Workbook


def _front(book: Any, pieces: Pieces, names: set[str]) -> None:
    """What was asked, the answer, warnings, what is where."""
    told: list[tuple[str, Sequence[str]]] = [
        ("Asked", [pieces.question]),
        ("Answer", pieces.answer),
    ]
    told += [("Validity", [*pieces.validity, pieces.validity_unknown, *pieces.notes])]
    told += [("Warning", pieces.warnings), ("Assumed", pieces.assumptions)]
    rows = [(word, plain(text)) for word, texts in told for text in texts if text]
    rows += list(pieces.identity.items())
    _sheet(book, "Answer", ReportTable(pieces.title, [Column("What"), Column("Text")], rows), names)


def plain(text: str) -> str:
    """A sentence without the signs of its Markdown."""
    return "".join(run.text for run in split_runs(text))


def _checks(checks: Sequence[Check]) -> ReportTable:
    rows = [(c.what, c.value, c.limit, c.unit, c.source, c.verdict) for c in checks]
    exceeded = frozenset((k, 5) for k, check in enumerate(checks) if check.verdict == "exceeded")
    return ReportTable("Checks", [Column(head) for head in CHECKED], rows, marked=exceeded)


def _split_sheets(table: ReportTable) -> Iterator[ReportTable]:
    """A table in pieces that a sheet can hold."""
    room = ROWS - 4
    for first in range(0, max(len(table.rows), 1), room):
        rows = table.rows[first : first + room]
        marked = {(r - first, c) for r, c in table.marked if first <= r < first + room}
        columns = table.columns[:COLUMNS]
        yield ReportTable(
            table.caption,
            columns,
            [row[:COLUMNS] for row in rows],
            table.keys,
            frozenset(marked),
            table.note,
        )


def history_tables(histories: Mapping[str, History]) -> dict[str, ReportTable]:
    """Histories of runs that have the same columns below each other, as a table each."""
    total = sum(len(history.values) for history in histories.values())
    every = max(1, -(-total // MOST_HISTORY_ROWS))
    note = f"Every {every}. of the samples that the result keeps." if every > 1 else ""
    groups: dict[tuple[str, ...], list[History]] = {}
    for history in histories.values():
        heads = (*history.keys, *(column.title for column in history.columns))
        groups.setdefault(heads, []).append(history)
    found = {}
    for number, group in enumerate(groups.values()):
        keys = [Column(head) for head in group[0].keys]
        rows: list[Sequence[Any]] = []
        for history in group:
            told = tuple(history.keys.values())
            rows += [(*told, *row) for row in history.values[::every].tolist()]
        name = f"Histories {number + 1}" if len(groups) > 1 else "Histories"
        columns = [*keys, *group[0].columns]
        found[name] = ReportTable("Histories", columns, rows, len(keys) + 1, note=note)
    return found


def _sheet(book: Any, name: str, table: ReportTable, names: set[str]) -> None:
    """A sheet: caption, note, heads with units, rows; heads and key columns stay in view."""
    from openpyxl.utils import get_column_letter

    sheet = book.create_sheet(sheet_name(name, names))
    sheet.freeze_panes = f"{get_column_letter(min(table.keys, len(table.columns)) + 1)}4"
    for column, width in enumerate(_widths(table), 1):
        sheet.column_dimensions[get_column_letter(column)].width = width
    sheet.append([_cell(sheet, table.caption, bold=True)])
    sheet.append([_cell(sheet, table.note)] if table.note else [])
    sheet.append([_cell(sheet, column.title, bold=True, fill=HEAD) for column in table.columns])
    if table.rows:
        last = get_column_letter(len(table.columns))
        sheet.auto_filter.ref = f"A3:{last}{len(table.rows) + 3}"
    for number, row in enumerate(table.rows):
        sheet.append(
            [
                _cell(sheet, value, column.form, fill=MARKED if (number, k) in table.marked else "")
                if len(table.rows) <= FORMATTED or isinstance(value, str)
                else _number(value)
                for k, (value, column) in enumerate(zip(row, table.columns, strict=True))
            ]
        )


def sheet_name(wanted: str, names: set[str]) -> str:
    """A name that Excel takes and that no sheet has yet."""
    plain = re.sub(r"[\[\]:*?/\\]+|[_\s]+", " ", printable(wanted)).strip(" '") or "Sheet"
    name, number = plain[:NAME], 1
    while name.casefold() in names or name.casefold() == "history":  # which Excel keeps to itself
        number += 1
        name = f"{plain[: NAME - 4]} {number}"
    names.add(name.casefold())
    return name


def _cell(sheet: Any, value: Any, form: str = "", *, bold: bool = False, fill: str = "") -> Any:
    """A cell; what is text stays text."""
    from openpyxl.cell import WriteOnlyCell
    from openpyxl.styles import Font, PatternFill

    cell = WriteOnlyCell(sheet)
    if isinstance(value, str):
        cell.value = printable(value)[:LETTERS]
        cell.data_type = "s"  # also what begins with "="
    else:
        cell.value = _number(value)
        cell.number_format = _format(value, form) or "General"
    if bold:
        cell.font = Font(bold=True)
    if fill:
        cell.fill = PatternFill("solid", fgColor=fill)
    return cell


def _number(value: Any) -> Any:
    """A number as Excel knows it; nothing where there is none."""
    if isinstance(value, bool | np.bool_):
        return "yes" if value else "no"
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value


def _format(value: Any, form: str) -> str:
    """Excel's format of a number from Python's; "" where it may choose itself."""
    if isinstance(value, bool | np.bool_) or not isinstance(
        value, int | float | np.integer | np.floating
    ):
        return ""
    value = float(value)
    found = re.fullmatch(r",?\.(\d)([fg])", form)
    if not found or not np.isfinite(value):
        return ""
    digits, kind = int(found[1]), found[2]
    if kind == "g":
        size = math.floor(math.log10(abs(value))) if value else 0
        if not -4 <= size <= 9:
            return f"0.{'0' * max(digits - 1, 1)}E+00"
        digits = max(0, digits - 1 - size) if value != round(value) else 0
    return f"0.{'0' * digits}" if digits else "0"


def _widths(table: ReportTable) -> list[float]:
    """Widths of columns, in letters."""
    shown = list(table.rows[:200])
    return [
        min(
            80.0,
            2.0 + max([len(column.title), *(len(column.text(row[k])) for row in shown)]),
        )
        for k, column in enumerate(table.columns)
    ]


def _restamped(raw: bytes) -> bytes:
    """A workbook without the time of its making."""
    made = io.BytesIO()
    with (
        zipfile.ZipFile(io.BytesIO(raw)) as old,
        zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as new,
    ):
        for name in old.namelist():
            part = old.read(name)
            if name == "docProps/core.xml":
                part = CREATED.sub(b"", part)
            entry = zipfile.ZipInfo(name, STAMP)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o600 << 16
            new.writestr(entry, part)
    return made.getvalue()
