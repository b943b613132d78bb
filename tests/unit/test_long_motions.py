"""Motions of hours: read in C where their rows are alike, in Python where not, refused at once."""

import time
from pathlib import Path

import numpy as np
import pytest

import thermobearing.motions.readers as readers
from tests.unit import motion_files as files
from tests.unit.inputs import assert_mentions
from thermobearing.border.errors import InputError
from thermobearing.motions.record import MOST_SAMPLES, GroundMotion

ROWS = 1500
SECONDS = 10.0  # of the processor for the longest motion
WAVE = files.shaking(count=ROWS)
TIMES = [f"{0.01 * k:.2f}" for k in range(ROWS)]
SEPARATORS = {",": ",", ";": "; ", "\t": "\t", " ": "   "}


def table(separator: str, header: str = "time [s]{0}acceleration [gal]") -> list[str]:
    rows = [f"{at}{separator}{value:.6e}" for at, value in zip(TIMES, WAVE, strict=True)]
    return [header.format(separator), *rows]


def both_ways(path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[GroundMotion, GroundMotion]:
    """Return the motion as it is read, and as it is read in Python alone."""
    quick = readers.read_motion(path)
    with monkeypatch.context() as patch:
        patch.setattr(readers, "_even_columns", lambda lines: None)
        slow = readers.read_motion(path)
    return quick, slow


@pytest.mark.parametrize(
    "separator", SEPARATORS.values(), ids=["comma", "semicolon", "tab", "blank"]
)
def test_rows_read_in_c_are_those_read_in_python(
    separator: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = files.write(tmp_path / "a.csv", "\n".join([*table(separator), ""]))
    assert readers._even_columns(path.read_text().splitlines()) is not None
    quick, slow = both_ways(path, monkeypatch)
    assert np.array_equal(quick.acceleration, slow.acceleration)
    assert quick.dt == slow.dt


@pytest.mark.parametrize(
    ("old", "new"), [("e+01", "D+01"), ("e+01", "e+01 "), (",", ",  "), ("14.99,", "\n14.99,")]
)
def test_what_only_python_reads(
    old: str, new: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = "\n".join(table(","))
    assert old in text
    quick, slow = both_ways(files.write(tmp_path / "a.csv", text.replace(old, new)), monkeypatch)
    assert np.array_equal(quick.acceleration, slow.acceleration)


@pytest.mark.parametrize("cell", ["x", "nan", "", "1_0", "1e999", "0x10"])
def test_a_wrong_cell_in_the_last_row_is_named(cell: str, tmp_path: Path) -> None:
    text = "\n".join([*table(",")[:-1], f"{TIMES[-1]},{cell}"])
    with pytest.raises(InputError) as caught:
        readers.read_motion(files.write(tmp_path / "a.csv", text))
    assert_mentions(str(caught.value), [f"line {ROWS + 1}"])


@pytest.mark.thorough
def test_the_longest_motion_takes_seconds(tmp_path: Path) -> None:
    """The rows of an hour at 500 Hz."""
    path = tmp_path / "a.csv"
    times = 0.002 * np.arange(MOST_SAMPLES)
    columns = np.column_stack([times, 3000.0 * np.sin(times)])
    np.savetxt(path, columns, "%.3f", ",", header="time [s],acceleration [mm/s2]", comments="")
    begin = time.process_time()
    motion = readers.read_motion(path)
    assert time.process_time() - begin < SECONDS
    assert len(motion.acceleration) == MOST_SAMPLES
    assert motion.dt == pytest.approx(0.002)


def test_ten_hours_are_refused_before_they_are_read(tmp_path: Path) -> None:
    """10 h at 100 Hz are 3.6e6 rows."""
    path = files.write(tmp_path / "a.csv", "time [s],acceleration [mm/s2]\n" + "0,1\n" * 3_600_000)
    begin = time.process_time()
    with pytest.raises(InputError) as caught:
        readers.read_motion(path)
    assert time.process_time() - begin < SECONDS
    assert_mentions(str(caught.value), ["3600001", str(MOST_SAMPLES)])
