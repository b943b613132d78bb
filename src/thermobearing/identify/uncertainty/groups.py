"""Numbers of a bearing or of its tests that a calibration assumes, in groups with a common error.

Each has a standard uncertainty, in data/identify/assumed.toml; a mistake has the size of a usual
one. Records and bearings whose numbers are changed by it show what the tests say about it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from pydantic import Field, model_validator

from thermobearing.bearing.cells import Cells
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, nearest
from thermobearing.border.library import read_data
from thermobearing.border.schema import Strict
from thermobearing.border.units import is_number
from thermobearing.cyclic.conditioning import filled
from thermobearing.identify.fit import parameters as kinds
from thermobearing.identify.records.cycles import dead_band, estimate_noise, turning_points
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.records.temperatures import measured_start, start_differences

LARGEST_SPREAD = 2.0  # relative standard uncertainty
NORMAL_FREEDOM = 10**6  # degrees of freedom with which Student's distribution is the normal one
LEVEL = 0.95
AMBIENT, TURNS, FORCE, CONDITIONING = "ambient", "turns", "force", "conditioning"
CHAMBER = "chamber_film"  # of tests that state how long their specimen was in the chamber
# Mistakes in the signals of each test, relative to the peak of the signal, and one in its clock.
DRIFT, ZERO, ZERO_DRIFT = "force_drift", "displacement_offset", "displacement_drift"
DELAY = "force_delay"
OF_EACH_TEST = (DRIFT, ZERO, ZERO_DRIFT)
OF_TESTS = (AMBIENT, TURNS, FORCE, CONDITIONING, CHAMBER, *OF_EACH_TEST, DELAY)
CELLS = "cells"
STATE = "{state}"  # in a cause: cold or warm, as the chamber of a specimen that is not yet so
PERCENT = 100.0  # of the peak of a signal
FINER = 2  # times more heat cells than in a bearing that has enough


def half_interval(freedom: float) -> float:
    """Return half a 95 % interval over its standard error, by Student's distribution."""
    from scipy.stats import t as student

    return float(student.ppf(0.5 + 0.5 * LEVEL, max(freedom, 2)))


def widening(freedom: float) -> float:
    """Return the ratio of a 95 % interval with few degrees of freedom to that of a normal error.

    Intervals and draws of the posterior contain this one factor, so that 95 % of the draws of a
    parameter are its interval.
    """
    return half_interval(freedom) / half_interval(NORMAL_FREEDOM)


class Group(Strict):
    """Numbers of a bearing with a common error."""

    name: str  # or the symbol of a parameter
    keys: list[str]  # dotted keys of a bearing
    relative: float | None = None  # standard uncertainty over the value, or
    absolute: float | None = None  # in the unit of the key
    source: str
    note: str = ""
    unit: str = ""  # of `absolute`; empty where the key says it
    # Degrees of freedom (JCGM 100:2008, G.4.2): how well the uncertainty itself is known.
    freedom: float = Field(default=NORMAL_FREEDOM, gt=0.0)
    cause: str = ""  # another reason for which tests require another value
    mistake: bool = False  # no uncertainty, but a suspect where residuals are not noise
    at: float | None = None  # of the tests at this ambient temperature only [degC]
    # Start of the thermocouples of these tests above that of the model [K]; None without any, or
    # where the difference is that of a sensor.
    measured: float | None = None

    @model_validator(mode="after")
    def _one_uncertainty(self) -> "Group":
        if (self.relative is None) == (self.absolute is None):
            raise ValueError("needs relative or absolute, one of them")
        return self

    def step(self, value: float) -> float:
        """Return the standard uncertainty of a value, in its unit."""
        return self.absolute if self.absolute is not None else (self.relative or 0.0) * abs(value)

    def moved(self, key: str, value: float, sigmas: float) -> float:
        """Return the value of a key, changed by `sigmas` standard uncertainties.

        Relative uncertainties are those of the logarithm, so that a number keeps its sign; a
        parameter stays within the bounds of its search, which no bearing may leave.
        """
        if self.absolute is None:
            changed = value * float(np.exp(sigmas * (self.relative or 0.0)))
        else:
            changed = value + sigmas * self.absolute
        kind = kinds.KINDS.get(key)
        if kind is None or kind.relative:
            return changed
        return min(max(changed, min(kind.lower, value)), max(kind.upper, value))

    @property
    def key(self) -> str:
        """The first of its keys."""
        return self.keys[0]

    @property
    def of_tests(self) -> bool:
        """Whether the numbers are of the tests, and none of the bearing."""
        return self.key in OF_TESTS

    @property
    def widening(self) -> float:
        """Factor on its uncertainty, by which 95 % of a normal distribution are a 95 % interval."""
        return widening(self.freedom)


class Groups(Strict):
    """Content of data/identify/assumed.toml."""

    groups: list[Group]


def chosen_groups(assumed: Mapping[str, float] | None) -> tuple[Group, ...]:
    """Return the default uncertainties, some of them replaced.

    `given` holds relative standard uncertainties in [0, 2] by the name of a group or a key of one;
    that of "ambient" is in K.
    """
    groups = list(read_data(Groups, "identify", "assumed.toml").groups)
    for name, value in (assumed or {}).items():
        places = [i for i, g in enumerate(groups) if name == g.name or name in g.keys]
        if not places:
            names = [word for group in groups for word in (group.name, *group.keys)]
            raise InputError(f'assumed: there is no number "{name}"{nearest(name, names)}')
        if not (is_number(value) and 0.0 <= value <= LARGEST_SPREAD):
            requirement = "must be a relative standard uncertainty, 0 to"
            raise InputError(f"assumed: {name} = {value!r} {requirement} {LARGEST_SPREAD:g}")
        attribute = "absolute" if groups[places[0]].keys == [AMBIENT] else "relative"
        change: dict[str, Any] = {"relative": None, "absolute": None, attribute: float(value)}
        change |= {"source": "given", "note": ""}
        groups[places[0]] = groups[places[0]].model_copy(update=change)
    return tuple(groups)


def shift(bearing: Bearing, group: Group, sigmas: float) -> Bearing:
    """Return a bearing whose numbers of a group are changed by `sigmas` standard uncertainties."""
    if group.key == CELLS:
        return bearing.model_copy(update={"cells": _other_cells(bearing)})
    values = {key: kinds.dotted_value(bearing, key) for key in group.keys}
    numbers = {key: value for key, value in values.items() if value is not None}
    return kinds.with_values(
        bearing, {key: round(group.moved(key, v, sigmas), 12) for key, v in numbers.items()}
    )


def _other_cells(bearing: Bearing) -> Cells:
    """Return a finer division into heat cells: enough where it is coarse, else twice as many.

    What the calculation changes with it is its error by the cells.
    """
    cells, enough = bearing.cells, bearing.cells.enough()
    if cells != enough:
        return enough
    counts = {name: FINER * getattr(cells, name) for name in ("rubber", "shim")}
    return cells.model_copy(update=counts)


def groups_of_tests(records: Sequence[TestRecord], groups: Sequence[Group]) -> list[Group]:
    """Return the systematic errors of the tests.

    Tests at the same temperature share its error: they had one chamber and thermometer.
    """
    errors = []
    stated = any(record.conditioning is not None for record in records)
    for group in groups:
        # A film of the chamber acts on computed soaking only.
        if group.keys[0] == CHAMBER and not stated:
            continue
        if group.keys[0] not in (AMBIENT, CONDITIONING):
            errors += [group] if group.of_tests else []
            continue
        for ambient in dict.fromkeys(record.ambient for record in records):
            name = f"{group.name} of {ambient:.4g} degC"
            starts = [d for r in records if r.ambient == ambient for _, d in start_differences(r)]
            update: dict[str, Any] = {"name": name, "at": ambient}
            update["measured"] = measured_start(starts)
            if group.keys[0] == AMBIENT:
                steps = [_kelvin(r, group) for r in records if r.ambient == ambient]
                update["absolute"] = max(steps)
            errors.append(group.model_copy(update=update))
    return errors


def _kelvin(record: TestRecord, group: Group) -> float:
    """Return the standard uncertainty of the ambient temperature of a test [K]."""
    stated = record.ambient_uncertainty
    return group.step(0.0) if stated is None else stated


def moved_record(record: TestRecord, group: Group, sigmas: float) -> TestRecord:
    """Return a test, changed by some standard uncertainties of a systematic error."""
    key = group.keys[0]
    if key == AMBIENT:
        if record.ambient != group.at:
            return record
        return replace(record, ambient=record.ambient + sigmas * _kelvin(record, group))
    if key == CONDITIONING:
        if record.ambient != group.at:
            return record
        return replace(record, start_offset=record.start_offset + sigmas * group.step(0.0))
    if key == CHAMBER:
        if record.conditioning is None:
            return record
        film = filled(record.conditioning).chamber_film or 0.0
        moved = {"chamber_film": group.moved(key, film, sigmas)}
        return replace(record, conditioning=record.conditioning.model_copy(update=moved))
    if key == TURNS:  # less far out, by the uncertainty from the noise
        x, displacement = record.displacement, record.displacement.copy()
        reversals = turning_points(x, dead_band(x))[1:-1]
        displacement[reversals] -= (
            sigmas * group.step(estimate_noise(x)) * np.sign(x[reversals] - x[reversals - 1])
        )
        return replace(record, displacement=displacement)
    if key in OF_EACH_TEST:
        name = "force" if key == DRIFT else "displacement"
        values = getattr(record, name)
        size = sigmas * group.step(1.0) / PERCENT * float(np.abs(values).max())
        span = float(record.time[-1] - record.time[0])
        course = 1.0 if key == ZERO else (record.time - record.time[0]) / span
        return replace(record, **{name: values - size * course})
    return replace(record, force=(1.0 + sigmas * group.step(1.0)) * record.force)
