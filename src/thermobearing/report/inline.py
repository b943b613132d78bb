"""Markdown inside a line: bold, italic, code and links; everything else is text as it stands."""

from dataclasses import dataclass
from functools import cache

from markdown_it import MarkdownIt


@dataclass(frozen=True)
class Run:
    """Letters that look alike; `address` of a link."""

    text: str
    bold: bool = False
    italic: bool = False
    code: bool = False
    address: str = ""


@cache
def _parser() -> MarkdownIt:
    return MarkdownIt("zero").enable(["emphasis", "backticks", "link", "escape"])


def runs_of(text: str) -> list[Run]:
    """The runs of a line.

    Examples
    --------
    >>> [run.text for run in runs_of("as *strong* as `$x$`")]
    ['as ', 'strong', ' as ', '$x$']
    """
    found: list[Run] = []
    bold, italic, address = 0, 0, ""
    for block in _parser().parseInline(text):
        for token in block.children or []:
            bold += token.nesting if token.tag == "strong" else 0
            italic += token.nesting if token.tag == "em" else 0
            if token.tag == "a":
                address = str(token.attrs["href"]) if token.nesting > 0 else ""
            elif token.content:
                code = token.type == "code_inline"
                found.append(Run(token.content, bold > 0, italic > 0, code, address))
            elif token.type in ("softbreak", "hardbreak"):
                found.append(Run(" ", bold > 0, italic > 0, False, address))
    return found
