"""A document as one HTML file: opens from a disk, asks no network, prints, light and dark."""

import base64
import re
from collections.abc import Mapping, Sequence
from functools import cache
from itertools import count
from typing import Any, NamedTuple
from urllib.parse import quote

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined, Template
from markupsafe import Markup

from thermobearing.border.library import data_path
from thermobearing.quantities.tables import Table, is_number
from thermobearing.quantities.validity import FAILED, NOT_MODELLED, NOTE
from thermobearing.report.figures import page_picture, picture_size, plot_json, points_each
from thermobearing.report.markdown import sentence_reader
from thermobearing.report.pieces import (
    BRIEF,
    LONGEST_WORD,
    MARK,
    MARK_WORDS,
    VERDICTS,
    Block,
    Bullets,
    Document,
    FigureBlock,
    Heading,
    Link,
    Live,
    Paragraph,
    ReportFigure,
    Signatures,
    TableBlock,
    column_letters,
    marked_note,
    policy_digest,
)

SEE_NOTE = "marked, see the note of the table"
MARKED_VERDICTS = {FAILED: "limit exceeded", NOT_MODELLED: "not assessed"}  # of checks of bearings
FEWEST_TO_SORT = 3  # rows; two are seen at once
MOST_ROWS = 200  # of a table that are open; the rest is folded
UPRIGHT = 130  # letters in a row of a table that fit on a page; more is turned, as page.css knows
SHORT = 12  # rows that stay on one page
PADDING = 4  # of a column on a screen, in letters; one less on paper
LONG = 34  # letters of a cell that is wrapped
PIXEL = 25.4 / 96.0  # of a page [mm]


def html_page(document: Document) -> str:
    """Return a document as one HTML file that needs nothing else.

    The same document gives the same text.
    """
    plots = any(isinstance(b, FigureBlock) and b.figure.plot for b in document.blocks)
    scripts = [_page_file(name) for name in ("page.js", "plots.js")[: 1 + plots]]
    live = [block.script for block in document.blocks if isinstance(block, Live)]
    # The engine of a live section is WebAssembly, which the policy must allow by its own word.
    allowed = [*map(policy_digest, [*scripts, *live]), *["'wasm-unsafe-eval'"] * bool(live)]
    page: str = _page_template().render(
        document=document,
        # Only these scripts run: the policy of the page holds their digests.
        allowed=Markup(" ".join(allowed)),
        css=Markup(_page_file("page.css")),
        scripts=list(map(Markup, scripts)),
        logo=_image_address(document.logo) if document.logo else "",
        sections=_sections(document.blocks),
        box_names={"answer": "Main results", "warning": "\N{WARNING SIGN} Warning"},
        mark=MARK,
    )
    return page


@cache
def _page_template() -> Template:
    environment = Environment(
        loader=FileSystemLoader(data_path("report-page")),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"sentence": _sentence, "breakable": _breakable}
    return environment.get_template("page.html")


def _page_file(name: str) -> str:
    return data_path("report-page", name).read_text(encoding="utf-8")


def _sentence(text: str) -> Markup:
    """Return the Markdown of a sentence as HTML."""
    return Markup(sentence_reader().renderInline(text))


def _breakable(text: str) -> Markup:
    """Return text whose long words (a digest, a path) may go on in the next line."""
    words = re.split(r"(\s+)", text)
    return Markup("").join(
        Markup("<wbr>").join(re.findall(r"\S{1,8}", word)) if len(word) > LONGEST_WORD else word
        for word in words
    )


def _image_address(image: bytes) -> str:
    """Return an image as an address that holds it: scripts in separate images do not run."""
    for start, kind in ((b"\x89PNG", "png"), (b"\xff\xd8", "jpeg")):
        if image.startswith(start):
            return f"data:image/{kind};base64,{base64.b64encode(image).decode('ascii')}"
    # Of an SVG few signs want to be written otherwise: shorter than base64.
    signs = quote(b" ".join(image.split()), safe=" ~!*'()/:;=?@$,+<>")
    return f"data:image/svg+xml,{signs}"


class Section(NamedTuple):
    """A chapter: its heading (None before the first), the headings in it, and its parts."""

    head: dict[str, Any] | None
    entries: list[dict[str, Any]]
    parts: list[dict[str, Any]]

    @property
    def look(self) -> str:
        """Return the class of a chapter that is shown only while a browser computes in it."""
        kinds = {part["kind"] for part in self.parts}
        return "live-only" if "live" in kinds and kinds <= {"heading", "live"} else ""


def _sections(blocks: Sequence[Block]) -> list[Section]:
    """Return the blocks in chapters, as the template reads them; tables and figures numbered."""
    plots = [b.figure.plot for b in blocks if isinstance(b, FigureBlock) and b.figure.plot]
    line_points = points_each(plots)
    places, taken = _places(blocks), {"content", "theme", "status", "live"}
    tables, figures = count(1), count(1)
    sections = [Section(None, [], [])]
    level = 0
    for block in blocks:
        part: dict[str, Any]
        match block:
            case Heading():
                level = min(block.level, level + 1)  # no level is left out on the way down
                name = _anchor(block.text, taken)
                text = Markup(sentence_reader(links=False).renderInline(block.text))
                part = {"kind": "heading", "level": level + 1, "name": name, "text": text}
                if level == 1:
                    sections.append(Section(part, [], []))
                elif level == 2:
                    sections[-1].entries.append(part)
            case Paragraph():
                part = {"kind": "text", "lines": [block.text], "box": block.kind, "listed": False}
            case Bullets():
                listed = block.kind != "answer"  # the sentences of an answer follow each other
                part = {"kind": "text", "lines": block.items, "box": block.kind, "listed": listed}
            case TableBlock():
                part = _table(block.table, next(tables), places)
            case FigureBlock():
                part = _figure(block.figure, next(figures), line_points)
            case Live():
                part = {"kind": "live", "it": block}
            case Signatures():
                part = {"kind": "signatures", "signers": block.signers}
        sections[-1].parts.append(part)
    return sections if sections[0].parts else sections[1:]


def _anchor(text: str, taken: set[str]) -> str:
    """Return an address within the page for a heading; none is given twice."""
    words = re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-") or "section"
    name = next(n for k in count(1) if (n := words if k == 1 else f"{words}-{k}") not in taken)
    taken.add(name)
    return name


def _places(blocks: Sequence[Block]) -> dict[str, str]:
    """Return the anchors of figures and tables by their names."""
    shown = [block for block in blocks if isinstance(block, TableBlock)]
    anchors = {block.name: f"table-{k}" for k, block in enumerate(shown, 1)}
    drawn = [block for block in blocks if isinstance(block, FigureBlock)]
    return anchors | {block.name: f"figure-{k}" for k, block in enumerate(drawn, 1)}


def _figure(figure: ReportFigure, number: int, line_points: int) -> dict[str, Any]:
    caption, alt = figure.caption, figure.alt or figure.caption
    if figure.plot and figure.plot_caption:
        caption, alt = figure.plot_caption, alt.replace(caption, figure.plot_caption, 1)
    part = {"kind": "figure", "number": number, "caption": caption}
    part |= {"alt": alt, "plot": "", "image": ""}
    if plot := figure.plot:
        # No sign in it that could end the element.
        data = Markup(plot_json(plot, line_points).replace("<", "\\u003c"))
        title = plot.slider_title.capitalize() or "Place"
        part |= {"plot": data, "choices": list(plot.choices), "slider": plot.slider}
        part |= {"slider_title": title, "shaded": "; ".join(plot.shaded())}
    elif picture := page_picture(figure):
        width = round(picture_size(picture)[0] / PIXEL)
        part |= {"image": _image_address(picture), "width": width}
    return part


class Cell(NamedTuple):
    """A cell: text, class, what it is sorted by, the anchor that it leads to."""

    text: str
    look: str
    value: str | None
    to: str
    mark: str  # what its mark means; empty without one


def _table(table: Table, number: int, places: Mapping[str, str]) -> dict[str, Any]:
    """Return a table as the template reads it: the governing rows, and the rest folded."""
    texts = table.texts()
    looks = _looks(table, texts)
    widths = column_letters(table, texts)
    letters = sum(min(widest, LONG) + PADDING - 1 for _, widest in widths)
    least = sum(least + PADDING for least, _ in widths)
    rows = [
        [
            _cell(value, text, look, places, _mark_words(table, text, (at, place)))
            for place, (value, text, look) in enumerate(zip(row, texts[at], looks, strict=True))
        ]
        for at, row in enumerate(table.rows)
    ]
    note = marked_note(table)
    shown, folded, row_note = _governing_rows(table)
    look = ["table", *["broad"] * (letters > UPRIGHT), *["short"] * (len(rows) < SHORT)]
    return {
        "kind": "table",
        "name": f"table-{number}",
        "number": number,
        "key_columns": table.keys,
        "caption": table.caption,
        "note": f"{note} {row_note}".strip(),
        "look": " ".join(look),
        "letters": letters,
        "least": least,
        "sorts": len(rows) >= FEWEST_TO_SORT,
        "columns": [
            {"head": column.head, "unit": column.unit, "look": look}
            for column, look in zip(table.columns, looks, strict=True)
        ],
        "rows": [rows[k] for k in shown],
        "rest": [rows[k] for k in folded],
    }


def _governing_rows(table: Table) -> tuple[list[int], list[int], str]:
    """Return the rows of a long table to be read first, the others, and a note on it."""
    total = len(table.rows)
    if total <= MOST_ROWS + SHORT:
        return list(range(total)), [], ""
    marked = {row for row, _ in table.marked}
    names = [column.name or column.head for column in table.columns]
    place = names.index(table.governing) if table.governing in names else None

    def _rank(row: int) -> tuple[bool, float]:
        value = 0.0 if place is None else table.rows[row][place]
        finite = is_number(value) and np.isfinite(value)
        return row not in marked, -abs(float(value)) if finite else np.inf

    order = sorted(range(total), key=_rank)
    clauses = [f"The first {MOST_ROWS} of {total} rows are open"]
    if marked:
        clauses.append("those with marked cells first")
    if place is not None:
        clauses.append(f"ordered by {table.columns[place].head}, largest first")
    # The folded rows keep the order of the table: a reader looks there for one run.
    return order[:MOST_ROWS], sorted(order[MOST_ROWS:]), f"{', '.join(clauses)}."


def _mark_words(table: Table, text: str, place: tuple[int, int]) -> str:
    """Return what the mark of a cell means, for those who do not see its colour."""
    if place not in table.marked:
        return ""
    return MARKED_VERDICTS.get(text, SEE_NOTE if NOTE in table.note else MARK_WORDS)


def _cell(value: Any, text: str, look: str, places: Mapping[str, str], mark: str) -> Cell:
    number = None
    if is_number(value):
        look, number = "amount", f"{value:.9g}" if np.isfinite(value) else ""
    if "verdict" in look and text in VERDICTS:
        look, text = f"{look} {text.replace(' ', '-')}", f"{VERDICTS[text]} {text}"
    to = places.get(value.to, "") if isinstance(value, Link) else ""
    return Cell(text, f"marked {look}" if mark else look, number, to, mark)


def _looks(table: Table, texts: Sequence[Sequence[str]]) -> list[str]:
    """Return the class of each column: numbers, verdicts, words, or sentences (more room)."""
    numbers = table.numeric()
    looks = []
    for place, column in enumerate(table.columns):
        longest = max((len(row[place]) for row in texts), default=0)
        size = " middle"
        if longest > LONG:
            size = " long"
        elif longest < BRIEF:
            size = " brief"
        words = "words verdict" if column.head == "Verdict" else f"words{size}"
        looks.append("amount" if place in numbers else words)
    return looks
