"""Shared by all tests: CI fails when a test is skipped that is not expected to be.

A test that needs the given data or an optional program skips elsewhere, with a reason; in
CI everything is there, so every skip must stand in tests/expected_skips.txt.
"""

import json
import os
from collections.abc import Callable
from pathlib import Path

import pytest

EXPECTED = Path(__file__).with_name("expected_skips.txt")


def _expected() -> set[str]:
    lines = (line.split("#")[0].strip() for line in EXPECTED.read_text().splitlines())
    return {line for line in lines if line}


@pytest.hookimpl(trylast=True)
def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Print the skipped tests, and in CI compare them with the expected list."""
    skipped = {report.nodeid for report in terminalreporter.stats.get("skipped", [])}
    if not os.environ.get("CI"):
        return
    terminalreporter.section("skipped tests")
    for name in sorted(skipped) or ["none"]:
        terminalreporter.write_line(name)
    unexpected = skipped ^ _expected()
    if unexpected:
        terminalreporter.write_line(f"not as in {EXPECTED.name}: {sorted(unexpected)}")
        terminalreporter._session.exitstatus = pytest.ExitCode.TESTS_FAILED  # type: ignore[attr-defined]


Value = str | float
Recorder = Callable[[str, Value, str], None]
MEASURED: dict[str, tuple[Value, str, str]] = {}


@pytest.fixture
def measured(request: pytest.FixtureRequest) -> Recorder:
    """Record a measured number for the docs: what, value, limit.

    Text is kept as it is; of numbers under one name the largest is kept.
    """

    def record(what: str, value: Value, limit: str) -> None:
        before = MEASURED.get(what, (value, "", ""))[0]
        if not isinstance(value, str) and not isinstance(before, str):
            value = max(float(value), before)
        MEASURED[what] = (value, limit, request.node.nodeid.split("[")[0])

    return record


def pytest_sessionfinish() -> None:
    """Write what the tests measured where THERMOBEARING_MEASURED says (used by `make docs`)."""
    target = os.environ.get("THERMOBEARING_MEASURED")
    if not target:
        return
    rows = [
        {
            "what": what,
            "value": value if isinstance(value, str) else f"{value:.1e}",
            "limit": limit,
            "test": test,
        }
        for what, (value, limit, test) in MEASURED.items()
    ]
    Path(target).write_text(json.dumps(rows, indent=1, ensure_ascii=False) + "\n")
