"""What stands beside the tables of the source where it follows from other numbers.

A function for each such row of `data/printed/tables.toml`, which names it: the numbers of the row,
a column each, None where nothing is printed.
"""

from collections.abc import Sequence

from thermobearing.bearing.bilinear import BilinearBearing, load_bilinear
from thermobearing.bearing.model import Bearing
from thermobearing.cyclic.case import make_case
from thermobearing.cyclic.equivalent import DESIGN_STRAIN, isothermal_cycle
from thermobearing.cyclic.protocol import Cycles
from thermobearing.design.result import source_design
from thermobearing.design.rubber import equivalent_stiffness, load_rubber, shear_modulus
from thermobearing.motions.record import STANDARD_GRAVITY
from thermobearing.reproduce.runs import Runs
from thermobearing.results.metrics import CycleMeasures
from thermobearing.structure.result import examine_structure

Numbers = Sequence[float | None]
SPECIMENS = ("shen-hdr-specimen", "shen-lhdr-specimen")
BRIDGE = ("shen-hdr-bridge", "shen-lhdr-bridge")
BILINEAR = "shen-bilinear-bridge"
# Powers of the scale factor: what the tests have in common, and time in each of them.
LENGTH, FORCE, TIME = 1, 2, (1, 0)


def specimens(runs: Runs) -> list[Bearing]:
    """HDR and LHDR."""
    return [runs.bearing(name) for name in SPECIMENS]


def plan_area(runs: Runs) -> Numbers:
    """A, gross [mm2]."""
    return [bearing.area for bearing in specimens(runs)]


def shims(runs: Runs) -> Numbers:
    """n_s."""
    return [bearing.geometry.rubber_layers - 1 for bearing in specimens(runs)]


def first_shape_factor(runs: Runs) -> Numbers:
    """S_1."""
    return [bearing.geometry.first_shape_factor for bearing in specimens(runs)]


def second_shape_factor(runs: Runs) -> Numbers:
    """S_2."""
    return [bearing.geometry.second_shape_factor for bearing in specimens(runs)]


def modulus_of_rubber(runs: Runs) -> Numbers:
    """G_e of a specimen at the design strain, without heating [MPa]."""
    return [isothermal_cycle(bearing, DESIGN_STRAIN).G_eq_MPa for bearing in specimens(runs)]


def loadings(_runs: Runs) -> list[Cycles]:
    """The amplitudes of the default cyclic test."""
    test = make_case({}, "Table 3.4", bearing=SPECIMENS[0]).test
    return [step for step in test.steps if isinstance(step, Cycles)]


def rubber(runs: Runs) -> float:
    """Total rubber thickness of a specimen [mm]."""
    return runs.bearing(SPECIMENS[0]).total_rubber_thickness


def amplitudes(runs: Runs) -> Numbers:
    """Displacement of each amplitude [mm]."""
    return [step.size(rubber(runs)) for step in loadings(runs)]


def cycle_periods(runs: Runs) -> Numbers:
    """Four quarters of each amplitude [s]."""
    return [4.0 * step.quarters(rubber(runs))[0] for step in loadings(runs)]


def cycle_frequencies(runs: Runs) -> Numbers:
    """One over the period [Hz]."""
    return [1.0 / period for period in cycle_periods(runs) if period]


def loading_rates(runs: Runs) -> Numbers:
    """Amplitude over a quarter of the period [mm/s]."""
    return [step.size(rubber(runs)) / step.quarters(rubber(runs))[0] for step in loadings(runs)]


def cycle_counts(runs: Runs) -> Numbers:
    """Of each amplitude."""
    return [step.count for step in loadings(runs)]


def line_stiffness(runs: Runs) -> Numbers:
    """k_1, of all bearings together [kN/mm]."""
    line = runs.structure("hybrid-pier").bearings[0]
    return [line.count * line.equivalent_stiffness]


def hybrid_period(runs: Runs) -> Numbers:
    """T of the printed masses and stiffnesses [s]."""
    return [float(examine_structure(runs.structure("hybrid-pier")).table["period_s"].iloc[0])]


def power_of_length(_runs: Runs) -> Numbers:
    """L in the pseudo-dynamic and in the real-time test."""
    return [LENGTH for _ in TIME]


def power_of_time(_runs: Runs) -> Numbers:
    """T."""
    return list(TIME)


def power_of_force(_runs: Runs) -> Numbers:
    """M L/T^2, from which that of mass follows."""
    return [FORCE for _ in TIME]


def power_of_mass(_runs: Runs) -> Numbers:
    """Force over acceleration."""
    return [FORCE - LENGTH + 2 * time for time in TIME]


def power_of_strain_rate(_runs: Runs) -> Numbers:
    """1/T."""
    return [-time for time in TIME]


def power_of_velocity(_runs: Runs) -> Numbers:
    """L/T."""
    return [LENGTH - time for time in TIME]


def power_of_acceleration(_runs: Runs) -> Numbers:
    """L/T^2."""
    return [LENGTH - 2 * time for time in TIME]


def side_film(runs: Runs) -> Numbers:
    """Of the sides of steel and rubber [W/(m2 K)]."""
    film = runs.bearing(SPECIMENS[0]).materials.side_film
    return [film, film]


def core_strength(runs: Runs) -> Numbers:
    """Q_l of one core [kN]."""
    lead = runs.bearing(SPECIMENS[1]).lead
    return [lead.core_strength if lead else None]


def bridge(runs: Runs) -> list[Bearing]:
    """The layered bearings of the bridge."""
    return [runs.bearing(name) for name in BRIDGE]


def bilinear() -> BilinearBearing:
    """The bearing that the bridge was designed with."""
    return load_bilinear(BILINEAR)


def bridge_areas(runs: Runs) -> Numbers:
    """A_e [mm2]."""
    side = source_design()["bearing"]["side_mm"]
    return [side**2, *(bearing.area for bearing in bridge(runs))]


def bridge_rubber(runs: Runs) -> Numbers:
    """Total rubber thickness [mm]."""
    layered = (bearing.total_rubber_thickness for bearing in bridge(runs))
    return [bilinear().total_rubber_thickness, *layered]


def bridge_stress(runs: Runs) -> Numbers:
    """Of the deck's share of one bearing on its plan [MPa]."""
    pier = runs.structure("pier-p1")
    deck = sum(mass.mass for mass in pier.masses if mass.body == pier.report.deck)
    newton = 1e3 * deck * STANDARD_GRAVITY / pier.bearings[0].count
    return [newton / area for area in bridge_areas(runs) if area]


def _design_loops(runs: Runs) -> list[CycleMeasures]:
    """Of the layered bearings at the design displacement, without heating."""
    end = source_design()["bearing"]["u_B_mm"]
    return [isothermal_cycle(b, end / b.total_rubber_thickness) for b in bridge(runs)]


def bridge_modulus(runs: Runs) -> Numbers:
    """G_e of rubber G8 and of the layered bearings at the design displacement [MPa]."""
    end = source_design()["bearing"]["u_B_mm"]
    designed = shear_modulus(load_rubber("G8"), end / bilinear().total_rubber_thickness)
    return [designed, *(loop.G_eq_MPa for loop in _design_loops(runs))]


def bridge_stiffness(runs: Runs) -> Numbers:
    """K_B by Eq. 6.1, and of the layered bearings [kN/mm]."""
    design = source_design()["bearing"]
    of_g8 = equivalent_stiffness(
        load_rubber("G8"),
        design["side_mm"] ** 2,
        bilinear().total_rubber_thickness,
        design["u_B_mm"],
    )
    return [of_g8, *(loop.stiffness_kN_mm for loop in _design_loops(runs))]


def bridge_cores(runs: Runs) -> Numbers:
    """n_l."""
    return [None, *(bearing.lead.cores if bearing.lead else None for bearing in bridge(runs))]


def bridge_core_diameter(runs: Runs) -> Numbers:
    """d_l [mm]."""
    return [None, *(bearing.lead.diameter if bearing.lead else None for bearing in bridge(runs))]


def bilinear_ratio(_runs: Runs) -> Numbers:
    """K_2/K_1."""
    return [bilinear().post_yield_stiffness / bilinear().initial_stiffness]


def bilinear_yield_force(runs: Runs) -> Numbers:
    """Q_y = Q_d/(1 - alpha) [kN]."""
    return [bilinear().strength / (1.0 - (ratio or 0.0)) for ratio in bilinear_ratio(runs)]


def bilinear_yield_displacement(_runs: Runs) -> Numbers:
    """u_y = Q_d/(K_1 - K_2) [mm]."""
    b = bilinear()
    return [b.strength / (b.initial_stiffness - b.post_yield_stiffness)]


def design_displacement(_runs: Runs) -> Numbers:
    """u_B [mm]."""
    return [source_design()["bearing"]["u_B_mm"]]


def bilinear_stiffness(runs: Runs) -> Numbers:
    """(Q_d + K_2 u_B)/u_B [kN/mm]."""
    b = bilinear()
    return [b.strength / end + b.post_yield_stiffness for end in design_displacement(runs) if end]
