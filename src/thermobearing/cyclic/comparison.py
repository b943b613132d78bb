"""How far simpler models, and too few heat cells, are from a reference on the same test.

The simpler models may have one temperature for all layers, or none that changes; outer and inner
layer of each are compared with those of the reference at the times of the reference. The error of
the cells of a layer is Richardson's estimate from twice as many.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from thermobearing.bearing.model import Bearing
from thermobearing.border.lazy import pd
from thermobearing.core.records import Floats
from thermobearing.cyclic.case import Case
from thermobearing.cyclic.protocol import CORNERS, Cycles, CyclicTest, PlanePath, Recorded
from thermobearing.cyclic.result import Result
from thermobearing.cyclic.run import run, run_case
from thermobearing.model.earlier import models_that_fit
from thermobearing.results.selection import force_differences, more, temperature_differences

STRAIN, PERIOD, COUNT, AMBIENT = 1.75, 4.0, 5, -20.0  # of the reference test; s, degC
REFERENCE = f"{COUNT} sine cycles of {100 * STRAIN:g} %, {PERIOD:g} s, {AMBIENT:g} degC"
FINER = 2  # times as many cells in layers and shims
RICHARDSON = FINER**2 / (FINER**2 - 1)  # of the difference, for a scheme of second order
TOLERABLE = 0.01  # of stiffness and energy: specimens of one make differ by 10 %
MOST_CELLS = 1000  # in a layer
LEAST_DAMPING = 1e-3  # h_eq below which the energy is negligible: linear rubber


def compare_models(case: Case) -> dict[str, Result]:
    """Return the results of a test by model, the multi-layer one first.

    All models run it with the conservative scheme and automatic stack. A test in a plane is
    compared with the one on a line of equal amplitude and period instead.
    """
    if case.test.in_plane:
        line = test_on_line(case.test, case.bearing.total_rubber_thickness)
        cases = {"plane": case, "line": case.model_copy(update={"test": line})}
        return {name: run_case(variant) for name, variant in cases.items()}
    results_by_model: dict[str, Result] = {}
    changes = {"scheme": "conservative", "stack": "auto"}
    for model in models_that_fit(case.bearing):
        analysis = case.analysis.model_copy(update=changes | {"model": model})
        results_by_model[model] = run_case(case.model_copy(update={"analysis": analysis}))
    return results_by_model


def test_on_line(test: CyclicTest, total_rubber_thickness: float) -> CyclicTest:
    """Return the test on a line that has the amplitudes along x and the periods of a test.

    Turns become sine cycles, those of a square and a cruciform triangular ones; of recordings the
    motion along x is left. The rubber thickness is in mm.
    """
    steps: list[Any] = []
    for step in test.steps:
        if isinstance(step, PlanePath):
            wave = "triangular" if step.path in CORNERS else "sine"
            period = step.turn_duration(total_rubber_thickness)
            size = {"strain": step.strain, "amplitude": step.amplitude}
            steps.append(Cycles(wave=wave, period=period, count=step.count, **size))
        elif isinstance(step, Recorded):
            steps.append(step.model_copy(update={"column_y": None, "displacement_y_mm": None}))
        else:
            steps.append(step)
    return CyclicTest(name=f"{test.name}, on a line", dt=test.dt, steps=steps)


def _line_rises(plane: Result, line: Result) -> list[dict[str, Any]]:
    """Return the rises of temperature in a plane and on a line, a row for each run and part."""
    rows = []
    for number, ambient in enumerate(plane["ambient"].values):
        for place in compared_places(plane):
            rises = []
            for result in (plane, line):
                values = _temperatures(result, number, place)
                rises.append(float(np.nanmax(values) - values[0]))
            row = {"ambient_degC": float(ambient), "part": place, "rise_K": rises[0]}
            rows.append(row | {"line_rise_K": rises[1], "rise_ratio": rises[0] / rises[1]})
    return rows


def comparison_table(results: Mapping[str, Result]) -> "pd.DataFrame":
    """Return the errors of each model against the first, a row per ambient temperature and model.

    Over the loadings: root mean square and largest temperature error of the outer layer, the inner
    layer and the lead [K]; root mean square force error [% of the peak]; error of G_e, h_eq and
    energy of the last cycle and of the peak force [%]. A model whose run ended early, which its
    outcome says, is compared as far as it got. Of a test in a plane and the one on a line: the
    largest rise of temperature at each of these places [K], and their ratio.
    """
    if "line" in results:
        return pd.DataFrame(_line_rises(results["plane"], results["line"]))
    (_, reference), *models = results.items()
    runs = range(reference.dataset.sizes["ambient"])
    return pd.DataFrame(
        [_errors(reference, result, name, k) for k in runs for name, result in models]
    )


def _errors(reference: Result, result: Result, name: str, run: int) -> dict[str, Any]:
    ambient = float(reference["ambient"].values[run])
    row: dict[str, Any] = {"ambient_degC": ambient, "model": name}
    row["outcome"] = str(result["outcome"].values[run])
    cycles = [r.cycles[r.cycles["ambient_degC"] == ambient] for r in (result, reference)]
    if cycles[0].empty:  # nothing to compare
        return row
    # Temperatures are compared while the bearing is loaded, as far as both runs got.
    computed_steps = np.isfinite(result["force"].values[run])
    moving = np.array([step["kind"] != "rest" for step in reference.segments])
    segment = reference["segment"].values[run]
    loaded = np.flatnonzero((segment >= 0) & moving[np.maximum(segment, 0)])
    loaded = loaded[loaded < len(computed_steps)]
    loaded = loaded[computed_steps[loaded]]
    for place in compared_places(reference):
        computed, expected = (_temperatures(r, run, place)[loaded] for r in (result, reference))
        row |= temperature_differences(place, computed, expected)
    row |= force_differences(*(r["force"].values[run, loaded] for r in (result, reference)))
    last = [table.iloc[len(cycles[0]) - 1] for table in cycles]
    for column, label in (("G_eq_MPa", "G_e"), ("h_eq", "h_eq"), ("energy_kN_mm", "energy")):
        row[f"last {label} %"] = more(last[0][column], last[1][column])
    return row


def compared_places(result: Result) -> list[str]:
    """Return where temperatures are compared."""
    return ["outer layer", "inner layer", *(["lead"] if result.has_lead else [])]


def _temperatures(result: Result, run: int, place: str) -> Floats:
    """Return the temperature at one of `compared_places` at all kept steps [degC]."""
    if place == "lead":
        return np.asarray(result["lead_temperature"].values[run])
    values = result["rubber_temperature"].values[run]
    half = bool(result.dataset.attrs["half_stack"])
    inner = values.shape[1] - 1 if half else values.shape[1] // 2
    return np.asarray(values[:, 0 if place == "outer layer" else inner])


@dataclass(frozen=True)
class CellsError:
    """What too few cells do to the last cycle of the reference test; signs as they are."""

    stiffness: float  # of G_eq, relative
    energy: float  # of the cycle, relative
    warming: float  # of the rise of the hottest layer [K]
    rise: float  # that rise, with many cells [K]
    cells: int  # in a rubber layer

    @property
    def worst(self) -> float:
        """The larger of stiffness and energy, without sign."""
        return max(abs(self.stiffness), abs(self.energy))

    @property
    def advised(self) -> int:
        """Even number of cells in a rubber layer that would be enough."""
        needed = self.cells * math.sqrt(self.worst / TOLERABLE)
        return min(MOST_CELLS, max(self.cells, 2 * math.ceil(0.5 * needed)))


def cells_error(bearing: Bearing) -> CellsError | None:
    """Estimate the error of a bearing's cells in layers and shims, from twice as many.

    None where the reference test does not run to its end.
    """
    cells = bearing.cells
    finer_cells = {"rubber": FINER * cells.rubber, "shim": FINER * cells.shim}
    finer = bearing.model_copy(update={"cells": cells.model_copy(update=finer_cells)})
    step = {"step": "cycles", "strain": STRAIN, "wave": "sine", "period": PERIOD, "count": COUNT}
    test = CyclicTest(dt=0.005, steps=[step])
    coarse_result, fine_result = (run(variant, test, AMBIENT) for variant in (bearing, finer))
    if coarse_result.outcome != "completed" or fine_result.outcome != "completed":
        return None
    coarse, fine = _last_cycle(coarse_result), _last_cycle(fine_result)
    least_loss = LEAST_DAMPING * fine.modulus
    rise = fine.hottest - AMBIENT
    return CellsError(
        stiffness=RICHARDSON * (coarse.modulus - fine.modulus) / fine.modulus,
        energy=RICHARDSON * (coarse.loss - fine.loss) / max(fine.loss, least_loss),
        warming=RICHARDSON * (coarse.hottest - fine.hottest),
        # Extrapolated from twice as many cells to many: a third of the change remains.
        rise=rise + (RICHARDSON - 1.0) * (fine.hottest - coarse.hottest),
        cells=cells.rubber,
    )


class _LastCycle(NamedTuple):
    modulus: float  # G_eq [MPa]
    loss: float  # G_eq h_eq [MPa]
    hottest: float  # layer at the end [degC]


def _last_cycle(result: Result) -> _LastCycle:
    modulus, damping = (float(result.cycles[name].iloc[-1]) for name in ("G_eq_MPa", "h_eq"))
    hottest = float(result["rubber_temperature"].values[0, -1].max())
    return _LastCycle(modulus, modulus * damping, hottest)
