"""Numbers of a study where a bearing, a structure or a case may have none: told before any run."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from thermobearing.bearing.ambient import COLDEST, HOTTEST
from thermobearing.border.errors import InputError
from thermobearing.border.schema import Strict, validated
from thermobearing.core.records import Floats
from thermobearing.studies.columns import AMBIENT, columns_of, levels_by_part, targets_of
from thermobearing.studies.names import Target, value_at, with_numbers
from thermobearing.studies.record import Study

LARGEST_SCALE = 1000.0
CUT = "; cut it off with low and high, or take a narrower one"


def reach_faults(study: Study) -> list[str]:
    """What is wrong with the numbers that a study may meet, one run in a million included."""
    ends: dict[str, tuple[float, float]] = {}
    drawn: dict[str, str] = {}
    for column in columns_of(study):
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
    records = levels_by_part(study)
    for target in targets_of(study):
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
