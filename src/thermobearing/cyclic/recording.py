"""A recorded displacement history: read from a laboratory's file or its sidecar, and checked."""

import numpy as np
from numpy.typing import NDArray

from thermobearing.border.errors import InputError
from thermobearing.border.sidecar import read_laboratory

Floats = NDArray[np.float64]
START = 1e-3  # of the largest displacement (1 mm at least): how far off a recording may start


def read_recording(path: str, start: float | None) -> tuple[Floats, Floats]:
    """Time between the points of a recording [s], and its displacements [mm].

    Parameters
    ----------
    path : table with columns time and displacement, or its sidecar (border/sidecar.py).
    start : where the bearing is when the recording begins [mm]; None if that is not known.

    Raises
    ------
    InputError : unreadable, time that does not increase, or another start.
    """
    readings = read_laboratory(path, optional=("force", "ambient"))
    time, displacement = readings.values["time"], readings.displacement
    gaps = np.diff(time)
    if not (gaps > 0).all():
        k = int(np.argmin(gaps > 0))
        raise InputError(
            f"time does not increase from {time[k]:g} to {time[k + 1]:g} s "
            f"(rows {k + 1} and {k + 2} of the numbers)",
            path,
        )
    if start is not None:
        largest = max(1.0, float(np.abs(displacement).max()))
        if abs(displacement[0] - start) > START * largest:
            raise InputError(
                f"starts at {displacement[0]:g} mm but the bearing is at {start:g} mm; "
                "put a ramp before it",
                path,
            )
    return gaps, displacement
