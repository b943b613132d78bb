"""OpenSees, the other program of the comparisons: imported in this place only.

`ops` is the module, or where it cannot be imported a stand-in whose every use says what to
install. Tests that need it carry the mark `needs_opensees`, which skips them with that sentence.
"""

from importlib import import_module
from typing import Any, NoReturn

import pytest

from tests.skip_reasons import NO_OPENSEES as MISSING
from thermobearing.verify.references import preload_opensees


class Absent:
    """Stands in for the module that is not there."""

    def __getattr__(self, name: str) -> NoReturn:
        if name.startswith("__"):  # asked of every object by those who look for docstrings
            raise AttributeError(name)
        raise ImportError(MISSING)


def _load() -> Any:
    """The module or its stand-in."""
    try:
        preload_opensees()
        return import_module("openseespy.opensees")
    except (ImportError, OSError, RuntimeError):  # the last is how openseespy itself reports
        return Absent()


ops = _load()
needs_opensees = pytest.mark.skipif(isinstance(ops, Absent), reason=MISSING)


def analyse(
    *integrator: object,
    tolerance: float = 1e-10,
    most: int = 50,
    constraints: str | tuple[object, ...] = "Transformation",
    numberer: str = "Plain",
    system: str = "BandGeneral",
) -> None:
    """Prepare a Newton analysis, by default a transient one with constant mean acceleration."""
    ops.constraints(*((constraints,) if isinstance(constraints, str) else constraints))
    ops.numberer(numberer)
    ops.system(system)
    ops.test("NormDispIncr", tolerance, most)
    ops.algorithm("Newton")
    ops.integrator(*(integrator or ("Newmark", 0.5, 0.25)))
    ops.analysis("Static" if integrator else "Transient")
