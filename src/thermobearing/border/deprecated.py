"""Names and keyword arguments of earlier versions: accepted for a while, with a warning."""

import functools
import warnings
from collections.abc import Callable
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")
UNTIL = "0.3"  # the version that no longer accepts them


def warn_renamed(old: str, new: str, stacklevel: int = 3) -> None:
    """Warn that a name of an earlier version is used, and give the present one."""
    told = f"{old} is deprecated and goes with version {UNTIL}; use {new}"
    warnings.warn(told, DeprecationWarning, stacklevel=stacklevel)


def renamed(**names: str) -> Callable[[Callable[P, T]], Callable[P, T]]:
    """Decorate a function so that it accepts keyword arguments by their earlier names.

    Examples
    --------
    >>> @renamed(force="overwrite")
    ... def save(path, *, overwrite=False):
    ...     return overwrite
    >>> save("out", overwrite=True)
    True
    """

    def decorate(function: Callable[P, T]) -> Callable[P, T]:
        @functools.wraps(function)
        def call(*args: P.args, **keywords: P.kwargs) -> T:
            for old in names.keys() & keywords.keys():
                warn_renamed(f"{function.__qualname__}(..., {old}=)", f"{names[old]}=")
                keywords[names[old]] = keywords.pop(old)
            return function(*args, **keywords)

        return call

    return decorate
