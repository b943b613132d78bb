"""`thermobearing study`: planned, carried out, looked at, from the command line."""

import json
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from typer.testing import CliRunner

import thermobearing as tb
from thermobearing.cli import app
from thermobearing.earthquake.motions import CUT
from thermobearing.motions.library import load_motion

FILE = """
kind = "study"
name = "small"
[case]
duration = "2 s"
[factors]
bearing = ["shen-hdr-bridge", "shen-bilinear-bridge"]
motion = "jra-ii-i-1"
scale = [0.5, 1.0]
ambient = ["-20 degC", "23 degC"]
"""


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("study")
    (folder / "small.toml").write_text(FILE)
    words = ["study", str(folder / "small.toml"), "-o", str(folder / "out"), "--jobs", "1"]
    result = CliRunner().invoke(app, [*words, "-q"])
    assert result.exit_code == 0, result.output
    return folder


def last(words: list[str]) -> dict[str, object]:
    result = CliRunner().invoke(app, [*words, "--json"])
    line = dict(json.loads(result.stdout.strip().splitlines()[-1]))
    assert line["exit_status"] == result.exit_code
    return line


def test_a_study_again_does_nothing(done: Path) -> None:
    files = {path: path.read_bytes() for path in (done / "out" / "shards").iterdir()}
    reported = last(["study", str(done / "small.toml"), "-o", str(done / "out"), "--jobs", "1"])
    assert (reported["outcome"], reported["runs"], reported["done"]) == ("completed", 8, 8)
    assert "seconds" not in reported  # nothing was computed
    assert {path: path.read_bytes() for path in files} == files


def test_resuming_is_said_and_needs_a_study(done: Path) -> None:
    words = ["study", str(done / "small.toml"), "--jobs", "1", "--resume", "-o"]
    there = CliRunner().invoke(app, [*words, str(done / "out")])
    assert there.exit_code == 0
    assert "8 of 8 runs" in there.stderr
    nowhere = CliRunner().invoke(app, [*words, str(done / "nowhere")])
    assert nowhere.exit_code == 2
    assert "nowhere" in nowhere.stderr
    with pytest.raises(tb.InputError, match="nowhere"):  # in Python too
        tb.study(done / "small.toml", done / "nowhere", jobs=1, resume=True)
    with pytest.raises(tb.InputError, match="resume"):
        tb.study(done / "small.toml", resume=True)
    assert tb.study(done / "small.toml", done / "out", jobs=1, resume=True).runs == 8
    assert not (done / "nowhere").exists()


def test_a_start_reports_time_and_memory(done: Path) -> None:
    study = ["study", str(done / "small.toml"), "-o", str(done / "timed"), "--jobs", "1"]
    result = last(study)
    assert result["computed_runs"] == 8
    assert 0.0 < float(str(result["seconds"])) < 600.0
    assert 10.0 < float(str(result["peak_memory_MB"])) < 10_000.0


def test_a_dry_run_writes_nothing(done: Path) -> None:
    before = sorted(done.iterdir())
    reported = last(["study", str(done / "small.toml"), "--dry-run", "--jobs", "3"])
    assert (reported["outcome"], reported["runs"], reported["jobs"]) == ("dry_run", 8, 3)
    assert reported["seconds"] == pytest.approx(8 / 3 * float(str(reported["seconds_a_run"])))
    assert 8 * 30 * 8 < int(float(str(reported["bytes"]))) < 8 * 100 * 8
    assert sorted(done.iterdir()) == before


def test_a_dry_run_says_why_trial_runs_failed(tmp_path: Path) -> None:
    """A motion of 60 times its size leaves what the model can follow."""
    table = FILE.replace("[0.5, 1.0]", "[0.5, 60.0]").replace("2 s", "6 s")
    (tmp_path / "large.toml").write_text(table)
    study = ["study", str(tmp_path / "large.toml"), "--dry-run", "--jobs", "1"]
    failures: Any = last(study)["failures"]
    shown = CliRunner().invoke(app, study).stdout
    assert failures
    for failure in failures:
        assert failure["outcome"] != "completed"
        assert f"{failure['outcome']}: {failure['sentence']}" in " ".join(shown.split())


def test_a_study_notes_that_one_component_of_a_pair_acts(tmp_path: Path) -> None:
    """The note of `bridge`, before and after the runs; a study of records has none."""
    pair = '{ name = "jra-ii-i-1", across = "jra-ii-i-2" }'
    table = FILE.replace('motion = "jra-ii-i-1"', f'motion = ["jra-i-i-1", {pair}]')
    study = [str(tmp_path / "pairs.toml"), "--jobs", "1"]
    (tmp_path / "pairs.toml").write_text(table.replace("2 s", "0.2 s"))
    note, _ = last(["study", *study, "--dry-run", "-q"])["notes"]
    assert "1 of 2 motions" in note
    output = CliRunner().invoke(app, ["study", *study, "--dry-run"]).stdout
    assert note in " ".join(output.split())
    assert last(["study", *study, "-o", str(tmp_path / "out"), "-q"])["exit_status"] == 0
    assert note in tb.load_result(tmp_path / "out").warnings
    motions: list[Any] = ["jra-i-i-1", {"name": "jra-ii-i-1", "across": "jra-ii-i-2"}]
    bridge = tb.bridge("shen-bilinear-bridge", motions, ambient=23, duration=0.2)
    assert note in bridge.warnings


def test_a_duration_that_cuts_motions_is_a_warning(tmp_path: Path) -> None:
    """Before and after the runs; a duration beyond all motions is none."""
    study = [str(tmp_path / "cut.toml"), "--jobs", "1"]
    (tmp_path / "cut.toml").write_text(FILE.replace("2 s", "0.2 s"))
    (note,) = last(["study", *study, "--dry-run", "-q"])["notes"]
    length = load_motion("jra-ii-i-1").duration
    assert f"jra-ii-i-1 (0.2 of {length:g} s)" in note
    shown = CliRunner().invoke(app, ["study", *study, "-o", str(tmp_path / "out")])
    assert note in " ".join(shown.stderr.split())
    warnings = tb.load_result(tmp_path / "out").warnings
    assert [text for text in warnings if getattr(text, "code", "") == CUT] == [note]
    bridge = tb.bridge("shen-bilinear-bridge", "jra-ii-i-1", ambient=23, duration=0.2)
    (cut,) = [text for text in bridge.warnings if getattr(text, "code", "") == CUT]
    assert note.startswith(cut)
    (tmp_path / "cut.toml").write_text(FILE.replace("2 s", f"{length + 1.0} s"))
    assert last(["study", *study, "--dry-run", "-q"])["notes"] == []


def test_status_and_table(done: Path) -> None:
    assert last(["study", "status", str(done / "out")])["outcome"] == "completed"
    for name in ("runs.csv", "runs.xlsx"):
        assert last(["study", "table", str(done / "out"), "-o", str(done / name)])["runs"] == 8
    text = pd.read_csv(done / "runs.csv")
    book = pd.read_excel(done / "runs.xlsx")
    pd.testing.assert_frame_equal(text, book, check_dtype=False)
    assert text["ambient_degC"].tolist() == [-20.0, 23.0] * 4
    words = ["study", "table", str(done / "out"), "-o"]
    for name, reported in (("runs.csv", "--overwrite"), ("runs.ods", ".csv or .xlsx")):
        result = CliRunner().invoke(app, [*words, str(done / name)])
        assert result.exit_code == 2
        assert reported in result.stderr


def test_what_is_no_study_is_reported(done: Path) -> None:
    result = CliRunner().invoke(app, ["study", str(done / "none.toml")])
    assert (result.exit_code, "no such file" in result.stderr) == (2, True)
    result = CliRunner().invoke(app, ["study", "status", str(done)])
    assert result.exit_code == 2
    with pytest.raises(tb.InputError, match="need a directory"):
        tb.study(done / "small.toml", jobs=2)
    with pytest.raises(tb.InputError, match="must be a file"):
        tb.study(3)  # type: ignore[arg-type]
