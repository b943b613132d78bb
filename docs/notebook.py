"""Pages of the documentation as Jupyter notebooks, written by `python -m docs.generate`.

Blocks of a page become cells: Python as it is, commands with `!`, files with `%%writefile`. What a
page shows as printed is stored as the output of its cell, so that a notebook can be read before it
is run. Links and pictures of the page are left out: a notebook is a file of its own.
"""

import json
import re
from pathlib import Path
from typing import Any

from docs.builder import outputs

DOCS = Path(__file__).parent
FOLDER = DOCS / "notebooks"
PAGES = ("tutorial", "first_results")  # of docs/guide
COMMENT = re.compile(r"<!--.*?-->\n?", re.DOTALL)
PICTURE = re.compile(r"!\[[^\]]*\]\([^)]*\)\n?")
LINK = re.compile(r"\[([^\]]+)\]\([^)]*\)")
DOWNLOAD = re.compile(r"^This page as a .*\n\n?", re.MULTILINE)  # the link to the notebook itself
FORMAT = {"nbformat": 4, "nbformat_minor": 5}
METADATA = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}


def notebook_text(page: Path) -> str:
    """Return a page of Markdown as the text of a notebook.

    Parameters
    ----------
    page
        File of Markdown with blocks as `docs.builder.outputs` runs them.

    Raises
    ------
    ValueError
        For a block of a language that no cell has.
    """
    text, position = page.read_text(encoding="utf-8"), 0
    cells: list[dict[str, Any]] = []
    for block in outputs.blocks(page):
        _add_prose(cells, text[position : block.start()])
        position = block.end()
        if block["language"] == "text":
            stream = {"output_type": "stream", "name": "stdout", "text": _lines(block["text"])}
            cells[-1]["outputs"] = [stream]
        else:
            code = {"cell_type": "code", "execution_count": None, "metadata": {}, "outputs": []}
            cells.append(code | {"source": _lines(_code(block))})
    _add_prose(cells, text[position:])
    cells = [{"id": f"cell-{number}", **cell} for number, cell in enumerate(cells)]
    notebook = {"cells": cells, "metadata": METADATA, **FORMAT}
    return json.dumps(notebook, ensure_ascii=False, indent=1) + "\n"


def notebook_texts() -> dict[Path, str]:
    """Return the notebooks of all pages that have one."""
    return {
        FOLDER / f"{name}.ipynb": notebook_text(DOCS / "guide" / f"{name}.md") for name in PAGES
    }


def _add_prose(cells: list[dict[str, Any]], text: str) -> None:
    """Append text between blocks as a cell, if there is any."""
    for pattern, replacement in ((COMMENT, ""), (PICTURE, ""), (DOWNLOAD, ""), (LINK, r"\1")):
        text = pattern.sub(replacement, text)
    text = re.sub(r"\n{3,}", "\n\n", text).strip()
    if text:
        cells.append({"cell_type": "markdown", "metadata": {}, "source": _lines(text)})


def _code(block: re.Match[str]) -> str:
    """Return a block as the code of a cell."""
    text, language = block["text"].rstrip("\n"), block["language"]
    if file := outputs.FILE.match(block["text"]):
        return f"%%writefile {file[1]}\n{text}"
    if language == "python":
        return text
    if language == "bash":
        return "\n".join(_shell_line(line) for line in text.replace("\\\n", " ").splitlines())
    raise ValueError(f"a block of {language} that is no file: {text[:40]}")


def _shell_line(line: str) -> str:
    """Return a command as a line of a cell; what installs is a comment."""
    line = re.sub(r"  +", " ", line)
    return f"!{line}" if line.startswith("thermobearing ") else f"# {line}"


def _lines(text: str) -> list[str]:
    """Return text as the list of lines that the format has."""
    return text.rstrip("\n").splitlines(keepends=True)
