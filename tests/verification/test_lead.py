"""Lead cores: half-space factor, strength that falls with heat, heat into finite plates."""

import math
from itertools import product
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import integrate, special
from scipy.linalg import expm
from scipy.optimize import nnls
from scipy.special import j0, j1, jn_zeros

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.quick import quick_cases
from tests.verification.lead_cases import touching
from tests.verification.models import assembled, changed
from thermobearing.core import types
from thermobearing.core.lead import (
    core_force,
    core_heat,
    end_factor,
    exchange,
    half_space_factor,
    published_exchange,
    side_factor,
)
from thermobearing.core.march import march
from thermobearing.core.numbers import SHIM
from thermobearing.core.step import step
from thermobearing.cyclic.history import room_for
from thermobearing.model import lead_impedance as way
from thermobearing.model.constants import build_constants
from thermobearing.model.lead_ends import lead_sizes
from thermobearing.model.stack import EndFace, Stack, build_stack

SPECIMEN = "shen-lhdr-specimen"


def make_constants(name: str = SPECIMEN, **lead: object) -> types.Constants:
    bearing = tb.load_bearing(name)
    if lead:
        changed = bearing.lead.model_copy(update=lead)  # type: ignore[union-attr]
        bearing = bearing.model_copy(update={"lead": changed})
    stack = build_stack(bearing, half=True)
    return build_constants(bearing, stack, upper=EndFace(eta=2.0), lower=None)


def exact_factor(t_plus: float) -> float:
    """Mean surface rise of a disc of constant flux on a half-space, by its Hankel integral."""

    def part(x: float) -> float:
        return float(2.0 * special.j1(x) ** 2 / x**2 * special.erf(x * np.sqrt(t_plus)))

    return float(integrate.quad(part, 0.0, 200.0, limit=2000)[0])


def test_half_space_factor_has_its_limits_and_joins_at_0_6(measured: Recorder) -> None:
    assert_allclose(half_space_factor(1e-12) / (2.0 * np.sqrt(1e-12 / np.pi)), 1.0, rtol=1e-5)
    assert_allclose(half_space_factor(1e12), 8.0 / (3.0 * np.pi), rtol=1e-5)
    jump = half_space_factor(0.6) / half_space_factor(0.6 - 1e-12) - 1.0
    assert abs(jump) < tol.FACTOR_JUMP
    measured("F(t+) of Eq. 5.5: jump at 0.6", f"{jump:+.2e}", f"{tol.FACTOR_JUMP:g}")


def test_half_space_factor_is_that_of_a_heated_disc(measured: Recorder) -> None:
    times = np.geomspace(1e-3, 100.0, 25)
    off = [half_space_factor(t) / exact_factor(t) - 1.0 for t in times]
    assert np.abs(off).max() < tol.FACTOR
    measured(
        "F(t+) of Eq. 5.5 against the Hankel integral", float(np.abs(off).max()), f"{tol.FACTOR:g}"
    )


@pytest.mark.parametrize(("start", "end"), [(0.0, 1e-4), (0.0, 0.05), (0.01, 0.012), (1.0, 1.2)])
def test_means_over_a_step(start: float, end: float) -> None:
    """1/F is singular like t^(-1/2) at the first step; its mean must be right there too."""
    exact = integrate.quad(
        lambda r: 2.0 * r / half_space_factor(r * r), np.sqrt(start), np.sqrt(end)
    )
    assert_allclose(end_factor(start, end), exact[0] / (end - start), rtol=tol.FACTOR_MEAN)
    third = integrate.quad(lambda r: 3.0 * r, start ** (1 / 3), end ** (1 / 3))
    assert_allclose(side_factor(start, end), third[0] / (end - start), rtol=tol.HEAT_BALANCE)


def core(softening: float) -> types.Lead:
    """One core of the specimen that is stiff, so that all of its path is plastic."""
    lead = make_constants(softening=softening, softening_beyond_tests=softening).lead
    return lead._replace(stiffness=1e6, reference_temperature=0.0)


def heated(lead: types.Lead, path: float, steps: int) -> float:
    """Temperature of an adiabatic core after a plastic path, from 0 degC."""
    t, force = 0.0, lead.strength
    for _ in range(steps):
        after, _ = core_force(lead, types.HEAT_FROM_WORK, t, force, path / steps)
        t += core_heat(lead, types.HEAT_FROM_WORK, force, after, path / steps) / lead.capacity
        force = after
    return t


def test_adiabatic_core_with_falling_strength_is_exact(measured: Recorder) -> None:
    """T = ln(1 + E2 sigma_0 s/(rho c h))/E2, second order in the step."""
    lead, path = core(0.0069), 1500.0
    exact = np.log1p(lead.softening * lead.strength * path / lead.capacity) / lead.softening
    errors = np.array([heated(lead, path, n) / exact - 1.0 for n in (100, 200, 400)])
    orders = np.log2(errors[:-1] / errors[1:])
    assert_allclose(orders, 2.0, atol=tol.ORDER)
    realistic = abs(heated(lead, path, 10_000) / exact - 1.0)  # steps of 0.15 mm
    assert realistic < tol.ADIABATIC_CORE
    measured("adiabatic core, exponential strength, against the exact rise", realistic, "1e-06")
    plain = core(0.0)
    assert_allclose(
        heated(plain, path, 100), plain.strength * path / plain.capacity, rtol=tol.HEAT_BALANCE
    )


@pytest.mark.parametrize("softening", [0.0, 0.002])
def test_adiabatic_core_beyond_its_tests_is_exact(softening: float, measured: Recorder) -> None:
    """Up to T_w at one rate, then T = T_w + ln(1 + E2' sigma_w s/(rho c h))/E2' along the rest."""
    warmest, beyond, path = 60.0, 0.0069, 1500.0
    lead = core(softening)._replace(softening_beyond=beyond, warmest_tested=warmest)
    rate = lead.strength / lead.capacity  # rise per path at T_0 = 0 degC [K/mm]
    to_warmest = warmest / rate if softening == 0.0 else np.expm1(softening * warmest) / softening
    to_warmest /= 1.0 if softening == 0.0 else rate
    per = rate * np.exp(-softening * warmest)
    exact = warmest + np.log1p(beyond * per * (path - to_warmest)) / beyond
    errors = np.array([heated(lead, path, n) / exact - 1.0 for n in (100, 1000, 10_000)])
    assert (np.abs(errors) < [1e-3, 1e-4, tol.ADIABATIC_CORE]).all()
    measured("adiabatic core beyond its tests, against the exact rise", abs(errors[-1]), "1e-06")
    for t in (warmest - 2.0 * rate, warmest - 0.5 * rate, warmest + 5.0):  # before, across, beyond
        x, h = 1.0, 1e-4
        after, slope = core_force(lead, types.HEAT_FROM_WORK, t, lead.strength, x)
        ends = [core_force(lead, types.HEAT_FROM_WORK, t, lead.strength, x + d)[0] for d in (-h, h)]
        assert_allclose(slope, (ends[1] - ends[0]) / (2.0 * h), rtol=1e-4, atol=1e-9)
        warmed = t + core_heat(lead, types.HEAT_FROM_WORK, lead.strength, after, x) / lead.capacity
        lowered = softening * min(warmed, warmest) + beyond * max(warmed - warmest, 0.0)
        assert_allclose(after, lead.strength * np.exp(-lowered), rtol=1e-12)


def test_lead_within_its_tests_has_the_same_bits() -> None:
    """The rate beyond the tests changes no bit of a run that stays within them."""
    path = np.linspace(0.0, 200.0, 500) % 50.0
    for softening in (0.0, 0.0069):
        alone = core(softening)._replace(stiffness=22.0)
        tested = alone._replace(softening_beyond=0.0069, warmest_tested=250.0)
        for lead in (alone, tested):
            t, force, forces = 0.0, 0.0, []
            for dx in np.diff(path):
                after, slope = core_force(lead, types.HEAT_FROM_WORK, t, force, dx)
                t += core_heat(lead, types.HEAT_FROM_WORK, force, after, dx) / lead.capacity
                force = after
                forces += [force, slope, t]
            if lead is alone:
                first = forces
        assert 0.0 < t < 250.0
        assert forces == first


def test_exchange_is_that_of_two_bodies(measured: Recorder) -> None:
    """Lead, heated or not, and the touched cell: the exact exponential at any step, heat kept."""
    constants = make_constants()
    rates, touched = constants.cells, constants.lead_cells[0].cell
    temperature = np.linspace(-20.0, 5.0, len(rates.capacity))
    capacity = np.array([constants.lead.cores * constants.lead.capacity, rates.capacity[touched]])
    worst = 0.0
    for dt, heat in product((1e-3, 0.1, 10.0, 1000.0), (0.0, 30.0)):
        work, state = types.new_workspace(constants), types.new_state(constants, temperature, 60.0)
        after = exchange(constants, work, state, heat, 3.0, 0.0, dt)
        g = constants.lead_cells[0].end * 3.0
        matrix = np.zeros((3, 3))  # of lead, cell and one, for the heat
        matrix[:2, :2] = g * dt * np.array([[-1.0, 1.0], [1.0, -1.0]]) / capacity[:, None]
        matrix[0, 2] = heat / capacity[0]
        exact = expm(matrix)[:2] @ np.array([60.0, temperature[touched], 1.0])
        result = np.array([after, temperature[touched] + work.cells.change[touched]])
        assert_allclose(result, exact, rtol=0.0, atol=tol.TWO_BODIES)
        kept = capacity @ result - capacity @ np.array([60.0, temperature[touched]]) - heat
        worst = max(worst, abs(kept) / capacity.sum())
    work, state = types.new_workspace(constants), types.new_state(constants, temperature, 60.0)
    alone = exchange(constants, work, state, 30.0, 0.0, 0.0, 0.1)  # adiabatic
    assert alone == pytest.approx(60.0 + 30.0 / capacity[0])
    measured(
        "lead and plate cell as two bodies: heat lost [K of both]", worst, f"{tol.TWO_BODIES:g}"
    )
    assert worst < tol.TWO_BODIES


def test_printed_bookkeeping_of_a_core_that_touches_the_shims() -> None:
    """A short step: each cell gets n_l theta of the rise, with n_l in theta once more (P4)."""
    constants = assembled(touching(SPECIMEN, True), scheme="published")
    lead, places, dt = constants.lead, constants.lead_cells, 1e-4
    cells = np.full(len(constants.cells.capacity), -20.0)
    work, state = types.new_workspace(constants), types.new_state(constants, cells, 60.0)
    published_exchange(constants, work, state, 0.0, 3.0, 2.0, dt, -20.0)
    g = places["end"] * 3.0 + places["side"] * 2.0
    assert (places["side"] > 0.0).any()
    wanted = lead.cores * dt * g / (lead.fold * lead.capacity) * 80.0
    assert_allclose(work.cells.change[places["cell"]], wanted, rtol=1e-9)


def marched_through(
    constants: types.Constants, state: types.State, x: np.ndarray, dt: np.ndarray
) -> None:
    """Move a bearing in air of 0 degC, keeping nothing but its state."""
    spare = types.new_state(constants, state.temperature)
    path = types.Path(x, dt, np.zeros(len(x)), np.zeros(len(x), dtype=bool), 0.0)
    march(constants, types.new_workspace(constants), state, spare, path, room_for(constants, 0, ()))


def cooling(constants: types.Constants, dt: float, steps: int) -> tuple[float, np.ndarray]:
    """Lead and cells after a rest that follows one tiny motion, from a hot lead."""
    state = types.new_state(constants, np.zeros(len(constants.cells.capacity)), 50.0)
    marched_through(constants, state, np.full(steps, 1e-9), np.full(steps, dt))
    return state.response[0].lead_temperature, state.temperature


def test_cooling_agrees_with_an_ode_solver(measured: Recorder) -> None:
    """Lead and all 29 cells from 50 K above, 20 s, against scipy with the same F(t+)."""
    constants = make_constants()
    rates, cell = constants.cells, constants.lead_cells[0].cell
    n = len(rates.capacity)
    lead_capacity = constants.lead.cores * constants.lead.capacity

    def slope(r: float, y: np.ndarray) -> np.ndarray:
        t, cells = r * r, y[:n]  # in r = sqrt(t) the flux is not singular
        out = -(rates.end_loss + rates.side_loss) * cells
        out[1:] += rates.to_previous[1:] * (cells[:-1] - cells[1:])
        out[:-1] += rates.to_next[:-1] * (cells[1:] - cells[:-1])
        flux = constants.lead_cells[0].end / half_space_factor(
            max(t * constants.lead.clock_rate, 1e-14)
        )
        flux *= y[n] - cells[cell]
        out[cell] += flux / rates.capacity[cell]
        return 2.0 * r * np.append(out, -flux / lead_capacity)

    start = np.append(np.zeros(n), 50.0)
    exact = integrate.solve_ivp(
        slope, (1e-7, np.sqrt(20.0)), start, method="BDF", rtol=1e-10, atol=1e-10
    ).y[:, -1]
    errors = [abs(cooling(constants, 20.0 / k, k)[0] - exact[n]) for k in (1000, 2000, 4000)]
    assert errors[1] < errors[0]
    assert errors[-1] < tol.COOLING
    measured(
        "lead after 20 s of cooling from 50 K, steps of 5 ms, against scipy [K]",
        errors[-1],
        f"{tol.COOLING:g}",
    )


def test_clock_starts_again_after_a_long_pause_only() -> None:
    constants = make_constants()
    recovery = 1.0 / constants.lead.clock_rate
    for pause, restarted in ((0.5 * recovery, False), (1.1 * recovery, True)):
        state = types.new_state(constants, np.zeros(len(constants.cells.capacity)))
        x = np.array([0.1, 0.2, *[0.2] * 100, 0.3])
        dt = np.array([0.01, 0.01, *[pause / 100] * 100, 0.01])
        marched_through(constants, state, x, dt)
        expected = 0.01 if restarted else 0.03 + pause
        assert_allclose(state.branches[0].clock, expected, rtol=1e-9)


@pytest.mark.parametrize("dt", [1e-5, 5e-3, 5e-2])
@pytest.mark.parametrize("name", [SPECIMEN, "lrb-example"])
def test_first_steps_are_finite_and_heat_flows_downhill(name: str, dt: float) -> None:
    lead, cells = cooling(make_constants(name), dt, 5)
    assert 0.0 < lead < 50.0
    assert (cells >= 0.0).all()
    assert cells.max() > 0.0


@pytest.mark.parametrize("scheme", ["conservative", "published"])
def test_long_rest_is_stable(scheme: str) -> None:
    """1.25 h of growing steps bring the lead to the ambient without overshoot."""
    test = tb.CyclicTest(
        steps=[
            {"step": "cycles", "strain": 1.0, "speed": 30.0, "count": 1},
            {"step": "rest", "duration": 4500.0},
        ]
    )
    result = tb.run(SPECIMEN, test, ambient=-20.0, model=tb.ModelOptions(scheme=scheme))
    lead = result["lead_temperature"].values[0]
    rest = result["segment"].values[0] == 1
    assert (lead[rest] >= -20.0).all()
    assert lead[-1] < -19.8


def test_cores_are_in_parallel() -> None:
    test = tb.cyclic_test(strain=[1.0], cycles=1)
    bearing = tb.load_bearing(SPECIMEN)
    result = tb.run(bearing, test, ambient=0.0)
    force = result["force"].values
    parts = sum(result[f"{name}_force"].values for name in ("rubber", "lead", "viscous"))
    assert_allclose(force, parts, rtol=0.0, atol=1e-10)
    assert bearing.lead is not None
    expected = bearing.lead.cores * bearing.lead.core_strength
    assert_allclose(np.abs(result["lead_force"].values).max(), expected, rtol=1e-12)
    assert_allclose(bearing.lead.core_strength, 11.22, rtol=1e-3)  # 5.3.2 prints 11.21 kN


def network_sizes(name: str = SPECIMEN, sides: bool = False) -> tuple[way.LeadSizes, Stack]:
    bearing = touching(name, sides)
    stack = build_stack(bearing, half=True)
    return lead_sizes(bearing, stack, EndFace(eta=3.0), None), stack


RATES = [way.frequency(i) for i in range(way.FREQUENCIES)]


def test_disc_on_a_plate_when_all_is_steady() -> None:
    """tanh(l H)/(k l) of each mode with the far face held; more with a film, most without."""
    sizes, _ = network_sizes()
    k, height = sizes.steel.conductivity, sizes.end_plate
    wave = jn_zeros(1, way.RADIAL) / sizes.plan
    mean = 4.0 * (j1(wave * sizes.radius) / (wave * sizes.plan * j0(wave * sizes.plan))) ** 2
    room = np.zeros(way.ROOM)
    way.fill_radial(sizes.radius, sizes.plan, room)
    assert_allclose(room[[way.WAVE, way.SHARE]], [wave, mean], rtol=1e-13, atol=1e-13 * mean.max())
    area = math.pi * sizes.radius**2
    for film, each in (
        (math.inf, np.tanh(wave * height) / (k * wave)),
        (0.0, 1.0 / np.tanh(wave * height) / (k * wave)),
    ):
        result = way.disc_on_plate(sizes, film, room, RATES[0])
        assert_allclose(result, (mean * each).sum() / area, rtol=tol.KERNEL_STEADY)
    held, robin, free = (
        way.disc_on_plate(sizes, film, room, RATES[0]) for film in (math.inf, 1e-3, 0.0)
    )
    assert held < robin < free


def test_core_when_all_is_steady() -> None:
    """h/(3 k A) along half a core, 1/(8 pi k h) to its wall."""
    lead = network_sizes()[0].lead
    k, s = lead.conductivity, RATES[0]
    modes = [way.core_mode(lead, 48.0, 17.25, 0.0, n, s) for n in range(1, way.AXIAL + 1)]
    assert_allclose(sum(modes), 48.0 / (3.0 * k * math.pi * 17.25**2), rtol=tol.KERNEL_STEADY)
    across = way.core_to_wall(lead, 48.0, 17.25, s)
    assert_allclose(across, 1.0 / (8.0 * math.pi * k * 48.0), rtol=tol.KERNEL_STEADY)


def test_edges_of_shims_on_a_wide_core_are_those_on_a_half_plane() -> None:
    """Shims as thick as the layers: 4 p/pi^3 times the sum of 1/n^3 over odd n, over 2 pi r h k."""
    lead, radius, pitch = network_sizes()[0].lead, 1e6, 10.0
    result = way.to_edges(lead, 0.5 * pitch, 0.5 * pitch, radius, RATES[0])
    steady = result * 2.0 * math.pi * radius * pitch * lead.conductivity
    wanted = 4.0 * pitch / math.pi**3 * 7.0 / 8.0 * special.zeta(3.0)
    assert_allclose(steady, wanted, rtol=1e-4)  # of 60 terms


def test_thick_rubber_at_the_wall_is_a_half_space() -> None:
    """2 pi r h sqrt(k c s), which no far side of the layer limits."""
    rubber, radius, layer = network_sizes("lrb-example")[0].rubber, 90.0, 1e6
    for s in RATES[::8]:
        wanted = 2.0 * math.pi * radius * layer * math.sqrt(rubber.conductivity * rubber.heat * s)
        assert_allclose(way.rubber_at_wall(rubber, layer, radius, s), wanted, rtol=1e-3)  # of 400


def test_fin_is_that_of_finite_volumes() -> None:
    """The ring of 400 volumes whose inner face is heated."""
    sizes, _ = network_sizes("lrb-example")
    faces = 75.0 + 275.0 * np.linspace(0.0, 1.0, 401) ** 2
    area = math.pi * np.diff(faces**2)
    middle = 0.5 * (faces[1:] + faces[:-1])
    across = 2.0 * math.pi * sizes.steel.conductivity * 3.0
    link = across / np.log(middle[1:] / middle[:-1])
    flow = np.diag(np.r_[link, 0.0] + np.r_[0.0, link]) - np.diag(link, 1) - np.diag(link, -1)
    for s in RATES[::8]:
        taken = way.fin_heat(sizes.steel, 3.0, sizes.rubber, 8.0, 2, s)
        t = np.linalg.solve(flow + np.diag(taken * area), np.eye(400)[0])
        edge = t[0] + math.log(middle[0] / faces[0]) / across
        exact = edge - area @ t / area.sum()
        assert_allclose(
            way.fin(sizes.steel, 3.0, taken, 75.0, 350.0), exact, rtol=tol.KERNEL_VOLUMES
        )


def test_bessel_functions_are_those_of_scipy(measured: Recorder) -> None:
    """Relative, and J0 and J1 by their magnitude, in all that bearings need and beyond."""
    worst = 0.0
    for x in np.geomspace(1e-4, 1e4, 400):
        exact = (special.ive(0, x), special.ive(1, x) / x, special.ive(2, x) / x**2)
        exact += (special.kve(0, x), special.kve(1, x))
        off = np.divide(way.scaled_i(x) + way.scaled_k(x), exact) - 1.0
        worst = max(worst, np.abs(off).max())
    for x in np.geomspace(1e-4, 400.0, 400):  # then scipy's lose digits
        off = np.subtract(way.bessel_j(x), (special.j0(x), special.j1(x)))
        worst = max(worst, np.abs(off).max() / min(1.0, math.sqrt(2.0 / (math.pi * x))))
    assert worst < tol.BESSEL
    measured("Bessel functions of the heat out of lead, against scipy", worst, f"{tol.BESSEL:g}")


@pytest.mark.parametrize(
    "name", quick_cases(["shen-lhdr-specimen", "shen-lhdr-bridge", "lrb-example"], 1)
)
def test_few_terms_are_enough(name: str, measured: Recorder) -> None:
    """The sum of the terms against the impedance they stand for; the terms against scipy's."""
    sizes, stack = network_sizes(name, True)
    half, room = 0.5 * stack.beside_lead.sum(), np.zeros(way.ROOM)
    way.fill_radial(sizes.radius, sizes.plan, room)
    way.fill_side(sizes, half, stack.thickness[stack.codes == SHIM].sum(), room)
    way.fill_end(sizes, half, math.inf, room)
    worst = 0.0
    for row in (way.PLATE, way.SIDE):
        impedance = room[way.FITTED] = room[row]
        way.fit_terms(room)
        a, tau = room[[way.A, way.TAU], : way.RELAXATIONS]
        assert a.min() >= 0.0
        terms = 1.0 / (1.0 + np.outer(RATES, tau)) / impedance[: len(RATES), None]
        size = np.linalg.norm(terms, axis=0)
        expected, _ = nnls(terms / size, np.ones(len(RATES)))
        assert_allclose(a * size, expected, rtol=0.0, atol=1e-9)
        worst = max(worst, float(np.abs(terms @ a - 1.0).max()))
    assert worst < tol.KERNEL_FIT
    measured(f"{name}: terms of lead ends and sides against what they stand for", worst, "0.02")


def still(
    half: bool, warm: float, dt: float, steps: int, sides: bool = False, **faces: EndFace
) -> Any:
    """A bearing at rest whose lead is warmer than the rest by `warm` [K]; states by time."""
    bearing = touching("shen-lhdr-specimen", sides)
    constants = assembled(bearing, half=half, lead_ends="finite-plate", **faces)
    state = types.new_state(constants, np.full(len(constants.cells.capacity), -20.0), -20.0 + warm)
    work, new = types.new_workspace(constants), types.new_state(constants, state.temperature)
    states = [state]
    for _ in range(steps):
        step(constants, work, state, 0.0, dt, -20.0, new)
        state, new = new, types.new_state(constants, state.temperature)
        states.append(state)
    return constants, states


@pytest.mark.parametrize("sides", [False, True])
def test_nothing_flows_where_all_is_as_warm(sides: bool) -> None:
    _, states = still(True, 0.0, 10.0, 3, sides)
    assert_allclose(states[-1].temperature, -20.0, rtol=tol.HEAT_BALANCE)
    assert_allclose(states[-1].branches[0].lead_temperature, -20.0, rtol=tol.HEAT_BALANCE)


@pytest.mark.parametrize("sides", [False, True])
@pytest.mark.parametrize("dt", [1e-4, 0.01, 1.0, 100.0, 1e4])
def test_any_step_is_stable_and_heat_flows_downhill(dt: float, sides: bool) -> None:
    _, states = still(True, 80.0, dt, 300, sides)
    lead = np.array([state.branches[0].lead_temperature for state in states])
    plates = np.array([state.temperature for state in states])
    assert plates.max() < 60.0
    assert lead.max() == 60.0
    if dt <= 1.0:
        assert np.all(np.diff(lead) <= 1e-9)
        assert min(lead.min(), plates.min()) > -20.0 - 1e-9
    else:  # Crank-Nicolson rings a little in steps that long, and dies out
        assert_allclose(lead[-1], -20.0, atol=tol.ENDS_RINGING)


@pytest.mark.parametrize("sides", [False, True])
def test_half_and_whole_stack_agree(sides: bool) -> None:
    """Two ends, each with its terms, are twice one end; the side is one in both."""
    whole, half = (still(half, 80.0, 0.05, 400, sides)[1][-1] for half in (False, True))
    near = tol.ENDS_HALF_SHIM if sides else tol.LOOP
    assert_allclose(
        whole.branches[0].lead_temperature, half.branches[0].lead_temperature, rtol=0.0, atol=near
    )
    assert_allclose(
        whole.temperature[: len(half.temperature)], half.temperature, rtol=tol.LOOP, atol=near
    )
    if not sides:
        assert_allclose(whole.ends.reshape(2, -1), [half.ends] * 2)


def test_no_heat_moves_between_what_is_as_warm() -> None:
    for sides in (False, True):
        _, states = still(True, 0.0, 0.1, 20, sides)
        assert_allclose(states[-1].temperature, -20.0, rtol=tol.LOOP)
        assert_allclose(states[-1].branches[0].lead_temperature, -20.0, rtol=tol.LOOP)
        assert_allclose(states[-1].ends, 0.0, atol=tol.LOOP)


def test_a_single_layer_has_no_shims_to_touch() -> None:
    bearing = changed(touching("lrb-example", True), geometry={"rubber_layers": 1})
    constants = assembled(bearing, half=False, lead_ends="finite-plate")
    assert constants.lead_ports == 2


def test_order_in_time(measured: Recorder) -> None:
    """First order: the flow is constant over a step, and the plate's own answer lags by one."""
    result = [
        still(True, 80.0, 4.0 / n, n)[1][-1].branches[0].lead_temperature for n in (800, 1600, 3200)
    ]
    order = math.log2((result[0] - result[1]) / (result[1] - result[2]))
    measured("lead on finite plates: observed order in time", f"{order:.3f}", "1 +- 0.1")
    assert abs(order - 1.0) < 0.1
    assert abs(result[1] - result[2]) < tol.ENDS_STEP


def test_terms_are_what_separates_core_and_plate() -> None:
    """After every step the excess is the sum of the terms, but for the plate's own conduction."""
    constants, states = still(True, 80.0, 1e-4, 50)
    last = states[-1]
    plate = last.temperature[constants.lead_cells[0].cell]
    assert_allclose(
        last.branches[0].lead_temperature - plate, last.ends.sum(), rtol=tol.ENDS_EXCESS
    )
    assert np.all(constants.lead_modes["relaxation"] > 0.0)
    heat = constants.cells.capacity @ (last.temperature + 20.0)
    core = constants.lead.cores * constants.lead.capacity
    assert_allclose(
        heat + core * (last.branches[0].lead_temperature + 20.0), core * 80.0, rtol=tol.ENDS_LOST
    )


@pytest.mark.parametrize("name", ["shen-lhdr-specimen", "shen-lhdr-bridge", "lrb-example"])
@pytest.mark.parametrize("unlike", [False, True])
@pytest.mark.parametrize("sides", [False, True])
def test_energy_balance_closes(name: str, unlike: bool, sides: bool, measured: Recorder) -> None:
    cycles = {"step": "cycles", "strain": 1.75, "wave": "sine", "speed": 100.0, "count": 3}
    test = tb.CyclicTest(dt=0.01, steps=[cycles, {"step": "rest", "duration": 3600.0}, cycles])
    faces = {"lower_face": tb.EndFace(film=20.0)} if unlike else {}
    result = tb.run(
        touching(name, sides),
        test,
        ambient=-20.0,
        model=tb.ModelOptions(lead_ends="finite-plate", **faces),
    )
    energy = result.energy
    residual = float(np.abs(energy[["mechanical_residual", "thermal_residual"]]).to_numpy().max())
    assert residual < tol.ENERGY_BALANCE
    how = "in touch with shims" if sides else "confined"
    measured(f"energy balance, lead on finite plates, {how}, {name}", f"{residual:.1e}", "1e-10")
