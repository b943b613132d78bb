"""What the tests of structures share. No tests."""

from typing import Any

import numpy as np
from scipy.signal import lsim

import thermobearing as tb
from thermobearing.core.types import Constants, Floats
from thermobearing.model.constants import build_constants
from thermobearing.model.earlier import BilinearParameters, bilinear_constants
from thermobearing.model.stack import EndFace, build_stack
from thermobearing.motions.library import load_motion
from thermobearing.structure import run
from thermobearing.structure.matrices import hinge_stiffness
from thermobearing.structure.model import DampingKind, Structure, load_structure

AMBIENT = -20.0
NEVER = 1e9  # kN: strength of a bearing that stays linear


def read_ground(name: str, dt: float, duration: float | None = None) -> Floats:
    """A built-in motion at steps of dt [s], starting from zero [mm/s2]."""
    motion = load_motion(name)
    last = motion.duration if duration is None else duration
    ground = np.interp(dt * np.arange(round(last / dt) + 1), motion.time, motion.acceleration)
    ground[0] = 0.0
    return np.asarray(ground)


def linear_bearing(stiffness: float) -> Constants:
    """A spring [kN/mm], by way of the bilinear bearing that never yields."""
    return bilinear_constants(BilinearParameters(NEVER, 0.5 * stiffness, stiffness))


def real_bearing(name: str, **options: Any) -> Constants:
    bearing = tb.load_bearing(name)
    stack = build_stack(bearing, half=True)
    return build_constants(bearing, stack, upper=EndFace(eta=2.0), lower=None, **options)


def shaken(
    structure: Structure | str,
    constants: Constants,
    ground: Floats,
    dt: float,
    *,
    ambient: float = AMBIENT,
    method: run.Method = "average-acceleration",
    mass: Any = "consistent",
    damping: DampingKind | None = None,
    **options: Any,
) -> tuple[run.Prepared, run.StructureHistory]:
    if isinstance(structure, str):
        structure = load_structure(structure)
    prepared = run.prepare_structure(structure, mass, damping)
    line = run.Line(
        constants,
        np.full(len(constants.cells.capacity), ambient, dtype=float),
        None,
        options.pop("speed", 0.0),
    )
    lines = [line] * len(structure.bearings)
    air = np.full(len(ground) - 1, ambient, dtype=float)
    return prepared, run.run_structure(prepared, lines, ground, dt, air, method=method, **options)


def exact_linear(prepared: run.Prepared, stiffness: Floats, ground: Floats, dt: float) -> Floats:
    """Coordinates of a linear structure, ground acceleration linear between its samples."""
    matrices, damping = prepared.matrices, prepared.damping
    n = len(matrices.load)
    inverse = np.linalg.inv(matrices.mass)
    zero, one = np.zeros((n, n)), np.eye(n)
    a = np.block([[zero, one], [-inverse @ stiffness, -inverse @ damping]])
    push = (inverse @ matrices.load).reshape(n, -1)  # in one direction, or two
    b = np.concatenate([np.zeros_like(push), push])
    time = dt * np.arange(len(ground))
    _, q, _ = lsim((a, b, np.hstack([one, zero]), np.zeros_like(push)), ground, time)
    return np.asarray(q)


def energy_residual(history: run.StructureHistory) -> float:
    """What the energy balance of a run lacks, of the input."""
    energies = history.rows.energies[-1]
    spent = (
        energies.kinetic
        + energies.damping
        + energies.springs
        + energies.hinges
        + energies.bearings
        + energies.dampers
        + energies.sliders
        + energies.gaps
    )
    return abs((energies.input - spent) / energies.input)


def rayleigh_factors(prepared: run.Prepared) -> tuple[float, float]:
    """a and b of C = a M + b K' (damping "source"), from the damping matrix itself."""
    matrices = prepared.matrices
    stiffness = matrices.springs + hinge_stiffness(prepared.structure, matrices)
    parts = np.column_stack([matrices.mass.ravel(), stiffness.ravel()])
    a, b = np.linalg.lstsq(parts, prepared.damping.ravel())[0]
    return float(a), float(b)


def follow(bearing: tb.BearingElement, path: Any, dt: Any) -> tuple[Floats, tb.BearingElement]:
    """Forces of an element that is moved along a path in steps of dt, and the element."""
    forces = []
    for x, step in np.broadcast(path, dt):
        forces.append(bearing.set_trial(float(x), dt=float(step)).force)
        bearing.commit()
    return np.array(forces), bearing
