"""The hysteretic variable and the Maxwell branch against their closed forms."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests import tolerances as tol
from tests.quick import quick_cases
from thermobearing.core.hysteresis import euler_increment, exact_increment
from thermobearing.core.records import rows
from thermobearing.core.step import maxwell, relax
from thermobearing.core.types import DurationWork

D_Y = 1.549  # mm, Table 4.2; the law scales with it
SHAPES = (-0.99, -0.864, -0.3, 0.0, 0.5, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.7, 3.0)
SAMPLES = 60


def curvature(s: float) -> float:
    """beta - gamma of Eq. 4.36 and 4.37 [1/mm2]."""
    beta = 1.0 / ((1.0 + s) * D_Y**2)
    return beta - s * beta


def samples(seed: int) -> list[tuple[float, float]]:
    """Random (Z, increment), small and large increments alike [mm]."""
    rng = np.random.default_rng(seed)
    z = rng.uniform(-D_Y, D_Y, SAMPLES)
    size = 10.0 ** rng.uniform(-3.0, 1.0, SAMPLES) * D_Y
    sign = rng.choice([-1.0, 1.0], SAMPLES)
    edges = [(z, e) for z in (-D_Y, 0.0, D_Y) for e in (-3.0 * D_Y, -0.1 * D_Y, 0.1 * D_Y)]
    return [*zip(z, sign * size, strict=True), *edges]


@pytest.mark.parametrize("s", quick_cases(SHAPES, 1, 7))
def test_one_increment_equals_a_thousand_small_ones(s: float) -> None:
    c = curvature(s)
    for z, increment in samples(1):
        whole, slope = exact_increment(z, increment, D_Y, 1.0 / D_Y, c)
        part, part_slope = z, 0.0
        for _ in range(1000):
            part, part_slope = exact_increment(part, increment / 1000, D_Y, 1.0 / D_Y, c)
        assert_allclose(part, whole, rtol=0.0, atol=tol.SPLIT_INCREMENT * D_Y)
        assert_allclose(part_slope, slope, rtol=0.0, atol=tol.SPLIT_INCREMENT / (1.0 + s))


@pytest.mark.parametrize("s", SHAPES)
def test_tangent_is_the_derivative_of_the_increment(s: float) -> None:
    c, h = curvature(s), tol.TANGENT_STEP * D_Y
    for z, increment in samples(2):
        _, slope = exact_increment(z, increment, D_Y, 1.0 / D_Y, c)
        above, _ = exact_increment(z, increment + h, D_Y, 1.0 / D_Y, c)
        below, _ = exact_increment(z, increment - h, D_Y, 1.0 / D_Y, c)
        difference = (above - below) / (2.0 * h)
        assert_allclose(slope, difference, rtol=tol.TANGENT_HYSTERESIS, atol=tol.TANGENT_HYSTERESIS)


@pytest.mark.parametrize("s", SHAPES)
def test_z_stays_within_the_yield_displacement_and_is_odd(s: float) -> None:
    c = curvature(s)
    for z, increment in samples(3):
        new, slope = exact_increment(z, increment, D_Y, 1.0 / D_Y, c)
        assert abs(new) <= D_Y * (1.0 + tol.BOUND_ROUNDING)
        assert slope >= -tol.BOUND_ROUNDING
        assert exact_increment(-z, -increment, D_Y, 1.0 / D_Y, c) == (-new, slope)


def test_z_saturates_at_the_yield_displacement() -> None:
    """A = 1: Eq. 5.35 drops it, and any other value would saturate elsewhere."""
    for s in SHAPES:
        z, slope = exact_increment(-0.7 * D_Y, 40.0 * D_Y, D_Y, 1.0 / D_Y, curvature(s))
        assert_allclose(z, D_Y, rtol=tol.BOUND_ROUNDING, atol=0.0)
        assert_allclose(slope, 0.0, rtol=0.0, atol=4.0 * tol.BOUND_ROUNDING)


def z_after(path: np.ndarray, c: float, euler: bool) -> float:
    z, d = 0.0, 0.0
    for target in path:
        if euler:
            z, _ = euler_increment(z, target - d, 1.0 / D_Y, c)
        else:
            z, _ = exact_increment(z, target - d, D_Y, 1.0 / D_Y, c)
        d = target
    return z


@pytest.mark.parametrize("s", quick_cases([-0.864, 0.5, 1.0, 3.0], 0, 2))
def test_euler_tends_to_the_exact_increment_with_order_one(s: float) -> None:
    errors = []
    for steps in (4000, 8000, 16000):
        t = np.arange(1, steps + 1) / steps
        path = 3.0 * D_Y * np.sin(2.0 * np.pi * 1.3 * t)
        c = curvature(s)
        errors.append(abs(z_after(path, c, True) - z_after(path, c, False)))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert_allclose(orders, 1.0, rtol=0.0, atol=tol.ORDER)


K, TAU = 1.89, 0.213 / 1.89  # kN/mm and s, Table 5.2


def viscous(force: float, dx: float, dt: float) -> tuple[float, float]:
    """Force [kN] and tangent [kN/mm] after dx [mm] in dt [s]."""
    duration = rows(DurationWork, 1)[0]
    relax(TAU, dt, duration)
    return maxwell(K, duration, force, dx)


def forces(x: np.ndarray, dt: float) -> np.ndarray:
    out, f = [], 0.0
    for dx in np.diff(x, prepend=0.0):
        f, _ = viscous(f, float(dx), dt)
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
    slow, _ = viscous(0.0, 1e-9, 1e3)
    assert_allclose(slow, K * TAU * 1e-12, rtol=tol.MAXWELL)  # zero rate: a dashpot alone
    fast, tangent = viscous(0.0, 1.0, 1e-9)
    assert_allclose([fast, tangent], K, rtol=1e-8)  # infinite rate: the spring alone
    force, tangent = viscous(2.0, 0.3, 0.01)
    ahead, _ = viscous(2.0, 0.3 + 1e-3, 0.01)
    assert_allclose(tangent, (ahead - force) / 1e-3, rtol=1e-9)
