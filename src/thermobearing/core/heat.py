"""One Crank-Nicolson step of conduction through the stack of cells (Eq. 4.6-4.33).

Both schemes of the specification are the same tridiagonal system with other rates: cell i
exchanges heat with its neighbours at the rates `to_previous` and `to_next`, and with the ambient
at the rates `end_loss` and `side_loss` (all 1/s; built in stack.py). Written for the change of
temperature over the step,

    (I + dt/2 M) dT = -dt M T + dt (losses to T_A) + source,

so that the energy books close to rounding. `published` leaves the side loss out of the
matrix (P2: explicit in time, as printed).
"""

from thermobearing.core.compile import compiled
from thermobearing.core.records import Floats
from thermobearing.core.types import Cells, CellWork


@compiled
def factor(rates: Cells, side_implicit: bool, dt: float, cells: CellWork) -> None:
    """LU factors of I + dt/2 M for this dt [s], into the workspace `cells`."""
    half = 0.5 * dt
    previous_upper = 0.0
    previous_pivot = 0.0
    for i in range(len(rates.capacity)):
        loss = rates.end_loss[i]
        if side_implicit:
            loss += rates.side_loss[i]
        a = half * rates.to_previous[i]
        c = half * rates.to_next[i]
        eliminate = -a * previous_pivot
        pivot = 1.0 / (1.0 + a + c + half * loss - eliminate * previous_upper)
        cells.elimination[i] = eliminate
        cells.pivot[i] = pivot
        cells.upper[i] = -c * pivot
        previous_upper = -c
        previous_pivot = pivot


@compiled
def right_side(
    rates: Cells, temperature: Floats, dt: float, ambient: float, cells: CellWork
) -> None:
    """Explicit change of every cell over dt, without the sources: -dt M T + losses."""
    n = len(temperature)
    for i in range(n):
        loss = rates.end_loss[i] + rates.side_loss[i]
        rate = -loss * (temperature[i] - ambient)
        if i > 0:
            rate += rates.to_previous[i] * (temperature[i - 1] - temperature[i])
        if i < n - 1:
            rate += rates.to_next[i] * (temperature[i + 1] - temperature[i])
        cells.change[i] = dt * rate


@compiled
def solve(cells: CellWork) -> None:
    """Replace the right sides `change` by the temperature change [K]."""
    n = len(cells.change)
    last = cells.change[0]
    for i in range(1, n):
        last = cells.change[i] - cells.elimination[i] * last
        cells.change[i] = last
    last *= cells.pivot[n - 1]
    cells.change[n - 1] = last
    for i in range(n - 2, -1, -1):
        last = cells.change[i] * cells.pivot[i] - cells.upper[i] * last
        cells.change[i] = last


@compiled
def balance(
    rates: Cells,
    side_implicit: bool,
    temperature: Floats,
    dt: float,
    ambient: float,
    cells: CellWork,
) -> tuple[float, float, float]:
    """Heat stored, and lost through end faces and sides, over the step [kN mm], whole bearing."""
    side_share = 0.5 if side_implicit else 0.0
    stored = 0.0
    ends = 0.0
    sides = 0.0
    for i in range(len(temperature)):
        above = temperature[i] - ambient
        change = cells.change[i]
        capacity = rates.capacity[i]
        stored += capacity * change
        sides += capacity * rates.side_loss[i] * (above + side_share * change)
        ends += capacity * rates.end_loss[i] * (above + 0.5 * change)
    return stored, ends * dt, sides * dt
