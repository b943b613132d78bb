"""Shared by all tests: what they measured, and what they skipped.

A test that needs an optional program skips where it is absent, with a reason; in CI everything
is there, so every skip must stand in tests/expected_skips.txt: CI fails when a test is skipped
that is not expected to be, and the other way round. Tests on real records, which the project may
not contain, skip where the folder of the records is absent.

Tests may run in several processes (pytest-xdist). Each reports what it measured and skipped to
the one that was called, which writes it down.
"""

import json
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.documented_numbers import disagreements, documented_rows
from tests.shared_data import ABSENT
from tests.skip_reasons import OTHER, counts

EXPECTED = Path(__file__).with_name("expected_skips.txt")
COARSE = 50  # points an inch of saved figures
Value = str | float
Recorder = Callable[[str, Value, str], None]
KEY = "measured"  # of the properties of a test's report that hold its numbers
SKIPPED: dict[str, str] = {}  # reasons, by the test or by the file that is skipped entirely
PROPERTIES: list[tuple[str, Any]] = []  # of all tests, in the order in which they ended


@pytest.fixture(autouse=True, scope="module")
def saved_figures(request: pytest.FixtureRequest) -> Iterator[None]:
    """Save figures quickly in files of tests that do not look at them.

    A file that looks at saved figures states `pytestmark = pytest.mark.drawn`: its figures are laid
    out and drawn, with few points an inch, or with all of them by `drawn(fine=True)`. Saved figures
    of other files are not laid out, and blank unless the thorough tests run too. What is measured
    after `draw_without_rendering` is laid out in every file.
    """
    mark = request.node.get_closest_marker("drawn")
    with pytest.MonkeyPatch.context() as patch:
        if "thermobearing" in sys.modules:
            if mark is None or not mark.kwargs.get("fine"):
                patch.setattr("thermobearing.results.drawing.DPI", COARSE)
            if mark is None:
                _save_without_layout(patch, blank="not thorough" in request.config.option.markexpr)
        yield


@pytest.fixture(autouse=True, scope="module")
def no_progress_lines() -> Iterator[None]:
    """Print no line of progress: whether one is due depends on how fast the machine is."""
    with pytest.MonkeyPatch.context() as patch:
        if "thermobearing.commands.common" in sys.modules:
            patch.setattr("thermobearing.commands.common.PROGRESS_LINES_PRINTED", False)
        yield


def _save_without_layout(patch: pytest.MonkeyPatch, blank: bool) -> None:
    """Draw figures without their layout, or not at all, unless they are drawn to be measured."""
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    from thermobearing.results.drawing import Picture

    places = {ConstrainedLayoutEngine: "execute"}
    if blank:  # a Picture looks through all its texts, ticks included, before it is drawn
        places |= dict.fromkeys((Figure, Picture), "draw")
    whole = [(place, name, getattr(place, name)) for place, name in places.items()]
    draw_without_rendering = Figure.draw_without_rendering

    def draw_to_measure(figure: Any) -> None:
        with pytest.MonkeyPatch.context() as patch:
            for place, name, function in whole:
                patch.setattr(place, name, function)
            draw_without_rendering(figure)

    for place, name, _ in whole:
        patch.setattr(place, name, lambda *_: None)
    patch.setattr(Figure, "draw_without_rendering", draw_to_measure)


@pytest.fixture
def measured(request: pytest.FixtureRequest) -> Recorder:
    """Record a measured number for the docs: what, value, limit.

    Text is kept as it is; of numbers under one name the largest is kept.
    """
    place = request.session.items.index(request.node)
    test = request.node.nodeid.split("[")[0]

    def record(what: str, value: Value, limit: str) -> None:
        number = value if isinstance(value, str) else float(value)
        row = {"place": place, "what": what, "value": number, "limit": limit, "test": test}
        request.node.user_properties.append((KEY, row))

    return record


def pytest_collectreport(report: pytest.CollectReport) -> None:
    """Note a file that skips as a whole."""
    _note_skip(report)


def _note_skip(report: pytest.CollectReport | pytest.TestReport) -> None:
    if report.skipped and not hasattr(report, "wasxfail"):
        reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else ""
        SKIPPED[report.nodeid] = reason


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Note what a test measured, and whether it skipped; in each process, and where all end."""
    _note_skip(report)
    if report.when == "teardown":  # the last report of a test has all its properties
        PROPERTIES.extend(report.user_properties)


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any, error: object) -> None:
    """Files that skipped in another process: pytest-xdist itself reports tests only."""
    SKIPPED.update(getattr(node, "workeroutput", {}).get("skipped", {}))


@pytest.hookimpl(trylast=True)
def pytest_terminal_summary(terminalreporter: "pytest.TerminalReporter") -> None:
    """Report skipped tests, in CI those that it does not expect, and numbers not as in the docs."""
    if SKIPPED:
        terminalreporter.section("skipped tests by reason")
        for kind, count in counts(SKIPPED.values()).most_common():
            terminalreporter.write_line(f"{count:4} {kind}")
    if os.environ.get("THERMOBEARING_BARE") and OTHER in counts(SKIPPED.values()):
        terminalreporter.write_line("a bare machine gives no reason for the last kind")
        _fail(terminalreporter)
    rows = measured_rows([row for key, row in PROPERTIES if key == KEY])
    stale = disagreements(rows, documented_rows())
    continuous_integration = bool(os.environ.get("CI"))
    if continuous_integration:
        terminalreporter.section("skipped tests")
        skipped = {name for name, reason in SKIPPED.items() if ABSENT not in reason}
        for name in sorted(skipped) or ["none"]:
            terminalreporter.write_line(name)
        unexpected = skipped ^ _expected()
        if unexpected:
            terminalreporter.write_line(f"not as in {EXPECTED.name}: {sorted(unexpected)}")
            _fail(terminalreporter)
    # Of some cases of a test the largest number may be smaller than in the docs; elsewhere than in
    # CI, with other versions of the libraries, another number is no failure.
    options = terminalreporter.config.option
    if continuous_integration or (stale and not options.markexpr and not options.keyword):
        terminalreporter.section("numbers in the docs")
        for line in stale or [f"{len(rows)} measured, as in the docs"]:
            terminalreporter.write_line(line)
    if continuous_integration and stale:
        _fail(terminalreporter)


def _fail(terminalreporter: "pytest.TerminalReporter") -> None:
    terminalreporter._session.exitstatus = pytest.ExitCode.TESTS_FAILED  # type: ignore[attr-defined]


def _expected() -> set[str]:
    lines = (line.split("#")[0].strip() for line in EXPECTED.read_text().splitlines())
    return {line for line in lines if line}


@pytest.hookimpl(tryfirst=True)
def pytest_sessionfinish(session: pytest.Session) -> None:
    """Write what the tests measured where THERMOBEARING_MEASURED says (used by `make docs`)."""
    if hasattr(session.config, "workerinput"):
        session.config.workeroutput["skipped"] = SKIPPED  # type: ignore[attr-defined]
        return
    target = os.environ.get("THERMOBEARING_MEASURED")
    if target:
        rows = measured_rows([row for key, row in PROPERTIES if key == KEY])
        Path(target).write_text(json.dumps(rows, indent=1, ensure_ascii=False) + "\n")


def measured_rows(result: list[dict[str, Any]]) -> list[dict[str, str]]:
    """One row for each name in the order of the tests; of several numbers the largest."""
    rows: dict[str, dict[str, Any]] = {}
    for row in sorted(result, key=lambda row: row["place"]):  # in whichever order they ended
        before = rows.get(row["what"], row)
        if not isinstance(row["value"], str) and not isinstance(before["value"], str):
            row = row | {"value": max(row["value"], before["value"])}
        rows[row["what"]] = row
    return [
        {
            "what": row["what"],
            "value": row["value"] if isinstance(row["value"], str) else f"{row['value']:.1e}",
            "limit": row["limit"],
            "test": row["test"],
        }
        for row in rows.values()
    ]
