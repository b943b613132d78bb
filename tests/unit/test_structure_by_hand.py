"""Matrices, damping and laboratories of structures by hand."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.border.schema import validated
from thermobearing.structure.matrices import (
    Modes,
    build_matrices,
    displacement_row,
    find_modes,
    hinge_stiffness,
    line_parts,
    line_stiffness,
    own_parts,
    weighed_ratios,
)
from thermobearing.structure.model import Structure, load_structure
from thermobearing.structure.run import prepare_structure

PIER = load_structure("pier-p1")


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


def test_periods_are_those_of_the_frequencies() -> None:
    modes = find_modes(np.diag([2.0, 0.5]), np.diag([8.0, 50.0]))
    assert_allclose(modes.frequencies, [2.0, 10.0])
    assert_allclose(modes.periods, [np.pi, 0.2 * np.pi])
    assert_allclose(Modes(np.array([2.0 * np.pi]), np.eye(1)).periods, [1.0])


def two_springs() -> Structure:
    """A deck on a bearing line; a pier on two springs of unlike damping."""
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
    prepared = prepare_structure(structure)
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
    parts = [*own_parts(structure, matrices), *line_parts(structure, matrices)]
    assert_allclose(weighed_ratios(parts, prepared.modes), wanted)
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
def test_actuator_is_where_it_was_told_to_be_a_delay_ago(steps: float, tmp_path: Path) -> None:
    """The specimen of 1/6 follows deck less pier, late by a part of a step or by more."""
    dt, count = 0.005, 160
    time = dt * np.arange(count)
    path = motion_file(tmp_path, 300.0 * np.sin(2.0 * np.pi * 1.5 * time))
    lab = {"delay": f"{1e3 * steps * dt} ms"}
    study = tb.hybrid("shen-hdr-specimen", path, 23.0, laboratory=lab, keep=tb.Keep(every=1))
    assert study.outcome == "completed"
    told = (study["deck_displacement"] - study["pier_top_displacement"]).values[0] / 6.0
    late = np.interp(study["time"].values[0] - steps * dt, study["time"].values[0], told)
    found = study["bearing_displacement"].values[0]
    assert np.abs(found).max() > 2.0
    # What was told is the prediction of a step, before it was corrected.
    assert np.abs(found - late).max() < tol.DELAYED * np.abs(found).max()
