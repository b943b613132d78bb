"""Ground motions and bearing lines of an analysis."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from thermobearing.bearing.bilinear import BilinearBearing, load_device
from thermobearing.bearing.model import Bearing
from thermobearing.border.cases import absolute, load_things
from thermobearing.border.errors import InputError, is_file, nearest
from thermobearing.border.schema import Name, OneLine, Strict, in_unit, validated
from thermobearing.border.units import with_unit
from thermobearing.climate.readers import read_air
from thermobearing.cyclic.case import Temperature
from thermobearing.cyclic.protocol import LONGEST
from thermobearing.motions.library import list_motions, load_motion
from thermobearing.motions.record import MOST_SAMPLES, GroundMotion, check_size, motion_from_arrays
from thermobearing.structure.model import Stiffness, Structure

Sample = Annotated[float, Field(ge=-1e12, le=1e12)]


class Motion(Strict):
    """A built-in motion, a file with what it does not say itself, or samples.

    `label` is its name in tables and figures: that of the motion, made different from others of
    that name by component, ending, factor or folder. `group` names those whose peaks are averaged;
    by default the standard spectrum of a built-in motion. `acceleration` holds the samples
    of one that is no file, in `unit`, every `dt`.
    """

    name: Annotated[str, Field(min_length=1)]
    unit: str | None = None
    dt: Annotated[float, in_unit("s"), Field(ge=1e-5, le=1)] | None = None
    component: str | None = None
    factor: Annotated[float, Field(ge=1e-6, le=100)] = 1.0
    label: Name | None = None
    group: Annotated[str, Field(min_length=1, max_length=60), OneLine] | None = None
    acceleration: Annotated[tuple[Sample, ...], Field(max_length=MOST_SAMPLES)] | None = None

    @classmethod
    def _conflicts(cls, given: dict[str, Any]) -> list[str]:
        missing = [key for key in ("unit", "dt") if key not in given]
        if "acceleration" in given and missing:
            return [f"acceleration: samples need {' and '.join(missing)} too"]
        return []

    def load(self) -> GroundMotion:
        """Return the ground motion under its label, not yet scaled."""
        if self.acceleration is not None:
            loaded = motion_from_arrays(
                self.acceleration,
                unit=self.unit or "",
                dt=self.dt,
                name=self.name,
                component=self.component or "",
                trust_unit=True,
            )
        else:
            loaded = load_motion(self.name, unit=self.unit, dt=self.dt, component=self.component)
        return replace(loaded, name=self.label) if self.label is not None else loaded


def make_table(motion: GroundMotion) -> dict[str, Any]:
    """Return a ground motion as the table of a case; InputError for a size that is not mm/s2."""
    try:
        check_size(motion.pga, "mm/s2", instrument=True, trusted=False)
    except InputError as error:
        said = str(error).removesuffix(". If the unit is right, say so with trust_unit")
        raise InputError(
            f'GroundMotion "{motion.name}": {said}; its acceleration is in mm/s2, and a factor '
            "scales it: a Motion with its samples, or a table of a file, takes one"
        ) from None
    return {
        "name": motion.name,
        "unit": "mm/s2",
        "dt": with_unit(motion.dt, "s"),
        "component": motion.component or None,
        "acceleration": motion.acceleration.tolist(),
    }


def settle_motions(
    items: Sequence[Any], folder: Path, key: str = "motions[{}]"
) -> tuple[list[Any], list[GroundMotion], list[str]]:
    """Return motions as tables that name absolute files, the motions, and the faults.

    `items` are names, paths (relative to `folder`), tables, GroundMotions or Motions; `key` names
    one of them in messages, with braces for its number.
    """
    tables: list[Any] = []
    loaded: list[GroundMotion] = []
    problems: list[str] = []
    for number, item in enumerate(items):
        here = key.format(number)
        try:
            table = _table(item, folder)
            tables.append(table)
            if isinstance(table, dict) and isinstance(table.get("name"), str):
                made = _made(table)
                loaded += [made.load()] if made is not None else []
        except InputError as error:
            problems += error.lines(here)
    if not problems and len(loaded) == len(tables):
        problems += _tell_apart(tables, loaded)
    return tables, loaded, problems


def _made(table: dict[str, Any]) -> Motion | None:
    """Return the motion of a table; None for faults that the check of the case reports."""
    try:
        return validated(Motion, table, "motion")
    except InputError:
        return None


def _table(item: Any, folder: Path) -> Any:
    """Return one motion as a table; anything else as it is, for the checks to find."""
    if isinstance(item, GroundMotion):
        return make_table(item)
    if isinstance(item, Motion):
        item = item.model_dump(exclude_none=True)
        item |= {"dt": with_unit(item["dt"], "s")} if "dt" in item else {}
    table = {"name": str(item)} if isinstance(item, str | Path) else item
    if not isinstance(table, dict) or not isinstance(table.get("name"), str):
        return table
    table = dict(table)
    samples: Any = table.get("acceleration")
    if hasattr(samples, "tolist"):
        table["acceleration"] = samples.tolist()
    built_in = table["name"] in list_motions() or "acceleration" in table
    if not built_in and is_file(folder / table["name"]):
        table["name"] = str((folder / table["name"]).absolute())
    return table


def _tell_apart(tables: list[Any], loaded: list[GroundMotion]) -> list[str]:
    """Give motions of one name labels that differ; return the faults where that fails."""
    faults = []
    names = [motion.name for motion in loaded]
    for name in dict.fromkeys(names):
        same = [k for k, other in enumerate(names) if other == name]
        if len(same) == 1:
            continue
        twice = any(tables[k] == tables[j] for k in same for j in same if j < k)
        if twice or any(tables[k].get("label") is not None for k in same):
            faults.append(f'motions: "{name}" is given more than once')
            continue
        for k, end in zip(same, _ends([(tables[k], loaded[k]) for k in same]), strict=True):
            tables[k]["label"] = f"{name}{end}"
            loaded[k] = replace(loaded[k], name=tables[k]["label"])
    labels = [motion.name for motion in loaded]
    again = {label for label in labels if labels.count(label) > 1}
    return faults or [f'motions: two are called "{label}"; give a label' for label in again]


def _ends(motions: list[tuple[dict[str, Any], GroundMotion]]) -> list[str]:
    """Return ends of labels that differ: component, ending, factor, folder or number."""
    paths = [Path(table["name"]) for table, _ in motions]
    ways = [
        [f"-{motion.component}" if motion.component else "" for _, motion in motions],
        [path.suffix.replace(".", "-") for path in paths],
        [f"-x{table.get('factor', 1.0):g}" for table, _ in motions],
        [f"-{path.parent.name}" for path in paths],
    ]
    told = [way for way in ways if len(set(way)) == len(way)]
    return told[0] if told else [f"-{k}" for k in range(1, len(motions) + 1)]


Device = Annotated[Bearing | BilinearBearing, Field(discriminator="kind")]


class OnLine(Strict):
    """Input of one bearing line; keys that are left out are those of the analysis.

    `line` is its name in the structure, whose `count` and `equivalent_stiffness` it replaces;
    `ambient` the temperature there and of its bearings at the start [degC]; `weather` a file, a
    table or EPW, that ends when the earthquake begins, instead of `ambient`.
    """

    line: Annotated[str, Field(min_length=1, max_length=60)]
    bearing: Device | None = None
    count: Annotated[int, Field(ge=1, le=10_000)] | None = None
    equivalent_stiffness: Stiffness | None = None
    ambient: Temperature | None = None
    weather: Annotated[str, Field(min_length=1)] | None = None

    @classmethod
    def _conflicts(cls, given: dict[str, Any]) -> list[str]:
        both = {"ambient", "weather"} <= set(given)
        return ["give ambient or weather, not both"] if both else []


def settle_lines(table: dict[str, Any], folder: Path) -> list[str]:
    """Load the bearings of lines of their own in the table of a case; return what is wrong."""
    if not isinstance(table.get("lines"), list | tuple):
        return []
    faults: list[str] = []
    table["lines"] = [dict(line) if isinstance(line, dict) else line for line in table["lines"]]
    for number, line in enumerate(table["lines"]):
        if isinstance(line, dict):
            faults += load_things(line, "bearing", load_device, folder, before=f"lines[{number}].")
            absolute(line, "weather", folder)
    return faults


def lines_faults(lines: Sequence[OnLine], structure: Structure) -> list[str]:
    """Return faults of lines: unknown or given twice, weather that cannot be read."""
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
            "lines: every line has a bearing of its own, and none is left for those of the case; "
            "leave one to bearings"
        )
    for item in lines:
        if item.weather is not None:
            found += weather_faults(item.weather, f"lines, {item.line}: weather")
    return found


def weather_faults(path: str, key: str) -> list[str]:
    """Return why a file cannot be the weather before an earthquake."""
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
    """Put counts and stiffnesses of lines into the structure; return the lines without them."""
    own = {"count", "equivalent_stiffness"}
    changes = {item.line: item.model_dump(include=own, exclude_none=True) for item in lines}
    if not any(changes.values()):
        return tuple(lines), structure
    bearings = [line.model_copy(update=changes.get(line.name, {})) for line in structure.bearings]
    left = [item.model_copy(update=dict.fromkeys(own)) for item in lines]
    known = {line.name for line in bearings}  # a count of no line is for the checks to find
    rest = tuple(
        item
        for item in left
        if (item.bearing, item.ambient, item.weather) != (None, None, None)
        or item.line not in known
    )
    changed = {
        f"bearings[{place}].{key}"
        for place, line in enumerate(structure.bearings)
        for key in changes.get(line.name, ())
    }
    sources = {key: text for key, text in structure.sources.items() if key not in changed}
    return rest, structure.model_copy(update={"bearings": bearings}).with_sources(sources)
