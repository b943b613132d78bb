"""Studies of axial forces: columns of the table of runs, uplift and instability as demand."""

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from tests.verification.test_vertical import TABLE
from thermobearing.earthquake.axial import AXIAL_COLUMNS
from thermobearing.studies.definition.case import make_study
from thermobearing.studies.definition.designs import Plan
from thermobearing.studies.run.engine import count_failures
from thermobearing.studies.run.shard import run_shard
from thermobearing.studies.statistics.demand import counted
from thermobearing.studies.statistics.fragility import fragility_curve

SCALES = [0.5, 1.0, 1.5, 2.0]
MOTIONS = [
    {"name": "jra-ii-i-1", "vertical": "jra-ii-i-2"},
    {"name": "jra-ii-i-2", "vertical": "jra-ii-i-3"},
]


def _study(
    *, level: str = "vertical", scales: list[float] = SCALES, **axial: str
) -> dict[str, Any]:
    return {
        "kind": "study",
        "name": "vertical",
        "case": {
            "structure": "pier-p1",
            "duration": "11 s",
            "analysis": {"axial": level},
            "lines": [{"line": "G1-G5", "axial": TABLE | axial}],
        },
        "factors": {
            "bearing": "lrb-example",
            "motion": MOTIONS,
            "scale": scales,
            "ambient": ["-10 degC"],
        },
    }


def _runs(table: dict[str, Any]):
    plan = Plan(make_study(table, "study.toml"))
    return run_shard(plan, plan.runs)


def test_fragility_of_uplift() -> None:
    runs = _runs(_study(dead_load="500 kN", joint="dowelled"))
    assert set(AXIAL_COLUMNS) <= set(runs)
    lifted = runs["uplift_mm"] > 0.0
    assert (runs.loc[lifted, "axial_force_min_kN"] == 0.0).all()
    assert (runs.loc[~lifted, "axial_force_min_kN"] > 0.0).all()
    # Of the two motions one lifts the bearings at a scale at which the other does not.
    at_scale = lifted.groupby(runs["scale"]).mean()
    assert at_scale.tolist() == [0.0, 0.5, 1.0, 1.0]
    curve = fragility_curve(runs, "uplift_mm", 1e-6, "scale", method="stripes")
    assert (curve.row()["runs"], curve.row()["beyond"]) == (8, 5)


def test_an_unstable_run_exceeds_every_demand() -> None:
    runs = _runs(_study(level="overturning", scales=[0.1, 1.0], dead_load="10500 kN"))
    assert runs["outcome"].tolist() == ["completed", "unstable"] * 2
    assert (runs["critical_share"] > 1.0).tolist() == [False, True] * 2
    for demand in ("uplift_mm", "critical_share", "bearing_displacement_max_mm"):
        assert np.isinf(counted(runs, demand).demand).tolist() == [False, True] * 2
    (row,) = count_failures(runs).to_dict("records")
    assert "unstable" in row.values()


@pytest.mark.parametrize(
    ("level", "axial", "outcomes"),
    [
        ("vertical", {"dead_load": "500 kN", "joint": "dowelled"}, {"completed", "unstable"}),
        ("vertical", {"dead_load": "500 kN"}, {"completed", "cavitated"}),
        ("overturning", {"dead_load": "10500 kN"}, {"completed", "unstable"}),
    ],
)
def test_runs_in_lockstep_are_those_one_by_one(
    level: str, axial: dict[str, str], outcomes: set[str]
) -> None:
    scales = [0.05, *np.linspace(0.25, 2.0, 8).tolist()]  # 18 runs, more than lanes
    table = _study(level=level, scales=scales, **axial)
    alone = _runs(table | {"design": {"kind": "factorial", "lockstep": False}})
    together = _runs(table | {"design": {"kind": "factorial", "lockstep": True}})
    assert set(alone["outcome"]) == outcomes
    assert alone["outcome"].tolist() == together["outcome"].tolist()
    good = alone["outcome"] != "unstable"  # beyond, rounding grows
    for name in (*AXIAL_COLUMNS, "bearing_displacement_max_mm", "pier_moment_max_kN_m"):
        assert_allclose(
            together[name][good], alone[name][good], tol.LANE_PEAK, tol.LANE_PEAK, err_msg=name
        )


def test_columns_of_a_study_without_axial_forces() -> None:
    assert not set(AXIAL_COLUMNS) & set(_runs(_study(level="off", scales=[0.5])))


def test_a_study_in_a_directory_has_units(tmp_path) -> None:
    pytest.importorskip("pyarrow")
    text = """
kind = "study"
name = "vertical"

[case]
structure = "pier-p1"
duration = "2 s"
analysis = { axial = "overturning" }

[[case.lines]]
line = "G1-G5"
[case.lines.axial]
dead_load = "800 kN"
places = ["-4 m", "-2 m", "0 m", "2 m", "4 m"]
deck_height = "2 m"
across = true

[factors]
bearing = "lrb-example"
motion = ["jra-ii-i-1", "jra-ii-i-2"]
ambient = ["0 degC"]
"""
    (tmp_path / "study.toml").write_text(text)
    result = tb.study(tmp_path / "study.toml", tmp_path / "out", jobs=1)
    assert (result.table["axial_force_min_kN"] < 800.0).all()
    assert result.demand("critical_share")["mean"].iloc[0] < 0.2
