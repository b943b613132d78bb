"""A study that was carried out: its table of runs, and what is drawn from it."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from thermobearing.border.errors import InputError
from thermobearing.border.showing import Shown
from thermobearing.studies.definition.columns import AMBIENT, HOUR, THINGS, list_columns
from thermobearing.studies.definition.factors import COLUMNS
from thermobearing.studies.run.demand_parameters import COMPLETED
from thermobearing.studies.run.worst import WORST, ranked_by, worst_table
from thermobearing.studies.statistics.bootstrap import LEVEL, SAMPLES
from thermobearing.studies.statistics.demand import demand_against, in_classes
from thermobearing.studies.statistics.failed_runs import OUTCOME, Failed
from thermobearing.studies.statistics.fragility import (
    Fragility,
    Method,
    fragility_curve,
    fragility_curves,
)
from thermobearing.studies.statistics.hazard import Hazard, Rate, annual_rate, ratio
from thermobearing.studies.statistics.ida import Ida, ida_curves
from thermobearing.studies.statistics.mixture import ClimateFragility, shares_of_time
from thermobearing.studies.statistics.variance import MATRIX, sobol_table, variance_shares

if TYPE_CHECKING:
    from thermobearing.studies.definition.record import Study
    from thermobearing.studies.figures import StudyFigures
    from thermobearing.studies.options import Question

NUMBERS = ("scale", AMBIENT, HOUR)
CLIMATE = "climate"


class StudyResult(Shown):
    """Runs of a study, and what is drawn from them.

    Every figure and table takes failed runs as `failed` says: "left-out", or "collapse"; each tells
    what became of them.

    Attributes
    ----------
    table : a row a run: what went in, outcome, demands.
    study : that was carried out.
    manifest : what its directory says of it: versions, input hash.
    directory : where it is.
    question : what is asked of it, see `asked`.
    """

    def __init__(
        self,
        table: pd.DataFrame,
        study: "Study",
        manifest: Mapping[str, Any],
        directory: str | Path = "DIR",
        question: "Question | None" = None,
    ) -> None:
        self.table, self.study, self.manifest = table, study, dict(manifest)
        self.directory, self._question = Path(directory), question

    @property
    def asked(self) -> "Question":
        """What is asked of it: by its directory, or the usual."""
        from thermobearing.studies.options import Question

        return self._question or Question()

    @property
    def runs(self) -> int:
        """How many runs there are, of all outcomes."""
        return len(self.table)

    @property
    def failed(self) -> int:
        """How many of them did not get through."""
        return int((self.table[OUTCOME] != COMPLETED).sum())

    @property
    def outcome(self) -> str:
        """In a word: "completed", "some_failed" or "incomplete"."""
        if self.runs < int(self.manifest.get("runs", self.runs)):
            return "incomplete"
        return "some_failed" if self.failed else "completed"

    @property
    def headline(self) -> str:
        """What it is, in a line."""
        return f"StudyResult of {self.study.name}: {self.runs} runs, {self.failed} failed"

    @property
    def factors(self) -> list[str]:
        """Columns of what differs between runs."""
        dotted = list(self.study.factors.numbers)
        known = [name for name in (*THINGS, *NUMBERS, *dotted) if name in self.table]
        return [name for name in known if self.table[name].nunique() > 1]

    @property
    def intensity(self) -> str:
        """Column of the intensity of the motions, in the measure of the study."""
        return COLUMNS[self.study.factors.scale.measure]

    @property
    def warnings(self) -> list[str]:
        """What a reader must know before using the numbers."""
        found = []
        if self.outcome == "incomplete":
            found.append(f"{self.runs} of {self.manifest['runs']} runs are done")
        if self.failed:
            found.append(
                f"{self.failed} of {self.runs} runs failed; they are left out, or count as "
                'collapse where failed = "collapse" says so'
            )
        if "scale" in self.factors and not self.has_ida:
            found.append(
                "incremental dynamic analysis is left out: no two runs differ in intensity alone. "
                "It needs the same draws at all intensities (`paired = true` in [design])"
            )
        return found

    def one_thing(self, by: str = "") -> None:
        """InputError where a curve would mix bearings or structures."""
        mixed = [name for name in self.things if name != by]
        if mixed:
            names = ", ".join(map(str, self.table[mixed[0]].unique()))
            raise InputError(f"the curve would mix {mixed[0]}s ({names}): select one of them first")

    @property
    def demand_name(self) -> str:
        """The demand that is looked at if no other is named."""
        return ranked_by(self.table)

    def demand(
        self,
        demand: str | None = None,
        across: str = AMBIENT,
        *,
        by: Sequence[str] | None = None,
        failed: Failed = "left-out",
    ) -> pd.DataFrame:
        """How a demand is spread along the temperature, see `demand_against`.

        Parameters
        ----------
        demand : column; ductility of the pier by default, or what there is instead.
        across : column of numbers.
        by : columns whose values are told apart; structures and bearings by default.
        failed : "left-out" or "collapse".
        """
        told = self.things if by is None else by
        return demand_against(
            self.table, demand or self.demand_name, across, by=tuple(told), failed=failed
        )

    @property
    def things(self) -> list[str]:
        """Structures and bearings, as far as they differ."""
        return [name for name in ("structure", "bearing") if name in self.factors]

    def ida(self, demand: str | None = None, *, failed: Failed = "left-out") -> Ida:
        """Curves of incremental dynamic analysis, see `ida_curves`; one for all but the scale.

        Parameters
        ----------
        demand : column, as of `demand`.
        failed : "left-out" or "collapse".
        """
        return ida_curves(
            self.table, demand or self.demand_name, self.intensity, self._curves(), failed=failed
        )

    @property
    def has_ida(self) -> bool:
        """Whether some motion has runs at several intensities with all else the same."""
        alone = MATRIX in self.table or "scale" not in self.factors
        return not alone and bool(self.table.duplicated(list(self._curves())).any())

    def _curves(self) -> tuple[str, ...]:
        """Columns that tell curves of single motions apart."""
        apart = [name for name in ("motion", "sample", *self.factors) if name in self.table]
        return tuple(dict.fromkeys(name for name in apart if name != "scale"))

    def select(self, **chosen: Any) -> "StudyResult":
        """The runs with some values of their factors, as a result of its own.

        Parameters
        ----------
        chosen : a value, or several in a list, by column.

        Raises
        ------
        InputError : no such column, or no such run.
        """
        kept = np.ones(self.runs, dtype=bool)
        for name, value in chosen.items():
            if name not in self.table:
                raise InputError(f'no column "{name}" to select by')
            values = value if isinstance(value, list | tuple) else [value]
            kept &= self.table[name].isin(values).to_numpy(dtype=bool)
        if not kept.any():
            raise InputError(f"no run has {chosen}")
        whole = {**self.manifest, "runs": int(kept.sum())}
        table = self.table[kept].reset_index(drop=True)
        return StudyResult(table, self.study, whole, self.directory, self._question)

    def parts(self) -> dict[str, "StudyResult"]:
        """A result for each structure and bearing, by name; "" where there is one of each."""
        if not self.things:
            return {"": self}
        chosen = self.table[self.things].drop_duplicates().to_dict("records")
        return {
            "-".join(map(str, one.values())): self.select(**{str(k): v for k, v in one.items()})
            for one in chosen
        }

    def fragility(
        self,
        capacity: float,
        demand: str | None = None,
        *,
        method: Method = "stripes",
        failed: Failed = "left-out",
        level: float = LEVEL,
        samples: int = SAMPLES,
        name: str = "",
    ) -> Fragility:
        """A fragility curve of all runs, see `fragility_curve`.

        Of a study that draws its temperatures from a climate it is the fragility over the climate.

        Parameters
        ----------
        capacity : of the demand, in its unit.
        demand : column, as of `demand`.
        method : "stripes", "ida" or "cloud".
        failed : "left-out" or "collapse".
        level : confidence of its bands.
        samples : of the bootstrap, over motions.
        name : of the curve.
        """
        self.one_thing()
        return fragility_curve(
            self.table,
            demand or self.demand_name,
            capacity,
            self.intensity,
            method=method,
            failed=failed,
            curves=self._curves(),
            level=level,
            samples=samples,
            name=name,
        )

    def fragilities(
        self,
        capacity: float,
        demand: str | None = None,
        by: str = AMBIENT,
        *,
        method: Method = "stripes",
        failed: Failed = "left-out",
        level: float = LEVEL,
        samples: int = SAMPLES,
    ) -> dict[Any, Fragility]:
        """A fragility curve for each temperature, or class of temperatures.

        Parameters
        ----------
        capacity, demand, method, failed, level, samples : as of `fragility`.
        by : column whose values have a curve each, such as "bearing".
        """
        self.one_thing(by)
        table, by = in_classes(self.table, by)
        return fragility_curves(
            table,
            demand or self.demand_name,
            capacity,
            self.intensity,
            by,
            method=method,
            failed=failed,
            curves=self._curves(),
            level=level,
            samples=samples,
        )

    def over_climate(self, curves: Mapping[Any, Fragility], temperatures: Any) -> ClimateFragility:
        """Curves of levels of the temperature, by the share of the time that each has.

        Parameters
        ----------
        curves : of `fragilities`, by temperature.
        temperatures : of the rubber at equally probable times, see
            `tb.bearing_weather` [degC].

        Raises
        ------
        InputError : the curves are not of temperatures.
        """
        if not all(isinstance(name, int | float) for name in curves):
            raise InputError(
                "these curves are of classes of a drawn temperature: `fragility` of all runs is "
                "that over its climate"
            )
        return ClimateFragility(curves, shares_of_time(list(curves), temperatures), CLIMATE)

    def rates(self, curves: Mapping[Any, Fragility], hazard: Hazard) -> dict[Any, Rate]:
        """How often a year the capacity is passed at each temperature.

        Parameters
        ----------
        curves : of `fragilities`.
        hazard : of the site, in the measure of the study.

        Raises
        ------
        InputError : the hazard curve is in another measure.
        """
        measure = self.study.factors.scale.measure
        if hazard.measure in COLUMNS and hazard.measure != measure:
            raise InputError(f"a hazard curve of {hazard.measure}, and a study of {measure}")
        return {
            name: annual_rate(ClimateFragility({name: curve}, np.ones(1)), hazard)
            for name, curve in curves.items()
        }

    def rates_table(
        self, curves: Mapping[Any, Fragility], rates: Mapping[Any, Rate], to: Any = None
    ) -> pd.DataFrame:
        """Rates with their bands and return periods, and each over that of one temperature.

        Parameters
        ----------
        curves : of `fragilities`.
        rates : of `rates`.
        to : name of the rate that the others are divided by; the last curve by default.
        """
        to = list(curves)[-1] if to is None else to
        level = next(iter(curves.values())).level
        rows = []
        for name, rate in rates.items():
            times, low, high = ratio(rate, rates[to], level)
            row = {"name": name, "rate": rate.rate, "rate_low": rate.low, "rate_high": rate.high}
            row |= {
                "return_period_years": rate.return_period,
                "in_50_years": rate.probability(50.0),
            }
            row |= {"over_reference": times, "over_low": low, "over_high": high}
            rows.append({**row, "notes": "; ".join(rate.notes)})
        return pd.DataFrame(rows).assign(reference=str(to))

    def variance(self, demand: str | None = None) -> pd.DataFrame:
        """Share of each factor in the variance of a demand.

        Sobol' indices where the design has Saltelli's arrangement and one combination of levels;
        the correlation ratio of each factor otherwise. Factors that paired draws have in common
        have one share. Failed runs are left out.

        Parameters
        ----------
        demand : column, as of `demand`.
        """
        name = demand or self.demand_name
        if MATRIX in self.table and not self.table.duplicated([MATRIX, "sample"]).any():
            found = sobol_table(self.table, name)
            return found.assign(factor=found["factor"].replace(HOUR, AMBIENT))
        factors = [factor for factor in self.factors if factor != HOUR]
        if self.study.factors.scale.of == "intensity":  # of which the scale follows by the motion
            factors = [self.intensity if factor == "scale" else factor for factor in factors]
        return variance_shares(self.table, name, factors, together=self._drawn_together())

    def _drawn_together(self) -> list[str]:
        """Factors that every combination of levels has the same draws of."""
        if not self.study.design.paired or self.table["sample"].nunique() == self.runs:
            return []
        drawn = {column.name for column in list_columns(self.study) if column.drawn}
        drawn |= {AMBIENT} if HOUR in drawn else set()
        return [name for name in self.factors if name in drawn and name != HOUR]

    def worst(self, count: int = WORST, by: str | None = None) -> pd.DataFrame:
        """The worst runs, and one of each way to fail, with the command that repeats each in full.

        Parameters
        ----------
        count : how many.
        by : column that is ranked; as of `demand` by default.
        """
        return worst_table(self.table, self.directory, self.factors, count, by)

    @property
    def plot(self) -> "StudyFigures":
        """Figures: demand, ida, fragility, rates, variance."""
        from thermobearing.studies.figures import StudyFigures

        return StudyFigures(self)

    def summary(self) -> dict[str, Any]:
        """What came out, for machines."""
        outcomes = self.table[OUTCOME].value_counts()
        return {
            "command": "study",
            "name": self.study.name,
            "outcome": self.outcome,
            "runs": self.runs,
            "failed": self.failed,
            "outcomes": {str(name): int(count) for name, count in outcomes.items()},
            "factors": self.factors,
            "intensity": self.intensity,
            "demand": self.demand_name,
        }
