"""The same structure, motion and bearing here and in OpenSees."""

import numpy as np

from tests.reference.opensees_pier import Bearing, bilinear_bearing, build, shake, spring_bearing
from tests.verification.structures import ground_of, linear_bearing, rayleigh_factors, shaken
from thermobearing.bearing.bilinear import load_bilinear
from thermobearing.core.types import Constants, Floats
from thermobearing.model.earlier import BilinearParameters, bilinear_constants
from thermobearing.structure.matrices import displacement_row, unit
from thermobearing.structure.model import Structure, load_structure

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
    structure = elastic_pier() if name == "pier-p1" else load_structure(name)
    ground = ground_of(MOTION, DT, DURATION)
    ours, theirs = parameters(name, kind)
    prepared, history = shaken(structure, ours, ground, DT, damping="source")
    assert history.outcome == "completed"
    nodes = build(prepared, theirs, ground, DT, rayleigh_factors(prepared))
    reference = shake(nodes, len(ground) - 1, DT)
    line, report = structure.bearings[0], structure.report
    deck = unit(structure, f"{report.deck} x")
    pier = displacement_row(structure, report.pier, report.pier_top)
    factor = line.count / line.scale**2
    found = {
        "deck": history.rows.q @ deck,
        "pier": history.rows.q @ pier,
        "force": factor * history.bearing()["force"],
        "acceleration": history.rows.a @ deck,
    }
    return {key: np.asarray(values[1:]) for key, values in found.items()}, reference
