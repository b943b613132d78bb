"""TOML files: reading with clear errors, entries with sources, writing of models."""

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomli_w

from thermobearing.border.errors import InputError, shortened
from thermobearing.border.opener import read_bytes
from thermobearing.border.schema import SOURCED, Strict, find_unit
from thermobearing.border.units import with_unit

DIGITS = 12  # of the numbers in files of bearings and compounds
BITS = 63  # of an integer in TOML, without its sign
DEEPEST = 50  # nested tables; a case has six levels
LARGEST_FILE = 10_000_000  # bytes of TOML
MOST_KEYS = 100_000  # keys, headers, lists and tables in a file
MOST_VALUES = 1_000_000  # in lists
MOST_PARTS = 1_000_000  # of dotted keys, added up
_MARKS = re.compile(r"([,=\[\]{}])")
# Texts and comments, which may hold any mark. None fails where its end is missing, so that each
# character is looked at once.
_QUOTED = re.compile(
    r'"""(?:[^"\\]++|\\.|"(?!""))*+(?:"{3,5})?'
    r"|'''(?:[^']++|'(?!''))*+(?:'{3,5})?"
    r'|"(?:[^"\\\n]++|\\[^\n])*+"?'
    r"|'[^'\n]*+'?|#[^\n]*+",
    re.DOTALL,
)
QUOTED = "_"  # what stands for them


def read_toml(path: Path) -> dict[str, Any]:
    """Parse a TOML file; every fault becomes an InputError that names the file."""
    raw = read_bytes(path, LARGEST_FILE)
    if path.suffix == ".py":
        raise InputError("is a Python file; give a file with laws of your own by --law", str(path))
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"is not UTF-8 text (byte {error.start + 1})", str(path)) from None
    _check_keys(text, str(path))
    try:
        table = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(f"is not valid TOML: {error}", str(path)) from None
    except ValueError as error:  # a number of thousands of digits
        raise InputError(f"cannot be read: {error}", str(path)) from None
    _check_sizes(table, str(path))
    return table


def _check_keys(text: str, where: str) -> None:
    """Reject text that takes a parser minutes: too many keys, tables or values, or long keys."""
    bare = _QUOTED.sub(QUOTED, text)
    if sum(bare.count(mark) for mark in "=[{") > MOST_KEYS:
        raise InputError(f"has more than {MOST_KEYS} keys, lists and tables", where)
    if bare.count(",") > MOST_VALUES:
        raise InputError(f"has more than {MOST_VALUES} values in lists", where)
    total = 0
    for number, line in enumerate(bare.splitlines(), 1):
        if "." not in line:
            continue
        # Numbers hold dots too: only what ends at "=" or "]" is a key.
        parts = _MARKS.split(line)
        for part, mark in zip(parts[::2], parts[1::2], strict=False):
            if mark not in "=]":
                continue
            dots = part.count(".")
            total += dots
            if dots > DEEPEST:
                raise InputError(f"line {number}: a key of more than {DEEPEST} parts", where)
    if total > MOST_PARTS:
        raise InputError(f"has keys of more than {MOST_PARTS} parts in all", where)


def _check_sizes(table: dict[str, Any], where: str) -> None:
    """Reject integers of more than 64 bits and excessive nesting.

    Larger integers have no float and may have no text; dotted keys nest without a limit, while
    the functions that read them are recursive.
    """
    level: list[tuple[str, Any]] = list(table.items())
    for _ in range(DEEPEST):
        inner: list[tuple[str, Any]] = []
        for key, value in level:
            if isinstance(value, int) and value.bit_length() > BITS:
                raise InputError(f"{shortened(key)}: an integer of more than 64 bits", where)
            if isinstance(value, dict):
                inner += [(f"{key}.{name}", item) for name, item in value.items()]
            elif isinstance(value, list):
                inner += [(f"{key}[{k}]", item) for k, item in enumerate(value)]
        level = inner
        if not level:
            return
    raise InputError(f"tables and lists are nested deeper than {DEEPEST} levels", where)


def split_sources(table: Any, key: str = "") -> tuple[Any, dict[str, str]]:
    """Return plain values and sources of a table whose entries may be {value, source, note}."""
    if isinstance(table, list):
        items: list[Any] = []
        sources_of_items: dict[str, str] = {}
        for number, item in enumerate(table):
            value, item_sources = split_sources(item, f"{key}[{number}]")
            items.append(value)
            sources_of_items |= item_sources
        return items, sources_of_items
    if not isinstance(table, dict):
        return table, {}
    if key and "value" in table and set(table) <= SOURCED:  # a file is a table in any case
        parts = [str(table[name]) for name in ("source", "note") if name in table]
        return table["value"], {key: "; ".join(parts)} if parts else {}
    values: dict[str, Any] = {}
    sources: dict[str, str] = {}
    for name, entry in table.items():
        values[name], item_sources = split_sources(entry, f"{key}.{name}" if key else name)
        sources |= item_sources
    return values, sources


def flat(table: Mapping[str, Any], key: str = "") -> dict[str, Any]:
    """Return values of a table by dotted key; lists of tables are counted, others are values.

    >>> flat({"a": {"b": 1}, "c": [{"d": 2}], "e": [3, 4]})
    {'a.b': 1, 'c[0].d': 2, 'e': [3, 4]}
    """
    values: dict[str, Any] = {}
    for name, value in table.items():
        dotted_key = f"{key}.{name}" if key else name
        if isinstance(value, Mapping):
            values |= flat(value, dotted_key)
        elif isinstance(value, list | tuple) and value and isinstance(value[0], Mapping):
            for number, item in enumerate(value):
                values |= flat(item, f"{dotted_key}[{number}]")
        else:
            values[dotted_key] = value
    return values


def to_table(model: Strict, digits: int | None = None) -> dict[str, Any]:
    """Return a model as a TOML table: units on every number, unset choices left out.

    Numbers have so many significant `digits`; by default, those that read back to the same bits.
    """
    return {
        name: _entry(value, find_unit(type(model), name), digits)
        for name in type(model).model_fields
        if (value := getattr(model, name)) is not None and value != ""
    }


def _entry(value: Any, unit: str | None, digits: int | None) -> Any:
    if isinstance(value, Strict):
        return to_table(value, digits)
    if isinstance(value, list | tuple):
        return [_entry(item, unit, digits) for item in value]
    if isinstance(value, float) and digits is not None:
        value = float(f"{value:.{digits}g}")
    if unit and isinstance(value, int | float):
        return with_unit(float(value), unit)
    return value


def with_sources(table: dict[str, Any], sources: Mapping[str, str]) -> dict[str, Any]:
    """Return the table with {value, source} where a source of an entry is known, by dotted key.

    Texts at the top (name, citation, ...) stay plain: readers look for them there.
    """
    for key, source in sources.items():
        *tables, name = key.split(".")
        inner: Any = table
        for part in tables:
            inner = _inner_table(inner, part)
        if tables and name in inner and not isinstance(inner[name], dict):
            inner[name] = {"value": inner[name], "source": source}
    return table


def _inner_table(table: Mapping[str, Any], part: str) -> Any:
    """The table of a name, or one of a list of them (`masses[2]`); an empty one where none is."""
    name, _, place = part.rstrip("]").partition("[")
    if not place:
        return table.get(name, {})
    items = table.get(name, [])
    return items[int(place)] if int(place) < len(items) else {}


def sourced_toml(model: Strict, sources: Mapping[str, str], *, digits: int | None = None) -> str:
    """Return a model as a library file, with the source of each number where one is known.

    `digits` are those of `to_table`: with 12, 36.0744696 instead of 36.07446959999999.
    """
    return tomli_w.dumps(with_sources(to_table(model, digits), sources))


def to_toml(model: Strict, *, without: str = "") -> str:
    """Return a model with every default as TOML text that reads back to the same bits."""
    table = to_table(model)
    table.pop(without, None)
    return tomli_w.dumps(table)
