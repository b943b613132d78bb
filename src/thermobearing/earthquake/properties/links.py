"""Equivalent properties of bearing lines as link elements of other programs take them."""

import math
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

from thermobearing.bearing.sources import (
    COEFFICIENTS,
    STIFFNESS,
)
from thermobearing.border.lazy import pd
from thermobearing.earthquake.properties.notes import (
    EXTREMES,
    HEATED_COLUMNS,
    KILO,
    OTHER_DISPLACEMENTS,
    SCRAGGED,
    assumed_in_file,
    beyond_note,
    bound_note,
    bounded_note,
    cold_lead_note,
    cycle_note,
    elastic_note,
    excess_note,
    heated_lead_note,
    initial_stiffness_note,
    is_extrapolated,
    is_lower,
    is_upper,
    left_out_note,
    secant_note,
    untested_note,
    with_bounds,
)
from thermobearing.earthquake.properties.peaks import (
    MOST_HALVINGS,
    PEAKS,
    TOLERANCE,
    halving_clause,
    is_settled,
    milliseconds,
)
from thermobearing.earthquake.properties.trials import (
    Trials,
    shortfall_note,
    trial_columns,
    upper_note,
)
from thermobearing.model.earlier import BilinearParameters
from thermobearing.quantities.words import counted, joined, percent
from thermobearing.structure.connections.model import DeviceTable

LINK_WIDTH = 79  # letters of a line of links.txt
LINK_NOTES = (
    EXTREMES,
    OTHER_DISPLACEMENTS,
    "The effective damping is the coefficient of a dashpot, C = h K_eff T_eff/pi, with the "
    "effective damping ratio h and the effective period T_eff of the bridge: the field Effective "
    "Damping of SAP2000 and CSiBridge, of linear load cases, takes C and not the ratio.",
    "bounds.csv of lambda has other loops: of one bearing at the strain of a test, its softest "
    "heated and its stiffest first cycle, with K_1 by a ratio to K_2 that is usual for its kind; "
    "these links are of the displacements of the bridge. Here K_1 of a bearing with a bilinear "
    "loop (linear rubber with lead) is its own initial stiffness K_0.",
    "(assumed): rests on a number that was assumed, borrowed or chosen, and not measured, or on a "
    "strain or temperature outside the tests of the bearing.",
)
DEVICES_NOTE = (
    "Devices parallel to bearings, one of each, in kN, m and s. Damper: link Damper - Exponential "
    "of SAP2000 and CSiBridge (F = C |v|^alpha, rigid brace). Slider: link Friction Isolator "
    "without radius. Gap: links Gap and Hook, which lose nothing in an impact. Their damping is "
    "not in the effective damping above, and other programs do not know the temperature of the "
    "oil: enter C times its factor."
)
VIRGIN_NOTE = (
    "Rubber of {names} is scragged here. Virgin rubber is stiffer, most in its first cycle: for "
    "upper values that count on it, run the analysis with --state virgin."
)
LOWER_NOTE = (
    "Rubber of {names} is not scragged here. Take lower values from an analysis of scragged rubber "
    "(--state tested)."
)


def link_text(
    lines: "pd.DataFrame",
    bridges: "pd.DataFrame",
    devices: Sequence[DeviceTable] = (),
    trials: Trials | None = None,
) -> str:
    """Return the properties as link elements of other programs take them, in kN and m.

    SAP2000 and CSiBridge: link of type "Rubber Isolator", directions U2 and U3; midas Civil:
    general link of type "Lead Rubber Bearing Isolator", directions y and z. The yield strength is
    Q_d K_1/(K_1 - K_d), the effective damping h_eff K_eff T_eff/pi with the effective period of the
    bridge. `bridges` are those of `bridge_properties`, `devices` those of the structure, parallel
    to its bearings. `lines` may be of several states of the rubber; `trials` are the peaks of the
    bridge with these links.
    """
    lines = with_bounds(lines)
    text = [
        "Properties of one bearing in kN and m, at its design displacement and temperature.",
        "SAP2000, CSiBridge: link Rubber Isolator, U2 and U3. midas Civil: general link",
        "Lead Rubber Bearing Isolator, y and z. A model has all upper or all lower values.",
        "All without heating: a bearing that warms in an earthquake is softer. Lines with",
        "lead have a second block of lower values, with the lead as warm as in the",
        "runs and T_eff without heating.",
    ]
    notes = [
        *LINK_NOTES,
        bounded_note(lines),
        *_state_notes(lines),
        left_out_note(lines),
        initial_stiffness_note(lines),
    ]
    for note in [*notes, trials_note(trials) if trials else ""]:
        text += textwrap.wrap(note, LINK_WIDTH)
    periods = bridges.set_index(["bearing", "state", "ambient_degC"])["effective_period_s"]
    for row in lines.to_dict("records"):
        period = float(periods.loc[row["bearing"], row["state"], row["ambient_degC"]])
        text.append(
            f"\n{row['line']}: {row['count']} bearings {row['line_bearing']} at "
            f"{row['ambient_degC']:g} degC"
        )
        keys = ", ".join(assumed_in_file(row))
        assumed = f"assumed in the bearing file: {keys}" if keys else ""
        phrases = [
            bound_note(row, lines),
            elastic_note(row),
            cycle_note(row),
            assumed,
            untested_note(row),
            beyond_note(row),
            excess_note(row),
        ]
        phrases += [cold_lead_note(row), heated_lead_note(row), secant_note(row) * is_upper(row)]
        for phrase in phrases:
            text += textwrap.wrap(phrase, LINK_WIDTH, initial_indent="  ", subsequent_indent="  ")
        text += _link_rows(_link_values(row, period)) + _trial_rows(trials, row)
        if is_lower(row) and not math.isnan(row["lead_degC"]):
            lead = f"{row['lead_degC']:.1f} degC, its highest temperature in the runs"
            text += [f"  {bound_note(row, lines, heated=True)}", f"  with the lead at {lead}"]
            # Vertical stiffness and design displacement are those above.
            text += _link_rows(_link_values(_with_heated_lead(row), period)[1:-1])
        if is_lower(row):
            text += _trial_rows(trials, row, heated=True)
    if devices:
        text += ["", *textwrap.wrap(DEVICES_NOTE, LINK_WIDTH)]
    for device in devices:
        text += [f"\n{device.title()}", *(_link_row(*constant) for constant in device.constants())]
    return "\n".join(text) + "\n"


def trials_note(trials: Trials) -> str:
    """Return what the peaks with links are, what was run for them, and why some are missing."""
    reasons = "; ".join(trials.reasons)
    if not trials.runs:
        return f"The bridge was not run with these links: {reasons}." if reasons else ""
    missing = f"; not of all links: {reasons}" if reasons else ""
    runs = counted(trials.runs, "more run")
    if trials.coupled_runs:
        runs += f" with links and {trials.coupled_runs} of the coupled analysis"
    return (
        "Peaks with links are those of the same bridge and motions with the links of all lines in "
        f"place of the bearings, next to those of the coupled analysis ({runs}{missing}). "
        f"{_left_out_note(trials)}{_steps_note(trials.rows)} {upper_note(trials.rows)}"
    ).rstrip()


def _left_out_note(trials: Trials) -> str:
    """Return which runs the peaks of trials leave out, as a sentence that others follow."""
    if not trials.left_out:
        return ""
    return (
        "The motions of runs that end early are left out of both, so that larger peaks are not "
        f"known: {'; '.join(trials.left_out)}. "
    )


def _steps_note(rows: "pd.DataFrame") -> str:
    """Return the steps at which peaks of trials settled, and which did not, in sentences."""
    steps, exceptions = [], dict[str, None]()
    for name, words in (("links", "with links"), ("coupled", "coupled")):
        ends = sorted(set(rows[f"{name}_step_s"]))
        shown = [milliseconds(ends[0]).removesuffix(" ms")] * (ends[0] < ends[-1])
        steps.append(f"{words} at {' to '.join([*shown, milliseconds(ends[-1])])}")
        for row in rows.to_dict("records"):
            halvings, change = row[f"{name}_halvings"], row[f"{name}_change"]
            if not is_settled(halvings, change):
                clause = halving_clause(halvings, change)
                exceptions[f"{_analysis_name(row, name)}, {clause}"] = None
    text = (
        "Both were repeated at half the time step until two halvings in a row moved no peak by "
        f"more than {percent(TOLERANCE)} ({', '.join(steps)})."
    )
    if exceptions:
        text += (
            f" Exceptions, after {MOST_HALVINGS} halvings or before too many steps, whose ratios "
            f"are as uncertain as stated: {'; '.join(exceptions)}."
        )
    return text


def _analysis_name(row: Mapping[Any, Any], name: str) -> str:
    """Return the name of an analysis with links of a row, or of the coupled one, in words."""
    rubber = f"{row['rubber']} rubber".strip()
    if name == "coupled":  # of all temperatures
        return f"coupled analysis with {rubber}"
    heated = " and heated lead" * bool(row["lead"])
    return f"links of {rubber}{heated} at {row['ambient_degC']:g} degC"


def _trial_rows(
    trials: Trials | None, row: Mapping[Any, Any], *, heated: bool = False
) -> list[str]:
    """Return peaks of a line with its links and of the coupled analysis, as rows of text."""
    if trials is None or trials.rows.empty:
        return []
    rows = trials.rows
    chosen = rows["lead"] == ("heated" if heated else "")
    for key in ("bearing", "line", "state", "ambient_degC"):
        chosen &= rows[key] == row[key]
    if not chosen.any():
        return []
    (peaks,) = rows[chosen].to_dict("records")
    links = "these links and heated lead" if heated else "these links"
    text = [f"  the bridge with {links} in place of bearings"]
    largest = "mean largest" if row["design_displacement_of"].startswith("mean") else "largest"
    for peak_name, unit in PEAKS.values():
        with_links, coupled, ratio = (peaks[name] for name in trial_columns(peak_name, unit))
        scale, metres = (KILO, "m") if unit == "mm" else (1.0, unit.replace("_", " "))
        if math.isfinite(ratio):
            other = f"{metres} (coupled {coupled / scale:.5g}, ratio {ratio:.2f})"
            text.append(
                _link_row(f"{largest} {peak_name.replace('_', ' ')}", with_links / scale, other)
            )
    coupled_step = f"s (coupled {peaks['coupled_step_s']:.4g})"
    text.append(_link_row("time step of these peaks", peaks["links_step_s"], coupled_step))
    note = shortfall_note(rows[chosen])
    return text + textwrap.wrap(note, LINK_WIDTH, initial_indent="  ", subsequent_indent="  ")


def _link_rows(values: Sequence[tuple[str, float, str]]) -> list[str]:
    """Return values as rows; the vertical stiffness of a bilinear bearing and no yield are NaN."""
    return [_link_row(*value) for value in values if not math.isnan(value[1])]


def _with_heated_lead(row: Mapping[Any, Any]) -> dict[Any, Any]:
    """Return a line with the properties that it has with the lead as warm as in the runs."""
    heated = {name.replace("_heated", ""): row[name] for name in HEATED_COLUMNS}
    return dict(row) | heated


def _link_row(name: str, value: float, unit: str) -> str:
    return f"  {name:37}{value:12.5g} {unit}".rstrip()


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
    """Return sentences on rubber that is stiffer while virgin, and on lower values of it.

    Of bearings whose other state is among the lines there is none.
    """
    scragged = lines["rubber"] == SCRAGGED
    names_with_both = set(lines.loc[scragged, "line_bearing"]) & set(
        lines.loc[~scragged, "line_bearing"]
    )
    excess = lines["excess"].astype(bool) & ~lines["line_bearing"].isin(names_with_both)
    stiffer, virgin = excess & scragged, excess & ~scragged
    return [
        note.format(names=joined(list(dict.fromkeys(lines.loc[chosen, "line_bearing"])), "and"))
        for note, chosen in ((VIRGIN_NOTE, stiffer), (LOWER_NOTE, virgin))
        if chosen.any()
    ]
