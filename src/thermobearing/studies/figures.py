"""Figures of a study: `result.plot.demand()` and so on, each a matplotlib Figure."""

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from thermobearing.results import drawing
from thermobearing.studies.columns import AMBIENT
from thermobearing.studies.counted import counted
from thermobearing.studies.demand_figure import draw_demand
from thermobearing.studies.fragility_figure import draw_fragility
from thermobearing.studies.ida_figure import draw_ida
from thermobearing.studies.labels import unit_of, words_of
from thermobearing.studies.question import Question
from thermobearing.studies.rates_figure import draw_rates
from thermobearing.studies.result import StudyResult
from thermobearing.studies.variance_figure import draw_variance


class StudyFigures:
    """Figures of a study; those of a single bearing of `result.select(bearing=...)`."""

    def __init__(self, result: StudyResult) -> None:
        self._result = result

    def demand(self, asked: Question | None = None, across: str = AMBIENT) -> Figure:
        """Fractiles of a demand along the temperature; a panel a bearing."""
        result, asked = self._result, asked or self._result.asked
        demand = asked.demand_of(result)
        found = result.demand(demand, across, failed=asked.failed)
        note = counted(result.table, demand, asked.failed).sentence
        limit = asked.capacity or np.nan
        return draw_demand(found, demand, across, result.things, note, limit)

    def ida(self, asked: Question | None = None) -> Figure:
        """Curves of single motions scaled up, with their fractiles."""
        result, asked = self._result, asked or self._result.asked
        found = result.ida(asked.demand_of(result), failed=asked.failed)
        return draw_ida(found, asked.capacity or np.nan)

    def fragility(self, asked: Question | None = None) -> Figure:
        """Fragility curves of each temperature, and over the climate."""
        asked = asked or self._result.asked
        curves, climate = asked.curves_of(self._result)
        return draw_fragility(curves, climate, self._title("fragility", asked))

    def rates(self, asked: Question | None = None) -> Figure:
        """Hazard curve and annual rates."""
        result, asked = self._result, asked or self._result.asked
        _, rates = asked.rates_of(result)
        assert asked.hazard is not None  # else the line above has said so
        title = self._title("annual rate", asked)
        note = counted(result.table, asked.demand_of(result), asked.failed).sentence
        return draw_rates(asked.hazard, rates, title, unit_of(result.intensity), note)

    def variance(self, asked: Question | None = None) -> Figure:
        """Share of each factor in the variance of a demand."""
        demand = (asked or self._result.asked).demand_of(self._result)
        return draw_variance(self._result.variance(demand), demand)

    def _title(self, what: str, asked: Question) -> str:
        """What is shown, of which demand, of which bearing."""
        result = self._result
        demand = asked.demand_of(result)
        limit = f"{asked.capacity_of(result):g} {unit_of(demand)}".strip()
        names = result.table["bearing"].unique()
        of = f", {names[0]}" if len(names) == 1 else ""
        return f"{what}, {words_of(demand)} beyond {limit}{of}"

    def all_of(self, asked: Question | None = None) -> Mapping[str, Callable[[], Figure]]:
        """What draws each figure that this study has, by name of its file.

        Parameters
        ----------
        asked : demand, capacity, hazard.

        Raises
        ------
        InputError : a hazard curve is given, and no capacity.
        """
        result, asked = self._result, asked or self._result.asked
        found: dict[str, Callable[[], Figure]] = {}
        if AMBIENT in result.factors:
            found["demand"] = partial(self.demand, asked)
        if len(result.factors) > 1:
            found["variance"] = partial(self.variance, asked)
        if asked.hazard is not None:
            asked.capacity_of(result)
        for name, part in result.parts().items():
            own = StudyFigures(part)
            ending = f"-{name}" if name else ""
            if part.has_ida:
                found[f"ida{ending}"] = partial(own.ida, asked)
            if asked.capacity is None or part.table[part.intensity].nunique() < 2:
                continue
            found[f"fragility{ending}"] = partial(own.fragility, asked)
            if asked.hazard is not None:
                found[f"rates{ending}"] = partial(own.rates, asked)
        return found

    def save_all(self, folder: Path, asked: Question | None = None) -> list[Path]:
        """Draw and write every figure; gives the files.

        Parameters
        ----------
        folder : where to; made if it does not exist.
        asked : demand, capacity, hazard.
        """
        return drawing.save_figures(self.all_of(asked), folder)
