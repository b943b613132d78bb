"""The Maxwell branch against its closed forms for ramp, hold and sine."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests import tolerances as tol
from thermobearing.core.viscous import maxwell

K, TAU = 1.89, 0.213 / 1.89  # kN/mm and s, Table 5.2


def forces(x: np.ndarray, dt: float) -> np.ndarray:
    out, f = [], 0.0
    for dx in np.diff(x, prepend=0.0):
        f, _ = maxwell(K, TAU, f, float(dx), dt)
        out.append(f)
    return np.array(out)


@pytest.mark.parametrize("dt", [1e-3, 0.05, 1.0])
def test_ramp_and_hold(dt: float) -> None:
    """c_v v (1 - e^(-t/tau)) while it moves, then decay; exact at any step."""
    t = dt * np.arange(1, 21)
    speed = 30.0
    ramp = forces(speed * t, dt)
    assert_allclose(ramp, K * TAU * speed * -np.expm1(-t / TAU), rtol=tol.MAXWELL)
    held = forces(np.concatenate([speed * t, np.full(20, speed * t[-1])]), dt)[20:]
    assert_allclose(held, ramp[-1] * np.exp(-t / TAU), rtol=tol.MAXWELL, atol=1e-12)


def test_sine_converges_with_order_two() -> None:
    """Linear between samples: second order towards the steady response of the branch."""
    omega, amplitude, cycles = 2.0 * np.pi / 10.0, 75.0, 3
    errors = []
    for n in (500, 1000, 2000):
        t = np.linspace(0.0, 10.0 * cycles, cycles * n + 1)[1:]
        exact = (
            K
            * amplitude
            * omega
            * TAU
            / (1.0 + (omega * TAU) ** 2)
            * (np.cos(omega * t) + omega * TAU * np.sin(omega * t) - np.exp(-t / TAU))
        )
        errors.append(np.abs(forces(amplitude * np.sin(omega * t), t[0]) - exact).max())
    assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), 2.0, atol=tol.ORDER)
    assert errors[-1] < tol.MAXWELL_SINE


def test_limits_and_tangent() -> None:
    slow, _ = maxwell(K, TAU, 0.0, 1e-9, 1e3)
    assert_allclose(slow, K * TAU * 1e-12, rtol=tol.MAXWELL)  # zero rate: a dashpot alone
    fast, tangent = maxwell(K, TAU, 0.0, 1.0, 1e-9)
    assert_allclose([fast, tangent], K, rtol=1e-8)  # infinite rate: the spring alone
    force, tangent = maxwell(K, TAU, 2.0, 0.3, 0.01)
    ahead, _ = maxwell(K, TAU, 2.0, 0.3 + 1e-3, 0.01)
    assert_allclose(tangent, (ahead - force) / 1e-3, rtol=1e-9)
