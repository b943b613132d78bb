"""What chapter 3 says of the hybrid tests (3.4 and 3.5): a function for each claim."""

from collections.abc import Sequence

import numpy as np

from thermobearing.core.types import Floats
from thermobearing.model.element import BearingElement
from thermobearing.reproduce.runs import AMBIENT, Runs
from thermobearing.reproduce.values import (
    ACCELERATION,
    ENERGY,
    FORCE,
    HDR,
    LHDR,
    PIER,
    SPECIMENS,
    STRAIN,
    at_moments,
    both,
    every_hybrid,
    histories,
    of_hybrid,
    real_over_pseudo,
    rise_ratios,
)
from thermobearing.structure.run import prepare_structure

GRAVITY = 9.80665  # [m/s2]
KN_PER_MASS = 1000.0  # of a mass in kN s2/mm at 1 m/s2
HYBRID_PIER, TWO = "hybrid-pier", "hybrid-pier-two-bearings"
DELAY = 0.005  # of the actuator: usual for a servo-hydraulic rig; not printed [s]
SLOW = 10.0  # of the pseudo-dynamic test, 3.4.2 [mm/s]
SHORTEST = 1e-9  # time step where the displacement stays [s]
SMALLEST = 0.5  # strain of the half cycles that count: the smallest amplitude of Table 3.4
MOMENTS = (5.0, 10.0, 20.0)  # of the first layer, 3.4.4 [s]
COLDEST = -20.0


def first_period(runs: Runs) -> float:
    """Of masses and stiffnesses of Table 3.5 [s]."""
    return float(prepare_structure(runs.structure(HYBRID_PIER)).modes.periods[0])


def _axial_stress(runs: Runs, structure: str) -> float:
    pier = runs.structure(structure)
    line = pier.bearings[0]
    deck = next(item.mass for item in pier.masses if item.body == line.body)
    area = runs.bearing(LHDR).geometry.plan.area / line.scale**2
    return float(deck * KN_PER_MASS * GRAVITY * 1000.0 / (line.count * area))


def axial_stress_of_eight(runs: Runs) -> float:
    """Of the deck on eight bearings of 1440 mm [MPa]."""
    return _axial_stress(runs, HYBRID_PIER)


def axial_stress_of_two(runs: Runs) -> float:
    """Of the deck on two bearings of 1440 mm [MPa]."""
    return _axial_stress(runs, TWO)


def largest_force(runs: Runs) -> float:
    """Of the specimen in all twelve runs [kN]."""
    return float(every_hybrid(runs, FORCE).max())


def largest_force_on_two(runs: Runs) -> float:
    """Of the specimen in real time on two bearings, LHDR at -20 degC [kN]."""
    result = runs.hybrid(LHDR, COLDEST, structure=TWO)
    return float(result.table[FORCE].max())


def largest_stroke(runs: Runs) -> float:
    """Of the specimen in all twelve runs [mm]."""
    return float(np.nanmax(np.abs(both(runs)["bearing_displacement"].values)))


def _speeds(runs: Runs, mode: str) -> Floats:
    """Largest speed of the specimen in each run of a mode [mm/s]."""
    result = both(runs)
    chosen = [run for run, own in enumerate(result.modes) if own == mode]
    return np.array([np.nanmax(np.abs(result["bearing_speed"].values[run])) for run in chosen])


def speed_in_real_time(runs: Runs) -> Floats:
    """Largest speeds in real time [mm/s]."""
    return _speeds(runs, "rt")


def speed_of_pseudo_dynamic(runs: Runs) -> Floats:
    """Largest speeds in pseudo-dynamic tests [mm/s]."""
    return _speeds(runs, "pd")


def delay_changes_force(runs: Runs) -> Floats:
    """Change of the largest force by 5 ms of delay, both specimens, warm to cold [%]."""
    found = []
    for bearing in SPECIMENS:
        plain = runs.hybrid(bearing).table[FORCE].to_numpy()
        late = runs.hybrid(bearing, laboratory={"mode": "rt", "delay": DELAY}).table[FORCE]
        found.append(100.0 * np.abs(late.to_numpy() / plain - 1.0))
    return np.array(found)


def hybrid_force_in_the_cold(runs: Runs) -> Floats:
    """Largest force of the specimen, a row for each specimen and mode [kN]."""
    return every_hybrid(runs, FORCE)


def hybrid_area_in_the_cold(runs: Runs) -> Floats:
    """Energy of the largest loop, likewise [kN mm]."""
    return every_hybrid(runs, "loop_energy_kN_mm")


def _driven(runs: Runs, name: str, air: float, time: Floats, moved: Floats) -> Floats:
    """Force of a specimen that is driven through a history of displacement [kN]."""
    element = BearingElement(runs.bearing(name), air)
    found = [0.0]
    for gap, target in zip(np.diff(time), moved[1:], strict=True):
        found.append(element.set_trial(float(target), dt=max(float(gap), SHORTEST)).force)
        element.commit()
    return np.asarray(np.abs(found), dtype=np.float64)


def _at_equal_displacement(runs: Runs, name: str) -> list[list[tuple[Floats, Floats, Floats]]]:
    """Half cycles beyond 50 % of real-time tests: |displacement|, force at both speeds; by air."""

    def make() -> list[list[tuple[Floats, Floats, Floats]]]:
        result, found = runs.hybrid(name, AMBIENT), []
        for run, air in enumerate(AMBIENT):
            time, moved = histories(result, run, "bearing_displacement")
            slow = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(moved)) / SLOW)])
            forces = [_driven(runs, name, air, each, moved) for each in (time, slow)]
            parts = np.split(np.arange(len(moved)), np.flatnonzero(np.diff(np.sign(moved))) + 1)
            size = runs.bearing(name).total_rubber_thickness * SMALLEST
            far = [part for part in parts if np.abs(moved[part]).max() > size]
            found.append([(np.abs(moved[p]), forces[0][p], forces[1][p]) for p in far])
        return found

    return runs.once(make, "equal displacement", name)


def _force_at_equal_displacement(runs: Runs, name: str) -> Floats:
    largest = [
        [max(half[way].max() for half in halves) for way in (1, 2)]
        for halves in _at_equal_displacement(runs, name)
    ]
    real, slow = np.array(largest).T
    return np.asarray(real / slow)


def hdr_force_ratio(runs: Runs) -> Floats:
    """Force in real time over 10 mm/s at equal displacement, HDR at 0 and -20 degC."""
    return _force_at_equal_displacement(runs, HDR)[1:]


def lhdr_force_ratio(runs: Runs) -> Floats:
    """Force in real time over 10 mm/s at equal displacement, LHDR at 0 and -20 degC."""
    return _force_at_equal_displacement(runs, LHDR)[1:]


def lhdr_half_cycles(runs: Runs) -> Floats:
    """Largest force of each half cycle beyond 50 %, real time over 10 mm/s, LHDR, all airs."""
    halves = [half for air in _at_equal_displacement(runs, LHDR) for half in air]
    return np.array([real.max() / slow.max() for _, real, slow in halves])


def corners(runs: Runs) -> Floats:
    """Force at the largest displacement over the largest force: real time over 10 mm/s, LHDR."""
    halves = [half for air in _at_equal_displacement(runs, LHDR) for half in air]
    ends = [
        [force[moved.argmax()] / force.max() for force in (real, slow)]
        for moved, real, slow in halves
    ]
    return np.array([real / slow for real, slow in ends])


def rise_at_the_peak(runs: Runs) -> float:
    """Rise of the third layer at the peak of the ground's acceleration, of that to 23 degC."""
    result = runs.hybrid(LHDR, COLDEST)
    _, ground = histories(result, 0, "ground_acceleration")
    _, layers = histories(result, 0, "rubber_temperature")
    rise = layers[int(np.abs(ground).argmax()), 2] - COLDEST
    return float(rise / (AMBIENT[0] - COLDEST))


def hdr_strain_ratio_cold(runs: Runs) -> float:
    """Strain in real time over pseudo-dynamic, HDR at -20 degC."""
    return float(real_over_pseudo(runs, HDR, STRAIN)[2])


def hdr_rise_ratio(runs: Runs) -> Floats:
    """Rise of the inner layer in real time over pseudo-dynamic, HDR."""
    return rise_ratios(runs, HDR, "inner_layer")


def hdr_rise_ratio_outer(runs: Runs) -> Floats:
    """Rise of the outer layer in real time over pseudo-dynamic, HDR."""
    return rise_ratios(runs, HDR, "outer_layer")


def lead_rise_ratio(runs: Runs) -> Floats:
    """Rise of the lead in real time over pseudo-dynamic."""
    return rise_ratios(runs, LHDR, "lead")


def _coldest_lhdr(runs: Runs) -> Floats:
    """First layer of the LHDR at -20 degC in real time at 5, 10, 20 s [degC]."""
    result = runs.hybrid(LHDR, COLDEST)
    return at_moments(result, 0, "rubber_temperature", MOMENTS)[:, 0]


def first_layer_early(runs: Runs) -> Floats:
    """First layer of the LHDR at -20 degC in real time at 5 and 10 s [degC]."""
    return _coldest_lhdr(runs)[:2]


def first_layer_on_two(runs: Runs) -> Floats:
    """The same on two bearings [degC]."""
    result = runs.hybrid(LHDR, COLDEST, structure=TWO)
    return at_moments(result, 0, "rubber_temperature", MOMENTS)[:2, 0]


def first_layer_late(runs: Runs) -> float:
    """First layer of the LHDR at -20 degC in real time at 20 s [degC]."""
    return float(_coldest_lhdr(runs)[2])


def layers_in_hybrid_tests(runs: Runs) -> Floats:
    """Largest rise of the third layer over that of the first, every run."""
    result = both(runs)
    found = []
    for run in range(result.runs):
        _, layers = histories(result, run, "rubber_temperature")
        rise = (layers - layers[0]).max(axis=0)
        found.append(rise[2] / rise[0])
    return np.array(found)


def hybrid_energy_in_the_cold(runs: Runs) -> Floats:
    """Energy of the specimen, a row for each specimen and mode [kN mm]."""
    return every_hybrid(runs, ENERGY)


def energy_of_lead_in_hybrid(runs: Runs) -> Floats:
    """Energy of the LHDR over the HDR specimen, in real time, then pseudo-dynamically."""
    found = [
        of_hybrid(runs, LHDR, mode, ENERGY) / of_hybrid(runs, HDR, mode, ENERGY)
        for mode in ("rt", "pd")
    ]
    return np.concatenate(found)


def real_time_dissipates_more(runs: Runs) -> Floats:
    """Energy RT/PD of the five tests that the source has above 1 (all but HDR at -20 degC)."""
    hdr, lhdr = (real_over_pseudo(runs, name, ENERGY) for name in SPECIMENS)
    return np.concatenate([hdr[:2], lhdr])


def hdr_energy_ratio_cold(runs: Runs) -> float:
    """Energy in real time over pseudo-dynamic, HDR at -20 degC."""
    return float(real_over_pseudo(runs, HDR, ENERGY)[2])


def pier_in_the_cold_hdr(runs: Runs) -> Floats:
    """Displacement of the pier with HDR bearings, real time [mm]."""
    return of_hybrid(runs, HDR, "rt", PIER)


def pier_in_the_cold_lhdr(runs: Runs) -> Floats:
    """Displacement of the pier with LHDR bearings, real time [mm]."""
    return of_hybrid(runs, LHDR, "rt", PIER)


def acceleration_in_the_cold_hdr(runs: Runs) -> Floats:
    """Acceleration of the pier top with HDR bearings, real time [m/s2]."""
    return of_hybrid(runs, HDR, "rt", ACCELERATION)


def acceleration_in_the_cold_lhdr(runs: Runs) -> Floats:
    """Acceleration of the pier top with LHDR bearings, real time [m/s2]."""
    return of_hybrid(runs, LHDR, "rt", ACCELERATION)


def pier_modes_hdr(runs: Runs) -> Floats:
    """Pier displacement and acceleration RT/PD, HDR."""
    return np.concatenate([real_over_pseudo(runs, HDR, name) for name in (PIER, ACCELERATION)])


def pier_modes_lhdr_displacement(runs: Runs) -> Floats:
    """Pier displacement RT/PD, LHDR."""
    return real_over_pseudo(runs, LHDR, PIER)


def pier_modes_lhdr_acceleration(runs: Runs) -> Floats:
    """Pier top acceleration RT/PD, LHDR."""
    return real_over_pseudo(runs, LHDR, ACCELERATION)


def _at_rest(runs: Runs, name: str, airs: Sequence[float]) -> Floats:
    """Stiffness of all bearings of the deck at rest [kN/mm]."""
    line = runs.structure(HYBRID_PIER).bearings[0]
    bearing = runs.bearing(name)
    each = [BearingElement(bearing, air).set_trial(1e-9, dt=1e6).tangent for air in airs]
    return np.array(each) * line.count / line.scale


def initial_stiffness_of_eight_hdr(runs: Runs) -> Floats:
    """Of eight HDR bearings at -20 degC, the printed one, and at 23 degC [kN/mm]."""
    cold, warm = _at_rest(runs, HDR, (COLDEST, 23.0))
    line = runs.structure(HYBRID_PIER).bearings[0]
    return np.array([cold, line.count * line.equivalent_stiffness, warm])
