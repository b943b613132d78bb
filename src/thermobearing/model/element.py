"""Trial, commit, revert: the step for anyone who searches for the displacement.

A structure's Newton iteration, or an outside finite element program, proposes
displacements until it is satisfied; only then does the bearing move on. The wrapper keeps
two states and calls the one coupled step; it adds no physics.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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
from thermobearing.model.outcomes import NAMES


@dataclass(frozen=True)
class Trial:
    """Answer to one proposed displacement."""

    force: float  # [kN]
    tangent: float  # [kN/mm]
    outcome: str


class BearingElement:
    """One bearing for an outside solver.

    Parameters
    ----------
    constants : from `model.constants.build_constants`.
    temperature : cell temperatures at the start [degC].
    """

    def __init__(self, constants: Constants, temperature: NDArray[np.float64]) -> None:
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
