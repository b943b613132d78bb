"""Viscous damping of a structure: what its parts lose beside the hysteresis that is modelled.

The damping matrix is that of the structure without its bearings, whose hysteresis is their
damping. What only bearings hold (the deck) then moves freely, and meets no dashpot to the ground;
every other motion has the ratios of its parts weighed with strain energy. The exceptions are
`source`: Rayleigh damping through modes 1 and 2 of the whole structure, whose mass term holds
the deck too; and `element`, where bearings that are given a ratio have a dashpot across them.
"""

import numpy as np
from scipy.linalg import eigh

from thermobearing.border.errors import InputError
from thermobearing.core.types import Floats
from thermobearing.structure.matrices import (
    Matrices,
    Modes,
    hinge_stiffness,
    spring_matrix,
)
from thermobearing.structure.model import Damping, Structure

MODES = 2  # that Rayleigh damping fits
NO_STIFFNESS = 1e-12  # of the largest squared frequency: rounding leaves 1e-16 of it
NEGATIVE = -1e-9  # of the largest damping: what is below feeds energy in, beyond rounding

Part = tuple[float, Floats]  # damping ratio, stiffness [n, n]


def own_parts(structure: Structure, matrices: Matrices) -> list[Part]:
    """Springs and hinges."""
    parts = [(one.damping_ratio, spring_matrix(structure, one)) for one in structure.springs]
    for hinge, row in zip(structure.hinges, matrices.hinge_rows, strict=True):
        parts.append((hinge.damping_ratio, hinge.stiffness * np.outer(row, row)))
    return parts


def line_parts(structure: Structure, matrices: Matrices) -> list[Part]:
    """Bearing lines with their equivalent stiffness."""
    lines = zip(structure.bearings, matrices.line_rows, strict=True)
    return [
        (line.damping_ratio, line.count * line.equivalent_stiffness * np.outer(row, row))
        for line, row in lines
    ]


def energies(part: Part, shapes: Floats) -> Floats:
    """Twice the strain energy of a part in each mode."""
    return np.asarray(np.einsum("ik,ij,jk->k", shapes, part[1], shapes))


def weighed_ratios(parts: list[Part], modes: Modes) -> Floats:
    """Damping ratio of each mode: those of the parts, weighed with their strain energy."""
    stored = np.array([energies(part, modes.shapes) for part in parts])
    ratios = np.array([ratio for ratio, _ in parts])
    return np.asarray(ratios @ stored / stored.sum(axis=0))


def bare_modes(structure: Structure, matrices: Matrices) -> Modes:
    """Modes of the structure without its bearings that meet stiffness, longest period first."""
    stiffness = matrices.springs + hinge_stiffness(structure, matrices)
    values, shapes = eigh(stiffness, matrices.mass)
    held = (values > 0.0) & (values > NO_STIFFNESS * values[-1])
    return Modes(np.sqrt(values[held]), shapes[:, held])


def mode_damping(matrix: Floats, modes: Modes) -> Floats:
    """Damping ratio that a damping matrix gives each mode."""
    modal = np.einsum("ik,ij,jk->k", modes.shapes, matrix, modes.shapes)
    return np.asarray(modal / (2.0 * modes.frequencies))


def _from_ratios(mass: Floats, modes: Modes, ratios: Floats) -> Floats:
    """C = M sum_k 2 xi_k omega_k phi_k phi_k^T M: these ratios, and nothing elsewhere."""
    pushed = mass @ modes.shapes
    return np.asarray((pushed * (2.0 * ratios * modes.frequencies)) @ pushed.T)


def _rayleigh_ratios(damping: Damping, modes: Modes, wanted: Floats, where: str) -> Floats:
    """xi_k = a/(2 omega_k) + b omega_k/2 through the chosen modes; b alone through one."""
    count = len(modes.frequencies)
    numbers = damping.modes or tuple(range(1, min(MODES, count) + 1))
    if max(numbers) > count:
        raise InputError(
            f"damping.modes: there is no mode {max(numbers)}; without its bearings the structure "
            f"has {count}",
            where,
        )
    chosen = np.array(numbers) - 1
    aim = wanted[chosen] if damping.ratios is None else np.array(damping.ratios)
    if len(aim) != len(chosen):
        raise InputError(
            f"damping.ratios: {len(aim)} numbers for {len(chosen)} mode(s); see damping.modes",
            where,
        )
    w = modes.frequencies
    columns = np.column_stack([0.5 / w, 0.5 * w])[:, MODES - len(chosen) :]
    factors = np.linalg.lstsq(columns[chosen], aim)[0]
    return np.asarray(columns @ factors)


def dashpots(parts: list[Part], modes: Modes) -> Floats:
    """C = sum 2 xi_e/omega_e K_e, omega_e of the mode in which the part stores the largest share.

    Of springs and hinges these are c_2 and c_3 of Eq. 6.5-6.7 (c_3 once for each ground spring),
    of the bearings c_1 of Eq. 6.4-6.7, zero in Table 6.2.
    """
    matrix = np.zeros((len(modes.shapes), len(modes.shapes)))
    for part in parts:
        share = energies(part, modes.shapes) / modes.frequencies**2
        matrix += 2.0 * part[0] / modes.frequencies[int(np.argmax(share))] * part[1]
    return matrix


def _modal_ratios(damping: Damping, wanted: Floats, where: str) -> Floats:
    """One ratio for each mode, or one for all; by default those of the parts."""
    if damping.ratios is None:
        return wanted
    if len(damping.ratios) not in (1, len(wanted)):
        raise InputError(
            f"damping.ratios: {len(damping.ratios)} numbers, but without its bearings the "
            f"structure has {len(wanted)} mode(s); give one for each, or one for all",
            where,
        )
    return np.full(len(wanted), damping.ratios)


def _source_matrix(structure: Structure, matrices: Matrices, modes: Modes) -> Floats:
    """C = a M + b K', K' the stiffness without the bearings; a and b give modes 1 and 2 of the
    whole structure the ratios of all parts, or those that are given.
    """
    parts = [*own_parts(structure, matrices), *line_parts(structure, matrices)]
    wanted = structure.damping.ratios or tuple(weighed_ratios(parts, modes))[:MODES]
    stiffness = matrices.springs + hinge_stiffness(structure, matrices)
    modal = energies((0.0, stiffness), modes.shapes)
    count = min(MODES, len(modes.frequencies))
    equations = np.column_stack([np.ones(count), modal[:count]])
    right = 2.0 * np.array(wanted[:count]) * modes.frequencies[:count]
    a, b = np.linalg.lstsq(equations, right)[0]
    return np.asarray(a * matrices.mass + b * stiffness)


def build_damping(structure: Structure, matrices: Matrices, modes: Modes) -> Floats:
    """The damping matrix [n, n].

    Parameters
    ----------
    structure : with the damping to build.
    matrices, modes : of the structure; modes with the equivalent stiffness of the bearings.

    Raises
    ------
    InputError : ratios or modes that the structure does not have, or damping that would feed
        energy into a mode.
    """
    damping, parts, where = structure.damping, own_parts(structure, matrices), structure.name
    if damping.kind == "source":
        matrix = _source_matrix(structure, matrices, modes)
    elif damping.kind == "none":
        matrix = np.zeros_like(matrices.mass)
    elif damping.kind == "element":
        matrix = dashpots(parts, bare_modes(structure, matrices))
        matrix += dashpots(line_parts(structure, matrices), modes)
    else:
        bare = bare_modes(structure, matrices)
        if not len(bare.frequencies):  # everything stands on bearings
            return np.zeros_like(matrices.mass)
        wanted = weighed_ratios(parts, bare)
        if damping.kind == "modal":
            matrix = _from_ratios(matrices.mass, bare, _modal_ratios(damping, wanted, where))
        else:
            ratios = _rayleigh_ratios(damping, bare, wanted, where)
            matrix = _from_ratios(matrices.mass, bare, ratios)
    _check_sign(matrix, matrices.mass, damping, where)
    return matrix


def _check_sign(matrix: Floats, mass: Floats, damping: Damping, where: str) -> None:
    """A line through two ratios may be negative between or beyond them."""
    values = eigh(matrix, mass, eigvals_only=True)
    if values[0] < NEGATIVE * abs(values[-1]):
        raise InputError(
            f'damping.kind = "{damping.kind}" feeds energy into some motion: what gives two modes '
            "these ratios gives others a negative one; choose other modes or ratios, or "
            'kind = "modal"',
            where,
        )
