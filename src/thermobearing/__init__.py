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
    "BilinearBearing": "thermobearing.bearing.bilinear",
    "Case": "thermobearing.case",
    "CyclicTest": "thermobearing.drive.protocol",
    "EarthquakeCase": "thermobearing.earthquake_case",
    "EarthquakeResult": "thermobearing.results.earthquake_result",
    "EndFace": "thermobearing.model_options",
    "GroundMotion": "thermobearing.drive.motions.record",
    "Identification": "thermobearing.identify.fit",
    "InputError": "thermobearing.errors",
    "OutputError": "thermobearing.errors",
    "Result": "thermobearing.results.result",
    "TestRecord": "thermobearing.identify.record",
    "baseline_corrected": "thermobearing.drive.motions.process",
    "bound_models": "thermobearing.design.bound_models",
    "bounds_study": "thermobearing.design.bounds_study",
    "bridge": "thermobearing.earthquake",
    "check_test": "thermobearing.identify.checks",
    "cyclic_test": "thermobearing.drive.protocol",
    "equal_bearing": "thermobearing.design.equal",
    "hybrid": "thermobearing.earthquake",
    "identify_bearing": "thermobearing.identify.fit",
    "list_bearings": "thermobearing.bearing.library",
    "list_motions": "thermobearing.drive.motions.library",
    "list_structures": "thermobearing.drive.structure.model",
    "load_bearing": "thermobearing.bearing.library",
    "load_bilinear": "thermobearing.bearing.bilinear",
    "load_case": "thermobearing.case",
    "load_design_case": "thermobearing.design.case",
    "load_earthquake_case": "thermobearing.earthquake_case",
    "load_motion": "thermobearing.drive.motions.library",
    "load_result": "thermobearing.results.files",
    "load_structure": "thermobearing.drive.structure.model",
    "load_test": "thermobearing.identify.record",
    "make_design_case": "thermobearing.design.case",
    "make_motion": "thermobearing.drive.motions.synthesis",
    "match_spectrum": "thermobearing.drive.motions.synthesis",
    "measure_cycle": "thermobearing.results.metrics",
    "measure_history": "thermobearing.results.metrics",
    "measure_motion": "thermobearing.drive.motions.measures",
    "read_columns": "thermobearing.tables",
    "read_motion": "thermobearing.drive.motions.readers",
    "record_from_arrays": "thermobearing.identify.record",
    "resampled": "thermobearing.drive.motions.process",
    "response_spectrum": "thermobearing.drive.motions.spectrum",
    "run": "thermobearing.simulate",
    "run_case": "thermobearing.simulate",
    "run_design": "thermobearing.design.loop",
    "run_earthquake": "thermobearing.earthquake",
    "scale_study": "thermobearing.design.scale",
    "scaled_bearing": "thermobearing.design.scale",
    "standard_spectrum": "thermobearing.drive.motions.jra",
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
    from thermobearing.bearing.bilinear import BilinearBearing, load_bilinear
    from thermobearing.bearing.library import list_bearings, load_bearing
    from thermobearing.bearing.model import Bearing
    from thermobearing.case import Case, load_case
    from thermobearing.design.bound_models import bound_models
    from thermobearing.design.bounds_study import bounds_study
    from thermobearing.design.case import load_design_case, make_design_case
    from thermobearing.design.equal import equal_bearing
    from thermobearing.design.factors import temperature_factors
    from thermobearing.design.loop import run_design
    from thermobearing.design.scale import scale_study, scaled_bearing
    from thermobearing.drive.ambient import Ambient
    from thermobearing.drive.element import BearingElement
    from thermobearing.drive.motions.jra import standard_spectrum
    from thermobearing.drive.motions.library import list_motions, load_motion
    from thermobearing.drive.motions.measures import measure_motion
    from thermobearing.drive.motions.process import baseline_corrected, resampled
    from thermobearing.drive.motions.readers import read_motion
    from thermobearing.drive.motions.record import GroundMotion
    from thermobearing.drive.motions.spectrum import response_spectrum
    from thermobearing.drive.motions.synthesis import make_motion, match_spectrum
    from thermobearing.drive.protocol import CyclicTest, cyclic_test
    from thermobearing.drive.structure.model import list_structures, load_structure
    from thermobearing.earthquake import bridge, hybrid, run_earthquake
    from thermobearing.earthquake_case import EarthquakeCase, load_earthquake_case
    from thermobearing.errors import InputError, OutputError
    from thermobearing.identify.checks import check_test
    from thermobearing.identify.fit import Identification, identify_bearing
    from thermobearing.identify.record import TestRecord, load_test, record_from_arrays
    from thermobearing.identify.synthetic import synthetic_record
    from thermobearing.model_options import EndFace
    from thermobearing.results.earthquake_result import EarthquakeResult
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
