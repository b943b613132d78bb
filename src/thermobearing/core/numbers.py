"""Constants of the coupled step from the plain numbers of a bearing.

Python builds every model with these functions (model/stack.py, model/constants.py), and the live
page calls them too, for bearings that its reader edits. Units are those of `types.py`; plan sizes
and thicknesses in mm, conductivities in kN/(s K), heats in kN mm/(mm3 K).
"""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermobearing.core.compiled.kernel import compiled
from thermobearing.core.records import Floats, Ints, Rows
from thermobearing.core.types import LayerCells

# Parts of the stack, in the order of `PARTS`.
END_PLATE: Final = 0
SEALING_PLATE: Final = 1
RUBBER: Final = 2
SHIM: Final = 3
MASS: Final = 4  # behind an end face
PARTS: Final = ("end_plate", "sealing_plate", "rubber", "shim", "mass")
LUMP: Final = 1e-6  # thickness of the cell that stands for what is behind a face [mm]
PER_KELVIN: Final = 100.0  # Eq. 4.34 divides T - 23 by 100
FACE_HELD: Final = 1e-9  # of the resistance to an outer cell's middle: less lies beyond the face
SIDE_FLUX: Final = 0.785  # of the flux from a core into the plates around it, Eq. 5.4


class Heights(NamedTuple):
    """What lies in a stack, from face to face; scalars only."""

    layers: int  # rubber layers of the complete bearing
    half: bool  # whether only the upper half is modelled
    end_plate: float  # thicknesses [mm]
    sealing_plate: float  # 0 for none
    rubber: float
    shim: float
    end_plate_cells: int  # in one part each
    sealing_plate_cells: int
    rubber_cells: int
    shim_cells: int
    plate_grading: float  # thickness of a plate cell over that of the next one nearer the rubber
    mass_above: bool  # whether there is something behind the upper face
    mass_below: bool


class StackCells(NamedTuple):
    """Where the cells of a stack go; arrays may have no entries, to count them."""

    part: Ints  # [n] END_PLATE to MASS
    thickness: Floats  # [n] [mm]
    interface: NDArray[np.bool_]  # [n] whether a material interface lies below the cell
    layers: Rows[LayerCells]  # [L]
    multiplicity: Floats  # [L]


@compiled
def _part_size(heights: Heights, part: int) -> tuple[float, int]:
    """Thickness of a part [mm] and its number of cells."""
    if part == END_PLATE:
        return heights.end_plate, heights.end_plate_cells
    if part == SEALING_PLATE:
        return heights.sealing_plate, heights.sealing_plate_cells
    if part == RUBBER:
        return heights.rubber, heights.rubber_cells
    if part == SHIM:
        return heights.shim, heights.shim_cells
    return LUMP, 1


@compiled
def _part_at(heights: Heights, place: int) -> int:
    """Return which part comes at a place, from the upper face down; -1 past the end."""
    outside = 2 if heights.sealing_plate > 0.0 else 1
    inner = heights.layers if heights.half else 2 * heights.layers - 1
    place -= 1 if heights.mass_above else 0
    if place < 0:
        return MASS
    if place == 0:
        return END_PLATE
    if place < outside:
        return SEALING_PLATE
    place -= outside
    if place < inner:
        return RUBBER if place % 2 == 0 else SHIM
    place -= inner
    if heights.half:
        return -1
    if place < outside - 1:
        return SEALING_PLATE
    if place == outside - 1:
        return END_PLATE
    return MASS if place == outside and heights.mass_below else -1


@compiled
def _graded_thickness(grading: float, count: int) -> float:
    """Return the thickness of cells, each `grading` times the one before, over that of the first.

    It is the number of cells, exactly, where they are equal.
    """
    total, power = 0.0, 1.0
    for _ in range(count):
        total += power
        power *= grading
    return total


@compiled
def _lay_part(
    cells: StackCells, part: int, at: int, count: int, innermost: float, grading: float, above: bool
) -> None:
    """Fill the cells of a part, from the side of the rubber outwards.

    `innermost` is the thickness of the first [mm], `grading` that of each over the one before, and
    `above` whether the rubber lies below the part.
    """
    thickness = innermost
    for k in range(count):
        i = at + count - 1 - k if above else at + k
        cells.part[i] = part
        cells.thickness[i] = thickness
        cells.interface[i] = False
        thickness *= grading


@compiled
def lay_cells(heights: Heights, cells: StackCells) -> tuple[int, int]:
    """Fill the cells of a stack; return the number of cells and of modelled rubber layers.

    A half stack ends at the symmetry plane, which cuts its last part in two. Nothing is written
    where there is no room.
    """
    at, layer, place = 0, 0, 0
    part = _part_at(heights, 0)
    while part >= 0:
        thickness, count = _part_size(heights, part)
        after = _part_at(heights, place + 1)
        halved = heights.half and after < 0
        # The symmetry plane cuts the last part: half of it, in half of its cells, rounded up.
        if halved:
            thickness, count = 0.5 * thickness, (count + 1) // 2
        grading = heights.plate_grading if part in (END_PLATE, SEALING_PLATE) else 1.0
        if at + count <= len(cells.part):
            innermost = thickness / _graded_thickness(grading, count)
            _lay_part(cells, part, at, count, innermost, grading, layer == 0)
            cells.interface[at + count - 1] = after >= 0
        if part == RUBBER:
            if layer < len(cells.layers):
                row = cells.layers[layer]
                row.first, row.last = at, at + count
                row.upper_middle, row.lower_middle = at + (count - 1) // 2, at + count // 2
                if halved:  # mid-thickness is the symmetry plane
                    row.upper_middle = row.lower_middle = at + count - 1
                cells.multiplicity[layer] = 2.0 if heights.half and not halved else 1.0
            layer += 1
        at += count
        place += 1
        part = after
    return at, layer


class CellHeat(NamedTuple):
    """Heat of the cells; all [n]."""

    thickness: Floats  # [mm]
    conductivity: Floats  # [kN/(s K)]
    volumetric_heat: Floats  # [kN mm/(mm3 K)]
    area: Floats  # [mm2]


class Fill(NamedTuple):
    """What the parts of a stack are made of; scalars only."""

    steel_conductivity: float
    steel_heat: float
    rubber_conductivity: float
    rubber_heat: float
    area: float  # gross plan area [mm2]
    lead_area: float  # of all cores [mm2]
    fold: int  # 2 for a half stack


class BesideLead(NamedTuple):
    """Contact of the cells with lead; all [n]."""

    height: Floats  # of lead next to the cell, of the complete bearing [mm]
    touches_end: NDArray[np.bool_]  # whether it is the cell of an end plate next to the others


@compiled
def fill_cells(
    fill: Fill, part: Ints, heat: CellHeat, capacity: Floats, beside: BesideLead
) -> None:
    """Fill the heat of the cells, their capacities [kN mm/K] and what touches lead.

    Lead cores pass through all parts but end plates and what is behind them. A mass behind a face
    conducts without limit; its heat is that of steel until it is overwritten.
    """
    last = len(part) - 1
    for i in range(last + 1):
        outside = part[i] == END_PLATE or part[i] == MASS
        conductivity, volumetric = fill.steel_conductivity, fill.steel_heat
        if part[i] == RUBBER:
            conductivity, volumetric = fill.rubber_conductivity, fill.rubber_heat
        elif part[i] == MASS:
            conductivity = math.inf
        heat.conductivity[i], heat.volumetric_heat[i] = conductivity, volumetric
        heat.area[i] = fill.area if outside else fill.area - fill.lead_area
        capacity[i] = fill.fold * volumetric * heat.area[i] * heat.thickness[i]
        beside.height[i] = 0.0 if outside else fill.fold * heat.thickness[i]
        # Only the cell of an end plate that lies against the inner parts touches the lead.
        above, below = part[max(i - 1, 0)], part[min(i + 1, last)]
        inner_above = above != END_PLATE and above != MASS
        inner_below = below != END_PLATE and below != MASS
        beside.touches_end[i] = outside and (inner_above or inner_below)


class CellRates(NamedTuple):
    """Rates at which the cells exchange heat [1/s]; all [n]."""

    to_previous: Floats
    to_next: Floats
    end_loss: Floats
    side_loss: Floats


@compiled
def face_conductance(eta: float, film: float, conductivity: float, thickness: float) -> float:
    """Conductance per area from the middle of an outer cell to the air [kN/(s mm K)].

    `eta` of Eq. 4.15, or 0 for a film [kN/(s mm K)].
    """
    if eta > 0.0:
        return (eta - 1.0) * conductivity / thickness
    # Film and half a cell in series.
    return film / (1.0 + 0.5 * film * thickness / conductivity)


@compiled
def film_at_face(eta: float, film: float, conductivity: float, thickness: float) -> float:
    """Film at the face itself [kN/(s mm K)], without half the outer cell: 0 to inf."""
    to_middle = face_conductance(eta, film, conductivity, thickness)
    # The conductance to the middle less half the cell; an `eta` of 3 leaves no resistance at the
    # face.
    beyond = 1.0 - 0.5 * to_middle * thickness / conductivity
    return to_middle / beyond if beyond > FACE_HELD else math.inf


@compiled
def conserve_heat(
    heat: CellHeat, perimeter: float, side_film: float, upper: float, lower: float, rates: CellRates
) -> None:
    """Fill the rates of the finite-volume balance: what leaves one cell enters the next.

    `upper` and `lower` are conductances of the faces per area; 0 at a symmetry plane.
    """
    last = len(heat.thickness) - 1
    for i in range(last + 1):
        capacity = heat.volumetric_heat[i] * heat.area[i] * heat.thickness[i]
        rates.side_loss[i] = side_film * perimeter * heat.thickness[i] / capacity
        rates.to_previous[i], rates.to_next[i], rates.end_loss[i] = 0.0, 0.0, 0.0
        if i == 0:
            rates.end_loss[i] += upper * heat.area[i] / capacity
        if i == last:
            rates.end_loss[i] += lower * heat.area[i] / capacity
        # Halves of two cells in series, over the smaller of their areas, which is that without
        # lead.
        resistance = 0.5 * heat.thickness[i] / heat.conductivity[i]
        if i > 0:
            neighbour = 0.5 * heat.thickness[i - 1] / heat.conductivity[i - 1]
            area = min(heat.area[i - 1], heat.area[i])
            rates.to_previous[i] = area / (neighbour + resistance) / capacity
        if i < last:
            neighbour = 0.5 * heat.thickness[i + 1] / heat.conductivity[i + 1]
            area = min(heat.area[i], heat.area[i + 1])
            rates.to_next[i] = area / (resistance + neighbour) / capacity


class LayerLaw(NamedTuple):
    """Parameters of one rubber layer as a bearing file has them; scalars only."""

    thickness: float  # [mm]
    post_yield_ratio: float
    layer_stiffness: float  # [kN/mm]
    shape: float
    yield_displacement: float  # [mm]
    hardening: float
    elastic_temperature_coefficient: float
    hysteretic_temperature_coefficient: float
    scragging_strain: float


@compiled
def rubber_numbers(
    law: LayerLaw,
) -> tuple[float, float, float, float, float, float, float, float]:
    """Return numbers of one rubber layer (Eq. 4.34-4.37), in the order of `Rubber`.

    Elastic and hysteretic stiffness, their exponents, hardening, the inverse of the yield
    displacement, unloading curvature and the displacement of scragging.
    """
    return (
        law.post_yield_ratio * law.layer_stiffness,
        (1.0 - law.post_yield_ratio) * law.layer_stiffness,
        law.elastic_temperature_coefficient / PER_KELVIN,
        law.hysteretic_temperature_coefficient / PER_KELVIN,
        law.hardening / law.thickness**2,
        1.0 / law.yield_displacement,
        (1.0 - law.shape) / ((1.0 + law.shape) * law.yield_displacement**2),
        law.scragging_strain * law.thickness,
    )


@compiled
def source_rise(volumetric_heat: float, area: float, thickness: float) -> float:
    """Return the temperature rise of a layer per heat in it [K/(kN mm)]; `area` without lead."""
    return 1.0 / (volumetric_heat * area * thickness)


class CoreSizes(NamedTuple):
    """Parameters of lead cores as a bearing file has them; scalars only."""

    cores: int
    diameter: float  # [mm]
    yield_stress: float  # [MPa]
    surface_ratio: float
    confined: bool
    volumetric_heat: float  # [kN mm/(mm3 K)]
    steel_conductivity: float  # [kN/(s K)]
    diffusivity: float  # of the medium that t+ counts in [mm2/s]


@compiled
def lead_numbers(
    core: CoreSizes,
    parts: Ints,
    beside_lead: Floats,
    touches_end: NDArray[np.bool_],
    fold: int,
    end: Floats,
    side: Floats,
) -> tuple[float, float, float, float, float]:
    """Fill the conductances from lead to each cell: ends, sides (Eq. 5.1-5.7).

    Returns strength of a core, heat capacity, rate of t+, conductance of an end and of all sides.
    """
    radius = 0.5 * core.diameter
    area = math.pi * radius**2
    one_end = area * core.surface_ratio * core.steel_conductivity / radius
    wall = 2.0 * math.pi * core.surface_ratio * core.steel_conductivity / SIDE_FLUX
    height, sides = 0.0, 0.0
    for i in range(len(parts)):
        height += beside_lead[i]
        end[i] = fold * core.cores * one_end if touches_end[i] else 0.0
        steel = parts[i] != RUBBER and not core.confined
        side[i] = core.cores * wall * beside_lead[i] if steel else 0.0
        sides += side[i]
    strength = core.yield_stress * area / 1e3
    capacity = core.volumetric_heat * area * height
    return strength, capacity, core.diffusivity / radius**2, one_end, sides
