"""Conduction keeps its books: heat balance to rounding, no new extremes, monotone decay."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests.tolerances import HEAT_BALANCE, NEW_EXTREME, RECIPROCITY
from tests.verification.models import assembled, changed, heat_step, rate_matrix, specimen
from thermobearing.core.types import Constants
from thermobearing.model.stack import Face

AMBIENT = -20.0
FACES = {"eta": Face(eta=2.0), "fixed": Face(eta=3.0), "film": Face(film=25.0)}


def stack(face: str, half: bool) -> Constants:
    lower = None if half else Face(film=5.0)
    return assembled(specimen(), half=half, upper=FACES[face], lower=lower)


@pytest.mark.parametrize("half", [True, False])
@pytest.mark.parametrize("face", FACES)
@pytest.mark.parametrize("dt", [1e-4, 5e-3, 1.0, 600.0])
def test_heat_in_is_heat_stored_plus_heat_lost(face: str, half: bool, dt: float) -> None:
    """Any temperatures, any sources, any step: what leaves one cell enters the next."""
    constants = stack(face, half)
    capacity = constants.cells.capacity
    rng = np.random.default_rng(11)
    for _ in range(20):
        temperature = rng.uniform(-60.0, 60.0, len(capacity))
        source = rng.normal(size=len(capacity))
        heat = heat_step(constants, temperature, dt, AMBIENT, source)
        stored = float(capacity @ heat.change)
        size = float(capacity @ np.abs(heat.change)) + abs(heat.ends) + abs(heat.sides)
        residual = float(capacity @ source) - stored - heat.ends - heat.sides
        assert_allclose(residual, 0.0, rtol=0.0, atol=HEAT_BALANCE * size)
        assert_allclose(heat.stored, stored, rtol=0.0, atol=HEAT_BALANCE * size)


@pytest.mark.parametrize("half", [True, False])
def test_neighbours_exchange_the_same_heat(half: bool) -> None:
    """Per kelvin, what one cell gives downwards is what the next takes from above."""
    constants = stack("eta", half)
    down = (constants.cells.capacity * constants.cells.to_next)[:-1]
    up = (constants.cells.capacity * constants.cells.to_previous)[1:]
    assert_allclose(down, up, rtol=RECIPROCITY, atol=0.0)


@pytest.mark.parametrize("face", FACES)
def test_no_new_extremes_where_the_step_is_short_enough(face: str) -> None:
    """Crank-Nicolson is bounded while dt/2 times every cell's own rate stays below 1."""
    constants = stack(face, half=False)
    dt = 2.0 / float(np.max(np.diag(rate_matrix(constants))))
    assert dt > 0.1  # s: far above the steps used in tests and earthquakes
    nothing = np.zeros(len(constants.cells.capacity))
    rng = np.random.default_rng(12)
    for _ in range(20):
        temperature = rng.uniform(-40.0, 40.0, len(nothing))
        for _ in range(50):
            low = min(temperature.min(), AMBIENT) - NEW_EXTREME
            high = max(temperature.max(), AMBIENT) + NEW_EXTREME
            temperature = (
                temperature + heat_step(constants, temperature, dt, AMBIENT, nothing).change
            )
            assert low <= temperature.min()
            assert temperature.max() <= high


@pytest.mark.parametrize("dt", [5e-3, 1.0, 60.0, 3600.0])
@pytest.mark.parametrize("face", ["eta", "film"])
def test_cooling_is_monotone_for_any_step(face: str, dt: float) -> None:
    """Capacity-weighted departure from the ambient falls in every step, however long it is."""
    constants = stack(face, half=False)
    capacity = constants.cells.capacity
    nothing = np.zeros(len(capacity))
    temperature = np.random.default_rng(13).uniform(-40.0, 40.0, len(capacity))
    before = float(capacity @ (temperature - AMBIENT) ** 2)
    for _ in range(100):
        temperature = temperature + heat_step(constants, temperature, dt, AMBIENT, nothing).change
        after = float(capacity @ (temperature - AMBIENT) ** 2)
        assert after < before
        before = after


def test_a_bearing_at_the_ambient_temperature_stays_there() -> None:
    """Side film, end film and eta all vanish at the ambient: not one bit of drift."""
    bearing = changed(specimen(), materials={"side_film": 500.0})
    constants = assembled(bearing, half=False, upper=Face(eta=2.0), lower=Face(film=40.0))
    still = np.full(len(constants.cells.capacity), AMBIENT)
    change = heat_step(constants, still, 0.5, AMBIENT, np.zeros(len(still))).change
    assert not change.any()
