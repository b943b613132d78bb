"""Energy: the balances of heat and work close, in single steps, in runs and over Table 3.4."""

from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.quick import quick_cases
from tests.tolerances import CLOSED_CYCLE, ENERGY_BALANCE, HEAT_BALANCE, NEW_EXTREME, RECIPROCITY
from tests.verification import models
from thermobearing.core.types import Constants, Floats
from thermobearing.model.stack import EndFace, build_stack

START, AMBIENT = -10.0, -20.0  # degC: the bearing also cools, through faces and sides
FACES = {
    "eta": (EndFace(eta=2.0), EndFace(eta=2.0)),
    "film": (EndFace(film=25.0), EndFace(film=25.0)),
    "unlike": (EndFace(eta=3.0), EndFace(film=5.0)),
}


def cycles(strain: float, cycle_count: int = 5, dt: float = 5e-3) -> Floats:
    return models.sine(models.specimen(), strain=strain, period=4.0, cycles=cycle_count, dt=dt)


def compute_run(face: str, half: bool, x: Floats, **options: str) -> models.Run:
    upper, lower = FACES[face]
    constants = models.assembled(models.specimen(), half=half, upper=upper, lower=lower, **options)
    return models.marched(constants, x, 5e-3, START, AMBIENT)


def trapezoid_work(run: models.Run) -> Floats:
    """Work of the returned forces on the returned displacements, added up here [kN mm]."""
    force = np.concatenate([[0.0], run.response["force"]])
    x = np.concatenate([[0.0], run.response["displacement"]])
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
def test_conservative_balance_closes(
    face: str, half: bool, source: str, strain: float, measured: Recorder
) -> None:
    run = compute_run(face, half, cycles(strain), heat_source=source)
    response = run.response
    work = response["work_in"][-1]
    assert work > 1e4
    assert (run.softened > 0) == (strain == 3.0)
    atol = ENERGY_BALANCE * work
    mechanical = response["work_in"] - response["heat_released"] - response["recoverable"]
    lost = response["heat_lost_ends"] + response["heat_lost_sides"]
    thermal = response["heat_released"][-1] - models.stored_heat(run, START) - lost[-1]
    measured(
        "energy balance, cyclic: mechanical residual", np.abs(mechanical).max() / work, "1e-10"
    )
    measured("energy balance, cyclic: thermal residual", abs(thermal) / work, "1e-10")
    assert_allclose(mechanical, 0.0, rtol=0.0, atol=atol)
    assert_allclose(thermal, 0.0, rtol=0.0, atol=atol)
    # The energies themselves, against sums made outside the core.
    assert_allclose(response["work_in"], trapezoid_work(run), rtol=0.0, atol=atol)
    assert_allclose(
        response["heat_stored"][-1], models.stored_heat(run, START), rtol=0.0, atol=atol
    )
    assert_allclose(response["clock"][-1], 5e-3 * len(response), rtol=ENERGY_BALANCE, atol=0.0)


def test_balance_closes_over_random_motion_and_a_long_rest() -> None:
    """Motion, then cooling with the same step: losses keep pace with what the cells give up."""
    x = models.smooth_history(np.random.default_rng(31), 75.0, 4000)
    x = np.concatenate([x, np.full(40000, x[-1])])
    for source in ("work", "dissipation"):
        run = compute_run("unlike", False, x, heat_source=source)
        response, work = run.response[-1], run.response["work_in"][-1]
        lost = response.heat_lost_ends + response.heat_lost_sides
        assert lost > 0.1 * work
        thermal = response.heat_released - models.stored_heat(run, START) - lost
        mechanical = work - response.heat_released - response.recoverable
        assert_allclose([mechanical, thermal], 0.0, rtol=0.0, atol=ENERGY_BALANCE * work)


@pytest.mark.parametrize("half", [True, False])
def test_recoverable_energy_is_that_of_the_two_springs(half: bool) -> None:
    """Sum over layers of ke d^2 / 2 + (1 + b (d/t_r)^2) kh Z^2 / 2, written out here (P3)."""
    bearing = models.specimen()
    h, t_r = bearing.hysteresis, bearing.geometry.rubber_thickness
    run = compute_run("film", half, cycles(1.5), heat_source="dissipation")
    warmer = (run.layer_start - 23.0) / 100.0
    ke = np.exp(h.elastic_temperature_coefficient * warmer) * h.post_yield_ratio
    kh = np.exp(h.hysteretic_temperature_coefficient * warmer) * (1.0 - h.post_yield_ratio)
    twice = ke * run.d**2 + (1.0 + h.hardening * (run.d / t_r) ** 2) * kh * run.z**2
    expected = 0.5 * h.layer_stiffness * twice @ run.constants.multiplicity
    atol = ENERGY_BALANCE * run.response["work_in"][-1]
    assert_allclose(run.response["recoverable"], expected, rtol=0.0, atol=atol)


def test_recoverable_energy_is_the_same_after_every_closed_cycle() -> None:
    """Without temperature coefficients the loop closes, and both sources give the same heat."""
    none = {"elastic_temperature_coefficient": 0.0, "hysteretic_temperature_coefficient": 0.0}
    bearing = models.changed(models.specimen(), hysteresis=none)
    x = cycles(1.5)
    per_cycle = len(x) // 5
    heats = []
    for source in ("work", "dissipation"):
        run = models.marched(models.assembled(bearing, heat_source=source), x, 5e-3, START, AMBIENT)
        ends = run.response[per_cycle - 1 :: per_cycle]
        work = np.diff(ends["work_in"])
        assert_allclose(work, work[0], rtol=CLOSED_CYCLE, atol=0.0)
        left = np.diff(ends["recoverable"])
        assert_allclose(left, 0.0, rtol=0.0, atol=CLOSED_CYCLE * work[0])
        heats.append(np.diff(ends["heat_released"]))
        if source == "dissipation":
            assert ends["recoverable"][0] > 1e-3 * work[0]  # Z is not zero where x is
            released = np.diff(run.response["heat_released"])
            assert released.min() >= -ENERGY_BALANCE * work[0]  # heat is never taken back
    assert_allclose(heats[0], heats[1], rtol=CLOSED_CYCLE, atol=0.0)


@pytest.mark.parametrize("half", [True, False])
def test_losses_are_those_of_the_face_and_side_temperatures(half: bool) -> None:
    """Both losses against film laws written out here: Eq. 4.4 at the side, Eq. 4.15 above."""
    bearing, dt, fold = models.specimen(), 5e-3, 2.0 if half else 1.0
    run = compute_run("eta", half, cycles(1.5))
    stack = build_stack(bearing, half=half)
    before = np.vstack([np.full_like(run.cells[:1], START), run.cells[:-1]])
    above = 0.5 * (before + run.cells) - AMBIENT
    side = 11.6e-6 * 4.0 * 240.0 * stack.thickness  # h times perimeter times height [kN/(s K)]
    sides = fold * dt * np.sum(above @ side)
    faces = above[:, 0] if half else above[:, 0] + above[:, -1]
    ends = fold * dt * np.sum(faces) * (2.0 - 1.0) * 38.76e-3 * 240.0**2 / 2.5  # eta = 2
    response, atol = run.response[-1], ENERGY_BALANCE * run.response["work_in"][-1]
    assert_allclose(response.heat_lost_sides, sides, rtol=0.0, atol=atol)
    assert_allclose(response.heat_lost_ends, ends, rtol=0.0, atol=atol)


AMBIENT_BALANCE = -20.0
FACES_BALANCE = {"eta": EndFace(eta=2.0), "fixed": EndFace(eta=3.0), "film": EndFace(film=25.0)}


def stack(face: str, half: bool) -> Constants:
    lower = None if half else EndFace(film=5.0)
    return models.assembled(models.specimen(), half=half, upper=FACES_BALANCE[face], lower=lower)


@pytest.mark.parametrize("half", [True, False])
@pytest.mark.parametrize("face", FACES_BALANCE)
@pytest.mark.parametrize("dt", [1e-4, 5e-3, 1.0, 600.0])
def test_heat_in_is_heat_stored_plus_heat_lost(face: str, half: bool, dt: float) -> None:
    """Any temperatures, any sources, any step: what leaves one cell enters the next."""
    constants = stack(face, half)
    capacity = constants.cells.capacity
    rng = np.random.default_rng(11)
    for _ in range(20):
        temperature = rng.uniform(-60.0, 60.0, len(capacity))
        source = rng.normal(size=len(capacity))
        heat = models.heat_step(constants, temperature, dt, AMBIENT_BALANCE, source)
        stored = float(capacity @ heat.change)
        size = float(capacity @ np.abs(heat.change)) + abs(heat.ends) + abs(heat.sides)
        residual = float(capacity @ source) - stored - heat.ends - heat.sides
        assert_allclose(residual, 0.0, rtol=0.0, atol=HEAT_BALANCE * size)
        assert_allclose(heat.stored, stored, rtol=0.0, atol=HEAT_BALANCE * size)


@pytest.mark.parametrize("half", [True, False])
def test_neighbours_exchange_the_same_heat(half: bool) -> None:
    """Per kelvin, what one cell gives downwards is what the next takes from above."""
    constants = stack("eta", half)
    down = (constants.cells.capacity * constants.cells.to_next)[:-1]
    up = (constants.cells.capacity * constants.cells.to_previous)[1:]
    assert_allclose(down, up, rtol=RECIPROCITY, atol=0.0)


@pytest.mark.parametrize("face", quick_cases(FACES_BALANCE, 0))
def test_no_new_extremes_where_the_step_is_short_enough(face: str) -> None:
    """Crank-Nicolson is bounded while dt/2 times every cell's own rate stays below 1."""
    constants = stack(face, half=False)
    dt = 2.0 / float(np.max(np.diag(models.rate_matrix(constants))))
    assert dt > 0.1  # s: far above the steps used in tests and earthquakes
    nothing = np.zeros(len(constants.cells.capacity))
    rng = np.random.default_rng(12)
    for _ in range(20):
        temperature = rng.uniform(-40.0, 40.0, len(nothing))
        for _ in range(50):
            low = min(temperature.min(), AMBIENT_BALANCE) - NEW_EXTREME
            high = max(temperature.max(), AMBIENT_BALANCE) + NEW_EXTREME
            temperature = (
                temperature
                + models.heat_step(constants, temperature, dt, AMBIENT_BALANCE, nothing).change
            )
            assert low <= temperature.min()
            assert temperature.max() <= high


@pytest.mark.parametrize("dt", [5e-3, 1.0, 60.0, 3600.0])
@pytest.mark.parametrize("face", ["eta", "film"])
def test_cooling_is_monotone_for_any_step(face: str, dt: float) -> None:
    """Capacity-weighted departure from the ambient falls in every step, however long it is."""
    constants = stack(face, half=False)
    capacity = constants.cells.capacity
    nothing = np.zeros(len(capacity))
    temperature = np.random.default_rng(13).uniform(-40.0, 40.0, len(capacity))
    before = float(capacity @ (temperature - AMBIENT_BALANCE) ** 2)
    for _ in range(100):
        temperature = (
            temperature
            + models.heat_step(constants, temperature, dt, AMBIENT_BALANCE, nothing).change
        )
        after = float(capacity @ (temperature - AMBIENT_BALANCE) ** 2)
        assert after < before
        before = after


def test_a_bearing_at_the_ambient_temperature_stays_there() -> None:
    """Side film, end film and eta all vanish at the ambient: not one bit of drift."""
    bearing = models.changed(models.specimen(), materials={"side_film": 500.0})
    constants = models.assembled(
        bearing, half=False, upper=EndFace(eta=2.0), lower=EndFace(film=40.0)
    )
    still = np.full(len(constants.cells.capacity), AMBIENT_BALANCE)
    change = models.heat_step(constants, still, 0.5, AMBIENT_BALANCE, np.zeros(len(still))).change
    assert not change.any()


NAMES = ["shen-hdr-specimen", "shen-lhdr-specimen", "shen-lhdr-bridge", "lrb-example"]
AMBIENTS = [-20.0, 0.0, 23.0]


@pytest.mark.parametrize("heat_source", ["work", "dissipation"])
@pytest.mark.parametrize("name", quick_cases(NAMES, 0, 1))
def test_balance_closes(name: str, heat_source: str, measured: Recorder) -> None:
    response = tb.run(name, ambient=AMBIENTS, model=tb.ModelOptions(heat_source=heat_source)).energy
    mechanical = float(response["mechanical_residual"].abs().max())
    thermal = float(response["thermal_residual"].abs().max())
    assert mechanical <= tol.ENERGY_BALANCE
    assert thermal <= tol.ENERGY_BALANCE
    measured(f"Table 3.4 with rests, {name}: mechanical residual", mechanical, "1e-10")
    measured(f"Table 3.4 with rests, {name}: thermal residual", thermal, "1e-10")


@pytest.mark.parametrize("name", NAMES[:2])
def test_published_balance_does_not_close(name: str, measured: Recorder) -> None:
    """The printed coefficients create heat; with lead, the Maxwell branch also warms nothing."""
    response = tb.run(name, ambient=AMBIENTS, model=tb.ModelOptions(scheme="published")).energy
    thermal = response["thermal_residual"].to_numpy()
    assert (np.abs(thermal) > 0.05).all()
    text = ", ".join(f"{-value:+.1%}" for value in thermal)
    measured(
        f"published scheme, {name}, -20, 0, 23 degC: heat created, of the work", text, "reported"
    )
    if name == "shen-hdr-specimen":
        assert np.abs(response["mechanical_residual"]).max() <= tol.ENERGY_BALANCE
    else:
        lost = response["mechanical_residual"].to_numpy()
        assert (lost > 1e-4).all()
        text = ", ".join(f"{value:.2%}" for value in lost)
        measured(
            "published scheme with lead: work of the Maxwell branch that warms nothing",
            text,
            "reported",
        )


@pytest.mark.parametrize("name", quick_cases(NAMES[:2], 0))
def test_halving_the_step_changes_no_cycle(name: str, measured: Recorder) -> None:
    """From 10 ms on, per-cycle G_e and h_eq are settled to 0.1 % (exact increment)."""
    tables = [tb.run(name, ambient=AMBIENTS, dt=dt).cycles for dt in (0.01, 0.005, 0.0025)]
    for column, what in (("G_eq_MPa", "G_e"), ("h_eq", "h_eq")):
        values = [table[column].to_numpy() for table in tables]
        first, second = (np.abs(b / a - 1.0).max() for a, b in pairwise(values))
        assert first <= tol.STEP_HALVING
        assert second < first
        measured(f"{name}: largest change of {what}, dt 10 to 5 ms", first, f"{tol.STEP_HALVING:g}")


def test_euler_is_coarser_than_exact(measured: Recorder) -> None:
    """What the published explicit Euler costs at the same 5 ms."""
    models = {"exact": tb.ModelOptions(), "euler": tb.ModelOptions(integrator="euler")}
    best = tb.run(NAMES[0], ambient=23.0, dt=0.00125).cycles["h_eq"].to_numpy()
    error = {
        name: float(
            np.abs(tb.run(NAMES[0], ambient=23.0, model=model).cycles["h_eq"] / best - 1).max()
        )
        for name, model in models.items()
    }
    assert error["exact"] <= tol.STEP_HALVING
    assert error["euler"] > 5.0 * error["exact"]
    measured(
        "h_eq at 5 ms, exact increment: largest error", error["exact"], f"{tol.STEP_HALVING:g}"
    )
    measured("h_eq at 5 ms, published Euler: largest error", error["euler"], "reported")
