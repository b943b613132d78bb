"""Bearings by name or by file: the TOML library shipped with the package, and the user's own."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from thermobearing.bearing.model import Bearing
from thermobearing.border.deprecated import renamed
from thermobearing.border.errors import InputError, shortened
from thermobearing.border.library import Library
from thermobearing.border.schema import Strict, validated
from thermobearing.border.text_file import write_file
from thermobearing.border.toml import sourced_toml, split_sources

BEARINGS = Library("bearing", "bearings")


def list_bearings() -> list[str]:
    """Names of the built-in bearings.

    Examples
    --------
    >>> "shen-hdr-specimen" in list_bearings()
    True
    """
    return BEARINGS.names()


def bearing_from_table(table: Any, where: str) -> Bearing:
    """A bearing from a parsed TOML table; `where` names the file in error messages."""
    values, sources = split_sources(table)
    if isinstance(values, dict) and values.get("kind") == "compound":
        raise InputError(
            "is a compound, not a bearing: thermobearing new NAME --compound FILE makes one of it",
            where,
        )
    bearing = validated(Bearing, values, where).with_sources(sources)
    if bearing.poor_fit:
        raise InputError(
            f"poor_fit: {bearing.poor_fit}: these numbers did not meet their tests, and are not "
            "used. Fit again (identify; --accept-poor leaves this mark out), or take the key out",
            where,
        )
    return bearing


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
    return bearing_from_table(*BEARINGS.table(name_or_path))


def as_bearing(given: Any, key: str = "bearing") -> Bearing:
    """A bearing from whatever stands for one: itself, a library name, a TOML file, or a table.

    `given`: a Bearing, what `load_bearing` takes, or a table as in a file; `key`: what the argument
    is called, for the message.
    """
    if isinstance(given, Bearing):
        return given
    if isinstance(given, dict):
        return bearing_from_table(given, key)
    if not isinstance(given, str | Path):
        said = shortened(repr(given))
        raise InputError(f"{key} = {said}: must be a Bearing, a library name, or a TOML file")
    try:
        return load_bearing(given)
    except InputError as error:
        raise InputError(error.lines(key)) from None


WHOLE = "shape"  # a plan that says its shape is another plan, not a part of the old one


def changed_bearing(bearing: Bearing | str | Path, **changes: Any) -> Bearing:
    """The same bearing with other numbers, checked as a file would be.

    Parameters
    ----------
    bearing : a Bearing, a library name, or a TOML file.
    changes : new values by the keys of a bearing's file (docs/files.md). A table holds only what
        changes in it, `hysteresis={"layer_stiffness": 40.0}`; a plan with its `shape` is taken
        whole, and None takes an optional table out. Numbers in the units of the file's keys (mm,
        kN/mm, MPa, degC, ...), or text with a unit.

    Returns
    -------
    Bearing : what was changed has a source that says so; the tested range stays, unless given.

    Raises
    ------
    InputError : an unknown key (with the nearest name), or numbers that no bearing has.

    Examples
    --------
    >>> stiff = changed_bearing(
    ...     "shen-hdr-specimen", name="stiff", hysteresis={"layer_stiffness": 40.0}
    ... )
    >>> stiff.hysteresis.layer_stiffness, stiff.hysteresis.yield_displacement
    (40.0, 1.549)
    >>> stiff.sources["hysteresis.layer_stiffness"]
    'changed, was 30.738'
    """
    before = as_bearing(bearing)
    data = before.model_dump()
    noted = _put_in(data, changes, "")
    made = validated(Bearing, data, "changed_bearing()", from_file=False)
    kept = {key: text for key, text in before.sources.items() if not _within(key, noted)}
    return made.with_sources(kept | {key: text for key, text in noted.items() if text})


@renamed(force="overwrite")
def save_bearing(bearing: Bearing, path: str | Path, *, overwrite: bool = False) -> Path:
    """Write a bearing as a TOML file, with the source of each number where one is known.

    Parameters
    ----------
    bearing : what to write; `load_bearing` and every command read it again.
    path : of the file, ending in ".toml".
    overwrite : replace a file that is there.

    Returns
    -------
    Path : the file.

    Raises
    ------
    OutputError : it exists and `force` is False, or it cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from thermobearing.bearing.library import load_bearing
    >>> mine = changed_bearing("shen-hdr-specimen", name="mine", cells={"rubber": 4, "shim": 2})
    >>> with TemporaryDirectory() as folder:
    ...     load_bearing(save_bearing(mine, folder + "/mine.toml")) == mine
    True
    """
    write_file(Path(path), sourced_toml(bearing, bearing.sources), overwrite=overwrite)
    return Path(path)


def _put_in(table: dict[str, Any], changes: Mapping[str, Any], above: str) -> dict[str, str]:
    """Changes put into a table, and by dotted key of each changed thing its new source."""
    noted: dict[str, str] = {}
    for name, value in changes.items():
        key = f"{above}{name}"
        new = value.model_dump() if isinstance(value, Strict) else value
        old = table.get(name)
        if isinstance(new, Mapping) and isinstance(old, dict) and WHOLE not in new:
            noted |= _put_in(old, new, f"{key}.")
            continue
        table[name] = dict(new) if isinstance(new, Mapping) else new
        plain = above and isinstance(old, int | float) and not isinstance(old, bool)
        noted[key] = f"changed, was {old:g}" if plain and new != old else ""
    return noted


def _within(key: str, changed: Mapping[str, str]) -> bool:
    """Whether a key is one that was changed, or in a table that was."""
    return any(key == one or key.startswith(f"{one}.") for one in changed)
