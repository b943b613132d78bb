"""A bearing as design has it: bilinear, blind to temperature and rate."""

from importlib import resources
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from thermobearing.bearing.library import split_sources
from thermobearing.border.schema import Strict, in_unit, read_toml, validated

Stiffness = Annotated[float, in_unit("kN/mm"), Field(gt=0)]


class BilinearBearing(Strict):
    """Backbone of one bearing (Fig. 6.3): Q_d, K_1, K_2; the rubber thickness makes strains."""

    name: Annotated[str, Field(min_length=1)]
    kind: Literal["bilinear"] = "bilinear"
    description: str = ""
    citation: str = ""
    total_rubber_thickness: Annotated[float, in_unit("mm"), Field(gt=0)]
    strength: Annotated[float, in_unit("kN"), Field(gt=0)]  # Q_d
    initial_stiffness: Stiffness  # K_1
    post_yield_stiffness: Stiffness  # K_2

    @model_validator(mode="after")
    def _stiff_first(self) -> "BilinearBearing":
        if self.initial_stiffness <= self.post_yield_stiffness:
            raise ValueError("initial_stiffness must be greater than post_yield_stiffness")
        return self


def _library() -> Path:
    return Path(str(resources.files("thermobearing") / "data" / "bilinear"))


def list_bilinear() -> list[str]:
    """Names of the built-in bilinear bearings."""
    return sorted(path.stem for path in _library().glob("*.toml"))


def load_bilinear(name_or_path: str | Path) -> BilinearBearing:
    """A bilinear bearing of the library, or from a TOML file.

    Examples
    --------
    >>> load_bilinear("shen-bilinear-bridge").strength
    125.4
    """
    text = str(name_or_path)
    path = _library() / f"{text}.toml" if text in list_bilinear() else Path(text)
    table, _ = split_sources(read_toml(path))
    return validated(BilinearBearing, table, str(path))
