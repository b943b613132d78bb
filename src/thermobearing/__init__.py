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
    "Ambient": "thermobearing.bearing.ambient",
    "Bearing": "thermobearing.bearing.model",
    "BearingElement": "thermobearing.model.element",
    "BilinearBearing": "thermobearing.bearing.bilinear",
    "Case": "thermobearing.cyclic.case",
    "CyclicTest": "thermobearing.cyclic.protocol",
    "EarthquakeCase": "thermobearing.earthquake.case",
    "EarthquakeResult": "thermobearing.earthquake.result",
    "EndFace": "thermobearing.model.options",
    "GroundMotion": "thermobearing.motions.record",
    "Identification": "thermobearing.identify.result",
    "InputError": "thermobearing.border.errors",
    "OutputError": "thermobearing.border.errors",
    "Result": "thermobearing.cyclic.result",
    "TestRecord": "thermobearing.identify.record",
    "baseline_corrected": "thermobearing.motions.process",
    "bound_models": "thermobearing.design.bound_models",
    "bounds_study": "thermobearing.design.bounds_study",
    "bridge": "thermobearing.earthquake.study",
    "check_test": "thermobearing.identify.checks",
    "cyclic_test": "thermobearing.cyclic.protocol",
    "equal_bearing": "thermobearing.design.equal",
    "hybrid": "thermobearing.earthquake.study",
    "identify_bearing": "thermobearing.identify.run",
    "list_bearings": "thermobearing.bearing.library",
    "list_motions": "thermobearing.motions.library",
    "list_structures": "thermobearing.structure.model",
    "load_bearing": "thermobearing.bearing.library",
    "load_bilinear": "thermobearing.bearing.bilinear",
    "load_case": "thermobearing.cyclic.case",
    "load_design_case": "thermobearing.design.case",
    "load_earthquake_case": "thermobearing.earthquake.case",
    "load_motion": "thermobearing.motions.library",
    "load_result": "thermobearing.loading",
    "load_structure": "thermobearing.structure.model",
    "load_test": "thermobearing.identify.record",
    "make_design_case": "thermobearing.design.case",
    "make_motion": "thermobearing.motions.synthesis",
    "match_spectrum": "thermobearing.motions.synthesis",
    "measure_cycle": "thermobearing.results.metrics",
    "measure_history": "thermobearing.results.metrics",
    "measure_motion": "thermobearing.motions.measures",
    "read_columns": "thermobearing.border.tables",
    "read_motion": "thermobearing.motions.readers",
    "record_from_arrays": "thermobearing.identify.record",
    "resampled": "thermobearing.motions.process",
    "response_spectrum": "thermobearing.motions.spectrum",
    "run": "thermobearing.cyclic.run",
    "run_case": "thermobearing.cyclic.run",
    "run_design": "thermobearing.design.run",
    "run_earthquake": "thermobearing.earthquake.run",
    "scale_study": "thermobearing.design.scale",
    "scaled_bearing": "thermobearing.design.scale",
    "standard_spectrum": "thermobearing.motions.jra",
    "synthetic_record": "thermobearing.identify.synthetic",
    "temperature_factors": "thermobearing.design.factors",
}

__all__ = [
    "Ambient",
    "Bearing",
    "BearingElement",
    "BilinearBearing",
    "Case",
    "CyclicTest",
    "EarthquakeCase",
    "EarthquakeResult",
    "EndFace",
    "GroundMotion",
    "Identification",
    "InputError",
    "OutputError",
    "Result",
    "TestRecord",
    "__version__",
    "baseline_corrected",
    "bound_models",
    "bounds_study",
    "bridge",
    "check_test",
    "cyclic_test",
    "equal_bearing",
    "hybrid",
    "identify_bearing",
    "list_bearings",
    "list_motions",
    "list_structures",
    "load_bearing",
    "load_bilinear",
    "load_case",
    "load_design_case",
    "load_earthquake_case",
    "load_motion",
    "load_result",
    "load_structure",
    "load_test",
    "make_design_case",
    "make_motion",
    "match_spectrum",
    "measure_cycle",
    "measure_history",
    "measure_motion",
    "read_columns",
    "read_motion",
    "record_from_arrays",
    "resampled",
    "response_spectrum",
    "run",
    "run_case",
    "run_design",
    "run_earthquake",
    "scale_study",
    "scaled_bearing",
    "standard_spectrum",
    "synthetic_record",
    "temperature_factors",
]

if TYPE_CHECKING:
    from thermobearing.bearing.ambient import Ambient
    from thermobearing.bearing.bilinear import BilinearBearing, load_bilinear
    from thermobearing.bearing.library import list_bearings, load_bearing
    from thermobearing.bearing.model import Bearing
    from thermobearing.border.errors import InputError, OutputError
    from thermobearing.border.tables import read_columns
    from thermobearing.cyclic.case import Case, load_case
    from thermobearing.cyclic.protocol import CyclicTest, cyclic_test
    from thermobearing.cyclic.result import Result
    from thermobearing.cyclic.run import run, run_case
    from thermobearing.design.bound_models import bound_models
    from thermobearing.design.bounds_study import bounds_study
    from thermobearing.design.case import load_design_case, make_design_case
    from thermobearing.design.equal import equal_bearing
    from thermobearing.design.factors import temperature_factors
    from thermobearing.design.run import run_design
    from thermobearing.design.scale import scale_study, scaled_bearing
    from thermobearing.earthquake.case import EarthquakeCase, load_earthquake_case
    from thermobearing.earthquake.result import EarthquakeResult
    from thermobearing.earthquake.run import run_earthquake
    from thermobearing.earthquake.study import bridge, hybrid
    from thermobearing.identify.checks import check_test
    from thermobearing.identify.record import TestRecord, load_test, record_from_arrays
    from thermobearing.identify.result import Identification
    from thermobearing.identify.run import identify_bearing
    from thermobearing.identify.synthetic import synthetic_record
    from thermobearing.loading import load_result
    from thermobearing.model.element import BearingElement
    from thermobearing.model.options import EndFace
    from thermobearing.motions.jra import standard_spectrum
    from thermobearing.motions.library import list_motions, load_motion
    from thermobearing.motions.measures import measure_motion
    from thermobearing.motions.process import baseline_corrected, resampled
    from thermobearing.motions.readers import read_motion
    from thermobearing.motions.record import GroundMotion
    from thermobearing.motions.spectrum import response_spectrum
    from thermobearing.motions.synthesis import make_motion, match_spectrum
    from thermobearing.results.metrics import measure_cycle, measure_history
    from thermobearing.structure.model import list_structures, load_structure


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'thermobearing' has no attribute {name!r}")
    value = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOME])
