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

from tests.opensees import MISSING

ROOT = Path(__file__).parents[2]
# Every test whose reference is OpenSees; the modules beside them hold none, but are collected.
NEED_IT = (
    "tests/cross_code/test_opensees_lead.py",
    "tests/cross_code/test_opensees_pier.py",
    "tests/verification/test_factors.py::test_opensees_text_gives_the_same_loop",
)
COUNT = 1 + 6 + 1


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
    """A Python of its own, in the root of the repository."""
    command = [sys.executable, *arguments]
    return subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )


def test_everything_is_collected(broken: dict[str, str]) -> None:
    done = python(broken, "-m", "pytest", "--collect-only", "-q", "-p", "no:cacheprovider")
    assert done.returncode == 0, done.stdout[-2000:]
    for name in NEED_IT:
        assert name in done.stdout
    assert "error" not in done.stdout.splitlines()[-1]


def test_the_tests_that_need_it_skip_and_say_what_to_install(broken: dict[str, str]) -> None:
    done = python(broken, "-m", "pytest", "-p", "no:cacheprovider", "-rs", *NEED_IT)
    assert done.returncode == 0, done.stdout[-2000:]
    assert re.search(rf"=+ {COUNT} skipped in ", done.stdout.splitlines()[-1]), done.stdout
    assert MISSING in " ".join(done.stdout.split())


@pytest.mark.parametrize("bench", ["opensees_model", "opensees_pier_model"])
def test_a_bench_that_needs_it_ends_with_what_to_install(
    bench: str, broken: dict[str, str]
) -> None:
    done = python(broken, "-m", f"benchmarks.{bench}")
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1] == f"ImportError: {MISSING}"


def test_openseespy_is_imported_in_one_place() -> None:
    found = {
        path.relative_to(ROOT).as_posix()
        for folder in ("tests", "benchmarks", "docs")
        for path in (ROOT / folder).rglob("*.py")
        if re.search(r"^\s*(import|from) openseespy|\(\s*[\"']openseespy", path.read_text(), re.M)
    }
    assert found == {"tests/opensees.py"}
