"""A validation: nothing is fitted, every ratio is what it says, verdicts follow the limits."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import thermobearing as tb
from tests.unit.inputs import command
from thermobearing.identify.fit.forward import ForwardModel, Prediction
from thermobearing.identify.records.cycles import compare_largest_loops, compare_loops
from thermobearing.identify.records.record import TestRecord
from thermobearing.validate.result import BEYOND, TOLD, WITHIN, Validation
from thermobearing.validate.run import rise_errors

HDR, LHDR = "shen-hdr-specimen", "shen-lhdr-specimen"
TEST = tb.cyclic_test(strain=[1.0, 2.0], cycles=2, rest=None)


@pytest.fixture(scope="module")
def record() -> TestRecord:
    """The test of a bearing 20 % stiffer than the library's, with a thermocouple."""
    stiffer = tb.load_bearing(HDR)
    hysteresis = stiffer.hysteresis.model_copy(update={"layer_stiffness": 1.2 * 30.738})
    stiffer = stiffer.model_copy(update={"hysteresis": hysteresis})
    made = tb.synthetic_record(stiffer, 0.0, TEST, noise=0.0, sampling=100.0)
    bare = replace(made, places={"T3_degC": "rubber 3"}, name="stiffer")
    found = ForwardModel(bare, stiffer, fine=True).run(stiffer)
    assert found is not None
    return replace(bare, temperatures=found.temperatures)


@pytest.fixture(scope="module")
def found(record: TestRecord) -> Validation:
    return tb.validate_bearing(HDR, record, limits={"energy": 0.3, "temperature": 0.1})


def test_the_bearing_stays_as_it_is(found: Validation) -> None:
    """A stiffer test warms more and softens a little: 0.8 of the force, nearly."""
    (item,) = found.comparisons
    assert [loop.cycle for loop in item.loops] == [1, 2, 4, 5]  # the third stops the motion
    for loop in item.loops:
        assert loop.ratios["K_eq"] == pytest.approx(1.0 / 1.2, rel=0.03)
        assert loop.ratios["h_eq"] == pytest.approx(1.0, rel=0.03)
        assert loop.ratios["energy"] == pytest.approx(
            loop.ratios["K_eq"] * loop.ratios["h_eq"], rel=1e-9
        )
    assert 0.7 < item.R2 < 0.99
    errors = item.errors
    assert errors["K_eq"] == pytest.approx(
        max((loop.ratios["K_eq"] - 1.0 for loop in item.loops), key=abs)
    )
    assert errors["temperature"] < -0.1


def test_verdicts_follow_the_limits(found: Validation) -> None:
    (row,) = found.table.to_dict("records")
    assert row["K_eq_verdict"] == BEYOND  # 17 % against 15 %
    assert row["h_eq_verdict"] == WITHIN
    assert row["energy_verdict"] == WITHIN  # 30 % were given
    assert row["temperature_verdict"] == BEYOND
    assert row["force_verdict"] == row["NRMSE_verdict"] == TOLD
    assert found.verdict == BEYOND
    looser = replace(found, limits={"K_eq": 0.2})
    assert looser.verdict == WITHIN


def sines(sizes: tuple[float, ...]) -> TestRecord:
    """A cycle of each size after the other, with a force that is ahead by 0.3 rad."""
    t = np.linspace(0.0, len(sizes), 2000 * len(sizes) + 1)
    size = np.array(sizes)[np.minimum(t.astype(int), len(sizes) - 1)]
    x = size * np.sin(2.0 * np.pi * t)
    force = 2.0 * size * np.sin(2.0 * np.pi * t + 0.3)
    return tb.record_from_arrays(t, x, force, 23.0)


def test_measures_of_loops_whose_answer_is_known() -> None:
    record = sines((10.0, 40.0, 40.0, 20.0))
    force = np.where(record.force > 0.0, 1.5, 0.5) * record.force
    loops = compare_loops(record, force)
    assert [loop.number for loop in loops] == [1, 1, 2, 1]
    top = compare_largest_loops(record, force, loops)
    assert top is loops[1]  # the first of equals
    assert top.displacement_max == pytest.approx(40.0)
    assert top.displacement_min == pytest.approx(-40.0)
    assert top.test["F+"] == pytest.approx(80.0, rel=0.01)
    assert top.test["K_eq"] == pytest.approx(2.0, rel=0.01)
    assert top.test["energy"] == pytest.approx(np.pi * 40.0 * 80.0 * np.sin(0.3), rel=2e-3)
    assert top.test["h_eq"] == pytest.approx(0.5 * np.sin(0.3), rel=0.01)
    assert top.ratios["F+"] == pytest.approx(1.5)
    assert top.ratios["F-"] == pytest.approx(0.5)
    assert top.ratios["K_eq"] == pytest.approx(1.0)
    assert compare_largest_loops(sines((0.0,)), force, []) is None


def test_the_largest_loop_may_be_no_full_cycle() -> None:
    """The farthest excursion to one side and the one after it, which belong to two cycles."""
    record = sines((10.0, 40.0, 60.0))
    half = len(record.time) // 3 * 3 // 2  # in the middle of the second cycle
    x = np.where(np.arange(len(record.time)) < half, 0.5, 1.0) * record.displacement
    force = np.where(np.arange(len(record.time)) < half, 0.5, 1.0) * record.force
    x[4001:], force[4001:] = 0.5 * x[4001:], 0.5 * force[4001:]
    record = replace(record, displacement=x, force=force)  # 5, 20, -40, 30, -30
    loops = compare_loops(record, force)
    top = compare_largest_loops(record, force, loops)
    assert top is not None
    assert (top.first, top.last) == pytest.approx((half, 5000), abs=1)
    assert (top.cycle, top.number) == (0, 0)
    assert top.displacement_min == pytest.approx(-40.0)
    assert top.displacement_max == pytest.approx(30.0)
    assert [loop.cycle for loop in loops] == [1, 2, 3]


def test_rise_errors_in_time() -> None:
    record = sines((10.0,))
    rise = np.linspace(0.0, 10.0, len(record.time))
    record = replace(record, temperatures={"T": 20.0 + rise})
    model = Prediction(record.force, {"T": -5.0 + 1.2 * rise})
    error = rise_errors(record, model)["T"]
    assert error == pytest.approx(0.02 * rise)  # of the largest rise, not of that so far


def test_any_history_will_do(record: TestRecord) -> None:
    """Half a cycle has no loops, which a fit would refuse."""
    half = slice(0, 40)
    short = replace(
        record, time=record.time[half], displacement=record.displacement[half],
        force=record.force[half], temperatures={}, places={}, block=record.block[half],
    )  # fmt: skip
    (item,) = tb.validate_bearing(HDR, short).comparisons
    assert (item.loops, item.largest) == ([], None)
    assert np.isnan(item.errors["K_eq"])
    assert item.R2 > 0.5


def test_bearings_and_models_side_by_side(record: TestRecord) -> None:
    models: Any = ["multi-layer", "lead-alone", "single-temperature", "bilinear"]
    both = tb.validate_bearing([HDR, LHDR], [record], models=models)
    pairs = list(zip(both.table["bearing"], both.table["model"], strict=True))
    assert pairs == [
        *((HDR, model) for model in models if model != "lead-alone"),
        *((LHDR, model) for model in models),
    ]
    assert len(both.plot.loops().axes) == 1
    assert len(both.plot.ratios().axes) == 5


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"limits": {"K_eg": 0.1}}, "K_eg.*K_eq"),
        ({"limits": {"K_eq": 0.0}}, "K_eq = 0.0"),
        ({"limits": {"K_eq": "15 %"}}, "K_eq = '15 %'"),
        ({"models": "adiabatik"}, "adiabatik.*adiabatic"),
        ({"models": []}, "model"),
        ({"bearings": []}, "bearing"),
        ({"models": "lead-alone"}, "needs lead"),
    ],
)
def test_what_cannot_be(record: TestRecord, options: dict[str, Any], said: str) -> None:
    with pytest.raises(tb.InputError, match=said):
        tb.validate_bearing(**{"bearings": HDR, "records": record} | options)


def test_command(tmp_path: Path, record: TestRecord) -> None:
    columns = {"time_s": record.time, "displacement_mm": record.displacement}
    columns |= {"force_kN": record.force, "T3_degC": record.temperatures["T3_degC"]}
    pd.DataFrame(columns).to_csv(tmp_path / "test.csv", index=False)
    (tmp_path / "test.toml").write_text(
        'file = "test.csv"\nambient = "0 degC"\n[thermocouples]\nT3_degC = "rubber 3"\n'
    )
    out = tmp_path / "out"
    words = ["validate", HDR, tmp_path / "test.toml", "--limit", "K_eq=0.3", "-o", out]
    done = command(*words, "--json")
    assert done.exit_code == 0, done.output
    assert "verdict: within" in " ".join(done.output.split())
    told = json.loads((out / "summary.json").read_text())
    assert (told["verdict"], told["limits"]) == ("within", {"K_eq": 0.3, "h_eq": 0.15})
    assert told["comparisons"][0]["largest_loop"]["cycle"] == 4
    assert told["comparisons"][0]["errors"]["temperature"]["verdict"] == "told"
    files = {str(path.relative_to(out)) for path in out.rglob("*.*")}
    drawn = ("loops", "ratios", "cycles", "residuals", "temperatures")
    tables = {"summary.json", "table.csv", "cycles.csv", "fit.csv", "thermocouples.csv"}
    tables |= {"tested_range.csv"}
    assert files == tables | {f"figures/{name}.{k}" for name in drawn for k in ("png", "svg")}
    fit = pd.read_csv(out / "fit.csv")
    assert len(fit) == len(record.time)
    assert fit["force_kN"].to_numpy() == pytest.approx(record.force, rel=1e-5, abs=1e-4)
    assert fit["model_T3_degC"].notna().all()
    bad = command(*words, "--overwrite", "--limit", "K_eq")
    assert bad.exit_code == 2
    assert "QUANTITY=NUMBER" in bad.stderr


def test_a_test_that_is_none_is_refused(tmp_path: Path) -> None:
    t = np.linspace(0.0, 4.0, 400)
    still = tb.record_from_arrays(t, 0.0 * t, np.sin(t), 23.0, name="still")
    with pytest.raises(tb.InputError, match="displacement is constant"):
        tb.validate_bearing(HDR, still)
