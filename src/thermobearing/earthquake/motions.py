"""The ground motions of a case as data: records, pairs of records at angles, and labels."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from thermobearing.border.errors import InputError, is_file
from thermobearing.border.lazy import pd
from thermobearing.border.schema import Name, OneLine, Strict, in_unit, validated
from thermobearing.border.units import parse_quantity, with_unit
from thermobearing.motions.library import list_motions, load_motion
from thermobearing.motions.pair import (
    LARGEST_ANGLE,
    MotionPair,
    distinct_angles,
    make_pair,
    rotation_measures,
)
from thermobearing.motions.record import MOST_SAMPLES, GroundMotion, check_size, motion_from_arrays

MOST_ANGLES = 360  # of a pair in one table
# Keys of each record of a pair: its name or file, component and samples.
FIRST = ("name", "component", "acceleration")
SECOND = ("across", "across_component", "across_acceleration")
Sample = Annotated[float, Field(ge=-1e12, le=1e12)]
Samples = Annotated[tuple[Sample, ...], Field(max_length=MOST_SAMPLES)]


class Motion(Strict):
    """A built-in motion, a file with what it does not say itself, or samples; or a pair of them.

    `label` is its name in tables and figures: that of the motion, made different from others of
    that name by component, ending, factor, angle or folder; an angle that is not zero is always
    in it. `group` names those whose peaks are averaged; by default the standard spectrum of a
    built-in motion. `acceleration` holds the samples of one that is no file, in `unit`, every `dt`.

    `across` makes a pair: the record of the direction at a right angle, of the same file if only
    `across_component` is given. `angle` is that from the axis of the bridge to the first record
    [deg], positive towards the second. `resample` brings the second record to the time step of the
    first, and cuts both to the shorter length.
    """

    name: Annotated[str, Field(min_length=1)]
    unit: str | None = None
    dt: Annotated[float, in_unit("s"), Field(ge=1e-5, le=1)] | None = None
    component: str | None = None
    across: Annotated[str, Field(min_length=1)] | None = None
    across_component: str | None = None
    angle: Annotated[float, in_unit("deg"), Field(ge=-LARGEST_ANGLE, le=LARGEST_ANGLE)] | None = (
        None
    )
    resample: bool | None = None
    factor: Annotated[float, Field(ge=1e-6, le=100)] = 1.0
    label: Name | None = None
    group: Annotated[str, Field(min_length=1, max_length=60), OneLine] | None = None
    acceleration: Samples | None = None
    across_acceleration: Samples | None = None

    @classmethod
    def _conflicts(cls, given: dict[str, Any]) -> list[str]:
        found = []
        missing = [key for key in ("unit", "dt") if key not in given]
        if "acceleration" in given and missing:
            found.append(f"acceleration: samples need {' and '.join(missing)} too")
        if "across_acceleration" in given and not {"across", "acceleration"} <= set(given):
            found.append("across_acceleration: needs across (a name) and acceleration too")
        if given.get("resample") and not {"across", "across_component"} & set(given):
            found.append("resample: requires across, the record that is resampled")
        first, second = _keys(given)
        if second and first == second:
            found.append("across: is the record of name; a pair has two different components")
        return found

    @property
    def is_pair(self) -> bool:
        """Whether it has a record across the first one."""
        return self.across is not None or self.across_component is not None

    @property
    def title(self) -> str:
        """The label, or the names of its records."""
        names = dict.fromkeys(name for name in (self.name, self.across) if name)
        return self.label or "+".join(names)

    def load(self) -> GroundMotion:
        """Return the motion along the bridge under its label, not yet scaled."""
        if self.is_pair or self.angle is not None:
            return self.load_pair().along("x")
        loaded = self._record(*FIRST)
        return replace(loaded, name=self.label) if self.label is not None else loaded

    def load_pair(self) -> MotionPair:
        """Return both components under the label; a record alone has no motion across it."""
        second = self._record(*SECOND) if self.is_pair else None
        return make_pair(
            self._record(*FIRST),
            second,
            self.angle or 0.0,
            resample=bool(self.resample),
            name=self.label or "",
        )

    def _record(self, name_key: str, component_key: str, samples_key: str) -> GroundMotion:
        """Return one of the two records, under its own name."""
        name = getattr(self, name_key) or self.name
        component, samples = getattr(self, component_key), getattr(self, samples_key)
        if samples is not None:
            return motion_from_arrays(
                samples,
                unit=self.unit or "",
                dt=self.dt,
                name=name,
                component=component or "",
                trust_unit=True,
            )
        stamp = None
        if is_file(Path(name)):
            status = Path(name).stat()
            stamp = (status.st_mtime_ns, status.st_size)
        return _read(name, self.unit, self.dt, component, stamp)


def pair_notes(motions: Sequence[Mapping[str, Any]], *, plan: bool) -> list[str]:
    """Return a sentence on the pairs among some tables of motions, unless structures are in plan.

    >>> pair_notes([{"name": "a", "across": "b"}, {"name": "a"}], plan=False)[0][:23]
    '1 of 2 motions have two'
    """
    pairs = [one for one in motions if {"across", "across_component", "angle"} & set(one)]
    if not pairs or plan:
        return []
    some = f"{len(pairs)} of {len(motions)} motions have two records or an angle"
    return [f"{some}; the structure is in one direction and is moved by their component along x"]


def _keys(given: dict[str, Any]) -> list[tuple[Any, ...] | None]:
    """Return what identifies each record of a table; None for the second without one."""
    first, second = ([given.get(key) for key in keys[:2]] for keys in (FIRST, SECOND))
    if second == [None, None]:
        return [tuple(first), None]
    return [tuple(first), (second[0] or first[0], second[1])]


@lru_cache(maxsize=16)
def _read(
    name: str, unit: str | None, dt: float | None, component: str | None, _: tuple[int, int] | None
) -> GroundMotion:
    """Return a motion; a file is read once for the check and all runs, until its stamp changes."""
    return load_motion(name, unit=unit, dt=dt, component=component)


def motion_table(motion: GroundMotion | MotionPair) -> dict[str, Any]:
    """Return a motion as the table of a case; InputError for a size that is not mm/s2."""
    try:
        check_size(motion.pga, "mm/s2", instrument=True, trusted=False)
    except InputError as error:
        said = str(error).partition("? If the unit is right")[0]  # a case has no trust_unit
        raise InputError(
            f'{type(motion).__name__} "{motion.name}": {said}; its acceleration must be in '
            "mm/s2. Give the samples as a Motion, or a file as a table, to scale it by a factor"
        ) from None
    table: dict[str, Any] = {"unit": "mm/s2", "dt": with_unit(motion.dt, "s")}
    if isinstance(motion, GroundMotion):
        return table | _record_table(FIRST, motion)
    table |= _record_table(FIRST, motion.first) | _record_table(SECOND, motion.second)
    return table | {"angle": with_unit(motion.angle, "deg"), "label": motion.name}


def _record_table(keys: Sequence[str], motion: GroundMotion) -> dict[str, Any]:
    values = motion.name, motion.component or None, motion.acceleration.tolist()
    return dict(zip(keys, values, strict=True))


def settle_motions(
    items: Sequence[Any], folder: Path, key: str = "motions[{}]"
) -> tuple[list[Any], list[GroundMotion], list[str]]:
    """Return motions as tables that name absolute files, the motions, and the faults.

    `items` are names, paths (relative to `folder`), tables, GroundMotions, MotionPairs or Motions;
    `key` names one of them in messages, with braces for its number. A table with several angles
    becomes a table for each.
    """
    groups: list[list[Any]] = []  # the tables of each item
    loaded: list[GroundMotion] = []
    problems: list[str] = []
    for number, item in enumerate(items):
        here = key.format(number)
        try:
            groups.append([_table(item, folder)])
            groups[-1] = _at_angles(groups[-1][0])
            for table in groups[-1]:
                if isinstance(table, dict) and isinstance(table.get("name"), str):
                    made = _made(table)
                    loaded += [made.load()] if made is not None else []
        except InputError as error:
            problems += error.lines(here)
    tables = [table for group in groups for table in group]
    if problems or len(loaded) < len(tables):  # the case reports faults by the number of an item
        return [group[0] for group in groups], loaded, problems
    return tables, loaded, _tell_apart(tables, loaded)


def _made(table: dict[str, Any]) -> Motion | None:
    """Return the motion of a table; None for faults that the check of the case reports."""
    try:
        return validated(Motion, table, "motion")
    except InputError:
        return None


def _table(item: Any, folder: Path) -> Any:
    """Return one motion as a table; anything else as it is, for the checks to find."""
    if isinstance(item, GroundMotion | MotionPair):
        return motion_table(item)
    if isinstance(item, Motion):
        item = item.model_dump(exclude_none=True)
        units = {"dt": "s", "angle": "deg"}
        item |= {key: with_unit(item[key], unit) for key, unit in units.items() if key in item}
    table = {"name": str(item)} if isinstance(item, str | Path) else item
    if not isinstance(table, dict) or not isinstance(table.get("name"), str):
        return table
    table = dict(table)
    for name, _, key in (FIRST, SECOND):
        record, samples = table.get(name), table.get(key)
        if samples is not None and hasattr(samples, "tolist"):
            table[key] = samples.tolist()
        if not isinstance(record, str | Path) or key in table or str(record) in list_motions():
            continue
        table[name] = str(record)
        if is_file(folder / record):
            table[name] = str((folder / record).absolute())
    return table


def _at_angles(table: Any) -> list[Any]:
    """Return a table for each angle of a table with a list of them, and any other as it is."""
    angles = table.get("angle") if isinstance(table, dict) else None
    if not isinstance(angles, list | tuple):
        return [table]
    del table["angle"]  # faults of it are reported here, and others by the check of the case
    if not 1 <= len(angles) <= MOST_ANGLES:
        raise InputError(f"angle: has {len(angles)} angles; give 1 to {MOST_ANGLES}")
    found = [table | {"angle": angle} for angle in angles]
    for place, one in enumerate(found):
        try:
            validated(Motion, {"name": "any", "angle": one["angle"]}, "motion")
        except InputError as error:
            faults = [text.replace("angle", f"angle[{place}]", 1) for text in error.problems]
            raise InputError(faults) from None
    return found


def _tell_apart(tables: list[Any], loaded: list[GroundMotion]) -> list[str]:
    """Give motions of one name labels that differ; return the faults where that fails."""
    faults = []
    names = [motion.name for motion in loaded]
    for name in dict.fromkeys(names):
        same = [k for k, other in enumerate(names) if other == name]
        if len(same) == 1:
            continue
        ends = _ends([(tables[k], loaded[k]) for k in same])
        twice = any(tables[k] == tables[j] for k in same for j in same if j < k)
        labelled = any(tables[k].get("label") is not None for k in same)
        if twice or (labelled and not all(AT in end for end in ends)):
            faults.append(f'motions: "{name}" is given more than once')
            continue
        for k, end in zip(same, ends, strict=True):
            tables[k]["label"] = f"{name}{end}"
            loaded[k] = replace(loaded[k], name=tables[k]["label"])
    for k, table in enumerate(tables):
        label = loaded[k].name.removesuffix(_at(table)) + _at(table)
        if _angle(table) and label != loaded[k].name:
            table["label"], loaded[k] = label, replace(loaded[k], name=label)
    labels = [motion.name for motion in loaded]
    again = {label for label in labels if labels.count(label) > 1}
    return faults or [f'motions: two are called "{label}"; give a label' for label in again]


AT = " at "  # between the label of a pair and its angle


def _angle(table: dict[str, Any]) -> float:
    """Return the angle of the table of a motion [deg]."""
    return parse_quantity(str(table.get("angle") or "0 deg"), "deg")


def _at(table: dict[str, Any]) -> str:
    """Return the end of a label that states the angle."""
    return f"{AT}{_angle(table):g} deg"


def rotation_groups(motions: Sequence[Mapping[str, Any]]) -> dict[str, dict[str, float]]:
    """Return angles [deg] by label, of each motion of a resolved case that has several."""
    groups: list[tuple[dict[str, Any], dict[str, float]]] = []
    for motion in motions:
        if "angle" not in motion or "label" not in motion:
            continue
        same = {key: value for key, value in motion.items() if key not in ("angle", "label")}
        known = next((angles for other, angles in groups if other == same), None)
        if known is None:
            groups.append((same, known := {}))
        known[str(motion["label"])] = parse_quantity(str(motion["angle"]), "deg")
    several = [angles for _, angles in groups if len(distinct_angles([*angles.values()])) > 1]
    return {
        next(iter(angles)).rpartition(AT)[0] or next(iter(angles)): angles for angles in several
    }


def rotation_frame(
    runs: "pd.DataFrame",
    motions: Sequence[Mapping[str, Any]],
    labels: Sequence[str],
    names: Sequence[str],
) -> "pd.DataFrame":
    """Return RotD50 and RotD100 of the columns `names` of runs, NaN where a run failed.

    `labels` are the columns that distinguish runs of one motion at one angle.
    """
    rows = []
    peaks = runs[list(names)].astype(float).where(runs["outcome"] == "completed")
    for motion, angles in rotation_groups(motions).items():
        mine = runs[runs["motion"].isin(list(angles))]
        for same, group in mine.groupby(list(labels), sort=False, dropna=False):
            turned = [angles[str(label)] for label in group["motion"]]
            found = rotation_measures(peaks.loc[group.index].to_numpy(), turned)
            about = dict(zip(labels, same, strict=True)) | {"motion": motion}
            about["angles"] = len(distinct_angles(turned))
            for measure, values in zip(("RotD50", "RotD100"), found, strict=True):
                rows.append(about | {"measure": measure} | dict(zip(names, values, strict=True)))
    return pd.DataFrame(rows)


def _ends(motions: list[tuple[dict[str, Any], GroundMotion]]) -> list[str]:
    """Return ends of labels that differ: component, ending, factor, folder, angle or number."""
    paths = [Path(table["name"]) for table, _ in motions]
    ways = [
        [f"-{motion.component}" if motion.component else "" for _, motion in motions],
        [path.suffix.replace(".", "-") for path in paths],
        [f"-x{table.get('factor', 1.0):g}" for table, _ in motions],
        [f"-{path.parent.name}" for path in paths],
        [_at(table) for table, _ in motions],
    ]
    unique = [way for way in ways if len(set(way)) == len(way)]
    return unique[0] if unique else [f"-{k}" for k in range(1, len(motions) + 1)]
