"""How an example ended, and what may not happen on the way. No tests."""

import os
import shutil
import signal
import sys
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np

import thermobearing as tb

try:
    import resource
except ImportError:  # Windows
    resource = None  # type: ignore[assignment]

CLEAN, COMPLETED, TYPED = "clean error", "completed", "typed outcome"
ENDS = (CLEAN, COMPLETED, TYPED)
# Examples take milliseconds. These are last resorts, far above what any may take: processor
# time and not that of a clock, and memory beyond what the process has already.
SECONDS = 60.0
MEMORY = 2 * 2**30
STATM = Path("/proc/self/statm")  # sizes of this process, where the system tells
KEEP = os.environ.get("THERMOBEARING_FUZZ_KEEP")  # a folder for what failed
MOST_KEPT = 3  # examples of one fault that are kept


class TookTooLong(BaseException):
    """The example was stopped; no `except Exception` may hide that."""


@dataclass(frozen=True)
class Example:
    """Input that is tried.

    Attributes
    ----------
    files : content by name, written into an empty folder before.
    call : does it in that folder; returns COMPLETED or TYPED, or raises.
    about : what is called, for people.
    """

    files: dict[str, bytes]
    call: Callable[[Path], str]
    about: str


@dataclass
class Tally:
    border: str
    ends: Counter[str] = field(default_factory=Counter)
    faults: dict[str, list[str]] = field(default_factory=dict)  # what was reported, by signature

    def try_example(self, example: Example, folder: Path) -> None:
        folder.mkdir()
        here = Path.cwd()
        try:
            for name, content in example.files.items():
                (folder / name).write_bytes(content)
            os.chdir(folder)
            self.ends[_run_example(example, folder)] += 1
        except (Exception, TookTooLong) as error:
            self.ends["FAILED"] += 1
            self._keep(error, example, folder)
        finally:
            os.chdir(here)
            shutil.rmtree(folder, ignore_errors=True)

    def _keep(self, error: BaseException, example: Example, folder: Path) -> None:
        reported = self.faults.setdefault(_signature(error), [])
        if len(reported) >= MOST_KEPT:
            return
        where = ""
        if KEEP:
            kept = Path(KEEP) / f"{self.border}-{len(self.faults)}-{len(reported)}".replace(
                " ", "-"
            )
            shutil.copytree(folder, kept, dirs_exist_ok=True)
            lines = "".join(traceback.format_exception(error))
            (kept / "report.txt").write_text(f"{example.about}\n\n{lines}", errors="replace")
            where = f" [{kept}]"
        reported.append(f"{example.about[:300]}: {str(error)[:200]}{where}")

    def reported(self) -> str:
        lines = [f"{self.border}: {len(self.faults)} faults"]
        for name, examples in self.faults.items():
            lines += [f"* {name}", *(f"    {text}" for text in examples)]
        return "\n".join(lines)


def _signature(error: BaseException) -> str:
    """Type of an error and the innermost place of the package that it came through."""
    frames = traceback.extract_tb(error.__traceback__)
    ours = [frame for frame in frames if f"thermobearing{os.sep}" in frame.filename] or frames
    place = f"{Path(ours[-1].filename).name}, {ours[-1].name}" if ours else "?"
    return f"{type(error).__name__} in {place}"


def _run_example(example: Example, folder: Path) -> str:
    try:
        with watched():
            end = example.call(folder)
    except (tb.InputError, tb.OutputError) as error:
        _check_message(str(error))
        end = CLEAN
    assert end in ENDS, end
    left = [path.name for path in folder.iterdir() if path.name.startswith(".")]
    assert not left, f"left behind: {left}"
    return end


def _check_message(message: str) -> None:
    assert message.strip(), "an error without a message"
    for piece in ("Traceback", "pydantic", "\x1b"):
        assert piece not in message, f"{piece!r} in the message: {message[:200]}"


@contextmanager
def watched() -> Iterator[None]:
    """Stop what takes too much processor time, refuse what takes too much memory."""

    def stop(_: int, frame: FrameType | None) -> None:
        raise TookTooLong(f"more than {SECONDS:g} s of processor time")

    if not hasattr(signal, "SIGPROF"):
        yield
        return
    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    try:
        with _limited_memory():
            yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


@contextmanager
def _limited_memory() -> Iterator[None]:
    if resource is None or not STATM.exists() or sys.platform != "linux":
        yield
        return
    size = int(STATM.read_text().split()[0]) * resource.getpagesize()
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (size + MEMORY, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


# Numbers of a summary that need not exist.
OPEN = {"limit", "used",  # of a check without a limit
        "lead_degC", "lead_degC_max", "characteristic_strength_kN", "post_yield_stiffness_kN_mm",
        "h_eq", "pier_ductility", "energy_of_warmest", "pier_moment_max_kN_m"}  # fmt: skip


def check_numbers(value: Any, outcome: str, key: str = "") -> None:
    """No number of a summary is NaN or infinite, unless it need not exist."""
    if isinstance(value, dict):
        for name, item in value.items():
            check_numbers(item, outcome, str(name))
    elif isinstance(value, list | tuple):
        for item in value:
            check_numbers(item, outcome, key)
    elif isinstance(value, float) and key not in OPEN:
        assert np.isfinite(value), f"{key} = {value} in the summary, outcome {outcome}"
