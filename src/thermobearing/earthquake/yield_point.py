"""Where the hinge of a pier yields, from what a run says of it."""

import numpy as np
import xarray as xr


def yield_point(data: xr.Dataset, run: int) -> tuple[float, float] | None:
    """Rotation [rad] and moment [kN m] at which the hinge of the pier yields; None without one.

    The moment is that of the elastic branch, on which the hinge is up to its first yielding.

    Parameters
    ----------
    data : of an earthquake study.
    run : its number.
    """
    ductility = float(data["pier_ductility"][run])
    if not np.isfinite(ductility) or ductility <= 0.0:
        return None
    rotation = float(data["pier_rotation_max"][run]) / ductility
    path = data["pier_rotation"].values[run].astype(float)
    path = path[np.isfinite(path)]
    beyond = np.abs(path) > rotation
    elastic = slice(0, int(beyond.argmax()) if beyond.any() else len(path))
    place = int(np.abs(path[elastic]).argmax()) if len(path[elastic]) else 0
    if not path[place]:
        return None
    return rotation, rotation * float(data["pier_moment"][run, place]) / path[place]
