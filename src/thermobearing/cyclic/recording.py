"""A recorded displacement history: read from a laboratory's file or its sidecar, and checked."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermobearing.border.errors import InputError
from thermobearing.border.numbers import number_list
from thermobearing.border.sidecar import read_laboratory

Floats = NDArray[np.float64]
START = 1e-3  # of the largest displacement (1 mm at least): how far off a recording may start


def read_recording(path: str, start: float | None) -> tuple[Floats, Floats, list[str]]:
    """Return the time between the points of a recording [s], its displacements [mm], assumptions.

    Parameters
    ----------
    path : table with columns time and displacement, or its sidecar (border/sidecar.py).
    start : where the bearing is when the recording begins [mm]; None if that is not known.

    Raises
    ------
    InputError : unreadable, time that does not increase, or another start.
    """
    readings = read_laboratory(path, optional=("force", "ambient"))
    gaps, displacement = checked_history(
        readings.values["time"], readings.displacement, start, path
    )
    return gaps, displacement, readings.assumptions


def checked_history(
    times: Any, displacements: Any, start: float | None, where: str
) -> tuple[Floats, Floats]:
    """Time between the points of a history [s], and its displacements [mm].

    Parameters
    ----------
    times, displacements : equally long lists, [s] and [mm].
    start : where the bearing is when the history begins [mm]; None if that is not known.
    where : names the history in messages.

    Raises
    ------
    InputError : no lists of numbers, another shape, time that does not increase, another start.

    Examples
    --------
    >>> checked_history([0.0, 0.5], [0.0, 10.0], 0.0, "example")[0].tolist()
    [0.5]
    """
    try:
        time = number_list(times, "time [s]")
        displacement = number_list(displacements, "displacement [mm]")
    except InputError as error:
        raise InputError(error.problems, where) from None
    if len(time) != len(displacement) or len(time) < 2:
        raise InputError(
            f"{len(time)} times and {len(displacement)} displacements; two equally long lists of "
            "at least 2 are needed",
            where,
        )
    gaps = np.diff(time)
    if not (gaps > 0).all():
        k = int(np.argmin(gaps > 0))
        raise InputError(
            f"time does not increase from {time[k]:g} to {time[k + 1]:g} s "
            f"(rows {k + 1} and {k + 2} of the numbers)",
            where,
        )
    if start is not None:
        largest = max(1.0, float(np.abs(displacement).max()))
        if abs(displacement[0] - start) > START * largest:
            raise InputError(
                f"starts at {displacement[0]:g} mm but the bearing is at {start:g} mm; "
                "put a ramp before it",
                where,
            )
    return gaps, displacement
