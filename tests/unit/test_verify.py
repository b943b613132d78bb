"""`thermobearing verify`: all rows are green here, and a row that is broken on purpose is red."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.opensees import needs_opensees
from tests.reference import stored
from tests.unit.inputs import command
from thermobearing.core.compiled import native
from thermobearing.core.records import Floats
from thermobearing.verify import closed_forms, references, report, rows
from thermobearing.verify.comparison import Comparison
from thermobearing.verify.numpy_stepper import NumpyStepper

PAGE = 26  # rows at most, so that they fit on a screen


def named(check: str) -> rows.Row:
    return next(row for row in rows.row_definitions() if row.check == check)


def verified(check: str) -> rows.Verified:
    (item,) = rows.verify_rows([named(check)])
    return item


def test_each_row_has_its_comparison() -> None:
    checks = [row.check for row in rows.row_definitions()]
    assert set(checks) == set(rows.CHECKS)
    assert len(checks) == len(set(checks)) <= PAGE


def test_all_rows_are_green(tmp_path: Path) -> None:
    page = tmp_path / "verify.html"
    done = command("verify", "--html", page, "--json")
    assert done.exit_code == 0, done.output
    summary = json.loads(done.stdout.splitlines()[-1])
    assert summary["outcome"] == "green"
    assert [row["check"] for row in summary["rows"]] == [r.check for r in rows.row_definitions()]
    assert all(row["error"] <= row["limit"] for row in summary["rows"])
    text = page.read_text(encoding="utf-8")
    assert all(row.what.partition(" (")[0] in text for row in rows.row_definitions())


OPTIONAL = ("jinja2", "markdown_it", "numba", "openseespy", "skfem")
PROGRAM = """
import sys
sys.modules.update(dict.fromkeys(sys.argv.pop(1).split(",")))
from thermobearing.cli import main
main()
"""


def test_no_optional_package_is_needed() -> None:
    # Where no kernels are built, numba is needed to compile them.
    built = native.open_library()[0] is not None
    absent = ",".join(name for name in OPTIONAL if built or name != "numba")
    ended = subprocess.run(
        [sys.executable, "-c", PROGRAM, absent, "verify", "--json", "--quiet"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr
    summary = json.loads(ended.stdout.splitlines()[-1])
    assert "recomputed" not in {row["evidence"] for row in summary["rows"]}


def test_a_narrow_screen_has_one_line_for_each_row() -> None:
    item = rows.Verified(named("linear_pier"), 2.0, "calculated", "", 0.1)
    wide, narrow = (report.screen_table([item], width) for width in (None, 80))
    assert len(wide.columns) == 6
    assert len(narrow.columns) == 4
    lines = [[row.what, "8.8e-88", "8.8e-88", "green"] for row in rows.row_definitions()]
    assert max(len("  ".join(line)) for line in lines) <= 80


def test_a_broken_row_is_red(monkeypatch: pytest.MonkeyPatch) -> None:
    """A heat capacity that is wrong by a thousandth is seen by two rows, and by no other."""
    right = NumpyStepper._conduct

    def warmer(stepper: NumpyStepper, source: Floats, dt: float, ambient: float) -> None:
        right(stepper, 1.001 * source, dt, ambient)

    monkeypatch.setattr(NumpyStepper, "_conduct", warmer)
    closed_forms._both_steppers.cache_clear()
    try:
        done = command("verify", "--json")
    finally:
        closed_forms._both_steppers.cache_clear()
    assert done.exit_code == 1
    summary = json.loads(done.stdout.splitlines()[-1])
    red = [row["check"] for row in summary["rows"] if row["verdict"] == "red"]
    assert red == ["stepper_force", "stepper_temperature"]
    assert summary["red"] == len(summary["explanations"]) == 2
    assert named("stepper_force").red in summary["explanations"][0]


def broken() -> Comparison:
    raise ArithmeticError("no equal layer forces")


@pytest.mark.parametrize("error", [np.nan, np.inf, 2.0, None])
def test_what_is_no_number_within_the_limit_is_red(
    error: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    call = broken if error is None else lambda: Comparison(error)
    monkeypatch.setattr(rows, "CHECKS", {**rows.CHECKS, "linear_pier": call})
    item = verified("linear_pier")
    assert item.verdict == "red"
    assert item.explanation
    assert error != 2.0 or ": 2 of the peak, limit 0.001. " in item.explanation
    assert ("no equal layer forces" in item.explanation) == (error is None)


STORED = [row.check for row in rows.row_definitions() if row.package]


@pytest.mark.parametrize("check", STORED)
def test_stored_references_without_the_other_programs(
    check: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(references, "is_installed", lambda package: False)
    item = verified(check)
    assert (item.verdict, item.evidence) == ("green", "stored")


@pytest.mark.parametrize("check", STORED)
def test_numbers_of_another_script_are_red(check: str, monkeypatch: pytest.MonkeyPatch) -> None:
    other: dict[str, Any] = json.loads(json.dumps(references.stored_references()))
    for table in (other["finite_elements"], other["opensees"]):
        table["script"] = "0" * 64
    monkeypatch.setattr(references, "is_installed", lambda package: False)
    monkeypatch.setattr(references, "stored_references", lambda: other)
    item = verified(check)
    assert item.verdict == "red"
    assert "script" in item.explanation


def test_other_numbers_of_a_processor_are_red(monkeypatch: pytest.MonkeyPatch) -> None:
    numbers = [value * (1.0 + 1e-11) for value in references.earthquake_numbers()]
    other = {"platform_earthquake": [value.hex() for value in numbers]}
    monkeypatch.setattr(references, "stored_references", lambda: other)
    assert verified("platform_earthquake").verdict == "red"


def test_stored_number_of_the_real_test_is_the_recorded_one() -> None:
    assert references.stored_references()["real_test"] == stored.real_test()


@needs_opensees
@pytest.mark.thorough
def test_stored_references_are_those_of_their_scripts() -> None:
    pytest.importorskip("skfem", reason="scikit-fem is not installed")
    again, kept = stored.computed(), references.stored_references()
    for bearing in {bearing for bearing, _ in references.ELEMENTS.values()}:
        assert again["finite_elements"][bearing] == pytest.approx(kept["finite_elements"][bearing])
    assert again["finite_elements"]["script"] == kept["finite_elements"]["script"]
    assert again["opensees"]["script"] == kept["opensees"]["script"]
    assert again["opensees"]["force"] == pytest.approx(kept["opensees"]["force"])
