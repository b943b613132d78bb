"""Cells, exchange rates and constants of a bearing by hand, and those of the earlier models."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.cyclic.equivalent import backbone
from thermobearing.model.constants import build_constants
from thermobearing.model.earlier import BilinearParameters, bilinear_constants
from thermobearing.model.options import build_model
from thermobearing.model.stack import Face, build_stack, conservative_rates

HDR, LHDR = tb.load_bearing("shen-hdr-specimen"), tb.load_bearing("shen-lhdr-specimen")
ETA = Face(eta=2.0)
STEEL, RUBBER = HDR.materials.steel, HDR.materials.rubber


def test_half_stack_of_the_specimen() -> None:
    """Fig. 4.2b: ten cells of plate, rubber 2 x 2.5 mm and shims 3.2 mm, half a shim."""
    stack = build_stack(HDR, half=True)
    thickness = [2.5] * 10 + [2.5, 2.5, 3.2] * 2 + [2.5, 2.5, 1.6]
    assert_allclose(stack.thickness, thickness)
    assert_allclose(stack.depth[[0, 10, 11, 12, 18]], [1.25, 26.25, 28.75, 31.6, 47.2])
    assert [tuple(pair) for pair in zip(*stack.middles(), strict=True)] == [
        (10, 11), (13, 14), (16, 17),
    ]  # fmt: skip
    assert stack.multiplicity.tolist() == [2.0, 2.0, 2.0]


@pytest.mark.parametrize(("cells", "upper", "lower"), [(1, 0, 0), (3, 1, 1), (4, 1, 2)])
def test_cells_beside_the_middle_of_a_layer(cells: int, upper: int, lower: int) -> None:
    bearing = HDR.model_copy(update={"cells": HDR.cells.model_copy(update={"rubber": cells})})
    stack = build_stack(bearing, half=True)
    found = [row - stack.first_cell for row in stack.middles()]
    assert_allclose(found, [[upper] * 3, [lower] * 3])


def test_lead_reaches_from_plate_to_plate() -> None:
    """96 mm in the specimen: two sealing plates, six layers, five shims; 25 + 5 + ... each half."""
    stack = build_stack(LHDR, half=True)
    g = LHDR.geometry
    sealed = g.total_rubber_thickness + 5 * g.shim_thickness + 2 * g.sealing_plate_thickness
    assert_allclose(stack.beside_lead.sum(), sealed)
    beside = {part for part, height in zip(stack.part, stack.beside_lead, strict=True) if height}
    assert beside == {"sealing_plate", "rubber", "shim"}
    cells = len(stack.part)
    profile = np.linspace(-20.0, 40.0, cells)
    test = tb.CyclicTest(dt=0.01, steps=[{"step": "rest", "duration": 0.01}])
    result = tb.run(LHDR, test, 0.0, initial=profile)
    mean = float(stack.beside_lead @ profile / stack.beside_lead.sum())
    assert_allclose(result["lead_temperature"].values[0, 0], mean)


def test_exchange_between_cells() -> None:
    """Half a cell of each material in series, through the smaller of the two areas."""
    stack = build_stack(LHDR, half=True)
    rates = conservative_rates(stack, ETA, None)
    net = LHDR.area - LHDR.lead_area
    k_s, k_r = STEEL.conductivity / 1e3, RUBBER.conductivity / 1e3
    ends, plates = LHDR.cells.end_plate, LHDR.cells.sealing_plate
    plate, sealing = stack.thickness[ends - 1], stack.thickness[ends]
    for cell, area, resistance in (
        (0, LHDR.area, plate / k_s),
        (ends - 1, net, 0.5 * (plate + sealing) / k_s),
        (ends + plates - 1, net, 0.5 * sealing / k_s + 0.5 * 2.5 / k_r),
        (ends + plates, net, 2.5 / k_r),
    ):
        capacity = stack.heat_capacity[cell : cell + 2] / stack.fold
        flow = area / resistance
        assert_allclose(rates.to_next[cell] * capacity[0], flow, rtol=tol.LOOP)
        assert_allclose(rates.to_previous[cell + 1] * capacity[1], flow, rtol=tol.LOOP)
    side = float(rates.side_loss @ stack.heat_capacity)
    assert_allclose(side, LHDR.materials.side_film * 1e-6 * 960.0 * 2.0 * stack.thickness.sum())


def test_losses_through_unlike_faces() -> None:
    """eta: (eta - 1) k/dx; a film in series with half a cell; the upper face is that of cell 0."""
    stack = build_stack(HDR, half=False)
    capacity = stack.heat_capacity
    k, dx = STEEL.conductivity / 1e3, 2.5
    loss = conservative_rates(stack, Face(eta=2.5), Face(film=20.0)).end_loss * capacity
    assert_allclose(loss[0], 1.5 * k / dx * HDR.area, rtol=tol.LOOP)
    film = 20e-6
    assert_allclose(loss[-1], HDR.area / (1.0 / film + 0.5 * dx / k), rtol=tol.LOOP)
    assert not loss[1:-1].any()


def test_numbers_of_rubber() -> None:
    rubber = build_model(HDR).constants.rubber
    h = HDR.hysteresis
    assert rubber.layer_count == 6.0
    assert_allclose(rubber.elastic_stiffness, h.post_yield_ratio * h.layer_stiffness)
    assert_allclose(rubber.hysteretic_stiffness, (1 - h.post_yield_ratio) * h.layer_stiffness)
    assert_allclose(rubber.elastic_exponent, h.elastic_temperature_coefficient / 100.0)
    assert_allclose(rubber.hysteretic_exponent, h.hysteretic_temperature_coefficient / 100.0)
    assert_allclose(rubber.hardening, h.hardening / 25.0)
    curvature = (1.0 - h.shape) / (1.0 + h.shape) / h.yield_displacement**2
    assert_allclose(rubber.unloading_curvature, curvature)


@pytest.mark.parametrize("clock", ["steel", "lead"])
def test_numbers_of_lead_and_rate(clock: str) -> None:
    assert LHDR.lead is not None
    assert LHDR.rate is not None
    assert LHDR.materials.lead is not None
    bearing = LHDR.model_copy(update={"lead": LHDR.lead.model_copy(update={"clock": clock})})
    stack = build_stack(bearing, half=True)
    constants = build_constants(bearing, stack, upper=ETA, lower=None)
    medium = LHDR.materials.steel if clock == "steel" else LHDR.materials.lead
    diffusivity = medium.conductivity / 1e3 / medium.volumetric_heat
    assert_allclose(constants.lead.clock_rate, diffusivity / 17.25**2)
    height = float(stack.beside_lead.sum())
    capacity = LHDR.materials.lead.volumetric_heat * LHDR.lead.core_area * height
    assert_allclose(constants.lead.capacity, capacity)
    assert constants.lead.cores == 4.0
    assert_allclose(constants.viscous.relaxation, LHDR.rate.damping / LHDR.rate.stiffness)


def test_one_temperature_loses_heat_through_both_ends_and_the_sides() -> None:
    """Eq. 2.12, first step of a rest at -20 degC; half a layer and the plate to each end."""
    dt = 0.1
    test = tb.CyclicTest(dt=dt, steps=[{"step": "rest", "duration": dt}])
    result = tb.run(HDR, test, -20.0, initial=20.0, model="single-temperature")
    resistance = 1e3 * (2.5 / RUBBER.conductivity + 25.0 / STEEL.conductivity)
    rubber, shims = 30.0 * RUBBER.volumetric_heat, 16.0 * STEEL.volumetric_heat
    capacity = HDR.area * (rubber + shims)
    ends = 2.0 * HDR.area / resistance
    sides = HDR.materials.side_film * 1e-6 * 960.0 * 46.0
    rate = (ends + sides) / capacity
    wanted = 20.0 - 40.0 * rate * dt / (1.0 + 0.5 * rate * dt)
    assert_allclose(result["final_temperature"].values[0], [wanted], rtol=1e-12)
    books = result.energy.iloc[0]
    ratio = books["heat_lost_ends_kN_mm"] / books["heat_lost_sides_kN_mm"]
    assert_allclose(ratio, ends / sides, rtol=1e-9)


def test_bilinear_bearing_by_hand() -> None:
    """Q_d = 90 kN, K_1 = 10, K_2 = 2 kN/mm: elastic, then along the backbone, then back."""
    constants = bilinear_constants(BilinearParameters(strength=90.0, post_yield=2.0, initial=10.0))
    element = tb.BearingElement.from_constants(constants, 23.0)
    trial = element.set_trial(3.0, 0.01)
    assert_allclose([trial.force, trial.tangent], [30.0, 10.0])
    trial = element.set_trial(50.0, 0.01)
    assert_allclose([trial.force, trial.tangent], [190.0, 2.0])
    element.commit()
    assert_allclose(element.set_trial(45.0, 0.01).force, 140.0)


def test_design_assumes_that_the_first_branch_is_six_and_a_half_times_stiffer() -> None:
    slim = backbone(2.0, 0.1 * 2.0 * math.pi * 2.0 * 100.0**2, 100.0)
    assert_allclose(slim.initial / slim.post_yield, 6.5)
    fat = backbone(2.0, 0.4 * 2.0 * math.pi * 2.0 * 100.0**2, 100.0)
    assert fat.initial / fat.post_yield > 6.5
