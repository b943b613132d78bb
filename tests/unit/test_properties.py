"""Whatever the bearing and the motion: finite numbers and closed response, or a typed outcome."""

import json
from typing import Any

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.bearing.model import Bearing
from thermobearing.border.schema import validated
from thermobearing.model.outcomes import SENTENCES

LONGEST = 250  # steps of one leg: the examples together must stay quick


def between(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers with six decimals: 1e-200 degC is no temperature, and its square is zero."""
    return st.floats(low, high, allow_nan=False).map(lambda value: round(value, 6))


PLANS = st.one_of(
    st.fixed_dictionaries({"shape": st.just("square"), "side": between(100, 1500)}),
    st.fixed_dictionaries(
        {"shape": st.just("rectangular"), "length": between(100, 900), "width": between(100, 900)}
    ),
    st.fixed_dictionaries({"shape": st.just("circular"), "diameter": between(100, 1500)}),
)
COUNTS = st.integers(1, 6)


@st.composite
def bearings(draw: st.DrawFn) -> Bearing:
    """Layers 1 to 8, odd and even; parameters around those identified, s also above 1.

    The modulus is drawn, not the stiffness: a stiff law on a small plan would be glass, not
    rubber, and boil within a cycle. The specimen's is 2.7 MPa.
    """
    thickness, plan, modulus = draw(between(2.0, 25.0)), draw(PLANS), draw(between(0.2, 8.0))
    area = plan.get("side", 0.0) ** 2 + plan.get("length", 0.0) * plan.get("width", 0.0)
    area += 0.25 * np.pi * plan.get("diameter", 0.0) ** 2
    table: dict[str, Any] = {
        "name": "random",
        "kind": "HDR",
        "geometry": {
            "plan": plan,
            "rubber_layers": draw(st.integers(1, 8)),
            "rubber_thickness": thickness,
            "shim_thickness": draw(between(1.0, 8.0)),
            "end_plate_thickness": draw(between(5.0, 60.0)),
        },
        "materials": {
            "rubber": {
                "conductivity": draw(between(0.1, 0.6)),
                "specific_heat": draw(between(1200.0, 2200.0)),
                "density": draw(between(900.0, 1400.0)),
            },
            "steel": {
                "conductivity": draw(between(15.0, 60.0)),
                "specific_heat": draw(between(400.0, 520.0)),
                "density": draw(between(7500.0, 8000.0)),
            },
            "side_film": draw(between(0.0, 30.0)),
        },
        "hysteresis": {
            "post_yield_ratio": draw(between(0.02, 0.9)),
            "layer_stiffness": 1e-3 * modulus * area / thickness,
            "shape": draw(st.one_of(between(-0.95, 3.0), st.just(1.0))),
            "yield_displacement": thickness * draw(between(0.05, 0.8)),
            "hardening": draw(between(0.0, 0.6)),
            "elastic_temperature_coefficient": draw(between(-3.0, 1.0)),
            "hysteretic_temperature_coefficient": draw(between(-4.0, 1.0)),
            "reference_temperature": draw(st.sampled_from([20.0, 23.0, 0.0])),
        },
        "cells": {"end_plate": draw(COUNTS), "rubber": draw(COUNTS), "shim": draw(COUNTS)},
    }
    return validated(Bearing, table, "random", from_file=False)


@st.composite
def motions(draw: st.DrawFn) -> tb.CyclicTest:
    """Two to five legs to random strains, rests among them, at one random time step."""
    dt = draw(between(1e-4, 0.05))
    steps: list[dict[str, Any]] = []
    for _ in range(draw(st.integers(2, 5))):
        duration = dt * draw(st.integers(1, LONGEST))
        if draw(st.integers(0, 4)) == 0:
            steps.append({"step": "rest", "duration": 100.0 * duration})
        else:
            strain = draw(between(-3.5, 3.5))
            steps.append({"step": "ramp", "to_strain": strain, "duration": duration})
    return tb.CyclicTest(dt=dt, steps=steps)


def residuals(result: tb.Result) -> tuple[float, float, float]:
    """What is missing from the mechanical and thermal response, and what may be [kN mm].

    A run that hardly moves or heats has no work to compare with: then the temperatures, which
    are rounded in every step, are what limits the heat that is computed from them.
    """
    response = result.energy.iloc[0]
    mechanical = response["work_in_kN_mm"] - response["heat_released_kN_mm"]
    mechanical -= response["recoverable_kN_mm"]
    lost = response["heat_lost_ends_kN_mm"] + response["heat_lost_sides_kN_mm"]
    thermal = response["heat_released_kN_mm"] - response["heat_stored_kN_mm"] - lost
    scale = max(abs(response["work_in_kN_mm"]), abs(response["heat_stored_kN_mm"]), abs(lost))
    capacity = sum(json.loads(result.dataset.attrs["heat_capacity_kN_mm_per_K"]))
    warmest = float(np.abs(result["temperature"].values).max())
    rounding = int(result["steps"][0]) * np.finfo(float).eps * capacity * warmest
    return mechanical, thermal, tol.ENERGY_BALANCE * scale + rounding


def end_state_at(test: tb.CyclicTest, bearing: Bearing) -> float:
    """Where the last ramp leads [mm]."""
    ramps = [step for step in test.steps if step.step == "ramp"]
    return ramps[-1].target(bearing.total_rubber_thickness) if ramps else 0.0


FACES = st.one_of(
    between(1.0, 3.0).map(lambda eta: tb.EndFace(eta=eta)),
    between(0.0, 1000.0).map(lambda film: tb.EndFace(film=film)),
)
OPTIONS = st.fixed_dictionaries(
    {
        "ambient": between(-60.0, 60.0),
        "initial": between(-60.0, 60.0),
    }
)
MODEL_OPTIONS = st.fixed_dictionaries(
    {
        "heat_source": st.sampled_from(["work", "dissipation"]),
        "scheme": st.sampled_from(["conservative", "conservative", "published"]),
        "integrator": st.sampled_from(["exact", "exact", "exact", "euler"]),
    }
)


@settings(max_examples=40, derandomize=True, deadline=None, database=None)
@given(
    bearing=bearings(),
    test=motions(),
    options=OPTIONS,
    choices=MODEL_OPTIONS,
    faces=st.one_of(FACES.map(lambda face: (face, face)), st.tuples(FACES, FACES)),
    full=st.booleans(),
)
def test_any_run_ends_well_or_says_why(
    bearing: Bearing,
    test: tb.CyclicTest,
    options: dict[str, Any],
    choices: dict[str, Any],
    faces: tuple[tb.EndFace, tb.EndFace],
    full: bool,
) -> None:
    upper, lower = faces
    keep = ["rubber", "layer_displacement", "hysteretic", "cells"]
    choices = choices | {"stack": "full" if full else "auto"}
    model = tb.ModelOptions(upper_face=upper, lower_face=lower, **choices)
    result = tb.run(bearing, test, model=model, keep=keep, **options)
    data = result.dataset
    assert ("half_stack", int(upper == lower and not full)) in data.attrs.items()
    # Rows are kept up to the last good step, so they are finite however the run ended.
    for name in ("displacement", "force", "rubber_temperature", "temperature", "work_in"):
        assert np.isfinite(data[name].values).all(), name
    assert result.outcome in SENTENCES
    if choices["integrator"] == "exact":
        assert result.outcome == "completed"
    mechanical, thermal, allowed = residuals(result)
    assert abs(mechanical) <= allowed
    if choices["scheme"] == "conservative":
        assert abs(thermal) <= allowed
    if result.outcome == "completed":
        assert int(data["steps"][0]) == data.sizes["time"] - 1
        assert data["displacement"].values[0, -1] == end_state_at(test, bearing)


def test_glass_for_rubber_runs_away_and_says_so() -> None:
    """Far outside those ranges the forces boil what they move, within a cycle."""
    table = tb.load_bearing("shen-hdr-specimen").model_dump()
    table["geometry"]["plan"] = {"shape": "circular", "diameter": 10.0}
    bearing = validated(Bearing, table, "glass", from_file=False)
    test = tb.cyclic_test(strain=[3.0], cycles=2, dt=0.01)
    result = tb.run(bearing, test, ambient=-20, model=tb.ModelOptions(heat_source="dissipation"))
    assert result.outcome == "temperature_runaway"
    assert np.isfinite(result["force"].values).all()
    assert np.isfinite(result["temperature"].values).all()
    assert 0 < int(result["steps"][0]) < 2400
