"""Layers in series: equal forces, displacements that add up, exact Z and tangent, pure trials."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from tests import tolerances as tol
from tests.conftest import Recorder
from tests.quick import quick_cases
from tests.verification import models
from thermobearing.core.hysteresis import exact_increment
from thermobearing.core.march import copy_state
from thermobearing.core.step import step
from thermobearing.core.types import COMPLETED, Constants, Floats, new_state, new_workspace

HISTORIES = ("sine 250 %", "small", "random", "held at the peak", "tremor at the peak")


def history(name: str) -> Floats:
    """Displacements [mm] every 5 ms."""
    bearing, dt = models.specimen(), 5e-3
    large = models.sine(bearing, strain=2.5, period=4.0, cycles=3, dt=dt)
    if name == "sine 250 %":
        return large
    if name == "small":
        return models.sine(bearing, strain=0.02, period=1.0, cycles=5, dt=dt)
    if name == "random":
        return models.smooth_history(np.random.default_rng(5), 70.0, 4000)
    # Layers creep against each other while the bearing stands (nearly) still: some of them
    # reverse within a step, where dZ/dd jumps.
    peak = models.sine(bearing, strain=2.0, period=4.0, cycles=1.25, dt=dt)
    tremor = 0.0 if name == "held at the peak" else 1e-6
    return np.concatenate([peak, peak[-1] + tremor * np.sin(0.3 * np.arange(2000))])


def healthy(run: models.Run) -> np.ndarray:
    return np.asarray(run.response["sharing_weight"] == 0.0)


@pytest.mark.parametrize("temperature", [-20.0, 0.0, 23.0])
@pytest.mark.parametrize("name", HISTORIES)
def test_layer_forces_are_equal_and_displacements_add_up(
    name: str, temperature: float, measured: Recorder
) -> None:
    """Eq. 4.34 recomputed from the returned d and Z at the temperatures of the step's start."""
    run = models.marched(
        models.assembled(models.specimen()), history(name), 5e-3, temperature, temperature
    )
    ok, force = healthy(run), run.response["force"]
    assert ok.mean() > 0.9
    peak = np.max(np.abs(force))
    apart = np.abs(models.layer_forces(models.specimen(), run) - force[:, None])
    measured(
        "layer forces apart, of the peak force", apart[ok].max() / peak, f"{tol.EQUAL_FORCE:g}"
    )
    assert_allclose(apart[ok], 0.0, rtol=0.0, atol=tol.EQUAL_FORCE * peak)
    # The mismatch that the run reports is this very difference, softened steps included.
    assert_allclose(
        run.response["layer_force_mismatch"],
        apart.max(axis=1),
        rtol=0.0,
        atol=tol.EQUAL_FORCE * peak,
    )
    total = run.d @ run.constants.multiplicity
    assert_allclose(total, run.response["displacement"], rtol=0.0, atol=tol.ADDS_UP)


@pytest.mark.parametrize("temperature", quick_cases([-20.0, 0.0, 23.0], 0))
@pytest.mark.parametrize("name", HISTORIES)
def test_z_of_every_layer_is_the_exact_increment(name: str, temperature: float) -> None:
    bearing = models.specimen()
    run = models.marched(models.assembled(bearing), history(name), 5e-3, temperature, temperature)
    d_y = bearing.hysteresis.yield_displacement
    c = run.constants.rubber.unloading_curvature
    d = np.vstack([np.zeros_like(run.d[:1]), run.d])
    z, moved = np.vstack([np.zeros_like(run.z[:1]), run.z]), np.diff(d, axis=0)
    exact = np.array(
        [
            [exact_increment(z[i, j], moved[i, j], d_y, 1.0 / d_y, c)[0] for j in range(3)]
            for i in range(len(run.d))
        ]
    )
    assert_allclose(run.z, exact, rtol=0.0, atol=tol.EXACT_Z * d_y)


def tangent_and_difference(
    constants: Constants, x: Floats, temperature: float
) -> list[tuple[float, float]]:
    """(returned tangent, central difference of trial forces) at every 20th healthy step."""
    work = new_workspace(constants)
    start = np.full(len(constants.cells.capacity), temperature)
    old, new, trial = (new_state(constants, start) for _ in range(3))
    h, pairs = tol.TANGENT_STEP_BEARING, []
    for i, target in enumerate(x):
        _, tangent, outcome = step(constants, work, old, target, 5e-3, temperature, new)
        if i % 20 == 7 and outcome == COMPLETED:
            above, _, up = step(constants, work, old, target + h, 5e-3, temperature, trial)
            below, _, down = step(constants, work, old, target - h, 5e-3, temperature, trial)
            if up == down == COMPLETED:
                pairs.append((tangent, (above - below) / (2.0 * h)))
        copy_state(new, old)
    return pairs


@pytest.mark.parametrize("layers", [1, 5, 6])
@pytest.mark.parametrize("temperature", [-20.0, 23.0])
def test_tangent_is_the_derivative_of_the_force(
    layers: int, temperature: float, measured: Recorder
) -> None:
    bearing = models.changed(models.specimen(), geometry={"rubber_layers": layers})
    x = models.sine(bearing, strain=2.0, period=4.0, cycles=2, dt=5e-3)
    pairs = np.array(tangent_and_difference(models.assembled(bearing), x, temperature))
    assert len(pairs) > 30
    worst = np.max(np.abs(pairs[:, 0] / pairs[:, 1] - 1.0))
    measured("bearing tangent against central differences", worst, f"{tol.TANGENT_BEARING:g}")
    assert_allclose(pairs[:, 0], pairs[:, 1], rtol=tol.TANGENT_BEARING, atol=0.0)


def test_equal_layers_share_equally() -> None:
    """Without temperature coefficients the bearing is one layer with N times the displacement."""
    none = {"elastic_temperature_coefficient": 0.0, "hysteretic_temperature_coefficient": 0.0}
    six = models.changed(models.specimen(), hysteresis=none)
    one = models.changed(six, geometry={"rubber_layers": 1})
    x = models.sine(six, strain=2.0, period=4.0, cycles=2, dt=5e-3)
    many = models.marched(models.assembled(six), x, 5e-3, -20.0, -20.0)
    single = models.marched(models.assembled(one), x / 6.0, 5e-3, -20.0, -20.0)
    assert_allclose(many.d, np.repeat(x[:, None] / 6.0, 3, axis=1), rtol=0.0, atol=tol.ADDS_UP)
    peak = np.abs(single.response["force"]).max()
    assert_allclose(
        many.response["force"], single.response["force"], rtol=0.0, atol=tol.ISOTHERMAL_FORCE * peak
    )


def full_and_half(layers: int, shim_cells: int) -> tuple[float, float]:
    """Largest differences of force (of the peak) and layer temperature [K], full against half."""
    bearing = models.changed(
        models.specimen(), geometry={"rubber_layers": layers}, cells={"shim": shim_cells}
    )
    x = models.sine(bearing, strain=2.0, period=4.0, cycles=3, dt=5e-3)
    full = models.marched(models.assembled(bearing, half=False), x, 5e-3, -10.0, -20.0)
    half = models.marched(models.assembled(bearing), x, 5e-3, -10.0, -20.0)
    force = half.response["force"]
    upper = full.layer_start[:, : half.layer_start.shape[1]]
    by_force = np.abs(full.response["force"] - force).max() / np.abs(force).max()
    return float(by_force), float(np.abs(upper - half.layer_start).max())


@pytest.mark.parametrize(("layers", "shim_cells"), [(1, 1), (2, 2), (5, 1), (5, 2), (6, 2)])
def test_full_stack_equals_half_stack(layers: int, shim_cells: int) -> None:
    """To rounding, wherever the symmetry plane falls between two cells of the full stack."""
    by_force, by_temperature = full_and_half(layers, shim_cells)
    assert_allclose(by_force, 0.0, rtol=0.0, atol=tol.FULL_AND_HALF)
    assert_allclose(by_temperature, 0.0, rtol=0.0, atol=tol.FULL_AND_HALF)


def test_half_stack_that_cuts_a_shim_cell_in_two_is_close_to_the_full_one(
    measured: Recorder,
) -> None:
    """The specimen: half a shim as one cell has its centre nearer the rubber than a whole one."""
    by_force, by_temperature = full_and_half(6, 1)
    measured("half against full stack, force, of the peak", by_force, f"{tol.HALF_SHIM:g}")
    measured("half against full stack, temperature [K]", by_temperature, f"{tol.HALF_SHIM:g}")
    assert_allclose(by_force, 0.0, rtol=0.0, atol=tol.HALF_SHIM)
    assert_allclose(by_temperature, 0.0, rtol=0.0, atol=tol.HALF_SHIM)
    assert by_temperature > tol.FULL_AND_HALF  # the two meshes do differ: the tests above can fail


@pytest.mark.parametrize("layers", [5, 6])
def test_symmetric_bearing_gives_symmetric_output(layers: int) -> None:
    bearing = models.changed(models.specimen(), geometry={"rubber_layers": layers})
    x = models.sine(bearing, strain=2.5, period=4.0, cycles=3, dt=5e-3)
    run = models.marched(models.assembled(bearing, half=False), x, 5e-3, -10.0, -20.0)
    for values in (run.cells, run.d, run.z):
        assert_allclose(values, values[:, ::-1], rtol=0.0, atol=tol.MIRROR)


def test_opposite_motion_gives_the_opposite_force_and_the_same_heat() -> None:
    """Not to the bit: the compiler may fuse sigma * z into an addition in one sign only."""
    x = models.smooth_history(np.random.default_rng(8), 80.0, 3000)
    there = models.marched(models.assembled(models.specimen()), x, 5e-3, -30.0, -20.0)
    back = models.marched(models.assembled(models.specimen()), -x, 5e-3, -30.0, -20.0)
    peak = np.abs(there.response["force"]).max()
    assert_allclose(
        there.response["force"], -back.response["force"], rtol=0.0, atol=tol.ISOTHERMAL_FORCE * peak
    )
    assert_allclose(there.cells, back.cells, rtol=0.0, atol=tol.MIRROR)


def test_same_input_gives_the_same_bits() -> None:
    x = models.smooth_history(np.random.default_rng(9), 90.0, 3000)
    first, second = (
        models.marched(models.assembled(models.specimen()), x, 5e-3, -40.0, -40.0) for _ in range(2)
    )
    assert first.softened > 0
    for name in ("response", "d", "z", "cells"):
        assert_array_equal(getattr(first, name), getattr(second, name))


def test_a_trial_step_leaves_the_state_alone() -> None:
    """Any number of trials, sane or mad, and the step after them still gives the same bits."""
    constants = models.assembled(models.specimen())
    work = new_workspace(constants)
    start = np.full(len(constants.cells.capacity), -20.0)
    old, new, fresh = (new_state(constants, start) for _ in range(3))
    for x in models.sine(models.specimen(), strain=2.5, period=4.0, cycles=1, dt=5e-3)[:300]:
        step(constants, work, old, x, 5e-3, -20.0, new)
        copy_state(new, old)
    before = [array.copy() for array in old]
    expected = step(constants, work, old, 50.0, 5e-3, -20.0, fresh)
    for x, dt in ((0.0, 1e-3), (-500.0, 5e-3), (1e9, 1.0), (np.nan, 5e-3), (50.0, 0.1)):
        step(constants, work, old, x, dt, 30.0, new)
        for array, kept in zip(old, before, strict=True):
            assert_array_equal(array, kept)
    assert step(constants, work, old, 50.0, 5e-3, -20.0, new) == expected
    for array, kept in zip(new, fresh, strict=True):
        assert_array_equal(array, kept)
