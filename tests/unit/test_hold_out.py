"""Tests held out of a fit, bearings validated with tests, thermocouples against the model."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.inputs import command, write_test
from thermobearing.identify.comparison import Comparison
from thermobearing.identify.fit.forward import ForwardModel, Prediction
from thermobearing.identify.records.cycles import (
    compare_loops,
    compute_measures,
    largest_measures,
)
from thermobearing.identify.records.record import TestRecord
from thermobearing.validate.result import BEYOND, REPORTED, WITHIN, CrossValidation, Validation
from thermobearing.validate.run import _split_tests, cross_validate

HDR = "shen-hdr-specimen"
TEST = tb.cyclic_test(strain=[0.5, 1.5], cycles=1, rest=None)
FAULT = 1.3  # of a load cell that reads too much
AMBIENTS = (-20.0, -10.0, 10.0, 23.0)
FIT: dict[str, Any] = {"free": ["K_r", "d_y"], "starts": 1}


def made(ambient: float, name: str, factor: float = 1.0) -> TestRecord:
    record = tb.synthetic_record(HDR, ambient, TEST, noise=0.002, sampling=25.0)
    return replace(record, name=name, force=factor * record.force)


@pytest.fixture(scope="module")
def good() -> list[TestRecord]:
    return [made(at, f"at{at:g}") for at in AMBIENTS]


@pytest.fixture(scope="module")
def faulty() -> TestRecord:
    return made(0.0, "fault", FAULT)


@pytest.fixture(scope="module")
def folded(good: list[TestRecord], faulty: TestRecord) -> CrossValidation:
    return cross_validate([*good, faulty], HDR, folds=5, **FIT)


def test_a_fault_shows_when_its_test_is_held_out(
    good: list[TestRecord], faulty: TestRecord
) -> None:
    result = cross_validate(good[:3], HDR, hold_out=[good[3], faulty], **FIT)
    assert [item.record for item in result.fitted.comparisons] == good[:3]
    assert [item.record for item in result.held_out.comparisons] == [good[3], faulty]
    assert (result.folds, result.spread) == ([], {})
    rows = result.table.set_index("test")
    assert rows["role"].tolist() == ["fitted"] * 3 + ["held out"] * 2
    assert rows["K_eq_verdict"].tolist() == [WITHIN] * 4 + [BEYOND]
    assert rows["K_eq_error"]["fault"] == pytest.approx(1.0 / FAULT - 1.0, abs=0.01)
    assert rows["K_eq_ratio"]["fault"] == pytest.approx(1.0 / FAULT, abs=0.01)
    assert rows["R2"]["at23"] > 0.999
    assert (result.verdict, result.fitted.verdict) == (BEYOND, WITHIN)
    looser = cross_validate(good[:3], HDR, hold_out=faulty, limits={"K_eq": 0.3}, **FIT)
    assert looser.verdict == WITHIN


def test_it_is_the_validation_of_the_fitted_bearing(good: list[TestRecord]) -> None:
    """One judge: the same numbers as `validate` with the bearing of the same fit."""
    result = cross_validate(good[:2], HDR, hold_out=good[2], **FIT)
    fit = tb.identify_bearing(good[:2], HDR, **FIT)
    again = tb.validate_bearing(fit.bearing, good[2])
    assert result.final.values == fit.values
    pd.testing.assert_frame_equal(result.held_out.table, again.table)
    assert result.held_out.limits == again.limits


def test_every_test_is_held_out_once(
    folded: CrossValidation, good: list[TestRecord], faulty: TestRecord
) -> None:
    tests = [*good, faulty]
    assert [record.name for record in folded.final.records] == [record.name for record in tests]
    for fit, group in zip(folded.folds, folded.groups, strict=True):
        names = {record.name for record in fit.records}
        assert len(names) == 4
        assert names | {record.name for record in group} == {record.name for record in tests}
    rows = folded.table[folded.table["role"] == "held out"].set_index("test")
    assert sorted(rows.index) == sorted(record.name for record in tests)
    assert rows["fold"].tolist() == [1, 2, 3, 4, 5]
    # Fitted alone, the good tests meet each other; the fault pulls the others' fits by a quarter
    # of itself, and is within no limit where it is not seen.
    assert rows["K_eq_error"]["fault"] == pytest.approx(1.0 / FAULT - 1.0, abs=0.01)
    assert rows["K_eq_verdict"].to_dict() == {
        record.name: BEYOND if record is faulty else WITHIN for record in tests
    }
    assert folded.verdict == BEYOND


def test_parameters_by_fold(folded: CrossValidation) -> None:
    assert (folded.outcome, folded.sentence) == ("completed", "")
    table = folded.parameters.set_index("fold")
    assert table.index.tolist() == [0, 1, 2, 3, 4, 5]
    assert table["tests"].tolist() == [5, 4, 4, 4, 4, 4]
    held = (item.record for item in folded.held_out.comparisons)
    without_it = folded._find_fold(next(record for record in held if record.name == "fault"))
    assert table["K_r"][without_it] == pytest.approx(30.738, rel=0.01)
    others = table["K_r"].drop([0, without_it])
    assert (others > 31.5).all()
    values = table["K_r"][1:].to_numpy()
    jackknife = np.sqrt(0.8 * ((values - values.mean()) ** 2).sum())
    assert folded.spread["K_r"] == pytest.approx(jackknife)
    assert folded.spread["K_r"] > 4.0 * table["K_r_stderr"][without_it]


def test_groups_have_every_temperature() -> None:
    one = made(-20.0, "one")
    tests = [replace(one, ambient=at, name=f"{at:g}") for at in (23.0, -20.0, 22.0, -19.0)]
    result = cross_validate(tests, HDR, folds=2, free=["K_r"], starts=1, limits={"K_eq": 10.0})
    assert [[r.ambient for r in group] for group in result.groups] == [[-20.0, 22.0], [23.0, -19.0]]
    assert [r.ambient for r in result.folds[0].records] == [23.0, -19.0]


def test_one_test_given_twice_is_one(tmp_path: Path, good: list[TestRecord]) -> None:
    files = [write_test(tmp_path, record) for record in good[:2]]
    held = files[1].with_suffix(".toml")  # the same test by its sidecar
    kept, out = _split_tests([*files, good[2]], [held, files[1]])
    assert [record.name for record in kept] == ["at-20", "at10"]
    assert [record.name for record in out] == ["at-10"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, "hold out"),
        ({"folds": 2, "hold_out": "first"}, "folds"),
        ({"hold_out": "all"}, "none remains"),
        *(({"folds": folds}, "from 2 to the number of tests, 3") for folds in (4, 1, True, 2.0)),
        ({"folds": 2, "limits": {"K_eg": 0.1}}, '"K_eq"'),
        ({"folds": 2, "loss": "cubic"}, "soft_l1"),
        ({"hold_out": "nobody.csv"}, "nobody.csv"),
    ],
)
def test_what_cannot_be(good: list[TestRecord], options: dict[str, Any], message: str) -> None:
    known = {"first": good[:1], "all": good[:3]}
    held = options.get("hold_out", ())
    with pytest.raises(tb.InputError, match=message):
        cross_validate(good[:3], HDR, **options | {"hold_out": known.get(held, held)})


def test_a_test_that_is_none_is_refused_before_the_fit(
    good: list[TestRecord], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("thermobearing.validate.run.run_identify", None)
    still = replace(good[0], name="still", displacement=0.0 * good[0].displacement)
    for options in ({"hold_out": still}, {"folds": 2}):
        records = good[1:3] if "hold_out" in options else [*good[1:3], still]
        with pytest.raises(tb.InputError, match="still: displacement is constant"):
            cross_validate(records, HDR, **options)


def test_a_fold_that_does_not_get_through_says_which(
    good: list[TestRecord], monkeypatch: pytest.MonkeyPatch
) -> None:
    from thermobearing.validate import run

    whole = run.run_identify

    def fails_without_the_first(case: Any) -> Any:
        if case.records[0] is not good[0]:
            raise tb.InputError("the model does not get through")
        return whole(case)

    monkeypatch.setattr(run, "run_identify", fails_without_the_first)
    with pytest.raises(tb.InputError, match="fold 1: the model does not get through"):
        cross_validate(good[:2], HDR, folds=2, **FIT)


def test_figures(folded: CrossValidation, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (panel,) = folded.plot.folds().axes
    assert [tick.get_text() for tick in panel.get_xticklabels()] == ["K_r", "d_y"]
    marked = [text.get_text() for text in panel.texts]
    assert marked == ["1", "2", "3", "4", "5"] * 2
    whole, *values = folded.parameters["K_r"]
    (dots,) = (
        line for line in panel.get_lines() if len(line.get_xdata()) == 5 and line.get_xdata()[0] < 0
    )
    assert dots.get_ydata() == pytest.approx([100.0 * (v / whole - 1.0) for v in values])
    dots = [x for x in folded.judged.plot.ratios().axes[0].get_lines() if x.get_marker() == "o"]
    assert len(dots) == 10  # five tests, seen and not
    drawn: list[str] = []
    monkeypatch.setattr(
        "thermobearing.results.drawing.save_figures",
        lambda figures, _, **how: drawn.extend(figures) or [],
    )
    folded.save(tmp_path / "out")
    of_tests = [f"held_out_{name}" for name in ("ratios", "cycles", "loops", "residuals")]
    of_fit = ["loops", "residuals", "convergence", "correlation", "cycles"]
    assert drawn == [*of_fit, "folds", *of_tests]


def test_command(tmp_path: Path, good: list[TestRecord], faulty: TestRecord) -> None:
    files = [write_test(tmp_path, record) for record in (*good[:2], faulty)]
    fit = ["--free", "K_r,d_y", "--starts", "1"]
    out = tmp_path / "held"
    done = command("identify", *files[:2], "--hold-out", files[2], *fit, "-o", out, "--no-figures")
    assert done.exit_code == 0, done.output
    shown = " ".join(done.output.split())
    assert (
        shown.index("used in the calibration")
        < shown.index("test held out")
        < shown.index("verdict: beyond")
    )
    reported = json.loads((out / "summary.json").read_text())
    assert reported["command"] == "identify"
    assert reported["held_out"]["verdict"] == "beyond"
    assert [test["role"] for test in reported["held_out"]["tests"]] == ["fitted"] * 2 + ["held out"]
    assert len(reported["records"]) == 2
    fitted = {"summary.json", "bearing.toml", "compound.toml", "fit.csv", "inputs.sha256"}
    more = {"table.csv", "cycles.csv", "held_out.csv"}
    assert {path.name for path in out.iterdir()} == fitted | more


@pytest.mark.thorough
def test_command_with_folds(tmp_path: Path, good: list[TestRecord]) -> None:
    files = [write_test(tmp_path, record) for record in good[:2]]
    out = tmp_path / "folds"
    words = ["identify", *files, "--folds", "2", "--free", "K_r", "--starts", "1", "-o", out]
    done = command(*words, "--no-figures", "--limit", "NRMSE=0.000001")
    assert done.exit_code == 0, done.output
    assert "jackknife" in done.output
    table = pd.read_csv(out / "folds.csv")
    assert table["fold"].tolist() == [0, 1, 2]
    reported = json.loads((out / "summary.json").read_text())["held_out"]
    assert reported["verdict"] == "beyond"  # noise alone is more
    assert reported["limits"] == {"K_eq": 0.15, "h_eq": 0.15, "NRMSE": 1e-6}
    assert set(reported["jackknife_stderr"]) == {"K_r"}
    assert table["K_r"].to_numpy() == pytest.approx(
        [row["K_r"] for row in reported["folds"]], rel=1e-6
    )


def test_a_test_is_judged_as_it_is_fitted() -> None:
    steps = tb.cyclic_test(strain=[0.5, 1.0], cycles=2, rest=120.0)
    record = tb.synthetic_record(
        "shen-hdr-specimen", 0.0, steps, noise=0.005, sampling=20.0, through_rests=True, jitter=0.02
    )
    force = record.force + 0.2 * record.peak_force * (np.abs(record.displacement) < 0.2)
    force[len(force) // 3] += 3.0 * record.peak_force
    record = replace(record, force=force, despike=True)
    result = tb.validate_bearing("shen-hdr-specimen", record).comparisons[0]
    assert result.R2 > 0.97
    assert result.NRMSE < 0.05
    held = cross_validate(
        [record, replace(record, name="other")], "shen-hdr-specimen", folds=2, free=["K_r"],
        starts=1,
    )  # fmt: skip
    assert held.table["fold"].tolist() == [0, 0, 1, 2]
    assert held.judged.table["R2"].min() > 0.97
    assert len({id(item.record) for item in held.judged.comparisons}) == 2


LHDR = "shen-lhdr-specimen"
TEST_VALIDATE = tb.cyclic_test(strain=[1.0, 2.0], cycles=2, rest=None)


@pytest.fixture(scope="module")
def record() -> TestRecord:
    """The test of a bearing 20 % stiffer than the library's, with a thermocouple."""
    stiffer = tb.load_bearing(HDR)
    hysteresis = stiffer.hysteresis.model_copy(update={"layer_stiffness": 1.2 * 30.738})
    stiffer = stiffer.model_copy(update={"hysteresis": hysteresis})
    made = tb.synthetic_record(stiffer, 0.0, TEST_VALIDATE, noise=0.0, sampling=100.0)
    bare = replace(made, places={"T3_degC": "rubber 3"}, name="stiffer")
    result = ForwardModel(bare, stiffer, fine=True).run(stiffer)
    assert result is not None
    return replace(bare, temperatures=result.temperatures)


@pytest.fixture(scope="module")
def result(record: TestRecord) -> Validation:
    return tb.validate_bearing(HDR, record, limits={"energy": 0.3, "temperature": 0.1})


def test_the_bearing_stays_as_it_is(result: Validation) -> None:
    """A stiffer test warms more and softens a little: 0.8 of the force, nearly."""
    (item,) = result.comparisons
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


def test_verdicts_follow_the_limits(result: Validation) -> None:
    (row,) = result.table.to_dict("records")
    assert row["K_eq_verdict"] == BEYOND  # 17 % against 15 %
    assert row["h_eq_verdict"] == WITHIN
    assert row["energy_verdict"] == WITHIN  # 30 % were given
    assert row["temperature_verdict"] == BEYOND
    assert row["force_verdict"] == row["NRMSE_verdict"] == REPORTED
    assert result.verdict == BEYOND
    looser = replace(result, limits={"K_eq": 0.2})
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
    loops, top = compare_loops(record, force)
    assert [loop.number for loop in loops] == [1, 1, 2, 1]
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
    assert compare_loops(sines((0.0,)), force) == ([], None)


def test_measures_of_triangular_cycles_are_those_of_measure() -> None:
    """The extremes are at the tips, which a mean over samples cuts off."""
    t = np.append(0.0, np.arange(160) / 40.0 + 0.006)  # no later sample at zero displacement
    x = 40.0 * (2.0 / np.pi) * np.arcsin(np.sin(2.0 * np.pi * t))
    force = 2.0 * x + 30.0 * np.sign(np.cos(2.0 * np.pi * t))
    record = tb.record_from_arrays(t, x, force, 23.0)
    loops, top = compare_loops(record, 1.1 * force)
    measured = compute_measures(record, force, 1e4, 50.0)
    assert len(loops) == len(measured) > 1
    for loop, cycle in zip(loops, measured, strict=True):
        expected = (
            cycle.force_max_kN,
            cycle.force_min_kN,
            cycle.stiffness_kN_mm,
            cycle.h_eq,
            cycle.energy_kN_mm,
        )
        assert_allclose(list(loop.test.values()), expected, rtol=tol.LOOP)
        assert_allclose(list(loop.ratios.values()), [1.1, 1.1, 1.1, 1.0, 1.1], rtol=tol.LOOP)
    assert top is not None
    assert top.test["F+"] == force[top.first : top.last + 1].max()
    predicted = largest_measures(record, force)
    assert (predicted["K_eq"], predicted["energy"]) == (top.test["K_eq"], top.test["energy"])


def test_the_largest_loop_may_be_no_full_cycle() -> None:
    """The farthest excursion to one side and the one after it, which belong to two cycles."""
    record = sines((10.0, 40.0, 60.0))
    half = len(record.time) // 3 * 3 // 2  # in the middle of the second cycle
    x = np.where(np.arange(len(record.time)) < half, 0.5, 1.0) * record.displacement
    force = np.where(np.arange(len(record.time)) < half, 0.5, 1.0) * record.force
    x[4001:], force[4001:] = 0.5 * x[4001:], 0.5 * force[4001:]
    record = replace(record, displacement=x, force=force)  # 5, 20, -40, 30, -30
    loops, top = compare_loops(record, force)
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
    item = Comparison(record, HDR, "multi-layer", 50.0, model)
    assert item.errors["temperature"] == pytest.approx(0.2)  # of the largest rise


def test_any_history_will_do(record: TestRecord) -> None:
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
    ("options", "message"),
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
def test_what_cannot_be_validate(record: TestRecord, options: dict[str, Any], message: str) -> None:
    with pytest.raises(tb.InputError, match=message):
        tb.validate_bearing(**{"bearings": HDR, "records": record} | options)


@pytest.mark.thorough
def test_command_validate(tmp_path: Path, record: TestRecord) -> None:
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
    reported = json.loads((out / "summary.json").read_text())
    assert (reported["verdict"], reported["limits"]) == ("within", {"K_eq": 0.3, "h_eq": 0.15})
    assert reported["comparisons"][0]["largest_loop"]["cycle"] == 4
    assert reported["comparisons"][0]["errors"]["temperature"]["verdict"] == "reported"
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


@pytest.fixture(scope="module")
def record_thermocouples() -> TestRecord:
    """A test whose thermocouple rises by a tenth less than the model, and a column not used."""
    test = tb.cyclic_test(strain=[1.5], cycles=3, rest=None)
    made = tb.synthetic_record(HDR, 0.0, test)
    placed = replace(made, places={"T3, inside": "rubber 2"}, unused=("counter",))
    model = ForwardModel(placed, tb.load_bearing(HDR)).run()
    assert model is not None
    rise = model.temperatures["T3, inside"] - model.temperatures["T3, inside"][0]
    return replace(placed, temperatures={"T3, inside": 0.9 * rise})


@pytest.mark.parametrize("command", ["identify", "validate"])
def test_beside_the_model(
    record_thermocouples: TestRecord,
    command: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    if command == "identify":
        fit = tb.identify_bearing(record_thermocouples, HDR, free=["K_r"], starts=1)
        fit.save(tmp_path / "out", figures=False)
        fit.show()
        listed = fit.summary()["records"][0]
        assert len(fit.plot.temperatures().axes[0].get_lines()) == 2
    else:
        result = tb.validate_bearing(HDR, record_thermocouples)
        result.save(tmp_path / "out", figures=False)
        result.show()
        listed = result.summary()["comparisons"][0]
    assert listed["unused_columns"] == ["counter"]
    (row,) = pd.read_csv(tmp_path / "out" / "thermocouples.csv").to_dict("records")
    assert (row["thermocouple"], row["place"]) == ("T3, inside", "rubber 2")
    assert_allclose(row["rise_error"], 1.0 / 0.9 - 1.0, rtol=tol.FITTED_RISE)
    assert row["start_model_degC"] == pytest.approx(0.0, abs=0.01)
    samples = pd.read_csv(tmp_path / "out" / "fit.csv")
    assert_allclose(
        samples["T3, inside"],
        record_thermocouples.temperatures["T3, inside"],
        rtol=tol.SEVEN_DIGITS,
    )
    assert_allclose(
        samples["model_T3, inside"].max(), row["highest_model_degC"], rtol=tol.SEVEN_DIGITS
    )
    reported = capsys.readouterr().out
    assert "columns not used: counter" in reported
    assert "hermocouples, model compared with test" in reported
    assert np.isfinite(row["rms_difference_K"])
