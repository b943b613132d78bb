"""Ground motions that fit a standard spectrum: from a seeded model of phases, or from a record.

They are stand-ins: they fit the spectrum, and are not the accelerograms of the specifications.
"""

from dataclasses import dataclass

import numpy as np

from thermobearing.border.errors import InputError
from thermobearing.core.types import Floats
from thermobearing.motions.jra import GROUNDS, KINDS, kind_and_ground, standard_spectrum
from thermobearing.motions.matching import (
    LONGEST_FIT,
    Effort,
    Matched,
    Progress,
    matched,
)
from thermobearing.motions.process import padded
from thermobearing.motions.record import GroundMotion

ROOM = 4.0  # [s] of rest before and after a record, for the ringing of changed amplitudes
SMALLEST_DT, LARGEST_DT = 0.001, 0.02  # half a period of 0.1 s holds at least 2.5 steps
# Above this the ground shakes less and less [Hz], as in records; the periods that are fitted
# end at 0.1 s, and white noise beyond would make large, short peaks.
HIGHEST = 10.0
# Where waves cancel in a narrow band, no amplitudes fill the hole: then the phases are drawn
# again. The limit leaves room below the 3 % that are promised.
DRAWS, ACCEPTED = 8, 0.025
LARGEST_SEED = 2**32 - 1
CITATION = (
    "Standard spectrum: Japan Road Association, Specifications for Highway Bridges, Part V (2012)"
)


@dataclass(frozen=True)
class _Shape:
    """How the strength of shaking goes in time: it rises, stays, and dies away [s]."""

    length: float
    start: float
    strong: float
    end: float
    decay: float


# Our choice: half a minute and more of strong shaking, as in 2003 Tokachi-oki and 2011 Tohoku;
# some seconds, as in 1995 Kobe.
SHAPES = {
    "I": _Shape(length=110.0, start=5.0, strong=20.0, end=50.0, decay=12.0),
    "II": _Shape(length=50.0, start=5.0, strong=9.0, end=12.0, decay=3.5),
}
# Type II: a velocity pulse with this period [s], longer on softer ground (1995 Kobe: JMA about
# 0.9 s, Takatori 1.3 to 2 s), at this time [s], and its weight against the noise.
PULSE_PERIODS = {"I": 1.0, "II": 1.4, "III": 1.8}
PULSE_TIME, PULSE_CYCLES, PULSE_WEIGHT = 10.0, 1.0, 4.0


def _envelope(time: Floats, shape: _Shape) -> Floats:
    rise = np.clip((time - shape.start) / (shape.strong - shape.start), 0.0, 1.0) ** 2
    return np.asarray(rise * np.exp(-np.maximum(time - shape.end, 0.0) / shape.decay))


def _noise(kind: str, ground: str, seed: int, draw: int, dt: float) -> Floats:
    """Gaussian noise under an envelope, with a pulse in it for Type II: gives the phases."""
    shape = SHAPES[kind]
    time = np.arange(round(shape.length / dt) + 1, dtype=np.float64) * dt
    # One stream of numbers for each motion and draw.
    key = [seed, KINDS.index(kind), GROUNDS.index(ground), draw]
    stream = np.random.default_rng(key)
    values = stream.standard_normal(len(time)) * _envelope(time, shape)
    # As white noise, its spectral density does not depend on the time step.
    values /= np.sqrt(dt)
    if kind == "II":
        period = PULSE_PERIODS[ground]
        width = 0.5 * PULSE_CYCLES * period
        past = (time - PULSE_TIME - 0.5 * stream.uniform(-1.0, 1.0)) / width
        angle = 2.0 * np.pi * past * width / period
        sign = 1.0 if stream.uniform() < 0.5 else -1.0
        pulse = np.cos(angle + 0.5 * np.pi * stream.uniform()) * np.exp(-0.5 * past**2)
        values += sign * PULSE_WEIGHT * pulse / np.sqrt(period) * np.sqrt(shape.decay)
    frequency = np.asarray(np.fft.rfftfreq(len(values), dt), dtype=np.float64)
    gain = 1.0 / (1.0 + (frequency / HIGHEST) ** 4)
    return np.asarray(np.fft.irfft(np.fft.rfft(values) * gain, len(values)))


def make_motion(
    kind: str | int,
    ground: str | int,
    seed: int,
    dt: float = 0.01,
    *,
    zone_factor: float = 1.0,
    progress: Progress | None = None,
) -> GroundMotion:
    """A ground motion that fits a standard spectrum, the same for the same seed.

    Type I shakes for long; Type II is short with a velocity pulse. It is a stand-in that fits
    the spectrum, not one of the accelerograms of the specifications.

    Parameters
    ----------
    kind : "I" (plate boundary) or "II" (inland).
    ground : "I" (hard), "II" or "III" (soft).
    seed : of the random phases, 0 to 4294967295.
    dt : time step [s], in [0.001, 0.02].
    zone_factor : c_z, in [0.01, 2].
    progress : called after each round of the fit with (rounds done, at most).

    Returns
    -------
    GroundMotion : velocity and displacement end at zero; its description tells the root mean
        square misfit of its spectrum over 0.1 to 3 s, at most 3 % unless 400 rounds were too few.

    Raises
    ------
    InputError : an argument out of range.

    Examples
    --------
    >>> make_motion("II", "I", seed=1).name
    'jra-ii-i-1'
    """
    kind, ground = kind_and_ground(kind, ground)
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed <= LARGEST_SEED:
        raise InputError(f"seed: {seed!r} is not a whole number from 0 to {LARGEST_SEED}")
    _check_step(dt, "make_motion")

    def target(periods: Floats) -> Floats:
        return standard_spectrum(kind, ground, periods, zone_factor=zone_factor)

    fit: Matched | None = None
    effort = Effort(progress=progress)
    for draw in range(DRAWS):
        trial = matched(_noise(kind, ground, seed, draw, dt), dt, target, effort=effort)
        if fit is None or trial.misfit < fit.misfit:
            fit = trial
        if fit.misfit <= ACCEPTED or effort.spent:
            break
    assert fit is not None
    return GroundMotion(
        name=f"jra-{kind}-{ground}-{seed}".lower(),
        dt=dt,
        acceleration=fit.acceleration,
        description=(
            f"Stand-in, NOT an accelerogram of the specifications: synthetic, fits the standard "
            f"spectrum of Level 2 Type {kind}, ground {ground}, c_z = {zone_factor:g} "
            f"(seed {seed}, misfit {100 * fit.misfit:.1f} % rms over 0.1-3 s)"
        ),
        citation=CITATION,
    )


def _check_step(dt: float, where: str) -> None:
    if not SMALLEST_DT <= dt <= LARGEST_DT:
        raise InputError(f"dt: {dt:g} s is outside [{SMALLEST_DT:g}, {LARGEST_DT:g}] s", where)


def match_spectrum(
    record: GroundMotion,
    kind: str | int,
    ground: str | int,
    *,
    zone_factor: float = 1.0,
    progress: Progress | None = None,
) -> GroundMotion:
    """A recorded motion with its Fourier amplitudes adjusted to a standard spectrum.

    The phases are kept, as in the accelerograms of the specifications. Rest is added before
    and after the record, for the ringing that changed amplitudes bring.

    Parameters
    ----------
    record : the recorded motion; at least 5 s long and at most 120000 samples, time step at most
        0.02 s.
    kind, ground, zone_factor : as of `standard_spectrum`.
    progress : called after each round of the fit with (rounds done, at most).

    Returns
    -------
    GroundMotion : velocity and displacement end at zero; its description tells the misfit.

    Raises
    ------
    InputError : an argument out of range; a record too short, too long, too coarse or zero
        throughout.

    Examples
    --------
    >>> record = make_motion("II", "I", seed=1)
    >>> match_spectrum(record, "II", "II").name
    'jra-ii-i-1-as-ii-ii'
    """
    kind, ground = kind_and_ground(kind, ground)
    _check_step(record.dt, record.name)
    if record.duration < 5.0:
        raise InputError(
            f"lasts {record.duration:g} s; at least 5 s are needed to fit periods up to 3 s",
            record.name,
        )
    if record.pga == 0.0:
        raise InputError("is zero throughout: it has no phases to keep", record.name)
    room = padded(record, ROOM, ROOM).acceleration
    if len(room) > LONGEST_FIT:
        raise InputError(
            f"has {len(room)} samples with the rest around it; at most {LONGEST_FIT} can be "
            "fitted: cut it to its strong part, or take a longer dt",
            record.name,
        )

    def target(periods: Floats) -> Floats:
        return standard_spectrum(kind, ground, periods, zone_factor=zone_factor)

    fit = matched(room, record.dt, target, finer=True, effort=Effort(progress=progress))
    return GroundMotion(
        name=f"{record.name}-as-{kind}-{ground}".lower(),
        dt=record.dt,
        acceleration=fit.acceleration,
        description=(
            f"{record.name} with Fourier amplitudes adjusted to the standard spectrum of Level 2 "
            f"Type {kind}, ground {ground}, c_z = {zone_factor:g}, phases kept (misfit "
            f"{100 * fit.misfit:.1f} % rms over 0.1-3 s); NOT an accelerogram of the specifications"
        ),
        citation="; ".join(text for text in (record.citation, CITATION) if text),
    )
