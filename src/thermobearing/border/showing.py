"""How things look in a notebook: a title, a list of facts, a table."""

from collections.abc import Mapping
from html import escape
from typing import Any

MOST_ROWS = 60  # of a table in a notebook


class Shown:
    """Short words for a result, and in a notebook its table and warnings.

    What inherits from it has `outcome`, `table` (a DataFrame) and `warnings` (sentences).
    """

    @property
    def headline(self: Any) -> str:
        """What it is and how it ended, in a line."""
        return f"{type(self).__name__}: {getattr(self, 'outcome', 'completed')}"

    def __repr__(self: Any) -> str:
        return f"<{self.headline}>"

    def _repr_html_(self: Any) -> str:
        return table_html(self.headline, self.table, self.warnings)


def facts_html(title: str, facts: Mapping[str, str]) -> str:
    """A titled list of names and values.

    Parameters
    ----------
    title : what it is.
    facts : values by name, as text; empty ones are left out.

    Examples
    --------
    >>> facts_html("mine", {"K_r": "30 kN/mm"})
    '<b>mine</b><table><tr><th style="text-align:left">K_r</th><td>30 kN/mm</td></tr></table>'
    """
    cell = '<tr><th style="text-align:left">{}</th><td>{}</td></tr>'
    rows = "".join(cell.format(escape(k), escape(v)) for k, v in facts.items() if v)
    return f"<b>{escape(title)}</b><table>{rows}</table>"


def table_html(title: str, table: Any, notes: list[str] | None = None) -> str:
    """A titled table, and sentences below it.

    Parameters
    ----------
    title : what it is.
    table : a pandas DataFrame.
    notes : sentences that a reader must know.

    Examples
    --------
    >>> import pandas as pd
    >>> "<td>1</td>" in table_html("mine", pd.DataFrame({"a": [1]}))
    True
    """
    drawn = table.to_html(index=False, max_rows=MOST_ROWS, border=0, float_format="%.4g")
    said = "".join(f"<p>{escape(note)}</p>" for note in notes or [])
    return f"<b>{escape(title)}</b>{drawn}{said}"
