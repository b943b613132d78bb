"""Files as rows of cells: text with any usual separator and decimal mark, and Excel workbooks.

The readers are Python's own csv and openpyxl; what is decided here is only which separator and
which decimal mark a file has.
"""

import csv
import datetime
import io
import re
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from thermobearing.border.encodings import LARGEST_FILE, decoded
from thermobearing.border.errors import InputError, nearest, read_bytes, shortened

Row = tuple[int, list[str]]  # number of the line in its file, cells

COMMENTS = ("#", "%", "!", "//", "*")
SEPARATORS = {"\t": "tab", ";": ";", ",": ",", " ": "blank"}
LOOKED_AT = 300  # rows that tell the separator
LARGEST_SHEET = 20_000_000  # cells
MOST_ROWS = 2**20  # of a sheet, as in Excel
MOST_COLUMNS = 1000
LONGEST_NUMBER = 60  # characters of a cell that may be a number or a time stamp
_WORKBOOK, _OLD_WORKBOOK = b"PK\x03\x04", b"\xd0\xcf\x11\xe0"
_EXPONENT = r"(?:[eEdD][-+]?\d+)?"
_POINT = re.compile(rf"[-+]?(?:\d+(?:\.\d*)?|\.\d+){_EXPONENT}")
_COMMA = re.compile(rf"[-+]?(?:\d+,\d+|,\d+){_EXPONENT}")
_BOTH = re.compile(r"[-+]?\d{1,3}(?:([.,])\d{3})+([.,])\d+")
_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}(?:,\d{3})+")
_STAMP = re.compile(r"(?:\d+[-/.:]\d+[-/.:]\d|\d+:\d)[^;,\t]*(?:,\d+)?")
NOT_FINITE = ("nan", "inf", "infinity", "nan.0", "1.#qnan")


@dataclass(frozen=True)
class Told:
    """What a user says about the form of a file; None is found by looking."""

    separator: str | None = None
    decimal: str | None = None
    encoding: str | None = None
    sheet: str | None = None


@dataclass(frozen=True)
class Sheet:
    """One table of cells: a text file, or a sheet of a workbook.

    Attributes
    ----------
    name : of the sheet; "" for text.
    rows : those that hold anything, without comments.
    comments : lines that begin with a mark of comments, without it.
    separator, decimal : that the file was found to have.
    """

    name: str
    rows: list[Row]
    comments: list[tuple[int, str]]
    separator: str = ","
    decimal: str = "."

    def plain(self, cell: str) -> str:
        """A cell as Python writes numbers: decimals with a point, no marks of thousands."""
        cell = cell.strip()
        if self.decimal == ",":
            grouped = "." in cell and "," in cell and _BOTH.fullmatch(cell)
            return (cell.replace(".", "") if grouped else cell).replace(",", ".")
        if "," in cell and (_THOUSANDS.fullmatch(cell) or _BOTH.fullmatch(cell)):
            return cell.replace(",", "")
        return cell


def is_stamp(cell: str) -> bool:
    """Whether a cell looks like a date or a time of day."""
    cell = cell.strip()
    return len(cell) <= LONGEST_NUMBER and bool(_STAMP.fullmatch(cell))


def is_numeric(cell: str) -> bool:
    """Whether a cell is a number with either decimal mark, not a finite one, or a time stamp."""
    cell = cell.strip()
    return len(cell) <= LONGEST_NUMBER and bool(
        _POINT.fullmatch(cell)
        or _COMMA.fullmatch(cell)
        or _BOTH.fullmatch(cell)
        or _THOUSANDS.fullmatch(cell)
        or cell.lstrip("+-").lower() in NOT_FINITE
        or is_stamp(cell)
    )


def read_sheets(path: Path, told: Told | None = None) -> list[Sheet]:
    """The tables of cells in a file: one of a text, one for each sheet of a workbook.

    Parameters
    ----------
    path : text or `.xlsx`.
    told : what the user says about its form.

    Raises
    ------
    InputError : unreadable file, no text, no workbook, a reader that is not installed.
    """
    told = told or Told()
    raw = read_bytes(path, LARGEST_FILE)
    if raw.startswith(_OLD_WORKBOOK):
        raise InputError("is an old Excel workbook (.xls); save it as .xlsx or CSV", str(path))
    try:
        if raw.startswith(_WORKBOOK):
            return _workbook(raw, told)
        return [sheet_of_text(decoded(raw, str(path), told.encoding), told)]
    except InputError as error:
        raise error if error.where else InputError(error.problems, str(path)) from None


def sheet_of_text(text: str, told: Told | None = None, *, quotes: bool = True) -> Sheet:
    r"""A text as a table of cells.

    Parameters
    ----------
    text : of the file.
    told : separator and decimal mark, if they are not to be found by looking.
    quotes : whether a cell may stand in quotation marks; below a free header they are but marks.

    Raises
    ------
    InputError : quotes that do not close, a cell without end, a decimal mark that cannot be told.

    Examples
    --------
    >>> sheet = sheet_of_text("t;x\n0,5;1,25\n")
    >>> sheet.separator, sheet.decimal, sheet.plain("1,25")
    (';', ',', '1.25')
    """
    told = told or Told()
    lines = io.StringIO(text, newline=None).readlines()
    comments = [
        (number, line.strip().lstrip("".join(COMMENTS)).strip())
        for number, line in enumerate(lines, 1)
        if _is_comment(line)
    ]
    separator = told.separator or _separator(lines)
    try:
        rows = list(_split(lines, separator, strict=True, quotes=quotes))
    except csv.Error as error:
        raise InputError(str(error)) from None
    decimal = told.decimal or _decimal([cell for _, cells in rows for cell in cells])
    return Sheet("", rows, comments, separator, decimal)


def _is_comment(line: str) -> bool:
    return line.lstrip().startswith(COMMENTS)


def _split(lines: list[str], separator: str, *, strict: bool, quotes: bool = True) -> Iterator[Row]:
    """Rows with a cell that is not blank; comments are left out."""
    blank = separator == " "
    kept = ("\n" if _is_comment(line) else line.strip() if blank else line for line in lines)
    quoting: Literal[0, 3] = csv.QUOTE_MINIMAL if quotes else csv.QUOTE_NONE
    reader = csv.reader(
        kept, delimiter=separator, skipinitialspace=blank, strict=strict, quoting=quoting
    )
    held = 0
    try:
        for row in reader:
            held += len(row)
            if len(row) > MOST_COLUMNS:
                raise csv.Error(f"more than {MOST_COLUMNS} columns")
            if held > LARGEST_SHEET:
                raise csv.Error(f"more than {LARGEST_SHEET:g} cells")
            if any(map(str.strip, row)):
                yield reader.line_num, row
    except csv.Error as error:
        raise csv.Error(f"line {reader.line_num}: {error}") from None


def _separator(lines: list[str]) -> str:
    """The one by which most of what is in the cells are numbers."""
    some = [line for line in lines if line.strip() and not _is_comment(line)][:LOOKED_AT]
    best, found = (0, 0.0, 0), ","
    for separator in SEPARATORS:
        try:
            rows = [row for _, row in _split(some, separator, strict=False)]
        except csv.Error:  # a cell without end, which is told when the whole file is read
            continue
        score = _score(rows, words=separator != " ")
        if score > best:
            best, found = score, separator
    return found


def _score(rows: list[list[str]], words: bool) -> tuple[int, float, int]:
    """Rows of nothing but numbers, share of numbers in all cells, cells that a separator makes.

    Blanks stand between words too (`words` is False): they need a row of numbers to count.
    """
    full, numbers, cells, parted = 0, 0, 0, 0
    for row in rows:
        held = [is_numeric(cell) for cell in row if cell.strip()]
        cells += len(held)
        if len(row) > 1:
            full += all(held)
            numbers += sum(held)
            parted += len(held)
    if not full and not words:
        return 0, 0.0, 0
    return full, numbers / max(cells, 1), parted if words else 0


def _decimal(cells: list[str]) -> str:
    """The decimal mark of a file.

    Raises
    ------
    InputError : "1,234" and nothing that tells whether that is a thousand or one.
    """
    doubtful = [cell.strip() for cell in cells if "," in cell]
    if not doubtful:
        return "."
    commas = 0
    unclear = ""
    for cell in doubtful:
        both = _BOTH.fullmatch(cell)
        if both and both[1] != both[2]:
            return both[2]
        if _THOUSANDS.fullmatch(cell):
            unclear = unclear or cell
        elif _COMMA.fullmatch(cell):
            commas += 1
    others = (cell.strip() for cell in cells if "." in cell and "," not in cell)
    points = any(map(_POINT.fullmatch, others))
    if commas and points:
        raise InputError(
            'has numbers with a decimal point and others with a decimal comma; give decimal = "." '
            'or "," in its sidecar'
        )
    if unclear and not commas and not points:
        raise InputError(
            f'"{shortened(unclear)}" may be a thousand or a decimal; give decimal = "," or "." in '
            "its sidecar"
        )
    return "," if commas else "."


def _workbook(raw: bytes, told: Told) -> list[Sheet]:
    """Sheets of an Excel workbook, as shown: results of formulas, times as stamps."""
    try:
        import openpyxl
    except ImportError:
        raise InputError(
            "is an Excel workbook, which openpyxl reads: pip install 'thermobearing[xlsx]', or "
            "save the sheet as CSV"
        ) from None
    try:
        with zipfile.ZipFile(io.BytesIO(raw)) as packed:
            size = sum(item.file_size for item in packed.infolist())
        if size > 5 * LARGEST_FILE:
            raise InputError(f"unpacks to {size / 1e6:.0f} MB, more than can be read")
        book = openpyxl.load_workbook(io.BytesIO(raw), read_only=True, data_only=True)
        names = [sheet.title for sheet in book.worksheets]
        if told.sheet is not None and told.sheet not in names:
            raise InputError(f'no sheet "{told.sheet}"{nearest(told.sheet, names)}')
        wanted = [sheet for sheet in book.worksheets if told.sheet in (None, sheet.title)]
        sheets = [_sheet(sheet) for sheet in wanted]
    except InputError:
        raise
    except Exception as error:  # whatever openpyxl meets in a file that is damaged, or no workbook
        about = shortened(str(error) or type(error).__name__)
        raise InputError(f"is not an .xlsx workbook that can be read: {about}") from None
    return sheets


def _sheet(sheet: Any) -> Sheet:
    sheet.reset_dimensions()  # what a file says of its own size may be wrong, and is then believed
    rows: list[Row] = []
    held = 0
    for number, values in enumerate(sheet.iter_rows(values_only=True), 1):
        held += len(values)
        if number > MOST_ROWS:
            raise InputError(f'sheet "{sheet.title}" has more than {MOST_ROWS} rows')
        if held > LARGEST_SHEET:
            raise InputError(f'sheet "{sheet.title}" has more than {LARGEST_SHEET:g} cells')
        if len(values) > MOST_COLUMNS and any(values[MOST_COLUMNS:]):
            raise InputError(f'sheet "{sheet.title}" has more than {MOST_COLUMNS} columns')
        cells = [_cell(value) for value in values[:MOST_COLUMNS]]
        if any(cells):
            rows.append((number, cells))
    comments = [(n, " ".join(cells).strip("# ")) for n, cells in rows if _is_comment(cells[0])]
    kept = [(n, cells) for n, cells in rows if not _is_comment(cells[0])]
    return Sheet(sheet.title, kept, comments)


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, datetime.datetime | datetime.date | datetime.time):
        return value.isoformat()
    return str(value).strip()
