"""The public interface: a dozen names at the top, rooms behind them."""

import inspect
import re
import subprocess
import sys
from importlib import import_module
from types import ModuleType
from typing import Any, get_args, is_typeddict

import pytest

import thermobearing as tb

ROOMS = sorted(name for name in tb.__all__ if isinstance(getattr(tb, name), ModuleType))
TOP = sorted(set(tb.__all__) - set(ROOMS))
PUBLIC = sorted(
    {getattr(getattr(tb, room), name) for room in ROOMS for name in getattr(tb, room).__all__}
    | {getattr(tb, name) for name in TOP},
    key=lambda item: (item.__module__, item.__name__),
)
HEAVY = {"numpy", "scipy", "numba", "pandas", "xarray", "pydantic", "pint", "matplotlib", "rich"}
SECTION = r"\n\s*{}\n\s*-+\n(.*?)(?=\n\s*\w+\n\s*---|\Z)"
# What a description of a number has: its unit in brackets, or a word for one that has none.
UNIT = re.compile(
    r"\[.+?\]|\b(ratios?|shares?|relative|strains?|factors?|c_z|weights?|correlation|unit|as of)\b"
)
NAMED_UNIT = re.compile(r"^h_eq$|_(mm|MPa|kN)$")  # or its name says it


def ident(item: Any) -> str:
    return f"{item.__module__.removeprefix('thermobearing.')}.{item.__name__}"


def test_a_dozen_names_at_the_top() -> None:
    assert len(TOP) <= 20
    assert {"run", "bridge", "hybrid", "cyclic_test", "load_bearing", "InputError"} <= set(TOP)
    assert {"motions", "design", "identify", "earthquake", "cyclic"} <= set(ROOMS)


@pytest.mark.parametrize("room", ROOMS)
def test_a_room_offers_what_is_its_own(room: str) -> None:
    module = getattr(tb, room)
    assert set(dir(module)) == set(module.__all__)
    for name in module.__all__:
        item = getattr(module, name)
        assert item.__name__ == name
        assert item.__module__.startswith(f"thermobearing.{room}.")
        # A module of the same name would hide the function once it is imported.
        assert not isinstance(sys.modules.get(f"thermobearing.{room}.{name}"), ModuleType)


def test_an_unknown_name_is_told() -> None:
    with pytest.raises(AttributeError, match=r"thermobearing.* nonsense"):
        _ = tb.nonsense  # type: ignore[attr-defined]
    with pytest.raises(AttributeError, match=r"motions.* nonsense"):
        _ = tb.motions.nonsense  # type: ignore[attr-defined]


def test_importing_the_package_imports_nothing_heavy() -> None:
    code = "import sys, thermobearing; print(*{name.split('.')[0] for name in sys.modules})"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = set(done.stdout.split())
    assert "thermobearing" in loaded
    assert not loaded & HEAVY


def section(text: str, title: str) -> str:
    found = re.search(SECTION.format(title), text, re.DOTALL)
    return found[1] if found else ""


def arguments(item: Any) -> dict[str, Any]:
    """Types by name, those of keywords that are listed in a TypedDict too."""
    found: dict[str, Any] = {}
    for name, parameter in inspect.signature(item).parameters.items():
        if name == "self":
            continue
        found[name] = parameter.annotation
        for kind in get_args(parameter.annotation):
            if is_typeddict(kind):
                found |= kind.__annotations__
    return found


def entry(text: str, name: str) -> str:
    """What a section says about an argument; several may be described together."""
    lines = text.split("\n")
    indent = min((len(line) - len(line.lstrip()) for line in lines if line.strip()), default=0)
    told, inside = [], False
    for line in lines:
        head = re.match(rf"\s{{{indent}}}([\w, *]+) :", line)
        if head:
            inside = name in re.split(r",\s*", head[1].replace("*", "").strip())
        if inside:
            told.append(line)
    return "\n".join(told)


@pytest.mark.parametrize("item", [pytest.param(i, id=ident(i)) for i in PUBLIC])
def test_a_public_name_is_documented(item: Any) -> None:
    """What it takes or holds, with units, and an example that runs (the doctests do).

    A record, whose docstring says what it holds, needs no example: functions make it.
    """
    text = inspect.getdoc(item) or ""
    assert text, "no docstring"
    if inspect.isclass(item) and issubclass(item, Exception):
        return
    record = section(text, "Attributes")
    assert record or ">>>" in section(text, "Examples"), "no example"
    told = record or section(text, "Parameters")
    for name, kind in arguments(item).items():
        said = entry(told, name)
        assert said, f"{name} is not described"
        if "float" in str(kind):
            assert UNIT.search(said) or NAMED_UNIT.search(name), f"{name} has no unit"


def test_every_stub_is_beside_its_room() -> None:
    """A wheel without them cannot be imported."""
    for name in ("", *(f".{room}" for room in ROOMS)):
        module = import_module(f"thermobearing{name}")
        assert module.__file__ is not None
        text = open(module.__file__ + "i", encoding="ascii").read()  # noqa: SIM115
        for public in module.__all__:
            assert re.search(rf"import {public} as {public}\n", text)
