"""From a bearing to a stack of heat cells and a series of rubber layers.

Upper (outer) face first. When both faces are treated alike only the upper half is modelled,
down to the symmetry plane; a middle layer or shim is then cut in two. When they differ (a
girder above, a concrete pier below) the full height is modelled.

Two schemes give the rates at which cells exchange heat (specification, section 3):
`conservative`, a finite-volume balance, and `published`, the printed Eq. 4.23-4.31.
"""

from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from thermobearing.bearing.model import Bearing
from thermobearing.border.schema import Strict, in_unit
from thermobearing.core import numbers
from thermobearing.core.numbers import (
    LUMP,
    MASS,
    PARTS,
    SHIM,
    BesideLead,
    CellHeat,
    CellRates,
    Fill,
    Heights,
    StackCells,
    conserve_heat,
    face_conductance,
    fill_cells,
    lay_cells,
)
from thermobearing.core.records import Floats, Ints, Rows, rows
from thermobearing.core.types import LayerCells

Scheme = Literal["conservative", "published"]

MM_PER_M = 1e3
KILO = 1e3


class EndFace(Strict):
    """Heat exchange of one end face: `eta` or a film coefficient.

    Attributes
    ----------
    eta : factor eta_B of Eq. 4.15, in [1, 3]: 1 is adiabatic, 3 holds the face at ambient. It is
        tied to the cell size: its conductance is (eta - 1) k / dx.
    film : film coefficient [W/(m^2 K)], in [0, 1e5]; independent of the cell size.
    heat_capacity : of the girder or pier top behind the face, per area of the face [kJ/(m^2 K)],
        in (0, 1e6]; the film is then between it and the ambient air. None: no such body.

    Examples
    --------
    >>> EndFace(eta=1.0).film is None
    True
    """

    eta: Annotated[float, Field(ge=1, le=3)] | None = None
    film: Annotated[float, in_unit("W/(m^2 K)"), Field(ge=0, le=1e5)] | None = None
    heat_capacity: Annotated[float, in_unit("kJ/(m^2 K)"), Field(gt=0, le=1e6)] | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        if ("eta" in values) == ("film" in values):
            return ["give either eta (1 adiabatic to 3 at ambient) or film"]
        if "eta" in values and "heat_capacity" in values:
            return ["heat_capacity can only be combined with film, not with eta"]
        return []


@dataclass(frozen=True)
class Stack:
    """Cells through the height, and which of them belong to which rubber layer.

    Arrays run over cells from the upper face down. `fold` is 2 for a half stack (everything
    counts twice in the full bearing), 1 for a full one.
    """

    # Of each cell: "end_plate", "sealing_plate", "rubber", "shim", or "mass" (behind a face).
    part: tuple[str, ...]
    thickness: Floats  # [mm]
    conductivity: Floats  # [kN/(s K)] = [kN mm/(s mm K)]
    volumetric_heat: Floats  # [kN mm/(mm3 K)]
    area: Floats  # [mm2]
    interface: np.ndarray  # bool: a material interface lies below the cell
    lone_shim: np.ndarray  # bool: a shim (or half shim) modelled by a single cell
    layers: Rows[LayerCells]  # modelled ones
    multiplicity: Floats  # layers of the bearing each modelled layer stands for
    beside_lead: Floats  # height of lead next to each cell, for the full bearing [mm]
    touches_lead_end: NDArray[np.bool_]  # a cell of an end plate next to rubber or sealing plate
    fold: int
    perimeter: float
    side_film: float  # [kN/(s mm K)]

    @property
    def depth(self) -> Floats:
        """Distance of the cell centres from the upper face [mm]."""
        return np.asarray(np.cumsum(self.thickness) - 0.5 * self.thickness)

    @property
    def codes(self) -> Ints:
        """Part of each cell by its place in PARTS."""
        return np.array([PARTS.index(name) for name in self.part])

    @property
    def heat_capacity(self) -> Floats:
        """Heat capacity of each cell, for the full bearing [kN mm/K]."""
        return self.fold * self.volumetric_heat * self.area * self.thickness

    def middles(self) -> tuple[Ints, Ints]:
        """The two cells next to each layer's mid-thickness (the same one, if it lies there)."""
        return self.layers["upper_middle"], self.layers["lower_middle"]


def _heights(bearing: Bearing, half: bool, behind: tuple[float, float]) -> Heights:
    """Return what lies in the stack of a bearing, as plain numbers."""
    g, cells = bearing.geometry, bearing.cells
    return Heights(
        layers=g.rubber_layers,
        half=half,
        end_plate=g.end_plate_thickness,
        sealing_plate=g.sealing_plate_thickness,
        rubber=g.rubber_thickness,
        shim=g.shim_thickness,
        end_plate_cells=cells.end_plate,
        sealing_plate_cells=cells.sealing_plate,
        rubber_cells=cells.rubber,
        shim_cells=cells.shim,
        plate_grading=cells.grading,
        mass_above=behind[0] > 0.0,
        mass_below=behind[1] > 0.0 and not half,
    )


def _room(cells: int, layers: int) -> StackCells:
    return StackCells(
        part=np.zeros(cells, dtype=np.int64),
        thickness=np.zeros(cells),
        interface=np.zeros(cells, dtype=np.bool_),
        layers=rows(LayerCells, layers),
        multiplicity=np.zeros(layers),
    )


def build_stack(
    bearing: Bearing,
    *,
    half: bool,
    side_film: float | None = None,
    behind: tuple[float, float] = (0.0, 0.0),
) -> Stack:
    """Build the cells and layers of a bearing.

    `bearing`: what to model; `half`: model the upper half only; right when both end faces are
    alike; `side_film`: coefficient of the side [W/(m2 K)]; that of the bearing's materials by
    default; `behind`: heat capacity behind the upper and the lower face [kJ/(m2 K)].
    """
    heights = _heights(bearing, half, behind)
    # An empty room counts the cells, the next one takes them.
    cells = _room(*lay_cells(heights, _room(0, 0)))
    lay_cells(heights, cells)
    steel, rubber = bearing.materials.steel, bearing.materials.rubber
    count = len(cells.part)
    heat, capacity = CellHeat(cells.thickness, *np.empty((3, count))), np.empty(count)
    lead = BesideLead(np.empty(count), np.empty(count, dtype=np.bool_))
    fill = Fill(
        steel_conductivity=steel.conductivity / MM_PER_M,
        steel_heat=steel.volumetric_heat,
        rubber_conductivity=rubber.conductivity / MM_PER_M,
        rubber_heat=rubber.volumetric_heat,
        area=bearing.area,
        lead_area=bearing.lead_area,
        fold=2 if half else 1,
    )
    fill_cells(fill, cells.part, heat, capacity, lead)
    lumps = np.flatnonzero(cells.part == MASS)
    starts = np.concatenate([[True], cells.interface[:-1]])
    faces = behind[:1] if half else behind
    # A body behind a face is a cell of the thickness LUMP with all of its heat.
    heat.volumetric_heat[lumps] = [
        KILO / MM_PER_M**2 / LUMP * heat_behind for heat_behind in faces if heat_behind > 0.0
    ]
    if side_film is None:
        side_film = bearing.materials.side_film
    return Stack(
        part=tuple(PARTS[part] for part in cells.part),
        thickness=cells.thickness,
        conductivity=heat.conductivity,
        volumetric_heat=heat.volumetric_heat,
        area=heat.area,
        interface=cells.interface,
        lone_shim=(cells.part == SHIM) & starts & np.append(starts[1:], True),
        layers=cells.layers,
        multiplicity=cells.multiplicity,
        beside_lead=lead.height,
        touches_lead_end=lead.touches_end,
        fold=fill.fold,
        perimeter=bearing.geometry.plan.perimeter,
        side_film=side_film / MM_PER_M**2,
    )


def through_side(bearing: Bearing, film: float, cover: float) -> float:
    """Return the coefficient between the mean temperature of a cell and the air [W/(m2 K)].

    Film, cover rubber and the way inside the layers are in series. The last is R/(4 k) of a disc
    (area/(2 perimeter k) otherwise) with the conductivity of rubber and steel in parallel: what a
    disc that cools slowly has between its mean and its edge.

    `bearing`: whose side it is; `film`: coefficient of the film [W/(m2 K)]; 0 insulates; `cover`:
    thickness of the cover rubber [mm].
    """
    if film == 0.0:
        return 0.0
    g, m = bearing.geometry, bearing.materials
    # Heat flows along the layers: steel and rubber are parallel paths, weighted by their heights.
    steel = (g.rubber_layers - 1) * g.shim_thickness + 2.0 * g.sealing_plate_thickness
    rubber = g.total_rubber_thickness
    along = (rubber * m.rubber.conductivity + steel * m.steel.conductivity) / (rubber + steel)
    inside = 0.5 * g.plan.area / g.plan.perimeter / along
    return 1.0 / (1.0 / film + (cover / m.rubber.conductivity + inside) / MM_PER_M)


def _end_conductance(face: EndFace, conductivity: float, thickness: float) -> float:
    """Conductance per area from the outermost cell centre to the ambient [kN/(s mm K)]."""
    film = (face.film or 0.0) / MM_PER_M**2
    return float(face_conductance(face.eta or 0.0, film, float(conductivity), float(thickness)))


def film_at_face(face: EndFace, stack: Stack, cell: int) -> float:
    """Film at the face itself [kN/(s mm K)], without half the outer cell: 0 to inf."""
    if face.heat_capacity:
        # The body behind the face touches it: there is no film between them.
        return float("inf")
    film = (face.film or 0.0) / MM_PER_M**2
    k, thickness = stack.conductivity[cell], stack.thickness[cell]
    return float(numbers.film_at_face(face.eta or 0.0, film, float(k), float(thickness)))


def _end_losses(stack: Stack, upper: EndFace, lower: EndFace | None, capacity: Floats) -> Floats:
    """Rates of loss through the end faces; none through the symmetry plane (lower None)."""
    loss = np.zeros(len(capacity))
    for i, face in ((0, upper), (-1, lower)):
        if face is not None:
            per_area = _end_conductance(face, stack.conductivity[i], stack.thickness[i])
            loss[i] += per_area * stack.area[i] / capacity[i]
    return loss


def conservative_rates(stack: Stack, upper: EndFace, lower: EndFace | None) -> CellRates:
    """Finite-volume balance: what leaves one cell enters the next."""
    k, thickness = stack.conductivity, stack.thickness
    above = _end_conductance(upper, k[0], thickness[0])
    # No heat passes the symmetry plane of a half stack.
    below = 0.0 if lower is None else _end_conductance(lower, k[-1], thickness[-1])
    heat = CellHeat(thickness, k, stack.volumetric_heat, stack.area)
    rates = CellRates(*np.empty((4, len(thickness))))
    conserve_heat(heat, stack.perimeter, stack.side_film, above, below, rates)
    return rates


def published_rates(stack: Stack, upper: EndFace, lower: EndFace | None) -> CellRates:
    """Return the printed coefficients, Eq. 4.23-4.31, with their departures P1 and P2.

    2 beta/dt of Shen (2023) is `diffusion` here. A shim of one cell receives twice the flux
    its neighbours lose (Eq. 4.28, 4.31), and theta uses the rubber's c rho everywhere.
    """
    dx, k = stack.thickness, stack.conductivity
    diffusion = k / stack.volumetric_heat / dx**2
    gamma_below = k[1:] * dx[:-1] / (k[:-1] * dx[1:] + k[1:] * dx[:-1])  # weight of the cell below
    # At a material interface the flux has weights of both conductivities.
    inside = ~stack.interface[:-1]
    to_next = np.where(inside, 1.0, 2.0 * gamma_below) * diffusion[:-1]
    to_previous = np.where(inside, 1.0, 2.0 * (1.0 - gamma_below)) * diffusion[1:]
    to_next *= np.where(stack.lone_shim[:-1], 2.0, 1.0)
    to_previous *= np.where(stack.lone_shim[1:], 2.0, 1.0)
    rubber = stack.volumetric_heat[stack.layers["first"][0]]
    side = stack.side_film * stack.perimeter / stack.area / rubber
    capacity = stack.heat_capacity / stack.fold
    return CellRates(
        to_previous=np.concatenate([[0.0], to_previous]),
        to_next=np.concatenate([to_next, [0.0]]),
        end_loss=_end_losses(stack, upper, lower, capacity),
        side_loss=side,
    )
