"""Unknown keyword arguments as errors that name the nearest known one."""

import functools
import inspect
from collections.abc import Callable
from typing import ParamSpec, TypeVar, get_args

from thermobearing.border.errors import InputError, nearest

P = ParamSpec("P")
T = TypeVar("T")


def checked_keywords(function: Callable[P, T]) -> Callable[P, T]:
    """Decorate a function so that an unknown keyword raises an InputError with the nearest name.

    Keywords listed in a TypedDict are known too.

    >>> @checked_keywords
    ... def save(path, *, overwrite=False):
    ...     return overwrite
    >>> save("out", overwrite=True)
    True
    """
    arguments = inspect.signature(function).parameters
    listed = [get_args(one.annotation) for one in arguments.values() if one.kind is one.VAR_KEYWORD]
    known = [*arguments, *(name for kinds in listed for name in kinds[0].__annotations__)]
    where = f"{function.__qualname__.removesuffix('.__init__')}()"

    @functools.wraps(function)
    def _call(*args: P.args, **keywords: P.kwargs) -> T:
        unknown = [name for name in keywords if name not in known]
        if unknown:
            raise InputError([f'unknown key "{n}"{nearest(n, known)}' for n in unknown], where)
        return function(*args, **keywords)

    return _call
