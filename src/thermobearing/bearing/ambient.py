"""Ambient temperature: constant, or a series in time."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, short_repr
from thermobearing.border.units import is_number, refuse_hidden
from thermobearing.core.records import Floats
from thermobearing.tables.guess import read_air_columns

COLDEST, HOTTEST = -100.0, 100.0  # plausible range of an ambient temperature [degC]


@checked
@dataclass(frozen=True)
class Ambient:
    """Ambient temperature, piecewise linear in time and constant beyond its ends.

    Attributes
    ----------
    time : increasing times [s]; one entry for a constant temperature.
    temperature : at those times [degC].
    """

    time: Floats
    temperature: Floats

    @classmethod
    def constant(cls, temperature: float) -> "Ambient":
        """One temperature [degC] for all times."""
        return cls(np.zeros(1), np.array([check_temperature(temperature, "ambient")]))

    @classmethod
    def series(cls, time: Floats, temperature: Floats, where: str = "ambient series") -> "Ambient":
        """Return a series; InputError unless times increase and temperatures are plausible."""
        for values in (time, temperature):
            refuse_hidden(values, where)
        try:
            time, temperature = np.asarray(time, float), np.asarray(temperature, float)
        except (TypeError, ValueError, OverflowError):
            raise InputError("needs two lists of numbers", where) from None
        if time.ndim != 1 or time.shape != temperature.shape or len(time) < 2:
            raise InputError("needs two equally long lists of at least 2 numbers", where)
        if not np.isfinite(time).all():
            raise InputError("time is not finite", where)
        if not (np.diff(time) > 0).all():
            k = int(np.argmin(np.diff(time) > 0))
            raise InputError(f"time does not increase from {time[k]:g} to {time[k + 1]:g} s", where)
        for value in (temperature.min(), temperature.max()):
            check_temperature(float(value), where)
        return cls(time, temperature)

    @classmethod
    def from_csv(cls, path: str | Path) -> "Ambient":
        """Return a series from a table with columns time and temperature."""
        data = read_air_columns(path).values
        return cls.series(data["time"], data["temperature"], str(path))

    def at(self, time: float) -> float:
        """Return the temperature at a time [degC]."""
        return float(np.interp(time, self.time, self.temperature))

    def means(self, start: float, dt: Floats) -> Floats:
        """Return the mean temperature over each of the steps dt that follow `start` [degC]."""
        if len(self.time) == 1:
            return np.full(len(dt), self.temperature[0])
        # Exact for a piecewise linear series: differences of its integral, with nodes at all its
        # kinks.
        edges = start + np.concatenate([[0.0], np.cumsum(dt)])
        nodes = np.unique(np.concatenate([self.time, edges]))
        values = np.interp(nodes, self.time, self.temperature)
        areas = np.concatenate(
            [[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(nodes))]
        )
        return np.asarray(np.diff(np.interp(edges, nodes, areas)) / np.diff(edges))


def check_temperature(value: float, where: str) -> float:
    """Return the value; InputError unless it is a plausible temperature in degC."""
    if not is_number(value):
        raise InputError(f"expected a temperature in degC, got {short_repr(value)}", where)
    if not COLDEST <= value <= HOTTEST:
        raise InputError(f"{value:g} degC is outside {COLDEST:g} to {HOTTEST:g} degC", where)
    return value
