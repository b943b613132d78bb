"""The energy books close: work in = heat + recoverable; heat = stored + lost to the ambient."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests.conftest import Recorder
from tests.tolerances import CLOSED_CYCLE, ENERGY_BOOKS
from tests.verification.models import (
    Run,
    assembled,
    changed,
    marched,
    sine,
    smooth_history,
    specimen,
    stored_heat,
)
from thermobearing.core.types import Floats
from thermobearing.model.stack import Face, build_stack

START, AMBIENT = -10.0, -20.0  # degC: the bearing also cools, through faces and sides
FACES = {
    "eta": (Face(eta=2.0), Face(eta=2.0)),
    "film": (Face(film=25.0), Face(film=25.0)),
    "unlike": (Face(eta=3.0), Face(film=5.0)),
}


def cycles(strain: float, cycle_count: int = 5, dt: float = 5e-3) -> Floats:
    return sine(specimen(), strain=strain, period=4.0, cycles=cycle_count, dt=dt)


def run_of(face: str, half: bool, x: Floats, **options: str) -> Run:
    upper, lower = FACES[face]
    constants = assembled(specimen(), half=half, upper=upper, lower=lower, **options)
    return marched(constants, x, 5e-3, START, AMBIENT)


def trapezoid_work(run: Run) -> Floats:
    """Work of the returned forces on the returned displacements, added up here [kN mm]."""
    force = np.concatenate([[0.0], run.books["force"]])
    x = np.concatenate([[0.0], run.books["displacement"]])
    return np.asarray(np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(x)))


CASES = [
    (face, half, source, strain)
    for face in FACES
    for half in (True, False)
    for source in ("work", "dissipation")
    for strain in (1.5, 3.0)
    if not (half and face == "unlike")
]


@pytest.mark.parametrize(("face", "half", "source", "strain"), CASES)
def test_conservative_books_close(
    face: str, half: bool, source: str, strain: float, measured: Recorder
) -> None:
    run = run_of(face, half, cycles(strain), heat_source=source)
    books = run.books
    work = books["work_in"][-1]
    assert work > 1e4
    assert (run.softened > 0) == (strain == 3.0)
    atol = ENERGY_BOOKS * work
    mechanical = books["work_in"] - books["heat_released"] - books["recoverable"]
    lost = books["heat_lost_ends"] + books["heat_lost_sides"]
    thermal = books["heat_released"][-1] - stored_heat(run, START) - lost[-1]
    measured("energy books, cyclic: mechanical residual", np.abs(mechanical).max() / work, "1e-10")
    measured("energy books, cyclic: thermal residual", abs(thermal) / work, "1e-10")
    assert_allclose(mechanical, 0.0, rtol=0.0, atol=atol)
    assert_allclose(thermal, 0.0, rtol=0.0, atol=atol)
    # The books themselves, against sums made outside the core.
    assert_allclose(books["work_in"], trapezoid_work(run), rtol=0.0, atol=atol)
    assert_allclose(books["heat_stored"][-1], stored_heat(run, START), rtol=0.0, atol=atol)
    assert_allclose(books["clock"][-1], 5e-3 * len(books), rtol=ENERGY_BOOKS, atol=0.0)


def test_books_close_over_random_motion_and_a_long_rest() -> None:
    """Motion, then cooling with the same step: losses keep pace with what the cells give up."""
    x = smooth_history(np.random.default_rng(31), 75.0, 4000)
    x = np.concatenate([x, np.full(40000, x[-1])])
    for source in ("work", "dissipation"):
        run = run_of("unlike", False, x, heat_source=source)
        books, work = run.books[-1], run.books["work_in"][-1]
        lost = books.heat_lost_ends + books.heat_lost_sides
        assert lost > 0.1 * work
        thermal = books.heat_released - stored_heat(run, START) - lost
        mechanical = work - books.heat_released - books.recoverable
        assert_allclose([mechanical, thermal], 0.0, rtol=0.0, atol=ENERGY_BOOKS * work)


@pytest.mark.parametrize("half", [True, False])
def test_recoverable_energy_is_that_of_the_two_springs(half: bool) -> None:
    """Sum over layers of ke d^2 / 2 + (1 + b (d/t_r)^2) kh Z^2 / 2, written out here (P3)."""
    bearing = specimen()
    h, t_r = bearing.hysteresis, bearing.geometry.rubber_thickness
    run = run_of("film", half, cycles(1.5), heat_source="dissipation")
    warmer = (run.layer_start - 23.0) / 100.0
    ke = np.exp(h.elastic_temperature_coefficient * warmer) * h.post_yield_ratio
    kh = np.exp(h.hysteretic_temperature_coefficient * warmer) * (1.0 - h.post_yield_ratio)
    twice = ke * run.d**2 + (1.0 + h.hardening * (run.d / t_r) ** 2) * kh * run.z**2
    expected = 0.5 * h.layer_stiffness * twice @ run.constants.multiplicity
    atol = ENERGY_BOOKS * run.books["work_in"][-1]
    assert_allclose(run.books["recoverable"], expected, rtol=0.0, atol=atol)


def test_recoverable_energy_is_the_same_after_every_closed_cycle() -> None:
    """Without temperature coefficients the loop closes, and both sources give the same heat."""
    none = {"elastic_temperature_coefficient": 0.0, "hysteretic_temperature_coefficient": 0.0}
    bearing = changed(specimen(), hysteresis=none)
    x = cycles(1.5)
    per_cycle = len(x) // 5
    heats = []
    for source in ("work", "dissipation"):
        run = marched(assembled(bearing, heat_source=source), x, 5e-3, START, AMBIENT)
        ends = run.books[per_cycle - 1 :: per_cycle]
        work = np.diff(ends["work_in"])
        assert_allclose(work, work[0], rtol=CLOSED_CYCLE, atol=0.0)
        left = np.diff(ends["recoverable"])
        assert_allclose(left, 0.0, rtol=0.0, atol=CLOSED_CYCLE * work[0])
        heats.append(np.diff(ends["heat_released"]))
        if source == "dissipation":
            assert ends["recoverable"][0] > 1e-3 * work[0]  # Z is not zero where x is
            released = np.diff(run.books["heat_released"])
            assert released.min() >= -ENERGY_BOOKS * work[0]  # heat is never taken back
    assert_allclose(heats[0], heats[1], rtol=CLOSED_CYCLE, atol=0.0)


@pytest.mark.parametrize("half", [True, False])
def test_losses_are_those_of_the_face_and_side_temperatures(half: bool) -> None:
    """Both loss books against film laws written out here: Eq. 4.4 at the side, Eq. 4.15 above."""
    bearing, dt, fold = specimen(), 5e-3, 2.0 if half else 1.0
    run = run_of("eta", half, cycles(1.5))
    stack = build_stack(bearing, half=half)
    before = np.vstack([np.full_like(run.cells[:1], START), run.cells[:-1]])
    above = 0.5 * (before + run.cells) - AMBIENT
    side = 11.6e-6 * 4.0 * 240.0 * stack.thickness  # h times perimeter times height [kN/(s K)]
    sides = fold * dt * np.sum(above @ side)
    faces = above[:, 0] if half else above[:, 0] + above[:, -1]
    ends = fold * dt * np.sum(faces) * (2.0 - 1.0) * 38.76e-3 * 240.0**2 / 2.5  # eta = 2
    books, atol = run.books[-1], ENERGY_BOOKS * run.books["work_in"][-1]
    assert_allclose(books.heat_lost_sides, sides, rtol=0.0, atol=atol)
    assert_allclose(books.heat_lost_ends, ends, rtol=0.0, atol=atol)
