"""Kinds of keys of structures, with units and ranges of real structures (a factor of ten more)."""

from typing import Annotated

from pydantic import Field

from thermobearing.border.schema import OneLine, in_unit
from thermobearing.border.units import parse_quantity

GRAVITY = parse_quantity("1 standard_gravity", "mm/s^2")
GROUND = "ground"  # what stands still; no body has this name
Name = Annotated[str, Field(min_length=1, max_length=60), OneLine]
Height = Annotated[float, in_unit("mm"), Field(ge=-1e6, le=1e6)]
Length = Annotated[float, in_unit("mm"), Field(ge=-1e8, le=1e8)]  # in plan: 100 km
Stiffness = Annotated[float, in_unit("kN/mm"), Field(ge=1e-6, le=1e9)]
Force = Annotated[float, in_unit("kN"), Field(ge=1e-3, le=1e6)]
Speed = Annotated[float, in_unit("mm/s"), Field(ge=1e-2, le=1e5)]
