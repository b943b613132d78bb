"""Structures in plan: modes of a deck with an eccentric mass, kinetic energy, one direction."""

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests import tolerances as tol
from tests.conftest import Recorder
from tests.verification.structures import read_ground, real_bearing, shaken
from thermobearing.border.errors import InputError
from thermobearing.border.schema import validated
from thermobearing.border.toml import to_table
from thermobearing.core.types import Floats
from thermobearing.structure.matrices import build_matrices, displacement_row, line_stiffness
from thermobearing.structure.model import DIRECTIONS, Structure, along, load_structure
from thermobearing.structure.report import EFFECTIVE_MASSES
from thermobearing.structure.result import examine_structure
from thermobearing.structure.run import prepare_structure

ECCENTRICITY = 3000.0  # mm, from the centre of mass to the centre of stiffness


def eccentric_deck(reference: float = 0.0) -> Structure:
    """A rigid deck of 20 m by 10 m on four lines of springs, its mass 3 m from their centre."""
    corners = [(x, y) for x in (-10, 10) for y in (-5, 5)]
    return validated(
        Structure,
        {
            "name": "one storey",
            "plan": True,
            "bodies": [{"name": "deck", "moves": True, "twists": True, "x": f"{reference} mm"}],
            "masses": [
                {
                    **{"body": "deck", "height": "0 m", "mass": "400 t"},
                    **{"x": f"{-ECCENTRICITY} mm", "y": "0 m", "twist_inertia": "16e3 t m^2"},
                }
            ],
            "bearings": [
                {
                    **{"name": f"({x}, {y})", "body": "deck", "count": 2},
                    **{"equivalent_stiffness": "2.5 kN/mm", "x": f"{x} m", "y": f"{y} m"},
                }
                for x, y in corners
            ],
            "report": {"deck": "deck"},
        },
        "test",
    )


@pytest.mark.parametrize("reference", [0.0, -7000.0])
def test_modes_of_an_eccentric_deck(reference: float, measured: Recorder) -> None:
    """One storey with its stiffness eccentric in one direction (Chopra, Dynamics of Structures).

    With w_y^2 = k_y/m and w_t^2 = k_t/(m r^2), k_t about the centre of mass, the coupled modes
    have w^2 = [w_y^2 + w_t^2 -+ sqrt((w_y^2 - w_t^2)^2 + 4 (e/r)^2 w_y^4)]/2. Where the reference
    point of the deck is does not matter.
    """
    mass, inertia, k = 0.4, 16e6, 4 * 2 * 2.5
    turning = k * (10e3**2 + 5e3**2) + k * ECCENTRICITY**2
    sideways, twist = k / mass, turning / inertia
    root = np.hypot(sideways - twist, 2.0 * sideways * ECCENTRICITY / np.sqrt(inertia / mass))
    squares = np.sort([sideways, *(0.5 * (sideways + twist + sign * root) for sign in (-1, 1))])
    result = examine_structure(eccentric_deck(reference))
    actual = result.prepared.modes.frequencies
    worst = float(np.abs(actual / np.sqrt(squares) - 1.0).max())
    if reference:
        measured("modes of an eccentric deck, error of w", f"{worst:.1e}", f"{tol.LOOP:g}")
    assert worst < tol.LOOP
    assert_allclose(result.table[list(EFFECTIVE_MASSES)].sum(), 1.0, rtol=tol.LOOP)


def footing_and_pier() -> Structure:
    """A footing that moves, rocks and twists, a pier that rocks on it, and a deck that twists."""
    return validated(
        Structure,
        {
            "name": "everything",
            "plan": True,
            "bodies": [
                {"name": "deck", "moves": True, "twists": True, "x": "20 m", "y": "-1 m"},
                {
                    **{"name": "footing", "moves": True, "rotates": True, "twists": True},
                    **{"base_height": "-2 m", "x": "3 m", "y": "2 m"},
                },
                {"name": "pier", "on": "footing", "rotates": True, "x": "4 m", "y": "2.5 m"},
            ],
            "masses": [
                {"body": "deck", "height": "10 m", "mass": "300 t", "x": "24 m", "y": "1 m"},
                {"body": "deck", "height": "10 m", "mass": "100 t", "x": "15 m", "y": "-3 m"},
                {"body": "footing", "height": "-1 m", "mass": "200 t", "x": "2 m"},
                {"body": "footing", "height": "-1 m", "mass": "50 t", "y": "7 m"},
                {"body": "pier", "height": "8.9 m", "mass": "140 t", "y": "4 m"},
                {"body": "pier", "height": "3.75 m", "mass": "206.3 t"},
            ],
            "springs": [
                {"name": "ground", "body": "footing", "height": "-2 m", "stiffness": "900 kN/mm"},
                {"name": "rocking", "body": "footing", "rotational_stiffness": "2e6 kN m/rad"},
                {
                    **{"name": "twist", "body": "footing", "direction": "twist"},
                    **{"rotational_stiffness": "2e6 kN m/rad"},
                },
            ],
            "hinges": [
                {
                    **{"name": "pier base", "body": "pier", "base": "footing"},
                    **{"yield_moment": "34839 kN m", "yield_rotation": "0.00309 rad"},
                }
            ],
            "bearings": [
                {
                    **{"name": "on pier", "body": "deck", "base": "pier", "height": "10 m"},
                    **{"height_across": "12.5 m", "count": 5, "equivalent_stiffness": "2.6 kN/mm"},
                },
                {
                    **{"name": "abutment", "body": "deck", "height": "10 m", "x": "40 m"},
                    **{"count": 5, "equivalent_stiffness": "2.6 kN/mm"},
                },
            ],
            "report": {"deck": "deck", "pier": "pier", "pier_base": "footing", "pier_top": "10 m"},
        },
        "test",
    )


def turned(twist: float, arm: tuple[float, float]) -> Floats:
    """An arm in plan after a finite rotation about the vertical, less the arm."""
    cos, sin = np.cos(twist), np.sin(twist)
    return np.array([[cos - 1.0, -sin], [sin, cos - 1.0]]) @ arm


def point_motion(name: str, q: dict[str, float], x: float, y: float, height: float) -> Floats:
    """Displacement of a point of a body of `footing_and_pier` from geometry, for rocking small."""
    if name == "deck":
        own = np.array([q["deck x"], q["deck y"]])
        return own + turned(q["deck twist"], (x - 20e3, y + 1e3))
    foot = np.array([q["footing x"], q["footing y"]])
    leans = np.array([q["footing rotation x"], q["footing rotation y"]])
    if name == "footing":
        arm = (x - 3e3, y - 2e3)
        return np.asarray(foot + (height + 2e3) * np.sin(leans) + turned(q["footing twist"], arm))
    hinge = point_motion("footing", q, 4e3, 2.5e3, 0.0)
    leans = np.array([q["pier rotation x"], q["pier rotation y"]])
    arm = (x - 4e3, y - 2.5e3)
    return np.asarray(hinge + height * np.sin(leans) + turned(q["footing twist"], arm))


def test_mass_matrix_is_the_kinetic_energy_of_points() -> None:
    """Speeds of the masses by central differences of their places, and the load likewise."""
    structure = footing_and_pier()
    matrices = build_matrices(structure)
    names = matrices.coordinates
    assert names[:4] == ["deck x", "deck y", "deck twist", "footing x"]
    rates = np.random.default_rng(4).normal(size=len(names))
    rates *= [1.0 if name.endswith(("k x", "k y", "g x", "g y")) else 1e-4 for name in names]
    step = 1e-3
    places = [dict(zip(names, sign * step * rates, strict=True)) for sign in (1.0, -1.0)]
    energy, momentum = np.zeros(()), np.zeros(2)
    for item in structure.masses:
        ends = [point_motion(item.body, q, *structure.point(item), item.height) for q in places]
        speed = (ends[0] - ends[1]) / (2.0 * step)
        energy += 0.5 * item.mass * speed @ speed
        momentum += item.mass * speed
    assert_allclose(0.5 * rates @ matrices.mass @ rates, energy, rtol=tol.LOOP)
    assert_allclose(-(rates @ matrices.load), momentum, rtol=tol.LOOP)
    assert_allclose(matrices.mass, matrices.mass.T)
    shares = examine_structure(structure).table[list(EFFECTIVE_MASSES)]
    assert_allclose(shares.sum(), 1.0, rtol=1e-9)


def test_stretches_and_hinges_in_plan() -> None:
    """Stretch along at the height of the line, across at its own height; two hinges."""
    structure = footing_and_pier()
    matrices = build_matrices(structure)
    q = np.random.default_rng(5).normal(size=len(matrices.coordinates)) * 1e-10
    named = dict(zip(matrices.coordinates, q, strict=True))
    for b, (x, y) in enumerate(((4e3, 2.5e3), (40e3, -1e3))):
        wanted = [
            point_motion("deck", named, x, y, 10e3)[k]
            - (0.0 if b else point_motion("pier", named, x, y, height)[k])
            for k, height in enumerate((10e3, 12.5e3))
        ]
        assert_allclose(np.tensordot(q, matrices.line_rows[b], 1), wanted, rtol=1e-6)
    wanted = [named[f"pier rotation {way}"] - named[f"footing rotation {way}"] for way in "xy"]
    assert_allclose(matrices.hinge_rows @ q, wanted)
    assert displacement_row(structure, "ground", 5.0).shape == (len(q), 2)
    each = np.array([1.0, 3.0])  # kN/mm, of one of five bearings
    stretches = np.tensordot(matrices.line_rows, q, (1, 0))
    energy = 0.5 * 5.0 * each @ np.square(stretches).sum(axis=1)
    assert_allclose(0.5 * q @ line_stiffness(structure, matrices, each) @ q, energy)


def test_a_symmetric_structure_has_the_modes_of_one_direction() -> None:
    """Pier P1 in plan: its own modes twice, and damping ratios too; along one direction: itself."""
    line = prepare_structure(load_structure("pier-p1"))
    plan = line.structure.model_copy(update={"plan": True})
    both = prepare_structure(plan)
    assert_allclose(both.modes.periods, np.repeat(line.modes.periods, 2), rtol=tol.LOOP)
    assert_allclose(both.ratios, np.repeat(line.ratios, 2), rtol=1e-6, atol=1e-12)
    for way in DIRECTIONS:
        alone = prepare_structure(along(plan, way))
        assert alone.matrices.coordinates == line.matrices.coordinates
        for name in ("mass", "load", "springs", "hinge_rows", "line_rows", "device_rows"):
            result, wanted = (getattr(one.matrices, name) for one in (alone, line))
            assert np.array_equal(result, wanted)


def test_across_the_bridge_the_force_acts_higher() -> None:
    """`height_across` is the height of the line in a unidirectional analysis across."""
    structure = footing_and_pier()
    plan = build_matrices(structure)
    for column, way in enumerate(DIRECTIONS):
        one = build_matrices(along(structure, way))
        own = [
            plan.coordinates.index(name if name.endswith(" x") else f"{name} x")
            for name in one.coordinates
        ]
        own = [place + column for place in own]
        assert_allclose(one.line_rows, plan.line_rows[:, own, column])
        assert_allclose(one.springs, plan.springs[np.ix_(own, own)])
        assert_allclose(one.load, plan.load[own, column])


@pytest.mark.parametrize(
    ("part", "changes", "message"),
    [
        ("", {"plan": False}, "bearings[0].y: for a structure in plan; add plan"),
        (
            "bearings",
            {"x": "1 m", "y": "1 m"},
            'body "deck" twists, and all that holds it is at one',
        ),
        ("masses", {"twist_inertia": "0 t m^2", "x": "0 m"}, "add a mass or twist_inertia"),
        ("masses", {"twist_inertia": "0 t m^2", "x": "9 m"}, '"deck twist" moves no mass; give'),
        ("springs", {"direction": "up"}, "'x', 'y' or 'twist'"),
        ("springs", {"direction": "twist"}, "takes rotational_stiffness"),
        ("bodies", {"x": 5.0}, 'write "5.0 mm"'),
    ],
)
def test_bad_plans_are_refused(part: str, changes: dict[str, Any], message: str) -> None:
    spring = {"name": "a", "body": "deck", "stiffness": "1 kN/mm", "x": "1 m", "y": "1 m"}
    table = to_table(eccentric_deck()) | {"springs": [spring]}
    if part:
        table[part] = [item | changes for item in table[part]]
    else:
        table |= changes
    with pytest.raises(InputError) as error:
        prepare_structure(validated(Structure, table, "test"))
    assert message in str(error.value)


def test_a_mechanism_names_what_meets_no_stiffness() -> None:
    """Springs in one direction hold no deck; lines through one point hold no twist."""
    deck = eccentric_deck()
    weak = [
        line.model_copy(update={"x": 0.0, "y": 0.0, "equivalent_stiffness": 1.0})
        for line in deck.bearings
    ]
    with pytest.raises(InputError, match='the motion of "deck twist" meets no stiffness'):
        prepare_structure(deck.model_copy(update={"bearings": weak}))
    pier = footing_and_pier()
    held = [spring.model_copy(update={"direction": "x"}) for spring in pier.springs[:2]]
    with pytest.raises(InputError) as error:
        prepare_structure(pier.model_copy(update={"springs": (*held,)}))
    assert '"footing rotation y"' in str(error.value)
    assert '"footing x"' not in str(error.value)


def test_the_bridge_in_plan_moves_like_pier_p1(measured: Recorder) -> None:
    """Without its abutments and end spans, the deck moves along as that of pier P1 does.

    Periods and modal damping of pier P1 are those of the bridge then, and a motion along it moves
    every bearing and hinge as those of pier P1. The abutments hold the bridge stiffer.
    """
    bridge, pier = load_structure("five-span-bridge"), load_structure("pier-p1")
    lines = [line for line in bridge.bearings if line.base != "ground"]
    assert [bridge.point(line)[0] for line in lines] == [4e4, 8e4, 12e4, 16e4]
    deck = bridge.masses[0].model_copy(update={"mass": len(lines) * pier.masses[0].mass})
    changes = {"bearings": lines, "masses": [deck, *bridge.masses[1:]]}
    alone = along(bridge.model_copy(update=changes), "x")
    own, whole = prepare_structure(pier), prepare_structure(alone)
    nearest = np.abs(whole.modes.periods[:, None] / own.modes.periods - 1.0).argmin(axis=0)
    assert_allclose(whole.modes.periods[nearest], own.modes.periods, rtol=tol.LOOP)
    assert_allclose(whole.ratios[nearest[0]], own.ratios[0], rtol=1e-9)
    constants, ground = real_bearing("shen-lhdr-bridge"), read_ground("jra-ii-i-1", 0.005, 9.0)
    _, one = shaken(pier, constants, ground, 0.005)
    _, all_piers = shaken(alone, constants, ground, 0.005)
    worst = 0.0
    for k in range(len(lines)):
        for result, wanted in (
            (all_piers.bearing(k)["force"], one.bearing()["force"]),
            (all_piers.hinge(k)["rotation"], one.hinge()["rotation"]),
        ):
            worst = max(worst, float(np.abs(result - wanted).max() / np.abs(wanted).max()))
    measured(
        "piers of the bridge in plan and pier P1, without abutments",
        f"{worst:.1e}",
        f"{tol.SAME_MOTION:g}",
    )
    assert worst < tol.SAME_MOTION
    table = examine_structure(bridge).table
    first = {way: table.loc[table[f"effective_mass_{way}"].idxmax()] for way in ("x", "y", "twist")}
    periods = {way: float(row["period_s"]) for way, row in first.items()}
    measured(
        "first periods of the bridge in plan along, across, in twist; of pier P1",
        ", ".join(f"{period:.3f} s" for period in (*periods.values(), own.modes.periods[0])),
        "no limit",
    )
    assert periods["twist"] < periods["x"] < periods["y"] < own.modes.periods[0]
