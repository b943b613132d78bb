"""Columns of the plan of a study, and the allowed ranges of their numbers."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from thermobearing.bearing.ambient import COLDEST, HOTTEST
from thermobearing.border.errors import InputError, nearest
from thermobearing.border.schema import Strict, find_unit, validated
from thermobearing.core.records import Floats, Ints
from thermobearing.identify.fit.parameters import ALIASES
from thermobearing.studies.definition.record import (
    OF_FACTORS,
    Distribution,
    MotionFactor,
    Picked,
    Posterior,
    Study,
    list_numbers,
)

Path = tuple[str | int, ...]
S = TypeVar("S", bound=Strict)
FACES = (("analysis", "upper_face"), ("analysis", "lower_face"), ("analysis", "side"))
# Numbers of a bearing that its heat cells know nothing of, so that they are made once.
WITHOUT_HEAT: dict[str | int, set[str] | None] = {
    "hysteresis": None,
    "scragging": None,
    "rate": None,
    "lead": {"stiffness", "yield_stress", "softening", "reference_temperature"},
}


@dataclass(frozen=True)
class Target:
    """A number that a study varies."""

    name: str  # dotted, as the study says it
    part: str  # "bearing", "structure" or "case"
    # where it is in each level of that part; None in one that does not have it
    paths: Sequence[Path | None]
    unit: str | None  # its own; None for a pure number
    of: str  # "factor" multiplies it, "value" replaces it

    def change(self, level: int, record: Strict, number: float) -> dict[Path, float]:
        """Return the number of a record of a level, changed, by its path; {} without it."""
        path = self.paths[level]
        if path is None:
            return {}
        return {path: number * value_at(record, path) if self.of == "factor" else number}


def _find_target(name: str, of: str, levels: Mapping[str, Sequence[Strict]]) -> Target:
    part, key = spelled(name)
    if part not in levels:
        raise InputError(f'factors: no part "{part}" in "{name}"; known: {", ".join(levels)}')
    without = OF_FACTORS if part == "case" else ()
    known = [number_paths(level, without) for level in levels[part]]
    found = [paths.get(key) for paths in known]
    units = [place[1] for place in found if place is not None]
    if not units:
        names = {f"{part}.{key}" for paths in known for key in paths}
        if part == "bearing":
            names |= {
                f"bearing.{alias}" for alias, key in ALIASES.items() if f"bearing.{key}" in names
            }
        raise InputError(f'factors: no number is called "{name}"{_nearest(name, names)}')
    return Target(name, part, [None if one is None else one[0] for one in found], units[0], of)


def _nearest(name: str, names: set[str]) -> str:
    close = nearest(name, names)
    if not close.startswith("; known"):
        return close
    part = name.rpartition(".")[0]
    within = sorted(one for one in names if one.rpartition(".")[0] == part)
    return nearest(name, within or {one.rpartition(".")[0] + ".…" for one in names})


def number_paths(record: Strict, without: Sequence[str] = ()) -> dict[str, tuple[Path, str | None]]:
    """Return path and unit of all numbers of a record that are no counts, by dotted name.

    Things in a list go by their name, or by that of their body where that is unique.
    """
    found = _numbers(record, "", ())
    return {name: (path, unit) for name, path, unit in found if path[0] not in without}


def _numbers(record: Strict, before: str, above: Path) -> Iterator[tuple[str, Path, str | None]]:
    for key in type(record).model_fields:
        value = getattr(record, key)
        name, path = f"{before}{key}", (*above, key)
        if isinstance(value, float):
            yield name, path, find_unit(type(record), key)
        elif isinstance(value, Strict):
            yield from _numbers(value, f"{name}.", path)
        elif isinstance(value, list | tuple):
            for number, (label, item) in enumerate(zip(_labels(value), value, strict=True)):
                if isinstance(item, Strict):
                    yield from _numbers(item, f"{name}{label}.", (*path, number))


def _labels(items: list[Any] | tuple[Any, ...]) -> list[str]:
    """Return what identifies a thing in a list: its name, its body, or its number."""
    names = [str(getattr(item, "name", getattr(item, "body", ""))) for item in items]
    return [
        f".{name}" if name and names.count(name) == 1 else f"[{number}]"
        for number, name in enumerate(names)
    ]


def spelled(name: str) -> tuple[str, str]:
    """Return part and dotted key of a number; of "bearing.K_r" hysteresis.layer_stiffness."""
    part, _, key = name.partition(".")
    return part, ALIASES.get(key, key) if part == "bearing" else key


def value_at(record: Any, path: Path) -> float:
    """Return the number at a path."""
    for step in path:
        record = record[step] if isinstance(step, int) else getattr(record, step)
    return float(record)


def with_numbers(record: S, changes: Mapping[Path, float]) -> S:
    """Return the record with other numbers; quick, its limits are not checked again."""
    update: dict[str, Any] = {}
    for key in dict.fromkeys(path[0] for path in changes):
        inner = {path[1:]: value for path, value in changes.items() if path[0] == key}
        assert isinstance(key, str)
        update[key] = _changed(getattr(record, key), inner)
    return record.model_copy(update=update)


def _changed(value: Any, changes: Mapping[Path, float]) -> Any:
    """Return a number, a record or a list of records with other numbers."""
    if () in changes:
        return changes[()]
    if isinstance(value, Strict):
        return with_numbers(value, changes)
    made = list(value)
    for number in {path[0] for path in changes}:
        assert isinstance(number, int)
        inner = {path[1:]: new for path, new in changes.items() if path[0] == number}
        made[number] = with_numbers(made[number], inner)
    return type(value)(made)


def moves_heat(path: Path) -> bool:
    """Return whether a number of a bearing goes into its heat cells."""
    if path[0] not in WITHOUT_HEAT:
        return True
    within = WITHOUT_HEAT[path[0]]
    return within is not None and path[1] not in within


def moves_warmth(target: Target) -> bool:
    """Return whether a varied number changes the temperature of a bearing at rest."""
    path = next(one for one in target.paths if one is not None)
    if target.part == "case":
        return path[:2] in FACES
    return target.part == "bearing" and moves_heat(path)


THINGS = ("structure", "bearing", "motion")
AMBIENT, HOUR = "ambient_degC", "hour"
SAMPLE = "bearing.sample"  # number of a sample of a posterior, -1 of a bearing without


@dataclass(frozen=True)
class Column:
    """One factor."""

    name: str  # of the column
    # names of things, or numbers; none of a distribution
    levels: Sequence[str] | Sequence[float] = ()
    distribution: Distribution | None = None  # of a number
    # of each level, where one is drawn by lot; None where all are met
    chances: Sequence[float] | None = None
    share: bool = False  # a number in [0, 1) that selects a sample, or an hour of the weather

    @property
    def drawn(self) -> bool:
        """Whether each sample draws it; else its levels meet those of all others."""
        return self.share or self.distribution is not None or self.chances is not None

    def of(self, places: Ints) -> Any:
        """Return numbers at places of the levels; the places themselves of things."""
        if self.levels and isinstance(self.levels[0], str):
            return places
        return np.array(self.levels, dtype=np.float64)[places]

    def at(self, probability: Floats) -> Any:
        """Return numbers (or places) at probabilities, for a factor that is drawn."""
        if self.share:
            return probability
        if self.distribution is not None:
            return self.distribution.at(probability)
        ends: Floats = np.cumsum(np.array(self.chances))[:-1]
        return self.of(np.searchsorted(ends, probability, side="right"))


def list_columns(study: Study) -> list[Column]:
    """Return the columns of a study: things, then numbers, those with dotted names last."""
    factors = study.factors
    columns = []
    for name in THINGS:
        factor = getattr(factors, name)
        motions = isinstance(factor, MotionFactor)
        names = factor.names if motions else [str(one.name) for one in factor.levels]
        columns.append(Column(name, names, chances=_chances(factor, len(names))))
        if name == "bearing" and any(isinstance(one, Posterior) for one in factor.levels):
            columns.append(Column(SAMPLE, share=True))
    columns.append(_number(factors.scale, "scale", factors.scale.unit, "factors.scale"))
    if factors.ambient.hourly:
        columns.append(Column(HOUR, share=True))
    else:
        columns.append(_number(factors.ambient, AMBIENT, "degC", "factors.ambient"))
    for target in list_targets(study):
        unit = target.unit if target.of == "value" else None
        number = factors.numbers[target.name]
        columns.append(_number(number, target.name, unit, f"factors.{target.name}"))
    return columns


def _chances(factor: Picked, count: int) -> list[float] | None:
    weights = list(factor.weights) if factor.weights is not None else [1.0] * count
    return [weight / sum(weights) for weight in weights] if factor.random else None


def _number(factor: Any, name: str, unit: str | None, key: str) -> Column:
    found = list_numbers(factor, unit, key)
    if isinstance(found, Distribution):
        return Column(name, distribution=found)
    return Column(name, found, chances=_chances(factor, len(found)))


def list_targets(study: Study) -> list[Target]:
    """Return where the dotted names of a study lead; of a posterior, in its bearing."""
    levels = _levels_by_part(study)
    return [_find_target(name, one.of, levels) for name, one in study.factors.numbers.items()]


def _levels_by_part(study: Study) -> dict[str, list[Strict]]:
    """Return the records whose numbers have dotted names, by the first part of the name."""
    bearings = study.factors.bearing.levels
    return {
        "bearing": [one.bearing if isinstance(one, Posterior) else one for one in bearings],
        "structure": list(study.factors.structure.levels),
        "case": [study.case],
    }


LARGEST_SCALE = 1000.0
CUT = "; cut it off with low and high, or take a narrower one"


def reach_faults(study: Study) -> list[str]:
    """Return the faults of numbers that a study may meet, one run in a million included."""
    ends: dict[str, tuple[float, float]] = {}
    drawn: dict[str, str] = {}
    for column in list_columns(study):
        if column.distribution is not None:
            ends[column.name] = column.distribution.reach
            drawn[column.name] = f"a {column.distribution.kind} distribution reaches "
        elif column.levels and not isinstance(column.levels[0], str):
            numbers = np.array(column.levels, dtype=np.float64)
            ends[column.name] = float(numbers.min()), float(numbers.max())
    return _faults(study, ends, drawn)


def check_numbers(study: Study, numbers: Mapping[str, Floats]) -> None:
    """Raise InputError where drawn numbers, by name of their column, leave what is allowed."""
    known = {name: values[~np.isnan(values)] for name, values in numbers.items()}
    ends = {name: (float(v.min()), float(v.max())) for name, v in known.items() if len(v)}
    if found := _faults(study, ends, {}):
        raise InputError(found)


def _faults(
    study: Study, ends: Mapping[str, tuple[float, float]], drawn: Mapping[str, str]
) -> list[str]:
    """Return the faults of the smallest and the largest number of each column."""
    faults = []
    scale, top = study.factors.scale, LARGEST_SCALE
    limits = {"scale": (0.0, top, scale.unit or ""), AMBIENT: (COLDEST, HOTTEST, "degC")}
    for name in (name for name in limits if name in ends):
        (low, high, unit), (smallest, largest) = limits[name], ends[name]
        positive = name == "scale"
        if smallest < low or largest > high or (positive and smallest <= 0.0):
            wrong = smallest if smallest < low or smallest == low == 0.0 else largest
            least = "greater than 0 and at most" if positive else f"{low:g} to"
            faults.append(
                f"factors.{'scale' if positive else 'ambient'}: "
                + f"{drawn.get(name, '')}{wrong:g} {unit}".rstrip()
                + f": must be {least} {high:g} {unit}".rstrip()
                + (CUT if name in drawn else "")
            )
    records = _levels_by_part(study)
    for target in list_targets(study):
        if target.name in ends:
            faults += _target_faults(target, records[target.part], ends[target.name], drawn)
    return faults


def _target_faults(
    target: Target, records: list[Any], ends: tuple[float, float], drawn: Mapping[str, str]
) -> list[str]:
    """Return the faults of a bearing, a structure or a case with the number."""
    for level, record in enumerate(records):
        path = target.paths[level]
        if path is None:
            continue
        for number in ends:
            made = with_numbers(record, target.change(level, record, number))
            try:
                validated(type(made), made.model_dump(), "", from_file=False)
            except InputError as error:
                what, more = f"{number:g}", ""
                if target.of == "factor":
                    what, more = f"{number:g} of it", f" (it is {value_at(record, path):g})"
                text = f"factors.{target.name}: {drawn.get(target.name, '')}{what}: "
                text += "; ".join(error.problems) + more
                return [text + (CUT if target.name in drawn else "")]
    return []
