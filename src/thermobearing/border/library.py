"""Data files of the package and their lookup by name or path."""

import copy
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any, Self, TypeVar

from pydantic import PrivateAttr

from thermobearing.border.errors import InputError, nearest
from thermobearing.border.opener import is_folder
from thermobearing.border.schema import Strict, validated
from thermobearing.border.toml import flat, read_toml, split_sources, to_table

R = TypeVar("R", bound=Strict)
S = TypeVar("S", bound="Sourced")
DEEPEST = 8  # files that are based on one another


DATA = Path(str(resources.files("thermobearing").joinpath("data")))


def data_path(*parts: str) -> Path:
    """Return a file or folder of the data shipped with the package."""
    return DATA.joinpath(*parts)


@cache
def _checked(model: type[Strict], path: Path) -> Any:
    return validated(model, split_sources(read_toml(path))[0], str(path))


def read_data(model: type[R], *parts: str) -> R:
    """Return the checked content of a TOML file of the package, read once."""
    content: R = _checked(model, data_path(*parts))
    return content


def is_path(name_or_path: str | Path) -> bool:
    """Return whether a value denotes a file: a Path, or text with a slash or ending in `.toml`."""
    text = str(name_or_path)
    return isinstance(name_or_path, Path) or text.endswith(".toml") or "/" in text


def unknown_name(kind: str, name: str, names: Iterable[str]) -> InputError:
    """Return the error for an unknown name, with the nearest known one, or for a directory."""
    if name and is_folder(Path(name)):
        return InputError("is a directory, not a file", name)
    return InputError(f'no {kind} is named "{name}"{nearest(name, names)}')


@cache
def _names(folder: str) -> tuple[str, ...]:
    return tuple(sorted(path.stem for path in data_path(folder).glob("*.toml")))


_shipped = cache(read_toml)  # a file of the package stays as it is while a program runs


@cache
def _built_in_entries(
    library: "Library", name: str, model: type[Strict]
) -> dict[str, tuple[Any, str]]:
    """Return values and sources of a built-in file by key, in the form of a validated object."""
    values, sources = split_sources(library.table(name)[0])
    # As written: the laws of a command line would change the numbers that have the sources.
    context = {"from_file": True, "as_written": True}
    built_in = flat(to_table(model.model_validate(values, context=context)))
    return {key: (built_in.get(key), source) for key, source in sources.items()}


def _with_differences(base: dict[str, Any], differences: dict[str, Any]) -> dict[str, Any]:
    """Return a table updated by another one; a number with its source is one value."""
    merged = dict(base)
    for key, value in differences.items():
        base_value = merged.get(key)
        if isinstance(base_value, dict) and isinstance(value, dict) and "value" not in value:
            value = _with_differences(base_value, value)
        merged[key] = value
    return merged


class Sourced(Strict):
    """A record with the sources of its numbers."""

    _sources: dict[str, str] = PrivateAttr(default_factory=dict)

    @property
    def sources(self) -> dict[str, str]:
        """Where each number comes from, by dotted key (`geometry.rubber_thickness`)."""
        return dict(self._sources)

    def with_sources(self, sources: Mapping[str, str]) -> Self:
        """Return the same with the sources of its numbers by dotted key."""
        copy = self.model_copy()
        copy._sources = dict(sources)
        return copy


@dataclass(frozen=True)
class Library:
    """Built-in objects of one kind, a TOML file each, and the user's own files."""

    kind: str  # in messages, such as "bearing"
    folder: str  # below the package's data

    def names(self) -> list[str]:
        """Return the names of the built-in ones, sorted."""
        return list(_names(self.folder))

    def path(self, name_or_path: str | Path) -> Path:
        """Return the file that a name or a path stands for."""
        text = str(name_or_path)
        names = self.names()
        if text in names:
            return data_path(self.folder, f"{text}.toml")
        if is_path(name_or_path):
            return Path(text)
        raise unknown_name(self.kind, text, names)

    def table(
        self, name_or_path: str | Path, chain: tuple[Path, ...] = ()
    ) -> tuple[dict[str, Any], str]:
        """Return the table of a file with its sources, and its path for messages; see `path`.

        A file with the key `based_on` (a name, or a relative file) holds only the differences.
        """
        path = self.path(name_or_path)
        built_in = str(name_or_path) in self.names()
        # The cached table is shared by all callers; some of them change what they get.
        table = copy.deepcopy(_shipped(path)) if built_in else read_toml(path)
        base = table.pop("based_on", None)
        if base is None:
            return table, str(path)
        if not isinstance(base, str) or not base or "name" not in table:
            rule = "must be a name or a file, and the table needs its own name"
            raise InputError(f"based_on = {base!r}: {rule}", str(path))
        if len(chain) >= DEEPEST:
            raise InputError(f"based_on = {base!r}: the files are based on each other", str(path))
        base_path = base if base in self.names() else path.parent / base
        return _with_differences(self.table(base_path, (*chain, path))[0], table), str(path)

    def read(self, name_or_path: str | Path) -> tuple[dict[str, Any], str]:
        """Return the plain values of a file, and its path for messages; see `path`."""
        table, where = self.table(name_or_path)
        return split_sources(table)[0], where

    def load(self, model: type[S], name_or_path: str | Path) -> S:
        """Return an object by name or file, with the sources of its numbers."""
        table, where = self.table(name_or_path)
        values, sources = split_sources(table)
        return validated(model, values, where).with_sources(sources)

    def sources(self, model: type[Strict], table: Mapping[str, Any]) -> dict[str, str]:
        """Return the sources of the values of a table that equal those of the built-in one."""
        name = str(table.get("name", ""))
        if name not in self.names():
            return {}
        built_in, values = _built_in_entries(self, name, model), flat(table)
        return {
            key: source for key, (value, source) in built_in.items() if values.get(key) == value
        }


def sources_to_keep(
    records: Iterable[tuple[Library, Sourced]],
    stored: Mapping[str, Mapping[str, str]] | None = None,
) -> dict[str, dict[str, str]] | None:
    """Return the sources of numbers of objects outside their library; None if there are none.

    `given` holds the sources stored with a case, by name of the object.
    """
    sources: dict[str, dict[str, str]] = {}
    for library, record in records:
        if not (record.sources or stored):
            continue
        table = to_table(record)
        name = str(table["name"])
        library_sources = library.sources(type(record), table)
        # What the library states is read from there again; only other sources stay with a case.
        differing = {
            key: text for key, text in record.sources.items() if library_sources.get(key) != text
        }
        # The objects of a saved case have no sources of their own when it is read again.
        record_sources = differing or dict((stored or {}).get(name, {}))
        if record_sources:
            sources[name] = sources.get(name, {}) | record_sources
    return sources or None
