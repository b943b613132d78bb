"""How large a misfit is: residuals of the force and of the temperatures against their noise."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from thermobearing.core.records import Floats
from thermobearing.identify.comparison import Comparison
from thermobearing.identify.records.checks import CheckReport
from thermobearing.identify.records.cycles import estimate_noise
from thermobearing.quantities.governing import largest_by
from thermobearing.quantities.words import number, percent
from thermobearing.tables.gaps import initial_temperature

FORCE = "force"
# Time constants of sensors [s]: a bare junction in rubber has a tenth, one in a tube a minute.
LAGS = (0.1, 0.2, 0.5, 0.7, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 60.0)
MAIN_LAG = 0.3  # of the squared difference: what a lag explains to be stated
TINY = 1e-12
Row = Mapping[str, Any]


@dataclass(frozen=True)
class Difference:
    """Difference of model and test in one signal of a test."""

    test: str
    signal: str  # "force", or the title of a thermocouple
    unit: str
    rms: float  # without the mean of a force, which is fitted
    noise: float  # standard deviation of the noise of the signal; 0 without noise
    largest: float  # at any time; magnitude
    scale: float  # largest force, or largest rise of the temperature
    lag: float = 0.0  # of a thermocouple, with which the difference is smallest [s]
    by_lag: float = 0.0  # share of the squared difference that this lag explains

    @property
    def times_noise(self) -> float:
        """Return the rms difference over the noise; infinite without noise."""
        return self.rms / self.noise if self.noise > 0.0 else float("inf")

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json about the difference."""
        return asdict(self)


def measure_differences(
    fits: Sequence[Comparison], checks: Sequence[CheckReport], weights: Sequence[Floats]
) -> list[Difference]:
    """Return the differences of model and tests, signal by signal.

    `weights` are those of the samples of each force in the calibration; samples without weight,
    such as those at rest, do not count.
    """
    differences = []
    for fit, check, weight in zip(fits, checks, weights, strict=True):
        if fit.prediction is None or check.treatment is None:
            continue
        record, used = fit.record, weight > 0.0
        residual = (fit.prediction.force - record.force)[used]
        noise, scale = check.treatment.noise["force"], record.peak_force
        if len(residual):
            centred = residual - residual.mean()
            differences.append(_difference(record.name, FORCE, "kN", centred, noise, scale))
        for title, test, model in fit.compared_temperatures():
            begin = initial_temperature(test)
            rise = float((test - begin).max())
            if rise > 0.0:
                courses = model - initial_temperature(model) - (test - begin)
                # Of all samples: those in rests are means, which have less noise.
                sampled = check.record.temperatures.get(title, test)
                noise = estimate_noise(sampled[~np.isnan(sampled)])
                difference = _difference(record.name, title, "K", courses, noise, rise)
                read = ~np.isnan(record.temperatures[title])
                lag, share = fit_lag(record.time[read], model, test)
                differences.append(replace(difference, lag=lag, by_lag=share))
    return differences


def fit_lag(time: Floats, model: Floats, test: Floats) -> tuple[float, float]:
    """Return the lag [s] of a sensor with which rises of model and test differ least.

    The second number is the share of the squared difference that this explains. The sensor is of
    the first order, and the best of the lags of LAGS is that of its time constant.
    """
    rise, measured = model - initial_temperature(model), test - initial_temperature(test)
    squares = [float(np.sum((lagged(time, rise, lag) - measured) ** 2)) for lag in (0.0, *LAGS)]
    if squares[0] == 0.0:
        return 0.0, 0.0
    best = int(np.argmin(squares))
    return (0.0, *LAGS)[best], 1.0 - squares[best] / squares[0]


def lagged(time: Floats, values: Floats, lag: float) -> Floats:
    """Return what a sensor of the first order with a lag [s] reads of a signal.

    Between samples the signal is a straight line, for which the reading is exact.
    """
    if lag == 0.0:
        return values
    steps = np.diff(time) / lag
    decays = np.exp(-steps)
    slopes = np.diff(values) / np.maximum(steps, TINY)  # in one lag
    behind = [0.0]  # of the signal, how far the reading is
    for decay, slope in zip(decays.tolist(), slopes.tolist(), strict=True):
        behind.append(decay * behind[-1] + (1.0 - decay) * slope)
    return np.asarray(values - np.array(behind))


def _difference(
    test: str, signal: str, unit: str, values: Floats, noise: float, scale: float
) -> Difference:
    rms, largest = float(np.sqrt(np.mean(values**2))), float(np.abs(values).max())
    return Difference(test, signal, unit, rms, noise, largest, scale)


def describe_differences(differences: Sequence[Difference]) -> str:
    """Return where force and temperatures differ most, and by how much; "" without any."""
    forces = [item for item in differences if item.signal == FORCE]
    sensors = [item for item in differences if item.signal != FORCE]
    parts = []
    if forces:
        item = largest_by(forces, lambda item: item.rms)
        parts.append(
            f"the force most in {item.test}, by {_size(item, item.rms)} rms "
            f"({percent(item.rms / item.scale, 2)} of the peak, {_against_noise(item)})"
        )
    if sensors:
        item = largest_by(sensors, lambda item: item.largest)
        parts.append(
            f"the temperature rise most in {item.test}, {item.signal}, by up to "
            f"{_size(item, item.largest)} ({percent(item.largest / item.scale, 1)} of the rise, "
            f"{_size(item, item.rms)} rms, {_against_noise(item)}{_by_lag(item)})"
        )
    return " and ".join(parts)


def _size(item: Difference, value: float) -> str:
    return f"{number(value, '.2g')} {item.unit}"


def _by_lag(item: Difference) -> str:
    """Return what a lag of the thermocouple explains of the difference; "" where that is little."""
    if item.by_lag < MAIN_LAG:
        return ""
    return (
        f"; a thermocouple that lags by {number(item.lag, '.2g')} s would explain "
        f"{percent(item.by_lag)} of the squared difference"
    )


def _against_noise(item: Difference) -> str:
    """Return the rms difference relative to the noise, in words."""
    if item.noise <= 0.0:
        return "the signal has no noise"
    return f"{number(item.times_noise, '.3g')} times the noise of {_size(item, item.noise)}"
