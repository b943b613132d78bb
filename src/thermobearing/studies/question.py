"""What is asked of a study that was carried out: which demand, which capacity, which hazard."""

from dataclasses import dataclass, field
from typing import Any

from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.climate import Hourly
from thermobearing.earthquake.soaking import bearing_weather
from thermobearing.model.options import ModelOptions
from thermobearing.studies.counted import Failed
from thermobearing.studies.factors import Posterior
from thermobearing.studies.fragility import Fragility, Method
from thermobearing.studies.hazard import Hazard, Rate, annual_rate
from thermobearing.studies.mixture import ClimateFragility
from thermobearing.studies.result import CLIMATE, StudyResult

FACES = ("upper_face", "lower_face", "side")


@dataclass(frozen=True)
class Question:
    """What is asked of a study.

    Attributes
    ----------
    demand : column; ductility of the pier by default, or what there is instead.
    capacity : of the demand, in its unit; None: no fragility, and no rates.
    method : of fragility.
    failed : runs that failed are "left-out", or count as "collapse".
    hazard : of the site; None: no rates.
    temperatures : hourly weather of the site, which the rubber of each bearing follows; or
        temperatures of the rubber at equally probable times [degC]. None: no climate but that of
        the study.
    _followed : temperatures of the rubber that were found already, by bearing.
    """

    demand: str | None = None
    capacity: float | None = None
    method: Method = "stripes"
    failed: Failed = "left-out"
    hazard: Hazard | None = None
    temperatures: Any = None
    _followed: dict[tuple[str, ...], Any] = field(default_factory=dict, repr=False, compare=False)

    def demand_of(self, result: StudyResult) -> str:
        """The demand that is asked for."""
        return self.demand or result.demand_name

    def capacity_of(self, result: StudyResult) -> float:
        """Return the capacity, which fragility and annual rates need.

        Raises
        ------
        InputError : it is not given.
        """
        if self.capacity is None:
            raise InputError(
                f"what is the capacity of {self.demand_of(result)}? Fragility and annual rates "
                "need it: --capacity, or capacity in question.toml (a pier yields at a "
                "pier_ductility of 1)"
            )
        return self.capacity

    def curves_of(self, result: StudyResult) -> tuple[dict[Any, Fragility], Any]:
        """Curves of each temperature, and that over the climate; of one bearing.

        Raises
        ------
        InputError : no capacity is known.
        """
        capacity = self.capacity_of(result)
        how: dict[str, Any] = {"method": self.method, "failed": self.failed}
        curves = result.fragilities(capacity, self.demand_of(result), **how)
        levels = all(isinstance(name, int | float) for name in curves)
        climate: ClimateFragility | Fragility | None = None
        if not levels:  # the study has drawn its temperatures from a climate
            climate = result.fragility(capacity, self.demand_of(result), name=CLIMATE, **how)
        elif self.temperatures is not None:
            climate = result.over_climate(curves, self._rubber(result))
        return curves, climate

    def _rubber(self, result: StudyResult) -> Any:
        """Return the temperatures of the rubber; of the air for bilinear or several bearings."""
        if not isinstance(self.temperatures, Hourly):
            return self.temperatures
        names = tuple(sorted({str(name) for name in result.table["bearing"]}))
        if names not in self._followed:
            levels = [one for one in result.study.factors.bearing.levels if str(one.name) in names]
            bearing = levels[0].bearing if isinstance(levels[0], Posterior) else levels[0]
            followed = self.temperatures.temperature
            if len(levels) == 1 and isinstance(bearing, Bearing):
                given, usual = result.study.case.analysis, ModelOptions()
                keys = [key for key in FACES if getattr(given, key) != getattr(usual, key)]
                options = {key: getattr(given, key) for key in keys}
                followed = bearing_weather(bearing, self.temperatures, **options)[
                    "rubber_degC"
                ].to_numpy()
            self._followed[names] = followed
        return self._followed[names]

    def rates_of(self, result: StudyResult) -> tuple[dict[Any, Fragility], dict[Any, Rate]]:
        """Curves, and the annual rate of each with that over the climate last.

        Raises
        ------
        InputError : no hazard curve, or no capacity.
        """
        if self.hazard is None:
            raise InputError("annual rates need a hazard curve")
        curves, climate = self.curves_of(result)
        rates = result.rates(curves, self.hazard)
        if isinstance(climate, Fragility):
            rates |= result.rates({CLIMATE: climate}, self.hazard)
        elif climate is not None:
            rates[CLIMATE] = annual_rate(climate, self.hazard)
        return curves, rates
