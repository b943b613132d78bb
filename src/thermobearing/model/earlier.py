"""Earlier models, each a modification of the constants of the coupled step.

They serve for comparison (`thermobearing cyclic --compare`, or `model` in a case). None has
a separate step: a model that ignores conduction has zero rates, one with a single temperature
has a single cell, and so on. Comments state assumptions where the publications give no value.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from thermobearing.bearing.model import Bearing
from thermobearing.core.records import Rows, filled, rows
from thermobearing.core.types import (
    EXACT,
    HEAT_FROM_WORK,
    Cells,
    Constants,
    LawPiece,
    LayerCells,
    Lead,
    LeadCell,
    Mode,
    Rubber,
    Viscous,
)
from thermobearing.model.outcomes import limits_of_a_step
from thermobearing.model.stack import MM_PER_M, Stack

Model = Literal[
    "multi-layer",
    "adiabatic",
    "per-cycle",
    "single-temperature",
    "lead-alone",
    "temperature-blind",
    "bilinear",
]
REFERENCE: Model = "multi-layer"  # that the others are compared with
BLIND = ("temperature-blind", "bilinear")  # rubber stiffness independent of temperature
ONE_CELL = ("per-cycle", "single-temperature")  # for all layers: they need a full stack
UNCHANGING = 1e12  # factor on heat capacities that keeps a temperature constant
TIGHT = 1e6  # lead exchanges heat this fast with the single temperature [kN mm/(s K)]


@dataclass(frozen=True)
class BilinearParameters:
    """Backbone of the bearing."""

    strength: float  # Q_d, force at zero displacement [kN]
    post_yield: float  # K_2 [kN/mm]
    initial: float  # K_1 [kN/mm]

    @property
    def yield_force(self) -> float:
        """The force Q_y at the yield displacement [kN]."""
        return self.strength * self.initial / (self.initial - self.post_yield)

    @property
    def yield_displacement(self) -> float:
        """The yield displacement u_y = Q_d/(K_1 - K_2) [mm]."""
        return self.strength / (self.initial - self.post_yield)

    def stiffness(self, amplitude: float) -> float:
        """Return the effective stiffness at some amplitude [mm], K_1 up to yield [kN/mm]."""
        return min(self.strength / amplitude + self.post_yield, self.initial)

    def energy(self, amplitude: float) -> float:
        """Return the energy of a cycle of some amplitude [mm], 4 Q_d (u - u_y) [kN mm].

        It is zero below the yield displacement u_y.
        """
        elastic = self.yield_displacement
        return 4.0 * self.strength * max(amplitude - elastic, 0.0)


def _adiabatic(constants: Constants) -> Constants:
    """Adiabatic rise of the rubber, T = (1/(rho c V)) int F du.

    Constantinou et al. (2007), Eq. 2.4-2.6 of Shen (2023): no conduction to steel, ends or air.
    """
    lead = constants.lead._replace(end_conductance=0.0, side_conductance=0.0)
    return constants._replace(
        cells=_unexchanging(constants.cells), lead=lead, lead_cells=rows(LeadCell, 0)
    )


def _lumped(constants: Constants, stack: Stack) -> Constants:
    """One cell for all rubber layers, shims and lead, losing no heat.

    Okui et al. (2019), Eq. 2.11: dT = delta V_r / (m_r c_r + m_s c_s); the rise per cycle of
    Shen (2023) is what this one shows at the end of each cycle. `stack` must be a full one.
    """
    inside = np.array([name in ("rubber", "shim") for name in stack.part])
    capacity = float(stack.heat_capacity[inside].sum())
    layers = len(constants.multiplicity)
    touching = rows(LeadCell, 0 if constants.lead.cores == 0.0 else 1)
    touching["end"] = TIGHT
    cells = _lone_cell(capacity, float(constants.cells.beside_lead.sum()))
    return constants._replace(
        cells=cells,
        layer_cells=_one_cell(layers),
        lead=constants.lead._replace(published=False),  # its misprints concern layered cells
        lead_cells=touching,
        source_rise=1.0 / capacity,
        side_implicit=True,
    )


def _lumped_with_losses(constants: Constants, bearing: Bearing, stack: Stack) -> Constants:
    """One temperature for the bearing, with losses: dT/dt = (dE/dt - dQ/dt) lambda.

    Tan et al. (2023a), Eq. 2.12. Its layer law and losses are not published: the layer law
    here is assumed (Eq. 4.34 at the single temperature); heat leaves through half an outer rubber
    layer and the plates beyond it to a face at ambient temperature, and through the sides.
    """
    lumped = _lumped(constants, stack)
    g, m = bearing.geometry, bearing.materials
    # In series from the middle of an outer layer to the face, which is at ambient temperature.
    plates = (g.end_plate_thickness + g.sealing_plate_thickness) / m.steel.conductivity
    resistance = MM_PER_M * (0.5 * g.rubber_thickness / m.rubber.conductivity + plates)
    height = g.total_rubber_thickness + (g.rubber_layers - 1) * g.shim_thickness
    capacity = lumped.cells.capacity[0]
    lumped.cells.end_loss[:] = 2.0 * bearing.area / resistance / capacity
    lumped.cells.side_loss[:] = stack.side_film * stack.perimeter * height / capacity
    return lumped


def _lone_cell(capacity: float, beside_lead: float) -> Cells:
    """Return a single cell that exchanges no heat."""
    zeros = [np.zeros(1) for _ in Cells._fields]
    return Cells(*zeros)._replace(
        capacity=np.array([capacity]), beside_lead=np.array([beside_lead])
    )


def _unexchanging(cells: Cells) -> Cells:
    """Return the same cells, without heat exchange between each other and with the ambient."""
    zeros = np.zeros_like(cells.capacity)
    return cells._replace(to_previous=zeros, to_next=zeros, end_loss=zeros, side_loss=zeros)


def _one_cell(layers: int) -> Rows[LayerCells]:
    """All layers have the temperature of the single cell."""
    return filled(LayerCells, first=np.zeros(layers), last=1, upper_middle=0, lower_middle=0)


def _temperature_blind(constants: Constants) -> Constants:
    """Bouc-Wen model with the stiffness of the reference temperature.

    Eq. 4.34 with m_T = n_T = 0, lead of constant strength. Temperatures are still computed.
    """
    rubber = constants.rubber._replace(elastic_exponent=0.0, hysteretic_exponent=0.0)
    lead = constants.lead._replace(softening=0.0, softening_beyond=0.0)
    return constants._replace(rubber=rubber, lead=lead, law=rows(LawPiece, 0))


def _bilinear(constants: Constants, parameters: BilinearParameters) -> Constants:
    """Return the bilinear model of design (Fig. 6.3), temperature-independent.

    A linear spring K_2 and, in parallel, an elastic and perfectly plastic one of strength Q_d
    and stiffness K_1 - K_2, which are the branches of the lead here.
    """
    # The spring starts at the mean temperature.
    cells = constants.cells._replace(beside_lead=constants.cells.capacity)
    plain = constants._replace(
        rubber=_backbone_rubber(constants.rubber.layer_count, parameters),
        lead=_backbone_spring(parameters, constants.lead.fold),
        viscous=constants.viscous._replace(stiffness=0.0),
        law=rows(LawPiece, 0),
        cells=cells,
        lead_cells=rows(LeadCell, 0),
    )
    return isothermal(plain)


def bilinear_constants(parameters: BilinearParameters) -> Constants:
    """Return constants of a bilinear bearing alone: one layer, one cell that never warms."""
    return Constants(
        law=rows(LawPiece, 0),
        rubber=_backbone_rubber(1.0, parameters),
        lead=_backbone_spring(parameters, 1.0),
        viscous=Viscous(0.0, 1.0, heats=False),
        multiplicity=np.ones(1),
        layer_cells=_one_cell(1),
        cells=_lone_cell(UNCHANGING, UNCHANGING),
        lead_cells=rows(LeadCell, 0),
        lead_ports=0,
        lead_modes=rows(Mode, 0),
        source_rise=1.0 / UNCHANGING,
        side_implicit=True,
        heat_source=HEAT_FROM_WORK,
        limits=limits_of_a_step(),
    )


def _backbone_rubber(count: float, parameters: BilinearParameters) -> Rubber:
    """Return a chain of `count` linear layers whose stiffness is K_2 [kN/mm]."""
    return Rubber(
        layer_count=count,
        layer_share=1.0 / count,
        elastic_stiffness=count * parameters.post_yield,
        hysteretic_stiffness=0.0,
        elastic_exponent=0.0,
        hysteretic_exponent=0.0,
        reference_temperature=0.0,
        hardening=0.0,
        monotone=False,
        yield_displacement=1.0,
        per_yield_displacement=1.0,
        unloading_curvature=0.0,
        integrator=EXACT,
        closed_loops=False,
        virgin=False,
        scragging_amplitude=0.0,
        scragging_displacement=1.0,
        mullins_amplitude=0.0,
        mullins_decay=1.0,
        mullins_renewal=1.0,
        sharing_start=0.0,
        sharing_full=-1.0,
    )


def _backbone_spring(parameters: BilinearParameters, fold: float) -> Lead:
    """Return an elastic, perfectly plastic branch: strength Q_d, stiffness K_1 - K_2."""
    return Lead(
        cores=1.0,
        stiffness=parameters.initial - parameters.post_yield,
        strength=parameters.strength,
        softening=0.0,
        softening_beyond=0.0,
        reference_temperature=0.0,
        warmest_tested=0.0,
        capacity=UNCHANGING,
        clock_rate=1.0,
        end_conductance=0.0,
        side_conductance=0.0,
        fold=fold,
        published=False,
    )


def isothermal(constants: Constants) -> Constants:
    """Return the constants with infinite heat capacity of steel and rubber."""
    cells = _unexchanging(constants.cells)
    cells = cells._replace(capacity=cells.capacity * UNCHANGING)
    return constants._replace(cells=cells, source_rise=constants.source_rise / UNCHANGING)


def without_heating(constants: Constants) -> Constants:
    """Return the constants of a bearing that stays at its temperature, its lead too."""
    lead = constants.lead._replace(capacity=constants.lead.capacity * UNCHANGING)
    return isothermal(constants)._replace(lead=lead)


def models_that_fit(bearing: Bearing) -> list[Model]:
    """Return the multi-layer model and the earlier ones; `lead-alone` needs lead."""
    return [m for m in get_args(Model) if m != "lead-alone" or bearing.lead is not None]


def apply_model(
    model: Model,
    constants: Constants,
    bearing: Bearing,
    stack: Stack,
    backbone: Callable[[Bearing], BilinearParameters] | None,
) -> Constants:
    """Constants of an earlier model from those of the multi-layer one.

    `backbone` computes the bilinear model of a bearing; needed for "bilinear".
    """
    if model == "adiabatic":
        return _adiabatic(constants)
    if model == "per-cycle":
        return _lumped(constants, stack)
    if model == "single-temperature":
        return _lumped_with_losses(constants, bearing, stack)
    if model == "lead-alone":  # Kalpakidis & Constantinou (2009), Eq. 2.7-2.9
        return isothermal(constants)
    if model == "temperature-blind":
        return _temperature_blind(constants)
    if model == "bilinear" and backbone is not None:
        return _bilinear(constants, backbone(bearing))
    return constants
