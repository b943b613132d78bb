"""What Shen (2023) says about the hybrid test, as criteria on computed numbers. No tests.

Each criterion has the place in the source, a text of our numbers and whether they agree. Those of
chapter 3 depend on how many bearings the specimen stands for (`benchmarks/bearing_count.py`);
all are used by tests/validation/test_source_hybrid.py and `benchmarks/source_hybrid.py`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

import thermobearing as tb
from thermobearing.core.types import Floats
from thermobearing.cyclic.case import load_rig
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.structure.matrices import find_modes, line_stiffness
from thermobearing.structure.model import Structure, load_structure
from thermobearing.structure.run import prepare_structure

HDR, LHDR = "shen-hdr-specimen", "shen-lhdr-specimen"
AMBIENT = [23.0, 0.0, -20.0]  # [degC]
STIFFNESS = 376.0  # of all bearings, Table 3.5 [kN/mm]
PLAN = 1440.0  # side of a bearing, 3.4.1 [mm]
GRAVITY = 9.80665  # [m/s2]
AGREES = 0.05  # relative, with a printed number
ABOUT = (1.7, 2.3)  # what "approximately twice" may mean
SAME = 0.10  # "no significant difference" of peaks
NEAR = 2.5  # K, of temperatures that a text reads off a figure
SECONDS = (5.0, 10.0, 20.0)  # of the first-layer temperatures of 3.4.4


def structure_with(count: int) -> Structure:
    """The hybrid pier on so many bearings; together they keep the printed linear stiffness."""
    structure = load_structure("hybrid-pier")
    changes = {"count": count, "equivalent_stiffness": STIFFNESS / count}
    line = structure.bearings[0].model_copy(update=changes)
    return structure.model_copy(update={"bearings": [line]})


@dataclass(frozen=True)
class Evidence:
    """Numbers of both specimens in both modes, from 23 to -20 degC."""

    count: int
    result: EarthquakeResult
    table: pd.DataFrame
    stiffness: dict[str, Floats]  # of all bearings at the start [kN/mm]
    periods: dict[str, Floats]  # first, with it [s]

    def rows(self, bearing: str, mode: str, column: str) -> Floats:
        t = self.table
        rows = t[(t["bearing"] == bearing) & (t["mode"] == mode)]
        rows = rows.sort_values("ambient_degC", ascending=False)
        return np.asarray(rows[column], dtype=float)

    def force(self, bearing: str, mode: str) -> Floats:
        """Of the specimen [kN]."""
        return self.rows(bearing, mode, "bearing_force_max_kN")

    def ratio(self, bearing: str, column: str) -> Floats:
        return self.rows(bearing, "rt", column) / self.rows(bearing, "pd", column)

    def energies(self, mode: str) -> Floats:
        column = "bearing_energy_kN_mm"
        return self.rows(LHDR, mode, column) / self.rows(HDR, mode, column)

    def run(self, bearing: str, mode: str, ambient: float) -> int:
        t = self.table
        result = (t["bearing"] == bearing) & (t["mode"] == mode) & (t["ambient_degC"] == ambient)
        return int(t.index[result][0])

    def outer_layer(self) -> Floats:
        """LHDR at -20 degC in real time, at 5, 10, 20 s [degC]."""
        run = self.run(LHDR, "rt", -20.0)
        time = self.result["time"].values[run]
        whole = np.isfinite(time)
        outer = self.result["rubber_temperature"].values[run, :, 0]
        return np.interp(SECONDS, time[whole], outer[whole])

    def rate_share(self, ambient: float, until: float = 2.0) -> float:
        """Largest share of the rate-dependent force in the three parts of the force: LHDR, in the
        first seconds of the pseudo-dynamic test (Fig. 5.15).
        """
        run = self.run(LHDR, "pd", ambient)
        time = self.result["time"].values[run]
        first = (time > 0.0) & (time <= until)
        names = ("viscous_force", "rubber_force", "lead_force")
        parts = np.abs([self.result[name].values[run][first] for name in names])
        return float((parts[0] / parts.sum(axis=0)).max())


def initial_stiffness(bearing: str, ambient: float) -> float:
    """Of one specimen at rest [kN/mm]; so slowly that the rate branch gives nothing."""
    return tb.BearingElement(bearing, ambient).set_trial(1e-9, dt=1e6).tangent


def evidence(count: int, motion: Any = None, **options: Any) -> Evidence:
    """Both specimens, three temperatures, both modes; `options` are those of `tb.hybrid`."""
    structure = structure_with(count)
    lab = {"mode": ["rt", "pd"]}
    result = tb.hybrid(
        None, motion, AMBIENT, structure=structure, laboratory=lab, duration=20.0, **options
    )
    prepared = prepare_structure(structure)
    scale = structure.bearings[0].scale
    stiffness, periods = {}, {}
    for bearing in (HDR, LHDR):
        each = np.array([initial_stiffness(bearing, t) for t in AMBIENT]) / scale
        stiffness[bearing] = count * each
        actual = []
        for k in each:
            line = line_stiffness(structure, prepared.matrices, np.array([k]))
            whole = prepared.matrices.springs + line
            actual.append(find_modes(prepared.matrices.mass, whole).periods[0])
        periods[bearing] = np.array(actual)
    return Evidence(count, result, result.table, stiffness, periods)


@dataclass(frozen=True)
class Criterion:
    """What the source says, what we get, and whether that agrees.

    `hard`: a printed number of the test or a limit of its machine, not a trend.
    """

    what: str
    source: str
    numbers: Callable[[Evidence], str]
    holds: Callable[[Evidence], bool]
    hard: bool = False


def format_values(values: Floats, form: str = ".2f") -> str:
    return " ".join(format(value, form) for value in np.atleast_1d(values))


def damping_ratios(bearing: str, strain: float = 1.75) -> Floats:
    table = tb.run(bearing, tb.cyclic_test(strain=[strain], cycles=3), AMBIENT).cycles
    third = table[table["cycle"] == 3].set_index("ambient_degC")["h_eq"]
    return np.array([third[ambient] for ambient in AMBIENT])


def axial_stress(e: Evidence) -> float:
    """Of the deck on so many bearings [MPa]."""
    deck = next(m for m in load_structure("hybrid-pier").masses if m.body == "deck")
    return deck.mass * 1e6 * GRAVITY / (e.count * PLAN**2)


def colder(values: Floats) -> bool:
    return bool(np.all(np.diff(values) > 0.0))


def pair(quantity: Callable[[str], Floats], form: str = ".2f") -> str:
    return f"{format_values(quantity(HDR), form)}; {format_values(quantity(LHDR), form)}"


PERIOD, STRESS, STRAIN = 1.30, 6.0, 2.5  # Table 3.5 [s], 3.2.2 [MPa], largest of Table 3.4
RIG = load_rig("shen-rig").force or 0.0  # Table 3.2 [kN]
FORCE, ENERGY = "bearing_force_max_kN", "bearing_energy_kN_mm"
DISPLACEMENT, ACCELERATION = "pier_top_displacement_max_mm", "pier_top_acceleration_max_m_s2"


def in_rig(bearing: str, mode: str, name: str) -> Criterion:
    return Criterion(
        f"{name}, {mode.upper()}: force of the specimen [kN]",
        f"rig {RIG:g} (Table 3.2)",
        lambda e: format_values(e.force(bearing, mode), ".0f"),
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
        lambda e: format_values(e.ratio(HDR, FORCE), ".3f"),
        lambda e: bool(np.all(e.ratio(HDR, FORCE)[1:] < 1.0)),
    ),
    Criterion(
        "LHDR: force RT/PD",
        "above 1 at 0, -20 (3.4.3)",
        lambda e: format_values(e.ratio(LHDR, FORCE), ".3f"),
        lambda e: bool(np.all(e.ratio(LHDR, FORCE)[1:] > 1.0)),
    ),
    Criterion(
        "HDR at -20: strain RT/PD",
        "below 1 (3.5)",
        lambda e: format_values(e.ratio(HDR, "bearing_strain_max")[2:], ".3f"),
        lambda e: bool(e.ratio(HDR, "bearing_strain_max")[2] < 1.0),
    ),
    Criterion(
        "LHDR at -20, RT: first layer at 5, 10, 20 s [degC]",
        "about -15, -5, below 0 (3.4.4)",
        lambda e: format_values(e.outer_layer(), ".1f"),
        lambda e: bool(
            np.abs(e.outer_layer()[:2] - [-15.0, -5.0]).max() < NEAR and e.outer_layer()[2] < 0.0
        ),
    ),
    Criterion(
        "energy LHDR/HDR, RT",
        "about 2 (3.4.5)",
        lambda e: format_values(e.energies("rt")),
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
        lambda e: format_values(e.ratio(HDR, DISPLACEMENT)),
        pier_alike,
    ),
    Criterion(
        "LHDR: pier displacement RT/PD",
        "above 1 (3.4.6)",
        lambda e: format_values(e.ratio(LHDR, DISPLACEMENT)),
        lambda e: bool(np.all(e.ratio(LHDR, DISPLACEMENT) > 1.0)),
    ),
]


def score(criteria: list[Criterion], e: Evidence) -> int:
    return sum(criterion.holds(e) for criterion in criteria)
