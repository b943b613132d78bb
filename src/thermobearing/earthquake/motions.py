"""The ground motions of a case as data: records, pairs of records at angles, and labels."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import numpy as np
from pydantic import Field

from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd, xr
from thermobearing.border.opener import is_file
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
from thermobearing.motions.record import (
    MOST_SAMPLES,
    GroundMotion,
    check_size,
    motion_from_arrays,
)
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.words import joined, quantity
from thermobearing.results.directory import MOTION
from thermobearing.results.writing import from_attribute

if TYPE_CHECKING:
    from thermobearing.earthquake.result import EarthquakeResult
    from thermobearing.motions.targets import DesignSpectrum

MOST_ANGLES = 360  # of a pair in one table
# Keys of each record of a pair: its name or file, component and samples.
FIRST = ("name", "component", "acceleration")
SECOND = ("across", "across_component", "across_acceleration")
THIRD = ("vertical", "vertical_component", "vertical_acceleration")
Sample = Annotated[float, Field(ge=-1e12, le=1e12)]
Samples = Annotated[tuple[Sample, ...], Field(max_length=MOST_SAMPLES)]


class Motion(Strict):
    """A built-in motion, a file with what it does not say itself, or samples; or a pair of them.

    `label` is its name in tables and figures: that of the motion, made different from others of
    that name by component, ending, factor, angle or folder; a factor that is not 1, as in
    "record-x0.6", and an angle that is not zero are always in it. `group` names those whose peaks
    are averaged; by default the standard spectrum of a built-in motion. `acceleration` holds the
    samples of one that is no file, in `unit`, every `dt`.
    `angle` is that from the axis of the bridge to the first record of a pair [deg], positive
    towards the second, which is at a right angle.

    Attributes
    ----------
    across : file or built-in name of the second record of a pair.
    across_component : component of the second record; makes a pair with the same file.
    resample : bring the second record of a pair to the time step of the first, and cut both to one
        length.
    vertical : file or built-in name of the vertical record, positive upwards, of the step and
        length of the first.
    vertical_component : component of the vertical record; from the same file if `vertical` is not
        stated.
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
    vertical: Annotated[str, Field(min_length=1)] | None = None
    vertical_component: str | None = None
    vertical_acceleration: Samples | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        faults = []
        missing = [key for key in ("unit", "dt") if key not in values]
        if "acceleration" in values and missing:
            faults.append(f"acceleration: samples need {' and '.join(missing)} too")
        if "across_acceleration" in values and not {"across", "acceleration"} <= set(values):
            faults.append("across_acceleration: needs across (a name) and acceleration too")
        if "vertical_acceleration" in values and not {"vertical", "acceleration"} <= set(values):
            faults.append("vertical_acceleration: needs vertical (a name) and acceleration too")
        if values.get("resample") and not {"across", "across_component"} & set(values):
            faults.append("resample: requires across, the record that is resampled")
        first, second = _keys(values)
        if second and first == second:
            faults.append("across: is the record of name; a pair has two different components")
        return faults

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

    @property
    def has_vertical(self) -> bool:
        """Whether it has a vertical record."""
        return self.vertical is not None or self.vertical_component is not None

    def load_vertical(self) -> GroundMotion | None:
        """Return the vertical record, not yet scaled; None without one."""
        if not self.has_vertical:
            return None
        first, upwards = self._record(*FIRST), self._record(*THIRD)
        steps = [len(record.acceleration) for record in (first, upwards)]
        if first.dt != upwards.dt or steps[0] != steps[1]:
            raise InputError(
                f"vertical: has {steps[1]} samples every {upwards.dt:g} s, but the first record "
                f"has {steps[0]} every {first.dt:g} s; give records of one step and length"
            )
        return upwards

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
        # Size and time of the file are part of the key of the cache: an edited file is read again.
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
    pairs = [motion for motion in motions if {"across", "across_component", "angle"} & set(motion)]
    if not pairs or plan:
        return []
    subject = f"{len(pairs)} of {len(motions)} motions have two records or an angle"
    return [
        f"{subject}; only their component along x acts, since the structure is in one direction"
    ]


MOST_NAMED = 3  # motions that are named
CUT = "cut_motion"  # code of the warning of a duration that ends motions before their end


def cut_note(lengths: Iterable[tuple[str, float]], duration: float | None) -> str:
    """Return which motions, of some names and lengths [s], a duration [s] cuts; else nothing.

    >>> cut_note([("a", 60.0), ("b", 20.0)], 40.0)
    'duration cuts a (40 of 60 s)'
    """
    if duration is None:
        return ""
    cut = {name: length for name, length in lengths if length > duration}
    named = [f"{name} ({duration:g} of {length:g} s)" for name, length in cut.items()]
    others = [f"{len(named) - MOST_NAMED} more"] if len(named) > MOST_NAMED else []
    return f"duration cuts {joined([*named[:MOST_NAMED], *others])}" if named else ""


def _keys(table: dict[str, Any]) -> list[tuple[Any, ...] | None]:
    """Return what identifies each record of a table; None for the second without one."""
    first, second = (
        (table.get(name_key), table.get(component_key))
        for name_key, component_key, _ in (FIRST, SECOND)
    )
    if second == (None, None):
        return [first, None]
    name, component = second
    # A component alone is one of the file of the first record.
    return [first, (name or table.get("name"), component)]


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
        message = str(error).partition("? If the unit is right")[0]  # a case has no trust_unit
        raise InputError(
            f'{type(motion).__name__} "{motion.name}": {message}; its acceleration must be in '
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
        item_key = key.format(number)
        try:
            # The group is there before anything can fail, so that faults have the item's number.
            groups.append([_table(item, folder)])
            groups[-1] = _at_angles(groups[-1][0])
            for table in groups[-1]:
                if isinstance(table, dict) and isinstance(table.get("name"), str):
                    motion = _valid_motion(table)
                    if motion is not None:
                        motion.load_vertical()
                    loaded += [motion.load()] if motion is not None else []
        except InputError as error:
            problems += error.lines(item_key)
    tables = [table for group in groups for table in group]
    if problems or len(loaded) < len(tables):  # the case reports faults by the number of an item
        return [group[0] for group in groups], loaded, problems
    return tables, loaded, _make_labels_differ(tables, loaded)


def _valid_motion(table: dict[str, Any]) -> Motion | None:
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
    for name, _, key in (FIRST, SECOND, THIRD):
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
    # Each angle is checked alone, so that its fault states its place in the list.
    for place, angle in enumerate(angles):
        try:
            validated(Motion, {"name": "any", "angle": angle}, "motion")
        except InputError as error:
            faults = [text.replace("angle", f"angle[{place}]", 1) for text in error.problems]
            raise InputError(faults) from None
    return [table | {"angle": angle} for angle in angles]


def _make_labels_differ(tables: list[Any], loaded: list[GroundMotion]) -> list[str]:
    """Give motions of one name labels that differ; return the faults where that fails."""
    faults = []
    chosen = [table.get("label") is not None for table in tables]
    names = [motion.name for motion in loaded]
    for name in dict.fromkeys(names):
        numbers = [k for k, candidate in enumerate(names) if candidate == name]
        if len(numbers) == 1:
            continue
        ends = _ends([(tables[k], loaded[k]) for k in numbers])
        is_repeated = any(tables[k] == tables[j] for k in numbers for j in numbers if j < k)
        # Labels that a user chose are not changed, except by the angle, which is always in them.
        labelled = any(chosen[k] for k in numbers)
        if is_repeated or (labelled and not all(AT in end for end in ends)):
            faults.append(f'motions: "{name}" is given more than once')
            continue
        for k, end in zip(numbers, ends, strict=True):
            tables[k]["label"] = f"{name}{end}"
            loaded[k] = replace(loaded[k], name=tables[k]["label"])
    # The name of a motion in a result directory is that of the directory and not of the file.
    for table, motion in zip(tables, loaded, strict=True):
        if table.get("label") is None and Path(table["name"]).name == MOTION:
            table["label"] = motion.name
    # A motion that is not run as recorded says so wherever it is named.
    for k, table in enumerate(tables):
        if not chosen[k] and _factor(table) != 1.0 and not loaded[k].name.endswith(_times(table)):
            table["label"] = f"{loaded[k].name.removesuffix(_at(table))}{_times(table)}"
            loaded[k] = replace(loaded[k], name=table["label"])
    # A label that states its angle already, as one of a resolved case does, is not lengthened.
    for k, table in enumerate(tables):
        label = loaded[k].name.removesuffix(_at(table)) + _at(table)
        if _angle(table) and label != loaded[k].name:
            table["label"], loaded[k] = label, replace(loaded[k], name=label)
    labels = [motion.name for motion in loaded]
    duplicates = {label for label in labels if labels.count(label) > 1}
    return faults or [f'motions: two are called "{label}"; give a label' for label in duplicates]


TARGETS = "motion_targets"  # attribute of a dataset: motions that were made to fit a spectrum
GENERATED = "generated_motions"  # attribute: descriptions of motions that fit a spectrum, by name
MM_PER_M = 1e3
AT = " at "  # between the label of a pair and its angle


def _angle(table: dict[str, Any]) -> float:
    """Return the angle of the table of a motion [deg]."""
    return parse_quantity(str(table.get("angle") or "0 deg"), "deg")


def _factor(table: dict[str, Any]) -> float:
    """Return the factor of the table of a motion; of one that is faulty 1, until it is checked."""
    factor = table.get("factor", 1.0)
    return float(factor) if isinstance(factor, int | float) else 1.0


def _times(table: dict[str, Any]) -> str:
    """Return the end of a label that states the factor."""
    return f"-x{_factor(table):g}"


def _at(table: dict[str, Any]) -> str:
    """Return the end of a label that states the angle."""
    return f"{AT}{_angle(table):g} deg"


def rotation_groups(motions: Sequence[Mapping[str, Any]]) -> dict[str, dict[str, float]]:
    """Return angles [deg] by label, of each motion of a resolved case that has several."""
    groups: list[tuple[dict[str, Any], dict[str, float]]] = []
    for motion in motions:
        if "angle" not in motion or "label" not in motion:
            continue
        # Tables that differ in angle and label only are the same records, turned.
        record_table = {
            key: value for key, value in motion.items() if key not in ("angle", "label")
        }
        labelled_angles = next((angles for table, angles in groups if table == record_table), None)
        if labelled_angles is None:
            groups.append((record_table, labelled_angles := {}))
        labelled_angles[str(motion["label"])] = parse_quantity(str(motion["angle"]), "deg")
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
        motion_runs = runs[runs["motion"].isin(list(angles))]
        for label_values, group in motion_runs.groupby(list(labels), sort=False, dropna=False):
            turned_by = [angles[str(label)] for label in group["motion"]]
            percentiles = rotation_measures(peaks.loc[group.index].to_numpy(), turned_by)
            label_columns = dict(zip(labels, label_values, strict=True)) | {"motion": motion}
            label_columns["angles"] = len(distinct_angles(turned_by))
            for measure, values in zip(("RotD50", "RotD100"), percentiles, strict=True):
                rows.append(
                    label_columns | {"measure": measure} | dict(zip(names, values, strict=True))
                )
    return pd.DataFrame(rows)


def _ends(motions: list[tuple[dict[str, Any], GroundMotion]]) -> list[str]:
    """Return ends of labels that differ: component, ending, factor, folder, angle or number."""
    paths = [Path(table["name"]) for table, _ in motions]
    choices = [
        [f"-{motion.component}" if motion.component else "" for _, motion in motions],
        [path.suffix.replace(".", "-") for path in paths],
        [_times(table) for table, _ in motions],
        [f"-{path.parent.name}" for path in paths],
        [_at(table) for table, _ in motions],
    ]
    # The first property in which all motions differ, in the order above, names them.
    unique = [endings for endings in choices if len(set(endings)) == len(endings)]
    return unique[0] if unique else [f"-{k}" for k in range(1, len(motions) + 1)]


class MotionTarget(NamedTuple):
    """The spectrum that a motion was made to fit, times the factor of the motion."""

    description: str
    spectrum: "DesignSpectrum"


def motion_targets(dataset: "xr.Dataset") -> dict[str, MotionTarget]:
    """Return the target spectra of the motions that were made to fit one, by name."""
    from thermobearing.motions.targets import read_target  # takes scipy

    rows = from_attribute(dataset, TARGETS) if TARGETS in dataset.attrs else {}
    targets = {}
    for name, row in rows.items():
        spectrum = read_target(row["target"])
        targets[name] = MotionTarget(row["description"], spectrum.scaled(float(row["factor"])))
    return targets


def given_motions_table(
    motions: Sequence[Mapping[str, Any]], result: "EarthquakeResult | None" = None
) -> Table:
    """Return the motions of a resolved case; with a result their length and peak as run."""
    rows: list[dict[str, Any]] = []
    targets = {} if result is None else motion_targets(result.dataset)
    described: dict[str, str] = {}
    if result is not None and GENERATED in result.dataset.attrs:
        described = from_attribute(result.dataset, GENERATED)
    for motion in motions:
        records = [Path(str(motion[key])).stem for key in ("name", "across") if motion.get(key)]
        name = str(motion.get("label") or "+".join(dict.fromkeys(records)))
        row = {"motion": name, "motion_factor": float(motion.get("factor", 1.0))}
        row |= {"motion_angle": quantity(motion["angle"])} if motion.get("angle") else {}
        if result is not None:
            names = [str(label) for label in result["motion"].values]
            if name not in names:  # interrupted before it
                continue
            run = names.index(name)
            row["motion_length_s"] = float(np.nanmax(result["time"].values[run]))
            row["motion_peak_m_s2"] = float(
                np.nanmax(np.abs(result["ground_acceleration"].values[run]))
            )
        source = _motion_source(motion)
        if name in described and source.startswith("file"):
            factor = row["motion_factor"]
            times = f"; as run, times {factor:g}" if factor != 1.0 else ""
            source = f"{source}: {described[name]}{times}"
        rows.append(row | {"source": source})
    note = ""
    if result is not None:
        note = f"Lengths and peaks as run, after factor and cut. {_peaks_of_targets(rows, targets)}"
    return make_table(pd.DataFrame(rows), None, "Ground motions", note=note.strip())


def _peaks_of_targets(
    rows: Sequence[Mapping[str, Any]], targets: Mapping[str, MotionTarget]
) -> str:
    """Return the peak accelerations that differ from that of the target at period zero.

    They do by more than the misfit that generated motions may have; empty where none does.
    """
    from thermobearing.motions.matching import LARGEST_MISFIT  # takes scipy

    ratios = {}
    for row in rows:
        target = targets.get(str(row["motion"]))
        if target is not None and (at_rest := target.spectrum.ground_acceleration):
            ratio = row["motion_peak_m_s2"] * MM_PER_M / at_rest
            if abs(ratio - 1.0) > LARGEST_MISFIT:
                ratios[str(row["motion"])] = ratio
    if not ratios:
        return ""
    peaks = joined(f"{ratio:.2f} times ({name})" for name, ratio in ratios.items())
    return (
        "Peak ground accelerations differ from the acceleration of the target spectrum at period "
        f"zero, such as A_s, times the factor of the motion: {peaks}. Motions are fitted over "
        "0.1 to 3 s and not at period zero."
    )


def _motion_source(motion: Mapping[str, Any]) -> str:
    name = str(motion.get("name", ""))
    if "acceleration" in motion:
        return "samples given in Python"
    if {name, str(motion.get("across", name))} <= set(list_motions()):
        return "synthetic stand-in fitted to the Level 2 standard spectrum of JRA"
    paths = [Path(str(motion[key])) for key in ("name", "across") if motion.get(key)]
    # Every directory of `motions make` has a file of this name; its folder tells which it is.
    files = [
        f"{path.parent.name}/{path.name}" if path.name == MOTION and path.parent.name else path.name
        for path in paths
    ]
    return f"file {' and '.join(files)}" if files else ""
