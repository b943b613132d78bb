"""What went in, as tables: each value of a resolved input with unit and source."""

import re
from collections.abc import Collection, Mapping, Sequence
from typing import Any

from thermobearing.border.toml import flat
from thermobearing.report.names import name_of
from thermobearing.report.pieces import Column, ReportTable
from thermobearing.report.words import printed_unit

QUANTITY = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(?:\s+(.+))?")
COLUMNS = (Column("What"), Column("Value", form=".6g"), Column("Unit"), Column("Source"))
RANGES = ("tested_range.",)  # keys whose two values are ends


def input_table(
    caption: str,
    table: Mapping[str, Any],
    sources: Mapping[str, str] | None = None,
    *,
    without: Collection[str] = (),
    otherwise: str = "",
    note: str = "",
) -> ReportTable:
    """A row for each value of a table of a resolved input.

    Parameters
    ----------
    caption : what they are.
    table : as it is read from TOML: numbers with a unit are text.
    sources : of values, by dotted key.
    without : keys that are left out, with everything below them.
    otherwise : source of the values that have none of their own.
    note : below the table.

    Examples
    --------
    >>> table = {"geometry": {"rubber_layers": 6, "rubber_thickness": "5.0 mm"}}
    >>> input_table("Bearing", table, {"geometry.rubber_layers": "Table 3.1"}).rows[0]
    ('Number of rubber layers', 6, '', 'Table 3.1')
    """
    told = sources or {}
    rows = [
        (name_of(key), *value_and_unit(value, ends=key.startswith(RANGES)), _source(key, told))
        for key, value in flat(table).items()
        if not any(key == one or key.startswith((f"{one}.", f"{one}[")) for one in without)
    ]
    rows = [(what, value, unit, source or otherwise) for what, value, unit, source in rows]
    return ReportTable(caption, COLUMNS, rows, note=note)


def _source(key: str, sources: Mapping[str, str]) -> str:
    """Of a value, or of the list that it stands in."""
    return sources.get(key) or sources.get(key.split("[")[0], "")


def value_and_unit(value: Any, *, ends: bool = False) -> tuple[Any, str]:
    """A value of TOML as a number or text, and its unit as one prints it.

    Parameters
    ----------
    value : such as "0.4 kN s^2/mm".
    ends : two values are the ends of a range.

    Examples
    --------
    >>> value_and_unit("0.4 kN s^2/mm"), value_and_unit(["-20 degC", "23 degC"], ends=True)
    ((400.0, 't'), ('−20 to 23', '°C'))
    """
    if isinstance(value, list | tuple):
        return _several(value, ends)
    if not isinstance(value, str):
        return value, ""
    found = QUANTITY.fullmatch(value.strip())
    if found is None or found[2] is None:
        return value, ""
    unit, factor = printed_unit(found[2])
    return factor * float(found[1]), unit


def _several(values: Sequence[Any], ends: bool) -> tuple[Any, str]:
    """Values of a list in one cell, where they have one unit."""
    pairs = [value_and_unit(value) for value in values]
    units = {unit for _, unit in pairs}
    if len(units) > 1:
        return ", ".join(f"{Column('').text(v)} {u}".strip() for v, u in pairs), ""
    cell = Column("", form=".6g")
    between = " to " if ends and len(pairs) == 2 else ", "
    if between == " to " and pairs[0] == pairs[1]:
        return pairs[0]
    return between.join(cell.text(value) for value, _ in pairs), "".join(units)
