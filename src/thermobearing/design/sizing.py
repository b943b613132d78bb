"""Size of a bearing for a design displacement, and the checks of a designer."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from thermobearing.border.errors import InputError
from thermobearing.border.schema import Strict, in_unit
from thermobearing.design.rubber import (
    NEWTON_PER_KILONEWTON,
    DesignRubber,
    damping_ratio,
    equivalent_stiffness,
)

MOST_LAYERS = 60
STRAIN_LIMIT, DUCTILITY_LIMIT = 2.5, 3.0  # Table 3.4, section 6.3.3


class SizingRules(Strict):
    """How a bearing is sized; the defaults give the source's bearing for its displacement.

    As many layers as keep the design strain, then the smallest square plan (in whole steps)
    with the second shape factor and under the stress. `strain_limit` and `ductility_limit` are
    what the largest strain and the pier's ductility are judged by, at every temperature.
    """

    layer_thickness: Annotated[float, in_unit("mm"), Field(ge=0.5, le=200)] = 14.0  # Table 6.1
    design_strain: Annotated[float, Field(ge=0.05, le=2.5)] = 1.75
    second_shape_factor: Annotated[float, Field(ge=0.1, le=100)] = 5.0
    stress: Annotated[float, in_unit("MPa"), Field(ge=0.05, le=200)] = 6.0
    plan_step: Annotated[float, in_unit("mm"), Field(ge=1, le=1000)] = 50.0
    strain_limit: Annotated[float, Field(ge=0.05, le=5)] = STRAIN_LIMIT
    ductility_limit: Annotated[float, Field(ge=0.1, le=20)] = DUCTILITY_LIMIT


@dataclass(frozen=True)
class Size:
    """A square bearing.

    Attributes
    ----------
    side : of the plan [mm].
    layers : number of rubber layers.
    layer_thickness : [mm].
    """

    side: float
    layers: int
    layer_thickness: float

    @property
    def area(self) -> float:
        """[mm2]"""
        return self.side**2

    @property
    def total_rubber_thickness(self) -> float:
        """[mm]"""
        return self.layers * self.layer_thickness

    @property
    def first_shape_factor(self) -> float:
        """Plan area over the free side area of one layer."""
        return self.side / (4.0 * self.layer_thickness)

    @property
    def second_shape_factor(self) -> float:
        """Side over total rubber thickness."""
        return self.side / self.total_rubber_thickness


@dataclass(frozen=True)
class Check:
    """One line of a calculation sheet.

    `least` says whether the limit is a lower one, `part` which group of lines or which pier it is
    about (empty where there is one), `unverified` that no printed source was read for the limit.
    """

    what: str
    value: float
    limit: float
    unit: str
    source: str
    least: bool = False
    part: str = ""
    unverified: bool = False

    @property
    def used(self) -> float:
        """Return the share of the limit that is used; above 1 it is exceeded."""
        return self.limit / self.value if self.least else self.value / self.limit

    @property
    def passed(self) -> bool:
        """Whether the value keeps the limit."""
        return self.value >= self.limit if self.least else self.value <= self.limit

    @property
    def verdict(self) -> str:
        """OK or NG."""
        return "OK" if self.passed else "NG"


def size_bearing(displacement: float, weight: float, rules: SizingRules) -> Size:
    """The smallest bearing that keeps the rules.

    Parameters
    ----------
    displacement : design displacement u_B [mm], > 0.
    weight : vertical load of one bearing [kN], > 0.
    rules : of sizing.

    Returns
    -------
    Size

    Raises
    ------
    InputError : it would take more than 60 layers.

    Examples
    --------
    >>> size = size_bearing(178.0, 784.8, SizingRules())
    >>> size.side, size.layers
    (600.0, 8)
    """
    if not displacement > 0.0 or not weight > 0.0:
        raise InputError(f"displacement {displacement:g} mm and weight {weight:g} kN must be > 0")
    layers = max(1, math.ceil(displacement / (rules.design_strain * rules.layer_thickness) - 1e-9))
    if layers > MOST_LAYERS:
        raise InputError(
            f"a design displacement of {displacement:.0f} mm needs {layers} layers of "
            f"{rules.layer_thickness:g} mm; at most {MOST_LAYERS} make sense"
        )
    stable = rules.second_shape_factor * layers * rules.layer_thickness
    strong = math.sqrt(weight * NEWTON_PER_KILONEWTON / rules.stress)
    steps = math.ceil(max(stable, strong) / rules.plan_step - 1e-9)
    return Size(steps * rules.plan_step, layers, rules.layer_thickness)


def checks_of(
    size: Size, weight: float, strain: float, rules: SizingRules, part: str = ""
) -> list[Check]:
    """The calculation sheet of a bearing: strain, stress, shape factors.

    Parameters
    ----------
    size : of the bearing.
    weight : vertical load of one bearing [kN], > 0.
    strain : largest shear strain found.
    rules : of sizing.
    part : group of lines that it is about.

    Returns
    -------
    list of Check

    Examples
    --------
    >>> sheet = checks_of(Size(600.0, 8, 14.0), 784.5, 1.6, SizingRules())
    >>> {check.verdict for check in sheet}
    {'OK'}
    """
    stress = weight * NEWTON_PER_KILONEWTON / size.area
    first, second = size.first_shape_factor, size.second_shape_factor
    far = "largest strain tested, Table 3.4"
    far = far if rules.strain_limit == STRAIN_LIMIT else "sizing.strain_limit"
    tests = "of the tests, section 3.3"
    chosen, usual = "chosen", "usual in Japan"
    return [
        Check("shear strain", strain, rules.strain_limit, "1", far, part=part),
        Check("compressive stress", stress, rules.stress, "MPa", tests, part=part),
        Check("first shape factor", first, 5.0, "1", chosen, True, part, True),
        Check("second shape factor", second, 4.0, "1", usual, True, part, True),
    ]


def pier_checks(ductility: Mapping[str, float], rules: SizingRules) -> list[Check]:
    """Return the check of the ductility of every pier that has a hinge.

    Parameters
    ----------
    ductility : by name of the pier, empty where there is one; NaN without a hinge.
    rules : of sizing.

    Returns
    -------
    list of Check

    Examples
    --------
    >>> [check.verdict for check in pier_checks({"P1": 1.2, "P2": 3.5}, SizingRules())]
    ['OK', 'NG']
    """
    large = "a large value for a pier in an isolated bridge, section 6.3.3"
    large = large if rules.ductility_limit == DUCTILITY_LIMIT else "sizing.ductility_limit"
    return [
        Check("pier ductility", value, rules.ductility_limit, "1", large, part=pier)
        for pier, value in ductility.items()
        if not math.isnan(value)
    ]


def design_values(compound: DesignRubber, size: Size, displacement: float) -> tuple[float, float]:
    """K_B [kN/mm] and h_B of a size at a displacement.

    Parameters
    ----------
    compound : from `load_rubber`.
    size : of the bearing.
    displacement : [mm], within the strains of the curves.

    Returns
    -------
    K_B [kN/mm] and h_B.

    Raises
    ------
    InputError : the strain is outside the range of the curves.

    Examples
    --------
    >>> from thermobearing.design.rubber import load_rubber
    >>> stiffness, damping = design_values(load_rubber("G8"), Size(600.0, 8, 14.0), 178.0)
    >>> round(stiffness, 3), round(damping, 4)
    (2.614, 0.1513)
    """
    thickness = size.total_rubber_thickness
    stiffness = equivalent_stiffness(compound, size.area, thickness, displacement)
    return stiffness, damping_ratio(compound, displacement / thickness)
