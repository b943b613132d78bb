"""Numbers by dotted name: those of a bearing, a structure or a case that a study may vary."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from thermobearing.border.errors import InputError, nearest
from thermobearing.border.schema import Strict, find_unit
from thermobearing.identify.fit.parameters import ALIASES
from thermobearing.studies.definition.record import OF_FACTORS

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
    """A number that a study varies.

    Attributes
    ----------
    name : dotted, as the study says it.
    part : "bearing", "structure" or "case".
    paths : where it is in each level of that part; None in one that does not have it.
    unit : its own; None for a pure number.
    of : "factor" multiplies it, "value" replaces it.
    """

    name: str
    part: str
    paths: Sequence[Path | None]
    unit: str | None
    of: str

    def change(self, level: int, record: Strict, number: float) -> dict[Path, float]:
        """What a factor or value makes of the number in a record of a level; {} without it."""
        path = self.paths[level]
        if path is None:
            return {}
        return {path: number * value_at(record, path) if self.of == "factor" else number}


def find_target(name: str, of: str, levels: Mapping[str, Sequence[Strict]]) -> Target:
    """Where a dotted name leads.

    Parameters
    ----------
    name : such as "bearing.K_r", "structure.hinges.pier base.yield_moment".
    of : "factor" or "value".
    levels : of each part.

    Raises
    ------
    InputError : there is no such number; the nearest is named.
    """
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
    """The nearest name, or those of the part that it begins with."""
    close = nearest(name, names)
    if not close.startswith("; known"):
        return close
    within = sorted(one for one in names if one.rpartition(".")[0] == name.rpartition(".")[0])
    return nearest(name, within or {one.rpartition(".")[0] + ".…" for one in names})


def number_paths(record: Strict, without: Sequence[str] = ()) -> dict[str, tuple[Path, str | None]]:
    """Dotted names of all numbers of a record that are no counts: where they are, their unit.

    Things in a list go by their name, or by that of their body where that tells them apart.

    Parameters
    ----------
    record : of any kind.
    without : keys to pass by.

    Examples
    --------
    >>> from thermobearing.structure.model import load_structure
    >>> paths = number_paths(load_structure("pier-p1"))
    >>> [name for name in paths if name.startswith("hinges")]
    ['hinges.pier base.yield_moment', 'hinges.pier base.yield_rotation', ...]
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
    """What tells a thing in a list apart: its name, its body, or its number."""
    names = [str(getattr(item, "name", getattr(item, "body", ""))) for item in items]
    return [
        f".{name}" if name and names.count(name) == 1 else f"[{number}]"
        for number, name in enumerate(names)
    ]


def spelled(name: str) -> tuple[str, str]:
    """Part and dotted key of a number, symbols of the source written out.

    Examples
    --------
    >>> spelled("bearing.K_r")
    ('bearing', 'hysteresis.layer_stiffness')
    """
    part, _, key = name.partition(".")
    return part, ALIASES.get(key, key) if part == "bearing" else key


def value_at(record: Any, path: Path) -> float:
    """The number that is there."""
    for step in path:
        record = record[step] if isinstance(step, int) else getattr(record, step)
    return float(record)


def with_numbers(record: S, changes: Mapping[Path, float]) -> S:
    """The record with other numbers, its limits not checked again: quick, for every run.

    Examples
    --------
    >>> from thermobearing.bearing.library import load_bearing
    >>> bearing = load_bearing("shen-hdr-bridge")
    >>> made = with_numbers(bearing, {("hysteresis", "hardening"): 0.1})
    >>> made.hysteresis.hardening, made.geometry is bearing.geometry
    (0.1, True)
    """
    update: dict[str, Any] = {}
    for key in dict.fromkeys(path[0] for path in changes):
        inner = {path[1:]: value for path, value in changes.items() if path[0] == key}
        assert isinstance(key, str)
        update[key] = _changed(getattr(record, key), inner)
    return record.model_copy(update=update)


def _changed(value: Any, changes: Mapping[Path, float]) -> Any:
    """A number, a record or a list of records with other numbers."""
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
    """Whether a number of a bearing goes into its heat cells."""
    if path[0] not in WITHOUT_HEAT:
        return True
    within = WITHOUT_HEAT[path[0]]
    return within is not None and path[1] not in within


def moves_warmth(target: Target) -> bool:
    """Whether a varied number changes how warm a bearing at rest becomes."""
    path = next(one for one in target.paths if one is not None)
    if target.part == "case":
        return path[:2] in FACES
    return target.part == "bearing" and moves_heat(path)
