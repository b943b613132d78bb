"""Whether the state a run came to can be true: the net below limits of input and of each step."""

from thermobearing.core.types import Constants, State
from thermobearing.model.limits import temperature_limits

MISSING = 1e-3  # part of the energy that books may miss; rounding comes to 1e-10
LEAST = 1e-3  # energy that this is a part of, at least [kN mm]
ENERGIES = (
    "work_in",
    "heat_released",
    "recoverable",
    "heat_stored",
    "heat_lost_ends",
    "heat_lost_sides",
)


def is_physical(constants: Constants, state: State, recoverable_before: float = 0.0) -> bool:
    """Whether every cell has a possible temperature, and the energy books close.

    `recoverable_before` is what an earlier test left in the bearing when the books began
    [kN mm]. The published scheme has gaps in its books by itself: there only the temperatures
    count.
    """
    temperature, limits = state.temperature, temperature_limits()
    possible = temperature.min() >= limits.absolute_zero
    if not (possible and temperature.max() <= limits.steel_melts):
        return False
    if constants.lead.published or not constants.viscous.heats:
        return True
    work, released, recoverable, stored, ends, sides = (
        float(state.books[name][0]) for name in ENERGIES
    )
    recoverable -= recoverable_before
    lost = ends + sides
    scale = MISSING * max(LEAST, *map(abs, (work, recoverable, released, stored, lost)))
    unbalanced = abs(work - released - recoverable)
    return unbalanced <= scale and abs(released - stored - lost) <= scale
