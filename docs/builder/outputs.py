"""Run the blocks of a page in order, as a reader would; write what they print into the page.

A block whose first line is `# NAME.toml` or `# NAME.csv` is that file. A `text` block shows lines
that the block before it printed; those that match the pattern of the comment above it,
`<!-- output: PATTERN -->`, are written into it by `python -m docs.builder.outputs PAGE...`.
"""

import contextlib
import io
import os
import re
import shlex
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

BLOCK = re.compile(
    r"(?:<!-- output: (?P<pattern>.*?) -->\n)?```(?P<language>[\w{}]+)\n(?P<text>.*?)```", re.DOTALL
)
FILE = re.compile(r"# (\S+\.(?:toml|csv))\n")  # the first line of a block that is a file
WITHOUT_FIGURES = {"study", "new", "check", "list", "measure", "--version"}
WIDTH = 100  # columns of the console
Command = Callable[..., Any]


def blocks(path: Path) -> list[re.Match[str]]:
    """Return the blocks of a page."""
    return list(BLOCK.finditer(path.read_text(encoding="utf-8")))


def run(path: Path, names: dict[str, Any], command: Command) -> Iterator[tuple[re.Match[str], str]]:
    """Run the blocks of a page in the working directory; give each text block and what it shows.

    Parameters
    ----------
    path : of the page.
    names : of the Python blocks, which share them.
    command : runs the words of a command line and returns its exit code, output and errors.
    """
    printed = ""
    for block in blocks(path):
        text, language = block["text"], block["language"]
        if file := FILE.match(text):
            Path(file[1]).write_text(text, encoding="utf-8")
        elif language.startswith("{"):
            continue  # a directive of the site
        elif language == "bash":
            printed = "".join(_printed(line, command) for line in _lines(text))
        elif language == "python":
            with contextlib.redirect_stdout(io.StringIO()) as caught:
                exec(compile(text, path.name, "exec"), names)
            printed = caught.getvalue()
        elif language == "text":
            yield block, printed
        else:
            raise ValueError(f"{path.name}: a block of {language} that is no file")


def _lines(text: str) -> list[str]:
    return text.replace("\\\n", " ").splitlines()


def _printed(line: str, command: Command) -> str:
    """Return what a command line prints, without drawing its figures."""
    if not line.startswith("thermobearing "):
        if line.startswith("pip "):
            return ""
        raise ValueError(f"no command of this package: {line}")
    words = shlex.split(line, comments=True)[1:]
    draws = "-o" in words and words[0] not in WITHOUT_FIGURES
    done = command(*words, *(["--no-figures"] if draws else []))
    if done.exit_code != 0:
        raise ValueError(f"{line}: {done.stderr}")
    return str(done.stdout)


def refreshed(path: Path, command: Command) -> str:
    """Return the text of a page with the lines that its blocks print now."""
    text = path.read_text(encoding="utf-8")
    for block, printed in run(path, {"__name__": "page"}, command):
        if block["pattern"] is None:
            continue
        pattern = re.compile(block["pattern"])
        shown = [line.rstrip() for line in printed.splitlines() if pattern.search(line)]
        if not shown:
            raise ValueError(f"{path.name}: nothing matches {block['pattern']}: {printed}")
        content = "".join(f"{line}\n" for line in shown)
        start = f"<!-- output: {block['pattern']} -->\n```text\n"
        text = text.replace(f"{start}{block['text']}```", f"{start}{content}```", 1)
    return text


def main() -> None:
    """Rewrite the pages that the command line names."""
    from typer.testing import CliRunner

    import tests.opensees  # noqa: F401  (finds its libraries)
    from thermobearing.cli import app

    os.environ["COLUMNS"] = str(WIDTH)
    for name in sys.argv[1:]:
        path = Path(name).resolve()
        with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
            text = refreshed(path, lambda *words: CliRunner().invoke(app, list(words)))
        path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
