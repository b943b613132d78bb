"""Measures of cycles, the largest loop of a history, residuals of next to nothing."""

import itertools
from dataclasses import astuple, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.results import metrics

Floats = NDArray[np.float64]
AREA, RUBBER = 57600.0, 30.0  # mm2, mm


def measured(d: Floats, f: Floats) -> metrics.CycleMeasures:
    return metrics.measure_cycle(d, f, area=AREA, total_rubber_thickness=RUBBER)


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
    t = 2.0 * np.pi * np.arange(4001) / 4000
    d = np.where(t < np.pi, 50.0, 30.0) * np.sin(t)
    f = np.where(t < np.pi, 100.0, 90.0) * np.sin(t)
    m = measured(d, f)
    assert_allclose([m.force_max_kN, m.force_min_kN], [100.0, -90.0], rtol=tol.LOOP)
    assert_allclose(m.stiffness_kN_mm, 190.0 / 80.0, rtol=tol.LOOP)
    assert_allclose(m.amplitude_mm, 40.0, rtol=tol.LOOP)
    loop = metrics.measure_cycle(d, f, area=AREA, total_rubber_thickness=RUBBER, work=1000.0)
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
    assert len(metrics.find_cycles(np.concatenate([wave, still, wave]))) == 2


@pytest.mark.parametrize("noise", [0.0, 0.001, 0.01])
def test_cycles_of_a_noisy_sine(noise: float) -> None:
    """Noise crosses zero many times at each turn; it makes neither more cycles nor fewer."""
    t = np.linspace(0.0, 7.0, 7001)
    rng = np.random.default_rng(3)
    d = 50.0 * (np.sin(2.0 * np.pi * t) + noise * rng.normal(size=len(t)))
    cycles = metrics.find_cycles(d)
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
    amplitudes = [np.abs(d[a : b + 1]).max() for a, b in metrics.find_cycles(d)]
    assert amplitudes == [10.0, 50.0]
    smaller = [np.abs(d[a : b + 1]).max() for a, b in metrics.find_cycles(d, smallest=0.005)]
    assert smaller == [10.0, 50.0, 0.5]


def test_first_motion_may_be_to_the_negative_side() -> None:
    d = -30.0 * np.sin(2.0 * np.pi * np.linspace(0.0, 3.0, 601))
    assert len(metrics.find_cycles(d)) == 3  # from downward crossing to downward crossing


@pytest.mark.parametrize("with_rests", [True, False])
def test_a_record_and_its_mirror_image_have_the_same_cycles(with_rests: bool) -> None:
    """Levels with rests between them, each cycle with its own amplitude on both sides."""
    parts, rests, count = list[tuple[Floats, Floats]](), list[tuple[int, int]](), 0
    for amplitude in (15.0, 30.0, 52.5):
        loop = bilinear(amplitude, 30.0, 12.0, 2.0, points=101)
        path = tuple(np.concatenate([loop[k], 0.1 * loop[k]]) for k in range(2))
        still = np.full(300, path[0][-1]), np.linspace(path[1][-1], 0.0, 300)
        rests.append((count + len(path[0]), count + len(path[0]) + 299))
        count += len(path[0]) + 300
        parts += [(path[0], path[1]), still]
    d, f = (np.concatenate([part[k] for part in parts]) for k in range(2))
    f = f + 0.02 * np.abs(d)  # stiffer to one side
    options = {"rests": rests} if with_rests else {}
    size: dict[str, Any] = {"area": AREA, "total_rubber_thickness": RUBBER} | options
    cycles, mirrored = (tb.measure_history(side * d, side * f, **size) for side in (1.0, -1.0))
    assert [round(cycle.amplitude_mm, 9) for cycle in cycles] == [15.0, 1.5, 30.0, 3.0, 52.5, 5.25]
    for cycle, mirror in zip(cycles, mirrored, strict=True):
        swapped = replace(
            mirror,
            force_max_kN=-mirror.force_min_kN,
            force_min_kN=-mirror.force_max_kN,
            displacement_max_mm=-mirror.displacement_min_mm,
            displacement_min_mm=-mirror.displacement_max_mm,
        )
        assert_allclose(astuple(swapped), astuple(cycle), rtol=tol.LOOP)
    places, mirrored_places = (metrics.cut_cycles(side * d, **options) for side in (1.0, -1.0))
    assert [replace(cycle, side=1.0) for cycle in mirrored_places] == places


def test_no_cycles() -> None:
    assert metrics.find_cycles(np.zeros(100)) == []
    assert metrics.find_cycles(np.empty(0)) == []
    assert metrics.find_cycles(np.linspace(0.0, 5.0, 50)) == []


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


def test_unusable_side() -> None:
    d, f = bilinear(60.0, 30.0, 12.0, 2.0)
    with pytest.raises(tb.InputError, match="side is 0"):
        tb.measure_history(d, f, area=AREA, total_rubber_thickness=RUBBER, side=0.0)


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
        metrics.measure_cycle(d, f, area=area, total_rubber_thickness=RUBBER)


def rested(gap: int, jitter: float, level: float) -> tuple[Floats, Floats, list[tuple[int, int]]]:
    """Three bilinear cycles with rests between them, in which force is lost and the rig jitters."""
    d, f = bilinear(60.0, 30.0, 12.0, 2.0)
    rng = np.random.default_rng(5)
    noise = jitter * rng.normal(size=gap)
    lost = 30.0 * np.exp(-np.arange(gap) / max(1.0, 0.1 * gap)) + 2.0 * noise
    parts = [(d, f), (level + noise, lost)] * 3
    rests = [(k * (len(d) + gap) + len(d), (k + 1) * (len(d) + gap) - 1) for k in range(3) if gap]
    return np.concatenate([p[0] for p in parts]), np.concatenate([p[1] for p in parts]), rests


@pytest.mark.parametrize("given", [True, False])
@pytest.mark.parametrize(
    ("gap", "jitter", "level"),
    [(2, 0, 0), (4000, 0, 0), (4000, 0.02, 0), (500, 0.02, -0.4), (500, 0.02, 0.4)],
)
def test_strength_of_cycles_before_a_rest(
    gap: int, jitter: float, level: float, given: bool
) -> None:
    """The force that is lost in a rest belongs to no cycle, whether the rest is known or not."""
    d, f, rests = rested(gap, jitter, level)
    known = rests if given or level else []
    cycles = tb.measure_history(d, f, area=AREA, total_rubber_thickness=RUBBER, rests=known)
    strengths = [cycle.characteristic_strength_kN for cycle in cycles]
    assert_allclose(strengths, 30.0, rtol=tol.FORCE_AT_A_REST)
    ends = [cycle.ends for cycle in metrics.cut_cycles(d, rests=known)]
    assert level or ends == (["rest"] * 3 if given or gap > 2 else ["closed"] * 3)


def test_a_cycle_that_does_not_close_is_reported_apart() -> None:
    d, _ = bilinear(60.0, 30.0, 12.0, 2.0)
    cycles = metrics.cut_cycles(np.concatenate([d, d[1 : len(d) // 2]]))
    assert [cycle.ends for cycle in cycles] == ["closed", "incomplete"]


PLAN = {"area": 1e4, "total_rubber_thickness": 20.0}


def waves(*amplitudes: float, points: int = 200) -> np.ndarray:
    angle = np.linspace(0.0, np.pi, points + 1)
    parts = [a * np.sin(angle[:-1]) for a in amplitudes]
    d = np.concatenate([*parts, [0.0]])
    d[::points] = 0.0
    return d


@pytest.mark.parametrize(
    ("amplitudes", "pieces"),
    [
        ((1, -2, 5, -3, 1), (2, 4)),  # with the wider neighbour, here the later
        ((1, -4, 5, -3, 1), (1, 3)),  # here the earlier
        ((1, -4, 5, -4, 1), (2, 4)),  # of equal ones the later
        ((2, -5, 1), (0, 2)),  # begins at the start
        ((1, 2, -3, 5, -6), (3, 5)),  # ends at the end; two pieces of one side are one
        ((-7, 3, -1), (0, 2)),
    ],
)
def test_pieces_of_the_largest_loop(amplitudes: tuple[int, ...], pieces: tuple[int, int]) -> None:
    d = waves(*map(float, amplitudes))
    assert metrics.find_largest_loop(d) == (200 * pieces[0], 200 * pieces[1])


@pytest.mark.parametrize(
    "d",
    [
        np.zeros(50),
        np.array([]),
        waves(3.0),  # one side only
        waves(1.0, -2.0, 5.0)[:-100],  # stopped at its largest displacement
        waves(5.0, -2.0)[100:],  # began there
        waves(5.0, -2.0)[:-100],  # its only neighbour is not closed
    ],
)
def test_a_largest_displacement_outside_any_loop(d: np.ndarray) -> None:
    assert metrics.find_largest_loop(d) is None
    assert metrics.largest_loop(d, d, **PLAN) is None


def test_a_neighbour_that_is_not_closed_leaves_the_other() -> None:
    assert metrics.find_largest_loop(waves(2.0, -5.0, 4.0)[:-100]) == (0, 400)


def test_what_stays_on_one_side_after_the_loop_is_not_in_it() -> None:
    """Small waves on both sides, then at rest near zero: the loop is closed by then."""
    d = np.concatenate([waves(0.05, -3.0, 5.0, -0.05)[:-1], np.linspace(0.0, 0.4, 100)])
    assert metrics.find_largest_loop(d) == (200, 600)


def test_noise_at_zero_cuts_no_loop() -> None:
    d = waves(1.0, 5.0, -4.0)
    d[190:210] = 0.05 * np.cos(np.arange(20.0))
    assert metrics.find_largest_loop(np.concatenate([waves(-1.0)[:-1], d]))[1] == 800


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("shift", [0.0, 0.37])
def test_measures_of_an_ellipse_among_smaller_ones(sign: float, shift: float) -> None:
    """f = k d + c d'/omega of a whole sine: K_eq, h_eq, energy and extremes in closed form."""
    stiffness, viscous, amplitude = 1.5, 0.4, 30.0
    angle = np.linspace(0.0, 6.0 * np.pi, 6001) + shift / 1000.0
    wide = np.abs(angle - 3.0 * np.pi) < np.pi + 0.003  # with the points next to the zeros
    size = np.where(wide, amplitude, 0.3 * amplitude)
    d = sign * size * np.sin(angle)
    if shift == 0.0:
        d[[2000, 4000]] = 0.0
    f = stiffness * d + viscous * sign * size * np.cos(angle)
    loop = metrics.largest_loop(d, f, **PLAN)
    assert loop is not None
    assert (loop.first, loop.last) == (2000 - (shift > 0), 4000)
    m = loop.measures
    peak = amplitude * np.hypot(stiffness, viscous)
    energy = np.pi * viscous * amplitude**2
    near = {"rel": tol.LOOP_POINTS}
    assert m.force_max_kN == pytest.approx(peak, **near)
    assert m.force_min_kN == pytest.approx(-peak, **near)
    assert m.displacement_max_mm == pytest.approx(amplitude, **near)
    assert m.displacement_min_mm == pytest.approx(-amplitude, **near)
    assert m.energy_kN_mm == pytest.approx(energy, **near)
    assert m.stiffness_kN_mm == pytest.approx(peak / amplitude, **near)
    assert m.h_eq == pytest.approx(energy / (2.0 * np.pi * peak * amplitude), **near)
    assert m.G_eq_MPa == pytest.approx(2.0 * peak / amplitude, **near)


def test_work_is_that_of_the_balance_from_zero_to_zero() -> None:
    """Work that grows evenly with the place in the history: its share between the two zeros."""
    angle = np.linspace(-3.5, 3.0 * np.pi, 801)
    d = np.exp(-0.05 * np.abs(angle - 1.6)) * np.sin(angle)
    loop = metrics.largest_loop(d, d, 7.0 * angle, **PLAN)
    assert loop is not None
    assert loop.measures.energy_kN_mm == pytest.approx(14.0 * np.pi, rel=tol.LOOP_POINTS)


def test_noise_does_not_choose_between_equal_excursions() -> None:
    """Three cycles of one amplitude, the third a hair larger: of a test, the first is meant."""
    angle = np.linspace(0.0, 6.0 * np.pi, 601)
    d = np.sin(angle) * np.where(angle > 4.0 * np.pi, 1.004, 1.0)
    assert metrics.find_largest_loop(d) == (399, 600)
    assert metrics.find_largest_loop(d, 0.01) == (0, 200)
    assert metrics.find_largest_loop(-d, 0.01) == (0, 200)


def test_an_excursion_that_comes_to_rest_beside_zero_ends_there() -> None:
    """A bearing that stays at -1.35 after -7.6; before, it had no largest loop."""
    first = 3.7 * np.sin(np.linspace(0.0, np.pi, 200))
    angle = np.linspace(0.0, 1.5 * np.pi, 200)
    second = -1.35 * (1.0 - np.cos(angle)) / 2.0 - 6.6 * np.sin(np.clip(angle, 0.0, np.pi))
    d = np.concatenate([first, second[second < 0.0], np.full(100, second[-1])])
    loop = metrics.largest_loop(d, 2.0 * d, **PLAN)
    assert loop is not None
    assert loop.first == 0
    assert loop.measures.stiffness_kN_mm == pytest.approx(2.0)
    assert loop.measures.displacement_max_mm == pytest.approx(3.7, rel=1e-3)
    assert loop.measures.displacement_min_mm == d.min()
    # Still moving where it is cut off, or at rest far from zero: none.
    assert metrics.largest_loop(d[:330], 2.0 * d[:330], **PLAN) is None
    far = np.where(np.arange(len(d)) > d.argmin(), np.minimum(d, 0.6 * d.min()), d)
    assert metrics.largest_loop(far, far, **PLAN) is None


HDR = "shen-hdr-specimen"
RESIDUALS = ["mechanical_residual", "thermal_residual"]


def test_relative_to_the_largest_energy_or_the_least() -> None:
    assert metrics.relative_residual(3.0, [-6.0, 2.0]) == 0.5
    assert metrics.relative_residual(3.0, [-6.0, 2.0], least=12.0) == 0.25
    assert metrics.relative_residual(metrics.LEAST_ENERGY, [0.0]) == 1.0
    assert metrics.relative_residual(0.0, [0.0]) == 0.0
    assert metrics.relative_residual(5e-324, [5e-324, 0.0]) < 1e-300


@pytest.mark.parametrize("model", ["multi-layer", "lead-alone", "bilinear"])
@pytest.mark.parametrize("amplitude", [1e-5, 1e-4, 1e-2])
def test_hardly_any_motion(amplitude: float, model: str) -> None:
    """Rounding of temperatures alone came to a residual of 0.99 at 1e-4 mm."""
    steps = [{"step": "cycles", "amplitude": amplitude, "period": 2.0, "count": 2}]
    result = tb.run("shen-lhdr-specimen", tb.CyclicTest(steps=steps), -20, model=model)
    assert result.outcome == "completed"
    assert result.energy[RESIDUALS].abs().max(axis=None) < tol.LEAST_RESIDUAL


@pytest.mark.parametrize("start", [None, 10.0], ids=["at ambient", "warmer"])
def test_no_motion(start: float | None) -> None:
    test = tb.CyclicTest(steps=[{"step": "rest", "duration": 100.0}])
    energy = tb.run(HDR, test, -20, initial=start).energy
    assert energy["work_in_kN_mm"][0] == 0.0
    assert energy[RESIDUALS].abs().max(axis=None) < tol.ENERGY_BALANCE


@pytest.mark.parametrize("factor", [1e-6, 1.0])
def test_study_of_hardly_any_motion(factor: float, tmp_path: Path) -> None:
    """A bearing that cools while next to nothing shakes it: the heat is the scale, not the work."""
    weather = tmp_path / "night.csv"
    weather.write_text("time_s,temperature_degC\n0,10\n3600,-20\n")
    motion = {"name": "jra-ii-i-1", "factor": factor}
    study = tb.bridge(HDR, motion, ambient=str(weather), duration=2)
    names = ["structure_residual", *RESIDUALS]
    assert np.isfinite(study.energy[names]).all(axis=None)
    assert study.energy[names].abs().max(axis=None) < tol.LEAST_RESIDUAL
