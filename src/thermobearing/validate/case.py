"""A validation as data: bearings as they are, tests, models, and the limits of the verdicts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import get_args

from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, nearest
from thermobearing.border.units import is_number
from thermobearing.identify.records.record import TestRecord, load_test
from thermobearing.model.earlier import Model
from thermobearing.model.options import ModelOptions

Test = TestRecord | str | Path
Chosen = Bearing | str | Path

# What can be judged; all of them relative errors but NRMSE, which is one of the largest force.
QUANTITIES = {
    "K_eq": "equivalent stiffness",
    "h_eq": "equivalent damping ratio",
    "energy": "energy of a cycle",
    "force": "peak force of a cycle, either side",
    "temperature": "temperature rise, Eq. 4.39",
    "NRMSE": "root mean square error of the force",
}
# Those of the source: 15 % on stiffness and damping (section 4.4.2).
LIMITS = {"K_eq": 0.15, "h_eq": 0.15}
LARGEST_LIMIT = 10.0


@dataclass(frozen=True)
class ValidateCase:
    """Everything a validation needs; see `make_validate_case`.

    Attributes
    ----------
    bearings : one or more, as they are.
    records : tests of any history, at least one.
    models : models to run each bearing with.
    limits : largest relative error by quantity; what has none is told without a verdict.
    """

    bearings: list[Bearing]
    records: list[TestRecord]
    models: list[Model] = field(default_factory=lambda: ["multi-layer"])
    limits: dict[str, float] = field(default_factory=lambda: dict(LIMITS))


def make_validate_case(
    bearings: Sequence[Chosen] | Chosen,
    records: Sequence[Test] | Test,
    *,
    models: Sequence[Model] | Model = "multi-layer",
    limits: Mapping[str, float] | None = None,
) -> ValidateCase:
    """A checked case of a validation.

    `bearings`: one or more: a Bearing, a library name, or a TOML file; `records`: one or more
    tests: from `load_test`, `record_from_arrays`, or paths; `models`: "multi-layer" and earlier
    models; each bearing has those that fit it; `limits`: largest relative error by quantity
    (`QUANTITIES`), in (0, 10]; they are added to the usual ones, 0.15 for K_eq and h_eq.

    >>> import numpy as np
    >>> from thermobearing.identify.records.record import record_from_arrays
    >>> t = np.linspace(0.0, 10.0, 200)
    >>> record = record_from_arrays(t, np.sin(t), 2.0 * np.sin(t), 23.0)
    >>> make_validate_case("shen-hdr-specimen", record, limits={"energy": 0.2}).limits
    {'K_eq': 0.15, 'h_eq': 0.15, 'energy': 0.2}
    """
    some = [bearings] if isinstance(bearings, Bearing | str | Path) else list(bearings)
    tests = [records] if isinstance(records, TestRecord | str | Path) else list(records)
    wanted: list[Model] = [models] if isinstance(models, str) else list(models)
    for what, given in (("bearing", some), ("test", tests), ("model", wanted)):
        if not given:
            raise InputError(f"give at least one {what}")
    for model in wanted:
        if model not in get_args(Model):
            raise InputError(f'model = "{model}"{nearest(model, get_args(Model))}')
    return ValidateCase(
        bearings=[as_bearing(item) for item in some],
        records=[item if isinstance(item, TestRecord) else load_test(item) for item in tests],
        models=list(dict.fromkeys(wanted)),
        limits=dict(LIMITS) | checked_limits(limits or {}),
    )


def checked_limits(limits: Mapping[str, float]) -> dict[str, float]:
    """Limits that can be: known quantities, more than 0 and at most 10."""
    for name, value in limits.items():
        if name not in QUANTITIES:
            raise InputError(f'limit of "{name}"{nearest(name, QUANTITIES)}')
        if not is_number(value) or not 0.0 < value <= LARGEST_LIMIT:
            raise InputError(
                f"limit of {name} = {value!r}: must be a relative error, more than 0 and at most "
                f"{LARGEST_LIMIT:g} (0.15 is 15 %)"
            )
    return {name: float(value) for name, value in limits.items()}


def possible_models(case: ValidateCase, bearing: Bearing) -> list[Model]:
    """Those of the case that a bearing can have: `lead-alone` needs lead.

    `case`: from `make_validate_case`; `bearing`: one of the case.
    """
    found = [model for model in case.models if not ModelOptions(model=model).misfits(bearing)]
    if not found:
        raise InputError(f'model "{case.models[0]}" needs lead, which {bearing.name} has not')
    return found
