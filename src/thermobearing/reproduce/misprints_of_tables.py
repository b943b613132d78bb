"""What tables and words of the print have wrong, computed: functions of `misprints.toml`."""

import math

from thermobearing.bearing.model import Bearing
from thermobearing.cyclic.equivalent import isothermal_cycle
from thermobearing.design.rubber import load_rubber
from thermobearing.reproduce.chapter_6 import GRAVITY, HDR, NOMINAL
from thermobearing.reproduce.printed import printed
from thermobearing.reproduce.runs import AMBIENT, Runs
from thermobearing.reproduce.values import Numbers

SPECIMENS = ("shen-hdr-specimen", "shen-lhdr-specimen")
HYBRID_PIER = "hybrid-pier"


def equivalent_stiffness_6_3(runs: Runs) -> Numbers:
    """(Q_d + K_2 u_B)/u_B of Table 6.3 [kN/mm]."""
    displacement = printed(runs, "u_B")
    return (printed(runs, "Q_d") + printed(runs, "K_2") * displacement) / displacement


def stiffness_6_4(runs: Runs) -> Numbers:
    """K_eq at 178 mm of the HDR bridge bearing with K_r as Table 6.4 prints it [N/mm]."""
    bearing = runs.bearing(HDR)
    law = {"layer_stiffness": printed(runs, "K_r_table_6_4")}
    soft = bearing.model_copy(update={"hysteresis": bearing.hysteresis.model_copy(update=law)})
    strain = printed(runs, "u_B") / bearing.total_rubber_thickness
    return 1e3 * isothermal_cycle(soft, strain).stiffness_kN_mm


def _swapped(bearing: Bearing) -> Bearing:
    law = bearing.hysteresis
    update = {
        "elastic_temperature_coefficient": law.hysteretic_temperature_coefficient,
        "hysteretic_temperature_coefficient": law.elastic_temperature_coefficient,
    }
    return bearing.model_copy(update={"hysteresis": law.model_copy(update=update)})


def damping_of_swapped(runs: Runs) -> Numbers:
    """h_eq of the HDR bridge bearing with m_T and n_T exchanged, 175 %, no heating."""
    bearing = _swapped(runs.bearing(HDR))
    return tuple(isothermal_cycle(bearing, NOMINAL, temperature=at).h_eq for at in AMBIENT)


def damping_of_g12(runs: Runs) -> Numbers:
    """h_B of G12 at 50 to 250 % with d_1 as Table A.2 prints it."""
    d_0, _, d_2 = load_rubber("G12").damping_ratio
    d_1 = printed(runs, "d_1_G12")
    return tuple(d_0 + d_1 * x + d_2 * x**2 for x in (0.5, 1.0, 1.5, 2.0, 2.5))


def degrees_of_damping(runs: Runs) -> Numbers:
    """Highest powers of h_B in Table A.2: HDR, HDR-S."""
    return tuple(float(len(load_rubber("G8", kind).damping_ratio) - 1) for kind in ("HDR", "HDR-S"))


def degrees_of_moduli(runs: Runs) -> Numbers:
    """Highest powers of G_e in Table A.1: HDR, HDR-S."""
    return tuple(float(len(load_rubber("G8", kind).shear_modulus) - 1) for kind in ("HDR", "HDR-S"))


def contribution_rates(runs: Runs) -> Numbers:
    """R2 of Table 4.2."""
    return tuple(printed(runs, name) for name in ("R2_warm", "R2_zero", "R2_cold"))


def _stress(runs: Runs, count: float) -> float:
    deck = next(m.mass for m in runs.structure(HYBRID_PIER).masses if m.body == "deck")
    return deck * 1e6 * GRAVITY / (count * printed(runs, "prototype_side") ** 2)


def stress_on_two(runs: Runs) -> Numbers:
    """Deck of Table 3.5 on the two bearings of 3.4.1 [MPa]."""
    return _stress(runs, printed(runs, "bearings_of_the_model"))


def stress_on_eight(runs: Runs) -> Numbers:
    """On the eight of the bridge [MPa]."""
    return _stress(runs, printed(runs, "bearings_of_the_bridge"))


def piers_of_six_spans(runs: Runs) -> Numbers:
    """Piers between six spans."""
    return printed(runs, "spans_in_the_lead") - 1.0


def peak_speed(runs: Runs) -> Numbers:
    """Largest speed of a sine of the periods of Table 3.4, over its "constant rate"."""
    return 0.5 * math.pi
