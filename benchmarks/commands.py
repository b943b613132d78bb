"""The package as a user meets it: fresh Python processes."""

import os
import resource
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass

# What the installed command does.
CLI = "import sys; from thermobearing.cli import main; sys.exit(main())"


class CommandError(Exception):
    """A command did not end with status 0."""


@dataclass(frozen=True, order=True)
class Elapsed:
    """What a process took: time on the wall, which a user waits, and of the processor [s]."""

    wall: float
    processor: float


def processor_of_children() -> float:
    """Processor time of all processes started from here that have ended [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run_python(code: str, arguments: Sequence[str] = (), **environment: str) -> Elapsed:
    """Time that a fresh Python needs for some code; CommandError with its last words."""
    begin, before = time.perf_counter(), processor_of_children()
    process = subprocess.run(
        [sys.executable, "-c", code, *arguments],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    elapsed = Elapsed(time.perf_counter() - begin, processor_of_children() - before)
    if process.returncode:
        words = (process.stderr.strip() or process.stdout.strip() or "no message").splitlines()
        raise CommandError(f"exit status {process.returncode}: {words[-1]}")
    return elapsed
