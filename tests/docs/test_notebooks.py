"""The notebooks are their pages: the same blocks in the same order, and they run."""

import json
import shlex
from pathlib import Path
from typing import Any

import pytest

from docs import notebook
from docs.builder import outputs
from tests.unit.inputs import command

KEYS = {"cells", "metadata", "nbformat", "nbformat_minor"}  # of the format, version 4.5
CELL_KEYS = {
    "markdown": {"id", "cell_type", "metadata", "source"},
    "code": {"id", "cell_type", "metadata", "source", "outputs", "execution_count"},
}
FILES = sorted(notebook.FOLDER.glob("*.ipynb"))


def cells_of(path: Path) -> list[dict[str, Any]]:
    content = json.loads(path.read_text(encoding="utf-8"))
    assert set(content) == KEYS
    assert (content["nbformat"], content["nbformat_minor"]) == (4, 5)
    return list(content["cells"])


def test_every_page_has_its_notebook() -> None:
    assert [path.stem for path in FILES] == sorted(notebook.PAGES)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_a_notebook_has_the_blocks_of_its_page(path: Path) -> None:
    cells = cells_of(path)
    for cell in cells:
        assert set(cell) == CELL_KEYS[cell["cell_type"]]
    assert len({cell["id"] for cell in cells}) == len(cells)
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    blocks = outputs.blocks(path.parents[1] / "guide" / f"{path.stem}.md")
    printed = [block["text"] for block in blocks if block["language"] == "text"]
    assert len(code) == len(blocks) - len(printed)
    stored = ["".join(cell["outputs"][0]["text"]) + "\n" for cell in code if cell["outputs"]]
    assert stored == printed
    python = [block["text"] for block in blocks if block["language"] == "python"]
    sources = ["".join(cell["source"]) + "\n" for cell in code]
    assert [text for text in sources if text in python] == python
    prose = "".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "markdown")
    assert "](" not in prose
    assert "<!--" not in prose


@pytest.mark.thorough
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_a_notebook_runs(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As Jupyter runs it, with commands in this process."""
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {"__name__": "notebook"}
    for cell in cells_of(path):
        source = "".join(cell["source"])
        if cell["cell_type"] != "code":
            continue
        if source.startswith("%%writefile "):
            first, _, content = source.partition("\n")
            Path(first.split()[1]).write_text(content, encoding="utf-8")
        elif source.startswith(("!", "#")):
            for line in source.splitlines():
                words = shlex.split(line.removeprefix("!thermobearing "))
                if line.startswith("!"):
                    done = command(*words)
                    assert done.exit_code == 0, (line, done.stderr)
        else:
            exec(compile(source, path.name, "exec"), names)
