"""Rubber bearings as data: plan, layers, materials and calibrated parameters.

Records are immutable; derived numbers are properties. Units are those of the field
annotations (kN, mm, s, degC; thermal properties as tables print them).
"""

import math
from collections.abc import Sequence
from html import escape
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, Protocol

from pydantic import Field, ValidationInfo, field_validator, model_validator

from thermobearing.bearing.cells import Cells
from thermobearing.bearing.exposure import Exposure
from thermobearing.border.errors import InputError
from thermobearing.border.library import Sourced
from thermobearing.border.schema import RATIO, Name, Strict, in_unit, updated
from thermobearing.border.units import CUBIC_MM_PER_CUBIC_M, NEWTON_PER_KILONEWTON
from thermobearing.laws import find_law, laws_to_apply

LawCelsius = Annotated[float, in_unit("degC"), Field(ge=-150, le=300)]
Factor = Annotated[float, Field(ge=1e-3, le=1e3)]
LawNumber = Annotated[float, Field(strict=True, ge=-1e12, le=1e12)]  # and the limits of its law
Factors = Annotated[list[Factor], Field(min_length=2, max_length=100)]


AxialForce = Annotated[float, in_unit("kN"), Field(ge=-1e6, le=1e6)]  # compression is positive


class TemperatureLaw(Strict):
    """Range of the law of Eq. 4.34, and a table or a registered law that multiplies it.

    The viscosity c_v of the rate branch depends on temperature by the table only.

    Attributes
    ----------
    coldest, warmest : temperatures of the rubber in the tests that the law was identified on
        [degC]; those of the table if not given.
    temperatures : of the table [degC], increasing.
    elastic, hysteretic : factors on the two stiffness terms there; between them a monotone cubic in
        the logarithm, beyond them a constant slope. A table that is the complete law needs
        m_T = n_T = 0.
    viscosity : factors there on c_v of the rate branch, alone or besides those on stiffness; the
        branch takes them at the temperatures of the layers. Without them c_v is constant.
    law, parameters : name of a law of `laws.register` in place of a table, with its digest or
        without, and parameters that differ from its defaults.

    Examples
    --------
    >>> TemperatureLaw(temperatures=[-20, 40], elastic=[1.4, 0.9], hysteretic=[2, 0.8]).range
    (-20.0, 40.0)
    """

    coldest: LawCelsius | None = None
    warmest: LawCelsius | None = None
    temperatures: Annotated[list[LawCelsius], Field(min_length=2, max_length=100)] | None = None
    elastic: Factors | None = None
    hysteretic: Factors | None = None
    viscosity: Factors | None = None
    law: Name | None = None
    parameters: dict[str, LawNumber] | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        messages = []
        columns = ("temperatures", "elastic", "hysteretic", "viscosity")
        table = [name for name in columns if name in values]
        if ("coldest" in values) != ("warmest" in values):
            messages.append("give both coldest and warmest, or neither")
        factors = table[1:] if table[:1] == ["temperatures"] else []
        if table and factors not in (["elastic", "hysteretic"], ["viscosity"], [*columns[1:]]):
            messages.append(
                "a table needs temperatures, elastic and hysteretic, or temperatures and viscosity"
            )
        elif len({len(values[name]) for name in table if isinstance(values[name], list)}) > 1:
            messages.append("temperatures, elastic, hysteretic and viscosity must be equally long")
        if table and "law" in values:
            messages.append("give a table or a law, not both")
        if "parameters" in values and "law" not in values:
            messages.append("parameters need a law")
        return messages

    def model_post_init(self, context: Any) -> None:
        """Compare values after conversion of units."""
        values = self.temperatures or []
        if any(after <= before for before, after in pairwise(values)):
            raise ValueError("temperatures must increase")
        if self.coldest is not None and self.warmest is not None and self.coldest >= self.warmest:
            raise ValueError("coldest must be below warmest")

    @property
    def has_factors(self) -> bool:
        """Whether there are factors besides those of m_T and n_T."""
        return self.temperatures is not None or self.law is not None

    @property
    def scales_stiffness(self) -> bool:
        """Whether these factors are on stiffness too, not on the viscosity alone."""
        return self.elastic is not None or self.law is not None

    @property
    def range(self) -> tuple[float, float] | None:
        """Coldest and warmest temperature of the law [degC]."""
        if self.coldest is not None and self.warmest is not None:
            return self.coldest, self.warmest
        if self.temperatures is not None:
            return self.temperatures[0], self.temperatures[-1]
        return None


class HysteresisLaw(Strict):
    """A registered law of Z in place of Eq. 4.35.

    Attributes
    ----------
    law : name of a law of `laws.register`, with its digest or without.
    parameters : those that differ from the defaults of the law.

    Examples
    --------
    >>> HysteresisLaw(law="mine", parameters={"power": 1.5}).law
    'mine'
    """

    law: Name
    parameters: dict[str, LawNumber] | None = None


TEMPERATURE_COEFFICIENTS = ("elastic_temperature_coefficient", "hysteretic_temperature_coefficient")


def laws_of_command(data: Any) -> list[str]:
    """Return the laws of the command for a bearing; no registered one if it names one itself."""
    table = data if isinstance(data, dict) else {}
    laws = [table.get("temperature_law"), table.get("hysteresis_law")]
    # A bearing that names a registered law keeps it against --law.
    names_law = any(isinstance(law, dict | Strict) and dict(law).get("law") for law in laws)
    return [name for name in laws_to_apply() if not names_law or find_law(name).function is None]


def with_laws(data: Any, names: Sequence[str]) -> Any:
    """Return the table of a bearing with laws; m_T = n_T = 0 with a registered temperature law."""
    for law in map(find_law, names if isinstance(data, dict) else ()):
        table, _, key = law.key.partition(".")
        rubber, part = (
            part.model_dump() if isinstance(part, Strict) else part
            for part in (data.get("hysteresis"), data.get(table))
        )
        # A law of the package sets keys of a table; a registered one is named in its table.
        if law.function is None:
            if part is None and law.kind == "lead":
                raise InputError(f'law = "{law.name}": needs a bearing with lead')
            data = data | {table: updated(part, dict.fromkeys(law.keys_in_table, law.value))}
            if law.kind == "hysteresis":
                data.pop("hysteresis_law", None)
        else:
            data = data | {table: {key: law.value}}
            if law.kind == "temperature":
                data["hysteresis"] = updated(rubber, dict.fromkeys(TEMPERATURE_COEFFICIENTS, 0.0))
    return data


Ends = Field(min_length=2, max_length=2)
Strain = Annotated[float, RATIO, Field(ge=0, le=10)]
Rate = Annotated[float, in_unit("1/s"), Field(ge=0, le=1e4)]
Celsius = Annotated[float, in_unit("degC"), Field(ge=-150, le=400)]
Count = Annotated[float, Field(ge=0, le=1e6)]


class Validity(Strict):
    """Calibration range: lowest and highest value of each quantity in the tests of a bearing.

    Missing entries are unknown; rubber temperatures are in `temperature_law`.

    Attributes
    ----------
    strain : largest shear strain of a test, as a share: 2.5 is 250 %, in [0, 10].
    strain_rate : largest speed of a test over the total rubber thickness [1/s], in [0, 1e4].
    ambient : ambient temperature [degC], in [-150, 400].
    cycles : consecutive ones of at least half the largest strain, in [0, 1e6].
    lead_temperature : of the lead cores [degC], in [-150, 400].

    Examples
    --------
    >>> Validity(strain=[0.5, 2.5], ambient=[-20, 23]).ranges()
    {'strain': (0.5, 2.5), 'ambient': (-20.0, 23.0)}
    """

    strain: Annotated[list[Strain], Ends] | None = None
    strain_rate: Annotated[list[Rate], Ends] | None = None
    ambient: Annotated[list[Celsius], Ends] | None = None
    cycles: Annotated[list[Count], Ends] | None = None
    lead_temperature: Annotated[list[Celsius], Ends] | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        if set(values) & set(cls.model_fields):
            return []
        return [f"give at least one of {', '.join(cls.model_fields)}, as [lowest, highest]"]

    def model_post_init(self, context: Any) -> None:
        """Compare values after conversion of units."""
        for name, (low, high) in self.ranges().items():
            if low > high:
                raise ValueError(f"{name}: {low:g} is above {high:g}; write [lowest, highest]")

    def ranges(self) -> dict[str, tuple[float, float]]:
        """Lowest and highest value of each known quantity."""
        limits = {name: getattr(self, name) for name in type(self).model_fields}
        return {name: (ends[0], ends[1]) for name, ends in limits.items() if ends is not None}


class Tested(Protocol):
    """A bearing with an optional calibration range."""

    @property
    def tested_range(self) -> Validity | None:
        """The calibration range; None if not given."""


def calibration_ranges(bearing: Tested) -> dict[str, tuple[float, float]] | None:
    """Return the calibration range of a bearing by quantity; None if its file has none."""
    return None if bearing.tested_range is None else bearing.tested_range.ranges()


# Ranges are those of real bearings with a factor of ten or more on either side: values outside
# are errors in a unit or an exponent.
PlanSize = Annotated[float, in_unit("mm"), Field(ge=1, le=1e5)]  # bearings are 50 mm to 2 m
Thickness = Annotated[float, in_unit("mm"), Field(ge=0.05, le=1e3)]  # 0.5 to 100 mm
Stiffness = Annotated[float, in_unit("kN/mm"), Field(ge=1e-4, le=1e6)]  # 0.5 to 4000 kN/mm
# Stiffness of rubber changes by exp(m_T (T - T_0)/100); identified are -0.3 to -2.2, and rubber
# that stiffens by its entropy when warm has up to +0.3.
TemperatureCoefficient = Annotated[float, Field(ge=-20, le=5)]
SOFTEST, HARDEST = 1e-3, 1e4  # modulus K_r t_r / A [MPa]; rubber has 0.2 to 20
EARLIEST, LATEST = 1e-3, 10.0  # yield strain d_y / t_r; identified are 0.06 to 0.5
THINNEST_SEALING = 0.05  # [mm]


class _PlanShape(Strict):
    """Area, perimeter and breadth of a plan: a rectangle, or the ellipse inscribed in it."""

    _share: ClassVar[float] = 1.0  # of the rectangle

    def _sides(self) -> tuple[float, float]:
        """Return the sizes along the direction of motion and across [mm]."""
        raise NotImplementedError

    @property
    def area(self) -> float:
        """Plan area with that of lead cores [mm2]."""
        along, across = self._sides()
        return self._share * (along * across)

    @property
    def perimeter(self) -> float:
        """Outer perimeter [mm]."""
        return self._share * (2.0 * sum(self._sides()))

    @property
    def inner_perimeter(self) -> float:
        """Perimeter of an open hole [mm]."""
        return 0.0

    @property
    def breadth(self) -> float:
        """Size in the direction of motion [mm]."""
        return self._sides()[0]


class SquarePlan(_PlanShape):
    """Square bearing."""

    shape: Literal["square"]
    side: PlanSize

    def _sides(self) -> tuple[float, float]:
        return self.side, self.side


class RectangularPlan(_PlanShape):
    """Rectangular bearing; `length` lies in the direction of motion."""

    shape: Literal["rectangular"]
    length: PlanSize
    width: PlanSize

    def _sides(self) -> tuple[float, float]:
        return self.length, self.width


class CircularPlan(_PlanShape):
    """Circular bearing; `hole` is the diameter of an open hole along its axis, if it has one."""

    shape: Literal["circular"]
    diameter: PlanSize
    hole: PlanSize | None = None
    _share: ClassVar[float] = 0.25 * math.pi

    def model_post_init(self, context: Any) -> None:
        """Compare both diameters after conversion of units."""
        if self.hole is not None and self.hole >= self.diameter:
            raise ValueError(
                f"hole = {self.hole:g} mm: must be less than diameter, {self.diameter:g} mm"
            )

    @property
    def area(self) -> float:
        """Plan area with that of lead cores, without an open hole [mm2]."""
        gross = super().area
        return gross if self.hole is None else gross - self._share * self.hole**2

    @property
    def inner_perimeter(self) -> float:
        """Perimeter of an open hole [mm]."""
        return math.pi * (self.hole or 0.0)

    def _sides(self) -> tuple[float, float]:
        return self.diameter, self.diameter


Plan = Annotated[SquarePlan | RectangularPlan | CircularPlan, Field(discriminator="shape")]


class Geometry(Strict):
    """Plan and thicknesses; shims lie between the rubber layers, end plates outside them.

    Sealing plates, if there are any, lie between the outer rubber layers and the end plates;
    lead cores run from one end plate to the other.
    """

    plan: Plan
    rubber_layers: Annotated[int, Field(ge=1, le=200)]
    rubber_thickness: Thickness
    shim_thickness: Thickness
    end_plate_thickness: Thickness
    sealing_plate_thickness: Annotated[float, in_unit("mm"), Field(ge=0, le=1e3)] = 0.0

    @field_validator("sealing_plate_thickness")
    @classmethod
    def _none_or_a_plate(cls, thickness: float) -> float:
        if 0.0 < thickness < THINNEST_SEALING:
            raise ValueError(f"{thickness:g} mm must be 0 or at least {THINNEST_SEALING:g} mm")
        return thickness

    @property
    def total_rubber_thickness(self) -> float:
        """[mm]"""
        return self.rubber_layers * self.rubber_thickness

    @property
    def first_shape_factor(self) -> float:
        """S1: plan area over the free side area of one rubber layer."""
        free = self.plan.perimeter + self.plan.inner_perimeter
        return self.plan.area / (free * self.rubber_thickness)

    @property
    def second_shape_factor(self) -> float:
        """S2: size in the direction of motion over the total rubber thickness."""
        return self.plan.breadth / self.total_rubber_thickness


class Material(Strict):
    """Thermal properties of one material, independent of temperature (assumption 3 of 4.2.2)."""

    conductivity: Annotated[float, in_unit("W/(m K)"), Field(ge=1e-3, le=1e3)]  # 0.1 to 60
    specific_heat: Annotated[float, in_unit("J/(kg K)"), Field(ge=10, le=5e4)]  # 130 to 4200
    density: Annotated[float, in_unit("kg/m^3"), Field(ge=50, le=2e5)]  # 900 to 11 300

    @property
    def volumetric_heat(self) -> float:
        """Heat capacity per volume [kN mm/(mm3 K)]."""
        return self.specific_heat * self.density / CUBIC_MM_PER_CUBIC_M


class Materials(Strict):
    """Materials of the stack, and the film coefficient of its side."""

    rubber: Material
    steel: Material
    lead: Material | None = None
    side_film: Annotated[float, in_unit("W/(m^2 K)"), Field(ge=0, le=1e5)]  # air 5 to 100


SmallLoops = Literal["published", "closed"]
Hardening = Literal["printed", "monotone"]


class RubberHysteresis(Strict):
    """Identified parameters of ONE rubber layer (Eq. 4.34-4.37; symbols of Table 4.2).

    `small_loops` and `hardening_form` are the laws used in the calibration (core/hysteresis.py,
    core/hardening.py); by default the published ones.
    """

    post_yield_ratio: Annotated[float, Field(ge=1e-3, le=1)]  # alpha_0; 1 is linear rubber
    layer_stiffness: Stiffness  # K_r
    shape: Annotated[float, Field(ge=-0.999, le=100)]  # s; -1 unloads without end
    yield_displacement: Annotated[float, in_unit("mm"), Field(ge=1e-4, le=1e3)]  # d_y
    hardening: Annotated[float, Field(ge=0, le=20)]  # b; identified are 0.02 to 0.5
    elastic_temperature_coefficient: TemperatureCoefficient  # m_T
    hysteretic_temperature_coefficient: TemperatureCoefficient  # n_T
    reference_temperature: Annotated[float, in_unit("degC"), Field(ge=-100, le=100)]
    small_loops: SmallLoops | None = None
    hardening_form: Hardening | None = None


class Scragging(Strict):
    """Virgin stiffness of the rubber and its decay (core/scragging.py); optional.

    `amplitude` and `strain`: excess of the hysteretic part before any strain, and the shear
    strain in which it falls by 1/e (scragging). `mullins_amplitude`, `mullins_decay`,
    `mullins_renewal`: excess of the virgin share, the travel over the largest displacement in
    which that share falls by 1/e, and the relative growth of the largest displacement that
    brings it back. After the damage variables of Grant, Fenves & Whittaker (2004),
    "Bidirectional modelling of high-damping rubber bearings", Journal of Earthquake
    Engineering 8; the form is that of this package. Recovery in rests is ignored.
    """

    amplitude: Annotated[float, Field(ge=0, le=20)] = 0.0  # b
    strain: Annotated[float, Field(ge=1e-4, le=5)] = 0.1  # gamma
    mullins_amplitude: Annotated[float, Field(ge=0, le=5)] = 0.0  # a
    mullins_decay: Annotated[float, Field(ge=1e-3, le=1000)] = 4.0  # c
    mullins_renewal: Annotated[float, Field(ge=1e-4, le=10)] = 0.05  # l


Clock = Literal["steel", "lead"]
Softening = Annotated[float, in_unit("1/K"), Field(ge=0, le=0.1)]  # E2


class LeadCores(Strict):
    """Lead cores in parallel; numbers of ONE core (Eq. 5.1-5.7, Table 5.2).

    `softening` is E2 of sigma_Y exp(-E2 (T_l - T_0)), zero for constant strength, up to the warmest
    lead of the tests (`tested_range.lead_temperature`; T_0 where it is not given), and
    `softening_beyond_tests` the rate above it: by default that of the law softening-lead, zero for
    a strength that is kept at any temperature (law constant-lead). `confined` cores (in springs)
    conduct heat to the end plates only. `clock` selects the diffusivity that makes t+
    dimensionless: that of steel (Kalpakidis & Constantinou) or of lead (as published, Eq. 5.6); by
    default lead with the published scheme and steel otherwise. `surface_ratio` and `clock` are for
    `lead_ends = "half-space"`. `end_spreading` is for confined cores on finite plates (the
    default): the thermal resistance of the end plate for one core, relative to that of the plate
    alone.
    """

    cores: Annotated[int, Field(ge=1, le=1000)]  # n_l
    diameter: Annotated[float, in_unit("mm"), Field(ge=0.1, le=1e4)]
    stiffness: Stiffness  # K_l
    yield_stress: Annotated[float, in_unit("MPa"), Field(ge=0.1, le=1000)]  # sigma_Y; 7 to 20
    softening: Softening = 0.0
    softening_beyond_tests: Softening | None = None
    reference_temperature: Annotated[float, in_unit("degC"), Field(ge=-100, le=100)]  # T_0
    surface_ratio: Annotated[float, Field(ge=1e-3, le=1)] = 0.5  # p
    confined: bool
    clock: Clock | None = None
    end_spreading: Annotated[float, Field(ge=1e-3, le=1)] = 1.0

    @property
    def radius(self) -> float:
        """[mm]"""
        return 0.5 * self.diameter

    @property
    def core_area(self) -> float:
        """Of one core [mm2]."""
        return math.pi * self.radius**2

    @property
    def core_strength(self) -> float:
        """Q_l of one core at the reference temperature [kN]."""
        return self.yield_stress * self.core_area / NEWTON_PER_KILONEWTON


class RateDependence(Strict):
    """A dashpot and a spring in series, in parallel with the rubber (Eq. 5.38-5.39)."""

    stiffness: Stiffness  # K_v
    damping: Annotated[float, in_unit("kN s/mm"), Field(ge=1e-6, le=1e6)]  # c_v


RateFactor = Annotated[float, Field(ge=0, le=20)]


class RateBand(Strict):
    """Factor on the rate branch, and the range that tests leave open.

    A bearing without the table `rate` borrows the branch of another rubber by its moduli, which is
    the same in a compound and in a bearing of it.

    Attributes
    ----------
    factor : factor on K_v and c_v that acts, in [0, 20]; 1 by default, and 0 in the library where
        the branch is borrowed.
    lowest, highest : ends of the range of the factor, in [0, 20].
    shear_modulus, viscosity : K_v H/A [MPa] and c_v H/A [MPa s] of the borrowed branch.

    Examples
    --------
    >>> RateBand(lowest=0.2, highest=1.0).factor
    1.0
    """

    factor: RateFactor = 1.0
    lowest: RateFactor
    highest: RateFactor
    shear_modulus: Annotated[float, in_unit("MPa"), Field(ge=1e-4, le=1e5)] | None = None
    viscosity: Annotated[float, in_unit("MPa s"), Field(ge=1e-6, le=1e5)] | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        incomplete = ("shear_modulus" in values) != ("viscosity" in values)
        return ["give both shear_modulus and viscosity, or neither"] if incomplete else []

    def model_post_init(self, context: Any) -> None:
        """Compare the ends of the range."""
        if self.lowest > self.highest:
            raise ValueError(f"lowest = {self.lowest:g} is above highest = {self.highest:g}")


def refuse_two_branches(band: RateBand | None, *, has_branch: bool) -> None:
    """Raise ValueError if a rate band borrows a branch besides that of the table `rate`.

    Without either it has no effect: `rate` may be left out to see what it does.
    """
    if has_branch and band is not None and band.shear_modulus is not None:
        raise ValueError(
            "rate_band borrows a branch (shear_modulus, viscosity) only without the table rate"
        )


class Bearing(Sourced):
    """A layered rubber bearing.

    Attributes
    ----------
    name, kind, description, citation : identification and sources.
    geometry, materials, hysteresis, temperature_law, scragging, lead, rate, cells : see those
        classes; `temperature_law` is None if only m_T and n_T are stated, `scragging` for
        scragged rubber, `lead` without lead cores, `rate` without rate dependence.
    rate_band : how uncertain the rate dependence is (`RateBand`); None if that is not stated.
    poor_fit : why the calibrated parameters should not be used; such a file does not load.
    tested_range : calibration range (`Validity`); None if not given.
    hysteresis_law : a law of Z in place of Eq. 4.35 (`HysteresisLaw`); None: none.
    exposure : factors for long cold and ageing (`Exposure`); None: no factors.
    """

    name: Name
    kind: Literal["HDR", "LHDR", "LRB"]
    description: str = ""
    citation: str = ""
    poor_fit: str = ""
    geometry: Geometry
    materials: Materials
    hysteresis: RubberHysteresis
    temperature_law: TemperatureLaw | None = None
    hysteresis_law: HysteresisLaw | None = None
    tested_range: Validity | None = None
    scragging: Scragging | None = None
    lead: LeadCores | None = None
    rate: RateDependence | None = None
    rate_band: RateBand | None = None
    exposure: Exposure | None = None
    cells: Cells = Cells()

    @model_validator(mode="before")
    @classmethod
    def _use_applied_laws(cls, data: Any, info: ValidationInfo) -> Any:
        as_written = (info.context or {}).get("as_written")
        return data if as_written else with_laws(data, laws_of_command(data))

    @model_validator(mode="after")
    def _lead_fits_kind(self) -> "Bearing":
        with_lead = self.kind != "HDR"
        if with_lead and (self.lead is None or self.materials.lead is None):
            raise ValueError(f"a {self.kind} bearing needs the tables lead and materials.lead")
        if not with_lead and self.lead is not None:
            raise ValueError('kind "HDR" has no lead; use "LHDR" or "LRB"')
        if self.lead is not None and self.geometry.plan.inner_perimeter > 0.0:
            raise ValueError("geometry.plan.hole: a bearing with lead cores has no open hole")
        if self.lead_area >= self.area:
            raise ValueError(
                f"the lead cores have an area of {self.lead_area:g} mm2, the plan only "
                f"{self.area:g} mm2"
            )
        return self

    @model_validator(mode="after")
    def _has_one_branch(self) -> "Bearing":
        refuse_two_branches(self.rate_band, has_branch=self.rate is not None)
        return self

    @model_validator(mode="after")
    def _is_rubber(self) -> "Bearing":
        """Check moduli: stiffness and size may each be plausible, but not their combination."""
        yielding = self.hysteresis.yield_displacement / self.geometry.rubber_thickness
        if not EARLIEST <= yielding <= LATEST:
            raise ValueError(
                "hysteresis.yield_displacement and geometry.rubber_thickness give a yield "
                f"strain of {yielding:.3g}: must be {EARLIEST:g} to {LATEST:g}"
            )
        modulus = self.hysteresis.layer_stiffness * self.geometry.rubber_thickness / self.area
        modulus *= NEWTON_PER_KILONEWTON
        if not SOFTEST <= modulus <= HARDEST:
            raise ValueError(
                "hysteresis.layer_stiffness, plan and rubber_thickness give a shear modulus "
                f"K_r t_r / A of {modulus:.3g} MPa: must be {SOFTEST:g} to {HARDEST:g} MPa"
            )
        return self

    def __repr__(self) -> str:
        g = self.geometry
        return (
            f"<Bearing {self.name} ({self.kind}): {g.rubber_layers} x {g.rubber_thickness:g} mm "
            f"of rubber, {g.plan.shape}, {self.area:g} mm2>"
        )

    __str__ = __repr__

    def _repr_html_(self) -> str:
        g, h = self.geometry, self.hysteresis
        cores = f"{self.lead.cores} x {self.lead.core_area:g} mm2" if self.lead else ""
        facts = {
            "kind": self.kind,
            "description": self.description,
            "plan": f"{g.plan.shape}, {self.area:g} mm2",
            "rubber": f"{g.rubber_layers} x {g.rubber_thickness:g} = "
            f"{g.total_rubber_thickness:g} mm",
            "shape factors": f"S1 = {g.first_shape_factor:.3g}, S2 = {g.second_shape_factor:.3g}",
            "K_r, d_y": f"{h.layer_stiffness:g} kN/mm, {h.yield_displacement:g} mm",
            "m_T, n_T": f"{h.elastic_temperature_coefficient:g}, "
            f"{h.hysteretic_temperature_coefficient:g}",
            "lead": cores,
            "citation": self.citation,
        }
        cell = '<tr><th style="text-align:left">{}</th><td>{}</td></tr>'
        rows = "".join(cell.format(escape(k), escape(v)) for k, v in facts.items() if v)
        return f"<b>{escape(self.name)}</b><table>{rows}</table>"

    @property
    def area(self) -> float:
        """Plan area with that of lead cores, without an open hole [mm2]."""
        return self.geometry.plan.area

    @property
    def lead_area(self) -> float:
        """Of all lead cores together [mm2]."""
        return self.lead.cores * self.lead.core_area if self.lead else 0.0

    @property
    def total_rubber_thickness(self) -> float:
        """[mm]"""
        return self.geometry.total_rubber_thickness
