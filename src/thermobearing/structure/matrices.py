"""From bodies and connections to matrices, natural modes and viscous damping.

The damping matrix is that of the structure without its bearings, whose hysteresis is their
damping. What only bearings hold (the deck) then moves freely, without a dashpot to the ground;
every other motion has the ratios of its parts weighted with strain energy. The exceptions are
`source`: Rayleigh damping through modes 1 and 2 of the structure, whose mass term holds
the deck too; `source-with-bearings`, whose stiffness term has the bearings too; and `element`,
where bearings with a ratio have a dashpot across them.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from thermobearing.border.errors import InputError
from thermobearing.core.types import Floats
from thermobearing.quantities.governing import place_of_largest
from thermobearing.quantities.register import Quantity, quantity
from thermobearing.results.sums import product_in_order
from thermobearing.structure.connections.model import DeviceTable
from thermobearing.structure.fields import GRAVITY, GROUND
from thermobearing.structure.model import (
    DIRECTIONS,
    SOURCE_KINDS,
    BearingLine,
    Damping,
    Hinge,
    MassModel,
    Spring,
    Structure,
    list_hinges,
)

DAMPED_MODES = 2  # that Rayleigh damping fits
NO_STIFFNESS = 1e-12  # of the largest squared frequency: rounding leaves 1e-16 of it
NO_MASS = 1e-13  # of the mass of one coordinate alone: rounding leaves 1e-16 of it
MOVING = 0.01  # of the kinetic energy of a motion without stiffness: the coordinate is named
NEGATIVE = -1e-9  # of the largest damping: what is below feeds energy in, beyond rounding
Part = tuple[float, Floats]  # damping ratio, stiffness [n, n]


@dataclass(frozen=True)
class Matrices:
    """A structure as numbers; coordinates are named "deck x", "pier rotation", ...

    In plan, they are "deck x", "deck y", "pier rotation x", "pier rotation y", "deck twist", ...,
    and what is given per direction has one more axis, the last: x and y.
    """

    coordinates: list[str]  # names, n of them
    mass: Floats  # [n, n] [kN s2/mm] and what follows from it for rotations
    load: Floats  # [n] or [n, 2] force per ground acceleration: minus mass times rigid motion
    springs: Floats  # [n, n] stiffness of linear springs
    hinge_rows: Floats  # [h, n] rotation per coordinate of each of `list_hinges`
    line_rows: Floats  # [b, n] or [b, n, 2] stretch of each bearing line per coordinate
    geometric: Floats  # [n, n] negative stiffness of weights; zero without P-delta
    device_rows: Floats  # [d, n] or [d, n, 2] stretch of each device, in plan along its axis first


@dataclass(frozen=True)
class Modes:
    """Natural modes: circular frequencies [rad/s] and shapes [n, modes] with unit modal mass."""

    frequencies: Floats
    shapes: Floats

    @property
    def periods(self) -> Floats:
        """[s], longest first."""
        return 2.0 * np.pi / self.frequencies


def _coordinates(structure: Structure) -> list[str]:
    """Return the names of the coordinates, body by body."""
    return [name for name, _ in describe_coordinates(structure)]


def describe_coordinates(structure: Structure) -> list[tuple[str, Quantity]]:
    """Return the name of each coordinate, body by body, and its quantity."""
    moves, rotates = quantity("coordinate_mm"), quantity("coordinate_rad")
    coordinates = []
    for body in structure.bodies:
        coordinates += [(name, moves) for name in _names(structure, body.name) * body.moves]
        names = _names(structure, body.name, " rotation") * body.rotates
        coordinates += [
            (name, rotates) for name in names + [f"{body.name} twist"] * bool(body.twists)
        ]
    return coordinates


def _names(structure: Structure, name: str, motion: str = "") -> list[str]:
    """Return the names of the sideways motion of a body, or its " rotation", in each direction."""
    if structure.plan:
        return [f"{name}{motion} {direction}" for direction in DIRECTIONS]
    return [f"{name}{motion or ' x'}"]


def unit(structure: Structure, name: str) -> Floats:
    """Return the row of a coordinate by its name."""
    names = _coordinates(structure)
    row = np.zeros(len(names))
    row[names.index(name)] = 1.0
    return row


def _motion_rows(structure: Structure, name: str, motion: str = "") -> Floats:
    """Return the rows of a motion: [n], or [n, 2] in plan."""
    rows = [unit(structure, coordinate) for coordinate in _names(structure, name, motion)]
    return np.stack(rows, axis=-1) if structure.plan else rows[0]


def _at_rest(structure: Structure) -> Floats:
    """Return the rows of the ground."""
    n = len(_coordinates(structure))
    return np.zeros((n, len(DIRECTIONS)) if structure.plan else n)


def _rotation_row(structure: Structure, name: str) -> Floats:
    """Return the absolute rotation of a body, or of its carrier, per coordinate."""
    if name == GROUND:
        return _at_rest(structure)
    body = structure.body(name)
    # A body that does not rotate by itself turns with what carries it.
    if body.rotates:
        return _motion_rows(structure, name, " rotation")
    return _rotation_row(structure, body.on or GROUND)


def _twist_row(structure: Structure, name: str) -> Floats:
    """Return [n] the rotation of a body, or of its carrier, about the vertical."""
    if name == GROUND:
        return np.zeros(len(_coordinates(structure)))
    body = structure.body(name)
    if body.twists:
        return unit(structure, f"{name} twist")
    return _twist_row(structure, body.on or GROUND)


def displacement_row(
    structure: Structure, name: str, height: float, x: float | None = None, y: float | None = None
) -> Floats:
    """Return the motion of a body at a height [mm] ([n]), in plan at a point ([n, 2])."""
    if name == GROUND:
        return _at_rest(structure)
    body, place = structure.body(name), structure.place(name)
    if body.on is None:
        base = _motion_rows(structure, name)
    else:
        base = displacement_row(structure, body.on, body.base_height, *place)
    # Small rotations: a point moves by its height above the base times the angle, Eq. 6.4-6.7.
    row = base + (height - body.base_height) * _rotation_row(structure, name)
    if not structure.plan:
        return row
    # A twist moves a point across its arm: by -y along x, and by x along y.
    arm = np.array([place[1] if y is None else y, place[0] if x is None else x]) - place[::-1]
    return np.asarray(row + np.outer(_twist_row(structure, name), arm * [-1.0, 1.0]))


def mean_height(structure: Structure, name: str) -> float:
    """Return the mean height of the masses of a body [mm]; its base if it has none."""
    masses = [mass for mass in structure.masses if mass.body == name]
    total = sum(mass.mass for mass in masses)
    if not masses:
        return structure.body(name).base_height
    return sum(mass.mass * mass.height for mass in masses) / total


def build_matrices(structure: Structure, mass_model: MassModel = "consistent") -> Matrices:
    """Return the matrices of a structure.

    `mass_model` "consistent": kinetic energy of every mass, and the ground pushes every mass.
    "published" (Eq. 6.4-6.7): a body that moves has its mass on that coordinate, one that is
    carried has only its inertia about its base, without coupling, and the ground pushes
    the moving ones.
    """
    names = _coordinates(structure)
    _check_names(structure, names, mass_model)
    n = len(names)
    mass, load, springs = np.zeros((n, n)), _at_rest(structure), np.zeros((n, n))
    for item in structure.masses:
        body = structure.body(item.body)
        if mass_model == "consistent":
            moving = displacement_row(structure, item.body, item.height, *structure.point(item))
            load -= item.mass * moving
        else:
            # Eq. 6.4-6.7 couple no coordinates: a mass is on the motion of its body, or turns about
            # its base.
            turning = (item.height - body.base_height) * _rotation_row(structure, body.name)
            moving = unit(structure, f"{body.name} x") if body.moves else turning
            load -= item.mass * moving * body.moves
        mass += item.mass * _square(moving)
        mass += item.rotary_inertia * _square(_rotation_row(structure, item.body))
        if item.twist_inertia:
            mass += item.twist_inertia * _square(_twist_row(structure, item.body))
    _check_mass(mass, names, structure.name)
    for spring in structure.springs:
        for _, matrix in _spring_parts(structure, spring):
            springs += matrix
    hinges = [
        _difference(_rotation_row, structure, h)[:, DIRECTIONS.index(h.direction)]
        if h.direction
        else _difference(_rotation_row, structure, h)
        for h in list_hinges(structure)
    ]
    lines = [_stretch_row(structure, line) for line in structure.bearings]
    rows = np.reshape(hinges, (len(hinges), n))
    devices = [_device_row(structure, device) for device in structure.device_list]
    device_rows = np.reshape(devices, (len(devices), *load.shape))
    geometric = _geometric_stiffness(structure) if structure.p_delta else np.zeros((n, n))
    return Matrices(names, mass, load, springs, rows, np.array(lines), geometric, device_rows)


def twist_load(structure: Structure) -> tuple[Floats, float]:
    """Return force [n] per angular acceleration of a ground that turns, and inertia [kN mm s2]."""
    mass = np.array([item.mass for item in structure.masses])
    points = np.array([structure.point(item) for item in structure.masses])
    # About the centre of mass, where a ground that turns does not push sideways.
    arms = points - product_in_order(points.T, mass) / mass.sum()
    load, inertia = np.zeros(len(_coordinates(structure))), 0.0
    for item, (x, y) in zip(structure.masses, arms, strict=True):
        moving = displacement_row(structure, item.body, item.height, *structure.point(item))
        own_inertia = item.twist_inertia or 0.0
        load -= item.mass * (x * moving[:, 1] - y * moving[:, 0]) + own_inertia * _twist_row(
            structure, item.body
        )
        inertia += item.mass * (x * x + y * y) + own_inertia
    return load, float(inertia)


def _square(row: Floats) -> Floats:
    """Return the matrix of a stiffness or mass of one on a row, or on both of a plan."""
    return np.outer(row, row) if row.ndim == 1 else product_in_order(row, row.T)


def _spring_parts(structure: Structure, spring: Spring) -> list[Part]:
    """Return the damping ratio and the stiffness [n, n] of one spring in each direction."""
    if spring.stiffness is not None:
        row = _sideways(structure, spring, spring.height)
    elif spring.direction == "twist":
        row = _difference(_twist_row, structure, spring)
    else:
        row = _difference(_rotation_row, structure, spring)
    rows = [
        component
        for direction, component in zip(DIRECTIONS, np.atleast_2d(row.T), strict=False)
        if spring.direction in (None, direction, "twist")
    ]
    size = spring.rotational_stiffness or 0.0 if spring.stiffness is None else spring.stiffness
    return [(spring.damping_ratio, np.asarray(size * _square(component))) for component in rows]


def _difference(
    motion: Callable[[Structure, str], Floats], structure: Structure, part: Spring | Hinge
) -> Floats:
    """Return the rotation of the body of a part less that of its base."""
    return motion(structure, part.body) - motion(structure, part.base)


def _sideways(
    structure: Structure, part: Spring | BearingLine | DeviceTable, height: float
) -> Floats:
    """Return the motion of the body of a part less that of its base, at its point and a height."""
    upper, lower = [
        displacement_row(structure, name, height, *structure.point(part))
        for name in (part.body or GROUND, part.base or GROUND)
    ]
    return upper - lower


def _stretch_row(structure: Structure, line: BearingLine) -> Floats:
    """Return the stretch of a bearing line per coordinate."""
    row = _sideways(structure, line, line.height)
    if line.height_across is not None:
        row[:, 1] = _sideways(structure, line, line.height_across)[:, 1]
    return row


def _lowering(structure: Structure, name: str, height: float) -> Floats:
    """Return the matrix [n, n] whose quadratic form is twice the lowering of a point of a body."""
    if name == GROUND:
        n = len(_coordinates(structure))
        return np.zeros((n, n))
    body = structure.body(name)
    tilt = (height - body.base_height) * _square(_rotation_row(structure, name))
    if body.on is None:
        return np.asarray(tilt)
    return np.asarray(tilt + _lowering(structure, body.on, body.base_height))


def _geometric_stiffness(structure: Structure) -> Floats:
    """Return the stiffness [n, n] of weights that rotations of bodies lower.

    A mass is lowered by the rotations of its body and of those that carry it. The load P of a line
    goes from its body to its base, and at a shear x of its bearings, each of whose ends takes the
    moment P x/2, it is lowered by x (theta_base + theta_body)/2 too.
    """
    n = len(_coordinates(structure))
    stiffness = np.zeros((n, n))
    for item in structure.masses:
        stiffness -= GRAVITY * item.mass * _lowering(structure, item.body, item.height)
    for line in structure.bearings:
        load = line.dead_load
        lowering = _lowering(structure, line.base, line.height)
        stiffness -= load * (lowering - _lowering(structure, line.body, line.height))
        turns = _rotation_row(structure, line.base) + _rotation_row(structure, line.body)
        shear = _stretch_row(structure, line)
        stiffness -= 0.25 * load * (_square(shear + turns) - _square(shear - turns))
    return stiffness


def _device_row(structure: Structure, device: DeviceTable) -> Floats:
    """Return the stretch of a device per coordinate, in plan along its axis and across it."""
    if device.line is None:
        row = _sideways(structure, device, device.height or 0.0)
    else:
        row = _stretch_row(structure, structure.line(device.line))
    if device.in_both_directions:
        return row
    cosine, sine = np.cos(device.angle or 0.0), np.sin(device.angle or 0.0)
    if not structure.plan:
        return np.asarray(cosine * row)
    along = cosine * row[:, 0] + sine * row[:, 1]
    return np.stack([along, np.zeros_like(along)], axis=-1)


def _check_names(structure: Structure, names: list[str], mass_model: MassModel) -> None:
    """Refuse two coordinates of one name, and a mass model that has no plan."""
    duplicates = [name for name in names if names.count(name) > 1]
    if duplicates:
        raise InputError(
            f'two coordinates are called "{duplicates[0]}": rename a body', structure.name
        )
    if structure.plan and mass_model != "consistent":
        raise InputError(
            f'mass = "{mass_model}": a structure in plan takes "consistent" only', structure.name
        )


def _check_mass(mass: Floats, names: list[str], where: str) -> None:
    """Refuse a coordinate without mass: time integration divides by it."""
    for name, value in zip(names, np.diag(mass), strict=True):
        if value <= 0.0:
            raise InputError(
                f'coordinate "{name}" has no mass; add a mass or '
                + ("twist_inertia" if name.endswith(" twist") else "rotary_inertia"),
                where,
            )


def hinge_stiffness(structure: Structure, matrices: Matrices) -> Floats:
    """Return the initial stiffness [n, n] of the hinges."""
    # Before it yields: modes and damping are those of small motions.
    values = np.array([hinge.stiffness for hinge in list_hinges(structure)])
    return product_in_order(matrices.hinge_rows.T, values[:, None] * matrices.hinge_rows)


def line_stiffness(structure: Structure, matrices: Matrices, each: Floats | None = None) -> Floats:
    """Return the stiffness [n, n] of the lines, with `each` of ONE bearing of each line [kN/mm]."""
    lines = structure.bearings
    per_bearing = np.array([line.equivalent_stiffness for line in lines]) if each is None else each
    values = per_bearing * np.array([line.count for line in lines])
    rows = _line_rows(matrices)
    # In plan a line is equally stiff in both directions.
    values = np.repeat(values, len(rows) // len(values))
    return product_in_order(rows.T, values[:, None] * rows)


def total_stiffness(structure: Structure, matrices: Matrices, each: Floats | None = None) -> Floats:
    """Return the stiffness [n, n] of springs, hinges, bearing lines and weights.

    `each` is that of ONE bearing of each line [kN/mm], by default its equivalent stiffness.
    """
    stiffness = matrices.springs + hinge_stiffness(structure, matrices)
    return stiffness + line_stiffness(structure, matrices, each) + matrices.geometric


def _line_rows(matrices: Matrices) -> Floats:
    """Return the rows [b, n] of bearing lines; in plan [2 b, n], both directions of each."""
    return np.moveaxis(matrices.line_rows, 1, -1).reshape(-1, len(matrices.coordinates))


def check_stands(structure: Structure, matrices: Matrices, stiffness: Floats) -> None:
    """Refuse a structure that its weights overturn; `stiffness` [n, n] contains theirs."""
    if not structure.p_delta:
        return
    values, shapes = scipy.linalg.eigh(stiffness, matrices.mass)
    stands = scipy.linalg.eigh(stiffness - matrices.geometric, matrices.mass, eigvals_only=True)
    if values[0] < 0.0 < stands[0]:
        share = np.diag(matrices.mass) * np.square(shapes[:, 0])
        raise InputError(
            f"p_delta: its weights overturn the structure; {_motion(matrices.coordinates, share)} "
            "has less stiffness than they take; check dead_load and the masses",
            structure.name,
        )


def find_modes(
    mass: Floats, stiffness: Floats, where: str = "structure", names: Sequence[str] = ()
) -> Modes:
    """Return all natural modes, longest period first; InputError for a mechanism."""
    # Each coordinate relative to its own mass: rotations and displacements have other units.
    scale = np.sqrt(np.diag(mass))
    # A motion of several coordinates can be without mass although each of them has some, which the
    # diagonal (`_check_mass`) does not show; `eigh` of the pair below would end in an exception.
    values, shapes = scipy.linalg.eigh(mass / np.outer(scale, scale))
    if values[0] <= NO_MASS:
        motion = _motion(names, np.square(shapes[:, values <= NO_MASS]).max(axis=1))
        remedy = "rotary_inertia, or masses at two heights"
        if ' twist"' in motion:
            remedy = "twist_inertia, or masses at two points of the plan"
        raise InputError(
            f"{motion} moves no mass; give that body {remedy} (and look for masses that differ by "
            "more than 1e12)",
            where,
        )
    values, shapes = scipy.linalg.eigh(stiffness, mass)
    # A mechanism has a frequency of rounding, positive or negative, in place of zero.
    free = values <= NO_STIFFNESS * values[-1]
    if free.any():
        share = np.diag(mass) * np.square(shapes[:, free]).max(axis=1)
        raise InputError(f"is a mechanism: {_motion(names, share)} meets no stiffness", where)
    return Modes(np.sqrt(values), shapes)


def _motion(names: Sequence[str], share: Floats) -> str:
    """Return words for a motion that has these shares in the kinetic energy of coordinates."""
    moving = [f'"{name}"' for name, part in zip(names, share, strict=False) if part > MOVING]
    return f"the motion of {', '.join(moving)}" if moving else "some motion"


def _spring_and_hinge_parts(structure: Structure, matrices: Matrices) -> list[Part]:
    """Return damping ratio and stiffness of springs and hinges."""
    parts = [part for spring in structure.springs for part in _spring_parts(structure, spring)]
    for hinge, row in zip(list_hinges(structure), matrices.hinge_rows, strict=True):
        parts.append((hinge.damping_ratio, hinge.stiffness * np.outer(row, row)))
    return parts


def _line_parts(structure: Structure, matrices: Matrices) -> list[Part]:
    """Return those of bearing lines with their equivalent stiffness."""
    rows = np.split(_line_rows(matrices), len(structure.bearings))
    return [
        (line.damping_ratio, line.count * line.equivalent_stiffness * np.outer(row, row))
        for line, line_rows in zip(structure.bearings, rows, strict=True)
        for row in line_rows
    ]


def _energies(part: Part, shapes: Floats) -> Floats:
    """Return twice the strain energy of a part in each mode."""
    return np.asarray(np.einsum("ik,ij,jk->k", shapes, part[1], shapes))


def _weighed_ratios(parts: list[Part], modes: Modes) -> Floats:
    """Return the damping ratio of each mode, weighted with the strain energy of the parts."""
    stored = np.array([_energies(part, modes.shapes) for part in parts])
    ratios = np.array([ratio for ratio, _ in parts])
    # The composite damping of codes: what stores most of the energy of a mode decides its ratio.
    return np.asarray(ratios @ stored / stored.sum(axis=0))


def _bare_modes(structure: Structure, matrices: Matrices) -> Modes:
    """Return the modes without the bearings that have stiffness, longest period first."""
    stiffness = matrices.springs + hinge_stiffness(structure, matrices)
    values, shapes = scipy.linalg.eigh(stiffness, matrices.mass)
    # Without bearings the deck is free: its motions have no frequency, and no damping ratio is
    # defined for them.
    resisted = (values > 0.0) & (values > NO_STIFFNESS * values[-1])
    return Modes(np.sqrt(values[resisted]), shapes[:, resisted])


def mode_damping(matrix: Floats, modes: Modes) -> Floats:
    """Return the damping ratio that a damping matrix gives each mode."""
    modal = np.einsum("ik,ij,jk->k", modes.shapes, matrix, modes.shapes)
    return np.asarray(modal / (2.0 * modes.frequencies))


def _from_ratios(mass: Floats, modes: Modes, ratios: Floats) -> Floats:
    """Return C = M sum_k 2 xi_k omega_k phi_k phi_k^T M: these ratios, nothing elsewhere."""
    # Modes of unit modal mass are orthogonal about M, so that each term damps its mode alone.
    # Motions on the bearings are in no mode and stay undamped, since bearings dissipate by
    # themselves.
    pushed = mass @ modes.shapes
    return np.asarray((pushed * (2.0 * ratios * modes.frequencies)) @ pushed.T)


def _rayleigh_ratios(damping: Damping, modes: Modes, part_ratios: Floats, where: str) -> Floats:
    """Return xi_k = a/(2 omega_k) + b omega_k/2 through the chosen modes; b alone of one."""
    count = len(modes.frequencies)
    numbers = damping.modes or tuple(range(1, min(DAMPED_MODES, count) + 1))
    if max(numbers) > count:
        raise InputError(
            f"damping.modes: there is no mode {max(numbers)}; without its bearings the structure "
            f"has {count}",
            where,
        )
    chosen = np.array(numbers) - 1
    aim = part_ratios[chosen] if damping.ratios is None else np.array(damping.ratios)
    if len(aim) != len(chosen):
        raise InputError(
            f"damping.ratios: {len(aim)} numbers for {len(chosen)} mode(s); see damping.modes",
            where,
        )
    w = modes.frequencies
    # With one mode only the stiffness term, the last column, is left.
    columns = np.column_stack([0.5 / w, 0.5 * w])[:, DAMPED_MODES - len(chosen) :]
    # Two modes determine both factors; more of them have the least sum of squares.
    factors = np.linalg.lstsq(columns[chosen], aim)[0]
    return np.asarray(columns @ factors)


def _dashpots(parts: list[Part], modes: Modes) -> Floats:
    """Return C = sum 2 xi_e/omega_e K_e, omega_e of the mode that stores most in the part.

    Of springs and hinges these are c_2 and c_3 of Eq. 6.5-6.7 (c_3 once for each ground spring),
    of the bearings c_1 of Eq. 6.4-6.7, zero in Table 6.2.
    """
    matrix = np.zeros((len(modes.shapes), len(modes.shapes)))
    for part in parts:
        share = _energies(part, modes.shapes) / modes.frequencies**2
        # A dashpot has its ratio at one frequency only, and that of the mode that moves the part
        # most is the one that counts.
        matrix += 2.0 * part[0] / modes.frequencies[place_of_largest(share)] * part[1]
    return matrix


def _modal_ratios(damping: Damping, part_ratios: Floats, where: str) -> Floats:
    """Return a ratio for each mode, or one for all; by default those of the parts."""
    if damping.ratios is None:
        return part_ratios
    if len(damping.ratios) not in (1, len(part_ratios)):
        raise InputError(
            f"damping.ratios: {len(damping.ratios)} numbers, but without its bearings the "
            f"structure has {len(part_ratios)} mode(s); give one for each, or one for all",
            where,
        )
    return np.full(len(part_ratios), damping.ratios)


def _source_matrix(structure: Structure, matrices: Matrices, modes: Modes) -> Floats:
    """Return C = a M + b K through modes 1 and 2 of the structure on its bearings.

    K is the stiffness without the bearings (section 6.2.3); of kind "source-with-bearings" it is
    all [K] of Eq. 3.3, the bearings with their equivalent stiffness.
    """
    parts = [*_spring_and_hinge_parts(structure, matrices), *_line_parts(structure, matrices)]
    ratios = structure.damping.ratios or tuple(_weighed_ratios(parts, modes))[:DAMPED_MODES]
    stiffness = matrices.springs + hinge_stiffness(structure, matrices)
    if structure.damping.kind == "source-with-bearings":
        stiffness = stiffness + line_stiffness(structure, matrices)
    modal = _energies((0.0, stiffness), modes.shapes)
    count = min(DAMPED_MODES, len(modes.frequencies))
    # 2 xi omega = a + b phi'K phi for modes of unit mass.
    equations = np.column_stack([np.ones(count), modal[:count]])
    right = 2.0 * np.array(ratios[:count]) * modes.frequencies[:count]
    a, b = np.linalg.lstsq(equations, right)[0]
    return np.asarray(a * matrices.mass + b * stiffness)


def build_damping(structure: Structure, matrices: Matrices, modes: Modes) -> Floats:
    """Return the damping matrix [n, n]; `modes` are with the equivalent stiffness of bearings."""
    damping, where = structure.damping, structure.name
    parts = _spring_and_hinge_parts(structure, matrices)
    if damping.kind in SOURCE_KINDS:
        matrix = _source_matrix(structure, matrices, modes)
    elif damping.kind == "none":
        matrix = np.zeros_like(matrices.mass)
    elif damping.kind == "element":
        matrix = _dashpots(parts, _bare_modes(structure, matrices))
        matrix += _dashpots(_line_parts(structure, matrices), modes)
    else:
        bare = _bare_modes(structure, matrices)
        if not len(bare.frequencies):  # everything stands on bearings
            return np.zeros_like(matrices.mass)
        part_ratios = _weighed_ratios(parts, bare)
        if damping.kind == "modal":
            matrix = _from_ratios(matrices.mass, bare, _modal_ratios(damping, part_ratios, where))
        else:
            ratios = _rayleigh_ratios(damping, bare, part_ratios, where)
            matrix = _from_ratios(matrices.mass, bare, ratios)
    _check_sign(matrix, matrices.mass, damping, where)
    return matrix


def _check_sign(matrix: Floats, mass: Floats, damping: Damping, where: str) -> None:
    """Refuse damping that feeds energy in: a line through two ratios may be negative elsewhere."""
    # Relative to the mass, so that coordinates of different units compare; a negative value is a
    # motion that grows by itself.
    values = scipy.linalg.eigh(matrix, mass, eigvals_only=True)
    if values[0] < NEGATIVE * abs(values[-1]):
        raise InputError(
            f'damping.kind = "{damping.kind}" adds energy to some motions: with these ratios '
            "of two modes, those of other modes are negative; choose other modes or ratios, "
            'or kind = "modal"',
            where,
        )
