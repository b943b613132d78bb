"""What chapter 6 says of the bridge in earthquakes, computed: functions of `chapter-6.toml`.

Values at several ambient temperatures stand from warm to cold: 23, 0, -20 degC. Rows are the four
motions I-I-1, I-I-2, II-I-1, II-I-2.
"""

import numpy as np

from thermobearing.core.types import Floats
from thermobearing.cyclic.case import Keep
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.reproduce.chapter_6 import HDR, LHDR, PIER
from thermobearing.reproduce.printed import printed
from thermobearing.reproduce.runs import AMBIENT, Runs
from thermobearing.reproduce.values import Numbers, rows, told

MOTIONS = ("jra-i-i-1", "jra-i-i-2", "jra-ii-i-1", "jra-ii-i-2")
II_I_1 = 2  # of the motions
TYPE_I, TYPE_II = slice(0, 2), slice(2, 4)
BILINEAR = "shen-bilinear-bridge"
THINNED = Keep(every=100)  # peaks and loops come from all steps; many analyses are kept


def study(runs: Runs, bearing: str) -> EarthquakeResult:
    """All motions at all temperatures on one kind of bearing."""
    return runs.bridge(bearing, MOTIONS, AMBIENT, keep=THINNED)


def by_motion(runs: Runs, bearing: str, column: str) -> Floats:
    """A column of the table: a row for each motion, warm to cold."""
    table = study(runs, bearing).table  # motion by motion, in each of them as AMBIENT
    values = table[column].to_numpy(dtype=float).reshape(len(MOTIONS), len(AMBIENT))
    return values if set(table["outcome"]) == {"completed"} else np.full_like(values, np.nan)


# 6.3.1, Fig. 6.9: the layered bearing compared with the bilinear one at 23 degC


def differences_at_23(runs: Runs) -> Numbers:
    """Largest difference of F+-, D+-, K_eq of the HDR from the bilinear bearing, by motion."""
    columns = ("loop_F_plus_kN", "loop_F_minus_kN", "loop_D_plus_mm", "loop_D_minus_mm")
    ratios = [
        by_motion(runs, HDR, name)[:, 0] / by_motion(runs, BILINEAR, name)[:, 0]
        for name in (*columns, "loop_K_eq_kN_mm")
    ]
    return told(np.abs(np.array(ratios) - 1.0).max(axis=0))


def design_displacement(runs: Runs) -> Numbers:
    """Largest displacement of the bilinear bearing in each motion over 178 mm."""
    strain = by_motion(runs, BILINEAR, "bearing_strain_max")[:, 0]
    largest = strain.max() * printed(runs, "t_e")
    return float(largest / printed(runs, "u_B"))


# 6.3.1 and 6.3.2: bearings


def strain_hdr(runs: Runs) -> Numbers:
    """Largest strain."""
    return rows(by_motion(runs, HDR, "bearing_strain_max"))


def strain_lhdr(runs: Runs) -> Numbers:
    """Largest strain."""
    return rows(by_motion(runs, LHDR, "bearing_strain_max"))


def strains_of_both(runs: Runs) -> Numbers:
    """Largest strains of HDR and LHDR, a row for each motion and temperature."""
    both = [by_motion(runs, name, "bearing_strain_max").ravel() for name in (HDR, LHDR)]
    return rows(np.array(both).T)


def strain_reduction(runs: Runs) -> Numbers:
    """1 - largest strain at -20 over that at 23 degC, HDR then LHDR, each motion."""
    both = [by_motion(runs, name, "bearing_strain_max") for name in (HDR, LHDR)]
    return rows(np.array([1.0 - strain[:, -1] / strain[:, 0] for strain in both]))


def force_hdr(runs: Runs) -> Numbers:
    """Largest force [kN]."""
    return rows(by_motion(runs, HDR, "bearing_force_max_kN"))


def force_lhdr(runs: Runs) -> Numbers:
    """Largest force [kN]."""
    return rows(by_motion(runs, LHDR, "bearing_force_max_kN"))


def energy_hdr(runs: Runs) -> Numbers:
    """Energy that one bearing dissipates [kN mm]."""
    return rows(by_motion(runs, HDR, "bearing_energy_kN_mm"))


def energy_lhdr(runs: Runs) -> Numbers:
    """Energy that one bearing dissipates [kN mm]."""
    return rows(by_motion(runs, LHDR, "bearing_energy_kN_mm"))


def energy_drop(runs: Runs) -> Numbers:
    """LHDR in II-I-1: change at 0 and -20 degC against 23 degC [%]."""
    energy = by_motion(runs, LHDR, "bearing_energy_kN_mm")[II_I_1]
    return told(100.0 * (energy[1:] / energy[0] - 1.0))


# 6.3.3 and 6.3.4: the pier


def pier_hdr(runs: Runs) -> Numbers:
    """Largest displacement of the pier top over its base [mm]."""
    return rows(by_motion(runs, HDR, "pier_displacement_max_mm"))


def pier_lhdr(runs: Runs) -> Numbers:
    """Largest displacement of the pier top over its base [mm]."""
    return rows(by_motion(runs, LHDR, "pier_displacement_max_mm"))


def _types(values: Floats) -> tuple[float, float]:
    """Largest of the two motions of type II, and of type I."""
    return float(values[TYPE_II].max()), float(values[TYPE_I].max())


def pier_of_types(runs: Runs) -> Numbers:
    """Largest displacement of the pier, types II and I: HDR, then LHDR, a row a temperature."""
    both = [by_motion(runs, name, "pier_displacement_max_mm") for name in (HDR, LHDR)]
    return [_types(values[:, k]) for values in both for k in range(len(AMBIENT))]


def pier_difference_of_types(runs: Runs) -> Numbers:
    """What -20 degC adds to the displacement of the pier: types II and I; HDR, LHDR [mm]."""
    both = [by_motion(runs, name, "pier_displacement_max_mm") for name in (HDR, LHDR)]
    return [_types(values[:, -1] - values[:, 0]) for values in both]


def ductility_warm(runs: Runs) -> Numbers:
    """At 23 degC: HDR, LHDR, a row each."""
    both = [by_motion(runs, name, "pier_ductility") for name in (HDR, LHDR)]
    return [told(values[:, 0]) for values in both]


def ductility_cold(runs: Runs) -> Numbers:
    """Largest at -20 degC in the motions of type II, HDR or LHDR."""
    both = [by_motion(runs, name, "pier_ductility") for name in (HDR, LHDR)]
    return float(max(values[TYPE_II, -1].max() for values in both))


def ductility_in_the_cold(runs: Runs) -> Numbers:
    """HDR, then LHDR, a row for each motion."""
    both = [by_motion(runs, name, "pier_ductility") for name in (HDR, LHDR)]
    return rows(np.concatenate(both))


def ductility_by_displacement(runs: Runs) -> Numbers:
    """Eq. 6.8 with displacements over the ductility by rotations, HDR and LHDR, II-I-1 cold."""
    hinge = runs.structure(PIER).hinges[0]
    line = runs.structure(PIER).bearings[0]
    found = []
    for name in (HDR, LHDR):
        displacement = by_motion(runs, name, "pier_displacement_max_mm")[II_I_1, -1]
        ductility = by_motion(runs, name, "pier_ductility")[II_I_1, -1]
        found.append(displacement / (hinge.yield_rotation * line.height) / ductility)
    return told(np.array(found))


def ductility_at_level_1(runs: Runs) -> Numbers:
    """Largest in motions of type I that envelop the spectrum of Level 1, HDR and LHDR."""
    factor = printed(runs, "level_1") * runs.change.get("a_g", 1.0)
    weak = runs.beside({"a_g": factor})
    both = [weak.bridge(name, MOTIONS[TYPE_I], AMBIENT, keep=THINNED) for name in (HDR, LHDR)]
    runs.shaken = True
    return told(np.array([study.table["pier_ductility"].max() for study in both]))


def yielding(runs: Runs) -> Numbers:
    """Largest ductility of all 24 runs on layered bearings."""
    both = [by_motion(runs, name, "pier_ductility") for name in (HDR, LHDR)]
    return float(max(values.max() for values in both))


# 6.3.5: the deck


def deck_hdr(runs: Runs) -> Numbers:
    """Largest acceleration of the deck [m/s2]."""
    return rows(by_motion(runs, HDR, "deck_acceleration_max_m_s2"))


def deck_lhdr(runs: Runs) -> Numbers:
    """Largest acceleration of the deck [m/s2]."""
    return rows(by_motion(runs, LHDR, "deck_acceleration_max_m_s2"))


def deck_change(runs: Runs) -> Numbers:
    """Largest acceleration of the deck at -20 over that at 23 degC, less 1: HDR, LHDR."""
    both = [by_motion(runs, name, "deck_acceleration_max_m_s2") for name in (HDR, LHDR)]
    return rows(np.array([values[:, -1] / values[:, 0] - 1.0 for values in both]))


def energy_in_both_models(runs: Runs) -> Numbers:
    """LHDR, energy at -20 over 23 degC: hybrid pier, which stays elastic; bridge in II-I-1."""
    hybrid = runs.hybrid("shen-lhdr-specimen", AMBIENT).table["bearing_energy_kN_mm"]
    energy = hybrid.to_numpy(dtype=float)
    bridge = by_motion(runs, LHDR, "bearing_energy_kN_mm")[II_I_1]
    return float(energy[-1] / energy[0]), float(bridge[-1] / bridge[0])
