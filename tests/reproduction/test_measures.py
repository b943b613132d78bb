"""Numbers of expressions by hand, and what changes them."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from reproduction import misprints
from reproduction.claims import CONTRADICTED, REPRODUCED, Variants, compute, load_claims, make_row
from reproduction.measures import bridge_study, rise_by_size, shaken
from reproduction.runs import HDR_BRIDGE, Runs
from tests import tolerances as tol
from thermobearing.border.errors import InputError

CLAIMS = {claim.id: claim for claim in load_claims()}


@pytest.mark.parametrize(
    ("change", "name", "kind"),
    [
        ({"sigma_Y": 1.05}, "5-3-2-strength", CONTRADICTED),
        ({"t_r": 1.05}, "fig-5-2-half-height", CONTRADICTED),
        ({"u_B": 1.05}, "table-6-1-k-b", CONTRADICTED),
        ({"A_e": 1.05}, "table-6-1-stress", CONTRADICTED),
        ({"K_r": 1.05}, "table-6-1-k-b-hdr", CONTRADICTED),
        ({"m_1": 1.05}, "table-6-2-period", CONTRADICTED),
        ({"K_1": 1.05}, "table-6-3-ratio", CONTRADICTED),
        ({"n_b": 1.05}, "3-4-1-eight-bearings", CONTRADICTED),
        ({"Q_d": 1.15}, "table-6-3-k-b", REPRODUCED),
    ],
)
def test_a_small_change_flips_what_it_should(
    change: dict[str, float], name: str, kind: str
) -> None:
    assert make_row(CLAIMS[name], Runs(change)).verdict.kind == kind


def test_flips_are_found() -> None:
    """Those of an eigenvalue: T goes with the root of the mass, printed 1.70 +- 1 %."""
    row = make_row(CLAIMS["table-6-2-period"], Runs(), Variants())
    result = {flip.parameter: flip.change for flip in row.flips}
    assert 0.01 < (result["m_1"] or 0.0) < 0.025
    assert -0.05 < (result["K_B"] or 0.0) < -0.02
    assert row.stiffer


def test_equations_typed_from_the_print(runs: Runs) -> None:
    """Rows of coefficients by hand: 1 K, in 5 ms; theta = 4 h dt/(a c rho)."""
    theta = 4.0 * 11.6 * 0.005 / (0.240 * 1732.0 * 1146.0)
    assert_allclose(misprints.cell_4_16(runs) - 1.0, theta, rtol=tol.THETA_OF_A_STEP)
    assert_allclose(misprints.cell_4_21(runs) - 1.0, theta, rtol=tol.THETA_OF_A_STEP)
    steel = 38.76 / (432.0 * 7740.0)
    beta = steel * 0.005 / (2.0 * 2.5e-3**2)
    gamma = 38.76 / (38.76 + 0.31)  # cells of 2.5 mm on both sides
    wrong = 1.0 - beta * (3.0 - 2.0 * gamma) + theta  # once too often on the right
    assert_allclose(misprints.cell_4_20(runs), wrong, rtol=tol.LOOP)
    assert_allclose(misprints.cell_5_23(runs), 2.0 / (1.0 - beta), rtol=tol.LOOP)
    after = (1.0 + 2.0 * beta * 2.5 / 6.0 - beta * (3.0 - 2.0 * 3.5 / 6.0) + beta) / (
        1.0 + 2.0 * beta * 2.5 / 6.0 + beta * (3.0 - 2.0 * 3.5 / 6.0) - beta
    )
    assert_allclose(misprints.cell_5_22(runs), after, rtol=tol.LOOP)
    outer = steel * 0.005 / (2.0 * 3.5e-3**2)
    assert_allclose(misprints.cell_5_19(runs), 1.0 - 4.0 * outer / (1.0 + outer), rtol=tol.LOOP)


def test_heat_by_hand(runs: Runs) -> None:
    steel, lead, rubber = 432.0 * 7740.0, 129.0 * 11360.0, 1732.0 * 1146.0  # rho c
    cell = steel * 0.240**2 * 3.5e-3
    core = lead * 0.25 * np.pi * 0.0345**2 * 0.096
    assert_allclose(misprints.shim_flux(runs), 2.0, rtol=tol.LOOP)
    assert_allclose(misprints.plates_gain(runs), cell / core, rtol=tol.LOOP)
    assert misprints.uphill(runs) < 0.0
    # Signs (1, 1, 1, 1) of the reactions, (1, -1, -1, -1) of the stretch: eigenvalues 1, -3.
    assert_allclose(misprints.dashpots_6_5(runs), -3.0, rtol=tol.LOOP)
    by_hand = {
        "eq-4-23-side-loss": steel / rubber,
        "eq-5-6-clock": 35.30 / lead / (38.76 / steel),
        "5-4-2-1-table-5-2": 1.890 / (1.890 + 26.783 / 6.0 + 4.0 * 22.066),
        "5-3-2-strength": 12e-3 * np.pi * 17.25**2,
        "table-6-3-q-y": 125.4 / (1.0 - 1.81 / 9.51),
        "table-6-3-u-y": 125.4 / (9.51 - 1.81),
        "table-6-3-k-b": (125.4 + 1.81 * 178.0) / 178.0,
        "axial-stress-eight": 10.156e6 * 9.80665 / (8 * 1440.0**2),
    }
    for name, value in by_hand.items():
        assert_allclose(compute(CLAIMS[name], runs), value, rtol=tol.LOOP, err_msg=name)
    g12 = 0.2022 - 0.5 * 3.035411 - 0.25 * 0.0004006
    assert_allclose(compute(CLAIMS["table-a-2-d-1"], runs)[0], g12)
    assert compute(CLAIMS["eq-4-28-mended"], runs) < 1e-10
    assert compute(CLAIMS["eq-4-28-inner-layer"], runs) > 1.1


def test_bridge_rows_are_motions_by_temperatures(runs: Runs) -> None:
    table = bridge_study(runs, HDR_BRIDGE).table
    strain = shaken(runs, HDR_BRIDGE, "bearing_strain_max")
    one = table[(table["motion"] == "jra-ii-i-1") & (table["ambient_degC"] == -20.0)]
    assert strain.shape == (4, 3)
    assert strain[2, -1] == one["bearing_strain_max"].iloc[0]
    drop = compute(CLAIMS["6-3-2-energy-drop"], runs)
    assert drop[1] < drop[0] < 0.0


def test_size_matters_for_heat_only_with_conduction(runs: Runs) -> None:
    both = [rise_by_size(each) for each in (runs, Runs({"k_r": 0.004}))]
    assert both[0] < 0.9 < 0.95 < both[1]


def test_printed_numbers_change_by_their_own_parameters_only() -> None:
    assert Runs({"K_r": 2.0}).number("u_B") == 178.0
    assert Runs({"u_B": 0.5}).number("u_B") == 89.0
    with pytest.raises(InputError, match="u_b"):
        Runs().number("u_b")
