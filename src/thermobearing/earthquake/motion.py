"""The ground motions of a study as data: names, files or samples, each with a name of its own."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from thermobearing.border.errors import InputError, is_file
from thermobearing.border.schema import Name, OneLine, Strict, in_unit, validated
from thermobearing.border.units import with_unit
from thermobearing.motions.arrays import motion_from_arrays
from thermobearing.motions.library import list_motions, load_motion
from thermobearing.motions.record import MOST_SAMPLES, GroundMotion
from thermobearing.motions.sniffing import check_size

Sample = Annotated[float, Field(ge=-1e12, le=1e12)]


class Motion(Strict):
    """A built-in motion, a file, or samples; what a file does not say itself.

    `label` is its name in tables and figures: that of the motion, told apart from others of that
    name by component, ending, factor or folder. `group` names those whose peaks a mean is taken
    over; by default the standard spectrum of a built-in motion. `acceleration` holds the samples
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
    def conflicts(cls, given: dict[str, Any]) -> list[str]:
        """Samples say nothing about themselves."""
        missing = [key for key in ("unit", "dt") if key not in given]
        if "acceleration" in given and missing:
            return [f"acceleration: samples need {' and '.join(missing)} too"]
        return []

    def load(self) -> GroundMotion:
        """The ground motion itself, under its label, not yet scaled."""
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


def table_of(motion: GroundMotion) -> dict[str, Any]:
    """A ground motion as the table of a case; InputError if its size speaks against mm/s2."""
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
    """Motions as tables that name absolute files; what they hold; what is wrong with them.

    Parameters
    ----------
    items : names, paths, tables, GroundMotions or Motions.
    folder : paths are relative to it.
    key : of one of them in messages, with braces for its number.
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
    """The motion of a table; None for faults that the check of the whole case will tell."""
    try:
        return validated(Motion, table, "motion")
    except InputError:
        return None


def _table(item: Any, folder: Path) -> Any:
    """One motion as a table; what is none stays as it is, for the checks to find."""
    if isinstance(item, GroundMotion):
        return table_of(item)
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
    """Give motions of one name labels that differ; what cannot be told apart is a fault."""
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
    """What tells motions of one name apart: the first of these that does."""
    paths = [Path(table["name"]) for table, _ in motions]
    ways = [
        [f"-{motion.component}" if motion.component else "" for _, motion in motions],
        [path.suffix.replace(".", "-") for path in paths],
        [f"-x{table.get('factor', 1.0):g}" for table, _ in motions],
        [f"-{path.parent.name}" for path in paths],
    ]
    told = [way for way in ways if len(set(way)) == len(way)]
    return told[0] if told else [f"-{k}" for k in range(1, len(motions) + 1)]
