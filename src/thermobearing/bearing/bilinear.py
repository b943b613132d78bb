"""Bilinear bearings as used in design, independent of temperature and rate."""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from thermobearing.bearing.exposure import Exposure
from thermobearing.bearing.library import list_bearings, load_bearing
from thermobearing.bearing.model import Bearing, Validity
from thermobearing.border.arguments import checked
from thermobearing.border.library import Library, Sourced, is_path, unknown_name
from thermobearing.border.opener import is_file
from thermobearing.border.schema import Name, in_unit
from thermobearing.border.toml import read_toml, split_sources

Stiffness = Annotated[float, in_unit("kN/mm"), Field(ge=1e-6, le=1e7)]  # 0.1 to 1000 kN/mm


class BilinearBearing(Sourced):
    """Backbone of one bearing (Fig. 6.3), independent of temperature and rate.

    Attributes
    ----------
    name, kind, description, citation : identification and sources; `kind` is
        "bilinear".
    total_rubber_thickness : converts displacements to strains [mm], in [0.01, 1e5].
    strength : Q_d, force at zero displacement [kN], in [1e-6, 1e7].
    initial_stiffness, post_yield_stiffness : K_1 > K_2 [kN/mm], in
        [1e-6, 1e7].
    tested_range : range of the design or the tests; None if not given.
    exposure : factors for long cold and ageing (`Exposure`); None: no factors.
    """

    name: Name
    kind: Literal["bilinear"] = "bilinear"
    description: str = ""
    citation: str = ""
    total_rubber_thickness: Annotated[float, in_unit("mm"), Field(ge=0.01, le=1e5)]
    strength: Annotated[float, in_unit("kN"), Field(ge=1e-6, le=1e7)]  # Q_d
    initial_stiffness: Stiffness  # K_1
    post_yield_stiffness: Stiffness  # K_2
    tested_range: Validity | None = None
    exposure: Exposure | None = None

    @model_validator(mode="after")
    def _stiff_first(self) -> "BilinearBearing":
        if self.initial_stiffness <= self.post_yield_stiffness:
            raise ValueError("initial_stiffness must be greater than post_yield_stiffness")
        return self


BILINEAR = Library("bilinear bearing", "bilinear")


@checked
def load_bilinear(name_or_path: str | Path) -> BilinearBearing:
    """Return a bilinear bearing of the library, or from a TOML file.

    Parameters
    ----------
    name_or_path : a name of the library, or a path to your own file.

    Raises
    ------
    InputError : no such bearing, or faults in the file.

    Examples
    --------
    >>> load_bilinear("shen-bilinear-bridge").strength
    125.4
    """
    return BILINEAR.load(BilinearBearing, name_or_path)


def load_device(name_or_path: str | Path) -> Bearing | BilinearBearing:
    """Return a layered or bilinear bearing by name or file.

    `name_or_path`: of the library, or a TOML file.

    >>> load_device("shen-bilinear-bridge").kind, load_device("shen-hdr-specimen").kind
    ('bilinear', 'HDR')
    """
    text = str(name_or_path)
    names = [*list_bearings(), *BILINEAR.names()]
    if text not in names and not is_path(name_or_path):
        raise unknown_name("bearing", text, names)
    # A file says itself which it is; a name is in one of the two libraries.
    if text not in names and is_file(Path(text)):
        bilinear = split_sources(read_toml(Path(text)))[0].get("kind") == "bilinear"
    else:
        bilinear = text in BILINEAR.names()
    return load_bilinear(text) if bilinear else load_bearing(text)
