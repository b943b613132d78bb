"""A document as one HTML file: opens from a disk, asks no network, prints, light and dark."""

import base64
import hashlib
import html
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from string import Template
from urllib.parse import quote

from thermobearing.report.html_plots import plot_html, points_each
from thermobearing.report.html_tables import (
    anchor,
    breakable,
    checks_html,
    encoded,
    escaped,
    heading,
    page_file,
    sentence,
    table_html,
)
from thermobearing.report.pictures import page_picture, picture_size
from thermobearing.report.pieces import (
    Block,
    Bullets,
    ChecksBlock,
    Document,
    FigureBlock,
    Heading,
    Paragraph,
    ReportFigure,
    TableBlock,
)

PIXEL = 25.4 / 96.0  # of a page [mm]


def figure_html(figure: ReportFigure, number: int) -> str:
    """A drawn figure with its caption.

    It is an image of its own, not a part of the page: names and looks within two of them do not
    meet, and a script in a picture from elsewhere does not run.

    Parameters
    ----------
    figure : with `draw` or `image`.
    number : of it in the document.

    Examples
    --------
    >>> "data:image/svg+xml" in figure_html(ReportFigure("A line", image=b"<svg/>"), 2)
    True
    """
    name = f"figure-{number}"
    return (
        f'<figure class="figure" id="{name}">\n{_image(figure)}'
        f'<figcaption><span class="number">Figure {number}.</span> '
        f"{escaped(figure.caption)}</figcaption>\n</figure>\n"
    )


def _image(figure: ReportFigure) -> str:
    """The picture of a figure, as broad as it says; nothing where it has none."""
    picture = page_picture(figure)
    if picture is None:
        return ""
    alt = escaped(figure.alt or figure.caption)
    width = round(picture_size(picture)[0] / PIXEL)
    return f'<img class="drawn" src="{_image_address(picture)}" width="{width}" alt="{alt}">\n'


def _image_address(image: bytes) -> str:
    """Bytes of a PNG, JPEG or SVG as an address that holds them."""
    if image.startswith(b"\x89PNG"):
        return encoded(image, "image/png")
    if image.startswith(b"\xff\xd8"):
        return encoded(image, "image/jpeg")
    # Of an SVG few signs want to be written otherwise: shorter than base64.
    signs = quote(b" ".join(image.split()), safe=" ~!*'()/:;=?@$,+<>")
    return html.escape(f"data:image/svg+xml,{signs}", quote=True)


DEEPEST_IN_CONTENTS = 2
# Boxes: the word above what stands in them.
BOX_NAMES = {"answer": "Answer", "warning": "\N{WARNING SIGN} Warning"}
TAKEN = ("content", "theme", "told")  # names of the page's own parts


@dataclass
class Body:
    """What the blocks of a document became."""

    html: list[str] = field(default_factory=list)
    entries: list[tuple[int, str, str]] = field(default_factory=list)  # level, anchor, words


def html_page(document: Document) -> str:
    """A document as one HTML file that needs nothing else.

    The same document gives the same text.

    Parameters
    ----------
    document : what is written.

    Returns
    -------
    str : the whole page.

    Examples
    --------
    >>> page = html_page(Document("A test", {}, None, [Paragraph("It **held**.")], {}))
    >>> "<p>It <strong>held</strong>.</p>" in page
    True
    """
    body = _body(document.blocks)
    plots = any(isinstance(b, FigureBlock) and b.figure.plot for b in document.blocks)
    scripts = [page_file("page.js")]
    if plots:
        scripts = [page_file("plotly-basic.min.js"), *scripts, page_file("plots.js")]
    project = document.block.get("Project", "")
    words = {
        "allowed": " ".join(f"'sha256-{_hash(script)}'" for script in scripts),
        "title": escaped(f"{project}: {document.title}" if project else document.title),
        "css": page_file("page.css"),
        "logo": _logo(document),
        "heading": escaped(document.title),
        "block": _title_block(document),
        "contents": _contents(body.entries),
        "body": "".join(body.html),
        "foot": _foot(document),
        "scripts": "".join(f"<script>{script}</script>\n" for script in scripts),
    }
    return Template(page_file("page.html")).substitute(words)


def _hash(script: str) -> str:
    """What a page is allowed to run, as its own policy names it: nothing else is."""
    return base64.b64encode(hashlib.sha256(script.encode()).digest()).decode("ascii")


def _logo(document: Document) -> str:
    if not document.logo:
        return ""
    return f'<img class="logo" src="{_image_address(document.logo)}" alt="Logo">\n'


def _title_block(document: Document) -> str:
    if not document.block:
        return ""
    rows = [
        f"<div><dt>{escaped(name)}</dt><dd>{breakable(value)}</dd></div>\n"
        for name, value in document.block.items()
    ]
    return f'<dl class="block">\n{"".join(rows)}</dl>\n'


def _foot(document: Document) -> str:
    if not document.identity:
        return ""
    told = " \N{MIDDLE DOT} ".join(
        f"{escaped(k)}: {breakable(v)}" for k, v in document.identity.items()
    )
    return f'<footer class="page-foot">{told}</footer>\n'


def _contents(entries: Sequence[tuple[int, str, str]]) -> str:
    """The contents list, with the sections below those they belong to."""
    if not entries:
        return ""
    items: list[str] = []
    depth = 0
    for level, name, words in entries:
        if level > depth:
            items.append("<ol>" * (level - depth))
        else:
            items.append("</li></ol>" * (depth - level) + "</li>")
        items.append(f'<li><a href="#{name}">{words}</a>')
        depth = level
    items.append("</li></ol>" * depth)
    return (
        '<nav class="contents" aria-label="Contents"><details open><summary>Contents</summary>\n'
        f"{''.join(items)}\n</details></nav>\n"
    )


def _body(blocks: Sequence[Block]) -> Body:
    """Blocks in reading order, in sections that their first headings name."""
    body = Body()
    taken = set(TAKEN)
    most = points_each(
        [b.figure.plot for b in blocks if isinstance(b, FigureBlock) and b.figure.plot]
    )
    pieces = _pieces(blocks, most)
    level, open_section = 0, False
    for block, text in zip(blocks, pieces, strict=True):
        if not isinstance(block, Heading):
            body.html.append(text)
            continue
        level = min(block.level, level + 1)  # no level is left out on the way down
        name = anchor(block.text, taken)
        if level <= DEEPEST_IN_CONTENTS:
            body.entries.append((level, name, text))
        if level == 1:
            body.html.append("</section>\n" if open_section else "")
            body.html.append(f'<section aria-labelledby="{name}">\n')
            open_section = True
        body.html.append(f'<h{level + 1} id="{name}">{text}</h{level + 1}>\n')
    body.html.append("</section>\n" if open_section else "")
    return body


def _pieces(blocks: Sequence[Block], most: int) -> Iterator[str]:
    """Each block as HTML, of a heading its words; tables and figures are numbered on the way."""
    places = _places(blocks)
    tables = figures = 0
    for block in blocks:
        match block:
            case Heading():
                yield heading(block.text)
            case Paragraph():
                yield _boxed(f"<p>{sentence(block.text)}</p>\n", block.kind)
            case Bullets():
                yield _boxed(_listed(block), block.kind)
            case TableBlock():
                tables += 1
                yield table_html(block.table, tables, places)
            case ChecksBlock():
                tables += 1
                yield checks_html(block.checks, tables)
            case FigureBlock():
                figures += 1
                drawn = block.figure
                yield plot_html(drawn, figures, most) if drawn.plot else figure_html(drawn, figures)


def _places(blocks: Sequence[Block]) -> dict[str, str]:
    """Anchors of figures and tables by their names, as they are numbered."""
    shown = [block for block in blocks if isinstance(block, TableBlock | ChecksBlock)]
    found = {b.name: f"table-{k}" for k, b in enumerate(shown, 1) if isinstance(b, TableBlock)}
    drawn = [block for block in blocks if isinstance(block, FigureBlock)]
    return found | {block.name: f"figure-{k}" for k, block in enumerate(drawn, 1)}


def _listed(block: Bullets) -> str:
    """A list; the sentences of an answer are paragraphs, one follows the other."""
    if block.kind == "answer":
        return "".join(f"<p>{sentence(item)}</p>\n" for item in block.items)
    items = "".join(f"<li>{sentence(item)}</li>\n" for item in block.items)
    return f"<ul>\n{items}</ul>\n"


def _boxed(text: str, kind: str) -> str:
    if kind not in BOX_NAMES:
        return text
    name = BOX_NAMES[kind]
    return f'<div class="box {kind}" role="note"><p class="box-name">{name}</p>\n{text}</div>\n'
