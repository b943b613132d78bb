"""Distributions of the numbers of a study: a few words with units become quantiles."""

import math
import re
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from thermobearing.border.errors import InputError
from thermobearing.border.schema import Strict
from thermobearing.border.units import parse_quantity
from thermobearing.core.records import Floats
from thermobearing.motions.record import acceleration_unit

Kind = Literal["normal", "lognormal", "uniform", "triangular"]
Number = float | str | None  # text where the factor has a unit
# Each way to say a distribution, by its kind; `low` and `high` cut off the first two besides.
WAYS: dict[str, tuple[tuple[str, ...], ...]] = {
    "normal": (("mean", "sd"), ("mean", "cov")),
    "lognormal": (("median", "cov"), ("median", "log_sd"), ("mean", "cov")),
    "uniform": (("low", "high"),),
    "triangular": (("low", "mode", "high"),),
}
CUT = ("normal", "lognormal")  # have no ends of their own
PURE = ("cov", "log_sd")  # have no unit whatever the number is
ACCELERATION = "m/s^2"
MM_PER_M = 1000.0
NUMBER = re.compile(r"^(?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(?P<unit>\D.*)?$")
RARE = 1e-6  # a study of a million runs meets what is as rare as this


class Drawn(Strict):
    """Keys of a number that has a distribution; which of them go together says `WAYS`."""

    distribution: Kind | None = None
    mean: Number = None
    median: Number = None
    mode: Number = None
    sd: Number = None
    cov: Number = None
    log_sd: Number = None
    low: Number = None
    high: Number = None


@dataclass(frozen=True)
class Distribution:
    """A distribution of one number, cut off at `low` and `high`.

    Attributes
    ----------
    kind : "normal", "lognormal", "uniform" or "triangular".
    centre : mean, median, or mode.
    spread : standard deviation; of a lognormal one that of the logarithm; none of the others.
    low, high : ends.
    """

    kind: Kind
    centre: float
    spread: float
    low: float = -math.inf
    high: float = math.inf

    @cached_property
    def _whole(self) -> Any:
        """Before it is cut off, by scipy."""
        from scipy import stats  # takes a second to read; processes that run need it not

        if self.kind == "normal":
            return stats.norm(self.centre, self.spread)
        if self.kind == "lognormal":
            return stats.lognorm(self.spread, scale=self.centre)
        width = self.high - self.low
        if self.kind == "uniform":
            return stats.uniform(self.low, width)
        return stats.triang((self.centre - self.low) / width, self.low, width)

    @cached_property
    def _ends(self) -> tuple[float, float]:
        """Probabilities of the whole below the ends."""
        return float(self._whole.cdf(self.low)), float(self._whole.cdf(self.high))

    def at(self, probability: Floats) -> Floats:
        """Values that are not exceeded with a probability, in [0, 1]."""
        below, above = self._ends
        inside = below + np.asarray(probability, dtype=np.float64) * (above - below)
        return np.clip(np.asarray(self._whole.ppf(inside), np.float64), self.low, self.high)

    @property
    def reach(self) -> tuple[float, float]:
        """Values as small and as large as one run in a million meets."""
        smallest, largest = self.at(np.array([RARE, 1.0 - RARE]))
        return float(smallest), float(largest)


def settled_number(value: float | str, unit: str | None) -> float:
    """A number of a study file: text with a unit where there is one, else a plain number."""
    if unit:
        if isinstance(value, str):
            return acceleration(value) if unit == ACCELERATION else parse_quantity(value, unit)
        raise InputError(f'{value!r} has no unit; write "{value} {unit}" if that is meant')
    if isinstance(value, str):
        raise InputError(f'"{value}": must be a plain number, without a unit')
    return float(value)


def acceleration(text: str) -> float:
    """A number with a unit of acceleration as records have them: m/s2, g, gal, ... [m/s2]."""
    number = NUMBER.match(text.strip())
    if number is None or not number["unit"]:
        raise InputError(f'"{text}": give a number with its unit, such as "2 m/s2"')
    return float(number["number"]) * acceleration_unit(number["unit"]) / MM_PER_M


def read_distribution(drawn: Drawn, unit: str | None, key: str) -> Distribution:
    """The distribution that the keys of a factor say."""
    kind = drawn.distribution
    assert kind is not None
    given = {name: getattr(drawn, name) for name in Drawn.model_fields if name != "distribution"}
    given = {name: value for name, value in given.items() if value is not None}
    ends = {"low", "high"} if kind in CUT else set()
    ways = [way for way in WAYS[kind] if set(way) == set(given) - ends]
    if not ways:
        said = " or ".join(" and ".join(way) for way in WAYS[kind])
        more = "; low and high cut it off" if ends else ""
        got = ", ".join(given) or "nothing"
        raise InputError(f"{key}: a {kind} distribution takes {said}{more}; got {got}")
    if unit == "degC" and (kind == "lognormal" or "cov" in given):
        raise InputError(f"{key}: of a temperature: normal with mean and sd, uniform or triangular")
    numbers, faults = {}, []
    for name, value in given.items():
        own = None if name in PURE else "K" if (name, unit) == ("sd", "degC") else unit
        try:
            numbers[name] = settled_number(value, own)
        except InputError as error:
            faults += error.lines(f"{key}.{name}")
    if faults:
        raise InputError(faults)
    return _made(kind, numbers, key)


def _made(kind: Kind, numbers: dict[str, float], key: str) -> Distribution:
    """The distribution of settled numbers; InputError where they make none."""
    low, high = numbers.get("low", -math.inf), numbers.get("high", math.inf)
    for name in ("sd", "cov", "log_sd"):
        if not numbers.get(name, 1.0) > 0.0:
            raise InputError(f"{key}.{name} = {numbers[name]:g}: must be greater than 0")
    if not low < high:
        raise InputError(f"{key}: low = {low:g} must be less than high = {high:g}")
    if kind == "normal":
        mean = numbers["mean"]
        spread = numbers["sd"] if "sd" in numbers else abs(mean) * numbers["cov"]
        if spread == 0.0:
            raise InputError(f"{key}: a cov of a mean of 0 is no spread; give sd")
        made = Distribution(kind, mean, spread, low, high)
    elif kind == "lognormal":
        cov = numbers.get("cov", 0.0)
        spread = numbers["log_sd"] if "log_sd" in numbers else math.sqrt(math.log1p(cov * cov))
        median = numbers["median"] if "median" in numbers else numbers["mean"]
        if not median > 0.0:
            raise InputError(f"{key}: a lognormal distribution is of numbers greater than 0")
        median = median if "median" in numbers else median / math.sqrt(1.0 + cov * cov)
        made = Distribution(kind, median, spread, low, high)
    else:
        mode = numbers.get("mode", low)
        if not low <= mode <= high:
            raise InputError(f"{key}: mode = {mode:g} must be between low and high")
        return Distribution(kind, mode, 0.0, low, high)
    below, above = made._ends
    if not above - below > RARE:
        raise InputError(f"{key}: next to nothing of the distribution is between low and high")
    return made
