"""Temperature factors of a bearing, and the effect of its size."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.scaling import resized
from thermobearing.bearing.undecided import RATE, band, rate_alternatives
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, nearest
from thermobearing.border.lazy import pd
from thermobearing.border.units import is_number, one_or_several
from thermobearing.cyclic.protocol import CyclicTest
from thermobearing.cyclic.result import Result, run_name
from thermobearing.cyclic.run import run
from thermobearing.results.ranges import Row, extrapolation, limits_passed, widened

TEMPERATURES = tuple(float(t) for t in range(-40, 41, 10))
STRAINS = (1.0, 1.75)
PERIOD = 2.0  # of the sine [s]
QUANTITIES = {  # name: unit
    "K_eq": "kN/mm",
    "Q_d": "kN",
    "K_d": "kN/mm",
    "h_eq": "1",
    "energy": "kN mm",
}
# Which cycles count. "3": ISO 22762-1, EN 15129 (third of three); "2-11": repeated tests; the
# assignment to standards is from memory and unverified.
PRESETS: dict[str, tuple[int, ...]] = {
    "3": (3,),
    "1-3": (1, 2, 3),
    "2-11": tuple(range(2, 12)),
    "all-but-first": tuple(range(2, 6)),
}
QUANTILES = (0.05, 0.95)
COLDEST, HOTTEST = -60.0, 60.0
MOST_CYCLES = 100


def _chosen_cycles(cycles: str | int | Sequence[int]) -> tuple[int, ...]:
    """Return numbers of the cycles of a preset or a list, from 1."""
    if isinstance(cycles, str):
        if cycles not in PRESETS:
            raise InputError(f'cycles = "{cycles}"{nearest(cycles, list(PRESETS))}')
        return PRESETS[cycles]
    numbers = one_or_several(cycles)
    if not numbers or not all(
        isinstance(n, int | np.integer) and 1 <= n <= MOST_CYCLES for n in numbers
    ):
        raise InputError(f"cycles = {numbers}: give integers from 1 to {MOST_CYCLES}")
    return tuple(sorted({int(n) for n in numbers}))


@checked
def temperature_factors(
    bearing: Bearing | str | Path | Sequence[Bearing | str | Path],
    *,
    reference_temperature: float,
    temperatures: float | Sequence[float] = TEMPERATURES,
    strains: float | Sequence[float] = STRAINS,
    period: float = PERIOD,
    cycles: str | int | Sequence[int] = "1-3",
    **options: Any,
) -> "pd.DataFrame":
    """Return K_eq, Q_d, K_d, h_eq and energy relative to those at a reference temperature.

    The coupled model runs sine cycles from a soaked state at each temperature. Basis "first" is the
    first cycle, in which rubber and lead already heat up; "heated" the last of the chosen cycles,
    with self-heating until then; "mean" the mean over the chosen cycles. Every factor is relative
    to the same basis at the reference temperature.

    Parameters
    ----------
    bearing : one bearing (a Bearing, a library name, or a TOML file); or several of one kind, such
        as samples of a posterior: the first gives the values, all of them the band between the 5
        and 95 % quantiles.
    reference_temperature : [degC], in [-60, 60]; there is no default.
    temperatures : [degC], in [-60, 60].
    strains : shear strain amplitudes, in [0.1, 3].
    period : of the sine [s], in [0.2, 1000].
    cycles : "3", "1-3", "2-11", "all-but-first" (of five), or numbers.
    options : of `run`: model, state, ...; with the conditioning of an `InitialState` as `initial`
        each temperature is that of a chamber in which the bearing was for so long before the test.

    Returns
    -------
    DataFrame : strain, basis, ambient_degC, quantity, unit, value, factor, factor_low,
        factor_high (these two NaN for one bearing), beyond_tested (quantities outside the
        calibration range of the first). With lead cores its `attrs["lead_rises"]` are rows of
        strain, ambient_degC and lead_rise_K, of the first bearing in its first cycle.

    Raises
    ------
    InputError : anything out of range; an analysis that did not complete.

    Examples
    --------
    >>> table = temperature_factors(
    ...     "shen-hdr-bridge", reference_temperature=23, temperatures=[-20], strains=[1.75]
    ... )
    >>> first = table.query("basis == 'first' and quantity == 'K_eq' and ambient_degC == -20")
    >>> bool(first["factor"].iloc[0] > 1.5)
    True
    """
    several = bearing if isinstance(bearing, list | tuple) else [bearing]
    bearings = [as_bearing(item) for item in several]
    numbers = _chosen_cycles(cycles)
    temperatures, strains = one_or_several(temperatures), one_or_several(strains)
    _check(bearings, reference_temperature, temperatures, strains, period)
    # 0.0 added to -0.0 is 0.0, as which it is labelled.
    ambient = list(dict.fromkeys(float(t) + 0.0 for t in (reference_temperature, *temperatures)))
    parts = [
        [_measured(item, ambient, strain, period, numbers, options) for strain in strains]
        for item in bearings
    ]
    tested = [row for table in parts[0] for row in table.attrs["tested_range"]]
    lead_rises = [row for table in parts[0] for row in table.attrs["lead_rises"]]
    tables = [pd.concat(strain_parts) for strain_parts in parts]
    keys = ["strain", "basis", "ambient_degC", "quantity"]
    # Each bearing is divided by its own value at the reference temperature, so that the band is
    # that of the factors and not of the values.
    for number, table in enumerate(tables):
        at_reference = table["ambient_degC"] == reference_temperature
        base = table[at_reference].set_index(["strain", "basis", "quantity"])["value"]
        index = pd.MultiIndex.from_frame(table[["strain", "basis", "quantity"]])
        table["factor"] = table["value"].to_numpy() / base.loc[index].to_numpy()
        tables[number] = table.set_index(keys)
    factors = tables[0].copy()
    low = high = np.full(len(factors), np.nan)
    if len(tables) > 1:  # one bearing has no band
        sample_factors = np.array(
            [table.loc[factors.index, "factor"].to_numpy() for table in tables]
        )
        low, high = np.quantile(sample_factors, QUANTILES, axis=0)
    factors["factor_low"], factors["factor_high"] = low, high
    factors = factors.reset_index().sort_values(
        ["strain", "quantity", "basis", "ambient_degC"], ignore_index=True
    )
    factors.attrs["lead_rises"] = lead_rises
    return _with_extrapolated_bands(_with_tested(factors, tested), tested)


def _with_extrapolated_bands(table: "pd.DataFrame", tested: list[Row]) -> "pd.DataFrame":
    """Return factors whose bands are wider at ambient temperatures outside the tests.

    Strain and rate change both values of a factor, and most of their error cancels.
    """
    by_run: dict[str, list[Row]] = {}
    for row in tested:
        by_run.setdefault(str(row["run"]), []).append(row)
    pairs = zip(table["strain"], table["ambient_degC"], strict=True)
    runs = [by_run.get(_run_label(float(strain), float(ambient)), []) for strain, ambient in pairs]
    extrapolated = np.array([extrapolation(rows, only=("ambient",)) for rows in runs])
    low, high, middle = (table[f"factor{end}"].to_numpy() for end in ("_low", "_high", ""))
    table["factor_low"], table["factor_high"] = widened(
        low, high, middle, extrapolated, QUANTILES[1]
    )
    return table


def factors_at_speed(
    bearings: Sequence[Bearing], *, speed: float, strains: Sequence[float], **options: Any
) -> "pd.DataFrame":
    """Return `temperature_factors` with the period 4 a/v of each strain from a speed v [mm/s]."""
    if not speed > 0.0:
        raise InputError(f"speed = {speed:g}: must be greater than 0")
    rubber = bearings[0].total_rubber_thickness
    parts = [
        temperature_factors(bearings, strains=[s], period=4.0 * s * rubber / speed, **options)
        for s in strains
    ]
    tested = [row for part in parts for row in part.attrs["tested_range"]]
    table = pd.concat(parts, ignore_index=True)
    table.attrs["lead_rises"] = [row for part in parts for row in part.attrs["lead_rises"]]
    return _with_tested(table, tested)


def rate_bands(
    bearing: Bearing, table: "pd.DataFrame", reference: float, **options: Any
) -> "pd.DataFrame":
    """Return how far the range of the rate factor moves the values at the reference temperature.

    `table` has the values of the bearing; `options` are those with which it was made. One row per
    strain and quantity: `lowest` and `highest` relative change of the mean over the cycles.
    """
    keys = ["strain", "quantity"]

    def _means(values: "pd.DataFrame") -> "pd.Series[float]":
        reference_rows = values[(values["basis"] == "mean") & (values["ambient_degC"] == reference)]
        return pd.Series(reference_rows.set_index(keys)["value"])

    conditions: dict[str, Any] = {"reference_temperature": reference, "temperatures": [reference]}
    compute = temperature_factors if "period" in options else factors_at_speed
    base, changes = _means(table), []
    for alternative in rate_alternatives(bearing).values():
        changes.append(_means(compute([alternative], **conditions, **options)) / base - 1.0)
    rows = []
    for strain, name in base.index if changes else ():
        low, high = band(change.loc[strain, name] for change in changes)
        row = {"bearing": bearing.name, "undecided": RATE, "strain": strain, "quantity": name}
        rows.append(row | {"lowest": low, "highest": high})
    return pd.DataFrame(rows)


def _check(
    bearings: Sequence[Bearing],
    reference: float,
    temperatures: Sequence[float],
    strains: Sequence[float],
    period: float,
) -> None:
    """Refuse what is out of range, all faults at once."""
    problems: list[str] = []
    if not bearings:
        problems.append("bearing: give one or more layered bearings")
    kinds = {item.kind: item.name for item in bearings}
    if len(kinds) > 1:
        text = ", ".join(f"{name} ({kind})" for kind, name in kinds.items())
        problems.append(
            f"bearing: {text}: several bearings are samples of one band, as of a posterior; "
            "give bearings of different kinds in separate runs"
        )
    for name, values, low, high, unit in (
        ("reference_temperature", [reference], COLDEST, HOTTEST, "degC"),
        ("temperatures", temperatures, COLDEST, HOTTEST, "degC"),
        ("strains", strains, 0.1, 3.0, "(a ratio: 1 is 100 %)"),
        ("period", [period], 0.2, 1000.0, "s"),
    ):
        if not len(values):
            problems.append(f"{name}: give at least one")
        problems += [
            f"{name} = {value!r}: must be a number from {low:g} to {high:g} {unit}".rstrip()
            for value in values
            if not is_number(value) or not low <= value <= high
        ]
    if problems:
        raise InputError(problems)


def _measured(
    bearing: Bearing,
    ambient: list[float],
    strain: float,
    period: float,
    numbers: tuple[int, ...],
    options: dict[str, Any],
) -> "pd.DataFrame":
    """Return values at one strain, by basis, temperature and quantity.

    Its `attrs` have the rows `tested_range` and `lead_rises`, which is empty without lead.
    """
    step = {"step": "cycles", "strain": float(strain), "wave": "sine", "period": float(period)}
    test = CyclicTest(dt=min(0.01, period / 200.0), steps=[step | {"count": max(numbers)}])
    result = run(bearing, test, ambient, keep=["rubber"], **options)
    if result.outcome != "completed":
        raise InputError(
            f"{bearing.name}: the model ended with {result.outcome} at {strain:.0%}: "
            f"{result.sentence}"
        )
    cycles = result.cycles
    scale = bearing.area / bearing.total_rubber_thickness / 1e3  # K_eq = G_eq A / T_r; MPa: kN/mm
    values = pd.DataFrame(
        {
            "ambient_degC": cycles["ambient_degC"],
            "cycle": cycles["cycle"],
            "K_eq": cycles["G_eq_MPa"] * scale,
            "Q_d": cycles["characteristic_strength_kN"],
            "K_d": cycles["post_yield_stiffness_kN_mm"],
            "h_eq": cycles["h_eq"],
            "energy": cycles["energy_kN_mm"],
        }
    )
    chosen = values[values["cycle"].isin(numbers)]
    parts = {
        "first": values[values["cycle"] == 1],
        "heated": values[values["cycle"] == max(numbers)],
        "mean": chosen.groupby("ambient_degC", as_index=False).mean(),
    }
    # One row for each number: factors of all quantities are then computed alike.
    frame = pd.concat(parts, names=["basis"]).reset_index("basis")
    keys = ["basis", "ambient_degC"]
    table = frame.melt(keys, list(QUANTITIES), var_name="quantity")
    table.insert(0, "strain", float(strain))
    table.insert(4, "unit", table["quantity"].map(QUANTITIES))
    tested = result.tested_range.to_dict("records")
    # Runs of several strains have the same ambient temperatures: their names need the strain.
    names = {run_name(t): _run_label(strain, t) for t in ambient}
    table.attrs["tested_range"] = [{**row, "run": names[row["run"]]} for row in tested]
    table.attrs["lead_rises"] = []
    if result.has_lead:
        lead = cycles.loc[cycles["cycle"] == 1].set_index("ambient_degC")["lead_degC"]
        starts = result["lead_temperature"].values[:, 0]
        table.attrs["lead_rises"] = [
            {"strain": float(strain), "ambient_degC": t, "lead_rise_K": float(lead[t] - start)}
            for t, start in zip(ambient, starts, strict=True)
        ]
    return table


def _run_label(strain: float, temperature: float) -> str:
    """Return what a run is called in sentences."""
    return f"{strain:.0%} at {temperature:g} degC"


def _with_tested(table: "pd.DataFrame", tested: list[Row]) -> "pd.DataFrame":
    """Return a table with what its first bearing was not tested at; those rows in `attrs`."""
    pairs = zip(table["strain"], table["ambient_degC"], strict=True)
    runs = [_run_label(float(strain), float(ambient)) for strain, ambient in pairs]
    table["beyond_tested"] = limits_passed(tested, runs)
    table.attrs["tested_range"] = tested
    return table


PLAN_LENGTHS = ("length", "width", "side", "diameter", "hole")
SPECIMEN = 1.0 / 6.0
STRAIN, COUNT, REST = 1.75, 5, 3600.0  # of the study; s


def scaled_bearing(bearing: Bearing | str | Path, factor: float) -> Bearing:
    """Return a bearing of the same compound with all lengths times a factor."""
    if not is_number(factor) or not 1e-3 <= factor <= 1e3:
        raise InputError(f"factor = {factor!r}: must be a number from 0.001 to 1000")
    bearing = as_bearing(bearing)
    g = bearing.geometry
    sizes = {name: getattr(g.plan, name, None) for name in PLAN_LENGTHS}
    plan = g.plan.model_copy(
        update={name: factor * size for name, size in sizes.items() if size is not None}
    )
    thicknesses = (
        "rubber_thickness",
        "shim_thickness",
        "sealing_plate_thickness",
        "end_plate_thickness",
    )
    geometry = g.model_copy(
        update={"plan": plan} | {name: factor * getattr(g, name) for name in thicknesses}
    )
    core = factor * bearing.lead.diameter if bearing.lead is not None else None
    return resized(bearing, geometry, core).model_copy(
        update={
            "name": f"{bearing.name}-x{factor:.4g}",
            "description": f"{bearing.name} with all lengths times {factor:.4g}",
            "cells": bearing.cells.enough(),
        }
    )


def scale_study(
    bearing: Bearing | str | Path,
    factors: Sequence[float] = (SPECIMEN, 1.0),
    ambient: float = -20.0,
    **options: Any,
) -> "tuple[pd.DataFrame, dict[float, Result]]":
    """Return rises [K] and results of five 2 s cycles of 175 % and an hour of rest, by size."""
    bearing = as_bearing(bearing)
    cycles = {"step": "cycles", "strain": STRAIN, "wave": "sine", "period": PERIOD, "count": COUNT}
    test = CyclicTest(dt=0.005, steps=[cycles, {"step": "rest", "duration": REST}])
    results = {
        float(factor): run(scaled_bearing(bearing, factor), test, ambient, **options)
        for factor in factors
    }
    rows = []
    end = PERIOD * COUNT
    for factor, result in results.items():
        time = result.time(0)
        rows.append({"factor": factor, "total_rubber_mm": factor * bearing.total_rubber_thickness})
        for name, delay in (("at_end", 0.0), ("after_1_min", 60.0), ("after_10_min", 600.0)):
            row = int(time.searchsorted(end + delay - 1e-6))
            layers = result["rubber_temperature"].values[0, row] - ambient
            rows[-1] |= {f"outer_{name}_K": float(layers[0]), f"inner_{name}_K": float(layers[-1])}
            if result.has_lead:
                lead = float(result["lead_temperature"].values[0, row]) - ambient
                rows[-1][f"lead_{name}_K"] = lead
        stress = result.cycles["stress_max_MPa"].to_numpy()
        rows[-1]["stress_cycle_5_over_1"] = float(stress[-1] / stress[0])
    return pd.DataFrame(rows), results
