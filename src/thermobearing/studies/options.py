"""Post-processing options of a study: demand, capacity and hazard, read from question.toml."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import tomli_w
from pydantic import Field

from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, is_file, nearest
from thermobearing.border.schema import Strict, in_unit, validated
from thermobearing.border.text_file import write_file
from thermobearing.border.toml import read_toml
from thermobearing.border.units import parse_quantity, with_unit
from thermobearing.climate.generator import generate_weather, list_climates
from thermobearing.climate.hourly import Hourly
from thermobearing.climate.readers import read_weather
from thermobearing.earthquake.run import bearing_weather
from thermobearing.model.options import ModelOptions
from thermobearing.studies.definition.record import INTENSITY_UNITS, Posterior
from thermobearing.studies.statistics.demand import Failed
from thermobearing.studies.statistics.fragility import Fragility, Method
from thermobearing.studies.statistics.hazard import (
    ClimateFragility,
    Hazard,
    Rate,
    annual_rate,
    load_hazard,
)

if TYPE_CHECKING:
    from thermobearing.studies.result import StudyResult

CLIMATE = "climate"
FACES = ("upper_face", "lower_face", "side")


@dataclass(frozen=True)
class Question:
    """Post-processing options of a study, ready for use; `Asked` describes those of a file.

    `temperatures` are hourly weather of the site, which the rubber of each bearing follows, or
    those of the rubber at equally probable times [degC]; None: no climate but that of the study.
    """

    demand: str | None = None
    capacity: float | None = None  # None: no fragility, and no rates
    method: Method = "stripes"
    failed: Failed = "left-out"
    hazard: Hazard | None = None  # None: no rates
    temperatures: Any = None
    # Temperatures of the rubber that were found already, by bearing.
    _followed: dict[tuple[str, ...], Any] = field(default_factory=dict, repr=False, compare=False)

    def chosen_demand(self, result: "StudyResult") -> str:
        """Return the demand, or that of the result by default."""
        return self.demand or result.demand_name

    def chosen_capacity(self, result: "StudyResult") -> float:
        """Return the capacity, which fragility and annual rates need; InputError without one."""
        if self.capacity is None:
            raise InputError(
                f"what is the capacity of {self.chosen_demand(result)}? Fragility and annual rates "
                "need it: --capacity, or capacity in question.toml (a pier yields at a "
                "pier_ductility of 1)"
            )
        return self.capacity

    def chosen_curves(self, result: "StudyResult") -> tuple[dict[Any, Fragility], Any]:
        """Return curves of each temperature, and that over the climate or None, of one bearing."""
        capacity = self.chosen_capacity(result)
        how: dict[str, Any] = {"demand": self.chosen_demand(result)}
        how |= {"method": self.method, "failed": self.failed}
        curves = result.fragilities(capacity, **how)
        climate: ClimateFragility | Fragility | None = None
        if not all(isinstance(name, int | float) for name in curves):
            # The study has drawn its temperatures from a climate.
            climate = result.fragility(capacity, name=CLIMATE, **how)
        elif self.temperatures is not None:
            climate = result.over_climate(curves, self._rubber(result))
        return curves, climate

    def _rubber(self, result: "StudyResult") -> Any:
        """Return rubber temperatures; the ambient ones for bilinear or several bearings."""
        if not isinstance(self.temperatures, Hourly):
            return self.temperatures
        names = tuple(sorted({str(name) for name in result.table["bearing"]}))
        if names not in self._followed:
            levels = [one for one in result.study.factors.bearing.levels if str(one.name) in names]
            bearing = levels[0].bearing if isinstance(levels[0], Posterior) else levels[0]
            followed = self.temperatures.temperature
            if len(levels) == 1 and isinstance(bearing, Bearing):
                given, usual = result.study.case.analysis, ModelOptions()
                options = {
                    key: getattr(given, key)
                    for key in FACES
                    if getattr(given, key) != getattr(usual, key)
                }
                weather = bearing_weather(bearing, self.temperatures, **options)
                followed = weather["rubber_degC"].to_numpy()
            self._followed[names] = followed
        return self._followed[names]

    def chosen_rates(self, result: "StudyResult") -> tuple[dict[Any, Fragility], dict[Any, Rate]]:
        """Return the curves, and the annual rate of each with that over the climate last."""
        if self.hazard is None:
            raise InputError("annual rates need a hazard curve")
        curves, climate = self.chosen_curves(result)
        rates = result.rates(curves, self.hazard)
        if isinstance(climate, Fragility):
            rates |= result.rates({CLIMATE: climate}, self.hazard)
        elif climate is not None:
            rates[CLIMATE] = annual_rate(climate, self.hazard)
        return curves, rates


QUESTION = "question.toml"
Rates = tuple[Annotated[float, in_unit("1/year"), Field(gt=0)], ...]
Periods = tuple[Annotated[float, in_unit("year"), Field(gt=0)], ...]


class SiteHazard(Strict):
    """Hazard curve of a site in a file.

    Attributes
    ----------
    measure : of the intensity: "PGA", "PGV" or "Sa".
    intensity : increasing, as text with units.
    rate : of exceedance, decreasing [1/year]; or
    return_period : increasing [year].
    """

    measure: Annotated[str, Field(pattern="^(PGA|PGV|Sa)$")] = "PGA"
    intensity: tuple[str, ...]
    rate: Rates | None = None
    return_period: Periods | None = None

    @classmethod
    def _conflicts(cls, given: dict[str, Any]) -> list[str]:
        both = [name for name in ("rate", "return_period") if name in given]
        return [] if len(both) == 1 else ["give rate, or return_period"]

    def _curve(self) -> Hazard:
        """Return the curve; InputError for what is none."""
        unit = INTENSITY_UNITS[self.measure]
        intensity = [parse_quantity(text, unit) for text in self.intensity]
        rate = self.rate or [1.0 / period for period in self.return_period or ()]
        return Hazard(np.array(intensity), np.array(rate), self.measure)


class Asked(Strict):
    """Post-processing options as in `question.toml`.

    Attributes
    ----------
    demand : column; ductility of the pier by default, or what there is instead.
    capacity : of the demand, in the unit of its column.
    method : of fragility: "stripes", "ida" or "cloud".
    failed : runs that failed are "left-out", or count as "collapse".
    hazard : in a file it may be the name of another, see `load_hazard`.
    weather : hourly file of the site, or the name of a climate: how often each temperature of the
        rubber comes, for studies whose temperatures are levels.
    """

    demand: str | None = None
    capacity: Annotated[float, Field(gt=0)] | None = None
    method: Method = "stripes"
    failed: Failed = "left-out"
    hazard: SiteHazard | None = None
    weather: str | None = None

    def question(self) -> Question:
        """Return the options ready for use; InputError where a file cannot be read."""
        return Question(
            demand=self.demand,
            capacity=self.capacity,
            method=self.method,
            failed=self.failed,
            hazard=None if self.hazard is None else self.hazard._curve(),
            temperatures=None if self.weather is None else _site_temperatures(self.weather),
        )


def _site_temperatures(weather: str) -> Hourly:
    if weather in list_climates() or weather.endswith(".toml"):
        return generate_weather(weather)
    if not is_file(Path(weather)):
        raise InputError(f'no file "{weather}", and no climate{nearest(weather, list_climates())}')
    return read_weather(weather)


def _make_asked(table: Mapping[str, Any], where: str, folder: Path = Path()) -> Asked:
    """Return checked options from the table of a file, or of the command line.

    None stands for an option that was not given; `where` names the file in messages, and names of
    files are relative to `folder`.
    """
    given = {name: value for name, value in table.items() if value is not None}
    hazard, weather = given.get("hazard"), given.get("weather")
    if isinstance(hazard, str):
        given["hazard"] = _of_file(folder / hazard)
    if isinstance(weather, str) and weather not in list_climates():
        given["weather"] = str((folder / weather).resolve())
    asked = validated(Asked, given, where)
    try:
        asked.question()
    except InputError as error:
        raise InputError(error.lines(), where) from None
    return asked


def _of_file(path: Path) -> dict[str, Any]:
    faults = []
    for measure, unit in INTENSITY_UNITS.items():
        try:
            found = load_hazard(path, measure)
        except InputError as error:
            faults.append(error)
            continue
        return {
            "measure": measure,
            "intensity": [with_unit(x, unit) for x in found.intensity],
            "rate": [with_unit(x, "1/year") for x in found.rate],
        }
    raise faults[0]


def kept_asked(directory: Path) -> Asked:
    """Return the options in `question.toml` of a study; the defaults without one."""
    file = directory / QUESTION
    return _make_asked(read_toml(file), str(file), directory) if is_file(file) else Asked()


def keep_asked(directory: Path, asked: Asked) -> None:
    """Write `question.toml`, so that documents of the directory use the same options."""
    table = asked.model_dump(exclude_none=True)
    if asked.hazard is not None:
        hazard = table["hazard"]
        for key, unit in (("rate", "1/year"), ("return_period", "year")):
            if key in hazard:
                hazard[key] = [with_unit(value, unit) for value in hazard[key]]
    write_file(directory / QUESTION, tomli_w.dumps(table), overwrite=True)


def asked_over(kept: Asked, options: Mapping[str, Any], folder: Path = Path()) -> Asked:
    """Return options of a directory, with those that are given now over them."""
    new = {name: value for name, value in options.items() if value is not None}
    made = _make_asked(new, "options", folder)
    return kept.model_copy(update={name: getattr(made, name) for name in new})
