"""Sentences, lists of facts and tables on the console.

A table that is too wide for the terminal gets heads of several lines; if it is still too wide, it
continues below, with its first columns repeated. Output that does not go to a terminal has no width
limit (unless COLUMNS is set), colours or frames.
"""

import os
import textwrap
from collections.abc import Iterable, Sequence
from html import escape
from typing import Any

from rich.console import Console
from rich.text import Text

from thermobearing.quantities.tables import Table

GAP = "  "  # between two columns
MOST_ROWS = 60  # of a table in a notebook
Row = Sequence[str]


def say(text: str, style: str = "") -> None:
    """Print a paragraph, without markup: wrapped on a terminal, one line elsewhere."""
    console = Console(highlight=False)
    console.print(Text(text, style=style), soft_wrap=not console.is_terminal)


def print_warnings(warnings: Iterable[str]) -> None:
    """Print a paragraph for each warning."""
    for warning in warnings:
        say(f"warning: {warning}", "yellow")


def show_table(table: Table) -> None:
    """Print a table with caption, note and marks.

    Numbers are not truncated: a table that is too wide is printed in blocks, each with the keys.
    """
    cells = table.texts()
    for row, column in table.marked:
        cells[row][column] += "!"
    heads = [column.title for column in table.columns]
    styles = ["red" if k in table.failed else "" for k in range(len(cells))]
    if table.caption:
        say(f"\n{table.caption}")
    for number, block in enumerate(_laid_out(heads, cells, table.keys, _screen_width())):
        if number:
            say("")
        looks = ["bold"] * (len(block) - len(cells)) + styles
        for text, style in zip(block, looks, strict=True):
            console = Console(highlight=False)
            console.print(Text(text, style=style, no_wrap=True), soft_wrap=True)
    if table.note:
        say(table.note)


def _screen_width() -> int | None:
    """Return the width of the terminal; None without a terminal and without COLUMNS."""
    console = Console()
    if console.is_terminal:
        return console.width
    columns = os.environ.get("COLUMNS", "")
    return int(columns) if columns.isdecimal() and int(columns) > 0 else None


def _laid_out(heads: Row, rows: Sequence[Row], keys: int, width: int | None) -> list[list[str]]:
    """Return the lines of each block of a table, no longer than `width` if possible."""
    cells = [[row[k] for row in rows] for k in range(len(heads))]
    columns = [[head, *column] for head, column in zip(heads, cells, strict=True)]
    wide = [max(map(len, column)) for column in columns]
    if width is not None and sum(wide) + len(GAP) * (len(wide) - 1) > width:
        least = [max(map(len, [*head.split(), *c])) for head, c in zip(heads, cells, strict=True)]
        lines = [textwrap.wrap(head, room) for head, room in zip(heads, least, strict=True)]
        most = max(map(len, lines))
        columns = [
            [""] * (most - len(above)) + above + column
            for above, column in zip(lines, cells, strict=True)
        ]
        wide = least
    blocks: list[list[int]] = [[]]
    taken = start = sum(w + len(GAP) for w in wide[:keys]) - len(GAP)
    for k in range(keys, len(heads)):
        if width is not None and blocks[-1] and taken + len(GAP) + wide[k] > width:
            blocks.append([])
            taken = start
        blocks[-1].append(k)
        taken += len(GAP) + wide[k]
    found = []
    for block in blocks:
        aligned = [
            [text.ljust(wide[k]) if k < keys else text.rjust(wide[k]) for text in columns[k]]
            for k in (*range(keys), *block)
        ]
        texts = [GAP.join(line).rstrip() for line in zip(*aligned, strict=True)]
        found.append(texts[next(k for k, text in enumerate(texts) if text) :])
    return found


def print_facts(title: str, facts: dict[str, str]) -> None:
    """Print a titled list of names and values, each of one or more lines."""
    say(title, "bold")
    width = max(len(name) for name in facts)
    for name, value in facts.items():
        for row, line in enumerate(value.split("\n")):
            say(f"  {'' if row else name:{width}}  {line}")


def table_html(title: str, table: Any, notes: Iterable[str] = ()) -> str:
    """Return a titled DataFrame for a notebook, with sentences below it."""
    drawn = table.to_html(index=False, max_rows=MOST_ROWS, border=0, float_format="%.4g")
    below = "".join(f"<p>{escape(note)}</p>" for note in notes)
    return f"<b>{escape(title)}</b>{drawn}{below}"
