"""What is served to OpenSees, as data: bearing, ambient temperature, count, units, options.

Units and signs are converted in one place, `Units`. Displacements of an element are those of its
second node relative to its first; forces on the second node resist them (positive with a positive
displacement), and those on the first node are their opposites.
"""

from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, Self

import numpy as np
from pydantic import Field

from thermobearing.bearing.library import BEARINGS, load_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.cases import load_all, read_case
from thermobearing.border.errors import InputError
from thermobearing.border.library import sources_to_keep
from thermobearing.border.schema import Strict, in_unit, overridden
from thermobearing.border.title import case_table
from thermobearing.border.toml import split_sources, to_toml
from thermobearing.border.units import conversion
from thermobearing.core.records import Floats
from thermobearing.cyclic.case import Temperature
from thermobearing.model.axial import (
    DOWELLED,
    DOWELS_NEEDED,
    DowelLength,
    Joint,
    axial_stiffness,
    compression_modulus,
    find_section,
    second_moments,
    shear_modulus,
)
from thermobearing.model.checks import secant_stiffness
from thermobearing.model.element import DEFAULT_AMBIENT, BearingElement
from thermobearing.model.handover import SpecimenState
from thermobearing.model.options import ModelOptions
from thermobearing.opensees.wire import MOST_DOFS

UnitNames = Literal["kN-mm", "kN-m", "N-mm", "N-m", "MN-m", "kip-in", "lbf-in"]
Axial = Literal["off", "node"]
IN_SPACE = 6  # degrees of freedom of a node
HORIZONTAL = (1, 2, 3)


class Units(NamedTuple):
    """Factors from the units of a client to those of this package."""

    force: float  # [kN]
    length: float  # [mm]

    @classmethod
    def named(cls, name: str) -> Self:
        """Return the factors of a name such as "kN-m"."""
        force, length = name.split("-")
        return cls(conversion(force, "kN")[0], conversion(length, "mm")[0])


class ServedCase(Strict):
    """A bearing that is served.

    Attributes
    ----------
    command : "serve".
    bearing : the bearing: a name, a TOML file, or a table.
    ambient : ambient temperature [degC], in [-100, 100].
    initial : temperature of the bearing at the start [degC]; the ambient temperature by default.
    initial_state : where an earlier analysis left the bearing, from `tb.end_state`.
    count : number of equal bearings side by side that an element stands for, in [1, 1000].
    units : force and length of the OpenSees model, such as "kN-mm" (default), "kN-m" or "N-m"; the
        time is in s and rotations are in rad.
    axial : whether the axial force between the nodes acts on the shear force: "off" (default), or
        "node", for elements with a vertical direction, whose positive side is up.
    joint : with `axial = "node"`: "bolted" (default), whose rubber cavitates in tension, or
        "dowelled", which lifts.
    dowel_length : with `joint = "dowelled"`: uplift at which dowels come out [mm]; without it no
        uplift is a failure.
    rate : speed [mm/s] at which a static analysis moves the bearing, in [1e-6, 1e6]. Steps without
        any velocity then last as long as this speed needs. By default the time of the model is the
        clock of the bearing in static analyses too, and must advance.
    analysis : how to model the bearing.
    """

    command: Literal["serve"] = "serve"
    bearing: Bearing
    ambient: Temperature = DEFAULT_AMBIENT
    initial: Temperature | None = None
    initial_state: SpecimenState | None = None
    count: Annotated[int, Field(ge=1, le=1000)] = 1
    units: UnitNames = "kN-mm"
    axial: Axial | None = None  # None: off
    joint: Joint | None = None  # None: bolted
    dowel_length: DowelLength | None = None
    rate: Annotated[float, in_unit("mm/s"), Field(ge=1e-6, le=1e6)] | None = None
    analysis: ModelOptions = ModelOptions()
    sources: dict[str, dict[str, str]] | None = None

    def to_toml(self) -> str:
        """Return the case with every default filled in, as TOML; reads back to the same bits."""
        return to_toml(self)

    @property
    def has_axial(self) -> bool:
        """Whether the axial force acts on the shear force."""
        return self.axial == "node"

    def check_layout(self, layout: "Layout", where: str) -> None:
        """Raise InputError for an element that this bearing cannot be."""
        if self.has_axial and layout.vertical is None:
            raise InputError(
                'axial = "node": the element needs its vertical direction; give vertical, one of '
                "the degrees of freedom 1, 2 and 3 of nodes with six",
                where,
            )
        if len(layout.directions) > 1:
            self.new_bearing(len(layout.directions))  # raises for what a plane does not have

    def new_bearing(self, components: int = 1) -> BearingElement:
        """Return a bearing at the start, on a line or in a plane (two components)."""
        start = self.initial if self.initial_state is None else self.initial_state
        return BearingElement(
            self.bearing, self.ambient, initial=start, components=components, model=self.analysis
        )


def make_served_case(
    table: dict[str, Any], where: str, folder: Path = Path(), **overrides: Any
) -> ServedCase:
    """Check a case from a table of a file and overrides, with the defaults filled in."""
    table, keywords, faults = load_all(table, overrides, {"bearing": load_bearing}, folder)
    table = overridden(table, keywords, ServedCase, {"analysis": ModelOptions})
    bearing_sources: dict[str, str] = {}
    if isinstance(table.get("bearing"), dict):
        table["bearing"], bearing_sources = split_sources(table["bearing"])
    case = read_case(ServedCase, table, where, faults)
    faults = [f"analysis.{text}" for text in case.analysis.misfits(case.bearing)]
    if case.analysis.model == "bilinear":
        faults.append('analysis.model = "bilinear": use bilinear bounds (thermobearing lambda)')
    if case.joint is not None and not case.has_axial:
        faults.append('joint: needs axial = "node"')
    if case.dowel_length is not None and case.joint != DOWELLED:
        faults.append(DOWELS_NEEDED)
    if case.initial is not None and case.initial_state is not None:
        faults.append("give initial or initial_state, not both")
    if faults:
        raise InputError(faults, where)
    bearing = case.bearing.with_sources(bearing_sources | case.bearing.sources)
    sources = sources_to_keep([(BEARINGS, bearing)], case.sources)
    analysis = case.analysis.settled(case.bearing)
    return case.model_copy(update={"analysis": analysis, "sources": sources})


def load_served_case(path: str | Path, **overrides: Any) -> ServedCase:
    """Read a case from TOML; overrides as of `make_served_case`."""
    return make_served_case(case_table(Path(path)), str(path), Path(path).parent, **overrides)


class Layout(NamedTuple):
    """Which springs an element of OpenSees has."""

    pairs: int  # bearings in the element, each between two nodes
    dofs: tuple[int, ...]  # of each node, numbered as in OpenSees
    directions: tuple[int, ...]  # those in which the bearing shears
    vertical: int | None  # None where the element has shear springs only

    @classmethod
    def of(cls, pairs: int, directions: Any, vertical: int | None, where: str) -> Self:
        """Return the layout of an element, checked."""
        shear_axes = directions if isinstance(directions, list | tuple) else (directions,)
        faults = []
        known_axes = bool(shear_axes) and set(shear_axes) <= set(HORIZONTAL)
        if not known_axes or len(set(shear_axes)) != len(shear_axes):
            faults.append(f"directions = {directions!r}: must be different ones of 1, 2, 3")
        elif vertical is not None and (vertical not in HORIZONTAL or vertical in shear_axes):
            faults.append(f"vertical = {vertical!r}: must be 1, 2 or 3, and none of directions")
        if len(shear_axes) > 2:
            faults.append(f"directions = {directions!r}: a bearing shears in two at most")
        # The limit of the wire format holds for both nodes of all pairs together. A fault in the
        # directions must not end in a division by zero before it is reported.
        dofs_of_node = IN_SPACE if vertical is not None else max(1, len(shear_axes))
        largest_count = MOST_DOFS // 2 // dofs_of_node
        if not 1 <= pairs <= largest_count:
            faults.append(f"nodes: {pairs} pairs; must be from 1 to {largest_count} in one element")
        if faults:
            raise InputError(faults, where)
        # With a vertical direction, the element has springs in all six degrees of freedom.
        axes = tuple(int(axis) for axis in shear_axes)
        dofs = tuple(sorted(axes)) if vertical is None else tuple(range(1, IN_SPACE + 1))
        return cls(pairs, dofs, axes, vertical)

    @property
    def size(self) -> int:
        """Number of degrees of freedom of the element."""
        return 2 * self.pairs * len(self.dofs)


class LinearStiffness(NamedTuple):
    """Stiffness of a bearing that neither temperature nor history changes during an analysis."""

    shear: float  # G A / T_r [kN/mm]
    vertical: float  # E_c A / T_r [kN/mm]
    rotation: tuple[float, float]  # E_c I / (3 T_r) about the axes along and across [kN mm/rad]
    torsion: float  # G J / T_r [kN mm/rad]


def linear_stiffness(case: ServedCase) -> LinearStiffness:
    r"""Return vertical, rotational, torsional and lateral stiffness of one bearing.

    .. math::
        E_c = (1 / (c G S^2) + 4 / (3 K))^{-1}, \quad K_v = E_c A / T_r, \quad
        K_r = E_c I / (3 T_r), \quad K_t = G J / T_r

    after Kumar, Whittaker & Constantinou (2014), "An advanced numerical model of elastomeric
    seismic isolation bearings", Earthquake Engineering & Structural Dynamics 43, with the shape
    factor S of one layer, c = 6 for round and 6.73 for other plans and the bulk modulus K
    (data/materials/vertical.toml). G is the secant modulus of the rubber of this bearing at 100 %
    shear strain and the temperature at the start, in the first loading. A single lead core in the
    centre of a round plan is left out of A and I; other cores count as rubber. With
    `axial = "node"` the vertical spring is that of opensees/axial.py instead.

    Examples
    --------
    >>> case = make_served_case({}, "example", bearing="shen-hdr-bridge", ambient=23)
    >>> stiffness = linear_stiffness(case)
    >>> stiffness.vertical > 100 * stiffness.shear
    True
    """
    bearing, geometry = case.bearing, case.bearing.geometry
    height = bearing.total_rubber_thickness
    shear = secant_stiffness(case.new_bearing(), height)
    modulus = shear_modulus(bearing, shear)
    bending = compression_modulus(geometry, modulus, bearing.lead) / (3.0 * height)
    along, across = find_section(geometry, bearing.lead).inertia
    return LinearStiffness(
        shear,
        axial_stiffness(geometry, modulus, bearing.lead),
        (bending * across, bending * along),  # about the axes along and across
        modulus * sum(second_moments(geometry.plan)) / height,
    )


def spring_constants(layout: Layout, case: ServedCase) -> Floats:
    """Return the linear springs of an element by degree of freedom [kN, mm, rad].

    They are zero in shear, and in the vertical direction where the axial force acts.
    """
    constants = np.zeros(len(layout.dofs))
    if layout.vertical is None:
        return constants
    stiffness = linear_stiffness(case)
    first = layout.directions[0]
    # A rocking spring has the degree of freedom of the translation plus three, as in OpenSees.
    second = next(axis for axis in HORIZONTAL if axis not in (first, layout.vertical))
    by_dof = {second: stiffness.shear, layout.vertical: stiffness.vertical}
    by_dof |= {first + 3: stiffness.rotation[0], second + 3: stiffness.rotation[1]}
    by_dof[layout.vertical + 3] = stiffness.torsion
    for place, dof in enumerate(layout.dofs):
        if dof not in layout.directions and not (case.has_axial and dof == layout.vertical):
            constants[place] = by_dof[dof]
    return constants
