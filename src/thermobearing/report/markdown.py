"""Markdown of a sentence, and the packages that documents need."""

from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any

from thermobearing.border.errors import InputError

if TYPE_CHECKING:
    from markdown_it import MarkdownIt

PACKAGES = ("jinja2", "markupsafe", "markdown_it")  # of the extra `report`, in every document
Data = dict[str, Any]


def check_packages() -> None:
    """Raise InputError where a package that every document needs is not installed."""
    for name in PACKAGES:
        try:
            import_module(name)
        except ImportError:
            raise InputError(
                f'a report needs {name}: pip install "thermobearing[report]"'
            ) from None


@cache
def sentence_reader(*, links: bool = True) -> "MarkdownIt":
    """Return the reader of what a sentence may have: no HTML, and no pictures from elsewhere."""
    from markdown_it import MarkdownIt

    return MarkdownIt("zero").enable(["emphasis", "backticks", "escape", *["link"] * links])


def split_runs(text: str) -> list[Data]:
    """Return the runs of a line of Markdown: letters that look alike."""
    runs: list[Data] = []
    bold, italic, address = 0, 0, ""
    for block in sentence_reader().parseInline(text):
        for token in block.children or []:
            bold += token.nesting if token.tag == "strong" else 0
            italic += token.nesting if token.tag == "em" else 0
            words = " " if token.type in ("softbreak", "hardbreak") else token.content
            if token.tag == "a":
                address = str(token.attrs["href"]) if token.nesting > 0 else ""
            elif words:
                look = {"bold": bold > 0, "italic": italic > 0, "address": address}
                runs.append({"text": words, "code": token.type == "code_inline", **look})
    return runs
