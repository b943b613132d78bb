"""JRA equivalent linearisation of high damping rubber (Eq. 6.1-6.3)."""

from functools import cache
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from thermobearing.border.errors import InputError, nearest
from thermobearing.border.library import data_path
from thermobearing.border.schema import Strict, validated
from thermobearing.border.toml import read_toml
from thermobearing.cyclic.equivalent import solve_backbone
from thermobearing.model.earlier import BilinearParameters

NEWTON_PER_KILONEWTON = 1e3
Kind = Literal["HDR", "HDR-S"]


class DesignRubber(Strict):
    """Coefficients of one rubber: G_e [MPa] and h_B by powers of the design shear strain."""

    name: str
    kind: Kind
    shear_modulus: Annotated[list[float], Field(min_length=1)]
    damping_ratio: Annotated[list[float], Field(min_length=1)]
    note: str = ""


class Curves(Strict):
    """The file of design curves, with the strains it may be used for."""

    citation: str
    smallest_strain: Annotated[float, Field(ge=0)]
    largest_strain: Annotated[float, Field(gt=0)]
    compounds: list[DesignRubber]


@cache
def load_curves() -> Curves:
    """The design curves shipped with the package.

    Returns
    -------
    Curves

    Examples
    --------
    >>> load_curves().largest_strain
    2.5
    """
    path = data_path("rubber", "jra-hdr.toml")
    return validated(Curves, read_toml(path), str(path))


def load_rubber(name: str, kind: Kind = "HDR") -> DesignRubber:
    """A compound by name and kind.

    Parameters
    ----------
    name : "G8", "G10" or "G12".
    kind : "HDR" or "HDR-S".

    Returns
    -------
    DesignRubber

    Raises
    ------
    InputError : no such compound.

    Examples
    --------
    >>> load_rubber("G8").damping_ratio[0]
    0.21615
    """
    known = [item for item in load_curves().compounds if item.kind == kind]
    for item in known:
        if item.name == name:
            return item
    names = [item.name for item in known] or ["HDR", "HDR-S"]
    wrong = name if known else kind
    raise InputError(f'no {kind} rubber is called "{wrong}"{nearest(wrong, names)}')


def checked_strain(strain: float) -> float:
    """The strain, if the curves may be used for it.

    Parameters
    ----------
    strain : design shear strain.

    Returns
    -------
    float : the same.

    Raises
    ------
    InputError : it is outside the range of the curves, 0.2 to 2.5.

    Examples
    --------
    >>> checked_strain(1.75)
    1.75
    """
    curves = load_curves()
    if not curves.smallest_strain <= strain <= curves.largest_strain:
        raise InputError(
            f"design shear strain {strain:.3g}: the curves are for {curves.smallest_strain:g} to "
            f"{curves.largest_strain:g}; choose a thicker or thinner bearing"
        )
    return strain


def shear_modulus(compound: DesignRubber, strain: float) -> float:
    """Design equivalent shear modulus G_e [MPa] at a design shear strain (Eq. 6.2).

    Parameters
    ----------
    compound : from `load_rubber`.
    strain : design shear strain, in [0.2, 2.5].

    Returns
    -------
    float : G_e [MPa].

    Raises
    ------
    InputError : the strain is outside the range of the curves.

    Examples
    --------
    >>> round(shear_modulus(load_rubber("G8"), 178 / 112), 4)
    0.8134
    """
    powers = np.arange(len(compound.shear_modulus))
    return float(np.array(compound.shear_modulus) @ checked_strain(strain) ** powers)


def damping_ratio(compound: DesignRubber, strain: float) -> float:
    """Design equivalent damping ratio h_B at a design shear strain (Eq. 6.3).

    Parameters
    ----------
    compound : from `load_rubber`.
    strain : design shear strain, in [0.2, 2.5].

    Returns
    -------
    float : h_B.

    Raises
    ------
    InputError : the strain is outside the range of the curves.

    Examples
    --------
    >>> round(damping_ratio(load_rubber("G8"), 178 / 112), 4)
    0.1513
    """
    powers = np.arange(len(compound.damping_ratio))
    return float(np.array(compound.damping_ratio) @ checked_strain(strain) ** powers)


def equivalent_stiffness(
    compound: DesignRubber, area: float, total_rubber_thickness: float, displacement: float
) -> float:
    """K_B = G_e A_e / sum t_e (Eq. 6.1) [kN/mm].

    Parameters
    ----------
    compound : from `load_rubber`.
    area : effective plan area A_e, without side cover [mm2], > 0.
    total_rubber_thickness : [mm], > 0.
    displacement : design displacement [mm], within the strains of the curves.

    Returns
    -------
    float : K_B [kN/mm].

    Raises
    ------
    InputError : the strain is outside the range of the curves.

    Examples
    --------
    >>> round(equivalent_stiffness(load_rubber("G8"), 360_000.0, 112.0, 178.0), 3)
    2.614
    """
    modulus = shear_modulus(compound, displacement / total_rubber_thickness)
    return modulus * area / total_rubber_thickness / NEWTON_PER_KILONEWTON


def equivalent_bilinear(
    stiffness: float, damping: float, displacement: float, stiffness_ratio: float
) -> BilinearParameters:
    """Bilinear model with a given equivalent stiffness and damping ratio at a displacement.

    Equal peak force and loop area; the equation is at `equivalent.solve_backbone`.

    Parameters
    ----------
    stiffness : K_B [kN/mm], > 0.
    damping : h_B, in (0, 0.6).
    displacement : u at which both hold [mm], > 0; for an effective displacement factor c_B give
        c_B u_B here and in the stiffness.
    stiffness_ratio : alpha = K_2/K_1, in (0, 1).

    Returns
    -------
    BilinearParameters : Q_d [kN], K_1 and K_2 [kN/mm].

    Raises
    ------
    InputError : no bilinear loop is that fat.

    Examples
    --------
    >>> design = equivalent_bilinear(2.615, 0.1513, 178.0, 0.19)
    >>> round(design.strength), round(design.post_yield, 2), round(design.initial, 1)
    (120, 1.94, 10.2)
    """
    for name, value, low, high in (
        ("stiffness", stiffness, 0.0, np.inf),
        ("damping", damping, 0.0, 0.6),
        ("displacement", displacement, 0.0, np.inf),
        ("stiffness_ratio", stiffness_ratio, 0.0, 1.0),
    ):
        if not low < value < high:
            raise InputError(f"{name} = {value:g}: must be between {low:g} and {high:g}")
    found = solve_backbone(stiffness, damping, displacement, stiffness_ratio)
    if found is None:
        raise InputError(
            f"no bilinear model with K_2/K_1 = {stiffness_ratio:g} has a damping ratio of "
            f"{damping:g}; try a smaller ratio"
        )
    return found
