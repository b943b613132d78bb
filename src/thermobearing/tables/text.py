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
from itertools import islice
from pathlib import Path
from typing import IO, Any, Literal, NamedTuple

from thermobearing.border.errors import InputError, nearest, shortened
from thermobearing.border.opener import read_bytes
from thermobearing.border.units import FORTRAN_NUMBER

Row = tuple[int, list[str]]  # number of the line in its file, cells

LARGEST_FILE = 100_000_000  # bytes; in memory, cell by cell, it is ten times that
LARGEST_SHEET = 20_000_000  # cells
MOST_ROWS = 2**20  # of a sheet, as in Excel
MOST_COLUMNS = 1000
MOST_CELLS = 8_000_000  # of a sheet of a workbook, which are parsed in half a minute
MOST_ELEMENTS = 500_000  # of XML in styles and lists of a workbook
UNPACKED = 1 << 20  # bytes of a workbook that are unpacked at a time
LONGEST_TAG = 60  # bytes of the begin of an element
# Elements that are counted before a workbook is parsed, by a part of the name of the file in it.
ELEMENTS: dict[str, list[tuple[re.Pattern[bytes], int, str]]] = {
    "worksheets/": [
        (re.compile(rb"<(?:[\w.-]{1,50}:)?row\b"), MOST_ROWS, "rows"),
        (re.compile(rb"<(?:[\w.-]{1,50}:)?c\b"), MOST_CELLS, "cells"),
    ],
    "sharedStrings": [(re.compile(rb"<(?:[\w.-]{1,50}:)?si\b"), 2 * MOST_ROWS, "texts")],
    "": [(re.compile(rb"<"), MOST_ELEMENTS, "elements")],
}
LONGEST_NUMBER = 60  # characters of a cell that may be a number or a time stamp
# Encodings of Windows in Japan and Western Europe. More would be worse: a header of a few words
# is little evidence. The rule of `_is_japanese` decides where a text is valid in both.
LEGACY = ("cp932", "cp1252")
COMMENTS = ("#", "%", "!", "//", "*")
SEPARATORS = {"\t": "tab", ";": ";", ",": ",", " ": "blank"}
SEPARATOR_ROWS = 300  # rows that decide on the separator
NOT_FINITE = ("nan", "inf", "infinity", "nan.0", "1.#qnan")
_WORKBOOK, _OLD_WORKBOOK = b"PK\x03\x04", b"\xd0\xcf\x11\xe0"
_POINT = re.compile(FORTRAN_NUMBER)
_COMMA = re.compile(r"[-+]?\d*,\d+(?:[eEdD][-+]?\d+)?")
_NOT_ASCII = re.compile(r"[^\x00-\x7f]+")
_QUOTES, _ACCENTED = "‘’“”–".encode("cp1252"), 0xA0  # bytes of cp1252; the first with "°" and "ä"
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
    patterns = (_POINT, _COMMA, _BOTH, _THOUSANDS)
    return any(f.fullmatch(cell) for f in patterns) or is_not_finite(cell) or is_stamp(cell)


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
    lines = b"\n".join(line for line in raw.splitlines() if not line.isascii())
    readable = {}
    for encoding in LEGACY:
        try:
            text = lines.decode(encoding)
        except UnicodeDecodeError:
            continue
        if "".join(text.split()).isprintable():
            readable[encoding] = text
    if not readable:
        raise InputError(
            "is neither UTF-8 nor cp932 nor cp1252 text; save it as UTF-8, or give encoding in "
            "its sidecar",
            where,
        )
    if len(readable) == len(LEGACY) and not _is_japanese(readable["cp932"]):
        return "cp1252"
    return next(iter(readable))


def _is_japanese(text: str) -> bool:
    """Whether text read as cp932 is Japanese, not accented letters and units of cp1252.

    These are single characters among plain letters, and most of their bytes are above those that
    begin a Japanese character.
    """
    japanese, total = 0, 0
    for run in _NOT_ASCII.findall(text):
        first = run.encode("cp932")[0]
        japanese += len(run) if len(run) > 1 or (first < _ACCENTED and first not in _QUOTES) else 0
        total += len(run)
    return 2 * japanese > total


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
    # A comment becomes an empty line, so that the numbers of the lines stay those of the file.
    stripped = (line.strip() if blank else line for line in lines)
    uncommented = ("\n" if _is_comment(line) else line for line in stripped)
    quoting: Literal[0, 3] = csv.QUOTE_MINIMAL if quotes else csv.QUOTE_NONE
    reader = csv.reader(
        uncommented, delimiter=separator, skipinitialspace=blank, strict=strict, quoting=quoting
    )
    cell_count = 0
    try:
        for row in reader:
            cell_count += len(row)
            if len(row) > MOST_COLUMNS:
                raise csv.Error(f"more than {MOST_COLUMNS} columns")
            if cell_count > LARGEST_SHEET:
                raise csv.Error(f"more than {LARGEST_SHEET:g} cells")
            if any(map(str.strip, row)):
                yield reader.line_num, row
    except csv.Error as error:
        raise csv.Error(f"line {reader.line_num}: {error}") from None


def _separator(lines: list[str]) -> str:
    """Return the separator by which most of what is in the cells are numbers."""
    filled = (line for line in lines if line.strip() and not _is_comment(line))
    sample = list(islice(filled, SEPARATOR_ROWS))
    best_score, best_separator = (0, 0.0, 0), ","
    for separator in SEPARATORS:
        try:
            rows = [row for _, row in _split(sample, separator, strict=False)]
        except csv.Error:  # an unterminated cell: an error when the complete file is read
            continue
        score = _score(rows, words=separator != " ")
        if score > best_score:
            best_score, best_separator = score, separator
    return best_separator


def _score(rows: list[list[str]], words: bool) -> tuple[int, float, int]:
    """Rows of numbers only, share of numbers in all cells, cells; blanks stand in words too."""
    numeric_rows, numbers, cells, split_cells = 0, 0, 0, 0
    for row in rows:
        numeric = [is_numeric(cell) for cell in row if cell.strip()]
        cells += len(numeric)
        if len(row) > 1:
            numeric_rows += all(numeric)
            numbers += sum(numeric)
            split_cells += len(numeric)
    if not numeric_rows and not words:
        return 0, 0.0, 0
    return numeric_rows, numbers / max(cells, 1), split_cells if words else 0


def _decimal(cells: list[str]) -> str:
    """Return the decimal mark; InputError for "1,234" alone, which may be a thousand or one."""
    commas, unclear = 0, ""
    for cell in (cell.strip() for cell in cells if "," in cell):
        match = _BOTH.fullmatch(cell)
        # "1.234,5": the mark after that of the thousands is the decimal one.
        if match and match[1] != match[2]:
            return match[2]
        if _THOUSANDS.fullmatch(cell):
            unclear = unclear or cell
        elif _COMMA.fullmatch(cell):
            commas += 1
    if not (commas or unclear):
        return "."
    points = any(
        _POINT.fullmatch(text.strip()) for text in cells if "." in text and "," not in text
    )
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
        _refuse_large_workbook(raw)
        book = openpyxl.load_workbook(io.BytesIO(raw), read_only=True, data_only=True)
        names = [sheet.title for sheet in book.worksheets]
        if form.sheet is not None and form.sheet not in names:
            raise InputError(f'no sheet "{form.sheet}"{nearest(form.sheet, names)}')
        return [_sheet(sheet) for sheet in book.worksheets if form.sheet in (None, sheet.title)]
    except InputError:
        raise
    except Exception as error:  # openpyxl raises many types for damaged files
        error_text = shortened(str(error) or type(error).__name__)
        raise InputError(f"is not an .xlsx workbook that can be read: {error_text}") from None


def _refuse_large_workbook(raw: bytes) -> None:
    """Reject a workbook that openpyxl would parse for minutes: its text is unpacked, and counted.

    A small archive can unpack to more than the memory holds, and to millions of empty elements.
    """
    with zipfile.ZipFile(io.BytesIO(raw)) as packed:
        size = sum(item.file_size for item in packed.infolist())
        if size > 5 * LARGEST_FILE:
            raise InputError(f"unpacks to {size / 1e6:.0f} MB, more than can be read")
        for item in packed.infolist():
            if item.filename.endswith((".xml", ".rels")):
                patterns = next(ELEMENTS[part] for part in ELEMENTS if part in item.filename)
                with packed.open(item) as content:
                    _refuse_many_elements(content, item.filename, patterns)


def _refuse_many_elements(
    content: IO[bytes], name: str, patterns: list[tuple[re.Pattern[bytes], int, str]]
) -> None:
    """Reject XML that has more elements of a kind than it may."""
    counts, rest = [0] * len(patterns), b""
    while block := content.read(UNPACKED):
        # An element that a block cuts is counted with the next block.
        text = rest + block
        cut = text.rfind(b"<", len(text) - LONGEST_TAG) if len(block) == UNPACKED else -1
        text, rest = (text[:cut], text[cut:]) if cut > 0 else (text, b"")
        for place, (pattern, most, pattern_name) in enumerate(patterns):
            counts[place] += sum(1 for _ in pattern.finditer(text))
            if counts[place] > most:
                raise InputError(f"{name} has more than {most} {pattern_name}")


def _sheet(sheet: Any) -> Sheet:
    sheet.reset_dimensions()  # the size that a file states may be wrong
    rows: list[Row] = []
    cell_count, prefix = 0, f'sheet "{sheet.title}" has more than'
    for number, values in enumerate(sheet.iter_rows(values_only=True), 1):
        cell_count += len(values)
        if number > MOST_ROWS:
            raise InputError(f"{prefix} {MOST_ROWS} rows")
        if cell_count > LARGEST_SHEET:
            raise InputError(f"{prefix} {LARGEST_SHEET:g} cells")
        if len(values) > MOST_COLUMNS and any(values[MOST_COLUMNS:]):
            raise InputError(f"{prefix} {MOST_COLUMNS} columns")
        cells = [_cell(value) for value in values[:MOST_COLUMNS]]
        if any(cells):
            rows.append((number, cells))
    comments = [(n, " ".join(cells).strip("# ")) for n, cells in rows if _is_comment(cells[0])]
    data_rows = [(n, cells) for n, cells in rows if not _is_comment(cells[0])]
    return Sheet(sheet.title, data_rows, comments)


def _cell(value: Any) -> str:
    if isinstance(value, datetime.datetime | datetime.date | datetime.time):
        return value.isoformat()
    return "" if value is None else str(value).strip()
