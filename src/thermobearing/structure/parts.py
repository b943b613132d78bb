"""Which bearing line and which piers of a structure are told about, and a structure held fast."""

from collections.abc import Collection
from dataclasses import dataclass

from thermobearing.border.errors import InputError
from thermobearing.structure.model import GROUND, Structure


@dataclass(frozen=True)
class Pier:
    """A pier as the tables have it.

    Attributes
    ----------
    name : of its body.
    base : body that it stands on; its displacement is relative to that.
    top : height of its top [mm].
    hinge : number of its hinge in the structure; None without one.
    height : from the base of its body to its top [mm].
    """

    name: str
    base: str
    top: float
    hinge: int | None
    height: float


def reported_line(structure: Structure, own: Collection[str] = ()) -> int:
    """Number of the bearing line that histories and the table of peaks are about.

    The one that `report.line` names; or the first between deck and pier of the report, if it can
    be one without a bearing of its `own`; or the first.

    Examples
    --------
    >>> from thermobearing.structure.model import load_structure
    >>> reported_line(load_structure("pier-p1"))
    0
    """
    lines, report = structure.bearings, structure.report
    names = [line.name for line in lines]
    if report.line is not None:
        return names.index(report.line)
    between = [k for k, b in enumerate(lines) if {b.body, b.base} == {report.deck, report.pier}]
    for chosen in (between, range(len(lines))):
        for k in chosen:
            if names[k] not in own:
                return k
    return between[0] if between else 0


def hinge_of(structure: Structure, pier: str) -> int | None:
    """Number of the first hinge at a body: below it, or else on it."""
    below = [k for k, hinge in enumerate(structure.hinges) if hinge.body == pier]
    on = [k for k, hinge in enumerate(structure.hinges) if hinge.base == pier]
    return next(iter([*below, *on]), None)


def piers_of(structure: Structure) -> list[Pier]:
    """The pier of the report, then every other body that carries a bearing line or has a hinge.

    The top of another pier is where its bearing lines are, or its highest mass; its base is what
    its hinge or the body itself stands on.

    Examples
    --------
    >>> from thermobearing.structure.model import load_structure
    >>> [(pier.name, pier.base, pier.hinge) for pier in piers_of(load_structure("pier-p1"))]
    [('pier', 'footing', 0)]
    """
    report = structure.report
    foot = structure.body(report.pier).base_height if report.has_pier else report.pier_top
    hinge = hinge_of(structure, report.pier)
    height = report.pier_top - foot
    found = [Pier(report.pier, report.pier_base, report.pier_top, hinge, height)]
    carriers = [line.base for line in structure.bearings]
    carriers += [hinge.body for hinge in structure.hinges]
    for name in dict.fromkeys(carriers):
        if name in (GROUND, report.deck, report.pier):
            continue
        if not structure.body(name).moves and not _rotates(structure, name):
            continue
        hinge = hinge_of(structure, name)
        below = hinge is not None and structure.hinges[hinge].body == name
        on = structure.hinges[hinge].base if below and hinge is not None else None
        base = on or structure.body(name).on or GROUND
        tops = [line.height for line in structure.bearings if line.base == name]
        tops = tops or [mass.height for mass in structure.masses if mass.body == name]
        top = max(tops, default=0.0)
        found.append(Pier(name, base, top, hinge, top - structure.body(name).base_height))
    return found


def _rotates(structure: Structure, name: str) -> bool:
    """Whether a body, or what carries it, has a coordinate."""
    while name != GROUND:
        body = structure.body(name)
        if body.moves or body.rotates:
            return True
        name = body.on or GROUND
    return False


def fixed_base(structure: Structure) -> Structure:
    """The structure without its foundation springs: what carries other bodies on springs is held.

    Parameters
    ----------
    structure : with a body that stands on springs to the ground and carries another.

    Returns
    -------
    Structure : that body does not move; its springs are left out. The name says so.

    Raises
    ------
    InputError : no body stands on springs and carries another, or what is left cannot be.

    Examples
    --------
    >>> from thermobearing.structure.matrices import coordinates
    >>> from thermobearing.structure.model import load_structure
    >>> coordinates(fixed_base(load_structure("pier-p1")))
    ['deck x', 'pier rotation']
    """
    carriers = {body.on for body in structure.bodies}
    springs = {spring.body for spring in structure.springs if spring.base == GROUND}
    held = carriers & springs
    if not held:
        raise InputError(
            "fixed_base: no body stands on springs to the ground and carries another; a pier whose "
            'own stiffness is a spring keeps it (give a body on = "ground" to hold one)',
            structure.name,
        )
    bodies = [
        body.model_copy(update={"moves": False, "rotates": False, "on": GROUND})
        if body.name in held
        else body
        for body in structure.bodies
    ]
    left = tuple(
        spring
        for spring in structure.springs
        if not (spring.base == GROUND and spring.body in held)
    )
    name = f"{structure.name} (fixed base)"[:60]
    told = {key: text for key, text in structure.sources.items() if not key.startswith("springs[")}
    changes = {"name": name, "bodies": bodies, "springs": left}
    return structure.model_copy(update=changes).with_sources(told)
