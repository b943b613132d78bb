"""Strict schemas with units: TOML tables become validated objects, errors become sentences."""

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from typing import Annotated, Any, NamedTuple, TypeVar, get_args
from unicodedata import category

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ModelWrapValidatorHandler,
    ValidationError,
    ValidationInfo,
    model_validator,
)
from pydantic.fields import FieldInfo

from thermobearing.border.errors import InputError, closest, nearest, printable, short_repr
from thermobearing.border.units import HUGEST, parse_quantity, with_unit

M = TypeVar("M", bound="Strict")
LONGEST_TEXT = 10_000  # characters of any text in a file
LONGEST_NAME = 200  # characters of the name of a thing
SOURCED = {"value", "source", "note"}  # keys of an entry {value = ..., source = ...}
UNION = ("float", "int", "str", "bool", "none", "list", "tuple", "function", "constrained")
TAGS = ("shape", "step", "kind", "part")  # keys that state which of several tables one is
MOST_FAULTS = 50  # of a file that a message holds
LIMITS = {"gt": "greater than", "ge": "at least", "lt": "less than", "le": "at most"}
# Messages by the type of pydantic's error; "own" and "conflict" are kinds of errors raised here.
MESSAGES = {
    **dict.fromkeys(("model_type", "model_attributes_type", "dict_type"), "must be a table"),
    **dict.fromkeys(("list_type", "tuple_type"), "must be a list"),
    "string_too_long": "must have at most {max_length} characters",
    "string_too_short": "must not be empty",
    "string_type": "must be text",
    **dict.fromkeys(("bool_type", "bool_parsing"), "must be true or false"),
    "too_short": "must have at least {min_length} entry",
    "too_long": "must have at most {max_length} entries",
}


def _one_line(text: str) -> str:
    """Check names, which stand in comments of generated scripts, in tables and on terminals."""
    if "\n" in text or printable(text) != text or {"Zl", "Zp"} & set(map(category, text)):
        raise ValueError("must be one line of printable characters")
    return text


OneLine = AfterValidator(_one_line)
Name = Annotated[str, Field(min_length=1, max_length=LONGEST_NAME), OneLine]


class FieldError(ValueError):
    """Error that a validator raises; pydantic gives it the type "value_error".

    `kind` is "own" for an error of one value, "conflict" for one of a combination of keys.
    """

    kind = "own"


class _ConflictError(FieldError):
    kind = "conflict"


class Strict(BaseModel):
    """Immutable record that refuses unknown keys, numbers that are not finite or not numbers."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, str_max_length=LONGEST_TEXT
    )

    def __init__(self, **data: Any) -> None:
        try:
            super().__init__(**data)
        except ValidationError as error:  # `EndFace(eta=5)`, built by hand
            raise InputError(_sentences(type(self), error), f"{type(self).__name__}()") from None

    # Tables inside tables are then built without a call of __init__, which would lose the
    # context of the validation (whether the data are those of a file).
    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]

    def __setattr__(self, name: str, value: Any) -> None:
        if name in type(self).model_fields:
            raise InputError(
                f"{type(self).__name__}.{name}: records are immutable; create a new one (bearing: "
                "tb.changed_bearing)"
            )
        super().__setattr__(name, value)

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        """Return the errors in the combination of the given keys."""
        return []

    @model_validator(mode="wrap")
    @classmethod
    def _check_all_at_once(cls, data: Any, handler: ModelWrapValidatorHandler[Any]) -> Any:
        """Raise errors of single keys and of their combination together."""
        if not isinstance(data, dict):
            return handler(data)
        # None stands for a key that is not set, so it conflicts with no other.
        values = {name: value for name, value in data.items() if value is not None}
        faults = [_fault(_ConflictError(text), (), data) for text in cls._conflicts(values)]
        try:
            record = handler({name: _marked(cls, name, value) for name, value in data.items()})
        except ValidationError as error:
            field_errors = [_raised_again(item) for item in error.errors(include_url=False)]
            raise ValidationError.from_exception_data(
                cls.__name__, [*field_errors, *faults]
            ) from None
        # Sizes are checked after conversion: text has none before its unit is known.
        for name in cls.model_fields:
            value = getattr(record, name)
            if isinstance(value, float) and (text := _implausible_size(cls, name, value)):
                faults.append(_fault(FieldError(text), (name,), value))
        if faults:
            raise ValidationError.from_exception_data(cls.__name__, faults)
        return record


def _implausible_size(model: type[BaseModel], name: str, value: float) -> str:
    """Return an error for a number of implausible size (usually a wrong unit or exponent)."""
    kind = _kind(model, name)
    unit = f" {kind.unit}" if kind.unit else ""
    if not kind.bounded and abs(value) > HUGEST:
        return f"must be at most {HUGEST:g}{unit} in size; check the unit and the exponent"
    if kind.positive and value < 1.0 / HUGEST:
        return f"must be at least {1.0 / HUGEST:g}{unit} in size; check the unit and the exponent"
    return ""


class _Converted:
    """A value of another type than the field's, which pydantic would convert silently."""

    def __init__(self, value: Any) -> None:
        self.value = value

    def __repr__(self) -> str:
        return repr(self.value)


def _marked(model: type[BaseModel], name: str, value: Any) -> Any:
    """Return the value, marked if text or a boolean is given for a plain number, or 1 for true."""
    if name not in model.model_fields or not isinstance(value, bool | str | int | float):
        return value
    kind = _kind(model, name)
    is_no_number = kind.plain and isinstance(value, bool | str)
    is_no_boolean = kind.boolean and not isinstance(value, bool)
    return _Converted(value) if is_no_number or is_no_boolean else value


def _fault(error: ValueError, location: tuple[int | str, ...], value: Any) -> Any:
    return {"type": "value_error", "loc": location, "input": value, "ctx": {"error": error}}


def _raised_again(item: Mapping[str, Any]) -> Any:
    """One item of a validation error, raised again together with others."""
    return {key: item[key] for key in ("type", "loc", "input", "ctx") if key in item}


class _Kind(NamedTuple):
    """Properties of a numeric field, cached."""

    unit: str | None
    plain: bool  # a number without a unit
    boolean: bool  # true or false only
    bounded: bool  # has an upper limit
    positive: bool  # must be more than zero


@cache
def _kind(model: type[BaseModel], name: str) -> _Kind:
    parts = list(_parts(model.model_fields[name]))
    functions = [part.func for part in parts if isinstance(part, BeforeValidator)]
    units = [function.unit for function in functions if isinstance(function, _InUnit)]
    types = {part for part in parts if isinstance(part, type)}
    return _Kind(
        unit=units[0] if units else None,
        plain=bool(types & {int, float}) and not types & {bool, str} and not units,
        boolean=types - {type(None)} == {bool},
        bounded=any(name in ("le", "lt") for name, _ in _limits(parts)),
        positive=("gt", 0) in _limits(parts),
    )


class _InUnit:
    """Parses text with a unit into a float in `unit`.

    Plain numbers are taken to be in `unit` already; in a file they are refused, because a
    file must state its units.
    """

    def __init__(self, unit: str) -> None:
        self.unit = unit

    def __call__(self, value: Any, info: ValidationInfo) -> Any:
        if isinstance(value, str):
            try:
                return parse_quantity(value, self.unit)
            except InputError as error:
                raise FieldError(str(error)) from None
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise FieldError(f'expected text such as "1.5 {self.unit}"')
        if info.context and info.context.get("from_file") and math.isfinite(value):
            raise FieldError(f'has no unit; write "{value} {self.unit}" if that is meant')
        return value


def in_unit(unit: str) -> BeforeValidator:
    """Return the annotation of a float field that files give as text with a unit."""
    return BeforeValidator(_InUnit(unit))


def find_unit(model: type[BaseModel], name: str) -> str | None:
    """Return the unit of a field declared with `in_unit`, None for other fields."""
    return _kind(model, name).unit


class _Ratio:
    """Mark of a field that is a ratio, whose limits a message explains."""

    words = "(a ratio: 1 is 100 %)"


RATIO = _Ratio()


def _parts(item: Any) -> Iterator[Any]:
    """Yield types, validators and limits in a field or annotation, at any depth."""
    if isinstance(item, FieldInfo):
        inner: Iterable[Any] = [*item.metadata, item.annotation]
    else:
        yield item
        inner = get_args(item)
    for part in inner:
        yield from _parts(part)


def _limits(parts: Iterable[Any]) -> list[tuple[str, float]]:
    """Return the limits among the parts of a field: "gt", "ge", "lt" or "le", and the number."""
    return [
        (name, getattr(part, name))
        for part in parts
        for name in LIMITS
        if not isinstance(part, type) and hasattr(part, name)
    ]


def validated(model: type[M], data: Any, where: str, *, from_file: bool = True) -> M:
    """Return data checked against a model, all faults in one InputError."""
    if not isinstance(data, dict):
        raise InputError(f"expected a table, got {type(data).__name__}", where)
    try:
        return model.model_validate(data, context={"from_file": from_file})
    except ValidationError as error:
        raise InputError(_sentences(model, error), where) from None


def _resolve(
    model: type[BaseModel], location: tuple[int | str, ...]
) -> tuple[str, type[BaseModel], str]:
    """Dotted key, owning model and field name of an error location, without union tags."""
    # pydantic puts the tag or type of the tried member of a union into a location. The file has no
    # such key, so the tables that can stand at each place are followed along the location.
    models, owner, name = [model], model, ""
    keys: list[str] = []
    for part in location:
        if isinstance(part, int):
            keys[-1:] = [f"{keys[-1]}[{part}]" if keys else f"[{part}]"]
            continue
        if not models and keys:  # a member of a union, or a key of a dictionary of plain values
            keys += [] if re.split(r"\W", part)[0] in UNION else [part]
            continue
        tagged = [m for m in models if part in _tags(m)] if len(models) > 1 else []
        if tagged:
            models, owner = tagged, tagged[0]
            continue
        keys.append(part)
        owner = next((m for m in models if part in m.model_fields), models[0] if models else owner)
        name = part
        if part in owner.model_fields:
            parts = _parts(owner.model_fields[part])
            models = [m for m in parts if isinstance(m, type) and issubclass(m, BaseModel)]
    return ".".join(keys), owner, name


def _tags(model: type[BaseModel]) -> list[str]:
    annotations = [
        model.model_fields[name].annotation for name in TAGS if name in model.model_fields
    ]
    return [str(tag) for annotation in annotations for tag in get_args(annotation)]


def _sentences(model: type[BaseModel], error: ValidationError) -> list[str]:
    """Return the messages of an error: at most MOST_FAULTS, then the number of the others."""
    errors = error.errors(include_url=False)
    messages = [_sentence(model, item) for item in errors[:MOST_FAULTS]]
    if len(errors) > len(messages):
        messages.append(f"{len(errors) - len(messages)} more")
    return messages


def _sentence(model: type[BaseModel], item: Mapping[str, Any]) -> str:
    """Return one message: key, value, allowed range with unit, nearest name."""
    key, owner, name = _resolve(model, item["loc"])
    kind, value, context = item["type"], item["input"], item.get("ctx", {})
    message = item["msg"].removeprefix("Value error, ")
    if isinstance(error := context.get("error"), FieldError):
        kind = error.kind
    if kind == "extra_forbidden":
        return f'unknown key "{key}"{nearest(name, owner.model_fields)}'
    if kind == "missing":
        unit = find_unit(owner, name)
        return f'missing key "{key}"' + (f' = "... {unit}"' if unit else "")
    if kind == "conflict":
        return f"{key}: {message}" if key else message
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        tag = context["discriminator"].strip("'")
        tag_value = value.get(tag) if isinstance(value, dict) else None
        if isinstance(value, dict) and tag_value is None:
            return f'missing key "{key}.{tag}"'
        if tag_value is not None:
            key, kind, value = f"{key}.{tag}", "literal_error", tag_value
            context = {"expected": f"one of {context['expected_tags']}"}
        else:
            kind = "dict_type"
    if isinstance(value, dict) and kind != "value_error" and set(value) & SOURCED:
        # `split_sources` takes {value, source, note} apart; an entry that is still a table here
        # lacks its value or has a misspelled key.
        unknown_keys = sorted(set(value) - SOURCED)
        message = f'an entry with a source needs a "value"; got {", ".join(sorted(value))}'
        if unknown_keys and "value" in value:
            hint = nearest(unknown_keys[0], SOURCED)
            message = f'unknown key "{unknown_keys[0]}" next to "value"{hint}'
    elif kind == "literal_error":
        options = context["expected"].split("'")[1::2]
        message = f"must be {context['expected']}"
        message += closest(value, options) if isinstance(value, str) else ""
    elif kind in MESSAGES:
        message = MESSAGES[kind].format(**context)
    elif kind not in ("own", "value_error"):
        message = f"must be {_allowed(owner, name)}"
    value_text = "" if kind == "value_error" else f" = {short_repr(value)}"
    return f"{key}{value_text}: {message}" if key else message


def _allowed(model: type[BaseModel], name: str) -> str:
    """Return the numbers a field takes, such as "a number greater than 0 and at most 5 mm"."""
    parts = list(_parts(model.model_fields[name]))
    noun = "an integer" if int in parts and float not in parts else "a number"
    limits = [f"{LIMITS[name]} {limit:g}" for name, limit in _limits(parts)]
    if not limits:
        noun = noun.replace("a number", "a finite number")
    unit = find_unit(model, name) or (RATIO.words if RATIO in parts else "")
    return " ".join(word for word in (noun, " and ".join(limits), unit) if word)


def field_limits(model: type[BaseModel], name: str) -> dict[str, Any]:
    """Return unit, limits and kind of a field, and what it takes in words."""
    parts = list(_parts(model.model_fields[name]))
    limits: dict[str, Any] = {"unit": find_unit(model, name)}
    for kind, limit in _limits(parts):
        side = "low" if kind in ("gt", "ge") else "high"
        limits |= {side: limit, f"{side}_open": kind in ("gt", "lt")}
    integer = int in parts and float not in parts
    return limits | {"integer": integer, "allowed": _allowed(model, name)}


def text_with_unit(value: Any, unit: str | None) -> Any:
    """Return plain numbers, alone or in a sequence, as text with their unit, as a file has them."""
    if unit is None:
        return value
    if hasattr(value, "tolist"):  # numpy arrays and scalars
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [text_with_unit(item, unit) for item in value]
    if isinstance(value, int | float) and not isinstance(value, bool):
        return with_unit(value, unit)
    return value


def updated(table: Any, changes: Mapping[str, Any]) -> Any:
    """Return the table with changes; other values stay unchanged and fail validation later."""
    return {**table, **changes} if isinstance(table, dict) else table


def overridden(
    table: Mapping[str, Any],
    changes: Mapping[str, Any],
    model: type[Strict],
    sections: Mapping[str, type[Strict]] | None = None,
) -> dict[str, Any]:
    """Return a table of a file with values that replace those of the file.

    `given` has values by key of the model or of one of the `sections` of the table, such as
    "analysis"; plain numbers are in the unit of the key, and None leaves the value of the table. An
    unknown key goes into the table too, for the check to find it.
    """
    table = dict(table)
    for key, value in changes.items():
        if value is None:
            continue
        candidates = [] if key in model.model_fields else list((sections or {}).items())
        section = next((item for item in candidates if key in item[1].model_fields), None)
        owner = section[1] if section else model
        unit = find_unit(owner, key) if key in owner.model_fields else None
        text = text_with_unit(value, unit)
        if section:
            table[section[0]] = updated(table.get(section[0], {}), {key: text})
        else:
            table[key] = text
    return table


def check_seed(seed: int, where: str = "") -> None:
    """Refuse what is no seed of random numbers."""
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise InputError(f"seed = {short_repr(seed)}: must be an integer of 0 or more", where)


def check_workers(where: str, executor: Any = None, progress: Any = None) -> None:
    """Refuse an executor or a callback that cannot be one, before anything is computed."""
    if executor is not None and not callable(getattr(executor, "submit", None)):
        raise InputError("executor: must be like an executor of concurrent.futures", where)
    if progress is not None and not callable(progress):
        raise InputError("progress: must be a function of two numbers", where)
