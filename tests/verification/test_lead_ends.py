"""Lead cores on finite plates (`lead_ends`): exact limits, energy books, finite elements."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.special import j0, j1, jn_zeros

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.verification.lead_cases import touching
from tests.verification.models import assembled, changed
from thermobearing.core.step import step
from thermobearing.core.types import new_state, new_workspace
from thermobearing.model import lead_ends as way
from thermobearing.model.lead_ends import _core_side, _core_sizes, end_state_at
from thermobearing.model.stack import Face, build_stack


def test_disc_on_a_plate_when_all_is_steady() -> None:
    """tanh(l H)/(k l) of each mode with the far face held; more with a film, most without."""
    bearing = touching("shen-lhdr-specimen", False)
    core = _core_sizes(bearing, build_stack(bearing, half=True))
    steel, height = bearing.materials.steel, bearing.geometry.end_plate_thickness
    k = steel.conductivity * 1e-3
    wave = jn_zeros(1, way.RADIAL) / core.plan
    mean = 4.0 * (j1(wave * core.radius) / (wave * core.plan * j0(wave * core.plan))) ** 2
    area = math.pi * core.radius**2
    for film, each in (
        (math.inf, np.tanh(wave * height) / (k * wave)),
        (0.0, 1.0 / np.tanh(wave * height) / (k * wave)),
    ):
        found = way._disc_on_plate(steel, height, film, core.radius, core.plan)
        assert_allclose(found[0], (mean * each).sum() / area, rtol=tol.KERNEL_STEADY)
    held, robin, free = (
        way._disc_on_plate(steel, height, film, core.radius, core.plan)[0]
        for film in (math.inf, 1e-3, 0.0)
    )
    assert held < robin < free


def test_core_when_all_is_steady() -> None:
    """h/(3 k A) along half a core, 1/(8 pi k h) to its wall."""
    core = tb.load_bearing("shen-lhdr-specimen").materials.lead
    assert core is not None
    k = core.conductivity * 1e-3
    along = way._core_modes(core, 48.0, 17.25).sum(axis=0)[0]
    assert_allclose(along, 48.0 / (3.0 * k * math.pi * 17.25**2), rtol=tol.KERNEL_STEADY)
    across = way._core_to_wall(core, 48.0, 17.25)[0]
    assert_allclose(across, 1.0 / (8.0 * math.pi * k * 48.0), rtol=tol.KERNEL_STEADY)


def test_fin_is_that_of_finite_volumes() -> None:
    """The ring of 400 volumes whose inner face is heated, at every frequency."""
    materials = tb.load_bearing("lrb-example").materials
    steel = materials.steel
    taken = way._fin_heat(steel, 3.0, materials.rubber, 8.0, faces=2)
    faces = 75.0 + 275.0 * np.linspace(0.0, 1.0, 401) ** 2
    area = math.pi * np.diff(faces**2)
    middle = 0.5 * (faces[1:] + faces[:-1])
    across = 2.0 * math.pi * steel.conductivity * 1e-3 * 3.0
    link = across / np.log(middle[1:] / middle[:-1])
    flow = np.diag(np.r_[link, 0.0] + np.r_[0.0, link]) - np.diag(link, 1) - np.diag(link, -1)
    found = way.fin(steel, 3.0, taken, 75.0, 350.0)
    for at in range(0, len(taken), 8):
        t = np.linalg.solve(flow + np.diag(taken[at] * area), np.eye(400)[0])
        edge = t[0] + math.log(middle[0] / faces[0]) / across
        exact = edge - area @ t / area.sum()
        assert_allclose(found[at], exact, rtol=tol.KERNEL_VOLUMES)


@pytest.mark.parametrize("name", ["shen-lhdr-specimen", "shen-lhdr-bridge", "lrb-example"])
def test_few_terms_are_enough(name: str, measured: Recorder) -> None:
    """The sum of the terms against the impedance they stand for."""
    bearing = touching(name, True)
    stack = build_stack(bearing, half=True)
    core = _core_sizes(bearing, stack)
    (end, _), side = (
        end_state_at(bearing, core, math.inf),
        _core_side(bearing, stack, core).impedance,
    )
    worst = 0.0
    for impedance in (end, side):
        a, tau = way.fitted(impedance)
        assert a.min() > 0.0
        assert len(a) <= len(way.RELAXATIONS)
        fit = (a / (1.0 + way.FREQUENCIES[:, None] * tau)).sum(axis=1)
        worst = max(worst, float(np.abs(fit / impedance - 1.0).max()))
    assert worst < tol.KERNEL_FIT
    measured(f"{name}: terms of lead ends and sides against what they stand for", worst, "0.02")


def still(
    half: bool, warm: float, dt: float, steps: int, sides: bool = False, **faces: Face
) -> Any:
    """A bearing at rest whose lead is warmer than the rest by `warm` [K]; states by time."""
    bearing = touching("shen-lhdr-specimen", sides)
    constants = assembled(bearing, half=half, lead_ends="finite-plate", **faces)
    state = new_state(constants, np.full(len(constants.cells.capacity), -20.0), -20.0 + warm)
    work, new = new_workspace(constants), new_state(constants, state.temperature)
    states = [state]
    for _ in range(steps):
        step(constants, work, state, 0.0, dt, -20.0, new)
        state, new = new, new_state(constants, state.temperature)
        states.append(state)
    return constants, states


@pytest.mark.parametrize("sides", [False, True])
@pytest.mark.parametrize("dt", [1e-4, 0.01, 1.0, 100.0, 1e4])
def test_any_step_is_stable_and_heat_flows_downhill(dt: float, sides: bool) -> None:
    _, states = still(True, 80.0, dt, 300, sides)
    lead = np.array([state.branches[0].lead_temperature for state in states])
    plates = np.array([state.temperature for state in states])
    assert plates.max() < 60.0
    assert lead.max() == 60.0
    if dt <= 1.0:
        assert np.all(np.diff(lead) <= 1e-9)
        assert min(lead.min(), plates.min()) > -20.0 - 1e-9
    else:  # Crank-Nicolson rings a little in steps that long, and dies out
        assert_allclose(lead[-1], -20.0, atol=tol.ENDS_RINGING)


@pytest.mark.parametrize("sides", [False, True])
def test_half_and_whole_stack_agree(sides: bool) -> None:
    """Two ends, each with its terms, are twice one end; the side is one in both."""
    whole, half = (still(half, 80.0, 0.05, 400, sides)[1][-1] for half in (False, True))
    near = tol.ENDS_HALF_SHIM if sides else tol.LOOP
    assert_allclose(
        whole.branches[0].lead_temperature, half.branches[0].lead_temperature, rtol=0.0, atol=near
    )
    assert_allclose(
        whole.temperature[: len(half.temperature)], half.temperature, rtol=tol.LOOP, atol=near
    )
    if not sides:
        assert_allclose(whole.ends.reshape(2, -1), [half.ends] * 2)


def test_no_heat_moves_between_what_is_as_warm() -> None:
    for sides in (False, True):
        _, states = still(True, 0.0, 0.1, 20, sides)
        assert_allclose(states[-1].temperature, -20.0, rtol=tol.LOOP)
        assert_allclose(states[-1].branches[0].lead_temperature, -20.0, rtol=tol.LOOP)
        assert_allclose(states[-1].ends, 0.0, atol=tol.LOOP)


def test_a_single_layer_has_no_shims_to_touch() -> None:
    bearing = changed(touching("lrb-example", True), geometry={"rubber_layers": 1})
    constants = assembled(bearing, half=False, lead_ends="finite-plate")
    assert constants.lead_ports == 2


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
@pytest.mark.parametrize("sides", [False, True])
def test_energy_books_close(name: str, unlike: bool, sides: bool, measured: Recorder) -> None:
    cycles = {"step": "cycles", "strain": 1.75, "wave": "sine", "speed": 100.0, "count": 3}
    test = tb.CyclicTest(dt=0.01, steps=[cycles, {"step": "rest", "duration": 3600.0}, cycles])
    result = tb.run(
        touching(name, sides),
        test,
        ambient=-20.0,
        lead_ends="finite-plate",
        lower_face=tb.EndFace(film=20.0) if unlike else None,
    )
    energy = result.energy
    residual = float(np.abs(energy[["mechanical_residual", "thermal_residual"]]).to_numpy().max())
    assert residual < tol.ENERGY_BOOKS
    how = "in touch with shims" if sides else "confined"
    measured(f"energy books, lead on finite plates, {how}, {name}", f"{residual:.1e}", "1e-10")
