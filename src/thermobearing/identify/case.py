"""Input of a calibration: tests, bearing, free parameters and search options."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypedDict, get_args

from thermobearing.bearing.exposure import effective_exposure
from thermobearing.bearing.library import as_bearing, load_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, nearest, shortened
from thermobearing.border.units import is_number
from thermobearing.identify.records.record import TestRecord, load_test
from thermobearing.identify.uncertainty.covariance import chosen_groups

Method = Literal["least-squares", "krill-herd", "differential-evolution"]
Loss = Literal["linear", "soft_l1", "huber", "cauchy"]
Test = TestRecord | str | Path

MOST_STARTS, MOST_EVALUATIONS, LARGEST_SEED = 100, 1_000_000, 2**32 - 1
SEARCH = 2000  # evaluations of krill herd and differential evolution


@dataclass(frozen=True)
class IdentifyCase:
    """Input of a calibration; see `identify_bearing`."""

    records: list[TestRecord]  # of one bearing, at least one
    bearing: Bearing  # geometry and materials, and the values of what is not free
    free: Sequence[str] | None = None  # keys, symbols and ties; None for the default ones
    bounds: dict[str, tuple[float, float]] | None = None  # by key or symbol, in its unit
    method: Method = "least-squares"
    seed: int = 0  # 0 to 4294967295
    starts: int = 3  # of least squares, 1 to 100
    loss: Loss = "linear"
    temperatures: bool = False
    blind: bool = True
    polish: bool = True
    evaluations: int = SEARCH  # 1 to a million
    assumed: Mapping[str, float] | None = None  # relative standard uncertainties
    accept_poor: bool = False
    one_temperature: bool = False


class IdentifyKeywords(TypedDict, total=False):
    """Options of `IdentifyCase` as keyword arguments."""

    free: Sequence[str] | None
    bounds: dict[str, tuple[float, float]] | None
    method: Method
    seed: int
    starts: int
    loss: Loss
    temperatures: bool
    blind: bool
    polish: bool
    evaluations: int
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
    several = [records] if isinstance(records, TestRecord | str | Path) else list(records)
    if not several:
        raise InputError("give at least one test")
    base = as_bearing(bearing)
    found = [item if isinstance(item, TestRecord) else load_test(item) for item in several]
    case = IdentifyCase(
        records=[record.of_bearing(base) for record in found], bearing=base, **options
    )
    if effective_exposure(case.bearing, None) is not None:
        raise InputError(
            f"{case.bearing.name} has the table exposure, whose factors would be contained in the "
            "calibrated parameters. Remove the table, calibrate, and add it to the calibrated "
            "bearing"
        )
    choices = (("method", case.method, get_args(Method)), ("loss", case.loss, get_args(Loss)))
    for name, value, known in choices:
        if value not in known:
            raise InputError(f'{name} = "{value}": {nearest(value, known).removeprefix("; ")}')
    numbers = (("starts", MOST_STARTS, 1), ("evaluations", MOST_EVALUATIONS, 1))
    for name, most, least in (*numbers, ("seed", LARGEST_SEED, 0)):
        value = getattr(case, name)
        if not isinstance(value, int) or isinstance(value, bool) or not least <= value <= most:
            said = shortened(str(value)) if is_number(value) else "that"
            raise InputError(f"{name} = {said}: must be an integer from {least} to {most}")
    chosen_groups(case.assumed)
    return case


def find_bearing(records: Sequence[TestRecord], start: str | None = None) -> Bearing | None:
    """Return the bearing that the tests belong to."""
    names = {record.bearing for record in records if record.bearing}
    if start is None and len(names) > 1:
        raise InputError(f"the tests name several bearings ({', '.join(sorted(names))})")
    chosen = start or next(iter(names), None)
    return load_bearing(chosen) if chosen else None
