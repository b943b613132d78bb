"""The tables of the source, each printed number beside ours.

`data/printed/tables.toml` has what is printed. Ours is a key of a data file, or is computed
(`table_values`), or there is a reason why not. A row that breaks says so in its last column.
"""

from collections.abc import Callable, Mapping
from functools import cache
from typing import Annotated, Any

import numpy as np
import pandas as pd
from pydantic import Field

from thermobearing.bearing.bilinear import load_bilinear
from thermobearing.border.library import data_path
from thermobearing.border.schema import Strict, validated
from thermobearing.border.toml import read_toml
from thermobearing.cyclic.case import load_rig
from thermobearing.design.rubber import load_rubber
from thermobearing.reproduce import table_values
from thermobearing.reproduce.claims import reason
from thermobearing.reproduce.runs import Runs

DATA, COMPUTED = "data file", "computed"
DIGITS = 6  # of a difference in per cent: below it is rounding
COLUMNS = ("what", "of", "unit", "printed", "here", "difference_per_cent", "by", "note")
Words = Annotated[str, Field(min_length=1, max_length=400)]


class PrintedRow(Strict):
    """A row of a table, and where ours comes from.

    Attributes
    ----------
    what, unit : symbol and words; "" for pure numbers.
    printed : a value for each column of the table; "" where nothing is printed.
    data, factor : key in the files of the table, and what makes the unit of the print of it.
    computed : a function of `table_values`.
    why : there is neither.
    note : how it prints, and what ours is.
    """

    what: Words
    unit: str = ""
    printed: tuple[float | str, ...]
    data: str = ""
    factor: float = 1.0
    computed: str = ""
    why: str = ""
    note: str = ""

    @classmethod
    def conflicts(cls, given: dict[str, Any]) -> list[str]:
        """One of three."""
        told = [name for name in ("data", "computed", "why") if name in given]
        return [] if len(told) == 1 else ["give exactly one of data, computed, why"]


class PrintedTable(Strict):
    """A table of the source; `of` has a file for each column, "bearing NAME", with a key or not."""

    number: Words
    title: Words
    columns: Annotated[tuple[Words, ...], Field(min_length=1)]
    of: tuple[Words, ...] = ()
    note: str = ""
    row: Annotated[tuple[PrintedRow, ...], Field(min_length=1)]

    @property
    def name(self) -> str:
        """Of its file: "table_3_1", "table_a_1"."""
        return f"table_{self.number.lower().replace('.', '_')}"


class _Printed(Strict):
    """The file of them."""

    citation: str
    table: tuple[PrintedTable, ...]


@cache
def printed_tables() -> tuple[PrintedTable, ...]:
    """All tables of the source, in its order.

    Examples
    --------
    >>> printed_tables()[0].title
    'Dimensions of HDR and LHDR bearing specimens'
    """
    path = data_path("printed", "tables.toml")
    return validated(_Printed, read_toml(path), str(path)).table


def all_tables(runs: Runs) -> dict[str, pd.DataFrame]:
    """Every table by name, with the columns `COLUMNS`, one row a printed number."""
    return {table.name: table_beside(table, runs) for table in printed_tables()}


def table_beside(table: PrintedTable, runs: Runs) -> pd.DataFrame:
    """One table: each printed number beside ours."""
    rows = [cell for row in table.row for cell in _cells(table, row, runs)]
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _cells(table: PrintedTable, row: PrintedRow, runs: Runs) -> list[tuple[Any, ...]]:
    """The printed numbers of a row, each with ours."""
    told = dict(zip(table.columns, row.printed, strict=True))
    ours: Mapping[str, Any] = {}
    by = row.why
    if not by:
        by = DATA if row.data else COMPUTED
        try:
            ours = dict(zip(table.columns, _ours(table, row, runs), strict=True))
        except Exception as error:  # whatever breaks is told in its row
            by = reason(error)
    cells = []
    for column, printed in told.items():
        here = ours.get(column)
        if printed == "" and here is None:
            continue
        cells.append(
            (row.what, column, row.unit, printed, here, _difference(printed, here), by, row.note)
        )
    return cells


def _ours(table: PrintedTable, row: PrintedRow, runs: Runs) -> list[Any]:
    """Our numbers, a column each; None where there is none."""
    if row.computed:
        make: Callable[[Runs], Any] = getattr(table_values, row.computed)
        return list(make(runs))
    return [_looked_up(of, row, runs) for of in table.of]


def _looked_up(of: str, row: PrintedRow, runs: Runs) -> Any:
    """A number of a data file; None where the file has no such part."""
    kind, _, rest = of.partition(" ")
    name, _, above = rest.partition(" ")
    loaders: dict[str, Callable[[], Any]] = {
        "bearing": lambda: runs.bearing(name),
        "structure": lambda: runs.structure(name),
        "bilinear": lambda: load_bilinear(name),
        "rig": lambda: load_rig(name),
        "rubber": lambda: load_rubber(above, "HDR-S" if name == "HDR-S" else "HDR"),
    }
    value: Any = loaders[kind]().model_dump()
    keys = row.data.split(".")
    for key in keys if kind == "rubber" or not above else [*above.split("."), *keys]:
        if isinstance(value, list | tuple):
            value = value[int(key)] if int(key) < len(value) else None
        else:
            value = value[key]
        if value is None:
            return None
    return row.factor * value if row.factor != 1.0 else value


def _difference(printed: Any, here: Any) -> float:
    """Of ours from the printed number [%]; NaN where there are not two numbers."""
    numbers = all(isinstance(value, int | float) for value in (printed, here))
    if not numbers or (printed == 0.0 and here != 0.0):
        return np.nan
    return 0.0 if printed == here else round(100.0 * (here / printed - 1.0), DIGITS)
