"""What a test rig can give, and where a run asks for more. Nothing stops: it is said."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from thermobearing.border.errors import InputError
from thermobearing.border.library import Library, Sourced
from thermobearing.border.schema import Name, in_unit
from thermobearing.results.ranges import Row, compared

LIMITS = {  # of a rig: unit, and how a run that passes it is told
    "force": ("kN", "asks for {0:.4g} kN, more than the {1:g} kN"),
    "stroke": ("mm", "moves to {0:.4g} mm, farther than the {1:g} mm"),
    "speed": ("mm/s", "moves at {0:.4g} mm/s, faster than the {1:g} mm/s"),
}


class Rig(Sourced):
    """Largest force, stroke and speed of an actuator, either way; what is left out has no limit.

    Attributes
    ----------
    name, description, citation : what it is and where its numbers come from.
    force : [kN], in [0.001, 1e6].
    stroke : from the middle [mm], in [0.001, 1e5].
    speed : [mm/s], in [1e-6, 1e6].

    Examples
    --------
    >>> load_rig("shen-rig").force
    400.0
    """

    name: Name = "rig"
    description: str = ""
    citation: str = ""
    force: Annotated[float, in_unit("kN"), Field(ge=1e-3, le=1e6)] | None = None
    stroke: Annotated[float, in_unit("mm"), Field(ge=1e-3, le=1e5)] | None = None
    speed: Annotated[float, in_unit("mm/s"), Field(ge=1e-6, le=1e6)] | None = None

    @classmethod
    def conflicts(cls, given: dict[str, Any]) -> list[str]:
        """A rig without a limit says nothing."""
        if set(given) & set(LIMITS):
            return []
        return ['give one limit at least: force = "... kN", stroke = "... mm", speed = "... mm/s"']


RIGS = Library("rig", "rigs")


def load_rig(name_or_path: str | Path) -> Rig:
    """A rig of the library by name, or one of your own from a TOML file.

    Parameters
    ----------
    name_or_path : "shen-rig", that of the source (Table 3.2), or a path.

    Raises
    ------
    InputError : no such rig, or faults in the file.

    Examples
    --------
    >>> load_rig("shen-rig").stroke
    200.0
    """
    return RIGS.load(Rig, name_or_path)


def settle_rig(table: dict[str, Any], folder: Path) -> list[str]:
    """Replace the name or file of a rig in the table of a case by the rig; what is wrong."""
    given = table.get("rig")
    if not isinstance(given, str | Path):
        return []
    own = str(given).endswith(".toml")
    try:
        table["rig"] = load_rig(folder / given if own else given)
    except InputError as error:
        del table["rig"]
        return error.lines("rig")
    return []


def asked_of(rig: Rig | None, run: str, peaks: Sequence[float]) -> list[Row]:
    """What a run asks of each limit of a rig: force [kN], stroke [mm] and speed [mm/s]."""
    known = {name: getattr(rig, name, None) for name in LIMITS}
    limits = {name: (0.0, limit) for name, limit in known.items() if limit is not None}
    units = {name: unit for name, (unit, _) in LIMITS.items()}
    return compared(run, dict(zip(LIMITS, peaks, strict=True)), limits, units)


def beyond(rig: Rig | None, rows: Sequence[Row]) -> list[str]:
    """A sentence for each limit that a run passes."""
    return [
        f"{row['run']} {LIMITS[row['limit']][1].format(row['asked'], row['largest'])} of "
        f"{rig.name}: that rig cannot do it"
        for row in rows
        if rig is not None and row["passed"]
    ]
