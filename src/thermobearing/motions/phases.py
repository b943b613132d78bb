"""Histories that give a made motion its phases: noise under an envelope, and a velocity pulse."""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from thermobearing.border.library import data_path
from thermobearing.border.toml import read_toml, split_sources
from thermobearing.border.units import parse_quantity
from thermobearing.core.types import Floats
from thermobearing.motions.jra import GROUNDS, KINDS
from thermobearing.motions.record import acceleration_unit

# Above this the ground shakes less and less [Hz], as in records; the periods that are fitted
# end at 0.1 s, and white noise beyond would make large, short peaks.
HIGHEST = 10.0


@dataclass(frozen=True)
class Shape:
    """How the strength of shaking goes in time: it rises, stays, and dies away [s]."""

    length: float
    start: float
    strong: float
    end: float
    decay: float

    def times(self, dt: float) -> Floats:
        """Of the samples [s]."""
        return np.arange(round(self.length / dt) + 1, dtype=np.float64) * dt

    def envelope(self, time: Floats) -> Floats:
        """Strength over that while strong."""
        rise = np.clip((time - self.start) / (self.strong - self.start), 0.0, 1.0) ** 2
        return np.asarray(rise * np.exp(-np.maximum(time - self.end, 0.0) / self.decay))


# Our choice: half a minute and more of strong shaking, as in 2003 Tokachi-oki and 2011 Tohoku;
# some seconds, as in 1995 Kobe.
SHAPES = {
    "I": Shape(length=110.0, start=5.0, strong=20.0, end=50.0, decay=12.0),
    "II": Shape(length=50.0, start=5.0, strong=9.0, end=12.0, decay=3.5),
}
# Type II: a velocity pulse with this period [s], longer on softer ground (1995 Kobe: JMA about
# 0.9 s, Takatori 1.3 to 2 s), at this time [s], and its weight against the noise.
PULSE_PERIODS = {"I": 1.0, "II": 1.4, "III": 1.8}
PULSE_TIME, PULSE_CYCLES, PULSE_WEIGHT = 10.0, 1.0, 4.0


@dataclass(frozen=True)
class Pulse:
    """Velocity pulse of a near-fault record, after Mavroeidis and Papageorgiou (2003, Eq. 3).

    v = A/2 (1 + cos(2 pi (t - t0)/(gamma T))) cos(2 pi (t - t0)/T + nu) where
    |t - t0| <= gamma T/2, and zero elsewhere.

    Attributes
    ----------
    amplitude : A [mm/s].
    period : T [s].
    cycles : gamma, > 1.
    phase : nu [rad].
    time : of its middle, t0 [s].
    """

    amplitude: float
    period: float
    cycles: float
    phase: float
    time: float

    def velocity(self, time: Floats) -> Floats:
        """[mm/s] at the given times [s]."""
        angle, hump = self._parts(time)
        return np.asarray(self.amplitude * hump * np.cos(angle + self.phase))

    def acceleration(self, time: Floats) -> Floats:
        """Derivative of the velocity [mm/s2]."""
        angle, hump = self._parts(time)
        slope = np.where(hump > 0.0, -0.5 * np.sin(angle / self.cycles) / self.cycles, 0.0)
        wave = slope * np.cos(angle + self.phase) - hump * np.sin(angle + self.phase)
        return np.asarray(self.amplitude * 2.0 * np.pi / self.period * wave)

    def _parts(self, time: Floats) -> tuple[Floats, Floats]:
        past = time - self.time
        angle = 2.0 * np.pi * past / self.period
        inside = np.abs(past) <= 0.5 * self.cycles * self.period
        return angle, np.where(inside, 0.5 * (1.0 + np.cos(angle / self.cycles)), 0.0)


@dataclass(frozen=True)
class NearFault:
    """The phases of a motion that stands for one accelerogram; see `data/phases`.

    Attributes
    ----------
    shape : of the noise in time.
    noise : its root mean square while strong, below `HIGHEST` [mm/s2].
    pulse : what is added to it.
    peak_time : where the largest acceleration of the accelerogram is [s].
    stream : key of the random numbers.
    citation : of the pulse.
    """

    shape: Shape
    noise: float
    pulse: Pulse
    peak_time: float
    stream: tuple[int, ...]
    citation: str


@cache
def near_fault() -> dict[str, NearFault]:
    """Of the motions that have phases of their own, by name."""
    table = dict(_chosen())
    citation, _ = table.pop("citation"), table.pop("first_draws")
    return {name: _read(row, citation) for name, row in table.items()}


def first_draw(name: str) -> int:
    """Return the number of the first draw of the random phases of a motion.

    Examples
    --------
    >>> first_draw("jra-ii-i-1"), first_draw("jra-i-i-1")
    (2, 0)
    """
    return int(_chosen()["first_draws"].get(name, 0))


@cache
def _chosen() -> dict[str, Any]:
    return dict(split_sources(read_toml(data_path("phases", "near-fault.toml")))[0])


def _read(row: dict[str, Any], citation: str) -> NearFault:
    def quantity(key: str, unit: str) -> float:
        return parse_quantity(row[key], unit)

    number, unit = row["noise"].split()
    return NearFault(
        shape=Shape(**{k: quantity(k, "s") for k in ("length", "start", "strong", "end", "decay")}),
        noise=float(number) * acceleration_unit(unit),
        pulse=Pulse(
            amplitude=quantity("pulse_amplitude", "mm/s"),
            period=quantity("pulse_period", "s"),
            cycles=row["pulse_cycles"],
            phase=quantity("pulse_phase", "rad"),
            time=quantity("pulse_time", "s"),
        ),
        peak_time=quantity("peak_time", "s"),
        stream=tuple(row["stream"]),
        citation=citation,
    )


def phases(kind: str, ground: str, seed: int, draw: int, dt: float) -> Floats:
    """A history [mm/s2] of the type's shape whose Fourier amplitudes are still to be fitted.

    The motions of `data/phases` have their own; the others are Gaussian noise under an
    envelope, with a pulse in it for Type II.

    Parameters
    ----------
    kind, ground : Roman numbers.
    seed : of the random numbers.
    draw : phases of one seed are drawn again under another number, counted from `first_draw`.
    dt : time step [s].
    """
    name = motion_name(kind, ground, seed)
    own = near_fault().get(name)
    if own:
        return _near_fault(own, draw, dt)
    return _noise(kind, ground, seed, first_draw(name) + draw, dt)


def motion_name(kind: str, ground: str, seed: int) -> str:
    """Of a made motion.

    Examples
    --------
    >>> motion_name("II", "I", 1)
    'jra-ii-i-1'
    """
    return f"jra-{kind}-{ground}-{seed}".lower()


def _near_fault(own: NearFault, draw: int, dt: float) -> Floats:
    time = own.shape.times(dt)
    stream = np.random.default_rng([*own.stream[:-1], own.stream[-1] + draw])
    # As white noise, its spectral density does not depend on the time step.
    size = own.noise / np.sqrt(2.0 * HIGHEST * dt)
    values = stream.standard_normal(len(time)) * own.shape.envelope(time) * size
    return _without_highest(values, dt) + own.pulse.acceleration(time)


def _noise(kind: str, ground: str, seed: int, draw: int, dt: float) -> Floats:
    shape = SHAPES[kind]
    time = shape.times(dt)
    # One stream of numbers for each motion and draw.
    key = [seed, KINDS.index(kind), GROUNDS.index(ground), draw]
    stream = np.random.default_rng(key)
    values = stream.standard_normal(len(time)) * shape.envelope(time)
    values /= np.sqrt(dt)  # see above
    if kind == "II":
        period = PULSE_PERIODS[ground]
        width = 0.5 * PULSE_CYCLES * period
        past = (time - PULSE_TIME - 0.5 * stream.uniform(-1.0, 1.0)) / width
        angle = 2.0 * np.pi * past * width / period
        sign = 1.0 if stream.uniform() < 0.5 else -1.0
        pulse = np.cos(angle + 0.5 * np.pi * stream.uniform()) * np.exp(-0.5 * past**2)
        values += sign * PULSE_WEIGHT * pulse / np.sqrt(period) * np.sqrt(shape.decay)
    return _without_highest(values, dt)


def _without_highest(values: Floats, dt: float) -> Floats:
    frequency = np.asarray(np.fft.rfftfreq(len(values), dt), dtype=np.float64)
    gain = 1.0 / (1.0 + (frequency / HIGHEST) ** 4)
    return np.asarray(np.fft.irfft(np.fft.rfft(values) * gain, len(values)))
