"""Rows of chapters 5 and 6, of the conclusions and of the misprints: computed, and able to fail."""

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests import tolerances as tol
from thermobearing.border.errors import InputError
from thermobearing.reproduce import (
    bridge_claims,
    chapter_5,
    chapter_6,
    conclusions,
    misprints,
    misprints_of_tables,
)
from thermobearing.reproduce.claims import (
    CONTRADICTED,
    FAILED,
    HOLDS,
    NEEDS,
    REPRODUCED,
    Row,
    Variants,
    load_claims,
    make_row,
)
from thermobearing.reproduce.printed import printed, printed_numbers
from thermobearing.reproduce.runs import Runs, parameters

PARTS = ("chapter-5", "chapter-6", "conclusions", "misprints")
FEWEST = {"chapter-5": 30, "chapter-6": 40, "conclusions": 30, "misprints": 35}


@pytest.fixture(scope="module")
def runs() -> Runs:
    return Runs()


@pytest.fixture(scope="module")
def rows(runs: Runs) -> dict[str, Row]:
    """Every row of the four parts, by id."""
    return {claim.id: make_row(claim, runs) for part in PARTS for claim in load_claims(part)}


@pytest.mark.parametrize("part", PARTS)
def test_no_row_is_broken(part: str, rows: dict[str, Row]) -> None:
    claims = load_claims(part)
    assert len(claims) >= FEWEST[part]
    broken = [(c.id, rows[c.id].verdict.words) for c in claims if rows[c.id].verdict.kind == FAILED]
    assert not broken
    for claim in claims:
        assert set(claim.flips) <= set(parameters()), claim.id


def test_a_row_that_holds_names_what_may_flip_it_or_why_nothing_does(rows: dict[str, Row]) -> None:
    for name, row in rows.items():
        if row.verdict.settled:
            assert row.claim.flips or row.claim.depends, name


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("5-3-2-strength", REPRODUCED),
        ("fig-5-7-within-15", NEEDS),
        ("fig-5-15-real-time-force", HOLDS),
        ("fig-5-17-peak", CONTRADICTED),
        ("fig-5-17-peak-as-printed", HOLDS),
        ("table-6-1-k-b", REPRODUCED),
        ("table-6-1-k-b-hdr", REPRODUCED),
        ("table-6-2-period", REPRODUCED),
        ("fig-6-11-strain", HOLDS),
        ("fig-6-9-force", HOLDS),
        ("6-3-2-energy-drop", CONTRADICTED),
        ("6-3-3-ductility-cold", CONTRADICTED),
        ("7-1-6-3-pier", HOLDS),
        ("table-6-4-k-r", CONTRADICTED),
        ("table-6-4-swapped", HOLDS),
        ("3-4-1-two-bearings", CONTRADICTED),
        ("3-4-1-eight-bearings", REPRODUCED),
    ],
)
def test_verdicts(name: str, kind: str, rows: dict[str, Row]) -> None:
    assert rows[name].verdict.kind == kind


def test_of_the_misprints_only_mended_readings_hold(rows: dict[str, Row]) -> None:
    held = {c.id for c in load_claims("misprints") if rows[c.id].verdict.settled}
    assert held == {
        "3-4-1-eight-bearings",
        "eq-4-25-mended",
        "eq-4-28-mended",
        "table-6-4-swapped",
        "eq-6-2-degree",
    }


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
    claim = next(c for part in PARTS for c in load_claims(part) if c.id == name)
    assert make_row(claim, Runs(change)).verdict.kind == kind


def test_flips_are_found() -> None:
    """Those of an eigenvalue: T goes with the root of the mass, printed 1.70 +- 1 %."""
    claim = next(c for c in load_claims("chapter-6") if c.id == "table-6-2-period")
    row = make_row(claim, Runs(), Variants())
    found = {flip.parameter: flip.change for flip in row.flips}
    assert 0.01 < (found["m_1"] or 0.0) < 0.025
    assert -0.05 < (found["K_B"] or 0.0) < -0.02
    assert row.stiffer


def test_equations_typed_from_the_print(runs: Runs) -> None:
    """Rows of coefficients by hand: 1 K, in 5 ms; theta = 4 h dt/(a c rho)."""
    theta = 4.0 * 11.6 * 0.005 / (0.240 * 1732.0 * 1146.0)
    assert_allclose(np.asarray(misprints.cell_4_16(runs)) - 1.0, theta, rtol=tol.THETA_OF_A_STEP)
    assert_allclose(np.asarray(misprints.cell_4_21(runs)) - 1.0, theta, rtol=tol.THETA_OF_A_STEP)
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


def test_slips_of_the_heat_by_hand(runs: Runs) -> None:
    assert_allclose(misprints.shim_flux(runs), 2.0, rtol=tol.LOOP)
    assert_allclose(
        misprints.side_loss_of_steel(runs), 432.0 * 7740.0 / (1732.0 * 1146.0), rtol=tol.LOOP
    )
    clock = 35.30 / (129.0 * 11360.0) / (38.76 / (432.0 * 7740.0))
    assert_allclose(misprints.clock_of_lead(runs), clock, rtol=tol.LOOP)
    cell = 432.0 * 7740.0 * 0.240**2 * 3.5e-3
    core = 129.0 * 11360.0 * 0.25 * np.pi * 0.0345**2 * 0.096
    assert_allclose(misprints.plates_gain(runs), cell / core, rtol=tol.LOOP)
    assert float(np.asarray(misprints.uphill(runs))) < 0.0
    assert float(np.asarray(misprints.heat_kept(runs))) < 1e-10
    assert float(np.asarray(misprints.inner_layer(runs))) > 1.1


def test_tables_by_hand(runs: Runs) -> None:
    assert_allclose(chapter_5.characteristic_strength(runs), 12e-3 * np.pi * 17.25**2)
    assert_allclose(chapter_6.yield_force(runs), 125.4 / (1.0 - 1.81 / 9.51))
    assert_allclose(chapter_6.yield_displacement(runs), 125.4 / (9.51 - 1.81))
    assert_allclose(
        misprints_of_tables.equivalent_stiffness_6_3(runs), (125.4 + 1.81 * 178.0) / 178.0
    )
    assert_allclose(
        misprints_of_tables.damping_of_g12(runs)[0],  # type: ignore[index]
        0.2022 - 0.5 * 3.035411 - 0.25 * 0.0004006,
    )


def test_dashpots_by_hand(runs: Runs) -> None:
    """Signs (1, 1, 1, 1) of the reactions, (1, -1, -1, -1) of the stretch: eigenvalues 1, -3."""
    assert_allclose(misprints.dashpots_6_5(runs), -3.0, rtol=tol.LOOP)
    assert_allclose(
        misprints.initial_rate_share(runs), 1.890 / (1.890 + 26.783 / 6.0 + 4.0 * 22.066)
    )


def test_bridge_rows_are_motions_by_temperatures(runs: Runs) -> None:
    table = bridge_claims.study(runs, bridge_claims.HDR).table
    strain = bridge_claims.by_motion(runs, bridge_claims.HDR, "bearing_strain_max")
    one = table[(table["motion"] == "jra-ii-i-1") & (table["ambient_degC"] == -20.0)]
    assert strain.shape == (4, 3)
    assert strain[bridge_claims.II_I_1, -1] == one["bearing_strain_max"].iloc[0]
    drop: Any = bridge_claims.energy_drop(runs)
    assert drop[1] < drop[0] < 0.0


def test_size_matters_for_heat_only_with_conduction(runs: Runs) -> None:
    insulating = Runs({"k_r": 0.004})
    both = [float(np.asarray(conclusions.size(each))) for each in (runs, insulating)]
    assert both[0] < 0.9 < 0.95 < both[1]


def test_printed_numbers_change_by_their_own_parameters_only() -> None:
    assert printed(Runs({"K_r": 2.0}), "u_B") == 178.0
    assert printed(Runs({"u_B": 0.5}), "u_B") == 89.0
    assert all(number.source for number in printed_numbers().values())
    with pytest.raises(InputError, match="u_b"):
        printed(Runs(), "u_b")
