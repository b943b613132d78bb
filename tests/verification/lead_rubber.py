"""Lead rubber bearings as `LeadRubberX` of OpenSees takes them, for comparisons with it.

Rubber K_el u beside a Bouc-Wen term of the lead, at any temperature; the factor of an open hole for
lead-filled bearings (`of_element`), as the element has it; see shared/spec/axial.md, sections 6, 7.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from thermobearing.bearing.model import CircularPlan, Geometry, LeadCores
from thermobearing.core.records import Floats, Rows
from thermobearing.core.types import Constants
from thermobearing.model.axial import Section, annular_section, build_column, compression_constants
from thermobearing.model.earlier import BilinearParameters, bilinear_constants
from thermobearing.structure import run
from thermobearing.structure.model import Structure

GRAVITY = 9810.0  # of the cases [mm/s2]
YIELD_RATIO = 0.1  # of the stiffness after yielding over that before, of the element
UNLOADING = 0.8  # of the Bouc-Wen law: 1 - z^2 loading, 1 + 0.8 z^2 unloading


@dataclass(frozen=True)
class LeadRubber:
    """A round bearing with one lead core; lengths [mm], modulus and yield stress [GPa]."""

    diameter: float
    core: float
    layers: int
    thickness: float
    shim: float
    modulus: float
    yield_stress: float

    @property
    def area(self) -> float:
        """Net area [mm2]."""
        return math.pi / 4.0 * (self.diameter**2 - self.core**2)

    @property
    def stiffness(self) -> float:
        """K_el of the rubber [kN/mm]."""
        return self.modulus * self.area / (self.layers * self.thickness)

    @property
    def strength(self) -> float:
        """Q of the lead [kN]."""
        return self.yield_stress * math.pi / 4.0 * self.core**2

    @property
    def yield_displacement(self) -> float:
        """u_y [mm]."""
        return self.strength / (self.stiffness / YIELD_RATIO - self.stiffness)

    @property
    def geometry(self) -> Geometry:
        """The bearing without lead, as the package takes it."""
        return Geometry(
            plan=CircularPlan(shape="circular", diameter=self.diameter),
            rubber_layers=self.layers,
            rubber_thickness=self.thickness,
            shim_thickness=self.shim,
            end_plate_thickness=25,
        )

    @property
    def section(self) -> Section:
        """Section of a layer with the shape factor of a filled hole and the F of an open one."""
        opened = annular_section(self.diameter, self.core, self.thickness, filled=False)
        shape = (self.diameter - self.core) / (4.0 * self.thickness)
        factor = opened.shape / (float(compression_constants()["compression_round"]) * shape**2)
        filled = annular_section(self.diameter, self.core, self.thickness, filled=True)
        return filled._replace(shape=factor * filled.shape)

    def constants(self) -> tuple[Constants, Rows]:
        """Return constants and column of one layer that stands for all, of the net area."""
        constants = bilinear_constants(BilinearParameters(1.0, 1.0, 2.0))
        rubber = constants.rubber._replace(
            elastic_stiffness=self.stiffness,
            hysteretic_stiffness=self.strength / self.yield_displacement,
            yield_displacement=self.yield_displacement,
            per_yield_displacement=1.0 / self.yield_displacement,
            unloading_curvature=UNLOADING / self.yield_displacement**2,
        )
        lead = LeadCores(
            cores=1,
            diameter=self.core,
            stiffness=8.0,
            yield_stress=10,
            reference_temperature=23,
            confined=False,
        )
        column = build_column(self.geometry, lead, secant=0.0, section=self.section)
        column["layer_thickness"], column["layer_count"] = self.layers * self.thickness, 1.0
        return constants._replace(rubber=rubber, lead=constants.lead._replace(cores=0.0)), column


def shake(
    bearing: LeadRubber,
    load: float,
    ground: Floats,
    dt: float,
    *,
    acts: bool = True,
    upwards: Floats | None = None,
) -> run.StructureHistory:
    """Return the history of one bearing under a rigid mass that weighs its `load` [kN].

    Its axial force, which `acts` switches off, is constant without a vertical motion.
    """
    if acts and upwards is not None:
        return make_line(bearing, np.array([load]), ground, dt, upwards=upwards)
    pressed = run.PressedLine(
        columns=bearing.constants()[1], dead_loads=np.array([load]), places=np.zeros(1)
    )
    return _march(bearing, 1, load, pressed if acts else None, ground, dt)


def make_line(
    bearing: LeadRubber,
    loads: Floats,
    ground: Floats,
    dt: float,
    *,
    upwards: Floats | None = None,
    places: Floats | None = None,
    **options: Any,
) -> run.StructureHistory:
    """Return the history of bearings side by side under a rigid mass that weighs their loads.

    It overturns where `places` [mm] are given; `options` are fields of `PressedLine`.
    """
    weight = float(loads.sum())
    pressed = run.PressedLine(
        columns=bearing.constants()[1],
        dead_loads=loads,
        places=np.zeros(len(loads)) if places is None else places,
        moves=True,
        overturns=places is not None,
        mass=weight / GRAVITY,
        **options,
    )
    return _march(bearing, len(loads), weight, pressed, ground, dt, upwards)


def _march(
    bearing: LeadRubber,
    count: int,
    weight: float,
    pressed: run.PressedLine | None,
    ground: Floats,
    dt: float,
    upwards: Floats | None = None,
) -> run.StructureHistory:
    structure = Structure(
        name="line",
        bodies=[{"name": "deck", "moves": True, "base_height": 0}],
        masses=[{"body": "deck", "height": 0, "mass": weight / GRAVITY}],
        bearings=[
            {
                "name": "line",
                "body": "deck",
                "base": "ground",
                "count": count,
                "equivalent_stiffness": bearing.stiffness,
            }
        ],
        damping={"kind": "none"},
        report={"deck": "deck"},
    )
    line = run.Line(bearing.constants()[0], np.full(1, 23.0), pressed=pressed)
    ambient = np.full(len(ground) - 1, 23.0)
    prepared = run.prepare_structure(structure)
    return run.run_structure(prepared, [line], ground, dt, ambient, vertical=upwards)
