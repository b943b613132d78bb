"""What stands on the bearing lines of a study: bearings by name or file, lines of their own."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from thermobearing.bearing.bilinear import BilinearBearing, load_device
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, nearest
from thermobearing.border.schema import Strict
from thermobearing.climate.readers import read_air
from thermobearing.cyclic.case import Temperature
from thermobearing.cyclic.protocol import LONGEST
from thermobearing.structure.model import Stiffness, Structure

Device = Annotated[Bearing | BilinearBearing, Field(discriminator="kind")]


class OnLine(Strict):
    """What one bearing line has for itself; what is left out is that of the study.

    Attributes
    ----------
    line : its name in the structure.
    bearing : of this line, whatever the study compares.
    count, equivalent_stiffness : instead of the structure's; the resolved case has them there.
    ambient : temperature of its air and of its bearings at the start [degC], in [-100, 100].
    weather : file of its air, a table or EPW, that ends when the earthquake begins, instead of
        `ambient`.
    """

    line: Annotated[str, Field(min_length=1, max_length=60)]
    bearing: Device | None = None
    count: Annotated[int, Field(ge=1, le=10_000)] | None = None
    equivalent_stiffness: Stiffness | None = None
    ambient: Temperature | None = None
    weather: Annotated[str, Field(min_length=1)] | None = None

    @classmethod
    def conflicts(cls, given: dict[str, Any]) -> list[str]:
        """One way to say the air."""
        both = {"ambient", "weather"} <= set(given)
        return ["give ambient or weather, not both"] if both else []


def settle_lines(table: dict[str, Any], folder: Path) -> list[str]:
    """Replace names and files of lines of their own in the table of a case; what is wrong."""
    given = table.get("lines")
    if not isinstance(given, list | tuple):
        return []
    problems: list[str] = []
    settled = []
    for number, item in enumerate(given):
        line = dict(item) if isinstance(item, dict) else item
        if isinstance(line, dict):
            bearing = line.get("bearing")
            if isinstance(bearing, str | Path):
                own = str(bearing).endswith(".toml")
                try:
                    line["bearing"] = load_device(folder / bearing if own else bearing)
                except InputError as error:
                    problems += error.lines(f"lines[{number}].bearing")
                    del line["bearing"]
            if isinstance(line.get("weather"), str | Path) and str(line["weather"]):
                line["weather"] = str((folder / line["weather"]).absolute())
        settled.append(line)
    table["lines"] = settled
    return problems


def lines_faults(lines: Sequence[OnLine], structure: Structure) -> list[str]:
    """Lines that the structure does not have, or twice; air that cannot be read."""
    names = [line.name for line in structure.bearings]
    given = [item.line for item in lines]
    found = [
        f'lines: no bearing line is called "{name}"{nearest(name, names)}'
        for name in given
        if name not in names
    ]
    twice = dict.fromkeys(name for name in given if given.count(name) > 1)
    found += [f'lines: "{name}" is given more than once' for name in twice]
    if {item.line for item in lines if item.bearing is not None} >= set(names):
        found.append(
            "lines: every line has a bearing of its own, and none is left for those of the study; "
            "leave one to bearings"
        )
    for item in lines:
        if item.weather is not None:
            found += weather_faults(item.weather, f"lines, {item.line}: weather")
    return found


def weather_faults(path: str, key: str) -> list[str]:
    """What keeps a file from being the air before an earthquake."""
    try:
        time = read_air(path).time
    except InputError as error:
        return error.lines(key)
    lasts = time[-1] - time[0]
    if 1.0 <= lasts <= LONGEST:
        return []
    return [f"{key}: lasts {lasts:g} s; must be 1 to {LONGEST:g} s"]


def into_structure(
    lines: Sequence[OnLine], structure: Structure
) -> tuple[tuple[OnLine, ...], Structure]:
    """Counts and stiffnesses of lines put into the structure, and the lines without them."""
    changes = {
        item.line: {
            key: value
            for key, value in (
                ("count", item.count),
                ("equivalent_stiffness", item.equivalent_stiffness),
            )
            if value is not None
        }
        for item in lines
    }
    if not any(changes.values()):
        return tuple(lines), structure
    bearings = [line.model_copy(update=changes.get(line.name, {})) for line in structure.bearings]
    none = {"count": None, "equivalent_stiffness": None}
    left = [item.model_copy(update=none) for item in lines]
    known = {line.name for line in bearings}  # a count of no line is for the checks to find
    rest = tuple(
        item
        for item in left
        if (item.bearing, item.ambient, item.weather) != (None, None, None)
        or item.line not in known
    )
    told = {
        key: text
        for key, text in structure.sources.items()
        if not any(
            key == f"bearings[{place}].{name}"
            for place, line in enumerate(structure.bearings)
            for name in changes.get(line.name, {})
        )
    }
    return rest, structure.model_copy(update={"bearings": bearings}).with_sources(told)
