"""Arguments of public functions, checked against their annotations.

A function checks its own arguments in the terms of its subject, several at once; the annotations
are asked only where it failed without saying why. What is stored for later is checked before.
"""

import functools
import inspect
import types
from collections.abc import Callable, Collection, Iterable, Mapping, Set
from pathlib import Path
from typing import (
    Annotated,
    Any,
    Literal,
    NamedTuple,
    TypeVar,
    Union,
    get_args,
    get_origin,
    is_typeddict,
)

import numpy as np
from numpy.typing import ArrayLike

from thermobearing.border.errors import InputError, OutputError, closest, nearest, short_repr
from thermobearing.border.keywords import renamed
from thermobearing.border.units import LARGEST, is_number, refuse_hidden

T = TypeVar("T")
COUNTS = {1: "one", 2: "two", 3: "three", 4: "four"}
# What is made by another function than that of its name.
CURES = {"SpecimenState": "a state from tb.end_state"}
NO_NAMES = ("self", "cls")
# Others may take the place of classes outside the package by their methods, as an executor does.
CHECKED_MODULES = ("thermobearing", "numpy", "pandas", "xarray")


class _Form(NamedTuple):
    """A kind of value that an argument may have."""

    accepts: Callable[[Any], bool]
    words: str  # for the message
    item: "_Argument | None" = None  # entry of a sequence or table
    is_table: bool = False


class _Argument(NamedTuple):
    """The kinds of values of one argument."""

    forms: tuple[_Form, ...]
    default: Any

    def fault(self, name: str, value: Any) -> str:
        """Return why a value cannot be used, or nothing."""
        if value is self.default:
            return ""
        if isinstance(value, int) and abs(value) > LARGEST:
            return f"{name}: an integer of {value.bit_length()} bits; must be within {LARGEST:.3g}"
        if any(form.words == NUMBERS.words for form in self.forms):
            try:
                refuse_hidden(value, name)
            except InputError as error:
                return str(error)
        if any(form.accepts(value) for form in self.forms):
            return ""
        if fault := self._fault_of_entry(name, value):
            return fault
        words = list(dict.fromkeys(form.words for form in self.forms))
        allowed = words[0] if len(words) == 1 else f"{', '.join(words[:-1])} or {words[-1]}"
        names = [name for form in self.forms for name in form.words.split('"')[1::2]]
        hint = closest(value, names) if isinstance(value, str) else ""
        return f"{name} = {short_repr(value)}: must be {allowed}{hint}"

    def _fault_of_entry(self, name: str, value: Any) -> str:
        """Return why the first wrong entry of a sequence or table cannot be used, or nothing."""
        is_table = isinstance(value, Mapping)
        if is_table:
            entries = [(f"{name}.{key}", entry) for key, entry in value.items()]
        elif isinstance(value, list | tuple):
            entries = [(f"{name}[{place}]", entry) for place, entry in enumerate(value)]
        else:
            return ""
        items = [form.item for form in self.forms if form.item and form.is_table == is_table]
        if not items:
            return ""
        faults = (items[0].fault(key, entry) for key, entry in entries)
        return next(filter(None, faults), "")


ANYTHING = _Form(lambda value: True, "")


class _Loaded(type):
    """A class by its name, of a module that is not imported to check an argument."""

    def __instancecheck__(cls, value: Any) -> bool:
        return any(ancestor.__name__ == cls.__name__ for ancestor in type(value).__mro__)


class _Module:
    """A module whose classes are known by their names."""

    def __getattr__(self, name: str) -> type:
        return _Loaded(name, (), {})


def checked(item: T) -> T:
    """Decorate a public function, or the methods of a class, to check its arguments.

    An unknown keyword raises an InputError. So does a value that is not of the annotated type, if
    the function fails with an error of Python or of another library: the message names the
    argument, the value and what it may be. Arguments of `__init__` are checked before it runs,
    since an object would keep a wrong value until it is used. Sequences may be lists, tuples or
    arrays, and numbers those of numpy. Keywords listed in a TypedDict are checked too; classes
    derived from `Strict` check their fields themselves.

    Examples
    --------
    >>> @checked
    ... def scale(factor: float, *, unit: str = "mm") -> float:
    ...     return 2.0 * factor
    >>> scale(3)
    6.0
    >>> scale("x")
    Traceback (most recent call last):
    ...
    thermobearing.border.errors.InputError: scale(): factor = 'x': must be a number
    """
    if isinstance(item, type):
        for name, attribute in list(vars(item).items()):
            function = getattr(attribute, "__func__", attribute)
            if not inspect.isfunction(function) or hasattr(function, "__wrapped__"):
                continue
            if (name == "__init__" or name[0] != "_") and _takes_values(function):
                method: Any = _checked_function(function)
                if isinstance(attribute, classmethod | staticmethod):
                    method = type(attribute)(method)
                setattr(item, name, method)
        return item
    return _checked_function(item)  # type: ignore[arg-type,return-value]


def _takes_values(function: types.FunctionType) -> bool:
    """Return whether a method has arguments other than `self`."""
    code = function.__code__
    return code.co_argcount + code.co_kwonlyargcount > 1 or bool(
        code.co_flags & inspect.CO_VARKEYWORDS
    )


def _checked_function(function: Callable[..., Any]) -> Callable[..., Any]:
    where = f"{function.__qualname__.removesuffix('.__init__')}()"
    is_checked_before = function.__name__ == "__init__"

    # Evaluated when the function is first called: importing the package stays quick.
    @functools.cache
    def _arguments() -> tuple[list[str], dict[str, _Argument], bool]:
        parameters = inspect.signature(function).parameters.values()
        arguments: dict[str, _Argument] = {}
        is_open = False
        for parameter in parameters:
            kinds = get_args(_evaluated(parameter.annotation, function))
            if parameter.kind is not parameter.VAR_KEYWORD:
                arguments[parameter.name] = _argument(parameter, function)
            elif kinds and is_typeddict(kinds[0]):
                # `**options: Unpack[Keywords]`: the TypedDict has the names.
                for name, annotation in kinds[0].__annotations__.items():
                    option = parameter.replace(name=name, annotation=annotation)
                    arguments[name] = _argument(option, function)
            else:
                is_open = True
        fixed = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
        return [item.name for item in parameters if item.kind in fixed], arguments, is_open

    def _faults(args: tuple[Any, ...], keywords: dict[str, Any]) -> list[str]:
        positional, arguments, _ = _arguments()
        items = [*zip(positional, args, strict=False), *keywords.items()]
        faults = (arguments[name].fault(name, value) for name, value in items if name in arguments)
        return list(filter(None, faults))

    def _refuse_unknown(keywords: dict[str, Any]) -> None:
        _, arguments, is_open = _arguments()
        if is_open or keywords.keys() <= arguments.keys():
            return
        accepted = [key for key in arguments if key not in NO_NAMES]
        unknown = [name for name in keywords if name not in arguments]
        hints = {name: renamed(name, accepted) or nearest(name, accepted) for name in unknown}
        faults = [f'unknown key "{name}"{hint}' for name, hint in hints.items()]
        raise InputError([*faults, *_faults((), keywords)], where)

    @functools.wraps(function)
    def _call(*args: Any, **keywords: Any) -> Any:
        _refuse_unknown(keywords)
        # A huge integer would be converted, counted to or printed before anybody looks at it.
        values = (*args, *keywords.values())
        is_huge = any(isinstance(value, int) and abs(value) > LARGEST for value in values)
        if (is_checked_before or is_huge) and (faults := _faults(args, keywords)):
            raise InputError(faults, where)
        try:
            return function(*args, **keywords)
        except (InputError, OutputError):
            raise
        except Exception as error:
            if faults := _faults(args, keywords):
                raise InputError(faults, where) from error
            raise

    return _call


def _argument(parameter: inspect.Parameter, function: Callable[..., Any]) -> _Argument:
    annotation = _evaluated(parameter.annotation, function)
    return _Argument(tuple(_forms(annotation, function)), parameter.default)


def _evaluated(annotation: Any, function: Callable[..., Any]) -> Any:
    """Return an annotation that is text as types; what is not imported is known by its name."""
    if not isinstance(annotation, str):
        return annotation
    names: dict[str, Any] = {"pd": _Module(), "xr": _Module()}
    scope: dict[str, Any] = getattr(inspect.unwrap(function), "__globals__", {})
    while True:
        try:
            return eval(annotation, scope, names)
        except NameError as error:
            name = str(error.name)
            names[name] = _Loaded(name, (), {})


def _entry(annotation: Any, function: Callable[..., Any]) -> _Argument:
    """Return the entry of a sequence or table."""
    return _Argument(tuple(_forms(annotation, function)), inspect.Parameter.empty)


def _resolve_alias(annotation: Any) -> Any:
    """Return what an alias of the statement `type` stands for: numpy 2.5 makes NDArray one."""
    origin = get_origin(annotation)
    if hasattr(origin, "__value__"):
        return _resolve_alias(origin.__value__[get_args(annotation)])
    if hasattr(annotation, "__value__"):
        return _resolve_alias(annotation.__value__)
    return annotation


ARRAY_LIKE = _resolve_alias(ArrayLike)


def _forms(annotation: Any, function: Callable[..., Any]) -> list[_Form]:
    """Return the kinds of values that an annotation allows."""
    annotation = _resolve_alias(_evaluated(annotation, function))
    origin, inner = get_origin(annotation), get_args(annotation)
    if annotation is ARRAY_LIKE:
        return [NUMBERS]
    if origin is np.ndarray:
        return [SEVERAL_NUMBERS]
    if origin is Annotated:
        return _forms(inner[0], function)
    if origin in (Union, types.UnionType):
        return [form for part in inner for form in _forms(part, function)]
    if origin is Literal:
        names = (f'"{item}"' if isinstance(item, str) else repr(item) for item in inner)
        words = f"one of {', '.join(names)}"
        return [_Form(functools.partial(_is_one_of, inner), words)]
    if origin is not None:
        return [_container(origin, inner, function)]
    if annotation is None:
        return [NONE]
    if annotation in FORMS:
        return [FORMS[annotation]]
    if is_typeddict(annotation):
        return [TABLE]
    if isinstance(annotation, _Loaded) or (
        isinstance(annotation, type) and annotation.__module__.startswith(CHECKED_MODULES)
    ):
        name = annotation.__name__
        article = "an" if name[0] in "AEIO" else "a"
        accepts: Callable[[Any], bool] = lambda value: isinstance(value, annotation)  # noqa: E731
        return [_Form(accepts, CURES.get(name, f"{article} {name}"))]
    return [ANYTHING]


def _container(origin: Any, inner: tuple[Any, ...], function: Callable[..., Any]) -> _Form:
    if not isinstance(origin, type):  # Unpack
        return ANYTHING
    if issubclass(origin, Mapping):
        parts = [_entry(part, function) for part in inner]
        item = parts[-1] if parts else None
        return _Form(functools.partial(_is_table, parts), TABLE.words, item, is_table=True)
    if issubclass(origin, Collection):
        if origin is tuple and inner[-1:] != (...,):
            parts = [_entry(part, function) for part in inner]
            noun = "numbers" if inner[0] is float else "values"
            return _Form(functools.partial(_is_tuple, parts), f"{COUNTS[len(inner)]} {noun}")
        item = _entry(inner[0], function)
        return _Form(functools.partial(_is_sequence, item), "a list", item)
    if issubclass(origin, Callable):  # type: ignore[arg-type]
        return _Form(callable, "a function")
    return ANYTHING


def _is_one_of(allowed: tuple[Any, ...], value: Any) -> bool:
    return any(isinstance(value, type(item)) and value == item for item in allowed)


def _is_text_like(value: Any) -> bool:
    return isinstance(value, str | bytes | bytearray | Mapping)


def _is_sequence(item: _Argument, value: Any) -> bool:
    if isinstance(value, list | tuple):
        return not any(item.fault("", entry) for entry in value)
    if isinstance(value, np.ndarray):  # its entries are alike
        first = value[0] if value.size and value.ndim else value.dtype.type()
        return value.ndim > 0 and not item.fault("", first)
    return isinstance(value, Iterable) and not (_is_text_like(value) or isinstance(value, Set))


def _is_tuple(parts: list[_Argument], value: Any) -> bool:
    if not isinstance(value, list | tuple | np.ndarray) or len(value) != len(parts):
        return False
    return not any(part.fault("", entry) for part, entry in zip(parts, value, strict=True))


def _is_table(parts: list[_Argument], value: Any) -> bool:
    if not isinstance(value, Mapping):
        return False
    return not parts or not any(
        part.fault("", entry)
        for item in value.items()
        for part, entry in zip(parts, item, strict=True)
    )


def _is_array(value: Any) -> bool:
    """Return whether numpy makes real numbers of a value; text is none."""
    if isinstance(value, bool) or _is_text_like(value):
        return False
    try:
        array = np.asarray(value)
        if array.dtype.kind == "O":  # of a masked value, or of integers beyond 64 bits
            if any(entry is None for entry in array.flat):  # numpy would make NaN of it
                return False
            array = array.astype(np.float64)
    except (TypeError, ValueError, OverflowError, RecursionError):
        return False
    return array.dtype.kind in "iuf"


def _is_real(value: Any) -> bool:
    if isinstance(value, np.ndarray):
        return value.ndim == 0 and value.dtype.kind in "iuf"
    return is_number(value)


def _is_integer(value: Any) -> bool:
    return isinstance(value, int | np.integer) and not isinstance(value, bool)


NONE = _Form(lambda value: value is None, "None")
TEXT = _Form(lambda value: isinstance(value, str), "text")
PATH = _Form(lambda value: isinstance(value, Path), "a pathlib.Path")
TABLE = _Form(lambda value: isinstance(value, Mapping), "a table (dict)")
NUMBERS = _Form(_is_array, "a list of numbers")
SEVERAL_NUMBERS = _Form(lambda value: _is_array(value) and np.ndim(value) > 0, NUMBERS.words)
FORMS: dict[Any, _Form] = {
    type(None): NONE,
    bool: _Form(lambda value: isinstance(value, bool | np.bool_), "True or False"),
    int: _Form(_is_integer, "an integer"),
    float: _Form(_is_real, "a number"),
    str: TEXT,
    Path: PATH,
    dict: TABLE,
}
