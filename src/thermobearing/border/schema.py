"""Strict data with units: how TOML tables become checked objects, and faults become sentences."""

import math
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from typing import Annotated, Any, TypeVar, get_args
from unicodedata import category

from annotated_types import Ge, Gt, Le, Lt
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
from pydantic_core import ErrorDetails, InitErrorDetails, PydanticCustomError

from thermobearing.border.errors import InputError, closest, nearest, printable, shortened
from thermobearing.border.units import HUGEST, parse_quantity, with_unit

M = TypeVar("M", bound="Strict")
LONGEST_NAME = 200  # characters of the name of a thing
SOURCED = {"value", "source", "note"}  # keys of an entry {value = ..., source = ...}
UNION = ("float", "int", "str", "bool", "none", "list", "tuple", "function-", "constrained-")
MOST_TOLD = 50  # faults of a file that a message holds
OURS = {"unit", "conflict", "size"}  # types of the faults found here, not by pydantic


def _one_line(text: str) -> str:
    """The text, if it is one line that can be printed.

    Names stand in the comments of generated scripts, in tables and on terminals.
    """
    if "\n" in text or printable(text) != text or {"Zl", "Zp"} & set(map(category, text)):
        raise ValueError("must be one line of printable characters")
    return text


OneLine = AfterValidator(_one_line)
Name = Annotated[str, Field(min_length=1, max_length=LONGEST_NAME), OneLine]


class Strict(BaseModel):
    """Immutable record that refuses unknown keys, numbers that are not finite or not numbers."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

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
                f"{type(self).__name__}.{name}: records are frozen; make another (of a bearing: "
                "tb.changed_bearing)"
            )
        super().__setattr__(name, value)

    @classmethod
    def conflicts(cls, given: dict[str, Any]) -> list[str]:
        """What is wrong with the combination of the keys that were given."""
        return []

    @model_validator(mode="wrap")
    @classmethod
    def _all_at_once(cls, data: Any, handler: ModelWrapValidatorHandler[Any]) -> Any:
        """Faults of single keys and of their combination in one error."""
        if not isinstance(data, dict):
            return handler(data)
        given = {name: value for name, value in data.items() if value is not None}
        faults = [_fault("conflict", (), text, data) for text in cls.conflicts(given)]
        try:
            made = handler({name: _plain(cls, name, value) for name, value in data.items()})
        except ValidationError as error:
            found = [*_line_errors(error), *faults]
            raise ValidationError.from_exception_data(cls.__name__, found) from None
        faults += [
            _fault("size", (name,), "", value)
            for name in cls.model_fields
            if isinstance(value := getattr(made, name), float) and _is_absurd(cls, name, value)
        ]
        if faults:
            raise ValidationError.from_exception_data(cls.__name__, faults)
        return made


class _Converted:
    """A value of another type than the field's, which pydantic would convert without a word."""

    def __init__(self, value: Any) -> None:
        self.value = value

    def __repr__(self) -> str:
        return repr(self.value)


def _is_absurd(model: type[BaseModel], name: str, value: float) -> bool:
    """Whether a number is so large, or so close to a zero it may not be, that it must be a slip."""
    bounded, positive = _bound_kinds(model, name)
    return (not bounded and abs(value) > HUGEST) or (positive and value < 1.0 / HUGEST)


# What a field allows is asked for every number of every record that is made.
@cache
def _bound_kinds(model: type[BaseModel], name: str) -> tuple[bool, bool]:
    """Whether a field has an upper limit, and whether it must be more than zero."""
    parts = list(_parts(model.model_fields[name]))
    bounded = any(isinstance(part, Le | Lt) for part in parts)
    return bounded, any(isinstance(part, Gt) and part.gt == 0 for part in parts)


@cache
def _is_plain(model: type[BaseModel], name: str) -> tuple[bool, bool]:
    """Whether a field is a plain number, and whether it is true or false only."""
    types = {item for item in _parts(model.model_fields[name]) if isinstance(item, type)}
    number = bool(types & {int, float}) and not types & {bool, str}
    return number and find_unit(model, name) is None, types == {bool}


def _plain(model: type[BaseModel], name: str, value: Any) -> Any:
    """The value, marked where text or true stands for a plain number, or 1 for true."""
    if name not in model.model_fields or not isinstance(value, bool | str | int | float):
        return value
    plain, truth = _is_plain(model, name)
    wrong = (plain and isinstance(value, bool | str)) or (truth and not isinstance(value, bool))
    return _Converted(value) if wrong else value


def _fault(kind: str, location: tuple[int | str, ...], text: str, value: Any) -> InitErrorDetails:
    error = PydanticCustomError(kind, "{text}", {"text": text})
    return InitErrorDetails(type=error, loc=location, input=value)


def _line_errors(error: ValidationError) -> Iterator[InitErrorDetails]:
    """The faults of an error, to be raised again together with others."""
    for item in error.errors(include_url=False):
        if item["type"] in OURS:
            yield _fault(item["type"], item["loc"], item["msg"], item["input"])
        else:
            again = InitErrorDetails(type=item["type"], loc=item["loc"], input=item["input"])
            if "ctx" in item:
                again["ctx"] = item["ctx"]
            yield again


class InUnit:
    """Parses text with a unit into a float in `unit`.

    Plain numbers are taken to be in `unit` already; in a file they are refused, because a
    file must say its units.
    """

    def __init__(self, unit: str) -> None:
        self.unit = unit

    def __call__(self, value: Any, info: ValidationInfo) -> Any:
        """Float from text with a unit; other numbers as they are, unless they are in a file."""
        if isinstance(value, str):
            try:
                return parse_quantity(value, self.unit)
            except InputError as error:
                raise PydanticCustomError("unit", "{text}", {"text": str(error)}) from None
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise PydanticCustomError(
                "unit", "expected text such as {text}", {"text": f'"1.5 {self.unit}"'}
            )
        if info.context and info.context.get("from_file") and math.isfinite(value):
            raise PydanticCustomError(
                "unit",
                "has no unit; write {text} if that is meant",
                {"text": f'"{value} {self.unit}"'},
            )
        return value


def in_unit(unit: str) -> BeforeValidator:
    """Annotation for a float field that files give as text with a unit."""
    return BeforeValidator(InUnit(unit))


def _parts(item: Any) -> Iterator[Any]:
    """Types, validators and limits in a field or annotation, at any depth."""
    if isinstance(item, FieldInfo):
        inner: Iterable[Any] = [*item.metadata, item.annotation]
    else:
        yield item
        inner = get_args(item)
    for part in inner:
        yield from _parts(part)


@cache
def find_unit(model: type[BaseModel], name: str) -> str | None:
    """Unit of a field declared with `in_unit`, None for a pure number or a nested table."""
    for item in _parts(model.model_fields[name]):
        if isinstance(item, BeforeValidator) and isinstance(item.func, InUnit):
            return item.func.unit
    return None


def validated(model: type[M], data: Any, where: str, *, from_file: bool = True) -> M:
    """Data checked against a model, all faults told at once.

    Raises
    ------
    InputError : unknown and missing keys, wrong units, values out of range, in one message.
    """
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
    models, owner, name = [model], model, ""
    keys: list[str] = []
    for part in location:
        if isinstance(part, int):
            keys[-1:] = [f"{keys[-1]}[{part}]" if keys else f"[{part}]"]
            continue
        if not models and keys and part.startswith(UNION):  # a member of a union, which is no key
            continue
        tagged = [m for m in models if part in _tags(m)] if len(models) > 1 else []
        if tagged:
            models, owner = tagged, tagged[0]
            continue
        keys.append(part)
        owner = next((m for m in models if part in m.model_fields), models[0] if models else owner)
        name = part
        if part in owner.model_fields:
            found = _parts(owner.model_fields[part])
            models = [m for m in found if isinstance(m, type) and issubclass(m, BaseModel)]
    return ".".join(keys), owner, name


def _tags(model: type[BaseModel]) -> list[str]:
    return [
        str(tag)
        for name in ("shape", "step", "kind", "part")
        if name in model.model_fields
        for tag in get_args(model.model_fields[name].annotation)
    ]


def _sentences(model: type[BaseModel], error: ValidationError) -> list[str]:
    """The faults of an error; of very many the first ones, and how many there are."""
    found = error.errors(include_url=False)
    told = [_sentence(model, item) for item in found[:MOST_TOLD]]
    left = len(found) - len(told)
    return [*told, f"{left} more"] if left else told


def _sentence(model: type[BaseModel], item: ErrorDetails) -> str:
    """One fault: key, value, what is allowed with its unit, nearest name."""
    key, owner, name = _resolve(model, item["loc"])
    kind, value = item["type"], item["input"]
    if kind == "extra_forbidden":
        return f'unknown key "{key}"{nearest(name, owner.model_fields)}'
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        return _tag_sentence(key, item)
    if kind == "missing":
        unit = find_unit(owner, name)
        return f'missing key "{key}"' + (f' = "... {unit}"' if unit else "")
    if kind == "conflict":
        return f"{key}: {item['msg']}" if key else item["msg"]
    message = item["msg"].removeprefix("Value error, ")
    if isinstance(value, dict) and kind != "value_error" and set(value) & SOURCED:
        strange = sorted(set(value) - SOURCED)
        message = f'an entry with a source needs a "value"; got {", ".join(sorted(value))}'
        if strange and "value" in value:
            message = f'unknown key "{strange[0]}" beside "value"{nearest(strange[0], SOURCED)}'
    elif kind == "literal_error":
        message = f"must be {item['ctx']['expected']}"
        message += _closest_hint(value, item["ctx"]["expected"])
    elif kind in ("model_type", "model_attributes_type", "dict_type"):
        message = "must be a table"
    elif kind in ("list_type", "tuple_type"):
        message = "must be a list"
    elif kind == "string_too_long":
        message = f"must have at most {item['ctx']['max_length']} characters"
    elif kind == "too_short":
        message = f"must have at least {item['ctx']['min_length']} entry"
    elif kind == "too_long":
        message = f"must have at most {item['ctx']['max_length']} entries"
    elif kind == "string_type":
        message = "must be text"
    elif kind in ("bool_type", "bool_parsing"):
        message = "must be true or false"
    elif kind == "string_too_short":
        message = "must not be empty"
    elif kind == "size":
        large = abs(value) > 1.0
        message = (
            f"must be {'at most' if large else 'at least'} {HUGEST if large else 1 / HUGEST:g}"
        )
        message += f" {find_unit(owner, name) or ''} in size; is it a slip?".replace("  ", " ")
    elif kind not in ("unit", "value_error"):
        message = f"must be {_allowed(owner, name)}"
    shown = "" if kind == "value_error" else f" = {shortened(repr(value))}"
    return f"{key}{shown}: {message}" if key else message


def _tag_sentence(key: str, item: ErrorDetails) -> str:
    """A table that says by one of its keys what it is: the key is missing or unknown."""
    tag = item["ctx"]["discriminator"].strip("'")
    if not isinstance(item["input"], dict):
        return f"{key} = {shortened(repr(item['input']))}: must be a table"
    given = item["input"].get(tag)
    if given is None:
        return f'missing key "{key}.{tag}"'
    expected = item["ctx"]["expected_tags"]
    return f"{key}.{tag} = {given!r}: must be one of {expected}" + _closest_hint(given, expected)


def _closest_hint(value: Any, quoted: str) -> str:
    """A hint at the name nearest to the value in a text such as "'a', 'b' or 'c'"."""
    return closest(value, quoted.split("'")[1::2]) if isinstance(value, str) else ""


def _allowed(model: type[BaseModel], name: str) -> str:
    """The numbers a field takes, such as "a number greater than 0 and at most 5 mm"."""
    parts = list(_parts(model.model_fields[name]))
    what = "a whole number" if int in parts and float not in parts else "a number"
    words = {Gt: "greater than", Ge: "at least", Lt: "less than", Le: "at most"}
    limits = [
        f"{words[type(part)]} {getattr(part, type(part).__name__.lower()):g}"
        for part in parts
        if type(part) in words
    ]
    if not limits:
        what = what.replace("a number", "a finite number")
    return " ".join(word for word in (what, " and ".join(limits), find_unit(model, name)) if word)


def said_with_unit(value: Any, unit: str | None) -> Any:
    """Plain numbers, alone or in a sequence, as text with their unit, as a file has them."""
    if unit is None:
        return value
    if hasattr(value, "tolist"):  # numpy arrays and scalars
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [said_with_unit(item, unit) for item in value]
    if isinstance(value, int | float) and not isinstance(value, bool):
        return with_unit(value, unit)
    return value


def updated(table: Any, changes: Mapping[str, Any]) -> Any:
    """The table with changes; what is no table stays as it is, for the checks to find."""
    return {**table, **changes} if isinstance(table, dict) else table


def overridden(
    table: Mapping[str, Any],
    given: Mapping[str, Any],
    model: type[Strict],
    sections: Mapping[str, type[Strict]] | None = None,
) -> dict[str, Any]:
    """A table of a file with what was given instead.

    Parameters
    ----------
    table : as read from a file, where every number says its unit.
    given : values by key of the model or of one of its sections; plain numbers are in the unit
        of the key, and None leaves the value of the table. An unknown key goes into the table
        too, for the check to find it.
    model : what the table is to become.
    sections : tables inside the table whose keys may be given directly, such as "analysis".

    Examples
    --------
    >>> from thermobearing.border.schema import in_unit
    >>> from typing import Annotated
    >>> class Walk(Strict):
    ...     length: Annotated[float, in_unit("mm")]
    ...     name: str = ""
    >>> overridden({"length": "5 m"}, {"length": 70, "name": None}, Walk)
    {'length': '70.0 mm'}
    """
    table = dict(table)
    for key, value in given.items():
        if value is None:
            continue
        homes = [] if key in model.model_fields else list((sections or {}).items())
        home = next((item for item in homes if key in item[1].model_fields), None)
        owner = home[1] if home else model
        unit = find_unit(owner, key) if key in owner.model_fields else None
        said = said_with_unit(value, unit)
        if home:
            table[home[0]] = updated(table.get(home[0], {}), {key: said})
        else:
            table[key] = said
    return table


def check_workers(where: str, executor: Any = None, progress: Any = None) -> None:
    """Refuse an executor or a callback that cannot be one, before anything is computed.

    Raises
    ------
    InputError : an executor without `submit`, or a callback that cannot be called.

    Examples
    --------
    >>> check_workers("example", None, print)
    """
    if executor is not None and not callable(getattr(executor, "submit", None)):
        raise InputError("executor: must be one of concurrent.futures, or like it", where)
    if progress is not None and not callable(progress):
        raise InputError("progress: must be a function of two numbers", where)
