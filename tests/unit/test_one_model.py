"""One bearing is one model in every analysis; the element does what the march does."""

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.inputs import assert_refused, changed_table, specimen_table, write_toml
from tests.verification.models import assembled, marched, smooth_history, specimen
from thermobearing.bearing.library import as_bearing, bearing_from_table
from thermobearing.core.types import HEAT_FROM_DISSIPATION, HEAT_FROM_WORK, Floats, State
from thermobearing.cyclic.case import make_case, to_table
from thermobearing.cyclic.equivalent import bilinear_parameters, isothermal_cycle
from thermobearing.design.factors import scale_study, scaled_bearing
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.earthquake.run import build_device
from thermobearing.identify.fit.forward import ForwardModel
from thermobearing.identify.fit.parameters import parameter_set
from thermobearing.identify.fit.synthetic import generic_start, synthetic_record
from thermobearing.model.earlier import models_that_fit
from thermobearing.model.options import ModelOptions, build_model
from thermobearing.model.stack import EndFace

HDR = "shen-hdr-bridge"
SHORT = tb.cyclic_test(strain=[1.0], cycles=1, rest=None, dt=0.02)
RECORD = synthetic_record(tb.load_bearing(HDR), 23.0, SHORT)
PARAMETERS = ["strength", "post_yield", "initial"]


def _factors(bearing: Any) -> Any:
    return tb.temperature_factors(
        bearing, reference_temperature=23, temperatures=[0], strains=[1.0], cycles=[1]
    )


# What every public function makes of a bearing.
TAKERS: dict[str, Callable[[Any], Any]] = {
    "run": lambda b: tb.run(b, SHORT).dataset["force"].values,
    "bridge": lambda b: tb.bridge(b, "jra-ii-i-1", 0, duration=0.2)["bearing_force"].values,
    "hybrid": lambda b: tb.hybrid(b, "jra-ii-i-1", 0, duration=0.2)["bearing_force"].values,
    "BearingElement": lambda b: tb.BearingElement(b, 23.0).set_trial(5.0, 0.1, 23.0).force,
    "bilinear_parameters": lambda b: [getattr(bilinear_parameters(b), n) for n in PARAMETERS],
    "isothermal_cycle": lambda b: isothermal_cycle(b, 1.0).energy_kN_mm,
    "bounds_study": lambda b: tb.bounds_study(b, "jra-ii-i-1", [0.0, 23.0], duration=0.2),
    "check_test": lambda b: tb.check_test(RECORD, b).outcome,
    "equal_bearing": lambda b: tb.equal_bearing(b, 2.0, 150.0).stiffness,
    "forgotten": lambda b: generic_start(b).model_dump_json(),
    "identify_bearing": lambda b: list(
        tb.identify_bearing(RECORD, b, free=["K_r"], starts=1, start_from="bearing").values.values()
    ),
    "parameter_set": lambda b: parameter_set(b, ["K_r"], [23.0]).start,
    "scale_study": lambda b: scale_study(b, factors=[0.5], dt=0.05)[0],
    "scaled_bearing": lambda b: scaled_bearing(b, 0.5).model_dump_json(),
    "synthetic_record": lambda b: synthetic_record(b, 23.0, SHORT).force,
    "temperature_factors": _factors,
    "temperature_factors, several": lambda b: _factors([b, b]),
}


# Several runs each; a bearing is read in one place for all.
LONG = ("bounds_study", "equal_bearing", "identify_bearing", "temperature_factors, several")


@pytest.mark.parametrize(
    "take",
    [
        pytest.param(take, id=name, marks=pytest.mark.thorough if name in LONG else ())
        for name, take in TAKERS.items()
    ],
)
def test_a_bearing_by_name_file_and_record(take: Callable[[Any], Any], tmp_path: Path) -> None:
    bearing = tb.load_bearing(HDR)
    path = write_toml(tmp_path / "mine.toml", to_table(bearing))
    wanted = take(bearing)
    for given in (HDR, path, str(path)):
        result = take(given)
        if isinstance(wanted, pd.DataFrame):
            pd.testing.assert_frame_equal(result, wanted, check_exact=True)
        else:
            assert_array_equal(result, wanted)


@pytest.mark.parametrize("take", TAKERS.values(), ids=TAKERS)
@pytest.mark.parametrize(
    ("given", "pieces"),
    [
        ("shen-hdr-brige", ['no bearing is named "shen-hdr-brige"', HDR]),
        (Path("nowhere.toml"), ["nowhere.toml", "no such file"]),
        (3, ["= 3"]),
    ],
    ids=["misspelt", "no file", "number"],
)
def test_what_is_no_bearing_is_reported(
    take: Callable[[Any], Any], given: Any, pieces: list[str]
) -> None:
    assert_refused(lambda: take(given), *pieces)


def test_a_table_is_a_bearing() -> None:
    bearing = tb.load_bearing(HDR)
    assert as_bearing(to_table(bearing)).model_dump() == bearing.model_dump()  # sources apart


@pytest.mark.parametrize("name", tb.list_bearings())
def test_one_heat_source_everywhere(name: str) -> None:
    bearing = tb.load_bearing(name)
    wanted = HEAT_FROM_DISSIPATION if bearing.kind == "LRB" else HEAT_FROM_WORK
    case = make_case({}, "test", bearing=bearing)
    study = make_earthquake_case({"command": "bridge"}, "test", bearings=[bearing])
    sources = {
        "alone": build_model(bearing).constants.heat_source,
        "cyclic test": build_model(bearing, case.analysis).constants.heat_source,
        "earthquake": build_device(study, bearing).constants.heat_source,
        "identification": ForwardModel(RECORD, bearing)._constants.heat_source,
        "element": tb.BearingElement(bearing, 0.0)._constants.heat_source,
    }
    assert sources == dict.fromkeys(sources, wanted)
    assert case.analysis.heat_source == build_model(bearing).options.heat_source
    other = ModelOptions(heat_source="work")
    assert build_model(bearing, other).constants.heat_source == HEAT_FROM_WORK


def test_yield_stress_comes_back_from_a_test_without_noise() -> None:
    """With another heat source in the fit than in the test it comes back as 10.013 MPa."""
    test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None, wave="sine")
    record = synthetic_record("lrb-example", 23.0, test, noise=0.0)
    result = tb.identify_bearing(record, "lrb-example", free=["K_r", "K_l", "sigma_Y"], starts=1)
    assert result.values["lead.yield_stress"] == pytest.approx(10.0, rel=tol.NOISE_FREE_STRENGTH)


FULL_PROFILE = np.linspace(-10.0, 20.0, 86).tolist()  # a temperature for each cell of the height


@pytest.mark.parametrize(
    ("bearing", "model", "given"),
    [
        (HDR, {"scheme": "published", "integrator": "euler", "upper_face": EndFace(film=5.0)}, {}),
        (HDR, {"hardening": "monotone"}, {}),
        (HDR, {"stack": "full", "heat_source": "dissipation"}, {"initial": FULL_PROFILE}),
        ("shen-lhdr-specimen", {"model": "single-temperature", "lower_face": EndFace(eta=1.0)}, {}),
        ("shen-lhdr-specimen", {"lead_ends": "finite-plate"}, {"initial_lead": 60.0}),
        ("shen-lhdr-specimen", {"lead_ends": "half-space", "clock": "lead"}, {}),
    ],
    ids=["published", "monotone", "full height", "one temperature", "lead", "clock"],
)
def test_element_with_options_is_the_run(
    bearing: str, model: dict[str, Any], given: dict[str, Any]
) -> None:
    lead = (
        {"initial": tb.InitialState(lead=given["initial_lead"])} if "initial_lead" in given else {}
    )
    options = {name: value for name, value in given.items() if name != "initial_lead"}
    chosen = tb.ModelOptions(**model)
    result = tb.run(bearing, SHORT, ambient=0.0, model=chosen, **options, **lead)
    element = tb.BearingElement(bearing, ambient=0.0, model=chosen, **given)
    x, clock = result["displacement"].values[0], result["time"].values
    forces = [0.0]
    for k in range(1, len(x)):
        forces.append(element.set_trial(x[k], clock[k] - clock[k - 1]).force)
        element.commit()
    peak = np.abs(forces).max()
    np.testing.assert_allclose(
        result["force"].values[0], forces, rtol=0.0, atol=tol.CLOCK_FORCE * peak
    )


@pytest.mark.parametrize(
    ("make", "pieces"),
    [
        (lambda: tb.BearingElement(HDR, 500.0), ["ambient", "-100 to 100 degC"]),
        (lambda: tb.BearingElement(HDR, np.nan), ["ambient", "nan"]),
        (lambda: tb.BearingElement(HDR, "cold"), ["ambient", "'cold'"]),
        (lambda: tb.BearingElement(HDR, initial=[1.0, 2.0]), ["initial", "has 2 numbers", "cells"]),
        (lambda: tb.BearingElement(HDR, initial=500.0), ["initial", "-100 to 100 degC"]),
        (lambda: tb.BearingElement(HDR, initial="cold"), ["initial = 'cold'"]),
        (lambda: tb.BearingElement(HDR, initial_lead=5.0), ["initial_lead", "with lead"]),
        (
            lambda: tb.BearingElement(HDR, model=tb.ModelOptions(scheme="publishd")),
            ["scheme", '"published"?'],
        ),
        (lambda: tb.BearingElement(HDR, model="lead-alone"), ["model", "with lead"]),
        (lambda: tb.BearingElement(HDR, model="bilinear"), ['"bilinear"', "bilinear constants"]),
        (lambda: tb.BearingElement("shen-hdr"), ["bearing", "did you mean"]),
    ],
    ids=range(11),
)
def test_bad_element(make: Callable[[], Any], pieces: list[str]) -> None:
    assert_refused(make, *pieces)


def test_resolved_study_says_every_option_and_reads_back() -> None:
    study = make_earthquake_case(
        {"command": "bridge"}, "test", bearings=[HDR], model="adiabatic", stack="full"
    )
    table = tomllib.loads(study.to_toml())
    assert table["analysis"]["model"] == "adiabatic"
    unset = {"hardening", "small_loops", "heat_source", "lead_ends", "clock"}  # of bearings
    unset |= {"side", "exposure", "state"}
    assert set(ModelOptions.model_fields) - set(table["analysis"]) == unset
    assert make_earthquake_case(table, "again").model_dump() == study.model_dump()


def test_earlier_models_in_an_earthquake() -> None:
    common = {"bearing": HDR, "motion": "jra-ii-i-1", "ambient": -20, "duration": 8}
    runs = {
        model: tb.bridge(model=model, **common)
        for model in ("multi-layer", "adiabatic", "per-cycle", "temperature-blind", "bilinear")
    }
    energy = {model: float(run["bearing_energy_end"][0]) for model, run in runs.items()}
    assert len(set(energy.values())) == len(runs)
    hottest = {model: float(run["rubber_temperature"].max()) for model, run in runs.items()}
    assert hottest["adiabatic"] > hottest["multi-layer"] > hottest["per-cycle"] > -20.0
    assert hottest["bilinear"] == -20.0
    with pytest.raises(tb.InputError, match=r'analysis\.model = "lead-alone": needs .*lead'):
        tb.bridge(model="lead-alone", **common)


def test_earlier_models_go_with_the_published_scheme() -> None:
    test = tb.cyclic_test(strain=[1.75], cycles=2, wave="sine")
    for model in models_that_fit(tb.load_bearing("shen-lhdr-specimen")):
        pair = [
            tb.run(
                "shen-lhdr-specimen", test, 0.0, model=tb.ModelOptions(model=model, scheme=scheme)
            )
            for scheme in ("conservative", "published")
        ]
        assert [one.outcome for one in pair] == ["completed"] * 2, model
        own, printed = (float(np.abs(one["force"].values).max()) for one in pair)
        assert printed == pytest.approx(own, rel=0.01), model


AIR, START, DT = -20.0, -10.0, 0.005
PATH = smooth_history(np.random.default_rng(12), 90.0, 400)  # 300 % in the cold: softening too


def fresh() -> tb.BearingElement:
    constants = assembled(specimen())
    return tb.BearingElement.from_constants(constants, START)


def assert_same_state(one: State, other: State) -> None:
    for a, b in zip(one, other, strict=True):
        assert_array_equal(a, b)


def follow(element: tb.BearingElement, path: Floats) -> list[float]:
    forces = []
    for x in path:
        trial = element.set_trial(float(x), DT, AIR)
        assert trial.outcome == "completed"
        forces.append(trial.force)
        element.commit()
    return forces


def test_committed_trials_are_the_march() -> None:
    run = marched(assembled(specimen()), PATH, DT, START, AIR)
    assert run.softened > 0
    element = fresh()
    assert_array_equal(follow(element, PATH), run.response["force"])
    assert_array_equal(element.state.temperature, run.cells[-1])
    assert element.state.response[0].displacement == PATH[-1]


def test_trials_that_are_not_committed_leave_no_trace() -> None:
    """A solver that proposes three wrong displacements before each right one gets the same."""
    plain, searching = fresh(), fresh()
    rng = np.random.default_rng(2)
    for x in PATH:
        for wrong in rng.uniform(-90.0, 90.0, 3):
            searching.set_trial(float(wrong), 7 * DT, 40.0)
        trials = [element.set_trial(float(x), DT, AIR) for element in (plain, searching)]
        assert trials[0] == trials[1]
        plain.commit()
        searching.commit()
    assert_same_state(plain.state, searching.state)


def test_commit_twice_moves_once() -> None:
    element = fresh()
    element.set_trial(3.0, DT, AIR)
    element.commit()
    once = element.save()
    element.commit()
    assert_same_state(element.state, once)
    assert element.state.response[0].clock == DT


def test_revert_to_start() -> None:
    element = fresh()
    virgin = element.save()
    first = follow(element, PATH)
    element.revert_to_start()
    assert_same_state(element.state, virgin)
    assert_array_equal(follow(element, PATH), first)


def test_save_and_restore() -> None:
    element = fresh()
    follow(element, PATH[:150])
    saved = element.save()
    rest = follow(element, PATH[150:])
    assert saved.response[0].displacement == PATH[149]  # a copy: the motion went on without it
    element.restore(saved)
    assert_array_equal(follow(element, PATH[150:]), rest)


def test_failed_trial_cannot_be_committed() -> None:
    """After a trial that ran away the element is where it was, and a commit says so."""
    table = changed_table(specimen_table(), {"hysteresis.yield_displacement": "0.1 mm"})
    constants = assembled(bearing_from_table(table, "table"), integrator="euler")
    element = tb.BearingElement.from_constants(constants, START)
    follow(element, np.array([0.01, 0.02]))
    before = element.save()
    trial = element.set_trial(60.0, DT, AIR)
    assert trial.outcome == "euler_unstable"
    with pytest.raises(tb.InputError, match="ended as euler_unstable"):
        element.commit()
    assert_same_state(element.state, before)
    assert element.set_trial(0.03, DT, AIR).outcome == "completed"
    element.commit()
    assert element.state.response[0].displacement == 0.03


@pytest.mark.parametrize("back", ["restore", "revert_to_start"])
def test_a_failed_trial_is_forgotten_with_its_state(back: str) -> None:
    element = fresh()
    saved = element.save()
    assert element.set_trial(float("nan"), DT, AIR).outcome == "not_finite"
    if back == "restore":
        element.restore(saved)
    else:
        element.revert_to_start()
    element.commit()
    assert_same_state(element.state, saved)


@pytest.mark.parametrize("name", ["shen-hdr-specimen", "shen-lhdr-specimen"])
def test_an_element_goes_on_where_a_test_ended(name: str) -> None:
    """As a second test of the package does, forces and temperatures to the bit."""
    test = tb.cyclic_test(strain=[1.0], cycles=1, rest=None, dt=0.01, closing_strain=None)
    first = tb.run(name, test, ambient=AIR)
    second = tb.run(name, test, ambient=AIR, initial=first)
    element = tb.element(name, ambient=AIR, initial=tb.end_state(first, name))
    x, clock = second["displacement"].values[0], second["time"].values
    forces = [float(element.state.response["force"][0])]
    for k in range(1, len(x)):
        forces.append(element.set_trial(x[k], clock[k] - clock[k - 1]).force)
        element.commit()
    peak = np.abs(forces).max()
    assert_allclose(second["force"].values[0], forces, rtol=0.0, atol=tol.CLOCK_FORCE * peak)
    element.revert_to_start()
    assert element.state.response["force"][0] == first["force"].values[0, -1]


def test_an_element_begins_only_where_its_bearing_was() -> None:
    test = tb.cyclic_test(strain=[0.5], cycles=1, rest=None, dt=0.02)
    result = tb.run("shen-hdr-specimen", test, ambient=[AIR, 23.0])
    with pytest.raises(tb.InputError, match="not of this"):
        tb.end_state(result, "shen-lhdr-specimen", AIR)
    with pytest.raises(tb.InputError, match="2 runs"):
        tb.end_state(result, "shen-hdr-specimen")
    warm = tb.end_state(result, "shen-hdr-specimen", 23.0)
    assert min(warm.temperature) > 22.0
    with pytest.raises(tb.InputError, match="end_state"):
        tb.element("shen-hdr-specimen", initial=result)
    fine = tb.changed_bearing("shen-hdr-specimen", cells={"rubber": 4})
    with pytest.raises(tb.InputError, match="cells"):
        tb.element(fine, initial=warm)


def test_elements_in_one_call_are_the_single_ones() -> None:
    kinds = ((HDR, -20.0), ("shen-lhdr-bridge", 0.0), (HDR, 23.0))
    alone, together = ([tb.element(name, ambient=t) for name, t in kinds] for _ in range(2))
    line = tb.BearingElements(together)
    for step, x in enumerate(30.0 * np.sin(np.outer(np.arange(1, 60), [0.1, 0.2, 0.3]))):
        air = None if step % 2 else np.array([-10.0, 0.0, 10.0])
        result = line.set_trial(x, 0.05, air)
        line.commit()
        for k, one in enumerate(alone):
            trial = one.set_trial(float(x[k]), 0.05, None if air is None else float(air[k]))
            one.commit()
            assert (result.force[k], result.tangent[k], result.outcome[k]) == (
                *(trial.force, trial.tangent, trial.outcome),
            )
    for one, other in zip(alone, line.elements, strict=True):
        assert_array_equal(one.state.temperature, other.state.temperature)
    line.revert_to_start()
    assert [one.state.response["clock"][0] for one in together] == [0.0, 0.0, 0.0]


def test_elements_in_one_call_commit_all_or_none() -> None:
    line = tb.BearingElements([tb.element(HDR), tb.element(HDR)])
    assert line.set_trial([5.0, 1e9], 0.1).outcome[0] == "completed"
    with pytest.raises(tb.InputError):
        line.commit()
    assert line.elements[0].state.response["displacement"][0] == 0.0
    assert line.set_trial(5.0, 0.1).force[1] > 0.0
    line.commit()
    assert line.elements[1].state.response["displacement"][0] == 5.0
    one = tb.element(HDR)
    for make in (
        lambda: tb.BearingElements([]),
        lambda: tb.BearingElements([one, one]),
        lambda: line.set_trial([1.0, 2.0, 3.0], 0.1),
        lambda: line.set_trial([1.0, float("nan")], 0.1),
        lambda: line.set_trial(1.0, 0.0),
        lambda: line.set_trial(1.0, 0.1, [-20.0, -200.0]),
    ):
        with pytest.raises(tb.InputError):
            make()
