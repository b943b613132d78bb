"""Files hold the rows that are worth it; measures, energies and ends are those of all rows."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_array_equal
from pandas.testing import assert_frame_equal

import thermobearing as tb
from thermobearing.cyclic.case import make_case
from thermobearing.cyclic.dataset import POINTS, _rows_to_write, expected_size, written_part
from thermobearing.results.drawing import thin_loops
from thermobearing.results.metrics import find_cycles

STEPS = 1200  # of a cycle of 4 s


def computed(**words: object) -> tb.Result:
    test = tb.cyclic_test(
        strain=[0.5, 1.5], cycles=2, wave="sine", period=4.0, rest=60.0, dt=4.0 / STEPS
    )
    return tb.run("shen-lhdr-specimen", test, ambient=[-20.0, 23.0], **words)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def result() -> tb.Result:
    return computed()


@pytest.fixture(scope="module")
def folder(result: tb.Result, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return result.save(tmp_path_factory.mktemp("thinned") / "out", figures=False)


@pytest.fixture(scope="module")
def loaded(folder: Path) -> tb.Result:
    actual = tb.load_result(folder)
    assert isinstance(actual, tb.Result)
    return actual


def test_rows_are_few_and_hold_what_turns(result: tb.Result) -> None:
    rows = _rows_to_write(result, 0)
    segment, cycle = (result[name].values[0] for name in ("segment", "cycle"))
    for name in ("displacement", "force"):
        values = result[name].values[0]
        for number, count in ((0, 1), (0, 2), (3, 1), (3, 2)):
            inside = (segment == number) & (cycle == count)
            mine = rows[inside[rows]]
            assert inside.sum() == STEPS
            assert POINTS <= len(mine) <= POINTS + 4
            assert values[mine].max() == values[inside].max()
            assert values[mine].min() == values[inside].min()
    assert rows[0] == 0
    assert rows[-1] == len(segment) - 1


def test_what_is_kept_keeps_its_bits(result: tb.Result, loaded: tb.Result) -> None:
    place = np.searchsorted(result.time(0), loaded.time(0))
    assert_array_equal(result.time(0)[place], loaded.time(0))
    for name, values in loaded.dataset.data_vars.items():
        if values.dims[:2] == ("ambient", "time"):
            assert_array_equal(values.values, result[str(name)].values[:, place])
    assert loaded.dataset.sizes["time"] < 0.3 * result.dataset.sizes["time"]


def test_measures_energies_and_summary_are_those_of_all_rows(
    result: tb.Result, loaded: tb.Result
) -> None:
    assert_frame_equal(loaded.cycles, result.cycles, check_exact=True)
    assert_frame_equal(loaded.energy, result.energy, check_exact=True)
    assert loaded.summary() == result.summary()


def test_the_table_in_the_file_is_not_measured_again(loaded: tb.Result) -> None:
    """From 200 points the strength and stiffness through zero would differ: they are stored."""
    without = loaded.dataset.drop_dims("closed_cycle")
    again = tb.Result(without).cycles
    assert len(again) == len(loaded.cycles)
    assert not again["post_yield_stiffness_kN_mm"].equals(
        loaded.cycles["post_yield_stiffness_kN_mm"]
    )
    assert np.allclose(again["G_eq_MPa"], loaded.cycles["G_eq_MPa"], rtol=1e-12)


def test_another_test_goes_on_from_the_same_end(result: tb.Result, folder: Path) -> None:
    further = tb.cyclic_test(strain=[1.0], cycles=1, dt=0.02)
    one, other = (
        tb.run("shen-lhdr-specimen", further, ambient=-20.0, initial=start)
        for start in (result, folder)
    )
    assert_array_equal(one["force"].values, other["force"].values)


def test_history_has_the_same_rows_and_saving_again_takes_none(
    loaded: tb.Result, folder: Path, tmp_path: Path
) -> None:
    table = pd.read_csv(folder / "history.csv")
    assert len(table) == 2 * loaded.dataset.sizes["time"]
    again = loaded.save(tmp_path / "again", figures=False)
    assert (again / "history.csv").read_bytes() == (folder / "history.csv").read_bytes()


def test_complete_histories_on_request(result: tb.Result, tmp_path: Path) -> None:
    whole = computed(keep=tb.Keep(histories="complete"))
    saved = tb.load_result(whole.save(tmp_path / "out", figures=False))
    assert isinstance(saved, tb.Result)
    assert saved.dataset.sizes["time"] == result.dataset.sizes["time"]
    resolved = tb.load_case(tmp_path / "out" / "case.resolved.toml")
    assert resolved.analysis.histories == "complete"


def test_runs_with_clocks_of_their_own() -> None:
    """A rest that ends when the bearing is cool lasts differently in each run."""
    steps = [
        {"step": "cycles", "strain": 1.0, "period": "2 s", "count": 1},
        {"step": "rest", "within": "0.2 K"},
        {"step": "cycles", "strain": 0.5, "period": "2 s", "count": 1},
    ]
    table = {"ambient": ["-20 degC", "23 degC"], "test": {"dt": "4 ms", "steps": steps}}
    result = tb.run_case(make_case(table, "test"))
    assert "clock" in result.dataset
    short = written_part(result)
    assert_frame_equal(short.cycles, result.cycles, check_exact=True)
    assert_frame_equal(short.energy, result.energy, check_exact=True)
    for run in range(2):
        rows = _rows_to_write(result, run)
        assert_array_equal(short.time(run)[: len(rows)], result.time(run)[rows])
        assert (short["segment"].values[run, len(rows) :] == -1).all()


def test_recorded_history_is_thinned_by_its_cycles(tmp_path: Path) -> None:
    time = np.arange(0.0, 8.0, 0.004)
    x = 40.0 * np.sin(np.pi * time / 2.0)
    lines = "".join(f"{t:.4f},{d:.9f}\n" for t, d in zip(time, x, strict=True))
    (tmp_path / "record.csv").write_text("time_s,displacement_mm\n" + lines)
    step = {"step": "recorded", "file": str(tmp_path / "record.csv")}
    table = {"ambient": "23 degC", "test": {"dt": "4 ms", "steps": [step]}}
    result = tb.run_case(make_case(table, "test"))
    cycles = len(find_cycles(result["displacement"].values[0]))
    short = written_part(result)
    assert 1 <= cycles <= 2
    assert short.dataset.sizes["time"] < (cycles + 2) * (POINTS + 5) < len(time)
    assert_frame_equal(short.cycles, result.cycles, check_exact=True)


def test_the_size_is_known_before(folder: Path, result: tb.Result) -> None:
    case = tb.load_case(folder / "case.resolved.toml")
    written = sum((folder / name).stat().st_size for name in ("result.nc", "history.csv"))
    assert 0.8 * written < expected_size(case) < 6.0 * written
    whole = case.model_copy(
        update={"analysis": case.analysis.model_copy(update={"histories": "complete"})}
    )
    assert expected_size(whole) > result.dataset.nbytes


def test_thinned_loops_keep_their_corners() -> None:
    x = 1.0 - np.abs(np.linspace(-1.0, 1.0, 101))
    kept = thin_loops(x, x, 1.0, 1.0, most=5)
    assert len(kept) < 10
    assert x[kept].max() == 1.0
    corners = np.arange(0, 601, 100)
    sizes = np.array([0.0, 1.0, -2.0, 3.0, -4.0, 5.0, 0.0])  # of growing cycles
    growing = np.interp(np.arange(601), corners, sizes)
    kept = thin_loops(growing, growing, 10.0, 10.0, most=20)
    assert len(kept) < 40
    assert set(corners.tolist()) <= set(kept.tolist())
