"""Peaks under several motions, at every temperature; bounds on another structure."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from thermobearing.design.case import make_design_case
from thermobearing.design.peaks import (
    OTHERS,
    _combined,
    coldest_sentences,
    collect_peaks,
    envelope,
    few_motions,
)
from thermobearing.design.run import _one_turn, _peaks_by_temperature, run_bounds
from thermobearing.design.sizing import Check
from thermobearing.earthquake.motions import Motion

THREE = ["jra-ii-i-1", "jra-ii-i-2", "jra-ii-i-3"]
LIMITS = [
    Check("shear strain", 0.0, 2.5, "1", "test"),
    Check("pier ductility", 0.0, 3.0, "1", "test"),
]


def test_the_mean_is_over_a_group_and_the_largest_of_the_groups() -> None:
    motions = [Motion(name=name) for name in (*THREE, "jra-i-i-1")]
    assert _combined([1.0, 2.0, 6.0, 4.0], motions, "largest") == 6.0
    assert _combined([1.0, 2.0, 6.0, 3.5], motions, "mean") == 3.5
    assert _combined([1.0, 2.0, 9.0, 3.5], motions, "mean") == 4.0
    mine = [Motion(name="a.csv", group="one"), Motion(name="b.csv"), Motion(name="c.csv")]
    assert _combined([5.0, 1.0, 3.0], mine, "mean") == 5.0
    two = [Motion(name=name) for name in THREE[:2]]  # too few for a mean
    assert _combined([2.0, 4.0], two, "mean") == 4.0
    assert few_motions(motions, "largest") == []
    (output,) = few_motions(motions, "mean")
    assert output.endswith(" jra-i-i has 1")
    (output,) = few_motions(mine, "mean")
    assert output.endswith(f" {OTHERS} has 2")
    (output,) = few_motions(mine[1:], "mean")  # nobody entered a group
    assert output.endswith(" there are 2")


def test_a_round_finds_the_mean_where_the_case_says_so() -> None:
    case = make_design_case({}, "test", motions=THREE)
    assert case.peaks == "mean"
    mean = _one_turn(case, 1, [178.0])
    largest = _one_turn(make_design_case({}, "test", motions=THREE, peaks="largest"), 1, [178.0])
    peaks = largest.study["bearing_displacement_max"].values
    assert_allclose([largest.rounds[0].found, mean.rounds[0].found], [peaks.max(), peaks.mean()])
    assert mean.rounds[0].largest == largest.rounds[0].found
    with pytest.raises(tb.InputError, match="'largest', 'mean' or 'mean of seven'"):
        make_design_case({"peaks": "means"}, "test")


def test_bearings_are_judged_at_every_temperature() -> None:
    study = tb.bridge("shen-hdr-bridge", THREE[:2], [23, -20], duration=6)
    motions = [Motion(name=name) for name in THREE[:2]]
    table = collect_peaks(study, motions, "largest", LIMITS).set_index("ambient_degC")
    runs = study.table[study.table["ambient_degC"] == -20]
    assert_allclose(table.loc[-20, "strain"], runs["bearing_strain_max"].max())
    tight = [Check("shear strain", 0.0, table.loc[-20, "strain"] + 1e-6, "1", "test")]
    verdicts = collect_peaks(study, motions, "largest", tight).set_index("ambient_degC")
    assert list(verdicts["verdict"]) == ["NG", "OK"]
    assert list(verdicts["fails"]) == ["strain", ""]
    worst = envelope(table.reset_index()).set_index("peak")
    assert worst.loc["strain", "at_degC"] == 23
    assert worst.loc["force_kN", "at_degC"] == -20
    (output,) = coldest_sentences(table.reset_index())
    assert "OK on the coldest day, -20 degC" in output
    assert np.isfinite(table.drop(columns=["bearing", "verdict", "fails"]).to_numpy(float)).all()


def test_nothing_to_judge_without_bearings_or_temperatures() -> None:
    case = make_design_case({}, "test", ambient=[])
    turn = _one_turn(make_design_case({}, "test", motions=["jra-ii-i-1"]), 1, [178.0])
    assert len(_peaks_by_temperature(case, turn.rounds, [[object()]], [])) == 0  # type: ignore[list-item]
    with pytest.raises(tb.InputError, match="more than once"):
        make_design_case({}, "test", ambient=[0, 0])


def test_bounds_on_another_structure_say_which(tmp_path: Path) -> None:
    given = {"structure": "pier-p1", "fixed_base": True, "duration": 4.0}
    report = run_bounds(["shen-hdr-bridge"], ["jra-ii-i-1"], [23.0, -20.0], **given)
    assert report.structure == "pier-p1 (fixed base)"
    assert report.summary()["structure"] == report.structure
    assert report.structure in report.tables()["demands"].caption
    assert set(report.table["structure"]) == {report.structure}
    plain = run_bounds(["shen-hdr-bridge"], ["jra-ii-i-1"], [23.0, -20.0], duration=4.0)
    assert (report.table["coupled_max"] != plain.table["coupled_max"]).all()
