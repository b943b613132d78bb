"""Words of an HTML page: escaped, Markdown in a line, files of the page."""

import base64
import html
import re

from markdown_it import MarkdownIt

from thermobearing.border.library import data_path

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
