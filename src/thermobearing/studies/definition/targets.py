"""The numbers that a study varies by dotted name, and records with other numbers."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from thermobearing.border.errors import InputError, nearest
from thermobearing.border.schema import Strict, find_unit
from thermobearing.identify.fit.parameters import ALIASES
from thermobearing.studies.definition.record import OF_FACTORS

NumberPath = tuple[str | int, ...]
S = TypeVar("S", bound=Strict)
FACES = (("analysis", "upper_face"), ("analysis", "lower_face"), ("analysis", "side"))
# Numbers of a bearing that do not affect its heat cells.
WITHOUT_HEAT: dict[str | int, set[str] | None] = {
    "hysteresis": None,
    "scragging": None,
    "rate": None,
    "rate_band": None,
    "lead": {
        "stiffness",
        "yield_stress",
        "softening",
        "softening_beyond_tests",
        "reference_temperature",
    },
}


@dataclass(frozen=True)
class Target:
    """A number that a study varies."""

    name: str  # dotted, as in the study
    part: str  # "bearing", "structure" or "case"
    paths: Sequence[NumberPath | None]  # in each level of the part; None in one without it
    unit: str | None  # None if dimensionless
    of: str  # "factor" multiplies it, "value" replaces it

    def change(self, level: int, record: Strict, number: float) -> dict[NumberPath, float]:
        """Return the changed number of a record of a level, by its path; {} without it."""
        path = self.paths[level]
        if path is None:
            return {}
        return {path: number * value_at(record, path) if self.of == "factor" else number}


def find_target(name: str, of: str, levels: Mapping[str, Sequence[Strict]]) -> Target:
    """Return the number of a dotted name in the records of its part; InputError without one."""
    part, key = spelled(name)
    if part not in levels:
        raise InputError(f'factors: no part "{part}" in "{name}"; known: {", ".join(levels)}')
    without = OF_FACTORS if part == "case" else ()
    paths_by_level = [_number_paths(level, without) for level in levels[part]]
    entries = [paths.get(key) for paths in paths_by_level]
    units = [entry[1] for entry in entries if entry is not None]
    if not units:
        names = {f"{part}.{key}" for paths in paths_by_level for key in paths}
        if part == "bearing":
            names |= {
                f"bearing.{alias}" for alias, key in ALIASES.items() if f"bearing.{key}" in names
            }
        raise InputError(f'factors: no number "{name}"{_nearest(name, names)}')
    number_paths = [None if entry is None else entry[0] for entry in entries]
    return Target(name, part, number_paths, units[0], of)


def _nearest(name: str, names: set[str]) -> str:
    suggestion = nearest(name, names)
    if not suggestion.startswith("; known"):
        return suggestion
    part = name.rpartition(".")[0]
    siblings = sorted(candidate for candidate in names if candidate.rpartition(".")[0] == part)
    return nearest(name, siblings or {candidate.rpartition(".")[0] + ".…" for candidate in names})


def _number_paths(
    record: Strict, without: Sequence[str] = ()
) -> dict[str, tuple[NumberPath, str | None]]:
    """Return path and unit of all numbers of a record except counts, by dotted name."""
    numbers = _numbers(record, "", ())
    return {name: (path, unit) for name, path, unit in numbers if path[0] not in without}


def _numbers(
    record: Strict, before: str, above: NumberPath
) -> Iterator[tuple[str, NumberPath, str | None]]:
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
    """Return the key of each item of a list: its name, its body, or its number."""
    names = [str(getattr(item, "name", getattr(item, "body", ""))) for item in items]
    return [
        f".{name}" if name and names.count(name) == 1 else f"[{number}]"
        for number, name in enumerate(names)
    ]


def spelled(name: str) -> tuple[str, str]:
    """Return part and dotted key of a number: of "bearing.K_r" hysteresis.layer_stiffness."""
    part, _, key = name.partition(".")
    return part, ALIASES.get(key, key) if part == "bearing" else key


def value_at(record: Any, path: NumberPath) -> float:
    """Return the number at a path."""
    for step in path:
        record = record[step] if isinstance(step, int) else getattr(record, step)
    return float(record)


def with_numbers(record: S, changes: Mapping[NumberPath, float]) -> S:
    """Return the record with other numbers, without checking limits again."""
    update: dict[str, Any] = {}
    for key in dict.fromkeys(path[0] for path in changes):
        inner = {path[1:]: value for path, value in changes.items() if path[0] == key}
        assert isinstance(key, str)
        update[key] = _changed(getattr(record, key), inner)
    return record.model_copy(update=update)


def _changed(value: Any, changes: Mapping[NumberPath, float]) -> Any:
    """Return a number, a record or a list of records with other numbers."""
    if () in changes:
        return changes[()]
    if isinstance(value, Strict):
        return with_numbers(value, changes)
    items = list(value)
    for number in {path[0] for path in changes}:
        assert isinstance(number, int)
        inner = {
            path[1:]: replacement for path, replacement in changes.items() if path[0] == number
        }
        items[number] = with_numbers(items[number], inner)
    return type(value)(items)


def affects_heat_cells(path: NumberPath) -> bool:
    """Return whether a number of a bearing affects its heat cells."""
    if path[0] not in WITHOUT_HEAT:
        return True
    within = WITHOUT_HEAT[path[0]]
    return within is not None and path[1] not in within


def affects_rest_temperature(target: Target) -> bool:
    """Return whether a varied number changes the temperature of a bearing at rest."""
    path = next(candidate for candidate in target.paths if candidate is not None)
    if target.part == "case":
        return path[:2] in FACES
    return target.part == "bearing" and affects_heat_cells(path)
