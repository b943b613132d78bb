"""Whether the state a run came to can be true: the net below limits of input and of each step."""

import numpy as np

from thermobearing.core.types import Constants, State
from thermobearing.model.limits import temperature_limits

MISSING = 1e-3  # part of the energy that books may miss; rounding comes to 1e-10
LEAST = 1e-3  # energy that this is a part of, at least [kN mm]


def is_physical(constants: Constants, state: State, recoverable_before: float = 0.0) -> bool:
    """Whether every cell has a possible temperature, and the energy books close.

    `recoverable_before` is what an earlier test left in the bearing when the books began
    [kN mm]. The published scheme has gaps in its books by itself: there only the temperatures
    count.
    """
    temperature, books = state.temperature, state.books[0]
    limits = temperature_limits()
    possible = temperature.min() >= limits.absolute_zero
    if not (possible and temperature.max() <= limits.steel_melts):
        return False
    if constants.lead.published or not constants.viscous.heats:
        return True
    released, stored = books.heat_released, books.heat_stored
    lost = books.heat_lost_ends + books.heat_lost_sides
    work, recoverable = books.work_in, books.recoverable - recoverable_before
    scale = MISSING * max(LEAST, float(np.abs([work, recoverable, released, stored, lost]).max()))
    unbalanced = abs(work - released - recoverable)
    return bool(unbalanced <= scale and abs(released - stored - lost) <= scale)
