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

from thermobearing.bearing.model import Bearing, Material
from thermobearing.border.schema import Strict, in_unit
from thermobearing.core.records import Floats

Ints = NDArray[np.int64]
Scheme = Literal["conservative", "published"]
OUTSIDE_LEAD = ("end_plate", "mass")  # parts that lead cores do not pass through

MM_PER_M = 1e3
KILO = 1e3
LUMP = 1e-6  # thickness of the cell that stands for what is behind a face [mm]
FACE_HELD = 1e-9  # of the resistance to the middle of the outer cell: less lies beyond the face


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
    def _conflicts(cls, given: dict[str, Any]) -> list[str]:
        if ("eta" in given) == ("film" in given):
            return ["give either eta (1 adiabatic to 3 at ambient) or film"]
        if "eta" in given and "heat_capacity" in given:
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
    first_cell: Ints  # per modelled layer
    last_cell: Ints
    multiplicity: Floats  # layers of the bearing each modelled layer stands for
    halved: bool  # the last modelled layer is cut by the symmetry plane
    fold: int
    perimeter: float
    side_film: float  # [kN/(s mm K)]

    @property
    def depth(self) -> Floats:
        """Distance of the cell centres from the upper face [mm]."""
        return np.asarray(np.cumsum(self.thickness) - 0.5 * self.thickness)

    @property
    def heat_capacity(self) -> Floats:
        """Heat capacity of each cell, for the full bearing [kN mm/K]."""
        return self.fold * self.volumetric_heat * self.area * self.thickness

    @property
    def beside_lead(self) -> Floats:
        """Height of lead next to each cell, for the full bearing [mm]."""
        touches = ~np.isin(self.part, OUTSIDE_LEAD)
        return np.asarray(self.fold * self.thickness * touches)

    @property
    def touches_lead_end(self) -> NDArray[np.bool_]:
        """Whether a cell is that of an end plate next to the rubber or sealing plate."""
        ends = np.isin(self.part, OUTSIDE_LEAD)
        touches = np.zeros(len(ends), dtype=bool)
        touches[:-1] |= ends[:-1] & ~ends[1:]
        touches[1:] |= ends[1:] & ~ends[:-1]
        return touches

    def middles(self) -> tuple[Ints, Ints]:
        """The two cells next to each layer's mid-thickness (the same one, if it lies there)."""
        count = self.last_cell - self.first_cell
        upper = self.first_cell + (count - 1) // 2
        lower = self.first_cell + count // 2
        if self.halved:  # mid-thickness is the symmetry plane, mirrored cells on either side
            upper[-1] = lower[-1] = self.last_cell[-1] - 1
        return upper, lower


def _parts(bearing: Bearing, half: bool) -> list[tuple[str, float, int]]:
    """(part, thickness, cells) from the upper face down, to the symmetry plane if `half`."""
    g, cells = bearing.geometry, bearing.cells
    end = ("end_plate", g.end_plate_thickness, cells.end_plate)
    rubber = ("rubber", g.rubber_thickness, cells.rubber)
    shim = ("shim", g.shim_thickness, cells.shim)
    sealing = [("sealing_plate", g.sealing_plate_thickness, cells.sealing_plate)]
    sealing = sealing if g.sealing_plate_thickness > 0.0 else []
    middle = [part for _ in range(g.rubber_layers - 1) for part in (rubber, shim)] + [rubber]
    if not half:
        return [end, *sealing, *middle, *sealing, end]
    kept, (name, thickness, count) = middle[: len(middle) // 2], middle[len(middle) // 2]
    return [end, *sealing, *kept, (name, 0.5 * thickness, (count + 1) // 2)]


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
    parts = _parts(bearing, half)
    lump = [("mass", LUMP, 1)]
    parts = lump * (behind[0] > 0.0) + parts + lump * (behind[1] > 0.0 and not half)
    materials: dict[str, Material] = {
        "end_plate": bearing.materials.steel,
        "sealing_plate": bearing.materials.steel,
        "shim": bearing.materials.steel,
        "rubber": bearing.materials.rubber,
        "mass": bearing.materials.steel,  # overwritten below
    }
    net = bearing.area - bearing.lead_area
    names = tuple(name for name, _, count in parts for _ in range(count))
    thickness = np.array([t / count for _, t, count in parts for _ in range(count)])
    ends = np.cumsum([count for _, _, count in parts])
    interface = np.zeros(len(names), dtype=bool)
    interface[ends[:-1] - 1] = True
    lone = np.array(
        [name == "shim" and count == 1 for name, _, count in parts for _ in range(count)]
    )
    layers = [i for i, (name, _, _) in enumerate(parts) if name == "rubber"]
    halved = half and parts[-1][0] == "rubber"
    multiplicity = np.full(len(layers), 2.0 if half else 1.0)
    if halved:
        multiplicity[-1] = 1.0
    conductivity = np.array([materials[n].conductivity / MM_PER_M for n in names])
    volumetric_heat = np.array([materials[n].volumetric_heat for n in names])
    lumps = np.flatnonzero([name == "mass" for name in names])
    conductivity[lumps] = np.inf
    faces = behind[:1] if half else behind
    volumetric_heat[lumps] = [KILO / MM_PER_M**2 / LUMP * each for each in faces if each > 0.0]
    if side_film is None:
        side_film = bearing.materials.side_film
    return Stack(
        part=names,
        thickness=thickness,
        conductivity=conductivity,
        volumetric_heat=volumetric_heat,
        area=np.array([bearing.area if n in OUTSIDE_LEAD else net for n in names]),
        interface=interface,
        lone_shim=lone,
        first_cell=np.array([ends[i - 1] for i in layers], dtype=np.int64),
        last_cell=np.array([ends[i] for i in layers], dtype=np.int64),
        multiplicity=multiplicity,
        halved=halved,
        fold=2 if half else 1,
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
    steel = (g.rubber_layers - 1) * g.shim_thickness + 2.0 * g.sealing_plate_thickness
    rubber = g.total_rubber_thickness
    along = (rubber * m.rubber.conductivity + steel * m.steel.conductivity) / (rubber + steel)
    inside = 0.5 * g.plan.area / g.plan.perimeter / along
    return 1.0 / (1.0 / film + (cover / m.rubber.conductivity + inside) / MM_PER_M)


@dataclass(frozen=True)
class Rates:
    """Heat exchange rates of the cells [1/s]; see core/heat.py."""

    to_previous: Floats
    to_next: Floats
    end_loss: Floats
    side_loss: Floats
    side_implicit: bool


def _end_conductance(face: EndFace, conductivity: float, thickness: float) -> float:
    """Conductance per area from the outermost cell centre to the ambient [kN/(s mm K)]."""
    if face.eta is not None:
        return (face.eta - 1.0) * conductivity / thickness
    film = (face.film or 0.0) / MM_PER_M**2
    return film / (1.0 + 0.5 * film * thickness / conductivity)


def film_at_face(face: EndFace, stack: Stack, cell: int) -> float:
    """Film at the face itself [kN/(s mm K)], without half the outer cell: 0 to inf."""
    if face.heat_capacity:
        return float("inf")
    k, thickness = stack.conductivity[cell], stack.thickness[cell]
    to_middle = _end_conductance(face, k, thickness)
    beyond = 1.0 - 0.5 * to_middle * thickness / k
    return to_middle / beyond if beyond > FACE_HELD else float("inf")


def _end_losses(stack: Stack, upper: EndFace, lower: EndFace | None, capacity: Floats) -> Floats:
    """Rates of loss through the end faces; none through the symmetry plane (lower None)."""
    loss = np.zeros(len(capacity))
    for i, face in ((0, upper), (-1, lower)):
        if face is not None:
            per_area = _end_conductance(face, stack.conductivity[i], stack.thickness[i])
            loss[i] += per_area * stack.area[i] / capacity[i]
    return loss


def conservative_rates(stack: Stack, upper: EndFace, lower: EndFace | None) -> Rates:
    """Finite-volume balance: what leaves one cell enters the next."""
    resistance = 0.5 * stack.thickness / stack.conductivity
    face_area = np.minimum(stack.area[:-1], stack.area[1:])
    conductance = face_area / (resistance[:-1] + resistance[1:])
    capacity = stack.heat_capacity / stack.fold
    side = stack.side_film * stack.perimeter * stack.thickness / capacity
    return Rates(
        to_previous=np.concatenate([[0.0], conductance / capacity[1:]]),
        to_next=np.concatenate([conductance / capacity[:-1], [0.0]]),
        end_loss=_end_losses(stack, upper, lower, capacity),
        side_loss=side,
        side_implicit=True,
    )


def published_rates(stack: Stack, upper: EndFace, lower: EndFace | None) -> Rates:
    """The printed coefficients, Eq. 4.23-4.31, with their departures P1 and P2.

    2 beta/dt of Shen (2023) is `diffusion` here. A shim of one cell receives twice the flux
    its neighbours lose (Eq. 4.28, 4.31), and theta uses the rubber's c rho everywhere.
    """
    dx, k = stack.thickness, stack.conductivity
    diffusion = k / stack.volumetric_heat / dx**2
    gamma_below = k[1:] * dx[:-1] / (k[:-1] * dx[1:] + k[1:] * dx[:-1])  # weight of the cell below
    inside = ~stack.interface[:-1]
    to_next = np.where(inside, 1.0, 2.0 * gamma_below) * diffusion[:-1]
    to_previous = np.where(inside, 1.0, 2.0 * (1.0 - gamma_below)) * diffusion[1:]
    to_next *= np.where(stack.lone_shim[:-1], 2.0, 1.0)
    to_previous *= np.where(stack.lone_shim[1:], 2.0, 1.0)
    rubber = stack.volumetric_heat[stack.first_cell[0]]
    side = stack.side_film * stack.perimeter / stack.area / rubber
    capacity = stack.heat_capacity / stack.fold
    return Rates(
        to_previous=np.concatenate([[0.0], to_previous]),
        to_next=np.concatenate([to_next, [0.0]]),
        end_loss=_end_losses(stack, upper, lower, capacity),
        side_loss=side,
        side_implicit=False,
    )
