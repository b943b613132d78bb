"""CSV tables with units in their headers, as laboratories write them.

A header is `name_unit` or `name [unit]`: `time_s`, `displacement_mm`, `force [kN]`. UTF-8
(with or without byte order mark) and Japanese cp932 are read.
"""

import csv
import io
import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thermobearing.errors import InputError, nearest
from thermobearing.units import conversion

Floats = NDArray[np.float64]

_HEADER = re.compile(
    r"^\s*(?P<name>[A-Za-z][A-Za-z ]*?)\s*(?:_|\[|\()\s*(?P<unit>[^\])]+?)\s*[\])]?\s*$"
)
ALIASES = {"disp": "displacement", "t": "time", "load": "force"}


def read_text(path: Path) -> str:
    """Text of a file, UTF-8 or cp932; InputError if it cannot be read."""
    try:
        raw = path.read_bytes()
    except FileNotFoundError:
        raise InputError("no such file", str(path)) from None
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", str(path)) from None
    for encoding in ("utf-8-sig", "cp932"):
        try:
            return raw.decode(encoding)
        except UnicodeDecodeError:
            continue
    raise InputError("is neither UTF-8 nor cp932 text", str(path))


def _columns(header: list[str]) -> dict[tuple[str, str], int]:
    """(name, unit) -> column number, for the headers that have both."""
    found: dict[tuple[str, str], int] = {}
    for number, title in enumerate(header):
        match = _HEADER.match(title)
        if match:
            name = match["name"].strip().lower()
            found.setdefault((ALIASES.get(name, name), match["unit"]), number)
    return found


def _pick(
    columns: dict[tuple[str, str], int], name: str, unit: str, header: list[str], where: str
) -> tuple[int, float]:
    """Column number of a quantity and the factor to the wanted unit."""
    units = {u: number for (n, u), number in columns.items() if n == name}
    if unit in units:
        return units[unit], 1.0
    for given, number in units.items():
        return number, conversion(given, unit)[0]
    shown = ", ".join(title.strip() for title in header)
    hint = nearest(f"{name}_{unit}", [title.strip() for title in header])
    raise InputError(f'no column "{name}_{unit}" among: {shown}{hint}', where)


def _numbers(rows: list[list[str]], number: int, title: str, where: str) -> Floats:
    """One column as floats; names the line of the first cell that is not a finite number."""
    values = np.empty(len(rows))
    for i, row in enumerate(rows):
        cell = row[number].strip() if number < len(row) else ""
        try:
            values[i] = float(cell)
        except ValueError:
            raise InputError(f'line {i + 2}, {title}: "{cell}" is not a number', where) from None
        if not np.isfinite(values[i]):
            raise InputError(f'line {i + 2}, {title}: "{cell}" is not a finite number', where)
    return values


def read_columns(path: Path | str, wanted: dict[str, str]) -> dict[str, Floats]:
    """Columns of a CSV file by name, converted to the wanted units.

    Parameters
    ----------
    path : the file; its first line names the columns and their units.
    wanted : unit by column name, such as {"time": "s", "displacement": "mm"}.

    Raises
    ------
    InputError : unreadable or empty file, missing column, wrong unit, a cell that is not a
        finite number (with its line).
    """
    where = str(path)
    rows = [row for row in csv.reader(io.StringIO(read_text(Path(path)))) if any(row)]
    if not rows:
        raise InputError("is empty", where)
    header, body = rows[0], rows[1:]
    columns = _columns(header)
    picked = {name: _pick(columns, name, unit, header, where) for name, unit in wanted.items()}
    if len(body) < 2:
        raise InputError(f"has {len(body)} rows of numbers; at least 2 are needed", where)
    return {
        name: _numbers(body, number, header[number].strip(), where) * factor
        for name, (number, factor) in picked.items()
    }
