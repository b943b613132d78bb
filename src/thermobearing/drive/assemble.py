"""From a bearing to the constants of the coupled step: where data meets physics."""

from typing import Literal

import numpy as np

from thermobearing.bearing.model import Bearing
from thermobearing.core.types import (
    EULER,
    EXACT,
    HEAT_FROM_DISSIPATION,
    HEAT_FROM_WORK,
    Constants,
    Rubber,
)
from thermobearing.stack import Face, Scheme, Stack, conservative_rates, published_rates

Integrator = Literal["exact", "euler"]
HeatSource = Literal["work", "dissipation"]

KELVIN_COEFFICIENT_SCALE = 100.0  # Eq. 4.34 divides T - 23 by 100
SHARING_MARGIN = 0.2  # see docs/theory.md, "When a layer softens"


def build_constants(
    bearing: Bearing,
    stack: Stack,
    *,
    upper: Face,
    lower: Face | None,
    scheme: Scheme = "conservative",
    integrator: Integrator = "exact",
    heat_source: HeatSource = "work",
) -> Constants:
    """The numbers one coupled step needs, from a bearing and its stack.

    `lower` is None for a half stack: its last cell lies at the symmetry plane.
    """
    make = conservative_rates if scheme == "conservative" else published_rates
    rates = make(stack, upper, lower)
    return Constants(
        rubber=_rubber(bearing, integrator),
        multiplicity=stack.multiplicity,
        layer_cells=np.column_stack([stack.first_cell, stack.last_cell, *stack.middles()]),
        cells=np.array(
            [
                rates.to_previous,
                rates.to_next,
                rates.end_loss,
                rates.side_loss,
                stack.heat_capacity,
            ]
        ),
        source_rise=1.0
        / (
            bearing.materials.rubber.volumetric_heat
            * bearing.area
            * bearing.geometry.rubber_thickness
        ),
        side_implicit=rates.side_implicit,
        heat_source=HEAT_FROM_DISSIPATION if heat_source == "dissipation" else HEAT_FROM_WORK,
    )


def _rubber(bearing: Bearing, integrator: Integrator) -> Rubber:
    """Numbers of one rubber layer (Eq. 4.34-4.37)."""
    h = bearing.hysteresis
    return Rubber(
        layer_count=float(bearing.geometry.rubber_layers),
        elastic_stiffness=h.post_yield_ratio * h.layer_stiffness,
        hysteretic_stiffness=(1.0 - h.post_yield_ratio) * h.layer_stiffness,
        elastic_exponent=h.elastic_temperature_coefficient / KELVIN_COEFFICIENT_SCALE,
        hysteretic_exponent=h.hysteretic_temperature_coefficient / KELVIN_COEFFICIENT_SCALE,
        reference_temperature=h.reference_temperature,
        hardening=h.hardening / bearing.geometry.rubber_thickness**2,
        yield_displacement=h.yield_displacement,
        unloading_curvature=(1.0 - h.shape) / ((1.0 + h.shape) * h.yield_displacement**2),
        integrator=EULER if integrator == "euler" else EXACT,
        sharing_margin=SHARING_MARGIN,
    )
