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
from thermobearing.core.lanes.choose import select
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


@compiled_apart
def has_side_loss(rates: Cells) -> float:
    """Return 1 if a cell loses heat through its side, else 0."""
    loss = 0.0
    for i in range(len(rates.side_loss)):
        loss += rates.side_loss[i]
    return select(loss > 0.0, 1.0, 0.0)


@compiled
def _lost_through_face(
    rates: Cells, temperature: Floats, change: Floats, ambient: float, i: int
) -> float:
    """Heat that an outer cell loses per time [kN mm/s], the mean of a step."""
    mean_excess = temperature[i] - ambient + 0.5 * change[i]
    lost: float = rates.capacity[i] * rates.end_loss[i] * mean_excess
    return lost


@compiled
def eliminate(
    rates: Cells, sides: bool, temperature: Floats, dt: float, ambient: float, cells: CellWork
) -> float:
    """Right sides of all cells, and the way down the matrix; `change` holds the sources [K].

    The explicit change -dt M T + losses is found on the way: the next cell waits for this one
    longer than that takes. Without `sides` no cell loses heat through its side. Returns the heat
    that they lose there per time at the start [kN mm/s], complete bearing.
    """
    change, last_cell = cells.change, len(temperature) - 1
    # Only the outer cells have faces; a single cell has both.
    change[0] -= dt * rates.end_loss[0] * (temperature[0] - ambient)
    if last_cell > 0:
        end_excess = temperature[last_cell] - ambient
        change[last_cell] -= dt * rates.end_loss[last_cell] * end_excess
    last, difference, lost = 0.0, 0.0, 0.0
    for i in range(last_cell + 1):
        # The difference to the cell before is that to the next one of the cell before.
        rate = -rates.to_previous[i] * difference
        if i < last_cell:
            difference = temperature[i + 1] - temperature[i]
            rate += rates.to_next[i] * difference
        if sides:
            loss = rates.side_loss[i] * (temperature[i] - ambient)
            rate -= loss
            lost += rates.capacity[i] * loss
        last = dt * rate + change[i] - cells.elimination[i] * last
        change[i] = last
    return lost


@compiled
def substitute(
    rates: Cells, sides: bool, temperature: Floats, cells: CellWork, after: Floats
) -> tuple[float, float]:
    """The way up the matrix: `change` [K] and temperatures `after` the step.

    Returns the heat stored over the step [kN mm], and, with `sides`, by how much more heat leaves
    there per time at its end than at its start [kN mm/s]; complete bearing.
    """
    change = cells.change
    last, stored, lost = 0.0, 0.0, 0.0
    for i in range(len(temperature) - 1, -1, -1):
        last = change[i] * cells.pivot[i] - cells.upper[i] * last
        change[i] = last
        after[i] = temperature[i] + last
        heat = rates.capacity[i] * last
        stored += heat
        if sides:
            lost += rates.side_loss[i] * heat
    return stored, lost


@compiled
def conduct(
    rates: Cells,
    side_implicit: bool,
    sides: bool,
    temperature: Floats,
    dt: float,
    ambient: float,
    cells: CellWork,
    after: Floats,
) -> tuple[float, float, float]:
    """One step of conduction; `change` holds the sources [K] before and the changes after it.

    Returns the heat stored, and lost through end faces and sides, over the step [kN mm], complete
    bearing.
    """
    start = eliminate(rates, sides, temperature, dt, ambient, cells)
    stored, more = substitute(rates, sides, temperature, cells, after)
    # Losses at the mean of the step; the printed scheme takes the sides at its start (P2).
    by_sides = start + 0.5 * more if side_implicit else start
    last_cell = len(temperature) - 1
    ends = _lost_through_face(rates, temperature, cells.change, ambient, 0)
    if last_cell > 0:
        ends += _lost_through_face(rates, temperature, cells.change, ambient, last_cell)
    return stored, ends * dt, by_sides * dt
