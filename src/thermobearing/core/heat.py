"""One Crank-Nicolson step of conduction through the stack of cells (Eq. 4.6-4.33).

Both schemes of the specification are the same tridiagonal system with other rates: cell i
exchanges heat with its neighbours at the rates `to_previous` and `to_next`, and with the ambient
at the rates `end_loss` and `side_loss` (all 1/s; built in stack.py). Written for the change of
temperature over the step,

    (I + dt/2 M) dT = -dt M T + dt (losses to T_A) + source,

so that the energy balance closes to rounding. `published` leaves the side loss out of the
matrix (P2: explicit in time, as printed).
"""

from thermobearing.core.compiled.kernel import compiled, compiled_apart
from thermobearing.core.records import Floats
from thermobearing.core.types import Cells, CellWork


@compiled_apart
def factor(rates: Cells, side_implicit: bool, dt: float, cells: CellWork) -> None:
    """LU factors of I + dt/2 M for this dt [s], into the workspace `cells`."""
    # Thomas' algorithm; inverse pivots are kept, so that steps multiply only.
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
def eliminate(
    rates: Cells, temperature: Floats, dt: float, ambient: float, cells: CellWork
) -> None:
    """Right sides of all cells, and the way down the matrix; `change` holds the sources [K].

    The explicit change -dt M T + losses is found on the way: the next cell waits for this one
    longer than that takes.
    """
    n, change = len(temperature), cells.change
    last = 0.0
    for i in range(n):
        loss = rates.end_loss[i] + rates.side_loss[i]
        rate = -loss * (temperature[i] - ambient)
        if i > 0:
            rate += rates.to_previous[i] * (temperature[i - 1] - temperature[i])
        if i < n - 1:
            rate += rates.to_next[i] * (temperature[i + 1] - temperature[i])
        last = dt * rate + change[i] - cells.elimination[i] * last
        change[i] = last


@compiled
def substitute(
    rates: Cells,
    side_implicit: bool,
    temperature: Floats,
    dt: float,
    ambient: float,
    cells: CellWork,
    after: Floats,
) -> tuple[float, float, float]:
    """The way up the matrix: `change` [K], temperatures `after` the step, and the response.

    Returns the heat stored, and lost through end faces and sides, over the step [kN mm], complete
    bearing.
    """
    # Losses at the mean excess of the step; the printed scheme takes the sides at its start (P2).
    side_share = 0.5 if side_implicit else 0.0
    n, change = len(temperature), cells.change
    last, stored, ends, sides = 0.0, 0.0, 0.0, 0.0
    for i in range(n - 1, -1, -1):
        last = change[i] * cells.pivot[i] - cells.upper[i] * last
        change[i] = last
        after[i] = temperature[i] + last
        above = temperature[i] - ambient
        capacity = rates.capacity[i]
        stored += capacity * last
        sides += capacity * rates.side_loss[i] * (above + side_share * last)
        ends += capacity * rates.end_loss[i] * (above + 0.5 * last)
    return stored, ends * dt, sides * dt
