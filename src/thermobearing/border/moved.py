"""Names that were at the top of the package, and the rooms where they are now."""

import warnings
from importlib import import_module
from typing import Any

UNTIL = "0.3"  # the version that forgets the old places
ROOMS = {
    "Bearing": "bearing",
    "BilinearBearing": "bearing",
    "Case": "cyclic",
    "CyclicTest": "cyclic",
    "EarthquakeCase": "earthquake",
    "EarthquakeResult": "earthquake",
    "EndFace": "model",
    "GroundMotion": "motions",
    "Identification": "identify",
    "Result": "cyclic",
    "TestRecord": "identify",
    "baseline_corrected": "motions",
    "bound_models": "design",
    "bounds_study": "design",
    "check_test": "identify",
    "equal_bearing": "design",
    "list_bearings": "bearing",
    "list_motions": "motions",
    "list_structures": "structure",
    "load_bilinear": "bearing",
    "load_design_case": "design",
    "load_earthquake_case": "earthquake",
    "load_structure": "structure",
    "make_design_case": "design",
    "make_motion": "motions",
    "match_spectrum": "motions",
    "measure_cycle": "results",
    "measure_history": "results",
    "measure_motion": "motions",
    "read_columns": "border",
    "read_motion": "motions",
    "record_from_arrays": "identify",
    "resampled": "motions",
    "response_spectrum": "motions",
    "run_case": "cyclic",
    "run_design": "design",
    "run_earthquake": "earthquake",
    "scale_study": "design",
    "scaled_bearing": "design",
    "standard_spectrum": "motions",
    "synthetic_record": "identify",
}


def found(name: str) -> Any:
    """What was at the top under this name, with a warning that tells the new place."""
    room = f"thermobearing.{ROOMS[name]}"
    warnings.warn(
        f"thermobearing.{name} is now {room}.{name}; the old place goes with version {UNTIL}",
        DeprecationWarning,
        stacklevel=3,
    )
    return getattr(import_module(room), name)
