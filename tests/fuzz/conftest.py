"""Counts of the fuzz at the end, whichever process they were made in; one seed for all."""

import os
import random

import pytest

KEY = "fuzz"
COUNT, SEED = "THERMOBEARING_FUZZ", "THERMOBEARING_FUZZ_SEED"
ROWS: list[tuple[str, dict[str, int]]] = []


def pytest_configure() -> None:
    os.environ.setdefault(SEED, str(random.randrange(2**32)))


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    if report.when == "teardown":
        ROWS.extend(row for key, row in report.user_properties if key == KEY)


@pytest.hookimpl(trylast=True)
def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    if not ROWS:
        return
    names = ("clean error", "completed", "typed outcome", "FAILED", "faults", "ms")
    terminalreporter.section("fuzz: how the examples ended")
    if COUNT in os.environ:
        terminalreporter.write_line(f"{COUNT}={os.environ[COUNT]} {SEED}={os.environ[SEED]}")
    terminalreporter.write_line(f"{'':28}" + "".join(f"{name:>14}" for name in names))
    total = dict.fromkeys(names, 0)
    for border, counts in [*sorted(ROWS), ("all", total)]:
        cells = "".join(f"{counts.get(name, 0):14}" for name in names)
        terminalreporter.write_line(f"{border:28}{cells}")
        for name in names:
            total[name] += 0 if border == "all" else counts.get(name, 0)
