"""Heat flow out of lead cores: a half-space, or ports into plates of finite thickness and shims."""

import math
from typing import NamedTuple

import numpy as np

from thermobearing.bearing.model import Bearing, Material
from thermobearing.core.records import Floats, Rows, filled, rows
from thermobearing.core.types import LeadCell, Mode
from thermobearing.model.lead_impedance import MOST_TERMS, ROOM, LeadSizes, Medium, fill_network
from thermobearing.model.stack import MM_PER_M, EndFace, Stack, film_at_face


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


def _medium(material: Material) -> Medium:
    return Medium(material.conductivity / MM_PER_M, material.volumetric_heat)


def lead_sizes(bearing: Bearing, stack: Stack, upper: EndFace, lower: EndFace | None) -> LeadSizes:
    """Return what the flow out of the cores of a bearing depends on, as plain numbers."""
    g, m, lead = bearing.geometry, bearing.materials, bearing.lead
    assert lead is not None
    assert m.lead is not None
    return LeadSizes(
        steel=_medium(m.steel),
        rubber=_medium(m.rubber),
        lead=_medium(m.lead),
        end_plate=g.end_plate_thickness,
        sealing_plate=g.sealing_plate_thickness,
        layer=g.rubber_thickness,
        shim=g.shim_thickness,
        radius=lead.radius,
        plan=math.sqrt(bearing.area / lead.cores / math.pi),
        confined=lead.confined,
        spreading=lead.end_spreading,
        fold=stack.fold,
        film_above=film_at_face(upper, stack, 0),
        film_below=0.0 if lower is None else film_at_face(lower, stack, -1),
    )


def lead_network(bearing: Bearing, stack: Stack, upper: EndFace, lower: EndFace | None) -> Network:
    """Ports of the lead cores of a bearing.

    `upper`, `lower`: heat exchange of the end faces; `lower` is None for a half stack.
    """
    sizes = lead_sizes(bearing, stack, upper, lower)
    cells, modes = rows(LeadCell, len(stack.part)), rows(Mode, MOST_TERMS)
    ports, cell_count, mode_count = fill_network(
        sizes, stack.codes, stack.thickness, stack.touches_lead_end, np.zeros(ROOM), cells, modes
    )
    return Network(ports, cells[:cell_count], modes[:mode_count])
