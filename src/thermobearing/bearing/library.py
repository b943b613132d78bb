"""Bearings by name or file: the TOML library of the package, and user files."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from thermobearing.bearing.model import (
    TEMPERATURE_COEFFICIENTS,
    Bearing,
    laws_of_command,
    with_laws,
)
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, short_repr
from thermobearing.border.library import Library
from thermobearing.border.schema import Strict, validated
from thermobearing.border.text_file import write_file
from thermobearing.border.toml import DIGITS, sourced_toml, split_sources
from thermobearing.border.units import one_or_several
from thermobearing.laws import find_law

BEARINGS = Library("bearing", "bearings")


def list_bearings() -> list[str]:
    """Return the names of the built-in bearings.

    Examples
    --------
    >>> "shen-hdr-specimen" in list_bearings()
    True
    """
    return BEARINGS.names()


def bearing_from_table(table: Any, where: str) -> Bearing:
    """Return a bearing from a parsed TOML table; `where` names the file in error messages."""
    values, sources = split_sources(table)
    if isinstance(values, dict) and values.get("kind") == "compound":
        raise InputError(
            "is a compound, not a bearing: create one with thermobearing new NAME --compound FILE",
            where,
        )
    sources = _sources_with_laws(sources, laws_of_command(values))
    bearing = validated(Bearing, values, where).with_sources(sources)
    if bearing.poor_fit:
        raise InputError(
            f"poor_fit: {bearing.poor_fit}: the calibration of these parameters failed, so they "
            "are not used. Calibrate again (identify; --accept-poor accepts it), or remove the key",
            where,
        )
    return bearing


def _sources_with_laws(sources: Mapping[str, str], names: Sequence[str]) -> dict[str, str]:
    """Return the sources of a bearing with those of laws in place of what they replaced."""
    updated = dict(sources)
    for law in map(find_law, names):
        if law.kind == "temperature":
            # A temperature law takes the place of the table and of m_T and n_T, whose sources go
            # with them.
            replaced = [
                "temperature_law",
                *(f"hysteresis.{key}" for key in TEMPERATURE_COEFFICIENTS),
            ]
            updated = {key: text for key, text in updated.items() if not _within(key, replaced)}
        else:
            updated |= dict.fromkeys({law.key, *law.also} & set(updated), law.source)
    return updated


@checked
def load_bearing(name_or_path: str | Path) -> Bearing:
    """Return a bearing of the library by name, or from your own TOML file.

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


def as_bearing(source: Any, key: str = "bearing") -> Bearing:
    """Return a bearing from a Bearing, a library name, a TOML file, or a table.

    `source`: a Bearing, an argument of `load_bearing`, or a table as in a file; `key`: name of the
    argument, for messages.
    """
    if isinstance(source, Bearing):
        return source
    if isinstance(source, dict):
        return bearing_from_table(source, key)
    if not isinstance(source, str | Path):
        raise InputError(
            f"{key} = {short_repr(source)}: must be a Bearing, a library name, or a TOML file"
        )
    try:
        return load_bearing(source)
    except InputError as error:
        raise InputError(error.lines(key)) from None


@checked
def changed_bearing(
    bearing: Bearing | str | Path, *, law: str | Sequence[str] | None = None, **changes: Any
) -> Bearing:
    """Return a bearing with changed parameters, validated like a file.

    Parameters
    ----------
    bearing : a Bearing, a library name, or a TOML file.
    law : name of a law of `thermobearing list` or of `tb.laws.register`, or several; a registered
        temperature law replaces m_T and n_T, which become 0, and the table of factors.
    changes : new values by the keys of a bearing's file (docs/files.md). A table holds only what
        changes in it, `hysteresis={"layer_stiffness": 40.0}`; a plan with its `shape` replaces the
        old one, and None removes an optional table. Numbers in the units of the file's keys (mm,
        kN/mm, MPa, degC, ...), or text with a unit.

    Returns
    -------
    Bearing : changed values are marked in their sources; the tested range is kept unless changed.

    Raises
    ------
    InputError : an unknown key (with the nearest name), or numbers out of range.

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
    names = [] if law is None else [str(name) for name in one_or_several(law)]
    data = with_laws(before.model_dump(), names)
    new_sources = _apply_changes(data, changes, "")
    changed = validated(Bearing, data, "changed_bearing()", from_file=False)
    kept = {key: text for key, text in before.sources.items() if not _within(key, new_sources)}
    kept = _sources_with_laws(kept, names)
    return changed.with_sources(kept | {key: text for key, text in new_sources.items() if text})


@checked
def save_bearing(bearing: Bearing, path: str | Path, *, overwrite: bool = False) -> Path:
    """Write a bearing as a TOML file, with the source of each number where one is known.

    Numbers have 12 significant digits.

    Parameters
    ----------
    bearing : the bearing; `load_bearing` and every command read the file.
    path : of the file, ending in ".toml".
    overwrite : replace an existing file.

    Returns
    -------
    Path : the file.

    Raises
    ------
    OutputError : the file exists and `overwrite` is False, or it cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from thermobearing.bearing.library import load_bearing
    >>> mine = changed_bearing("shen-hdr-specimen", name="mine", cells={"rubber": 4, "shim": 2})
    >>> with TemporaryDirectory() as folder:
    ...     load_bearing(save_bearing(mine, folder + "/mine.toml")) == mine
    True
    """
    text = sourced_toml(bearing, bearing.sources, digits=DIGITS)
    write_file(Path(path), text, overwrite=overwrite)
    return Path(path)


def _apply_changes(table: dict[str, Any], changes: Mapping[str, Any], above: str) -> dict[str, str]:
    """Update a table in place; return the new source of each changed entry by dotted key."""
    sources: dict[str, str] = {}
    for name, value in changes.items():
        key = f"{above}{name}"
        new = value.model_dump() if isinstance(value, Strict) else value
        old = table.get(name)
        # A plan of another shape has other keys, so it is replaced as a whole.
        plan = isinstance(new, Mapping) and isinstance(
            new.get("shape"), str
        )  # replaces the old one
        if isinstance(new, Mapping) and isinstance(old, dict) and not plan:
            sources |= _apply_changes(old, new, f"{key}.")
            continue
        table[name] = dict(new) if isinstance(new, Mapping) else new
        plain = above and isinstance(old, int | float) and not isinstance(old, bool)
        sources[key] = f"changed, was {old:g}" if plain and new != old else ""
    return sources


def _within(key: str, changed: Iterable[str]) -> bool:
    """Return whether a key, or a table that contains it, was changed."""
    return any(key == prefix or key.startswith(f"{prefix}.") for prefix in changed)
