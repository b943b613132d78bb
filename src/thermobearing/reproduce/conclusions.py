"""What chapter 7 says, computed: a function for each claim of `data/claims/conclusions.toml`.

What chapters 5 and 6 compute already is taken from there. Values at several ambient temperatures
stand from warm to cold: 23, 0, -20 degC.
"""

import numpy as np

from thermobearing.core.types import Floats
from thermobearing.cyclic.protocol import CyclicTest
from thermobearing.cyclic.result import Result
from thermobearing.design.factors import scaled_bearing
from thermobearing.reproduce.bridge_claims import MOTIONS, by_motion
from thermobearing.reproduce.chapter_6 import HDR as BRIDGE_HDR
from thermobearing.reproduce.chapter_6 import LHDR as BRIDGE_LHDR
from thermobearing.reproduce.runs import AMBIENT, Runs, full_cycles
from thermobearing.reproduce.values import Numbers, rows, told

HDR, LHDR = "shen-hdr-specimen", "shen-lhdr-specimen"
STRAINS = (0.5, 1.0, 1.5, 2.0, 2.5)
SCALE = 6.0  # of the prototype, Table 3.6
INNERMOST = -1


def _tests(runs: Runs, bearing: str) -> Result:
    """Table 3.4 with the wave of the specimen, without histories of cells."""
    wave = "triangular" if bearing == HDR else "sine"
    return runs.cyclic(bearing, AMBIENT, full_cycles(STRAINS, wave=wave), keep=["rubber"])


def _measure(runs: Runs, bearing: str, column: str, cycle: int = 5) -> Floats:
    """Of one cycle at each amplitude: a row for each temperature."""
    table = _tests(runs, bearing).cycles
    table = table[(table["cycle"] == cycle) & table["amplitude_strain"].round(2).isin(STRAINS)]
    return np.array([table[table["ambient_degC"] == at][column] for at in AMBIENT], dtype=float)


def _of_both(runs: Runs, column: str, cycle: int = 5) -> Floats:
    """Rows over temperature, for each amplitude of HDR, then LHDR."""
    return np.concatenate([_measure(runs, name, column, cycle).T for name in (HDR, LHDR)])


# 7.1, chapter 3 (1): cyclic loading


def energy_in_the_cold(runs: Runs) -> Numbers:
    """Area of the fifth loop at each amplitude, HDR then LHDR [kN mm]."""
    return rows(_of_both(runs, "energy_kN_mm"))


def modulus_in_the_cold(runs: Runs) -> Numbers:
    """G_e of the fifth cycle at each amplitude, HDR then LHDR [MPa]."""
    return rows(_of_both(runs, "G_eq_MPa"))


def damping_in_the_cold(runs: Runs) -> Numbers:
    """h_eq of the fifth cycle at each amplitude, HDR then LHDR."""
    return rows(_of_both(runs, "h_eq"))


def damping_of_hdr_in_the_cold(runs: Runs) -> Numbers:
    """h_eq of the first cycle of 100 to 250 %, HDR."""
    return rows(_measure(runs, HDR, "h_eq", 1).T[1:])


def modulus_first_and_fifth(runs: Runs) -> Numbers:
    """G_e of cycles 1 and 5 at 100 to 250 %, both bearings, all temperatures [MPa]."""
    first, fifth = (_of_both(runs, "G_eq_MPa", cycle) for cycle in (1, 5))
    pairs = np.stack([first, fifth], axis=-1).reshape(2, len(STRAINS), len(AMBIENT), 2)
    return rows(pairs[:, 1:].reshape(-1, 2))


def damping_first_and_fifth(runs: Runs) -> Numbers:
    """h_eq of cycles 1 and 5, both bearings, all amplitudes and temperatures."""
    first, fifth = (_of_both(runs, "h_eq", cycle).ravel() for cycle in (1, 5))
    return rows(np.column_stack([first, fifth]))


# 7.1, chapter 3 (2): temperatures of the cyclic tests


def lead_falls_in_rest(runs: Runs) -> Numbers:
    """Rise of the lead at the end of 250 %, then 60 s and 600 s later, a row a temperature [K]."""
    cycles = {"step": "cycles", "strain": 2.5, "wave": "sine", "speed": 30.0, "count": 5}
    test = CyclicTest(steps=[cycles, {"step": "rest", "duration": 900.0}])
    result = runs.cyclic(LHDR, AMBIENT, test, keep=["rubber"])
    found = []
    for run, air in enumerate(AMBIENT):
        time, lead = result.time(run), result["lead_temperature"].values[run] - air
        end = float(time[int(np.argmax(lead))])
        found.append(told(np.interp([end, end + 60.0, end + 600.0], time, lead)))
    return found


# 7.1, chapter 6 and 7.2


def strain_of_the_bridge(runs: Runs) -> Numbers:
    """Largest strain of HDR, then LHDR, a row for each motion."""
    return _bridge(runs, "bearing_strain_max")


def force_of_the_bridge(runs: Runs) -> Numbers:
    """Largest force of HDR, then LHDR [kN]."""
    return _bridge(runs, "bearing_force_max_kN")


def energy_of_the_bridge(runs: Runs) -> Numbers:
    """Dissipated energy of HDR, then LHDR [kN mm]."""
    return _bridge(runs, "bearing_energy_kN_mm")


def pier_of_the_bridge(runs: Runs) -> Numbers:
    """Displacement of the pier top on HDR, then LHDR [mm]."""
    return _bridge(runs, "pier_displacement_max_mm")


def deck_of_the_bridge(runs: Runs) -> Numbers:
    """Acceleration of the deck on HDR, then LHDR, at 23 and -20 degC [m/s2]."""
    both = [by_motion(runs, name, "deck_acceleration_max_m_s2") for name in _names()]
    return rows(np.concatenate(both)[:, [0, -1]])


def _names() -> tuple[str, str]:
    return BRIDGE_HDR, BRIDGE_LHDR


def _bridge(runs: Runs, column: str) -> Numbers:
    found = np.concatenate([by_motion(runs, name, column) for name in _names()])
    assert len(found) == 2 * len(MOTIONS)
    return rows(found)


def size(runs: Runs) -> Numbers:
    """Rise of the third layer: specimen over one six times as large, same strains and times."""
    rises = []
    for factor in (1.0, SCALE):
        specimen = scaled_bearing(runs.bearing(HDR), factor)
        cycles = {"step": "cycles", "strain": 2.5, "period": 10.0, "count": 5}
        rest = {"step": "rest", "duration": 120.0}
        result = runs.cyclic(specimen, -20.0, CyclicTest(steps=[cycles, rest]))
        rises.append(float(result["rubber_temperature"].values[0, -1, INNERMOST]) + 20.0)
    return rises[0] / rises[1]
