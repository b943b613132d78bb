"""Rubber isolation bearings in the cold: heat conduction coupled to hysteresis.

>>> import thermobearing as tb
>>> result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1), ambient=-20)
>>> result.outcome
'completed'

Names below are imported when they are first used, so that `import thermobearing` is quick.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_HOME = {
    "Ambient": "thermobearing.drive.ambient",
    "Bearing": "thermobearing.bearing.model",
    "BearingElement": "thermobearing.drive.element",
    "Case": "thermobearing.case",
    "CyclicTest": "thermobearing.drive.protocol",
    "EndFace": "thermobearing.case",
    "InputError": "thermobearing.errors",
    "OutputError": "thermobearing.errors",
    "Result": "thermobearing.results.result",
    "cyclic_test": "thermobearing.drive.protocol",
    "list_bearings": "thermobearing.bearing.library",
    "load_bearing": "thermobearing.bearing.library",
    "load_case": "thermobearing.case",
    "load_result": "thermobearing.results.files",
    "measure_cycle": "thermobearing.results.metrics",
    "measure_history": "thermobearing.results.metrics",
    "read_columns": "thermobearing.tables",
    "run": "thermobearing.simulate",
    "run_case": "thermobearing.simulate",
}

__all__ = [
    "Ambient",
    "Bearing",
    "BearingElement",
    "Case",
    "CyclicTest",
    "EndFace",
    "InputError",
    "OutputError",
    "Result",
    "__version__",
    "cyclic_test",
    "list_bearings",
    "load_bearing",
    "load_case",
    "load_result",
    "measure_cycle",
    "measure_history",
    "read_columns",
    "run",
    "run_case",
]

if TYPE_CHECKING:
    from thermobearing.bearing.library import list_bearings, load_bearing
    from thermobearing.bearing.model import Bearing
    from thermobearing.case import Case, EndFace, load_case
    from thermobearing.drive.ambient import Ambient
    from thermobearing.drive.element import BearingElement
    from thermobearing.drive.protocol import CyclicTest, cyclic_test
    from thermobearing.errors import InputError, OutputError
    from thermobearing.results.files import load_result
    from thermobearing.results.metrics import measure_cycle, measure_history
    from thermobearing.results.result import Result
    from thermobearing.simulate import run, run_case
    from thermobearing.tables import read_columns


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'thermobearing' has no attribute {name!r}")
    value = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOME])
