"""Heat in a bearing in two dimensions: axisymmetric finite elements, by scikit-fem.

    rho c dT/dt = 1/r d/dr (r k dT/dr) + d/dz (k dT/dz) + source

over r from the axis and z from the upper face down to the symmetry plane. What the package
lumps into cells, films and a formula for the lead is resolved here: heat spreads sideways in
the plates, the lead core has its own field, no half-space is assumed. The sources come from
a run of the package, so that only the heat is compared.

A bearing without lead is a disc of the same plan area; its side film is scaled so that film x
perimeter is that of the bearing. With n lead cores it is one core with its share of the plan
as a disc around it, insulated outside. A confined core touches the end plate only (the nodes
of its wall are doubled); else it touches all that is around it.

Biquadratic elements on a graded mesh; in time the two-stage SDIRK method of order two
(L-stable), one factorisation per step size. Units: kN, mm, s, degC (1 J = 1 kN mm).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import SuperLU, splu
from skfem import (
    Basis,
    BilinearForm,
    ElementQuad0,
    ElementQuad2,
    FacetBasis,
    InteriorFacetBasis,
    LinearForm,
    MeshQuad,
)

from thermobearing.bearing.model import Bearing, Material

Floats = NDArray[np.float64]

SDIRK = 1.0 - 1.0 / math.sqrt(2.0)
CONDUCTIVITY = 1e-3  # W/(m K) -> kN/(s K)
FILM = 1e-6  # W/(m2 K) -> kN/(s mm K)
NEAR = 1e-9  # mm, of nodes that are one


@dataclass(frozen=True)
class Block:
    """A rectangle of one material, in r and z [mm]."""

    name: str
    r: tuple[float, float]
    z: tuple[float, float]
    material: Material


@dataclass(frozen=True)
class Problem:
    """Geometry, mesh lines and losses [kN/(s mm K)] of one unit cell."""

    r: Floats  # mesh lines
    z: Floats
    blocks: tuple[Block, ...]
    face_film: float = 0.0  # at z = 0
    side_film: float = 0.0  # at the largest r
    slit: tuple[float, float] | None = None  # an insulating gap at radius r, below depth z
    planes: tuple[tuple[str, float, float], ...] = ()  # name, depth, inner radius: means wanted


def graded(start: float, end: float, count: int, ratio: float = 1.0) -> Floats:
    """Mesh lines after `start` up to `end`; the last interval is `ratio` times the first."""
    steps = ratio ** (np.arange(count) / max(count - 1, 1))
    lines = start + (end - start) * np.cumsum(steps) / steps.sum()
    lines[-1] = end
    return np.asarray(lines)


def make_mesh(problem: Problem) -> MeshQuad:
    """Return the mesh of the lines of a problem, its nodes doubled along the slit."""
    rows, columns = len(problem.z), len(problem.r)
    z, r = (part.ravel() for part in np.meshgrid(problem.z, problem.r, indexing="ij"))
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    quads = np.array([corner, corner + 1, corner + columns + 1, corner + columns])
    if problem.slit is not None:
        radius, depth = problem.slit
        doubled = np.flatnonzero((np.abs(r - radius) < NEAR) & (z > depth + NEAR))
        twin = np.arange(len(r))
        twin[doubled] = len(r) + np.arange(len(doubled))
        outside = r[corner] > radius - NEAR
        quads[:, outside] = twin[quads[:, outside]]
        r, z = np.append(r, r[doubled]), np.append(z, z[doubled])
    return MeshQuad(np.array([r, z]), quads)


@BilinearForm  # type: ignore[untyped-decorator]
def _capacity(u: Any, v: Any, w: Any) -> Any:
    return 2.0 * np.pi * w.x[0] * w.value * u * v


@BilinearForm  # type: ignore[untyped-decorator]
def _conduction(u: Any, v: Any, w: Any) -> Any:
    return 2.0 * np.pi * w.x[0] * w.value * (u.grad[0] * v.grad[0] + u.grad[1] * v.grad[1])


@BilinearForm  # type: ignore[untyped-decorator]
def _film(u: Any, v: Any, w: Any) -> Any:
    return 2.0 * np.pi * w.x[0] * u * v


@LinearForm  # type: ignore[untyped-decorator]
def _mean(v: Any, w: Any) -> Any:
    return 2.0 * np.pi * w.x[0] * v


@dataclass(frozen=True)
class History:
    """Temperatures above the ambient at every step; heat balance [kN mm]."""

    time: Floats
    means: dict[str, Floats]  # of every block and plane
    final: Floats  # at the nodes of the elements
    released: float
    stored: float
    lost: float


class FiniteElements:
    """Matrices of one problem; `march` carries the temperature through time."""

    def __init__(self, problem: Problem) -> None:
        mesh = make_mesh(problem)
        self.basis = Basis(mesh, ElementQuad2())
        centre = mesh.p[:, mesh.t].mean(axis=1)
        owner = np.full(mesh.t.shape[1], -1)
        for number, block in enumerate(problem.blocks):
            inside_r = (centre[0] > block.r[0]) & (centre[0] < block.r[1])
            owner[inside_r & (centre[1] > block.z[0]) & (centre[1] < block.z[1])] = number
        if (owner < 0).any():
            raise ValueError("part of the mesh belongs to no block")
        materials = [block.material for block in problem.blocks]
        heat = np.array([m.volumetric_heat for m in materials])[owner]
        conductivity = np.array([m.conductivity * CONDUCTIVITY for m in materials])[owner]
        cells = self.basis.with_element(ElementQuad0())
        self.capacity = _capacity.assemble(self.basis, value=cells.interpolate(heat))
        self.losses = self._films(mesh, problem)
        conduction = _conduction.assemble(self.basis, value=cells.interpolate(conductivity))
        self.stiffness = conduction + self.losses
        self.weights: dict[str, Floats] = {}  # mean = weights @ T, and load of a unit source
        for number, block in enumerate(problem.blocks):
            part = Basis(mesh, ElementQuad2(), elements=np.flatnonzero(owner == number))
            self._add(block.name, _mean.assemble(part))
        for name, depth, inner in problem.planes:
            facets = mesh.facets_satisfying(
                lambda x, d=depth, a=inner: (np.abs(x[1] - d) < NEAR) & (x[0] > a)
            )
            part = InteriorFacetBasis(mesh, ElementQuad2(), facets=facets)
            self._add(name, _mean.assemble(part))

    def _add(self, name: str, integral: Floats) -> None:
        self.weights[name] = self.weights.get(name, 0.0) + integral / integral.sum()

    def _films(self, mesh: MeshQuad, problem: Problem) -> csc_matrix:
        """Exchange with the ambient through the face z = 0 and the outer radius."""
        face = mesh.facets_satisfying(lambda x: x[1] < NEAR, boundaries_only=True)
        outer = problem.r[-1] - NEAR
        side = mesh.facets_satisfying(lambda x: x[0] > outer, boundaries_only=True)
        total = csc_matrix(self.capacity.shape)
        for facets, film in ((face, problem.face_film), (side, problem.side_film)):
            if film > 0.0:
                total += film * _film.assemble(FacetBasis(mesh, ElementQuad2(), facets=facets))
        return total

    def factors(self, dt: float) -> SuperLU:
        """Of one stage; symmetric and positive definite, so no pivoting is needed."""
        matrix = csc_matrix(self.capacity + SDIRK * dt * self.stiffness)
        options = {"SymmetricMode": True}
        return splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)

    def march(
        self,
        stages: Sequence[tuple[float, int]],
        heat: dict[str, tuple[Floats, Floats]] | None = None,
        start: Floats | None = None,
    ) -> History:
        """Temperatures above the ambient.

        Parameters
        ----------
        stages : step size [s] and number of steps, one after the other.
        heat : by block, times [s] and heat released there until then [kN mm]; the heat of a
            step is spread evenly over the step and the block.
        start : at the nodes; zero if not given.
        """
        heat = heat or {}
        steps = np.concatenate([np.full(count, dt) for dt, count in stages])
        time = np.concatenate([[0.0], np.cumsum(steps)])
        loads = np.array([self.weights[name] for name in heat]).T
        amounts = np.array([np.diff(np.interp(time, *curve)) for curve in heat.values()]).T
        t = np.zeros(self.basis.N) if start is None else start.copy()
        gauge = np.array(list(self.weights.values()))
        means = [gauge @ t]
        capacities, sink = (np.asarray(m.sum(axis=0)).ravel() for m in (self.capacity, self.losses))
        lost, begin, factored = 0.0, float(capacities @ t), (0.0, self.factors(float(steps[0])))
        for i, dt in enumerate(steps):
            if factored[0] != dt:
                factored = (dt, self.factors(dt))
            load = loads @ amounts[i] / dt if heat else 0.0
            first = factored[1].solve(load - self.stiffness @ t)
            middle = t + SDIRK * dt * first
            between = t + (1.0 - SDIRK) * dt * first
            second = factored[1].solve(load - self.stiffness @ between)
            lost += dt * (1.0 - SDIRK) * float(sink @ middle)
            lost += dt * SDIRK * float(sink @ (between + SDIRK * dt * second))
            t = between + SDIRK * dt * second
            means.append(gauge @ t)
        table = np.array(means)
        stored = float(capacities @ t) - begin
        named = {name: table[:, k] for k, name in enumerate(self.weights)}
        return History(time, named, t, float(amounts.sum()), stored, lost)


def bearing_problem(bearing: Bearing, eta: float = 2.0, fineness: float = 1.0) -> Problem:
    """The upper half of a bearing with an even number of layers, as one unit cell.

    The face film is the one that eta of Eq. 4.15 stands for with the outer cell of the
    package: (eta - 1) k/dx from the middle of that cell, without the half cell.
    """
    g, m, lead = bearing.geometry, bearing.materials, bearing.lead
    if g.rubber_layers % 2:
        raise ValueError("the middle layer would be cut: not provided for")
    share = bearing.area / (lead.cores if lead else 1)
    radius, core = math.sqrt(share / math.pi), lead.radius if lead else 0.0
    blocks, lines, planes = [], [np.zeros(1)], []
    parts = [("end plate", g.end_plate_thickness, 10, m.steel)]
    parts += [("sealing plate", g.sealing_plate_thickness, 8, m.steel)] * (
        g.sealing_plate_thickness > 0.0
    )
    for j in range(1, g.rubber_layers // 2 + 1):
        parts += [(f"rubber {j}", g.rubber_thickness, 4, m.rubber)]
        parts += [(f"shim {j}", g.shim_thickness, 2, m.steel)]
    parts[-1] = (parts[-1][0], 0.5 * g.shim_thickness, 1, m.steel)
    depth = 0.0
    for name, thickness, count, material in parts:
        elements = 2 * round(0.5 * count * fineness + 0.2)  # even: a line at mid-thickness
        ratio = {"end plate": 0.03, "sealing plate": 30.0}.get(name, 1.0) if lead else 1.0
        lines.append(graded(depth, depth + thickness, elements, ratio))
        across = (core if name != "end plate" else 0.0, radius)
        blocks.append(Block(name, across, (depth, depth + thickness), material))
        if name.startswith("rubber"):
            planes.append((f"middle of {name}", depth + 0.5 * thickness, core))
        depth += thickness
    count = max(2, round(9 * fineness))
    radial = [np.zeros(1), graded(core, radius, count, 30.0 if lead else 0.2)]
    slit = None
    if lead is not None and m.lead is not None:
        radial.insert(1, graded(0.0, core, max(2, round(7 * fineness)), 0.03))
        blocks.append(Block("lead", (0.0, core), (g.end_plate_thickness, depth), m.lead))
        slit = (core, g.end_plate_thickness) if lead.confined else None
    cell = g.end_plate_thickness / bearing.cells.end_plate
    per_area = (eta - 1.0) * m.steel.conductivity * CONDUCTIVITY / cell
    half = 0.5 * cell / (m.steel.conductivity * CONDUCTIVITY)
    side = m.side_film * FILM * g.plan.perimeter / (2.0 * math.pi * radius)
    return Problem(
        r=np.unique(np.concatenate(radial)),
        z=np.concatenate(lines),
        blocks=tuple(blocks),
        face_film=per_area / (1.0 - per_area * half),
        side_film=0.0 if lead else side,
        slit=slit,
        planes=tuple(planes),
    )


def weather_problem(
    bearing: Bearing, film: float, cover: float, heat_capacity: float = 0.0
) -> Problem:
    """The upper half of a whole bearing in the open air, as a disc of the same area and perimeter.

    Parameters
    ----------
    bearing : with an even number of layers; its lead cores become one of their area.
    film : at the face and around the cover [W/(m2 K)].
    cover : thickness of the rubber around the plan [mm], which conducts and stores heat.
    heat_capacity : of a plate behind the face, hardly resisting [kJ/(m2 K)].
    """
    g, m, lead = bearing.geometry, bearing.materials, bearing.lead
    radius = math.sqrt(bearing.area / math.pi)
    longer = g.plan.perimeter / (2.0 * math.pi * radius)  # than that of the disc
    core = lead.radius * math.sqrt(lead.cores) if lead else 0.0
    around = m.rubber.model_copy(update={"conductivity": longer * m.rubber.conductivity})
    behind = 10.0 if heat_capacity else 0.0
    parts = [("end plate", g.end_plate_thickness, 6, m.steel)]
    if behind:
        heat = {"conductivity": 1e3, "specific_heat": 1e3, "density": 1e2 * heat_capacity}
        parts.insert(0, ("behind", behind, 2, m.steel.model_copy(update=heat)))
    if g.sealing_plate_thickness:
        parts += [("sealing plate", g.sealing_plate_thickness, 6, m.steel)]
    for j in range(1, g.rubber_layers // 2 + 1):
        parts += [(f"rubber {j}", g.rubber_thickness, 4, m.rubber)]
        parts += [(f"shim {j}", g.shim_thickness, 2, m.steel)]
    parts[-1] = (parts[-1][0], 0.5 * g.shim_thickness, 1, m.steel)
    blocks, lines, depth = [], [np.zeros(1)], 0.0
    for name, thickness, count, material in parts:
        lines.append(graded(depth, depth + thickness, count))
        across = (core if name not in ("end plate", "behind") else 0.0, radius)
        blocks.append(Block(name, across, (depth, depth + thickness), material))
        depth += thickness
    inner = behind + g.end_plate_thickness
    radial = [np.zeros(1), graded(core, radius, 9, 0.1), graded(radius, radius + cover, 2)]
    slit = None
    if lead is not None and m.lead is not None:
        radial.insert(1, graded(0.0, core, 5))
        blocks.append(Block("lead", (0.0, core), (inner, depth), m.lead))
        slit = (core, inner) if lead.confined else None
    if cover:
        blocks.append(Block("cover", (radius, radius + cover), (0.0, depth), around))
    return Problem(
        r=np.unique(np.concatenate(radial)),
        z=np.concatenate(lines),
        blocks=tuple(blocks),
        face_film=film * FILM,
        side_film=film * FILM * longer * radius / (radius + cover),
        slit=slit,
    )


def mean_rubber(problem: Problem, history: History) -> Floats:
    """Return the mean temperature of all rubber above the ambient [K]."""
    layers = [block for block in problem.blocks if block.name.startswith("rubber")]
    volume = [(b.r[1] ** 2 - b.r[0] ** 2) * (b.z[1] - b.z[0]) for b in layers]
    return np.average([history.means[b.name] for b in layers], axis=0, weights=volume)


def released(bearing: Bearing, result: Any) -> dict[str, tuple[Floats, Floats]]:
    """Heat of every block of `bearing_problem` until each kept row of a run [kN mm].

    The run keeps "layer_displacement" in every row, with heat from work (Eq. 4.22): rubber
    force times the layer's own displacement, its part of the viscous work, and the work of
    the lead.
    """
    data = result.dataset.isel(ambient=0)
    time, x = data["time"].values, data["displacement"].values
    layers, cores = bearing.geometry.rubber_layers, bearing.lead.cores if bearing.lead else 1

    def work(force: str, d: Floats) -> Floats:
        f = data[force].values
        return np.concatenate([[0.0], np.cumsum(0.5 * (f[1:] + f[:-1]) * np.diff(d))])

    branches = "rubber_force" in data
    viscous = work("viscous_force", x) / layers if branches else np.zeros(len(x))
    heats = {}
    for j in range(1, layers // 2 + 1):
        d = data["layer_displacement"].sel(layer=j).values
        elastic = work("rubber_force" if branches else "force", d)
        heats[f"rubber {j}"] = (time, (elastic + viscous) / cores)
    if bearing.lead is not None:
        heats["lead"] = (time, 0.5 * work("lead_force", x) / cores)  # the upper half of a core
    return heats
