"""Result of a parameter study, and its post-processing options (question.toml)."""

import shlex
from collections.abc import Callable, Hashable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar, Unpack, cast

import numpy as np
from numpy.typing import ArrayLike

from thermobearing.bearing.model import Bearing
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, nearest, short_repr
from thermobearing.border.lazy import pd
from thermobearing.climate.hourly import Hourly
from thermobearing.earthquake.run import bearing_weather
from thermobearing.model.options import ModelOptions
from thermobearing.quantities.tables import Table
from thermobearing.quantities.warned import Warned
from thermobearing.results.base import COMPLETED, Result
from thermobearing.results.directory import RESOLVED, TABLE
from thermobearing.results.writing import write_csv
from thermobearing.studies.curves import Temperature, at_temperature, other_medians
from thermobearing.studies.definition.designs import AMBIENT, HOUR, NAMED_FACTORS, Plan
from thermobearing.studies.definition.record import (
    COLUMNS,
    Posterior,
    Study,
    stated_laws,
)
from thermobearing.studies.question import Question, load_question
from thermobearing.studies.statistics.demand import (
    ANY,
    COMPUTED,
    FEW_BEYOND,
    OUTCOME,
    WORST,
    Failed,
    counted,
    demand_against,
    describe_selection,
    extrapolations,
    failure_rule,
    in_classes,
    ranked_by,
    worst_runs,
)
from thermobearing.studies.statistics.fragility import (
    Fragility,
    Options,
    combine_curves,
    fragility_curve,
    fragility_curves,
)
from thermobearing.studies.statistics.hazard import (
    ALL_TEMPERATURES,
    CLIMATE,
    Hazard,
    Rate,
    annual_rate,
    ratio,
    shares_of_time,
)
from thermobearing.studies.statistics.ida import Ida, ida_curves
from thermobearing.studies.statistics.variance import (
    LEAST_ROWS,
    MATRIX,
    Lost,
    find_lost,
    sobol_table,
    variance_shares,
)
from thermobearing.studies.store import Store
from thermobearing.studies.tables import (
    answer,
    column_words,
    find_unit,
    result_tables,
)
from thermobearing.studies.validity import study_warnings

T = TypeVar("T")
FACES = ("upper_face", "lower_face", "side")


LAW_FILE = "FILE.py"  # to be replaced by the reader
NUMBERS = ("scale", AMBIENT, HOUR)
INCOMPLETE = "incomplete"  # in the manifest of some runs: how many of the study there are


@checked
class StudyResult(Result):
    """Runs of a parameter study, and their statistics.

    All figures and tables treat failed runs as the option `failed` states ("computed", "left-out"
    or "collapse"), and report how many there are.

    Attributes
    ----------
    table : DataFrame
        A row for each run: factors, outcome, demands.
    study : Study
        The definition of the study.
    manifest : dict
        Versions and digest of the input, of its directory.
    directory : Path
        Directory of the study.
    question : Question
        Demand, capacity and hazard curve: those of the directory, or the defaults.
    """

    _figures = "StudyFigures"
    _listed = "`thermobearing report` lists all"

    def __init__(
        self,
        table: "pd.DataFrame",
        study: Study,
        manifest: Mapping[str, Any],
        directory: str | Path = "DIR",
        question: Question | None = None,
    ) -> None:
        self.table, self.study, self.manifest = table, study, dict(manifest)
        self.directory, self.question = Path(directory), question or Question()
        self._parts: tuple[Question, dict[str, StudyResult]] | None = None
        self._curve_cache: tuple[Question, dict[Any, Fragility], Fragility | None] | None = None
        self._statistics: dict[Hashable, Any] = {}

    @property
    def runs(self) -> int:
        """Number of runs."""
        return len(self.table)

    @property
    def failed(self) -> int:
        """Number of runs that did not complete."""
        return int((self.table[OUTCOME] != COMPLETED).sum())

    @property
    def outcome(self) -> str:
        """The word "completed", "some_failed" or "incomplete"."""
        if self.incomplete:
            return "incomplete"
        return "some_failed" if self.failed else "completed"

    @property
    def incomplete(self) -> str:
        """How many runs of the whole study are there; "" if all are."""
        runs = int(self.manifest.get("runs", self.runs))
        words = f"{self.runs} of {runs} runs are complete" if self.runs < runs else ""
        return words or str(self.manifest.get(INCOMPLETE, ""))

    @property
    def headline(self) -> str:
        """Return the name of the study and the numbers of runs in a line."""
        return f"Study {self.study.name}: {self.runs} runs, {self.failed} failed"

    @property
    def factors(self) -> list[str]:
        """Columns of factors that vary between runs."""
        dotted = list(self.study.factors.numbers)
        columns = [name for name in (*NAMED_FACTORS, *NUMBERS, *dotted) if name in self.table]
        return self._once(
            ("factors",), lambda: [name for name in columns if self.table[name].nunique() > 1]
        )

    @property
    def things(self) -> list[str]:
        """The columns "structure" and "bearing", if they vary."""
        return [name for name in ("structure", "bearing") if name in self.factors]

    @property
    def intensity(self) -> str:
        """Column of the intensity measure."""
        return COLUMNS[self.study.factors.scale.measure]

    @property
    def default_demand(self) -> str:
        """Column of a demand that is not stated: ductility of the pier if it exists.

        That and ``failed="computed"`` are the defaults of methods, whatever `question` has.
        """
        return ranked_by(self.table)

    @property
    def demand_name(self) -> str:
        """Column of the demand of figures, tables and sentences: that of the question, if any."""
        return self.question.demand or self.default_demand

    @property
    def selection(self) -> str:
        """Words for titles: which runs are left, if runs with a failed pier are left out, or ""."""
        return describe_selection(self.table, self.demand_name, self.question.failed)

    @property
    def warnings(self) -> list[str]:
        """Warnings about the validity of the result."""
        return study_warnings(self)

    def beyond_ranges(self, least: float = FEW_BEYOND) -> list[Warned]:
        """Return which runs leave the calibration range of each bearing, if a share above `least`.

        The limits are those in the column `beyond_tested`. A bearing without a range is named too.
        """
        own_lines = any(line.bearing is not None for line in self.study.case.lines)
        levels = self.study.factors.bearing.levels
        return extrapolations(self.table, levels, own_lines=own_lines, least=least)

    @property
    def _has_sobol_design(self) -> bool:
        """Whether each sample of each of Saltelli's matrices was run once."""
        table = self.table
        return MATRIX in table and not table.duplicated([MATRIX, "sample"]).any()

    def _failure_sentence(self) -> str:
        """Return how many runs failed, and the rule by which they count."""
        demand, failed = self.demand_name, self.question.failed
        try:
            capacity = self.question.capacity or ANY
            sentence = counted(self.table, demand, failed, capacity).sentence
        except InputError:  # no run has a number
            return f"{self.failed} of {self.runs} runs failed"
        return f"{sentence}. {failure_rule(demand, failed)}".removesuffix(".")

    def tables(self) -> dict[str, Table]:
        """Return tables of failures, demand, fragility, rates and variance, where they exist."""
        return result_tables(self)

    def notes(self) -> list[str]:
        """Return the summary of results in sentences."""
        return answer(self)

    def demand(
        self,
        demand: str | None = None,
        across: str = AMBIENT,
        *,
        by: Sequence[str] | None = None,
        failed: Failed = COMPUTED,
        least: bool = False,
    ) -> "pd.DataFrame":
        """Return mean, fractiles and band of the median of a demand at each temperature.

        Parameters
        ----------
        demand : str, optional
            Column; `default_demand` by default.
        across : str
            Column of numbers in place of the ambient temperature.
        by : sequence of str, optional
            Columns whose values have separate rows; structures and bearings by default.
        failed : {"computed", "left-out", "collapse"}
            Treatment of failed runs. With "computed" those that stopped are larger than all
            others, so that numbers are upper bounds, and infinite where they do not end.
        least : bool
            Lower bounds instead: runs that stopped count with their last values.
        """
        by, name = tuple(self.things if by is None else by), demand or self.default_demand
        return self._once(
            ("demand", name, across, by, failed, least),
            lambda: demand_against(self.table, name, across, by=by, failed=failed, least=least),
        )

    def _once(self, key: tuple[Any, ...], compute: Callable[[], T]) -> T:
        """Return a copy of statistics computed once; of a million runs they take seconds."""
        if key not in self._statistics:
            self._statistics[key] = compute()
        statistics: Any = self._statistics[key]
        return cast(T, statistics if isinstance(statistics, tuple) else statistics.copy())

    def ida(
        self,
        demand: str | None = None,
        *,
        failed: Failed = COMPUTED,
        capacity: float | None = None,
        temperature: Temperature = None,
    ) -> Ida:
        """Return IDA curves at one temperature, one for each combination of the factors but scale.

        Parameters
        ----------
        demand, failed
            As in `demand`.
        capacity : float, optional
            With "computed" a run that stopped counts as in `fragility` of this capacity: as a
            collapse if it had reached it, and left out otherwise. Without a capacity all runs that
            stopped count as a collapse.
        temperature : float or "pooled", optional
            As in `fragility`.

        Raises
        ------
        InputError
            The runs have several temperature levels, and none is selected.
        """
        table = at_temperature(self, temperature).table
        name, least = demand or self.default_demand, ANY if capacity is None else capacity
        curves = self._curves()
        return ida_curves(table, name, self.intensity, curves, failed=failed, capacity=least)

    @property
    def has_ida(self) -> bool:
        """Whether some runs differ in their intensity only."""
        unsuitable = MATRIX in self.table or "scale" not in self.factors
        return not unsuitable and bool(self.table.duplicated(list(self._curves())).any())

    @property
    def has_variance(self) -> bool:
        """Whether there are enough factors and runs for shares of the variance."""
        return len(self.factors) > 1 and self.runs - self.failed >= LEAST_ROWS

    def _curves(self) -> tuple[str, ...]:
        columns = [name for name in ("motion", "sample", *self.factors) if name in self.table]
        return tuple(dict.fromkeys(name for name in columns if name != "scale"))

    def select(self, **chosen: Any) -> "StudyResult":
        """Return the runs with some values of their factors, as a result.

        Parameters
        ----------
        chosen
            A value, or several in a list, by column.

        Raises
        ------
        InputError
            There is no such column or no such run.
        """
        selected = np.ones(self.runs, dtype=bool)
        for name, value in chosen.items():
            if name not in self.table:
                raise InputError(f'no column "{name}"{nearest(name, [str(k) for k in self.table])}')
            values = value if isinstance(value, list | tuple) else [value]
            selected &= self.table[name].isin(values).to_numpy(dtype=bool)
        if not selected.any():
            raise InputError(f"no run has {chosen}")
        manifest = {**self.manifest, "runs": int(selected.sum()), INCOMPLETE: self.incomplete}
        table = self.table[selected].reset_index(drop=True)
        return StudyResult(table, self.study, manifest, self.directory, self.question)

    def parts(self) -> dict[str, "StudyResult"]:
        """Return a result for each structure and bearing, by name; "" if none of them varies."""
        if not self.things:
            return {"": self}
        if not self._parts or self._parts[0] is not self.question:
            results = {}
            for row in self.table[self.things].drop_duplicates().to_dict("records"):
                chosen = {str(key): value for key, value in row.items()}
                results["-".join(map(str, row.values()))] = self.select(**chosen)
            self._parts = self.question, results
        return self._parts[1]

    def _refuse_mixed(self, by: str = "") -> None:
        mixed = [name for name in self.things if name != by]
        if mixed:
            names = ", ".join(map(str, self.table[mixed[0]].unique()))
            raise InputError(f"the curve would mix {mixed[0]}s ({names}): select one of them")

    def fragility(
        self,
        capacity: float,
        demand: str | None = None,
        *,
        name: str = "",
        temperature: Temperature = None,
        **options: Unpack[Options],
    ) -> Fragility:
        """Return a lognormal fragility curve of the runs at one temperature.

        If the study draws its temperatures from a climate, it is the fragility over the climate.

        Parameters
        ----------
        capacity : float
            Capacity in the unit of the demand.
        demand : str, optional
            Column; `default_demand` by default.
        name : str
            Name of the curve.
        temperature : float or "pooled", optional
            One of several temperature levels [degC], or all their runs together: a curve that
            depends on the levels that were chosen. Left out where the study has one temperature or
            draws them.
        options
            `method` ("stripes", "ida" or "cloud"), `failed` ("computed", "left-out" or "collapse"),
            `level` (confidence of the bands), `samples` and `seed` (of the bootstrap over motions).

        Raises
        ------
        InputError
            The runs have several temperature levels, structures or bearings, and none is selected.
        """
        self._refuse_mixed()
        options.setdefault("curves", self._curves())
        demand, table = demand or self.default_demand, at_temperature(self, temperature).table
        return fragility_curve(table, demand, capacity, self.intensity, name=name, **options)

    def fragilities(
        self,
        capacity: float,
        demand: str | None = None,
        by: str = AMBIENT,
        *,
        temperature: Temperature = None,
        **options: Unpack[Options],
    ) -> dict[Any, Fragility]:
        """Return a fragility curve for each temperature, or class of temperatures.

        Parameters
        ----------
        capacity, demand, options
            As in `fragility`.
        by : str
            Column whose values have a curve each, such as "bearing".
        temperature : float or "pooled", optional
            As in `fragility`, where the curves are not those of temperatures.
        """
        self._refuse_mixed(by)
        runs = at_temperature(self, "pooled" if by == AMBIENT else temperature)
        table, by = in_classes(runs.table, by)
        options.setdefault("curves", self._curves())
        demand = demand or self.default_demand
        return fragility_curves(table, demand, capacity, self.intensity, by, **options)

    def over_climate(self, curves: Mapping[Any, Fragility], temperatures: ArrayLike) -> Fragility:
        """Return the mean of the curves of temperature levels, each by its share of the time.

        Parameters
        ----------
        curves : mapping of float to Fragility
            Those of `fragilities`, by temperature.
        temperatures : array_like
            Rubber temperatures at equally probable times, see `bearing_weather` [degC].

        Raises
        ------
        InputError
            The curves are not those of temperatures.
        """
        if not all(isinstance(name, int | float) for name in curves):
            raise InputError(
                "these curves belong to classes of a random temperature; use `fragility` of "
                "all runs for the fragility over the climate"
            )
        return combine_curves(curves, shares_of_time(list(curves), temperatures), CLIMATE)

    def rates(self, curves: Mapping[Any, Fragility], hazard: Hazard) -> dict[Any, Rate]:
        """Return the annual rate of exceedance of the capacity at each temperature.

        Parameters
        ----------
        curves : mapping to Fragility
            Those of `fragilities`.
        hazard : Hazard
            Hazard curve of the site, in the intensity measure of the study.

        Raises
        ------
        InputError
            The hazard curve is in another measure.
        """
        measure = self.study.factors.scale.measure
        if hazard.measure in COLUMNS and hazard.measure != measure:
            raise InputError(
                f"the hazard curve is in {hazard.measure}, and the study is in {measure}"
            )
        return {name: annual_rate(curve, hazard) for name, curve in curves.items()}

    @property
    def capacity(self) -> float:
        """The capacity of the question; InputError without one."""
        if self.question.capacity is None:
            raise InputError(
                f"the capacity of {self.demand_name} is missing: fragility and annual rates need "
                "--capacity, or capacity in question.toml (a pier yields at a pier_ductility of 1)"
            )
        return self.question.capacity

    def find_curves(self) -> tuple[dict[Any, Fragility], Fragility | None]:
        """Return curves of each temperature of one bearing, and that of all together, if any."""
        question = self.question
        # Kept until the question changes, since a bootstrap takes long.
        if self._curve_cache is None or self._curve_cache[0] is not question:
            options: dict[str, Any] = {"method": question.method, "failed": question.failed}
            demand = self.demand_name
            curves, climate = self.fragilities(self.capacity, demand, **options), None
            if not all(isinstance(name, int | float) for name in curves):
                # The study has drawn its temperatures from a climate or a distribution.
                hourly = self.study.factors.ambient.hourly
                name = CLIMATE if hourly else ALL_TEMPERATURES
                options |= {"name": name, "temperature": "pooled"}
                climate = self.fragility(self.capacity, demand, **options)
            elif question.temperatures is not None:
                climate = self.over_climate(curves, self._rubber())
            self._curve_cache = question, curves, climate
        return self._curve_cache[1:]

    def find_rates(self) -> tuple[dict[Any, Fragility], dict[Any, Rate]]:
        """Return the curves, and the annual rate of each; that over the climate is the last."""
        if self.question.hazard is None:
            raise InputError("annual rates need a hazard curve: set hazard")
        return self.find_curves()[0], self.rates(self.all_curves(), self.question.hazard._curve())

    def all_curves(self) -> dict[Any, Fragility]:
        """Return the curves of `find_curves`; that of all temperatures, if any, is the last."""
        curves, climate = self.find_curves()
        return curves if climate is None else {**curves, climate.name: climate}

    def other_medians(self) -> dict[Any, dict[Failed, float]]:
        """Return the medians with the other treatments of failed runs, by curve and treatment."""
        return other_medians(self)

    def _rubber(self) -> Any:
        """Return rubber temperatures; ambient ones for a bilinear bearing or several bearings."""
        weather, cache = self.question.temperatures, self.question._rubber
        if not isinstance(weather, Hourly):
            return weather
        names = tuple(sorted({str(name) for name in self.table["bearing"]}))
        if names not in cache:
            levels = [
                level for level in self.study.factors.bearing.levels if str(level.name) in names
            ]
            bearing = levels[0].bearing if isinstance(levels[0], Posterior) else levels[0]
            # Without a temperature of the rubber that all share, it is that of the air.
            cache[names] = weather.temperature
            if len(levels) == 1 and isinstance(bearing, Bearing):
                analysis, defaults = self.study.case.analysis, ModelOptions()
                faces = {key: getattr(analysis, key) for key in FACES}
                faces = {key: face for key, face in faces.items() if face != getattr(defaults, key)}
                temperatures = bearing_weather(bearing, weather, model=ModelOptions(**faces))
                cache[names] = temperatures["rubber_degC"].to_numpy()
        return cache[names]

    def rates_table(
        self, curves: Mapping[Any, Fragility], rates: Mapping[Any, Rate], to: Any = None
    ) -> "pd.DataFrame":
        """Return rates with bands and return periods, and their ratios to one of them.

        Parameters
        ----------
        curves : mapping to Fragility
            Those of `fragilities`.
        rates : mapping to Rate
            Those of `rates`.
        to : optional
            Name of the rate that the others are divided by; the last curve by default.
        """
        to = list(curves)[-1] if to is None and curves else to
        if not curves or not isinstance(to, Hashable) or to not in rates:
            names = ", ".join(map(str, rates)) or "none"
            raise InputError(f"to = {short_repr(to)}: must be the name of a rate; known: {names}")
        level = next(iter(curves.values())).level
        rows = []
        for name, rate in rates.items():
            quotient, low, high = ratio(rate, rates[to], level)
            rows.append(
                {
                    "name": name,
                    "rate": rate.rate,
                    "rate_low": rate.low,
                    "rate_high": rate.high,
                    "return_period_years": rate.return_period,
                    "in_50_years": rate.probability(50.0),
                    "over_reference": quotient,
                    "over_low": low,
                    "over_high": high,
                    "outcome": rate.outcome,
                    "notes": "; ".join(rate.notes),
                }
            )
        return pd.DataFrame(rows).assign(reference=str(to))

    def variance(self, demand: str | None = None) -> "pd.DataFrame":
        """Return the share of each factor in the variance of a demand.

        The shares are Sobol' indices if the design has Saltelli's arrangement and one combination
        of levels, and correlation ratios otherwise. Factors with paired draws have one common
        share. Failed runs without a demand that was computed to the end are left out.

        Parameters
        ----------
        demand : str, optional
            Column; `default_demand` by default.
        """
        name = demand or self.default_demand
        return self._once(("variance", name), lambda: self._variance(name))

    def _variance(self, name: str) -> "pd.DataFrame":
        if self._has_sobol_design:
            indices = sobol_table(self.table, name)
            return indices.assign(factor=indices["factor"].replace(HOUR, AMBIENT))
        factors = self._variance_factors()
        return variance_shares(self.table, name, factors, together=self._drawn_together())

    def lost_demands(self) -> Lost:
        """Return how many runs the variance of the demand of the question lacks, and which."""
        factors = {name: (column_words(name), find_unit(name)) for name in self._variance_factors()}
        name, sobol = self.demand_name, self._has_sobol_design
        return self._once(("lost", name), lambda: find_lost(self.table, name, factors, sobol=sobol))

    def _variance_factors(self) -> list[str]:
        factors = [factor for factor in self.factors if factor != HOUR]
        if self.study.factors.scale.of == "intensity":  # which with the motion determines the scale
            factors = [self.intensity if factor == "scale" else factor for factor in factors]
        return factors

    def _drawn_together(self) -> list[str]:
        """Return the factors whose draws are the same in all combinations of levels."""
        if not self.study.design.paired or self.table["sample"].nunique() == self.runs:
            return []
        drawn = {column.name for column in Plan(self.study).columns if column.drawn}
        drawn |= {AMBIENT} if HOUR in drawn else set()
        return [name for name in self.factors if name in drawn and name != HOUR]

    def worst(self, count: int = WORST, by: str | None = None) -> "pd.DataFrame":
        """Return the worst runs and the first of each failure mode, with commands that repeat them.

        Runs whose pier exceeded its limits have their place among the worst ones, and so have runs
        that stopped, with their last values; other failed runs have none.

        Parameters
        ----------
        count : int
            Number of the worst runs.
        by : str, optional
            Column that ranks the runs; `default_demand` by default.
        """
        by = by or self.default_demand
        run_numbers = worst_runs(self.table, count, by)
        failed = self.table[self.table[OUTCOME] != COMPLETED]
        run_numbers += [
            int(run) for run in failed.groupby(OUTCOME, sort=True, observed=True)["run"].min()
        ]
        run_numbers = list(dict.fromkeys(run_numbers))  # the first of a mode may be a worst run
        columns = ["run", "id", OUTCOME, *self.factors, by]
        if "scale" in columns and self.intensity in self.table:
            columns.insert(columns.index("scale") + 1, self.intensity)
        by_run = self.table.set_index("run", drop=False)
        rows = by_run.loc[run_numbers, columns].reset_index(drop=True)
        place = str(self.directory).rstrip("/")
        # A study never names the file that registers a law, since files load no code.
        own_laws = any(stated_laws(bearing) for bearing in self.study.factors.bearing.levels)
        rows["command"] = [
            f"thermobearing study repeat {shlex.quote(place)} {run} -o "
            + shlex.quote(f"{place}-run-{run}")
            + (f" --law {LAW_FILE}" if own_laws else "")
            for run in run_numbers
        ]
        return pd.DataFrame(rows)

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json."""
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

    def _write(self, folder: Path) -> None:
        (folder / RESOLVED).write_text(self.study.to_toml(), encoding="utf-8")
        names = list(self.table.select_dtypes("category"))
        write_csv(folder / TABLE, self.table.astype(dict.fromkeys(names, object)))


def study_result(
    directory: str | Path, question: Question | None = None, *, demands: Sequence[str] | None = None
) -> StudyResult:
    """Return the result of a study, also of an incomplete one, with its own question by default.

    With `demands` the table has the columns that statistics of these need (`Store.checked_table`).
    """
    store = Store(Path(directory))
    question, table = question or load_question(store.directory), store.checked_table(demands)
    return StudyResult(table, store.study(), store.manifest, directory, question)
