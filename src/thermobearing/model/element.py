"""Trial, commit, revert: the step for anyone who searches for the displacement.

A structure's Newton iteration, or an outside finite element program, proposes
displacements until it is satisfied; only then does the bearing move on. The wrapper keeps
two states and calls the one coupled step; it adds no physics.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermobearing.bearing.ambient import check_temperature
from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.core.march import copy_state
from thermobearing.core.step import step
from thermobearing.core.types import (
    COMPLETED,
    SOFTENED,
    Constants,
    State,
    new_state,
    new_workspace,
)
from thermobearing.model.options import ModelOptions, build_model
from thermobearing.model.outcomes import NAMES


@dataclass(frozen=True)
class Trial:
    """Answer to one proposed displacement."""

    force: float  # [kN]
    tangent: float  # [kN/mm]
    outcome: str


def _of_cells(temperature: Any, cells: int) -> NDArray[np.float64]:
    """Temperature of each cell [degC]."""
    try:
        given = np.asarray(temperature, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"temperature = {temperature!r}: must be in degC, numbers") from None
    if given.ndim and given.shape != (cells,):
        raise InputError(f"temperature: has {given.size} numbers, but the stack has {cells} cells")
    for value in (given.min(), given.max()):
        check_temperature(float(value), "temperature")
    return np.full(cells, given)


class BearingElement:
    """One bearing for an outside solver.

    Parameters
    ----------
    bearing : a Bearing, a library name, or a TOML file; or the constants of a step.
    temperature : at the start [degC], of the whole bearing or of each cell, in [-100, 100].
    options : how to model the bearing; as `run` does by default.

    Raises
    ------
    InputError : no such bearing, or temperatures that do not fit its cells.

    Examples
    --------
    >>> element = BearingElement("shen-hdr-specimen", -20.0)
    >>> trial = element.set_trial(3.0, dt=0.1, ambient=-20.0)
    >>> element.commit()
    >>> trial.outcome, trial.force > 10.0
    ('completed', True)
    """

    def __init__(
        self,
        bearing: Bearing | str | Path | Constants,
        temperature: float | NDArray[np.float64],
        options: ModelOptions | None = None,
    ) -> None:
        constants = (
            bearing
            if isinstance(bearing, Constants)
            else build_model(as_bearing(bearing), options).constants
        )
        temperature = _of_cells(temperature, constants.cells.shape[1])
        self._constants = constants
        self._work = new_workspace(constants)
        self._start = new_state(constants, temperature)
        self._committed = new_state(constants, temperature)
        self._trial = new_state(constants, temperature)

    @property
    def state(self) -> State:
        """The committed state (a live record: copy it to keep it)."""
        return self._committed

    def set_trial(self, x: float, dt: float, ambient: float) -> Trial:
        """Displacement x [mm] after a step dt [s] from the committed state."""
        force, tangent, outcome = step(
            self._constants, self._work, self._committed, x, dt, ambient, self._trial
        )
        if outcome not in (COMPLETED, SOFTENED):
            copy_state(self._committed, self._trial)
        return Trial(force, tangent, NAMES[outcome])

    def commit(self) -> None:
        """Accept the last trial."""
        copy_state(self._trial, self._committed)

    def revert_to_start(self) -> None:
        """Back to the virgin bearing at its first temperatures."""
        copy_state(self._start, self._committed)
        copy_state(self._start, self._trial)

    def save(self) -> State:
        """A copy of the committed state."""
        return State(*(array.copy() for array in self._committed))

    def restore(self, saved: State) -> None:
        """Continue from a state that `save` returned."""
        copy_state(saved, self._committed)
        copy_state(saved, self._trial)
