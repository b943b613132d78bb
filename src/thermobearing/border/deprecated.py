"""Keyword arguments of earlier versions, accepted for a while with a warning."""

import functools
import inspect
import warnings
from collections.abc import Callable, Mapping
from typing import Any, ParamSpec, TypeVar, get_args

from thermobearing.border.errors import InputError, nearest

P = ParamSpec("P")
T = TypeVar("T")
UNTIL = "0.3"  # the version that removes them


def renamed(
    records: Mapping[str, Any] | None = None, /, **names: str
) -> Callable[[Callable[P, T]], Callable[P, T]]:
    """Decorate a function so that it accepts keyword arguments by their earlier names.

    A name such as "keep.every" is a field of a record that the present keyword takes; the class of
    that record is in `records`, and its `of(value, **fields)` adds fields to what is given. Where
    the other keywords are listed in a TypedDict, the nearest name is given for an unknown one.

    Examples
    --------
    >>> @renamed(force="overwrite")
    ... def save(path, *, overwrite=False):
    ...     return overwrite
    >>> save("out", overwrite=True)
    True
    """

    def _decorate(function: Callable[P, T]) -> Callable[P, T]:
        known = _keywords(function)
        where = f"{function.__qualname__.removesuffix('.__init__')}()"

        @functools.wraps(function)
        def _call(*args: P.args, **keywords: P.kwargs) -> T:
            for old in names.keys() & keywords.keys():
                new, _, field = names[old].partition(".")
                made = f"{records[new].__name__}({field}=...)" if records and field else ""
                message = (
                    f"{where[:-1]}{old}=) is deprecated and will be removed in version {UNTIL}"
                )
                message += f"; use {new}={made}"
                warnings.warn(message, DeprecationWarning, stacklevel=2)
                value = keywords.pop(old)
                if records and field:
                    value = records[new].of(keywords.get(new), **{field: value})
                elif keywords.get(new) is not None:
                    raise InputError(f"give {new} or {old}, not both", where)
                keywords[new] = value
            unknown = [name for name in keywords if known and name not in known]
            if unknown:
                problems = [f'unknown key "{name}"{nearest(name, known)}' for name in unknown]
                raise InputError(problems, where)
            return function(*args, **keywords)

        return _call

    return _decorate


def _keywords(function: Callable[..., Any]) -> list[str]:
    """Return the names of all arguments, also of a TypedDict; none if any keyword is accepted."""
    arguments = inspect.signature(function).parameters
    listed = [get_args(one.annotation) for one in arguments.values() if one.kind is one.VAR_KEYWORD]
    if not all(listed):
        return []
    return [*arguments, *(name for kinds in listed for name in kinds[0].__annotations__)]
