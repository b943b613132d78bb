"""Z after one increment: the closed form against an adaptive Runge-Kutta solver."""

import numpy as np
from scipy.integrate import solve_ivp

import thermobearing as tb
from benchmarks.rows import Row, at_most, plain
from benchmarks.specimen import NAME
from thermobearing.core.hysteresis import euler_increment, exact_increment

SAMPLES = 200
LARGEST = 3.0  # increment, in yield displacements
LIMIT = 1e-9  # of the yield displacement


def integrated(z: float, increment: float, s: float) -> float:
    """Eq. 4.35-4.37 as printed in units of the yield displacement, by DOP853."""
    beta = 1.0 / (1.0 + s)

    def rate(part: float, y: np.ndarray) -> np.ndarray:
        return np.asarray(
            increment - beta * np.abs(increment * y) * y - s * beta * increment * y**2
        )

    # Short steps: the equation has a kink at Z = 0, where a long one would lose its accuracy.
    solution = solve_ivp(
        rate, (0.0, 1.0), [z], method="DOP853", rtol=1e-13, atol=1e-15, max_step=0.01
    )
    return float(solution.y[0, -1])


def rows() -> list[Row]:
    """Largest difference over random starts and increments of either sign."""
    s = tb.load_bearing(NAME).hysteresis.shape
    curvature = (1.0 - s) / (1.0 + s)
    rng = np.random.default_rng(1)
    exact, euler = 0.0, 0.0
    for z, increment in zip(
        rng.uniform(-1.0, 1.0, SAMPLES), rng.uniform(-LARGEST, LARGEST, SAMPLES), strict=True
    ):
        expected = integrated(z, increment, s)
        exact = max(exact, abs(exact_increment(z, increment, 1.0, 1.0, curvature)[0] - expected))
        small = 0.01 * increment  # explicit Euler is meant for small increments
        expected = integrated(z, small, s)
        euler = max(euler, abs(euler_increment(z, small, 1.0, curvature)[0] - expected))
    return [
        at_most(f"exact increment up to {LARGEST:g} d_y against DOP853", exact, LIMIT, "d_y"),
        plain(f"Euler increment up to {0.01 * LARGEST:g} d_y against DOP853", euler, "d_y"),
    ]
