"""Strict data with units: how TOML tables become checked objects, and faults become sentences."""

import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError, ValidationInfo
from pydantic_core import ErrorDetails, PydanticCustomError

from thermobearing.errors import InputError, nearest
from thermobearing.units import parse_quantity

M = TypeVar("M", bound="Strict")


class Strict(BaseModel):
    """Immutable record that refuses unknown keys and numbers that are not finite."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


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
        if info.context and info.context.get("from_file"):
            raise PydanticCustomError(
                "unit",
                "has no unit; write {text} if that is meant",
                {"text": f'"{value} {self.unit}"'},
            )
        return value


def in_unit(unit: str) -> BeforeValidator:
    """Annotation for a float field that files give as text with a unit."""
    return BeforeValidator(InUnit(unit))


def unit_of(model: type[BaseModel], name: str) -> str | None:
    """Unit of a field declared with `in_unit`, None for a pure number or a nested table."""
    field = model.model_fields[name]
    return _unit_in([*field.metadata, field.annotation])


def _unit_in(parts: Iterable[Any]) -> str | None:
    for item in parts:
        if isinstance(item, BeforeValidator) and isinstance(item.func, InUnit):
            return item.func.unit
        found = _unit_in(get_args(item)) or _unit_in(getattr(item, "__metadata__", ()))
        if found:
            return found
    return None


def read_toml(path: Path) -> dict[str, Any]:
    """Parse a TOML file; every fault becomes an InputError that names the file."""
    try:
        with path.open("rb") as file:
            return tomllib.load(file)
    except FileNotFoundError:
        raise InputError("no such file", str(path)) from None
    except IsADirectoryError:
        raise InputError("is a directory, not a TOML file", str(path)) from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot be read: {error}", str(path)) from None
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"is not valid TOML: {error}", str(path)) from None


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
        raise InputError([_sentence(model, item) for item in error.errors()], where) from None


def _models(annotation: Any) -> list[type[BaseModel]]:
    """Model classes inside an annotation, through Annotated, unions and lists."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [found for part in get_args(annotation) for found in _models(part)]


def _resolve(model: type[BaseModel], location: tuple[int | str, ...]) -> tuple[str, Any, Any]:
    """Dotted key, owning model and field of an error location, without union tags."""
    models, owner, field = [model], model, None
    keys: list[str] = []
    for part in location:
        if isinstance(part, int):
            keys[-1:] = [f"{keys[-1]}[{part}]" if keys else f"[{part}]"]
            continue
        tagged = [m for m in models if part in _tags(m)] if len(models) > 1 else []
        if tagged:
            models = owner_candidates = tagged
            owner = owner_candidates[0]
            continue
        keys.append(part)
        holder = next((m for m in models if part in m.model_fields), None)
        owner = holder or (models[0] if models else owner)
        field = holder.model_fields[part] if holder else None
        if field is not None:
            inner = [m for item in field.metadata for m in _models(item)]
            models = _models(field.annotation) + inner
    return ".".join(keys), owner, field


def _tags(model: type[BaseModel]) -> list[str]:
    return [
        str(tag)
        for name in ("shape", "step")
        if name in model.model_fields
        for tag in get_args(model.model_fields[name].annotation)
    ]


def _sentence(model: type[BaseModel], item: ErrorDetails) -> str:
    """One fault: key, value, unit, allowed range or nearest name."""
    key, owner, field = _resolve(model, item["loc"])
    name = str(item["loc"][-1]) if item["loc"] else ""
    unit = unit_of(owner, name) if field is not None and name in owner.model_fields else None
    kind = item["type"]
    if kind == "extra_forbidden":
        return f'unknown key "{key}"{nearest(name, owner.model_fields)}'
    if kind == "missing":
        example = f' = "... {unit}"' if unit else ""
        return f'missing key "{key}"{example}'
    message = item["msg"].removeprefix("Value error, ")
    if kind in ("greater_than", "greater_than_equal", "less_than", "less_than_equal"):
        message = message.replace("Input should", "must") + (f" {unit}" if unit else "")
    elif kind == "literal_error":
        message = message.replace("Input should be", "must be")
        if isinstance(item["input"], str):
            message += nearest(
                item["input"],
                str(item["ctx"]["expected"])
                .strip("'")
                .replace("' or '", ", ")
                .replace("', '", ", ")
                .split(", "),
            )
    value = item["input"]
    shown = "" if isinstance(value, dict | list) else f" = {value!r}"
    return f"{key}{shown}: {message}" if key else message
