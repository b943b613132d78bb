"""Numbers out of simulations: the words of the expressions of claims and tables.

An expression in `data/*.toml` is Python over the names of `words`: bearings, constants and the
public functions here, in `misprints` and in `records`, each called without its first argument,
the simulations.
Values at several ambient temperatures stand from warm to cold: 23, 0, -20 degC; those of the bridge
have a row for each of the motions I-I-1, I-I-2, II-I-1, II-I-2.
"""

import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from inspect import isfunction
from types import ModuleType
from typing import Any

import numpy as np

from reproduction import misprints, records
from reproduction.runs import (
    AMBIENT,
    BILINEAR,
    BRIDGES,
    HDR,
    HDR_BRIDGE,
    HYBRID_PIER,
    LHDR,
    LHDR_BRIDGE,
    MODES,
    MOTIONS,
    PIER,
    SPECIMENS,
    TWO,
    Runs,
    full_cycles,
)
from thermobearing.bearing.bilinear import load_bilinear
from thermobearing.bearing.model import Bearing
from thermobearing.core.lead import half_space_factor
from thermobearing.core.records import Floats
from thermobearing.cyclic.case import Keep, load_rig
from thermobearing.cyclic.equivalent import DESIGN_STRAIN, isothermal_cycle, solve_backbone
from thermobearing.cyclic.protocol import Cycles, CyclicTest, cyclic_test
from thermobearing.cyclic.result import Result
from thermobearing.design.factors import scaled_bearing
from thermobearing.design.sizing import damping_ratio, load_rubber, shear_modulus
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.model.element import BearingElement
from thermobearing.model.options import ModelOptions
from thermobearing.model.stack import EndFace, Stack, build_stack
from thermobearing.motions.record import STANDARD_GRAVITY
from thermobearing.results.metrics import CycleMeasures
from thermobearing.structure.model import Structure
from thermobearing.structure.run import prepare_structure

FORCE = "bearing_force_max_kN"
COLDEST = -20.0
COOLING = 60.0  # after a loading [s]
PLUNGE = (0.0, 10.0, 60.0)  # of a rest, 4.4.1.2 [s]
SHORTEST = 1e-9  # time step where the displacement stays [s]
SLOW = 10.0  # of the pseudo-dynamic test, 3.4.2 [mm/s]
SMALLEST = 0.5  # strain of the half cycles that count: the smallest amplitude of Table 3.4
STRONG = (5.0, 10.0)  # when the specimen moves most, 4.4.2.2 [s]
FADING = (10.0, 15.0, 20.0)  # of Fig. 4.14 [s]
PROFILE_AT = 20.0  # last of the profiles of Fig. 5.17 [s]
FIRST_SECONDS = 2.0  # "the beginning" of Fig. 5.15
THINNED = Keep(every=100)  # peaks and loops come from all steps; many analyses are kept
SIX_TIMES = 6.0  # the prototype over the specimen, Table 3.6


# Bearings, structures and sections: no simulation.


def stack(runs: Runs, bearing: str) -> Stack:
    """Return the cells of the symmetric half of a bearing."""
    return build_stack(runs.bearing(bearing), half=True)


def period(runs: Runs, structure: str, mass: Any = "consistent") -> float:
    """Return the first period of a structure [s]."""
    return float(prepare_structure(runs.structure(structure), mass).modes.periods[0])


def compute_deck_stress(structure: Structure, area: float, count: float | None = None) -> float:
    """Return the stress of the deck on bearings of an area [MPa]; as many as the line has."""
    line = structure.bearings[0]
    mass = next(item.mass for item in structure.masses if item.body == line.body)
    return 1e3 * mass * STANDARD_GRAVITY / ((count or line.count) * area)


def deck_stress(runs: Runs, structure: str, area: float, count: float | None = None) -> float:
    """Return the stress of the deck on bearings of an area [MPa]; as many as the line has."""
    return compute_deck_stress(runs.structure(structure), area, count)


def at_rest(runs: Runs, bearing: str, ambient: Sequence[float] = AMBIENT) -> Floats:
    """Return the stiffness of a bearing at rest [kN/mm]."""
    elements = [BearingElement(runs.bearing(bearing), air) for air in ambient]
    return np.array([element.set_trial(1e-9, dt=1e6).tangent for element in elements])


def with_law(runs: Runs, bearing: str, **law: float) -> Bearing:
    """Return a bearing with other numbers of its rubber's hysteresis."""
    original = runs.bearing(bearing)
    return original.model_copy(update={"hysteresis": original.hysteresis.model_copy(update=law)})


def _as_bearing(runs: Runs, bearing: str | Bearing) -> Bearing:
    return runs.bearing(bearing) if isinstance(bearing, str) else bearing


def loops(runs: Runs, bearing: str | Bearing) -> list[CycleMeasures]:
    """Return the third cycle of 175 % without heating, at each temperature."""
    device = _as_bearing(runs, bearing)
    return [isothermal_cycle(device, DESIGN_STRAIN, temperature=ambient) for ambient in AMBIENT]


def design_loop(runs: Runs, bearing: str | Bearing) -> CycleMeasures:
    """Return the cycle of the design displacement without heating, 23 degC."""
    device = _as_bearing(runs, bearing)
    return isothermal_cycle(device, runs.number("u_B") / device.total_rubber_thickness)


def bilinear_of_g8(runs: Runs) -> tuple[float, ...]:
    """Return Q_d [kN], K_1, K_2 [kN/mm] of Fig. 6.3 from K_B, h_B and K_2/K_1 of Table 6.3."""
    end, thickness = runs.number("u_B"), runs.number("t_e")
    rubber, strain = load_rubber("G8"), end / thickness
    stiffness = shear_modulus(rubber, strain) * runs.number("A_e") / thickness / 1e3
    ratio = runs.number("K_2") / runs.number("K_1")
    backbone = solve_backbone(stiffness, damping_ratio(rubber, strain), end, ratio)
    return (backbone.strength, backbone.initial, backbone.post_yield) if backbone else (np.nan,) * 3


# The cyclic test of Table 3.4.


def loading(runs: Runs, bearing: str) -> Floats:
    """Return amplitudes [mm], periods [s] and counts of the cycles of Table 3.4, a row each."""
    thickness = runs.bearing(bearing).total_rubber_thickness
    steps = [step for step in cyclic_test().steps if isinstance(step, Cycles)]
    rows = [(step.size(thickness), 4.0 * step.quarters(thickness)[0], step.count) for step in steps]
    return np.array(rows, dtype=float).T


def cycles(runs: Runs, bearing: str, column: str, cycle: int) -> Floats:
    """Return a measure of one cycle of Table 3.4, a row for each amplitude."""
    table = runs.once(lambda: runs.cyclic(bearing).cycles, "cycles", bearing)
    rows = table[table["cycle"] == cycle]
    by_amplitude = rows.pivot(index="amplitude_strain", columns="ambient_degC", values=column)
    return np.asarray(by_amplitude[list(AMBIENT)], dtype=float)


def all_cycles(runs: Runs, bearing: str, column: str) -> Floats:
    """Return a measure of the cycles 1 to 5, a row for each amplitude and temperature."""
    return np.stack([cycles(runs, bearing, column, n).ravel() for n in range(1, 6)], axis=1)


def _temperature(result: Result, place: str, run: int) -> Floats:
    """Return the history of the "lead" or of a layer ("rubber1" is the outer one) [degC]."""
    if place == "lead":
        return np.asarray(result["lead_temperature"].values[run], dtype=float)
    layer = int(place.removeprefix("rubber")) - 1
    return np.asarray(result["rubber_temperature"].values[run, :, layer], dtype=float)


def _at(moments: float | Sequence[float] | Floats, time: Floats, values: Floats) -> Floats:
    return np.asarray(np.interp(moments, time, values), dtype=float)


def _loadings(result: Result, run: int) -> list[tuple[int, int]]:
    """Return the first and last sample of the five cycles of every amplitude."""
    inside = result["cycle"].values[run] > 0
    segment = result["segment"].values[run]
    parts = [np.flatnonzero(inside & (segment == part)) for part in np.unique(segment[inside])]
    return [(int(part[0]), int(part[-1])) for part in parts]


def rises(runs: Runs, bearing: str, place: str) -> Floats:
    """Return the largest rise of a layer ("rubber1") or "lead", a row for each amplitude [K]."""
    result, largest_rises = runs.cyclic(bearing), []
    for run, air in enumerate(result["ambient"].values):
        values = _temperature(result, place, run)
        largest_rises.append([values[a : b + 1].max() - air for a, b in _loadings(result, run)])
    return np.array(largest_rises).T


def rises_at_ends(runs: Runs, bearing: str, **options: Any) -> Floats:
    """Return the rise at the end of each loading: loading, temperature, layer from outside [K]."""
    result, end_rises = runs.cyclic(bearing, **options), []
    for run, air in enumerate(result["ambient"].values):
        layers = result["rubber_temperature"].values[run]
        end_rises.append([layers[last] - air for _, last in _loadings(result, run)])
    return np.swapaxes(np.array(end_rises, dtype=float), 0, 1)


def loading_speeds(runs: Runs, bearing: str) -> Floats:
    """Return the largest speed of each loading at 23 degC [mm/s]."""
    result = runs.cyclic(bearing, 23.0)
    time, moved = result.time(0), result["displacement"].values[0]
    parts = [slice(first, last + 1) for first, last in _loadings(result, 0)]
    return np.array([np.abs(np.diff(moved[p]) / np.diff(time[p])).max() for p in parts])


def left_after_rests(runs: Runs) -> float:
    """Return how far a rubber layer is from the air at most after a rest of 1.25 h [K]."""
    differences = []
    for result in map(runs.cyclic, SPECIMENS):
        for run, air in enumerate(result["ambient"].values):
            starts = [first for first, _ in _loadings(result, run)[1:]]
            differences.append(np.abs(result["rubber_temperature"].values[run][starts] - air).max())
    return float(max(differences))


def _after(result: Result, run: int, place: str, moments: Sequence[float]) -> Floats:
    """Return temperatures some time after the loading of 200 %; the last has no rest after it."""
    end, time = _loadings(result, run)[-2][1], result.time(run)
    return _at(time[end] + np.array(moments), time, _temperature(result, place, run))


def fall(runs: Runs, bearing: str, place: str) -> Floats:
    """Return the fall in the first minute after the loading of 200 % [K]."""
    result = runs.cyclic(bearing)
    ends = [_after(result, run, place, (0.0, COOLING)) for run in range(len(AMBIENT))]
    return -np.diff(ends, axis=1)[:, 0]


def first_plunge(runs: Runs) -> Floats:
    """Return the rate of fall in the first 10 s of a rest over that after, layers 1 and 3, HDR."""
    result, ratios = runs.cyclic(HDR), []
    for run in range(len(AMBIENT)):
        for place in ("rubber1", "rubber3"):
            rates = np.diff(_after(result, run, place, PLUNGE)) / np.diff(PLUNGE)
            ratios.append(rates[0] / rates[1])
    return np.array(ratios)


def share_lost(runs: Runs) -> Floats:
    """Return the share of the rise that layers 1, 2, 3 lose in a minute after 200 %, HDR."""
    result, shares = runs.cyclic(HDR), []
    for run, air in enumerate(AMBIENT):
        layers = ("rubber1", "rubber2", "rubber3")
        rise = np.array([_after(result, run, name, (0.0, COOLING)) for name in layers]) - air
        shares.append(1.0 - rise[:, 1] / rise[:, 0])
    return np.array(shares)


def layer_displacements(runs: Runs) -> Floats:
    """Return the displacement of layers 3, 2, 1 at the last peak of 250 % at -20 degC, HDR [mm]."""
    kept = ["rubber", "layer_displacement"]
    result = runs.cyclic(HDR, COLDEST, full_cycles([2.5]), keep=kept)
    moved = result["displacement"].values[0]
    peak = np.flatnonzero(moved >= 0.999 * moved.max())[-1]
    return np.asarray(result["layer_displacement"].values[0][peak][::-1], dtype=float)


def rubber_above_steel(runs: Runs) -> Floats:
    """Return how much rubber is warmer than the shim next to it at least, end of loadings [K]."""
    result = runs.cyclic(HDR, keep=["rubber", "cells"])
    shims = np.flatnonzero(result["part"].values == "shim")
    count = len(result["part"].values)
    pairs = [(k + side, k) for k in shims for side in (-1, 1) if k + side < count]
    rubber, steel = np.array(pairs).T
    smallest = []
    for run in range(len(AMBIENT)):
        ends = [last for _, last in _loadings(result, run)]
        cells = result["temperature"].values[run][ends]
        smallest.append((cells[:, rubber] - cells[:, steel]).min(axis=1))
    return np.array(smallest)


# Five cycles of 250 % and a rest, LHDR (5.4.1).


def largest_test(runs: Runs, rest: float = 4500.0) -> Result:
    """Return five sines of 250 % at 30 mm/s and a rest [s], LHDR."""
    step = {"step": "cycles", "strain": 2.5, "wave": "sine", "speed": 30.0, "count": 5}
    test = CyclicTest(steps=[step, {"step": "rest", "duration": rest}])
    return runs.cyclic(LHDR, AMBIENT, test, keep=["rubber"])


def largest_cycles(runs: Runs, column: str) -> Floats:
    """Return a measure of the five cycles of 250 %, a row for each temperature, LHDR."""
    table = largest_test(runs).cycles
    return np.array(
        [table[table["ambient_degC"] == ambient][column] for ambient in AMBIENT], dtype=float
    )


def half_lives(runs: Runs) -> Floats:
    """Return after how long half of the rise is gone, third layer and lead, a row each [s]."""
    result, times = largest_test(runs), []
    for run, air in enumerate(AMBIENT):
        segment = result["segment"].values[run]
        samples = np.flatnonzero(segment == segment.max())
        clock = result.time(run)[samples] - result.time(run)[samples[0]]
        parts = [_temperature(result, name, run)[samples] - air for name in ("rubber3", "lead")]
        times.append([clock[np.argmax(part < 0.5 * part[0])] for part in parts])
    return np.array(times)


def lead_rises_by_scheme(runs: Runs) -> Floats:
    """Return the rise of the lead by default over that of the printed scheme, 0 and -20 degC."""
    test = full_cycles([2.5], wave="sine", closing_strain=None)
    ends = []
    for scheme in ("conservative", "published"):
        table = runs.cyclic(
            LHDR, AMBIENT[1:], test, model=ModelOptions(scheme=scheme), keep=["rubber"]
        ).cycles
        lead = table[table["cycle"] == 5].set_index("ambient_degC")["lead_degC"]
        ends.append([lead[ambient] - ambient for ambient in AMBIENT[1:]])
    return np.asarray(np.divide(ends[0], ends[1]), dtype=float)


def lead_in_rest(runs: Runs) -> Floats:
    """Return the rise of the lead at the end of 250 %, then 60 s and 600 s later [K]."""
    result, lead_rises = largest_test(runs, 900.0), []
    for run, air in enumerate(AMBIENT):
        time, lead = result.time(run), _temperature(result, "lead", run) - air
        end = float(time[int(np.argmax(lead))])
        lead_rises.append(_at([end, end + 60.0, end + 600.0], time, lead))
    return np.array(lead_rises)


def rise_by_size(runs: Runs) -> float:
    """Return the rise of the third layer, specimen over one six times as large (7.2)."""
    ends = []
    for factor in (1.0, SIX_TIMES):
        specimen = scaled_bearing(runs.bearing(HDR), factor)
        step = {"step": "cycles", "strain": 2.5, "period": 10.0, "count": 5}
        test = CyclicTest(steps=[step, {"step": "rest", "duration": 120.0}])
        result = runs.cyclic(specimen, COLDEST, test)
        ends.append(float(result["rubber_temperature"].values[0, -1, -1]) - COLDEST)
    return ends[0] / ends[1]


# Any result.


def largest(_runs: Runs, result: Result | EarthquakeResult, name: str) -> Floats:
    """Return the largest magnitude of a history in each run."""
    values = np.abs(np.asarray(result[name].values, dtype=float))
    return np.asarray(np.nanmax(values, axis=1), dtype=float)


def column(_runs: Runs, result: EarthquakeResult, name: str) -> Floats:
    """Return a column of the table of a study."""
    return result.table[name].to_numpy(dtype=float)


def _history(result: EarthquakeResult, run: int, name: str) -> tuple[Floats, Floats]:
    """Return time and a history of one run, without what comes after its end."""
    time = np.asarray(result["time"].values[run], dtype=float)
    recorded = np.isfinite(time)
    return time[recorded], np.asarray(result[name].values[run], dtype=float)[recorded]


# The hybrid tests.


def both(runs: Runs) -> EarthquakeResult:
    """Return the hybrid tests of both specimens in real time and pseudo-dynamically: 12 runs."""
    return runs.hybrid(SPECIMENS, mode=MODES)


def _bearing_rows(runs: Runs, name: str, bearing: str) -> Any:
    table = runs.once(lambda: getattr(both(runs), name), name, "of both")
    return table[table["bearing"] == bearing].sort_values("ambient_degC", ascending=False)


def tested(runs: Runs, bearing: str, mode: str, column: str) -> Floats:
    """Return a column of the table of the hybrid tests."""
    rows = _bearing_rows(runs, "table", bearing)
    return np.asarray(rows[rows["mode"] == mode][column], dtype=float)


def all_tested(runs: Runs, column: str) -> Floats:
    """Return a column of the table of the hybrid tests, a row for each specimen and mode."""
    return np.array([tested(runs, b, m, column) for b in SPECIMENS for m in MODES])


def by_mode(runs: Runs, bearing: str, column: str) -> Floats:
    """Return a number of the hybrid tests in real time over pseudo-dynamic."""
    return tested(runs, bearing, "rt", column) / tested(runs, bearing, "pd", column)


def rises_by_mode(runs: Runs, bearing: str, place: str) -> Floats:
    """Return a rise ("outer_layer", "inner_layer", "lead") in real time over pseudo-dynamic."""
    return np.asarray(
        _bearing_rows(runs, "modes_table", bearing)[f"{place}_rise_ratio"], dtype=float
    )


def rise_differences(runs: Runs, bearing: str, place: str) -> Floats:
    """Return a rise in real time less that in the pseudo-dynamic test [K]; see `rises_by_mode`."""
    table = _bearing_rows(runs, "modes_table", bearing)
    fast, slow = (table[f"{place}_rise_{mode}_K"].to_numpy(dtype=float) for mode in ("rt", "pd"))
    return np.asarray(fast - slow)


def speeds(runs: Runs, mode: str) -> Floats:
    """Return the largest speed of the specimen in each run of a mode [mm/s]."""
    result = both(runs)
    of_mode = np.array(result.modes) == mode
    return np.asarray(largest(runs, result, "bearing_speed")[of_mode])


def _driven(runs: Runs, name: str, air: float, time: Floats, moved: Floats) -> Floats:
    """Return the force of a specimen that is driven through a history of displacement [kN]."""
    element, forces = BearingElement(runs.bearing(name), air), [0.0]
    for gap, target in zip(np.diff(time), moved[1:], strict=True):
        forces.append(element.set_trial(float(target), dt=max(float(gap), SHORTEST)).force)
        element.commit()
    return np.asarray(np.abs(forces), dtype=np.float64)


def half_cycles(runs: Runs, bearing: str) -> list[list[tuple[Floats, Floats, Floats]]]:
    """Return |displacement| and force at both speeds in half cycles beyond 50 %, by temperature.

    A real-time test's history of displacement is driven as it is, and at 10 mm/s.
    """

    def make() -> list[list[tuple[Floats, Floats, Floats]]]:
        result, by_temperature = runs.hybrid(bearing, AMBIENT), []
        size = runs.bearing(bearing).total_rubber_thickness * SMALLEST
        for run, air in enumerate(AMBIENT):
            time, moved = _history(result, run, "bearing_displacement")
            # The same path at a constant speed: the time is its length over that speed.
            slow = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(moved)) / SLOW)])
            forces = [_driven(runs, bearing, air, clock, moved) for clock in (time, slow)]
            parts = np.split(np.arange(len(moved)), np.flatnonzero(np.diff(np.sign(moved))) + 1)
            large = [part for part in parts if np.abs(moved[part]).max() > size]
            by_temperature.append([(np.abs(moved[p]), forces[0][p], forces[1][p]) for p in large])
        return by_temperature

    return runs.once(make, "half cycles", bearing)


def force_by_speed(runs: Runs, bearing: str) -> Floats:
    """Return the force in real time over that at 10 mm/s at equal displacement."""
    real, slow = (
        np.array([max(half[place].max() for half in air) for air in half_cycles(runs, bearing)])
        for place in (1, 2)
    )
    return np.asarray(real / slow)


def peaks_by_speed(runs: Runs) -> Floats:
    """Return the largest force of each half cycle, real time over 10 mm/s, LHDR."""
    halves = [half for air in half_cycles(runs, LHDR) for half in air]
    return np.array([real.max() / slow.max() for _, real, slow in halves])


def corners(runs: Runs) -> Floats:
    """Return the force at the largest displacement over the largest: real time over 10 mm/s."""
    halves = [half for air in half_cycles(runs, LHDR) for half in air]
    ends = [[f[moved.argmax()] / f.max() for f in (real, slow)] for moved, real, slow in halves]
    return np.asarray(np.divide(*np.array(ends).T))


def rise_at_the_peak(runs: Runs) -> float:
    """Return the rise of the third layer at the peak of the ground, of that to 23 degC, LHDR."""
    result = runs.hybrid(LHDR, COLDEST)
    _, ground = _history(result, 0, "ground_acceleration")
    _, layers = _history(result, 0, "rubber_temperature")
    rise = layers[int(np.abs(ground).argmax()), 2] - COLDEST
    return float(rise / (AMBIENT[0] - COLDEST))


def first_layer(runs: Runs, moments: Sequence[float], **options: Any) -> Floats:
    """Return the first layer of the LHDR at -20 degC in real time at some moments [degC]."""
    time, layers = _history(runs.hybrid(LHDR, COLDEST, **options), 0, "rubber_temperature")
    return _at(moments, time, layers[:, 0])


def layers_in_tests(runs: Runs) -> Floats:
    """Return the largest rise of the third layer over that of the first, every run."""
    result, ratios = both(runs), []
    for run in range(result.runs):
        _, layers = _history(result, run, "rubber_temperature")
        rise = (layers - layers[0]).max(axis=0)
        ratios.append(rise[2] / rise[0])
    return np.array(ratios)


def _inner(runs: Runs, **options: Any) -> list[tuple[Floats, Floats]]:
    """Return time and rise of the inner layer in real time, HDR, warm to cold."""
    result = runs.hybrid(HDR, **options)
    histories = [_history(result, run, "rubber_temperature") for run in range(result.runs)]
    return [(time, layers[:, -1] - layers[0, -1]) for time, layers in histories]


def inner_rises(runs: Runs, **options: Any) -> Floats:
    """Return the largest rise of the inner layer in real time, HDR [K]."""
    return np.array([rise.max() for _, rise in _inner(runs, **options)])


def rise_while_strong(runs: Runs) -> Floats:
    """Return the share of the inner layer's largest rise that it gains from 5 to 10 s, HDR."""
    return np.array([np.diff(_at(STRONG, t, r))[0] / r.max() for t, r in _inner(runs)])


def teeth(runs: Runs) -> Floats:
    """Return how much rubber is warmer than shims on average at 10, 15, 20 s, HDR [K]."""
    result, differences = runs.hybrid(HDR, keep=["rubber", "cells"]), []
    for run in range(result.runs):
        time, cells = _history(result, run, "temperature")
        shims = np.flatnonzero(result["part"].values[run] == "shim")
        gap = (cells[:, shims - 1] - cells[:, shims]).mean(axis=1)
        differences.append(_at(FADING, time, gap))
    return np.array(differences)


# Profiles and shares of force in the hybrid tests of the LHDR specimen (5.4.2).


def _lhdr(runs: Runs, **options: Any) -> EarthquakeResult:
    return runs.hybrid(LHDR, AMBIENT, MODES, keep=["rubber", "cells"], **options)


def _find_runs(result: EarthquakeResult, mode: str) -> list[int]:
    """Return the numbers of the runs of a mode, warm to cold."""
    table = result.table[result.table["mode"] == mode]
    return [int(run) for run in table.sort_values("ambient_degC", ascending=False).index]


def share(runs: Runs, mode: str, part: str) -> Floats:
    """Return the largest value of a part of the force over the largest force."""
    result = _lhdr(runs)
    parts, force = (largest(runs, result, name) for name in (part, "bearing_force"))
    return (parts / force)[_find_runs(result, mode)]


def rate_share_at_the_beginning(runs: Runs) -> Floats:
    """Return the largest share of the rate-dependent force, first 2 s, pseudo-dynamic."""
    result, shares = _lhdr(runs), []
    for run in _find_runs(result, "pd"):
        time = result["time"].values[run]
        first = (time > 0.0) & (time <= FIRST_SECONDS)
        names = ("viscous_force", "rubber_force", "lead_force")
        parts = np.abs([result[name].values[run][first] for name in names])
        shares.append((parts[0] / parts.sum(axis=0)).max())
    return np.array(shares)


def _last(runs: Runs, **options: Any) -> list[tuple[Floats, Floats, float]]:
    """Return rises of cells, layers and lead at 20 s in real time [K], warm to cold."""
    result, profiles = _lhdr(runs, **options), []
    for air, run in zip(AMBIENT, _find_runs(result, "rt"), strict=True):
        step = int(np.nanargmin(np.abs(result["time"].values[run] - PROFILE_AT)))
        names = ("temperature", "rubber_temperature", "lead_temperature")
        cells, rubber, lead = (result[name].values[run, step] - air for name in names)
        profiles.append((cells, rubber, float(lead)))
    return profiles


def layers_in_real_time(runs: Runs) -> list[tuple[float, ...]]:
    """Return the rises of lead, third and first layer at 20 s, a row for each temperature [K]."""
    return [(lead, rubber[-1], rubber[0]) for _, rubber, lead in _last(runs)]


def saw_teeth(runs: Runs) -> Floats:
    """Return how much each layer is above the coldest steel next to it at 20 s [K]."""
    half = stack(runs, LHDR)
    ends = list(zip(half.layers["first"], half.layers["last"], strict=True))
    return np.array(
        [
            [cells[a:b].mean() - min(cells[a - 1], cells[b]) for a, b in ends]
            for cells, _, _ in _last(runs)
        ]
    )


def peak_at_the_interface(runs: Runs, **options: Any) -> list[tuple[float, ...]]:
    """Return the rises of the steel at 48 mm and of the hottest rubber at 20 s, a row each [K]."""
    part = np.array(stack(runs, LHDR).part)
    interface = int(np.flatnonzero(part == "end_plate")[-1])
    return [(c[interface], c[part == "rubber"].max()) for c, _, _ in _last(runs, **options)]


def spread_with_the_motion(runs: Runs) -> Floats:
    """Return the third layer less the first at 5, 10 and 20 s at -20 degC in real time [K]."""
    result = _lhdr(runs)
    time, rubber = _history(result, _find_runs(result, "rt")[-1], "rubber_temperature")
    return _at([5.0, 10.0, 20.0], time, rubber[:, -1] - rubber[:, 0])


# Pier P1 in earthquakes (chapter 6).


def bridge_study(runs: Runs, bearing: str) -> EarthquakeResult:
    """Return pier P1 on one kind of bearing: four motions at three temperatures."""
    return runs.bridge(bearing, MOTIONS, AMBIENT, keep=THINNED)


def shaken(runs: Runs, bearing: str, column: str) -> Floats:
    """Return a column of the table of the bridge: a row for each motion; NaN if a run ended."""
    table = bridge_study(runs, bearing).table  # motion by motion, in each of them as AMBIENT
    values = table[column].to_numpy(dtype=float).reshape(len(MOTIONS), len(AMBIENT))
    return values if set(table["outcome"]) == {"completed"} else np.full_like(values, np.nan)


def both_shaken(runs: Runs, column: str) -> Floats:
    """Return a column of the table of the bridge: motions on HDR, then on LHDR bearings."""
    return np.concatenate([shaken(runs, name, column) for name in BRIDGES])


def ductility_at_level_1(runs: Runs) -> Floats:
    """Return the largest ductility in Type I motions that envelop Level 1, HDR and LHDR."""
    weak = runs.varied({"a_g": runs.number("level_1") * runs.change.get("a_g", 1.0)})
    studies = [weak.bridge(name, MOTIONS[:2], AMBIENT, keep=THINNED) for name in BRIDGES]
    # The motion was asked of the varied simulations, which do not tell these.
    runs.shaken = True
    return np.array([study.table["pier_ductility"].max() for study in studies])


def _public(*modules: ModuleType) -> dict[str, Callable[..., Any]]:
    """Return the public functions of modules that take simulations."""
    return {
        name: function
        for module in modules
        for name, function in vars(module).items()
        if isfunction(function)
        and function.__module__ == module.__name__
        and next(iter(function.__annotations__), "").endswith("runs")
        and not name.startswith("_")
    }


def functions() -> dict[str, Callable[..., Any]]:
    """Return the functions that expressions may call without their first argument."""
    methods = (Runs.bearing, Runs.structure, Runs.number, Runs.cyclic, Runs.hybrid)
    return {function.__name__: function for function in methods} | _public(
        sys.modules[__name__], misprints, records
    )


# Names of expressions that need no simulations.
PLAIN: dict[str, Any] = {
    "np": np,
    "HDR": HDR,
    "LHDR": LHDR,
    "SPECIMENS": SPECIMENS,
    "MODES": MODES,
    "PIER": PIER,
    "TWO": TWO,
    "HDR_BRIDGE": HDR_BRIDGE,
    "LHDR_BRIDGE": LHDR_BRIDGE,
    "BRIDGES": BRIDGES,
    "BILINEAR": BILINEAR,
    "HYBRID_PIER": HYBRID_PIER,
    "AMBIENT": np.array(AMBIENT),
    "RUBBERS": ("G8", "G10", "G12"),
    "KINDS": ("HDR", "HDR-S"),
    "full_cycles": full_cycles,
    "load_rig": load_rig,
    "load_bilinear": load_bilinear,
    "load_rubber": load_rubber,
    "shear_modulus": shear_modulus,
    "damping_ratio": damping_ratio,
    "half_space_factor": half_space_factor,
    "EndFace": EndFace,
    "ModelOptions": ModelOptions,
}


def words(runs: Runs) -> dict[str, Any]:
    """Return all that an expression may name."""
    return PLAIN | {name: partial(function, runs) for name, function in functions().items()}


def evaluate(expression: str, names: Mapping[str, Any]) -> Any:
    """Return the value of an expression of our data files over some names."""
    return eval(expression, dict(names))
