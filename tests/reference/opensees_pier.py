"""The structures of this package in OpenSees: linear and bilinear bearings, or LeadRubberX.

Units N, m, s, kg inside; kN, mm, s outside. Rigid bodies are stiff beams, hinges and springs
zero-length elements; damping is the source's a M + b K' (stiffness part on springs and hinges).
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from tests.opensees import analyse, ops
from tests.verification.structures import linear_bearing, rayleigh_factors, read_ground, shaken
from thermobearing.bearing.bilinear import load_bilinear
from thermobearing.core.types import Constants, Floats
from thermobearing.model.earlier import BilinearParameters, bilinear_constants
from thermobearing.structure.matrices import displacement_row, unit
from thermobearing.structure.model import Structure, load_structure
from thermobearing.structure.run import Prepared

RIGID = 1e15  # E, G [N/m2] of bodies with a unit cross-section
VERTICAL = (0.0, 0.0, 1.0, 0.0, 1.0, 0.0)
Bearing = Callable[[int, int, int], Any]  # makes the element: tag, lower node, upper node


def spring_bearing(stiffness: float, count: int) -> Bearing:
    """`count` linear springs [kN/mm] side by side."""

    def make(tag: int, lower: int, upper: int) -> None:
        ops.uniaxialMaterial("Elastic", 900, count * stiffness * 1e6)
        ops.element("zeroLength", tag, lower, upper, "-mat", 900, "-dir", 1)

    return make


def bilinear_bearing(strength: float, initial: float, post_yield: float, count: int) -> Bearing:
    """`count` bilinear bearings: Q_d [kN], K_1 and K_2 [kN/mm], kinematic hardening."""

    def make(tag: int, lower: int, upper: int) -> None:
        yield_force = strength * initial / (initial - post_yield)
        ops.uniaxialMaterial(
            "Steel01", 900, count * yield_force * 1e3, count * initial * 1e6, post_yield / initial
        )
        ops.element("zeroLength", tag, lower, upper, "-mat", 900, "-dir", 1)

    return make


def _pier_p1(structure: Structure) -> tuple[int, int, int]:
    """Nodes of pier P1; returns ground-side node of the bearings, deck node, pier base node."""
    heights = {2: -2.0, 3: -1.0, 4: 0.0, 5: 0.0, 6: 3.75, 7: 8.9, 8: 10.0, 9: 10.0}
    for node, height in ({1: -2.0} | heights).items():
        ops.node(node, 0.0, 0.0, height)
    ops.fix(1, 1, 1, 1, 1, 1, 1)
    for node in (2, 5):
        ops.fix(node, 0, 1, 1, 1, 0, 1)
    ops.fix(9, 0, 1, 1, 1, 1, 1)
    for node in (3, 4, 6, 7, 8):
        ops.fix(node, 0, 1, 1, 1, 0, 1)
    ops.geomTransf("Linear", 1, 0.0, 1.0, 0.0)
    for tag, ends in enumerate(((2, 3), (3, 4), (5, 6), (6, 7), (7, 8)), 20):
        ops.element("elasticBeamColumn", tag, *ends, 1.0, RIGID, RIGID, 1.0, 1.0, 1.0, 1)
    deck, top, middle, footing = structure.masses
    for node, item in ((9, deck), (7, top), (6, middle), (3, footing)):
        mass = item.mass * 1e6  # kN mm s2 = kg m2: rotary inertia needs no factor
        ops.mass(node, mass, 0.0, 0.0, 0.0, item.rotary_inertia, 0.0)
    sideways, rocking = structure.springs
    assert sideways.stiffness is not None
    assert rocking.rotational_stiffness is not None
    ops.uniaxialMaterial("Elastic", 1, sideways.stiffness * 1e6)
    ops.uniaxialMaterial("Elastic", 2, rocking.rotational_stiffness)
    ops.uniaxialMaterial("Elastic", 3, structure.hinges[0].stiffness)
    ops.element("zeroLength", 1, 1, 2, "-mat", 1, 2, "-dir", 1, 5, "-doRayleigh", 1)
    ops.element("zeroLength", 2, 4, 5, "-mat", 3, "-dir", 5, "-doRayleigh", 1)
    ops.equalDOF(4, 5, 1)
    return 8, 9, 5


def _hybrid_pier(structure: Structure) -> tuple[int, int, int]:
    for node in (1, 2, 3):
        ops.node(node, 0.0, 0.0, 0.0)
        ops.fix(node, int(node == 1), 1, 1, 1, 1, 1)
    deck, pier = structure.masses
    ops.mass(3, deck.mass * 1e6, 0.0, 0.0, 0.0, 0.0, 0.0)
    ops.mass(2, pier.mass * 1e6, 0.0, 0.0, 0.0, 0.0, 0.0)
    stiffness = structure.springs[0].stiffness
    assert stiffness is not None
    ops.uniaxialMaterial("Elastic", 1, stiffness * 1e6)
    ops.element("zeroLength", 1, 1, 2, "-mat", 1, "-dir", 1, "-doRayleigh", 1)
    return 2, 3, 2


def build(
    prepared: Prepared, bearing: Bearing, ground: Floats, dt: float, rayleigh: tuple[float, float]
) -> tuple[int, int, int]:
    """A model that is ready to be analysed; ground acceleration in mm/s2."""
    structure = prepared.structure
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    make = _pier_p1 if structure.name == "pier-p1" else _hybrid_pier
    nodes = make(structure)
    bearing(10, nodes[0], nodes[1])
    ops.rayleigh(rayleigh[0], 0.0, rayleigh[1], 0.0)
    ops.timeSeries("Path", 1, "-dt", dt, "-values", *(ground / 1e3), ground[-1] / 1e3)
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    analyse(numberer="RCM", system="FullGeneral")
    return nodes


def shake(nodes: tuple[int, int, int], steps: int, dt: float) -> dict[str, Floats]:
    """Histories after each step: deck and pier [mm], bearing force of the line [kN], deck
    acceleration relative to the ground [mm/s2]."""
    lower, deck, _ = nodes
    rows = []
    for _ in range(steps):
        if ops.analyze(1, dt) != 0:
            raise RuntimeError("OpenSees did not converge")
        rows.append(
            (
                1e3 * ops.nodeDisp(deck, 1),
                1e3 * ops.nodeDisp(lower, 1),
                1e-3 * ops.eleResponse(10, "force")[6],
                1e3 * ops.nodeAccel(deck, 1),
            )
        )
    ops.wipe()
    names = ("deck", "pier", "force", "acceleration")
    return dict(zip(names, np.array(rows).T, strict=True))


DT, DURATION = 0.005, 20.0  # [s]
MOTION = "jra-ii-i-1"


def elastic_pier() -> Structure:
    """Pier P1 whose hinge never yields: the hinge rules of OpenSees differ."""
    structure = load_structure("pier-p1")
    hinge = structure.hinges[0]
    strong = hinge.model_copy(
        update={
            "yield_moment": 1e3 * hinge.yield_moment,
            "yield_rotation": 1e3 * hinge.yield_rotation,
        }
    )
    return structure.model_copy(update={"hinges": (strong,)})


def parameters(name: str, kind: str) -> tuple[Constants, Bearing]:
    line = load_structure(name).bearings[0]
    if kind == "linear":
        stiffness = line.equivalent_stiffness
        return linear_bearing(stiffness * line.scale), spring_bearing(stiffness, line.count)
    given = load_bilinear("shen-bilinear-bridge")
    larger = line.equivalent_stiffness / 2.6153  # as stiff at the same displacement
    q, first, second = (
        larger * value
        for value in (given.strength, given.initial_stiffness, given.post_yield_stiffness)
    )
    scaled = BilinearParameters(q * line.scale**2, second * line.scale, first * line.scale)
    return bilinear_constants(scaled), bilinear_bearing(q, first, second, line.count)


def compare(name: str, kind: str) -> tuple[dict[str, Floats], dict[str, Floats]]:
    """Histories of deck and pier [mm], line force [kN] and deck acceleration [mm/s2], relative to
    the ground: ours, and those of OpenSees."""
    ours, theirs = parameters(name, kind)
    return compare_bearings(name, ours, theirs)


def compare_bearings(
    name: str, ours: Constants, theirs: Bearing
) -> tuple[dict[str, Floats], dict[str, Floats]]:
    """`compare` for any bearing."""
    structure = elastic_pier() if name == "pier-p1" else load_structure(name)
    ground = read_ground(MOTION, DT, DURATION)
    prepared, history = shaken(structure, ours, ground, DT, damping="source")
    assert history.outcome == "completed"
    nodes = build(prepared, theirs, ground, DT, rayleigh_factors(prepared))
    reference = shake(nodes, len(ground) - 1, DT)
    line, report = structure.bearings[0], structure.report
    deck = unit(structure, f"{report.deck} x")
    pier = displacement_row(structure, report.pier, report.pier_top)
    factor = line.count / line.scale**2
    result = {
        "deck": history.rows.q @ deck,
        "pier": history.rows.q @ pier,
        "force": factor * history.bearing()["force"],
        "acceleration": history.rows.a @ deck,
    }
    return {key: np.asarray(values[1:]) for key, values in result.items()}, reference
