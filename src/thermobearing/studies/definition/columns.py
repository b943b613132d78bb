"""Columns of the plan of a study, and the allowed ranges of their numbers."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermobearing.bearing.ambient import COLDEST, HOTTEST
from thermobearing.border.errors import InputError
from thermobearing.border.schema import Strict, validated
from thermobearing.core.records import Floats
from thermobearing.studies.definition.distributions import Distribution
from thermobearing.studies.definition.factors import (
    MotionFactor,
    Picked,
    Posterior,
    list_numbers,
    probabilities,
)
from thermobearing.studies.definition.record import Study
from thermobearing.studies.definition.targets import Target, find_target, value_at, with_numbers

Ints = NDArray[np.int64]
THINGS = ("structure", "bearing", "motion")
AMBIENT, HOUR = "ambient_degC", "hour"
SAMPLE = "bearing.sample"  # number of a sample of a posterior, -1 of a bearing without


@dataclass(frozen=True)
class Column:
    """One factor.

    Attributes
    ----------
    name : of the column.
    levels : names of things, or numbers; none of a distribution.
    distribution : of a number.
    chances : of each level, where one is drawn by lot; None where all are met.
    share : a number in [0, 1) that says which sample, or which hour of the weather.
    """

    name: str
    levels: Sequence[str] | Sequence[float] = ()
    distribution: Distribution | None = None
    chances: Sequence[float] | None = None
    share: bool = False

    @property
    def drawn(self) -> bool:
        """Whether each sample draws it; else its levels meet those of all others."""
        return self.share or self.distribution is not None or self.chances is not None

    @property
    def count(self) -> int:
        """Number of levels."""
        return len(self.levels)

    def of(self, places: Ints) -> Any:
        """Numbers at places of the levels; the places themselves where levels are things."""
        if self.levels and isinstance(self.levels[0], str):
            return places
        return np.array(self.levels, dtype=np.float64)[places]

    def at(self, probability: Floats) -> Any:
        """The same at probabilities, for a factor that is drawn."""
        if self.share:
            return probability
        if self.distribution is not None:
            return self.distribution.at(probability)
        ends: Floats = np.cumsum(np.array(self.chances))[:-1]
        return self.of(np.searchsorted(ends, probability, side="right"))


def list_columns(study: Study) -> list[Column]:
    """Columns of a study: things first, then numbers, those with dotted names last."""
    factors = study.factors
    columns = []
    for name in THINGS:
        factor = getattr(factors, name)
        motions = isinstance(factor, MotionFactor)
        names = factor.names if motions else [str(one.name) for one in factor.levels]
        columns.append(Column(name, names, chances=_chances(factor, len(names))))
        if name == "bearing" and any(isinstance(one, Posterior) for one in factor.levels):
            columns.append(Column(SAMPLE, share=True))
    columns.append(_number(factors.scale, "scale", factors.scale.unit, "factors.scale"))
    if factors.ambient.hourly:
        columns.append(Column(HOUR, share=True))
    else:
        columns.append(_number(factors.ambient, AMBIENT, "degC", "factors.ambient"))
    for target in list_targets(study):
        unit = target.unit if target.of == "value" else None
        number = factors.numbers[target.name]
        columns.append(_number(number, target.name, unit, f"factors.{target.name}"))
    return columns


def list_targets(study: Study) -> list[Target]:
    """Where the dotted names of a study lead; of a posterior, in the bearing that it is of.

    Raises
    ------
    InputError : a name that leads nowhere.
    """
    levels = _levels_by_part(study)
    return [find_target(name, one.of, levels) for name, one in study.factors.numbers.items()]


def _levels_by_part(study: Study) -> dict[str, list[Strict]]:
    """The records whose numbers have dotted names, by the first part of the name."""
    bearings = study.factors.bearing.levels
    return {
        "bearing": [one.bearing if isinstance(one, Posterior) else one for one in bearings],
        "structure": list(study.factors.structure.levels),
        "case": [study.case],
    }


def _chances(factor: Picked, count: int) -> list[float] | None:
    return probabilities(factor.weights, count) if factor.random else None


def _number(factor: Any, name: str, unit: str | None, key: str) -> Column:
    """Column of a factor that is a number."""
    found = list_numbers(factor, unit, key)
    if isinstance(found, Distribution):
        return Column(name, distribution=found)
    return Column(name, found, chances=_chances(factor, len(found)))


LARGEST_SCALE = 1000.0
CUT = "; cut it off with low and high, or take a narrower one"


def reach_faults(study: Study) -> list[str]:
    """What is wrong with the numbers that a study may meet, one run in a million included."""
    ends: dict[str, tuple[float, float]] = {}
    drawn: dict[str, str] = {}
    for column in list_columns(study):
        if column.distribution is not None:
            ends[column.name] = column.distribution.reach
            drawn[column.name] = f"a {column.distribution.kind} distribution "
        elif column.levels and not isinstance(column.levels[0], str):
            numbers = np.array(column.levels, dtype=np.float64)
            ends[column.name] = float(numbers.min()), float(numbers.max())
    return _faults(study, ends, drawn)


def check_numbers(study: Study, numbers: Mapping[str, Floats]) -> None:
    """InputError where drawn numbers, by name of their column, leave what is allowed."""
    ends = {}
    for name, values in numbers.items():
        known = values[~np.isnan(values)]
        if len(known):
            ends[name] = float(known.min()), float(known.max())
    found = _faults(study, ends, {})
    if found:
        raise InputError(found)


def _faults(
    study: Study, ends: Mapping[str, tuple[float, float]], drawn: Mapping[str, str]
) -> list[str]:
    """Faults of the smallest and the largest number of each column."""
    faults = []
    scale = study.factors.scale
    top = LARGEST_SCALE
    for name, low, high, unit in (
        ("scale", 0.0, top, scale.unit or ""),
        (AMBIENT, COLDEST, HOTTEST, "degC"),
    ):
        if name not in ends:
            continue
        smallest, largest = ends[name]
        wrong = smallest if smallest < low or (smallest == low == 0.0) else largest
        if smallest < low or largest > high or (name == "scale" and smallest <= 0.0):
            key = "scale" if name == "scale" else "ambient"
            least = "greater than 0 and at most" if name == "scale" else f"{low:g} to"
            faults.append(
                f"factors.{key}: {_reaches(drawn, name)}{wrong:g} {unit}".rstrip()
                + f": must be {least} {high:g} {unit}".rstrip()
                + (CUT if name in drawn else "")
            )
    records = _levels_by_part(study)
    for target in list_targets(study):
        if target.name in ends:
            faults += _target_faults(target, records[target.part], ends[target.name], drawn)
    return faults


def _reaches(drawn: Mapping[str, str], name: str) -> str:
    """Words for where a number comes from."""
    return f"{drawn[name]}reaches " if name in drawn else ""


def _target_faults(
    target: Target, records: list[Any], ends: tuple[float, float], drawn: Mapping[str, str]
) -> list[str]:
    """What is wrong with a bearing, a structure or a case that has the number."""
    for level, record in enumerate(records):
        path = target.paths[level]
        if path is None:
            continue
        for number in ends:
            made = with_numbers(record, target.change(level, record, number))
            found = _wrong(made)
            if found:
                what = f"{number:g} of it" if target.of == "factor" else f"{number:g}"
                said = f"factors.{target.name}: {_reaches(drawn, target.name)}{what}: "
                more = "" if target.of == "value" else f" (it is {value_at(record, path):g})"
                return [f"{said}{found}{more}{CUT if target.name in drawn else ''}"]
    return []


def _wrong(record: Strict) -> str:
    """What keeps a record from being one; nothing if it is."""
    try:
        validated(type(record), record.model_dump(), "", from_file=False)
    except InputError as error:
        return "; ".join(error.problems)
    return ""
