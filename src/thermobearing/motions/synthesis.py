"""Ground motions that fit a standard spectrum: from a seeded model of phases, or from a record.

They are stand-ins: they fit the spectrum, and are not the accelerograms of the specifications.
"""

from thermobearing.border.errors import InputError
from thermobearing.motions.jra import kind_and_ground
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
from thermobearing.motions.targets import DesignSpectrum, standard_target

ROOM = 4.0  # [s] of rest before and after a record, for the ringing of changed amplitudes
SHORTEST_RECORD = 5.0  # [s]
SMALLEST_DT, LARGEST_DT = 0.001, 0.02  # half a period of 0.1 s holds at least 2.5 steps
# Where waves cancel in a narrow band, no amplitudes fill the hole: then the phases are drawn
# again. The limit leaves room below the 3 % that are promised.
DRAWS, ACCEPTED = 8, 0.025
LARGEST_SEED = 2**32 - 1


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
    """A ground motion that fits a standard spectrum, the same for the same seed.

    Type I shakes for long; Type II is short with a velocity pulse. It is a stand-in that fits
    the spectrum, not one of the accelerograms of the specifications. Seed 1 of Type II, ground
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
        say how it shakes.
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

    target = spectrum or standard_target(kind, ground, zone_factor)
    fit: Matched | None = None
    effort = Effort(progress=progress)
    for draw in range(DRAWS):
        trial = matched(phases(kind, ground, seed, draw, dt), dt, target.at, effort=effort)
        if fit is None or trial.misfit < fit.misfit:
            fit = trial
        if fit.misfit <= ACCEPTED or effort.spent:
            break
    assert fit is not None
    own = near_fault().get(motion_name(kind, ground, seed))
    stand_in = f"Stand-in, {target.caveat}: synthetic" if target.caveat else "Synthetic"
    return GroundMotion(
        name=f"{target.name}-{seed}",
        dt=dt,
        acceleration=fit.acceleration,
        description=(
            f"{stand_in}, fits {target.told} "
            f"(seed {seed}, misfit {100 * fit.misfit:.1f} % rms over 0.1-3 s)"
        ),
        citation="; ".join(text for text in (target.citation, own and own.citation) if text),
    )


def _check_step(dt: float, where: str) -> None:
    if not SMALLEST_DT <= dt <= LARGEST_DT:
        raise InputError(f"dt: {dt:g} s is outside [{SMALLEST_DT:g}, {LARGEST_DT:g}] s", where)


def match_spectrum(
    record: GroundMotion,
    kind: str | int = "II",
    ground: str | int = "I",
    *,
    zone_factor: float = 1.0,
    spectrum: DesignSpectrum | None = None,
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
    spectrum : to be fitted instead of the standard one, from `load_spectrum`.
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
            f"{record.name} with Fourier amplitudes adjusted to {target.told}, phases kept (misfit "
            f"{100 * fit.misfit:.1f} % rms over 0.1-3 s){caveat}"
        ),
        citation="; ".join(text for text in (record.citation, target.citation) if text),
    )


def check_record(record: GroundMotion) -> None:
    """Whether a motion can be adjusted to a spectrum.

    Raises
    ------
    InputError : it is too short, too long, too coarse or zero throughout.
    """
    _check_step(record.dt, record.name)
    if record.duration < SHORTEST_RECORD:
        raise InputError(
            f"lasts {record.duration:g} s; at least {SHORTEST_RECORD:g} s are needed to fit "
            "periods up to 3 s",
            record.name,
        )
    if record.pga == 0.0:
        raise InputError("is zero throughout: it has no phases to keep", record.name)
    count = len(record.acceleration) + 2 * round(ROOM / record.dt)
    if count > LONGEST_FIT:
        raise InputError(
            f"has {count} samples with the rest around it; at most {LONGEST_FIT} can be "
            "fitted: cut it to its strong part, or take a longer dt",
            record.name,
        )
