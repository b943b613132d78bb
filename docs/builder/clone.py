"""Run the blocks of pages in a clone as a reader types them: `python -m docs.builder.clone [PAGE]`.

Commands run in a shell with the environment of this Python, each page in an empty folder and a
separate process. What the text between blocks says to run first, as `pip install ...`,
`apt-get install ...` or `make kernels`, is run where it stands; nothing else is. A page whose
commands need more than its text says therefore fails. `--first` stops a page after its first
command. Without PAGE: README and all guides, those that build kernels last.
"""

import argparse
import contextlib
import os
import re
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from docs.builder import outputs

ROOT = Path(__file__).parents[2]
BIN = Path(sys.executable).parent
PREREQUISITE = re.compile(
    r"(?:^|`|# )((?:pip|apt-get) install (?!dist)[^`\n]+|make kernels)", re.MULTILINE
)
COMMAND = re.compile(r"`(thermobearing [^`]+)`")
NOT_TO_BE_RUN = re.compile(r"without `make kernels`")
SHOWN = 2000  # characters of a message


def pages() -> list[Path]:
    """Return README and guides; those with `make kernels` are last, since libraries stay."""
    guides = sorted((ROOT / "docs" / "guide").glob("[!i]*.md"))
    everything = [ROOT / "README.md", *guides]
    return sorted(everything, key=lambda page: "make kernels" in page.read_text(encoding="utf-8"))


def prerequisites(prose: str) -> list[str]:
    """Return the commands that a text says to run first."""
    return [text.strip() for text in PREREQUISITE.findall(NOT_TO_BE_RUN.sub("", prose))]


def run_prerequisite(command: str) -> None:
    """Run an installation, of this clone where it is one of the package."""
    command = command.partition("  #")[0].strip()
    if command.startswith("pip "):
        command = re.sub(r'"?(?:thermobearing|\.)\[(\w+)\]"?', rf'-e "{ROOT}[\1]"', command)
        command = f"{sys.executable} -m {command} --quiet"
    elif command.startswith("apt-get "):
        command = f"(apt-get update -qq && {command} -qq --yes) > /dev/null"
    subprocess.run(command, shell=True, check=True, cwd=ROOT)


def run_command(*words: str) -> Any:
    """Run a command of the package in a separate process."""
    process = subprocess.run(
        [BIN / "thermobearing", *words], capture_output=True, text=True, check=False
    )
    return SimpleNamespace(
        exit_code=process.returncode, stdout=process.stdout, stderr=process.stderr[-SHOWN:]
    )


class _FirstCommandRan(Exception):  # noqa: N818  # no fault: the rest of a page is not wanted
    """The first command of a page has run."""


def run_page(path: Path, *, first_only: bool) -> None:
    """Run a page in the working directory, and what it says to run first."""
    text = path.read_text(encoding="utf-8")
    position = 0

    def prepare(block: re.Match[str]) -> None:
        nonlocal position
        # A comment in a block of commands may name a prerequisite too.
        commands = block["text"] if block["language"] == "bash" else ""
        for command in prerequisites(f"{text[position : block.start()]}\n{commands}"):
            run_prerequisite(command)
        position = block.end()

    def run(*words: str) -> Any:
        result = run_command(*words)
        if first_only and not result.exit_code:
            raise _FirstCommandRan
        return result

    with contextlib.suppress(_FirstCommandRan):
        for _ in outputs.run(path, {"__name__": "page"}, run, draw=True, prepare=prepare):
            pass
        if not position and (command := COMMAND.search(text)):  # a page without blocks
            for prerequisite in prerequisites(text[: command.start()]):
                run_prerequisite(prerequisite)
            outputs.run_line(command[1], run, draw=True)


def main() -> None:
    """Run pages and print a row for each; exit with 1 if one fails."""
    parser = argparse.ArgumentParser("python -m docs.builder.clone", description=__doc__)
    parser.add_argument("pages", nargs="*", type=Path, metavar="PAGE")
    parser.add_argument("--first", action="store_true", help="only the first command of each")
    parser.add_argument("--here", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.here:
        run_page(options.pages[0], first_only=options.first)
        return
    failed = False
    for page in [path.resolve() for path in options.pages] or pages():
        start_usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        words = ["--here", *(["--first"] if options.first else []), str(page)]
        environment = {
            **os.environ,
            "PATH": f"{BIN}{os.pathsep}{os.environ['PATH']}",
            "PYTHONPATH": str(ROOT),
        }
        with tempfile.TemporaryDirectory() as folder:
            process = subprocess.run(
                [sys.executable, "-m", "docs.builder.clone", *words],
                cwd=folder,
                env=environment,
                capture_output=True,
                text=True,
                check=False,
            )
        end_usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = (
            end_usage.ru_utime + end_usage.ru_stime - start_usage.ru_utime - start_usage.ru_stime
        )
        problem = process.stderr.strip()[-SHOWN:] if process.returncode else ""
        print(f"{page.name:24} {'FAILED' if problem else 'ran':6} {seconds:7.1f} CPU s", flush=True)
        if problem:
            print(problem, flush=True)
            failed = True
    sys.exit(failed)


if __name__ == "__main__":
    main()
