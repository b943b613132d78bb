"""Equivalent linear and bilinear properties of bearing lines, as other programs take them.

The third cycle of a bearing that does not warm, at the design displacement of its line and the
ambient temperature, gives effective stiffness, damping and the bilinear loop of the same peak force
and energy. Virgin rubber has its largest force in the first cycle, which gives the upper values.
"""

import math
import textwrap
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.exposure import exposed, exposed_bilinear
from thermobearing.bearing.library import BEARINGS, as_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.sources import (
    COEFFICIENTS,
    EXTRAPOLATED,
    STIFFNESS,
    VIRGIN_EXCESS,
    assumed_clause,
    assumed_properties,
)
from thermobearing.bearing.state import RubberState, has_excess, in_state, scragging_of
from thermobearing.border.lazy import pd
from thermobearing.border.library import data_path, read_data
from thermobearing.border.schema import Strict, validated
from thermobearing.border.toml import read_toml
from thermobearing.core.records import Floats
from thermobearing.cyclic.equivalent import (
    CYCLE,
    backbone,
    isothermal_cycle,
    post_yield_ratio,
    solve_backbone,
    stated_backbone,
)
from thermobearing.earthquake.case import EarthquakeAnalysis, OnLine, list_bearing_tables
from thermobearing.model.axial import axial_stiffness
from thermobearing.model.checks import checked_modulus
from thermobearing.model.earlier import BilinearParameters
from thermobearing.quantities.governing import SLACK_KELVIN, place_of_largest
from thermobearing.quantities.register import Quantity, quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.words import joined
from thermobearing.results.directory import MODES_FILE
from thermobearing.structure.connections.model import DeviceTable
from thermobearing.structure.matrices import find_modes, line_stiffness, total_stiffness
from thermobearing.structure.model import Structure
from thermobearing.structure.run import Prepared, prepare_structure

if TYPE_CHECKING:
    from thermobearing.earthquake.result import EarthquakeResult

RATIO_SLACK = 1.0 + 1e-9  # by which rounding may exceed a ratio
RUN_SLACK = 1.005  # a run is as stiff as a link within half a percent
STILL = 1e-6  # strain of a line that does not move, whose stiffness is not asked for
MEAN_RULE = "mean of seven"
KILO = 1e3  # mm in a metre
FIRST = 1  # the cycle in which virgin rubber is stiffest
SCRAGGED = "scragged"
OTHER_DISPLACEMENTS = (
    "K_eff and damping also depend on the design displacement, which differs between temperatures: "
    "their ratio is not that of one loop at two temperatures."
)

LINK_WIDTH = 79  # letters of a line of links.txt
LINK_NOTES = (
    OTHER_DISPLACEMENTS,
    "The effective damping is the coefficient of a dashpot, C = h K_eff T_eff/pi, with the "
    "effective damping ratio h and the effective period T_eff of the bridge: the field Effective "
    "Damping of SAP2000 and CSiBridge, of linear load cases, takes C and not the ratio.",
    "(assumed): rests on a number that was assumed, borrowed or chosen, and not measured, or on a "
    "temperature outside the tests of the rubber.",
)
DEVICES_NOTE = (
    "Devices parallel to bearings, one of each, in kN, m and s. Damper: link Damper - Exponential "
    "of SAP2000 and CSiBridge (F = C |v|^alpha, rigid brace). Slider: link Friction Isolator "
    "without radius. Gap: links Gap and Hook, which lose nothing in an impact. Their damping is "
    "not in the effective damping above, and other programs do not know the temperature of the "
    "oil: enter C times its factor."
)
TEMPERATURE_NOTE = (
    "Effects of temperature rest on coefficients m_T and n_T that were not measured on the rubber: "
    "{phrases}. Compare them with factors of the maker or of a code (thermobearing lambda)."
)
VIRGIN_NOTE = (
    "Rubber of {names} is scragged here. Virgin rubber is stiffer, most in its first cycle: for "
    "upper values that count on it, run the analysis with --state virgin."
)
LOWER_NOTE = (
    "Rubber of {names} is not scragged here. Take lower values from an analysis of scragged rubber "
    "(--state tested)."
)


class DampingFactor(Strict):
    """Content of data/equivalent/damping.toml; `unverified`: its source was not read."""

    reference: Annotated[float, Field(gt=0, lt=1)]
    exponent: Annotated[float, Field(gt=0, lt=1)]
    largest: Annotated[float, Field(ge=1)]
    source: str
    unverified: bool

    def at(self, ratio: float) -> float:
        """Return B_L, which divides the displacement of a spectrum of 5 % damping."""
        return float(min((ratio / self.reference) ** self.exponent, self.largest))


def damping_factor() -> DampingFactor:
    """Return the rule for B_L."""
    return read_data(DampingFactor, "equivalent", "damping.toml")


def motions_for_mean() -> int:
    """Return from how many motions on the mean of their peaks counts (data/design/peaks.toml)."""
    rules = read_toml(data_path("design", "peaks.toml"))["rules"]
    return int(next(rule["least"] for rule in rules if rule["name"] == MEAN_RULE))


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
        bearing have one K_1/K_d. `cycle` is the third; the first at the coldest temperature of
        rubber with virgin excess, whose state is `rubber`. `over_scragged` is K_eff over that of
        the third cycle of scragged rubber, `excess` whether the rubber is stiffer while virgin, and
        `assumed` the keys of the bearing file on which the properties rest and which were not
        measured; `outside_law_K` is how far the temperature is above (or, negative, below) the
        range `law` of the temperature law of the rubber [degC]. `Q_d_heated_kN` is Q_d with the
        lead at its highest temperature in the runs, `lead_degC`. `secant_kN_mm` is the largest
        force over the largest displacement of the run `secant_of` where that is most. Lines that do
        not move are left out.
    """
    case = tomllib.loads(str(result.dataset.attrs["case"]))
    devices = {str(table["name"]): _device(table) for table in list_bearing_tables(case)}
    options = validated(EarthquakeAnalysis, case["analysis"], "analysis")
    states = {
        str(table["line"]): validated(OnLine, dict(table), "lines").state
        for table in case.get("lines", [])
    }
    period = float(np.atleast_1d(result.dataset.attrs["periods_s"])[0])
    rows = []
    lines = _moved_lines(result, case["structure"], devices)
    for key, group in lines.groupby(["bearing", "line", "ambient_degC"], sort=False):
        peaks = group["displacement_max_mm"].to_numpy(dtype=float)
        has_mean = len(peaks) >= motions_for_mean()
        displacement = float(peaks.mean() if has_mean else peaks.max())
        governing = str(group["motion"].iloc[place_of_largest(peaks)])
        source = f"mean of {len(peaks)} motions" if has_mean else f"largest, in {governing}"
        state = states.get(str(key[1])) or options.state
        device = _as_run(devices[str(group["line_bearing"].iloc[0])], options, state)
        coldest = key[2] == lines["ambient_degC"].min()
        # The secant stiffness of a line that does not move is that of no cycle.
        if displacement <= STILL * device.total_rubber_thickness:
            continue
        temperature = float(group["line_ambient_degC"].iloc[0])
        labels = dict(zip(("bearing", "line", "ambient_degC"), key, strict=True))
        line = {"line_bearing": device.name, "count": int(group["count"].iloc[0])}
        line |= {"design_displacement_of": source}
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
        origin: dict[str, Any] = {"rubber": rubber, "excess": excess, "assumed": " ".join(assumed)}
        origin |= {"law": law, "outside_law_K": outside}
        rows.append(labels | line | values | origin | _largest_secant(group))
    lines = _with_one_ratio(pd.DataFrame(rows))
    if len(lines):
        fall = (lines["K_eff_kN_mm"] - lines["K_eff_heated_kN_mm"]).astype(float)
        lines["Q_d_heated_kN"] = lines["Q_d_kN"] - fall * lines["design_displacement_mm"]
    return lines


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


def bearing_sources(case: Mapping[str, Any], table: Mapping[str, Any]) -> dict[str, str]:
    """Return the sources of a bearing of a resolved case, by dotted key."""
    stated = case.get("sources", {}).get(str(table["name"]), {})
    return BEARINGS.sources(Bearing, table) | dict(stated)


def temperature_note(case: Mapping[str, Any]) -> str:
    """Return which temperature coefficients of a case were not measured, and what to do about it.

    Empty where those of all bearings were.
    """
    phrases = []
    for table in list_bearing_tables(case):
        sources = bearing_sources(case, table)
        clauses = dict.fromkeys(assumed_clause(sources.get(key, "")) for key in COEFFICIENTS)
        if origins := [clause for clause in clauses if clause]:
            phrases.append(f"of {table['name']} {joined(origins)}")
    return TEMPERATURE_NOTE.format(phrases=joined(phrases)) if phrases else ""


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
    otherwise have other ratios, and other Q_d and K_d.
    """
    if not len(lines):
        return lines
    assumed = lines[lines["kind"] != ""]
    for _, group in assumed.groupby(["bearing", "line_bearing"], sort=False):
        smallest = float((group["K_d_kN_mm"] / group["K_1_kN_mm"]).min())
        for index, row in zip(group.index, group.to_dict("records"), strict=True):
            loop = solve_backbone(
                row["K_eff_kN_mm"], row["h_eff"], row["design_displacement_mm"], smallest
            )
            if loop is not None:
                values = [loop.strength, loop.post_yield, loop.initial]
                lines.loc[index, ["Q_d_kN", "K_d_kN_mm", "K_1_kN_mm"]] = values
    return lines


def _device(table: Mapping[str, Any]) -> Bearing | BilinearBearing:
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


def _moved_lines(
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
    kind, cycle_number, over_scragged, heated = "", CYCLE, 1.0, math.nan
    if isinstance(device, BilinearBearing):
        loop = BilinearParameters(
            device.strength, device.post_yield_stiffness, device.initial_stiffness
        )
        stiffness = loop.strength / displacement + loop.post_yield
        energy = loop.energy(displacement)
        vertical = math.nan
    else:
        strain = displacement / device.total_rubber_thickness
        speed = 4.0 * displacement / period  # a cycle covers four times its amplitude
        if upper and device.scragging is not None and has_excess(device):
            cycle_number = FIRST
        cycle = isothermal_cycle(device, strain, speed, temperature, cycle_number)
        stiffness, energy = cycle.stiffness_kN_mm, cycle.energy_kN_mm
        stated = stated_backbone(device, cycle, displacement)
        kind = device.kind if stated is None else ""
        loop = stated or backbone(stiffness, energy, displacement, device.kind)
        if device.scragging is not None:
            scragged = in_state(device, RubberState(rubber="tested"))
            if cycle_number != CYCLE or scragged != device:
                third = isothermal_cycle(scragged, strain, speed, temperature)
                over_scragged = stiffness / third.stiffness_kN_mm
        if lead is not None:
            with_lead = isothermal_cycle(device, strain, speed, temperature, cycle_number, lead)
            heated = with_lead.stiffness_kN_mm
        modulus = checked_modulus(device, temperature)
        vertical = axial_stiffness(device.geometry, modulus, device.lead)
    return {
        "design_displacement_mm": displacement,
        "K_eff_kN_mm": stiffness,
        "h_eff": energy / (2.0 * math.pi * stiffness * displacement**2),
        "Q_d_kN": loop.strength,
        "K_d_kN_mm": loop.post_yield,
        "K_1_kN_mm": loop.initial,
        "K_v_kN_mm": vertical,
        "kind": kind,
        "cycle": cycle_number,
        "over_scragged": over_scragged,
        "lead_degC": math.nan if lead is None else lead,
        "K_eff_heated_kN_mm": heated,
    }


def initial_stiffness_note(lines: "pd.DataFrame") -> str:
    """Return which K_1/K_d is assumed, with its source and where a fat loop needs more of it."""
    kinds = dict.fromkeys(kind for kind in lines["kind"] if kind)
    if not kinds:
        return ""
    ratios = [f"{1.0 / post_yield_ratio(kind).K_2_over_K_1:.3g} ({kind})" for kind in kinds]
    sources = dict.fromkeys(post_yield_ratio(kind).source for kind in kinds)
    star = "*" if any(post_yield_ratio(kind).unverified for kind in kinds) else ""
    larger = dict.fromkeys(
        f"{row['line_bearing']}: {row['K_1_kN_mm'] / row['K_d_kN_mm']:.3g}"
        for row in lines.to_dict("records")
        if row["kind"]
        and row["K_1_kN_mm"] / row["K_d_kN_mm"]
        > RATIO_SLACK / post_yield_ratio(row["kind"]).K_2_over_K_1
    )
    text = (
        f"K_1 is assumed{star} where the loop of a bearing is not bilinear: K_1/K_d = "
        f"{joined(ratios, 'and')}, {'; '.join(sources)}"
    )
    if larger:
        text += (
            ". A loop with more damping than a bilinear one of this ratio can have needs a larger "
            f"ratio ({'; '.join(larger)})"
        )
    return f"{text}. *: not checked against the published text." if star else f"{text}."


def cycle_note(row: Mapping[Any, Any]) -> str:
    """Return the cycle and the state of the rubber that a line stands for; empty if bilinear."""
    if not row["rubber"]:
        return ""
    cycle = "first" if row["cycle"] == FIRST else "third"
    text = f"{cycle} cycle without heating, {row['rubber']} rubber"
    if row["rubber"] == SCRAGGED:
        return text
    factor = f"{row['over_scragged']:.2f}"
    return f"{text}: effective stiffness {factor} times that of the third cycle, scragged rubber"


def heated_lead_note(row: Mapping[Any, Any]) -> str:
    """Return Q_d with the lead as warm as in the runs; empty where the lead did not warm."""
    if math.isnan(row["lead_degC"]):
        return ""
    return (
        f"Q_d {row['Q_d_heated_kN']:.1f} instead of {row['Q_d_kN']:.1f} kN with the lead at "
        f"{row['lead_degC']:.1f} degC, its highest temperature in the runs"
    )


def beyond_note(row: Mapping[Any, Any]) -> str:
    """Return by how much the temperature of a line is outside the law of its rubber; else empty."""
    beyond = float(row["outside_law_K"])
    if beyond == 0.0:
        return ""
    side = "below" if beyond < 0.0 else "above"
    return f"ambient {abs(beyond):.3g} K {side} the temperature law of the rubber, {row['law']}"


def excess_note(row: Mapping[Any, Any]) -> str:
    """Return that the excess stiffness of rubber is that of another compound; else empty."""
    if VIRGIN_EXCESS not in row["assumed"].split():
        return ""
    return f"excess stiffness of {row['rubber']} rubber assumed, from a test of another compound"


def is_extrapolated(row: Mapping[Any, Any]) -> bool:
    """Return whether temperature or state of the rubber of a line are outside its tests."""
    return bool(beyond_note(row) or excess_note(row))


def bridge_properties(result: "EarthquakeResult", lines: "pd.DataFrame") -> "pd.DataFrame":
    """Return effective period [s], damping ratio and damping factor B_L, by ambient temperature.

    `lines` are those of `line_properties`. The period is that of the first mode with the effective
    stiffness of all lines, the ratio that of the bearings,

    xi = sum n E / (2 pi sum n K_eff D^2),

    without the viscous damping of the structure.
    """
    prepared = _prepared_structure(result)
    structure, matrices = prepared.structure, prepared.matrices
    rows = []
    for key, group in lines.groupby(["bearing", "ambient_degC"], sort=False):
        stiffness = dict(zip(group["line"], group["K_eff_kN_mm"], strict=True))
        # Lines that do not move have no row: they keep the equivalent stiffness of their input.
        stiffnesses = [
            stiffness.get(line.name, line.equivalent_stiffness) for line in structure.bearings
        ]
        total = total_stiffness(structure, matrices, np.array(stiffnesses))
        modes = find_modes(matrices.mass, total, structure.name)
        work = group["count"] * group["K_eff_kN_mm"] * group["design_displacement_mm"] ** 2
        ratio = float((work * group["h_eff"]).sum() / work.sum())
        rows.append(
            dict(zip(("bearing", "ambient_degC"), key, strict=True))
            | {
                "effective_period_s": float(2.0 * math.pi / modes.frequencies[0]),
                "effective_damping_ratio": ratio,
                "B_L": damping_factor().at(ratio),
            }
        )
    return pd.DataFrame(rows)


def _analysed_structure(result: "EarthquakeResult") -> tuple[Structure, dict[str, Any]]:
    """Return the structure of a result and the table `analysis` of its case."""
    case = tomllib.loads(str(result.dataset.attrs["case"]))
    return validated(Structure, case["structure"], "structure"), case["analysis"]


def nominal_stiffness(result: "EarthquakeResult") -> str:
    """Return the stiffness [kN/mm] of one bearing in the modes of a result, or its range, as text.

    It is what the structure states for its lines, whichever bearing and temperature a run has.
    """
    structure, _ = _analysed_structure(result)
    stiffnesses = [line.equivalent_stiffness for line in structure.bearings]
    texts = dict.fromkeys(f"{value:.3g}" for value in (min(stiffnesses), max(stiffnesses)))
    return f"{' to '.join(texts)} kN/mm"


def _prepared_structure(result: "EarthquakeResult") -> Prepared:
    """Return the structure of a result with its matrices and modes, as it was analysed."""
    structure, analysis = _analysed_structure(result)
    return prepare_structure(structure, analysis.get("mass", "consistent"), analysis.get("damping"))


def hysteretic_ratios(
    result: "EarthquakeResult", lines: "pd.DataFrame"
) -> dict[str, NDArray[np.float64]]:
    """Return the equivalent damping ratios of the bearings in each mode, by bearing.

    xi_i = sum h_eff phi_i^T K_line phi_i / (phi_i^T K phi_i) over the lines of `line_properties` at
    the warmest temperature, in the modes with equivalent stiffness. None where the modes of a
    result are those of one direction of a structure in plan.
    """
    prepared = _prepared_structure(result)
    structure, modes = prepared.structure, prepared.modes
    equivalent = np.array([line.equivalent_stiffness for line in structure.bearings])
    ratios: dict[str, NDArray[np.float64]] = {}
    if len(modes.frequencies) != len(np.atleast_1d(result.dataset.attrs["periods_s"])):
        return ratios
    warmest = lines[lines["ambient_degC"] == lines["ambient_degC"].max()]
    for name, group in warmest.groupby("bearing", sort=False):
        ratio_by_line = dict(zip(group["line"], group["h_eff"], strict=True))
        line_ratios = np.array([ratio_by_line.get(line.name, 0.0) for line in structure.bearings])
        lossy = line_stiffness(structure, prepared.matrices, equivalent * line_ratios)
        # The shapes have unit modal mass, so that phi^T K phi is the squared frequency.
        shapes = modes.shapes
        ratios[str(name)] = np.einsum("ni,nm,mi->i", shapes, lossy, shapes) / modes.frequencies**2
    return ratios


def link_text(
    lines: "pd.DataFrame", bridges: "pd.DataFrame", devices: Sequence[DeviceTable] = ()
) -> str:
    """Return the properties as link elements of other programs take them, in kN and m.

    SAP2000 and CSiBridge: link of type "Rubber Isolator", directions U2 and U3; midas Civil:
    general link of type "Lead Rubber Bearing Isolator", directions y and z. The yield strength is
    Q_d K_1/(K_1 - K_d), the effective damping h_eff K_eff T_eff/pi with the effective period of the
    bridge. `bridges` are those of `bridge_properties`, `devices` those of the structure, parallel
    to its bearings.
    """
    text = [
        "Properties of one bearing in kN and m, at its design displacement and temperature.",
        "SAP2000, CSiBridge: link Rubber Isolator, U2 and U3. midas Civil: general link",
        "Lead Rubber Bearing Isolator, y and z. Coldest: upper values. Warmest: lower values.",
        "All without heating: a bearing that warms in an earthquake is softer.",
    ]
    for note in (*LINK_NOTES, *_state_notes(lines), initial_stiffness_note(lines)):
        text += textwrap.wrap(note, LINK_WIDTH)
    periods = bridges.set_index(["bearing", "ambient_degC"])["effective_period_s"]
    for row in lines.to_dict("records"):
        period = float(periods.loc[row["bearing"], row["ambient_degC"]])
        text.append(
            f"\n{row['line']}: {row['count']} bearings {row['line_bearing']} at "
            f"{row['ambient_degC']:g} degC"
        )
        upper = row["ambient_degC"] == lines["ambient_degC"].min()
        keys = ", ".join(assumed_in_file(row))
        assumed = f"assumed in the bearing file: {keys}" if keys else ""
        phrases = [cycle_note(row), assumed, beyond_note(row), excess_note(row)]
        phrases += [heated_lead_note(row), secant_note(row) if upper else ""]
        for phrase in phrases:
            text += textwrap.wrap(phrase, LINK_WIDTH, initial_indent="  ", subsequent_indent="  ")
        text += [
            _link_row(name, value, unit)
            for name, value, unit in _link_values(row, period)
            if not math.isnan(value)  # the vertical stiffness of a bilinear bearing
        ]
    if devices:
        text += ["", *textwrap.wrap(DEVICES_NOTE, LINK_WIDTH)]
    for device in devices:
        text += [f"\n{device.title()}", *(_link_row(*constant) for constant in device.constants())]
    return "\n".join(text) + "\n"


def _link_row(name: str, value: float, unit: str) -> str:
    return f"  {name:37}{value:12.5g} {unit}".rstrip()


def structure_devices(result: "EarthquakeResult") -> Sequence[DeviceTable]:
    """Return the devices parallel to the bearings of a result."""
    return _analysed_structure(result)[0].devices or ()


def _link_values(row: Mapping[Any, Any], period: float) -> list[tuple[str, float, str]]:
    """Return name, value and unit of each property; `period` is that of the bridge [s]."""
    loop = BilinearParameters(row["Q_d_kN"], row["K_d_kN_mm"], row["K_1_kN_mm"])
    keys = row["assumed"].split()
    # Yield stress changes neither K_1 nor K_d; the bearing's own K_1/K_d is that of its kind.
    measured = not any(key in (*STIFFNESS, *COEFFICIENTS) for key in keys)
    stiff = not measured or is_extrapolated(row)
    of_any, of_ratio = (" (assumed)" * bool(flag) for flag in (keys, stiff or row["kind"]))
    # That of scragged rubber, in the cold at the reference temperature.
    of_vertical = " (assumed)" * (not measured or row["outside_law_K"] > 0.0)
    effective = KILO * row["K_eff_kN_mm"]
    damping = row["h_eff"] * effective * period / math.pi
    displacement = row["design_displacement_mm"] / KILO
    return [
        ("design displacement", displacement, f"m ({row['design_displacement_of']})"),
        (f"effective stiffness{of_any}", effective, "kN/m"),
        (f"effective damping ratio{of_any}", row["h_eff"], ""),
        (f"effective damping{of_any}", damping, f"kN s/m (T_eff {period:.4g} s)"),
        (f"stiffness before yielding{of_ratio}", KILO * row["K_1_kN_mm"], "kN/m"),
        (f"yield strength{of_any}", loop.yield_force, "kN"),
        (f"post-yield stiffness ratio{of_ratio}", row["K_d_kN_mm"] / row["K_1_kN_mm"], ""),
        (f"vertical stiffness{of_vertical}", KILO * row["K_v_kN_mm"], "kN/m"),
    ]


def _state_notes(lines: "pd.DataFrame") -> list[str]:
    """Return sentences on rubber that is stiffer while virgin, and on lower values of it."""
    excess, scragged = lines["excess"].astype(bool), lines["rubber"] == SCRAGGED
    stiffer, virgin = excess & scragged, excess & ~scragged
    return [
        note.format(names=joined(list(dict.fromkeys(lines.loc[chosen, "line_bearing"])), "and"))
        for note, chosen in ((VIRGIN_NOTE, stiffer), (LOWER_NOTE, virgin))
        if chosen.any()
    ]


def secant_note(row: Mapping[Any, Any]) -> str:
    """Return that a run has a larger stiffness than the effective one; empty where none has."""
    if row["secant_kN_mm"] <= RUN_SLACK * row["K_eff_kN_mm"]:
        return ""
    return (
        f"the effective stiffness is below the {KILO * row['secant_kN_mm']:.5g} kN/m of a run, its "
        f"largest force over its largest displacement ({row['secant_of']}): it is that at the "
        "design displacement"
    )


def assumed_in_file(row: Mapping[Any, Any]) -> list[str]:
    """Return the keys of the bearing file whose numbers a line rests on and were not measured."""
    return [key for key in row["assumed"].split() if key not in (EXTRAPOLATED, VIRGIN_EXCESS)]


def periods_table(
    result: "EarthquakeResult",
    hysteretic: Mapping[str, Floats] | None = None,
    mode_limit: int | None = None,
) -> tuple[Table, "pd.DataFrame"]:
    """Return the first modes as a table, and all of them as a frame; empty without a run.

    Their periods and viscous damping ratios are those with the equivalent stiffness that the
    structure states for its lines, not with K_eff of `line_properties`. `hysteretic` are
    ratios by bearing (`hysteretic_ratios`), `mode_limit` is how many modes the table has.
    """
    attrs = result.dataset.attrs
    if "periods_s" not in attrs:
        return make_table(pd.DataFrame()), pd.DataFrame()
    frame = pd.DataFrame({"period_s": np.atleast_1d(attrs["periods_s"])})
    frame["damping_ratio"] = np.atleast_1d(attrs["damping_ratios"])
    frame.insert(0, "mode_number", range(1, len(frame) + 1))
    period = quantity("period_s", head="Period, entered stiffness", form=".3f")
    columns: list[str | Quantity] = ["mode_number", period]
    columns.append(quantity("damping_ratio", head="Viscous damping ratio"))
    sentences = [
        "Periods and damping ratios are those with the equivalent stiffness that was entered for "
        "each bearing line."
    ]
    if hysteretic:
        sentences.append(
            "The effective period and damping of the bridge, with K_eff of its bearings at their "
            "design displacement, have their own table. Hysteretic damping of the bearings is "
            "equivalent, at their design displacement and warmest temperature, by their share in "
            "the strain energy of the mode; it is not in the viscous ratio."
        )
    # With one bearing, or lines with their own on one bridge, the heads name none.
    labels = result.bearing_labels
    ends = {name: f", {label}" if len(labels) > 1 else "" for name, label in labels.items()}
    for name, ratios in (hysteretic or {}).items():
        frame[f"hysteretic_{name}"] = ratios
        ratio = quantity("damping_ratio", head=f"Hysteretic damping ratio{ends[name]}")
        columns.append(replace(ratio, name=f"hysteretic_{name}"))
    for name in dict.fromkeys(result["bearing"].values.tolist()):
        frame[name] = np.atleast_1d(attrs[f"initial_periods_s:{name}"])
        columns.append(replace(period, name=name, head=f"Initial period{ends[name]}"))
    sentences.append(
        "Initial periods use the stiffness of the bearings before yielding, at the temperature of "
        "the first run."
    )
    if mode_limit is not None and len(frame) > mode_limit:
        sentences.append(f"The first {mode_limit} of {len(frame)} modes; all are in {MODES_FILE}.")
    caption = "Natural periods and damping" if hysteretic else "Natural periods and viscous damping"
    if result.directions and not result.in_plan:
        caption += f" along {result.directions[0]}"
    shown = frame.head(mode_limit or len(frame))
    return make_table(shown, columns, caption, note=" ".join(sentences)), frame
