"""A design as data: bridge, groups of its bearing lines, motions, rubber, rules."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from thermobearing.border.errors import InputError
from thermobearing.border.schema import OneLine, Strict, in_unit, overridden, validated
from thermobearing.border.title import case_table
from thermobearing.border.toml import to_toml
from thermobearing.cyclic.case import Ambients
from thermobearing.design.peaks import PeakRule
from thermobearing.design.sizing import Kind, SizingRules, load_rubber
from thermobearing.earthquake.case import AxialLevel, make_earthquake_case
from thermobearing.earthquake.motions import Motion
from thermobearing.motions.record import STANDARD_GRAVITY
from thermobearing.structure.fields import GROUND, Name
from thermobearing.structure.model import MassModel, Structure, line_faults

STIFFNESS_RATIO = 0.19  # alpha of Table 6.3
Weight = Annotated[float, in_unit("kN"), Field(ge=0.1, le=1e6)]


class LineGroup(Strict):
    """Bearing lines that get bearings of one size; `weight` of one [kN] instead of the case's."""

    lines: Annotated[list[Name], Field(min_length=1, max_length=8)]
    name: Annotated[str, Field(max_length=600), OneLine] = ""
    weight: Weight | None = None


class DesignCase(Strict):
    """Everything `design` needs.

    Attributes
    ----------
    structure, motions : the bridge, and the earthquakes it is designed for.
    compound : compound of the rubber, "G8", "G10" or "G12".
    compound_kind : kind of the rubber, which chooses its curves: "HDR" or "HDR-S".
    start : first displacement u_B [mm], in [1, 2000].
    weight : vertical load on one bearing [kN], in [0.1, 1e6]; by default an equal part of the
        weight that the lines carry.
    line_groups : bearing lines that get one size; lines that no group names are grouped by their
        count and by what they stand on (the ground or a pier). None of a structure with one line.
    stiffness_ratio : ratio K_2 / K_1 of the bilinear model, in [0.001, 0.99].
    effective_displacement_factor : factor c_B of u_Be = c_B u_B, in [0.01, 1] (0.7 is
        reported to be usual for Level 2; unverified).
    tolerance : relative convergence tolerance of the displacement, in [1e-6, 0.1] (Shen (2023)
        uses 10 %).
    most_rounds : of the loop, 1 to 200.
    dt : largest time step [s], in [1e-6, 0.1].
    mass : "consistent" or "published".
    sizing : rules of plan and layers.
    equal : names of layered bearings that are to be scaled to the same K_B.
    ambient : temperature at which layered bearings are checked [degC], in [-100, 100].
    axial : axial forces that act on the shear force of layered bearings, on lines of the structure
        with a table `axial`: "off" (default), "dead", "overturning" or "vertical". A size with an
        unstable run has the verdict NG.
    peaks : peak response to several motions: "mean" of a group of motions (the largest of fewer
        than three), and the largest of all groups; "mean of seven" likewise of seven; or "largest"
        of all motions (data/design/peaks.toml).
    """

    structure: Structure
    motions: Annotated[list[Motion], Field(min_length=1, max_length=1000)]
    compound: str = "G8"
    compound_kind: Kind = "HDR"
    start: Annotated[float, in_unit("mm"), Field(ge=1, le=2000)] = 200.0
    weight: Weight | None = None
    line_groups: Annotated[list[LineGroup], Field(min_length=1, max_length=8)] | None = None
    stiffness_ratio: Annotated[float, Field(ge=1e-3, le=0.99)] = STIFFNESS_RATIO
    effective_displacement_factor: Annotated[float, Field(ge=0.01, le=1)] = 1.0
    tolerance: Annotated[float, Field(ge=1e-6, le=0.1)] = 0.01
    most_rounds: Annotated[int, Field(ge=1, le=200)] = 40
    dt: Annotated[float, in_unit("s"), Field(ge=1e-6, le=0.1)] = 0.005
    mass: MassModel = "consistent"
    sizing: SizingRules = SizingRules()
    equal: list[str] = ["shen-hdr-bridge", "shen-lhdr-bridge"]  # noqa: RUF012 (pydantic copies it)

    ambient: Annotated[Ambients, Field(max_length=100)] = [23.0, 0.0, -20.0]  # noqa: RUF012
    axial: AxialLevel | None = None  # None: off
    peaks: PeakRule = "mean"

    @property
    def groups(self) -> list[LineGroup]:
        """The groups; one without a name where the structure has one line."""
        return self.line_groups or [
            LineGroup(lines=[line.name for line in self.structure.bearings])
        ]

    def to_toml(self) -> str:
        """Return the case with every default filled in, as TOML; reads back to the same bits."""
        return to_toml(self)


def make_design_case(
    table: dict[str, Any], where: str, folder: Path = Path(), **overrides: Any
) -> DesignCase:
    """Check a design case from a table, whose paths are relative to `folder`, and overrides."""
    table = overridden(table, overrides, DesignCase)
    study: dict[str, Any] = {"command": "bridge", "bearings": ["shen-bilinear-bridge"]}
    study |= {key: table[key] for key in ("structure", "motions", "fixed_base") if key in table}
    table.pop("fixed_base", None)
    if table.get("axial") not in (None, "off"):  # bilinear bearings of the rounds have none
        study |= {"bearings": ["shen-hdr-bridge"], "analysis": {"axial": table["axial"]}}
    settled = make_earthquake_case(study, where, folder)
    table["structure"], table["motions"] = settled.structure, settled.motions
    case = validated(DesignCase, table, where)
    try:
        load_rubber(case.compound, case.compound_kind)
    except InputError as error:
        raise InputError(error.lines("compound"), where) from None
    if len(case.structure.bearings) == 1 and case.line_groups is None:
        return case
    return case.model_copy(
        update={"line_groups": _settle_groups(case.line_groups or [], case.structure, where)}
    )


def _settle_groups(
    explicit_groups: Sequence[LineGroup], structure: Structure, where: str
) -> list[LineGroup]:
    """Return groups that hold every line once: those given, then the other lines by their kind."""
    named_lines = [name for group in explicit_groups for name in group.lines]
    faults = line_faults(structure, named_lines, "line_groups")
    lines_by_kind: dict[tuple[int, bool], list[str]] = {}
    for line in structure.bearings:
        if line.name not in named_lines:
            lines_by_kind.setdefault((line.count, line.base == GROUND), []).append(line.name)
    groups = [*explicit_groups, *(LineGroup(lines=lines) for lines in lines_by_kind.values())]
    names = [group.name or ", ".join(group.lines) for group in groups]
    faults += [
        f'line_groups: two are called "{n}"' for n in dict.fromkeys(names) if names.count(n) > 1
    ]
    if faults:
        raise InputError(faults, where)
    pairs = zip(groups, names, strict=True)
    return [group.model_copy(update={"name": name}) for group, name in pairs]


def load_design_case(path: str | Path, **overrides: Any) -> DesignCase:
    """Read a design case from TOML; overrides as of `make_design_case`."""
    return make_design_case(case_table(Path(path)), str(path), Path(path).parent, **overrides)


def bearing_weight(case: DesignCase, group: LineGroup | None = None) -> float:
    """Return the vertical load of one bearing of a group [kN].

    That of the group or of the case; otherwise the weight of the body that the lines carry, in
    equal parts on all the bearings below it; of several bodies the largest.

    >>> round(bearing_weight(make_design_case({}, "example")), 1)
    784.5
    """
    group = group or case.groups[0]
    weight = group.weight or case.weight
    if weight is not None:
        return weight
    structure = case.structure
    bodies = {line.body for line in structure.bearings if line.name in group.lines}
    loads = []
    for body in bodies:
        mass = sum(item.mass for item in structure.masses if item.body == body)
        count = sum(line.count for line in structure.bearings if line.body == body)
        loads.append(mass * STANDARD_GRAVITY / count)
    return max(loads)
