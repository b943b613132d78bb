"""Cases of analyses as tables: load names and files in them, then validate all keys at once."""

import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

from thermobearing.border.errors import InputError
from thermobearing.border.schema import Strict, validated

M = TypeVar("M", bound=Strict)
KEY = re.compile(r"[\w.\[\]]+")  # the key at the start of an error message


def load_things(
    table: dict[str, Any],
    key: str,
    load: Callable[[Any], Any],
    folder: Path = Path(),
    before: str = "",
) -> list[str]:
    """Replace a name or file in a table, or each one in a list, by the object that `load` returns.

    Files are relative to `folder`. An entry that cannot be loaded stays unchanged; the messages
    returned begin with its key, after `before`.
    """
    if key not in table:
        return []
    entry, faults, loaded = table[key], [], []
    is_list = isinstance(entry, list | tuple)
    for number, item in enumerate(entry if is_list else [entry]):
        if isinstance(item, str | Path):
            try:
                # A name of the library has no folder; a file is relative to that of its case.
                item = load(folder / item if str(item).endswith(".toml") else item)
            except InputError as error:
                faults += error.lines(before + (f"{key}[{number}]" if is_list else key))
        loaded.append(item)
    table[key] = loaded if is_list else loaded[0]
    return faults


def load_all(
    table: dict[str, Any],
    overrides: Mapping[str, Any],
    loads: Mapping[str, Callable[[Any], Any]],
    folder: Path,
) -> tuple[dict[str, Any], dict[str, Any], list[str]]:
    """Return a table with its overrides, the names in them loaded, and the error messages.

    File names in the table are relative to its folder, those in `overrides` to the current one.
    """
    table, replacements = dict(table), {k: v for k, v in overrides.items() if v is not None}
    faults: list[str] = []
    for key, load in loads.items():
        if key in replacements:
            faults += load_things(replacements, key, load)
        else:
            faults += load_things(table, key, load, folder)
    return table, replacements, faults


def unlike(faults: Sequence[str], reported: Sequence[str]) -> list[str]:
    """Return the errors in `faults` of keys that have none in `reported` yet."""
    keys = {match[0] for match in map(KEY.match, reported) if match}
    return [text for text in faults if (match := KEY.match(text)) is None or match[0] not in keys]


def read_case(model: type[M], table: dict[str, Any], where: str, faults: Sequence[str] = ()) -> M:
    """Validate the table of a case after loading; also raise the `faults` that loading found."""
    try:
        case = validated(model, table, where)
    except InputError as error:
        # What could not be loaded is still text, which validation reports as a wrong type; the
        # message of loading says why.
        raise InputError([*faults, *unlike(error.problems, faults)], where) from None
    if faults:
        raise InputError(faults, where)
    return case


def made_case(
    case: Any,
    model: type[M],
    load: Callable[..., M],
    make: Callable[..., M],
    where: str,
    overrides: Mapping[str, Any],
) -> M:
    """Return a case from a file, a table (as read from a file) or a case."""
    if isinstance(case, str | Path):
        return load(case, **overrides)
    if case is None or isinstance(case, dict):
        return make(case or {}, where, **overrides)
    if not isinstance(case, model):
        raise InputError(f"needs a file, a table or a {model.__name__}", where)
    if overrides:
        raise InputError("a complete case accepts no further values", where)
    return case


def absolute(table: Any, key: str, folder: Path) -> None:
    """Make the path under a key absolute, so that a case finds it from wherever it is saved."""
    if isinstance(table, dict) and isinstance(table.get(key), str | Path) and str(table[key]):
        table[key] = str((folder / table[key]).absolute())
