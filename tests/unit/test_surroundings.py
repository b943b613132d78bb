"""Heat exchange of a bearing in the weather: defaults, keys of the user, and messages."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from thermobearing.earthquake.case import EarthquakeCase, make_earthquake_case
from thermobearing.earthquake.report import _input_tables
from thermobearing.earthquake.run import build_device
from thermobearing.model.options import ModelOptions, Side, build_model, outdoors
from thermobearing.model.stack import EndFace, film_at_face, through_side
from thermobearing.studies.definition.case import make_study
from thermobearing.studies.definition.designs import Plan
from thermobearing.studies.definition.targets import affects_rest_temperature
from thermobearing.studies.question import Question
from thermobearing.studies.result import StudyResult
from thermobearing.studies.run.prepare import _thermal_key

FILM = EndFace(film=12.0)
OPEN = (FILM, FILM, Side(film=12.0, cover=10.0))
LABORATORY = (EndFace(eta=2.0), EndFace(eta=2.0), None)
TOWN = {"climate": "cold-town", "years": 1}


@pytest.fixture
def night(tmp_path: Path) -> str:
    (tmp_path / "night.csv").write_text("time_h,temperature_degC\n0,-5\n12,-25\n")
    return str(tmp_path / "night.csv")


def make_case(**given: Any) -> EarthquakeCase:
    table = {"command": "bridge", "bearings": ["shen-lhdr-bridge"], "duration": "0.05 s"}
    return make_earthquake_case(table | {"motions": ["jra-ii-i-1"]} | given, "test")


def exchange(case: EarthquakeCase) -> tuple[Any, ...]:
    return case.analysis.upper_face, case.analysis.lower_face, case.analysis.side


def make_weather_study(ambient: Any, **case: Any) -> Any:
    factors = {"bearing": "shen-hdr-bridge", "motion": "jra-ii-i-1", "ambient": ambient}
    table = {"kind": "study", "name": "s", "case": case, "factors": factors}
    table["design"] = {"kind": "monte-carlo", "samples": 2} if isinstance(ambient, dict) else {}
    return make_study(table, "test")


def test_weather_brings_films_and_cover(night: str) -> None:
    assert exchange(make_case(weather=night)) == OPEN
    assert exchange(make_case()) == LABORATORY
    line = [{"line": "G1-G5", "weather": night}]
    assert exchange(make_case(lines=line)) == OPEN
    assert exchange(make_weather_study(TOWN).case) == OPEN
    assert exchange(make_weather_study("0 degC").case) == LABORATORY


def test_keys_of_the_user_count(night: str) -> None:
    given = {"upper_face": {"eta": 2.0}, "side": {"film": "25 W/(m^2 K)"}}
    expected = (EndFace(eta=2.0), FILM, Side(film=25.0))
    assert exchange(make_case(weather=night, analysis=given)) == expected
    assert exchange(make_weather_study(TOWN, analysis=given).case) == expected
    windy = {name: EndFace(film=25.0) for name in ("upper_face", "lower_face")}
    sheltered, wind = (
        tb.bearing_weather(
            "shen-hdr-bridge", tb.Hourly([0.0, -9.0, -9.0]), model=ModelOptions(**faces)
        )
        for faces in ({}, windy)
    )
    assert wind["rubber_degC"].iloc[-1] < sheltered["rubber_degC"].iloc[-1] < -1.0


def test_resolved_case_reads_back(night: str) -> None:
    import tomllib

    case = make_case(weather=night, analysis={"side": {"film": "25 W/(m^2 K)", "cover": "5 mm"}})
    again = make_earthquake_case(tomllib.loads(case.to_toml()), "again")
    assert exchange(again) == exchange(case)


def test_through_the_side_by_hand() -> None:
    bearing = tb.load_bearing("shen-lhdr-bridge")
    along = (102.0 * 0.31 + (5 * 6.4 + 100.0) * 38.76) / (102.0 + 5 * 6.4 + 100.0)
    inside = 0.5 * 0.48**2 / (4 * 0.48) / along
    expected = 1.0 / (1.0 / 12.0 + 0.010 / 0.31 + inside)
    assert through_side(bearing, 12.0, 10.0) == pytest.approx(expected, rel=1e-12)
    assert through_side(bearing, 0.0, 10.0) == 0.0
    stack = ModelOptions(side=Side(film=12.0, cover=10.0)).build_stack(bearing)
    assert stack.side_film == pytest.approx(1e-6 * expected, rel=1e-12)


@pytest.mark.parametrize("lower", [EndFace(film=3.0, heat_capacity=500.0), EndFace(eta=2.0)])
def test_a_mass_behind_a_face_is_a_cell(lower: EndFace) -> None:
    upper = EndFace(film=12.0, heat_capacity=1000.0)
    bearing = tb.load_bearing("shen-lhdr-bridge")
    model = build_model(bearing, ModelOptions(upper_face=upper, lower_face=lower))
    cells, both = model.constants.cells, lower.heat_capacity is not None
    assert model.stack.part[0] == "mass"
    assert (model.stack.part[-1] == "mass") == both
    area = 480.0**2
    assert cells.capacity[0] == pytest.approx(1000.0 * 1e-3 * area, rel=1e-12)
    assert cells.end_loss[0] * cells.capacity[0] == pytest.approx(12e-6 * area, rel=1e-9)
    assert cells.side_loss[0] < 1e-9 * cells.side_loss[1:].max() + 1e-30
    plate = cells.to_previous[1] * cells.capacity[1]  # half a cell of the plate
    assert plate == pytest.approx(area * 38.76e-3 / (0.5 * 70.0 / 20), rel=1e-6)
    assert cells.to_next[0] * cells.capacity[0] == pytest.approx(plate, rel=1e-12)
    if both:
        assert cells.end_loss[-1] * cells.capacity[-1] == pytest.approx(3e-6 * area, rel=1e-9)
    assert film_at_face(upper, model.stack, 0) == np.inf  # for the plate, held by the mass
    modes = model.constants.lead_modes
    assert np.isfinite(modes["resistance"]).all()
    plain = build_model(bearing, ModelOptions(stack="full")).constants
    assert len(plain.lead_cells) == len(model.constants.lead_cells)
    assert_allclose(plain.lead.capacity, model.constants.lead.capacity, rtol=1e-12)


def test_film_at_a_face_is_without_half_the_outer_cell() -> None:
    """A film is itself; eta = 3 holds the face, since half a cell conducts 2 k/thickness."""
    stack = build_model(tb.load_bearing("shen-lhdr-bridge"), ModelOptions()).stack
    half = 2.0 * stack.conductivity[0] / stack.thickness[0]
    assert film_at_face(FILM, stack, 0) == pytest.approx(12e-6)
    assert film_at_face(EndFace(eta=2.0), stack, 0) == pytest.approx(half)
    assert film_at_face(EndFace(eta=3.0), stack, 0) == np.inf


def test_balance_closes_with_masses_and_cover() -> None:
    face = EndFace(film=12.0, heat_capacity=1000.0)
    test = tb.cyclic_test(strain=[1.0], cycles=2)
    side = Side(film=12.0, cover=10.0)
    result = tb.run(
        "shen-hdr-bridge",
        test,
        ambient=-10,
        initial=5.0,
        model=tb.ModelOptions(upper_face=face, lower_face=face, side=side),
    )
    data = result.dataset.isel(ambient=0, time=-1)
    balance = data["heat_released"] - data["heat_stored"] - data["heat_lost_ends"]
    balance -= data["heat_lost_sides"]
    assert abs(float(balance)) < 1e-9 * float(data["heat_released"])


@pytest.mark.parametrize(
    ("faulty", "reported"),
    [
        ({"upper_face": {"eta": 2.0, "heat_capacity": "9 kJ/(m^2 K)"}}, "combined with film"),
        ({"side": {"cover": "10 mm"}}, "side.film"),
        ({"side": {"film": "12 W/(m^2 K)", "cover": "-1 mm"}}, "side.cover"),
        ({"upper_face": {"film": "9 W/(m^2 K)", "heat_capacity": "0 kJ/(m^2 K)"}}, "upper_face"),
        (
            {
                "scheme": "published",
                "upper_face": {"film": "9 W/(m^2 K)", "heat_capacity": "9 kJ/(m^2 K)"},
            },
            "conservative",
        ),
    ],
)
def test_what_does_not_go_together(faulty: dict[str, Any], reported: str, night: str) -> None:
    with pytest.raises(tb.InputError, match=reported):
        make_case(weather=night, analysis=faulty)


def test_side_is_part_of_how_a_bearing_takes_on_warmth(night: str) -> None:
    cases = [
        make_case(weather=night, analysis={"side": {"film": f"{film} W/(m^2 K)"}})
        for film in (5, 6)
    ]
    keys = [_thermal_key(build_device(case, case.bearings[0]), case) for case in cases]
    assert keys[0] != keys[1]
    drawn = {"distribution": "uniform", "low": "8 W/(m^2 K)", "high": "25 W/(m^2 K)", "of": "value"}
    ambient = TOWN | {"history": "10 d"}
    factors = {"bearing": "shen-hdr-bridge", "motion": "jra-ii-i-1", "ambient": ambient}
    factors["case.analysis.side.film"] = drawn
    table = {"kind": "study", "name": "s", "factors": factors}
    study = make_study(table | {"design": {"kind": "monte-carlo", "samples": 2}}, "test")
    assert [affects_rest_temperature(target) for target in Plan(study).targets] == [True]


def test_report_and_result_tell_the_exchange(night: str) -> None:
    result = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", ambient=night, duration=0.05)
    assert "12 W/(m² K)" in result.summary()["surroundings"]
    import tomllib

    case = tomllib.loads(result.dataset.attrs["case"])
    rows = {row[0]: row for row in _input_tables(result, case)["analysis"].rows}
    assert "ISO 6946" in str(rows["Film coefficient of the upper face"])
    assert "Shen (2023)" in str(rows["Cover rubber of the side"])
    plain = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", ambient=0, duration=0.05)
    assert "surroundings" not in plain.summary()


def test_a_climate_beside_levels_counts_the_temperature_of_the_rubber() -> None:
    weather = tb.generate_weather("cold-town", 2, 3)
    case = {"analysis": {"side": {"film": "25 W/(m^2 K)"}}}
    table = {"kind": "study", "name": "s", "case": case | {"duration": "0.05 s"}}
    factors: dict[str, Any] = {"bearing": ["shen-hdr-bridge", "shen-bilinear-bridge"]}
    factors |= {"motion": "jra-ii-i-1", "ambient": ["-20 degC", "20 degC"]}
    study = make_study(table | {"factors": factors}, "test")
    rows = pd.DataFrame({"bearing": factors["bearing"]})
    question = Question()
    question._temperatures = weather
    layered, bilinear = (
        StudyResult(rows.iloc[[k]], study, {}, question=question)._rubber() for k in range(2)
    )
    known = tb.bearing_weather("shen-hdr-bridge", weather, model=ModelOptions(side=Side(film=25.0)))
    np.testing.assert_array_equal(layered, known["rubber_degC"])
    np.testing.assert_array_equal(bilinear, weather.temperature)
    assert np.min(layered) > np.min(weather.temperature) + 2.0


def test_values_of_the_file_are_what_they_cite() -> None:
    """h = 4 + 4 v + 0.9 h_r0 with v = 1 m/s and h_r0 = 4 sigma T^3 at 0 degC, rounded."""
    values, sources = outdoors()
    film = 4.0 + 4.0 * 1.0 + 0.9 * 4.0 * 5.670374e-8 * 273.15**3
    assert values["side"]["film"] == f"{film:.0f} W/(m^2 K)"
    assert set(sources) == {"upper_face.film", "lower_face.film", "side.film", "side.cover"}
