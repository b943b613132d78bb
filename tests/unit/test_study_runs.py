"""Runs of a study: shards, restarts, failures, lockstep, bearings as warm as their weather."""

import json
import pickle
import re
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
import xarray as xr
from numpy.testing import assert_allclose, assert_array_equal

import thermobearing as tb
import thermobearing.studies.run.prepare as warmth
import thermobearing.studies.run.shard as peaks
import thermobearing.studies.store as stores
from tests import tolerances as tol
from tests.quick import quick_cases
from tests.unit.studies import kept, small_study
from thermobearing.border.errors import InputError, OutputError
from thermobearing.climate.generator import generate_weather
from thermobearing.core.lanes.memory import WIDTH
from thermobearing.earthquake.measures import COLUMNS
from thermobearing.studies.definition import designs, record
from thermobearing.studies.definition.case import load_study, make_study
from thermobearing.studies.definition.designs import Plan
from thermobearing.studies.definition.record import Study
from thermobearing.studies.result import study_result
from thermobearing.studies.run.engine import (
    Pace,
    _only_writer,
    run_study,
    say_duration,
    study_status,
)
from thermobearing.studies.run.prepare import Preparer
from thermobearing.studies.run.shard import COUNTS, RESULT_COLUMNS, TEXTS, packed, run_shard
from thermobearing.studies.statistics.demand import worst_runs
from thermobearing.studies.store import (
    FEWEST,
    MOST,
    Store,
    _parquet_bytes,
    _read_labels,
    _read_notes,
    _shard_size,
)
from thermobearing.studies.tables import count_failures

ROUNDING = {"structure_residual", "mechanical_residual", "thermal_residual"}
PIER_HEIGHT = 10e3  # of pier P1 above its footing [mm]


def test_numbers_are_those_of_an_earthquake_analysis() -> None:
    """Every column that `bridge` has too, to the last bit, and its energy balance."""
    study = small_study({"duration": "3 s"}, bearing=["shen-lhdr-bridge", "shen-bilinear-bridge"])
    result = run_shard(Plan(study), Plan(study).runs)
    result = result[result["scale"] == 1.0].reset_index(drop=True)
    names = ["shen-lhdr-bridge", "shen-bilinear-bridge"]
    whole = tb.bridge(names, "jra-ii-i-1", [23.0, -20.0], duration=3.0, keep=tb.Keep(every=1))
    assert result["bearing"].tolist() == whole.table["bearing"].tolist()
    for name in COLUMNS:
        assert_array_equal(result[name], whole.table[name], err_msg=name)
    for name in ("structure_residual", "mechanical_residual", "thermal_residual"):
        assert_array_equal(result[name], whole.energy[name], err_msg=name)
    assert_array_equal(result["damping_of_input"], whole.table["damping_of_input"])
    # Cycles need a history, which runs in lockstep do not have.
    outside = [text.replace(" cycles", "") for text in whole.table["beyond_tested"]]
    assert result["beyond_tested"].tolist() == outside
    assert any("strain_rate" in text for text in outside)
    hottest = [whole.hottest(run) for run in range(whole.runs)]
    for place in ("rubber", "lead"):
        expected = np.array([one[place] for one in hottest], dtype=np.float32)
        assert_array_equal(result[f"{place}_max_degC"].astype(np.float32), expected)
    moved = whole["bearing_displacement"].values[:, -1]
    assert_array_equal(result["bearing_displacement_residual_mm"].astype(np.float32), moved)
    height = result["pier_displacement_max_mm"] / result["pier_drift_max"]
    np.testing.assert_allclose(height, PIER_HEIGHT, rtol=tol.BOUND_ROUNDING)


def test_every_column_says_what_it_is(tmp_path: Path) -> None:
    study = small_study(**{"bearing.K_r": {"distribution": "uniform", "low": 0.9, "high": 1.1}})
    study = study.model_copy(update={"design": study.design.model_copy(update={"samples": 1})})
    run_study(study, tmp_path / "out", jobs=1)
    reported = _read_labels(tmp_path / "out" / "shards" / "00000.parquet")
    assert all(meaning for _, meaning in reported.values())
    assert reported["bearing_force_max_kN"] == ("kN", "largest force of one bearing")
    assert reported["bearing.K_r"] == ("1", "factor of bearing.K_r")
    assert reported["ambient_degC"][0] == "degC"
    assert tuple(reported)[-len(RESULT_COLUMNS) :] == RESULT_COLUMNS


def test_a_second_start_does_what_is_missing_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study, out = small_study(keep="all"), tmp_path / "out"
    output: list[tuple[int, int]] = []
    done = run_study(study, out, jobs=1, size=3, progress=lambda *two: output.append(two))
    assert output == [(0, 8), (3, 8), (6, 8), (8, 8)]
    assert (done.outcome, done.done, done.shards_done) == ("completed", 8, 3)
    before = kept(out)
    run, calls = peaks.run_task, []
    monkeypatch.setattr(peaks, "run_task", lambda task: calls.append(task) or run(task))
    run_study(study, out, jobs=1)
    assert not calls
    (out / "shards" / "00001.parquet").write_bytes(before["shards/00000.parquet"])
    (out / "shards" / "00002.parquet").write_bytes(before["shards/00002.parquet"][:-100])
    assert study_status(out).outcome == "incomplete"
    assert run_study(study, out, jobs=1).outcome == "completed"
    assert len(calls) == 5
    assert kept(out) == before


def test_table_is_the_plan_with_results_whatever_the_shards(
    tmp_path: Path, small_done: Path
) -> None:
    study = small_study()
    run_study(study, tmp_path / "large", jobs=1)
    one, other = Store(small_done).table(), Store(tmp_path / "large").table()
    pd.testing.assert_frame_equal(one, other)
    runs = Plan(study).runs
    for name in runs:
        assert one[name].tolist() == runs[name].tolist()
    assert Store(small_done).table(["run", "outcome"]).shape == (8, 2)
    # As others read it, without this package.
    assert_array_equal(pd.read_parquet(tmp_path / "large" / "shards")["run"], np.arange(8))


CHANGED: list[tuple[dict[str, Any], str]] = [
    ({"scale": [0.5, 1.5]}, "factors.scale.levels = [0.5, 1.5], was [0.5, 1.0]"),
    ({"case": {"dt": "2 ms"}}, "case.analysis.dt = '0.002 s', was '0.005 s'"),
    ({"motion": [{"name": "jra-ii-i-1", "label": "Kobe"}]}, "label = 'Kobe', was 'jra-ii-i-1'"),
    ({"keep": "all"}, "keep.histories = 'all', was 'none'"),
]


@pytest.mark.parametrize(("changes", "words"), CHANGED)
def test_a_changed_study_is_refused(
    small_done: Path, small_files: dict[str, bytes], changes: dict[str, Any], words: str
) -> None:
    case = {"analysis": changes["case"]} if "case" in changes else None
    others = {key: value for key, value in changes.items() if key != "case"}
    with pytest.raises(InputError) as caught:
        run_study(small_study(case, **others), small_done, jobs=1)
    assert words in str(caught.value)
    assert kept(small_done) == small_files


def test_a_changed_file_is_refused(tmp_path: Path) -> None:
    record = tmp_path / "record.csv"
    table = {"motion": [{"name": str(record), "unit": "gal", "dt": "0.01 s"}]}
    for factor in (300.0, 301.0):
        values = factor * np.sin(np.arange(100))
        record.write_text("\n".join(f"{value:.6f}" for value in values))
        if factor == 300.0:
            run_study(small_study(**table), tmp_path / "out", jobs=1)
    with pytest.raises(InputError, match=r"\(motion, bearing, weather\)"):
        run_study(small_study(**table), tmp_path / "out", jobs=1)


def test_an_edited_study_is_refused(small_done: Path) -> None:
    """Its results are those of the text before: reading and repeating name the key."""
    path = small_done / "study.toml"
    before = path.read_text()
    name = 'name = "edited"'
    path.write_text(re.sub("^name = .*$", name, before, count=1, flags=re.MULTILINE))
    assert path.read_text() != before
    for read in (study_result, lambda folder: stores.Store(folder).study()):
        with pytest.raises(InputError, match=r"study\.toml: was edited .* name = 'edited', was "):
            read(small_done)
    path.write_text(before)
    assert stores.Store(small_done).study().to_toml() == before


def test_another_version_is_refused(small_done: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stores, "kernels_digest", lambda: "other")
    with pytest.raises(InputError, match=r"kernels .* now other"):
        run_study(small_study(), small_done, jobs=1)


def test_directories_of_others_are_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(OutputError, match=r"contains thesis\.tex"):
        run_study(small_study(), tmp_path, jobs=1)
    with pytest.raises(InputError, match=r"manifest\.json"):
        study_status(tmp_path)
    whole = {"kind": "study", "format": 1, "runs": 8, "_shard_size": 0, "versions": {}, "input": ""}
    unnamed = whole | {"shard_size": 8, "versions": {"numpy": "2"}}
    for content in ({"kind": "study"}, whole, unnamed):
        (tmp_path / "manifest.json").write_text(json.dumps(content))
        with pytest.raises(InputError, match="damaged"):
            study_status(tmp_path)
    assert sorted(kept(tmp_path)) == ["manifest.json", "thesis.tex"]


def test_failed_runs_are_reported_with_their_reason(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One that tears its bearing, one that cannot be prepared, one that breaks this program."""
    study = small_study({"duration": "8 s"}, bearing=["shen-hdr-bridge"], scale=[1.0, 50.0])
    prepared, run = Preparer.make_task, peaks.run_task

    def prepare(self: Preparer, row: Any) -> Any:
        if row["run"] == 1:
            raise InputError("K_r must be positive", "bearing")
        return prepared(self, row)

    def broken(task: Any) -> Any:
        if task.ambient == 23.0 and np.abs(task.shaking.ground).max() > 1e5:
            raise ZeroDivisionError("float division")
        return run(task)

    monkeypatch.setattr(Preparer, "make_task", prepare)
    monkeypatch.setattr(peaks, "run_task", broken)
    done = run_study(study, tmp_path / "out", jobs=1)
    assert (done.outcome, done.done, done.failed) == ("some_failed", 4, 3)
    reported = done.failures.set_index("outcome")
    assert reported.loc["bad_input", "sentence"] == "bearing: K_r must be positive"
    assert reported.loc["broken", "sentence"].endswith("ZeroDivisionError: float division")
    (third,) = set(reported.index) - {"bad_input", "broken"}
    assert "Try" in reported.loc[third, "sentence"] or "try" in reported.loc[third, "sentence"]
    assert reported[["runs", "share"]].values.tolist() == [[1, 0.25]] * 3
    table = Store(tmp_path / "out").table()
    assert table["outcome"].tolist() == ["completed", "bad_input", "broken", third]
    assert np.isnan(table["bearing_force_max_kN"][1])


def test_the_most_frequent_failure_comes_first() -> None:
    outcomes = ["diverged", "completed", "not_converged", "not_converged"]
    runs = pd.DataFrame({"run": range(4), "outcome": outcomes, "sentence": "Try."})
    result = count_failures(runs)
    assert result["outcome"].tolist() == ["not_converged", "diverged"]
    assert result["first"].tolist() == [2, 0]


def test_a_program_that_always_breaks_is_no_result(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(_: Any) -> None:
        raise TypeError("no such thing")

    monkeypatch.setattr(peaks, "run_task", broken)
    with pytest.raises(OutputError, match="TypeError: no such thing"):
        run_study(small_study(), tmp_path / "out", jobs=1)
    assert study_status(tmp_path / "out").done == 0


def test_histories_are_kept_where_they_are_asked_for(tmp_path: Path) -> None:
    study = small_study(keep="all")
    run_study(study, tmp_path / "all", jobs=1, size=4)
    files = sorted((tmp_path / "all" / "histories").iterdir())
    assert [file.name for file in files] == ["00000.nc", "00001.nc"]
    table = Store(tmp_path / "all").table()
    peaks_kept = []
    for file in files:
        with xr.open_dataset(file, engine="netcdf4") as data:
            assert data["bearing_force"].attrs["units"] == "kN"
            peaks_kept += np.abs(data["pier_displacement"]).max("step").values.tolist()
            assert data["id"].values.tolist() == table["id"][data["run"].values].tolist()
    assert np.all(np.array(peaks_kept) <= table["pier_displacement_max_mm"] * (1 + 1e-6))
    assert np.all(np.array(peaks_kept) > 0.9 * table["pier_displacement_max_mm"])
    worst = small_study(keep="worst 3")
    run_study(worst, tmp_path / "worst", jobs=1, size=2, shard="2/2")
    assert not (tmp_path / "worst" / "histories").exists()  # nobody knows yet which
    run_study(worst, tmp_path / "worst", jobs=1)
    with xr.open_dataset(tmp_path / "worst" / "histories" / "worst.nc", engine="netcdf4") as data:
        ranked = table.sort_values("pier_ductility", ascending=False)["run"].tolist()
        assert data["run"].values.tolist() == sorted(ranked[:3]) != ranked[:3]
    assert worst_runs(table, 2) == ranked[:2]
    failed = table.assign(
        outcome=["diverged" if run == ranked[0] else "completed" for run in table["run"]]
    )
    assert worst_runs(failed, 2) == ranked[1:3]


def test_two_writers(tmp_path: Path, small_files: dict[str, bytes]) -> None:
    run_study(small_study(), tmp_path / "out", jobs=1, shard="1/3", size=1)
    result = Store(tmp_path / "out").table()
    assert result["run"].tolist() == [0, 3, 6]
    with _only_writer(tmp_path / "out"), pytest.raises(OutputError, match="another process"):
        run_study(small_study(), tmp_path / "out", jobs=1)
    with _only_writer(tmp_path / "out", "2-of-3"):
        for part in (None, "2/3"):
            with pytest.raises(OutputError, match="another process is writing this study"):
                run_study(small_study(), tmp_path / "out", jobs=1, shard=part)
        run_study(small_study(), tmp_path / "out", jobs=1, shard="3/3")
    assert run_study(small_study(), tmp_path / "out", jobs=1, shard="2/3").outcome == "completed"
    assert kept(tmp_path / "out") == small_files


def test_a_directory_that_another_part_has_made_meanwhile_is_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = stores.write_directory

    def quicker(*given: Any) -> None:
        made(*given)
        raise OutputError("exists")

    monkeypatch.setattr(stores, "write_directory", quicker)
    assert run_study(small_study(), tmp_path / "out", jobs=1).outcome == "completed"


def test_a_part_counts_and_clears_away_its_own(tmp_path: Path) -> None:
    out, output = tmp_path / "out", []
    run_study(small_study(), out, jobs=1, shard="2/2", size=4)
    left = [out / "shards" / f".0000{shard}.parquet-ab" for shard in range(2)]
    for path in left:
        path.touch()
    run_study(small_study(), out, jobs=1, shard="1/2", progress=lambda *two: output.append(two))
    assert output == [(0, 4), (4, 4)]
    assert [path.exists() for path in left] == [False, True]


def test_a_part_that_cannot_be_marked_as_taken_is_reported(tmp_path: Path) -> None:
    (tmp_path / ".part-1-of-3").symlink_to(tmp_path / "nowhere" / "file")
    with pytest.raises(OutputError, match="cannot be written"), _only_writer(tmp_path, "1-of-3"):
        pass


@pytest.mark.parametrize(
    "words",
    [
        {"executor": "mpi"},
        {"jobs": 0},
        {"size": 0},
        {"address": "tcp://x:1"},
        {"executor": "dask"},
        {"shard": "3"},
        {"shard": "4/3"},
    ],
)
def test_bad_arguments_are_named(tmp_path: Path, words: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=next(iter(words))):
        run_study(small_study(), tmp_path / "out", **words)


def test_without_pyarrow_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
    with pytest.raises(InputError, match=r'needs pyarrow: pip install "thermobearing\[study\]"'):
        run_study(small_study(), tmp_path / "out", jobs=1)
    assert not (tmp_path / "out").exists()


def test_equal_tables_make_equal_files(tmp_path: Path) -> None:
    table = pd.DataFrame({"x": [1.0, np.nan], "n": [1, 2], "name": pd.Categorical(["a", "b"])})
    for name in ("one", "two"):
        content = _parquet_bytes(table, {"x": ("mm", "way")}, {"k": 1})
        (tmp_path / name).write_bytes(content)
    assert (tmp_path / "one").read_bytes() == (tmp_path / "two").read_bytes()
    assert _read_notes(tmp_path / "one") == ({"k": 1}, 2)
    assert _read_notes(tmp_path / "none") is None
    assert pq.read_table(tmp_path / "one").column("x").null_count == 1  # NaN would spoil means
    assert_array_equal(pd.read_parquet(tmp_path / "one")["x"], table["x"])


def test_pace_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr("thermobearing.studies.run.engine.time.monotonic", lambda: now[0])
    pace = Pace(20, 100)
    assert str(pace) == "20 of 100 runs"
    pace.done, now[0] = 60, 110.0
    assert str(pace) == "60 of 100 runs, 4 per second, 10 s left"
    assert [say_duration(s) for s in (59.4, 61, 3660)] == ["59 s", "1 min 1 s", "1 h 1 min"]


def test_sizes_of_shards() -> None:
    assert [_shard_size(runs) for runs in (1, 1600, 1601, 50_000, 10**6)] == [16, 16, 32, 512, 1008]
    assert [_shard_size(runs, lockstep=True) for runs in (1, 5000, 10**6)] == [16, 208, 1008]
    assert FEWEST % WIDTH == MOST % WIDTH == 0  # whole companies


def test_a_log_that_cannot_be_written_stops_nothing(tmp_path: Path) -> None:
    run_study(small_study(), tmp_path / "out", jobs=1, shard="1/2", size=4)
    (tmp_path / "out" / "study.log").unlink()
    (tmp_path / "out" / "study.log").mkdir()
    assert run_study(small_study(), tmp_path / "out", jobs=1).outcome == "completed"


@pytest.mark.thorough
def test_a_study_is_planned_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls: Counter[str] = Counter()

    def count(name: str) -> None:
        function = getattr(designs, name)

        def counted(*words: Any) -> Any:
            calls[name] += 1
            return function(*words)

        monkeypatch.setattr(designs, name, counted)

    study = small_study({"duration": "1 s"}, **{"bearing.K_r": {"of": "factor", "levels": [1, 2]}})
    steps = ("find_target", "_list_columns", "_picked", "_with_ids")
    for name in steps:
        count(name)
    run_study(study, tmp_path / "study", jobs=1)
    assert calls == dict.fromkeys(steps, 1)


def test_runs_in_lockstep_are_those_of_runs_alone_and_nobody_elses() -> None:
    """All columns but those of rounding itself; in any company, to the last bit."""
    temperatures = ["-30 degC", "23 degC"]
    study = small_study({"duration": "4 s"}, bearing=["shen-lhdr-bridge"], ambient=temperatures)
    side = study.design.model_copy(update={"lockstep": True})
    study = study.model_copy(update={"design": side})
    alone = study.model_copy(update={"design": side.model_copy(update={"lockstep": False})})
    rows = Plan(study).runs
    together, one_by_one = run_shard(Plan(study), rows), run_shard(Plan(alone), rows)
    for column in RESULT_COLUMNS:
        if column in ROUNDING:
            off = together[column] - one_by_one[column]
            assert (off.abs() < tol.STRUCTURE_BALANCE).all(), column
        elif column == "layer_force_mismatch_max_kN":
            force = one_by_one["bearing_force_max_kN"]
            off = together[column] - one_by_one[column]
            assert (off.abs() <= tol.LANE_PEAK * force).all()
        elif column not in (*TEXTS, *COUNTS):
            given = one_by_one[column]
            assert_allclose(together[column], given, rtol=tol.LANE_PEAK, err_msg=column)
        else:
            assert_array_equal(together[column], one_by_one[column])
    # Lead that is colder than that of the tests, and rubber that is strained less.
    assert together["beyond_tested"].str.contains("ambient lead_temperature").any()
    backwards = run_shard(Plan(study), rows.iloc[[3, 1]])
    for name in together:
        assert_array_equal(backwards[name], together[name].iloc[[3, 1]], err_msg=name)


@pytest.mark.thorough
def test_outcomes_in_lockstep_are_those_of_runs_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """A bearing that tears, one without lead; nothing is run alone that does not need it."""
    study = small_study({"duration": "4 s"}, bearing=["shen-hdr-bridge"], scale=[0.5, 80.0])
    side = study.design.model_copy(update={"lockstep": True})
    alone = run_shard(Plan(study), Plan(study).runs)
    monkeypatch.setattr(peaks, "run_task", None)
    together = run_shard(Plan(study.model_copy(update={"design": side})), Plan(study).runs)
    assert alone["outcome"].tolist() == ["completed"] * 2 + ["not_physical"] * 2
    assert together["outcome"].tolist() == alone["outcome"].tolist()
    assert together["lead_max_degC"].isna().all()
    assert together["rubber_max_degC"].notna().all()


BEARINGS = ["shen-hdr-bridge", "shen-lhdr-bridge", "shen-bilinear-bridge"]
TENTH = {"distribution": "uniform", "low": 0.9, "high": 1.1}
FEW = {"kind": "latin-hypercube", "samples": 3, "paired": False}
KINDS: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "all weather before": ({}, {}),
    "a history": ({"history": "2 d"}, {}),
    "own heat": ({"history": "2 d"}, {"bearing.materials.rubber.conductivity": TENTH}),
    "another stiffness": ({}, {"bearing.K_r": TENTH}),
}


@pytest.fixture
def town(tmp_path: Path) -> Path:
    weather = generate_weather("cold-town", 1, 2)
    rows = [f"{k},{air:.17g}" for k, air in enumerate(weather.temperature[5000:5336])]
    file = tmp_path / "town.csv"
    file.write_text("\n".join(["time_h,temperature_degC", *rows]))
    return file


def weathered(town: Path, kind: str = "all weather before") -> Study:
    ambient, others = KINDS[kind]
    factors = {"bearing": BEARINGS, "motion": "jra-ii-i-1"} | others
    factors["ambient"] = {"weather": str(town)} | ambient
    table = {"kind": "study", "name": "warm", "case": {"duration": "0.05 s"}, "design": FEW}
    return make_study(table | {"factors": factors}, "study.toml")


@pytest.mark.parametrize("kind", quick_cases(KINDS, 3))
def test_what_was_foreseen_is_what_a_run_finds_alone(kind: str, town: Path) -> None:
    study = weathered(town, kind)
    runs = Plan(study).runs
    alone, first, worker = (Preparer(Plan(study)) for _ in range(3))
    first.compute_temperatures(runs)
    warm = first.select_temperatures(runs.iloc[2:8])
    worker.use_temperatures(pickle.loads(pickle.dumps(warm)))
    for row in runs.iloc[1:8].to_dict("records"):  # the first is foreseen by nobody
        one, other, third = (prep.make_task(row).reported for prep in (alone, first, worker))
        assert_array_equal(one.temperature, other.temperature)
        assert_array_equal(one.temperature, third.temperature)
        assert one.lead == other.lead == third.lead


@pytest.mark.parametrize("kind", quick_cases(KINDS, 0))
def test_weather_is_read_and_gone_through_once(
    kind: str, town: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    read, through = record.read_weather, []
    counted: list[str] = []
    monkeypatch.setattr(record, "read_weather", lambda path: counted.append(path) or read(path))
    for name in ("soaked_hours", "history_weights"):
        call = getattr(warmth, name)
        monkeypatch.setattr(
            warmth, name, lambda *words, call=call: through.append(call) or call(*words)
        )
    run_study(weathered(town, kind), tmp_path / "out", jobs=1, size=2)
    assert counted == [str(town)]
    assert len(through) == (0 if kind == "own heat" else 2)  # bearings with heat
    table = Store(tmp_path / "out").table()
    assert set(table["outcome"]) == {"completed"}
    # A second start that has nothing to do goes through nothing.
    counted.clear()
    through.clear()
    run_study(weathered(town, kind), tmp_path / "out", jobs=1)
    assert (len(counted), len(through)) == (1, 0)


@pytest.mark.thorough
def test_workers_need_no_weather(town: Path, tmp_path: Path) -> None:
    """Neither its file nor its hours are sent; the bits are those of one process."""
    studies = [weathered(town) for _ in range(2)]
    (tmp_path / "study.toml").write_text(studies[0].to_toml())
    assert load_study(tmp_path / "study.toml").factors.ambient._series is not None
    town.unlink()
    run_study(studies[0], tmp_path / "one", jobs=1, size=2)
    run_study(studies[1], tmp_path / "two", jobs=2, size=2)
    assert kept(tmp_path / "one") == kept(tmp_path / "two")
    assert set(Store(tmp_path / "two").table()["outcome"]) == {"completed"}
    assert pickle.loads(packed(Plan(studies[0])))[0].study.factors.ambient._series is None
    assert studies[0].factors.ambient._series is not None


def test_a_shard_is_sent_its_own_hours(town: Path) -> None:
    study = weathered(town)
    runs = Plan(study).runs
    preparer = Preparer(Plan(study))
    preparer.compute_temperatures(runs)
    warm = preparer.select_temperatures(runs.iloc[:4])
    assert warm is not None
    assert warm.weather is None
    hours = [hours.tolist() for hours, _ in warm.soaked.values()]
    assert hours == [sorted(runs["hour"][:3]), [runs["hour"][3]]]
    plain = make_study(
        {
            "kind": "study",
            "name": "plain",
            "factors": {"bearing": BEARINGS[:1], "motion": "jra-ii-i-1", "ambient": "0 degC"},
        },
        "study.toml",
    )
    assert Preparer(Plan(plain)).select_temperatures(Plan(plain).runs) is None


@pytest.mark.thorough
def test_lines_with_a_bearing_of_their_own_are_foreseen(
    town: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A separate line has heat in every run, also where the bearing of the study has none."""
    structure = Path(__file__).parents[1] / "regression" / "inputs" / "two-piers.toml"
    case = {"duration": "0.05 s", "lines": [{"line": "on A", "bearing": "lrb-example"}]}
    factors = {"bearing": BEARINGS[1:], "motion": "jra-ii-i-1", "structure": str(structure)}
    table = {"case": case, "design": FEW, "factors": factors | {"ambient": {"weather": str(town)}}}
    study = make_study({"kind": "study", "name": "two"} | table, "study.toml")
    runs = Plan(study).runs
    alone, first = Preparer(Plan(study)), Preparer(Plan(study))
    first.compute_temperatures(runs)
    expected = [alone.make_task(row).lines for row in runs.to_dict("records")]
    monkeypatch.setattr(warmth, "soaked_hours", divmod)  # nothing is left to be found
    for row, lines in zip(runs.to_dict("records"), expected, strict=True):
        for one, other in zip(first.make_task(row).lines, lines, strict=True):
            assert_array_equal(one.temperature, other.temperature)
            assert one.lead == other.lead
