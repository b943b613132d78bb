"""The `published` scheme is Eq. 4.23-4.33 (HDR) and 5.13-5.31 (LHDR) as printed.

The equations are typed from Shen (2023), with departures from conservation. Layers count from 1
there and from 0 in the arrays. Eq. 5.13-5.31 are read around their slips: missing minus signs in
5.16 and 5.22, stray factors 2 in 5.23, theta_B for eta_B in 5.19. theta_l1 contains n_l and is
multiplied by n_l again for the plate (P4).
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from tests.tolerances import PUBLISHED_COEFFICIENT, PUBLISHED_STEP, RECIPROCITY
from tests.verification.models import assembled, heat_step, marched, sine, specimen
from thermobearing.core.lead import end_factor
from thermobearing.core.step import step
from thermobearing.core.types import Constants, Floats, new_state, new_workspace
from thermobearing.model.constants import build_constants
from thermobearing.model.stack import EndFace, build_stack

# Tables 4.1 and 5.1, Fig. 4.2b and section 5.2 in SI units, typed again: metres, watts, kilograms.
K_S, K_R, FILM = 38.76, 0.31, 11.6
C_RHO_S, C_RHO_R = 432.0 * 7740.0, 1732.0 * 1146.0
HDR = {"s1": 2.5e-3, "r": 2.5e-3, "s2": 3.2e-3, "s3": 1.6e-3}  # thickness of cells
LHDR = {"s1": 3.5e-3, "s2": 2.5e-3, "r": 2.5e-3, "s3": 3.2e-3, "s4": 1.6e-3}
SIDE = 0.240
V_R = SIDE * SIDE * 5e-3  # volume of one rubber layer [m3]
SHIMS = (12, 15, 18)  # layers 13, 16, 19
AMBIENT = -20.0
Rows = dict[int, tuple[float, float, float]]  # A, B - 1, C of the left side by layer, from 1


def beta(dx: dict[str, float], name: str, dt: float) -> float:
    """alpha dt / (2 dx^2), below Eq. 4.23, 4.26 and 4.28."""
    k, c_rho = (K_R, C_RHO_R) if name == "r" else (K_S, C_RHO_S)
    return k / c_rho * dt / (2.0 * dx[name] ** 2)


def gamma(dx: dict[str, float], a: str, b: str) -> float:
    """gamma_AB = k_A dx_B / (k_A dx_B + k_B dx_A) of Eq. 4.19."""
    k_a, k_b = (K_R if name == "r" else K_S for name in (a, b))
    return k_a * dx[b] / (k_a * dx[b] + k_b * dx[a])


def shims(dx: dict[str, float], dt: float, first: int, shim: str, last: str) -> Rows:
    """Rubber, shim, rubber twice, rubber, half shim: Eq. 4.27-4.31, 5.26-5.30."""
    b_r, b_s, b_l = (beta(dx, name, dt) for name in ("r", shim, last))
    g_sr, g_rs = gamma(dx, shim, "r"), gamma(dx, "r", shim)
    g_lr, g_rl = gamma(dx, last, "r"), gamma(dx, "r", last)
    rows: Rows = {}
    for j in (first, first + 3):
        rows[j] = (-b_r, b_r * (3.0 - 2.0 * g_rs), -2.0 * b_r * g_sr)
        rows[j + 1] = (-4.0 * b_s * g_rs, 8.0 * b_s * (1.0 - g_sr), -4.0 * b_s * g_rs)
        rows[j + 2] = (-2.0 * b_r * g_sr, b_r * (3.0 - 2.0 * g_rs), -b_r)
    rows[first + 6] = (-b_r, b_r * (3.0 - 2.0 * g_rl), -2.0 * b_r * g_lr)
    rows[first + 7] = (-4.0 * b_l * g_rl, 4.0 * b_l * (1.0 - g_lr), 0.0)
    return rows


def joint(dx: dict[str, float], dt: float, a: str, b: str, j: int) -> Rows:
    """The layers j and j + 1 of two parts that touch: Eq. 4.25-4.26, 5.21-5.22, 5.24-5.25."""
    b_a, b_b, g_ab, g_ba = beta(dx, a, dt), beta(dx, b, dt), gamma(dx, a, b), gamma(dx, b, a)
    upper = (-b_a, b_a * (3.0 - 2.0 * g_ab), -2.0 * b_a * g_ba)
    return {j: upper, j + 1: (-2.0 * b_b * g_ab, b_b * (3.0 - 2.0 * g_ba), -b_b)}


def printed_rows(dt: float, eta: float) -> Rows:
    """Layers 1 to 19 of the HDR specimen, from Eq. 4.23-4.31."""
    b_s1 = beta(HDR, "s1", dt)
    rows = {1: (0.0, eta * b_s1, -b_s1)}  # 4.23
    rows |= {j: (-b_s1, 2.0 * b_s1, -b_s1) for j in range(2, 10)}  # 4.24
    return rows | joint(HDR, dt, "s1", "r", 10) | shims(HDR, dt, 12, "s2", "s3")


def matrices(rows: Rows) -> tuple[Floats, Floats]:
    """K^{i+1} and K^i of the conduction alone."""
    new, old = np.eye(len(rows)), np.eye(len(rows))
    for j, (a, b, c) in rows.items():
        i = j - 1
        new[i, i] += b
        old[i, i] -= b
        if i > 0:
            new[i, i - 1], old[i, i - 1] = a, -a
        if j < len(rows):
            new[i, j], old[i, j] = c, -c
    return new, old


def printed_system(dt: float, eta: float) -> tuple[Floats, Floats, Floats]:
    """K^{i+1}, K^i and the vector theta^i of Eq. 4.33."""
    theta = 4.0 * FILM * dt / (SIDE * C_RHO_R)
    new, old = matrices(printed_rows(dt, eta))
    outflow = np.full(19, theta)
    outflow[0] += 2.0 * (eta - 1.0) * beta(HDR, "s1", dt)  # 4.23
    return new, old - theta * np.eye(19), outflow


def core_system(constants: Constants, dt: float) -> tuple[Floats, Floats, Floats]:
    cells = constants.cells
    own = cells.to_previous + cells.to_next + cells.end_loss
    rates = np.diag(own) - np.diag(cells.to_previous[1:], -1) - np.diag(cells.to_next[:-1], 1)
    side = dt * cells.side_loss
    n = len(side)
    assert not constants.side_implicit
    new, old = np.eye(n) + 0.5 * dt * rates, np.eye(n) - 0.5 * dt * rates - np.diag(side)
    return new, old, dt * cells.end_loss + side


def published(eta: float) -> Constants:
    return assembled(specimen(), upper=EndFace(eta=eta), scheme="published")


@pytest.mark.parametrize("dt", [5e-3, 0.1])
@pytest.mark.parametrize("eta", [1.0, 2.0, 3.0])
def test_coefficients_are_the_printed_ones(dt: float, eta: float) -> None:
    names = ("K^{i+1}", "K^i", "theta^i")
    core, printed = core_system(published(eta), dt), printed_system(dt, eta)
    for name, ours, theirs in zip(names, core, printed, strict=True):
        # Entry by entry, relative: the small rubber entries count as much as the diagonal.
        assert_allclose(ours, theirs, rtol=PUBLISHED_COEFFICIENT, atol=0.0, err_msg=name)


@pytest.mark.parametrize("dt", [5e-3, 0.1])
@pytest.mark.parametrize("eta", [1.0, 2.0, 3.0])
def test_one_conduction_step_solves_the_printed_system(dt: float, eta: float) -> None:
    constants = published(eta)
    new, old, outflow = printed_system(dt, eta)
    rng = np.random.default_rng(3)
    for _ in range(10):
        start, source = rng.uniform(-40.0, 40.0, 19), rng.normal(size=19)
        expected = np.linalg.solve(new, old @ start + source + outflow * AMBIENT)
        change = heat_step(constants, start, dt, AMBIENT, source).change
        assert_allclose(start + change, expected, rtol=0.0, atol=PUBLISHED_STEP)


def test_coupled_steps_solve_the_printed_system_with_the_printed_source() -> None:
    """w of Eq. 4.22, from the layer displacements and the force that the core returns."""
    dt, eta = 5e-3, 2.0
    run = marched(
        published(eta), sine(specimen(), strain=2.0, period=4.0, cycles=1, dt=dt), dt, -20.0, -25.0
    )
    new, old, outflow = printed_system(dt, eta)
    d = np.vstack([np.zeros(3), run.d]) * 1e-3  # m
    f = np.concatenate([[0.0], run.response["force"]]) * 1e3  # N
    cells = np.vstack([np.full(19, -20.0), run.cells])
    for i in range(len(run.d)):
        w = np.zeros(19)
        per_volume = (d[i + 1] - d[i]) * (f[i + 1] + f[i]) / (2.0 * V_R)
        for layer, (first, second) in enumerate(((10, 11), (13, 14), (16, 17))):
            w[[first, second]] = per_volume[layer] / C_RHO_R
        expected = np.linalg.solve(new, old @ cells[i] + w + outflow * -25.0)
        assert_allclose(cells[i + 1], expected, rtol=0.0, atol=PUBLISHED_STEP)


def test_a_shim_receives_twice_what_its_rubber_neighbours_lose() -> None:
    """P1: factor 2 at every shim, from both sides; exactly 1 at every other interface."""
    cells = published(2.0).cells
    given_down, taken_up = cells.capacity * cells.to_next, cells.capacity * cells.to_previous
    shim = np.isin(np.arange(19), SHIMS)
    # Between cells i and i + 1: what the lower one exchanges over what the upper one does.
    ratio = taken_up[1:] / given_down[:-1]
    expected = np.where(shim[1:], 2.0, np.where(shim[:-1], 0.5, 1.0))
    assert_allclose(ratio, expected, rtol=RECIPROCITY, atol=0.0)


# Section 5.2, in m, kg, s, J.
C_L, RHO_L, K_L = 129.0, 11360.0, 35.3
CORES, RADIUS, HEIGHT, P, ETA = 4, 17.25e-3, 0.096, 0.5, 2.0


def printed_rows_lead(dt: float) -> Rows:
    """Layers 1 to 29 of the LHDR specimen, from Eq. 5.19-5.30."""
    b = {name: beta(LHDR, name, dt) for name in LHDR}
    rows = {1: (0.0, ETA * b["s1"], -b["s1"])}  # 5.19
    rows |= {j: (-b["s1"], 2.0 * b["s1"], -b["s1"]) for j in range(2, 10)}  # 5.20
    rows |= joint(LHDR, dt, "s1", "s2", 10)
    rows |= {j: (-b["s2"], 2.0 * b["s2"], -b["s2"]) for j in range(12, 20)}  # 5.23
    return rows | joint(LHDR, dt, "s2", "r", 20) | shims(LHDR, dt, 22, "s3", "s4")


def printed_step(dt: float, t: Floats, lead: float, one_over_f: float) -> tuple[Floats, float]:
    """Cells and lead after one step without sources (Eq. 5.32), confined cores."""
    new, old = matrices(printed_rows_lead(dt))
    ambient = np.zeros(29)
    ambient[0] = 2.0 * (ETA - 1.0) * beta(LHDR, "s1", dt) * AMBIENT
    area, volume = np.pi * RADIUS**2, np.pi * RADIUS**2 * HEIGHT
    theta = CORES * dt / (C_L * RHO_L) * area / volume * P * K_S / RADIUS * one_over_f
    from_lead = np.zeros(29)
    from_lead[9] = CORES * theta * (lead - AMBIENT)  # 5.21
    after = (1.0 - 2.0 * theta) * lead + 2.0 * theta * AMBIENT  # 5.31
    return np.linalg.solve(new, old @ t + ambient + from_lead), after


@pytest.mark.parametrize("dt", [1e-3, 5e-3, 0.05])
def test_one_step_is_the_printed_one(dt: float) -> None:
    bearing = tb.load_bearing("shen-lhdr-specimen")
    stack = build_stack(bearing, half=True)
    constants = build_constants(
        bearing, stack, upper=EndFace(eta=ETA), lower=None, scheme="published"
    )
    rng = np.random.default_rng(5)
    cells, lead = rng.uniform(-20.0, 30.0, 29), 60.0
    state, new = new_state(constants, cells, lead), new_state(constants, cells, lead)
    step(constants, new_workspace(constants), state, 0.0, dt, AMBIENT, new)
    mean = end_factor(0.0, K_L / (C_L * RHO_L) * dt / RADIUS**2)  # 5.5 with t+ of 5.6
    expected, after = printed_step(dt, cells, lead, mean)
    # The bearing is held, so rubber at unequal temperatures shares nothing and makes no heat.
    assert_allclose(new.temperature, expected, rtol=0.0, atol=tol.PUBLISHED_LEAD)
    assert_allclose(new.branches[0].lead_temperature, after, rtol=0.0, atol=tol.PUBLISHED_LEAD)
