"""Another solver on the same equation: scipy's adaptive Runge-Kutta on Eq. 4.35 as printed."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from tests.conftest import Recorder
from tests.quick import quick_cases
from tests.tolerances import SCIPY_ABSOLUTE, SCIPY_HYSTERESIS, SCIPY_RELATIVE
from thermobearing.core.hysteresis import exact_increment

D_Y = 1.549  # mm, Table 4.2
SHAPES = (-0.99, -0.864, -0.5, 0.0, 0.4, 1.0, 1.5, 3.0)
SHAPES += tuple(np.random.default_rng(4).uniform(-0.99, 3.0, 4).round(3))
SAMPLES = 25


def integrated(z: float, increment: float, s: float) -> float:
    """Z after a monotone increment, by DOP853 with a stop at Z = 0 (a kink of the equation)."""
    beta = 1.0 / ((1.0 + s) * D_Y**2)
    gamma = s * beta
    sigma = np.sign(increment)

    def rate(e: float, y: np.ndarray) -> np.ndarray:
        return np.asarray(sigma - beta * np.abs(y) * y - gamma * sigma * y**2)

    def crossing(e: float, y: np.ndarray) -> float:
        return float(y[0])

    crossing.terminal = True  # type: ignore[attr-defined]
    options = {"method": "DOP853", "rtol": SCIPY_RELATIVE, "atol": SCIPY_ABSOLUTE * D_Y}
    path = (0.0, abs(increment))
    if sigma * z < 0.0:
        first = solve_ivp(rate, path, [z], events=crossing, **options)
        assert first.success
        if first.status == 0:
            return float(first.y[0, -1])
        path, z = (first.t[-1], path[1]), 0.0
    second = solve_ivp(rate, path, [z], **options)
    assert second.success
    return float(second.y[0, -1])


@pytest.mark.parametrize("s", quick_cases(SHAPES, 0, 1, 5))
def test_closed_form_agrees_with_scipy(s: float, measured: Recorder) -> None:
    rng = np.random.default_rng(round(1000 * (s + 1.0)))
    curvature = (1.0 - s) / ((1.0 + s) * D_Y**2)
    worst = 0.0
    for _ in range(SAMPLES):
        z = rng.uniform(-D_Y, D_Y)
        increment = rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-2.0, 1.0) * D_Y
        closed, _ = exact_increment(z, increment, D_Y, 1.0 / D_Y, curvature)
        other = integrated(z, increment, s)
        worst = max(worst, abs(closed - other) / D_Y)
        assert_allclose(closed, other, rtol=0.0, atol=SCIPY_HYSTERESIS * D_Y)
    measured("exact increment against scipy solve_ivp, of d_y", worst, f"{SCIPY_HYSTERESIS:g}")
