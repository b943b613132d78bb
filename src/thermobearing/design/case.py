"""A design as data: bridge, motions, rubber, rules."""

from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, field_validator

from thermobearing.border.errors import InputError
from thermobearing.border.overrides import overridden
from thermobearing.border.schema import Strict, in_unit, validated
from thermobearing.border.toml import to_toml
from thermobearing.cyclic.case import Temperature, each_once
from thermobearing.design.peaks import PeakRule
from thermobearing.design.rubber import Kind, load_rubber
from thermobearing.design.sizing import SizingRules
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.earthquake.motion import Motion
from thermobearing.motions.record import STANDARD_GRAVITY
from thermobearing.report.title import case_table
from thermobearing.structure.model import MassModel, Structure

STIFFNESS_RATIO = 0.19  # alpha of Table 6.3


class DesignCase(Strict):
    """Everything `design` needs.

    Attributes
    ----------
    structure, motions : the bridge, and the earthquakes it is designed for.
    compound, compound_kind : rubber, and which of its curves: "HDR" or "HDR-S".
    start : first displacement u_B [mm], in [1, 2000].
    weight : on one bearing [kN], in [0.1, 1e6]; by default what the structure says.
    stiffness_ratio : ratio K_2 / K_1 of the bilinear model, in [0.001, 0.99].
    effective_displacement_factor : factor c_B of u_Be = c_B u_B, in [0.01, 1] (0.7 is said to be
        usual for Level 2; unverified).
    tolerance : on found over assumed displacement, relative, in [1e-6, 0.1] (the source stops at
        10 %).
    most_rounds : of the loop, 1 to 200.
    dt : largest time step [s], in [1e-6, 0.1].
    mass : "consistent" or "published".
    sizing : rules of plan and layers.
    equal : names of layered bearings that are to be scaled to the same K_B.
    ambient : temperatures that these are judged at [degC], in [-100, 100].
    peaks : what counts under several motions: "largest", or "mean" over the motions of a group, of
        which the largest (data/design/peaks.toml).
    """

    structure: Structure
    motions: Annotated[list[Motion], Field(min_length=1, max_length=1000)]
    compound: str = "G8"
    compound_kind: Kind = "HDR"
    start: Annotated[float, in_unit("mm"), Field(ge=1, le=2000)] = 200.0
    weight: Annotated[float, in_unit("kN"), Field(ge=0.1, le=1e6)] | None = None
    stiffness_ratio: Annotated[float, Field(ge=1e-3, le=0.99)] = STIFFNESS_RATIO
    effective_displacement_factor: Annotated[float, Field(ge=0.01, le=1)] = 1.0
    tolerance: Annotated[float, Field(ge=1e-6, le=0.1)] = 0.01
    most_rounds: Annotated[int, Field(ge=1, le=200)] = 40
    dt: Annotated[float, in_unit("s"), Field(ge=1e-6, le=0.1)] = 0.005
    mass: MassModel = "consistent"
    sizing: SizingRules = SizingRules()
    equal: list[str] = ["shen-hdr-bridge", "shen-lhdr-bridge"]  # noqa: RUF012 (pydantic copies it)

    ambient: Annotated[list[Temperature], Field(max_length=100)] = [23.0, 0.0, -20.0]  # noqa: RUF012
    peaks: PeakRule = "largest"

    @field_validator("ambient")
    @classmethod
    def _each_once(cls, ambient: list[float]) -> list[float]:
        return each_once(ambient)

    def to_toml(self) -> str:
        """The case with every default filled in, as TOML; reads back to the same bits."""
        return to_toml(self)


def make_design_case(
    table: dict[str, Any], where: str, folder: Path = Path(), **overrides: Any
) -> DesignCase:
    """A checked design case; the bridge of section 6.2 by default.

    Parameters
    ----------
    table : keys of `DesignCase`; structure and motions as in an earthquake case.
    where : names the file in messages.
    folder : paths in the table are relative to it.
    overrides : values that replace those of the table; plain numbers in mm, kN and s.

    Returns
    -------
    DesignCase

    Raises
    ------
    InputError : all faults in one message.

    Examples
    --------
    >>> make_design_case({"compound": "G10"}, "example", start=150).start
    150.0
    """
    table = overridden(table, overrides, DesignCase)
    study: dict[str, Any] = {"command": "bridge", "bearings": ["shen-bilinear-bridge"]}
    study |= {key: table[key] for key in ("structure", "motions", "fixed_base") if key in table}
    table.pop("fixed_base", None)
    settled = make_earthquake_case(study, where, folder)
    table["structure"], table["motions"] = settled.structure, settled.motions
    case = validated(DesignCase, table, where)
    try:
        load_rubber(case.compound, case.compound_kind)
    except InputError as error:
        raise InputError(error.lines("compound"), where) from None
    if len(case.structure.bearings) != 1:
        names = ", ".join(f'"{line.name}"' for line in case.structure.bearings)
        raise InputError(
            f"structure: the design loop needs exactly one bearing line, and this has {names}; "
            "give one pier with its line and the mass of the deck that it carries, then take the "
            "bearings found (bearings/*.toml) for the whole structure in `bridge`",
            where,
        )
    return case


def load_design_case(path: str | Path, **overrides: Any) -> DesignCase:
    """A design case from TOML.

    Parameters
    ----------
    path : the file; see `DesignCase` for its keys.
    overrides : values that replace those of the file; plain numbers in mm, kN and s.

    Returns
    -------
    DesignCase

    Raises
    ------
    InputError : the file cannot be read, or all its faults in one message.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "case.toml"
    ...     _ = file.write_text('compound = "G10"')
    ...     load_design_case(file, start=150.0).compound
    'G10'
    """
    path = Path(path)
    table = case_table(path)
    return make_design_case(table, str(path), path.parent, **overrides)


def bearing_weight(case: DesignCase) -> float:
    """Vertical load of one bearing [kN]: given, or the deck's weight over the count.

    Parameters
    ----------
    case : what is designed.

    Returns
    -------
    float : [kN], > 0.

    Examples
    --------
    >>> round(bearing_weight(make_design_case({}, "example")), 1)
    784.5
    """
    if case.weight is not None:
        return case.weight
    structure = case.structure
    mass = sum(item.mass for item in structure.masses if item.body == structure.report.deck)
    return mass * STANDARD_GRAVITY / structure.bearings[0].count
