"""Properties of a bearing at the temperatures of its tests: G_e, h_eq, Q_d and K_d.

Test and model are measured in the same cycles, as `measure` does. Intervals are those of the model:
they contain the uncertainty of its parameters, by the tests and by what is held.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from statistics import NormalDist
from typing import TYPE_CHECKING, Any

import numpy as np

from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.core.records import Floats
from thermobearing.identify.fit.forward import ForwardModel
from thermobearing.identify.records.cycles import (
    SAME,
    compute_measures,
    level_amplitudes,
    property_cycles,
)
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.records.turns import turned_amplitudes
from thermobearing.quantities.governing import place_of_largest
from thermobearing.quantities.register import Quantity, quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.words import degrees, joined, number, percent, printed_unit
from thermobearing.results.metrics import BACKBONE_DEFINITION, THIRD_CYCLE
from thermobearing.results.ranges import MARKED

if TYPE_CHECKING:
    from thermobearing.identify.result import Identification
    from thermobearing.results.metrics import CycleMeasures

MEASURED = {  # fields of the measures of a cycle by symbol, and units
    "G_e": ("G_eq_MPa", "MPa"),
    "h_eq": ("h_eq", ""),
    "Q_d": ("characteristic_strength_kN", "kN"),
    "K_d": ("post_yield_stiffness_kN_mm", "kN/mm"),
}
Row = Mapping[str, Any]
LATER = {name: unit for name, (_, unit) in MEASURED.items()}  # that are predicted
WITHOUT_FIRST = "Mean over the cycles of this amplitude, without the first if there are more."
DEFINITIONS = f"In test and model, {BACKBONE_DEFINITION}."
FIRST_CYCLE, LATER_CYCLES = "first of the largest", "mean without the first"  # of a prediction
HIGH = 0.975  # upper end of a 95 % interval
AS_IN_THE_TEST = (
    "The amplitudes are in the order of the first test: those before have warmed the rubber, so "
    "that a single amplitude from the soaked state, as of `lambda` and `cyclic`, is stiffer."
)
WITHIN = "\N{NO-BREAK SPACE}\N{PLUS-MINUS SIGN}\N{NO-BREAK SPACE}"  # between value and half width
MOST_DECIMALS = 4  # of a value with its interval
NOT_SHOWN = 1e-9  # of the largest value: ratios to smaller ones say nothing


@dataclass(frozen=True)
class Property:
    """A property in a test and in the calibrated model, and its ratio to that of the warmest test.

    Values of None are not known: a ratio of cycles that differ in amplitude, or K_d of a cycle
    without reversal points.
    """

    test: str
    ambient_degC: float
    strain: float  # of the cycles
    quantity: str  # "G_e", "h_eq", "Q_d" or "K_d"
    unit: str
    measured: float | None
    model: float | None
    lower: float | None  # of the 95 % interval of the model
    upper: float | None
    measured_ratio: float | None
    ratio: float | None  # of the model
    ratio_lower: float | None
    ratio_upper: float | None

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json about the property."""
        return asdict(self)


def list_properties(identification: "Identification") -> list[Property]:
    """Return the properties of a calibrated bearing at the temperatures of its tests.

    They are means over the cycles of the largest amplitude that all tests have, without the first
    of it if there are more. Where no amplitude is common to all, each test has its largest one, and
    a ratio if the warmest test has the same. Closing cycles do not count.
    """
    records, rubber = identification.records, identification.bearing.total_rubber_thickness
    size = identification.bearing.area, rubber
    measured = [_measures(record, record.force, *size) for record in records]
    if not all(measured):
        return []
    warmest = place_of_largest([record.ambient for record in records])
    amplitudes = [level_amplitudes(record) for record in records]
    places = property_cycles(amplitudes)
    chosen = [amplitudes[test][cycles[0]] for test, cycles in enumerate(places)]
    best = [prediction.force for prediction in identification.predictions]
    of_tests = _values(measured, places, warmest)
    middles, errors = _of_model(identification, best, places, warmest)
    strains = [
        float(np.mean([turned_amplitudes(record)[k] for k in cycle_numbers])) / rubber
        for record, cycle_numbers in zip(records, places, strict=True)
    ]
    properties = []
    for place, record in enumerate(records):
        for symbol, (_, unit) in MEASURED.items():
            value, ratio = (f"{symbol} {place}", f"ratio {symbol} {place}")
            ends = {name: _interval(middles, errors, name) for name in (value, ratio)}
            same_amplitude = abs(chosen[place] / chosen[warmest] - 1.0) < SAME
            has_ratio = same_amplitude and place != warmest
            properties.append(
                Property(
                    record.name,
                    record.ambient,
                    strains[place],
                    symbol,
                    unit,
                    of_tests.get(value),
                    middles.get(value),
                    *ends[value],
                    of_tests.get(ratio) if has_ratio else None,
                    middles.get(ratio) if has_ratio else None,
                    *(ends[ratio] if has_ratio else (None, None)),
                )
            )
    return properties


def _of_model(
    identification: "Identification",
    best: Sequence[Floats],
    places: Sequence[Sequence[int]],
    warmest: int,
) -> tuple[dict[str, float], dict[str, float]]:
    """Return the values of the model by name, and their standard errors."""
    from thermobearing.identify.uncertainty.posterior import drawn_bearing, propagate_errors

    size = identification.bearing.area, identification.bearing.total_rubber_thickness
    middles = _values(
        [_measures(r, force, *size) for r, force in zip(identification.records, best, strict=True)],
        places,
        warmest,
    )
    # Derivatives need changes only: coarse steps take a fifth of the time, and their difference is
    # added to the force with fine steps.
    models = [ForwardModel(record, identification.bearing) for record in identification.records]
    coarse = [model.run(identification.bearing) for model in models]

    def _measure(cube: Floats, changes: Floats) -> dict[str, float] | None:
        bearing, rows = drawn_bearing(identification, cube, changes), []
        for model, record, force, middle in zip(
            models, identification.records, best, coarse, strict=True
        ):
            run = model.rebuilt(bearing).run(bearing)
            if run is None or middle is None:
                return None
            rows.append(_measures(record, force + run.force - middle.force, *size))
        moved = _values(rows, places, warmest)
        return moved if moved.keys() >= middles.keys() else None

    errors = propagate_errors(identification, _measure, middles)
    return middles, {name: error.size for name, error in errors.items()}


def _interval(
    middles: dict[str, float], errors: dict[str, float], name: str
) -> tuple[float | None, float | None]:
    """Return the 95 % interval of a value; None where it is not known."""
    if name not in middles or name not in errors:
        return None, None
    half_width = NormalDist().inv_cdf(HIGH) * errors[name]
    return middles[name] - half_width, middles[name] + half_width


def _measures(
    record: TestRecord, force: Floats, area: float, rubber: float
) -> "list[CycleMeasures]":
    """Return the measures of each full cycle of a record; none if a cycle cannot be measured."""
    try:
        return compute_measures(record, force, area, rubber)
    except InputError:
        return []


def later_cycles(identification: "Identification") -> list[int]:
    """Return the numbers of the cycles of the first test that its properties are means over."""
    return property_cycles([level_amplitudes(record) for record in identification.records])[0]


def later_means(
    identification: "Identification", force: Floats, cycles: Sequence[int]
) -> dict[str, float]:
    """Return G_e [MPa], h_eq, Q_d [kN] and K_d [kN/mm] of the model in the first test, by symbol.

    `force` [kN] is that of the model at its samples; the means are those of `list_properties`, over
    the cycles of these numbers. Empty where a cycle cannot be measured.
    """
    bearing = identification.bearing
    size = bearing.area, bearing.total_rubber_thickness
    measured = [_measures(identification.records[0], force, *size)]
    values = _values(measured, [cycles], 0)
    return {name: values[f"{name} 0"] for name in LATER if f"{name} 0" in values}


def _values(
    measured: "Sequence[list[CycleMeasures]]", places: Sequence[Sequence[int]], warmest: int
) -> dict[str, float]:
    """Return the means over the cycles by symbol and test, and their ratios to the warmest."""
    values: dict[str, float] = {}
    for symbol, (field, _) in MEASURED.items():
        means = []
        for cycles, cycle_numbers in zip(measured, places, strict=True):
            numbers = [getattr(cycles[k], field) for k in cycle_numbers if k < len(cycles)]
            complete = bool(numbers) and all(value is not None for value in numbers)
            means.append(float(np.mean(numbers)) if complete else None)
        base = means[warmest]
        for place, mean in enumerate(means):
            if mean is not None:
                values[f"{symbol} {place}"] = mean
                # The ratio to a number that is zero but for rounding means nothing.
                if base is not None and abs(base) > NOT_SHOWN:
                    values[f"ratio {symbol} {place}"] = mean / base
    return values


def properties_table(properties: Sequence[Row]) -> Table:
    """Return G_e, h_eq, Q_d and K_d at the temperatures of the tests, the warmest first."""
    symbols = list(dict.fromkeys(item["quantity"] for item in properties))
    order = sorted(
        properties, key=lambda item: (symbols.index(item["quantity"]), -item["ambient_degC"])
    )
    rows = [
        {
            "quantity": item["quantity"],
            "unit": item["unit"],
            "ambient_degC": item["ambient_degC"],
            "test": item["test"],
            "property_measured": item["measured"],
            "property_model": item["model"],
            "property_lower": item["lower"],
            "property_upper": item["upper"],
            "ratio_measured": item["measured_ratio"],
            "ratio_model": item["ratio"],
            "ratio_lower": item["ratio_lower"],
            "ratio_upper": item["ratio_upper"],
        }
        for item in order
    ]
    strains = [percent(item["strain"]) for item in properties]
    note = (
        f"Mean over the cycles at {' or '.join(dict.fromkeys(strains))} shear strain, without "
        f"the first of them. {DEFINITIONS} Ratios are those to the warmest test. "
        "Intervals are those of the model: they contain the uncertainty of "
        "its parameters, and no error of the model, which the comparison with the test shows."
    )
    caption = "Properties at the temperatures of the tests"
    return make_table(pd.DataFrame(rows), caption=caption, keys=3, note=note)


def brief_properties(properties: Sequence[Row]) -> Table:
    """Return the properties in a row for each test and each ratio, of test and model."""
    symbols = list(dict.fromkeys(item["quantity"] for item in properties))
    units = {item["quantity"]: item["unit"] for item in properties}
    by_test = {(item["test"], item["quantity"]): item for item in properties}
    tests = {item["test"]: item["ambient_degC"] for item in properties}
    warmest_first = sorted(tests, key=lambda name: -tests[name])
    strains = {item["test"]: percent(item["strain"]) for item in properties}
    same_strain = len(set(strains.values())) == 1
    rows = []
    for name in warmest_first:
        items = [by_test[name, symbol] for symbol in symbols]
        label = (
            degrees([tests[name]]) if same_strain else f"{degrees([tests[name]])}, {strains[name]}"
        )
        rows.append([label, *_test_and_model(items, "measured", "model", "")])
        if any(item["ratio"] is not None for item in items):
            label = f"ratio to {degrees([tests[warmest_first[0]]])}"
            rows.append([label, *_test_and_model(items, "measured_ratio", "ratio", "ratio_")])
    columns = [Quantity("Temperature")]
    for symbol in symbols:
        columns += [Quantity(symbol, units[symbol]), Quantity("model", units[symbol])]
    shown = joined(dict.fromkeys(strains.values()), "or")
    caption = f"Equivalent properties at {shown} shear strain: test, and model with 95 % interval"
    note = f"{WITHOUT_FIRST} Half widths of intervals are rounded up. {DEFINITIONS}"
    return Table(caption, columns, rows, note=note)


def _test_and_model(items: Sequence[Row], measured: str, model: str, ends: str) -> list[str]:
    """Return the cells of a row: each value of the test, and of the model with its interval."""
    cells = []
    for item in items:
        values = item[measured], item[model]
        low, high = item[f"{ends}lower"], item[f"{ends}upper"]
        form, half_width = "#.3g", ""
        if item[model] is not None and low is not None and high > low:
            form, half_width = _rounded_up(0.5 * (high - low))
        test, middle = (
            "" if value is None else number(value, form).rstrip(".") for value in values
        )
        cells += [test, f"{middle}{WITHIN}{half_width}" if half_width else middle]
    return cells


def _rounded_up(half_width: float) -> tuple[str, str]:
    """Return the format of values with an interval, and its half width in two digits, rounded up.

    A smaller half width would state too narrow an interval; more than four decimals say nothing.
    """
    decimals = min(1 - math.floor(math.log10(half_width)), MOST_DECIMALS)
    step = 10.0**-decimals
    # Not a digit more for what is two digits but for rounding.
    rounded = math.ceil(half_width / step - NOT_SHOWN) * step
    form = f".{max(decimals, 0)}f"
    return form, number(rounded, form)


def predicted_cycles_table(posterior: Row) -> Table:
    """Return what is predicted of the first and the third cycle of each amplitude.

    The last cycle stands for the third of an amplitude that has fewer.
    """
    cycles: dict[tuple[float, int], dict[str, Row]] = {}
    for row in posterior.get("predicted_cycles", []):
        cycles.setdefault((row["ambient_degC"], row["cycle"]), {})[row["quantity"]] = row
    levels: list[list[Row]] = []
    for items in cycles.values():
        first = next(iter(items.values()))
        if first["number"] == 1 or not levels:
            levels.append([])
        levels[-1].append(first)
    chosen: list[Row] = []
    for level in levels:
        third = level[:THIRD_CYCLE][-1]
        chosen += level[:1] if third is level[0] else [level[0], third]
    columns = [quantity(name) for name in ("ambient_degC", "strain", "cycle")]
    rows: list[list[Any]] = []
    for first in chosen:
        items = cycles[first["ambient_degC"], first["cycle"]]
        cells = [columns[0].shown(first["ambient_degC"]), columns[1].shown(first["strain"])]
        cells.append(first["number"])
        for name in items:
            factor = printed_unit(str(items[name]["unit"]))[1]
            values = (factor * items[name][end] for end in ("best", "lower", "upper"))
            ends = (number(value, "#.4g").rstrip(".") for value in values)
            cells.append("{} ({} to {})".format(*ends))
        rows.append(cells)
    for name, item in next(iter(cycles.values()), {}).items():
        head = {"force": "Peak force", "energy": "Energy"}.get(name, name)
        columns.append(Quantity(head, printed_unit(str(item["unit"]))[0]))
    marked = frozenset((k, 0) for k, first in enumerate(chosen) if first["beyond_tested"])
    caption = "Predicted cycles as in the first test, with 95 % intervals"
    note = f"First and third cycle of each amplitude; all are in predicted.csv. {AS_IN_THE_TEST}"
    note += f" {MARKED}; the intervals are wider there." if marked else ""
    return Table(caption, columns, rows, keys=3, marked=marked, note=note)


def property_sentence(properties: Sequence[Row]) -> str:
    """Return a sentence on the properties of the coldest test; "" if there are none."""
    if not properties:
        return ""
    coldest, warmest = (
        pick(properties, key=lambda item: item["ambient_degC"])["ambient_degC"]
        for pick in (min, max)
    )
    values = []
    for item in properties:
        if item["ambient_degC"] != coldest or item["model"] is None:
            continue
        value = f"{item['quantity']} = {number(item['model'], '.3g')} {item['unit']}".strip()
        if item["lower"] is not None:
            value += f" ({number(item['lower'], '.3g')} to {number(item['upper'], '.3g')})"
        if item["ratio"] is not None:
            value += f", {number(item['ratio'], '.2f')} times that at {degrees([warmest])}"
        values.append(value)
    if not values:
        return ""
    return f"At {degrees([coldest])}, with 95 % intervals: {'; '.join(values)}."


def prediction_sentence(posterior: Row) -> str:
    """Return a sentence on what is predicted at the design temperatures; "" without it."""
    values = []
    for row in posterior.get("predicted", []):
        unit, factor = printed_unit(str(row["unit"]))
        best, lower, upper = (number(factor * row[k], ".3g") for k in ("best", "lower", "upper"))
        name = {"force": "peak force"}.get(row["quantity"], row["quantity"])
        name += f" ({row['cycles']})" if row.get("cycles") == LATER_CYCLES else ""
        words = f"{name} {best} {unit}".rstrip() + f" ({lower} to {upper})"
        words += f" at {degrees([row['ambient_degC']])}"
        values.append(f"{words}, extrapolated" if row.get("beyond_tested") else words)
    return (
        f"Predicted in the first cycle of the largest amplitude of the first test: "
        f"{'; '.join(values)}."
        if values
        else ""
    )
