"""What the tests say of themselves is the same in one process and in several."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.documented_numbers import documented_rows
from tests.quick import quick_cases
from tests.skip_reasons import OTHER

ROOT = Path(__file__).parents[2]
SAMPLE = """
import pytest

@pytest.mark.parametrize("value", [1.0, 3.0, 2.0])
def test_numbers(value, measured):
    measured("largest", value, "4")

@pytest.mark.parametrize("text", ["first", "last"])
def test_text(text, measured):
    measured("a second row", text, "no limit")

def test_skips():
    pytest.skip("not here")

@pytest.mark.xfail(strict=True)
def test_fails_as_expected():
    assert False
"""
SKIPS = """
import pytest
from tests import skip_reasons as reasons

@pytest.mark.parametrize("reason", [reasons.NO_BROWSER, reasons.NO_BROWSER, reasons.NO_NODE])
def test_without_browser(reason):
    pytest.skip(reason)

@pytest.mark.skipif(True, reason=reasons.NO_OPENSEES)
def test_without_opensees():
    pass

def test_without_records():
    pytest.skip(f"{reasons.NO_RECORDS}: /shared")
"""
WHOLE_FILE = 'import pytest\npytest.importorskip("no_such_package")\n'
ALONE = {"CI": "true", "THERMOBEARING_MEASURED": "measured.json"}
ALONE["PYTHONPATH"] = str(ROOT)  # what conftest.py takes from the other tests
ALONE["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"  # the others would take most of the time
FOUND = ["test_sample.py::test_skips", "test_whole.py"]
ROWS = [
    {"what": "largest", "value": "3.0e+00", "limit": "4", "test": "test_sample.py::test_numbers"},
    {
        "what": "a second row",
        "value": "last",
        "limit": "no limit",
        "test": "test_sample.py::test_text",
    },
]


@pytest.fixture
def suite(tmp_path: Path) -> Path:
    (tmp_path / "conftest.py").write_text((ROOT / "tests" / "conftest.py").read_text())
    (tmp_path / "test_sample.py").write_text(SAMPLE)
    (tmp_path / "test_whole.py").write_text(WHOLE_FILE)
    (tmp_path / "pytest.ini").write_text("[pytest]\n")
    return tmp_path


def ended(
    folder: Path, workers: int, expected: list[str], **variables: str
) -> subprocess.CompletedProcess[str]:
    (folder / "expected_skips.txt").write_text("\n".join(["# node ids", *expected]))
    inherited = {
        key: value
        for key, value in os.environ.items()
        if not key.startswith("PYTEST_") and key != "THERMOBEARING_BARE"
    }
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "xdist", "-n", str(workers)],
        cwd=folder,
        env=inherited | ALONE | variables,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("workers", quick_cases([0, 2], 1))
def test_measured_numbers_and_expected_skips(suite: Path, workers: int) -> None:
    done = ended(suite, workers, FOUND)
    assert done.returncode == 0, done.stdout
    assert json.loads((suite / "measured.json").read_text()) == ROWS


@pytest.mark.parametrize(
    ("expected", "amiss"),
    quick_cases(
        [(FOUND[:1], FOUND[1]), (FOUND[1:], FOUND[0]), ([*FOUND, "test_x.py"], "test_x.py")], 1
    ),
    ids=["a file", "a test", "one that does not skip"],
)
def test_unexpected_skips_fail(suite: Path, expected: list[str], amiss: str) -> None:
    done = ended(suite, 0, expected)
    assert done.returncode == 1, done.stdout
    assert f"not as in expected_skips.txt: ['{amiss}']" in done.stdout


@pytest.mark.parametrize(("ci", "status"), [("true", 1), ("", 0)])
def test_numbers_that_are_not_those_of_the_docs(suite: Path, ci: str, status: int) -> None:
    """They are always reported; in CI they fail the run, since it has the versions of the docs."""
    documented = documented_rows()[0]["what"]
    (suite / "test_stale.py").write_text(
        f"def test_stale(measured):\n    measured({documented!r}, 'another number', 'no limit')\n"
    )
    process = ended(suite, 0, FOUND, CI=ci)
    assert process.returncode == status, process.stdout
    assert f"{documented}: the docs say " in process.stdout


@pytest.mark.parametrize("workers", quick_cases([0, 2], 0))
def test_skips_are_counted_by_reason(tmp_path: Path, workers: int) -> None:
    """On a bare machine, those for other reasons fail the run."""
    (tmp_path / "conftest.py").write_text((ROOT / "tests" / "conftest.py").read_text())
    (tmp_path / "test_skips.py").write_text(SKIPS)
    (tmp_path / "pytest.ini").write_text("[pytest]\n")
    bare = {"CI": "", "THERMOBEARING_BARE": "1"}
    process = ended(tmp_path, workers, [], **bare)
    assert process.returncode == 0, process.stdout
    for count, kind in {(3, "browser or node"), (1, "OpenSees"), (1, "real records")}:
        assert re.search(rf"^ +{count} .*{kind}", process.stdout, re.MULTILINE), process.stdout
    (tmp_path / "test_whole.py").write_text(WHOLE_FILE)
    process = ended(tmp_path, workers, [], **bare)
    assert process.returncode == 1, process.stdout
    assert re.search(rf"^ +1 {OTHER}", process.stdout, re.MULTILINE), process.stdout


def test_cases_that_are_not_kept_are_left_to_the_thorough_tests() -> None:
    cases = quick_cases([1, (2, 3), pytest.param(4, id="four")], 1)
    assert [case.values for case in cases] == [(1,), (2, 3), (4,)]
    assert [[mark.name for mark in case.marks] for case in cases] == [
        ["thorough"],
        [],
        ["thorough"],
    ]
    assert cases[2].id == "four"
    for kept in ((), (3,)):
        with pytest.raises(AssertionError):
            quick_cases([1, 2, 3], *kept)
