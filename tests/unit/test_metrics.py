"""Measures of loops whose measures are known: ellipses, bilinear loops; cycles in noise."""

import itertools

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.results.metrics import (
    CycleMeasures,
    find_cycles,
    found_cycles,
    loop_energy,
    measure_cycle,
)

Floats = NDArray[np.float64]
AREA, RUBBER = 57600.0, 30.0  # mm2, mm


def measured(d: Floats, f: Floats) -> CycleMeasures:
    return measure_cycle(d, f, area=AREA, total_rubber_thickness=RUBBER)


def test_ellipse() -> None:
    """Elastic k d and, a quarter of a turn ahead, a viscous force of the same amplitude."""
    a, k, n = 45.0, 2.0, 4000
    t = 2.0 * np.pi * np.arange(n + 1) / n
    m = measured(a * np.sin(t), k * a * (np.sin(t) + np.cos(t)))  # sin(2 pi) is not quite zero
    assert_allclose(m.force_max_kN, np.sqrt(2.0) * k * a, rtol=tol.LOOP)
    assert_allclose(m.stiffness_kN_mm, np.sqrt(2.0) * k, rtol=tol.LOOP)
    assert_allclose(m.G_eq_MPa, 1e3 * np.sqrt(2.0) * k * RUBBER / AREA, rtol=tol.LOOP)
    # Inscribed in the ellipse is a polygon, whose area is known too.
    polygon = 0.5 * n * np.sin(2.0 * np.pi / n) * k * a**2
    assert_allclose(m.energy_kN_mm, polygon, rtol=tol.LOOP)
    assert_allclose(m.h_eq, polygon / (2.0 * np.pi * np.sqrt(2.0) * k * a**2), rtol=tol.LOOP)
    assert_allclose(m.h_eq, 0.5 / np.sqrt(2.0), rtol=tol.POLYGON)
    assert_allclose(m.characteristic_strength_kN, k * a, rtol=tol.LOOP)
    assert m.amplitude_mm == a


def bilinear(a: float, q: float, k1: float, k2: float, points: int = 60) -> tuple[Floats, Floats]:
    """The steady loop of a bilinear spring, from zero displacement on its upper branch."""
    yielding = q / (k1 - k2)
    corners_d = np.array([0.0, a, a - 2 * yielding, -a, -a + 2 * yielding, 0.0])
    upper = q + k2 * corners_d
    lower = -q + k2 * corners_d
    corners_f = np.where([True, True, False, False, True, True], upper, lower)
    where = np.linspace(0.0, 5.0, 5 * points + 1)
    return np.interp(where, range(6), corners_d), np.interp(where, range(6), corners_f)


@pytest.mark.parametrize("wanted", [(60.0, 30.0, 12.0, 2.0), (30.0, 5.0, 20.0, 0.5)])
def test_bilinear_loop(wanted: tuple[float, float, float, float]) -> None:
    a, q, k1, k2 = wanted
    m = measured(*bilinear(a, q, k1, k2))
    energy = 4.0 * q * (a - q / (k1 - k2))
    stiffness = (q + k2 * a) / a
    assert_allclose(m.energy_kN_mm, energy, rtol=tol.LOOP)
    assert_allclose(m.stiffness_kN_mm, stiffness, rtol=tol.LOOP)
    assert_allclose(m.G_eq_MPa, 1e3 * stiffness * RUBBER / AREA, rtol=tol.LOOP)
    assert_allclose(m.h_eq, energy / (2.0 * np.pi * stiffness * a**2), rtol=tol.LOOP)
    assert_allclose(m.characteristic_strength_kN, q, rtol=tol.LOOP)
    assert_allclose(m.post_yield_stiffness_kN_mm, k2, rtol=tol.LOOP)
    assert (m.force_max_kN, m.force_min_kN) == (q + k2 * a, -q - k2 * a)


def test_post_yield_stiffness_is_fitted_from_50_to_90_percent_of_each_loading_branch() -> None:
    """Two different cubics going out, something else coming back; the fit of d^3 by integrals."""
    rising = np.linspace(0.0, 1.0, 20001)
    out = [2.0 * rising**3, 5.0 * rising**3]
    back = [9.0 * np.sqrt(rising[::-1]), 9.0 * np.sqrt(rising[::-1])]
    d = np.concatenate([rising, rising[-2::-1], -rising[1:], -rising[-2::-1]])
    f = np.concatenate([out[0], back[0][1:], -out[1][1:], -back[1][1:]])
    low, high = 0.5, 0.9
    middle, width = 0.5 * (low + high), high - low
    fourth = (high**5 - low**5) / 5.0 - middle * (high**4 - low**4) / 4.0
    slope = 12.0 / width**3 * fourth  # least squares over an even distribution
    wanted = 0.5 * (2.0 + 5.0) * slope
    assert_allclose(measured(d, f).post_yield_stiffness_kN_mm, wanted, rtol=tol.FITTED_RANGE)


def test_forces_of_a_lopsided_loop() -> None:
    """Displacement and force reach further to one side."""
    t = 2.0 * np.pi * np.arange(4001) / 4000
    d = np.where(t < np.pi, 50.0, 30.0) * np.sin(t)
    f = np.where(t < np.pi, 100.0, 90.0) * np.sin(t)
    m = measured(d, f)
    assert_allclose([m.force_max_kN, m.force_min_kN], [100.0, -90.0], rtol=tol.LOOP)
    assert_allclose(m.stiffness_kN_mm, 190.0 / 80.0, rtol=tol.LOOP)
    assert_allclose(m.amplitude_mm, 40.0, rtol=tol.LOOP)
    loop = measure_cycle(d, f, area=AREA, total_rubber_thickness=RUBBER, work=1000.0)
    assert_allclose(loop.h_eq, 1000.0 / (2.0 * np.pi * 190.0 / 80.0 * 40.0**2), rtol=tol.LOOP)


def test_strength_is_half_the_difference_of_both_crossings() -> None:
    """A bilinear loop that sits 3 kN too high, whose points miss zero displacement."""
    d, f = bilinear(60.0, 30.0, 12.0, 2.0, points=7)
    coarse = measured(d[1:-1], f[1:-1] + 3.0)
    assert_allclose(coarse.characteristic_strength_kN, 30.0, rtol=tol.LOOP)


def test_cycles_are_cut_where_they_cross_zero() -> None:
    """A polygon sampled at its corners only: energy and strength are exact if the cut is."""
    a, q, k1, k2 = 60.0, 30.0, 12.0, 2.0
    knee = 2.0 * q / (k1 - k2)
    d = np.array([a, a - knee, -17.0, -40.0, -a, -a + knee, -20.0, 25.0])
    f = np.where([True, False, False, False, False, True, True, True], q, -q) + k2 * d
    d = np.concatenate([[0.0, 10.0], np.tile(d, 3), [a]])
    f = np.concatenate([[0.0, q + 10.0 * k2], np.tile(f, 3), [q + k2 * a]])
    cycles = tb.measure_history(d, f, area=AREA, total_rubber_thickness=RUBBER)
    assert len(cycles) == 3
    energy = [cycle.energy_kN_mm for cycle in cycles[1:]]
    assert_allclose(energy, 4.0 * q * (a - q / (k1 - k2)), rtol=tol.LOOP)
    strength = [cycle.characteristic_strength_kN for cycle in cycles[1:]]
    assert_allclose(strength, q, rtol=tol.LOOP)


def test_noise_within_the_threshold_makes_no_cycles() -> None:
    """A drift of 0.5 % to both sides at rest between two cycles."""
    wave = 50.0 * np.sin(2.0 * np.pi * np.linspace(0.0, 1.0, 201))
    still = 0.25 * np.sin(2.0 * np.pi * np.linspace(0.0, 3.0, 61))
    assert len(find_cycles(np.concatenate([wave, still, wave]))) == 2


def test_spring_dissipates_nothing() -> None:
    d, _ = bilinear(30.0, 5.0, 20.0, 0.5)
    m = measured(d, 3.0 * d)
    assert_allclose([m.energy_kN_mm, m.h_eq], 0.0, atol=tol.LOOP)
    assert_allclose(m.post_yield_stiffness_kN_mm, 3.0, rtol=tol.LOOP)


def test_loop_energy_is_the_work_on_the_specimen() -> None:
    assert loop_energy(np.array([0.0, 2.0, 2.0, 0.0]), np.array([0.0, 6.0, 4.0, 0.0])) == 2.0


@pytest.mark.parametrize("noise", [0.0, 0.001, 0.01])
def test_cycles_of_a_noisy_sine(noise: float) -> None:
    """Noise crosses zero many times at each turn; it makes neither more cycles nor fewer."""
    t = np.linspace(0.0, 7.0, 7001)
    rng = np.random.default_rng(3)
    d = 50.0 * (np.sin(2.0 * np.pi * t) + noise * rng.normal(size=len(t)))
    cycles = find_cycles(d)
    assert len(cycles) == 7
    for k, (first, last) in enumerate(cycles):
        assert_allclose([t[first], t[last]], [k, k + 1], atol=tol.NOISY_CROSSING)
    for (_, end), (start, _) in itertools.pairwise(cycles):
        assert abs(end - start) <= 1


def test_growing_amplitudes_rests_and_half_cycles() -> None:
    """Rests and an unfinished last cycle are left out; a small cycle counts above the threshold."""
    wave = np.sin(2.0 * np.pi * np.linspace(0.0, 1.0, 401))
    rest, half = np.zeros(50), wave[:150]
    d = np.concatenate([10.0 * wave, rest, 50.0 * wave, 0.5 * wave, rest, 50.0 * half])
    amplitudes = [np.abs(d[a : b + 1]).max() for a, b in find_cycles(d)]
    assert amplitudes == [10.0, 50.0]
    smaller = [np.abs(d[a : b + 1]).max() for a, b in find_cycles(d, smallest=0.005)]
    assert smaller == [10.0, 50.0, 0.5]


def test_first_motion_may_be_to_the_negative_side() -> None:
    d = -30.0 * np.sin(2.0 * np.pi * np.linspace(0.0, 3.0, 601))
    assert len(find_cycles(d)) == 2  # from upward crossing to upward crossing


def test_no_cycles() -> None:
    assert find_cycles(np.zeros(100)) == []
    assert find_cycles(np.empty(0)) == []
    assert find_cycles(np.linspace(0.0, 5.0, 50)) == []


@pytest.mark.parametrize(
    ("d", "f", "piece"),
    [
        (np.zeros(20), np.zeros(19), "20 points"),
        (np.zeros(20), np.zeros(20), "no full cycle"),
        (np.linspace(0, 5, 20), np.zeros(20), "no full cycle"),
        (np.empty(0), np.empty(0), "no full cycle"),
        (np.full(20, np.nan), np.zeros(20), "nan at point 1"),
        (np.sin(np.arange(20.0)), np.full(20, np.inf), "inf at point 1"),
        ("all", np.zeros(20), "lists of numbers"),
        (np.zeros((4, 5)), np.zeros((4, 5)), "points"),
    ],
)
def test_unusable_histories(d: Floats, f: Floats, piece: str) -> None:
    with pytest.raises(tb.InputError, match=piece):
        tb.measure_history(d, f, area=AREA, total_rubber_thickness=RUBBER)


@pytest.mark.parametrize("points", [40, 200, 1003])
def test_cycles_share_no_energy(points: int) -> None:
    """However coarse and wherever its points lie, each cycle counts its own area once."""
    t = np.arange(0.3, 4.2 * points) / points
    d, f = 30.0 * np.sin(2 * np.pi * t), 50.0 * np.cos(2 * np.pi * t)
    cycles = tb.measure_history(d, f, area=AREA, total_rubber_thickness=RUBBER)
    polygon = 0.5 * points * np.sin(2 * np.pi / points) * 1500.0
    assert len(cycles) == 4
    energy = [cycle.energy_kN_mm for cycle in cycles[1:]]
    assert_allclose(energy, polygon, rtol=(np.pi / points) ** 3)  # of the two cut chords


def test_known_work_needs_peaks_and_zeros_only() -> None:
    d, f = np.array([0.0, 30.0, 0.0, -30.0, 0.0]), np.array([9.0, 60.0, -9.0, -60.0, 9.0])
    m = measure_cycle(d, f, area=AREA, total_rubber_thickness=RUBBER, work=700.0)
    assert_allclose(m.h_eq, 700.0 / (2.0 * np.pi * 2.0 * 900.0), rtol=tol.LOOP)


@pytest.mark.parametrize(
    ("d", "f", "area"),
    [
        (np.arange(5.0), np.arange(5.0), AREA),  # too few points
        (np.arange(9.0), np.arange(9.0), 0.0),
        (np.zeros(50), np.ones(50), AREA),  # no displacement
        (np.full(20, np.nan), np.zeros(20), AREA),
    ],
)
def test_unusable_cycles(d: Floats, f: Floats, area: float) -> None:
    with pytest.raises(tb.InputError):
        measure_cycle(d, f, area=area, total_rubber_thickness=RUBBER)


def rested(gap: int, jitter: float, level: float) -> tuple[Floats, Floats, list[tuple[int, int]]]:
    """Three bilinear cycles with rests between them, in which force is lost and the rig jitters."""
    d, f = bilinear(60.0, 30.0, 12.0, 2.0)
    rng = np.random.default_rng(5)
    noise = jitter * rng.normal(size=gap)
    lost = 30.0 * np.exp(-np.arange(gap) / max(1.0, 0.1 * gap)) + 2.0 * noise
    parts = [(d, f), (level + noise, lost)] * 3
    rests = [(k * (len(d) + gap) + len(d), (k + 1) * (len(d) + gap) - 1) for k in range(3) if gap]
    return np.concatenate([p[0] for p in parts]), np.concatenate([p[1] for p in parts]), rests


@pytest.mark.parametrize("told", [True, False])
@pytest.mark.parametrize(("gap", "jitter", "level"), [(2, 0, 0), (4000, 0, 0), (4000, 0.02, 0)])
def test_strength_of_cycles_before_a_rest(
    gap: int, jitter: float, level: float, told: bool
) -> None:
    """The force that is lost in a rest belongs to no cycle, whether the rest is known or not."""
    d, f, rests = rested(gap, jitter, level)
    known = rests if told else []
    cycles = tb.measure_history(d, f, area=AREA, total_rubber_thickness=RUBBER, rests=known)
    strengths = [cycle.characteristic_strength_kN for cycle in cycles]
    assert_allclose(strengths, 30.0, rtol=tol.FORCE_AT_A_REST)
    assert [cycle.ends for cycle in found_cycles(d, rests=known)] == (
        ["rest"] * 3 if told or gap > 2 else ["closed"] * 3
    )


@pytest.mark.parametrize("level", [-0.4, 0.4])
def test_rests_beside_zero(level: float) -> None:
    d, f, rests = rested(500, 0.02, level)
    cycles = tb.measure_history(d, f, area=AREA, total_rubber_thickness=RUBBER, rests=rests)
    strengths = [cycle.characteristic_strength_kN for cycle in cycles]
    assert_allclose(strengths, 30.0, rtol=tol.FORCE_AT_A_REST)


def test_a_cycle_that_does_not_close_is_told_apart() -> None:
    d, _ = bilinear(60.0, 30.0, 12.0, 2.0)
    found = found_cycles(np.concatenate([d, d[1 : len(d) // 2]]))
    assert [cycle.ends for cycle in found] == ["closed", "incomplete"]
