"""Tables of numbers with units in their titles, as laboratories write them.

A title is `name_unit` or `name [unit]`: `time_s`, `displacement_mm`, `force [kN]`; the unit may
also stand in a row of its own below. Separators, decimal marks and encodings: see sheets.py.
"""

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thermobearing.border.errors import InputError, nearest
from thermobearing.border.layout import Layout, Table, make_table
from thermobearing.border.sheets import Sheet, is_stamp, read_sheets
from thermobearing.border.stamps import seconds_and_start
from thermobearing.border.titles import is_called, name_and_unit, plain_title, plain_unit
from thermobearing.border.units import conversion

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Columns:
    """What was read from a file.

    Attributes
    ----------
    values : by the name a column was wanted by, in the unit it was wanted in.
    parts : number of the sample that each part begins with.
    unused : titles of columns that hold anything and were not wanted.
    stamped : whether time came from stamps (dates, times of day).
    begins : date of the first stamp, if stamps have dates.
    """

    values: dict[str, Floats]
    parts: list[int]
    unused: list[str]
    stamped: bool = False
    begins: np.datetime64 | None = None


def read_columns(
    path: Path | str,
    wanted: dict[str, str],
    *,
    optional: Collection[str] = (),
    layout: Layout | None = None,
) -> dict[str, Floats]:
    r"""Columns of a file by name, converted to the wanted units.

    Parameters
    ----------
    path : text with any separator, or `.xlsx`; a line names the columns and their units.
    wanted : unit by column name, such as {"time": "s", "displacement": "mm"}.
    optional : names that may be missing; they are then missing from what is returned.
    layout : extra lines and other titles and units, if the file is not a plain table.

    Raises
    ------
    InputError : unreadable or empty file, missing column, wrong unit, a cell that is not a
        finite number (with its line).

    Examples
    --------
    >>> import tempfile
    >>> file = Path(tempfile.mkdtemp()) / "ramp.csv"
    >>> _ = file.write_text("time_s;displacement_cm\n0;0\n1;2,5\n")
    >>> read_columns(file, {"time": "s", "displacement": "mm"})["displacement"].tolist()
    [0.0, 25.0]
    """
    path, layout = Path(path), layout or Layout()
    first: InputError | None = None
    for sheet in read_sheets(path, layout.told):
        try:
            return list_columns(usable_table(sheet, layout), wanted, optional, layout).values
        except InputError as error:
            first = first or error
    told = first or InputError("is empty")
    raise told if told.where else InputError(told.problems, str(path)) from None


def usable_table(sheet: Sheet, layout: Layout) -> Table:
    """Return the table in a sheet.

    Raises
    ------
    InputError : it is empty, has fewer than two rows of numbers, or decimal commas between commas.
    """
    table = make_table(sheet, layout)
    if table is None:
        raise InputError("is empty")
    problems = _doubled(table)
    if len(table.rows) < 2:
        problems += [f"has {len(table.rows)} rows of numbers; at least 2 are needed"]
    if problems:
        raise InputError(problems)
    return table


def list_columns(
    table: Table, wanted: dict[str, str], optional: Collection[str], layout: Layout
) -> Columns:
    """Return the columns of a table, with its parts and the titles that were not used.

    Parameters
    ----------
    table : from `usable_table`.
    wanted, optional, layout : as in `read_columns`.

    Raises
    ------
    InputError : as in `read_columns`.
    """
    picked: dict[str, tuple[int, float, float]] = {}
    problems: list[str] = []
    for name, unit in wanted.items():
        try:
            found = _found(table, name, unit, layout, needed=name not in optional)
            if found is not None:
                picked[name] = found
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(problems)
    used = {column for column, *_ in picked.values()}
    values: dict[str, Floats] = {}
    stamped, begins = False, None
    for name, (column, scale, offset) in picked.items():
        if name == "time" and is_stamp(table.cells(column)[0]):
            values[name], begins, dates = _stamps(table, column)
            used |= dates
            stamped = True
        else:
            values[name] = table.numbers(column, scale, offset)
    unused = [
        title for n, title in enumerate(table.titles) if n not in used and any(table.cells(n)[:50])
    ]
    return Columns(values, table.parts, unused, stamped, begins=begins)


def _doubled(table: Table) -> list[str]:
    """Decimal commas between commas make two cells of each."""
    if table.sheet.separator != "," or not table.rows:
        return []
    width = len(table.titles)
    if width < 2 or not all(len(row) == 2 * width for _, row in table.rows[:50]):
        return []
    return [
        f"has {width} titles and {2 * width} numbers in a row: decimal commas between commas "
        "cannot be told apart; write it with semicolons"
    ]


def _found(
    table: Table, name: str, unit: str, layout: Layout, *, needed: bool
) -> tuple[int, float, float] | None:
    """Column number of a quantity, scale and offset to the wanted unit; None if it may be missing.

    Raises
    ------
    InputError : there is none and it is needed, none with a unit, or not with a fitting one.
    """
    if name in layout.titles:
        title = layout.titles[name]
        if title not in table.titles:
            raise InputError(f'no column "{title}"{nearest(title, table.titles)}')
        some = [table.titles.index(title)]
    else:
        names = [name_and_unit(title)[0] for title in table.titles]
        some = [n for n, one in enumerate(names) if is_called(one, name)]
        some = [n for n in some if plain_title(names[n]) == name] + [
            n for n in some if plain_title(names[n]) != name
        ]
    given = {n: layout.units.get(name) or table.unit(n) for n in some}
    stamped = [n for n in some if name == "time" and table.rows and is_stamp(table.cells(n)[0])]
    if stamped:
        return stamped[0], 1.0, 0.0
    best = next((n for n, said in given.items() if said == unit), None)
    if best is not None:
        return best, 1.0, 0.0
    for n, said in given.items():
        if said:
            return n, *_converted(table.titles[n], said, unit)
    if not needed and not (name in layout.titles or name in layout.units):
        return None
    if name in layout.titles or (some and name in layout.units):
        raise InputError(f'column "{table.titles[some[0]]}" has no unit; give units.{name}')
    wanted = name if name in layout.units else f"{name}_{unit}"
    raise InputError(f'no column "{wanted}"{nearest(wanted, table.titles)}')


def _converted(title: str, said: str, unit: str) -> tuple[float, float]:
    """Scale and offset of a column, in a unit as laboratories write it."""
    try:
        return conversion(plain_unit(said), unit)
    except InputError as error:
        raise InputError(error.lines(f'column "{title}"')) from None


def _stamps(table: Table, column: int) -> tuple[Floats, np.datetime64 | None, set[int]]:
    """Seconds of a column of stamps, their start, and the column of dates beside times of day."""
    cells, used = table.cells(column), set()
    if ":" not in cells[0]:  # a date: the time of day stands in the column beside it
        clock = next(
            (n for n in range(len(table.titles)) if n != column and ":" in table.cells(n)[0]), None
        )
        if clock is not None:
            cells = [f"{day} {time}" for day, time in zip(cells, table.cells(clock), strict=True)]
            used.add(clock)
    else:
        days = [
            n
            for n, title in enumerate(table.titles)
            if n != column
            and is_called(name_and_unit(title)[0], "time")
            and is_stamp(table.cells(n)[0])
            and ":" not in table.cells(n)[0]
        ]
        if days and " " not in cells[0]:
            cells = [f"{day} {time}" for day, time in zip(table.cells(days[0]), cells, strict=True)]
            used.add(days[0])
    try:
        return *seconds_and_start(cells), used
    except InputError as error:
        raise InputError(error.lines(f'column "{table.titles[column]}"')) from None
