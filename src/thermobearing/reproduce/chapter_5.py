"""What chapter 5 says, computed: a function for each claim of `data/claims/chapter-5.toml`.

Values at several ambient temperatures stand from warm to cold: 23, 0, -20 degC.
"""

from typing import Any

import numpy as np
import pandas as pd

from thermobearing.core.lead import half_space_factor
from thermobearing.core.types import Floats
from thermobearing.cyclic.protocol import CyclicTest
from thermobearing.cyclic.result import Result
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.model.stack import build_stack
from thermobearing.reproduce.runs import AMBIENT, Runs, full_cycles
from thermobearing.reproduce.values import Numbers, told

LHDR = "shen-lhdr-specimen"
MODES = ("rt", "pd")
KEEP = ("rubber", "cells")
BRANCH_CHANGES = 0.6  # t+ at which Eq. 5.5 goes from one line to the other
LARGEST, SPEED = 2.5, 30.0  # largest strain and rate of Table 3.4 [mm/s]
FIRST_SECONDS = 2.0  # "the beginning" of Fig. 5.15
PROFILE_AT = 20.0  # last of the profiles of Fig. 5.17 [s]
INNERMOST = -1
# Tables 5.1 and 5.2, Fig. 5.2


def characteristic_strength(runs: Runs) -> Numbers:
    """Q_l of one core: yield stress times its area [kN]."""
    lead = runs.bearing(LHDR).lead
    assert lead is not None
    return lead.core_strength


def heat_capacities(runs: Runs) -> Numbers:
    """Rho c of rubber and of lead [MJ/(m3 K)]."""
    materials = runs.bearing(LHDR).materials
    assert materials.lead is not None
    joules = 1e9 / 1e6  # kN mm/(mm3 K) to MJ/(m3 K)
    return (
        materials.rubber.volumetric_heat * joules,
        materials.lead.volumetric_heat * joules,
    )


def diffusivities(runs: Runs) -> Numbers:
    """k/(rho c) of lead, steel and rubber [mm2/s]."""
    materials = runs.bearing(LHDR).materials
    assert materials.lead is not None
    parts = (materials.lead, materials.steel, materials.rubber)
    return tuple(part.conductivity / 1e3 / part.volumetric_heat for part in parts)


def half_height(runs: Runs) -> Numbers:
    """From the end face to the plane of symmetry [mm]."""
    return float(build_stack(runs.bearing(LHDR), half=True).thickness.sum())


def interface_height(runs: Runs) -> Numbers:
    """Of the interface between end and sealing plate above the plane of symmetry [mm]."""
    stack = build_stack(runs.bearing(LHDR), half=True)
    end = np.array([name == "end_plate" for name in stack.part])
    return float(stack.thickness[~end].sum())


def cells(runs: Runs) -> Numbers:
    """Layers of the numerical model in the half height."""
    return float(len(build_stack(runs.bearing(LHDR), half=True).part))


def branches_meet(runs: Runs) -> Numbers:
    """Second line of Eq. 5.5 over the first where they meet."""
    before = half_space_factor(BRANCH_CHANGES * (1.0 - 1e-12))
    return half_space_factor(BRANCH_CHANGES) / before


# 5.4.1, cyclic loading


def _largest(runs: Runs) -> Result:
    """Five cycles of 250 % and a rest of 1.25 h, at three temperatures."""
    cycles = {"step": "cycles", "strain": LARGEST, "wave": "sine", "speed": SPEED, "count": 5}
    test = CyclicTest(steps=[cycles, {"step": "rest", "duration": 4500.0}])
    return runs.cyclic(LHDR, AMBIENT, test, keep=["rubber"])


def _cycles(runs: Runs, column: str) -> Floats:
    """Of the five cycles of 250 %, a row for each temperature."""
    table = _largest(runs).cycles
    return np.array([table[table["ambient_degC"] == at][column] for at in AMBIENT], dtype=float)


def modulus_in_the_cold(runs: Runs) -> Numbers:
    """G_e of the fifth cycle of 250 % [MPa]."""
    return told(_cycles(runs, "G_eq_MPa")[:, 4])


def energy_in_the_cold(runs: Runs) -> Numbers:
    """Area of the fifth loop of 250 % [kN mm]."""
    return told(_cycles(runs, "energy_kN_mm")[:, 4])


def modulus_cycle_by_cycle(runs: Runs) -> Numbers:
    """G_e of cycles 1 to 5 of 250 %, a row for each temperature [MPa]."""
    return [told(row) for row in _cycles(runs, "G_eq_MPa")]


def degradation(runs: Runs) -> Numbers:
    """1 - G_e of the fifth cycle over that of the first, 250 %."""
    found = _cycles(runs, "G_eq_MPa")
    return told(1.0 - found[:, 4] / found[:, 0])


def rate_share_cyclic(runs: Runs) -> Numbers:
    """Largest rate-dependent force over the largest force."""
    result = _largest(runs)
    part = np.abs(result["viscous_force"].values).max(axis=1)
    return told(part / np.abs(result["force"].values).max(axis=1))


def _rises(runs: Runs) -> tuple[Floats, Floats, Floats]:
    """Of lead, third and first layer at the end of the fifth cycle, warm to cold [K]."""
    air = np.array(AMBIENT)
    columns = ("lead_degC", "rubber3_degC", "rubber1_degC")
    lead, third, first = (_cycles(runs, name)[:, 4] - air for name in columns)
    return lead, third, first


def lead_over_rubber(runs: Runs) -> Numbers:
    """Rise of the lead over that of the third layer."""
    lead, third, _ = _rises(runs)
    return told(lead / third)


def third_layer_in_the_cold(runs: Runs) -> Numbers:
    """Rise of the third layer in five cycles of 250 % [K]."""
    return told(_rises(runs)[1])


def third_and_first_layer(runs: Runs) -> Numbers:
    """Rises of the third and of the first layer, a row for each temperature [K]."""
    _, third, first = _rises(runs)
    return [told(row) for row in np.column_stack([third, first])]


def halves(runs: Runs) -> Numbers:
    """After how long half of the rise is gone, third layer and lead, a row each [s]."""
    result = _largest(runs)
    found = []
    for run, air in enumerate(AMBIENT):
        time = result.time(run)
        rest = np.flatnonzero(result["segment"].values[run] == result["segment"].values[run].max())
        clock = time[rest] - time[rest[0]]
        parts = (
            result["rubber_temperature"].values[run, rest, INNERMOST],
            result["lead_temperature"].values[run, rest],
        )
        rows = [clock[np.argmax(part - air < 0.5 * (part[0] - air))] for part in parts]
        found.append(told(np.array(rows)))
    return found


def lead_rise_beside_printed(runs: Runs) -> Numbers:
    """Rise of the lead by default over that of the printed scheme: 250 %, at 0 and -20 degC."""
    test = full_cycles([LARGEST], wave="sine", closing_strain=None)
    air = AMBIENT[1:]
    ends = []
    for scheme in ("conservative", "published"):
        lead = runs.cyclic(LHDR, air, test, scheme=scheme, keep=["rubber"]).cycles
        last = lead[lead["cycle"] == 5].set_index("ambient_degC")["lead_degC"]
        ends.append(np.array([last[at] - at for at in air]))
    return told(ends[0] / ends[1])


# 5.4.2, hybrid simulation


def _hybrid(runs: Runs, **options: Any) -> EarthquakeResult:
    """Both kinds of test at three temperatures, with the profiles."""
    return runs.hybrid(LHDR, AMBIENT, MODES, keep=list(KEEP), **options)


def _rows(result: EarthquakeResult, mode: str) -> pd.DataFrame:
    """Of one kind of test, warm to cold."""
    table = result.table
    return table[table["mode"] == mode].sort_values("ambient_degC", ascending=False)


def _share(result: EarthquakeResult, mode: str, name: str) -> Floats:
    """Largest value of a part of the force over the largest force."""
    found = []
    for run in _rows(result, mode).index:
        force = np.nanmax(np.abs(result["bearing_force"].values[run]))
        found.append(np.nanmax(np.abs(result[name].values[run])) / force)
    return np.array(found)


def rate_share_of_both(runs: Runs) -> Numbers:
    """Share of the rate-dependent force in real time and pseudo-dynamically, a row each."""
    result = _hybrid(runs)
    both = np.array([_share(result, mode, "viscous_force") for mode in MODES])
    return [told(row) for row in both.T]


def rate_share_in_the_cold(runs: Runs) -> Numbers:
    """Share of the rate-dependent force: real time, then pseudo-dynamic, a row each."""
    result = _hybrid(runs)
    return [told(_share(result, mode, "viscous_force")) for mode in MODES]


def rubber_share_in_the_cold(runs: Runs) -> Numbers:
    """Share of the rubber: real time, then pseudo-dynamic, a row each."""
    result = _hybrid(runs)
    return [told(_share(result, mode, "rubber_force")) for mode in MODES]


def rate_share_at_the_beginning(runs: Runs) -> Numbers:
    """Largest share of the rate-dependent force in the three parts, first 2 s, pseudo-dynamic."""
    result = _hybrid(runs)
    found = []
    for run in _rows(result, "pd").index:
        time = result["time"].values[run]
        first = (time > 0.0) & (time <= FIRST_SECONDS)
        names = ("viscous_force", "rubber_force", "lead_force")
        parts = np.abs([result[name].values[run][first] for name in names])
        found.append((parts[0] / parts.sum(axis=0)).max())
    return told(np.array(found))


def _last(runs: Runs, **options: Any) -> tuple[EarthquakeResult, list[int], list[int]]:
    """Real-time tests: result, numbers of the runs, step of each at 20 s."""
    result = _hybrid(runs, **options)
    numbers = [int(run) for run in _rows(result, "rt").index]
    time = result["time"].values
    steps = [int(np.nanargmin(np.abs(time[run] - PROFILE_AT))) for run in numbers]
    return result, numbers, steps


def layers_in_real_time(runs: Runs) -> Numbers:
    """Rises of lead, third and first layer at 20 s, a row for each temperature [K]."""
    result, numbers, steps = _last(runs)
    found = []
    for air, run, step in zip(AMBIENT, numbers, steps, strict=True):
        rubber = result["rubber_temperature"].values[run, step]
        lead = result["lead_temperature"].values[run, step]
        found.append(told(np.array([lead, rubber[INNERMOST], rubber[0]]) - air))
    return found


def saw_teeth(runs: Runs) -> Numbers:
    """Each rubber layer above the coldest steel beside it at 20 s, a row each temperature [K]."""
    result, numbers, steps = _last(runs)
    stack = build_stack(runs.bearing(LHDR), half=True)
    found = []
    for run, step in zip(numbers, steps, strict=True):
        cells = result["temperature"].values[run, step]
        found.append(
            told(
                np.array(
                    [
                        cells[a:b].mean() - min(cells[a - 1], cells[b])
                        for a, b in zip(stack.first_cell, stack.last_cell, strict=True)
                    ]
                )
            )
        )
    return found


def _interface_and_rubber(runs: Runs, **options: Any) -> Numbers:
    """Rises of the steel at 48 mm and of the hottest rubber at 20 s, a row each [K]."""
    result, numbers, steps = _last(runs, **options)
    part = np.array(build_stack(runs.bearing(LHDR), half=True).part)
    at = int(np.flatnonzero(part == "end_plate")[-1])
    found: list[tuple[float, ...]] = []
    for air, run, step in zip(AMBIENT, numbers, steps, strict=True):
        cells = result["temperature"].values[run, step] - air
        found.append((float(cells[at]), float(cells[part == "rubber"].max())))
    return found


def peak_at_the_interface(runs: Runs) -> Numbers:
    """By default."""
    return _interface_and_rubber(runs)


def peak_at_the_interface_as_printed(runs: Runs) -> Numbers:
    """With the printed bookkeeping."""
    return _interface_and_rubber(runs, scheme="published")


def spread_with_the_motion(runs: Runs) -> Numbers:
    """Third layer above the first one at 5, 10 and 20 s at -20 degC in real time [K]."""
    result, numbers, _ = _last(runs)
    run = numbers[-1]
    time = result["time"].values[run]
    known = np.isfinite(time)
    rubber = result["rubber_temperature"].values[run][known]
    spread = rubber[:, INNERMOST] - rubber[:, 0]
    return told(np.interp([5.0, 10.0, 20.0], time[known], spread))
