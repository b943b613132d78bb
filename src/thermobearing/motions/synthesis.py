"""Generated motions that match a target spectrum, with random phases or those of a record.

They fit the spectrum, but are not the accelerograms of the specifications.
Random phases are those of noise under an envelope, with a velocity pulse for Type II.
"""

from functools import cache
from typing import Any, NamedTuple

import numpy as np

from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.library import data_path
from thermobearing.border.toml import read_toml, split_sources
from thermobearing.border.units import parse_quantity
from thermobearing.core.types import Floats
from thermobearing.motions.matching import LONGEST_FIT, Effort, Matched, Progress, matched
from thermobearing.motions.process import padded
from thermobearing.motions.record import ADJUSTED, SYNTHETIC, GroundMotion, acceleration_unit
from thermobearing.motions.targets import (
    GROUNDS,
    KINDS,
    DesignSpectrum,
    kind_and_ground,
    standard_target,
)

ROOM = 4.0  # [s] of rest before and after a record, for the ringing of changed amplitudes
SHORTEST_RECORD = 5.0  # [s]
SMALLEST_DT, LARGEST_DT = 0.001, 0.02  # half a period of 0.1 s holds at least 2.5 steps
# Where waves cancel in a narrow band, no amplitudes fill the hole: then the phases are drawn
# again. The limit leaves a margin below the documented 3 %.
DRAWS, ACCEPTED = 8, 0.025
LARGEST_SEED = 2**32 - 1
# Above this the ground shakes less and less [Hz], as in records; the periods that are fitted
# end at 0.1 s, and white noise beyond would make large, short peaks.
HIGHEST = 10.0


class Shape(NamedTuple):
    """Envelope of the shaking: times of rise, plateau and decay [s]."""

    length: float
    start: float
    strong: float
    end: float
    decay: float

    def _times(self, dt: float) -> Floats:
        """Return the times of the samples [s]."""
        return np.arange(round(self.length / dt) + 1, dtype=np.float64) * dt

    def _envelope(self, time: Floats) -> Floats:
        """Return the envelope, relative to its plateau."""
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


class Pulse(NamedTuple):
    """Velocity pulse of a near-fault record, after Mavroeidis and Papageorgiou (2003, Eq. 3).

    v = A/2 (1 + cos(2 pi (t - t0)/(gamma T))) cos(2 pi (t - t0)/T + nu) where
    |t - t0| <= gamma T/2, and zero elsewhere: `amplitude` A [mm/s], `period` T [s], `cycles`
    gamma > 1, `phase` nu [rad], `time` t0 of its middle [s].
    """

    amplitude: float
    period: float
    cycles: float
    phase: float
    time: float

    def velocity(self, time: Floats) -> Floats:
        """Return the velocity at the given times [mm/s]."""
        angle, hump = self._parts(time)
        return np.asarray(self.amplitude * hump * np.cos(angle + self.phase))

    def acceleration(self, time: Floats) -> Floats:
        """Return the derivative of the velocity [mm/s2]."""
        angle, hump = self._parts(time)
        slope = np.where(hump > 0.0, -0.5 * np.sin(angle / self.cycles) / self.cycles, 0.0)
        wave = slope * np.cos(angle + self.phase) - hump * np.sin(angle + self.phase)
        return np.asarray(self.amplitude * 2.0 * np.pi / self.period * wave)

    def _parts(self, time: Floats) -> tuple[Floats, Floats]:
        offset = time - self.time
        angle = 2.0 * np.pi * offset / self.period
        inside = np.abs(offset) <= 0.5 * self.cycles * self.period
        return angle, np.where(inside, 0.5 * (1.0 + np.cos(angle / self.cycles)), 0.0)


class NearFault(NamedTuple):
    """The phases of a motion that substitutes one accelerogram; see `data/phases`.

    Noise of a `shape` in time, with this root mean square while strong and below `HIGHEST`
    [mm/s2], and a pulse; `peak_time` is that of the largest acceleration of the accelerogram [s],
    `stream` the key of the random numbers, `citation` that of the pulse.
    """

    shape: Shape
    noise: float
    pulse: Pulse
    peak_time: float
    stream: tuple[int, ...]
    citation: str


@cache
def _phase_table() -> dict[str, Any]:
    """Return the numbers of the motions with their own phases, by name, and the first draws."""
    return dict(split_sources(read_toml(data_path("phases", "near-fault.toml")))[0])


@cache
def _near_fault() -> dict[str, NearFault]:
    """Return the motions with their own phases, by name."""
    motions = {}
    for name, row in _phase_table().items():
        if name in ("citation", "first_draws"):
            continue
        number, unit = row["noise"].split()
        units = {"amplitude": "mm/s", "period": "s", "phase": "rad", "time": "s"}
        pulse = {
            key: parse_quantity(row[f"pulse_{key}"], pulse_unit)
            for key, pulse_unit in units.items()
        }
        motions[name] = NearFault(
            shape=Shape(**{key: parse_quantity(row[key], "s") for key in Shape._fields}),
            noise=float(number) * acceleration_unit(unit),
            pulse=Pulse(cycles=row["pulse_cycles"], **pulse),
            peak_time=parse_quantity(row["peak_time"], "s"),
            stream=tuple(row["stream"]),
            citation=_phase_table()["citation"],
        )
    return motions


def _motion_name(kind: str, ground: str, seed: int) -> str:
    """Return the name of a motion that is made from random phases, such as "jra-ii-i-1"."""
    return f"jra-{kind}-{ground}-{seed}".lower()


def _first_draw(name: str) -> int:
    """Return the number of the first draw of the random phases of a motion."""
    return int(_phase_table()["first_draws"].get(name, 0))


def _phases(kind: str, ground: str, seed: int, draw: int, dt: float) -> Floats:
    """Return a history [mm/s2] of the type's shape whose Fourier amplitudes are still to be fitted.

    The motions of `data/phases` have their own; the others are Gaussian noise under an
    envelope, with a pulse in it for Type II. Type and ground are Roman numbers; the phases of one
    seed are drawn again under another `draw`, counted from the first one of the data file.
    """
    name = _motion_name(kind, ground, seed)
    near_fault = _near_fault().get(name)
    if near_fault:
        time = near_fault.shape._times(dt)
        stream = np.random.default_rng([*near_fault.stream[:-1], near_fault.stream[-1] + draw])
        # As white noise, its spectral density does not depend on the time step.
        size = near_fault.noise / np.sqrt(2.0 * HIGHEST * dt)
        values = stream.standard_normal(len(time)) * near_fault.shape._envelope(time) * size
        return _without_highest(values, dt) + near_fault.pulse.acceleration(time)
    draw += _first_draw(name)
    shape = SHAPES[kind]
    time = shape._times(dt)
    # One stream of numbers for each motion and draw.
    key = [seed, KINDS.index(kind), GROUNDS.index(ground), draw]
    stream = np.random.default_rng(key)
    values = stream.standard_normal(len(time)) * shape._envelope(time)
    values /= np.sqrt(dt)  # a spectral density that does not depend on the time step, as above
    if kind == "II":
        period = PULSE_PERIODS[ground]
        width = 0.5 * PULSE_CYCLES * period
        offset = (time - PULSE_TIME - 0.5 * stream.uniform(-1.0, 1.0)) / width
        angle = 2.0 * np.pi * offset * width / period
        sign = 1.0 if stream.uniform() < 0.5 else -1.0
        pulse = np.cos(angle + 0.5 * np.pi * stream.uniform()) * np.exp(-0.5 * offset**2)
        values += sign * PULSE_WEIGHT * pulse / np.sqrt(period) * np.sqrt(shape.decay)
    return _without_highest(values, dt)


def _without_highest(values: Floats, dt: float) -> Floats:
    frequency = np.asarray(np.fft.rfftfreq(len(values), dt), dtype=np.float64)
    gain = 1.0 / (1.0 + (frequency / HIGHEST) ** 4)
    return np.asarray(np.fft.irfft(np.fft.rfft(values) * gain, len(values)))


@checked
def make_motion(
    kind: str | int,
    ground: str | int,
    seed: int,
    dt: float = 0.01,
    *,
    zone_factor: float = 1.0,
    spectrum: DesignSpectrum | None = None,
    progress: Progress | None = None,
) -> GroundMotion:
    """Return a ground motion that fits a standard spectrum, the same for the same seed.

    Type I has a long duration; Type II is short with a velocity pulse. The motion fits the
    spectrum; it is not one of the accelerograms of the specifications. Seed 1 of Type II, ground
    II, has the envelope and the pulse of the record behind its accelerogram (`data/phases`) and,
    with the time step of 0.01 s, its largest acceleration at the same time, 8 s. Seeds 1 to 3 of
    Type II, ground I, have phases with which the design of the bridge of Shen (2023) closes.

    Parameters
    ----------
    kind : "I" (plate boundary) or "II" (inland).
    ground : "I" (hard), "II" or "III" (soft).
    seed : of the random phases, 0 to 4294967295.
    dt : time step [s], in [0.001, 0.02].
    zone_factor : c_z, in [0.01, 2].
    spectrum : to be fitted instead of the standard one, from `load_spectrum`; type and ground then
        determine the envelope.
    progress : called after each round of the fit with (rounds done, at most).

    Returns
    -------
    GroundMotion : velocity and displacement end at zero; its description states the root mean
        square misfit of its spectrum over 0.1 to 3 s, at most 3 % unless 400 rounds were too few.

    Raises
    ------
    InputError : an argument out of range.

    Examples
    --------
    >>> make_motion("II", "I", seed=1, dt=0.02).name
    'jra-ii-i-1'
    """
    kind, ground = kind_and_ground(kind, ground)
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed <= LARGEST_SEED:
        raise InputError(f"seed: {seed!r} is not an integer from 0 to {LARGEST_SEED}")
    _check_step(dt, "make_motion()")

    target = spectrum or standard_target(kind, ground, zone_factor)
    fit: Matched | None = None
    effort = Effort(progress=progress)
    for draw in range(DRAWS):
        trial = matched(_phases(kind, ground, seed, draw, dt), dt, target.at, effort=effort)
        if fit is None or trial.misfit < fit.misfit:
            fit = trial
        if fit.misfit <= ACCEPTED or effort.spent:
            break
    assert fit is not None
    near_fault = _near_fault().get(_motion_name(kind, ground, seed))
    stand_in = (
        f"Stand-in, {target.caveat}: {SYNTHETIC}" if target.caveat else SYNTHETIC.capitalize()
    )
    return GroundMotion(
        name=f"{target.name}-{seed}",
        dt=dt,
        acceleration=fit.acceleration,
        description=(
            f"{stand_in} {target.words} "
            f"(seed {seed}, misfit {100 * fit.misfit:.1f} % rms over 0.1-3 s)"
        ),
        citation="; ".join(
            text for text in (target.citation, near_fault and near_fault.citation) if text
        ),
        target=target,
    )


def _check_step(dt: float, where: str) -> None:
    if not SMALLEST_DT <= dt <= LARGEST_DT:
        raise InputError(f"dt: {dt:g} s is outside [{SMALLEST_DT:g}, {LARGEST_DT:g}] s", where)


@checked
def match_spectrum(
    record: GroundMotion,
    kind: str | int = "II",
    ground: str | int = "I",
    *,
    zone_factor: float = 1.0,
    spectrum: DesignSpectrum | None = None,
    progress: Progress | None = None,
) -> GroundMotion:
    """Return a recorded motion with its Fourier amplitudes adjusted to a standard spectrum.

    The phases are kept, as in the accelerograms of the specifications. Zeros are added before and
    after the record, since changed amplitudes cause ringing.

    Parameters
    ----------
    record : the recorded motion; at least 5 s long and at most 120000 samples, time step at most
        0.02 s.
    kind, ground, zone_factor : as of `standard_spectrum`.
    spectrum : to be fitted instead of the standard one, from `load_spectrum`.
    progress : called after each round of the fit with (rounds done, at most).

    Returns
    -------
    GroundMotion : velocity and displacement end at zero; its description states the misfit.

    Raises
    ------
    InputError : an argument out of range; a record too short, too long, too coarse or zero
        throughout.

    Examples
    --------
    >>> record = make_motion("II", "I", seed=1, dt=0.02)
    >>> match_spectrum(record, "II", "II").name
    'jra-ii-i-1-as-ii-ii'
    """
    target = spectrum or standard_target(*kind_and_ground(kind, ground), zone_factor)
    check_record(record)
    room = padded(record, ROOM, ROOM).acceleration
    fit = matched(room, record.dt, target.at, finer=True, effort=Effort(progress=progress))
    caveat = f"; {target.caveat}" if target.caveat else ""
    as_name = target.name.removeprefix("jra-")
    return GroundMotion(
        name=f"{record.name}-as-{as_name}".lower(),
        dt=record.dt,
        acceleration=fit.acceleration,
        description=(
            f"{record.name} {ADJUSTED} {target.words}, phases kept "
            f"(misfit {100 * fit.misfit:.1f} % rms over 0.1-3 s){caveat}"
        ),
        citation="; ".join(text for text in (record.citation, target.citation) if text),
        target=target,
    )


def check_record(record: GroundMotion) -> None:
    """Raise InputError unless a motion can be adjusted to a spectrum."""
    _check_step(record.dt, record.name)
    if record.duration < SHORTEST_RECORD:
        raise InputError(
            f"lasts {record.duration:g} s; at least {SHORTEST_RECORD:g} s are needed to fit "
            "periods up to 3 s",
            record.name,
        )
    if record.pga == 0.0:
        raise InputError("is zero throughout and has no phases", record.name)
    count = len(record.acceleration) + 2 * round(ROOM / record.dt)
    if count > LONGEST_FIT:
        raise InputError(
            f"has {count} samples with padding; at most {LONGEST_FIT} can be "
            "fitted: cut it to its strong part, or take a longer dt",
            record.name,
        )
