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
from thermobearing.quantities.warned import BEYOND_LAW, BEYOND_TESTS, NO_RANGE, Warned, as_warned

GAP = "  "  # between two columns
MOST_ROWS = 60  # of a table in a notebook
MOST_WARNINGS = 3  # of a result on the screen, and of quantities outside one calibration range
LONGEST_CELL = 120  # characters; a column with longer ones is printed below its table
MORE = "and "  # begins the line that counts the others
Row = Sequence[str]


def say(text: str, style: str = "") -> None:
    """Print a paragraph, without markup: wrapped on a terminal, one line elsewhere."""
    console = Console(highlight=False)
    console.print(Text(text, style=style), soft_wrap=not console.is_terminal)


LISTED = "summary.json and the report list all"  # warnings of a saved result


def shown_warnings(
    warnings: Iterable[str], most: int = MOST_WARNINGS, listed: str = LISTED
) -> list[str]:
    """Return the warnings of a result for the screen: one a cause, the largest effect first.

    What is outside the calibration range of one bearing is one cause. Beyond `most`, the last line
    says how many more there are; the files and the report of a result have all of them.

    >>> strain = Warned("strain 3, above the 2 tested (a)", "beyond_tests.strain", 2.0, "b")
    >>> shown_warnings(["y", strain, "z", Warned("x", "x", 1.0), "z"], 2)[:2]
    ['b: strain 3, above the 2 tested (a)', 'x']
    """
    causes: list[Warned] = []
    of_ranges: dict[str, list[Warned]] = {}
    for warning in map(as_warned, dict.fromkeys(warnings)):
        if warning.code.partition(".")[0] in (BEYOND_TESTS, BEYOND_LAW, NO_RANGE):
            of_ranges.setdefault(warning.place, []).append(warning)
        else:
            causes.append(warning)
    joined = [
        Warned(
            "; ".join(warning.sentence for warning in group[:most]),
            BEYOND_TESTS,
            max(warning.effect for warning in group),
            place,
        )
        for place, group in of_ranges.items()
    ]
    causes = sorted([*joined, *causes], key=lambda warning: -warning.effect)
    left = sum(max(0, len(group) - most) for group in of_ranges.values())
    left += max(0, len(causes) - most)
    if not left:
        return [*causes]
    more = f"{MORE}{left} more warning{'s' if left > 1 else ''}"
    return [*causes[:most], f"{more}: {listed}"]


def print_warnings(
    warnings: Iterable[str], *, all_of_them: bool = False, listed: str = LISTED
) -> None:
    """Print a paragraph for each warning that `shown_warnings` selects, or for each."""
    texts = list(warnings)
    for text in texts if all_of_them else shown_warnings(texts, listed=listed):
        say(text if text.startswith(MORE) else f"warning: {text}", "yellow")


def show_table(table: Table) -> None:
    """Print a table with caption, note and marks.

    Numbers are not truncated: a table that is too wide is printed in blocks, each with the keys.
    Sentences follow the table, each with the first cell of its row.
    """
    cells = table.texts()
    for row, column in table.marked:
        cells[row][column] += "!"
    heads = [column.title for column in table.columns]
    styles = ["red" if k in table.failed else "" for k in range(len(cells))]
    if table.caption:
        say(f"\n{table.caption}")
    long = {k for row in cells for k in range(1, len(row)) if len(row[k]) > LONGEST_CELL}
    sentences = [f"{row[0]}: {row[k]}" for row in cells for k in sorted(long) if row[k]]
    heads, *cells = ([c for k, c in enumerate(row) if k not in long] for row in (heads, *cells))
    for number, block in enumerate(_laid_out(heads, cells, table.keys, screen_width())):
        if number:
            say("")
        looks = ["bold"] * (len(block) - len(cells)) + styles
        for text, style in zip(block, looks, strict=True):
            console = Console(highlight=False)
            console.print(Text(text, style=style, no_wrap=True), soft_wrap=True)
    for text in [*sentences, *filter(None, [table.note])]:
        say(text)


def screen_width() -> int | None:
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
    widths = [max(map(len, column)) for column in columns]
    if width is not None and sum(widths) + len(GAP) * (len(widths) - 1) > width:
        # Heads broken between words: a column is then as wide as its longest word or cell.
        least_widths = [
            max(map(len, [*head.split(), *c])) for head, c in zip(heads, cells, strict=True)
        ]
        lines = [
            textwrap.wrap(head, width_of_head)
            for head, width_of_head in zip(heads, least_widths, strict=True)
        ]
        height = max(map(len, lines))
        columns = [
            [""] * (height - len(head_lines)) + head_lines + column
            for head_lines, column in zip(lines, cells, strict=True)
        ]
        widths = least_widths
    blocks: list[list[int]] = [[]]
    used_width = start = sum(w + len(GAP) for w in widths[:keys]) - len(GAP)
    for k in range(keys, len(heads)):
        if width is not None and blocks[-1] and used_width + len(GAP) + widths[k] > width:
            blocks.append([])
            used_width = start
        blocks[-1].append(k)
        used_width += len(GAP) + widths[k]
    block_lines = []
    for block in blocks:
        aligned = [
            [text.ljust(widths[k]) if k < keys else text.rjust(widths[k]) for text in columns[k]]
            for k in (*range(keys), *block)
        ]
        texts = [GAP.join(line).rstrip() for line in zip(*aligned, strict=True)]
        block_lines.append(texts[next(k for k, text in enumerate(texts) if text) :])
    return block_lines


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
    below = "".join(f"<p>{escape(note)}</p>" for note in shown_warnings(notes))
    return f"<b>{escape(title)}</b>{drawn}{below}"
