"""The tables of Shen (2023): each printed number compared with ours.

`data/tables.toml` has what is printed. Ours is a key of a data file, or is computed by an
expression, or there is a reason why not. A row that breaks says so in its last column.
"""

from collections.abc import Callable, Mapping
from functools import cache
from typing import Annotated, Any

import numpy as np
import pandas as pd
from pydantic import Field

from reproduction.claims import failure
from reproduction.measures import evaluate, words
from reproduction.runs import Runs, load_data
from thermobearing.bearing.bilinear import load_bilinear
from thermobearing.border.schema import Strict
from thermobearing.cyclic.case import load_rig
from thermobearing.design.sizing import load_rubber

DATA, COMPUTED = "data file", "computed"
DIGITS = 6  # of a difference in per cent: below it is rounding
COLUMNS = ("what", "of", "unit", "printed", "here", "difference_per_cent", "by", "note")
Words = Annotated[str, Field(min_length=1, max_length=600)]


class PrintedRow(Strict):
    """A row of a table, and where ours comes from.

    `printed` has a value for each column of the table, "" where nothing is printed; `data` is a key
    in the files of the table, `factor` converts it to the printed unit; `computed` is an
    expression; `why` says that there is neither; `note` how it prints, and what ours is.
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
    def _conflicts(cls, given: dict[str, Any]) -> list[str]:
        count = sum(name in given for name in ("data", "computed", "why"))
        return [] if count == 1 else ["give exactly one of data, computed, why"]


class PrintedTable(Strict):
    """A table; `of` has a file for each column, "bearing NAME", with a key or not."""

    number: Words
    title: Words
    columns: Annotated[tuple[Words, ...], Field(min_length=1)]
    of: tuple[Words, ...] = ()
    note: str = ""
    row: Annotated[tuple[PrintedRow, ...], Field(min_length=1)]

    @property
    def name(self) -> str:
        """The name of its file: "table_3_1", "table_a_1"."""
        return f"table_{self.number.lower().replace('.', '_')}"


class _Printed(Strict):
    citation: str
    table: tuple[PrintedTable, ...]


@cache
def printed_tables() -> tuple[PrintedTable, ...]:
    """Return all tables of Shen (2023) in order."""
    return load_data(_Printed, "tables.toml").table


def all_tables(runs: Runs) -> dict[str, pd.DataFrame]:
    """Return every table by name, with the columns `COLUMNS`, one row for each printed number."""
    return {table.name: compare_table(table, runs) for table in printed_tables()}


def compare_table(table: PrintedTable, runs: Runs) -> pd.DataFrame:
    """Return one table with each printed number and ours."""
    rows = [cell for row in table.row for cell in _cells(table, row, runs)]
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _cells(table: PrintedTable, row: PrintedRow, runs: Runs) -> list[tuple[Any, ...]]:
    ours: Mapping[str, Any] = {}
    by = row.why or (DATA if row.data else COMPUTED)
    if not row.why:
        try:
            ours = dict(zip(table.columns, _ours(table, row, runs), strict=True))
        except Exception as error:  # whatever breaks is the reason of its row
            by = failure(error)
    cells = []
    for column, printed in zip(table.columns, row.printed, strict=True):
        computed = ours.get(column)
        if printed != "" or computed is not None:
            difference = _difference(printed, computed)
            cells.append((row.what, column, row.unit, printed, computed, difference, by, row.note))
    return cells


def _ours(table: PrintedTable, row: PrintedRow, runs: Runs) -> list[Any]:
    """Return our numbers, one for each column; None where there is none."""
    if row.computed:
        return list(evaluate(row.computed, words(runs)))
    return [_look_up(of, row, runs) for of in table.of]


def _look_up(of: str, row: PrintedRow, runs: Runs) -> Any:
    """Return a number of a data file; None where the file has no such part."""
    kind, _, name_and_key = of.partition(" ")
    name, _, above = name_and_key.partition(" ")
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
    """Return how far ours is from the printed number [%]; NaN where there are not two numbers."""
    numbers = all(isinstance(value, int | float) for value in (printed, here))
    if not numbers or (printed == 0.0 and here != 0.0):
        return np.nan
    return 0.0 if printed == here else round(100.0 * (here / printed - 1.0), DIGITS)
