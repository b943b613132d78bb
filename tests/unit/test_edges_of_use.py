"""Ten thousand cycles, narrow terminals, clocks that jump, damaged libraries of the kernels."""

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from itertools import count
from pathlib import Path

import numpy as np
import pytest

import thermobearing as tb
from tests import tolerances as tol
from tests.unit import inputs
from tests.unit.studies import kept, small_study
from thermobearing.core.compiled import native
from thermobearing.studies.run.engine import run_study

CYCLES = 10_000
NARROW = 40  # letters of a terminal


@pytest.mark.thorough
def test_ten_thousand_cycles() -> None:
    """The energy balance closes after all of them, and the rubber reaches a steady temperature."""
    cycles = {"step": "cycles", "strain": 0.5, "wave": "sine", "period": 2.0, "count": CYCLES}
    test = tb.CyclicTest(dt=0.05, steps=[cycles])
    result = tb.run("shen-hdr-specimen", test, ambient=-20.0, keep=["rubber"])
    assert result.outcome == "completed"
    assert len(result.cycles) == CYCLES
    assert float(result.energy["thermal_residual"].abs().max()) <= tol.ENERGY_BALANCE
    energy = result.cycles["energy_kN_mm"].to_numpy()
    assert np.isfinite(energy).all()
    assert abs(energy[-1] / energy[-1000] - 1.0) < 1e-6


TABLES = [
    ["cyclic", "--bearing", "shen-hdr-specimen", "--ambient", "-20", "--strain", "0.5"],
    ["lambda", "shen-hdr-bridge", "--reference-temperature", "23", "--temperature", "-20"],
]


@pytest.mark.parametrize("words", TABLES, ids=lambda words: words[0])
def test_tables_on_a_terminal_of_40_columns(
    words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Columns without room are below, after the first ones once more."""
    monkeypatch.setenv("COLUMNS", str(NARROW))
    monkeypatch.chdir(tmp_path)
    done = inputs.command(*words, "-o", "out", "--no-figures")
    assert done.exit_code == 0, done.output
    tables = [line for line in done.stdout.splitlines() if "  " in line.strip()]
    assert tables
    assert max(map(len, tables)) <= NARROW


@pytest.fixture
def _jumping(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the clock of the system jump by a day, forwards and back, whenever it is read."""
    jumps = count()
    monkeypatch.setattr(time, "time", lambda: 1.7e9 + 86400.0 * (-1) ** next(jumps))


@pytest.mark.usefixtures("_jumping")
def test_a_clock_that_jumps_changes_no_study(tmp_path: Path) -> None:
    """Progress, locks and waiting use the monotonic clock; the log alone has the time of day."""
    study = small_study({"duration": "0.1 s"})
    for name in ("first", "second"):
        run_study(study, tmp_path / name, jobs=1)
    assert kept(tmp_path / "first") == kept(tmp_path / "second")


def emptied(file: Path) -> None:
    os.truncate(file, 0)


def one_bit(file: Path) -> None:
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(content)


def without_its_end(file: Path) -> None:
    os.truncate(file, file.stat().st_size - 4096)


DAMAGES = [emptied, one_bit, without_its_end, Path.unlink]
PROGRAM = """
import sys
from pathlib import Path
from thermobearing.core.compiled import native
native.FOLDER = Path(sys.argv.pop(1))
from thermobearing.cli import main
main()
"""


@pytest.mark.thorough
@pytest.mark.parametrize("damage", DAMAGES, ids=lambda damage: damage.__name__)
def test_a_damaged_library_of_this_installation(
    damage: Callable[[Path], None], tmp_path: Path
) -> None:
    """The command states the damage, compiles again, and gives the same numbers."""
    if native.open_library()[0] is None:
        pytest.skip("the kernels of these sources are not built: make kernels")
    folder = shutil.copytree(native.FOLDER, tmp_path / "libraries")
    for file in folder.glob("*.so"):
        damage(file)
    words = ["cyclic", "--bearing", "shen-hdr-specimen", "--ambient", "-20", "--strain", "0.5"]
    words += ["--no-figures"]
    tables = []
    for number, library in enumerate((native.FOLDER, folder)):
        ended = subprocess.run(
            [sys.executable, "-c", PROGRAM, library, *words, "-o", tmp_path / f"out{number}"],
            capture_output=True,
            text=True,
            check=False,
        )
        assert ended.returncode == 0, ended.stderr
        assert ("cannot be used" in ended.stderr) == bool(number)
        tables.append((tmp_path / f"out{number}" / "history.csv").read_bytes())
    assert tables[0] == tables[1]
