"""A result directory is complete or absent; a damaged result is refused before it is read."""

import errno
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from textwrap import dedent
from typing import Any

import numpy as np
import pytest
import xarray as xr

import thermobearing as tb
import thermobearing.cyclic.history
import thermobearing.results.directory
from tests import tolerances as tol
from tests.quick import quick_cases
from tests.unit import inputs


@pytest.fixture
def case(tmp_path: Path) -> Path:
    return inputs.quick_case(tmp_path / "case.toml")


def test_existing_result_is_replaced_on_request_only(case: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    inputs.cyclic(case, "-o", out, "-q")
    before = inputs.content(tmp_path)
    done = inputs.cyclic(case, "-o", out, "--ambient", 5, "--json")
    assert done.exit_code == inputs.last_line(done)["exit_status"] == 2
    assert "--overwrite" in done.stderr
    assert inputs.content(tmp_path) == before
    (tmp_path / "link").symlink_to(out)
    for target in (out, tmp_path / "link"):
        assert inputs.cyclic(case, "-o", target, "-q", "--overwrite", "--ambient", 5).exit_code == 0
        assert inputs.summary(out)["runs"][0]["ambient_degC"] == 5.0
        assert sorted(inputs.content(out)) == inputs.FILES
    assert (tmp_path / "link").is_symlink()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["case.toml", "link", "out"]


def test_parents_are_made_and_an_empty_directory_is_used(case: Path, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    for out in (tmp_path / "empty", tmp_path / "a" / "b" / "out"):
        assert inputs.cyclic(case, "-o", out, "-q").exit_code == 0
        assert sorted(inputs.content(out)) == inputs.FILES


@pytest.mark.parametrize("name", ["notes.txt", "summary.json"])
def test_force_refuses_what_is_not_only_a_result(case: Path, tmp_path: Path, name: str) -> None:
    """A folder with other files, with or without a summary.json among them, is never deleted."""
    out = tmp_path / "out"
    out.mkdir()
    (out / name).write_text("{}")
    (out / "thesis.tex").write_text("years of work")
    before = inputs.content(tmp_path)
    done = inputs.cyclic(case, "-o", out, "--overwrite", "--json")
    assert done.exit_code == 2
    assert "not a result directory" in inputs.last_line(done)["message"]
    assert "thesis.tex" in inputs.last_line(done)["message"]
    assert inputs.content(tmp_path) == before


@pytest.mark.parametrize(
    ("target", "words"),
    [
        ("case.toml", "is a file"),
        ("case.toml/below/it", "case.toml is a file"),
        ("x" * 300, "cannot be used"),
        (".", "current directory"),
        ("..", "current directory"),
        ("/proc/none/out", "cannot be written"),
    ],
)
def test_unusable_target(
    case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, target: str, words: str
) -> None:
    monkeypatch.chdir(tmp_path)
    before = inputs.content(tmp_path)
    done = inputs.cyclic(case, "-o", target, "--overwrite", "--json")
    assert done.exit_code == 2
    assert words in inputs.last_line(done)["message"]
    assert inputs.last_line(done)["outcome"] == "not_written"
    assert done.stderr == f"thermobearing: {inputs.last_line(done)['message']}\n"
    assert inputs.content(tmp_path) == before


def test_unusable_target_is_reported_before_the_run(
    case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(thermobearing.cyclic.history, "march", lambda *_: pytest.fail("it was run"))
    assert inputs.cyclic(case, "-o", case).exit_code == 2


FULL = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def stop_while_writing(monkeypatch: pytest.MonkeyPatch, how: BaseException) -> None:
    """Raise in the middle of the writing: other files are there, netCDF is half written."""

    def half(_: xr.Dataset, path: Path, **__: Any) -> None:
        assert (path.parent / "history.csv").stat().st_size > 0
        path.write_bytes(b"half")
        raise how

    monkeypatch.setattr(xr.Dataset, "to_netcdf", half)


@pytest.mark.parametrize(
    ("how", "status", "words"),
    quick_cases(
        [
            (FULL, 2, os.strerror(errno.ENOSPC)),
            (RuntimeError("NetCDF: HDF error"), 2, "HDF error"),  # as netCDF tells it
            (KeyboardInterrupt(), 130, "nothing was written"),
        ],
        0,
    ),
    ids=["full disk", "full disk, as netCDF tells it", "Ctrl-C"],
)
def test_writing_stopped_halfway_leaves_nothing(
    case: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    how: BaseException,
    status: int,
    words: str,
) -> None:
    inputs.cyclic(case, "-o", tmp_path / "old", "-q")
    before = inputs.content(tmp_path)
    stop_while_writing(monkeypatch, how)
    for target, force in (("deep/new", []), ("old", ["--overwrite"])):
        done = inputs.cyclic(case, "-o", tmp_path / target, "--json", *force)
        assert done.exit_code == status
        assert words in inputs.last_line(done)["message"]
        assert inputs.last_line(done)["exit_status"] == status
        assert inputs.content(tmp_path) == before
        assert sorted(path.name for path in tmp_path.iterdir()) == ["case.toml", "old"]


@pytest.mark.parametrize(
    "stop", quick_cases([1, 2], 0), ids=["before the old one is moved", "before the new one"]
)
def test_interrupted_swap_brings_the_earlier_result_back(
    case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, stop: int
) -> None:
    inputs.cyclic(case, "-o", tmp_path / "out", "-q")
    before = inputs.content(tmp_path)
    monkeypatch.setattr(thermobearing.results.directory, "_exchange", lambda *_: False)
    rename, calls = Path.rename, []

    def interrupted(path: Path, target: Path) -> Path:
        calls.append(path)
        if len(calls) == stop:
            raise KeyboardInterrupt
        return rename(path, target)

    monkeypatch.setattr(Path, "rename", interrupted)
    assert inputs.cyclic(case, "-o", tmp_path / "out", "--overwrite").exit_code == 130
    assert inputs.content(tmp_path) == before


@pytest.mark.thorough
def test_really_full_disk(case: Path, tmp_path: Path) -> None:
    """No monkeypatch: the system refuses files of more than 60 kB, and the netCDF is larger.

    Only after it was seen that compiled code can be kept, or all would be compiled anew.
    """
    pytest.importorskip("resource")  # not on Windows
    program = """
        import resource
        from thermobearing.cli import main
        from thermobearing.core.compiled.sources import cache_directory
        cache_directory()
        resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, 60_000))
        main()
    """
    words = ["cyclic", str(case), "--no-figures", "--json"]
    assert inputs.cyclic(case, "-o", tmp_path / "first", *words[2:]).exit_code == 0  # compiles
    shutil.rmtree(tmp_path / "first")
    done = subprocess.run(
        [sys.executable, "-c", dedent(program), *words, "-o", str(tmp_path / "out")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2, done.stderr
    assert json.loads(done.stdout.splitlines()[-1])["outcome"] == "not_written"
    assert [path.name for path in tmp_path.iterdir()] == ["case.toml"]


def interrupt(monkeypatch: pytest.MonkeyPatch, call: int, chunk: int) -> None:
    """Press Ctrl-C in one of the calls of compiled code, each of so many steps."""
    march, calls = thermobearing.cyclic.history.march, []

    def interrupted(*args: Any) -> Any:
        calls.append(args)
        if len(calls) == call:
            raise KeyboardInterrupt
        return march(*args)

    monkeypatch.setattr(thermobearing.cyclic.history, "CHUNK", chunk)
    monkeypatch.setattr(thermobearing.cyclic.history, "march", interrupted)


def test_ctrl_c_during_a_run_keeps_what_was_computed(
    case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    interrupt(monkeypatch, 4, 50)
    out = tmp_path / "out"
    done = inputs.cyclic(case, "--ambient", 0, "--ambient", 23, "-o", out, "--json")
    assert done.exit_code == 130
    assert inputs.last_line(done)["outcome"] == inputs.summary(out)["outcome"] == "interrupted"
    assert inputs.last_line(done)["files"] == inputs.WITHOUT_CYCLES
    (run,) = inputs.summary(out)["runs"]  # the second temperature was not begun
    assert run["outcome"] == "interrupted"
    assert run["energy"]["work_in_kN_mm"] > 0.0
    assert len((out / "history.csv").read_text().splitlines()) == 1 + 1 + 150
    assert tb.load_result(out).outcome == "interrupted"


def test_energies_of_a_partial_result_balance_whatever_is_kept(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The run stops between two kept rows; the final profile and the last row must agree."""
    interrupt(monkeypatch, 4, 47)
    test = tb.cyclic_test(strain=[1.0], dt=0.01)
    result = tb.run("shen-hdr-specimen", test, keep=tb.Keep(every=20))
    assert result.outcome == "interrupted"
    assert int(result["steps"][0]) == 3 * 47
    assert float(result["time"][-1]) == pytest.approx(3 * 0.47)
    residuals = result.energy[["thermal_residual", "mechanical_residual"]]
    assert residuals.abs().max(axis=None) < tol.ENERGY_BALANCE


def test_ctrl_c_before_the_first_step(
    case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    interrupt(monkeypatch, 1, 50)
    assert inputs.cyclic(case, "-o", tmp_path / "out").exit_code == 130
    assert inputs.summary(tmp_path / "out")["outcome"] == "interrupted"
    assert inputs.summary(tmp_path / "out")["runs"][0]["cycles"] == []


INTERRUPTS_ITSELF = """
import signal
import thermobearing.cyclic.history as drive
march, calls = drive.march, []
def marching(*args):
    calls.append(args)
    if len(calls) == 4:
        signal.raise_signal(signal.SIGINT)
    return march(*args)
drive.march, drive.CHUNK = marching, 50
signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background ignores it
from thermobearing.cli import main
main()
"""


@pytest.mark.thorough
def test_real_interrupt_signal(case: Path, tmp_path: Path) -> None:
    """SIGINT to a real process in the middle of a run, always at the same step."""
    out = tmp_path / "out"
    words = ["cyclic", str(case), "-o", str(out), "--no-figures", "--json"]
    line = [sys.executable, "-c", INTERRUPTS_ITSELF, *words]
    done = subprocess.run(line, capture_output=True, text=True, check=False)
    assert done.returncode == 130, done.stderr
    assert json.loads(done.stdout.splitlines()[-1])["outcome"] == "interrupted"
    result = inputs.summary(out)
    assert result["outcome"] == "interrupted"
    assert result["runs"][0]["series_sharing"]["steps"] == 3 * 50
    # The first cycle is not closed yet.
    assert sorted(inputs.content(out)) == inputs.WITHOUT_CYCLES
    assert sorted(path.name for path in tmp_path.iterdir()) == ["case.toml", "out"]


def test_early_end_is_marked(tmp_path: Path) -> None:
    """Steps far longer than the yield displacement, on which explicit Euler runs away."""
    table = inputs.changed_table(
        inputs.specimen_table(), {"hysteresis.yield_displacement": "0.1 mm"}
    )
    inputs.write_toml(tmp_path / "stiff.toml", table)
    path = inputs.quick_case(tmp_path / "case.toml", bearing="stiff.toml")
    out = tmp_path / "out"
    done = inputs.cyclic(path, "--model-option", "integrator=euler", "--dt", 1, "-o", out, "--json")
    assert done.exit_code == 3
    assert "euler_unstable" in done.stderr
    assert "smaller dt" in done.stderr
    assert inputs.last_line(done) == {
        "outcome": "euler_unstable",
        "exit_status": 3,
        "output": str(out),
        "files": inputs.WITHOUT_CYCLES,
    }
    result = inputs.summary(out)
    assert result["outcome"] == result["runs"][0]["outcome"] == "euler_unstable"
    assert result["runs"][0]["outcome_sentence"] in done.stderr
    assert np.isfinite(tb.load_result(out)["force"]).all()
    assert inputs.cyclic(path, "--dt", 1, "-o", tmp_path / "exact", "-q").exit_code == 0


LINE = {"name": "b", "body": "deck", "count": 1, "equivalent_stiffness": "2 kN/mm"}
SMALL = {
    "name": "one mass",
    "bodies": [{"name": "deck", "moves": True}],
    "masses": [{"body": "deck", "height": "0 mm", "mass": "0.1 kN s^2/mm"}],
    "bearings": [LINE],
    "report": {"deck": "deck", "pier": "deck", "pier_top": "0 mm"},
}


@pytest.mark.parametrize(
    ("study", "options"),
    quick_cases(
        [
            (
                tb.bridge,
                {"bearing": ["shen-lhdr-bridge", "shen-bilinear-bridge"], "ambient": [0, 23]},
            ),
            (tb.bridge, {"bearing": "shen-hdr-bridge", "structure": SMALL}),  # a single period
            (tb.hybrid, {"bearing": "shen-hdr-specimen"}),
        ],
        1,
    ),
    ids=["bridge", "one coordinate", "hybrid"],
)
def test_a_study_is_read_back(study: Any, options: dict[str, Any], tmp_path: Path) -> None:
    saved = study(motion="jra-ii-i-1", duration=1, **{"ambient": -20, **options})
    saved.save(tmp_path / "out", figures=False)
    for path in (tmp_path / "out", tmp_path / "out" / "result.nc"):
        result = tb.load_result(path)
        assert isinstance(result, tb.EarthquakeResult)
        assert result.outcome == saved.outcome
        assert json.dumps(result.summary()) == json.dumps(saved.summary())
        assert result.history(0).equals(saved.history(0))
    again = result.save(tmp_path / "again", figures=False)
    one, other = inputs.content(tmp_path / "out"), inputs.content(again)
    same = [name for name in one if name != "result.nc"]  # its dates differ
    assert [one[name] for name in same] == [other[name] for name in same]


def test_what_has_no_histories_says_so(case: Path, tmp_path: Path) -> None:
    """A fit is read as a bearing; a study of another bearing gives no start for a test."""
    (tmp_path / "fit").mkdir()
    (tmp_path / "fit" / "bearing.toml").write_text("")
    with pytest.raises(tb.InputError, match=r"contains no result\.nc; .*load_bearing"):
        tb.load_result(tmp_path / "fit")
    study = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", 0, duration=1)
    study.save(tmp_path / "study", figures=False)
    with pytest.raises(tb.InputError, match=r'initial_result: is a test of "shen-hdr-bridge"'):
        tb.load_case(case, initial_result=str(tmp_path / "study"))


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    test = tb.cyclic_test(strain=[0.5], cycles=1, dt=0.05)
    out = tmp_path_factory.mktemp("saved") / "out"
    return tb.run("shen-hdr-specimen", test, ambient=-20).save(out, figures=False)


def flipped(raw: bytes) -> bytes:
    return bytes([*raw[:2000], raw[2000] ^ 1, *raw[2001:]])


def again(raw: bytes) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        before, after = Path(folder) / "before.nc", Path(folder) / "after.nc"
        before.write_bytes(raw)
        xr.load_dataset(before).drop_vars("force").to_netcdf(after)
        return after.read_bytes()


@pytest.mark.parametrize(
    ("damage", "piece"),
    [
        (flipped, "does not match its digest"),
        (lambda raw: raw[:-1], "is truncated"),
        (lambda raw: raw[: len(raw) // 2], "is truncated"),
        (lambda raw: raw[:1000] + raw[1001:], "does not match its digest"),
        (lambda raw: b"", "is not a result file"),
        (lambda raw: b"no netCDF", "is not a result file"),
        (again, "another program"),
    ],
    ids=["bit", "last byte", "half", "byte lost", "empty", "text", "rewritten"],
)
def test_damaged_result_is_reported_before_it_is_read(
    damage: Callable[[bytes], bytes], piece: str, saved: Path, tmp_path: Path
) -> None:
    result = tmp_path / "out"
    result.mkdir()
    (result / "result.nc").write_bytes(damage((saved / "result.nc").read_bytes()))
    inputs.assert_refused(lambda: tb.load_result(result), str(result / "result.nc"), piece)
    case = inputs.quick_case(tmp_path / "case.toml", initial_result="out")
    inputs.assert_refused(lambda: tb.load_case(case), "initial_result", piece)
    done = inputs.command("cyclic", case, "-o", tmp_path / "new", "-q")
    assert done.exit_code == 2
    assert not (tmp_path / "new").exists()


def test_undamaged_result_starts_another(saved: Path, tmp_path: Path) -> None:
    case = inputs.quick_case(
        tmp_path / "case.toml", initial_result=os.path.relpath(saved, tmp_path)
    )
    assert (
        inputs.command("cyclic", case, "-o", tmp_path / "new", "-q", "--no-figures").exit_code == 0
    )
    assert tb.load_result(tmp_path / "new" / "result.nc").outcome == "completed"


def test_damaged_resolved_case_is_reported(saved: Path, tmp_path: Path) -> None:
    text = inputs.content(saved)["case.resolved.toml"]
    for damaged in (text[:-40], b"", text.replace(b"[test]", b"[tset]"), text[::-1]):
        path = tmp_path / "case.toml"
        path.write_bytes(damaged)
        done = inputs.command(
            "cyclic", path, "-o", tmp_path / "new", "-q", "--no-figures", "--overwrite"
        )
        assert done.exit_code in (0, 2)  # an empty case is the default one
        assert (done.exit_code == 0) == (damaged == b"")
