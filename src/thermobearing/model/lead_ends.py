"""Heat flow out of lead cores: end plates of finite thickness, shims as fins.

A core exchanges heat with the cells of the stack through ports (core/lead_ends.py): its end
into the plate under it; if it is not confined, its side into the shims, and its foot between
sealing plates into them. The mean of the core and a port are separated by sums of
exponentials, fitted to impedances (model/lead_impedance.py):

* plate: a disc on a plate, its far face with its own film, insulated where the plan's share of
  a core ends; rubber and shims beneath take some of the spot's heat;
* side: annular fins between halves of rubber layers, the rubber at the wall, the core's way to
  its wall and along it to the edges of the shims;
* the core along its axis, cos(n pi z/h). The first two modes are what ends and side have in
  common: where the ends drain the core, the shims deeper inside feel more than its mean.

Each function gives, at `FREQUENCIES` s on the positive real axis, an impedance Z(s): how much
warmer a place becomes by a flow of one [K s/(kN mm)], or an admittance. Such a Z is a sum of
a/(1 + s tau) with a > 0, which `_fitted` finds. Means over the plan are left out: the stack of
cells has them already.
"""

import math
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from thermobearing.bearing.model import Bearing, Material
from thermobearing.core.records import Floats, Rows, filled, rows
from thermobearing.core.types import Constants, LeadCell, Mode
from thermobearing.model.stack import MM_PER_M, EndFace, Stack, film_at_face

RADIAL = 400  # modes of a disc on a plate
AXIAL = 200  # modes of a core
ACROSS = 60  # modes across one shim and one layer
BELOW = 4  # layers and shims that a hot spot of the plate above reaches
FREQUENCIES = np.logspace(-5.0, 1.0, 65)  # 1/s: from tenths of a second to a day
RELAXATIONS = np.logspace(-1.5, 4.5, 11)  # s, to choose from
SMALL = 1e-3  # below it a series is exact to rounding


def _numbers(material: Material) -> tuple[float, float]:
    """Conductivity [kN/(s K)] and heat capacity [kN mm/(mm3 K)]."""
    return material.conductivity / MM_PER_M, material.volumetric_heat


def _fitted(impedance: Floats) -> Floats:
    """[2, K] a and tau of the terms of an impedance: relative least squares with a >= 0."""
    from scipy.optimize import nnls  # imported here: takes a third of a second, only for lead

    terms = 1.0 / (1.0 + FREQUENCIES[:, None] * RELAXATIONS) / impedance[:, None]
    size = np.linalg.norm(terms, axis=0)
    weight, _ = nnls(terms / size, np.ones(len(impedance)), maxiter=100 * len(size))
    kept = weight > 0.0
    return np.array([(weight / size)[kept], RELAXATIONS[kept]])


@cache
def _plan_modes() -> tuple[Floats, Floats]:
    """Zeros of J1, and J0 there: modes of a disc that is insulated at its edge."""
    from scipy.special import j0, jn_zeros

    zeros = jn_zeros(1, RADIAL)
    return zeros, j0(zeros)


def _disc_on_plate(
    steel: Material,
    height: float,
    film: float,
    radius: float,
    plan: float,
    below: tuple[Material, float, float] | None = None,
) -> Floats:
    """Mean over a disc that heats the near face of a plate, less the mean over the plan.

    `steel`, `height`: of the plate; height [mm]; `film`: at its far face [kN/(s mm K)], 0 to inf;
    `radius`: of the disc [mm]; `plan`: radius at which the plate is insulated [mm]; `below`:
    rubber, thickness of its layers and of the shims [mm], if layers lie against the near face
    around the disc; they take heat from the hot spot.
    """
    from scipy.special import j1

    k, heat = _numbers(steel)
    zeros, j0_there = _plan_modes()
    wave = zeros / plan
    share = 4.0 * (j1(wave * radius) / (zeros * j0_there)) ** 2
    own = k * np.sqrt(wave**2 + FREQUENCIES[:, None] * heat / k)
    admittance = _through(own, np.tanh(own / k * height), film)
    if below is not None:
        around = 1.0 - (radius / plan) ** 2
        admittance = admittance + around * _layers(steel, *below, wave=wave)
    return np.asarray((share / admittance).sum(axis=1) / (np.pi * radius**2))


def _through(own: Any, tangent: Any, beyond: Any) -> Any:
    """Admittance of a slab with another one beyond it; `own` k beta, `tangent` tanh(beta H)."""
    if np.isscalar(beyond) and np.isinf(beyond):
        return own / tangent
    return own * (beyond + own * tangent) / (own + beyond * tangent)


def _layers(steel: Material, rubber: Material, layer: float, shim: float, wave: Floats) -> Floats:
    """Admittance of layers and shims to radial modes, per area."""
    k, heat = _numbers(steel)
    k_rubber, heat_rubber = _numbers(rubber)
    s = FREQUENCIES[:, None]
    own = k_rubber * np.sqrt(wave**2 + s * heat_rubber / k_rubber)
    tangent = np.tanh(own / k_rubber * layer)
    total = np.zeros_like(own)
    for _ in range(BELOW):
        total = _through(own, tangent, total + shim * (heat * s + k * wave**2))
    return total


def _core_modes(lead: Material, half_height: float, radius: float, extra: Any = 0.0) -> Floats:
    """[AXIAL, s] modes cos(n pi z/h) of a core, heated by one at z = 0.

    `extra` is the additional admittance per height [kN/(s K)].
    """
    k, heat = _numbers(lead)
    area = np.pi * radius**2
    wave = np.arange(1, AXIAL + 1)[:, None] * np.pi / half_height
    return np.asarray(2.0 / half_height / (area * (heat * FREQUENCIES + k * wave**2) + extra))


def _core_to_wall(lead: Material, height: float, radius: float) -> Floats:
    """Return mean minus wall temperature of a core for uniform flow through the wall."""
    from scipy.special import ive

    k, heat = _numbers(lead)
    x = radius * np.sqrt(FREQUENCIES * heat / k)
    large = np.maximum(x, SMALL)
    total = (large * ive(0, large) / ive(1, large) - 2.0) / large**2
    return np.asarray(np.where(x > SMALL, total, 0.25) / (2.0 * np.pi * k * height))


def _to_edges(lead: Material, height: float, shim: float, layer: float, radius: float) -> Floats:
    """Return shim-edge minus mean wall temperature, when heat leaves through the shims only."""
    from scipy.special import ive

    k, heat = _numbers(lead)
    n = np.arange(1, ACROSS + 1)
    wave = np.sqrt((2.0 * np.pi * n / (shim + layer)) ** 2 + FREQUENCIES[:, None] * heat / k)
    mode = 2.0 * np.sinc(n * shim / (shim + layer)) ** 2
    field = ive(0, wave * radius) / ive(1, wave * radius) / wave
    return np.asarray((mode * field).sum(axis=1) / (2.0 * np.pi * radius * height * k))


def _fin_heat(
    steel: Material, thickness: float, rubber: Material, layer: float, faces: int
) -> Floats:
    """Admittance per area of a fin with half a layer of rubber on one or two faces."""
    _, heat = _numbers(steel)
    k, heat_rubber = _numbers(rubber)
    beta = np.sqrt(FREQUENCIES * heat_rubber / k)
    return np.asarray(
        thickness * heat * FREQUENCIES + faces * k * beta * np.tanh(0.5 * beta * layer)
    )


def _fin(steel: Material, thickness: float, per_area: Floats, radius: float, plan: float) -> Floats:
    """Return inner-edge minus mean temperature of an annular fin heated at that edge (Bessel)."""
    from scipy.special import ive, kve

    across = _numbers(steel)[0] * thickness
    m = np.sqrt(per_area / across)
    inner, outer = m * radius, m * plan
    damped = np.exp(-2.0 * (outer - inner))
    above = kve(0, inner) * ive(1, outer) + ive(0, inner) * kve(1, outer) * damped
    below = kve(1, inner) * ive(1, outer) - ive(1, inner) * kve(1, outer) * damped
    total = above / below / (2.0 * np.pi * radius * across * m)
    return np.asarray(total - 1.0 / (np.pi * (plan**2 - radius**2) * per_area))


def _rubber_at_wall(rubber: Material, layer: float, radius: float) -> Floats:
    """Return the admittance of a layer at the wall, without the share of the adjacent shims."""
    k, heat = _numbers(rubber)
    odd = np.pi * (2.0 * np.arange(RADIAL) + 1.0)
    rate = FREQUENCIES[:, None] * heat / k
    each = 8.0 / odd**2 * rate / np.sqrt((odd / layer) ** 2 + rate)
    return np.asarray(2.0 * np.pi * radius * layer * k * each.sum(axis=1))


Term = tuple[float, float, int, float, int, float]
STEPS_OF_LEAD = 50.0
COMMON = 2  # modes of the core that act on ends and side


class Network(NamedTuple):
    """Ports of the cores: how many, the cells that they heat, terms between core and ports."""

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


class Core(NamedTuple):
    """Sizes of one core in its share of the plan [mm]."""

    radius: float
    plan: float  # radius of the share as a disc
    half: float  # of the height of the core
    foot: float  # of the part between sealing plates that it touches


class Side(NamedTuple):
    """The wall of a core in touch with shims."""

    cells: Any  # of the shims
    shares: Floats  # of the flow
    impedance: Floats  # mean of the core less the shims
    felt: Floats  # [AXIAL] of each mode of the core, at the shims
    extra: Floats  # [AXIAL, s] what the shims take from it beyond that, per height


def _core_sizes(bearing: Bearing, stack: Stack) -> Core:
    """The sizes of a core."""
    lead = bearing.lead
    assert lead is not None
    return Core(
        radius=lead.radius,
        plan=math.sqrt(bearing.area / lead.cores / math.pi),
        half=0.5 * float(stack.beside_lead.sum()),
        foot=0.0 if lead.confined else bearing.geometry.sealing_plate_thickness,
    )


def _core_side(bearing: Bearing, stack: Stack, core: Core) -> Side:
    """The shims as fins of a core that is not confined."""
    g, m = bearing.geometry, bearing.materials
    assert m.lead is not None
    shims = np.flatnonzero([name == "shim" for name in stack.part])
    steel = stack.thickness[shims]
    count, height = steel.sum() / g.shim_thickness, 2.0 * (core.half - core.foot) / stack.fold
    heat = _fin_heat(m.steel, g.shim_thickness, m.rubber, g.rubber_thickness, faces=2)
    each = _fin(m.steel, g.shim_thickness, heat, core.radius, core.plan)
    pitch = g.shim_thickness + g.rubber_thickness
    each += _to_edges(m.lead, pitch, g.shim_thickness, g.rubber_thickness, core.radius)
    taken = count * (1.0 / each + _rubber_at_wall(m.rubber, g.rubber_thickness, core.radius))
    impedance = 1.0 / taken + _core_to_wall(m.lead, height, core.radius)
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


def _end_impedance(bearing: Bearing, core: Core, film: float) -> tuple[Floats, Floats]:
    """End of a core, or its foot: less the plates around it, and [AXIAL] of the core's modes.

    A foot gives heat to the end plate through its end and to the sealing plate through its
    wall: there in the half that is nearer to the middle, from where the heat comes.
    """
    g, m, lead = bearing.geometry, bearing.materials, bearing.lead
    assert lead is not None
    assert m.lead is not None
    below = (m.rubber, g.rubber_thickness, g.shim_thickness)
    plate = _disc_on_plate(
        m.steel,
        g.end_plate_thickness,
        film,
        core.radius,
        core.plan,
        None if g.sealing_plate_thickness > 0.0 else below,
    )
    if core.foot == 0.0:
        return lead.end_spreading * plate, np.ones(AXIAL)
    heat = _fin_heat(m.steel, core.foot, m.rubber, g.rubber_thickness, faces=1)
    around = _fin(m.steel, core.foot, heat, core.radius, core.plan)
    around += _core_to_wall(m.lead, core.foot, core.radius)
    down = float(np.median(around / (plate + around)))  # of the heat, through the end
    n, part = np.arange(1, AXIAL + 1), core.foot / core.half
    wall = np.cos(0.75 * np.pi * n * part) * np.sinc(0.25 * n * part)
    return plate * around / (plate + around), down + (1.0 - down) * wall


def _end_cells(stack: Stack, core: Core) -> list[Any]:
    """Cells that each end heats: the end plate's next to it, or those of the sealing plate."""
    if core.foot == 0.0:
        return [[cell] for cell in np.flatnonzero(stack.touches_lead_end)]
    sealing = np.flatnonzero([name == "sealing_plate" for name in stack.part])
    return list(np.split(sealing, np.flatnonzero(np.diff(sealing) > 1) + 1))


def _end_terms(
    own: Floats, modes: Floats, at_end: Floats, side: Side | None, port: int, fold: int
) -> list[Term]:
    """(a, tau, port, weight, other, other_weight) of one end; the side is port 0."""
    common = 0 if side is None else COMMON
    alone = own + (at_end[common:, None] ** 2 * modes[common:]).sum(axis=0)
    found: list[Term] = [(a, tau, port, 1.0, port, 0.0) for a, tau in _fitted(alone).T]
    for n in range(common):
        assert side is not None
        felt = 0.5 * fold * side.felt[n]
        found += [(a, tau, port, at_end[n], 0, felt) for a, tau in _fitted(modes[n]).T]
    return found


def longest_rest_step(constants: Constants) -> float:
    """Return the longest step of a rest that follows lead and shims in touch [s].

    The flows out of the lead are constant over a step, and heat the cells that they reach before
    these pass it on: as if a resistance dt/C were added to that of the port, with C the heat
    capacity of those cells. It is held at a fiftieth of what is between shims and end plates.
    Confined lead carries no heat from shims to plates, and takes steps of any length.

    `constants`: of the coupled step.
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


def lead_network(bearing: Bearing, stack: Stack, upper: EndFace, lower: EndFace | None) -> Network:
    """Ports of the lead cores of a bearing.

    `upper`, `lower`: heat exchange of the end faces; `lower` is None for a half stack.
    """
    lead, material = bearing.lead, bearing.materials.lead
    assert lead is not None
    assert material is not None
    core = _core_sizes(bearing, stack)
    side = None
    cells: list[tuple[int, int, float]] = []
    terms: list[Term] = []
    if not lead.confined and "shim" in stack.part:
        side = _core_side(bearing, stack, core)
        cells += [(cell, 0, share) for cell, share in zip(side.cells, side.shares, strict=True)]
        terms += [(a, tau, 0, 1.0, 0, 0.0) for a, tau in _fitted(side.impedance).T]
    first = 0 if side is None else 1
    extra = 0.0 if side is None else side.extra
    modes = _core_modes(material, core.half, core.radius, extra)
    faces = [upper] if lower is None else [upper, lower]
    for end, (touched, face) in enumerate(zip(_end_cells(stack, core), faces, strict=True)):
        own, at_end = _end_impedance(bearing, core, film_at_face(face, stack, -end))
        cells += [(cell, first + end, 1.0 / len(touched)) for cell in touched]
        terms += _end_terms(own, modes, at_end, side, first + end, stack.fold)
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
