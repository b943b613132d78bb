"""A ground motion from arrays that the caller holds already."""

from typing import Any

import numpy as np

from thermobearing.border.errors import InputError
from thermobearing.border.units import is_number, number_list
from thermobearing.motions.readers import SHORTEST, check_size, checked_step, even_step
from thermobearing.motions.record import ACCELERATION_UNITS, GroundMotion, acceleration_unit


def motion_from_arrays(
    acceleration: Any,
    *,
    unit: str,
    dt: float | None = None,
    time: Any = None,
    name: str = "motion",
    component: str = "",
    trust_unit: bool = False,
) -> GroundMotion:
    """A ground motion from arrays, checked as one from a file is.

    Parameters
    ----------
    acceleration : [n] of the ground, evenly sampled, n >= 2.
    unit : of the acceleration: "g", "gal", "m/s2", "cm/s2" or "mm/s2".
    dt : time step [s], in [1e-5, 0.1]; or
    time : [n] times of the samples [s], increasing in even steps.
    name : of the motion, for tables and figures.
    component : direction, such as "NS"; tells motions of one name apart.
    trust_unit : take the motion even if its largest acceleration is outside 100 to 2000 gal.

    Returns
    -------
    GroundMotion

    Raises
    ------
    InputError : another shape, numbers that are not finite, times that do not increase evenly, an
        unknown unit, an implausible size.

    Examples
    --------
    >>> time = 0.01 * np.arange(200)
    >>> motion_from_arrays(3.0 * np.sin(20.0 * time), unit="m/s2", time=time).dt
    0.01
    """
    where = f'motion "{name}"'
    try:
        values = number_list(acceleration, "acceleration")
        if len(values) < SHORTEST:
            raise InputError(f"holds {len(values)} samples; at least {SHORTEST} are needed")
        found = None
        if time is not None:
            times = number_list(time, "time [s]")
            if len(times) != len(values):
                raise InputError(f"{len(times)} times and {len(values)} accelerations")
            found = even_step(times, list(range(1, len(times) + 1)), "sample")
        if dt is not None and not is_number(dt):
            raise InputError(f"dt = {dt!r}: must be a number of seconds")
        if not isinstance(unit, str):
            raise InputError(f'unit = {unit!r}: must be text, such as "gal"')
        step = checked_step(found, dt)
        size = acceleration_unit(unit)
        plain = _unit_of_size(size)
        largest = float(np.abs(values).max()) * size
        check_size(largest, plain, instrument=False, trusted=trust_unit)
    except InputError as error:
        raise InputError(error.problems, where) from None
    return GroundMotion(str(name), step, values * size, component=component)


def _unit_of_size(size: float) -> str:
    """The first unit of that size [mm/s2].

    Examples
    --------
    >>> _unit_of_size(1000.0)
    'm/s2'
    """
    return next(name for name, value in ACCELERATION_UNITS.items() if value == size)
