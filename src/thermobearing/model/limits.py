"""Temperatures that no part of a bearing can have (data/materials/limits.toml)."""

from functools import cache
from typing import Annotated

from thermobearing.border.library import data_path
from thermobearing.border.schema import Strict, in_unit, validated
from thermobearing.border.toml import read_toml, split_sources
from thermobearing.core.types import Limits


class TemperatureLimits(Strict):
    """What the file says [degC]."""

    absolute_zero: Annotated[float, in_unit("degC")]
    rubber_decomposes: Annotated[float, in_unit("degC")]
    lead_melts: Annotated[float, in_unit("degC")]
    steel_melts: Annotated[float, in_unit("degC")]


@cache
def temperature_limits() -> TemperatureLimits:
    """The limits, read once."""
    path = data_path("materials", "limits.toml")
    return validated(TemperatureLimits, split_sources(read_toml(path))[0], str(path))


def limits_of_a_step() -> Limits:
    """Those that every step looks at."""
    found = temperature_limits()
    return Limits(
        coldest=found.absolute_zero, rubber=found.rubber_decomposes, lead=found.lead_melts
    )
