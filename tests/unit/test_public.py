"""The public interface: a dozen names at the top, rooms behind them, old places with a warning."""

import re
import subprocess
import sys
from importlib import import_module
from types import ModuleType

import pytest

import thermobearing as tb
from thermobearing.border.moved import ROOMS as MOVED

ROOMS = sorted(name for name in tb.__all__ if isinstance(getattr(tb, name), ModuleType))
TOP = sorted(set(tb.__all__) - set(ROOMS))
HEAVY = {"numpy", "scipy", "numba", "pandas", "xarray", "pydantic", "pint", "matplotlib", "rich"}


def test_a_dozen_names_at_the_top() -> None:
    assert len(TOP) <= 16
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


@pytest.mark.parametrize("name", sorted(MOVED))
def test_an_old_place_still_works_and_tells_the_new_one(name: str) -> None:
    assert name not in tb.__all__
    new = f"thermobearing.{MOVED[name]}.{name}"
    with pytest.warns(DeprecationWarning, match=re.escape(f"is now {new};")) as caught:
        old = getattr(tb, name)
    assert old is getattr(getattr(tb, MOVED[name]), name)
    assert caught[0].filename == __file__


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


def test_every_stub_is_beside_its_room() -> None:
    """A wheel without them cannot be imported."""
    for name in ("", *(f".{room}" for room in ROOMS)):
        module = import_module(f"thermobearing{name}")
        assert module.__file__ is not None
        text = open(module.__file__ + "i", encoding="ascii").read()  # noqa: SIM115
        for public in module.__all__:
            assert re.search(rf"import {public} as {public}\n", text)
