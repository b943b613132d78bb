"""Names and keyword arguments of earlier versions: accepted for a while, with a warning."""

import functools
import inspect
import re
import sys
import warnings
from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any, ParamSpec, TypeVar, get_args

from thermobearing.border.errors import InputError, nearest

P = ParamSpec("P")
T = TypeVar("T")
TOP = "thermobearing"
UNTIL = "0.3"  # the version that removes them


def _warn_renamed(old: str, new: str, stacklevel: int = 3) -> None:
    """Warn that a name of an earlier version is used, and give the present one."""
    message = f"{old} is deprecated and will be removed in version {UNTIL}; use {new}"
    warnings.warn(message, DeprecationWarning, stacklevel=stacklevel)


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

    def decorate(function: Callable[P, T]) -> Callable[P, T]:
        known = _keywords(function)
        where = f"{function.__qualname__.removesuffix('.__init__')}()"

        @functools.wraps(function)
        def call(*args: P.args, **keywords: P.kwargs) -> T:
            for old in names.keys() & keywords.keys():
                new, _, field = names[old].partition(".")
                made = f"{records[new].__name__}({field}=...)" if records and field else ""
                _warn_renamed(f"{where[:-1]}{old}=)", f"{new}={made}")
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

        return call

    return decorate


def _keywords(function: Callable[..., Any]) -> list[str]:
    """Return the names of all arguments, also of a TypedDict; none if any keyword is accepted."""
    arguments = inspect.signature(function).parameters
    listed = [get_args(one.annotation) for one in arguments.values() if one.kind is one.VAR_KEYWORD]
    if not all(listed):
        return []
    return [*arguments, *(name for kinds in listed for name in kinds[0].__annotations__)]


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
                _warn_renamed(f"{package}.{name}", f"{TOP if public else place}.{name}")
                return getattr(import_module(place), name)
        if package != TOP and name in import_module(TOP).__all__:  # another package has it now
            _warn_renamed(f"{package}.{name}", f"{TOP}.{name}")
            return getattr(import_module(TOP), name)
        raise missing

    return find
