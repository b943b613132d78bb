"""Viscous damping of structures by hand: where it acts, which ratios it gives, what is refused."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.test_structure_by_hand import two_springs
from tests.verification.structures import ground_of, real_bearing, shaken
from tests.verification.test_structures import residual
from thermobearing.border.errors import InputError
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.earthquake.result import LARGEST_DAMPING_SHARE
from thermobearing.structure.matrices import bare_modes, mode_damping
from thermobearing.structure.model import Damping, DampingKind, Structure, load_structure
from thermobearing.structure.run import Prepared, prepare_structure

PIER = load_structure("pier-p1")
OWN: tuple[DampingKind, ...] = ("modal", "rayleigh", "element", "none")


def prepared_with(structure: Structure, **damping: Any) -> Prepared:
    return prepare_structure(structure.model_copy(update={"damping": Damping(**damping)}))


def without_ratio(structure: Structure) -> Structure:
    """Bearings with 0 %, as in Table 6.2; with more, "element" has c_1 (test_dashpots.py)."""
    lines = [line.model_copy(update={"damping_ratio": 0.0}) for line in structure.bearings]
    return structure.model_copy(update={"bearings": lines})


def bare_ratios(prepared: Prepared) -> np.ndarray:
    """Ratios of the modes without the bearings."""
    modes = bare_modes(prepared.structure, prepared.matrices)
    return mode_damping(prepared.damping, modes)


@pytest.mark.parametrize("kind", OWN)
@pytest.mark.parametrize("mass", ["consistent", "published"])
def test_nothing_damps_the_deck(kind: DampingKind, mass: Any) -> None:
    """No dashpot from the deck to the ground, none across the bearings."""
    damping = prepare_structure(PIER, mass, kind).damping
    assert np.abs(damping[0]).max() <= 1e-9 * np.abs(damping).max()
    assert_allclose(damping, damping.T, atol=1e-12 * np.abs(damping).max())


def test_the_source_damps_the_deck() -> None:
    """Section 6.2.3: modes 1 and 2 get their ratios; modes 3 and 4 what comes of it."""
    prepared = prepare_structure(PIER, "consistent", "source")
    assert prepared.damping[0, 0] > 0.0
    assert_allclose(prepared.ratios, [0.0609, 0.0333, 0.332, 0.610], rtol=2e-3)
    given = prepared_with(two_springs(), kind="source", ratios=(0.03, 0.07))
    assert_allclose(given.ratios, [0.03, 0.07], rtol=1e-9)
    assert given.damping[0, 1] == 0.0


def test_modal_ratios_are_those_of_the_parts() -> None:
    """Of a pier on two springs: (0.02 100 + 0.10 300)/400 in its one mode."""
    assert_allclose(bare_ratios(prepared_with(two_springs(), kind="modal")), [0.08])
    assert_allclose(bare_ratios(prepared_with(two_springs(), kind="modal", ratios=(0.03,))), [0.03])
    given = prepared_with(PIER, kind="modal", ratios=(0.01, 0.02, 0.03))
    assert_allclose(bare_ratios(given), [0.01, 0.02, 0.03], rtol=1e-9)


def test_rayleigh_goes_through_the_chosen_modes() -> None:
    """a/(2 omega) + b omega/2; through one mode it is b K' alone."""
    own = bare_ratios(prepare_structure(PIER))
    w = bare_modes(PIER, prepare_structure(PIER).matrices).frequencies
    for first, second in ((0, 1), (0, 2)):
        found = bare_ratios(prepared_with(PIER, kind="rayleigh", modes=(first + 1, second + 1)))
        assert_allclose(found[[first, second]], own[[first, second]], rtol=1e-9)
        rates = 2.0 * own * w
        b = (rates[second] - rates[first]) / (w[second] ** 2 - w[first] ** 2)
        a = rates[first] - b * w[first] ** 2
        assert_allclose(found, 0.5 * (a / w + b * w), rtol=1e-9)
    alone = prepared_with(two_springs(), kind="rayleigh", modes=(1,), ratios=(0.05,))
    assert_allclose(alone.damping, np.diag([0.0, 2.0 * 0.05 / 20.0 * 400.0]), atol=1e-12)


def test_dashpots_beside_the_parts() -> None:
    """c = 2 xi k/omega, omega that of the pier alone: 20/s."""
    damping = prepared_with(without_ratio(two_springs()), kind="element").damping
    assert_allclose(damping, np.diag([0.0, 0.1 * (0.02 * 100.0 + 0.10 * 300.0)]), atol=1e-12)
    pier = prepare_structure(PIER, "consistent", "element")
    w = bare_modes(PIER, pier.matrices).frequencies
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
        assert not prepare_structure(floating, "consistent", kind).damping.any()


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
        ({"kind": "rayleigh", "ratios": (0.3, 0.0)}, ["feeds energy", "modal"]),
        ({"kind": "source", "ratios": (0.3, 0.0)}, ["feeds energy", "modal"]),
        ({"kind": "source", "ratios": (0.3,)}, ["two"]),
        ({"kind": "modal", "ratios": (0.1, 0.1)}, ["2 numbers", "3 mode"]),
        ({"kind": "modal", "ratios": (1.5,)}, ["less than 1"]),
        ({"kind": "modl"}, ["modal", "element"]),
    ],
)
def test_what_is_refused(damping: dict[str, Any], words: list[str]) -> None:
    with pytest.raises(InputError) as told:
        prepared_with(PIER, **damping)
    for word in words:
        assert word in str(told.value)


@pytest.mark.parametrize("kind", [*OWN, "source"])
def test_books_close_with_every_kind(kind: DampingKind) -> None:
    ground = 2.0 * ground_of("jra-ii-i-1", 0.005, 10.0)
    constants = real_bearing("shen-lhdr-bridge")
    _, history = shaken("pier-p1", constants, ground, 0.005, damping=kind)
    assert history.outcome == "completed"
    assert residual(history) < tol.STRUCTURE_BOOKS
    assert (history.rows.books[-1].damping > 0.0) == (kind != "none")


def test_the_option_goes_before_the_structure() -> None:
    """By keyword and in the case; what the structure says holds where nothing else is said."""
    table = {"command": "bridge", "structure": "pier-p1", "motions": ["jra-ii-i-1"]}
    assert make_earthquake_case(table, "test").analysis.damping is None
    case = make_earthquake_case(table | {"analysis": {"damping": "element"}}, "test")
    assert case.analysis.damping == "element"
    with pytest.raises(InputError, match="damping"):
        make_earthquake_case(table, "test", damping="rayligh")
    kept = prepare_structure(load_structure("hybrid-pier"), "consistent", "source")
    assert_allclose(kept.ratios, [0.05, 0.05], rtol=1e-9)


def test_results_say_how_much_is_damped() -> None:
    """Share of the input, ratios, kind, and a warning where the share is large."""
    shares = {}
    for kind in ("none", "source"):
        result = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", -20, duration=8, damping=kind)
        told, energy = result.summary(), result.energy.iloc[0]
        share = energy["damping_kN_mm"] / energy["input_kN_mm"]
        assert told["damping"] == kind
        assert len(told["damping_ratios"]) == 4
        assert math.isclose(told["runs"][0]["damping_of_input"], share)
        shares[kind] = share
        damped = [text for text in told["warnings"] if "damping" in text]
        assert bool(damped) == (share > LARGEST_DAMPING_SHARE)
        assert told["warnings"] == result.warnings
    assert shares["none"] == 0.0
    assert shares["source"] > LARGEST_DAMPING_SHARE
    assert "source" in damped[0]
    assert "1 of 1 runs" in damped[0]
