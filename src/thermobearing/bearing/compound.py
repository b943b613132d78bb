"""Rubber compounds, with lead if tested, in terms of stress and strain.

A compound transfers parameters between bearings of different size; see scaling.py.
"""

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from thermobearing.bearing.model import (
    EARLIEST,
    HARDEST,
    LATEST,
    SOFTEST,
    Bearing,
    Clock,
    Hardening,
    HysteresisLaw,
    Materials,
    RateBand,
    Scragging,
    SmallLoops,
    Softening,
    TemperatureCoefficient,
    TemperatureLaw,
    Validity,
    refuse_two_branches,
)
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, short_repr
from thermobearing.border.library import Library, Sourced
from thermobearing.border.schema import Name, Strict, in_unit, validated
from thermobearing.border.toml import split_sources

Modulus = Annotated[float, in_unit("MPa"), Field(ge=1e-4, le=1e5)]


class CompoundRubber(Strict):
    """The layer law (Eq. 4.34-4.37) per stress and strain.

    `shear_modulus` is K_r t_r/A with the rubber's own area A: the modulus at small strain, elastic
    and hysteretic part together. `yield_strain` is d_y/t_r. The others have no size.
    """

    shear_modulus: Annotated[float, in_unit("MPa"), Field(ge=SOFTEST, le=HARDEST)]
    post_yield_ratio: Annotated[float, Field(ge=1e-3, le=1)]  # alpha_0; 1 is linear rubber
    shape: Annotated[float, Field(ge=-0.999, le=100)]  # s
    yield_strain: Annotated[float, Field(ge=EARLIEST, le=LATEST)]
    hardening: Annotated[float, Field(ge=0, le=20)]  # b
    elastic_temperature_coefficient: TemperatureCoefficient  # m_T
    hysteretic_temperature_coefficient: TemperatureCoefficient  # n_T
    reference_temperature: Annotated[float, in_unit("degC"), Field(ge=-100, le=100)]
    small_loops: SmallLoops | None = None
    hardening_form: Hardening | None = None


class CompoundLead(Strict):
    """Lead of a core of any size: yield stress and elastic stiffness.

    `shear_modulus` is K_l H/A_l, with the total rubber thickness H, over which the core shears. Or
    `stiffness_ratio`: stiffness of the bearing before yielding of the lead over that after,
    K_1/K_2, as used in design.
    """

    yield_stress: Annotated[float, in_unit("MPa"), Field(ge=0.1, le=1000)]  # sigma_Y
    shear_modulus: Modulus | None = None
    stiffness_ratio: Annotated[float, Field(ge=1.1, le=1000)] | None = None
    softening: Softening = 0.0
    softening_beyond_tests: Softening | None = None
    reference_temperature: Annotated[float, in_unit("degC"), Field(ge=-100, le=100)]  # T_0
    surface_ratio: Annotated[float, Field(ge=1e-3, le=1)] = 0.5  # p
    clock: Clock | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        if ("shear_modulus" in values) == ("stiffness_ratio" in values):
            return ["give either shear_modulus (K_l H/A_l) or stiffness_ratio (K_1/K_2)"]
        return []


class CompoundRate(Strict):
    """The rate branch (Eq. 5.38-5.39) per stress and strain: K_v H/A and c_v H/A."""

    shear_modulus: Modulus
    viscosity: Annotated[float, in_unit("MPa s"), Field(ge=1e-6, le=1e5)]


class Compound(Sourced):
    """One rubber compound, with lead parameters if its tests included lead.

    Attributes
    ----------
    kind : "compound".
    name, description, citation : identification and sources.
    family : "HDR", high damping rubber (bearings of it are HDR, with lead LHDR), or "NR", natural
        rubber (bearings of it have lead, LRB).
    rubber, lead, rate : see those classes; `lead` is None if not known, `rate` without
        rate dependence.
    materials : thermal properties, including side film and steel, used in the calibration.
    temperature_law, hysteresis_law, tested_range, scragging, rate_band : as in a bearing;
        independent of size.

    Examples
    --------
    >>> load_compound("shen-hdr").rubber.yield_strain
    0.3098
    """

    kind: Literal["compound"] = "compound"
    name: Name
    family: Literal["HDR", "NR"]
    description: str = ""
    citation: str = ""
    rubber: CompoundRubber
    materials: Materials
    temperature_law: TemperatureLaw | None = None
    hysteresis_law: HysteresisLaw | None = None
    tested_range: Validity | None = None
    scragging: Scragging | None = None
    lead: CompoundLead | None = None
    rate: CompoundRate | None = None
    rate_band: RateBand | None = None

    @model_validator(mode="after")
    def _has_one_branch(self) -> "Compound":
        refuse_two_branches(self.rate_band, has_branch=self.rate is not None)
        return self

    @model_validator(mode="after")
    def _lead_is_known(self) -> "Compound":
        if self.lead is not None and self.materials.lead is None:
            raise ValueError("a compound with the table lead needs the table materials.lead")
        ratio = self.lead is not None and self.lead.stiffness_ratio is not None
        if ratio and self.rubber.post_yield_ratio < 1.0:
            raise ValueError(
                "lead.stiffness_ratio needs rubber that is linear (post_yield_ratio = 1): other "
                "rubber has its own stiffness before yield; give lead.shear_modulus"
            )
        return self


COMPOUNDS = Library("compound", "compounds")


def _compound_from_table(table: Any, where: str) -> Compound:
    """Return a compound from a parsed TOML table; `where` names the file in error messages."""
    values, sources = split_sources(table)
    if isinstance(values, dict) and "geometry" in values:
        raise InputError("is a bearing, not a compound; new_bearing accepts either", where)
    return validated(Compound, values, where).with_sources(sources)


@checked
def load_compound(name_or_path: str | Path) -> Compound:
    """Return a compound of the library by name, or from your own TOML file.

    Parameters
    ----------
    name_or_path : a name of the library, or a path ending in `.toml`.

    Raises
    ------
    InputError : no such compound, or faults in the file (all of them, in one message).

    Examples
    --------
    >>> load_compound("shen-hdr").family
    'HDR'
    """
    return _compound_from_table(*COMPOUNDS.table(name_or_path))


def as_compound(source: Any) -> "Compound | Bearing":
    """Return the compound, or bearing of it, from which a new bearing is derived.

    `source`: a Compound or Bearing, a library name, or the TOML file of either.
    """
    from thermobearing.bearing.library import bearing_from_table

    if isinstance(source, Compound | Bearing):
        return source
    if not isinstance(source, str | Path):
        raise InputError(
            f"compound = {short_repr(source)}: must be a Compound, a library name, or a TOML file"
        )
    try:
        table, where = COMPOUNDS.table(source)
        return (bearing_from_table if "geometry" in table else _compound_from_table)(table, where)
    except InputError as error:
        raise InputError(error.lines("compound")) from None
