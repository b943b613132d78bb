"""What a document says of a result whose analysis has no words of its own for it."""

import re
from typing import Any

import pandas as pd

from thermobearing.report.pieces import Column, Pieces, ReportTable
from thermobearing.report.saved import saved_figures
from thermobearing.results.saved import SavedResult

# Ends of names of columns and of keys of a summary, and the unit that they say.
UNITS = {
    **{unit: unit for unit in ("mm", "kN", "MPa", "s", "K", "t", "Hz", "gal", "kJ", "m")},
    **{"degC": "°C", "kN_mm": "kN mm", "kN_per_mm": "kN/mm", "mm_s": "mm/s", "m_s2": "m/s²"},
    **{"cm_s": "cm/s", "cm": "cm", "kN_m": "kN m", "kNmm": "kN mm", "percent": "%"},
    **{"m_s": "m/s", "rad": "rad"},
}
MOST_ROWS = 400  # of a table in a document; longer ones stay in their files
TOLD_APART = {"command", "warnings", "outcome", "sentence", "version", "tested_range", "rig"}


def pieces_of_saved(saved: SavedResult) -> Pieces:
    """Summary, tables and pictures of a result directory.

    Parameters
    ----------
    saved : of any command.
    """
    summary = saved.summary
    sentence = str(summary.get("sentence") or f"The analysis ended: {saved.outcome}.")
    tables = {name: table_of(name, table) for name, table in saved.tables.items()}
    facts = [(words(key)[0], value, words(key)[1]) for key, value in _plain(summary)]
    columns = [Column("What"), Column("Value"), Column("Unit")]
    inputs = {"facts": ReportTable("What the summary says", columns, facts)} if facts else {}
    return Pieces(
        command=saved.command,
        title=f"Result of {saved.command}",
        question=f"What `thermobearing {saved.command}` was asked, and found.",
        answer=[sentence],
        inputs=inputs,
        tables=tables,
        figures=saved_figures(saved, {}),
        warnings=saved.warnings,
        identity={"Program": f"thermobearing {summary.get('version', '')}".strip()},
    )


def words(name: str) -> tuple[str, str]:
    """Words and unit of a column such as "peak_force_kN".

    Examples
    --------
    >>> words("peak_force_kN")
    ('peak force', 'kN')
    """
    if re.match(r"K_.*_kN_mm$", name):  # a stiffness; elsewhere kN_mm is an energy
        return re.sub(r"[_\s]+", " ", name.removesuffix("_kN_mm")), "kN/mm"
    for end in sorted(UNITS, key=len, reverse=True):
        if name.endswith(f"_{end}"):
            return re.sub(r"[_\s]+", " ", name.removesuffix(f"_{end}")), UNITS[end]
    return re.sub(r"[_\s]+", " ", name), ""


def table_of(name: str, table: pd.DataFrame) -> ReportTable:
    """A table of a result directory; of a long one its first rows."""
    shown = table.head(MOST_ROWS).dropna(axis="columns", how="all")
    rows = [tuple(row) for row in shown.itertuples(index=False, name=None)]
    left = len(table) - len(shown)
    note = f"The first {MOST_ROWS} of {len(table)} rows; all are in {name}.csv." if left else ""
    columns = [column_of(str(title), shown[title]) for title in shown.columns]
    return ReportTable(words(name)[0].capitalize(), columns, rows, note=note)


def column_of(title: str, values: "pd.Series[Any]") -> Column:
    """A column of a table of a result directory; symbols keep their small letters."""
    head, unit = words(title)
    begins = head.split(" ")[0]
    head = f"{head[:1].upper()}{head[1:]}" if len(begins) > 1 else head
    return Column(head, unit, form_of(values))


def form_of(values: "pd.Series[Any]") -> str:
    """How numbers of a column are written: four digits that count, or as many as are whole."""
    if not pd.api.types.is_numeric_dtype(values) or pd.api.types.is_bool_dtype(values):
        return ".4g"
    largest = float(values.abs().max())
    return f".{max(4, len(f'{largest:.0f}'))}g"


def _plain(summary: dict[str, Any]) -> list[tuple[str, Any]]:
    """Single values of a summary; the rest is in tables."""
    found = []
    for key, value in summary.items():
        if isinstance(value, list) and all(isinstance(item, str | int | float) for item in value):
            value = ", ".join(map(str, value))
        if isinstance(value, str | int | float) and key not in TOLD_APART:
            found.append((key, value))
    return found
