"""Where a run starts: temperatures uniform or cell by cell, or the end of an earlier result."""

import tomllib
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.border.toml import to_table
from thermobearing.model.handover import MEMORY, PREFIX, SpecimenState, specimen_state

if TYPE_CHECKING:
    from thermobearing.cyclic.case import Case

Floats = NDArray[np.float64]
TEXTS = ("name", "description", "citation")  # of a bearing: nothing that it does


def final_state(data: xr.Dataset, ambient: list[float]) -> SpecimenState:
    """Where a bearing was at the end of an earlier result, in the run at the same ambient.

    Results that hold no state (before 0.2) give temperatures only.

    Raises
    ------
    InputError : several runs, and none or several of them asked for.
    """
    run = _same_run(data, ambient)
    memory = None
    if PREFIX + MEMORY[0] in data:
        memory = {
            key: data[PREFIX + key].values[run] if PREFIX + key in data else [] for key in MEMORY
        }
    return specimen_state(
        data["final_temperature"].values[run],
        float(data["final_lead_temperature"].values[run]),
        memory,
    )


def _same_run(data: xr.Dataset, ambient: list[float]) -> int:
    """Number of the run of a result at an ambient temperature; the only run, if there is one."""
    runs = data["ambient"].values
    if len(runs) == 1:
        return 0
    match: Any = np.flatnonzero(runs == ambient[0]) if len(ambient) == 1 else []
    if len(match) != 1:
        raise InputError(f"has {len(runs)} runs, at {runs} degC; start at one of them only")
    return int(match[0])


def of_another_bearing(data: xr.Dataset, bearing: Bearing) -> str:
    """Why a whole state does not belong to a bearing; empty if it does."""
    theirs = tomllib.loads(data.attrs["case"])["bearing"]
    ours = to_table(bearing)
    differ = [key for key in ours | theirs if theirs.get(key) != ours.get(key)]
    if not set(differ) - set(TEXTS):
        return ""
    return (
        f'is a test of "{data.attrs["bearing"]}", not of this "{bearing.name}" (they differ in '
        f"{', '.join(differ)}); forces and memory go with the bearing, temperatures alone may be "
        "given as initial_profile"
    )


def initial_temperatures(case: "Case", cells: int, ambient: float) -> Floats:
    """Cell temperatures at the start [degC]."""
    given = case.initial_profile
    if case.initial_state is not None:
        given = case.initial_state.temperature
    if given is not None:
        if len(given) != cells:
            raise InputError(
                f"initial_profile has {len(given)} temperatures, but the stack has {cells} cells"
            )
        return np.array(given)
    return np.full(cells, ambient if case.initial is None else case.initial)
