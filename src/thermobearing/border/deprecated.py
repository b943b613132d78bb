"""Names and keyword arguments of earlier versions: accepted for a while, with a warning."""

import functools
import re
import sys
import warnings
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")
TOP = "thermobearing"
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


def find_moved(package: str) -> Callable[[str], Any]:
    """Return the `__getattr__` of a package: its modules, and names that it once promised.

    Such a name is public at the top now, or defined in a module of the package.
    """

    def find(name: str) -> Any:
        missing = AttributeError(f"module {package!r} has no attribute {name!r}")
        folder = Path(str(sys.modules[package].__file__)).parent
        if name.startswith("_"):
            raise missing
        if (folder / f"{name}.py").exists() or (folder / name / "__init__.py").exists():
            return import_module(f"{package}.{name}")
        for path in sorted(folder.rglob("*.py")) if package != TOP else ():
            text = path.read_text(encoding="utf-8")
            if re.search(rf"^(?:class|def) {re.escape(name)}\b", text, re.MULTILINE):
                inside = path.relative_to(folder).with_suffix("").parts
                place = ".".join((package, *inside))
                public = name in import_module(TOP).__all__
                warn_renamed(f"{package}.{name}", f"{TOP if public else place}.{name}")
                return getattr(import_module(place), name)
        raise missing

    return find
