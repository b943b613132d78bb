"""Plans of studies: which runs, in which order, known by what goes into them."""

import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import thermobearing as tb
from thermobearing.border.errors import InputError
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.earthquake.run import build_tasks, run_task
from thermobearing.studies.definition.case import make_study
from thermobearing.studies.definition.designs import MANY, in_lockstep, plan
from thermobearing.studies.definition.record import Keep, ScaleFactor, Study, intensity
from thermobearing.studies.run.prepare import Preparer

BEARINGS = ["shen-hdr-bridge", "shen-bilinear-bridge"]
MOTIONS = ["jra-ii-i-1", "jra-ii-i-2"]


def study(
    design: dict[str, Any] | None = None, case: dict[str, Any] | None = None, **factors: Any
) -> Study:
    """A small study; factors replace or join those of one run."""
    whole = {"bearing": BEARINGS[0], "motion": MOTIONS[0], "ambient": ["0 degC"]} | factors
    table = {"kind": "study", "name": "small", "factors": whole}
    table["case"] = {"duration": "2 s"} | (case or {})
    return make_study(table | ({"design": design} if design else {}), "study.toml")


def test_levels_meet_in_every_combination() -> None:
    made = study(bearing=BEARINGS, motion=MOTIONS, ambient=["23 degC", "-20 degC"])
    runs = plan(made)
    names = ["bearing", "motion", "ambient_degC"]
    assert runs[names].values.tolist() == [
        [bearing, motion, air] for bearing in BEARINGS for motion in MOTIONS for air in (23, -20)
    ]
    assert runs["run"].tolist() == list(range(8))
    assert runs["id"].nunique() == 8


def test_a_run_of_a_study_is_that_of_bridge() -> None:
    made = study(bearing=BEARINGS, ambient=["23 degC", "-20 degC"])
    case = make_earthquake_case(
        {"command": "bridge"},
        "bridge",
        bearings=BEARINGS,
        motions=MOTIONS[:1],
        ambient=[23, -20],
        duration=2,
    )
    preparer = Preparer(made)
    for row, task in zip(plan(made).to_dict("records"), build_tasks(case), strict=True):
        mine, theirs = run_task(preparer.make_task(row)), run_task(task)
        np.testing.assert_array_equal(mine.rows.q, theirs.rows.q)


def test_an_id_is_of_the_input_and_of_nothing_else() -> None:
    alone = plan(study(ambient=["-20 degC"])).iloc[0]
    among = plan(study(bearing=BEARINGS[::-1], ambient=["23 degC", "-20 degC"]))
    same = among[(among["bearing"] == BEARINGS[0]) & (among["ambient_degC"] == -20.0)].iloc[0]
    assert (alone["id"], alone["seed"]) == (same["id"], same["seed"])
    assert alone["run"] != same["run"]
    others = [
        study(ambient=["-20.1 degC"]),
        study(ambient=["-20 degC"], scale=[1.1]),
        study(ambient=["-20 degC"], motion=MOTIONS[1]),
        study(ambient=["-20 degC"], bearing=BEARINGS[1]),
        study(ambient=["-20 degC"], structure="hybrid-pier"),
    ]
    assert alone["id"] not in {plan(other)["id"][0] for other in others}


@pytest.mark.parametrize("kind", ["factorial", "latin-hypercube", "sobol", "monte-carlo"])
def test_a_plan_repeats_itself(kind: str) -> None:
    air = {"distribution": "normal", "mean": "0 degC", "sd": "10 K"}
    made = study({"kind": kind, "samples": 16, "seed": 3}, bearing=BEARINGS, ambient=air)
    runs = plan(made)
    again = make_study(tomllib.loads(made.to_toml()), "again")
    pd.testing.assert_frame_equal(plan(again), runs, check_exact=True)
    first, second = (runs.loc[runs["bearing"] == name, "ambient_degC"] for name in BEARINGS)
    assert first.tolist() == second.tolist()  # paired: both bearings meet the same air
    assert first.nunique() == 16
    other = plan(study({"kind": kind, "samples": 16, "seed": 4}, ambient=air))
    assert set(other["ambient_degC"]).isdisjoint(first)


def test_draws_that_are_not_paired_are_others_for_every_combination() -> None:
    air = {"distribution": "uniform", "low": "-20 degC", "high": "30 degC"}
    design = {"kind": "sobol", "samples": 16, "paired": False}
    runs = plan(study(design, bearing=BEARINGS, ambient=air))
    first, second = (runs.loc[runs["bearing"] == name, "ambient_degC"] for name in BEARINGS)
    assert set(first).isdisjoint(second)


@pytest.mark.parametrize(("samples", "many"), [(MANY // 4, True), (MANY // 4 - 1, False)])
def test_large_studies_are_carried_out_in_lockstep(samples: int, many: bool) -> None:
    """Saltelli's arrangement of two factors is four runs a sample; histories need a run alone."""
    drawn = {"distribution": "uniform", "low": 0.9, "high": 1.1}
    air = {"distribution": "uniform", "low": "-20 degC", "high": "30 degC"}
    design = {"kind": "monte-carlo", "samples": samples, "arrangement": "saltelli"}
    made = study(design, scale=drawn, ambient=air)
    assert in_lockstep(made) == many
    assert not in_lockstep(made.model_copy(update={"keep": Keep(histories="all")}))


HEAT = {"bearing.materials.rubber.conductivity": {"levels": [0.9, 1.1]}}


def test_numbers_of_heat_keep_runs_apart() -> None:
    """Runs side by side have the heat of their cells in common."""
    made = study({"kind": "factorial"}, **HEAT)
    asked = made.design.model_copy(update={"lockstep": True})
    assert not in_lockstep(made.model_copy(update={"design": asked}))
    with pytest.raises(InputError, match=r"lockstep: true; .*conductivity changes it"):
        study({"kind": "factorial", "lockstep": True}, **HEAT)
    other = study({"kind": "factorial", "lockstep": True}, **{"bearing.K_r": {"levels": [0.9]}})
    assert Preparer(other).lockstep


def test_hours_have_their_history_before_them(tmp_path: Path) -> None:
    rows = [f"2024-01-{1 + hour // 24:02d} {hour % 24:02d}:00,{-hour % 7}" for hour in range(60)]
    file = tmp_path / "town.csv"
    file.write_text("\n".join(["time,temperature_degC", *rows]))
    draws = {"kind": "latin-hypercube", "samples": 24}
    runs = plan(study(draws, ambient={"weather": str(file), "history": "2 d"}))
    assert set(runs["hour"]) == set(range(48, 60))


def test_hours_of_another_weather_are_other_runs() -> None:
    draws = {"kind": "latin-hypercube", "samples": 4}
    one, other = (
        plan(study(draws, ambient={"climate": "cold-town", "years": 1, "seed": seed}))
        for seed in (0, 1)
    )
    assert one["hour"].tolist() == other["hour"].tolist()
    assert set(one["id"]).isdisjoint(other["id"])


@pytest.mark.parametrize("measure", ["PGA", "PGV", "Sa"])
def test_a_motion_turned_round_is_as_strong(measure: Any) -> None:
    """Whichever way its largest value points."""
    motion = tb.load_motion(MOTIONS[0])
    scale = ScaleFactor(levels=[1.0], measure=measure, period=1.0 if measure == "Sa" else None)
    turned = replace(motion, acceleration=-motion.acceleration)
    assert intensity(turned, scale) == pytest.approx(intensity(motion, scale))


def test_saltelli_swaps_one_factor_at_a_time() -> None:
    air = {"distribution": "uniform", "low": "-20 degC", "high": "30 degC"}
    scale = {"distribution": "lognormal", "median": 1.0, "cov": 0.3}
    design = {"kind": "sobol", "samples": 8, "arrangement": "saltelli"}
    runs = plan(study(design, ambient=air, scale=scale)).set_index(["matrix", "sample"])
    assert len(runs) == 8 * 4
    a, b = runs.loc["A"], runs.loc["B"]
    for name, other in (("ambient_degC", "scale"), ("scale", "ambient_degC")):
        swapped = runs.loc[f"AB {name}"]
        assert swapped[name].tolist() == b[name].tolist()
        assert swapped[other].tolist() == a[other].tolist()


def test_a_motion_is_brought_to_an_intensity() -> None:
    scale = {"of": "intensity", "measure": "PGA", "levels": ["2 m/s2", "400 gal"]}
    made = study(scale=scale, motion=MOTIONS)
    runs = plan(made)
    assert runs["PGA_m_s2"].tolist() == pytest.approx([2.0, 4.0, 2.0, 4.0])
    for row in runs.to_dict("records"):
        pga = tb.load_motion(row["motion"]).pga
        assert row["scale"] * pga == pytest.approx(1000.0 * row["PGA_m_s2"])
    task = Preparer(study(scale=[1.5])).make_task(plan(study(scale=[1.5])).to_dict("records")[0])
    plain = Preparer(study()).make_task(plan(study()).to_dict("records")[0])
    np.testing.assert_array_equal(task.shaking.ground, 1.5 * plain.shaking.ground)


def test_too_many_runs_are_refused() -> None:
    air = {"distribution": "normal", "mean": "0 degC", "sd": "10 K"}
    levels = [0.01 * k for k in range(1, 2000)]
    with pytest.raises(InputError, match="at most 10000000 are done"):
        plan(study({"kind": "monte-carlo", "samples": 10_000}, ambient=air, scale=levels))
