"""Comparisons with closed forms, with solvers of other libraries, and with the own stepper."""

import math
from collections.abc import Callable, Mapping
from functools import cache

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.signal import lsim

import thermobearing as tb
from thermobearing.bearing.model import Bearing, Material, SquarePlan
from thermobearing.core.hysteresis import exact_increment, plane_increment
from thermobearing.core.march import march
from thermobearing.core.plane import march_plane
from thermobearing.core.records import Floats
from thermobearing.core.types import Constants, Path, new_state, new_workspace
from thermobearing.cyclic.history import build_segments, room_for
from thermobearing.model.constants import build_constants
from thermobearing.model.earlier import BilinearParameters, bilinear_constants
from thermobearing.model.options import ModelOptions, build_model
from thermobearing.model.stack import EndFace, build_stack
from thermobearing.motions.targets import standard_spectrum
from thermobearing.structure.model import load_structure
from thermobearing.structure.run import Line, prepare_structure, run_structure
from thermobearing.verify.comparison import Comparison
from thermobearing.verify.numpy_stepper import NumpyStepper

HDR, LHDR, BRIDGE = "shen-hdr-specimen", "shen-lhdr-specimen", "shen-hdr-bridge"
MOTION = "jra-ii-i-1"
SEED = 7
INCREMENTS = 40
TIGHT = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}
DT = 0.05  # of paths in a plane, and of cycles [s]
SHAPE = -0.864  # s of the HDR specimen
CURVATURE = (1.0 - SHAPE) / (1.0 + SHAPE)  # beta - gamma, of a yield displacement of 1


def hysteresis_on_a_line() -> Comparison:
    """Return the error of Z after increments from any Z, of the yield displacement."""
    random, largest = np.random.default_rng(SEED), 0.0
    beta = 1.0 / (1.0 + SHAPE)
    for _ in range(INCREMENTS):
        z, size = random.uniform(-1.0, 1.0), 10.0 ** random.uniform(-2.0, 1.0)
        direction = random.choice([-1.0, 1.0])

        def rate(_: float, y: Floats, sign: float = direction) -> Floats:
            return np.asarray(sign - beta * (np.abs(y) * y + SHAPE * sign * y**2))

        def crossing(_: float, y: Floats) -> float:
            return float(y[0])

        crossing.terminal = True  # type: ignore[attr-defined]
        # The rate has a kink where Z changes its sign, at which the solver begins again.
        at, start = 0.0, z
        if direction * z < 0.0:
            first = solve_ivp(rate, (0.0, size), [z], events=crossing, **TIGHT)
            at, start = (first.t[-1], 0.0) if first.status == 1 else (size, first.y[0, -1])
        end = solve_ivp(rate, (at, size), [start], **TIGHT).y[0, -1] if at < size else start
        closed, _ = exact_increment(z, direction * size, 1.0, 1.0, CURVATURE)
        largest = max(largest, abs(closed - float(end)))
    return Comparison(largest)


def _solid(material: Material, steel: Material, side_film: float, cells: int) -> Bearing:
    """Return one rubber layer of 20 mm between end plates of 20 mm, a square of 100 mm."""
    bearing = tb.load_bearing(HDR)
    parts = {
        "geometry": {
            "plan": SquarePlan(shape="square", side=100.0),
            "rubber_layers": 1,
            "rubber_thickness": 20.0,
            "end_plate_thickness": 20.0,
        },
        "materials": {"rubber": material, "steel": steel, "side_film": side_film},
        "cells": {"rubber": 2 * cells, "end_plate": cells, "shim": 1},
    }
    copies = {
        name: getattr(bearing, name).model_copy(update=update) for name, update in parts.items()
    }
    return bearing.model_copy(update=copies)


def _path(x: Floats, dt: float, ambient: float) -> Path:
    """Return a path through displacements x [mm] at an ambient temperature [degC]."""
    count = len(x)
    times, air = np.full(count, dt), np.full(count, ambient)
    return Path(np.ascontiguousarray(x), times, air, np.ones(count, dtype=bool), 0.0)


def _marched(constants: Constants, x: Floats, dt: float, start: Floats, ambient: float) -> Floats:
    """Return the cell temperatures [degC] after a march through displacements x [mm]."""
    count, path = len(x), _path(x, dt, ambient)
    state, spare = new_state(constants, start), new_state(constants, start)
    march(constants, new_workspace(constants), state, spare, path, room_for(constants, count, ()))
    return np.asarray(state.temperature)


B, H, CELLS = 10.0, 30.0, 32  # half the rubber and half the height [mm]; cells in B, and in H - B
FILM = 800.0  # at the end face [W/(m2 K)]
PER_METRE = 1e-3  # W/(m K) -> kN/(s K)
PER_AREA = 1e-6  # W/(m2 K) -> kN/(s mm K)
STEPS = 1000


def _decay(
    material: Material, steel: Material, face: EndFace, rate: float, profile: Callable[..., Floats]
) -> Comparison:
    """Return the error of a mode of conduction after 1/rate [s], of its peak."""
    bearing = _solid(material, steel, 0.0, CELLS)
    stack = build_stack(bearing, half=True)
    constants = build_constants(bearing, stack, upper=face, lower=None)
    shape = profile(H - stack.depth)
    ambient = -20.0
    still = np.zeros(STEPS)
    end = _marched(constants, still, 1.0 / rate / STEPS, ambient + shape, ambient)
    return Comparison(float(np.abs(end - ambient - math.exp(-1.0) * shape).max()))


def _diffusivity(material: Material) -> float:
    """Return the diffusivity [mm2/s]."""
    return material.conductivity * PER_METRE / material.volumetric_heat


def decaying_cosine() -> Comparison:
    """Return the error of cos(pi y/H) between insulated faces of steel."""
    steel = tb.load_bearing(HDR).materials.steel
    wave = math.pi / H
    rate = _diffusivity(steel) * wave**2
    return _decay(steel, steel, EndFace(eta=1.0), rate, lambda y: np.cos(wave * y))


def film_wave(material: Material, film: float) -> float:
    """Return the wave number [1/mm] of the slowest mode with a film [W/(m2 K)], at y = H.

    k w tan(w H) = film.
    """
    k, film_kn = material.conductivity * PER_METRE, film * PER_AREA

    def imbalance(wave: float) -> float:
        return k * wave * math.sin(wave * H) - film_kn * math.cos(wave * H)

    return float(brentq(imbalance, 0.0, 0.5 * math.pi / H, xtol=1e-16))


def composite_mode(rubber: Material, steel: Material) -> tuple[float, Callable[[Floats], Floats]]:
    """Return rate [1/s] and profile of the slowest mode of rubber and steel, zero at y = H.

    Rubber cos(p y), steel C sin(q (H - y)): equal temperature and flux at y = B.
    """

    def waves(rate: float) -> tuple[float, float]:
        return math.sqrt(rate / _diffusivity(rubber)), math.sqrt(rate / _diffusivity(steel))

    def flux_gap(rate: float) -> float:
        p, q = waves(rate)
        inside = rubber.conductivity * p * math.sin(p * B) * math.sin(q * (H - B))
        return inside - steel.conductivity * q * math.cos(q * (H - B)) * math.cos(p * B)

    slowest = _diffusivity(rubber) * (0.5 * math.pi / B) ** 2
    rate = float(brentq(flux_gap, 1e-6 * slowest, slowest, xtol=1e-18))
    p, q = waves(rate)
    factor = math.cos(p * B) / math.sin(q * (H - B))

    def profile(y: Floats) -> Floats:
        return np.where(y < B, np.cos(p * y), factor * np.sin(q * (H - y)))

    return rate, profile


def decaying_film_mode() -> Comparison:
    """Return the error of the slowest mode with a film."""
    steel = tb.load_bearing(HDR).materials.steel
    wave = film_wave(steel, FILM)
    rate = _diffusivity(steel) * wave**2
    return _decay(steel, steel, EndFace(film=FILM), rate, lambda y: np.cos(wave * y))


def decaying_composite_mode() -> Comparison:
    """Return the error of the slowest mode of rubber and steel with a face at the ambient."""
    materials = tb.load_bearing(HDR).materials
    mode = composite_mode(materials.rubber, materials.steel)
    return _decay(materials.rubber, materials.steel, EndFace(eta=3.0), *mode)


def adiabatic_heating() -> Comparison:
    """Return the error of the heat that an insulated bearing stores, of the work."""
    bearing = tb.load_bearing(HDR)
    materials = bearing.materials.model_copy(update={"side_film": 0.0})
    insulated = bearing.model_copy(update={"materials": materials})
    stack = build_stack(insulated, half=True)
    constants = build_constants(insulated, stack, upper=EndFace(eta=1.0), lower=None)
    x = 30.0 * np.sin(np.linspace(0.0, 8.0 * math.pi, 1601)[1:])
    start = np.full(len(constants.cells.capacity), 23.0)
    path = _path(x, DT, 23.0)
    state, spare = new_state(constants, start), new_state(constants, start)
    march(constants, new_workspace(constants), state, spare, path, room_for(constants, len(x), ()))
    # The records of the step give the heat; the cells themselves are the other heading.
    stored = (
        2.0
        * bearing.area
        * float((stack.thickness * stack.volumetric_heat * (state.temperature - start)).sum())
    )
    return Comparison(abs(stored / float(state.response[0].heat_released) - 1.0))


def stiffness_in_series() -> Comparison:
    """Return the error of the stiffness of a small displacement, relative."""
    bearing = tb.load_bearing(HDR)
    constants = build_model(bearing, ModelOptions()).constants
    h, ambient, small = bearing.hysteresis, -20.0, 1e-6
    start = np.full(len(constants.cells.capacity), ambient)
    state, spare = new_state(constants, start), new_state(constants, start)
    path = _path(np.array([small]), 1.0, ambient)
    march(constants, new_workspace(constants), state, spare, path, room_for(constants, 1, ()))
    warmer = (ambient - h.reference_temperature) / 100.0
    elastic = h.post_yield_ratio * math.exp(h.elastic_temperature_coefficient * warmer)
    hysteretic = (1.0 - h.post_yield_ratio) * math.exp(
        h.hysteretic_temperature_coefficient * warmer
    )
    closed = h.layer_stiffness * (elastic + hysteretic) / bearing.geometry.rubber_layers
    return Comparison(abs(float(state.response[0].force) / small / closed - 1.0))


@cache
def _both_steppers() -> tuple[float, float]:
    """Return the differences of force, of the peak, and of layer temperatures [K]."""
    bearing = tb.load_bearing(HDR)
    test = tb.cyclic_test(strain=[1.5], cycles=2, rest=None)
    result = tb.run(bearing, test, ambient=23.0, keep=("rubber",))
    other, rows = NumpyStepper(bearing, 23.0), []
    for segment in build_segments(test, bearing.total_rubber_thickness):
        for x, dt in zip(segment.x, segment.dt, strict=True):
            rows.append((other.step(float(x), float(dt), 23.0), other.layer_temperature))
    force, layers = (np.array(column) for column in zip(*rows, strict=True))
    apart = np.abs(result["force"].values[0, 1:] - force).max() / np.abs(force).max()
    return float(apart), float(np.abs(result["rubber_temperature"].values[0, 1:] - layers).max())


def stepper_force() -> Comparison:
    """Return the difference of the forces from the own stepper, of the peak."""
    return Comparison(_both_steppers()[0])


def stepper_temperature() -> Comparison:
    """Return the difference of the layer temperatures from the own stepper [K]."""
    return Comparison(_both_steppers()[1])


def _cyclic_balance(bearing: str) -> Comparison:
    energy = tb.run(bearing, ambient=[-20.0, 23.0]).energy
    residuals = energy[["mechanical_residual", "thermal_residual"]].abs()
    return Comparison(float(residuals.to_numpy().max()))


def energy_without_lead() -> Comparison:
    """Return what the energy balance of the HDR specimen lacks, of the work."""
    return _cyclic_balance(HDR)


def energy_with_lead() -> Comparison:
    """Return what the energy balance of the LHDR specimen lacks, of the work."""
    return _cyclic_balance(LHDR)


def energy_of_a_pier() -> Comparison:
    """Return what the energy balance of pier P1 lacks, of the input."""
    data = tb.bridge(BRIDGE, MOTION, -20.0).dataset
    parts = ("kinetic", "damping", "springs", "hinges", "bearings")
    spent = sum(float(data[f"energy_{name}"].squeeze()) for name in parts)
    return Comparison(abs(spent / float(data["energy_input"].squeeze()) - 1.0))


def _plane_forces(constants: Constants, x: Floats, ambient: float) -> tuple[Floats, Floats]:
    """Return forces [kN] and work [kN mm] on a path in a plane [steps, 2]."""
    count = len(x)
    start = np.full(len(constants.cells.capacity), ambient)
    state, spare = (new_state(constants, start, components=2) for _ in range(2))
    path = _path(x, DT, ambient)
    rows = room_for(constants, count, (), 2)
    march_plane(constants, new_workspace(constants, 2), state, spare, path, rows)
    return np.array(rows.response["force"]), np.array(rows.response["work_in"])


def straight_path_in_a_plane() -> Comparison:
    """Return the difference of forces on a straight path from those on a line, of the peak."""
    constants = build_model(tb.load_bearing(LHDR), ModelOptions()).constants
    x = 50.0 * np.sin(0.1 * np.arange(1, 200))
    angle = math.radians(40.0)
    across = np.array([math.cos(angle), math.sin(angle)])
    force, _ = _plane_forces(constants, x[:, None] * across, -20.0)
    start = np.full(len(constants.cells.capacity), -20.0)
    state, spare = new_state(constants, start), new_state(constants, start)
    room = room_for(constants, len(x), ())
    path = _path(x, DT, -20.0)
    march(constants, new_workspace(constants), state, spare, path, room)
    line = np.array(room.response["force"])
    return Comparison(float(np.abs(force @ across - line).max() / np.abs(line).max()))


def core_on_a_circle() -> Comparison:
    """Return the error of the work of a rigid-plastic core per turn, relative."""
    strength, radius, steps = 5.0, 40.0, 2000
    constants = bilinear_constants(BilinearParameters(strength, 1e-3, 1e7))
    out = np.linspace(0.0, radius, steps // 4 + 1)[1:, None] * [1.0, 0.0]
    angle = 2.0 * math.pi * np.arange(1, 3 * steps + 1) / steps
    x = np.vstack([out, radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)])
    _, work = _plane_forces(constants, x, 20.0)
    turn = float(work[-1] - work[-1 - steps])
    return Comparison(abs(turn / (2.0 * math.pi * radius * strength) - 1.0))


def hysteresis_in_a_plane() -> Comparison:
    """Return the error of Z in a plane after increments from any Z, of the yield displacement."""
    random, largest = np.random.default_rng(SEED), 0.0
    beta, gamma = 1.0 / (1.0 + SHAPE), SHAPE / (1.0 + SHAPE)
    for _ in range(INCREMENTS):
        radius, turn = 0.9 * math.sqrt(random.uniform()), random.uniform(0.0, 2.0 * math.pi)
        z = radius * np.array([math.cos(turn), math.sin(turn)])
        turn, size = random.uniform(0.0, 2.0 * math.pi), 10.0 ** random.uniform(-2.0, 0.5)
        heading = np.array([math.cos(turn), math.sin(turn)])

        def rate(_: float, y: Floats, heading: Floats = heading) -> Floats:
            along = float(y @ heading)
            return np.asarray(heading - (beta * abs(along) + gamma * along) * y)

        def crossing(_: float, y: Floats, heading: Floats = heading) -> float:
            return float(y @ heading)

        crossing.terminal, crossing.direction = True, 1.0  # type: ignore[attr-defined]
        first = solve_ivp(rate, (0.0, size), z, events=crossing, **TIGHT)
        end = first.y[:, -1]
        if first.status == 1:
            # From the kink on the product is positive.
            start = end + 1e-15 * heading
            end = solve_ivp(rate, (first.t[-1], size), start, **TIGHT).y[:, -1]
        closed, _ = plane_increment(tuple(z), tuple(size * heading), 1.0, CURVATURE)
        largest = max(largest, float(np.abs(np.asarray(closed).ravel()[:2] - end).max()))
    return Comparison(largest)


def _spring(stiffness: float) -> Constants:
    """Return a bearing that never yields, of a stiffness [kN/mm]."""
    return bilinear_constants(BilinearParameters(1e9, 0.5 * stiffness, stiffness))


def periods_of_two_masses() -> Comparison:
    """Return the error of the periods of the pier of the hybrid test, relative."""
    structure = load_structure("hybrid-pier")
    deck, pier = (item.mass for item in structure.masses)
    line, spring = structure.bearings[0], structure.springs[0]
    assert spring.stiffness is not None
    upper, lower = line.count * line.equivalent_stiffness, spring.stiffness
    total = (upper + lower) / pier + upper / deck
    root = math.sqrt(total**2 - 4.0 * upper * lower / (deck * pier))
    closed = 2.0 * math.pi / np.sqrt(0.5 * np.array([total - root, total + root]))
    return Comparison(
        float(np.abs(prepare_structure(structure).modes.periods / closed - 1.0).max())
    )


def _ground(dt: float, duration: float) -> Floats:
    """Return a built-in motion from zero, at steps of dt [s], in mm/s2."""
    motion = tb.load_motion(MOTION)
    ground = np.interp(dt * np.arange(round(duration / dt) + 1), motion.time, motion.acceleration)
    ground[0] = 0.0
    return np.asarray(ground)


def linear_pier() -> Comparison:
    """Return the error of a linear structure in a motion, of its largest displacement."""
    dt, structure = 0.0025, load_structure("hybrid-pier")
    ground, prepared = _ground(dt, 20.0), prepare_structure(structure)
    bearing = structure.bearings[0]
    constants = _spring(bearing.equivalent_stiffness * bearing.scale)
    line = Line(constants, np.full(len(constants.cells.capacity), 20.0))
    air = np.full(len(ground) - 1, 20.0)
    history = run_structure(prepared, [line], ground, dt, air)
    matrices = prepared.matrices
    count = len(matrices.load)
    inverse = np.linalg.inv(matrices.mass)
    zero, unit = np.zeros((count, count)), np.eye(count)
    system = np.block([[zero, unit], [-inverse @ prepared.predictor, -inverse @ prepared.damping]])
    push = (inverse @ matrices.load).reshape(count, -1)
    times = dt * np.arange(len(ground))
    matrix = (system, np.concatenate([np.zeros_like(push), push]), np.hstack([unit, zero]))
    _, exact, _ = lsim((*matrix, np.zeros_like(push)), ground, times)
    return Comparison(float(np.abs(history.rows.q - exact).max() / np.abs(exact).max()))


def response_spectrum() -> Comparison:
    """Return the largest error of displacements of oscillators, relative."""
    dt, damping, periods = 0.01, 0.05, np.geomspace(0.3, 4.0, 12)
    ground = _ground(dt, 30.0)
    motion = tb.GroundMotion("verified", dt, ground)
    spectrum = tb.response_spectrum(motion, periods, damping, steps_per_period=1)
    times, exact = dt * np.arange(len(ground)), []
    for period in periods:
        w = 2.0 * math.pi / period
        system = (
            [[0.0, 1.0], [-(w**2), -2.0 * damping * w]],
            [[0.0], [-1.0]],
            [[1.0, 0.0]],
            [[0.0]],
        )
        exact.append(np.abs(lsim(system, ground, times)[1]).max())
    return Comparison(float(np.abs(spectrum.displacement / np.array(exact) - 1.0).max()))


def standard_motions() -> Comparison:
    """Return the rms difference of a built-in motion from its standard spectrum, relative."""
    periods = np.geomspace(0.1, 3.0, 200)
    spectrum = tb.response_spectrum(tb.load_motion(MOTION), periods)
    error = spectrum.acceleration / standard_spectrum("ii", "i", periods) - 1.0
    return Comparison(float(np.sqrt(np.mean(error**2))))


def bridge_stiffness() -> Comparison:
    """Return the error of the stiffness of the bridge bearing that stays at 23 degC, relative."""
    bearing = tb.load_bearing(BRIDGE)
    rubber = bearing.materials.rubber.model_copy(update={"specific_heat": 1e15})
    materials = bearing.materials.model_copy(update={"rubber": rubber})
    still = bearing.model_copy(update={"materials": materials})
    strain = 178.0 / bearing.total_rubber_thickness
    test = tb.cyclic_test(strain=[strain], cycles=2, speed=200)
    cycles = tb.run(still, test, ambient=23.0).cycles
    modulus = float(cycles["G_eq_MPa"][1])
    stiffness = modulus * bearing.area / bearing.total_rubber_thickness / 1e3
    return Comparison(abs(stiffness / 2.633 - 1.0))


CHECKS: Mapping[str, Callable[[], Comparison]] = {
    function.__name__: function
    for function in (
        hysteresis_on_a_line,
        hysteresis_in_a_plane,
        stiffness_in_series,
        stepper_force,
        stepper_temperature,
        adiabatic_heating,
        decaying_cosine,
        decaying_film_mode,
        decaying_composite_mode,
        energy_without_lead,
        energy_with_lead,
        energy_of_a_pier,
        straight_path_in_a_plane,
        core_on_a_circle,
        periods_of_two_masses,
        linear_pier,
        response_spectrum,
        standard_motions,
        bridge_stiffness,
    )
}
