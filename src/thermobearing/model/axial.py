"""Bearings under an axial force: from geometry to the column that `core/axial.py` computes with.

All that checks, properties, linear springs and analyses say of a bearing in compression comes from
here: its compression modulus, vertical stiffness, critical load and overlap.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, Final, Literal, NamedTuple, TypeVar, cast

import numpy as np
from pydantic import Field

from thermobearing.bearing.model import Bearing, CircularPlan, Geometry, LeadCores, Plan
from thermobearing.border.library import data_path
from thermobearing.border.schema import in_unit
from thermobearing.border.toml import read_toml, split_sources
from thermobearing.border.units import NEWTON_PER_KILONEWTON, parse_quantity
from thermobearing.core.axial import (
    Column,
    axial_march,
    buckling_load,
    layer_compression,
    tension,
)
from thermobearing.core.records import Floats, Rows, filled, rows
from thermobearing.core.types import AxialResponse, Constants
from thermobearing.quantities.governing import place_of_largest
from thermobearing.quantities.warned import EXCEEDED, Warned

F = TypeVar("F", bound=Callable[..., Any])
AxialFactor = Literal["overlap", "potential"]
Joint = Literal["bolted", "dowelled"]
BOLTED: Final[Joint] = "bolted"
DOWELLED: Final[Joint] = "dowelled"
DowelLength = Annotated[float, in_unit("mm"), Field(gt=0, le=1e5)]
DOWELS_NEEDED: Final = 'dowel_length: needs joint = "dowelled"'


@cache
def compression_constants() -> dict[str, Any]:
    """Return the constants of data/materials/vertical.toml, of compression and tension."""
    table, _ = split_sources(read_toml(data_path("materials", "vertical.toml")))
    return dict(table)


def compression_sources() -> dict[str, str]:
    """Return the sources of the constants of data/materials/vertical.toml, by key."""
    _, sources = split_sources(read_toml(data_path("materials", "vertical.toml")))
    return dict(sources)


def _in_python(kernel: F) -> F:
    """Return a kernel of a few numbers as plain Python, which needs no compiling."""
    # Properties of a bearing are computed once, where compiling a kernel would take seconds.
    return cast(F, getattr(kernel, "py_func", kernel))


class Section(NamedTuple):
    """The rubber of a layer that carries an axial force."""

    area: float  # A [mm2]
    inertia: tuple[float, float]  # second moments for bending along x and y [mm4]
    shape: float  # C S^2, with the shape factor S
    shape_factor: float  # S: area over the free side area of a layer


def second_moments(plan: Plan) -> tuple[float, float]:
    """Return the second moments of area of a plan about the axes along and across [mm4]."""
    if isinstance(plan, CircularPlan) and plan.hole is not None:
        inertia = annular_inertia(plan.diameter, plan.hole)
        return inertia, inertia
    along, across = plan._sides()
    share = math.pi / 64.0 if isinstance(plan, CircularPlan) else 1.0 / 12.0
    return share * along * across**3, share * across * along**3


def annular_inertia(diameter: float, hole: float) -> float:
    """Return the second moment of area of a ring about a diameter [mm4]."""
    return math.pi / 64.0 * (diameter**4 - hole**4)


def annular_section(diameter: float, hole: float, thickness: float, *, filled: bool) -> Section:
    r"""Return the section of a round layer with a hole, open or filled with lead.

    .. math::
        C = 6 F, \quad F = \frac{\rho^2 + 1}{(\rho - 1)^2} + \frac{1 + \rho}{(1 - \rho) \ln \rho},
        \quad \rho = D/d

    of an open hole; lead holds the inner face, so that F = 1, and that face is not free.

    >>> round(annular_section(700.0, 140.0, 8.0, filled=True).area, 2)
    369451.3
    """
    area = 0.25 * math.pi * (diameter**2 - hole**2)
    inertia = annular_inertia(diameter, hole)
    factor = float(compression_constants()["compression_round"])
    if filled:
        shape_factor = area / (math.pi * diameter * thickness)
        return Section(area, (inertia, inertia), factor * shape_factor**2, shape_factor)
    ratio = diameter / hole
    loss = (ratio**2 + 1.0) / (ratio - 1.0) ** 2
    loss += (1.0 + ratio) / ((1.0 - ratio) * math.log(ratio))
    shape_factor = (diameter - hole) / (4.0 * thickness)
    return Section(area, (inertia, inertia), factor * loss * shape_factor**2, shape_factor)


def find_section(geometry: Geometry, lead: LeadCores | None = None) -> Section:
    """Return the section of a bearing.

    A single lead core in the centre of a round plan is left out of it, and so is an open hole;
    other cores count as rubber.
    """
    plan = geometry.plan
    if isinstance(plan, CircularPlan) and plan.hole is not None:
        return annular_section(plan.diameter, plan.hole, geometry.rubber_thickness, filled=False)
    if isinstance(plan, CircularPlan) and lead is not None and lead.cores == 1:
        return annular_section(plan.diameter, lead.diameter, geometry.rubber_thickness, filled=True)
    constants = compression_constants()
    round_plan = isinstance(plan, CircularPlan)
    factor = float(constants["compression_round" if round_plan else "compression_square"])
    about_x, about_y = second_moments(plan)
    # Bending along x turns about the axis across, to which the second of the two belongs.
    shape_factor = geometry.first_shape_factor
    return Section(plan.area, (about_y, about_x), factor * shape_factor**2, shape_factor)


def shear_modulus(bearing: Bearing, stiffness: float) -> float:
    """Return the modulus K T_r/A of rubber [GPa] with a shear stiffness K of a bearing [kN/mm].

    A is the area that also carries the axial force (`find_section`): one pair of G and A is in the
    strain of compression, the vertical stiffness and the critical load.

    >>> import thermobearing as tb
    >>> round(1e3 * shear_modulus(tb.load_bearing("shen-hdr-bridge"), 2.0), 3)
    0.885
    """
    area = find_section(bearing.geometry, bearing.lead).area
    return stiffness * bearing.total_rubber_thickness / area


def build_column(
    geometry: Geometry,
    lead: LeadCores | None = None,
    *,
    secant: float = 1.0,
    factor: AxialFactor = "overlap",
    section: Section | None = None,
) -> Rows[Column]:
    """Return the numbers [1] of a bearing under an axial force.

    `secant` is the share of the hysteretic stiffness term in the stiffness at 100 % strain.
    """
    constants, along_across = compression_constants(), geometry.plan._sides()
    section = section or find_section(geometry, lead)
    bulk = parse_quantity(str(constants["bulk_modulus"]), "MPa") / NEWTON_PER_KILONEWTON
    # The column that buckles is between the end plates, which are stiff: rubber, shims and sealing
    # plates.
    height = geometry.total_rubber_thickness + 2.0 * geometry.sealing_plate_thickness
    height += (geometry.rubber_layers - 1) * geometry.shim_thickness
    return filled(
        Column,
        area=section.area,
        inertia_x=section.inertia[0],
        inertia_y=section.inertia[1],
        length=along_across[0],
        width=along_across[1],
        circular=int(isinstance(geometry.plan, CircularPlan)),
        modulus_ratio=section.shape,
        volumetric=4.0 / (3.0 * bulk),
        layer_thickness=geometry.rubber_thickness,
        layer_count=float(geometry.rubber_layers),
        height=height,
        least_overlap=float(constants["least_overlap"]),
        cavitation=float(constants["cavitation"]),
        secant=secant,
        damage=float(constants["cavitation_damage"]),
        damage_rate=float(constants["cavitation_damage_rate"]),
        strengthening=parse_quantity(str(constants["cavitation_strengthening"]), "1/mm"),
        by_overlap=int(factor == "overlap"),
    )


def column_of(bearing: Bearing, factor: AxialFactor = "overlap") -> Rows[Column]:
    """Return the column [1] of a bearing whose layers have the stiffness terms of Eq. 4.34."""
    rubber, geometry = bearing.hysteresis, bearing.geometry
    secant = (1.0 + rubber.hardening) * rubber.yield_displacement / geometry.rubber_thickness
    return build_column(geometry, bearing.lead, secant=secant, factor=factor)


def compression_modulus(
    geometry: Geometry, shear_modulus: float, lead: LeadCores | None = None
) -> float:
    r"""Return the compression modulus E_c of a layered pad, in the unit of its shear modulus, GPa.

    .. math::
        E_c = (1 / (c G S^2) + 4 / (3 K))^{-1}

    with the shape factor S of one layer, c = 6 for round and 6.73 for other plans and the bulk
    modulus K (data/materials/vertical.toml). A single lead core in the centre of a round plan is no
    part of the layer; other cores count as rubber.
    """
    return 1.0 / _in_python(layer_compression)(build_column(geometry, lead)[0], 1.0 / shear_modulus)


def axial_stiffness(
    geometry: Geometry, shear_modulus: float, lead: LeadCores | None = None
) -> float:
    """Return the vertical stiffness E_c A/T_r without displacement [kN/mm]."""
    modulus = compression_modulus(geometry, shear_modulus, lead)
    return float(modulus * find_section(geometry, lead).area / geometry.total_rubber_thickness)


def critical_load(geometry: Geometry, shear_modulus: float, lead: LeadCores | None = None) -> float:
    r"""Return the load at which a bearing buckles without displacement [kN].

    .. math::
        P_{cr} = \frac{P_S}{2} \left(\sqrt{1 + 4 P_E / P_S} - 1\right), \quad
        P_S = G A \frac{h}{T_r}, \quad P_E = \frac{\pi^2}{h^2} \frac{E_c I}{3} \frac{h}{T_r}

    of Haringx's column, with both ends held against rotation, between the end plates (height h of
    rubber and shims, T_r of rubber), about the weaker axis; `shear_modulus` is the secant modulus
    of the rubber [GPa]. A single lead core in the centre of a round plan is no part of A and I;
    other cores count as rubber.

    >>> import thermobearing as tb
    >>> geometry = tb.load_bearing("shen-hdr-bridge").geometry
    >>> 9e3 < critical_load(geometry, 1e-3) < 10e3
    True
    """
    column, rubber = build_column(geometry, lead)[0], geometry.total_rubber_thickness
    compression = rubber * _in_python(layer_compression)(column, 1.0 / shear_modulus)
    return float(_in_python(buckling_load)(column, compression, rubber / shear_modulus))


def overlap_area(plan: Plan, displacement: Floats) -> Floats:
    """Return the area of a plan that still lies above itself when the top has moved [mm2].

    It is (a - abs(x)) (b - abs(y)) of a rectangle, the lens of two circles of a round plan, and the
    same share of the area of a plan with an open hole.
    `displacement` [mm] has a number for each place, or pairs (x, y) on the last axis of two
    dimensions; x is along the `length` of a rectangular plan.

    >>> from thermobearing.bearing.model import RectangularPlan
    >>> plan = RectangularPlan(shape="rectangular", length=400, width=300)
    >>> overlap_area(plan, np.array([[100.0, -50.0], [500.0, 0.0]])).tolist()
    [75000.0, 0.0]
    """
    moved = np.asarray(displacement, dtype=float)
    pairs = moved if moved.ndim > 1 else np.stack([moved, np.zeros_like(moved)], axis=-1)
    along, across = plan._sides()
    if isinstance(plan, CircularPlan):
        share = np.minimum(np.hypot(pairs[..., 0], pairs[..., 1]) / along, 1.0)
        angle = 2.0 * np.arccos(share)
        lens = np.asarray(0.25 * along**2 * (angle - np.sin(angle)))
        if plan.hole is not None:
            lens *= 1.0 - (plan.hole / plan.diameter) ** 2
        return lens
    overlap = np.maximum(np.array([along, across]) - np.abs(pairs), 0.0)
    return np.asarray(overlap[..., 0] * overlap[..., 1])


def tension_law(
    column: Column, extension: float, stiffness: float, strength: float, memory: float
) -> tuple[float, float]:
    """Return tension [kN] and tangent [kN/mm] of a bolted bearing at an extension [mm].

    Arguments are those of `core.axial.tension`, for callers that compute a step at a time.
    """
    pulled, tangent = _in_python(tension)(column, extension, stiffness, strength, memory)
    return float(pulled), float(tangent)


def axial_rows(
    columns: Rows[Column],
    constants: Constants,
    displacement: Floats,
    axial_force: Floats,
    rubber: Floats,
) -> Rows[AxialResponse]:
    """Return what prescribed axial forces do to a bearing along its way, a row for each step.

    `displacement` [mm] has a number for each row, or pairs; `axial_force` [kN] one number, and
    `rubber` [degC] the temperatures of all layers. Rows follow each other in single steps.
    """
    moved = displacement if displacement.ndim > 1 else displacement[:, np.newaxis]
    response = rows(AxialResponse, len(moved))
    scratch = np.zeros((2, len(constants.multiplicity)))
    axial_march(
        constants,
        columns,
        np.ascontiguousarray(moved[:, 0]),
        np.ascontiguousarray(moved[:, 1]) if moved.shape[1] > 1 else np.zeros(len(moved)),
        np.ascontiguousarray(axial_force),
        np.ascontiguousarray(rubber),
        scratch[0],
        scratch[1],
        response,
    )
    return response


@dataclass(frozen=True)
class AxialPeak:
    """Where the axial force of a run is largest relative to a limit that depends on the place."""

    used: float  # largest ratio of force and limit
    force: float  # [kN] then
    limit: float  # [kN]
    time: float  # [s] of the largest ratio
    first: float  # [s] when the limit is first exceeded; NaN if it is not
    duration: float  # [s] for which it is exceeded


def axial_peak(clock: Floats, force: Floats, limit: Floats) -> AxialPeak:
    """Return the largest share of a limit in a history."""
    # The limit changes with displacement and temperature, so the largest force need not be the one
    # nearest to its limit.
    share = force / limit
    place, beyond = place_of_largest(share), share > 1.0
    first = float(clock[np.flatnonzero(beyond)[0]]) if beyond.any() else math.nan
    duration = float(np.diff(clock, prepend=clock[0])[beyond].sum())
    at_peak = float(force[place]), float(limit[place]), float(clock[place])
    return AxialPeak(float(share[place]), *at_peak, first, duration)


def unstable_warning(run: str, peak: AxialPeak) -> Warned:
    """Return when and by how much the axial force of a run exceeds its critical load."""
    sentence = (
        f"{run} is unstable: the axial force exceeds the critical load "
        f"for {peak.duration:.3g} s, first at {peak.first:.4g} s, most at {peak.time:.4g} s "
        f"({peak.force:.4g} kN, critical load {peak.limit:.4g} kN)"
    )
    return Warned(sentence, "unstable", EXCEEDED)


def uplift_warning(bearing: str, first: float, largest: float) -> Warned:
    """Return when a dowelled bearing lifts first [s], and its largest uplift [mm]."""
    sentence = f"{bearing}lifts, first at {first:.4g} s; the largest uplift is {largest:.3g} mm"
    return Warned(sentence, "uplift", EXCEEDED)


def axial_peaks(
    clock: Floats, axial: Rows[AxialResponse] | dict[str, Floats]
) -> dict[str, AxialPeak]:
    """Return the peaks of a history of axial forces, as `axial_checks` takes them."""
    peaks = {"analysis": axial_peak(clock, axial["axial_force"], axial["critical_load"])}
    # Cavitation is a limit of tension, and compression has no share in it.
    if axial["axial_force"].min() < 0.0:
        peaks["cavitation"] = axial_peak(clock, -axial["axial_force"], axial["cavitation_force"])
    return peaks
