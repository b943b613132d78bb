"""No dead knobs: every number of a bearing, every option and every key of a test changes something.

A parameter that is read, checked, documented and then not used would pass all other tests.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from pydantic import BaseModel

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.inputs import SPECIMEN
from thermobearing.bearing.model import Bearing
from thermobearing.cyclic.case import Analysis, Case
from thermobearing.cyclic.protocol import Cycles, PlanePath, Ramp, Recorded, Rest
from thermobearing.model.options import Side
from thermobearing.tables.conditioning import Conditioning

STEPS = [
    {"step": "cycles", "strain": 1.5, "speed": 60.0, "count": 2, "closing_strain": 0.1},
    {"step": "rest", "duration": 60.0},
    {"step": "ramp", "to_strain": 0.7, "speed": 30.0},
]
TEST = tb.CyclicTest(dt=0.02, steps=STEPS)
FACE = tb.EndFace(film=20.0)


def list_numbers(model: BaseModel, key: str = "") -> Iterator[tuple[str, float | int]]:
    for name in type(model).model_fields:
        value, dotted = getattr(model, name), f"{key}.{name}" if key else name
        if isinstance(value, BaseModel):
            yield from list_numbers(value, dotted)
        elif isinstance(value, int | float) and not isinstance(value, bool):
            yield dotted, value


def with_plan(**plan: Any) -> Bearing:
    """The specimen with another plan and more cells, so that every cell count matters."""
    return tb.changed_bearing(SPECIMEN, geometry={"plan": plan})


def perturbed(bearing: Bearing, key: str) -> Bearing:
    """The bearing with one number a little larger: one more, or 3 %."""
    value = dict(list_numbers(bearing))[key]
    change: Any = value + 1 if isinstance(value, int) else value * 1.03
    for name in reversed(key.split(".")):
        change = {name: change}
    return tb.changed_bearing(bearing, **change)


def fingerprint(result: tb.Result) -> list[NDArray[Any]]:
    """What an analysis computed: histories, final profile, and which variables there are."""
    data = result.dataset
    numbers = [data[name].values for name in sorted(map(str, data.variables)) if name != "outcome"]
    return [np.array(sorted(map(str, data.variables))), *numbers]


def differ(one: tb.Result, other: tb.Result) -> bool:
    a, b = fingerprint(one), fingerprint(other)
    return len(a) != len(b) or not all(map(same, a, b))


def same(a: NDArray[Any], b: NDArray[Any]) -> bool:
    """To the bit; what does not exist (lead in a bearing without) is the same as itself."""
    return np.array_equal(a, b, equal_nan=a.dtype.kind == "f")


LEAD = {"softening": 0.005, "confined": False, "clock": "lead"}  # all numbers of lead count
PLANS = {
    "virgin": tb.changed_bearing(SPECIMEN, scragging={"amplitude": 1.0, "mullins_amplitude": 0.3}),
    "square": with_plan(shape="square", side=240.0),
    "rectangular": with_plan(shape="rectangular", length=200.0, width=288.0),
    "circular": with_plan(shape="circular", diameter=270.0),
    "lead": tb.changed_bearing("shen-lhdr-specimen", lead=LEAD),
}
OF_ENDS = "lead.end_spreading"  # of confined cores on finite plates only
OF_FORMULA = "lead.surface_ratio"  # of lead on a half-space only
OF_RANGE = "temperature_law"  # what is said beyond it: verification/test_temperature_law.py
OF_BAND = ("rate_band.lowest", "rate_band.highest")  # ends, for `--bands`: unit/test_undecided.py
OF_LEAD = ("lead", "rate", "materials.lead", "geometry.sealing", "cells.sealing")
KEYS = [
    pytest.param(shape, key, id=f"{shape}-{key}")
    for shape, bearing in PLANS.items()
    for key, _ in list_numbers(bearing)
    if key.startswith("geometry.plan")
    or (shape == "square" and not key.startswith((*OF_LEAD, OF_RANGE)))
    or (shape == "virgin" and key.startswith("scragging"))
    or (shape == "lead" and key.startswith(OF_LEAD) and key not in (OF_ENDS, OF_FORMULA, *OF_BAND))
]


@pytest.fixture(scope="module")
def results() -> dict[str, tb.Result]:
    return {
        shape: tb.run(
            bearing, TEST, ambient=-10, model=tb.ModelOptions(upper_face=FACE, lower_face=FACE)
        )
        for shape, bearing in PLANS.items()
    }


def test_keys_are_all_there() -> None:
    names = {param.values[1] for param in KEYS}
    # 23 of the square one, the sizes of the other plans, 14 of lead and rate dependence, 5 of
    # virgin rubber
    assert len(names) == 45
    assert {"hysteresis.reference_temperature", "cells.shim", "materials.side_film"} <= names


def test_same_input_same_output(results: dict[str, tb.Result]) -> None:
    """The comparison is to the bit, so it must say "the same" where nothing was changed."""
    again = tb.run(
        PLANS["square"], TEST, ambient=-10, model=tb.ModelOptions(upper_face=FACE, lower_face=FACE)
    )
    assert not differ(results["square"], again)


@pytest.mark.parametrize(("shape", "key"), KEYS)
def test_numbers_of_a_bearing(results: dict[str, tb.Result], shape: str, key: str) -> None:
    """Histories of force, not only geometry in the labels, must feel the change."""
    changed = perturbed(PLANS[shape], key)
    result = tb.run(
        changed, TEST, ambient=-10, model=tb.ModelOptions(upper_face=FACE, lower_face=FACE)
    )
    before, after = results[shape], result
    assert differ(before, after)
    same_force = np.array_equal(before["force"].values, after["force"].values)
    same_heat = np.array_equal(before["heat_stored"].values, after["heat_stored"].values)
    assert not (same_force and same_heat)


def run(test: tb.CyclicTest = TEST, **options: Any) -> tb.Result:
    return tb.run(SPECIMEN, test, **({"ambient": -10} | options))


OPTIONS: dict[str, Any] = {
    "scheme": "published",
    "integrator": "euler",
    "heat_source": "dissipation",
    "stack": "full",
    "upper_face": tb.EndFace(eta=3.0),
    "lower_face": tb.EndFace(film=3.0),
    "side": Side(film=25.0, cover=5.0),
    "model": "adiabatic",
    "keep_every": 3,
    "keep": ["rubber", "hysteretic", "layer_displacement"],
    "initial": 5.0,
    "initial_profile": np.linspace(-10.0, 20.0, 19),
    "ambient": -9.0,
    "dt": 0.01,
}


@pytest.fixture(scope="module")
def plain() -> tb.Result:
    return run()


@pytest.mark.parametrize("option", OPTIONS)
def test_options(plain: tb.Result, option: str) -> None:
    value = OPTIONS[option]
    if option == "keep_every":
        keywords = {"keep": tb.Keep(every=value)}
    elif option in tb.ModelOptions.model_fields:
        keywords = {"model": tb.ModelOptions(**{option: value})}
    else:
        keywords = {"initial" if option == "initial_profile" else option: value}
    assert differ(plain, run(**keywords))


def test_every_option_of_a_case_was_tried() -> None:
    elsewhere = {"bearing", "test", "ambient_series", "analysis", "initial_lead"}
    elsewhere |= {"lead_ends", "clock"}  # below, and in unit/test_lead_clock.py
    elsewhere |= {"initial_state", "rig"}  # verification/test_handover.py, unit/test_sequences.py
    elsewhere |= {"histories"}  # of files: unit/test_thinning.py
    # Of documents, not of numbers: unit/test_cli.py, unit/test_repeated_case.py, the same bits.
    elsewhere |= {"sources", "compare"}
    elsewhere |= {"axial_force"}  # changes no number: unit/test_bearing_checks.py
    elsewhere |= {"axial", "axial_factor", "axial_history"}  # verification/test_axial.py
    elsewhere |= {"exposure", "state"}  # unit/test_exposure.py, unit/test_state.py
    elsewhere |= {*Conditioning.model_fields}  # unit/test_conditioning.py
    elsewhere |= {"hardening"}  # acts at larger strains: verification/test_softening.py
    elsewhere |= {"small_loops"}  # acts after small reversals: verification/test_small_loops.py
    assert {*Analysis.model_fields, *Case.model_fields} - elsewhere <= set(OPTIONS)


def test_choices_of_lead(results: dict[str, tb.Result]) -> None:
    confined = tb.changed_bearing(PLANS["lead"], lead={"confined": True})
    warm: dict[str, Any] = {"initial": tb.InitialState(lead=30.0)}
    for bearing, more in ((confined, {}), (PLANS["lead"], warm)):
        other = tb.run(
            bearing,
            TEST,
            ambient=-10,
            model=tb.ModelOptions(upper_face=FACE, lower_face=FACE),
            **more,
        )
        assert differ(results["lead"], other)


def test_lead_on_finite_plates() -> None:
    bearing = tb.load_bearing("shen-lhdr-specimen")
    clock = tb.changed_bearing(bearing, lead={"clock": "lead"})
    run_of = {
        ends: tb.run(bearing, TEST, ambient=-10, model=tb.ModelOptions(lead_ends=ends))
        for ends in ("half-space", "finite-plate")
    }
    assert differ(*run_of.values())
    assert not differ(run_of["finite-plate"], tb.run(bearing, TEST, ambient=-10))
    for ends, plain in run_of.items():
        for changed, of in (
            (perturbed(bearing, OF_ENDS), "finite-plate"),
            (perturbed(bearing, OF_FORMULA), "half-space"),
            (clock, "half-space"),
        ):
            other = tb.run(changed, TEST, ambient=-10, model=tb.ModelOptions(lead_ends=ends))
            assert differ(plain, other) == (ends == of)


def test_keeping_less_changes_no_measure() -> None:
    """What is kept is a choice of output: energy and damping come from every step."""
    whole, thin, thinnest = (run(keep=tb.Keep(every=n)).cycles for n in (1, 20, 10_000))
    for less in (thin, thinnest):
        for name in ("G_eq_MPa", "h_eq", "energy_kN_mm", "stress_max_MPa", "rubber1_degC"):
            assert_allclose(less[name], whole[name], rtol=tol.LOOP, err_msg=name)


def test_ambient_series(plain: tb.Result) -> None:
    series = tb.Ambient.series([0.0, 10.0], [-10.0, -11.0])
    assert differ(plain, run(ambient=series))


@pytest.mark.parametrize(
    ("face", "other"),
    [({"eta": 2.0}, {"eta": 2.1}), ({"film": 5.0}, {"film": 6.0}), ({"eta": 1.0}, {"film": 1.0})],
)
def test_faces(face: dict[str, float], other: dict[str, float]) -> None:
    one, two = (run(model=tb.ModelOptions(upper_face=f), initial=20.0) for f in (face, other))
    assert differ(one, two)


STEP_KEYS: list[tuple[str, dict[str, Any], dict[str, Any]]] = [
    ("cycles.strain", {"strain": 1.0, "speed": 60.0}, {"strain": 1.1}),
    ("cycles.amplitude", {"amplitude": 30.0, "speed": 60.0}, {"amplitude": 31.0}),
    ("cycles.wave", {"strain": 1.0, "speed": 60.0}, {"wave": "sine"}),
    ("cycles.speed", {"strain": 1.0, "speed": 60.0}, {"speed": 61.0}),
    ("cycles.period", {"strain": 1.0, "period": 2.0}, {"period": 2.1}),
    ("cycles.frequency", {"strain": 1.0, "frequency": 0.5}, {"frequency": 0.49}),
    ("cycles.count", {"strain": 1.0, "speed": 60.0, "count": 1}, {"count": 2}),
    ("cycles.closing_strain", {"strain": 1.0, "speed": 60.0}, {"closing_strain": 0.1}),
    ("path.path", {"path": "circle", "strain": 1.0, "period": 2.0}, {"path": "square"}),
    ("path.strain", {"path": "circle", "strain": 1.0, "period": 2.0}, {"strain": 1.1}),
    ("path.amplitude", {"path": "circle", "amplitude": 30.0, "period": 2.0}, {"amplitude": 31.0}),
    ("path.ratio", {"path": "eight", "strain": 1.0, "period": 2.0}, {"ratio": 0.6}),
    ("path.speed", {"path": "circle", "strain": 1.0, "speed": 60.0}, {"speed": 61.0}),
    ("path.period", {"path": "circle", "strain": 1.0, "period": 2.0}, {"period": 2.1}),
    ("path.frequency", {"path": "circle", "strain": 1.0, "frequency": 0.5}, {"frequency": 0.49}),
    ("path.count", {"path": "circle", "strain": 1.0, "period": 2.0, "count": 1}, {"count": 2}),
    ("path.ramp", {"path": "circle", "strain": 1.0, "period": 2.0}, {"ramp": 1.0}),
    ("ramp.to", {"to": 10.0, "speed": 10.0}, {"to": 11.0}),
    ("ramp.to_strain", {"to_strain": 0.3, "speed": 10.0}, {"to_strain": 0.4}),
    ("ramp.speed", {"to": 10.0, "speed": 10.0}, {"speed": 11.0}),
    ("ramp.duration", {"to": 10.0, "duration": 1.0}, {"duration": 1.1}),
    ("rest.duration", {"duration": 60.0}, {"duration": 70.0}),
    ("rest.within", {"within": 5.0}, {"within": 4.0}),
]


@pytest.mark.parametrize(
    ("kind", "keys", "change"),
    [pytest.param(name.split(".")[0], a, b, id=name) for name, a, b in STEP_KEYS],
)
def test_keys_of_steps(kind: str, keys: dict[str, Any], change: dict[str, Any]) -> None:
    tests = [
        tb.CyclicTest(dt=0.02, steps=[{"step": kind, **keys, **more}]) for more in ({}, change)
    ]
    one, two = (run(test, initial=20.0) for test in tests)
    assert differ(one, two)


def test_every_key_of_a_step_was_tried() -> None:
    kinds = {"cycles": Cycles, "path": PlanePath, "ramp": Ramp, "rest": Rest}
    keys = {f"{kind}.{key}" for kind, model in kinds.items() for key in model.model_fields}
    assert {key for key in keys if not key.endswith(".step")} == {row[0] for row in STEP_KEYS}
    # read in test_protocol.py, test_arrays.py and test_paths.py
    lists = {"time_s", "displacement_mm", "displacement_y_mm"}
    assert set(Recorded.model_fields) == lists | {"step", "file", "column_y"}
