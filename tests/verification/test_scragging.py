"""Virgin rubber: its limits, its memory, tangent, energy balance, and hostile histories."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.verification.models import assembled, marched, numbers
from thermobearing.bearing.model import Scragging
from thermobearing.bearing.state import RubberState, in_state
from thermobearing.core.records import Floats
from thermobearing.core.step import step
from thermobearing.core.types import COMPLETED, SOFTENED, new_state, new_workspace
from thermobearing.model.element import BearingElement

LAW = Scragging(
    amplitude=1.5, strain=0.3, mullins_amplitude=0.25, mullins_decay=4.0, mullins_renewal=0.05
)
HDR = tb.load_bearing("shen-hdr-specimen")


def virgin(**changes: Any) -> tb.Bearing:
    return HDR.model_copy(update={"scragging": LAW.model_copy(update=changes)})


def run(bearing: tb.Bearing, strains: list[float], cycles: int = 3, **options: Any) -> tb.Result:
    test = tb.cyclic_test(strain=strains, cycles=cycles, rest=None, closing_strain=None, dt=0.01)
    return tb.run(bearing, test, options.pop("ambient", 23.0), **options)


def test_none_is_the_same_as_zero() -> None:
    plain, zero = (
        run(HDR, [1.0, 2.0]),
        run(virgin(amplitude=0.0, mullins_amplitude=0.0), [1.0, 2.0]),
    )
    for name in ("force", "rubber_temperature", "heat_stored"):
        assert_array_equal(plain[name].values, zero[name].values)


def test_first_stiffness() -> None:
    h, count = HDR.hysteresis, HDR.geometry.rubber_layers
    small = 1e-6
    forces = [
        BearingElement.from_constants(assembled(bearing), 23.0).set_trial(small, 1.0, 23.0).force
        for bearing in (HDR, virgin())
    ]
    elastic, hysteretic = h.post_yield_ratio, 1.0 - h.post_yield_ratio
    expected = elastic * 1.25 + hysteretic * 1.25**2 * 2.5
    assert_allclose(forces[1] / forces[0], expected, rtol=1e-5)
    assert_allclose(forces[0], h.layer_stiffness / count * small, rtol=1e-5)


def test_memory_follows_its_equations(measured: Recorder) -> None:
    """Full cycles of one amplitude: D stays, v falls by e^{-4/c} each; never recovers."""
    result_of = []
    constants = assembled(virgin())
    state, new, work = (
        new_state(constants, np.full(19, 23.0)),
        new_state(constants, np.full(19, 23.0)),
        new_workspace(constants),
    )
    x = np.concatenate(
        [np.linspace(0, 30, 300), *[np.linspace(s * 30, -s * 30, 601)[1:] for s in (1, -1, 1, -1)]]
    )
    for value in x[1:]:
        outcome = step(constants, work, state, float(value), 0.005, 23.0, new)[2]
        assert outcome in (COMPLETED, SOFTENED)
        assert np.all(new.layers["farthest"] >= state.layers["farthest"])
        assert np.all((new.layers["virgin"] > 0.0) & (new.layers["virgin"] <= 1.0))
        mean = abs(value) * (1.0 / HDR.geometry.rubber_layers)
        assert np.all(new.layers["farthest"] >= mean)
        result_of.append(new.layers["virgin"].mean())
        state, new = new, state
    after = np.array(result_of)
    end = 299 + 600 * np.arange(5) - 1
    ratio = after[end[1:]] / after[end[:-1]]
    measured(
        "virgin share over half a cycle", f"{ratio[-1]:.4f}", f"e^(-2/c) = {math.exp(-0.5):.4f}"
    )
    assert_allclose(ratio[1:], math.exp(-2.0 / LAW.mullins_decay), rtol=tol.VIRGIN_SHARE)
    # while loading for the first time: (1/l)/(1/l + 1/c)
    loading = LAW.mullins_decay / (LAW.mullins_decay + LAW.mullins_renewal)
    assert_allclose(after[250], loading, rtol=tol.VIRGIN_SHARE)


def test_first_cycle_of_every_amplitude_is_stiffer() -> None:
    plain, fresh = run(HDR, [1.0, 2.0], 6), run(virgin(strain=0.05), [1.0, 2.0], 6)
    ratio = (fresh.cycles["stress_max_MPa"] / plain.cycles["stress_max_MPa"]).to_numpy()
    for level in (ratio[:6], ratio[6:]):
        assert np.all(np.diff(level) < 0.0)
        assert level[0] > 1.15
        assert level[-1] < 1.02
    again = run(virgin(strain=0.05), [2.0, 1.0], 6).cycles["stress_max_MPa"].to_numpy()
    assert again[6] / again[11] < 1.05  # no new strain: no new stiffness


@pytest.mark.parametrize("heat_source", ["work", "dissipation"])
@pytest.mark.parametrize("ambient", [-20.0, 23.0])
def test_energy_balance_closes(heat_source: str, ambient: float, measured: Recorder) -> None:
    model = tb.ModelOptions(heat_source=heat_source)
    result = run(virgin(), [1.5, 3.0], ambient=ambient, model=model)
    energy = result.energy.iloc[0]
    worst = max(abs(energy["mechanical_residual"]), abs(energy["thermal_residual"]))
    measured(
        f"energy balance, virgin rubber, {heat_source}, {ambient:g} degC", f"{worst:.1e}", "1e-10"
    )
    assert worst < tol.ENERGY_BALANCE


def test_lost_stiffness_is_heat() -> None:
    response = marched(
        assembled(virgin(), heat_source="dissipation"),
        np.linspace(0.0, 40.0, 400),
        0.005,
        23.0,
        23.0,
    ).response
    released = np.diff(response["heat_released"])
    total = response["heat_released"] + response["recoverable"]
    assert_allclose(total, response["work_in"], rtol=tol.LOOP, atol=1e-9)
    assert np.all(released[20:] > 0.0)


def test_tangent_is_the_slope_of_the_force() -> None:
    rng = np.random.default_rng(5)
    element = BearingElement.from_constants(assembled(virgin()), -20.0)
    x = 0.0
    for _ in range(150):
        x += float(rng.uniform(-6.0, 6.0)) - 0.05 * x
        slope = element.set_trial(x, 0.01, -20.0).tangent
        step_size = 1e-6
        near = [element.set_trial(x + s, 0.01, -20.0).force for s in (step_size, -step_size)]
        difference = (near[0] - near[1]) / (2.0 * step_size)
        assert_allclose(slope, difference, rtol=tol.VIRGIN_TANGENT, atol=tol.VIRGIN_TANGENT)
        element.set_trial(x, 0.01, -20.0)
        element.commit()


def test_a_trial_that_is_not_committed_wears_nothing() -> None:
    element = BearingElement.from_constants(assembled(virgin()), 23.0)
    element.set_trial(60.0, 0.01, 23.0)
    element.set_trial(10.0, 0.01, 23.0)
    element.commit()
    assert element.state.layers["farthest"].max() < 3.0
    saved = element.save()
    element.set_trial(-50.0, 0.01, 23.0)
    element.commit()
    element.restore(saved)
    assert_array_equal(element.state.layers, saved.layers)
    element.revert_to_start()
    assert np.all(element.state.layers["virgin"] == 1.0)
    assert np.all(element.state.layers["farthest"] == 0.0)


def test_convergence_with_the_step(measured: Recorder) -> None:
    peaks = []
    for dt in (0.02, 0.01, 0.005):
        test = tb.cyclic_test(strain=[1.0, 2.0], cycles=2, rest=None, closing_strain=None, dt=dt)
        peaks.append(tb.run(virgin(), test, 23.0).cycles["energy_kN_mm"].to_numpy())
    change = [float(np.abs(a / peaks[-1] - 1.0).max()) for a in peaks[:-1]]
    measured(
        "virgin rubber, energy of a cycle: 20 and 10 ms against 5 ms",
        f"{100 * change[0]:.2f} %, {100 * change[1]:.2f} %",
        f"{100 * tol.VIRGIN_STEP:g} %",
    )
    assert change[1] < tol.VIRGIN_STEP
    assert change[1] < 0.6 * change[0]


@pytest.mark.parametrize("ambient", [-60.0, -20.0, 60.0])
@pytest.mark.parametrize("dt", [1e-4, 0.005, 0.05])
def test_no_step_fails_in_hostile_histories(ambient: float, dt: float) -> None:
    rng = np.random.default_rng(int(1e5 * dt) + int(ambient) + 100)
    speeds = np.repeat(rng.uniform(-900.0, 900.0, 40), 50)
    x = np.cumsum(speeds * dt)
    x = 105.0 * np.sin(x / max(np.abs(x).max(), 1.0) * 9.0)
    result = marched(
        assembled(virgin(amplitude=4.0, mullins_amplitude=0.6)), x, dt, ambient, ambient
    )
    assert np.isfinite(numbers(result.response)).all()
    assert len(result.response) == len(x)


def test_the_memory_is_that_of_the_mean_displacement() -> None:
    """A bearing that is colder outside strains its layers differently, and has one memory."""
    element = BearingElement.from_constants(
        assembled(virgin()), initial=np.linspace(-30.0, 20.0, 19)
    )
    for x in np.linspace(0.0, 45.0, 100):
        element.set_trial(float(x), 0.01, -30.0)
        element.commit()
    layers = element.state.layers
    assert layers["d"][0] < layers["d"][1] < layers["d"][2]
    assert_array_equal(layers["farthest"], 45.0 * (1.0 / HDR.geometry.rubber_layers))
    assert np.ptp(layers["virgin"]) == 0.0


def moved_layers(ahead: float, steps: int) -> Floats:
    """Displacements of virgin layers at -20 degC, one of which starts `ahead` of the others [mm].

    After a cycle of 2 s in `steps` steps with each of four amplitudes.
    """
    bearing = in_state(tb.load_bearing("shen-hdr-bridge"), RubberState(rubber="virgin"))
    constants = assembled(bearing)
    cells = np.full(len(constants.cells.capacity), -20.0)
    state, new = new_state(constants, cells), new_state(constants, cells)
    work = new_workspace(constants)
    state.layers["d"][0] = ahead
    for amplitude in (3.0, 9.0, 27.0, 81.0):
        for x in amplitude * np.sin(np.linspace(0.0, 2.0 * math.pi, steps + 1)[1:]):
            outcome = step(constants, work, state, float(x), 2.0 / steps, -20.0, new)[2]
            assert outcome in (COMPLETED, SOFTENED)
            state, new = new, state
    displacements: Floats = state.layers["d"].copy()
    return displacements


@pytest.mark.parametrize("steps", [400, 1600, 6400])
def test_rounding_does_not_choose_the_layer_that_softens(steps: int, measured: Recorder) -> None:
    """The assumed law takes more force from a layer in the cold than a displacement adds."""
    ahead = 1e-9
    grown = float(np.abs(moved_layers(ahead, steps) - moved_layers(0.0, steps)).max())
    measured(
        f"virgin rubber, a layer 1e-9 mm ahead, after four cycles of {steps} steps [mm]",
        f"{grown:.1e}",
        f"{ahead:.0e}",
    )
    assert grown < ahead
