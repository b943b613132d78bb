"""Pairs of horizontal ground motions: two records of one place, and their direction in plan."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.units import is_number
from thermobearing.core.types import Floats
from thermobearing.motions.process import SAME_STEP, resampled
from thermobearing.motions.record import GroundMotion

LARGEST_ANGLE, HALF_TURN = 360.0, 180.0  # [deg]


class RotationMeasures(NamedTuple):
    """Measures of a response that do not depend on the axes of the records (Boore, 2010)."""

    rotd50: Floats  # median over the angles
    rotd100: Floats  # largest over the angles


@checked
@dataclass(frozen=True)
class MotionPair:
    """Two horizontal components of a ground motion and their direction in plan.

    Attributes
    ----------
    first, second : records of equal time step and length. The second acts at a right angle to the
        first, turned from it as y is from x.
    angle : from the axis x (along the bridge) to the direction of the first record [deg], in
        [-360, 360], positive from x to y.
    name : for tables and file names; by default the names of both records, joined by "+".

    Raises
    ------
    InputError : records of different steps or lengths, or an angle outside its range.

    Examples
    --------
    >>> import numpy as np
    >>> north = GroundMotion("north", 0.01, np.array([0.0, 100.0]))
    >>> east = GroundMotion("east", 0.01, np.array([0.0, 0.0]))
    >>> MotionPair(north, east, angle=90.0).rotated().tolist()
    [[0.0, 0.0], [0.0, 100.0]]
    """

    first: GroundMotion
    second: GroundMotion
    angle: float = 0.0
    name: str = ""

    def __post_init__(self) -> None:
        first, second = self.first, self.second
        if not self.name:
            names = dict.fromkeys([first.name, second.name])
            object.__setattr__(self, "name", "+".join(names))
        faults = [*_misfits(first, second), *_angle_faults(self.angle)]
        if faults:
            raise InputError(faults, f'MotionPair "{self.name}"')

    @property
    def dt(self) -> float:
        """Time between samples [s]."""
        return self.first.dt

    @property
    def time(self) -> Floats:
        """Times of the samples [s]."""
        return self.first.time

    @property
    def duration(self) -> float:
        """Time of the last sample [s]."""
        return self.first.duration

    @property
    def pga(self) -> float:
        """Largest resultant of both components [mm/s2]."""
        return float(np.hypot(self.first.acceleration, self.second.acceleration).max())

    def __repr__(self) -> str:
        return f"<MotionPair {self.name} at {self.angle:g} deg: {self.first!r}, {self.second!r}>"

    def rotated(self, angle: float | None = None) -> Floats:
        """Return the components along x and y, [samples, 2] [mm/s2], by default at `angle`.

        Parameters
        ----------
        angle : another one than that of the pair [deg], in [-360, 360].
        """
        angle = self.angle if angle is None else angle
        if faults := _angle_faults(angle):
            raise InputError(faults, f'MotionPair "{self.name}"')
        cosine, sine = pair_direction(angle)
        first, second = self.first.acceleration, self.second.acceleration
        return np.column_stack([cosine * first - sine * second, sine * first + cosine * second])

    def along(self, axis: Literal["x", "y"]) -> GroundMotion:
        """Return the component along an axis as a ground motion with the name of the pair."""
        values = self.rotated()[:, "xy".index(axis)].copy()
        # No combination of two records fits the spectrum of one.
        target = self.first.target if axis == "x" and self.angle == 0.0 else None
        return replace(self.first, name=self.name, acceleration=values, component="", target=target)


def pair_direction(angle: float) -> tuple[float, float]:
    """Return the cosine and the sine of an angle [deg], exact at right angles."""
    radians = math.radians(angle)
    cosine, sine = math.cos(radians), math.sin(radians)
    return (float(round(cosine)), float(round(sine))) if angle % 90.0 == 0.0 else (cosine, sine)


def distinct_angles(angles: Sequence[float]) -> list[int]:
    """Return the places of angles [deg] that are not half a turn from an earlier one.

    Half a turn changes the sign of the motion, and the sign of every response of a structure and
    bearings that resist both signs alike.
    """
    # The second remainder is for angles that rounding brings to half a turn, which is zero again.
    reduced = [round(float(angle) % HALF_TURN, 9) % HALF_TURN for angle in angles]
    return [place for place, angle in enumerate(reduced) if angle not in reduced[:place]]


def rotation_measures(values: ArrayLike, angles: Sequence[float] | None = None) -> RotationMeasures:
    """Return RotD50 and RotD100 of largest absolute responses [angle, ...] to a pair.

    NaN, of a run that failed, makes the measures NaN. Of `angles` [deg], those half a turn from an
    earlier one count once; by default all values count.
    """
    responses = np.asarray(values, dtype=np.float64)
    responses = responses if angles is None else responses[distinct_angles(angles)]
    return RotationMeasures(np.median(responses, axis=0), np.max(responses, axis=0))


def _angle_faults(angle: object) -> list[str]:
    """Return why a number is not an angle of a pair."""
    if is_number(angle) and abs(angle) <= LARGEST_ANGLE:  # type: ignore[arg-type]
        return []
    limits = f"a number from {-LARGEST_ANGLE:g} to {LARGEST_ANGLE:g} deg"
    return [f"angle = {angle!r}: must be {limits}"]


def _misfits(first: GroundMotion, second: GroundMotion) -> list[str]:
    """Return how the steps and lengths of two records differ."""
    first_name, second_name = _name(first, second), _name(second, first)
    faults = []
    if abs(first.dt - second.dt) > SAME_STEP * first.dt:
        faults.append(
            f"time steps differ: {first_name} of {first.dt:g} s and {second_name} of "
            f"{second.dt:g} s"
        )
    if len(first.acceleration) != len(second.acceleration):
        faults.append(
            f"lengths differ: {first_name} has {len(first.acceleration)} samples "
            f"({first.duration:g} s) and {second_name} has {len(second.acceleration)} samples "
            f"({second.duration:g} s)"
        )
    if faults:
        faults[-1] += (
            "; resample = true in the table of the motion, or --resample, makes them equal"
        )
    return faults


def _name(motion: GroundMotion, partner: GroundMotion) -> str:
    """Return the name of a record, with its component where the names are equal."""
    if motion.name != partner.name:
        return motion.name
    return f"{motion.name} {motion.component}".strip()


def make_pair(
    first: GroundMotion,
    second: GroundMotion | None = None,
    angle: float = 0.0,
    *,
    resample: bool = False,
    name: str = "",
) -> MotionPair:
    """Return a pair of two records, or of one record and no motion across it.

    With `resample` the second record is brought to the time step of the first, and both are cut to
    the length of the shorter one.
    """
    if second is None:
        zero_motion = replace(first, acceleration=np.zeros(len(first.acceleration)))
        return MotionPair(first, zero_motion, angle, name or first.name)
    if resample:
        second = replace(resampled(second, first.dt), dt=first.dt)
        count = min(len(first.acceleration), len(second.acceleration))
        pair = (first, second)
        first, second = (
            replace(record, acceleration=record.acceleration[:count]) for record in pair
        )
    return MotionPair(first, second, angle, name)
