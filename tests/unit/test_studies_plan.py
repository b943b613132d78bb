"""Studies before they run: factors, designs, input that is refused."""

import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.bearing.new import new_bearing
from thermobearing.border.errors import InputError
from thermobearing.climate.generator import generate_weather
from thermobearing.earthquake import run
from thermobearing.motions.pair import MotionPair
from thermobearing.structure.lanes import run_peaks
from thermobearing.studies.definition import designs, record, targets
from thermobearing.studies.definition.case import make_study
from thermobearing.studies.run import shard
from thermobearing.studies.run.prepare import Preparer

BEARINGS = ["shen-hdr-bridge", "shen-bilinear-bridge"]
MOTIONS = ["jra-ii-i-1", "jra-ii-i-2"]


def study(
    design: dict[str, Any] | None = None, case: dict[str, Any] | None = None, **factors: Any
) -> record.Study:
    whole = {"bearing": BEARINGS[0], "motion": MOTIONS[0], "ambient": ["0 degC"]} | factors
    table = {"kind": "study", "name": "small", "factors": whole}
    table["case"] = {"duration": "2 s"} | (case or {})
    return make_study(table | ({"design": design} if design else {}), "study.toml")


def test_levels_meet_in_every_combination() -> None:
    made = study(bearing=BEARINGS, motion=MOTIONS, ambient=["23 degC", "-20 degC"])
    runs = designs.Plan(made).runs
    names = ["bearing", "motion", "ambient_degC"]
    assert runs[names].values.tolist() == [
        [bearing, motion, air] for bearing in BEARINGS for motion in MOTIONS for air in (23, -20)
    ]
    assert runs["run"].tolist() == list(range(8))
    assert runs["id"].nunique() == 8


def test_an_id_is_of_the_input_and_of_nothing_else() -> None:
    alone = designs.Plan(study(ambient=["-20 degC"])).runs.iloc[0]
    among = designs.Plan(study(bearing=BEARINGS[::-1], ambient=["23 degC", "-20 degC"])).runs
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
    assert alone["id"] not in {designs.Plan(other).runs["id"][0] for other in others}


@pytest.mark.parametrize("kind", ["factorial", "latin-hypercube", "sobol", "monte-carlo"])
def test_a_plan_repeats_itself(kind: str) -> None:
    air = {"distribution": "normal", "mean": "0 degC", "sd": "10 K"}
    made = study({"kind": kind, "samples": 16, "seed": 3}, bearing=BEARINGS, ambient=air)
    runs = designs.Plan(made).runs
    again = make_study(tomllib.loads(made.to_toml()), "again")
    pd.testing.assert_frame_equal(designs.Plan(again).runs, runs, check_exact=True)
    first, second = (runs.loc[runs["bearing"] == name, "ambient_degC"] for name in BEARINGS)
    assert first.tolist() == second.tolist()  # paired: both bearings meet the same air
    assert first.nunique() == 16
    other = designs.Plan(study({"kind": kind, "samples": 16, "seed": 4}, ambient=air)).runs
    assert set(other["ambient_degC"]).isdisjoint(first)


def test_draws_that_are_not_paired_are_others_for_every_combination() -> None:
    air = {"distribution": "uniform", "low": "-20 degC", "high": "30 degC"}
    design = {"kind": "sobol", "samples": 16, "paired": False}
    runs = designs.Plan(study(design, bearing=BEARINGS, ambient=air)).runs
    first, second = (runs.loc[runs["bearing"] == name, "ambient_degC"] for name in BEARINGS)
    assert set(first).isdisjoint(second)


@pytest.mark.parametrize(
    ("samples", "many"), [(designs.MANY // 4, True), (designs.MANY // 4 - 1, False)]
)
def test_large_studies_are_carried_out_in_lockstep(samples: int, many: bool) -> None:
    """Saltelli's arrangement of two factors is four runs a sample; histories need a run alone."""
    drawn = {"distribution": "uniform", "low": 0.9, "high": 1.1}
    air = {"distribution": "uniform", "low": "-20 degC", "high": "30 degC"}
    design = {"kind": "monte-carlo", "samples": samples, "arrangement": "saltelli"}
    made = study(design, scale=drawn, ambient=air)
    assert designs.Plan(made).lockstep == many
    assert not designs.Plan(made.model_copy(update={"keep": record.Keep(histories="all")})).lockstep


def in_plan(**changes: Any) -> record.Study:
    angles = [
        {"name": MOTIONS[0], "across": MOTIONS[1], "angle": f"{angle} deg"} for angle in (0, 30)
    ]
    return study(structure="five-span-bridge", motion={"levels": angles}, **changes)


@pytest.mark.parametrize(
    "scale", [{}, {"measure": "PGV"}, {"measure": "Sa", "period": "1 s", "damping": 0.05}]
)
def test_the_intensity_of_a_pair_is_its_median_over_directions(scale: dict[str, Any]) -> None:
    """RotD50 from records that are turned one by one."""
    made = in_plan(scale={"levels": [1.5], **scale})
    runs, pair = designs.Plan(made).runs, designs.Levels(made).motions[0]
    assert isinstance(pair, MotionPair)
    axes = [replace(pair, angle=float(angle)).along("x") for angle in range(180)]
    peaks = [record.intensity(one, made.factors.scale) for one in axes]
    wanted = 1.5 * float(np.median(peaks))
    result = runs[record.COLUMNS[made.factors.scale.measure]]
    assert_allclose(result, [wanted, wanted], rtol=tol.PLANE_TURNED)


def test_peaks_of_studies_in_plan_are_those_of_histories(monkeypatch: pytest.MonkeyPatch) -> None:
    """Resultants of displacements and forces, the larger of the hinges of a pier."""
    monkeypatch.setattr(shard, "run_lanes", lambda runs: [run_peaks(one) for one in runs])
    made = in_plan()
    preparer = Preparer(designs.Plan(made))
    tasks = [preparer.make_task(row) for row in designs.Plan(made).runs.to_dict("records")]
    alone, peaks = (list(shard._measure_all(tasks, lockstep=way)) for way in (False, True))
    for one, other in zip(alone, peaks, strict=True):
        assert one.numbers["outcome"] == other.numbers["outcome"] == "completed"
        for name in set(shard.RESULT_COLUMNS) - set(shard.TEXTS):
            # A residual is itself of the size of rounding.
            expected = one.numbers[name]
            assert_allclose(other.numbers[name], expected, tol.LOOP, tol.LOOP, err_msg=name)
    response = run.run_task(tasks[1]).bearing(1)["displacement"]
    assert np.hypot(*response.T).max() <= alone[1].numbers["bearing_displacement_max_mm"]
    assert alone[0].numbers["pier_moment_max_kN_m"] != alone[1].numbers["pier_moment_max_kN_m"]


HEAT = {"bearing.materials.rubber.conductivity": {"levels": [0.9, 1.1]}}


def test_numbers_of_heat_keep_runs_apart() -> None:
    made = study({"kind": "factorial"}, **HEAT)
    asked = made.design.model_copy(update={"lockstep": True})
    assert not designs.Plan(made.model_copy(update={"design": asked})).lockstep
    with pytest.raises(InputError, match=r"lockstep: true .*conductivity"):
        study({"kind": "factorial", "lockstep": True}, **HEAT)
    other = study({"kind": "factorial", "lockstep": True}, **{"bearing.K_r": {"levels": [0.9]}})
    assert Preparer(designs.Plan(other)).lockstep


def test_hours_have_their_history_before_them(tmp_path: Path) -> None:
    rows = [f"2024-01-{1 + hour // 24:02d} {hour % 24:02d}:00,{-hour % 7}" for hour in range(60)]
    file = tmp_path / "town.csv"
    file.write_text("\n".join(["time,temperature_degC", *rows]))
    draws = {"kind": "latin-hypercube", "samples": 24}
    runs = designs.Plan(study(draws, ambient={"weather": str(file), "history": "2 d"})).runs
    assert set(runs["hour"]) == set(range(48, 60))


def test_hours_of_another_weather_are_other_runs() -> None:
    draws = {"kind": "latin-hypercube", "samples": 4}
    one, other = (
        designs.Plan(study(draws, ambient={"climate": "cold-town", "years": 1, "seed": seed})).runs
        for seed in (0, 1)
    )
    assert one["hour"].tolist() == other["hour"].tolist()
    assert set(one["id"]).isdisjoint(other["id"])


@pytest.mark.parametrize("measure", ["PGA", "PGV", "Sa"])
def test_a_motion_turned_round_is_as_strong(measure: Any) -> None:
    motion = tb.load_motion(MOTIONS[0])
    scale = record.ScaleFactor(
        levels=[1.0], measure=measure, period=1.0 if measure == "Sa" else None
    )
    turned = replace(motion, acceleration=-motion.acceleration)
    assert record.intensity(turned, scale) == pytest.approx(record.intensity(motion, scale))


def test_saltelli_swaps_one_factor_at_a_time() -> None:
    air = {"distribution": "uniform", "low": "-20 degC", "high": "30 degC"}
    scale = {"distribution": "lognormal", "median": 1.0, "cov": 0.3}
    design = {"kind": "sobol", "samples": 8, "arrangement": "saltelli"}
    runs = designs.Plan(study(design, ambient=air, scale=scale)).runs.set_index(
        ["matrix", "sample"]
    )
    assert len(runs) == 8 * 4
    a, b = runs.loc["A"], runs.loc["B"]
    for name, other in (("ambient_degC", "scale"), ("scale", "ambient_degC")):
        swapped = runs.loc[f"AB {name}"]
        assert swapped[name].tolist() == b[name].tolist()
        assert swapped[other].tolist() == a[other].tolist()


def test_a_motion_is_brought_to_an_intensity() -> None:
    scale = {"of": "intensity", "measure": "PGA", "levels": ["2 m/s2", "400 gal"]}
    made = study(scale=scale, motion=MOTIONS)
    runs = designs.Plan(made).runs
    assert runs["PGA_m_s2"].tolist() == pytest.approx([2.0, 4.0, 2.0, 4.0])
    for row in runs.to_dict("records"):
        pga = tb.load_motion(row["motion"]).pga
        assert row["scale"] * pga == pytest.approx(1000.0 * row["PGA_m_s2"])
    task = Preparer(designs.Plan(study(scale=[1.5]))).make_task(
        designs.Plan(study(scale=[1.5])).runs.to_dict("records")[0]
    )
    plain = Preparer(designs.Plan(study())).make_task(
        designs.Plan(study()).runs.to_dict("records")[0]
    )
    np.testing.assert_array_equal(task.shaking.ground, 1.5 * plain.shaking.ground)


def test_too_many_runs_are_refused() -> None:
    air = {"distribution": "normal", "mean": "0 degC", "sd": "10 K"}
    levels = [0.01 * k for k in range(1, 2000)]
    large = study({"kind": "monte-carlo", "samples": 10_000}, ambient=air, scale=levels)
    with pytest.raises(InputError, match="at most 10000000"):
        assert len(designs.Plan(large).runs)


ONE = {"bearing": "shen-hdr-bridge", "motion": "jra-ii-i-1", "ambient": "0 degC"}
NORMAL = {"distribution": "normal", "mean": 1.0, "cov": 0.1}
SIZE = {"plan": "1000x1000mm", "layers": "20x8mm", "shim": "3mm", "lead": "180mm"}
NATURAL = {"compound": "natural-rubber"}
DRAWN = {"kind": "sobol", "samples": 8}


def reported(table: dict[str, Any], folder: Path = Path()) -> str:
    whole = {"kind": "study", "name": "bad"} | table
    with pytest.raises(InputError) as caught:
        assert designs.Plan(make_study(whole, "study.toml", folder)).runs is None
    return str(caught.value)


FACTORS: list[tuple[dict[str, Any], str]] = [
    ({"motion": None}, "factors.motion"),
    ({"bearings": "x"}, 'did you mean "bearing"'),
    ({"bearing": ["shen-hdr-brigde"]}, 'did you mean "shen-hdr-bridge"'),
    ({"bearing": ["shen-hdr-bridge", "shen-hdr-bridge"]}, 'two have the name "shen-hdr-bridge"'),
    ({"motion": ["jra-ii-i-9999"]}, "factors.motion.levels[0]"),
    ({"structure": ["pier-p2"]}, "factors.structure.levels[0]"),
    ({"structure": ["five-span-bridge"]}, "takes pairs, which act together"),
    ({"structure": ["five-span-bridge", "pier-p1"]}, "require separate studies"),
    (
        {"motion": {"levels": [{"name": "jra-ii-i-1", "across": "jra-ii-i-2"}], "matched": "II-I"}},
        "single records can be matched",
    ),
    ({"ambient": [23]}, "has no unit"),
    ({"scale": {"of": "intensity", "levels": [2]}}, "has no unit"),
    ({"scale": {"of": "intensity", "levels": ["2 m"]}}, "factors.scale.levels[0]"),
    ({"scale": ["2 m/s2"]}, "must be a plain number"),
    ({"scale": [-1.0]}, "greater than 0"),
    ({"scale": [1.0, 1.0]}, "factors.scale.levels: "),
    ({"ambient": ["300 degC"]}, "at most 100 degC"),
    ({"scale": {"of": "intensity", "measure": "Sa", "levels": ["2 m/s2"]}}, "period: "),
    ({"scale": {"of": "factor"}}, "either levels or a distribution"),
    ({"ambient": {"climate": "cold-town", "levels": ["0 degC"]}}, "give one of"),
    ({"ambient": {"climate": "cold-twon"}}, 'did you mean "cold-town"'),
    ({"ambient": {"weather": "no.epw"}}, "no such file"),
    ({"ambient": {"levels": ["0 degC"], "history": "3 d"}}, "history: "),
    ({"ambient": {"climate": "cold-town", "years": 1, "history": "400 d"}}, "needs more of them"),
    ({"motion": {"levels": ["jra-ii-i-1"], "weights": [1]}}, "random = true"),
    ({"motion": {"levels": ["jra-ii-i-1"], "weights": [1, 2], "random": True}}, "for 1 levels"),
    ({"bearing.K_rr": NORMAL}, 'did you mean "bearing.K_r"'),
    ({"pier.mass": NORMAL}, "bearing, structure, case"),
    ({"bearing.K_r": NORMAL, "bearing.hysteresis.layer_stiffness": NORMAL}, " are the same number"),
    ({"bearing.K_r": {"of": "value", "levels": [30.0]}}, "factors.bearing.K_r.levels[0]"),
    ({"bearing.K_r": NORMAL | {"distribution": "lognormall"}}, 'did you mean "lognormal"'),
    ({"bearing.K_r": {"distribution": "normal", "mean": 1.0}}, "mean and sd or mean and cov"),
    ({"bearing.K_r": {"distribution": "normal", "mean": 1.0, "sd": 0.0}}, "bearing.K_r.sd = 0"),
    ({"bearing.K_r": {"distribution": "uniform", "low": 2.0, "high": 1.0}}, "low = 2"),
    ({"bearing.K_r": NORMAL | {"cov": 0.3}}, "normal distribution reaches"),
    ({"ambient": {"distribution": "normal", "mean": "-60 degC", "sd": "15 K"}}, "reaches -131"),
    ({"ambient": {"distribution": "normal", "mean": "0 degC", "sd": "40 K"}}, "low and high"),
    ({"ambient": {"distribution": "normal", "mean": "10 degC", "cov": 0.2}}, "mean and sd"),
    (
        {
            "ambient": {"climate": "cold-town", "years": 1},
            "bearing.materials.rubber.conductivity": NORMAL,
        },
        'history = "10 d"',
    ),
    ({"bearing": {"posterior": "nowhere"}}, "no posterior.csv"),
    ({"bearing": {"posterior": "fit", "counts": 3}}, 'did you mean "count"'),
    ({"bearing": {"posterior": "fit", "levels": ["shen-hdr-bridge"]}}, "in addition to levels"),
    ({"bearing": NATURAL | {"size": SIZE | {"shim": 3.0}}}, "size.shim = 3.0 has no unit"),
    ({"bearing": NATURAL | {"size": SIZE | {"layer": "1x8mm"}}}, 'did you mean "layers"'),
    ({"bearing": {"compound": "natural-rubbr", "size": SIZE}}, 'did you mean "natural-rubber"'),
]


@pytest.mark.parametrize(("factors", "word"), FACTORS)
def test_a_bad_factor_is_reported(tmp_path: Path, factors: dict[str, Any], word: str) -> None:
    fit(tmp_path / "fit")
    whole = {key: value for key, value in (ONE | factors).items() if value is not None}
    drawn = any("distribution" in str(value) or "climate" in str(value) for value in whole.values())
    design = {"design": DRAWN} if drawn or "posterior" in str(whole) else {}
    text = reported({"factors": whole} | design, tmp_path)
    assert text.startswith("study.toml: ") or "factors" in text
    assert word in text


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"kind": "studdy"}, ['must be "study"']),
        ({"name": 3}, ["name = 3"]),
        ({"desing": {}}, ['unknown key "desing"', 'did you mean "design"']),
        ({"design": {"kind": "sobol", "samples": 1000}}, ["512 or 1024"]),
        ({"design": {"kind": "sobol", "samples": 1e3}}, ["512 or 1024"]),
        ({"design": {"kind": "latin-hypercube"}}, ['missing key "samples"']),
        ({"design": {"kind": "lhs", "samples": 3}}, ["design.kind = 'lhs'", "latin-hypercube"]),
        ({"design": {"samples": 16}}, ["design.samples"]),
        ({"design": {"arrangement": "saltelli"}}, ["arrangement"]),
        ({"factors": ONE | {"bearing.K_r": NORMAL}}, ["design.samples", "bearing.K_r"]),
        ({"keep": {"histories": "best 10"}}, ["keep.histories", "worst 10"]),
        ({"case": {"weather": "w.csv"}}, ["case.weather", "factors.ambient"]),
        ({"case": {"motions": "jra-ii-i-1"}}, ["factors.motion"]),
        ({"case": {"duration": 40}}, ["duration", "has no unit"]),
        ({"case": {"duration": "1 ms"}}, ["shorter than a step"]),
        ({"case": {"analysis": {"dtt": "1 ms"}}}, ["analysis.dtt"]),
        ({"case": {"lines": [{"line": "G9", "count": 3}]}}, ['no bearing line is called "G9"']),
        (
            {"case": {"command": "hybrid", "laboratory": {"mode": ["rt", "pd"]}}},
            ["case.laboratory.mode"],
        ),
        ({"case": [], "factors": 3}, ["case: must be a table", "factors: must be a table"]),
    ],
)
def test_a_bad_study_is_reported(table: dict[str, Any], words: list[str]) -> None:
    whole = {"factors": ONE} | table
    text = reported({key: value for key, value in whole.items() if value is not None})
    for word in words:
        assert word in text, text


def test_every_fault_is_in_one_message() -> None:
    text = reported({"factors": ONE | {"ambient": [23], "scale": ["x"], "hour": 3}, "nme": 1})
    for word in ("problems", 'unknown key "nme"', 'unknown factor "hour"', "has no unit"):
        assert word in text


LHDR, HDR, BILINEAR = "shen-lhdr-bridge", "shen-hdr-bridge", "shen-bilinear-bridge"
DRAWS = {"kind": "monte-carlo", "samples": 6, "seed": 2}
NEAR_ONE = {"distribution": "lognormal", "median": 1.0, "cov": 0.1}


def tasks(made: record.Study) -> tuple[pd.DataFrame, list[run.Task]]:
    runs, preparer = designs.Plan(made).runs, Preparer(designs.Plan(made))
    preparer.compute_temperatures(runs)
    return runs, [preparer.make_task(row) for row in runs.to_dict("records")]


def alike(first: Any, second: Any) -> bool:
    if isinstance(first, tuple):
        return all(alike(one, two) for one, two in zip(first, second, strict=True))
    return bool(np.array_equal(np.asarray(first), np.asarray(second)))


def test_every_number_of_a_bearing_goes_where_it_belongs() -> None:
    """One by one a little larger: what is made quickly is what is made whole."""
    before = tb.load_bearing(LHDR)
    paths = targets._number_paths(before)
    assert len(paths) > 30
    for name, (path, _) in paths.items():
        made = study(bearing=LHDR, **{f"bearing.{name}": {"levels": [1.001]}})
        (task,) = tasks(made)[1]
        changed = targets.with_numbers(before, {path: 1.001 * targets.value_at(before, path)})
        own = run.build_device(made.case, changed)
        assert alike(task.device.constants, own.constants), name


def test_long_cold_stays_on_a_bearing_that_is_varied() -> None:
    exposed = {"exposure": {"stiffness": 1.3, "strength": 1.2, "source": "a guess"}}
    made = study(DRAWS, {"analysis": exposed}, bearing=LHDR, **{"bearing.K_r": NEAR_ONE})
    runs, done = tasks(made)
    before = tb.load_bearing(LHDR)
    for row, task in zip(runs.to_dict("records"), done, strict=True):
        stiffness = row["bearing.K_r"] * before.hysteresis.layer_stiffness
        changed = tb.changed_bearing(before, hysteresis={"layer_stiffness": stiffness})
        assert alike(task.device.constants, run.build_device(made.case, changed).constants)


def test_noise_of_a_laboratory_is_that_of_the_run() -> None:
    noisy: dict[str, Any] = {"laboratory": {"mode": "pd", "force_noise": "1 kN"}}
    noisy["analysis"] = {"method": "predictor-corrector"}
    runs, done = tasks(study(case=noisy, scale=[0.5, 1.0]))
    assert [task.case.laboratory.seed for task in done] == runs["seed"].tolist()
    assert runs["seed"].nunique() == 2


def test_numbers_of_structure_and_case() -> None:
    name = "structure.hinges.pier base.yield_moment"
    moment = {"of": "value", "levels": ["30000 kN m", "40000 kN m"]}
    eta = {"of": "value", "levels": [1.0, 3.0]}
    both = {"case.analysis.upper_face.eta": eta, "case.analysis.lower_face.eta": eta}
    runs, done = tasks(study(**{name: moment}, **both))
    assert len(runs) == 8
    for row, task in zip(runs.to_dict("records"), done, strict=True):
        assert task.prepared.structure.hinges[0].yield_moment == row[name]
        assert task.case.analysis.upper_face.eta == row["case.analysis.upper_face.eta"]
        own = run.build_device(task.case, task.device.bearing)
        assert alike(task.device.constants, own.constants)


def test_a_number_that_a_bearing_does_not_have_is_none_and_changes_no_id() -> None:
    lead = {"bearing.sigma_Y": NEAR_ONE}
    runs = designs.Plan(study(DRAWS, bearing=[LHDR, HDR, BILINEAR], **lead)).runs
    without = runs[runs["bearing"] != LHDR]
    assert without["bearing.sigma_Y"].isna().all()
    assert runs.loc[runs["bearing"] == LHDR, "bearing.sigma_Y"].notna().all()
    assert set(without["id"]) == set(designs.Plan(study(bearing=[HDR, BILINEAR])).runs["id"])


def fit(folder: Path, count: int = 4) -> Path:
    """What `identify --posterior` leaves behind, as far as a study looks."""
    folder.mkdir()
    bearing = tb.load_bearing("shen-hdr-specimen")
    tb.save_bearing(bearing, folder / "bearing.toml")
    rows = "".join(f"{30 + k},-1.{k}\n" for k in range(count))
    (folder / "posterior.csv").write_text(f"K_r,m_T\n{rows}")
    return folder


def test_samples_of_a_posterior(tmp_path: Path) -> None:
    place = str(fit(tmp_path / "fit"))
    levels = [{"posterior": place, "name": "fitted"}, BILINEAR]
    made = study(DRAWS | {"samples": 40}, bearing=levels)
    runs, done = tasks(made)
    fitted = (runs["bearing"] == "fitted").to_numpy()
    assert set(runs.loc[fitted, "bearing.sample"]) == {0, 1, 2, 3}
    assert set(runs.loc[~fitted, "bearing.sample"]) == {-1}
    assert runs["id"].nunique() == 5  # four samples, and one bearing that is always the same
    for row, task in zip(runs.to_dict("records"), done, strict=True):
        if row["bearing"] == "fitted":
            result = task.device.bearing.hysteresis  # type: ignore[union-attr]
            assert result.layer_stiffness == 30.0 + row["bearing.sample"]
    alone = study(DRAWS, bearing={"posterior": place, "count": 2})
    assert set(designs.Plan(alone).runs["bearing.sample"]) <= {0, 1}


def test_a_compound_and_its_sizes() -> None:
    size = {"plan": "1000x1000mm", "layers": ["20x8mm", "25x8mm"], "shim": "3mm", "lead": "180mm"}
    made = study(bearing={"compound": "natural-rubber", "size": size})
    result = made.factors.bearing.levels
    assert [one.name for one in result] == [
        "natural-rubber layers 20x8mm",
        "natural-rubber layers 25x8mm",
    ]
    one = {key: value if isinstance(value, str) else value[1] for key, value in size.items()}
    assert result[1] == new_bearing(result[1].name, "natural-rubber", **one)


def test_bearings_whose_lead_differs_are_not_as_warm(tmp_path: Path) -> None:
    thin = tb.changed_bearing(LHDR, name="thin", lead={"diameter": 150.0})
    tb.save_bearing(thin, tmp_path / "thin.toml")
    air = {"climate": "cold-town", "years": 1}
    levels = [LHDR, str(tmp_path / "thin.toml")]
    runs, done = tasks(study(DRAWS, bearing=levels, ambient=air))
    weather = generate_weather("cold-town", 1, 0)
    for hour, task in zip(runs["hour"], done, strict=True):
        own = run.build_device(task.case, task.device.bearing)
        alone = run.soaked_hours(own, weather, np.array([hour]))
        assert_array_equal(task.lines[0].temperature, alone.temperature[0])
    assert_array_equal(runs["ambient_degC"], weather.temperature[runs["hour"]])
    assert done[0].lines[0].lead != done[6].lines[0].lead


@pytest.mark.parametrize("heat", [False, True])
def test_a_history_before_the_earthquake(heat: bool) -> None:
    air = {"climate": "cold-town", "years": 1, "history": "2 d"}
    more = {"bearing.materials.rubber.conductivity": {"levels": [1.0]}} if heat else {}
    runs, done = tasks(study(DRAWS, bearing=LHDR, ambient=air, **more))
    weather = generate_weather("cold-town", 1, 0)
    for k, task in enumerate(done):
        cells, lead = run._soaked(task.device, weather.before(int(runs["hour"][k]), 48.0))
        assert_allclose(task.lines[0].temperature, cells, atol=tol.TEN_MINUTES)
        assert task.lines[0].lead == pytest.approx(lead, abs=tol.TEN_MINUTES_OF_LEAD)


@pytest.mark.parametrize(
    ("kind", "words", "mean", "deviation"),
    [
        ("normal", {"mean": 3.0, "cov": 0.2}, 3.0, 0.6),
        ("lognormal", {"mean": 2.0, "cov": 0.5}, 2.0, 1.0),
        ("uniform", {"low": 1.0, "high": 4.0}, 2.5, 3.0 / 12.0**0.5),
        ("triangular", {"low": 0.0, "mode": 1.0, "high": 2.0}, 1.0, 1.0 / 6.0**0.5),
    ],
)
def test_distributions_have_the_moments_that_are_reported(
    kind: str, words: dict[str, float], mean: float, deviation: float
) -> None:
    made = study(
        {"kind": "monte-carlo", "samples": 1}, **{"bearing.K_r": {"distribution": kind} | words}
    )

    result = designs.Plan(made).columns[-1].distribution
    assert result is not None
    points = (np.arange(100_000) + 0.5) / 100_000
    values = result.at(points)
    assert values.mean() == pytest.approx(mean, rel=tol.QUADRATURE_OF_TAILS)
    assert values.std() == pytest.approx(deviation, rel=tol.QUADRATURE_OF_TAILS)


def test_a_distribution_is_cut_off() -> None:
    cut = record.Distribution("normal", 0.0, 1.0, -1.0, 0.5)
    values = cut.at(np.linspace(0.0, 1.0, 1001))
    assert (values[0], values[-1]) == (-1.0, 0.5)
    assert (np.diff(values) > 0.0).all()


def test_levels_by_lot_have_their_weights() -> None:
    motion = {"levels": ["jra-ii-i-1", "jra-ii-i-2"], "random": True, "weights": [3, 1]}
    runs = designs.Plan(study({"kind": "latin-hypercube", "samples": 400}, motion=motion)).runs
    assert len(runs) == 400
    assert (runs["motion"] == "jra-ii-i-1").sum() == 300


def test_a_resolved_study_is_the_same_study(tmp_path: Path) -> None:
    import tomllib

    made = study(
        DRAWS,
        bearing=[{"posterior": str(fit(tmp_path / "fit")), "name": "fitted"}, BILINEAR],
        ambient={"climate": "cold-town", "years": 1, "history": "5 h"},
        scale={"of": "intensity", "measure": "Sa", "period": "1 s", "levels": ["0.3 g"]},
        **{"bearing.K_r": NEAR_ONE, "structure.masses.deck.mass": NEAR_ONE},
    )
    again = make_study(tomllib.loads(made.to_toml()), "again")
    pd.testing.assert_frame_equal(
        designs.Plan(again).runs, designs.Plan(made).runs, check_exact=True
    )
