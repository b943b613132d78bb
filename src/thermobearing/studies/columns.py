"""The columns of a plan: for each factor its levels, or how it is drawn."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermobearing.border.schema import Strict
from thermobearing.core.records import Floats
from thermobearing.studies.distributions import Distribution
from thermobearing.studies.factors import MotionFactor, Picked, Posterior, numbers_of, probabilities
from thermobearing.studies.names import Target, target_of
from thermobearing.studies.record import Study

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


def columns_of(study: Study) -> list[Column]:
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
    for target in targets_of(study):
        unit = target.unit if target.of == "value" else None
        number = factors.numbers[target.name]
        columns.append(_number(number, target.name, unit, f"factors.{target.name}"))
    return columns


def targets_of(study: Study) -> list[Target]:
    """Where the dotted names of a study lead; of a posterior, in the bearing that it is of.

    Raises
    ------
    InputError : a name that leads nowhere.
    """
    levels = levels_by_part(study)
    return [target_of(name, one.of, levels) for name, one in study.factors.numbers.items()]


def levels_by_part(study: Study) -> dict[str, list[Strict]]:
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
    found = numbers_of(factor, unit, key)
    if isinstance(found, Distribution):
        return Column(name, distribution=found)
    return Column(name, found, chances=_chances(factor, len(found)))
