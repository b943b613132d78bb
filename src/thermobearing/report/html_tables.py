"""Tables and text of an HTML page: escaped, with units, marks and verdicts."""

import base64
import html
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from markdown_it import MarkdownIt

from thermobearing.border.library import data_path
from thermobearing.report.pieces import (
    EXCEEDED,
    NOT_JUDGED,
    PASSED,
    Check,
    Column,
    Link,
    ReportTable,
)

# Of Markdown what a sentence needs: no HTML, and no pictures, which would come from elsewhere.
SENTENCES = MarkdownIt("zero", {"html": False}).enable(["emphasis", "backticks", "link", "escape"])
HEADINGS = MarkdownIt("zero", {"html": False}).enable(["emphasis", "backticks", "escape"])
LONGEST_WORD = 24  # letters of a word that stays on a line
PARTS = re.compile(r"\S{1,8}")  # of a longer one


def escaped(text: object) -> str:
    """Text as text, between tags and in attributes."""
    return html.escape(str(text), quote=True)


def breakable(text: str) -> str:
    """Text as text, whose long words (a digest, a path) may go on in the next line."""
    return "".join(
        "<wbr>".join(map(escaped, PARTS.findall(word)))
        if len(word) > LONGEST_WORD
        else escaped(word)
        for word in re.split(r"(\s+)", text)
    )


def sentence(text: str) -> str:
    """Markdown of a sentence as HTML."""
    return str(SENTENCES.renderInline(text))


def heading(text: str) -> str:
    """Markdown of a heading as HTML; without links, for it is one itself in the contents list."""
    return str(HEADINGS.renderInline(text))


def anchor(text: str, taken: set[str]) -> str:
    """An address within the page for a heading, made of its letters; none is given twice."""
    words = re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-") or "section"
    name, count = words, 1
    while name in taken:
        count += 1
        name = f"{words}-{count}"
    taken.add(name)
    return name


def page_file(name: str) -> str:
    """A file of the page's own."""
    return data_path("report-page", name).read_text(encoding="utf-8")


def encoded(content: bytes, kind: str) -> str:
    """A picture as an address that holds it."""
    return f"data:{kind};base64,{base64.b64encode(content).decode('ascii')}"


MARK = "\N{DAGGER}"
MARKED = "Marked:"  # a note that begins so says itself what the mark means
MARK_WORDS = "beyond what was tested"
FEWEST_TO_SORT = 3  # rows; two are seen at once
UPRIGHT = 130  # letters in a row of a table that fit on a page; more is turned, as page.css knows
SHORT = 12  # rows that stay on one page
PADDING = 3  # of a column, in letters
BRIEF = 25  # letters of a cell that stays on a line
LONGEST = 34  # letters of a cell that is not wrapped
SIGNS = {PASSED: "\N{CHECK MARK}", EXCEEDED: "\N{MULTIPLICATION X}", NOT_JUDGED: "\N{EN DASH}"}
CHECK_CAPTION = "Numbers beside their limits"
LIMIT_FORM = Column("", "", ".4g")


def table_html(table: ReportTable, number: int, places: Mapping[str, str] | None = None) -> str:
    """A table with its caption, number and note.

    Parameters
    ----------
    table : to write.
    number : of it in the document, 1 or more.
    places : anchors of figures and tables by their names, which cells lead to.

    Examples
    --------
    >>> text = table_html(ReportTable("Cycles", [Column("Force", "kN", ".1f")], [(2.0,)]), 1)
    >>> 'class="amount" data-value="2">2.0<' in text
    True
    """
    kinds = [_kind(table, place) for place in range(len(table.columns))]
    heads = [_head(c, kind, len(table.rows)) for c, kind in zip(table.columns, kinds, strict=True)]
    rows = [_row(table, at, kinds, places or {}) for at in range(len(table.rows))]
    return _framed(table.caption, number, heads, rows, _note(table), _letters(table))


def checks_html(checks: Sequence[Check], number: int) -> str:
    """The table of checks: value, limit, where the limit is from, verdict in words and a sign.

    Parameters
    ----------
    checks : at least one.
    number : of the table in the document.

    Examples
    --------
    >>> text = checks_html([Check("strain", 2.8, 2.5, "", "Table 1", EXCEEDED)], 1)
    >>> "exceeded" in text
    True
    """
    columns = [Column("Check"), Column("Value"), Column("Limit"), Column("Source of the limit")]
    kinds = ["words long", "amount", "amount", "words long"]
    heads = [_head(c, k, len(checks)) for c, k in zip(columns, kinds, strict=True)]
    heads.append(_head(Column("Verdict"), "words", len(checks)))
    rows = [f"<tr>{_check_cells(check)}</tr>" for check in checks]
    return _framed(CHECK_CAPTION, number, heads, rows, "", UPRIGHT)


def _check_cells(check: Check) -> str:
    unit = f" {check.unit}" if check.unit else ""
    value, limit = (
        LIMIT_FORM.text(number) and LIMIT_FORM.text(number) + unit
        for number in (check.value, check.limit)
    )
    sign = "\N{GREATER-THAN OR EQUAL TO}" if check.lower else "\N{LESS-THAN OR EQUAL TO}"
    limit = f"{sign} {limit}" if limit else "none"
    kind = check.verdict.replace(" ", "-")
    verdict = f"{SIGNS[check.verdict]} {check.verdict}"
    return (
        f'<th scope="row" class="words long">{breakable(check.what)}</th>'
        f"<td {_amount(check.value)}>{escaped(value)}</td>"
        f"<td {_amount(check.limit)}>{escaped(limit)}</td>"
        f'<td class="words long">{breakable(check.source)}</td>'
        f'<td class="verdict {escaped(kind)}">{escaped(verdict)}</td>'
    )


def _is_number(value: Any) -> bool:
    number = isinstance(value, int | float | np.integer | np.floating)
    return number and not isinstance(value, bool | np.bool_)


def _note(table: ReportTable) -> str:
    """What stands below a table; where cells are marked, what the mark means."""
    if not table.marked or MARKED in table.note:
        return table.note.replace(MARKED, MARK)
    return f"{MARK} {MARK_WORDS}. {table.note}".strip()


def _kind(table: ReportTable, place: int) -> str:
    """Numbers, words, or sentences, which want more room."""
    if _is_amount(table, place):
        return "amount"
    column = table.columns[place]
    longest = max((len(column.text(row[place])) for row in table.rows), default=0)
    return f"words {'long' if longest > LONGEST else 'brief' if longest < BRIEF else ''}".strip()


def _is_amount(table: ReportTable, place: int) -> bool:
    """Whether most of a column are numbers: they stand under each other at the right."""
    values = [row[place] for row in table.rows]
    told = [value for value in values if table.columns[place].text(value)]
    return 2 * sum(map(_is_number, told)) > len(told)


def _head(column: Column, kind: str, rows: int) -> str:
    unit = f' <span class="unit">[{escaped(column.unit)}]</span>' if column.unit else ""
    words = f"{escaped(column.head)}{unit}"
    if rows >= FEWEST_TO_SORT:
        words = f'<button type="button">{words}</button>'
    return f'<th scope="col" class="{kind}">{words}</th>'


def _amount(value: Any) -> str:
    """Class of a cell with a number, and what it is sorted by."""
    told = f"{value:.9g}" if np.isfinite(value) else ""
    return f'class="amount" data-value="{told}"'


def _row(table: ReportTable, at: int, kinds: Sequence[str], places: Mapping[str, str]) -> str:
    cells = []
    for place, (column, kind) in enumerate(zip(table.columns, kinds, strict=True)):
        value = table.rows[at][place]
        text = breakable(column.text(value))
        if isinstance(value, Link) and value.to in places:
            text = f'<a href="#{escaped(places[value.to])}">{text}</a>'
        look = _amount(value) if _is_number(value) else f'class="{kind}"'
        if (at, place) in table.marked:
            look = look.replace('class="', 'class="marked ')
            text = f'{MARK}<span class="unseen"> {MARK_WORDS}:</span> {text}'
        tag, scope = ("th", ' scope="row"') if place < table.keys else ("td", "")
        cells.append(f"<{tag}{scope} {look}>{text}</{tag}>")
    return f"<tr>{''.join(cells)}</tr>"


def _letters(table: ReportTable) -> int:
    """Width of a table, in letters: how large they are on paper follows from it."""
    wide = 0
    for place, column in enumerate(table.columns):
        cells = [min(len(column.text(row[place])), LONGEST) for row in table.rows]
        words = [len(word) for word in column.title.split()]
        wide += max([*cells, *words], default=0) + PADDING
    return wide


def _framed(
    caption: str, number: int, heads: list[str], rows: list[str], note: str, letters: int
) -> str:
    """A table within what scrolls, which a keyboard reaches."""
    name = f"table-{number}"
    looks = [*["broad"] * (letters > UPRIGHT), *["short"] * (len(rows) < SHORT)]
    below = f'\n<p class="note">{escaped(note)}</p>' if note else ""
    told = "\n".join(rows)
    return (
        f'<figure class="{" ".join(["table", *looks])}" id="{name}" style="--letters: {letters}">\n'
        f'<figcaption id="{name}-caption"><span class="number">Table {number}.</span> '
        f"{escaped(caption)}</figcaption>\n"
        f'<div class="scroll" role="region" tabindex="0" aria-labelledby="{name}-caption">'
        f'<table aria-labelledby="{name}-caption">\n'
        f"<thead><tr>{''.join(heads)}</tr></thead>\n<tbody>\n{told}\n</tbody>\n</table></div>"
        f"{below}\n</figure>\n"
    )
