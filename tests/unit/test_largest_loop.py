"""The largest loop of a history: loops whose answer is known."""

import numpy as np
import pytest

from tests import tolerances as tol
from thermobearing.results.metrics import find_largest_loop, largest_loop

PLAN = {"area": 1e4, "total_rubber_thickness": 20.0}


def waves(*amplitudes: float, points: int = 200) -> np.ndarray:
    """Half sine waves one after the other, zero at both ends."""
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
    assert find_largest_loop(d) == (200 * pieces[0], 200 * pieces[1])


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
    assert find_largest_loop(d) is None
    assert largest_loop(d, d, **PLAN) is None


def test_a_neighbour_that_is_not_closed_leaves_the_other() -> None:
    assert find_largest_loop(waves(2.0, -5.0, 4.0)[:-100]) == (0, 400)


def test_what_stays_on_one_side_after_the_loop_is_not_in_it() -> None:
    """Small waves on both sides, then at rest beside zero: the loop is closed by then."""
    d = np.concatenate([waves(0.05, -3.0, 5.0, -0.05)[:-1], np.linspace(0.0, 0.4, 100)])
    assert find_largest_loop(d) == (200, 600)


def test_noise_at_zero_cuts_no_loop() -> None:
    d = waves(1.0, 5.0, -4.0)
    d[190:210] = 0.05 * np.cos(np.arange(20.0))
    assert find_largest_loop(np.concatenate([waves(-1.0)[:-1], d]))[1] == 800


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("shift", [0.0, 0.37])
def test_measures_of_an_ellipse_among_smaller_ones(sign: float, shift: float) -> None:
    """f = k d + c d'/omega of a whole sine: K_eq, h_eq, energy and extremes in closed form."""
    stiffness, viscous, amplitude = 1.5, 0.4, 30.0
    angle = np.linspace(0.0, 6.0 * np.pi, 6001) + shift / 1000.0
    wide = np.abs(angle - 3.0 * np.pi) < np.pi + 0.003  # with the points beside the zeros
    size = np.where(wide, amplitude, 0.3 * amplitude)
    d = sign * size * np.sin(angle)
    if shift == 0.0:
        d[[2000, 4000]] = 0.0
    f = stiffness * d + viscous * sign * size * np.cos(angle)
    loop = largest_loop(d, f, **PLAN)
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


def test_work_is_that_of_the_books_from_zero_to_zero() -> None:
    """Work that grows evenly with the place in the history: its share between the two zeros."""
    angle = np.linspace(-3.5, 3.0 * np.pi, 801)
    d = np.exp(-0.05 * np.abs(angle - 1.6)) * np.sin(angle)
    loop = largest_loop(d, d, 7.0 * angle, **PLAN)
    assert loop is not None
    assert loop.measures.energy_kN_mm == pytest.approx(14.0 * np.pi, rel=tol.LOOP_POINTS)


def test_noise_does_not_choose_between_equal_excursions() -> None:
    """Three cycles of one amplitude, the third a hair larger: of a test, the first is meant."""
    angle = np.linspace(0.0, 6.0 * np.pi, 601)
    d = np.sin(angle) * np.where(angle > 4.0 * np.pi, 1.004, 1.0)
    assert find_largest_loop(d) == (399, 600)
    assert find_largest_loop(d, 0.01) == (0, 200)
    assert find_largest_loop(-d, 0.01) == (0, 200)


def test_an_excursion_that_comes_to_rest_beside_zero_ends_there() -> None:
    """A bearing that stays at -1.35 after -7.6; before, it had no largest loop."""
    first = 3.7 * np.sin(np.linspace(0.0, np.pi, 200))
    angle = np.linspace(0.0, 1.5 * np.pi, 200)
    second = -1.35 * (1.0 - np.cos(angle)) / 2.0 - 6.6 * np.sin(np.clip(angle, 0.0, np.pi))
    d = np.concatenate([first, second[second < 0.0], np.full(100, second[-1])])
    loop = largest_loop(d, 2.0 * d, **PLAN)
    assert loop is not None
    assert loop.first == 0
    assert loop.measures.stiffness_kN_mm == pytest.approx(2.0)
    assert loop.measures.displacement_max_mm == pytest.approx(3.7, rel=1e-3)
    assert loop.measures.displacement_min_mm == d.min()
    # Still moving where it is cut off, or at rest far from zero: none.
    assert largest_loop(d[:330], 2.0 * d[:330], **PLAN) is None
    far = np.where(np.arange(len(d)) > d.argmin(), np.minimum(d, 0.6 * d.min()), d)
    assert largest_loop(far, far, **PLAN) is None
