"""A structure as data: rigid bodies, masses on them, and what connects them.

A body that stands alone moves sideways with its own coordinate; one that stands `on` another,
or on the ground, is carried by it. Either may rotate (absolute rotation, positive when its top
moves in the positive direction). Heights are measured from any common level. Springs, hinges and
bearing lines connect two bodies, or a body and the ground.

A structure in plan (`plan = true`) moves in two directions, x along and y across the bridge; its
bodies and connections have places in plan, and bodies may twist about the vertical.
"""

import math
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Annotated, Literal, NamedTuple

from pydantic import Field, model_validator

from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, nearest
from thermobearing.border.library import Library, Sourced, data_path
from thermobearing.border.schema import Strict, in_unit
from thermobearing.border.toml import read_toml
from thermobearing.border.units import parse_quantity
from thermobearing.structure.connections.axial import AxialTable
from thermobearing.structure.connections.model import AnyDevice, DeviceTable
from thermobearing.structure.fields import GROUND, Height, Length, Name, Stiffness

LIMITS = read_toml(data_path("plausible", "piers.toml"))
MassModel = Literal["consistent", "published"]
DampingKind = Literal["modal", "rayleigh", "element", "none", "source", "source-with-bearings"]
SOURCE_KINDS = ("source", "source-with-bearings")  # through modes 1 and 2 on the bearings
Direction = Literal["x", "y"]
RotationalStiffness = Annotated[float, in_unit("kN mm/rad"), Field(ge=1e-3, le=1e15)]
Ratio = Annotated[float, Field(ge=0, lt=1)]
ModeNumber = Annotated[int, Field(ge=1, le=200)]


class Body(Strict):
    """A rigid body; `base_height` is where it stands, `moves` and `rotates` its coordinates.

    In plan, both give a coordinate for each direction. `twists` gives a rotation about the
    vertical, positive from x to y; without it a body twists with what carries it. `x` and `y` are
    the place of its reference point, by default that of its carrier, or zero.
    """

    name: Name
    base_height: Height = 0.0
    on: Name | None = None
    moves: bool = False
    rotates: bool = False
    x: Length | None = None
    y: Length | None = None
    twists: bool | None = None


class Mass(Strict):
    """A mass on a body, with its own rotary inertia if that is known.

    In plan, `x` and `y` are by default those of the body, the rotary inertia counts for rocking
    in both directions, and `twist_inertia` is that about the vertical through the mass.
    """

    body: Name
    height: Height
    mass: Annotated[float, in_unit("kN s^2/mm"), Field(ge=1e-6, le=1e5)]  # 1 kg to 1e8 t
    rotary_inertia: Annotated[float, in_unit("kN mm s^2"), Field(ge=0, le=1e15)] = 0.0
    x: Length | None = None
    y: Length | None = None
    twist_inertia: Annotated[float, in_unit("kN mm s^2"), Field(ge=0, le=1e18)] | None = None


class Spring(Strict):
    """A linear spring between `body` and `base`: sideways at a height, or against rotation.

    In plan it acts in both directions, or in its `direction`; with `direction = "twist"` it acts
    against rotation about the vertical. `x` and `y` are by default those of the body.
    """

    name: Name
    body: Name
    base: Name = GROUND
    height: Height = 0.0
    stiffness: Stiffness | None = None
    rotational_stiffness: RotationalStiffness | None = None
    damping_ratio: Ratio = 0.0
    x: Length | None = None
    y: Length | None = None
    direction: Literal["x", "y", "twist"] | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, object]) -> list[str]:
        """One of the two stiffnesses, and the one against rotation for twist."""
        if ("stiffness" in values) == ("rotational_stiffness" in values):
            return ["give either stiffness or rotational_stiffness"]
        if values.get("direction") == "twist" and "stiffness" in values:
            return ['direction: "twist" takes rotational_stiffness, not stiffness']
        return []


class Hinge(Strict):
    """A degrading rotational hinge (Takeda) between `body` and `base`.

    In plan these are two hinges, one for each direction, that do not affect each other; or one,
    with a `direction`.
    """

    name: Name
    body: Name
    base: Name = GROUND
    yield_moment: Annotated[float, in_unit("kN mm"), Field(ge=1e-3, le=1e12)]
    yield_rotation: Annotated[float, in_unit("rad"), Field(ge=1e-6, lt=1)]
    hardening_ratio: Annotated[float, Field(ge=0, lt=1)] = 0.0
    unloading_exponent: Annotated[float, Field(ge=0, le=1)] = 0.5
    damping_ratio: Ratio = 0.0
    direction: Direction | None = None

    @property
    def stiffness(self) -> float:
        """Initial stiffness [kN mm/rad]."""
        return self.yield_moment / self.yield_rotation


class BearingLine(Strict):
    """Equal bearings side by side between `body` (above) and `base`.

    `equivalent_stiffness` is that of one bearing at its design displacement, for eigenvalues;
    `damping_ratio` counts in the damping of kinds "element" (c_1 of Eq. 6.4), "source" and
    "source-with-bearings" only.
    `scale` is the length of the modelled specimen over that of the bearing in the structure.
    In plan, `x` and `y` are by default those of the body that carries the line, or of `body` on
    the ground. The force acts at `height` along the bridge and at `height_across` across it (by
    default the same height): where the deck does not roll, that of the inertia of the deck. `axial`
    is the table of its axial forces, which act with `axial` in the analysis.
    """

    name: Name
    body: Name
    base: Name = GROUND
    height: Height = 0.0
    count: Annotated[int, Field(ge=1, le=10_000)]
    equivalent_stiffness: Stiffness
    damping_ratio: Ratio = 0.0
    scale: Annotated[float, Field(ge=1e-3, le=1)] = 1.0
    x: Length | None = None
    y: Length | None = None
    height_across: Height | None = None
    axial: AxialTable | None = None

    @property
    def dead_load(self) -> float:
        """Dead load on all bearings of the line [kN]; zero where it is not stated."""
        return sum(self.axial.dead_loads(self.count)) if self.axial is not None else 0.0


class Damping(Strict):
    """Viscous damping of the structure without its bearings; see docs/theory.md.

    Attributes
    ----------
    kind : "modal" (default), a ratio for each mode; "rayleigh", mass and stiffness term through
        two chosen modes, or the stiffness term alone through one; "element", a dashpot parallel to
        every spring and hinge; "none". "source" is that of Shen (2023): Rayleigh through modes 1
        and 2 of the structure on its bearings, with a mass term on everything. Its stiffness term
        is of springs and hinges; in "source-with-bearings" it is of all [K] of Eq. 3.3, so that
        bearings have a dashpot of their equivalent stiffness too.
    ratios : instead of those of the parts weighed with strain energy: of each mode, or one for
        all (modal); of the chosen modes (rayleigh); of modes 1 and 2 (source and
        source-with-bearings).
    modes : that Rayleigh damping goes through, one or two of those of the structure without
        its bearings, from 1 for the longest period; 1 and 2 by default.
    """

    kind: DampingKind = "modal"
    ratios: Annotated[tuple[Ratio, ...], Field(min_length=1, max_length=200)] | None = None
    modes: Annotated[tuple[ModeNumber, ...], Field(min_length=1, max_length=2)] | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, object]) -> list[str]:
        """Return faults of keys that do not apply to the kind, and of ratios without a kind."""
        kind = values.get("kind", "modal")
        faults = []
        if "ratios" in values and "kind" not in values:
            faults.append(
                "ratios: require kind, one of modal, rayleigh, source and source-with-bearings"
            )
        if "ratios" in values and kind in ("element", "none"):
            faults.append(f'ratios: kind = "{kind}" has none')
        if "modes" in values and kind != "rayleigh":
            faults.append('modes: only of kind = "rayleigh"')
        return faults

    @model_validator(mode="after")
    def _lengths(self) -> "Damping":
        if self.kind in SOURCE_KINDS and self.ratios is not None and len(self.ratios) != 2:
            raise ValueError(f'ratios: kind = "{self.kind}" takes two, of modes 1 and 2')
        if self.modes is not None and len(set(self.modes)) < len(self.modes):
            raise ValueError("modes: one twice")
        return self


class Reported(Strict):
    """Bodies that tables call deck and pier, and the height of the pier top.

    `line` is the bearing line of histories and the table of peaks; by default the first between
    deck and pier. A deck on bearings that stand on the ground has no pier; both keys are left out.
    """

    deck: Name
    pier: Name = GROUND
    pier_base: Name = GROUND
    pier_top: Height = 0.0

    line: Name | None = None


class PierLimits(Strict):
    """What a pier may do before the model says nothing of it; data/plausible/piers.toml has why.

    Attributes
    ----------
    ductility : of any hinge: its rotation over that at yield.
    drift : displacement of a pier top relative to its base over the height of the pier [rad].
    """

    ductility: Annotated[float, Field(gt=1, le=1e4)] = LIMITS["ductility"]["value"]
    drift: Annotated[float, in_unit("rad"), Field(gt=0, le=10)] = parse_quantity(
        LIMITS["drift"]["value"], "rad"
    )


_Part = Body | Mass | Spring | Hinge | BearingLine | DeviceTable
# `x` is of use to drawings without a plan too.
DIRECTIONS: tuple[Direction, ...] = ("x", "y")
ACROSS = 1e-9  # cosine of an angle below which a device acts across a direction only
PLAN_KEYS = ("y", "twists", "twist_inertia", "direction", "height_across", "angle")


def _point(
    part: Body | Mass | Spring | BearingLine | DeviceTable, usual: tuple[float, float]
) -> tuple[float, float]:
    """Return the coordinates of a part, or the usual ones."""
    return usual[0] if part.x is None else part.x, usual[1] if part.y is None else part.y


class Structure(Sourced):
    """A structure; see docs/files.md.

    Attributes
    ----------
    name, description, citation : identification and sources.
    bodies : rigid bodies, each after the one that carries it.
    masses : on bodies.
    springs, hinges, bearings : connections of two bodies, or of a body and the ground.
    devices : parallel to bearings: viscous dampers, friction sliders, gaps.
    damping : viscous damping, in addition to the hysteresis of bearings and hinges.
    limits : of piers; a run that exceeds one has the outcome `pier_beyond_limit`.
    report : which body is the deck, which the pier, and where its ends are.
    plan : true if it moves in two directions and may twist.
    p_delta : true if weights act on the displaced structure: those of masses of piers and footings,
        and dead loads of lines (`axial.dead_load`) on piers and on the shear of the bearings.
    """

    name: Name
    plan: bool | None = None
    p_delta: bool | None = None
    description: str = ""
    citation: str = ""
    bodies: Annotated[list[Body], Field(min_length=1, max_length=100)]
    masses: Annotated[list[Mass], Field(min_length=1)]
    springs: tuple[Spring, ...] = ()
    hinges: tuple[Hinge, ...] = ()
    bearings: Annotated[list[BearingLine], Field(min_length=1, max_length=40)]
    devices: Annotated[tuple[AnyDevice, ...], Field(max_length=100)] | None = None
    damping: Damping = Damping()
    limits: PierLimits = PierLimits()
    report: Reported

    @model_validator(mode="after")
    def _names_exist(self) -> "Structure":
        names: list[str] = []
        faults = []
        for body in self.bodies:
            if body.name in (*names, GROUND):
                faults.append(f'two bodies are called "{body.name}"')
            if body.on is not None and body.on not in (*names, GROUND):
                faults.append(f'body "{body.name}" stands on "{body.on}", which is not above it')
            if body.on is not None and body.moves:
                faults.append(f'body "{body.name}" is carried by "{body.on}": remove moves')
            if body.on is None and not body.moves:
                faults.append(f'body "{body.name}" needs moves = true, or a body that carries it')
            names.append(body.name)
        lines = [line.name for line in self.bearings]
        duplicates = dict.fromkeys(name for name in lines if lines.count(name) > 1)
        faults += [f'two bearing lines are called "{name}"' for name in duplicates]
        line = self.report.line
        if line is not None and line not in lines:
            faults.append(f'report.line: no bearing line is called "{line}"{nearest(line, lines)}')
        if self.report.pier == GROUND and any(line.base != GROUND for line in self.bearings):
            faults.append(
                "report.pier (the body that is the pier) and report.pier_top (the height of "
                "its top) are required, unless all bearings stand on the ground"
            )
        faults += self._device_faults(lines)
        weightless = [line.name for line in self.bearings if line.axial is None]
        if self.p_delta and weightless:
            faults.append(
                f"p_delta: needs axial.dead_load of all bearing lines; {', '.join(weightless)} "
                f"{'has' if len(weightless) == 1 else 'have'} none"
            )
        wrong = [
            line.name
            for line in self.bearings
            if line.axial is not None and len(line.axial.dead_load) not in (1, line.count)
        ]
        if self.p_delta and wrong:
            faults.append(f"p_delta: give one dead_load, or `count` of them, in {', '.join(wrong)}")
        used = [mass.body for mass in self.masses]
        for device in self.device_list:
            used += [name for name in (device.body, device.base) if name is not None]
        parts: tuple[Spring | Hinge | BearingLine, ...] = (*self.springs, *self.hinges)
        for part in (*parts, *self.bearings):
            used += [part.body, part.base]
        used += [self.report.deck, self.report.pier, self.report.pier_base]
        for name in dict.fromkeys(used):
            if name not in (*names, GROUND):
                faults.append(f'no body is called "{name}"{nearest(name, [*names, GROUND])}')
        if faults:
            raise ValueError("; ".join(faults))
        return self

    def _device_faults(self, lines: Sequence[str]) -> list[str]:
        """Return faults of the names of devices and of the lines that they are parallel to."""
        names = [device.name for device in self.device_list]
        duplicates = dict.fromkeys(name for name in names if names.count(name) > 1)
        faults = [f'two devices are called "{name}"' for name in duplicates]
        for number, device in enumerate(self.device_list):
            if device.line is not None and device.line not in lines:
                faults.append(
                    f'devices[{number}].line: no bearing line is called "{device.line}"'
                    f"{nearest(device.line, lines)}"
                )
            if device.body is not None and device.body == (device.base or GROUND):
                faults.append(f'devices[{number}]: connects "{device.body}" with itself')
        return faults

    @model_validator(mode="after")
    def _plan_is_complete(self) -> "Structure":
        """Refuse keys that say nothing without a plan, and a twist that nothing can hold."""
        faults: list[str] = []
        first_places: dict[tuple[str, str], str] = {}  # the first place of each key
        for where, items in self._parts().items() if not self.plan else ():
            for number, item in enumerate(items):
                for key in PLAN_KEYS:
                    if getattr(item, key, None) is not None:
                        first_places.setdefault((where, key), f"{where}[{number}].{key}")
        if first_places:
            faults.append(
                f"{', '.join(first_places.values())}: for a structure in plan; add plan = true"
            )
        for body in self.bodies if self.plan else []:
            faults += self._one_point(body) if body.twists else []
        if faults:
            raise ValueError("; ".join(faults))
        return self

    def _parts(self) -> dict[str, Sequence["_Part"]]:
        """Return bodies, masses and connections by their keys."""
        keys = ("bodies", "masses", "springs", "hinges", "bearings")
        return {key: getattr(self, key) for key in keys} | {"devices": self.device_list}

    def _one_point(self, body: Body) -> list[str]:
        """Return the fault of a body that twists on bearings and springs at one point."""
        lines = [line for line in self.bearings if body.name in (line.body, line.base)]
        springs = [spring for spring in self.springs if body.name in (spring.body, spring.base)]
        resists_twist = any(spring.direction == "twist" for spring in springs)
        points = {self.point(line) for line in lines}
        points |= {self.point(spring) for spring in springs if spring.stiffness is not None}
        if not lines or resists_twist or len(points) > 1:
            return []
        return [
            f'bearings: body "{body.name}" twists, and all that holds it is at one point of '
            "the plan, x = {:g} mm, y = {:g} mm, so that nothing resists the twist; "
            "place bearing lines at different x or y, or remove twists".format(*points.pop())
        ]

    def body(self, name: str) -> Body:
        """Return the body of that name."""
        return next(body for body in self.bodies if body.name == name)

    def place(self, name: str) -> tuple[float, float]:
        """Return the reference point of a body in plan, x and y [mm]; zero for the ground."""
        if name == GROUND:
            return 0.0, 0.0
        body = self.body(name)
        return _point(body, self.place(body.on or GROUND))

    @property
    def device_list(self) -> tuple[AnyDevice, ...]:
        """The devices, none where the key is left out."""
        return self.devices or ()

    def line(self, name: str) -> BearingLine:
        """Return the bearing line of that name."""
        return next(line for line in self.bearings if line.name == name)

    def point(self, part: Mass | Spring | BearingLine | DeviceTable) -> tuple[float, float]:
        """Return where a part is in plan, x and y [mm]."""
        if isinstance(part, DeviceTable):
            if part.line is not None:
                return self.point(self.line(part.line))
            return _point(part, self.place(part.body or GROUND))
        carrier = part.base if isinstance(part, BearingLine) else GROUND
        return _point(part, self.place(part.body if carrier == GROUND else carrier))


STRUCTURES = Library("structure", "structures")


def list_structures() -> list[str]:
    """Return the names of the built-in structures."""
    return STRUCTURES.names()


@checked
def load_structure(name_or_path: str | Path) -> Structure:
    """Return a structure of the library by name, or one of your own from a TOML file.

    Parameters
    ----------
    name_or_path : str or Path
        A name of `list_structures()`, or a path to your own file.

    Raises
    ------
    InputError
        No such structure, or faults in the file.

    Examples
    --------
    >>> load_structure("pier-p1").bearings[0].count
    5
    """
    return STRUCTURES.load(Structure, name_or_path)


class Pier(NamedTuple):
    """A pier of the tables."""

    name: str  # of its body
    base: str  # body that it stands on; its displacement is relative to that
    top: float  # height of its top [mm]
    hinges: tuple[int | None, ...]  # number of its hinge in each direction; None without one
    height: float  # from the base of its body to its top [mm]


def reported_line(structure: Structure, own: Collection[str] = ()) -> int:
    """Return the number of the bearing line of histories and of the table of peaks.

    The one that `report.line` names; or the first between deck and pier of the report, if it can
    be one without a bearing of its `own`; or the first.
    """
    lines, report = structure.bearings, structure.report
    names = [line.name for line in lines]
    if report.line is not None:
        return names.index(report.line)
    # A line between deck and pier shows what both do; without one, any line has to serve.
    between = [k for k, b in enumerate(lines) if {b.body, b.base} == {report.deck, report.pier}]
    usual = [k for k in (*between, *range(len(lines))) if names[k] not in own]
    number: int = [*usual, *between, 0][0]
    return number


def line_faults(structure: Structure, requested: Sequence[str], key: str) -> list[str]:
    """Return faults of the names of lines in a case: unknown, or given twice."""
    names = [line.name for line in structure.bearings]
    unknown = [name for name in requested if name not in names]
    faults = [
        f'{key}: no bearing line is called "{unknown_name}"{nearest(unknown_name, names)}'
        for unknown_name in unknown
    ]
    duplicates = dict.fromkeys(name for name in requested if requested.count(name) > 1)
    return faults + [f'{key}: "{name}" is given more than once' for name in duplicates]


def default_deck_height(structure: Structure, line: BearingLine) -> float:
    """Return the height of the masses of a deck above a bearing line [mm]; 0 without masses."""
    masses = [mass for mass in structure.masses if mass.body == line.body]
    if not masses:
        return 0.0
    total = sum(mass.mass for mass in masses)
    return sum(mass.mass * mass.height for mass in masses) / total - line.height


def carried_mass(structure: Structure) -> float:
    """Return the mass of the bodies that stand on bearing lines [kN s2/mm]."""
    bodies = {line.body for line in structure.bearings}
    return sum(mass.mass for mass in structure.masses if mass.body in bodies)


def axial_table_faults(structure: Structure, line: BearingLine, level: str) -> list[str]:
    """Return what the table of axial forces of a line lacks, by `axial` of the analysis."""
    table, faults = line.axial, []
    assert table is not None
    if len(table.dead_load) not in (1, line.count):
        faults.append(
            f"dead_load: has {len(table.dead_load)} entries; give one, or {line.count} (count)"
        )
    if level == "dead":
        return faults
    if table.places is None:
        faults.append(f'places: needed with axial = "{level}"; give {line.count} (count)')
    elif len(table.places) != line.count:
        faults.append(f"places: has {len(table.places)} entries; give {line.count} (count)")
    elif line.count > 1 and len(set(table.places)) == 1:
        faults.append("places: are all alike, so that nothing resists the overturning moment")
    if not structure.plan and not table.across:
        faults.append(
            f'across: axial = "{level}" needs a transverse structure; set across = true if it is '
            "one, or plan = true in the structure"
        )
    if table.deck_height is None and default_deck_height(structure, line) <= 0.0:
        faults.append(
            "deck_height: needed, since the deck has no mass above the line; give the height of "
            "the inertia above mid-height of the bearings"
        )
    return faults


def device_ends(structure: Structure, device: DeviceTable) -> tuple[str, str, float]:
    """Return body, base and height [mm] of a device: its own, or those of its line."""
    if device.line is not None:
        line = structure.line(device.line)
        return line.body, line.base, line.height
    return device.body or GROUND, device.base or GROUND, device.height or 0.0


def list_hinges(structure: Structure) -> list[Hinge]:
    """Return the hinges, one for each direction in plan ("pier base x", "pier base y")."""
    if not structure.plan:
        return list(structure.hinges)
    return [
        hinge.model_copy(update={"name": f"{hinge.name} {direction}", "direction": direction})
        for hinge in structure.hinges
        for direction in DIRECTIONS
        if hinge.direction in (None, direction)
    ]


def first_hinges(structure: Structure, pier: str) -> tuple[int | None, ...]:
    """Return the number of the first hinge of a body in each direction: below it, or else on it."""
    hinges = list(enumerate(list_hinges(structure)))
    numbers = []
    for direction in DIRECTIONS if structure.plan else (None,):
        below = [k for k, hinge in hinges if hinge.body == pier and hinge.direction == direction]
        on = [k for k, hinge in hinges if hinge.base == pier and hinge.direction == direction]
        numbers.append(next(iter([*below, *on]), None))
    return tuple(numbers)


def list_piers(structure: Structure) -> list[Pier]:
    """Return the pier of the report, then other bodies that carry a bearing line or have a hinge.

    The top of another pier is at its bearing lines, or its highest mass; its base is the body under
    its hinge or under itself.
    """
    report = structure.report
    foot = structure.body(report.pier).base_height if report.pier != GROUND else report.pier_top
    height = report.pier_top - foot
    numbers = first_hinges(structure, report.pier)
    piers = [Pier(report.pier, report.pier_base, report.pier_top, numbers, height)]
    # Bodies that carry a line or have a hinge are piers too, if they can rotate or move.
    carriers = [line.base for line in structure.bearings]
    carriers += [hinge.body for hinge in structure.hinges]
    for name in dict.fromkeys(carriers):
        if name in (GROUND, report.deck, report.pier) or not _rotates(structure, name):
            continue
        below = [hinge.base for hinge in structure.hinges if hinge.body == name]
        base = next(iter(below), None) or structure.body(name).on or GROUND
        tops = [line.height for line in structure.bearings if line.base == name]
        tops = tops or [mass.height for mass in structure.masses if mass.body == name]
        top = max(tops, default=0.0)
        height = top - structure.body(name).base_height
        piers.append(Pier(name, base, top, first_hinges(structure, name), height))
    return piers


def _rotates(structure: Structure, name: str) -> bool:
    while name != GROUND:
        body = structure.body(name)
        if body.moves or body.rotates:
            return True
        name = body.on or GROUND
    return False


def fixed_base(structure: Structure) -> Structure:
    """Return the structure whose bodies on springs to the ground, which carry others, are held."""
    carriers = {body.on for body in structure.bodies}
    springs = {spring.body for spring in structure.springs if spring.base == GROUND}
    fixed = carriers & springs
    if not fixed:
        raise InputError(
            "fixed_base: there is no foundation, which is a body on springs to the ground "
            'that carries another body; to fix a body, give it on = "ground"',
            structure.name,
        )
    bodies = [
        body.model_copy(update={"moves": False, "rotates": False, "twists": None, "on": GROUND})
        if body.name in fixed
        else body
        for body in structure.bodies
    ]
    remaining = tuple(
        spring for spring in structure.springs if spring.base != GROUND or spring.body not in fixed
    )
    name = f"{structure.name} (fixed base)"[:60]
    # Sources of springs are numbered; those that remain have other numbers now.
    texts = {key: text for key, text in structure.sources.items() if not key.startswith("springs[")}
    changes = {"name": name, "bodies": bodies, "springs": remaining}
    return structure.model_copy(update=changes).with_sources(texts)


def along(structure: Structure, direction: Direction) -> Structure:
    """Return a structure in plan in one direction only, for a unidirectional analysis."""
    if not structure.plan:
        return structure
    name = f"{structure.name} (along {direction})"[:60]
    changes: dict[str, object] = {"plan": None, "name": name}
    for where, items in structure._parts().items():
        if where == "devices":
            continue
        kept = [part for part in items if getattr(part, "direction", None) in (None, direction)]
        changes[where] = type(getattr(structure, where))(_in_line(part, direction) for part in kept)
    changes["devices"] = tuple(_turned(structure.device_list, direction)) or None
    parts = "springs[", "hinges[", "devices["
    texts = {key: text for key, text in structure.sources.items() if not key.startswith(parts)}
    return structure.model_copy(update=changes).with_sources(texts)


def _turned(devices: Sequence[AnyDevice], direction: Direction) -> list[AnyDevice]:
    """Return the devices that act in a direction, with angles from it."""
    turn = 0.0 if direction == "x" else 0.5 * math.pi
    kept: list[AnyDevice] = []
    for device in devices:
        angle = None if device.in_both_directions else (device.angle or 0.0) - turn
        if angle is None or abs(math.cos(angle)) > ACROSS:
            kept.append(device.model_copy(update={"x": None, "y": None, "angle": angle}))
    return kept


def _in_line(part: _Part, direction: Direction) -> _Part:
    """Return a part without what only a plan has."""
    changes: dict[str, object] = dict.fromkeys(k for k in ("x", *PLAN_KEYS) if hasattr(part, k))
    if direction == "y" and isinstance(part, BearingLine) and part.height_across is not None:
        changes["height"] = part.height_across
    return part.model_copy(update=changes)
