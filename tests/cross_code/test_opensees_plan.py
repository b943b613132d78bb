"""A rigid deck that twists on bearings in a plane, here and in OpenSees, in a recorded pair."""

from collections.abc import Callable

import numpy as np
import pytest

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.opensees import analyse, needs_opensees, ops
from tests.shared_data import shared_data
from tests.verification.structures import AMBIENT, real_bearing
from tests.verification.test_structures_in_plan import eccentric_deck
from thermobearing.core.types import Constants, Floats
from thermobearing.model.earlier import BilinearParameters, bilinear_constants
from thermobearing.structure import run

pytestmark = needs_opensees

DT = 0.005  # s
DECK = eccentric_deck()
COUNT = DECK.bearings[0].count
BEARING = "shen-hdr-bridge"
MASTER, CENTRE = 1, 2  # nodes: of the mass, and at the origin
STIFF, SOFT = 1, 2  # materials
Pairs = list[tuple[int, int]]


def kobe(first: int, steps: int) -> Floats:
    """North-south and east-west components of JMA Kobe 1995 [steps + 1, 2] in mm/s2."""
    record = np.loadtxt(shared_data("motions/jma_kobe_ns_ew_gal_dt0.005.txt"), comments="%")
    grown = np.minimum(1.0, 0.05 * np.arange(steps + 1))[:, None]
    return np.asarray(10.0 * grown * record[first : first + steps + 1])


def ours(constants: list[Constants], ground: Floats) -> Floats:
    """Return histories of the deck at the origin (x, y, twist), and of the lines in x and y.

    Displacements of the lines come first, forces of their bearings together after them.
    """
    lines = [run.Line(one, np.full(len(one.cells.capacity), AMBIENT), None) for one in constants]
    prepared = run.prepare_structure(DECK, "consistent", "none")
    air = np.full(len(ground) - 1, AMBIENT)
    history = run.run_structure(prepared, lines, ground, DT, air)
    assert history.outcome == "completed"
    responses = [history.bearing(line) for line in range(len(lines))]
    moved = [np.asarray(one["displacement"]) for one in responses]
    forces = [COUNT * np.asarray(one["force"]) for one in responses]
    return np.hstack([history.rows.q, *moved, *forces])[1:]


def build() -> Pairs:
    """Build the deck of rigid links, on vertical springs; return the nodes of the lines."""
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    ops.uniaxialMaterial("Elastic", STIFF, 1e3)
    ops.uniaxialMaterial("Elastic", SOFT, 1e-9)
    (mass,) = DECK.masses
    ops.node(MASTER, *DECK.point(mass), 0.0)
    ops.mass(MASTER, *[mass.mass] * 3, *[mass.twist_inertia] * 3)
    ops.node(CENTRE, 0.0, 0.0, 0.0)
    ops.rigidLink("beam", MASTER, CENTRE)
    pairs = [(10 + number, 20 + number) for number in range(len(DECK.bearings))]
    for (lower, upper), line in zip(pairs, DECK.bearings, strict=True):
        for node in (lower, upper):
            ops.node(node, *DECK.point(line), 0.0)
        ops.fix(lower, *[1] * 6)
        ops.rigidLink("beam", MASTER, upper)
        ops.element("zeroLength", 100 + upper, lower, upper, "-mat", STIFF, "-dir", 3)
    return pairs


def shake(ground: Floats, pairs: Pairs, forces: Callable[[], list[float]]) -> Floats:
    """Return the histories of `ours`, those that `forces` reads at the end of a step."""
    for axis in (1, 2):
        values = [*ground[:, axis - 1].tolist(), 0.0]  # the end of a series is not in it
        ops.timeSeries("Path", axis, "-dt", DT, "-values", *values)
        ops.pattern("UniformExcitation", axis, axis, "-accel", axis)
    analyse(numberer="RCM", system="UmfPack")
    result = []
    for _ in range(len(ground) - 1):
        assert ops.analyze(1, DT) == 0
        row = [ops.nodeDisp(CENTRE, k) for k in (1, 2, 6)]
        row += [ops.nodeDisp(upper, k) for _, upper in pairs for k in (1, 2)]
        result.append(row + forces())
    return np.array(result)


def compare(mine: Floats, theirs: Floats, name: str, measured: Recorder) -> None:
    """Compare each history, of its peak: x, y and twist of the deck, then those of the lines."""
    apart = np.abs(mine - theirs).max(axis=0) / np.abs(theirs).max(axis=0)
    assert np.abs(theirs[:, 2]).max() * 10e3 > 10.0  # mm at the ends of the deck, of twist
    assert apart.max() < tol.OPENSEES_PLAN
    lines = 3 + 2 * len(DECK.bearings)
    worst = [apart[:2].max(), apart[2], apart[3:lines].max(), apart[lines:].max()]
    measured(
        f"deck that twists, {name}, complete histories against OpenSees: deck, twist, bearings, "
        "forces",
        ", ".join(f"{one:.1e}" for one in worst),
        f"{tol.OPENSEES_PLAN:g}",
    )


@pytest.mark.thorough
def test_a_deck_on_bilinear_bearings(measured: Recorder) -> None:
    """Bearings at one end are stronger, so that the deck twists by its stiffness too."""
    ground = kobe(0, 4000)
    ends = [DECK.point(line)[0] for line in DECK.bearings]
    backbones = [
        BilinearParameters(30.0 * f, 0.32 * f, 3.2 * f)
        for f in (1.6 if x > 0.0 else 1.0 for x in ends)
    ]
    pairs = build()
    soft = [part for name in ("-P", "-T", "-My", "-Mz") for part in (name, SOFT)]
    axes = ("-orient", 0.0, 0.0, 1.0, 1.0, 0.0, 0.0)
    tags = range(1, len(pairs) + 1)
    for tag, ends_of, one in zip(tags, pairs, backbones, strict=True):
        law = (COUNT * one.initial, COUNT * one.strength, one.post_yield / one.initial, 0.0, 1.0)
        ops.element("elastomericBearingPlasticity", tag, *ends_of, *law, *soft, *axes)

    def forces() -> list[float]:
        return [force for tag in tags for force in ops.eleForce(tag)[6:8]]

    theirs = shake(ground, pairs, forces)
    ops.wipe()
    mine = ours([bilinear_constants(one) for one in backbones], ground)
    assert np.abs(mine[:, 3:5]).max() > 200.0  # mm: far beyond yield
    compare(mine, theirs, "bilinear bearings", measured)


def test_a_deck_on_served_bearings(measured: Recorder) -> None:
    """Rubber with its heat in two programs, in the strong part of the motion."""
    ground = kobe(1500, 400)
    with tb.opensees.serve(BEARING, AMBIENT, count=COUNT) as line:
        pairs = build()
        ops.element(*line.element(1, pairs, directions=(1, 2)))
        theirs = shake(ground, pairs, list)
        forces = COUNT * line.results()["force"].values[:, 1:].T
        ops.wipe()
    mine = ours([real_bearing(BEARING)] * len(pairs), ground)
    compare(mine, np.hstack([theirs, forces]), "served bearings", measured)
