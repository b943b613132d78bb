"""Scaling rules between a bearing and its compound (docs/theory.md).

    K_r = G_r A/t_r          d_y = gamma_y t_r      b, s, alpha_0, m_T, n_T: no size
    K_l = G_l A_l/H          Q_l = sigma_Y A_l      of one core
    K_v = G_v A/H            c_v = eta_v A/H        of the bearing

A is the area of the rubber (gross minus lead), t_r the thickness of a layer, H = n t_r.
"""

import math
from typing import Annotated, Any

from pydantic import Field

from thermobearing.bearing.compound import Compound, CompoundLead, CompoundRate, CompoundRubber
from thermobearing.bearing.model import (
    Bearing,
    Geometry,
    LeadCores,
    RateDependence,
    RubberHysteresis,
)
from thermobearing.border.errors import InputError
from thermobearing.border.schema import Strict, in_unit
from thermobearing.border.units import NEWTON_PER_KILONEWTON

WITHOUT_SIZE = [key for key in CompoundRubber.model_fields if key in RubberHysteresis.model_fields]
OF_LEAD = [key for key in CompoundLead.model_fields if key in LeadCores.model_fields]
COPIED = (
    "materials",
    "temperature_law",
    "hysteresis_law",
    "tested_range",
    "scragging",
    "rate_band",
)
RULES = {  # key of a bearing: key of its compound, rule that divides the size out, and back
    "hysteresis.layer_stiffness": ("rubber.shear_modulus", "K_r t_r/A", "K_r = G_r A/t_r"),
    "hysteresis.yield_displacement": ("rubber.yield_strain", "d_y/t_r", "d_y = gamma_y t_r"),
    "lead.stiffness": ("lead.shear_modulus", "K_l H/A_l", "K_l = G_l A_l/H"),
    "rate.stiffness": ("rate.shear_modulus", "K_v H/A", "K_v = G_v A/H"),
    "rate.damping": ("rate.viscosity", "c_v H/A", "c_v = eta_v A/H"),
}
# The same rules as powers of sizes, for callers that scale a bearing of known numbers.
EXPONENTS = {
    "hysteresis.layer_stiffness": {"net_area": 1, "layer": -1},
    "hysteresis.yield_displacement": {"layer": 1},
    "lead.stiffness": {"core_area": 1, "height": -1},
    "rate.stiffness": {"net_area": 1, "height": -1},
    "rate.damping": {"net_area": 1, "height": -1},
}
KINDS = {("HDR", False): "HDR", ("HDR", True): "LHDR", ("NR", True): "LRB"}


class Cores(Strict):
    """Lead cores of a drawing; the other parameters of `LeadCores` follow from the compound."""

    cores: Annotated[int, Field(ge=1, le=1000)]
    diameter: Annotated[float, in_unit("mm"), Field(ge=0.1, le=1e4)]
    confined: bool
    end_spreading: Annotated[float, Field(ge=1e-3, le=1)] = 1.0

    @property
    def core_area(self) -> float:
        """Of one core [mm2]."""
        return 0.25 * math.pi * self.diameter**2


def rubber_modulus(bearing: Bearing) -> float:
    """Return the shear modulus K_r t_r/A of the elastic part of the rubber [MPa], without lead."""
    net = bearing.area - bearing.lead_area
    stiffness = bearing.hysteresis.layer_stiffness
    return NEWTON_PER_KILONEWTON * stiffness * bearing.geometry.rubber_thickness / net


def extract_compound(bearing: Bearing, name: str = "") -> Compound:
    """Return the compound of a bearing.

    `bearing`: any layered one, such as a calibrated specimen; `name`: of the compound; that of the
    bearing with "-compound" if not given.
    """
    g, h = bearing.geometry, bearing.hysteresis
    net, height = bearing.area - bearing.lead_area, g.total_rubber_thickness
    rubber = CompoundRubber(
        shear_modulus=rubber_modulus(bearing),
        yield_strain=h.yield_displacement / g.rubber_thickness,
        **{key: getattr(h, key) for key in WITHOUT_SIZE},
    )
    lead, rate = bearing.lead, bearing.rate
    # Moduli take the sizes out: the area of a core, the height over which it shears.
    if lead is not None:
        modulus = NEWTON_PER_KILONEWTON * lead.stiffness * height / lead.core_area
        values = {key: getattr(lead, key) for key in OF_LEAD}
        compound_lead: CompoundLead | None = CompoundLead(shear_modulus=modulus, **values)
    else:
        compound_lead = None
    branch = None
    if rate is not None:
        per_area = NEWTON_PER_KILONEWTON * height / net
        branch = CompoundRate(
            shear_modulus=per_area * rate.stiffness, viscosity=per_area * rate.damping
        )
    compound = Compound(
        name=name or f"{bearing.name}-compound",
        family="NR" if bearing.kind == "LRB" else "HDR",
        description=f"rubber of {bearing.name}" + (", with its lead" if compound_lead else ""),
        citation=bearing.citation,
        rubber=rubber,
        lead=compound_lead,
        rate=branch,
        **{key: getattr(bearing, key) for key in COPIED},
    )
    return compound.with_sources(_number_sources(bearing))


def _number_sources(bearing: Bearing) -> dict[str, str]:
    """Return the sources of a bearing's numbers under the names that they have in a compound."""
    sources = {}
    for key, source in bearing.sources.items():
        table, _, name = key.partition(".")
        if key in RULES:
            new, rule, _ = RULES[key]
            sources[new] = f"{rule} of {bearing.name}; {source}"
        elif table == "hysteresis":
            sources[f"rubber.{name}"] = source
        elif table in COPIED or (table == "lead" and name in OF_LEAD):
            sources[key] = source
    return sources


def _find_kind(compound: Compound, *, with_lead: bool) -> str:
    """Return the kind: HDR, LHDR or LRB."""
    if with_lead and compound.lead is None:
        raise InputError(
            f"compound {compound.name} has no lead parameters: give it the tables lead and "
            "materials.lead, or use a compound that has them (thermobearing list)"
        )
    kind = KINDS.get((compound.family, with_lead))
    if kind is None:
        raise InputError(
            f"compound {compound.name} is natural rubber: a bearing of it needs lead cores (LRB)"
        )
    return kind


def split_parts(compound: Compound, geometry: Geometry, cores: Cores | None) -> dict[str, Any]:
    """Return hysteresis, lead and rate of a bearing of that size, by key of `Bearing`."""
    rubber, height = compound.rubber, geometry.total_rubber_thickness
    lead_area = cores.cores * cores.core_area if cores else 0.0
    net = geometry.plan.area - lead_area
    if net <= 0.0:
        raise InputError(
            f"the lead cores have an area of {lead_area:g} mm2, the plan only "
            f"{geometry.plan.area:g} mm2"
        )
    layer = rubber.shear_modulus * net / geometry.rubber_thickness / NEWTON_PER_KILONEWTON
    hysteresis = RubberHysteresis(
        layer_stiffness=layer,
        yield_displacement=rubber.yield_strain * geometry.rubber_thickness,
        **{key: getattr(rubber, key) for key in WITHOUT_SIZE},
    )
    rate = None
    if compound.rate is not None:
        per_modulus = net / height / NEWTON_PER_KILONEWTON
        rate = RateDependence(
            stiffness=per_modulus * compound.rate.shear_modulus,
            damping=per_modulus * compound.rate.viscosity,
        )
    lead = None
    if cores is not None:
        lead = _lead(compound, cores, height, layer / geometry.rubber_layers)
    return {"hysteresis": hysteresis, "rate": rate, "lead": lead}


def _lead(compound: Compound, cores: Cores, height: float, post_yield: float) -> LeadCores:
    """Return the cores of the compound's lead; `post_yield` is K_2 of linear rubber [kN/mm]."""
    lead = compound.lead
    if lead is None:
        raise InputError(f"compound {compound.name} has no lead parameters")
    if lead.shear_modulus is not None:
        stiffness = lead.shear_modulus * cores.core_area / height / NEWTON_PER_KILONEWTON
    else:
        # K_1 - K_2 is the stiffness of all cores before they yield.
        stiffness = ((lead.stiffness_ratio or 0.0) - 1.0) * post_yield / cores.cores
    return LeadCores(
        cores=cores.cores,
        diameter=cores.diameter,
        confined=cores.confined,
        end_spreading=cores.end_spreading,
        stiffness=stiffness,
        **{key: getattr(lead, key) for key in OF_LEAD},
    )


def acting_rate(bearing: Bearing) -> RateDependence | None:
    """Return the rate branch that acts in a bearing: its own or a borrowed one, times its factor.

    None without a branch, or with a factor of zero.
    """
    band, branch = bearing.rate_band, bearing.rate
    if band is None or (branch is not None and band.factor == 1.0):
        return branch
    if band.factor == 0.0 or (branch is None and band.shear_modulus is None):
        return None
    if band.shear_modulus is not None and band.viscosity is not None:
        net = bearing.area - bearing.lead_area
        per_modulus = net / bearing.total_rubber_thickness / NEWTON_PER_KILONEWTON
        stiffness, damping = per_modulus * band.shear_modulus, per_modulus * band.viscosity
    else:
        assert branch is not None  # as the bearing's file was checked
        stiffness, damping = branch.stiffness, branch.damping
    # Without the limits of a file, which a small factor passes.
    return RateDependence.model_construct(
        stiffness=band.factor * stiffness, damping=band.factor * damping
    )


def build_bearing(
    compound: Compound, name: str, geometry: Geometry, cores: Cores | None = None, **fields: Any
) -> Bearing:
    """Return a bearing of a compound and size.

    `compound`: its rubber, and its lead if there are cores; `name`: of the bearing; `geometry`:
    plan, layers and plates; `cores`: lead cores; none by default; `more`: other keys of `Bearing`,
    such as cells and description.
    """
    kind: Any = _find_kind(compound, with_lead=cores is not None)
    return Bearing(
        name=name,
        kind=kind,
        geometry=geometry,
        **split_parts(compound, geometry, cores),
        **{key: getattr(compound, key) for key in COPIED},
        **fields,
    )


def resized(bearing: Bearing, geometry: Geometry, core_diameter: float | None = None) -> Bearing:
    """Return the bearing at another size, with its compound, number of cores and other keys.

    `bearing`: any layered one; `core_diameter`: of its lead cores [mm]; unchanged if not given.
    """
    cores = lead_cores(bearing, core_diameter)
    parts = split_parts(extract_compound(bearing), geometry, cores)
    return bearing.model_copy(update={"geometry": geometry, **parts})


def lead_cores(bearing: Bearing, diameter: float | None = None) -> Cores | None:
    """Lead cores of a bearing, with another diameter [mm] if given; None without lead."""
    if bearing.lead is None:
        return None
    return Cores(
        cores=bearing.lead.cores,
        diameter=bearing.lead.diameter if diameter is None else diameter,
        confined=bearing.lead.confined,
        end_spreading=bearing.lead.end_spreading,
    )
