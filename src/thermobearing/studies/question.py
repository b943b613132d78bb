"""Post-processing options of a parameter study (question.toml)."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import tomli_w
from pydantic import Field, PrivateAttr

from thermobearing.border.errors import InputError
from thermobearing.border.opener import is_file
from thermobearing.border.schema import Strict, in_unit, validated
from thermobearing.border.text_file import write_file
from thermobearing.border.toml import read_toml, to_table
from thermobearing.border.units import parse_quantity, with_unit
from thermobearing.climate.generator import CLIMATES
from thermobearing.climate.site import as_weather
from thermobearing.studies.definition.record import INTENSITY_UNITS
from thermobearing.studies.statistics.demand import COMPUTED, Failed
from thermobearing.studies.statistics.fragility import Method
from thermobearing.studies.statistics.hazard import Hazard, load_hazard

QUESTION = "question.toml"
Rates = tuple[Annotated[float, in_unit("1/year"), Field(gt=0)], ...]
Periods = tuple[Annotated[float, in_unit("year"), Field(gt=0)], ...]


class SiteHazard(Strict):
    """Hazard curve of a site in a file.

    Attributes
    ----------
    measure : intensity measure: "PGA", "PGV" or "Sa".
    intensity : increasing, as text with units.
    rate : annual rate of exceedance, decreasing [1/year]; or
    return_period : increasing [year].
    """

    measure: Annotated[str, Field(pattern="^(PGA|PGV|Sa)$")] = "PGA"
    intensity: tuple[str, ...]
    rate: Rates | None = None
    return_period: Periods | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        stated_keys = [name for name in ("rate", "return_period") if name in values]
        return [] if len(stated_keys) == 1 else ["give rate, or return_period"]

    def _curve(self) -> Hazard:
        unit = INTENSITY_UNITS[self.measure]
        intensity = [parse_quantity(text, unit) for text in self.intensity]
        rate = self.rate or [1.0 / period for period in self.return_period or ()]
        return Hazard(np.array(intensity), np.array(rate), self.measure)


class Question(Strict):
    """Post-processing options of a study, as in `question.toml`.

    Attributes
    ----------
    demand : demand parameter, a column of the table; by default pier ductility, or the first
        demand that exists.
    capacity : capacity in the unit of the demand; without it there is no fragility and no rate.
    method : method of the fragility: "stripes", "ida" or "cloud".
    failed : failed runs count with the demand that was "computed" (default), are "left-out", or
        count as "collapse".
    hazard : hazard curve of the site, or its file; without it there are no rates.
    weather : hourly weather of the site, a file or a climate: the share of the time of each
        rubber temperature, for studies whose temperatures are levels.
    """

    demand: str | None = None
    capacity: Annotated[float, Field(gt=0)] | None = None
    method: Method = "stripes"
    failed: Failed = COMPUTED
    hazard: SiteHazard | None = None
    weather: str | None = None
    # Hourly weather, or rubber temperatures at equally probable times [degC].
    _temperatures: Any = PrivateAttr(default=None)
    _rubber: dict[tuple[str, ...], Any] = PrivateAttr(default_factory=dict)  # by bearings

    @property
    def temperatures(self) -> Any:
        """Hourly weather of the site, read once; None without a climate."""
        if self._temperatures is None and self.weather is not None:
            self._temperatures = as_weather(self.weather)
        return self._temperatures


def _make_question(table: Mapping[str, Any], where: str, folder: Path = Path()) -> Question:
    """Return checked options of a file or of the command line, where None means not given."""
    options = {name: value for name, value in table.items() if value is not None}
    hazard, weather = options.get("hazard"), options.get("weather")
    if isinstance(hazard, str):
        options["hazard"] = _hazard_table(folder / hazard)
    if isinstance(weather, str) and weather not in CLIMATES.names():
        options["weather"] = str((folder / weather).resolve())
    question = validated(Question, options, where)
    try:
        if question.hazard is not None:
            question.hazard._curve()
        question.temperatures  # noqa: B018 - the file is read here
    except InputError as error:
        raise InputError(error.lines(), where) from None
    return question


def _hazard_table(path: Path) -> dict[str, Any]:
    faults = []
    for measure, unit in INTENSITY_UNITS.items():
        try:
            curve = load_hazard(path, measure)
        except InputError as error:
            faults.append(error)
            continue
        return {
            "measure": measure,
            "intensity": [with_unit(x, unit) for x in curve.intensity],
            "rate": [with_unit(x, "1/year") for x in curve.rate],
        }
    # Most files have the column of one measure: what is wrong with it says more than that those of
    # the others are missing.
    unreadable = [error for error in faults if "no column" not in str(error)]
    fault = (unreadable or faults)[0]
    if unreadable and "cannot be converted" not in str(fault):
        raise fault
    heads = " or ".join(f"{measure} [{unit}]" for measure, unit in INTENSITY_UNITS.items())
    first, *others = fault.problems
    # The measure that was tried first is not the one that the file should have.
    first = re.sub(r'no column "[^"]*"', "no column of an intensity", first, count=1)
    hint = f"the column of the intensity is headed {heads}; cm/s^2 is converted, g is not"
    raise InputError([f"{first}; {hint}", *others], str(path))


def load_question(directory: Path) -> Question:
    """Return the options in `question.toml` of a study; the defaults without one."""
    file = directory / QUESTION
    return _make_question(read_toml(file), str(file), directory) if is_file(file) else Question()


def save_question(directory: Path, question: Question) -> None:
    """Write `question.toml`, so that the reports of the directory use the same options."""
    write_file(directory / QUESTION, tomli_w.dumps(to_table(question)), overwrite=True)


OF_DEMAND = ("capacity", "failed")  # options that belong to one demand


def change_question(
    saved: Question, options: Mapping[str, Any], folder: Path = Path(), default_demand: str = ""
) -> Question:
    """Return saved options with the given ones in place of theirs; None means not given.

    With another demand, `capacity` and `failed` of the saved one do not apply. `default_demand` is
    the demand of saved options without one.
    """
    changes = {name: value for name, value in options.items() if value is not None}
    question = _make_question(changes, "options", folder)
    kept = dict(saved)
    if "demand" in changes and question.demand != (saved.demand or default_demand):
        kept = {name: value for name, value in kept.items() if name not in OF_DEMAND}
    return Question(**(kept | {name: getattr(question, name) for name in changes}))


def describe_kept(
    saved: Question, options: Mapping[str, Any], question: Question, where: str
) -> list[str]:
    """Return which saved options hold in a question with other options, and which do not."""
    sentences, defaults = [], Question()
    stated = [
        name
        for name in Question.model_fields
        if options.get(name) is None and getattr(saved, name) != getattr(defaults, name)
    ]
    kept = [name for name in stated if getattr(question, name) == getattr(saved, name)]
    if kept:
        sentences.append(f"from {where}: {', '.join(_option_text(saved, name) for name in kept)}")
    dropped = [_option_text(saved, name) for name in stated if name not in kept]
    if dropped:
        sentences.append(f"not from {where}, since the demand is another one: {', '.join(dropped)}")
    return sentences


def _option_text(question: Question, name: str) -> str:
    value = getattr(question, name)
    if isinstance(value, SiteHazard):
        return f"{name} of {len(value.intensity)} points"
    return f"{name} = {value:g}" if isinstance(value, float) else f"{name} = {value}"
