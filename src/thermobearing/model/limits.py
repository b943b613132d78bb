"""Limits of checks that an office enters: value, edition and clause, and who read them there.

The values of the package that no printed code was read for are in data/design/provisions.toml; a
file of limits replaces them, one table for each limit, such as `[jra.level_2_shear_strain]`.
"""

from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from thermobearing.border.schema import OneLine, Strict, in_unit, validated
from thermobearing.border.toml import read_toml

PERCENT = 100.0  # in 1
EMPTY = 'states no limit; remove the "# " before the lines of each limit that you have confirmed'
Words = Annotated[str, Field(min_length=1, max_length=200), OneLine]


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
    def codes(self) -> list[str]:
        """The codes that have a limit here."""
        return [name for name in ("jra", "aashto") if getattr(self, name).model_fields_set]


def load_limits(file: str | Path) -> Limits:
    """Return the limits of a file; an error names key, value, unit and allowed range."""
    return validated(Limits, read_toml(Path(file)), str(file))
