"""The command where little is as usual: no terminal, no home, odd letters, a reader who leaves."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.unit.inputs import FILES, content, quick_case

COMMAND = [sys.executable, "-m", "thermobearing.cli"]
POOR = {"COLUMNS": "20", "LANG": "C", "LC_ALL": "C", "PYTHONIOENCODING": "ascii", "TERM": "dumb"}


def environment(**changes: str | None) -> dict[str, str]:
    changed = {**os.environ, **changes}
    return {key: value for key, value in changed.items() if value is not None}


@pytest.fixture
def case(tmp_path: Path) -> Path:
    folder = tmp_path / "cold tests \u51ac"
    folder.mkdir()
    return quick_case(folder / "case \u71b1.toml")


@pytest.mark.thorough
def test_ascii_on_twenty_columns_without_a_home(case: Path) -> None:
    out = case.parent / "out \u529b"
    done = subprocess.run(
        [*COMMAND, "cyclic", str(case), "-o", str(out), "--no-figures", "--json"],
        env=environment(HOME=None, XDG_CACHE_HOME=None, **POOR),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout.splitlines()[-1])["output"] == str(out)
    assert sorted(content(out)) == FILES


def test_help_where_a_character_is_missing() -> None:
    done = subprocess.run(
        [*COMMAND, "bounds", "--help"], env=environment(**POOR), capture_output=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, b"")


@pytest.mark.skipif(os.name != "posix", reason="needs a POSIX shell")
@pytest.mark.parametrize(
    "how",
    [
        "| head -1",
        pytest.param(">&-", marks=pytest.mark.thorough),
        pytest.param("<&- >&- 2>&-", marks=pytest.mark.thorough),
    ],
)
def test_output_that_nobody_reads(case: Path, how: str) -> None:
    out = case.parent / "out"
    words = "cyclic case*.toml -o out --no-figures --json"
    done = subprocess.run(
        ["bash", "-c", f"set -o pipefail; {' '.join(COMMAND)} {words} {how}"],
        cwd=case.parent,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert sorted(content(out)) == FILES
