"""Text files and Excel workbooks as rows of cells.

Python's own csv and openpyxl split the cells; encoding, separator and decimal mark are found here.
"""

import codecs
import csv
import datetime
import io
import re
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal, NamedTuple

from thermobearing.border.errors import InputError, nearest, read_bytes, shortened

Row = tuple[int, list[str]]  # number of the line in its file, cells

LARGEST_FILE = 100_000_000  # bytes; in memory, cell by cell, it is ten times that
LARGEST_SHEET = 20_000_000  # cells
MOST_ROWS = 2**20  # of a sheet, as in Excel
MOST_COLUMNS = 1000
LONGEST_NUMBER = 60  # characters of a cell that may be a number or a time stamp
# Encodings of Windows in Japan and Western Europe. More would be worse: a header of a few words
# is little evidence, and with all encodings "初期" would be detected as Korean.
LEGACY = ("cp932", "cp1252")
LEGACY_BYTES = 20_000  # of lines that are not plain ASCII: enough to recognise an encoding
COMMENTS = ("#", "%", "!", "//", "*")
SEPARATORS = {"\t": "tab", ";": ";", ",": ",", " ": "blank"}
SEPARATOR_ROWS = 300  # rows that decide on the separator
NOT_FINITE = ("nan", "inf", "infinity", "nan.0", "1.#qnan")
_WORKBOOK, _OLD_WORKBOOK = b"PK\x03\x04", b"\xd0\xcf\x11\xe0"
# One half-width katakana among plain letters: "°" or "²" of cp1252 read as cp932.
_LONE_KATAKANA = re.compile(r"(?<![^\x00-\x7f])[｡-ﾟ](?![^\x00-\x7f])")
_EXPONENT = r"(?:[eEdD][-+]?\d+)?"
_POINT = re.compile(rf"[-+]?(?:\d+(?:\.\d*)?|\.\d+){_EXPONENT}")
_COMMA = re.compile(rf"[-+]?(?:\d+,\d+|,\d+){_EXPONENT}")
_BOTH = re.compile(r"[-+]?\d{1,3}(?:([.,])\d{3})+([.,])\d+")
_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}(?:,\d{3})+")
_STAMP = re.compile(r"(?:\d+[-/.:]\d+[-/.:]\d|\d+:\d)[^;,\t]*(?:,\d+)?")


class Form(NamedTuple):
    """Format of a file as stated by the user; None: detected."""

    separator: str | None = None
    decimal: str | None = None
    encoding: str | None = None
    sheet: str | None = None


class Sheet(NamedTuple):
    """One table of cells: a text file (its name is ""), or a sheet of a workbook.

    `rows` are those with any content, `comments` the comment lines without their mark, both with
    their line in the file.
    """

    name: str
    rows: list[Row]
    comments: list[tuple[int, str]]
    separator: str = ","
    decimal: str = "."

    def plain(self, cell: str) -> str:
        """Return a cell as Python writes numbers: a decimal point, no marks of thousands."""
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


def is_not_finite(cell: str) -> bool:
    """Whether a cell holds NaN or infinity in one of their usual spellings."""
    return cell.strip().lstrip("+-").lower() in NOT_FINITE


def is_numeric(cell: str) -> bool:
    """Whether a cell is a number with either decimal mark, not a finite one, or a time stamp."""
    cell = cell.strip()
    if len(cell) > LONGEST_NUMBER:
        return False
    forms = (_POINT, _COMMA, _BOTH, _THOUSANDS)
    return any(f.fullmatch(cell) for f in forms) or is_not_finite(cell) or is_stamp(cell)


def read_text(path: Path, encoding: str | None = None) -> str:
    """Return the text of a file: UTF-8, UTF-16 with its mark, cp932, cp1252, or as stated.

    Raises InputError for a file that cannot be read, is no text, or is in none of these encodings.
    """
    return _decoded(read_bytes(path, LARGEST_FILE), str(path), encoding)


def read_sheets(path: Path, form: Form | None = None) -> list[Sheet]:
    """Return the tables of cells in a file: one of a text, one for each sheet of a workbook."""
    form = form or Form()
    raw = read_bytes(path, LARGEST_FILE)
    if raw.startswith(_OLD_WORKBOOK):
        raise InputError("is an old Excel workbook (.xls); save it as .xlsx or CSV", str(path))
    try:
        if raw.startswith(_WORKBOOK):
            return _workbook(raw, form)
        return [sheet_of_text(_decoded(raw, str(path), form.encoding), form)]
    except InputError as error:
        raise error.located(path) from None


def _decoded(raw: bytes, where: str, encoding: str | None) -> str:
    if encoding is None and raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        encoding = "utf-16"
    if encoding is None:
        if b"\0" in raw:
            raise InputError("is not a text file: it contains null bytes", where)
        try:
            return raw.decode("utf-8-sig")
        except UnicodeDecodeError:
            encoding = _legacy(raw, where)
    try:
        text = raw.decode(encoding)
    except (UnicodeError, LookupError):
        raise InputError(f'is not text in the encoding "{shortened(encoding)}"', where) from None
    if "\0" in text:
        raise InputError("is not a text file: it contains null bytes", where)
    return text


def _legacy(raw: bytes, where: str) -> str:
    """Return the older encoding of the lines that hold more than ASCII."""
    from charset_normalizer import from_bytes

    lines = b"\n".join(line for line in raw.splitlines() if not line.isascii())[:LEGACY_BYTES]
    best = from_bytes(lines, cp_isolation=list(LEGACY)).best()
    if best is None:
        raise InputError(
            "is neither UTF-8 nor cp932 nor cp1252 text; save it as UTF-8, or give encoding in "
            "its sidecar",
            where,
        )
    if best.encoding == "cp932":
        strange = re.findall(r"[^\x00-\x7f]", str(best))
        if len(_LONE_KATAKANA.findall(str(best))) == len(strange):
            return "cp1252"
    return str(best.encoding)


def sheet_of_text(text: str, form: Form | None = None, *, quotes: bool = True) -> Sheet:
    r"""Return a text as a table of cells.

    With `quotes`, a cell may be quoted; below a free header quotes are ordinary characters.
    Raises InputError for quotes that do not close, a cell without end, an unclear decimal mark.

    >>> sheet = sheet_of_text("t;x\n0,5;1,25\n")
    >>> sheet.separator, sheet.decimal, sheet.plain("1,25")
    (';', ',', '1.25')
    """
    form = form or Form()
    lines = io.StringIO(text, newline=None).readlines()
    comments = [
        (number, line.strip().lstrip("".join(COMMENTS)).strip())
        for number, line in enumerate(lines, 1)
        if _is_comment(line)
    ]
    separator = form.separator or _separator(lines)
    try:
        rows = list(_split(lines, separator, strict=True, quotes=quotes))
    except csv.Error as error:
        raise InputError(str(error)) from None
    decimal = form.decimal or _decimal([cell for _, cells in rows for cell in cells])
    return Sheet("", rows, comments, separator, decimal)


def _is_comment(line: str) -> bool:
    return line.lstrip().startswith(COMMENTS)


def _split(lines: list[str], separator: str, *, strict: bool, quotes: bool = True) -> Iterator[Row]:
    """Yield rows with a cell that is not blank; comments are left out."""
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
    """Return the separator by which most of what is in the cells are numbers."""
    some = [line for line in lines if line.strip() and not _is_comment(line)][:SEPARATOR_ROWS]
    best, found = (0, 0.0, 0), ","
    for separator in SEPARATORS:
        try:
            rows = [row for _, row in _split(some, separator, strict=False)]
        except csv.Error:  # an unterminated cell: an error when the complete file is read
            continue
        score = _score(rows, words=separator != " ")
        if score > best:
            best, found = score, separator
    return found


def _score(rows: list[list[str]], words: bool) -> tuple[int, float, int]:
    """Rows of numbers only, share of numbers in all cells, cells; blanks stand in words too."""
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
    """Return the decimal mark; InputError for "1,234" alone, which may be a thousand or one."""
    commas, unclear = 0, ""
    for cell in (cell.strip() for cell in cells if "," in cell):
        both = _BOTH.fullmatch(cell)
        if both and both[1] != both[2]:
            return both[2]
        if _THOUSANDS.fullmatch(cell):
            unclear = unclear or cell
        elif _COMMA.fullmatch(cell):
            commas += 1
    if not (commas or unclear):
        return "."
    points = any(_POINT.fullmatch(one.strip()) for one in cells if "." in one and "," not in one)
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


def _workbook(raw: bytes, form: Form) -> list[Sheet]:
    """Return sheets of an Excel workbook, as shown: results of formulas, times as stamps."""
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
        if form.sheet is not None and form.sheet not in names:
            raise InputError(f'no sheet "{form.sheet}"{nearest(form.sheet, names)}')
        return [_sheet(sheet) for sheet in book.worksheets if form.sheet in (None, sheet.title)]
    except InputError:
        raise
    except Exception as error:  # openpyxl raises many types for damaged files
        about = shortened(str(error) or type(error).__name__)
        raise InputError(f"is not an .xlsx workbook that can be read: {about}") from None


def _sheet(sheet: Any) -> Sheet:
    sheet.reset_dimensions()  # the size that a file states may be wrong
    rows: list[Row] = []
    held, named = 0, f'sheet "{sheet.title}" has more than'
    for number, values in enumerate(sheet.iter_rows(values_only=True), 1):
        held += len(values)
        if number > MOST_ROWS:
            raise InputError(f"{named} {MOST_ROWS} rows")
        if held > LARGEST_SHEET:
            raise InputError(f"{named} {LARGEST_SHEET:g} cells")
        if len(values) > MOST_COLUMNS and any(values[MOST_COLUMNS:]):
            raise InputError(f"{named} {MOST_COLUMNS} columns")
        cells = [_cell(value) for value in values[:MOST_COLUMNS]]
        if any(cells):
            rows.append((number, cells))
    comments = [(n, " ".join(cells).strip("# ")) for n, cells in rows if _is_comment(cells[0])]
    kept = [(n, cells) for n, cells in rows if not _is_comment(cells[0])]
    return Sheet(sheet.title, kept, comments)


def _cell(value: Any) -> str:
    if isinstance(value, datetime.datetime | datetime.date | datetime.time):
        return value.isoformat()
    return "" if value is None else str(value).strip()
