"""Ways to say what differs between the runs of a study, and what a run is made of then."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.test_studies_plan import study
from thermobearing.bearing.new import new_bearing
from thermobearing.climate.generator import generate_weather
from thermobearing.earthquake.run import Task, build_device, soaked, soaked_hours
from thermobearing.studies.definition.case import make_study
from thermobearing.studies.definition.designs import _number_paths, _value_at, plan, with_numbers
from thermobearing.studies.definition.record import Distribution, Study
from thermobearing.studies.run.prepare import Preparer

LHDR, HDR, BILINEAR = "shen-lhdr-bridge", "shen-hdr-bridge", "shen-bilinear-bridge"
DRAWS = {"kind": "monte-carlo", "samples": 6, "seed": 2}
NEAR_ONE = {"distribution": "lognormal", "median": 1.0, "cov": 0.1}


def tasks(made: Study) -> tuple[pd.DataFrame, list[Task]]:
    """The plan of a study, and what each run is made of."""
    runs, preparer = plan(made), Preparer(made)
    preparer.foresee(runs)
    return runs, [preparer.make_task(row) for row in runs.to_dict("records")]


def alike(first: Any, second: Any) -> bool:
    """Whether two records of arrays and numbers are the same bits."""
    if isinstance(first, tuple):
        return all(alike(one, two) for one, two in zip(first, second, strict=True))
    return bool(np.array_equal(np.asarray(first), np.asarray(second)))


def test_every_number_of_a_bearing_goes_where_it_belongs() -> None:
    """One by one a little larger: what is made quickly is what is made whole."""
    before = tb.load_bearing(LHDR)
    paths = _number_paths(before)
    assert len(paths) > 30
    for name, (path, _) in paths.items():
        made = study(bearing=LHDR, **{f"bearing.{name}": {"levels": [1.001]}})
        (task,) = tasks(made)[1]
        changed = with_numbers(before, {path: 1.001 * _value_at(before, path)})
        own = build_device(made.case, changed)
        assert alike(task.device.constants, own.constants), name


def test_long_cold_stays_on_a_bearing_that_is_varied() -> None:
    exposed = {"exposure": {"stiffness": 1.3, "strength": 1.2, "source": "a guess"}}
    made = study(DRAWS, {"analysis": exposed}, bearing=LHDR, **{"bearing.K_r": NEAR_ONE})
    runs, done = tasks(made)
    before = tb.load_bearing(LHDR)
    for row, task in zip(runs.to_dict("records"), done, strict=True):
        stiffness = row["bearing.K_r"] * before.hysteresis.layer_stiffness
        changed = tb.changed_bearing(before, hysteresis={"layer_stiffness": stiffness})
        assert alike(task.device.constants, build_device(made.case, changed).constants)


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
        own = build_device(task.case, task.device.bearing)
        assert alike(task.device.constants, own.constants)


def test_a_number_that_a_bearing_does_not_have_is_none_and_changes_no_id() -> None:
    lead = {"bearing.sigma_Y": NEAR_ONE}
    runs = plan(study(DRAWS, bearing=[LHDR, HDR, BILINEAR], **lead))
    without = runs[runs["bearing"] != LHDR]
    assert without["bearing.sigma_Y"].isna().all()
    assert runs.loc[runs["bearing"] == LHDR, "bearing.sigma_Y"].notna().all()
    assert set(without["id"]) == set(plan(study(bearing=[HDR, BILINEAR]))["id"])


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
            found = task.device.bearing.hysteresis  # type: ignore[union-attr]
            assert found.layer_stiffness == 30.0 + row["bearing.sample"]
    alone = study(DRAWS, bearing={"posterior": place, "count": 2})
    assert set(plan(alone)["bearing.sample"]) <= {0, 1}


def test_a_compound_and_its_sizes() -> None:
    size = {"plan": "1000x1000mm", "layers": ["20x8mm", "25x8mm"], "shim": "3mm", "lead": "180mm"}
    made = study(bearing={"compound": "natural-rubber", "size": size})
    found = made.factors.bearing.levels
    assert [one.name for one in found] == [
        "natural-rubber layers 20x8mm",
        "natural-rubber layers 25x8mm",
    ]
    one = {key: value if isinstance(value, str) else value[1] for key, value in size.items()}
    assert found[1] == new_bearing(found[1].name, "natural-rubber", **one)


def test_bearings_whose_lead_differs_are_not_as_warm(tmp_path: Path) -> None:
    thin = tb.changed_bearing(LHDR, name="thin", lead={"diameter": 150.0})
    tb.save_bearing(thin, tmp_path / "thin.toml")
    air = {"climate": "cold-town", "years": 1}
    levels = [LHDR, str(tmp_path / "thin.toml")]
    runs, done = tasks(study(DRAWS, bearing=levels, ambient=air))
    weather = generate_weather("cold-town", 1, 0)
    for hour, task in zip(runs["hour"], done, strict=True):
        own = build_device(task.case, task.device.bearing)
        alone = soaked_hours(own, weather, np.array([hour]))
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
        cells, lead = soaked(task.device, weather.before(int(runs["hour"][k]), 48.0))
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
def test_distributions_have_the_moments_that_are_told(
    kind: str, words: dict[str, float], mean: float, deviation: float
) -> None:
    made = study(
        {"kind": "monte-carlo", "samples": 1}, **{"bearing.K_r": {"distribution": kind} | words}
    )
    from thermobearing.studies.definition.designs import list_columns

    found = list_columns(made)[-1].distribution
    assert found is not None
    points = (np.arange(100_000) + 0.5) / 100_000
    values = found.at(points)
    assert values.mean() == pytest.approx(mean, rel=tol.QUADRATURE_OF_TAILS)
    assert values.std() == pytest.approx(deviation, rel=tol.QUADRATURE_OF_TAILS)


def test_a_distribution_is_cut_off() -> None:
    cut = Distribution("normal", 0.0, 1.0, -1.0, 0.5)
    values = cut.at(np.linspace(0.0, 1.0, 1001))
    assert (values[0], values[-1]) == (-1.0, 0.5)
    assert (np.diff(values) > 0.0).all()


def test_levels_by_lot_have_their_weights() -> None:
    motion = {"levels": ["jra-ii-i-1", "jra-ii-i-2"], "random": True, "weights": [3, 1]}
    runs = plan(study({"kind": "latin-hypercube", "samples": 400}, motion=motion))
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
    pd.testing.assert_frame_equal(plan(again), plan(made), check_exact=True)
