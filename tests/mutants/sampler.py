"""Runs mutants: one at a time in each scratch copy of the tree, side by side over the cores.

The copies lie in build/mutants (git ignores it) and stay there, with the compiled code of the
unchanged kernels; the tree itself is never touched.
"""

import multiprocessing
import os
import queue
import resource
import shutil
import signal
import sys
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

from tests.mutants.kept import ROOT, Mutant, place

SCRATCH = ROOT / "build" / "mutants"
COMPILED = ".numba"  # in a copy: code of the kernels
NOT_COPIED = {"build", "dist", "demo", "__pycache__"}
# What a run may use: processor time [s] of each of its processes, which does not depend on what
# else the machine does, and for those that wait for ever a time on the clock.
PROCESSOR_LIMIT = 300
CLOCK_LIMIT = 10.0 * PROCESSOR_LIMIT
BY_HAND = "tests/unit/test_kernels_by_hand.py"  # kernels as plain Python, before any compilation
OPTIONS = ("-q", "-p", "no:cacheprovider", "--no-header", "--tb=line", "--hypothesis-seed=0")
USED = "processor time [s]: "  # last line of a child
CAUGHT, SURVIVED, TOO_LONG = "caught", "survived", "too long"
NOTHING_RUN = 5  # status of pytest where every test was left out
ENDED_BY_LIMIT = 124
PASSED = (0, NOTHING_RUN)
# Children are forked from a process that has the libraries in memory already, ours not.
SERVER = multiprocessing.get_context("forkserver")
SERVER.set_forkserver_preload(
    [
        "netCDF4",
        "hypothesis",
        "matplotlib.figure",
        "numba",
        "pandas",
        "pint",
        "pydantic",
        "pytest",
        "rich.console",
        "scipy.linalg",
        "scipy.optimize",
        "scipy.signal",
        "scipy.stats",
        "typer.testing",
        "xarray",
    ]
)


@dataclass(frozen=True)
class Verdict:
    """Whether the tests noticed a mutant, the first that did, and its processor time [s].

    A run that reaches a limit is neither caught nor survived: an endless loop looks the same as
    tests that are too slow.
    """

    mutant: Mutant
    verdict: str
    by: str
    seconds: float


def _pytest_here(folder: Path, environment: dict[str, str], words: list[str], said: Path) -> None:
    """In a child process: the tests of a copy; ends the process with their status."""
    with said.open("wb") as file:
        os.dup2(file.fileno(), 1)
        os.dup2(file.fileno(), 2)
    resource.setrlimit(resource.RLIMIT_CPU, (PROCESSOR_LIMIT, PROCESSOR_LIMIT))
    os.chdir(folder)
    os.environ.update(environment)
    sys.path[:] = [environment["PYTHONPATH"], *(p for p in sys.path if p not in ("", str(ROOT)))]
    for name in [name for name in sys.modules if name.split(".")[0] in ("tests", "__mp_main__")]:
        del sys.modules[name]  # those of the tree, not of the copy
    import numba
    import pytest

    numba.config.reload_config()
    status = int(pytest.main(words))
    import thermobearing

    if not thermobearing.__file__.startswith(str(folder)):
        print(f"not the copy was tested, but {thermobearing.__file__}")
        status = 3
    used = os.times()
    print(f"{USED}{used.user + used.system + used.children_user + used.children_system:.2f}")
    sys.stdout.flush()
    os._exit(status)


class Copy:
    """One scratch copy of the tree, in which one mutant at a time lives."""

    def __init__(self, number: int) -> None:
        self.folder = SCRATCH / str(number)
        self.folder.mkdir(parents=True, exist_ok=True)
        for path in self.folder.iterdir():
            if path.name != COMPILED:
                shutil.rmtree(path) if path.is_dir() else path.unlink()
        for path in ROOT.iterdir():
            if path.name.startswith(".") or path.name in NOT_COPIED:
                continue
            if path.is_dir():
                ignore = shutil.ignore_patterns("__pycache__", "*.egg-info")
                shutil.copytree(path, self.folder / path.name, ignore=ignore)
            else:
                shutil.copy2(path, self.folder)
        # Imported here, so that no child is forked with the package of the tree in memory.
        from thermobearing.core.compiled.sources import cache_directory

        compiled = cache_directory()
        if compiled:
            shutil.copytree(compiled, self.folder / COMPILED / compiled.name, dirs_exist_ok=True)
        self.left_out: list[str] = []  # tests that fail anyway
        self.used = 0.0  # processor time of its tests [s]
        self.stamp = 1_000_000_000  # of changed files, never the same twice: see `_write`

    def _environment(self, plain: bool) -> dict[str, str]:
        beside = {"THERMOBEARING_SHARED": str(ROOT.parent / "shared")}
        given = {
            "PYTHONPATH": str(self.folder / "src"),
            "NUMBA_CACHE_DIR": str(self.folder / COMPILED),
            "NUMBA_DISABLE_JIT": "1" if plain else "0",
        }
        return beside | dict(os.environ) | given

    def pytest(self, tests: Iterable[str], *options: str, plain: bool) -> tuple[int, str]:
        """Exit status and output of pytest; ENDED_BY_LIMIT if it reached a limit."""
        left_out = [f"--deselect={test}" for test in self.left_out]
        words = [*OPTIONS, *options, *left_out, *tests]
        output = self.folder.with_suffix(".txt")
        child = SERVER.Process(
            target=_pytest_here, args=(self.folder, self._environment(plain), words, output)
        )
        child.start()
        child.join(CLOCK_LIMIT)
        if child.is_alive():
            child.kill()
            child.join()
            return ENDED_BY_LIMIT, ""
        if child.exitcode in (-signal.SIGXCPU, -signal.SIGKILL):
            self.used += PROCESSOR_LIMIT
            return ENDED_BY_LIMIT, ""
        text = output.read_text(encoding="utf-8", errors="replace")
        self.used += float(text.rpartition(USED)[2] if USED in text else 0.0)
        return child.exitcode or 0, text.rpartition(USED)[0]

    def _write(self, path: Path, text: str) -> None:
        """Python trusts its byte code if time (whole seconds) and size are the same."""
        path.write_text(text, encoding="utf-8")
        self.stamp += 1
        os.utime(path, (self.stamp, self.stamp))

    def run(self, mutant: Mutant) -> Verdict:
        """Run the nearest tests with the mutant in place, until the first that fails."""
        used_before = self.used
        path = place(self.folder, mutant.file)
        compiled = self._compiled()
        kept = self.folder.with_suffix(".original")
        shutil.copy2(path, kept)
        self._write(path, mutant.text)
        try:
            options = ("-x", "-m", "not thorough") if mutant.by_chance else ("-x",)
            rest = [test for test in mutant.tests if test != BY_HAND or mutant.plain]
            status, output = NOTHING_RUN, ""
            if BY_HAND in mutant.tests and not mutant.plain:
                status, output = self.pytest([BY_HAND], *options, plain=True)
            if status in PASSED and rest:
                status, output = self.pytest(rest, *options, plain=mutant.plain)
        finally:
            shutil.copy2(kept, path)
            for name in self._compiled() - compiled:  # nobody needs those kernels again
                shutil.rmtree(self.folder / COMPILED / name, ignore_errors=True)
        names = {0: SURVIVED, NOTHING_RUN: SURVIVED, ENDED_BY_LIMIT: TOO_LONG}
        verdict = names.get(status, CAUGHT)
        by = (_failures(output) or ["an error before the tests"])[0] if verdict == CAUGHT else ""
        return Verdict(mutant, verdict, by, self.used - used_before)

    def _compiled(self) -> set[str]:
        folder = self.folder / COMPILED
        return {path.name for path in folder.iterdir()} if folder.exists() else set()


def _failures(said: str) -> list[str]:
    """Tests that failed, in their order."""
    result = [
        line.partition(" ")[2].partition(" - ")[0]
        for line in said.splitlines()
        if line.startswith(("FAILED ", "ERROR "))
    ]
    return list(dict.fromkeys(result))


def failing_anyway(copies: list[Copy], mutants: list[Mutant]) -> list[str]:
    """Nearest tests that fail without any mutant; from now on the copies leave them out."""
    result: list[str] = []
    for plain in (False, True):
        tests = sorted({test for m in mutants if m.plain is plain for test in m.tests})
        parts = [tests[k :: len(copies)] for k in range(len(copies))]
        with ThreadPoolExecutor(len(copies)) as pool:
            jobs = [
                pool.submit(copy.pytest, part, plain=plain)
                for copy, part in zip(copies, parts, strict=True)
                if part
            ]
            result += [
                test for _, output in (job.result() for job in jobs) for test in _failures(output)
            ]
    for copy in copies:
        copy.left_out = result
    return result


def verdicts(copies: list[Copy], mutants: list[Mutant]) -> Iterator[Verdict]:
    """Verdicts as they come."""
    free: queue.SimpleQueue[Copy] = queue.SimpleQueue()
    for copy in copies:
        free.put(copy)

    def look(mutant: Mutant) -> Verdict:
        copy = free.get()
        try:
            return copy.run(mutant)
        finally:
            free.put(copy)

    with ThreadPoolExecutor(len(copies)) as pool:
        for job in as_completed([pool.submit(look, mutant) for mutant in mutants]):
            yield job.result()
