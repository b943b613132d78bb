"""Structures: matrices, damping, lines of bearings, the command `structures`."""

import json
import math
import os
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.linalg import eigh

import thermobearing as tb
from tests import tolerances as tol
from tests.quick import quick_cases
from tests.unit.inputs import command, last_line, write_toml
from tests.unit.test_lines_and_piers import make_bridge, two_piers
from tests.verification.structures import (
    energy_residual,
    linear_bearing,
    read_ground,
    real_bearing,
    shaken,
)
from thermobearing.border.errors import InputError
from thermobearing.border.schema import validated
from thermobearing.border.toml import to_toml
from thermobearing.core.records import Floats
from thermobearing.earthquake import report as earthquake_report
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.earthquake.measures import LARGEST_DAMPING_SHARE
from thermobearing.results.saved import read_saved
from thermobearing.structure import run
from thermobearing.structure.forces import build_bearings
from thermobearing.structure.matrices import (
    _bare_modes,
    _line_parts,
    _spring_and_hinge_parts,
    _weighed_ratios,
    build_matrices,
    displacement_row,
    hinge_stiffness,
    line_stiffness,
    mode_damping,
)
from thermobearing.structure.model import Damping, DampingKind, Structure, load_structure
from thermobearing.structure.newmark import newmark_march
from thermobearing.structure.report import build_pieces

PIER = load_structure("pier-p1")
OWN: tuple[DampingKind, ...] = ("modal", "rayleigh", "element", "none")


def test_rows_of_pier_p1() -> None:
    """Deck x, footing x and rotation, pier rotation; heights from the pier's base, in mm."""
    matrices = build_matrices(PIER)
    assert matrices.coordinates == ["deck x", "footing x", "footing rotation", "pier rotation"]
    # Stretch x1 - x3 - theta3 l3 - theta2 (l1 + l2), Eq. 6.4.
    assert_allclose(matrices.line_rows, [[1.0, -1.0, -2000.0, -10000.0]])
    assert_allclose(matrices.hinge_rows, [[0.0, 0.0, -1.0, 1.0]])
    assert_allclose(displacement_row(PIER, "pier", 8900.0), [0.0, 1.0, 2000.0, 8900.0])
    assert_allclose(displacement_row(PIER, "footing", -1000.0), [0.0, 1.0, 1000.0, 0.0])
    assert_allclose(displacement_row(PIER, "deck", 10000.0), [1.0, 0.0, 0.0, 0.0])
    assert_allclose(displacement_row(PIER, "ground", 5.0), np.zeros(4))


def test_stiffnesses_of_pier_p1() -> None:
    """Five bearings of 2.6153 kN/mm; 34 839 kN m at 0.309 % of a radian."""
    matrices = build_matrices(PIER)
    assert PIER.hinges[0].stiffness == pytest.approx(34839e3 / 0.00309)
    lines = line_stiffness(PIER, matrices)
    assert_allclose(lines, 5 * 2.6153 * np.outer(matrices.line_rows[0], matrices.line_rows[0]))
    each = line_stiffness(PIER, matrices, np.array([4.0]))
    assert_allclose(each[0, 0], 20.0)
    hinge = hinge_stiffness(PIER, matrices)
    assert_allclose(hinge[2:, 2:], PIER.hinges[0].stiffness * np.array([[1.0, -1.0], [-1.0, 1.0]]))
    assert_allclose(matrices.springs[1, 1], 1397.0)
    assert_allclose(matrices.springs[2, 2], 1.725e9)  # kN mm/rad
    # The ground pushes every mass: all of it sideways.
    mass = 400.0 + 140.0 + 206.3 + 227.5
    assert_allclose(matrices.load[:2].sum(), -1e-3 * mass)


def two_springs() -> Structure:
    mass = "1 kN s^2/mm"
    table: dict[str, Any] = {
        "name": "two springs",
        "bodies": [{"name": "deck", "moves": True}, {"name": "pier", "moves": True}],
        "masses": [{"body": name, "height": "0 m", "mass": mass} for name in ("deck", "pier")],
        "springs": [
            {"name": "a", "body": "pier", "stiffness": "100 kN/mm", "damping_ratio": 0.02},
            {"name": "b", "body": "pier", "stiffness": "300 kN/mm", "damping_ratio": 0.10},
        ],
        "bearings": [
            {"name": "line", "body": "deck", "base": "pier", "count": 4,
             "equivalent_stiffness": "0.5 kN/mm", "damping_ratio": 0.2}
        ],
        "report": {"deck": "deck", "pier": "pier", "pier_top": "0 m"},
    }  # fmt: skip
    return validated(Structure, table, "two springs")


def test_damping_ratios_are_weighed_with_strain_energy() -> None:
    """Nearly all energy of the first mode is in the bearings, of the second in the springs."""
    structure = two_springs()
    prepared = run.prepare_structure(structure)
    stiffness = np.array([[2.0, -2.0], [-2.0, 402.0]])
    values, shapes = np.linalg.eigh(stiffness)  # unit masses
    assert_allclose(prepared.modes.frequencies, np.sqrt(values))
    wanted = []
    for shape in shapes.T:
        bearing = 2.0 * (shape[0] - shape[1]) ** 2
        springs = np.array([100.0, 300.0]) * shape[1] ** 2
        total = bearing + springs.sum()
        wanted.append((0.2 * bearing + 0.02 * springs[0] + 0.10 * springs[1]) / total)
    matrices = build_matrices(structure)
    parts = [*_spring_and_hinge_parts(structure, matrices), *_line_parts(structure, matrices)]
    assert_allclose(_weighed_ratios(parts, prepared.modes), wanted)
    assert_allclose(wanted, [0.2, 0.08], atol=0.002)


def motion_file(folder: Path, values: np.ndarray, dt: float = 0.005) -> str:
    path = folder / "motion.csv"
    rows = np.column_stack([dt * np.arange(len(values)), values])
    np.savetxt(path, rows, fmt="%.6f", delimiter=",", header="t_s,acc_gal", comments="")
    return str(path)


def test_ground_that_starts_at_once_leaves_everything_where_it_is(tmp_path: Path) -> None:
    """At the first instant nothing has moved: what the deck feels is no acceleration at all."""
    path = motion_file(tmp_path, np.full(20, 300.0))
    for name in ("pier-p1", "hybrid-pier"):
        bearing = "shen-bilinear-bridge"
        study = tb.bridge(bearing, path, 23.0, structure=name, keep=tb.Keep(every=1))
        assert study.outcome == "completed"
        deck = study["deck_acceleration"].values[0]
        assert abs(deck[0]) < 1e-6  # m/s2, of 3
        assert_allclose(study["ground_acceleration"].values[0], 3.0, rtol=1e-6)


@pytest.mark.parametrize("steps", [0.0, 0.5, 1.25, 2.0])
def test_actuator_is_where_it_was_commanded_to_be_a_delay_ago(steps: float, tmp_path: Path) -> None:
    """The specimen of 1/6 follows deck less pier, late by a part of a step or by more."""
    dt, count = 0.005, 160
    time = dt * np.arange(count)
    path = motion_file(tmp_path, 300.0 * np.sin(2.0 * np.pi * 1.5 * time))
    lab = {"delay": f"{1e3 * steps * dt} ms"}
    study = tb.hybrid("shen-hdr-specimen", path, 23.0, laboratory=lab, keep=tb.Keep(every=1))
    assert study.outcome == "completed"
    reported = (study["deck_displacement"] - study["pier_top_displacement"]).values[0] / 6.0
    late = np.interp(study["time"].values[0] - steps * dt, study["time"].values[0], reported)
    result = study["bearing_displacement"].values[0]
    assert np.abs(result).max() > 2.0
    # The command was the prediction of a step, before it was corrected.
    assert np.abs(result - late).max() < tol.DELAYED * np.abs(result).max()


def prepared_with(structure: Structure, **damping: Any) -> run.Prepared:
    return run.prepare_structure(structure.model_copy(update={"damping": Damping(**damping)}))


def without_ratio(structure: Structure) -> Structure:
    """Bearings with 0 %, as in Table 6.2; with more, "element" has c_1 (test_dashpots.py)."""
    lines = [line.model_copy(update={"damping_ratio": 0.0}) for line in structure.bearings]
    return structure.model_copy(update={"bearings": lines})


def bare_ratios(prepared: run.Prepared) -> np.ndarray:
    modes = _bare_modes(prepared.structure, prepared.matrices)
    return mode_damping(prepared.damping, modes)


@pytest.mark.parametrize("kind", OWN)
@pytest.mark.parametrize("mass", ["consistent", "published"])
def test_nothing_damps_the_deck(kind: DampingKind, mass: Any) -> None:
    damping = run.prepare_structure(PIER, mass, kind).damping
    assert np.abs(damping[0]).max() <= 1e-9 * np.abs(damping).max()
    assert_allclose(damping, damping.T, atol=1e-12 * np.abs(damping).max())


def test_the_source_damps_the_deck() -> None:
    """Section 6.2.3: modes 1 and 2 get their ratios; modes 3 and 4 what comes of it."""
    prepared = run.prepare_structure(PIER, "consistent", "source")
    assert prepared.damping[0, 0] > 0.0
    assert_allclose(prepared.ratios, [0.0609, 0.0333, 0.332, 0.610], rtol=2e-3)
    given = prepared_with(two_springs(), kind="source", ratios=(0.03, 0.07))
    assert_allclose(given.ratios, [0.03, 0.07], rtol=1e-9)
    assert given.damping[0, 1] == 0.0


def test_the_source_with_bearings_damps_all_stiffness() -> None:
    """C = a M + b K with all [K] of Eq. 3.3: every mode on the bearings has a/(2 w) + b w/2."""
    prepared = prepared_with(two_springs(), kind="source-with-bearings", ratios=(0.03, 0.07))
    assert_allclose(prepared.ratios, [0.03, 0.07], rtol=1e-9)
    assert prepared.damping[0, 1] < 0.0  # the dashpot across the bearings
    pier = run.prepare_structure(PIER, "consistent", "source-with-bearings")
    w = pier.modes.frequencies
    a, b = np.linalg.solve(np.column_stack([0.5 / w, 0.5 * w])[:2], pier.ratios[:2])
    assert_allclose(pier.ratios, 0.5 * a / w + 0.5 * b * w, rtol=1e-9)


def test_modal_ratios_are_those_of_the_parts() -> None:
    """Of a pier on two springs: (0.02 100 + 0.10 300)/400 in its one mode."""
    assert_allclose(bare_ratios(prepared_with(two_springs(), kind="modal")), [0.08])
    assert_allclose(bare_ratios(prepared_with(two_springs(), kind="modal", ratios=(0.03,))), [0.03])
    given = prepared_with(PIER, kind="modal", ratios=(0.01, 0.02, 0.03))
    assert_allclose(bare_ratios(given), [0.01, 0.02, 0.03], rtol=1e-9)


def test_rayleigh_goes_through_the_chosen_modes() -> None:
    """a/(2 omega) + b omega/2; through one mode it is b K' alone."""
    own = bare_ratios(run.prepare_structure(PIER))
    w = _bare_modes(PIER, run.prepare_structure(PIER).matrices).frequencies
    for first, second in ((0, 1), (0, 2)):
        result = bare_ratios(prepared_with(PIER, kind="rayleigh", modes=(first + 1, second + 1)))
        assert_allclose(result[[first, second]], own[[first, second]], rtol=1e-9)
        rates = 2.0 * own * w
        b = (rates[second] - rates[first]) / (w[second] ** 2 - w[first] ** 2)
        a = rates[first] - b * w[first] ** 2
        assert_allclose(result, 0.5 * (a / w + b * w), rtol=1e-9)
    alone = prepared_with(two_springs(), kind="rayleigh", modes=(1,), ratios=(0.05,))
    assert_allclose(alone.damping, np.diag([0.0, 2.0 * 0.05 / 20.0 * 400.0]), atol=1e-12)


def test_dashpots_beside_the_parts() -> None:
    """c = 2 xi k/omega, omega that of the pier alone: 20/s."""
    damping = prepared_with(without_ratio(two_springs()), kind="element").damping
    assert_allclose(damping, np.diag([0.0, 0.1 * (0.02 * 100.0 + 0.10 * 300.0)]), atol=1e-12)
    pier = run.prepare_structure(PIER, "consistent", "element")
    w = _bare_modes(PIER, pier.matrices).frequencies
    k = pier.structure.hinges[0].stiffness
    # Pier rotation: c_2 of Eq. 6.5, in the fastest mode; nothing else turns with it.
    assert_allclose(pier.damping[3, 3], 2.0 * 0.02 / w[2] * k, rtol=1e-9)
    assert_allclose(pier.damping[2, 3], -2.0 * 0.02 / w[2] * k, rtol=1e-9)
    # c_3: rocking in the slowest mode, sideways in the second.
    assert_allclose(pier.damping[1, 1], 2.0 * 0.10 / w[1] * 1397.0, rtol=1e-9)


def test_a_structure_on_nothing_but_bearings_has_no_viscous_damping() -> None:
    structure = without_ratio(two_springs())
    line = structure.bearings[0].model_copy(update={"base": "ground"})
    second = line.model_copy(update={"name": "second", "body": "pier"})
    floating = structure.model_copy(update={"springs": (), "bearings": [line, second]})
    for kind in OWN:
        assert not run.prepare_structure(floating, "consistent", kind).damping.any()


@pytest.mark.parametrize(
    ("damping", "words"),
    [
        ({"ratios": (0.02, 0.05)}, ["ratios", "kind"]),
        ({"kind": "element", "ratios": (0.02,)}, ["ratios", "element"]),
        ({"kind": "none", "modes": (1,)}, ["modes", "rayleigh"]),
        ({"kind": "rayleigh", "modes": (2, 2)}, ["modes", "twice"]),
        ({"kind": "rayleigh", "modes": (0,)}, ["modes", "at least 1"]),
        ({"kind": "rayleigh", "modes": (1, 9)}, ["no mode 9", "has 3"]),
        ({"kind": "rayleigh", "ratios": (0.1,)}, ["1 numbers for 2"]),
        ({"kind": "rayleigh", "ratios": (0.3, 0.0)}, ["adds energy", "modal"]),
        ({"kind": "source", "ratios": (0.3, 0.0)}, ["adds energy", "modal"]),
        ({"kind": "source", "ratios": (0.3,)}, ["two"]),
        ({"kind": "source-with-bearings", "ratios": (0.3,)}, ["two"]),
        ({"kind": "modal", "ratios": (0.1, 0.1)}, ["2 numbers", "3 mode"]),
        ({"kind": "modal", "ratios": (1.5,)}, ["less than 1"]),
        ({"kind": "modl"}, ["modal", "element"]),
    ],
)
def test_what_is_refused(damping: dict[str, Any], words: list[str]) -> None:
    with pytest.raises(InputError) as reported:
        prepared_with(PIER, **damping)
    for word in words:
        assert word in str(reported.value)


@pytest.mark.parametrize("kind", [*OWN, "source", "source-with-bearings"])
def test_balance_closes_with_every_kind(kind: DampingKind) -> None:
    ground = 2.0 * read_ground("jra-ii-i-1", 0.005, 10.0)
    constants = real_bearing("shen-lhdr-bridge")
    _, history = shaken("pier-p1", constants, ground, 0.005, damping=kind)
    assert history.outcome == "completed"
    assert energy_residual(history) < tol.STRUCTURE_BALANCE
    assert (history.rows.energies[-1].damping > 0.0) == (kind != "none")


def test_the_option_goes_before_the_structure() -> None:
    """By keyword and in the case; what the structure says holds where nothing else is said."""
    table = {"command": "bridge", "structure": "pier-p1", "motions": ["jra-ii-i-1"]}
    assert make_earthquake_case(table, "test").analysis.damping is None
    case = make_earthquake_case(table | {"analysis": {"damping": "element"}}, "test")
    assert case.analysis.damping == "element"
    with pytest.raises(InputError, match="damping"):
        make_earthquake_case(table, "test", damping="rayligh")
    kept = run.prepare_structure(load_structure("hybrid-pier"), "consistent", "source")
    assert_allclose(kept.ratios, [0.05, 0.05], rtol=1e-9)


def test_results_say_how_much_is_damped() -> None:
    """Share of the input, ratios, kind, and a warning where the share is large."""
    for kind, much in (("none", False), ("source", True)):
        result = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", -20, duration=8, damping=kind)
        summary, energy = result.summary(), result.energy.iloc[0]
        share = energy["damping_kN_mm"] / energy["input_kN_mm"]
        assert summary["damping"] == kind
        assert len(summary["damping_ratios"]) == 4
        assert math.isclose(summary["runs"][0]["damping_of_input"], share)
        assert (share > LARGEST_DAMPING_SHARE) == much
        assert any("damping" in text for text in summary["warnings"]) == much


def test_damping_of_the_structure_is_an_assumption_and_a_chosen_one_a_warning() -> None:
    for chosen in (None, "modal"):
        result = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", -20, duration=8, damping=chosen)
        assert result.table["damping_of_input"].max() > LARGEST_DAMPING_SHARE
        assert (result.damping_note in result.warnings) == (chosen is not None)
        told = [
            text
            for text in earthquake_report.build_pieces(result).assumptions
            if "input energy" in text
        ]
        assert len(told) == (chosen is None)


# Table 6.2 in kN, mm, s; coordinates in the order of the print: x_1, theta_2, x_3, theta_3.
L12, L3 = 10e3, 2e3
K_PIER, K_SIDE, K_ROCK = 34839e3 / 0.309e-2, 1397.0, 1.725e9
XI_PIER, XI_GROUND = 0.02, 0.10
PRINTED = ["deck x", "pier rotation", "footing x", "footing rotation"]


def printed(c1: float, c2: float, c3: tuple[float, float], *, signs: int) -> Floats:
    """Coefficients of the velocities, row by row; one letter c_3 stands for two ground springs.

    `signs` is +1 for the c_1 terms of Eq. 6.5-6.7 as printed, -1 for those that balance Eq. 6.4.
    """
    stretch = np.array([1.0, -L12, -1.0, -L3])  # x1' - x3' - theta3' l3 - theta2' (l1 + l2)
    between = np.array([0.0, 1.0, 0.0, -1.0])  # theta2' - theta3'
    return np.array(
        [
            c1 * stretch,  # 6.4
            signs * c1 * L12 * stretch + c2 * between,  # 6.5
            signs * c1 * stretch + c3[0] * np.array([0.0, 0.0, 1.0, 0.0]),  # 6.6
            signs * c1 * L3 * stretch - c2 * between + c3[1] * np.array([0.0, 0.0, 0.0, 1.0]),
        ]
    )


def frequencies_without_bearings() -> Floats:
    """Of theta_2, x_3, theta_3 with the masses of Table 6.2, and which part works in which mode."""
    places = [(140.0, 8900.0, 2000.0), (206.3, 3750.0, 2000.0), (227.5, 0.0, 1000.0)]
    mass = np.zeros((3, 3))
    for tonnes, on_pier, on_footing in places:
        row = np.array([on_pier, 1.0, on_footing])
        mass += 1e-3 * tonnes * np.outer(row, row)
    mass[2, 2] += 876.8e3  # t m2 = 1e3 kN s2 mm
    stiffness = np.array(
        [[K_PIER, 0.0, -K_PIER], [0.0, K_SIDE, 0.0], [-K_PIER, 0.0, K_PIER + K_ROCK]]
    )
    return np.asarray(np.sqrt(eigh(stiffness, mass, eigvals_only=True)))


def in_the_order_of_the_print(structure: Structure) -> Floats:
    prepared = run.prepare_structure(structure, "consistent", "element")
    order = [prepared.matrices.coordinates.index(name) for name in PRINTED]
    return prepared.damping[np.ix_(order, order)]


def dashpots() -> tuple[float, tuple[float, float]]:
    """c = 2 xi k/omega: rocking is mode 1, sideways mode 2, the pier mode 3."""
    rocking, sideways, pier = frequencies_without_bearings()
    c2 = 2.0 * XI_PIER * K_PIER / pier
    return c2, (2.0 * XI_GROUND * K_SIDE / sideways, 2.0 * XI_GROUND * K_ROCK / rocking)


@pytest.mark.parametrize("signs", [1, -1])
def test_the_matrix_is_the_printed_one(signs: int) -> None:
    """With the 0 % of Table 6.2 for the bearings it does not matter how c_1 is signed."""
    c2, c3 = dashpots()
    expected = printed(0.0, c2, c3, signs=signs)
    result = in_the_order_of_the_print(PIER)
    assert_allclose(result, expected, rtol=tol.LOOP, atol=tol.ROUNDING * np.abs(expected).max())


def test_bearings_with_a_ratio_have_c_1() -> None:
    """In the mode of the whole structure in which they store most, signed so that it damps."""
    line = PIER.bearings[0].model_copy(update={"damping_ratio": 0.03})
    structure = PIER.model_copy(update={"bearings": [line]})
    second = (
        2.0 * np.pi / run.prepare_structure(PIER).modes.periods[1]
    )  # in mode 1 the ground rocks
    c1 = 2.0 * 0.03 * 5 * 2.6153 / second
    c2, c3 = dashpots()
    expected = printed(c1, c2, c3, signs=-1)
    result = in_the_order_of_the_print(structure)
    assert_allclose(result, expected, rtol=tol.LOOP, atol=tol.ROUNDING * np.abs(expected).max())
    # As printed, Eq. 6.5-6.7 would push the pier with the force that holds the deck.
    scale = np.diag([1.0, 1.0 / L12, 1.0, 1.0 / L3])
    as_printed = scale @ printed(c1, 0.0, (0.0, 0.0), signs=1) @ scale
    assert np.linalg.eigvalsh(as_printed + as_printed.T)[0] < -c1


def test_bearings_alone_have_dashpots_too() -> None:
    """A structure on nothing but bearings: c = 2 xi k/omega of each line."""
    line = PIER.bearings[0].model_copy(update={"base": "ground", "damping_ratio": 0.05})
    deck = [body for body in PIER.bodies if body.name == "deck"]
    masses = [item for item in PIER.masses if item.body == "deck"]
    alone = PIER.model_copy(
        update={
            **{"bodies": deck, "masses": masses, "bearings": [line]},
            **{"springs": (), "hinges": (), "report": None},
        }
    )
    k = 5 * 2.6153
    omega = np.sqrt(k / 0.4)
    damping = run.prepare_structure(alone, "consistent", "element").damping
    assert_allclose(damping, [[2.0 * 0.05 * k / omega]], rtol=tol.LOOP)


DT = 0.005


def make_pier(counts: list[int]) -> Structure:
    """Pier P1 with its bearings in several lines."""
    structure = load_structure("pier-p1")
    line = structure.bearings[0]
    lines = [
        line.model_copy(update={"name": str(k), "count": count}) for k, count in enumerate(counts)
    ]
    return structure.model_copy(update={"bearings": lines})


def test_five_bearings_in_any_number_of_lines_are_the_same() -> None:
    ground = read_ground("jra-ii-i-1", DT, 8.0)
    constants = real_bearing("shen-lhdr-bridge")
    _, one = shaken(make_pier([5]), constants, ground, DT)
    compiled = len(newmark_march.signatures)  # type: ignore[attr-defined]
    for counts in ([2, 3], [1, 1, 1, 1, 1]):
        _, other = shaken(make_pier(counts), constants, ground, DT)
        assert_allclose(other.rows.q, one.rows.q, atol=tol.SAME_MOTION * np.abs(one.rows.q).max())
        for line in range(len(counts)):
            warmed = one.layers().max() - one.layers().min()
            assert_allclose(other.layers(line), one.layers(), atol=tol.SAME_MOTION * warmed)
        assert_array_equal(other.bearing(1)["force"], other.bearing(0)["force"])
    assert len(newmark_march.signatures) == compiled  # type: ignore[attr-defined]


def test_lines_start_at_temperatures_of_their_own() -> None:
    ground = read_ground("jra-ii-i-1", DT, 4.0)
    constants = real_bearing("shen-hdr-bridge")
    cells = len(constants.cells.capacity)
    lines = [run.Line(constants, np.full(cells, t)) for t in (-20.0, 20.0)]
    history = run.run_structure(
        run.prepare_structure(make_pier([2, 3])), lines, ground, DT, np.zeros(len(ground) - 1)
    )
    assert_array_equal(history.layers(0)[0], -20.0)
    assert_array_equal(history.layers(1)[0], 20.0)
    cold, warm = (np.abs(history.bearing(line)["force"]).max() for line in (0, 1))
    assert cold > warm


def test_lines_of_one_kind_share_their_constants() -> None:
    a, b = linear_bearing(1.0), real_bearing("shen-hdr-bridge")
    starts = [np.full(len(one.cells.capacity), 7.0) for one in (a, b, a)]
    kinds = build_bearings([a, b, a], starts, [None, None, None])
    assert [list(kind.lines) for kind in kinds] == [[0, 2], [1]]
    assert kinds[0].constants is a
    assert kinds[0].states.temperature.shape == (2, len(a.cells.capacity))
    assert kinds[1].states.temperature.shape == (1, len(b.cells.capacity))


def shake_unlike_lines() -> tuple[run.StructureHistory, run.StructureHistory]:
    structure, ground = make_pier([1, 1]), read_ground("jra-ii-i-1", DT, 0.3)
    both = [linear_bearing(4.0), linear_bearing(9.0)]
    prepared = run.prepare_structure(structure)

    def shake(lines: list[run.Line]) -> run.StructureHistory:
        return run.run_structure(prepared, lines, ground, DT, np.zeros(len(ground) - 1))

    start: Floats = np.zeros(len(both[0].cells.capacity))
    mean = linear_bearing(6.5)
    return shake([run.Line(one, start) for one in both]), shake([run.Line(mean, start)] * 2)


@pytest.mark.thorough
def test_lines_of_several_kinds() -> None:
    """As plain Python: compiling for a second kind takes longer than all other tests here."""
    code = "from tests.unit.test_structure_matrices import check_unlike_lines; check_unlike_lines()"
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr


def check_unlike_lines() -> None:
    unlike, alike = shake_unlike_lines()
    largest = np.abs(alike.rows.q).max()
    assert largest > 0.0
    assert_allclose(unlike.rows.q, alike.rows.q, atol=tol.SAME_MOTION * largest)
    forces = [np.abs(unlike.bearing(line)["force"]).max() for line in (0, 1)]
    assert_allclose(forces[1] / forces[0], 9.0 / 4.0, rtol=tol.SAME_MOTION)
    assert unlike.layers(1).shape == alike.layers(1).shape


def test_show_writes_parts_periods_and_figures(tmp_path: Path) -> None:
    out = tmp_path / "pier"
    done = command("structures", "show", "pier-p1", "-o", str(out), "--json")
    assert done.exit_code == 0
    assert last_line(done)["outcome"] == "completed"
    files = {path.name for path in out.rglob("*") if path.is_file()}
    assert {"summary.json", "parts.csv", "periods.csv", "model.png", "modes.png"} <= files
    reported = json.loads((out / "summary.json").read_text())
    assert reported["structure"] == "pier-p1"
    assert reported["reported_line"] == "G1-G5"
    assert_allclose(reported["mass_t"], 973.8)
    assert [mode["mode"] for mode in reported["modes"]] == [1, 2, 3, 4]
    assert "pier base" in done.stdout
    assert load_structure(out / "case.resolved.toml") == load_structure("pier-p1")


@pytest.mark.thorough
def test_show_draws_a_structure_in_plan(tmp_path: Path) -> None:
    """Places of all parts, effective masses per direction, and the plan; and a report of it."""
    out = tmp_path / "bridge"
    assert command("structures", "show", "five-span-bridge", "-o", str(out)).exit_code == 0
    assert {path.stem for path in (out / "figures").iterdir()} == {"model", "plan", "modes"}
    parts = pd.read_csv(out / "parts.csv").query("part == 'bearings'")
    assert parts["x_mm"].tolist() == [0.0, 4e4, 8e4, 12e4, 16e4, 20e4]
    modes = pd.read_csv(out / "periods.csv").filter(like="effective_mass_")
    assert_allclose(modes.sum(), 1.0, rtol=1e-5)
    assert load_structure(out / "case.resolved.toml") == load_structure("five-span-bridge")
    output = " ".join(build_pieces(read_saved(out)).answer)
    assert "across" in output


def test_show_without_a_directory_and_a_bad_name(tmp_path: Path) -> None:
    done = command("structures", "show", "hybrid-pier", "--json")
    assert last_line(done)["modes"][0]["mode"] == 1
    own = tmp_path / "two.toml"
    own.write_text(to_toml(make_bridge(two_piers())))
    for words, output in (
        (["pier-p2"], '"pier-p1"'),
        (["pier-p1", "--mass", "heavy"], "mass = 'heavy'"),
        ([str(own), "--fixed-base"], "springs"),
    ):
        done = command("structures", "show", *words)
        assert done.exit_code == 2
        assert output in done.stderr


def test_effective_masses_are_all_mass_that_moves() -> None:
    result = tb.examine_structure(make_bridge(two_piers()))
    assert_allclose(result.table["effective_mass"].sum(), 1.0, rtol=1e-9)
    shapes = result.table[result.prepared.matrices.coordinates].to_numpy()
    assert_allclose(np.abs(shapes).max(axis=1), 1.0)
    assert isinstance(result.parts, pd.DataFrame)
    assert set(result.parts["part"]) == {"mass", "spring", "hinge", "bearings"}


ON_THE_GROUND = """name = "mass"
[[bodies]]
name = "deck"
moves = true
[[masses]]
body = "deck"
height = "0 m"
mass = "200 t"
[[bearings]]
name = "bearings"
body = "deck"
base = "ground"
count = 4
equivalent_stiffness = "2 kN/mm"
[report]
deck = "deck"
"""


def test_a_mass_on_the_ground_has_no_pier(tmp_path: Path) -> None:
    path = tmp_path / "mass.toml"
    path.write_text(ON_THE_GROUND)
    assert load_structure(path).report.pier == "ground"
    words = ["bridge", "--structure", str(path), "--bearing", "shen-hdr-bridge", "--ambient", "0"]
    words += ["--motion", "jra-ii-i-1", "--duration", "0.5", "-o", str(tmp_path / "out")]
    done = command(*words)
    assert done.exit_code == 0, done.output
    assert "pier" not in done.stdout
    assert "ductility" not in done.stdout
    text = path.read_text()
    path.write_text(
        text.replace(
            'name = "deck"\n', 'name = "pier"\nmoves = true\n[[bodies]]\nname = "deck"\n'
        ).replace('"ground"', '"pier"')
    )
    with pytest.raises(tb.InputError, match=r"report\.pier \(the body that is the pier\)"):
        load_structure(path)


@pytest.mark.thorough
@pytest.mark.parametrize("lines", quick_cases([1, 2], 1))
def test_nothing_is_said_of_a_pier_on_the_ground(tmp_path: Path, lines: int) -> None:
    """Neither in columns of a history, nor in captions, notes and heads of a report and figures."""
    table = tomllib.loads(ON_THE_GROUND)
    table["bearings"] += [{**table["bearings"][0], "name": "more"}] * (lines - 1)
    path = write_toml(tmp_path / "mass.toml", table)
    result = tb.bridge(
        "shen-hdr-bridge", ["jra-ii-i-1", "jra-ii-i-2"], 0, structure=path, duration=0.5
    )
    columns = list(result.history(0))
    assert "deck_acceleration_m_s2" in columns
    assert not any(part in name for name in columns for part in ("pier", "ground_displacement"))
    pieces = earthquake_report.build_pieces(result)
    texts = [figure.caption + figure.alt for figure in pieces.figures.values()]
    for one in pieces.tables.values():
        texts += [one.caption, one.note, *(column.head for column in one.columns)]
    texts += [*pieces.answer, result.plot.peaks().get_suptitle()]
    assert not [text for text in texts if "pier" in text.lower()]
