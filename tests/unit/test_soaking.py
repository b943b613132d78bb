"""A bearing through hourly weather in one pass: the same as soaking it from far enough back."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import thermobearing as tb
from tests import tolerances as tol
from tests.quick import quick_cases
from thermobearing.climate.hourly import HOUR
from thermobearing.cyclic.history import build_segments, run_segments
from thermobearing.cyclic.protocol import CyclicTest
from thermobearing.earthquake import run
from thermobearing.earthquake.case import make_earthquake_case

WEATHER = tb.generate_weather("cold-town", years=1, seed=2)
LOOKED_AT = 400
UNSETTLED = ("LHDR, half-space", "LHDR, published")
OPTIONS = {
    "HDR": ("shen-hdr-bridge", {}),
    "LHDR": ("shen-lhdr-bridge", {}),
    "LHDR, half-space": ("shen-lhdr-bridge", {"lead_ends": "half-space"}),
    "LHDR, published": ("shen-lhdr-bridge", {"scheme": "published"}),
    "two faces": ("shen-lhdr-bridge", {"lower_face": {"eta": 2.0}}),
}


def make_device(name: str, **analysis: object) -> run.Device:
    case = make_earthquake_case(
        {"command": "bridge", "bearings": [name], "analysis": analysis}, "test"
    )
    return run.build_device(case, case.bearings[0])


@pytest.mark.parametrize("kind", quick_cases(list(OPTIONS), 0))
def test_pass_is_the_rests_of_all_hours_in_a_row(kind: str) -> None:
    name, analysis = OPTIONS[kind]
    device = make_device(name, **analysis)
    rests = CyclicTest(dt=10.0, steps=[{"step": "rest", "duration": HOUR}] * LOOKED_AT)
    air = WEATHER.before(LOOKED_AT, LOOKED_AT)
    uniform = np.full(len(device.constants.cells.capacity), air.temperature[0])
    history = run_segments(device.constants, build_segments(rests, 1.0), air, uniform, groups=())
    temperature, lead = run.soaked_hours(device, WEATHER, np.array([LOOKED_AT])).at(0)
    within = tol.HALF_SPACE_SETTLES if kind in UNSETTLED else tol.HOURS_OF_REST
    assert_allclose(temperature, history.state.temperature, atol=within)
    if lead is not None:
        assert_allclose(lead, history.state.branches[0].lead_temperature, atol=within)


@pytest.mark.parametrize("name", ["shen-hdr-bridge", "shen-lhdr-bridge"])
def test_same_as_soaking_from_far_enough_back(name: str) -> None:
    """That takes steps of 600 s, in which lead lags behind."""
    device = make_device(name)
    hours = np.array([5000, 1500, 4000])
    result = run.soaked_hours(device, WEATHER, hours)
    for place, hour in enumerate(hours):
        temperature, lead = run._soaked(device, WEATHER.before(int(hour), 720))
        assert_allclose(result.temperature[place], temperature, atol=tol.TEN_MINUTES)
        if lead is not None:
            assert_allclose(result.at(place)[1], lead, atol=tol.TEN_MINUTES_OF_LEAD)


@pytest.mark.parametrize("name", ["shen-hdr-bridge", "shen-lhdr-bridge"])
def test_weights_of_a_history_are_its_hours_in_a_row(name: str) -> None:
    device, hours = make_device(name), 12
    air = WEATHER.temperature[: hours + 1]
    weights = run.history_weights(device.constants, hours)
    temperature, lead = run.soaked_history(device.constants, weights, air)
    one_by_one = run.soaked_hours(device, tb.Hourly(air), np.array([hours]))
    assert_allclose(temperature, one_by_one.temperature[0], atol=tol.HOURS_OF_REST)
    if lead is not None:
        assert_allclose(lead, one_by_one.at(0)[1], atol=tol.HOURS_OF_REST)


def test_some_hours_are_those_of_all() -> None:
    device = make_device("shen-lhdr-bridge")
    every = run.soaked_hours(device, WEATHER)
    some = run.soaked_hours(device, WEATHER, np.array([300, 0, 300, 7]))
    assert_array_equal(some.temperature, every.temperature[[300, 0, 300, 7]])
    assert_array_equal(some.lead, every.lead[[300, 0, 300, 7]])
    assert_array_equal(every.temperature[0], WEATHER.temperature[0])


def test_typical_year_has_had_the_days_before() -> None:
    device = make_device("shen-hdr-bridge")
    year = tb.Hourly(WEATHER.temperature[:2000], recurs=True)
    twice = tb.Hourly(np.tile(WEATHER.temperature[:2000], 2))
    assert run.SPIN_UP < 2000
    first = run.soaked_hours(device, year, np.array([0, 10])).temperature
    second = run.soaked_hours(device, twice, np.array([2000, 2010])).temperature
    assert_allclose(first, second, atol=tol.HOURS_OF_REST)


def test_bilinear_has_no_temperature() -> None:
    result = run.soaked_hours(make_device("shen-bilinear-bridge"), WEATHER, np.array([1, 2]))
    assert result.temperature.shape == (2, 1)
    assert result.at(1)[1] is None
    with pytest.raises(tb.InputError, match="has no temperature"):
        tb.bearing_weather("shen-bilinear-bridge", WEATHER)


@pytest.mark.parametrize("hours", [[0, len(WEATHER)], [-1, 5]])
def test_hours_that_the_weather_does_not_have(hours: list[int]) -> None:
    with pytest.raises(tb.InputError, match=f"0 to {len(WEATHER) - 1}"):
        run.soaked_hours(make_device("shen-hdr-bridge"), WEATHER, np.array(hours))
