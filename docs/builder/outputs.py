"""Run the blocks of a page in order, as a reader would; write what they print into the page.

A block whose first line is `# NAME.toml` (or .csv, .tcl, .py) is that file. A `text` block shows
lines that the block before it printed; those that match the pattern of the comment above it,
`<!-- output: PATTERN -->`, are written into it by `python -m docs.builder.outputs PAGE...`.
A picture below a comment `<!-- figure: PATH -->` is a file that the blocks of the page write
(for a PDF, its first page); `python -m docs.generate --pictures` copies it.
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
PICTURE = re.compile(r"<!-- figure: (?P<made>\S+) -->\n!\[[^\]]*\]\((?P<shown>[^)]+)\)")
FILE = re.compile(r"# (\S+\.(?:toml|csv|tcl|py))\n")  # the first line of a block that is a file
WITHOUT_FIGURES = {"study", "new", "start", "check", "list", "measure", "--version"}
WIDTH = 100  # columns of the console
Command = Callable[..., Any]


def blocks(path: Path) -> list[re.Match[str]]:
    """Return the blocks of a page."""
    return list(BLOCK.finditer(path.read_text(encoding="utf-8")))


def run(
    path: Path,
    names: dict[str, Any],
    command: Command,
    draw: bool = False,
    prepare: Callable[[re.Match[str]], None] | None = None,
) -> Iterator[tuple[re.Match[str], str]]:
    """Run the blocks of a page in the working directory; give each text block and what it shows.

    Parameters
    ----------
    path : of the page.
    names : of the Python blocks, which share them.
    command : runs the words of a command line and returns its exit code, output and errors.
    draw : commands draw their figures too.
    prepare : called with each block before it runs.
    """
    printed = ""
    for block in blocks(path):
        if prepare:
            prepare(block)
        text, language = block["text"], block["language"]
        if file := FILE.match(text):
            Path(file[1]).write_text(text, encoding="utf-8")
        elif language.startswith("{"):
            continue  # a directive of the site
        elif language == "bash":
            printed = "".join(run_line(line, command, draw) for line in _lines(text))
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


def run_line(line: str, command: Command, draw: bool) -> str:
    """Run a command line and return what it prints; raise ValueError if it fails."""
    if not line.startswith("thermobearing "):
        if line.startswith("pip "):
            return ""
        raise ValueError(f"no command of this package: {line}")
    words = shlex.split(line, comments=True)[1:]
    draws = "-o" in words and words[0] not in WITHOUT_FIGURES
    result = command(*words, *(["--no-figures"] if draws and not draw else []))
    if result.exit_code != 0:
        raise ValueError(f"{line}: {result.stderr}")
    return str(result.stdout)


def refreshed(path: Path, command: Command) -> str:
    """Return the text of a page with the lines that its blocks print now."""
    text = path.read_text(encoding="utf-8")
    for block, printed in run(path, {"__name__": "page"}, command):
        if block["pattern"] is None:
            continue
        pattern = re.compile(block["pattern"])
        matching = [line.rstrip() for line in printed.splitlines() if pattern.search(line)]
        if not matching:
            raise ValueError(f"{path.name}: nothing matches {block['pattern']}: {printed}")
        content = "".join(f"{line}\n" for line in matching)
        start = f"<!-- output: {block['pattern']} -->\n```text\n"
        text = text.replace(f"{start}{block['text']}```", f"{start}{content}```", 1)
    return text


def run_command(*words: str) -> Any:
    """Run the words of a command line in this process."""
    from typer.testing import CliRunner

    from thermobearing.cli import app

    return CliRunner().invoke(app, list(words))


def main() -> None:
    """Rewrite the pages that the command line names."""
    import tests.opensees  # noqa: F401  (finds its libraries)

    os.environ["COLUMNS"] = str(WIDTH)
    for path in [Path(name).resolve() for name in sys.argv[1:]]:
        with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
            path.write_text(refreshed(path, run_command), encoding="utf-8")


if __name__ == "__main__":
    main()
