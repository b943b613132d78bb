"""What chapter 3 says of specimens and cyclic tests: a function for each claim.

Hybrid tests are in `chapter_3_hybrid`; places and statements in `data/claims/chapter-3.toml`.
"""

import numpy as np

from thermobearing.core.types import Floats
from thermobearing.cyclic.case import load_rig
from thermobearing.cyclic.protocol import Cycles, cyclic_test
from thermobearing.reproduce.runs import Runs, full_cycles
from thermobearing.reproduce.values import (
    HDR,
    LHDR,
    SPECIMENS,
    all_cycles,
    loadings,
    of_cycle,
    rises_in_loading,
    temperature_at,
)

G_E, H_EQ, ENERGY = "G_eq_MPa", "h_eq", "energy_kN_mm"
NOMINAL = 1.75  # strain at which a rubber's nominal modulus is told
COOLING = 60.0  # after a loading [s]
PLUNGE = (0.0, 10.0, 60.0)  # of a rest, 4.4.1.2 [s]


def first_shape_factor(runs: Runs) -> Floats:
    """S1 of both specimens."""
    return np.array([runs.bearing(name).geometry.first_shape_factor for name in SPECIMENS])


def second_shape_factor(runs: Runs) -> Floats:
    """S2 of both specimens."""
    return np.array([runs.bearing(name).geometry.second_shape_factor for name in SPECIMENS])


def total_thicknesses(runs: Runs) -> Floats:
    """Of all rubber layers and of all shims of the HDR specimen [mm]."""
    geometry = runs.bearing(HDR).geometry
    shims = (geometry.rubber_layers - 1) * geometry.shim_thickness
    return np.array([geometry.total_rubber_thickness, shims])


def nominal_modulus(runs: Runs) -> float:
    """G_e of the third cycle of 175 % at 23 degC, HDR [MPa]."""
    table = runs.cyclic(HDR, 23.0, full_cycles([NOMINAL], 3)).cycles
    return float(table[G_E].iloc[-1])


def prototype(runs: Runs) -> Floats:
    """Side and rubber thickness of the bearing that the specimen stands for [mm]."""
    geometry = runs.bearing(HDR).geometry
    scale = runs.structure("hybrid-pier").bearings[0].scale
    return np.array([geometry.plan.breadth, geometry.total_rubber_thickness]) / scale


def _largest(runs: Runs, bearing: str, name: str) -> float:
    return float(np.nanmax(np.abs(runs.cyclic(bearing)[name].values)))


def cyclic_force_hdr(runs: Runs) -> float:
    """Largest force of the cyclic tests of the HDR specimen [kN]."""
    return _largest(runs, HDR, "force")


def cyclic_force_lhdr(runs: Runs) -> float:
    """Largest force of the cyclic tests of the LHDR specimen [kN]."""
    return _largest(runs, LHDR, "force")


def cyclic_stroke(runs: Runs) -> float:
    """Largest displacement of the cyclic tests over the stroke of the rig."""
    stroke = load_rig("shen-rig").stroke
    return max(_largest(runs, name, "displacement") for name in SPECIMENS) / float(stroke or np.nan)


def _parts(runs: Runs, bearing: str) -> list[tuple[float, float]]:
    """Amplitude and period of the cycles of Table 3.4 [mm, s]."""
    thick = runs.bearing(bearing).total_rubber_thickness
    steps = [step for step in cyclic_test().steps if isinstance(step, Cycles)]
    return [(step.size(thick), 4.0 * step.quarters(thick)[0]) for step in steps]


def amplitudes(runs: Runs) -> Floats:
    """Of Table 3.4 by the strains and the rubber of the specimen [mm]."""
    return np.array([size for size, _ in _parts(runs, HDR)])


def periods(runs: Runs) -> Floats:
    """Of cycles at 30 mm/s [s]."""
    return np.array([period for _, period in _parts(runs, HDR)])


def frequencies(runs: Runs) -> Floats:
    """Of cycles at 30 mm/s [Hz]."""
    return 1.0 / periods(runs)


def _speeds(runs: Runs, bearing: str) -> Floats:
    result = runs.cyclic(bearing, 23.0)
    time, moved = result.time(0), result["displacement"].values[0]
    found = []
    for first, last in loadings(result, 0):
        part = slice(first, last + 1)
        found.append(np.abs(np.diff(moved[part]) / np.diff(time[part])).max())
    return np.array(found)


def rate_of_triangles(runs: Runs) -> Floats:
    """Largest speed of the five loadings of the HDR specimen [mm/s]."""
    return _speeds(runs, HDR)


def rate_of_sines(runs: Runs) -> Floats:
    """Largest speed of the five loadings of the LHDR specimen, sines [mm/s]."""
    return _speeds(runs, LHDR)


def left_after_rests(runs: Runs) -> float:
    """Most that a rubber layer is away from the air after a rest of 1.25 h [K]."""
    found = []
    for bearing in SPECIMENS:
        result = runs.cyclic(bearing)
        for run, air in enumerate(result["ambient"].values):
            starts = [first for first, _ in loadings(result, run)[1:]]
            layers = result["rubber_temperature"].values[run][starts]
            found.append(np.abs(layers - air).max())
    return float(max(found))


def stress_in_the_cold(runs: Runs) -> Floats:
    """Largest stress of the fifth cycle at each strain, both specimens [MPa]."""
    return np.vstack([of_cycle(runs, name, "stress_max_MPa", 5) for name in SPECIMENS])


def area_in_the_cold_hdr(runs: Runs) -> Floats:
    """Energy of the fifth cycle at each strain, HDR [kN mm]."""
    return of_cycle(runs, HDR, ENERGY, 5)


def area_in_the_cold_lhdr(runs: Runs) -> Floats:
    """Energy of the fifth cycle at each strain, LHDR [kN mm]."""
    return of_cycle(runs, LHDR, ENERGY, 5)


def modulus_first_and_fifth(runs: Runs) -> Floats:
    """G_e of first and fifth cycle, a row per strain and temperature, HDR [MPa]."""
    return all_cycles(runs, HDR, G_E)[:, [0, -1]]


def damping_first_and_fifth(runs: Runs) -> Floats:
    """h_eq of first and fifth cycle, a row per strain and temperature, HDR."""
    return all_cycles(runs, HDR, H_EQ)[:, [0, -1]]


def first_over_second(runs: Runs) -> Floats:
    """G_e of the first cycle over that of the second at each strain and temperature, HDR."""
    cycles = all_cycles(runs, HDR, G_E)
    return np.asarray(cycles[:, 0] / cycles[:, 1])


def first_cycles(runs: Runs) -> Floats:
    """G_e of first cycles from 50 to 250 %, a row for each temperature, HDR [MPa]."""
    return of_cycle(runs, HDR, G_E, 1).T


def modulus_with_strain(runs: Runs) -> Floats:
    """G_e of fifth cycles from 50 to 250 %, a row for each temperature, HDR [MPa]."""
    return of_cycle(runs, HDR, G_E, 5).T


def damping_with_strain(runs: Runs) -> Floats:
    """h_eq of fifth cycles from 50 to 250 %, a row for each temperature, HDR."""
    return of_cycle(runs, HDR, H_EQ, 5).T


def modulus_in_the_cold_hdr(runs: Runs) -> Floats:
    """G_e of the fifth cycle at each strain, HDR [MPa]."""
    return of_cycle(runs, HDR, G_E, 5)


def modulus_in_the_cold_lhdr(runs: Runs) -> Floats:
    """G_e of the fifth cycle at each strain, LHDR [MPa]."""
    return of_cycle(runs, LHDR, G_E, 5)


def damping_in_the_cold_hdr(runs: Runs) -> Floats:
    """h_eq of the fifth cycle at each strain, HDR."""
    return of_cycle(runs, HDR, H_EQ, 5)


def damping_in_the_cold_lhdr(runs: Runs) -> Floats:
    """h_eq of the fifth cycle at each strain, LHDR."""
    return of_cycle(runs, LHDR, H_EQ, 5)


def modulus_with_cycles_lhdr(runs: Runs) -> Floats:
    """G_e from the first to the fifth cycle, a row per strain and temperature, LHDR [MPa]."""
    return all_cycles(runs, LHDR, G_E)


def stress_of_lead(runs: Runs) -> Floats:
    """Largest stress of the LHDR over the HDR specimen, fifth cycle of each strain."""
    column = "stress_max_MPa"
    return np.asarray(of_cycle(runs, LHDR, column, 5) / of_cycle(runs, HDR, column, 5))


def energy_of_lead(runs: Runs) -> Floats:
    """Energy of the LHDR over the HDR specimen in the whole cyclic test."""
    energy = [runs.cyclic(name).energy["work_in_kN_mm"].to_numpy() for name in (LHDR, HDR)]
    return np.asarray(energy[0] / energy[1])


def third_over_first_layer(runs: Runs) -> Floats:
    """Largest rise of the third layer over the first at each strain and temperature, both."""
    rises = [
        rises_in_loading(runs, name, "rubber3") / rises_in_loading(runs, name, "rubber1")
        for name in SPECIMENS
    ]
    return np.vstack(rises)


def rise_in_the_cold(runs: Runs) -> Floats:
    """Largest rise of the third layer at each strain, both specimens [K]."""
    return np.vstack([rises_in_loading(runs, name, "rubber3") for name in SPECIMENS])


def lead_over_rubber(runs: Runs) -> Floats:
    """Rise of the lead over that of the third layer of the HDR specimen, 250 %."""
    lead = rises_in_loading(runs, LHDR, "lead")[-1]
    return np.asarray(lead / rises_in_loading(runs, HDR, "rubber3")[-1])


def hdr_over_lhdr_layer(runs: Runs) -> Floats:
    """Rise of the third layer in the HDR over that in the LHDR specimen, 250 %."""
    hdr, lhdr = (rises_in_loading(runs, name, "rubber3")[-1] for name in SPECIMENS)
    return np.asarray(hdr / lhdr)


def _lost(runs: Runs, bearing: str, place: str) -> Floats:
    """Fall in the first minute after the loading of 200 % [K]; the last has no rest after it."""
    result = runs.cyclic(bearing)
    found = []
    for run in range(len(result["ambient"])):
        end, time = loadings(result, run)[-2][1], result.time(run)
        values = temperature_at(result, place, run)
        found.append(values[end] - np.interp(time[end] + COOLING, time, values))
    return np.array(found)


def first_plunge(runs: Runs) -> Floats:
    """Rate of fall of first and third layer in the first 10 s of a rest over that after, HDR."""
    result = runs.cyclic(HDR)
    found = []
    for run in range(len(result["ambient"])):
        end, time = loadings(result, run)[-2][1], result.time(run)
        for place in ("rubber1", "rubber3"):
            values = temperature_at(result, place, run)
            fall = -np.diff(np.interp(time[end] + np.array(PLUNGE), time, values))
            found.append(fall[0] / fall[1] * (PLUNGE[2] - PLUNGE[1]) / PLUNGE[1])
    return np.array(found)


def lead_cools_before_rubber(runs: Runs) -> Floats:
    """Fall of the lead in the minute after 200 %, over that of the third layer beside it."""
    return np.asarray(_lost(runs, LHDR, "lead") / _lost(runs, LHDR, "rubber3"))
