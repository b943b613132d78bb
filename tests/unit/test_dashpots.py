"""`damping = "element"`: the dashpots c_1, c_2, c_3 of Eq. 6.4-6.7, typed from the print."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from scipy.linalg import eigh

from tests import tolerances as tol
from thermobearing.structure.model import Structure, load_structure
from thermobearing.structure.run import prepare_structure

Floats = NDArray[np.float64]
PIER = load_structure("pier-p1")
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
    prepared = prepare_structure(structure, "consistent", "element")
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
    found = in_the_order_of_the_print(PIER)
    assert_allclose(found, expected, rtol=tol.LOOP, atol=tol.ROUNDING * np.abs(expected).max())


def test_bearings_with_a_ratio_have_c_1() -> None:
    """In the mode of the whole structure in which they store most, signed so that it damps."""
    line = PIER.bearings[0].model_copy(update={"damping_ratio": 0.03})
    structure = PIER.model_copy(update={"bearings": [line]})
    second = 2.0 * np.pi / prepare_structure(PIER).modes.periods[1]  # in mode 1 the ground rocks
    c1 = 2.0 * 0.03 * 5 * 2.6153 / second
    c2, c3 = dashpots()
    expected = printed(c1, c2, c3, signs=-1)
    found = in_the_order_of_the_print(structure)
    assert_allclose(found, expected, rtol=tol.LOOP, atol=tol.ROUNDING * np.abs(expected).max())
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
    damping = prepare_structure(alone, "consistent", "element").damping
    assert_allclose(damping, [[2.0 * 0.05 * k / omega]], rtol=tol.LOOP)
