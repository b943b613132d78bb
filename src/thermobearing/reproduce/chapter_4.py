"""What chapter 4 says of the model of HDR bearings: a function for each claim."""

from typing import Any

import numpy as np

from thermobearing.core.types import Floats
from thermobearing.cyclic.result import Result
from thermobearing.model.element import BearingElement
from thermobearing.model.options import EndFace, build_model
from thermobearing.reproduce.runs import Runs, full_cycles
from thermobearing.reproduce.values import (
    ACCELERATION,
    FORCE,
    HDR,
    PIER,
    all_cycles,
    histories,
    last_loading,
    loadings,
    of_cycle,
)

LARGEST = 2.5  # amplitude of the last loading
COOLING = 60.0  # after a loading [s]
MOMENTS = (5.0, 10.0, 15.0, 20.0)  # of Fig. 4.14 [s]
STRONG = (5.0, 10.0)  # when the specimen moves most, 4.4.2.2 [s]
SINGLE = "single-temperature"
ETAS = (1.0, 2.0, 3.0)  # of Eq. 4.15: adiabatic, middle, ambient temperature


def cells(runs: Runs) -> float:
    """Number of cells of the symmetric half."""
    return float(len(build_model(runs.bearing(HDR)).constants.cells.capacity))


def half_height(runs: Runs) -> float:
    """From the outer face to the symmetry plane [mm]."""
    return float(runs.cyclic(HDR, 23.0)["cell_thickness"].values.sum())


def cell_thicknesses(runs: Runs) -> Floats:
    """Of end plate, rubber, shim and half shim [mm]."""
    result = runs.cyclic(HDR, 23.0)
    parts, sizes = result["part"].values, result["cell_thickness"].values
    first = [sizes[np.flatnonzero(parts == name)[0]] for name in ("end_plate", "rubber", "shim")]
    return np.array([*first, sizes[-1]])


def heat_through_the_face(runs: Runs) -> Floats:
    """Heat lost through the ends with eta_B = 1, 2, 3 of Eq. 4.15, two cycles of 250 % [kN mm]."""
    test = full_cycles([LARGEST], 2)
    found = []
    for eta in ETAS:
        result = runs.cyclic(
            HDR, -20.0, test, upper_face=EndFace(eta=eta), lower_face=EndFace(eta=eta)
        )
        found.append(float(result["heat_lost_ends"].values[0][-1]))
    return np.array(found)


def layers_share_one_force(runs: Runs) -> Floats:
    """Largest difference between layer forces over the largest force."""
    result = runs.cyclic(HDR)
    force = np.nanmax(np.abs(result["force"].values), axis=1)
    return np.asarray(result["layer_force_mismatch_max"].values / force)


def layer_stiffness(runs: Runs) -> float:
    """Six times the stiffness of the bearing at rest at 23 degC [kN/mm]."""
    bearing = runs.bearing(HDR)
    element = BearingElement(bearing, bearing.hysteresis.reference_temperature)
    return float(element.set_trial(1e-9, dt=1e6).tangent * bearing.geometry.rubber_layers)


def layers_shear_unequally(runs: Runs) -> Floats:
    """Displacement of inner, middle, outer layer at the last peak of 250 % at -20 degC [mm]."""
    result = runs.cyclic(HDR, -20.0, full_cycles([LARGEST]), keep=["rubber", "layer_displacement"])
    moved = result["displacement"].values[0]
    peak = np.flatnonzero(moved >= 0.999 * moved.max())[-1]
    return np.asarray(result["layer_displacement"].values[0][peak][::-1], dtype=float)


def stiffness_with_cycles(runs: Runs) -> Floats:
    """G_e from the second to the fifth cycle, a row per strain and temperature [MPa]."""
    return all_cycles(runs, HDR, "G_eq_MPa")[:, 1:]


def degradation_in_the_cold(runs: Runs) -> Floats:
    """G_e of the fifth over the first cycle of 250 %, warm to cold."""
    last, first = (of_cycle(runs, HDR, "G_eq_MPa", n)[-1] for n in (5, 1))
    return np.asarray(last / first)


def strain_changes_modulus(runs: Runs) -> Floats:
    """G_e of 50 % over that of 250 %, fifth cycle, warm to cold."""
    found = of_cycle(runs, HDR, "G_eq_MPa", 5)
    return np.asarray(found[0] / found[-1])


def _layers_at_end(result: Result, run: int) -> Floats:
    """Rise of the layers 1, 2, 3 at the end of the last loading [K]."""
    layers = result["rubber_temperature"].values[run][last_loading(result, run)]
    return np.asarray(layers - result["ambient"].values[run], dtype=float)


def layers_by_warmth(runs: Runs) -> Floats:
    """Rise of the layers 3, 2, 1 at the end of 250 %, a row per temperature [K]."""
    result = runs.cyclic(HDR)
    return np.array([_layers_at_end(result, run)[::-1] for run in range(3)])


def third_only_slightly_above_second(runs: Runs) -> Floats:
    """Lead of layer 3 over 2, over that of layer 2 over 1, end of 250 %."""
    rises = layers_by_warmth(runs)
    return np.asarray((rises[:, 0] - rises[:, 1]) / (rises[:, 1] - rises[:, 2]))


def outer_layer_cools_first(runs: Runs) -> Floats:
    """Share of the rise that layers 1, 2, 3 lose in a minute after 200 %, a row a temperature."""
    result = runs.cyclic(HDR)
    found = []
    for run, air in enumerate(result["ambient"].values):
        end, time = loadings(result, run)[-2][1], result.time(run)
        layers = result["rubber_temperature"].values[run]
        later = [np.interp(time[end] + COOLING, time, layer) for layer in layers.T]
        found.append(1.0 - (np.array(later) - air) / (layers[end] - air))
    return np.array(found)


def rise_in_the_cold(runs: Runs) -> Floats:
    """Rise of the third layer at the end of each loading, a row per strain [K]."""
    result = runs.cyclic(HDR)
    inner = result["rubber_temperature"].values[:, :, 2]
    ends = [[inner[k][last] for _, last in loadings(result, k)] for k in range(3)]
    return np.asarray((np.array(ends) - result["ambient"].values[:, None]).T)


def _teeth(profile: Floats, parts: Floats) -> float:
    """The least that a rubber layer is warmer than a shim beside it [K]."""
    shims = np.flatnonzero(parts == "shim")
    beside = [
        profile[k + side] - profile[k] for k in shims for side in (-1, 1) if k + side < len(profile)
    ]
    return float(min(beside))


def rubber_above_steel(runs: Runs) -> Floats:
    """Least that rubber is warmer than the shim beside it, end of each loading [K]."""
    result = runs.cyclic(HDR, keep=["rubber", "cells"])
    parts = result["part"].values
    return np.array(
        [
            [
                _teeth(result["temperature"].values[k][last], parts)
                for _, last in loadings(result, k)
            ]
            for k in range(3)
        ]
    )


def _real_time(runs: Runs, column: str) -> Floats:
    """Of the real-time tests of the HDR specimen, warm to cold."""
    return np.asarray(runs.hybrid(HDR).table[column], dtype=float)


def loop_modulus_in_the_cold(runs: Runs) -> Floats:
    """G_e of the largest loop in real time, warm to cold [MPa]."""
    return _real_time(runs, "loop_G_e_MPa")


def loop_damping_in_the_cold(runs: Runs) -> Floats:
    """h_eq of the largest loop in real time, warm to cold."""
    return _real_time(runs, "loop_h_eq")


def force_in_the_cold(runs: Runs) -> Floats:
    """Largest force in real time, warm to cold [kN]."""
    return _real_time(runs, FORCE)


def stiffness_at_rest_in_the_cold(runs: Runs) -> Floats:
    """Of the specimen, warm to cold [kN/mm]."""
    bearing = runs.bearing(HDR)
    airs = (23.0, 0.0, -20.0)
    return np.array([BearingElement(bearing, air).set_trial(1e-9, dt=1e6).tangent for air in airs])


def _inner_rises(runs: Runs, **options: Any) -> Floats:
    """Largest rise of the inner layer in real time, warm to cold [K]."""
    result = runs.hybrid(HDR, **options)
    found = []
    for run in range(result.runs):
        _, layers = histories(result, run, "rubber_temperature")
        found.append(float((layers[:, -1] - layers[0, -1]).max()))
    return np.array(found)


def single_temperature_is_colder(runs: Runs) -> Floats:
    """Rise of the single temperature less that of the inner layer, real time [K]."""
    return _inner_rises(runs, model=SINGLE) - _inner_rises(runs)


def single_temperature_is_colder_cyclic(runs: Runs) -> Floats:
    """The same at the end of five cycles of 250 % [K]."""
    test = full_cycles([LARGEST])
    rises = []
    for model in (SINGLE, "multi-layer"):
        result = runs.cyclic(HDR, test=test, model=model)
        inner = result["rubber_temperature"].values[:, :, -1]
        ends = [inner[k][last_loading(result, k)] for k in range(3)]
        rises.append(np.array(ends) - result["ambient"].values)
    return np.asarray(rises[0] - rises[1])


def hybrid_rise_in_the_cold(runs: Runs) -> Floats:
    """Largest rise of the inner layer in real time, warm to cold [K]."""
    return _inner_rises(runs)


def rise_while_strong(runs: Runs) -> Floats:
    """Share of the inner layer's largest rise that it gains from 5 to 10 s, warm to cold."""
    result = runs.hybrid(HDR)
    found = []
    for run in range(result.runs):
        time, layers = histories(result, run, "rubber_temperature")
        inner = layers[:, -1] - layers[0, -1]
        early, late = np.interp(STRONG, time, inner)
        found.append((late - early) / inner.max())
    return np.array(found)


def teeth_become_smaller(runs: Runs) -> Floats:
    """Mean lead of rubber over the shims beside it at 10, 15, 20 s, a row a temperature [K]."""
    result = runs.hybrid(HDR, keep=["rubber", "cells"])
    found = []
    for run in range(result.runs):
        time, profile = histories(result, run, "temperature")
        inside = result["part"].values[run]
        shims = np.flatnonzero(inside == "shim")
        gap = np.mean([profile[:, k - 1] - profile[:, k] for k in shims], axis=0)
        found.append(np.interp(MOMENTS[1:], time, gap))
    return np.array(found)


def pier_in_the_cold(runs: Runs) -> Floats:
    """Displacement of the pier, real time, warm to cold [mm]."""
    return _real_time(runs, PIER)


def acceleration_in_the_cold(runs: Runs) -> Floats:
    """Acceleration of the pier top, real time, warm to cold [m/s2]."""
    return _real_time(runs, ACCELERATION)
