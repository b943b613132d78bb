"""Tables for readers: one description for the console, reports and workbooks.

A `Table` is made once of a DataFrame by the register. `results.screen.show_table` prints it, and
the report engine writes it into HTML, PDF and workbooks. CSV files hold the DataFrame itself.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from thermobearing.border.lazy import pd
from thermobearing.quantities.register import Quantity, quantity, registered_quantities


@dataclass(frozen=True)
class Table:
    """A table that an engineer can quote."""

    caption: str  # what it holds, without a full stop
    columns: Sequence[Quantity]  # heads, units and formats
    rows: Sequence[Sequence[Any]]  # in the units of the columns; numbers stay numbers
    keys: int = 1  # leading columns that say what a row is
    marked: frozenset[tuple[int, int]] = frozenset()  # (row, column) outside the calibration range
    note: str = ""  # below the table: what marks and symbols mean
    failed: frozenset[int] = frozenset()  # rows of runs that did not complete
    governing: str = ""  # name of the column whose largest values open a long table in a page

    def __len__(self) -> int:
        return len(self.rows)

    def texts(self) -> list[list[str]]:
        """Return the cells as readers see them, without marks."""
        return [
            [column.text(value) for column, value in zip(self.columns, row, strict=True)]
            for row in self.rows
        ]

    def merged(self, joined: str) -> "Table":
        """Return the table with one row for rows that read the same but for the column `joined`.

        That row lists their entries of that column.
        """
        texts, names = self.texts(), [column.name for column in self.columns]
        if joined not in names:
            return self
        joined_place, groups = names.index(joined), dict[tuple[Any, ...], list[int]]()
        for row, cells in enumerate(texts):
            # A marked cell and one without a mark read alike, but are not the same.
            marks = [(row, k) in self.marked for k in range(len(names))]
            key = (*cells[:joined_place], *cells[joined_place + 1 :], *marks)
            groups.setdefault(key, []).append(row)
        rows, first_rows = [], [group[0] for group in groups.values()]
        for group in groups.values():
            rows.append(list(self.rows[group[0]]))
            if len(group) > 1:
                rows[-1][joined_place] = ", ".join(texts[row][joined_place] for row in group)
        marked = {(first_rows.index(row), k) for row, k in self.marked if row in first_rows}
        failed = {first_rows.index(row) for row in self.failed if row in first_rows}
        return replace(self, rows=rows, marked=frozenset(marked), failed=frozenset(failed))

    def numeric(self) -> set[int]:
        """Return the columns that mostly contain numbers, which are aligned at the right."""
        numeric_columns = set()
        for place, column in enumerate(self.columns):
            values = [row[place] for row in self.rows if column.text(row[place])]
            if 2 * sum(map(is_number, values)) > len(values):
                numeric_columns.add(place)
        return numeric_columns


def is_number(value: Any) -> bool:
    """Return whether a value is a number; booleans do not count."""
    number = isinstance(value, int | float | np.integer | np.floating)
    return number and not isinstance(value, bool | np.bool_)


def make_table(
    frame: "pd.DataFrame",
    names: Iterable[str | Quantity] | None = None,
    caption: str = "",
    *,
    keys: int = 1,
    heads: Mapping[str, str] | None = None,
    marked: Mapping[str, Sequence[bool]] | None = None,
    note: str = "",
    drop_empty: bool = True,
    keep_keys: bool = False,
    governing: str = "",
) -> Table:
    """Return a table of some columns of a DataFrame, in the words and units of the register.

    `names` are the columns in order (all by default); those that the frame does not have are left
    out, and those without any value where `drop_empty`. A `Quantity` whose `name` is a column
    overrides the register, `heads` its head, by column. Of the leading columns, `keys` identify a
    row; a key that is the same in all rows is stated in the caption, unless `keep_keys`. `marked`
    has for columns whether each row is outside the calibration range. Raises KeyError for a column
    of numbers that the register does not have.

    >>> import pandas as pd
    >>> frame = pd.DataFrame({"motion": ["a"], "bearing_energy_kN_mm": [5230.0], "note": [""]})
    >>> table = make_table(frame, caption="Runs")
    >>> [column.title for column in table.columns], table.texts()
    (['Motion', 'Energy of one [kJ]'], [['a', '5.2']])
    """
    selected = list(frame.columns) if names is None else list(names)
    columns: list[Quantity] = []
    for item in selected:
        name = item.name if isinstance(item, Quantity) else str(item)
        if name in frame and not (drop_empty and _is_empty(frame[name])):
            described = item if isinstance(item, Quantity) else _find(frame[name])
            head = (heads or {}).get(name)
            columns.append(replace(described, head=head) if head else described)
    marked_columns = {name: flags for name, flags in (marked or {}).items() if any(flags)}
    fixed = [] if keep_keys else _fixed_keys(frame, columns[:keys], marked_columns)
    if fixed:
        caption = _with_fixed_keys(caption, frame, fixed)
        columns, keys = [c for c in columns if c not in fixed], keys - len(fixed)
    stored = [frame[column.name].tolist() for column in columns]
    displayed = [[c.shown(v) for v in values] for c, values in zip(columns, stored, strict=True)]
    places = [column.name for column in columns]
    marks = {
        (row, places.index(name))
        for name, flags in marked_columns.items()
        if name in places
        for row, flag in enumerate(flags)
        if flag
    }
    failed: frozenset[int] = frozenset()
    if "outcome" in frame:
        outcomes = frame["outcome"].tolist()
        failed = frozenset(k for k, outcome in enumerate(outcomes) if outcome != "completed")
    rows = [list(row) for row in zip(*displayed, strict=True)]
    return Table(caption, columns, rows, keys, frozenset(marks), note, failed, governing)


def _fixed_keys(
    frame: "pd.DataFrame", keys: Sequence[Quantity], marked: Mapping[str, Sequence[bool]]
) -> list[Quantity]:
    """Return the keys with one value in all rows; one key stays, and so do marked columns."""
    fixed = [key for key in keys if key.name not in marked and frame[key.name].nunique() == 1]
    fixed = [key for key in fixed if frame[key.name].notna().all()]
    return fixed[1:] if len(fixed) == len(keys) else fixed


def _with_fixed_keys(caption: str, frame: "pd.DataFrame", keys: Sequence[Quantity]) -> str:
    """Return a caption with the values of keys that have no column."""
    facts = []
    for key in keys:
        value = key.text(key.shown(frame[key.name].iloc[0]))
        head = key.head if "_" in key.head[:2] else f"{key.head[:1].lower()}{key.head[1:]}"
        facts.append(f"{head}: {value} {key.unit}".rstrip())
    text = "; ".join(facts)
    return f"{caption} ({text})" if caption else f"{text[:1].upper()}{text[1:]}"


def _is_empty(column: "pd.Series[Any]") -> bool:
    return bool((column.isna() | (column.astype(object) == "")).all())


def _find(column: "pd.Series[Any]") -> Quantity:
    """Return the row of the register, or a column of words under its own name."""
    name = str(column.name)
    if name in registered_quantities() or column.dtype.kind in "iufc":
        return quantity(name)
    return Quantity(name.replace("_", " ").capitalize(), name=name)
