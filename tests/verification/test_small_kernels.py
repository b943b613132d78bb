"""Single numbers of the kernels that no whole run shows."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests import tolerances as tol
from tests.verification.models import assembled, heat_step, sine, specimen
from thermobearing.core.march import copy_state
from thermobearing.core.sharing import newton, share, uniform_trial
from thermobearing.core.step import set_stiffness, step
from thermobearing.core.types import EULER_UNSTABLE, SOFTENED, new_state, new_workspace


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_euler_that_runs_away_is_told_in_both_directions(direction: float) -> None:
    """One step of ten yield displacements in every layer."""
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


def test_tangent_of_softened_steps_is_the_derivative_at_their_weight() -> None:
    """Newton's common force a little above and below, at the weight that the step chose."""
    bearing, constants = specimen(), assembled(specimen())
    rubber, layers = constants.rubber, constants.multiplicity
    work, start = new_workspace(constants), np.full(len(constants.cells.capacity), -40.0)
    old, new, trial = (new_state(constants, start) for _ in range(3))
    h, checked = tol.TANGENT_STEP_BEARING, 0
    for x in sine(bearing, strain=3.0, period=4.0, cycles=1, dt=5e-3):
        before = old.books[0].displacement
        outcome = step(constants, work, old, x, 5e-3, -40.0, new)[2]
        if outcome == SOFTENED:
            set_stiffness(rubber, constants.layer_cells, old.temperature, work.layers)
            given = (rubber, layers, old.layers, work.layers)
            tangent, w = np.array(share(*given, before, x, trial.layers))[[1, 3]]
            forces = []
            for at in (x + h, x - h):
                each, mean = (at - before) / rubber.layer_count, at / rubber.layer_count
                least = uniform_trial(rubber, old.layers, work.layers, each, mean, w, trial.layers)
                forces.append(newton(*given, at, w, trial.layers, least)[0])
            slope = (forces[0] - forces[1]) / (2.0 * h)
            assert_allclose(tangent, slope, rtol=tol.SOFTENED_TANGENT)
            checked += 1
        copy_state(new, old)
    assert checked > 10
