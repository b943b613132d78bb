"""Compiled functions, cells, rates and constants by hand; short enough for plain Python too."""

import math
from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.core.hardening import force_and_tangent, surely_stiff
from thermobearing.core.hysteresis import euler_increment, exact_increment
from thermobearing.core.lead import core_force, core_heat
from thermobearing.core.records import rows
from thermobearing.core.step import maxwell, recoverable_energy, relax, runs_away
from thermobearing.core.types import (
    HEAT_FROM_DISSIPATION,
    HEAT_FROM_WORK,
    DurationWork,
    Layer,
    new_state,
)
from thermobearing.cyclic.equivalent import backbone
from thermobearing.model.constants import build_constants
from thermobearing.model.earlier import BilinearParameters, bilinear_constants
from thermobearing.model.options import ModelOptions, build_model
from thermobearing.model.stack import EndFace, build_stack, conservative_rates

HDR, LHDR = tb.load_bearing("shen-hdr-specimen"), tb.load_bearing("shen-lhdr-specimen")
RUBBER = build_model(HDR).constants.rubber
LEAD = build_model(LHDR).constants.lead._replace(softening=0.0069)
D_Y = 0.8  # [mm]


def integrated(z: float, increment: float, curvature: float) -> float:
    """Z by Runge and Kutta from dZ = dd - beta |dd Z| Z - gamma dd Z^2, Eq. 4.35."""
    total, difference = 1.0 / D_Y**2, curvature  # beta + gamma, beta - gamma
    beta, gamma = 0.5 * (total + difference), 0.5 * (total - difference)
    sign, steps = math.copysign(1.0, increment), 2000
    h = increment / steps

    def slope(z: float) -> float:
        return 1.0 - beta * abs(z) * z * sign - gamma * z * z

    for _ in range(steps):
        a = slope(z)
        b = slope(z + 0.5 * h * a)
        c = slope(z + 0.5 * h * b)
        z += h * (a + 2.0 * b + 2.0 * c + slope(z + h * c)) / 6.0
    return z


@pytest.mark.parametrize("shape", [-0.7, 0.4, 1.0, 2.5])
@pytest.mark.parametrize("z", [-0.6, 0.0, 0.5])
@pytest.mark.parametrize("increment", [-1.5, -0.2, 0.3, 2.0])
def test_exact_increment_solves_its_equation(shape: float, z: float, increment: float) -> None:
    curvature = (1.0 - shape) / ((1.0 + shape) * D_Y**2)
    result, slope = exact_increment(z, increment, D_Y, 1.0 / D_Y, curvature)
    assert_allclose(result, integrated(z, increment, curvature), atol=tol.RUNGE_KUTTA)
    step = math.copysign(1e-6, increment)
    ahead, _ = exact_increment(z, increment + step, D_Y, 1.0 / D_Y, curvature)
    assert_allclose((ahead - result) / step, slope, atol=1e-5)


def test_euler_increment_by_hand() -> None:
    """Loading loses z^2/d_y^2 of the slope, unloading gains c z^2; mirrored downwards."""
    for sign in (1.0, -1.0):
        z, slope = euler_increment(sign * 0.4, sign * 0.1, 1.0 / D_Y, 3.0)
        assert_allclose([sign * z, slope], [0.4 + 0.1 * 0.75, 0.75])
        z, slope = euler_increment(-sign * 0.4, sign * 0.1, 1.0 / D_Y, 3.0)
        assert_allclose([sign * z, slope], [-0.4 + 0.1 * 1.48, 1.48])


def test_maxwell_branch_by_hand() -> None:
    """K_v = 2 kN/mm, tau = 0.5 s; held, and moved by 3 mm in 0.1 s."""
    decay, duration = math.exp(-0.2), rows(DurationWork, 1)[0]
    relax(0.5, 0.1, duration)
    assert_allclose(maxwell(2.0, duration, 7.0, 0.0)[0], 7.0 * decay)
    force, tangent = maxwell(2.0, duration, 7.0, 3.0)
    assert_allclose(tangent, 2.0 * 0.5 / 0.1 * (1.0 - decay))
    assert_allclose(force, 7.0 * decay + 3.0 * tangent)
    # Another duration, another relaxation time.
    for relaxation, dt in ((0.5, 0.2), (0.4, 0.2)):
        relax(relaxation, dt, duration)
        assert_allclose(maxwell(2.0, duration, 7.0, 0.0)[0], 7.0 * math.exp(-dt / relaxation))


@pytest.mark.parametrize("w", [0.0, 0.4, 1.0])
def test_force_of_a_layer_by_hand(w: float) -> None:
    """f = ke d + (1 + B s^2) kh Z, s between d and the mean; and its derivative."""
    ke, kh, d, z, slope, mean = 2.0, 15.0, 6.0, -0.5, 0.9, 5.0
    s = (1.0 - w) * d + w * mean
    force, tangent = force_and_tangent(RUBBER, ke, kh, d, z, slope, mean, w)
    assert_allclose(force, ke * d + (1.0 + RUBBER.hardening * s**2) * kh * z, rtol=tol.LOOP)
    step = 1e-6
    ahead, _ = force_and_tangent(RUBBER, ke, kh, d + step, z + slope * step, slope, mean, w)
    assert_allclose((ahead - force) / step, tangent, rtol=1e-5)
    stored = recoverable_energy(RUBBER, ke, kh, d, z, mean, w)
    wanted = 0.5 * ke * d**2 + 0.5 * (1.0 + RUBBER.hardening * s**2) * kh * z**2
    assert_allclose(stored, wanted, rtol=tol.LOOP)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_explicit_euler_that_runs_away_is_noticed_on_both_sides(sign: float) -> None:
    element = tb.BearingElement(HDR, -20.0, model=tb.ModelOptions(integrator="euler"))
    assert element.set_trial(sign * 90.0, 1.0).outcome == "euler_unstable"
    assert element.set_trial(sign * 1.0, 1.0).outcome == "completed"


@pytest.mark.parametrize(("rubber", "away"), [(-280.0, True), (23.0, False), (900.0, True)])
def test_layers_colder_or_hotter_than_rubber_can_be(rubber: float, away: bool) -> None:
    constants = build_model(HDR).constants
    state = new_state(constants, np.full(len(constants.cells.capacity), rubber))
    assert runs_away(constants, state) == away


@pytest.mark.parametrize("source", [HEAT_FROM_WORK, HEAT_FROM_DISSIPATION])
def test_core_of_lead_by_hand(source: int) -> None:
    """Elastic, yielding; warm lead is weaker; the tangent is the slope, in both directions."""
    k, q = LEAD.stiffness, LEAD.strength
    at = LEAD.reference_temperature
    assert core_force(LEAD, source, at, 1.0, 0.1) == (1.0 + 0.1 * k, k)
    for sign in (1.0, -1.0):
        for before in (0.0, 0.5 * q, -q):
            force, tangent = core_force(LEAD, source, at, before, sign * 8.0)
            assert 0.8 * q < sign * force <= q  # warmed by its own work
            step = sign * 1e-5
            ahead, _ = core_force(LEAD, source, at, before, sign * 8.0 + step)
            assert_allclose((ahead - force) / step, tangent, rtol=1e-4)
    warm, _ = core_force(LEAD, source, at + 100.0, 0.0, 8.0)
    cold, _ = core_force(LEAD, source, at, 0.0, 8.0)
    assert_allclose(warm / cold, math.exp(-0.69), rtol=0.02)


def test_heat_of_a_core_by_hand() -> None:
    """Elastic loading gives its work back; yielding at constant force turns all into heat."""
    k = LEAD.stiffness
    assert_allclose(core_heat(LEAD, HEAT_FROM_WORK, 0.0, 2.0 * k, 2.0), 2.0 * k)
    assert_allclose(core_heat(LEAD, HEAT_FROM_DISSIPATION, 0.0, 2.0 * k, 2.0), 0.0, atol=1e-12)
    for source in (HEAT_FROM_WORK, HEAT_FROM_DISSIPATION):
        assert_allclose(core_heat(LEAD, source, 9.0, 9.0, 4.0), 36.0)


@pytest.mark.parametrize("source", ["work", "dissipation"])
def test_balance_of_a_few_coarse_steps_closes(source: str) -> None:
    """Rubber, lead and rate dependence, out and back and out again in steps of 5 mm."""
    ramps = [{"step": "ramp", "to": f"{x} mm", "speed": "100 mm/s"} for x in (30, -20, 45)]
    test = tb.CyclicTest(dt=0.05, steps=[*ramps, {"step": "rest", "duration": 2.0}])
    response = tb.run(LHDR, test, -20.0, model=tb.ModelOptions(heat_source=source)).energy.iloc[0]
    for kind in ("mechanical", "thermal"):
        assert abs(response[f"{kind}_residual"]) < tol.ENERGY_BALANCE
    assert (response["recoverable_kN_mm"] == 0.0) == (source == "work")


def test_heat_of_one_long_step_is_booked_as_it_was_lost() -> None:
    """A warm bearing at rest; a film on its ends, its sides in the wind, one step of 0.1 s."""
    test = tb.CyclicTest(dt=0.1, steps=[{"step": "rest", "duration": 0.1}])
    face = tb.EndFace(film=30.0)
    result = tb.run(
        HDR, test, -20.0, initial=20.0, model=tb.ModelOptions(upper_face=face, lower_face=face)
    )
    assert int(result["steps"].sum()) == 1
    response = result.energy.iloc[0]
    assert response["heat_lost_ends_kN_mm"] > 0.0
    assert abs(response["thermal_residual"]) < tol.ENERGY_BALANCE


@pytest.mark.parametrize("published", [False, True])
def test_side_loss_of_one_step(published: bool) -> None:
    """Explicit as printed: with the temperatures before; Crank-Nicolson: with their means."""
    options = ModelOptions(scheme="published" if published else "conservative")
    model = build_model(HDR, options)
    rest = {"step": "rest", "duration": 0.1}
    test = tb.CyclicTest(dt=0.1, steps=[rest])
    result = tb.run(HDR, test, -20.0, initial=20.0, model=tb.ModelOptions(scheme=options.scheme))
    before, after = (result[f"{when}_temperature"].values[0] for when in ("initial", "final"))
    above = (before if published else 0.5 * (before + after)) + 20.0
    stack, heat = model.stack, result.dataset.attrs["heat_capacity_kN_mm_per_K"]
    capacity = np.array([float(part) for part in heat.strip("[]").split(",")])
    if published:  # 4 h/(a c rho) with the c rho of rubber, in every cell
        rate = HDR.materials.side_film * 1e-6 * 960.0 / HDR.area
        rates = np.full(len(capacity), rate / HDR.materials.rubber.volumetric_heat)
    else:
        rates = HDR.materials.side_film * 1e-6 * 960.0 * stack.thickness * stack.fold / capacity
    lost = result.energy.iloc[0]["heat_lost_sides_kN_mm"]
    assert_allclose(lost, 0.1 * float(capacity @ (rates * above)), rtol=tol.BASELINE)


def test_histories_are_the_same_however_many_steps_were_done() -> None:
    for counts in ((1, 2), (2, 1), (1, 1, 1)):
        steps = [
            {"step": "ramp", "to": f"{3 * n} mm", "duration": f"{0.1 * (n - m)} s"}
            for m, n in pairwise(np.cumsum([0, *counts]).tolist())
        ]
        test = tb.CyclicTest(dt=0.1, steps=steps)
        result = tb.run(HDR, test, 0.0)
        assert_allclose(result["displacement"].values[0], [0.0, 3.0, 6.0, 9.0], rtol=tol.RAMP)
        whole = tb.CyclicTest(dt=0.1, steps=[{"step": "ramp", "to": "9 mm", "duration": "0.3 s"}])
        expected = tb.run(HDR, whole, 0.0)["force"].values[0]
        assert_allclose(result["force"].values[0], expected, rtol=1e-9)


def test_bound_of_the_margin_is_on_the_safe_side() -> None:
    """What it lets pass has the tangent it promises, by the closed form; and it lets most pass."""
    random = np.random.default_rng(5)
    passed, healthy = 0, 0
    for _ in range(4000):
        d, step = random.uniform(-30.0, 30.0), random.normal(scale=0.05)
        ke, kh = 1.0, random.uniform(2.0, 30.0)
        d_y = RUBBER.yield_displacement
        z = random.uniform(-d_y, d_y)
        after, _ = exact_increment(z, step, d_y, 1.0 / d_y, RUBBER.unloading_curvature)
        s = d + step
        slope = 1.0 - (after / d_y) ** 2
        b = RUBBER.hardening
        tangent = ke + kh * ((1.0 + b * s * s) * slope + min(2.0 * b * s * after, 0.0))
        enough = s * after >= 0.0 or tangent >= RUBBER.sharing_start * ke
        layer = rows(Layer, 1)[0]
        layer.d, layer.z = d, z
        let = surely_stiff(RUBBER, ke, kh, layer, step)
        assert enough or not let
        passed, healthy = passed + let, healthy + enough
    assert healthy < 4000
    assert passed > 0.8 * healthy


ETA = EndFace(eta=2.0)
STEEL, RUBBER_MATERIAL = HDR.materials.steel, HDR.materials.rubber


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
    result = [row - stack.layers["first"] for row in stack.middles()]
    assert_allclose(result, [[upper] * 3, [lower] * 3])


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
    k_s, k_r = STEEL.conductivity / 1e3, RUBBER_MATERIAL.conductivity / 1e3
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
    loss = conservative_rates(stack, EndFace(eta=2.5), EndFace(film=20.0)).end_loss * capacity
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
    resistance = 1e3 * (2.5 / RUBBER_MATERIAL.conductivity + 25.0 / STEEL.conductivity)
    rubber, shims = 30.0 * RUBBER_MATERIAL.volumetric_heat, 16.0 * STEEL.volumetric_heat
    capacity = HDR.area * (rubber + shims)
    ends = 2.0 * HDR.area / resistance
    sides = HDR.materials.side_film * 1e-6 * 960.0 * 46.0
    rate = (ends + sides) / capacity
    wanted = 20.0 - 40.0 * rate * dt / (1.0 + 0.5 * rate * dt)
    assert_allclose(result["final_temperature"].values[0], [wanted], rtol=1e-12)
    response = result.energy.iloc[0]
    ratio = response["heat_lost_ends_kN_mm"] / response["heat_lost_sides_kN_mm"]
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
