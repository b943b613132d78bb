"""What chapter 6 and the appendix say of design, computed: functions of `chapter-6.toml`.

What the bridge does in earthquakes is in `bridge_claims`.
"""

import numpy as np

from thermobearing.bearing.model import Bearing
from thermobearing.cyclic.equivalent import isothermal_cycle, solve_backbone
from thermobearing.design.rubber import Kind, damping_ratio, load_rubber, shear_modulus
from thermobearing.reproduce.printed import printed
from thermobearing.reproduce.runs import AMBIENT, Runs
from thermobearing.reproduce.values import Numbers, told
from thermobearing.structure.run import prepare_structure

HDR, LHDR, PIER = "shen-hdr-bridge", "shen-lhdr-bridge", "pier-p1"
NAMES = ("G8", "G10", "G12")
GRAVITY = 9.80665  # [m/s2]
NOMINAL = 1.75  # strain at which a rubber's name is its modulus
STRAINS = (0.5, 1.0, 1.5, 2.0, 2.5)  # of the design curves
# Design, Tables 6.1 and 6.3, Fig. 6.3


def equivalent_stiffness(runs: Runs) -> Numbers:
    """K_B of G8 by Eq. 6.1 and 6.2 at the design displacement [N/mm]."""
    area, thickness = printed(runs, "A_e"), printed(runs, "t_e")
    return shear_modulus(load_rubber("G8"), printed(runs, "u_B") / thickness) * area / thickness


def compressive_stresses(runs: Runs) -> Numbers:
    """Deck on five bearings: on 600 mm and on 480 mm squares [MPa]."""
    structure = runs.structure(PIER)
    deck = next(item.mass for item in structure.masses if item.body == "deck")
    newton = deck * 1e6 * GRAVITY / structure.bearings[0].count
    return newton / printed(runs, "A_e"), newton / printed(runs, "A_MTBW")


def _secant(runs: Runs, bearing: Bearing) -> float:
    """K_eq at the design displacement, 23 degC, no heating [kN/mm]."""
    strain = printed(runs, "u_B") / bearing.total_rubber_thickness
    return isothermal_cycle(bearing, strain).stiffness_kN_mm


def equivalent_stiffness_hdr(runs: Runs) -> Numbers:
    """Of the layered HDR bearing at 178 mm and 23 degC [N/mm]."""
    return 1e3 * _secant(runs, runs.bearing(HDR))


def equivalent_stiffness_lhdr(runs: Runs) -> Numbers:
    """Of the LHDR bearing, without its rate-dependent branch [N/mm]."""
    bearing = runs.bearing(LHDR)
    return 1e3 * _secant(runs, bearing.model_copy(update={"rate": None}))


def bilinear_of_g8(runs: Runs) -> Numbers:
    """Q_d [kN], K_1, K_2 [kN/mm] of Fig. 6.3 from K_B, h_B and K_2/K_1 of Table 6.3."""
    strain = printed(runs, "u_B") / printed(runs, "t_e")
    stiffness = float(np.asarray(equivalent_stiffness(runs))) / 1e3
    damping = damping_ratio(load_rubber("G8"), strain)
    ratio = printed(runs, "K_2") / printed(runs, "K_1")
    found = solve_backbone(stiffness, damping, printed(runs, "u_B"), ratio)
    if found is None:
        return float("nan")
    return found.strength, found.initial, found.post_yield


def stiffness_ratio(runs: Runs) -> Numbers:
    """K_2/K_1 of Table 6.3."""
    return printed(runs, "K_2") / printed(runs, "K_1")


def yield_force(runs: Runs) -> Numbers:
    """Q_d/(1 - K_2/K_1) of Table 6.3 [kN]."""
    return printed(runs, "Q_d") / (1.0 - printed(runs, "K_2") / printed(runs, "K_1"))


def yield_displacement(runs: Runs) -> Numbers:
    """Q_d/(K_1 - K_2) of Table 6.3 [mm]."""
    return printed(runs, "Q_d") / (printed(runs, "K_1") - printed(runs, "K_2"))


def modulus_in_the_cold(runs: Runs) -> Numbers:
    """K_eq of both bridge bearings at 175 %, third cycle without heating, a row each [kN/mm]."""
    return [
        tuple(
            isothermal_cycle(runs.bearing(name), NOMINAL, temperature=at).stiffness_kN_mm
            for at in AMBIENT
        )
        for name in (HDR, LHDR)
    ]


def damping_in_the_cold(runs: Runs) -> Numbers:
    """h_eq of the same, a row each."""
    return [
        tuple(isothermal_cycle(runs.bearing(name), NOMINAL, temperature=at).h_eq for at in AMBIENT)
        for name in (HDR, LHDR)
    ]


def more_damping_with_lead(runs: Runs) -> Numbers:
    """h_eq at 23 degC and 175 %: LHDR, HDR."""
    return tuple(isothermal_cycle(runs.bearing(name), NOMINAL).h_eq for name in (LHDR, HDR))


# The model of the bridge, Table 6.2


def first_period(runs: Runs) -> Numbers:
    """With the masses as Eq. 6.4-6.7 print them [s]."""
    return float(prepare_structure(runs.structure(PIER), "published").modes.periods[0])


def pier_height(runs: Runs) -> Numbers:
    """Top of the pier above the underside of the footing [m]."""
    structure = runs.structure(PIER)
    top = structure.bearings[0].height
    return (top - min(body.base_height or 0.0 for body in structure.bodies)) / 1e3


# Appendix A


def ratios_of_moduli(runs: Runs) -> Numbers:
    """Coefficients of G10 and G12 over 1.25 and 1.5 of those of G8, HDR (Table A.1)."""
    first, *others = (np.array(load_rubber(name).shear_modulus) for name in NAMES)
    return [told(each / first / size) for each, size in zip(others, (1.25, 1.5), strict=True)]


def nominal_moduli(runs: Runs) -> Numbers:
    """G_e at 175 % of G8, G10, G12, HDR [MPa]."""
    return tuple(shear_modulus(load_rubber(name), NOMINAL) for name in NAMES)


def nominal_moduli_of_super(runs: Runs) -> Numbers:
    """The same of HDR-S."""
    return tuple(shear_modulus(load_rubber(name, "HDR-S"), NOMINAL) for name in NAMES)


def order_of_damping(runs: Runs) -> Numbers:
    """h_B of G8, G10, G12 at 50 to 250 %, a row for each strain (G12 with d_1 mended)."""
    return [tuple(damping_ratio(load_rubber(name), strain) for name in NAMES) for strain in STRAINS]


def softening_of_curves(runs: Runs) -> Numbers:
    """G_e of all six rubbers at 50, 100 and 150 %, a row each [MPa]."""
    both: tuple[Kind, ...] = ("HDR", "HDR-S")
    kinds = [(name, kind) for kind in both for name in NAMES]
    return [
        tuple(shear_modulus(load_rubber(name, kind), strain) for strain in STRAINS[:3])
        for name, kind in kinds
    ]
