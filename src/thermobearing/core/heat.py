"""One Crank-Nicolson step of conduction through the stack of cells (Eq. 4.6-4.33).

Both schemes of the specification are the same tridiagonal system with other rates: cell i
exchanges heat with its neighbours at the rates TO_PREVIOUS and TO_NEXT, and with the ambient
at the rates END_LOSS and SIDE_LOSS (all 1/s; built in stack.py). Written
for the change of temperature over the step,

    (I + dt/2 M) dT = -dt M T + dt (losses to T_A) + source,

so that the energy books close to rounding. `published` leaves the side loss out of the
matrix (P2: explicit in time, as printed).
"""

from thermobearing.core.compile import compiled
from thermobearing.core.types import (
    CAPACITY,
    CHANGE,
    ELIMINATION,
    END_LOSS,
    PIVOT,
    SIDE_LOSS,
    TO_NEXT,
    TO_PREVIOUS,
    UPPER,
    Floats,
)


@compiled
def factor(rates: Floats, side_implicit: bool, dt: float, cells: Floats) -> None:
    """LU factors of I + dt/2 M for this dt [s], into the workspace rows of `cells`."""
    half = 0.5 * dt
    previous_upper = 0.0
    previous_pivot = 0.0
    for i in range(rates.shape[1]):
        loss = rates[END_LOSS, i]
        if side_implicit:
            loss += rates[SIDE_LOSS, i]
        a = half * rates[TO_PREVIOUS, i]
        c = half * rates[TO_NEXT, i]
        eliminate = -a * previous_pivot
        pivot = 1.0 / (1.0 + a + c + half * loss - eliminate * previous_upper)
        cells[ELIMINATION, i] = eliminate
        cells[PIVOT, i] = pivot
        cells[UPPER, i] = -c * pivot
        previous_upper = -c
        previous_pivot = pivot


@compiled
def right_side(
    rates: Floats, temperature: Floats, dt: float, ambient: float, cells: Floats
) -> None:
    """Explicit change of every cell over dt, without the sources: -dt M T + losses."""
    n = len(temperature)
    for i in range(n):
        loss = rates[END_LOSS, i] + rates[SIDE_LOSS, i]
        rate = -loss * (temperature[i] - ambient)
        if i > 0:
            rate += rates[TO_PREVIOUS, i] * (temperature[i - 1] - temperature[i])
        if i < n - 1:
            rate += rates[TO_NEXT, i] * (temperature[i + 1] - temperature[i])
        cells[CHANGE, i] = dt * rate


@compiled
def solve(cells: Floats) -> None:
    """Replace the right side in row CHANGE by the temperature change [K]."""
    n = cells.shape[1]
    last = cells[CHANGE, 0]
    for i in range(1, n):
        last = cells[CHANGE, i] - cells[ELIMINATION, i] * last
        cells[CHANGE, i] = last
    last *= cells[PIVOT, n - 1]
    cells[CHANGE, n - 1] = last
    for i in range(n - 2, -1, -1):
        last = cells[CHANGE, i] * cells[PIVOT, i] - cells[UPPER, i] * last
        cells[CHANGE, i] = last


@compiled
def balance(
    rates: Floats,
    side_implicit: bool,
    temperature: Floats,
    dt: float,
    ambient: float,
    cells: Floats,
) -> tuple[float, float, float]:
    """Heat stored, and lost through end faces and sides, over the step [kN mm], whole bearing."""
    side_share = 0.5 if side_implicit else 0.0
    stored = 0.0
    ends = 0.0
    sides = 0.0
    for i in range(len(temperature)):
        above = temperature[i] - ambient
        change = cells[CHANGE, i]
        capacity = rates[CAPACITY, i]
        stored += capacity * change
        sides += capacity * rates[SIDE_LOSS, i] * (above + side_share * change)
        ends += capacity * rates[END_LOSS, i] * (above + 0.5 * change)
    return stored, ends * dt, sides * dt
