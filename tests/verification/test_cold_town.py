"""The built-in studies of a cold town: hours of its weather against levels of the temperature."""

from typing import Any

import numpy as np
import pytest

from tests import tolerances as tol
from tests.conftest import Recorder
from thermobearing.border.library import data_path
from thermobearing.border.toml import read_toml
from thermobearing.climate.generator import generate_weather
from thermobearing.studies.definition.case import load_study, make_study
from thermobearing.studies.definition.designs import Plan
from thermobearing.studies.run.prepare import Preparer
from thermobearing.studies.run.shard import _measure_all

DEMANDS = ("pier_rotation_max_rad", "bearing_displacement_max_mm", "bearing_force_max_kN")


def cold_town(name: str, **factors: Any) -> Any:
    """One of the studies with one motion at one intensity, cut to fourteen seconds."""
    table = read_toml(data_path("studies", f"{name}.toml"))
    table["case"]["duration"] = "14 s"
    table["factors"] |= {"bearing": "shen-lhdr-bridge", "motion": "jra-ii-i-1"}
    table["factors"]["scale"]["levels"] = ["6 m/s2"]
    table["factors"] |= factors
    if "design" in table:
        table["design"]["samples"] = 12
    study = make_study(table, name)
    prepared, runs = Preparer(Plan(study)), Plan(study).runs
    prepared.compute_temperatures(runs)
    rows = runs.to_dict("records")
    result = {demand: [] for demand in DEMANDS}
    for row in rows:
        given = prepared.make_task(row)
        numbers = next(_measure_all([given])).numbers
        middles = np.concatenate(given.device.stack.middles())
        row["rubber_degC"] = given.reported.temperature[middles].mean()
        assert numbers["outcome"] == "completed"
        for demand in DEMANDS:
            result[demand].append(numbers[demand])
    return rows, result


@pytest.mark.thorough
def test_hours_with_their_weather_are_as_the_levels_of_the_temperature(measured: Recorder) -> None:
    """A bearing whose rubber has a mean temperature behaves as one that has it all through.

    By the temperature of the air of single hours it would be wrong by 10 %.
    """
    ambient = [f"{degrees} degC" for degrees in range(-30, 31, 3)]
    rows, levels = cold_town("cold-town-levels", ambient=ambient)
    air = [row["rubber_degC"] for row in rows]
    np.testing.assert_allclose(air, [row["ambient_degC"] for row in rows], atol=tol.MEAN)
    hours, result = cold_town("cold-town")
    at = [row["rubber_degC"] for row in hours]
    assert np.ptp(at) > 20.0
    worst = 0.0
    for demand in DEMANDS:
        reported = np.interp(at, air, levels[demand])
        assert np.ptp(reported) > 0.05 * np.mean(reported)  # the temperature matters
        worst = max(worst, float(np.abs(np.array(result[demand]) / reported - 1.0).max()))
    measured(
        "Cold town: peaks at 12 hours of weather against bearings that are as warm all through",
        worst,
        f"{tol.LEVEL_FOR_AN_HOUR:g}",
    )
    assert worst < tol.LEVEL_FOR_AN_HOUR


def test_studies_are_what_they_say() -> None:
    hours, levels = (load_study(name) for name in ("cold-town", "cold-town-levels"))
    assert [len(Plan(study).runs) for study in (hours, levels)] == [4032, 2520]
    in_hours, stripes = (
        [float(level.split()[0]) for level in study.factors.scale.levels]
        for study in (hours, levels)
    )
    assert set(in_hours) < set(stripes)
    assert sorted(Plan(levels).runs["Sa_m_s2"].unique()) == stripes  # to the last bit
    table = Plan(hours).runs
    weather = generate_weather("cold-town", years=50, seed=1)
    air = table["ambient_degC"].to_numpy()
    np.testing.assert_allclose(air, weather.temperature[table["hour"].to_numpy()], atol=tol.MEAN)
    assert abs(air.mean() - weather.temperature.mean()) < tol.MONTHLY_MEAN
    assert table["hour"].nunique() > 3900  # a separate hour for each run
    assert hours.factors.motion == levels.factors.motion
    assert hours.factors.scale.period == levels.factors.scale.period
