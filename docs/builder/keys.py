"""Tables of the keys of files, from the models that read them.

A page holds `<!-- keys: MODULE.CLASS -->` and `<!-- end keys -->`; `make docs` writes the table
between them: key, unit or kind, default, range, meaning. The meaning is that of the attribute in
the docstring of the class, or in docs/keys.toml.
"""

import re
import tomllib
import types
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from thermobearing.border.schema import find_unit

MARK = re.compile(
    r"(<!-- keys: (?P<name>[\w.]+)(?P<skipped>(?: -\w+)*) -->\n).*?(<!-- end keys -->)", re.DOTALL
)
ATTRIBUTE = re.compile(r"^ {4}(?P<names>\w+(?:, \w+)*) :(?P<text>.*(?:\n {8}.*)*)", re.MULTILINE)
MEANINGS = tomllib.loads((Path(__file__).parents[1] / "keys.toml").read_text(encoding="utf-8"))
KINDS = {float: "number", int: "integer", str: "text", bool: "true or false"}


def fill(text: str) -> str:
    """Return the text of a page with its tables of keys written anew."""

    def table(found: re.Match[str]) -> str:
        module, _, name = found["name"].rpartition(".")
        model = getattr(import_module(f"thermobearing.{module}"), name)
        skipped = found["skipped"].replace("-", "").split()
        return f"{found[1]}\n{key_table(model, skipped)}\n\n{found[4]}"

    return MARK.sub(table, text)


def key_table(model: type[BaseModel], skipped: list[str]) -> str:
    """Return a Markdown table of the fields of a model, without those to skip."""
    meanings = attribute_texts(model) | MEANINGS.get(model.__name__, {})
    lines = ["| key | unit or kind | default | range | meaning |", "|---|---|---|---|---|"]
    for name, field in model.model_fields.items():
        if name in skipped:
            continue
        cells = [f"`{field.alias or name}`", kind(model, name), default(field), limits(field)]
        lines.append(f"| {' | '.join([*cells, meanings.get(name, '')])} |".replace("|  |", "| |"))
    return "\n".join(lines)


def attribute_texts(model: type[BaseModel]) -> dict[str, str]:
    """Return what the docstrings of a model and its bases say of each attribute."""
    texts: dict[str, str] = {}
    for base in reversed(model.__mro__):
        for match in ATTRIBUTE.finditer(base.__doc__ or "" if "__doc__" in vars(base) else ""):
            words = " ".join(match["text"].split())
            texts |= dict.fromkeys(match["names"].split(", "), words.replace("|", "\\|"))
    return texts


def parts(item: Any) -> Iterator[Any]:
    """Give the annotation and the metadata of a field, at any depth."""
    yield item
    for inner in get_args(item):
        yield from parts(inner)


def kind(model: type[BaseModel], name: str) -> str:
    """Return the unit of a field, or what it is."""
    unit = find_unit(model, name)
    annotation = model.model_fields[name].annotation
    prefix = "list of " if _is_list(annotation) else ""
    if unit is not None:
        return f"{prefix}{unit}"
    inner = list(parts(annotation))
    words = [
        f'"{value}"' for part in inner if get_origin(part) is Literal for value in get_args(part)
    ]
    tables = [p for p in inner if isinstance(p, type) and issubclass(p, BaseModel)]
    plain = [KINDS[part] for part in inner if isinstance(part, type) and part in KINDS]
    kinds = words or (["table"] if tables else []) or list(dict.fromkeys(plain))
    return f"{prefix}{' or '.join(kinds[:6])}"


def _is_list(annotation: Any) -> bool:
    outer = get_args(annotation) if get_origin(annotation) in (Union, types.UnionType) else ()
    return any(get_origin(part) in (list, tuple) for part in (annotation, *outer))


def default(field: FieldInfo) -> str:
    """Return the default of a field."""
    if field.is_required():
        return "required"
    value = field.get_default(call_default_factory=True)
    if value is None or value == "" or value == [] or value == {}:
        return ""
    if isinstance(value, BaseModel):
        fields = value.model_dump(exclude_none=True, exclude_defaults=False)
        return ", ".join(
            f"{key} {item:g}" for key, item in fields.items() if isinstance(item, float)
        )
    if isinstance(value, float):
        return f"{value:g}"
    return f"`{str(value).lower()}`" if isinstance(value, bool) else f"`{value}`"


def limits(field: FieldInfo) -> str:
    """Return the range of a number."""
    bounds = {}
    for part in (*field.metadata, *parts(field.annotation)):
        for name in ("ge", "gt", "le", "lt"):
            if getattr(part, name, None) is not None:
                bounds.setdefault(name, f"{getattr(part, name):g}")
        for inner in getattr(part, "metadata", []) or []:
            for name in ("ge", "gt", "le", "lt"):
                if getattr(inner, name, None) is not None:
                    bounds.setdefault(name, f"{getattr(inner, name):g}")
    # One bound at either end, the open one if a field has both.
    ends = []
    for signs in ((("gt", ">"), ("ge", "≥")), (("lt", "<"), ("le", "≤"))):
        stated = [f"{sign} {bounds[name]}" for name, sign in signs if name in bounds]
        ends += stated[:1]
    return ", ".join(ends)
