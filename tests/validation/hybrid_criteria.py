"""The criteria of hybrid_source.py: what chapter 3 prints and reports. No tests.

Numbers stand for 23, 0, -20 degC; where two bearings are meant, HDR; LHDR.
"""

import numpy as np

from tests.validation.hybrid_source import (
    ABOUT,
    AGREES,
    HDR,
    LHDR,
    NEAR,
    SAME,
    STIFFNESS,
    Criterion,
    Evidence,
    axial_stress,
    colder,
    pair,
    told,
)
from thermobearing.cyclic.case import load_rig

PERIOD, STRESS, STRAIN = 1.30, 6.0, 2.5  # Table 3.5 [s], 3.2.2 [MPa], largest of Table 3.4
RIG = load_rig("shen-rig").force or 0.0  # Table 3.2 [kN]
FORCE, ENERGY = "bearing_force_max_kN", "bearing_energy_kN_mm"
DISPLACEMENT, ACCELERATION = "pier_top_displacement_max_mm", "pier_top_acceleration_max_m_s2"


def in_rig(bearing: str, mode: str, name: str) -> Criterion:
    return Criterion(
        f"{name}, {mode.upper()}: force of the specimen [kN]",
        f"rig {RIG:g} (Table 3.2)",
        lambda e: told(e.force(bearing, mode), ".0f"),
        lambda e: bool(e.force(bearing, mode).max() <= RIG),
        hard=True,
    )


def all_periods(e: Evidence) -> np.ndarray:
    return np.concatenate([e.periods[HDR], e.periods[LHDR]])


HARD = [
    Criterion(
        "axial stress of the deck on squares of 1440 mm [MPa]",
        "6 (3.2.2)",
        lambda e: f"{axial_stress(e):.1f}",
        lambda e: abs(axial_stress(e) / STRESS - 1.0) < AGREES,
        hard=True,
    ),
    in_rig(HDR, "rt", "HDR"),
    in_rig(LHDR, "rt", "LHDR"),
    in_rig(HDR, "pd", "HDR"),
    in_rig(LHDR, "pd", "LHDR"),
    Criterion(
        "largest strain, RT [%]; parameters are identified up to 250 %",
        "at most 250 (Table 3.4)",
        lambda e: pair(lambda b: 100.0 * e.rows(b, "rt", "bearing_strain_max"), ".0f"),
        lambda e: max(e.rows(b, "rt", "bearing_strain_max").max() for b in (HDR, LHDR)) <= STRAIN,
        hard=True,
    ),
    Criterion(
        "first period at the start [s], one of them",
        "1.30 (Table 3.5; its own k_1 gives 1.50)",
        lambda e: pair(lambda b: e.periods[b]),
        lambda e: bool(np.abs(all_periods(e) / PERIOD - 1.0).min() < AGREES),
        hard=True,
    ),
    Criterion(
        "initial stiffness of all bearings [kN/mm], within those of one kind",
        "k_1 = 376 (Table 3.5)",
        lambda e: pair(lambda b: e.stiffness[b], ".0f"),
        lambda e: any(k.min() <= STIFFNESS <= k.max() for k in e.stiffness.values()),
        hard=True,
    ),
]


def energy_signs(e: Evidence) -> list[bool]:
    """RT above PD but for HDR at -20 degC."""
    hdr, lhdr = e.ratio(HDR, ENERGY), e.ratio(LHDR, ENERGY)
    return [*(hdr[:2] > 1.0), hdr[2] < 1.0, *(lhdr > 1.0)]


def pier_alike(e: Evidence) -> bool:
    """HDR: real time and pseudo-dynamic within 10 %."""
    return bool(np.abs(e.ratio(HDR, DISPLACEMENT) - 1.0).max() < SAME)


def list_rows(column: str, form: str, factor: float = 1.0) -> "Criterion":
    name = "displacement [mm]" if column == DISPLACEMENT else "acceleration [m/s2]"
    return Criterion(
        f"pier top {name}, RT",
        "higher in the cold (3.4.6)",
        lambda e: pair(lambda b: factor * e.rows(b, "rt", column), form),
        lambda e: all(colder(e.rows(b, "rt", column)) for b in (HDR, LHDR)),
    )


SOFT = [
    Criterion(
        "HDR: force RT/PD",
        "below 1 at 0, -20 (3.4.3)",
        lambda e: told(e.ratio(HDR, FORCE), ".3f"),
        lambda e: bool(np.all(e.ratio(HDR, FORCE)[1:] < 1.0)),
    ),
    Criterion(
        "LHDR: force RT/PD",
        "above 1 at 0, -20 (3.4.3)",
        lambda e: told(e.ratio(LHDR, FORCE), ".3f"),
        lambda e: bool(np.all(e.ratio(LHDR, FORCE)[1:] > 1.0)),
    ),
    Criterion(
        "HDR at -20: strain RT/PD",
        "below 1 (3.5)",
        lambda e: told(e.ratio(HDR, "bearing_strain_max")[2:], ".3f"),
        lambda e: bool(e.ratio(HDR, "bearing_strain_max")[2] < 1.0),
    ),
    Criterion(
        "LHDR at -20, RT: first layer at 5, 10, 20 s [degC]",
        "about -15, -5, below 0 (3.4.4)",
        lambda e: told(e.outer_layer(), ".1f"),
        lambda e: bool(
            np.abs(e.outer_layer()[:2] - [-15.0, -5.0]).max() < NEAR and e.outer_layer()[2] < 0.0
        ),
    ),
    Criterion(
        "energy LHDR/HDR, RT",
        "about 2 (3.4.5)",
        lambda e: told(e.energies("rt")),
        lambda e: bool(np.all((e.energies("rt") > ABOUT[0]) & (e.energies("rt") < ABOUT[1]))),
    ),
    Criterion(
        "energy [kJ], RT",
        "more in the cold (3.4.5)",
        lambda e: pair(lambda b: 1e-3 * e.rows(b, "rt", ENERGY), ".0f"),
        lambda e: all(colder(e.rows(b, "rt", ENERGY)) for b in (HDR, LHDR)),
    ),
    Criterion(
        "energy RT/PD",
        "above 1, but HDR at -20 (3.4.5)",
        lambda e: pair(lambda b: e.ratio(b, ENERGY)),
        lambda e: all(energy_signs(e)),
    ),
    list_rows(DISPLACEMENT, ".0f"),
    list_rows(ACCELERATION, ".1f"),
    Criterion(
        "HDR: pier displacement RT/PD",
        "no difference (3.4.6)",
        lambda e: told(e.ratio(HDR, DISPLACEMENT)),
        pier_alike,
    ),
    Criterion(
        "LHDR: pier displacement RT/PD",
        "above 1 (3.4.6)",
        lambda e: told(e.ratio(LHDR, DISPLACEMENT)),
        lambda e: bool(np.all(e.ratio(LHDR, DISPLACEMENT) > 1.0)),
    ),
]


def score(criteria: list[Criterion], e: Evidence) -> int:
    return sum(criterion.holds(e) for criterion in criteria)
