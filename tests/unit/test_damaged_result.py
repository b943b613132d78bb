"""A result that was cut off or changed is told before anything reads it."""

import os
import tempfile
from collections.abc import Callable
from pathlib import Path

import pytest
import xarray as xr

import thermobearing as tb
from tests.unit.inputs import command, content, quick_case, told


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    test = tb.cyclic_test(strain=[0.5], cycles=1, dt=0.05)
    out = tmp_path_factory.mktemp("saved") / "out"
    return tb.run("shen-hdr-specimen", test, ambient=-20).save(out, figures=False)


def flipped(raw: bytes) -> bytes:
    return bytes([*raw[:2000], raw[2000] ^ 1, *raw[2001:]])


def again(raw: bytes) -> bytes:
    """The same numbers, as another program would save them."""
    with tempfile.TemporaryDirectory() as folder:
        before, after = Path(folder) / "before.nc", Path(folder) / "after.nc"
        before.write_bytes(raw)
        xr.load_dataset(before).drop_vars("force").to_netcdf(after)
        return after.read_bytes()


@pytest.mark.parametrize(
    ("damage", "piece"),
    [
        (flipped, "was changed after it was written"),
        (lambda raw: raw[:-1], "its end is missing"),
        (lambda raw: raw[: len(raw) // 2], "its end is missing"),
        (lambda raw: raw[:1000] + raw[1001:], "was changed after it was written"),
        (lambda raw: b"", "is not a result file"),
        (lambda raw: b"no netCDF", "is not a result file"),
        (again, "another program"),
    ],
    ids=["bit", "last byte", "half", "byte lost", "empty", "text", "rewritten"],
)
def test_damaged_result_is_told_before_it_is_read(
    damage: Callable[[bytes], bytes], piece: str, saved: Path, tmp_path: Path
) -> None:
    result = tmp_path / "out"
    result.mkdir()
    (result / "result.nc").write_bytes(damage((saved / "result.nc").read_bytes()))
    told(lambda: tb.load_result(result), str(result / "result.nc"), piece)
    case = quick_case(tmp_path / "case.toml", initial_result="out")
    told(lambda: tb.load_case(case), "initial_result", piece)
    done = command("cyclic", case, "-o", tmp_path / "new", "-q")
    assert done.exit_code == 2
    assert not (tmp_path / "new").exists()


def test_undamaged_result_starts_another(saved: Path, tmp_path: Path) -> None:
    case = quick_case(tmp_path / "case.toml", initial_result=os.path.relpath(saved, tmp_path))
    assert command("cyclic", case, "-o", tmp_path / "new", "-q", "--no-figures").exit_code == 0
    assert tb.load_result(tmp_path / "new" / "result.nc").outcome == "completed"


def test_damaged_resolved_case_is_told(saved: Path, tmp_path: Path) -> None:
    text = content(saved)["case.resolved.toml"]
    for damaged in (text[:-40], b"", text.replace(b"[test]", b"[tset]"), text[::-1]):
        path = tmp_path / "case.toml"
        path.write_bytes(damaged)
        done = command("cyclic", path, "-o", tmp_path / "new", "-q", "--no-figures", "--overwrite")
        assert done.exit_code in (0, 2)  # an empty case is the default one
        assert (done.exit_code == 0) == (damaged == b"")
