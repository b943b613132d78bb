"""Temperatures of a specimen after some hours in its chamber, from the soaking model.

The one place where start temperatures are made of `conditioned`: tests, temperature factors,
calibrations and the inspection of records call `soaked_start`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field

from thermobearing.bearing.ambient import Ambient
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.border.library import read_data
from thermobearing.border.schema import Strict, in_unit
from thermobearing.core.records import Floats
from thermobearing.cyclic.history import History, rest_in
from thermobearing.model.earlier import ONE_CELL
from thermobearing.model.options import BearingModel, ModelOptions, Side, build_model
from thermobearing.model.stack import EndFace
from thermobearing.tables.conditioning import PLACE, Conditioning, Temperature

HOUR = 3600.0
LONGEST = 20_000.0  # of a search; any bearing is cold through long before [h]
CLOSE = 1e-4  # of the difference between specimen and chamber: a thermocouple reads no closer
TINY = 1e-12  # for the logarithm of what has passed zero by rounding


class Chamber(Strict):
    """Content of data/surroundings/chamber.toml."""

    film: Annotated[float, in_unit("W/(m^2 K)"), Field(gt=0)]
    before: Temperature
    cover: Annotated[float, in_unit("mm"), Field(ge=0)]
    settled: Annotated[float, in_unit("K"), Field(gt=0)]
    usual: Annotated[float, in_unit("h"), Field(gt=0)]


@dataclass(frozen=True)
class SoakedStart:
    """Temperatures of a specimen when its test begins [degC]."""

    temperature: Floats  # of each cell of the model of the test, upper face first
    lead: float | None  # of the lead cores; None without
    layers: Floats  # middles of the modelled rubber layers, outer one first
    rubber: float  # mean of the rubber
    hours: float  # in the chamber, by the model: `conditioned`, or until `inside` was reached


def chamber_numbers() -> Chamber:
    """Return the film, cover and start of specimens in chambers."""
    return read_data(Chamber, "surroundings", "chamber.toml")


def filled(conditioning: Conditioning) -> Conditioning:
    """Return a conditioning with the defaults of chambers filled in."""
    defaults = {"before": chamber_numbers().before, "chamber_film": chamber_numbers().film}
    missing = {key: value for key, value in defaults.items() if getattr(conditioning, key) is None}
    return conditioning.model_copy(update=missing)


def conditioning_faults(conditioning: Conditioning, bearing: Bearing, chamber: float) -> list[str]:
    """Return what a conditioning cannot be of a bearing in a chamber at a temperature [degC]."""
    place, inside = conditioning.inside_place, conditioning.inside
    faults = []
    if place == "lead" and bearing.lead is None:
        faults.append(
            f'inside_place = "lead": needs a bearing with lead; "{bearing.name}" has none'
        )
    elif place not in (None, "lead"):
        number, count = _layer(place or ""), bearing.geometry.rubber_layers
        if number > count:
            faults.append(f'inside_place = "{place}": "{bearing.name}" has {count} rubber layers')
    before = filled(conditioning).before
    assert before is not None
    # Between the two, since the model warms or cools monotonically and never has another
    # temperature.
    low, high = sorted((before, chamber))
    if inside is not None and not low <= inside <= high:
        faults.append(
            f"inside = {inside:g} degC: must be from {low:g} to {high:g} degC, between before and "
            "the temperature of the chamber"
        )
    return faults


def _layer(place: str) -> int:
    """Return the number of a rubber layer, from 1 at the outside."""
    match = PLACE.match(place)
    assert match is not None
    return int(match[1])


def soaked_start(
    bearing: Bearing,
    conditioning: Conditioning,
    chamber: float,
    options: ModelOptions | None = None,
) -> SoakedStart:
    """Return the temperatures of a specimen after its time in a chamber.

    It comes in at a uniform temperature and loses heat through its faces and its side, by the film
    of the chamber; the rest is that of any analysis, in the conservative scheme. With a reading
    `inside` the time is that at which the model has it, so that the profile is one that the
    specimen can have, whatever the film.

    Parameters
    ----------
    bearing : the specimen.
    conditioning : `conditioned` must be given.
    chamber : temperature of the chamber [degC], constant.
    options : of the model of the test, which has the cells of the result; the default one if None.

    Raises
    ------
    InputError : a place that the bearing does not have, a reading that is not between the
        temperatures before and of the chamber.

    Examples
    --------
    >>> from thermobearing.bearing.library import load_bearing
    >>> start = soaked_start(load_bearing("lrb-example"), Conditioning(conditioned=6.0), -20.0)
    >>> -1.0 < start.rubber < 1.0
    True
    """
    if faults := conditioning_faults(conditioning, bearing, chamber):
        raise InputError(faults)
    options = (options or ModelOptions()).settled(bearing)
    conditioning = filled(conditioning)
    hours, before = conditioning.conditioned, conditioning.before
    assert hours is not None
    assert before is not None
    model = _in_chamber(bearing, conditioning, options)
    if conditioning.inside is not None:
        hours = _hours_until(model, conditioning, conditioning.inside, chamber)
    history = _soak(model, before, chamber, hours)
    temperature = history.state.temperature.copy()
    has_lead = bearing.lead is not None
    return SoakedStart(
        temperature=_cells_of_test(temperature, model, options, bearing, chamber),
        lead=float(history.state.branches["lead_temperature"][0]) if has_lead else None,
        layers=history.rows.rubber[-1].copy(),
        rubber=mean_rubber(model, temperature),
        hours=hours,
    )


def hours_to_settle(bearing: Bearing, conditioning: Conditioning, chamber: float) -> float:
    """Return the time until the mean of the rubber is within `settled` of the chamber [h]."""
    conditioning = filled(conditioning)
    assert conditioning.before is not None
    difference = abs(conditioning.before - chamber)
    tolerance = chamber_numbers().settled
    if difference <= tolerance:
        return 0.0
    # The problem is linear: a unit of difference falls by the same share as the real one.
    model = _in_chamber(bearing, conditioning, ModelOptions())
    weights = _rubber_weights(model)
    return _time_when(model, tolerance / difference, lambda history: history.rows.cells @ weights)


def mean_rubber(model: BearingModel, temperature: Floats) -> float:
    """Return the mean temperature of the rubber of a model [degC]."""
    return float(temperature @ _rubber_weights(model))


def _rubber_weights(model: BearingModel) -> Floats:
    thickness = model.stack.thickness * np.array([part == "rubber" for part in model.stack.part])
    return np.asarray(thickness / thickness.sum())


def _in_chamber(
    bearing: Bearing, conditioning: Conditioning, options: ModelOptions
) -> BearingModel:
    """Return the model of a bearing in its chamber, of half or full height as the test's."""
    film = conditioning.chamber_film
    face = EndFace(film=film)
    return build_model(
        bearing,
        ModelOptions(
            upper_face=face,
            lower_face=face,
            side=Side(film=film, cover=chamber_numbers().cover),
            stack="half" if options.half else "full",
        ),
    )


def _soak(model: BearingModel, before: float, chamber: float, hours: float) -> History:
    """Return the rest of a bearing in a chamber, with cells and middles of layers."""
    uniform = np.full(len(model.stack.part), before)
    air = Ambient.constant(chamber)
    return rest_in(model.constants, air, HOUR * hours, uniform, groups=("rubber", "cells"))


def _cells_of_test(
    temperature: Floats,
    model: BearingModel,
    options: ModelOptions,
    bearing: Bearing,
    chamber: float,
) -> Floats:
    """Return the temperatures in the cells of the test's model.

    What is behind the faces in a test has the temperature of the chamber; an earlier model with one
    cell has the mean of rubber and shims by their heat capacity.
    """
    stack = model.stack
    if options.model in ONE_CELL:
        # Its one cell is the rubber with its shims; the end plates are its ambient.
        inside = np.isin(stack.part, ("rubber", "shim"))
        return np.array([np.average(temperature[inside], weights=stack.heat_capacity[inside])])
    parts = options.build_stack(bearing).part
    cells = np.full(len(parts), chamber)
    cells[[part != "mass" for part in parts]] = temperature
    return cells


def _reading(model: BearingModel, history: History, place: str | None) -> Floats:
    """Return the temperature at the place of a thermocouple, at each step [degC]."""
    if place == "lead":
        return np.asarray(history.rows.response["lead_temperature"])
    layers = history.rows.rubber
    if place is None:
        # The last layer of a half stack is next to the middle of the bearing.
        middle = len(model.stack.multiplicity) // 2 if model.stack.fold == 1 else -1
        return np.asarray(layers[:, middle])
    number = _layer(place)
    if model.stack.fold == 2:
        # A half stack stands for both halves: a layer of the lower one is its mirror image.
        number = min(number, int(model.stack.multiplicity.sum()) + 1 - number)
    return np.asarray(layers[:, number - 1])


def _hours_until(
    model: BearingModel, conditioning: Conditioning, inside: float, chamber: float
) -> float:
    """Return the time at which the place of a thermocouple has its reading [h]."""
    before, place = conditioning.before, conditioning.inside_place
    assert before is not None
    if before == chamber:
        return conditioning.conditioned or 0.0
    part = (inside - chamber) / (before - chamber)
    return _time_when(model, part, lambda history: _reading(model, history, place))


def _time_when(model: BearingModel, part: float, followed: Callable[[History], Floats]) -> float:
    """Return when a temperature that falls from 1 to 0 degC is at a part of it [h].

    Between two steps it falls as an exponential. At the ends, which it never has, it is within
    CLOSE of them.
    """
    part, hours = min(max(part, CLOSE), 1.0 - CLOSE), 1.0
    while True:
        history = _soak(model, 1.0, 0.0, hours)
        values = followed(history)
        # The time is not known before, so the rest is doubled until it is long enough.
        if values[-1] <= part or 2.0 * hours > LONGEST:
            break
        hours *= 2.0
    times = np.asarray(history.rows.response["clock"]) / HOUR
    # Rounding near zero may raise a temperature; the interpolation needs one that falls.
    falling = np.minimum.accumulate(np.maximum(values, TINY))
    return float(np.interp(-np.log(part), -np.log(falling), times))
