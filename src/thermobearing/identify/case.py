"""Input of a calibration: tests, bearing, free parameters and search options."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, TypedDict, get_args

from thermobearing.bearing.exposure import effective_exposure
from thermobearing.bearing.library import as_bearing, load_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, nearest, shortened
from thermobearing.border.units import is_number
from thermobearing.core.records import Floats
from thermobearing.identify.records.record import TestRecord, load_test
from thermobearing.identify.uncertainty.groups import chosen_groups

# Takes the objective over the unit cube of parameters, and the start in it; returns the best point.
Search = Callable[[Callable[[Floats], float], Floats], Floats]
Loss = Literal["linear", "soft_l1", "huber", "cauchy"]
StartFrom = Literal["loops", "bearing"]
Test = TestRecord | str | Path

MOST_STARTS, LARGEST_SEED = 100, 2**32 - 1


@dataclass(frozen=True)
class IdentifyCase:
    """Input of a calibration; see `identify_bearing`.

    Attributes
    ----------
    records : tests of one bearing, at least one.
    bearing : geometry and materials, and the values of what is not free.
    free : parameters to calibrate, such as K_r,d_y or n_T=2.4*m_T.
    bounds : replacements of default bounds, by key or symbol, in the unit of the parameter.
    search : function in place of least squares from several starts.
    seed : seed of all random numbers, 0 to 4294967295; 0 by default.
    starts : number of starting points of least squares, 1 to 100; 3 by default.
    loss : loss function: "linear" (default), "soft_l1", "huber" or "cauchy".
    temperatures : also calibrate to the measured temperatures.
    start_from : starting values of the free parameters: "loops" (default), estimates from the
        measured loops, or "bearing", the values of the bearing.
    polish : finish with least squares (default).
    assumed : relative standard uncertainty of a parameter that is not calibrated, such as
        materials.side_film=0.1 or sigma_Y=0.
    accept_poor : write the bearing of a poor calibration (status 4) as a usable one.
    one_temperature : calibrate m_T and n_T even if all tests have the same temperature.
    """

    records: list[TestRecord]
    bearing: Bearing
    free: Sequence[str] | None = None
    bounds: dict[str, tuple[float, float]] | None = None
    search: Search | None = None
    seed: int = 0
    starts: int = 3
    loss: Loss = "linear"
    temperatures: bool = False
    start_from: StartFrom = "loops"
    polish: bool = True
    assumed: Mapping[str, float] | None = None
    accept_poor: bool = False
    one_temperature: bool = False


class IdentifyKeywords(TypedDict, total=False):
    """Options of `IdentifyCase` as keyword arguments: a test compares names and types."""

    free: Sequence[str] | None
    bounds: dict[str, tuple[float, float]] | None
    search: Search | None
    seed: int
    starts: int
    loss: Loss
    temperatures: bool
    start_from: StartFrom
    polish: bool
    assumed: Mapping[str, float] | None
    accept_poor: bool
    one_temperature: bool


def make_identify_case(
    records: Sequence[Test] | Test, bearing: Bearing | str | Path, **options: Any
) -> IdentifyCase:
    """Return a checked case of a calibration.

    `records`: one or more tests: from `load_test`, `record_from_arrays`, or paths; `bearing`: a
    Bearing, a library name, or a TOML file; `options`: the other attributes of `IdentifyCase`, each
    with its default.
    """
    sources = [records] if isinstance(records, TestRecord | str | Path) else list(records)
    if not sources:
        raise InputError("give at least one test")
    base = as_bearing(bearing)
    tests = [item if isinstance(item, TestRecord) else load_test(item) for item in sources]
    tests = [record.of_bearing(base) for record in _with_distinct_names(tests)]
    case = IdentifyCase(records=tests, bearing=base, **options)
    # The tests contain the ageing already; factors on top of it would count it twice.
    if effective_exposure(case.bearing, None) is not None:
        raise InputError(
            f"{case.bearing.name} has the table exposure, whose factors would be contained in the "
            "calibrated parameters. Remove the table, calibrate, and add it to the calibrated "
            "bearing"
        )
    for name, choices in (("loss", get_args(Loss)), ("start_from", get_args(StartFrom))):
        choice = getattr(case, name)
        if choice not in choices:
            raise InputError(f'{name} = "{choice}": {nearest(choice, choices).removeprefix("; ")}')
    if case.search is not None and not callable(case.search):
        raise InputError("search: give a function of the objective and the start, or None")
    for name, upper, lower in (("starts", MOST_STARTS, 1), ("seed", LARGEST_SEED, 0)):
        value = getattr(case, name)
        if not isinstance(value, int) or isinstance(value, bool) or not lower <= value <= upper:
            shown = shortened(str(value)) if is_number(value) else "that"
            raise InputError(f"{name} = {shown}: must be an integer from {lower} to {upper}")
    chosen_groups(case.assumed)
    return case


def find_bearing(records: Sequence[TestRecord], start: str | None = None) -> Bearing | None:
    """Return the bearing that the tests belong to.

    Parameters
    ----------
    start : bearing with geometry, materials and fixed parameters.
    """
    names = {record.bearing for record in records if record.bearing}
    if start is None and len(names) > 1:
        raise InputError(f"the tests name several bearings ({', '.join(sorted(names))})")
    name = start or next(iter(names), None)
    return load_bearing(name) if name else None


def _with_distinct_names(records: list[TestRecord]) -> list[TestRecord]:
    """Return tests of which those with one name have their folder before it: "cold-history"."""
    counts = Counter(record.name for record in records)
    return [
        replace(record, name=f"{Path(record.file).parent.name}-{record.name}")
        if counts[record.name] > 1 and Path(record.file).parent.name
        else record
        for record in records
    ]
