"""Limits of checks that an office enters: value, edition and clause, and who read them there.

The values of the package that no printed code was read for are in data/design/provisions.toml; a
file of limits replaces them, one table for each limit, such as `[jra.level_2_shear_strain]`.
"""

from pathlib import Path
from typing import Annotated, Any, Literal, get_args

from pydantic import BeforeValidator, Field

from thermobearing.border.schema import OneLine, Strict, in_unit, validated
from thermobearing.border.toml import read_toml
from thermobearing.border.units import one_or_several

PERCENT = 100.0  # in 1
EMPTY = 'states no limit; remove the "# " before the lines of each limit that you have confirmed'
Words = Annotated[str, Field(min_length=1, max_length=200), OneLine]
Code = Literal["jra", "aashto"]
ZONES = (1, 2, 3, 4)  # seismic zones of AASHTO
CODE_KEYS = ("codes", "rotation", "zone")  # of a case, for its documents
DEFAULT_ROTATION, DEFAULT_ZONE = 0.0, 4  # [rad]; where a case states none


class Limit(Strict):
    """A limit as an office has read it in a printed code.

    Attributes
    ----------
    edition : of the code, in words.
    clause : where the limit stands in it.
    entered_by : who read it there, such as name and date.
    value : the limit; each kind has its unit and range.
    """

    edition: Words
    clause: Words
    entered_by: Words
    value: float

    @property
    def number(self) -> float:
        """The limit in the unit of its check: a ratio, [MPa] or [rad]."""
        return self.value

    def describe(self) -> str:
        """Return where the limit stands, and who entered it."""
        return f"{self.edition}, {self.clause}, entered by {self.entered_by}"


class StrainLimit(Limit):
    """A shear strain; `value`: largest one [%], in [10, 2000]."""

    value: Annotated[float, in_unit("%"), Field(ge=10, le=2000)]

    @property
    def number(self) -> float:
        """The limit as a ratio."""
        return self.value / PERCENT


class StressLimit(Limit):
    """A stress; `value`: largest one [MPa], in [0, 1000]; of uplift the tensile stress."""

    value: Annotated[float, in_unit("MPa"), Field(ge=0, le=1000)]


class RotationLimit(Limit):
    """A rotation; `value`: largest one [rad], in [0.0001, 0.2]."""

    value: Annotated[float, in_unit("rad"), Field(ge=1e-4, le=0.2)]


class ReserveLimit(Limit):
    """A reserve; `value`: least ratio of the critical load to the load, in [0.5, 20]."""

    value: Annotated[float, Field(ge=0.5, le=20)]


class DuctilityLimit(Limit):
    """A ductility; `value`: largest rotation of the hinge over that at yield, in [1, 20]."""

    value: Annotated[float, Field(ge=1, le=20)]


AnyLimit = StrainLimit | StressLimit | RotationLimit | ReserveLimit | DuctilityLimit


class JraLimits(Strict):
    """Limits of JRA V; the keys are those of its checks in data/design/provisions.toml."""

    level_1_shear_strain: StrainLimit | None = None
    level_2_shear_strain: StrainLimit | None = None
    level_2_local_shear_strain: StrainLimit | None = None
    level_2_overlap_stress: StressLimit | None = None
    uplift_stress: StressLimit | None = None
    rotation: RotationLimit | None = None


class AashtoLimits(Strict):
    """Limits of AASHTO GSID; the keys are those of its checks in data/design/provisions.toml."""

    compression_shear_strain: StrainLimit | None = None
    total_shear_strain: StrainLimit | None = None
    reserve_without_displacement: ReserveLimit | None = None
    reserve_zones_3_and_4: ReserveLimit | None = None
    reserve_zones_1_and_2: ReserveLimit | None = None
    uplift_stress: StressLimit | None = None


class BearingLimits(Strict):
    """Limits of the checks under a vertical load and in a plane, of any code (model/checks.py)."""

    stress: StressLimit | None = None
    overlap_stress: StressLimit | None = None
    local_strain: StrainLimit | None = None


class HingeLimits(Strict):
    """Limits of piers, which the report of a bridge checks: first yield without an entry."""

    ductility: DuctilityLimit | None = None


class Limits(Strict):
    """Limits that an office enters, by code and check.

    Attributes
    ----------
    jra, aashto : of the checks after these codes.
    bearing : of the checks that every bearing with an `axial_force` or in a plane has.
    pier : of the ductility of every pier, in the report.
    """

    jra: JraLimits = JraLimits()
    aashto: AashtoLimits = AashtoLimits()
    bearing: BearingLimits = BearingLimits()
    pier: HingeLimits = HingeLimits()

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        return [] if any(values.values()) else [EMPTY]

    def of(self, table: str, key: str) -> AnyLimit | None:
        """Return the limit of a check, or None where none is entered."""
        limit: AnyLimit | None = getattr(getattr(self, table), key)
        return limit

    @property
    def codes(self) -> list[Code]:
        """The codes that have a limit here."""
        return [name for name in get_args(Code) if getattr(self, name).model_fields_set]


def load_limits(file: str | Path) -> Limits:
    """Return the limits of a file; an error names key, value, unit and allowed range."""
    return validated(Limits, read_toml(Path(file)), str(file))


class CodeChecks(Strict):
    """What the bearings of a bridge are checked after.

    Attributes
    ----------
    codes : codes to check the bearings after: "jra", JRA V (2017), and "aashto", AASHTO GSID
        (2014); may be empty with `limits`.
    rotation : design rotation of the bearings [rad], in [0, 0.2]; 0 by default.
    zone : seismic zone of AASHTO, a number from 1 to 4; 4 by default.
    limits : file of the limits of checks that an office has confirmed (`thermobearing limits new`).
        Codes that it has limits of are checked.
    """

    codes: Annotated[tuple[Code, ...], BeforeValidator(one_or_several)] | None = None
    rotation: Annotated[float, in_unit("rad"), Field(ge=0, le=0.2)] | None = None
    zone: Annotated[int, Field(ge=ZONES[0], le=ZONES[-1])] | None = None
    limits: Limits | None = None

    @property
    def checked_codes(self) -> list[Code] | None:
        """The codes that bearings are checked after; None where there are no such checks."""
        if self.codes is not None:
            return list(dict.fromkeys(self.codes))
        return None if self.limits is None else self.limits.codes

    @property
    def design_rotation(self) -> float:
        """The design rotation that the checks count on [rad]."""
        return DEFAULT_ROTATION if self.rotation is None else self.rotation

    @property
    def seismic_zone(self) -> int:
        """The seismic zone that the checks count on."""
        return DEFAULT_ZONE if self.zone is None else self.zone

    def code_faults(self, *, of_bridge: bool) -> list[str]:
        """Return what bearings cannot be checked after; those of a hybrid test after nothing."""
        keys = [key for key in CodeChecks.model_fields if getattr(self, key) is not None]
        if not of_bridge:
            reason = "only the bearings of a bridge are checked after codes; omit them"
            return [f"{key}: {reason}" for key in keys]
        if self.checked_codes is None:
            return [f"{key}: needs codes or limits, whose checks count on it" for key in keys]
        if not self.checked_codes and self.limits is None:
            return ["codes: must have at least one entry, or give limits"]
        return []
