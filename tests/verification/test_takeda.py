"""The degrading hinge: every rule by hand, any increment, energy."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from tests import tolerances as tol
from thermobearing.core.records import Floats, Rows, filled
from thermobearing.structure.connections.takeda import straight_hinges, takeda
from thermobearing.structure.types import Hinge, HingeState

YIELD, STIFFNESS = 0.002, 1e4  # rad, kN mm/rad: yields at 20
EXPONENT = 0.5


def hinge(hardening: float = 0.0, exponent: float = EXPONENT) -> Rows[Hinge]:
    return filled(
        Hinge, initial=STIFFNESS, yield_rotation=YIELD, hardening=hardening, unloading=exponent
    )


def turned(constants: Rows[Hinge], state: HingeState, rotation: float) -> tuple[HingeState, float]:
    new = straight_hinges(constants)
    return new, takeda(constants, state, 0, rotation, new)


def walk(constants: Rows[Hinge], rotations: Floats, parts: int = 1) -> tuple[Floats, Floats]:
    """Moments and tangents at the rotations, each leg in so many equal increments."""
    state, new, here = straight_hinges(constants), straight_hinges(constants), 0.0
    moments, slopes = [], []
    for end in rotations:
        for target in np.linspace(here, end, parts + 1)[1:].tolist():
            slope = takeda(constants, state, 0, target, new)
            state, new = new, state
        here = end
        moments.append(state.bends[0].moment)
        slopes.append(slope)
    return np.array(moments), np.array(slopes)


def test_every_rule() -> None:
    """By hand: yield to 4 yields, unload half as stiff, head for the yield point, come back."""
    y, m = YIELD, STIFFNESS * YIELD
    soft = STIFFNESS * 0.5  # (1/4)^0.5
    zero = 4.0 * y - m / soft  # = 2 y
    path = [0.5, -0.5, 1.0, 4.0, 3.0, 4.0, 2.0, 0.5, -1.0, -3.0]
    expected = [
        0.5 * m,  # elastic
        -0.5 * m,
        m,  # yields
        m,  # backbone without hardening
        m - soft * y,  # unloads
        m,  # comes back to where it turned
        0.0,  # zero moment
        -m * 1.5 / 3.0,  # heads for the yield point on the other side, from 2 y to -y
        -m,
        -m,  # backbone
    ]
    assert zero == pytest.approx(2.0 * y)
    moments, slopes = walk(hinge(), y * np.array(path))
    assert_allclose(moments, expected, atol=tol.TAKEDA * m)
    assert_allclose(slopes[[0, 4, 5]], [STIFFNESS, soft, soft], rtol=tol.TAKEDA)
    assert slopes[3] == 0.0


def test_reloading_heads_for_the_farthest_point() -> None:
    """After 4 yields up and 3 down, upward motion aims at (4 y, m) again."""
    y, m = YIELD, STIFFNESS * YIELD
    state_path = y * np.array([4.0, -3.0])
    ku = STIFFNESS * (1.0 / 3.0) ** EXPONENT
    zero = -3.0 * y + m / ku
    half = 0.5 * (zero + 4.0 * y)
    moments, _ = walk(hinge(), np.array([*state_path, half, 4.0 * y, 5.0 * y]))
    assert_allclose(moments[2:], [0.5 * m, m, m], atol=tol.TAKEDA * m)


def test_no_degradation_and_hardening() -> None:
    y, m = YIELD, STIFFNESS * YIELD
    moments, slopes = walk(hinge(0.1, 0.0), y * np.array([3.0, 2.5]))
    assert_allclose(moments, [1.2 * m, 0.7 * m], atol=tol.TAKEDA * m)
    assert_allclose(slopes, [0.1 * STIFFNESS, STIFFNESS], rtol=tol.TAKEDA)


paths = st.lists(st.floats(-8.0, 8.0, allow_nan=False), min_size=1, max_size=12)


@settings(max_examples=30, derandomize=True, deadline=None, database=None)
@given(paths, st.sampled_from([0.0, 0.5, 1.0]), st.sampled_from([0.0, 0.05]))
def test_any_increment_mirror_and_energy(
    path: list[float], exponent: float, hardening: float
) -> None:
    """One increment or a hundred: the same; turned over: the same; never gives energy away."""
    constants, rotations = hinge(hardening, exponent), YIELD * np.array(path)
    m = STIFFNESS * YIELD
    once, _ = walk(constants, rotations)
    often, _ = walk(constants, rotations, 100)
    assert_allclose(often, once, atol=1e-9 * m)
    mirrored, _ = walk(constants, -rotations)
    assert_allclose(mirrored, -once, atol=tol.TAKEDA * m)
    assert np.all(np.abs(once) <= m * (1.0 + hardening * 8.0) * (1.0 + 1e-12))
    fine = np.concatenate(
        [np.linspace(a, b, 101)[1:] for a, b in zip([0.0, *rotations[:-1]], rotations, strict=True)]
    )
    moments, _ = walk(constants, np.append(fine, 0.0 * fine[-1]))
    x = np.concatenate([[0.0], fine, [0.0]])
    f = np.concatenate([[0.0], moments])
    work = float((0.5 * (f[1:] + f[:-1]) * np.diff(x)).sum())
    assert work > -1e-2 * m * YIELD  # trapezoids across corners


def test_tangent_is_the_slope() -> None:
    constants = hinge(0.02)
    rng = np.random.default_rng(3)
    state = straight_hinges(constants)
    for target in YIELD * rng.uniform(-6.0, 6.0, 60):
        for part in np.linspace(0.0, 1.0, 8)[1:]:
            here = state.bends[0].rotation
            rotation = float((1.0 - part) * here + part * target)
            if rotation == here:
                continue
            new, slope = turned(constants, state, rotation)
            step = 1e-9 * np.sign(rotation - here)
            near, _ = turned(constants, state, rotation - step)
            difference = (new.bends[0].moment - near.bends[0].moment) / step
            assert_allclose(difference, slope, atol=1e-3 * STIFFNESS)
            state = new
