"""Bearings by name or by file: the TOML library shipped with the package, and the user's own."""

from pathlib import Path
from typing import Any

from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, shortened
from thermobearing.border.library import Library
from thermobearing.border.schema import validated
from thermobearing.border.toml import split_sources

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

    Parameters
    ----------
    given : a Bearing, what `load_bearing` takes, or a table as in a file.
    key : what the argument is called, for the message.

    Raises
    ------
    InputError : it stands for no layered bearing.

    Examples
    --------
    >>> as_bearing("shen-hdr-specimen") == as_bearing(load_bearing("shen-hdr-specimen"))
    True
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
