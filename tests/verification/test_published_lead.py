"""Eq. 5.13-5.31 of the LHDR specimen, typed from the print, against the published scheme.

Read around its slips: missing minus signs in 5.16 and 5.22, stray factors 2 in 5.23, theta_B for
eta_B in 5.19. theta_l1 contains n_l and is multiplied by n_l again for the plate (P4).
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.core.lead import end_factor
from thermobearing.core.step import step
from thermobearing.core.types import new_state, new_workspace
from thermobearing.model.constants import build_constants
from thermobearing.model.stack import Face, build_stack

Floats = NDArray[np.float64]
# Table 5.1 and section 5.2, in m, kg, s, J.
K_S, C_S, RHO_S = 38.76, 432.0, 7740.0
K_R, C_R, RHO_R = 0.31, 1732.0, 1146.0
C_L, RHO_L, K_L = 129.0, 11360.0, 35.3
DX = {"s1": 3.5e-3, "s2": 2.5e-3, "r": 2.5e-3, "s3": 3.2e-3, "s4": 1.6e-3}
CORES, RADIUS, HEIGHT, P, ETA = 4, 17.25e-3, 0.096, 0.5, 2.0
AMBIENT = -20.0


def beta(name: str, dt: float) -> float:
    k, c_rho = (K_R, C_R * RHO_R) if name == "r" else (K_S, C_S * RHO_S)
    return k / c_rho * dt / (2.0 * DX[name] ** 2)


def gamma(a: str, b: str) -> float:
    """gamma_ab = k_a dx_b / (k_a dx_b + k_b dx_a)."""
    k = {name: K_R if name == "r" else K_S for name in (a, b)}
    return k[a] * DX[b] / (k[a] * DX[b] + k[b] * DX[a])


def printed_rows(dt: float) -> dict[int, tuple[float, float, float]]:
    """Coefficients (before, own less 1, after) of K^{i+1}, by the printed number of the layer."""
    b = {name: beta(name, dt) for name in DX}
    rows = {1: (0.0, ETA * b["s1"], -b["s1"])}  # 5.19
    rows |= {j: (-b["s1"], 2.0 * b["s1"], -b["s1"]) for j in range(2, 10)}  # 5.20
    g12, g21 = gamma("s1", "s2"), gamma("s2", "s1")
    rows[10] = (-b["s1"], b["s1"] * (3.0 - 2.0 * g12), -2.0 * b["s1"] * g21)  # 5.21
    rows[11] = (-2.0 * b["s2"] * g12, b["s2"] * (3.0 - 2.0 * g21), -b["s2"])  # 5.22
    rows |= {j: (-b["s2"], 2.0 * b["s2"], -b["s2"]) for j in range(12, 20)}  # 5.23
    g2r, gr2 = gamma("s2", "r"), gamma("r", "s2")
    rows[20] = (-b["s2"], b["s2"] * (3.0 - 2.0 * g2r), -2.0 * b["s2"] * gr2)  # 5.24
    rows[21] = (-2.0 * b["r"] * g2r, b["r"] * (3.0 - 2.0 * gr2), -b["r"])  # 5.25
    g3r, gr3 = gamma("s3", "r"), gamma("r", "s3")
    g4r, gr4 = gamma("s4", "r"), gamma("r", "s4")
    for j in (22, 25):  # 5.26
        rows[j] = (-b["r"], b["r"] * (3.0 - 2.0 * gr3), -2.0 * b["r"] * g3r)
    for j in (23, 26):  # 5.27
        rows[j] = (-4.0 * b["s3"] * gr3, 8.0 * b["s3"] * (1.0 - g3r), -4.0 * b["s3"] * gr3)
    for j in (24, 27):  # 5.28
        rows[j] = (-2.0 * b["r"] * g3r, b["r"] * (3.0 - 2.0 * gr3), -b["r"])
    rows[28] = (-b["r"], b["r"] * (3.0 - 2.0 * gr4), -2.0 * b["r"] * g4r)  # 5.29
    rows[29] = (-4.0 * b["s4"] * gr4, 4.0 * b["s4"] * (1.0 - g4r), 0.0)  # 5.30
    return rows


def printed_step(dt: float, t: Floats, lead: float, one_over_f: float) -> tuple[Floats, float]:
    """Cells and lead after one step without sources (Eq. 5.32), confined cores."""
    new, old = np.eye(29), np.eye(29)
    for j, (a, own, c) in printed_rows(dt).items():
        i = j - 1
        new[i, i] += own
        old[i, i] -= own
        if i > 0:
            new[i, i - 1], old[i, i - 1] = a, -a
        if i < 28:
            new[i, i + 1], old[i, i + 1] = c, -c
    ambient = np.zeros(29)
    ambient[0] = 2.0 * (ETA - 1.0) * beta("s1", dt) * AMBIENT
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
    constants = build_constants(bearing, stack, upper=Face(eta=ETA), lower=None, scheme="published")
    rng = np.random.default_rng(5)
    cells, lead = rng.uniform(-20.0, 30.0, 29), 60.0
    state, new = new_state(constants, cells, lead), new_state(constants, cells, lead)
    step(constants, new_workspace(constants), state, 0.0, dt, AMBIENT, new)
    mean = end_factor(0.0, K_L / (C_L * RHO_L) * dt / RADIUS**2)  # 5.5 with t+ of 5.6
    expected, after = printed_step(dt, cells, lead, mean)
    # The bearing is held, so rubber at unequal temperatures shares nothing and makes no heat.
    assert_allclose(new.temperature, expected, rtol=0.0, atol=tol.PUBLISHED_LEAD)
    assert_allclose(new.branches[0].lead_temperature, after, rtol=0.0, atol=tol.PUBLISHED_LEAD)
