"""Numbers by dotted name: those of a bearing, a structure or a case that a study may vary."""

from collections.abc import Iterator, Mapping
from typing import Any, TypeVar

from thermobearing.border.schema import Strict, unit_of
from thermobearing.identify.kinds import ALIASES

Path = tuple[str | int, ...]
S = TypeVar("S", bound=Strict)
PARTS = ("bearing", "structure", "case")


def number_paths(record: Strict) -> dict[str, tuple[Path, str | None]]:
    """Dotted names of all numbers of a record that are no counts: where they are, their unit.

    Things in a list go by their name, or by that of their body where that tells them apart.

    Examples
    --------
    >>> from thermobearing.structure.model import load_structure
    >>> paths = number_paths(load_structure("pier-p1"))
    >>> [name for name in paths if name.startswith("hinges")]
    ['hinges.pier base.yield_moment', 'hinges.pier base.yield_rotation', ...]
    """
    return {name: (path, unit) for name, path, unit in _numbers(record, "", ())}


def _numbers(record: Strict, before: str, above: Path) -> Iterator[tuple[str, Path, str | None]]:
    for key in type(record).model_fields:
        value = getattr(record, key)
        name, path = f"{before}{key}", (*above, key)
        if isinstance(value, float):
            yield name, path, unit_of(type(record), key)
        elif isinstance(value, Strict):
            yield from _numbers(value, f"{name}.", path)
        elif isinstance(value, list | tuple):
            for number, (label, item) in enumerate(zip(_labels(value), value, strict=True)):
                if isinstance(item, Strict):
                    yield from _numbers(item, f"{name}{label}.", (*path, number))


def _labels(items: list[Any] | tuple[Any, ...]) -> list[str]:
    """What tells the things of a list apart: a name, a body, or their numbers."""
    for key in ("name", "body"):
        names = [getattr(item, key, None) for item in items]
        if None not in names and len(set(names)) == len(names):
            return [f".{name}" for name in names]
    return [f"[{number}]" for number in range(len(items))]


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
