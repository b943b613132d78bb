"""Lead cores on finite plates (`lead_ends`): exact sums, energy books, finite elements."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.special import j0, j1, jn_zeros

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.verification.models import assembled
from thermobearing.core.step import step
from thermobearing.core.types import new_state, new_workspace
from thermobearing.model.lead_ends import RADIAL, core_modes, end_modes, lumped, plate_modes
from thermobearing.model.stack import Face

CASES = {  # bearing, strain, cycles, speed [mm/s]
    "specimen, 250 %, 30 mm/s": ("shen-lhdr-specimen", 2.5, 5, 30.0),
    "specimen, 100 %, 150 mm/s": ("shen-lhdr-specimen", 1.0, 10, 150.0),
    "bridge, 175 %, 200 mm/s": ("shen-lhdr-bridge", 1.75, 5, 200.0),
    "bridge, 175 %, 50 mm/s": ("shen-lhdr-bridge", 1.75, 5, 50.0),
    "LRB, confined, 100 %, 300 mm/s": ("lrb-example", 1.0, 5, 300.0),
}


def confined(name: str) -> tb.bearing.Bearing:
    bearing = tb.load_bearing(name)
    assert bearing.lead is not None
    return bearing.model_copy(update={"lead": bearing.lead.model_copy(update={"confined": True})})


def test_terms_add_up_to_the_steady_resistances() -> None:
    """tanh(l H)/(k l) of each plate mode, h/(3 k A) of the core; lumping keeps the sum."""
    bearing = confined("shen-lhdr-specimen")
    lead, core = bearing.lead, bearing.materials.lead
    assert lead is not None
    assert core is not None
    k, height = bearing.materials.steel.conductivity * 1e-3, bearing.geometry.end_plate_thickness
    radius = math.sqrt(bearing.area / lead.cores / math.pi)
    wave = jn_zeros(1, RADIAL) / radius
    mean = 4.0 * (j1(wave * lead.radius) / (wave * radius * j0(wave * radius))) ** 2
    steady = float((mean * np.tanh(wave * height) / wave).sum()) / (k * lead.core_area)
    plate = plate_modes(bearing)
    assert_allclose(plate[0].sum(), steady, rtol=tol.KERNEL_SUM)
    along = 48.0 / (3.0 * core.conductivity * 1e-3 * lead.core_area)
    cores = core_modes(bearing, 48.0)
    assert_allclose(cores[0].sum(), along, rtol=tol.KERNEL_SUM)
    assert_allclose(lumped(plate)[0].sum(), plate[0].sum(), rtol=tol.ROUNDING * plate.shape[1])
    both = end_modes(bearing, 48.0)
    assert_allclose(both["resistance"].sum(), 0.8 * plate[0].sum() + cores[0].sum(), rtol=tol.LOOP)
    assert 8 <= len(both) <= 12


def still(half: bool, warm: float, dt: float, steps: int, **faces: Face) -> Any:
    """A bearing at rest whose lead is warmer than the rest by `warm` [K]; states by time."""
    bearing = confined("shen-lhdr-specimen")
    constants = assembled(bearing, half=half, lead_ends="finite-plate", **faces)
    state = new_state(constants, np.full(len(constants.cells.capacity), -20.0), -20.0 + warm)
    work, new = new_workspace(constants), new_state(constants, state.temperature)
    states = [state]
    for _ in range(steps):
        step(constants, work, state, 0.0, dt, -20.0, new)
        state, new = new, new_state(constants, state.temperature)
        states.append(state)
    return constants, states


@pytest.mark.parametrize("dt", [1e-4, 0.01, 1.0, 100.0, 1e4])
def test_any_step_is_stable_and_heat_flows_downhill(dt: float) -> None:
    _, states = still(True, 80.0, dt, 300)
    lead = np.array([state.branches[0].lead_temperature for state in states])
    plates = np.array([state.temperature for state in states])
    assert plates.max() < 60.0
    assert lead.max() == 60.0
    if dt <= 1.0:
        assert np.all(np.diff(lead) <= 1e-9)
        assert min(lead.min(), plates.min()) > -20.0 - 1e-9
    else:  # Crank-Nicolson rings a little in steps that long, and dies out
        assert_allclose(lead[-1], -20.0, atol=tol.ENDS_RINGING)


def test_half_and_whole_stack_agree() -> None:
    """Two ends, each with its terms, are twice one end."""
    whole, half = (still(half, 80.0, 0.05, 400)[1][-1] for half in (False, True))
    assert_allclose(
        whole.branches[0].lead_temperature, half.branches[0].lead_temperature, rtol=tol.LOOP
    )
    assert_allclose(
        whole.temperature[: len(half.temperature)], half.temperature, rtol=tol.LOOP, atol=tol.LOOP
    )
    assert len(whole.ends) == 2 * len(half.ends)
    assert_allclose(whole.ends.reshape(2, -1), [half.ends] * 2)


def test_order_in_time(measured: Recorder) -> None:
    """First order: the flow is constant over a step, and the plate's own answer lags by one."""
    found = [
        still(True, 80.0, 4.0 / n, n)[1][-1].branches[0].lead_temperature for n in (800, 1600, 3200)
    ]
    order = math.log2((found[0] - found[1]) / (found[1] - found[2]))
    measured("lead on finite plates: observed order in time", f"{order:.3f}", "1 +- 0.1")
    assert abs(order - 1.0) < 0.1
    assert abs(found[1] - found[2]) < tol.ENDS_STEP


def test_terms_are_what_separates_core_and_plate() -> None:
    """After every step the excess is the sum of the terms, but for the plate's own conduction."""
    constants, states = still(True, 80.0, 1e-4, 50)
    last = states[-1]
    plate = last.temperature[constants.lead_cells[0].cell]
    assert_allclose(
        last.branches[0].lead_temperature - plate, last.ends.sum(), rtol=tol.ENDS_EXCESS
    )
    assert np.all(constants.lead_modes["relaxation"] > 0.0)
    heat = constants.cells.capacity @ (last.temperature + 20.0)
    core = constants.lead.cores * constants.lead.capacity
    assert_allclose(
        heat + core * (last.branches[0].lead_temperature + 20.0), core * 80.0, rtol=tol.ENDS_LOST
    )


@pytest.mark.parametrize("name", ["shen-lhdr-specimen", "shen-lhdr-bridge", "lrb-example"])
@pytest.mark.parametrize("unlike", [False, True])
def test_energy_books_close(name: str, unlike: bool, measured: Recorder) -> None:
    """Motion and a long rest, half and whole stack."""
    cycles = {"step": "cycles", "strain": 1.75, "wave": "sine", "speed": 100.0, "count": 3}
    test = tb.cyclic.CyclicTest(
        dt=0.01, steps=[cycles, {"step": "rest", "duration": 3600.0}, cycles]
    )
    result = tb.run(
        confined(name),
        test,
        ambient=-20.0,
        lead_ends="finite-plate",
        lower_face=tb.model.EndFace(film=20.0) if unlike else None,
    )
    energy = result.energy
    residual = float(np.abs(energy[["mechanical_residual", "thermal_residual"]]).to_numpy().max())
    assert residual < tol.ENERGY_BOOKS
    measured(f"energy books, lead on finite plates, {name}", f"{residual:.1e}", "1e-10")


@pytest.mark.parametrize("case", CASES)
def test_against_finite_elements(case: str, measured: Recorder) -> None:
    """The largest error at any time of loading and two minutes of cooling, of both closures."""
    pytest.importorskip("skfem", reason="scikit-fem is not installed")
    from tests.reference.fe_heat import FiniteElements, bearing_problem, released

    name, strain, count, speed = CASES[case]
    bearing = confined(name)
    cycles = {"step": "cycles", "strain": strain, "wave": "sine", "speed": speed, "count": count}
    test = tb.cyclic.CyclicTest(dt=0.01, steps=[cycles, {"step": "rest", "duration": 120.0}])
    keep = ("rubber", "layer_displacement", "cells")
    worst = []
    peak = 0.0
    for ends in ("half-space", "finite-plate"):
        result = tb.run(bearing, test, ambient=-20.0, heat_source="work", keep=keep, lead_ends=ends)
        time = result.time(0)
        history = FiniteElements(bearing_problem(bearing)).march(
            [(0.1, int(time[-1] / 0.1 + 1e-6))], released(bearing, result)
        )
        ours = np.interp(history.time, time, result["lead_temperature"].values[0] + 20.0)
        error = ours - history.means["lead"]
        worst.append(float(error[np.argmax(np.abs(error))]))
        peak = float(history.means["lead"].max())
    measured(
        f"lead, {case}: largest error, half-space and finite plate",
        f"{worst[0]:+.1f} K, {worst[1]:+.1f} K of {peak:.0f} K",
        f"{tol.KERNEL_LEAD:g} K for the finite plate",
    )
    assert abs(worst[1]) < tol.KERNEL_LEAD
    assert abs(worst[1]) < 0.25 * abs(worst[0])
