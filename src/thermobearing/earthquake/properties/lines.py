"""Equivalent linear and bilinear properties of bearing lines, as other programs take them.

The third cycle of a bearing that does not warm, at the design displacement of its line and the
ambient temperature, gives effective stiffness, damping and the bilinear loop of the same peak force
and energy. Upper values of virgin rubber have the largest force of the first cycle, and the energy
of the third (`first_loading`).
"""

import math
import tomllib
from collections.abc import Iterable, Mapping
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.exposure import exposed, exposed_bilinear
from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing, calibration_ranges
from thermobearing.bearing.sources import (
    EXTRAPOLATED,
    LEAD_EXTRAPOLATED,
    UNTESTED_VALUES,
    VIRGIN_EXCESS,
    assumed_properties,
)
from thermobearing.bearing.state import RubberState, has_excess, in_state, scragging_of
from thermobearing.border.lazy import pd
from thermobearing.border.library import data_path
from thermobearing.border.schema import validated
from thermobearing.border.toml import read_toml
from thermobearing.core.records import Floats
from thermobearing.cyclic.equivalent import (
    find_backbone,
    first_loading,
    isothermal_cycle,
    solve_backbone,
)
from thermobearing.earthquake.case import EarthquakeAnalysis, OnLine, list_bearing_tables
from thermobearing.earthquake.properties.notes import (
    FIRST,
    HEATED_COLUMNS,
    SCRAGGED,
    bearing_sources,
)
from thermobearing.model.axial import axial_stiffness
from thermobearing.model.checks import checked_modulus
from thermobearing.model.earlier import BilinearParameters
from thermobearing.model.element import initial_stiffness
from thermobearing.model.options import ModelOptions, build_model
from thermobearing.quantities.governing import SLACK_KELVIN, place_of_largest
from thermobearing.quantities.words import counted
from thermobearing.results.metrics import THIRD_CYCLE, CycleMeasures
from thermobearing.results.ranges import OUTSIDE, beyond_words, compare_with_tests

if TYPE_CHECKING:
    from thermobearing.earthquake.result import EarthquakeResult

ROUNDING = 1e-9  # of K_eff D^2: energy of a loop that is elastic
STILL = 1e-6  # strain of a line that does not move, whose stiffness is not asked for
MEAN_RULE = "mean of seven"


@cache
def _mean_rule() -> dict[str, Any]:
    rules = read_toml(data_path("design", "peaks.toml"))["rules"]
    return next(dict(rule) for rule in rules if rule["name"] == MEAN_RULE)


def motions_for_mean() -> int:
    """Return from how many motions on the mean of their peaks counts (data/design/peaks.toml)."""
    return int(_mean_rule()["least"])


def few_motions_note(count: int) -> str:
    """Return that motions are too few for the largest of their peaks too, as a sentence.

    Empty from as many on as the rule needs (data/design/peaks.toml).
    """
    rule = _mean_rule()
    if count >= rule["fewest"]:
        return ""
    return (
        f"{counted(count, 'ground motion')} {'is' if count == 1 else 'are'} too few for a design: "
        f"codes take the largest peak of {rule['fewest']} motions or more, or the mean of "
        f"{rule['least']} or more ({rule['fewest_source']}); peaks and verdicts of this report are "
        f"those of {counted(count, 'motion')} only."
    )


def more_motions_action(count: int) -> str:
    """Return what to do about too few motions; empty where they are enough."""
    rule = _mean_rule()
    if count >= rule["fewest"]:
        return ""
    return (
        f"Add ground motions and repeat the analysis with {rule['fewest']} or more for the largest "
        f"peaks, {rule['least']} or more for means: until then no check that counts on a "
        "displacement or force of the motions is decided."
    )


def design_peak(peaks: Floats) -> float:
    """Return the design value of the peaks of motions: their mean, of fewer than seven the largest.

    >>> design_peak(np.array([1.0, 3.0]))
    3.0
    """
    return float(peaks.mean() if len(peaks) >= motions_for_mean() else peaks.max())


def analysed_state(
    options: EarthquakeAnalysis, devices: Iterable[Bearing | BilinearBearing]
) -> str:
    """Return the state of the rubber of an analysis in words; of a file with virgin rubber that."""
    layered = [device for device in devices if isinstance(device, Bearing)]
    rubbers = [_rubber(in_state(device, options.state), options.state) for device in layered]
    return next((rubber for rubber in rubbers if rubber != SCRAGGED), SCRAGGED)


def line_properties(result: "EarthquakeResult") -> "pd.DataFrame":
    """Return the equivalent properties of one bearing of each line, by ambient temperature.

    The design displacement of a line is the mean of its largest displacements over the motions
    where there are at least seven, otherwise the largest (data/design/peaks.toml). The
    test has the mean speed 4 D/T of a cycle with the first period T of the structure. Exposure and
    state of the rubber are those of the analysis, or of the line where it states its own.

    Returns
    -------
    DataFrame
        One row for each bearing of the analysis, line and ambient temperature: design displacement
        [mm] and the motion that it is of (`design_displacement_of`), effective stiffness [kN/mm]
        and damping ratio, and Q_d [kN], K_d and K_1 [kN/mm] of the bilinear loop with the same peak
        force and energy; `kind` of the bearing, empty where its own K_1 is stated. All lines of a
        bearing at a temperature have one K_1/K_d. `K_0_kN_mm` is the initial stiffness of the
        model, its tangent without displacement. `D_y_mm` is the yield displacement of the loop
        [mm], beyond the design displacement of a bearing that does not yield; without a loop in
        which a yield can be found, it, Q_d, K_d and K_1 are NaN. `state` is that of the rubber in
        the analysis. `cycle` is the third; the first at the coldest temperature of rubber with
        virgin excess, whose state is `rubber`. `over_scragged` is K_eff over that of the third
        cycle of scragged rubber, `excess` whether the rubber is stiffer while virgin, and `assumed`
        the keys of the bearing file on which the properties rest and which were not measured, or
        whose range of tests they are outside of, as `beyond_tests` says in words;
        `outside_law_K` is how far the temperature is above (or, negative, below) the range `law` of
        the temperature law of the rubber [degC]. `K_eff_heated_kN_mm`, `h_eff_heated` and
        `Q_d_heated_kN` are those with the lead at its highest temperature in the runs, `lead_degC`.
        `secant_kN_mm` is the largest force over the largest displacement of the run `secant_of`
        where that is most, `has_lead` whether there is lead. Lines that do not move are left out.
    """
    case = tomllib.loads(str(result.dataset.attrs["case"]))
    devices = {str(table["name"]): load_device(table) for table in list_bearing_tables(case)}
    options = validated(EarthquakeAnalysis, case["analysis"], "analysis")
    states = {
        str(table["line"]): validated(OnLine, dict(table), "lines").state
        for table in case.get("lines", [])
    }
    period = float(np.atleast_1d(result.dataset.attrs["periods_s"])[0])
    analysis_state = analysed_state(options, devices.values())
    rows = []
    lines = moved_lines(result, case["structure"], devices)
    for key, group in lines.groupby(["bearing", "line", "ambient_degC"], sort=False):
        peaks = group["displacement_max_mm"].to_numpy(dtype=float)
        displacement = design_peak(peaks)
        governing = str(group["motion"].iloc[place_of_largest(peaks)])
        state = states.get(str(key[1])) or options.state
        device = _as_run(devices[str(group["line_bearing"].iloc[0])], options, state)
        coldest = key[2] == lines["ambient_degC"].min()
        # The secant stiffness of a line that does not move is that of no cycle.
        if displacement <= STILL * device.total_rubber_thickness:
            continue
        temperature = float(group["line_ambient_degC"].iloc[0])
        labels = dict(zip(("bearing", "line", "ambient_degC"), key, strict=True))
        labels["state"] = analysis_state
        line = {"line_bearing": device.name, "count": int(group["count"].iloc[0])}
        line |= {"design_displacement_of": _design_source(len(peaks), governing)}
        lead = float(group["lead_max_degC"].max())
        heated = lead if lead > temperature + SLACK_KELVIN else None
        values = _properties(device, displacement, temperature, period, upper=coldest, lead=heated)
        rubber = _rubber(device, state)
        as_in_file = devices[device.name]
        excess = isinstance(as_in_file, Bearing) and has_excess(as_in_file)
        law, outside = _beyond_law(device, temperature)
        assumed = list(_assumed_keys(case, device, temperature))
        if excess and rubber != SCRAGGED and isinstance(as_in_file, Bearing):
            assumed += [VIRGIN_EXCESS] * scragging_of(as_in_file)[1]
        assumed += [EXTRAPOLATED] * (outside != 0.0)
        beyond = _beyond_tests(device, displacement, temperature)
        if outside != 0.0:  # said of the law, in more detail
            beyond.pop("ambient", None)
        assumed += [UNTESTED_VALUES[limit] for limit in beyond]
        cold_lead = _cold_lead(device, temperature)
        assumed += [LEAD_EXTRAPOLATED] * bool(cold_lead)
        origin: dict[str, Any] = {"rubber": rubber, "excess": excess, "assumed": " ".join(assumed)}
        origin |= {"law": law, "outside_law_K": outside, "cold_lead": cold_lead}
        origin["beyond_tests"] = "; ".join(beyond.values())
        origin["has_lead"] = isinstance(device, Bearing) and device.lead is not None
        rows.append(labels | line | values | origin | _largest_secant(group))
    return _with_one_ratio(pd.DataFrame(rows))


def _design_source(count: int, governing: str) -> str:
    """Return which of the peaks of some motions a design displacement is, in words."""
    if count >= motions_for_mean():
        return f"mean of {count} motions"
    too_few = f" of {counted(count, 'motion')}, too few for a code" * bool(few_motions_note(count))
    return f"largest{too_few}, in {governing}"


def _beyond_law(device: Bearing | BilinearBearing, temperature: float) -> tuple[str, float]:
    """Return the range of the temperature law in words, and how far a temperature is outside [K].

    Negative below it, zero inside, where no law is stated and for a bilinear bearing.
    """
    law = None if isinstance(device, BilinearBearing) else device.temperature_law
    if law is None or law.range is None:
        return "", 0.0
    low, high = law.range
    beyond = min(temperature - low, 0.0) + max(temperature - high, 0.0)
    return f"{low:g} to {high:g} degC", beyond if abs(beyond) > SLACK_KELVIN else 0.0


def _beyond_tests(
    device: Bearing | BilinearBearing, displacement: float, temperature: float
) -> dict[str, str]:
    """Return which of strain and ambient temperature are outside the tests of a bearing, in words.

    At a displacement [mm] and a temperature [degC]. Its strain rate does not count: earthquakes are
    faster than tests (`rate_note`).
    """
    reached: dict[str, float | tuple[float, float]] = {
        "strain": displacement / device.total_rubber_thickness,
        "ambient": (temperature, temperature),
    }
    rows = compare_with_tests(device.name, reached, calibration_ranges(device))
    return {str(row["limit"]): beyond_words(row) for row in rows if row[OUTSIDE]}


def _cold_lead(device: Bearing | BilinearBearing, temperature: float) -> str:
    """Return what the strength of lead rests on that is colder than in its tests [degC]; else "".

    Without stated tests, that is lead colder than the temperature that its yield stress is of.
    """
    if isinstance(device, BilinearBearing) or device.lead is None:
        return ""
    lead = device.lead
    tested = (calibration_ranges(device) or {}).get("lead_temperature")
    coldest = lead.reference_temperature if tested is None else tested[0]
    if not temperature < coldest - SLACK_KELVIN:
        return ""
    factor = math.exp(-lead.softening * (temperature - coldest))
    ends = "T_0 of its yield stress; no test of it is stated"
    return (
        f"Q_d is {factor:.2f} times that with the lead at {coldest:g} degC by E_2 = "
        f"{lead.softening:g}/K, which is extrapolated below this temperature, "
        + (ends if tested is None else "the coldest of its tests")
    )


def _largest_secant(group: "pd.DataFrame") -> dict[str, Any]:
    """Return the largest force over the largest displacement of the runs of a line, and its run."""
    secants = (group["force_max_kN"] / group["displacement_max_mm"]).to_numpy(dtype=float)
    place = place_of_largest(secants)
    displacement = float(group["displacement_max_mm"].iloc[place])
    return {
        "secant_kN_mm": float(secants[place]),
        "secant_of": f"{group['motion'].iloc[place]}, {displacement:.0f} mm",
    }


def _rubber(device: Bearing | BilinearBearing, state: RubberState | None) -> str:
    """Return the state of the rubber of a bearing in words; empty of a bilinear one."""
    if isinstance(device, BilinearBearing):
        return ""
    if device.scragging is None:
        return SCRAGGED
    # A file with the table scragging is of virgin rubber where no state is stated.
    return "virgin" if state is None else state.describe()


def _assumed_keys(
    case: Mapping[str, Any], device: Bearing | BilinearBearing, temperature: float
) -> tuple[str, ...]:
    """Return the keys that were not measured of a bearing at a temperature [degC]."""
    if isinstance(device, BilinearBearing):
        return ()
    table = next(t for t in list_bearing_tables(case) if str(t["name"]) == device.name)
    difference = abs(temperature - device.hysteresis.reference_temperature)
    return assumed_properties(bearing_sources(case, table), at_reference=difference <= SLACK_KELVIN)


def _with_one_ratio(lines: "pd.DataFrame") -> "pd.DataFrame":
    """Return lines of which those with the same bearing have the largest assumed K_1/K_d of them.

    A fat loop needs a larger ratio than that of the kind; lines with other displacements would
    otherwise have other ratios, and other Q_d and K_d. Each temperature has its own ratio: with
    that of a fatter loop in the cold, links of the warm bearing give too small displacements.
    """
    if not len(lines):
        return lines
    assumed = lines[lines["kind"] != ""]
    keys = ["bearing", "line_bearing", "ambient_degC"]
    for _, group in assumed.groupby(keys, sort=False):
        smallest = float((group["K_d_kN_mm"] / group["K_1_kN_mm"]).min())
        for index, row in zip(group.index, group.to_dict("records"), strict=True):
            loop = solve_backbone(
                row["K_eff_kN_mm"], row["h_eff"], row["design_displacement_mm"], smallest
            )
            if loop is not None:
                change = loop.strength - row["Q_d_kN"]
                values = [loop.strength, loop.post_yield, loop.initial, loop.yield_displacement]
                lines.loc[index, ["Q_d_kN", "K_d_kN_mm", "K_1_kN_mm", "D_y_mm"]] = values
                lines.loc[index, "Q_d_heated_kN"] = row["Q_d_heated_kN"] + change
    return lines


def load_device(table: Mapping[str, Any]) -> Bearing | BilinearBearing:
    """Return a bearing of a resolved case."""
    name = str(table["name"])
    if table.get("kind") == "bilinear":
        return validated(BilinearBearing, dict(table), name)
    return as_bearing(dict(table), name)


def _as_run(
    device: Bearing | BilinearBearing, options: EarthquakeAnalysis, state: RubberState | None
) -> Bearing | BilinearBearing:
    """Return a bearing with the exposure of an analysis and its rubber in a state."""
    if isinstance(device, BilinearBearing):
        return exposed_bilinear(device, options.exposure)
    return in_state(exposed(device, options.exposure), state)


def moved_lines(
    result: "EarthquakeResult",
    structure: Mapping[str, Any],
    devices: Mapping[str, Bearing | BilinearBearing],
) -> "pd.DataFrame":
    """Return the lines of completed runs; of one line, the table of runs with its count."""
    table = result.table
    completed = table["outcome"] == "completed"
    lines = result.lines
    if len(lines):
        return lines[np.repeat(completed.to_numpy(), len(lines) // result.runs)]
    # A structure with one line and one pier has no table of lines; peaks are those of its line.
    line = structure["bearings"][0]
    lead = [result.hottest(run)["lead"] for run in range(result.runs)]
    table = table.assign(lead_max_degC=lead)[completed]
    strain = table["bearing_strain_max"].to_numpy(dtype=float)
    thickness = np.array([devices[name].total_rubber_thickness for name in table["bearing"]])
    return table[["bearing", "motion", "ambient_degC", "lead_max_degC"]].assign(
        force_max_kN=table["bearing_force_max_kN"],
        line=line["name"],
        line_bearing=table["bearing"],
        count=int(line["count"]),
        line_ambient_degC=table["ambient_degC"],
        displacement_max_mm=strain * thickness,
    )


def _properties(
    device: Bearing | BilinearBearing,
    displacement: float,
    temperature: float,
    period: float,
    *,
    upper: bool,
    lead: float | None,
) -> dict[str, float | str]:
    """Return the equivalent properties of a bearing at a displacement [mm] and temperature.

    Upper values of rubber that is stiffer while virgin are those of the first cycle. `lead` is the
    temperature of the lead in the runs, where it warms [degC].
    """
    kind, cycle_number, over_scragged = "", THIRD_CYCLE, 1.0
    loop: BilinearParameters | None
    heated: dict[str, float] = dict.fromkeys(HEATED_COLUMNS, math.nan)
    if isinstance(device, BilinearBearing):
        loop = BilinearParameters(
            device.strength, device.post_yield_stiffness, device.initial_stiffness
        )
        stiffness, energy = loop.stiffness(displacement), loop.energy(displacement)
        vertical, at_rest = math.nan, device.initial_stiffness
    else:
        strain = displacement / device.total_rubber_thickness
        speed = 4.0 * displacement / period  # a cycle covers four times its amplitude
        if upper and device.scragging is not None and has_excess(device):
            cycle_number = FIRST
        measure = first_loading if cycle_number == FIRST else isothermal_cycle
        cycle = measure(device, strain, speed, temperature)
        stiffness, energy = cycle.stiffness_kN_mm, cycle.energy_kN_mm
        loop, is_stated = find_backbone(device, cycle, displacement, speed, temperature)
        kind = "" if is_stated or loop is None else device.kind
        if device.scragging is not None:
            scragged = in_state(device, RubberState(rubber="tested"))
            if cycle_number != THIRD_CYCLE or scragged != device:
                third = isothermal_cycle(scragged, strain, speed, temperature)
                over_scragged = stiffness / third.stiffness_kN_mm
        if lead is not None:
            with_lead = measure(device, strain, speed, temperature, lead=lead)
            warm = find_backbone(device, with_lead, displacement, speed, temperature, lead)
            heated = _heated(cycle, loop, with_lead, warm, displacement)
        constants = build_model(device, ModelOptions()).constants
        at_rest = initial_stiffness(constants, temperature, temperature)
        modulus = checked_modulus(device, temperature)
        vertical = axial_stiffness(device.geometry, modulus, device.lead)
    return {
        "design_displacement_mm": displacement,
        "K_eff_kN_mm": stiffness,
        "h_eff": _damping_ratio(energy, stiffness, displacement),
        "Q_d_kN": loop.strength if loop else math.nan,
        "K_d_kN_mm": loop.post_yield if loop else math.nan,
        "K_1_kN_mm": loop.initial if loop else math.nan,
        "K_0_kN_mm": at_rest,
        "D_y_mm": loop.yield_displacement if loop else math.nan,
        "K_v_kN_mm": vertical,
        "kind": kind,
        "cycle": cycle_number,
        "over_scragged": over_scragged,
        "lead_degC": math.nan if lead is None else lead,
        **heated,
    }


def _heated(
    cycle: CycleMeasures,
    loop: BilinearParameters | None,
    with_lead: CycleMeasures,
    warm: tuple[BilinearParameters | None, bool],
    displacement: float,
) -> dict[str, float]:
    """Return stiffness, damping ratio and Q_d of a cycle with warm lead at a displacement [mm].

    `loop` is that of the cycle with lead as warm as the rubber; `warm` is `find_backbone` of the
    other. Where its loop is not stated by the bearing, warm lead takes its force from Q_d alone.
    """
    warm_loop, is_stated = warm
    fall = (cycle.stiffness_kN_mm - with_lead.stiffness_kN_mm) * displacement
    strength = loop.strength - fall if loop else math.nan
    if is_stated and warm_loop:
        strength = warm_loop.strength
    ratio = _damping_ratio(with_lead.energy_kN_mm, with_lead.stiffness_kN_mm, displacement)
    values = with_lead.stiffness_kN_mm, ratio, strength
    return dict(zip(HEATED_COLUMNS, values, strict=True))


def _damping_ratio(energy: float, stiffness: float, displacement: float) -> float:
    """Return the damping ratio of a loop; exactly zero where its energy is one of rounding."""
    scale = stiffness * displacement**2
    return energy / (2.0 * math.pi * scale) if abs(energy) > ROUNDING * scale else 0.0
