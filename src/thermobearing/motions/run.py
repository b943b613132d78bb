"""The story of a ground motion: read or made -> corrected -> measured -> beside a standard one.

a record, or a name ............... load_motion -> `examine_motion` -> MotionResult
a standard spectrum and phases .... MotionCase  -> `run_motion`     -> MotionResult
"""

import re
from dataclasses import dataclass, replace
from pathlib import Path

from thermobearing.motions.jra import kind_and_ground
from thermobearing.motions.library import load_motion
from thermobearing.motions.matching import LARGEST_MISFIT, Progress, misfit
from thermobearing.motions.measures import measure_motion
from thermobearing.motions.process import baseline_corrected, resampled
from thermobearing.motions.record import GroundMotion
from thermobearing.motions.result import POOR_FIT, MotionResult, Reference
from thermobearing.motions.spectrum import DAMPING, check_damping
from thermobearing.motions.synthesis import make_motion, match_spectrum

DEFAULT_SEED, DEFAULT_DT = 1, 0.01  # [s]


def examine_motion(
    motion: GroundMotion,
    kind: str | None = None,
    ground: str | None = None,
    *,
    damping: float = DAMPING,
    baseline: bool = False,
    high_pass: float | None = None,
    command: str = "motions show",
) -> MotionResult:
    """Size, duration, ends and spectrum of a ground motion, beside a standard spectrum.

    Parameters
    ----------
    motion : the ground motion.
    kind, ground : of the standard spectrum, "I" or "II" and "I", "II" or "III"; if neither is
        given, those that a built-in motion was made for, and none for others.
    damping : ratio of critical damping of the response spectrum, in [0, 1).
    baseline : correct the base line first; see `baseline_corrected`.
    high_pass : corner of the filter that goes with it [Hz], > 0; implies `baseline`.
    command : what the summary calls it.

    Raises
    ------
    InputError : an argument out of range, or a motion that is zero throughout.

    Examples
    --------
    >>> examined = examine_motion(load_motion("jra-ii-i-1"))
    >>> examined.reference
    Reference(kind='II', ground='I', zone_factor=1.0)
    >>> examined.misfit < 0.03
    True
    """
    if baseline or high_pass is not None:
        motion = baseline_corrected(motion, high_pass=high_pass)
    return _measured(command, motion, _reference(motion, kind, ground), damping)


@dataclass(frozen=True)
class MotionCase:
    """A motion to be made, as data.

    Attributes
    ----------
    kind, ground, zone_factor : type, ground and c_z of the standard spectrum that it shall fit.
    seed : of random phases, unless there is a record.
    record : the motion whose phases are kept; None for random ones.
    dt : time step [s]; None for that of the record, or 0.01 s.
    """

    kind: str
    ground: str
    zone_factor: float = 1.0
    seed: int = DEFAULT_SEED
    record: GroundMotion | None = None
    dt: float | None = None

    @property
    def name(self) -> str:
        """For a directory: what shall be fitted, by what."""
        if self.record is None:
            return f"jra-{self.kind}-{self.ground}-{self.seed}".lower()
        name = f"{self.record.name}-as-{self.kind}-{self.ground}".lower()
        return re.sub(r"[^\w.+-]+", "-", name)


def make_motion_case(
    kind: str | int = "II",
    ground: str | int = "I",
    *,
    seed: int | None = None,
    record: str | Path | GroundMotion | None = None,
    dt: float | None = None,
    zone_factor: float = 1.0,
    unit: str | None = None,
    component: str | None = None,
    trust_unit: bool = False,
) -> MotionCase:
    """A motion to be made, checked as far as that is quick.

    Parameters
    ----------
    kind, ground : "I" (plate boundary) or "II" (inland); "I" (hard), "II" or "III" (soft).
    seed : of the random phases; 1 by default.
    record : a motion, a name or a file whose phases are kept instead.
    dt : time step [s]; that of the record, or 0.01 s, by default.
    zone_factor : c_z of the region, in [0.01, 2].
    unit, component, trust_unit : of the record, as for `load_motion`.

    Raises
    ------
    InputError : an unknown type or ground, faults in the record.

    Examples
    --------
    >>> make_motion_case("II", "I", record="jra-i-i-1").name
    'jra-i-i-1-as-ii-i'
    """
    kind, ground = kind_and_ground(kind, ground)
    if record is not None and not isinstance(record, GroundMotion):
        record = load_motion(record, unit=unit, component=component, trust_unit=trust_unit)
    seed = DEFAULT_SEED if seed is None else seed
    return MotionCase(kind, ground, zone_factor, seed, record, dt)


def run_motion(case: MotionCase, *, progress: Progress | None = None) -> MotionResult:
    """Make the motion of a case and measure how well it fits.

    Parameters
    ----------
    case : from `make_motion_case`.
    progress : called after each round of the fit with (rounds done, at most).

    Raises
    ------
    InputError : seed, time step or zone factor out of range; a record that cannot be used.

    Examples
    --------
    >>> run_motion(make_motion_case("II", "I", seed=1, dt=0.02)).outcome
    'completed'
    """
    kind, ground, factor = case.kind, case.ground, case.zone_factor
    if case.record is None:
        dt = DEFAULT_DT if case.dt is None else case.dt
        motion = make_motion(kind, ground, case.seed, dt, zone_factor=factor, progress=progress)
    else:
        record = case.record if case.dt is None else resampled(case.record, case.dt)
        motion = match_spectrum(record, kind, ground, zone_factor=factor, progress=progress)
    made = _measured("motions make", motion, Reference(kind, ground, factor), DAMPING)
    assert made.misfit is not None
    return replace(made, outcome=POOR_FIT) if made.misfit > LARGEST_MISFIT else made


def _reference(motion: GroundMotion, kind: str | None, ground: str | None) -> Reference | None:
    """What was asked to be compared with, or what a built-in motion was made for."""
    if kind or ground:
        return Reference(*kind_and_ground(kind or "II", ground or "I"))
    named = re.fullmatch(r"jra-(i|ii)-(i|ii|iii)-\d+", motion.name)
    return Reference(named[1].upper(), named[2].upper()) if named else None


def _measured(
    command: str, motion: GroundMotion, reference: Reference | None, damping: float
) -> MotionResult:
    check_damping(damping)
    measures = measure_motion(motion)
    error = None if reference is None else misfit(motion, reference.at)
    return MotionResult(command, motion, measures, damping, reference, error)
