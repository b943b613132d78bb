"""From bodies and connections to matrices and periods."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, eigh

from thermobearing.border.errors import InputError
from thermobearing.core.types import Floats
from thermobearing.structure.model import (
    GROUND,
    Body,
    MassModel,
    Spring,
    Structure,
)


@dataclass(frozen=True)
class Matrices:
    """A structure as numbers; coordinates are named "deck x", "pier rotation", ...

    Attributes
    ----------
    coordinates : names, n of them.
    mass : [n, n] [kN s2/mm] and what follows from it for rotations.
    load : [n] force per ground acceleration: minus mass times rigid motion.
    springs : [n, n] stiffness of linear springs.
    hinge_rows, line_rows : rotation of each hinge, stretch of each bearing line per coordinate.
    """

    coordinates: list[str]
    mass: Floats
    load: Floats
    springs: Floats
    hinge_rows: Floats
    line_rows: Floats


@dataclass(frozen=True)
class Modes:
    """Natural modes: circular frequencies [rad/s] and shapes [n, modes] with unit modal mass."""

    frequencies: Floats
    shapes: Floats

    @property
    def periods(self) -> Floats:
        """[s], longest first."""
        return 2.0 * np.pi / self.frequencies


def coordinates(structure: Structure) -> list[str]:
    """Names of the coordinates, body by body."""
    names = []
    for body in structure.bodies:
        names += [f"{body.name} x"] * body.moves + [f"{body.name} rotation"] * body.rotates
    return names


def unit(structure: Structure, name: str) -> Floats:
    """Row of a coordinate by its name."""
    names = coordinates(structure)
    row = np.zeros(len(names))
    row[names.index(name)] = 1.0
    return row


def rotation_row(structure: Structure, name: str) -> Floats:
    """Absolute rotation of a body per coordinate; one that does not rotate follows its carrier."""
    if name == GROUND:
        return np.zeros(len(coordinates(structure)))
    body = structure.body(name)
    if body.rotates:
        return unit(structure, f"{name} rotation")
    return rotation_row(structure, body.on or GROUND)


def displacement_row(structure: Structure, name: str, height: float) -> Floats:
    """Sideways motion, relative to the ground, of the point of a body at a height [mm]."""
    if name == GROUND:
        return np.zeros(len(coordinates(structure)))
    body = structure.body(name)
    if body.on is None:
        base = unit(structure, f"{name} x")
    else:
        base = displacement_row(structure, body.on, body.base_height)
    return base + (height - body.base_height) * rotation_row(structure, name)


def mean_height(structure: Structure, name: str) -> float:
    """Where the masses of a body are in the mean [mm]; its base if it has none."""
    mine = [mass for mass in structure.masses if mass.body == name]
    whole = sum(mass.mass for mass in mine)
    if not mine:
        return structure.body(name).base_height
    return sum(mass.mass * mass.height for mass in mine) / whole


def build_matrices(structure: Structure, mass_model: MassModel = "consistent") -> Matrices:
    """Matrices of a structure.

    Parameters
    ----------
    structure : from `load_structure`.
    mass_model : "consistent": kinetic energy of every mass, and the ground pushes every mass.
        "published" (Eq. 6.4-6.7): a body that moves has its mass on that coordinate, one that is
        carried has only its inertia about its base, without coupling, and the ground pushes
        the moving ones.
    """
    names = coordinates(structure)
    n = len(names)
    mass, load, springs = np.zeros((n, n)), np.zeros(n), np.zeros((n, n))
    for item in structure.masses:
        body = structure.body(item.body)
        turning = rotation_row(structure, item.body)
        if mass_model == "consistent":
            moving = displacement_row(structure, item.body, item.height)
            load -= item.mass * moving
        else:
            moving = _own_motion(structure, body, item.height)
            load -= item.mass * moving * body.moves
        mass += item.mass * np.outer(moving, moving)
        mass += item.rotary_inertia * np.outer(turning, turning)
    _check_mass(mass, names, structure.name)
    for spring in structure.springs:
        springs += spring_matrix(structure, spring)
    hinges = [
        rotation_row(structure, h.body) - rotation_row(structure, h.base) for h in structure.hinges
    ]
    lines = [difference(structure, b.body, b.base, b.height) for b in structure.bearings]
    return Matrices(
        names, mass, load, springs, np.reshape(hinges, (len(hinges), n)), np.array(lines)
    )


def spring_matrix(structure: Structure, spring: Spring) -> Floats:
    """[n, n] stiffness of one spring."""
    if spring.stiffness is not None:
        row = difference(structure, spring.body, spring.base, spring.height)
        return np.asarray(spring.stiffness * np.outer(row, row))
    row = rotation_row(structure, spring.body) - rotation_row(structure, spring.base)
    return np.asarray((spring.rotational_stiffness or 0.0) * np.outer(row, row))


def difference(structure: Structure, body: str, base: str, height: float) -> Floats:
    """Sideways motion of `body` less that of `base`, at one height."""
    return displacement_row(structure, body, height) - displacement_row(structure, base, height)


def _own_motion(structure: Structure, body: Body, height: float) -> Floats:
    """Motion of a mass as the published mass matrix has it."""
    if body.moves:
        return unit(structure, f"{body.name} x")
    return (height - body.base_height) * rotation_row(structure, body.name)


def _check_mass(mass: Floats, names: list[str], where: str) -> None:
    """Every coordinate needs mass, or time integration has nothing to divide by."""
    for name, value in zip(names, np.diag(mass), strict=True):
        if value <= 0.0:
            raise InputError(
                f'coordinate "{name}" has no mass; add a mass or rotary_inertia', where
            )


def hinge_stiffness(structure: Structure, matrices: Matrices) -> Floats:
    """[n, n] initial stiffness of the hinges."""
    values = np.array([hinge.stiffness for hinge in structure.hinges])
    return np.asarray(matrices.hinge_rows.T @ (values[:, None] * matrices.hinge_rows))


def line_stiffness(structure: Structure, matrices: Matrices, each: Floats | None = None) -> Floats:
    """[n, n] stiffness of the bearing lines.

    Parameters
    ----------
    each : stiffness of ONE bearing of each line [kN/mm]; the equivalent one by default.
    """
    lines = structure.bearings
    one = np.array([line.equivalent_stiffness for line in lines]) if each is None else each
    values = one * np.array([line.count for line in lines])
    return np.asarray(matrices.line_rows.T @ (values[:, None] * matrices.line_rows))


def find_modes(mass: Floats, stiffness: Floats, where: str = "structure") -> Modes:
    """All natural modes, longest period first.

    Raises
    ------
    InputError : the structure is a mechanism: some motion meets no stiffness.
    """
    try:
        values, shapes = eigh(stiffness, mass)
    except LinAlgError:
        raise InputError(
            "some motion moves no mass; give every body that rotates a rotary_inertia, or masses "
            "at two heights (and look for masses that differ by more than 1e12)",
            where,
        ) from None
    if values[0] <= 1e-12 * values[-1]:
        raise InputError("is a mechanism: some motion meets no stiffness", where)
    return Modes(np.sqrt(values), shapes)
