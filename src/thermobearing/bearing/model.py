"""A rubber bearing as data: plan, layers, materials and identified parameters.

Everything is frozen; derived numbers are properties. Units are those of the field
annotations (kN, mm, s, degC; thermal properties as tables print them).
"""

import math
from typing import Annotated, Any, Literal

from pydantic import Field, PrivateAttr

from thermobearing.bearing.schema import Strict, in_unit
from thermobearing.units import CUBIC_MM_PER_CUBIC_M

Length = Annotated[float, in_unit("mm"), Field(gt=0)]


class SquarePlan(Strict):
    """Square bearing."""

    shape: Literal["square"]
    side: Length

    @property
    def area(self) -> float:
        """Gross plan area [mm2]."""
        return self.side * self.side

    @property
    def perimeter(self) -> float:
        """[mm]"""
        return 4.0 * self.side

    @property
    def breadth(self) -> float:
        """Size in the direction of motion [mm]."""
        return self.side


class RectangularPlan(Strict):
    """Rectangular bearing; `length` lies in the direction of motion."""

    shape: Literal["rectangular"]
    length: Length
    width: Length

    @property
    def area(self) -> float:
        """Gross plan area [mm2]."""
        return self.length * self.width

    @property
    def perimeter(self) -> float:
        """[mm]"""
        return 2.0 * (self.length + self.width)

    @property
    def breadth(self) -> float:
        """Size in the direction of motion [mm]."""
        return self.length


class CircularPlan(Strict):
    """Circular bearing."""

    shape: Literal["circular"]
    diameter: Length

    @property
    def area(self) -> float:
        """Gross plan area [mm2]."""
        return 0.25 * math.pi * self.diameter**2

    @property
    def perimeter(self) -> float:
        """[mm]"""
        return math.pi * self.diameter

    @property
    def breadth(self) -> float:
        """Size in the direction of motion [mm]."""
        return self.diameter


Plan = Annotated[SquarePlan | RectangularPlan | CircularPlan, Field(discriminator="shape")]


class Geometry(Strict):
    """Plan and thicknesses; shims lie between the rubber layers, end plates outside them."""

    plan: Plan
    rubber_layers: Annotated[int, Field(ge=1, le=200)]
    rubber_thickness: Length
    shim_thickness: Length
    end_plate_thickness: Length

    @property
    def total_rubber_thickness(self) -> float:
        """[mm]"""
        return self.rubber_layers * self.rubber_thickness

    @property
    def first_shape_factor(self) -> float:
        """S1: plan area over the free side area of one rubber layer."""
        return self.plan.area / (self.plan.perimeter * self.rubber_thickness)

    @property
    def second_shape_factor(self) -> float:
        """S2: size in the direction of motion over the total rubber thickness."""
        return self.plan.breadth / self.total_rubber_thickness


class Material(Strict):
    """Thermal properties of one material, constant with temperature (assumption 3 of 4.2.2)."""

    conductivity: Annotated[float, in_unit("W/(m K)"), Field(gt=0)]
    specific_heat: Annotated[float, in_unit("J/(kg K)"), Field(gt=0)]
    density: Annotated[float, in_unit("kg/m^3"), Field(gt=0)]

    @property
    def volumetric_heat(self) -> float:
        """Heat capacity per volume [kN mm/(mm3 K)]."""
        return self.specific_heat * self.density / CUBIC_MM_PER_CUBIC_M


class Materials(Strict):
    """What the stack is made of, and how its side exchanges heat with the air."""

    rubber: Material
    steel: Material
    side_film: Annotated[float, in_unit("W/(m^2 K)"), Field(ge=0)]


class RubberHysteresis(Strict):
    """Identified parameters of ONE rubber layer (Eq. 4.34-4.37; symbols of Table 4.2)."""

    post_yield_ratio: Annotated[float, Field(gt=0, lt=1)]  # alpha_0
    layer_stiffness: Annotated[float, in_unit("kN/mm"), Field(gt=0)]  # K_r
    shape: Annotated[float, Field(gt=-1)]  # s
    yield_displacement: Length  # d_y
    hardening: Annotated[float, Field(ge=0)]  # b
    elastic_temperature_coefficient: float  # m_T
    hysteretic_temperature_coefficient: float  # n_T
    reference_temperature: Annotated[float, in_unit("degC"), Field(ge=-100, le=100)]


class Cells(Strict):
    """Heat cells through the thickness of one part each."""

    end_plate: Annotated[int, Field(ge=1, le=1000)]
    rubber: Annotated[int, Field(ge=1, le=1000)]
    shim: Annotated[int, Field(ge=1, le=1000)]


class Bearing(Strict):
    """One bearing, complete.

    Attributes
    ----------
    name, kind, description, citation : what it is and where its numbers come from.
    geometry, materials, hysteresis, cells : see those classes.
    """

    name: Annotated[str, Field(min_length=1)]
    kind: Literal["HDR"]
    description: str = ""
    citation: str = ""
    geometry: Geometry
    materials: Materials
    hysteresis: RubberHysteresis
    cells: Cells
    _sources: dict[str, str] = PrivateAttr(default_factory=dict)

    @property
    def sources(self) -> dict[str, str]:
        """Where each number comes from, by dotted key (`geometry.rubber_thickness`)."""
        return dict(self._sources)

    @property
    def area(self) -> float:
        """Gross plan area [mm2]."""
        return self.geometry.plan.area

    @property
    def total_rubber_thickness(self) -> float:
        """[mm]"""
        return self.geometry.total_rubber_thickness

    def with_sources(self, sources: dict[str, str]) -> "Bearing":
        """The same bearing, remembering where its numbers come from."""
        copy: Any = self.model_copy()
        copy._sources = dict(sources)
        return copy  # type: ignore[no-any-return]
