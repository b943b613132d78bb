"""A document's numbers as an Excel workbook: a sheet a table, units in the heads, main histories.

Text of users is written as text: a name that begins with "=" is no formula.
"""

import io
import math
import re
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from thermobearing.border.errors import InputError, printable
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table, is_number
from thermobearing.report.markdown import check_packages, split_runs
from thermobearing.report.pieces import Pieces, checks_table

ROWS, COLUMNS, NAME, LETTERS = 1_048_576, 16_384, 31, 32_767  # what a sheet can hold
# Of all histories together: what opens quickly, and what can be sent by mail (about 3 MB).
MOST_HISTORY_ROWS, MOST_HISTORY_CELLS = 20_000, 300_000
FORMATTED = 5_000  # rows of a sheet up to which every number has its own format
STAMP = (1980, 1, 1, 0, 0, 0)  # of every part of the file: the same bytes for the same result
MARKED, HEAD = "F6DEDE", "E8ECF1"  # fills
CREATED = re.compile(rb"<dcterms:(created|modified)[^>]*>[^<]*</dcterms:\1>")


@dataclass(frozen=True)
class History:
    """Histories of a run, or of a bearing line: `values` has the shape (samples, columns).

    `keys` say what the run is, by the head of a column, such as {"Motion": "jra-ii-i-1"}.
    """

    keys: Mapping[str, Any]
    columns: Sequence[Quantity]
    values: np.ndarray[Any, np.dtype[np.float64]]


def workbook_bytes(pieces: Pieces, histories: Mapping[str, History]) -> bytes:
    """Return an .xlsx file of a result, the same for the same result.

    Long histories, by the name of their run, are thinned evenly, which a note states.
    """
    tables = {"Answer": _front(pieces)}
    tables |= {"Checks": checks_table(pieces.checks, signs=False)} if pieces.checks else {}
    tables |= {**pieces.inputs, **pieces.tables}
    if pieces.energy is not None:
        tables["energy balance"] = pieces.energy
    return sheets_bytes(tables | _history_tables(histories))


def sheets_bytes(tables: Mapping[str, Table]) -> bytes:
    """Return an .xlsx file with a sheet for each table, in parts where it is too long."""
    book = the_writer()(write_only=True)
    names: set[str] = set()
    for name, table in tables.items():
        for first in range(0, max(len(table.rows), 1), ROWS - 4):
            part = _part(table, first) if len(table.rows) > ROWS - 4 else table
            _add_sheet(book, f"{name} {first // (ROWS - 4) + 1}" if first else name, part, names)
    written = io.BytesIO()
    book.save(written)
    return _restamped(written.getvalue())


def the_writer() -> Any:
    """Return what makes a workbook; InputError where a package is not installed."""
    check_packages()
    try:
        from openpyxl import Workbook
    except ImportError:
        raise InputError('a workbook needs openpyxl: pip install "thermobearing[report]"') from None
    return Workbook


def _front(pieces: Pieces) -> Table:
    """Return question, answer, warnings, identity."""
    texts: dict[str, Sequence[str]] = {
        "Question": [pieces.question],
        "Answer": pieces.answer,
        "Validity": [*pieces.validity, pieces.validity_unknown, *pieces.notes],
        "Warning": pieces.warnings,
        "Assumption": pieces.assumptions,
    }
    rows = [(word, _plain(text)) for word, sentences in texts.items() for text in sentences if text]
    return Table(
        pieces.title, [Quantity("What"), Quantity("Text")], [*rows, *pieces.identity.items()]
    )


def _plain(text: str) -> str:
    """Return a sentence without the signs of its Markdown."""
    return "".join(run["text"] for run in split_runs(text))


def _part(table: Table, first: int) -> Table:
    """Return the rows of a table from one on that a sheet can hold."""
    end = first + ROWS - 4
    marked = frozenset((r - first, c) for r, c in table.marked if first <= r < end)
    return replace(table, rows=table.rows[first:end], marked=marked)


def _history_tables(histories: Mapping[str, History]) -> dict[str, Table]:
    """Return histories of runs that have the same columns below each other, as a table each."""
    total = sum(len(history.values) for history in histories.values())
    cells = sum(np.size(history.values) for history in histories.values())
    stride = max(1, -(-total // MOST_HISTORY_ROWS), -(-cells // MOST_HISTORY_CELLS))
    note = f"One of every {stride} samples of the result." if stride > 1 else ""
    # Runs of bearings with other layers, or without lead, have other columns: a table of their own.
    groups: dict[tuple[str, ...], list[History]] = {}
    for history in histories.values():
        heads = (*history.keys, *(column.title for column in history.columns))
        groups.setdefault(heads, []).append(history)
    tables = {}
    for number, group in enumerate(groups.values(), 1):
        keys = list(map(Quantity, group[0].keys))
        rows = [
            (*run_history.keys.values(), *row)
            for run_history in group
            for row in run_history.values[::stride].tolist()
        ]
        name = f"Histories {number}" if len(groups) > 1 else "Histories"
        columns = [*keys, *group[0].columns]
        tables[name] = Table("Histories", columns, rows, len(keys) + 1, note=note)
    return tables


def _add_sheet(book: Any, name: str, table: Table, names: set[str]) -> None:
    """Add a sheet: caption, note, heads with units, rows; heads and key columns stay in view."""
    from openpyxl.utils import get_column_letter

    columns = table.columns[:COLUMNS]
    sheet = book.create_sheet(_sheet_name(name, names))
    sheet.freeze_panes = f"{get_column_letter(min(table.keys, len(columns)) + 1)}4"
    for place, column in enumerate(columns):
        texts = [column.title, *(column.text(row[place]) for row in table.rows[:200])]
        width = min(80.0, 2.0 + max(map(len, texts)))
        sheet.column_dimensions[get_column_letter(place + 1)].width = width
    sheet.append([_cell(sheet, table.caption, bold=True)])
    sheet.append([_cell(sheet, table.note)] if table.note else [])
    sheet.append([_cell(sheet, column.title, bold=True, fill=HEAD) for column in columns])
    if table.rows:
        last = get_column_letter(len(columns))
        sheet.auto_filter.ref = f"A3:{last}{len(table.rows) + 3}"
    formatted = len(table.rows) <= FORMATTED
    for number, row in enumerate(table.rows):
        sheet.append(
            [
                _cell(sheet, value, column.form, fill=MARKED if (number, k) in table.marked else "")
                if formatted or isinstance(value, str)
                else _number(value)
                for k, (value, column) in enumerate(zip(row, columns, strict=False))
            ]
        )


def _sheet_name(wanted: str, names: set[str]) -> str:
    """Return a name that Excel takes and that no sheet has yet."""
    plain = re.sub(r"[\[\]:*?/\\]+|[_\s]+", " ", printable(wanted)).strip(" '") or "Sheet"
    name, number = plain[:NAME], 1
    while name.casefold() in names or name.casefold() == "history":  # which Excel keeps to itself
        number += 1
        name = f"{plain[: NAME - 4]} {number}"
    names.add(name.casefold())
    return name


def _cell(sheet: Any, value: Any, form: str = "", *, bold: bool = False, fill: str = "") -> Any:
    """Return a cell; what is text stays text."""
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
    """Return a number as Excel knows it; nothing where there is none."""
    if isinstance(value, bool | np.bool_):
        return "yes" if value else "no"
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not np.isfinite(value) else value


def _format(value: Any, form: str) -> str:
    """Return Excel's format of a number from Python's; "" where it may choose itself."""
    match = re.fullmatch(r",?\.(\d)([fg])", form)
    if not match or not is_number(value) or not np.isfinite(value):
        return ""
    digits = int(match[1])
    if match[2] == "g":
        # Excel has no format of significant digits: decimals follow from the size of the number.
        size = math.floor(math.log10(abs(value))) if value else 0
        if not -4 <= size <= 9:
            return f"0.{'0' * max(digits - 1, 1)}E+00"
        digits = max(0, digits - 1 - size) if value != round(value) else 0
    return f"0.{'0' * digits}" if digits else "0"


def _restamped(raw: bytes) -> bytes:
    """Return a workbook without the time of its making."""
    buffer = io.BytesIO()
    with (
        zipfile.ZipFile(io.BytesIO(raw)) as source,
        zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as target,
    ):
        # openpyxl stamps each part, and the properties of the document, with the time of writing.
        for name in source.namelist():
            part = source.read(name)
            if name == "docProps/core.xml":
                part = CREATED.sub(b"", part)
            entry = zipfile.ZipInfo(name, STAMP)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o600 << 16
            target.writestr(entry, part)
    return buffer.getvalue()
