"""Heat flow out of lead cores as kernels: impedances, and the few terms that stand for them.

A core exchanges heat with the cells of the stack through ports (core/lead_ends.py): its end
into the plate under it; if it is not confined, its side into the shims, and its foot between
sealing plates into them. The mean of the core and a port are separated by sums of
exponentials, fitted to impedances:

* plate: a disc on a plate, its far face with its own film, insulated where the plan's share of
  a core ends; rubber and shims beneath take some of the spot's heat;
* side: annular fins between halves of rubber layers, the rubber at the wall, the core's way to
  its wall and along it to the edges of the shims;
* the core along its axis, cos(n pi z/h). The first two modes are what ends and side have in
  common: where the ends drain the core, the shims deeper inside feel more than its mean.

Each function gives, at s on the positive real axis, an impedance Z(s): how much warmer a place
becomes by a flow of one [K s/(kN mm)], or an admittance. Such a Z is a sum of a/(1 + s tau) with
a > 0, which `fit_terms` finds. Means over the plan are left out: the stack of cells has them
already. Bessel functions are Poisson's integrals by the trapezoidal rule, whose error falls
exponentially, with all terms of one sign (Trefethen and Weideman 2014, SIAM Review 56).
"""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermobearing.core.compiled.kernel import compiled
from thermobearing.core.numbers import END_PLATE, MASS, SEALING_PLATE, SHIM
from thermobearing.core.records import Floats, Ints, Rows
from thermobearing.core.types import LeadCell, Mode

RADIAL: Final = 400  # modes of a disc on a plate
AXIAL: Final = 200  # modes of a core
ACROSS: Final = 60  # modes across one shim and one layer
BELOW: Final = 4  # layers and shims that a hot spot of the plate above reaches
FREQUENCIES: Final = 65
RELAXATIONS: Final = 11
COMMON: Final = 2  # modes of the core that act on ends and side
MOST_TERMS: Final = RELAXATIONS * (1 + 2 * (1 + COMMON))  # of a side and two ends
LARGE: Final = 25.0  # from here on Hankel's expansion of J0 and J1 is exact to rounding
NOTHING: Final = 40.0  # exp(-NOTHING) is no part of a sum
QUARTER_TURN: Final = 16  # intervals of the integrals for J0 and J1
# Rows of the scratch: modes of a disc, modes of a core, impedances, terms, normal equations.
WAVE, SHARE, AT_END, FELT, UNEVEN, SIDE, PER_HEIGHT, PLATE, AROUND, FITTED = range(10)
A, TAU, SIZE, KEPT, NORMAL = range(10, 15)
ROOM: Final = (NORMAL + RELAXATIONS + 1, RADIAL)  # shape of the scratch


class Medium(NamedTuple):
    """A material that conducts heat."""

    conductivity: float  # [kN/(s K)]
    heat: float  # capacity [kN mm/(mm3 K)]


class LeadSizes(NamedTuple):
    """What the flow out of the cores of a bearing depends on; scalars only."""

    steel: Medium
    rubber: Medium
    lead: Medium
    end_plate: float  # thicknesses [mm]
    sealing_plate: float  # 0 for none
    layer: float  # of rubber
    shim: float
    radius: float  # of a core [mm]
    plan: float  # radius of its share of the plan as a disc [mm]
    confined: bool
    spreading: float
    fold: int  # 2 for a half stack
    film_above: float  # at the faces of the end plates [kN/(s mm K)], 0 to inf
    film_below: float


@compiled
def frequency(i: int) -> float:
    """Return one of FREQUENCIES [1/s]: from tenths of a second to a day."""
    rate: float = 10.0 ** (6.0 * i / (FREQUENCIES - 1.0) - 5.0)
    return rate


@compiled
def _hankel(order: float, x: float) -> tuple[float, float]:
    """P and Q of Hankel's expansion (DLMF 10.17.3)."""
    p, q, term, k = 1.0, 0.0, 1.0, 1.0
    while abs(term) > 1e-17:
        term *= (4.0 * order**2 - (2.0 * k - 1.0) ** 2) / (8.0 * k * x)
        q += term
        term *= -(4.0 * order**2 - (2.0 * k + 1.0) ** 2) / (8.0 * (k + 1.0) * x)
        p += term
        k += 2.0
    return p, q


@compiled
def bessel_j(x: float) -> tuple[float, float]:
    """J0 and J1 of x >= 0."""
    if x < LARGE:
        j0, j1 = 0.5 * math.cos(x), 0.5 * math.sin(x)
        for k in range(1, QUARTER_TURN):
            cosine = math.cos(0.5 * math.pi * k / QUARTER_TURN)
            j0 += math.cos(x * cosine)
            j1 += math.sin(x * cosine) * cosine
        return (j0 + 0.5) / QUARTER_TURN, j1 / QUARTER_TURN
    sine, cosine, scale = math.sin(x), math.cos(x), 1.0 / math.sqrt(math.pi * x)
    p, q = _hankel(0.0, x)
    j0 = scale * (p * (cosine + sine) + q * (cosine - sine))
    p, q = _hankel(1.0, x)
    return j0, scale * (p * (sine - cosine) + q * (sine + cosine))


@compiled
def scaled_i(x: float) -> tuple[float, float, float]:
    """I0, I1/x and I2/x^2 of x >= 0, times exp(-x)."""
    count = int(12.0 + 5.0 * math.sqrt(x))
    i0, i1, i2 = 0.5, 0.0, 0.0
    for k in range(1, count + 1):
        rise = 2.0 * math.sin(0.5 * math.pi * k / count) ** 2  # 1 - cos
        if x * rise > NOTHING:
            break
        part = math.exp(-x * rise) * (1.0 if k < count else 0.5)
        squared = rise * (2.0 - rise)  # of the sine
        i0 += part
        i1 += part * squared
        i2 += part * squared**2
    return i0 / count, i1 / count, i2 / (3.0 * count)


@compiled
def scaled_k(x: float) -> tuple[float, float]:
    """K0 and K1 of x > 0, times exp(x)."""
    width = min(0.2, 0.5 / math.sqrt(x))
    k0, k1, rise, k = 0.5, 0.0, 0.0, 0.0
    while x * rise < NOTHING:
        part = math.exp(-x * rise) if k > 0.0 else 0.0
        k0 += part
        k1 += part * rise * (2.0 + rise)  # squared hyperbolic sine
        k += 1.0
        exp_minus_one = math.expm1(0.5 * width * k)
        rise = (
            0.5 * (exp_minus_one + exp_minus_one / (1.0 + exp_minus_one)) ** 2
        )  # hyperbolic cosine - 1
    return width * k0, width * x * k1


@compiled
def fill_radial(radius: float, plan: float, room: Floats) -> None:
    """Modes of a disc on a plate insulated at radius `plan` [mm]: J0 at the zeros of J1."""
    for m in range(RADIAL):
        # The first two terms of McMahon's expansion, then Newton.
        zero = math.pi * (m + 1.25)
        zero -= 3.0 / (8.0 * zero)
        j0 = 1.0
        for _ in range(3):  # Newton
            j0, j1 = bessel_j(zero)
            zero -= j1 / (j0 - j1 / zero)
        _, j1_at_edge = bessel_j(zero * radius / plan)
        room[WAVE, m] = zero / plan
        room[SHARE, m] = 4.0 * (j1_at_edge / (zero * j0)) ** 2


@compiled
def _slab(medium: Medium, height: float, wave: float, s: float) -> tuple[float, float]:
    """Return k beta of a slab, and tanh(beta H)."""
    beta = math.sqrt(wave**2 + s * medium.heat / medium.conductivity)
    depth = beta * height
    return medium.conductivity * beta, math.tanh(depth) if depth < NOTHING else 1.0


@compiled
def _through(k_beta: float, tangent: float, beyond: float) -> float:
    """Admittance of a slab with another one beyond it; `own` k beta, `tangent` tanh(beta H)."""
    if tangent == 1.0:
        return k_beta
    if beyond == math.inf:
        return k_beta / tangent
    return k_beta * (beyond + k_beta * tangent) / (k_beta + beyond * tangent)


@compiled
def disc_on_plate(sizes: LeadSizes, film: float, room: Floats, s: float) -> float:
    """Mean over a disc that heats the near face of an end plate, less the mean over the plan.

    `film` is at the far face [kN/(s mm K)], 0 to inf. Where there are no sealing plates, layers
    and shims lie against the near face around the disc, and take heat from the hot spot.
    """
    around = 1.0 - (sizes.radius / sizes.plan) ** 2
    steel, total = sizes.steel, 0.0
    for m in range(RADIAL):
        wave = room[WAVE, m]
        k_beta, tangent = _slab(steel, sizes.end_plate, wave, s)
        admittance = _through(k_beta, tangent, film)
        if sizes.sealing_plate == 0.0:
            k_beta, tangent = _slab(sizes.rubber, sizes.layer, wave, s)
            shim = sizes.shim * (steel.heat * s + steel.conductivity * wave**2)
            # Layers and shims below, from the farthest to the plate.
            below = 0.0
            for _ in range(BELOW):
                below = _through(k_beta, tangent, below + shim)
            admittance += around * below
        total += room[SHARE, m] / admittance
    return total / (math.pi * sizes.radius**2)


@compiled
def core_mode(
    lead: Medium, half_height: float, radius: float, extra: float, n: int, s: float
) -> float:
    """Mode cos(n pi z/h) of a core, heated by one at z = 0.

    `extra` is the additional admittance per height [kN/(s K)].
    """
    area, wave = math.pi * radius**2, n * math.pi / half_height
    along = area * (lead.heat * s + lead.conductivity * wave**2)
    return 2.0 / half_height / (along + extra)


@compiled
def core_to_wall(lead: Medium, height: float, radius: float, s: float) -> float:
    """Return mean minus wall temperature of a core for uniform flow through the wall."""
    _, i1, i2 = scaled_i(radius * math.sqrt(s * lead.heat / lead.conductivity))
    return i2 / i1 / (2.0 * math.pi * lead.conductivity * height)


@compiled
def to_edges(lead: Medium, shim: float, layer: float, radius: float, s: float) -> float:
    """Return shim-edge minus mean wall temperature, when heat leaves through the shims only."""
    pitch, total = shim + layer, 0.0
    for n in range(1, ACROSS + 1):
        squared = (2.0 * math.pi * n / pitch) ** 2 + s * lead.heat / lead.conductivity
        i0, i1, _ = scaled_i(radius * math.sqrt(squared))
        total += _sinc(n * shim / pitch) ** 2 * i0 / (i1 * squared)
    return total / (math.pi * radius**2 * pitch * lead.conductivity)


@compiled
def _sinc(x: float) -> float:
    return math.sin(math.pi * x) / (math.pi * x)


@compiled
def fin_heat(
    steel: Medium, thickness: float, rubber: Medium, layer: float, faces: int, s: float
) -> float:
    """Admittance per area of a fin with half a layer of rubber on one or two faces."""
    k_beta, tangent = _slab(rubber, 0.5 * layer, 0.0, s)
    return thickness * steel.heat * s + faces * k_beta * tangent


@compiled
def fin(steel: Medium, thickness: float, per_area: float, radius: float, plan: float) -> float:
    """Return inner-edge minus mean temperature of an annular fin heated at that edge (Bessel)."""
    across = steel.conductivity * thickness
    m = math.sqrt(per_area / across)
    inner, outer = m * radius, m * plan
    # The Bessel functions are scaled by exponentials; what is left of them is this factor.
    damped = math.exp(-2.0 * (outer - inner))
    i0, i1, _ = scaled_i(inner)
    k0, k1 = scaled_k(inner)
    _, i1_outer, _ = scaled_i(outer)
    _, k1_outer = scaled_k(outer)
    above = k0 * outer * i1_outer + i0 * k1_outer * damped
    below = k1 * outer * i1_outer - inner * i1 * k1_outer * damped
    total = above / below / (2.0 * math.pi * radius * across * m)
    return total - 1.0 / (math.pi * (plan**2 - radius**2) * per_area)


@compiled
def rubber_at_wall(rubber: Medium, layer: float, radius: float, s: float) -> float:
    """Return the admittance of a layer at the wall, without the share of the adjacent shims."""
    rate, total = s * rubber.heat / rubber.conductivity, 0.0
    for m in range(RADIAL):
        odd = math.pi * (2.0 * m + 1.0)
        total += 8.0 / odd**2 * rate / math.sqrt((odd / layer) ** 2 + rate)
    return 2.0 * math.pi * radius * layer * rubber.conductivity * total


@compiled
def _sweep(matrix: Floats, p: int, sign: float) -> None:
    """Solve normal equations for one more unknown (`way` 1), or for one less (-1)."""
    pivot = 1.0 / matrix[p, p]
    for i in range(len(matrix)):
        for j in range(len(matrix)):
            if p not in (i, j):
                matrix[i, j] -= matrix[i, p] * pivot * matrix[p, j]
    for i in range(len(matrix)):
        matrix[i, p] *= sign * pivot
        matrix[p, i] *= sign * pivot
    matrix[p, p] = -pivot


@compiled
def _fill_normal(room: Floats) -> None:
    """Normal equations of the relative misfit of all terms, the right side last."""
    room[A:] = 0.0
    for i in range(FREQUENCIES):
        for j in range(RELAXATIONS):
            room[TAU, j] = 10.0 ** (6.0 * j / (RELAXATIONS - 1.0) - 1.5)
            room[A, j] = 1.0 / (1.0 + frequency(i) * room[TAU, j]) / room[FITTED, i]
        room[A, RELAXATIONS] = 1.0
        for j in range(RELAXATIONS):
            for k in range(RELAXATIONS + 1):
                room[NORMAL + j, k] += room[A, j] * room[A, k]
    for j in range(RELAXATIONS):
        room[SIZE, j] = math.sqrt(room[NORMAL + j, j])
    room[A] = 0.0


@compiled
def fit_terms(room: Floats) -> None:
    """Fit a/(1 + s tau) with a >= 0 to the row FITTED: relative least squares, rows A and TAU.

    The non-negative least squares of Lawson and Hanson (1974, chapter 23): a term that lowers the
    misfit most comes in; the first that would become negative leaves.
    """
    _fill_normal(room)
    matrix = room[NORMAL:, : RELAXATIONS + 1]
    for _ in range(20 * RELAXATIONS):
        # How far the kept terms can go towards their least squares before one becomes negative.
        step_length, at, steepest = 1.0, -1, 1e-12
        for j in range(RELAXATIONS):
            a, target = room[A, j], matrix[j, RELAXATIONS]
            if room[KEPT, j] > 0.0 and target <= 0.0 and a < step_length * (a - target):
                at, step_length = j, a / (a - target)
        for j in range(RELAXATIONS):
            # If all can go there, the term that lowers the misfit most comes in.
            slope = matrix[j, RELAXATIONS] / room[SIZE, j]
            if room[KEPT, j] > 0.0:
                room[A, j] += step_length * (matrix[j, RELAXATIONS] - room[A, j])
            elif step_length == 1.0 and slope > steepest:
                at, steepest = j, slope
        if at < 0:
            break
        _sweep(matrix, at, 1.0 - 2.0 * room[KEPT, at])
        room[KEPT, at] = 1.0 - room[KEPT, at]
        room[A, at] = 0.0


@compiled
def fill_side(sizes: LeadSizes, half: float, steel: float, room: Floats) -> None:
    """The shims as fins of a core that is not confined: mean of the core less the shims.

    Also what the shims take from a mode of the core beyond that, per height. `half` is half the
    height of the core, `steel` the thickness of the modelled shims [mm].
    """
    count, height = steel / sizes.shim, 2.0 * (half - sizes.sealing_plate) / sizes.fold
    for i in range(FREQUENCIES):
        s = frequency(i)
        heat = fin_heat(sizes.steel, sizes.shim, sizes.rubber, sizes.layer, 2, s)
        resistance = fin(sizes.steel, sizes.shim, heat, sizes.radius, sizes.plan)
        resistance += to_edges(sizes.lead, sizes.shim, sizes.layer, sizes.radius, s)
        admittance = count * (
            1.0 / resistance + rubber_at_wall(sizes.rubber, sizes.layer, sizes.radius, s)
        )
        room[SIDE, i] = 1.0 / admittance + core_to_wall(sizes.lead, height, sizes.radius, s)
        stored = count * math.pi * (sizes.plan**2 - sizes.radius**2) * heat
        room[PER_HEIGHT, i] = 0.5 * sizes.fold / half / (room[SIDE, i] + 1.0 / stored)


@compiled
def fill_felt(half: float, steel: float, part: Ints, thickness: Floats, room: Floats) -> None:
    """How much of each mode of the core the shims feel, which are `steel` thick together [mm]."""
    for n in range(1, AXIAL + 1):
        felt, squared, depth = 0.0, 0.0, 0.0
        for i in range(len(part)):
            if part[i] == SHIM:  # means over each cell
                angle = n * math.pi * (depth + 0.5 * thickness[i]) / half
                height = n * thickness[i] / half
                share = thickness[i] / steel
                felt += share * math.cos(angle) * _sinc(0.5 * height)
                squared += share * (0.5 + 0.5 * math.cos(2.0 * angle) * _sinc(height))
            if part[i] != END_PLATE and part[i] != MASS:
                depth += thickness[i]
        room[FELT, n - 1] = felt
        room[UNEVEN, n - 1] = 2.0 * (squared - felt**2)


@compiled
def _median(values: Floats) -> float:
    """The middle one of an odd number of values."""
    for i in range(len(values)):
        smaller, equal = 0, 0
        for j in range(len(values)):
            smaller += values[j] < values[i]
            equal += values[j] == values[i]
        if smaller <= len(values) // 2 < smaller + equal:
            return float(values[i])
    return math.nan


@compiled
def fill_end(sizes: LeadSizes, half: float, film: float, room: Floats) -> None:
    """End of a core, or its foot: less the plates around it, and weights of the core's modes.

    A foot gives heat to the end plate through its end and to the sealing plate through its
    wall: there in the half that is nearer to the middle, from where the heat comes.
    """
    foot = 0.0 if sizes.confined else sizes.sealing_plate
    for i in range(FREQUENCIES):
        s = frequency(i)
        plate = disc_on_plate(sizes, film, room, s)
        room[PLATE, i] = sizes.spreading * plate
        if foot > 0.0:
            heat = fin_heat(sizes.steel, foot, sizes.rubber, sizes.layer, 1, s)
            around = fin(sizes.steel, foot, heat, sizes.radius, sizes.plan)
            around += core_to_wall(sizes.lead, foot, sizes.radius, s)
            room[PLATE, i] = plate * around / (plate + around)
            room[AROUND, i] = around / (plate + around)
    # One share for all frequencies, since weights of modes do not depend on it.
    down = (
        _median(room[AROUND, :FREQUENCIES]) if foot > 0.0 else 1.0
    )  # of the heat, through the end
    for n in range(1, AXIAL + 1):
        wall = 0.0
        if foot > 0.0:
            wall = math.cos(0.75 * math.pi * n * foot / half) * _sinc(0.25 * n * foot / half)
        room[AT_END, n - 1] = down + (1.0 - down) * wall


@compiled
def _fill_fitted(
    sizes: LeadSizes, half: float, room: Floats, common: int, end: bool, n: int
) -> None:
    """What is fitted: mode n of the core, or for 0 a port with the modes that are its own."""
    for i in range(FREQUENCIES):
        s = frequency(i)
        room[FITTED, i] = room[PLATE if end else SIDE, i] if n == 0 else 0.0
        for m in range(1, AXIAL + 1):
            if m == n or (n == 0 and end and m > common):
                extra = room[UNEVEN, m - 1] * room[PER_HEIGHT, i]
                mode = core_mode(sizes.lead, half, sizes.radius, extra, m, s)
                room[FITTED, i] += mode if n > 0 else room[AT_END, m - 1] ** 2 * mode


@compiled
def fill_network(
    sizes: LeadSizes,
    part: Ints,
    thickness: Floats,
    touches_end: NDArray[np.bool_],
    room: Floats,
    cells: Rows[LeadCell],
    modes: Rows[Mode],
) -> tuple[int, int, int]:
    """Fill the ports of lead cores: the cells that they heat, terms between core and ports.

    `part`, `thickness` and `touches_end` are those of the cells (core/numbers.py); `cells` has
    room for all of them, `modes` for MOST_TERMS, and `room` is scratch. Returns the number of
    ports, of cells and of terms.
    """
    half, steel, ends = 0.0, 0.0, 0
    foot = sizes.sealing_plate > 0.0 and not sizes.confined
    for i in range(len(part)):
        if part[i] != END_PLATE and part[i] != MASS:
            half += 0.5 * sizes.fold * thickness[i]
        if part[i] == SHIM and not sizes.confined:
            steel += thickness[i]
        ends += (part[i] == SEALING_PLATE) if foot else touches_end[i]
    faces, first, cell_count, term_count = 3 - sizes.fold, 1 if steel > 0.0 else 0, 0, 0
    for i in range(len(part)):
        if part[i] == SHIM and steel > 0.0:
            cells[cell_count].cell, cells[cell_count].share = i, thickness[i] / steel
            cell_count += 1
        elif (part[i] == SEALING_PLATE) if foot else touches_end[i]:
            cells[cell_count].cell, cells[cell_count].share = i, faces / ends
            cells[cell_count].port = first + (faces == 2 and 2 * i >= len(part))
            cell_count += 1
    room[:] = 0.0
    if steel > 0.0:
        fill_felt(half, steel, part, thickness, room)
        fill_side(sizes, half, steel, room)
    fill_radial(sizes.radius, sizes.plan, room)
    common = COMMON if first > 0 else 0
    for port in range(first + faces):
        if port >= first:
            fill_end(sizes, half, sizes.film_above if port == first else sizes.film_below, room)
        for n in range(common + 1 if port >= first else 1):
            _fill_fitted(sizes, half, room, common, port >= first, n)
            fit_terms(room)
            for j in range(RELAXATIONS):
                if room[A, j] > 0.0:
                    row = modes[term_count]
                    row.resistance, row.relaxation = room[A, j], room[TAU, j]
                    row.port, row.second_port = port, 0 if n > 0 else port
                    row.weight = room[AT_END, n - 1] if n > 0 else 1.0
                    row.second_weight = 0.5 * sizes.fold * room[FELT, n - 1] if n > 0 else 0.0
                    term_count += 1
    return first + faces, cell_count, term_count
