"""Ways of heat out of lead cores: end plates of finite thickness, shims as fins.

A core exchanges heat with the cells of the stack through ports (core/lead_ends.py): its end
into the plate under it; if it is not confined, its side into the shims, and its foot between
sealing plates into them. What separates the mean of the core from a port are sums of
exponentials, fitted to impedances (model/lead_impedance.py):

* plate: a disc on a plate, its far face with its own film, insulated where the plan's share of
  a core ends; rubber and shims beneath take some of the spot's heat;
* side: annular fins between halves of rubber layers, the rubber at the wall, the core's way to
  its wall and along it to the edges of the shims;
* the core along its axis, cos(n pi z/h). The first two modes are what ends and side have in
  common: where the ends drain the core, the shims deeper inside feel more than its mean.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from thermobearing.bearing.model import Bearing
from thermobearing.core.records import Floats, Rows, filled, rows
from thermobearing.core.types import Constants, LeadCell, Mode
from thermobearing.model.lead_impedance import (
    AXIAL,
    core_modes,
    core_to_wall,
    disc_on_plate,
    fin,
    fin_heat,
    fitted,
    rubber_at_wall,
    to_edges,
)
from thermobearing.model.stack import Face, Stack, film_at_face

Term = tuple[float, float, int, float, int, float]

STEPS_OF_LEAD = 50.0
COMMON = 2  # modes of the core that act on ends and side


@dataclass(frozen=True)
class Network:
    """Ports of the cores.

    Attributes
    ----------
    ports : how many.
    cells : which cells they heat.
    modes : [K] terms of what separates core and ports.
    """

    ports: int
    cells: Rows[LeadCell]
    modes: Rows[Mode]


def half_space(end: Floats, side: Floats) -> Network:
    """No ports: the formulas of core/lead.py, with the conductances of each cell."""
    touching = np.flatnonzero(end + side)
    cells = filled(
        LeadCell, cell=touching, end=end[touching], side=side[touching], port=0, share=0.0
    )
    return Network(0, cells, rows(Mode, 0))


@dataclass(frozen=True)
class Core:
    """Sizes of one core in its share of the plan [mm]."""

    radius: float
    plan: float  # radius of the share as a disc
    half: float  # of the height of the core
    foot: float  # of the part between sealing plates that it touches


@dataclass(frozen=True)
class Side:
    """The wall of a core in touch with shims.

    Attributes
    ----------
    cells, shares : of the shims, and how the flow divides among them.
    impedance : mean of the core less the shims.
    felt : [AXIAL] of each mode of the core, at the shims.
    beside : [AXIAL, s] what the shims take from it beyond that, per height.
    """

    cells: Any
    shares: Floats
    impedance: Floats
    felt: Floats
    beside: Floats


def core_of(bearing: Bearing, stack: Stack) -> Core:
    """The sizes of a core."""
    lead = bearing.lead
    assert lead is not None
    return Core(
        radius=lead.radius,
        plan=math.sqrt(bearing.area / lead.cores / math.pi),
        half=0.5 * float(stack.beside_lead.sum()),
        foot=0.0 if lead.confined else bearing.geometry.sealing_plate_thickness,
    )


def side_of(bearing: Bearing, stack: Stack, core: Core) -> Side:
    """The shims as fins of a core that is not confined."""
    g, m = bearing.geometry, bearing.materials
    assert m.lead is not None
    shims = np.flatnonzero([name == "shim" for name in stack.part])
    steel = stack.thickness[shims]
    count, height = steel.sum() / g.shim_thickness, 2.0 * (core.half - core.foot) / stack.fold
    heat = fin_heat(m.steel, g.shim_thickness, m.rubber, g.rubber_thickness, faces=2)
    each = fin(m.steel, g.shim_thickness, heat, core.radius, core.plan)
    pitch = g.shim_thickness + g.rubber_thickness
    each += to_edges(m.lead, pitch, g.shim_thickness, g.rubber_thickness, core.radius)
    taken = count * (1.0 / each + rubber_at_wall(m.rubber, g.rubber_thickness, core.radius))
    impedance = 1.0 / taken + core_to_wall(m.lead, height, core.radius)
    shares = steel / steel.sum()
    depth = stack.depth[shims] - g.end_plate_thickness
    depth = np.minimum(depth, 2.0 * core.half - depth)
    n = np.arange(1, AXIAL + 1)[:, None]
    angle, height_of = n * np.pi * depth / core.half, n * steel / core.half
    felt = (np.cos(angle) * np.sinc(0.5 * height_of)) @ shares  # means over each cell
    squared = (0.5 + 0.5 * np.cos(2.0 * angle) * np.sinc(height_of)) @ shares
    uneven = 2.0 * (squared - felt**2)
    stored = count * np.pi * (core.plan**2 - core.radius**2) * heat
    per_height = 0.5 * stack.fold / core.half / (impedance + 1.0 / stored)
    return Side(shims, shares, impedance, felt, uneven[:, None] * per_height)


def end_of(bearing: Bearing, core: Core, film: float) -> tuple[Floats, Floats]:
    """End of a core, or its foot: less the plates around it, and [AXIAL] of the core's modes.

    A foot gives heat to the end plate through its end and to the sealing plate through its
    wall: there in the half that is nearer to the middle, from where the heat comes.
    """
    g, m, lead = bearing.geometry, bearing.materials, bearing.lead
    assert lead is not None
    assert m.lead is not None
    below = (m.rubber, g.rubber_thickness, g.shim_thickness)
    plate = disc_on_plate(
        m.steel,
        g.end_plate_thickness,
        film,
        core.radius,
        core.plan,
        None if g.sealing_plate_thickness > 0.0 else below,
    )
    if core.foot == 0.0:
        return lead.end_spreading * plate, np.ones(AXIAL)
    heat = fin_heat(m.steel, core.foot, m.rubber, g.rubber_thickness, faces=1)
    around = fin(m.steel, core.foot, heat, core.radius, core.plan)
    around += core_to_wall(m.lead, core.foot, core.radius)
    down = float(np.median(around / (plate + around)))  # of the heat, through the end
    n, part = np.arange(1, AXIAL + 1), core.foot / core.half
    wall = np.cos(0.75 * np.pi * n * part) * np.sinc(0.25 * n * part)
    return plate * around / (plate + around), down + (1.0 - down) * wall


def end_cells(stack: Stack, core: Core) -> list[Any]:
    """Cells that each end heats: the end plate's next to it, or those of the sealing plate."""
    if core.foot == 0.0:
        return [[cell] for cell in np.flatnonzero(stack.touches_lead_end)]
    sealing = np.flatnonzero([name == "sealing_plate" for name in stack.part])
    return list(np.split(sealing, np.flatnonzero(np.diff(sealing) > 1) + 1))


def end_terms(
    own: Floats, modes: Floats, at_end: Floats, side: Side | None, port: int, fold: int
) -> list[Term]:
    """(a, tau, port, weight, other, other_weight) of one end; the side is port 0."""
    common = 0 if side is None else COMMON
    alone = own + (at_end[common:, None] ** 2 * modes[common:]).sum(axis=0)
    found: list[Term] = [(a, tau, port, 1.0, port, 0.0) for a, tau in fitted(alone).T]
    for n in range(common):
        assert side is not None
        felt = 0.5 * fold * side.felt[n]
        found += [(a, tau, port, at_end[n], 0, felt) for a, tau in fitted(modes[n]).T]
    return found


def longest_rest_step(constants: Constants) -> float:
    """Return the longest step of a rest that follows lead and shims in touch [s].

    The flows out of the lead are constant over a step, and heat the cells that they reach before
    these pass it on: as if a resistance dt/C were added to that of the port, with C the heat
    capacity of those cells. It is held at a fiftieth of what is between shims and end plates.
    Confined lead carries no heat from shims to plates, and takes steps of any length.

    Parameters
    ----------
    constants : of the coupled step.

    Examples
    --------
    >>> from thermobearing.bearing.library import load_bearing
    >>> from thermobearing.model.options import build_model
    >>> round(longest_rest_step(build_model(load_bearing("lrb-example")).constants))
    15
    """
    ports, lead = constants.lead_ports, constants.lead
    if ports * lead.fold <= 2.0:  # ends only
        return math.inf
    cells, modes = constants.lead_cells, constants.lead_modes
    at_cell = lead.fold * lead.cores * cells["share"] ** 2
    per_step = np.bincount(cells["port"], at_cell / constants.cells.capacity[cells["cell"]], ports)
    resistance = np.bincount(modes["port"], modes["weight"] ** 2 * modes["resistance"], ports)
    resistance += np.bincount(
        modes["other"], modes["other_weight"] ** 2 * modes["resistance"], ports
    )
    return float(resistance[:2].sum() / per_step[:2].sum() / STEPS_OF_LEAD)


def lead_network(bearing: Bearing, stack: Stack, upper: Face, lower: Face | None) -> Network:
    """Ports of the lead cores of a bearing.

    Parameters
    ----------
    bearing : with lead.
    stack : its cells.
    upper, lower : heat exchange of the end faces; `lower` is None for a half stack.
    """
    lead, material = bearing.lead, bearing.materials.lead
    assert lead is not None
    assert material is not None
    core = core_of(bearing, stack)
    side = None
    cells: list[tuple[int, int, float]] = []
    terms: list[Term] = []
    if not lead.confined and "shim" in stack.part:
        side = side_of(bearing, stack, core)
        cells += [(cell, 0, share) for cell, share in zip(side.cells, side.shares, strict=True)]
        terms += [(a, tau, 0, 1.0, 0, 0.0) for a, tau in fitted(side.impedance).T]
    first = 0 if side is None else 1
    beside = 0.0 if side is None else side.beside
    modes = core_modes(material, core.half, core.radius, beside)
    faces = [upper] if lower is None else [upper, lower]
    for end, (touched, face) in enumerate(zip(end_cells(stack, core), faces, strict=True)):
        own, at_end = end_of(bearing, core, film_at_face(face, stack, -end))
        cells += [(cell, first + end, 1.0 / len(touched)) for cell in touched]
        terms += end_terms(own, modes, at_end, side, first + end, stack.fold)
    cell, port, share = np.array(cells).T
    a, tau, main, weight, other, other_weight = np.array(terms).T
    return Network(
        ports=first + len(faces),
        cells=filled(LeadCell, cell=cell, end=0.0, side=0.0, port=port, share=share),
        modes=filled(
            Mode,
            resistance=a,
            relaxation=tau,
            port=main,
            weight=weight,
            other=other,
            other_weight=other_weight,
        ),
    )
