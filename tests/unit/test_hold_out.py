"""Fits judged by tests that they have not seen: who is held out of which fit, verdicts, files."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import thermobearing as tb
from tests.unit.inputs import command, write_test
from thermobearing.identify.records.record import TestRecord
from thermobearing.validate.result import BEYOND, WITHIN, CrossValidation
from thermobearing.validate.run import cross_validate, split_tests

HDR = "shen-hdr-specimen"
TEST = tb.cyclic_test(strain=[0.5, 1.5], cycles=2, rest=None)
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
    found = cross_validate(good[:3], HDR, hold_out=[good[3], faulty], **FIT)
    assert [item.record for item in found.fitted.comparisons] == good[:3]
    assert [item.record for item in found.held_out.comparisons] == [good[3], faulty]
    assert (found.folds, found.spread) == ([], {})
    rows = found.table.set_index("test")
    assert rows["role"].tolist() == ["fitted"] * 3 + ["held out"] * 2
    assert rows["K_eq_verdict"].tolist() == [WITHIN] * 4 + [BEYOND]
    assert rows["K_eq_error"]["fault"] == pytest.approx(1.0 / FAULT - 1.0, abs=0.01)
    assert rows["K_eq_ratio"]["fault"] == pytest.approx(1.0 / FAULT, abs=0.01)
    assert rows["R2"]["at23"] > 0.999
    assert (found.verdict, found.fitted.verdict) == (BEYOND, WITHIN)
    looser = cross_validate(good[:3], HDR, hold_out=faulty, limits={"K_eq": 0.3}, **FIT)
    assert looser.verdict == WITHIN


def test_it_is_the_validation_of_the_fitted_bearing(good: list[TestRecord]) -> None:
    """One judge: the same numbers as `validate` with the bearing of the same fit."""
    found = cross_validate(good[:2], HDR, hold_out=good[2], **FIT)
    fit = tb.identify_bearing(good[:2], HDR, **FIT)
    again = tb.validate_bearing(fit.bearing, good[2])
    assert found.final.values == fit.values
    pd.testing.assert_frame_equal(found.held_out.table, again.table)
    assert found.held_out.limits == again.limits


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
    table = folded.parameters.set_index("fold")
    assert table.index.tolist() == [0, 1, 2, 3, 4, 5]
    assert table["tests"].tolist() == [5, 4, 4, 4, 4, 4]
    held = (item.record for item in folded.held_out.comparisons)
    without_it = folded.find_fold(next(record for record in held if record.name == "fault"))
    assert table["K_r"][without_it] == pytest.approx(30.738, rel=0.01)
    others = table["K_r"].drop([0, without_it])
    assert (others > 31.5).all()
    values = table["K_r"][1:].to_numpy()
    jackknife = np.sqrt(0.8 * ((values - values.mean()) ** 2).sum())
    assert folded.spread["K_r"] == pytest.approx(jackknife)
    assert folded.spread["K_r"] > 4.0 * table["K_r_stderr"][without_it]


def test_groups_have_every_temperature() -> None:
    """Given by temperature, in a row: no fit misses all of the cold ones."""
    one = made(-20.0, "one")
    tests = [replace(one, ambient=at, name=f"{at:g}") for at in (23.0, -20.0, 22.0, -19.0)]
    found = cross_validate(tests, HDR, folds=2, free=["K_r"], starts=1, limits={"K_eq": 10.0})
    assert [[r.ambient for r in group] for group in found.groups] == [[-20.0, 22.0], [23.0, -19.0]]
    assert [r.ambient for r in found.folds[0].records] == [23.0, -19.0]


def test_one_test_given_twice_is_one(tmp_path: Path, good: list[TestRecord]) -> None:
    files = [write_test(tmp_path, record) for record in good[:2]]
    held = files[1].with_suffix(".toml")  # the same test by its sidecar
    kept, out = split_tests([*files, good[2]], [held, files[1]])
    assert [record.name for record in kept] == ["at-20", "at10"]
    assert [record.name for record in out] == ["at-10"]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({}, "hold out"),
        ({"folds": 2, "hold_out": "first"}, "folds"),
        ({"hold_out": "all"}, "none is left"),
        *(({"folds": folds}, "from 2 to the number of tests, 3") for folds in (4, 1, True, 2.0)),
        ({"folds": 2, "limits": {"K_eg": 0.1}}, '"K_eq"'),
        ({"folds": 2, "method": "annealing"}, "least-squares"),
        ({"hold_out": "nobody.csv"}, "nobody.csv"),
    ],
)
def test_what_cannot_be(good: list[TestRecord], options: dict[str, Any], said: str) -> None:
    known = {"first": good[:1], "all": good[:3]}
    held = options.get("hold_out", ())
    with pytest.raises(tb.InputError, match=said):
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
    of_tests = [f"held_out_{name}" for name in ("loops", "ratios", "cycles", "residuals")]
    of_fit = ["loops", "residuals", "convergence", "correlation", "cycles"]
    assert drawn == [*of_fit, "folds", *of_tests]


def test_command(tmp_path: Path, good: list[TestRecord], faulty: TestRecord) -> None:
    files = [write_test(tmp_path, record) for record in (*good[:2], faulty)]
    fit = ["--free", "K_r,d_y", "--starts", "1"]
    out = tmp_path / "held"
    done = command("identify", *files[:2], "--hold-out", files[2], *fit, "-o", out, "--no-figures")
    assert done.exit_code == 0, done.output
    shown = " ".join(done.output.split())
    assert shown.index("fitted to") < shown.index("test held out") < shown.index("verdict: beyond")
    told = json.loads((out / "summary.json").read_text())
    assert told["command"] == "identify"
    assert told["held_out"]["verdict"] == "beyond"
    assert [test["role"] for test in told["held_out"]["tests"]] == ["fitted"] * 2 + ["held out"]
    assert len(told["records"]) == 2
    fitted = {"summary.json", "bearing.toml", "compound.toml", "fit.csv"}
    assert {path.name for path in out.iterdir()} == fitted | {"table.csv", "cycles.csv"}


def test_command_with_folds(tmp_path: Path, good: list[TestRecord]) -> None:
    files = [write_test(tmp_path, record) for record in good[:2]]
    out = tmp_path / "folds"
    words = ["identify", *files, "--folds", "2", "--free", "K_r", "--starts", "1", "-o", out]
    done = command(*words, "--no-figures", "--limit", "NRMSE=0.000001")
    assert done.exit_code == 0, done.output
    assert "jackknife" in done.output
    table = pd.read_csv(out / "folds.csv")
    assert table["fold"].tolist() == [0, 1, 2]
    told = json.loads((out / "summary.json").read_text())["held_out"]
    assert told["verdict"] == "beyond"  # noise alone is more
    assert told["limits"] == {"K_eq": 0.15, "h_eq": 0.15, "NRMSE": 1e-6}
    assert set(told["jackknife_stderr"]) == {"K_r"}
    assert table["K_r"].to_numpy() == pytest.approx([row["K_r"] for row in told["folds"]], rel=1e-6)


def test_a_test_is_judged_as_it_is_fitted() -> None:
    """Before: R2 0.97 for 0.996, since rests that relax and spikes taken out counted."""
    steps = tb.cyclic_test(strain=[0.5, 1.0], cycles=2, rest=120.0)
    record = tb.synthetic_record(
        "shen-hdr-specimen", 0.0, steps, noise=0.005, sampling=20.0, through_rests=True, jitter=0.02
    )
    force = record.force + 0.2 * record.peak_force * (np.abs(record.displacement) < 0.2)
    force[len(force) // 3] += 3.0 * record.peak_force
    record = replace(record, force=force, despike=True)
    found = tb.validate_bearing("shen-hdr-specimen", record).comparisons[0]
    assert found.R2 > 0.97
    assert found.NRMSE < 0.05
    held = cross_validate(
        [record, replace(record, name="other")], "shen-hdr-specimen", folds=2, free=["K_r"],
        starts=1,
    )  # fmt: skip
    assert held.table["fold"].tolist() == [0, 0, 1, 2]
    assert held.judged.table["R2"].min() > 0.97
    assert len({id(item.record) for item in held.judged.comparisons}) == 2
