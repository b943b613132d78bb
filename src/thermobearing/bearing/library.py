"""Bearings by name or by file: the TOML library shipped with the package, and the user's own."""

from importlib import resources
from pathlib import Path
from typing import Any

from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, nearest
from thermobearing.border.schema import SOURCED, read_toml, validated


def _library() -> Path:
    return Path(str(resources.files("thermobearing") / "data" / "bearings"))


def list_bearings() -> list[str]:
    """Names of the built-in bearings.

    Examples
    --------
    >>> "shen-hdr-specimen" in list_bearings()
    True
    """
    return sorted(path.stem for path in _library().glob("*.toml"))


def split_sources(table: Any, key: str = "") -> tuple[Any, dict[str, str]]:
    """Plain values and their sources, from a table whose entries may be {value, source, note}."""
    if isinstance(table, list):
        pairs = [split_sources(item, f"{key}[{k}]") for k, item in enumerate(table)]
        return [value for value, _ in pairs], {k: v for _, found in pairs for k, v in found.items()}
    if not isinstance(table, dict):
        return table, {}
    if "value" in table and set(table) <= SOURCED:
        parts = [str(table[name]) for name in ("source", "note") if name in table]
        return table["value"], {key: "; ".join(parts)} if parts else {}
    values: dict[str, Any] = {}
    sources: dict[str, str] = {}
    for name, entry in table.items():
        values[name], found = split_sources(entry, f"{key}.{name}" if key else name)
        sources |= found
    return values, sources


def bearing_from_table(table: Any, where: str) -> Bearing:
    """A bearing from a parsed TOML table; `where` names the file in error messages."""
    values, sources = split_sources(table)
    return validated(Bearing, values, where).with_sources(sources)


def load_bearing(name_or_path: str | Path) -> Bearing:
    """A bearing of the library by name, or one of your own from a TOML file.

    Parameters
    ----------
    name_or_path : a name of `list_bearings()`, or a path ending in `.toml`.

    Raises
    ------
    InputError : no such bearing, or faults in the file (all of them, in one message).

    Examples
    --------
    >>> load_bearing("shen-hdr-specimen").total_rubber_thickness
    30.0
    """
    text = str(name_or_path)
    if text in list_bearings():
        path = _library() / f"{text}.toml"
    elif isinstance(name_or_path, Path) or text.endswith(".toml") or "/" in text:
        path = Path(text)
    else:
        raise InputError(f'no bearing is called "{text}"{nearest(text, list_bearings())}')
    return bearing_from_table(read_toml(path), str(path))
