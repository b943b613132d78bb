"""The live section of a report: its analysis, computed again by the reader's browser."""

import json
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.cyclic.case import Case, make_case
from thermobearing.cyclic.dataset import GIVEN_IN_PYTHON
from thermobearing.cyclic.result import Result
from thermobearing.cyclic.tables import largest_cycles
from thermobearing.earthquake.case import EarthquakeCase, make_earthquake_case
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.run import build_shaking
from thermobearing.live.data import (
    engine_data,
    engine_steps,
    live_module,
    motion_data,
    structure_data,
)
from thermobearing.live.page import live_script, pack
from thermobearing.model.options import build_model
from thermobearing.motions.record import GroundMotion
from thermobearing.quantities.governing import SLACK_KELVIN
from thermobearing.quantities.register import quantity
from thermobearing.quantities.words import degrees, plain
from thermobearing.report.pieces import Live
from thermobearing.results.ranges import SLACK
from thermobearing.structure.run import prepare_structure

# Keys of a case that the engine knows nothing of.
STARTS = ("initial", "initial_lead", "initial_profile", "initial_state", "conditioned")
OF_TESTS = ("ambient_series", *STARTS)
OF_BRIDGES = ("weather", "laboratory", "initial_state", "lines")
MOST_STEPS = 100_000  # of a test, which takes some 0.3 s
MOST_SAMPLES = 25_000  # of all motions, which take some 120 kB
MOST_RUNS = 100  # entries of the menu
CYCLE = {  # columns of `Result.cycles` and names of the engine
    "G_eq_MPa": "G_eq_MPa",
    "K_eq_kN_mm": "stiffness_kN_mm",
    "h_eq": "h_eq",
    "characteristic_strength_kN": "characteristic_strength_kN",
    "energy_kN_mm": "energy_kN_mm",
    "lead_degC": "lead_temperature",
}
PEAKS = {  # columns of `EarthquakeResult.table` and names of the engine
    "bearing_strain_max": "bearing_strain",
    "bearing_force_max_kN": "bearing_force_kN",
    "pier_displacement_max_mm": "pier_displacement_mm",
    "pier_ductility": "pier_ductility",
    "deck_displacement_max_mm": "deck_mm",
    "rubber_max_degC": "layer_temperature_degC",
    "lead_max_degC": "lead_temperature_degC",
}


def live_section(result: Any) -> Live | None:
    """Return the section that computes a result again in an HTML page.

    It is None for analyses that the engine does not have (recorded histories, weather, hybrid
    tests, bilinear bearings, axial forces that act), and where the installation has no kernels for
    web pages.
    """
    try:
        if isinstance(result, Result):
            return _test_section(result)
        if isinstance(result, EarthquakeResult):
            return _bridge_section(result)
    except InputError:  # no module, a step that the engine does not have, or a motion that is gone
        pass
    return None


def _section(runs: Sequence[Mapping[str, Any]], strain: float, **content: Any) -> Live | None:
    """Return the section of some runs, each with the numbers of the report."""
    if not runs:
        return None
    data = {"runs": runs, "strain": strain, "slack": SLACK, **content, "slack_kelvin": SLACK_KELVIN}
    return Live(
        runs=[run["name"] for run in runs],
        strain=strain > 0.0,
        script=live_script("report.js"),
        data=pack(json.dumps(data, separators=(",", ":")).encode()),
        module=pack(live_module()),
    )


def _row(name: str, key: str, words: str = "") -> dict[str, Any]:
    """Return a row of the table: the name that the engine has for a number, and its words."""
    about = quantity(name)
    words = words or f"{about.meaning[:1].upper()}{about.meaning[1:]}"
    return {
        "key": key,
        "label": f"{words} [{about.unit}]" if about.unit else words,
        "factor": about.factor,
        "digits": int(about.form.strip(".f")),
        "ratio": about.unit != "°C",
    }


def _numbers(values: Mapping[str, Any]) -> dict[str, float]:
    """Return the numbers of a run without NaN, which JSON does not have."""
    return {key: float(value) for key, value in values.items() if np.isfinite(value)}


# Tests.


def _test_section(result: Result) -> Live | None:
    table = tomllib.loads(result.dataset.attrs["case"])
    series = any(warning.startswith(GIVEN_IN_PYTHON) for warning in result.warnings)
    if series or not len(result.cycles) or any(key in table for key in OF_TESTS):
        return None
    case = make_case(table, "report")
    steps = engine_steps(case.test)
    options = case.analysis
    if options.model == "bilinear" or options.keep_every > 1 or options.has_axial:
        return None
    if result.dataset["steps"].max() > MOST_STEPS:
        return None
    strain = float(result.cycles["amplitude_strain"].max())
    runs = [_run_of_test(result, case, k) for k in range(min(len(case.ambient), MOST_RUNS))]
    model = build_model(case.bearing, options)
    return _section(
        runs,
        strain,
        test={"dt_s": case.test.dt, "steps": steps},
        rows=_rows_of_test(),
        engine=engine_data([(case.bearing, model)]),
    )


def _run_of_test(result: Result, case: Case, number: int) -> dict[str, Any]:
    ambient = case.ambient[number]
    values = {"force": np.nanmax(np.abs(result["force"].values[number]))}
    cycles = largest_cycles(result.cycles[result.cycles["ambient_degC"] == ambient])
    layers = [name for name in map(str, cycles) if name.startswith("rubber")]
    for cycle_name, place in (("last", -1), ("first", 0))[: len(cycles)]:
        row = cycles.iloc[place]
        values |= {f"{cycle_name}.{key}": row[name] for name, key in CYCLE.items() if name in row}
        values[f"{cycle_name}.layer_temperature"] = row[layers].max()
    name, numbers = degrees([ambient]), _numbers(values)
    return {"name": name, "bearing": case.bearing.name, "ambient": ambient, "numbers": numbers}


def _rows_of_test() -> list[dict[str, Any]]:
    rows = [_row("bearing_force_max_kN", "force", "Largest force")]
    for cycle_name in ("first", "last"):
        for name, key in (CYCLE | {"rubber_degC": "layer_temperature"}).items():
            head = "Warmest layer" if key == "layer_temperature" else quantity(name).head
            rows.append(_row(name, f"{cycle_name}.{key}", f"{head}, {cycle_name} cycle"))
    return rows


# Bridges.


def _bridge_section(result: EarthquakeResult) -> Live | None:
    table = tomllib.loads(result.dataset.attrs["case"])
    if table.get("command") != "bridge" or any(table.get(key) for key in OF_BRIDGES):
        return None
    case = make_earthquake_case(table, "report")
    method, options = case.analysis.method, case.analysis
    if method == "predictor-corrector" or options.model == "bilinear" or case.structure.plan:
        return None
    if options.has_axial:
        return None
    bearings = {bearing.name: bearing for bearing in case.bearings if isinstance(bearing, Bearing)}
    motions = _motions(case)
    models = [(bearing, build_model(bearing, options)) for bearing in bearings.values()]
    prepared = prepare_structure(case.structure, options.mass, options.damping)
    runs: list[dict[str, Any]] = []
    for number, row in enumerate(result.table.to_dict("records")):
        if row["bearing"] in bearings and row["motion"] in motions and len(runs) < MOST_RUNS:
            hottest = {f"{part}_max_degC": t for part, t in result.hottest(number).items()}
            numbers = {key: (row | hottest)[name] for name, key in PEAKS.items()}
            run = {"bearing": row["bearing"], "motion": row["motion"]}
            name = plain(result.run_names[number])
            run |= {"name": name, "ambient": row["ambient_degC"], "numbers": _numbers(numbers)}
            runs.append(run)
    return _section(
        runs,
        0.0,
        rows=[_row(name, key) for name, key in PEAKS.items()],
        factors={name: factor for name, (_, factor) in motions.items()},
        engine=engine_data(models)
        | {
            "structures": {"": structure_data(prepared, options.dt, method)},
            "motions": {name: motion_data(motion) for name, (motion, _) in motions.items()},
        },
    )


def _motions(case: EarthquakeCase) -> dict[str, tuple[GroundMotion, float]]:
    """Return the motions as they were run, with factors, as far as a page has room for them."""
    motions = {}
    room = MOST_SAMPLES
    for number, case_motion in enumerate(case.motions):
        motion = case_motion.load()
        shaking = build_shaking(case, number, motion)
        dt, ground = shaking.dt, shaking.ground
        steps, steps_per_sample = len(ground) - 1, round(motion.dt / dt)  # of a sampling interval
        factor = 1.0
        # Unless it is cut within a sampling interval, the page gets the samples of the motion and
        # its factor: fewer numbers than the ground at every time step.
        if steps % steps_per_sample == 0:
            dt, factor = motion.dt, case_motion.factor
            ground = motion.acceleration[: steps // steps_per_sample + 1]
        room -= len(ground)
        if room >= 0:
            motions[motion.name] = (replace(motion, dt=dt, acceleration=ground), factor)
    return motions
