"""Ground motions that fit a standard spectrum: from a seeded model of phases, or from a record.

They are stand-ins: they fit the spectrum, and are not the accelerograms of the specifications.
"""

from thermobearing.border.errors import InputError
from thermobearing.core.types import Floats
from thermobearing.motions.jra import kind_and_ground, standard_spectrum
from thermobearing.motions.matching import (
    LONGEST_FIT,
    Effort,
    Matched,
    Progress,
    matched,
)
from thermobearing.motions.phases import motion_name, near_fault, phases
from thermobearing.motions.process import padded
from thermobearing.motions.record import GroundMotion

ROOM = 4.0  # [s] of rest before and after a record, for the ringing of changed amplitudes
SMALLEST_DT, LARGEST_DT = 0.001, 0.02  # half a period of 0.1 s holds at least 2.5 steps
# Where waves cancel in a narrow band, no amplitudes fill the hole: then the phases are drawn
# again. The limit leaves room below the 3 % that are promised.
DRAWS, ACCEPTED = 8, 0.025
LARGEST_SEED = 2**32 - 1
CITATION = (
    "Standard spectrum: Japan Road Association, Specifications for Highway Bridges, Part V (2012)"
)


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
    the spectrum, not one of the accelerograms of the specifications. Seed 1 of Type II, ground
    II, has the envelope and the pulse of the record behind its accelerogram (`data/phases`) and,
    with the time step of 0.01 s, its largest acceleration at the same time, 8 s.

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
        trial = matched(phases(kind, ground, seed, draw, dt), dt, target, effort=effort)
        if fit is None or trial.misfit < fit.misfit:
            fit = trial
        if fit.misfit <= ACCEPTED or effort.spent:
            break
    assert fit is not None
    name = motion_name(kind, ground, seed)
    own = near_fault().get(name)
    return GroundMotion(
        name=name,
        dt=dt,
        acceleration=fit.acceleration,
        description=(
            f"Stand-in, NOT an accelerogram of the specifications: synthetic, fits the standard "
            f"spectrum of Level 2 Type {kind}, ground {ground}, c_z = {zone_factor:g} "
            f"(seed {seed}, misfit {100 * fit.misfit:.1f} % rms over 0.1-3 s)"
        ),
        citation=f"{CITATION}; {own.citation}" if own else CITATION,
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
