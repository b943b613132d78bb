"""Single numbers of the kernels that no whole run shows."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests import tolerances as tol
from tests.verification.models import assembled, heat_step, specimen
from thermobearing.core.step import step
from thermobearing.core.types import EULER_UNSTABLE, new_state, new_workspace


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_euler_that_runs_away_is_told_in_both_directions(direction: float) -> None:
    bearing, constants = specimen(), assembled(specimen(), integrator="euler")
    start = np.zeros(len(constants.cells.capacity))
    old, new = new_state(constants, start), new_state(constants, start)
    x = 10.0 * bearing.hysteresis.yield_displacement * bearing.geometry.rubber_layers
    found = step(constants, new_workspace(constants), old, direction * x, 0.01, 0.0, new)
    assert found[2] == EULER_UNSTABLE


@pytest.mark.parametrize(("scheme", "share_of_change"), [("published", 0.0), ("conservative", 0.5)])
def test_side_loss_in_the_books_is_that_of_the_scheme(scheme: str, share_of_change: float) -> None:
    """Published: with the temperatures before the step; conservative: with the mean ones."""
    constants = assembled(specimen(), scheme=scheme)
    above = np.linspace(5.0, 40.0, len(constants.cells.capacity))
    found = heat_step(constants, above - 20.0, 10.0, -20.0, 0.0 * above)
    rate = constants.cells.capacity * constants.cells.side_loss
    assert rate.max() > 0.0
    expected = 10.0 * float(rate @ (above + share_of_change * found.change))
    assert_allclose(found.sides, expected, rtol=tol.HEAT_BALANCE)
