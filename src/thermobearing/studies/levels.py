"""What the levels of a study stand for, loaded once: bearings one by one, motions, weather."""

from functools import cached_property
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.model import Bearing
from thermobearing.climate import Hourly, generate_weather, read_weather
from thermobearing.earthquake.motion import Motion
from thermobearing.identify.samples import posterior_bearings
from thermobearing.motions.record import GroundMotion
from thermobearing.studies.factors import AmbientFactor, Posterior
from thermobearing.studies.matched import levels_of, motions_of
from thermobearing.studies.record import Study

Ints = NDArray[np.int64]
AnyBearing: TypeAlias = Bearing | BilinearBearing
YEARS = 50  # of weather that is made up, where nothing is said


class Levels:
    """The levels of a study.

    A bearing is known by its place in `bearings`, where each sample of a posterior has its own.
    """

    def __init__(self, study: Study) -> None:
        self.study = study

    @cached_property
    def samples(self) -> list[list[Bearing]]:
        """Samples of each level of the bearing; none of one that is a single bearing."""
        return [
            posterior_bearings(one.bearing, Path(one.posterior), one.count)[1:]
            if isinstance(one, Posterior)
            else []
            for one in self.study.factors.bearing.levels
        ]

    @cached_property
    def bearings(self) -> list[AnyBearing]:
        """All bearings, level after level."""
        found: list[AnyBearing] = []
        for one, samples in zip(self.study.factors.bearing.levels, self.samples, strict=True):
            if isinstance(one, Posterior):
                found += samples
            else:
                found.append(one)
        return found

    @cached_property
    def counts(self) -> Ints:
        """Number of samples of each level of the bearing; 0 of a single one."""
        return np.array([len(samples) for samples in self.samples], dtype=np.int64)

    def place(self, level: Ints, sample: Ints) -> Ints:
        """Places in `bearings` of samples (-1: none) of levels."""
        taken = np.maximum(self.counts, 1)
        return np.asarray((np.cumsum(taken) - taken)[level] + np.maximum(sample, 0))

    @cached_property
    def motions(self) -> list[GroundMotion]:
        """Ground motions, not yet scaled."""
        return motions_of(self.study.factors.motion)

    @cached_property
    def listed(self) -> list[Motion]:
        """The same as data, each with the factor of its level."""
        return levels_of(self.study.factors.motion)

    @cached_property
    def weather(self) -> Hourly | None:
        """Hourly weather; None where the air is levels or a distribution."""
        return weather_of(self.study.factors.ambient)


def weather_of(ambient: AmbientFactor) -> Hourly | None:
    """The weather of a study, read or made up once.

    Raises
    ------
    InputError : no such file or climate, or faults in it.
    """
    if ambient.series is None and ambient.weather is not None:
        ambient.keep_series(read_weather(ambient.weather))
    if ambient.series is None and ambient.climate is not None:
        years, seed = ambient.years or YEARS, ambient.seed or 0
        ambient.keep_series(generate_weather(ambient.climate, years, seed))
    return ambient.series
