"""Processor time until a user sees anything: importing the package, asking for help, a first test.

Users have the packages of the wheel. xarray imports dask, if that is installed, and pandas pyarrow,
which adds to the commands of developers.
"""

import tempfile
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from typing import Any

import typer

from benchmarks.commands import CLI, CommandError, run_python
from benchmarks.rows import Row, at_most, failed, plain
from thermobearing.cli import app

RUN_LIMIT, HELP_LIMIT, CYCLIC_LIMIT = 0.5, 0.3, 1.0  # [s]
REPEATS = 5
HELP = "any `--help`"
OTHERS = ("dask", "distributed", "pyarrow")  # imported where they are installed


def command_names(group: Any, *words: str) -> Iterator[tuple[str, ...]]:
    """Yield the words of the program, its groups and its commands."""
    yield words
    for name, item in getattr(group, "commands", {}).items():
        yield from command_names(item, *words, name)


def processor_times(code: str, *arguments: str, repeats: int = REPEATS) -> list[float]:
    """Processor times of fresh processes, in order; the first one (cold files) is not counted."""
    written = {"PYTHONDONTWRITEBYTECODE": ""}  # else edited modules are compiled in every process
    times = [run_python(code, arguments, **written).processor for _ in range(1 + repeats)]
    return sorted(times[1:])


def timed(what: str, code: str, *arguments: str, limit: float | None = None, note: str = "") -> Row:
    """Return the median processor time of a fresh process."""
    try:
        times = processor_times(code, *arguments)
    except CommandError as error:
        return failed(what, str(error), f"<= {limit:g} s" if limit else "")
    note = f"least {times[0]:.2f} s{note}"
    if limit is None:
        return plain(what, median(times), "s", note)
    return at_most(what, median(times), limit, "s", note)


def help_row() -> Row:
    """Return the row of the command whose help takes longest."""
    commands = list(command_names(typer.main.get_command(app)))
    try:
        times = {
            words: median(processor_times(CLI, *words, "--help", repeats=3)) for words in commands
        }
    except CommandError as error:
        return failed(HELP, str(error), f"<= {HELP_LIMIT:g} s")
    slowest = max(times, key=times.__getitem__)
    note = f"the largest of {len(times)}: {' '.join(slowest)}; median {median(times.values()):.2f}"
    return at_most(HELP, times[slowest], HELP_LIMIT, "s", f"{note} s")


def rows() -> list[Row]:
    """Each row is the whole process, Python's own start included."""
    installed = [name for name in OTHERS if find_spec(name)]
    note = f"; with {', '.join(installed)}" if installed else ""
    with tempfile.TemporaryDirectory() as folder:
        cyclic = ("cyclic", "-q", "--overwrite", "-o", str(Path(folder) / "result"))
        return [
            timed("python without anything, for comparison", "pass"),
            timed("import thermobearing", "import thermobearing"),
            timed("`thermobearing.load_bearing`", "import thermobearing as tb; tb.load_bearing"),
            timed("`thermobearing.run`", "import thermobearing as tb; tb.run", limit=RUN_LIMIT),
            help_row(),
            timed(
                "`thermobearing cyclic --no-figures`, kernels compiled",
                CLI,
                *cyclic,
                "--no-figures",
                limit=CYCLIC_LIMIT,
                note=note,
            ),
            timed("the same with figures", CLI, *cyclic, note=note),
        ]
