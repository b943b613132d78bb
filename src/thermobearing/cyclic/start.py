"""Temperatures a run starts from: uniform, given cell by cell, or the end of an earlier result."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermobearing.border.errors import InputError
from thermobearing.cyclic.case import Case
from thermobearing.cyclic.result import Result

Floats = NDArray[np.float64]


def final_profile(result: Result, ambient: Any) -> Floats:
    """Cell temperatures at the end of an earlier result; of the run at the same ambient."""
    return np.asarray(result["final_temperature"].values[_same_run(result, ambient)])


def final_lead(result: Result, ambient: Any) -> float | None:
    """Lead temperature at the end of an earlier result; None without lead."""
    value = float(result["final_lead_temperature"].values[_same_run(result, ambient)])
    return None if np.isnan(value) else value


def _same_run(result: Result, ambient: Any) -> int:
    """Number of the run of a result at an ambient temperature; the only run, if there is one."""
    runs = result["ambient"].values
    if len(runs) == 1:
        return 0
    match: Any = np.flatnonzero(runs == ambient) if np.ndim(ambient) == 0 else []
    if len(match) != 1:
        raise InputError(f"initial: the earlier result has runs at {runs} degC; use one of them")
    return int(match[0])


def initial_temperatures(case: Case, cells: int, ambient: float) -> Floats:
    """Cell temperatures at the start [degC]."""
    if case.initial_profile is not None:
        if len(case.initial_profile) != cells:
            raise InputError(
                f"initial_profile has {len(case.initial_profile)} temperatures, "
                f"but the stack has {cells} cells"
            )
        return np.array(case.initial_profile)
    return np.full(cells, ambient if case.initial is None else case.initial)
