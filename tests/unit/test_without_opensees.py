"""Where OpenSees cannot be imported, the tests that need it skip and say what to install.

openseespy is there on every machine that has the test extra, and raises a RuntimeError when a
library of the system is missing: here by a package of that name that does the same.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks import opensees
from tests.opensees import MISSING

ROOT = Path(__file__).parents[2]
# Files with tests whose reference is OpenSees, and how many tests they are; all have it in their
# names. The modules next to them hold no tests, but are collected.
NEED_IT = (
    "tests/cross_code/test_opensees_axial.py",
    "tests/cross_code/test_opensees_frame.py",
    "tests/cross_code/test_opensees_girder.py",
    "tests/cross_code/test_opensees_lead_rubber.py",
    "tests/cross_code/test_opensees_material.py",
    "tests/cross_code/test_opensees_pier.py",
    "tests/cross_code/test_opensees_plan.py",
    "tests/cross_code/test_opensees_plane.py",
    "tests/cross_code/test_opensees_replaced.py",
    "tests/cross_code/test_opensees_script.py",
    "tests/cross_code/test_opensees_serve.py",
    "tests/docs/test_pictures.py",
    "tests/docs/test_site.py",
    "tests/verification/test_factors.py",
    "tests/verification/test_devices.py",
)
SKIPPED = 17 + 2 + 5 + 1 + 13 + 10 + 2 + 13 + 5 + 5 + 10 + 3 + 2 + 1 + 4


@pytest.fixture
def broken(tmp_path: Path) -> dict[str, str]:
    """The environment of a process in which openseespy raises when it is imported."""
    package = tmp_path / "openseespy"
    package.mkdir()
    for name in ("__init__", "opensees"):
        text = "raise RuntimeError('Failed to import openseespy on Linux.')\n"
        (package / f"{name}.py").write_text("" if name == "__init__" else text)
    kept = {key: value for key, value in os.environ.items() if not key.startswith("PYTEST_")}
    return kept | {"PYTHONPATH": str(tmp_path), "CI": "", "THERMOBEARING_MEASURED": ""}


def python(environment: dict[str, str], *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *arguments]
    return subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )


@pytest.mark.parametrize(
    "collected",
    [
        pytest.param((*NEED_IT, "tests/reference"), id="what needs it"),
        pytest.param(("tests", "benchmarks"), id="all"),
    ],
)
@pytest.mark.thorough
def test_it_is_collected_and_what_needs_it_says_what_to_install(
    broken: dict[str, str], collected: tuple[str, ...]
) -> None:
    # No test that needs it runs to its end, so that no `assert` need be made to tell its values.
    words = ("--assert=plain", "-p", "no:cacheprovider", "-rs")
    words += ("-k", "opensees and not without")
    done = python(broken, "-m", "pytest", *words, *collected)
    assert done.returncode == 0, done.stdout[-2000:]
    assert re.search(
        rf" {SKIPPED} skipped, \d+ deselected(, \d+ warnings?)? in ", done.stdout.splitlines()[-1]
    )
    reported = " ".join(done.stdout.split())  # lines are broken where the terminal ends
    for name in NEED_IT:
        assert re.search(rf"\[\d\] {name}:\d+: {re.escape(MISSING)}", reported), name


@pytest.mark.thorough
def test_the_model_of_a_bench_ends_with_what_to_install(broken: dict[str, str]) -> None:
    done = python(broken, "-m", "benchmarks.opensees_pier_model")
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1] == f"ImportError: {MISSING}"


def test_the_row_of_a_bench_says_what_to_install(
    broken: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONPATH", broken["PYTHONPATH"])
    monkeypatch.setattr(opensees, "our_step", lambda keep_every: 1.0)
    monkeypatch.chdir(ROOT)
    _, row = opensees.rows()
    assert (row.value, row.met) == (None, False)
    assert MISSING in row.note


def test_openseespy_is_imported_in_one_place() -> None:
    result = {
        path.relative_to(ROOT).as_posix()
        for folder in ("tests", "benchmarks", "docs")
        for path in (ROOT / folder).rglob("*.py")
        if re.search(r"^\s*(import|from) openseespy|\(\s*[\"']openseespy", path.read_text(), re.M)
    }
    # The second has it in the text of a script that is read, not run.
    assert result == {"tests/opensees.py", "tests/verification/frames.py"}
