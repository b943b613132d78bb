"""Descriptions of options from the fields of records and the arguments of functions.

`python -m docs.generate --texts-only` writes them to `options.json`, from which commands read them.
"""

import inspect
import json
import re
import types
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Annotated, Any, Literal, get_args, get_origin, get_type_hints

if TYPE_CHECKING:
    from thermobearing.commands.options import Fields


def descriptions_text(fields: "Iterable[Fields]") -> str:
    """Return the content of `options.json`: the options of all commands, by place and name."""
    names: dict[str, set[str]] = {}
    for field in fields:
        names.setdefault(field.place, set()).update(field.names.split())
    table = {
        place: {key: describe(place, key) for key in sorted(keys)}
        for place, keys in sorted(names.items())
    }
    return json.dumps(table, indent=1, ensure_ascii=False) + "\n"


@cache
def _definition(place: str) -> tuple[Any, dict[str, Any]]:
    """Return the record or function at a place such as "cyclic.case:Case", and its types."""
    module, _, name = place.partition(":")
    item = getattr(import_module(f"thermobearing.{module}"), name)
    return item, get_type_hints(item, include_extras=True)


def describe(place: str, key: str) -> dict[str, Any]:
    """Return kind and text of an option, and which of its other properties hold.

    "choices": the values that it takes; "entries": its keys, if it is a record;
    "several": it may be repeated; "named": it takes a name of the library or a file; "required": it
    has no default; "switched_on": its default is true.

    >>> describe("cyclic.case:Analysis", "keep_every")["kind"]
    'int'
    """
    item, hints = _definition(place)
    kind, several, choices, named = _read_type(hints[key])
    default = _default(item, key)
    properties = {
        "several": several,
        "named": named and not choices,
        "required": default is inspect.Parameter.empty,
        "switched_on": kind is bool and default is True,
    }
    text = _help_text(item, key, choices, default)
    flags = {name: True for name, holds in properties.items() if holds}
    lists = {"choices": choices, "entries": _entries(hints[key])}
    return {
        "kind": kind.__name__,
        **flags,
        **{name: values for name, values in lists.items() if values},
        "text": text,
    }


def _entries(hint: Any) -> list[str]:
    """Return the keys of a field that is a record, or may be one; of any other none."""
    for kind in (hint, *get_args(hint)):
        if isinstance(kind, type) and hasattr(kind, "model_fields"):
            return list(kind.model_fields)
    return []


PLAIN = {str, int, float, bool, types.NoneType}


def _read_type(hint: Any) -> tuple[Any, bool, list[str], bool]:
    """Return type of one value, whether there may be several, choices, whether it is a name."""
    leaves: set[Any] = set()
    choices: list[str] = []
    several = False
    pending = [hint]
    while pending:
        part = pending.pop(0)
        origin = get_origin(part)
        if origin is Literal:
            choices += map(str, get_args(part))
        elif origin is Annotated:
            pending.insert(0, get_args(part)[0])
        elif origin is not None:
            several |= isinstance(origin, type) and issubclass(origin, Sequence | Mapping)
            pending[:0] = get_args(part)
        elif isinstance(part, type):
            leaves.add(part)
    text = str in leaves or bool(choices)
    kind = next((number for number in (float, int, bool) if number in leaves and not text), str)
    return kind, several, choices, kind is str and bool(leaves - PLAIN)


def _default(item: Any, name: str) -> Any:
    """Return the default of a field or an argument; empty for an argument without one."""
    if hasattr(item, "model_fields"):
        field = item.model_fields[name]
        return None if field.is_required() else field.get_default()
    return inspect.signature(item).parameters[name].default


ENTRY = r"^ *(?:[\w, *]+, )?{}(?:, [\w, *]+)? :(.*(?:\n(?!(?: *[\w, *]+ :| *\n)).*)*)"
TYPE = re.compile(r" (str|int|float|bool|mapping|sequence|list|dict|Path|array|[A-Z]\w+)\b[^.;]*$")


def _help_text(item: Any, name: str, choices: Sequence[str] = (), default: Any = None) -> str:
    """Return the description of a field or an argument in the docstring of its record or function.

    Choices, unit and default are added where the sentence does not have them.

    >>> from thermobearing.cyclic.protocol import CyclicTest
    >>> _help_text(CyclicTest, "dt", default=0.005)
    'Largest time step while the bearing moves [s], in [1e-6, 10]; 0.005 by default.'
    """
    texts = (inspect.getdoc(base) or "" for base in getattr(item, "__mro__", [item]))
    matches = (re.search(ENTRY.format(name), text, re.MULTILINE) for text in texts)
    match = next(filter(None, matches), None)
    first, _, following = match[1].partition("\n") if match else (name.replace("_", " "), "", "")
    # numpydoc: the first line may be a type alone, with the sentence below it.
    sentence = following if following and TYPE.match(first) else f"{first} {following}"
    text = " ".join(sentence.split()).rstrip(".")
    if hasattr(item, "model_fields") and "[" not in text:
        from thermobearing.border.schema import find_unit

        unit = find_unit(item, name)
        text += f" [{unit}]" if unit else ""
    if unstated := [choice for choice in choices if f'"{choice}"' not in text]:
        text += f": {', '.join(unstated[:-1])} or {unstated[-1]}"
    stated_default = isinstance(default, int | float | str) and not isinstance(default, bool)
    if stated_default and default != "" and "default" not in text:
        text += f"; {default} by default"
    return text[:1].upper() + text[1:] + "."
