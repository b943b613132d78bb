"""Report of an analysis of earthquakes: scope, inputs, summary, checks, figures."""

import copy
import tomllib
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes

from thermobearing import reported
from thermobearing.border.schema import validated
from thermobearing.border.units import with_unit
from thermobearing.cyclic.report import rig_table
from thermobearing.earthquake.analysis import OtherBound
from thermobearing.earthquake.answer import (
    Shown,
    few_motions,
    find_other_bound,
    governing_lines,
    governing_pier,
    largest_place,
    main_results,
    strength_note,
)
from thermobearing.earthquake.case import EarthquakeAnalysis, in_weather, list_bearing_tables
from thermobearing.earthquake.figures import MN_M, EarthquakeFigures
from thermobearing.earthquake.measures import tested_rows, tested_to
from thermobearing.earthquake.motions import given_motions_table
from thermobearing.earthquake.panels import (
    MOST_COLUMNS,
    part_names,
    select_part,
)
from thermobearing.earthquake.properties.lines import more_motions_action
from thermobearing.earthquake.properties.loads import dead_load_table, direction_note
from thermobearing.earthquake.properties.notes import (
    temperature_note,
)
from thermobearing.earthquake.properties.peaks import (
    Settled,
    settle_bridge,
    step_note,
    step_warning,
)
from thermobearing.earthquake.properties.report import property_tables
from thermobearing.earthquake.properties.strength import (
    StrengthBand,
    action_on_untested,
    run_strength_band,
)
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.tables import structure_balance
from thermobearing.model.limits import CODE_KEYS, CodeChecks, Limits
from thermobearing.model.options import outdoors
from thermobearing.quantities.governing import place_of_largest
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table
from thermobearing.quantities.words import (
    counted,
    degrees,
    joined,
    part_label,
    plain,
    quantity,
    tidy,
)
from thermobearing.report import content
from thermobearing.report.content import IN_EARTHQUAKES, TESTED_RANGE, input_table
from thermobearing.report.figures import blank_panel, plot_from_axes
from thermobearing.report.pieces import (
    EXCEEDED,
    PASSED,
    Check,
    Pieces,
    Plot,
    ReportFigure,
    Trace,
)
from thermobearing.results import drawing
from thermobearing.results.directory import HISTORY, LINES, PIERS
from thermobearing.structure.report import structure_table

Case = Mapping[str, Any]
MODES = {"rt": "in real time", "pd": "pseudo-dynamic"}
NOT_ASSEMBLED = (
    "Not checked: thermal movement, creep and shrinkage of the deck, which move bearings before "
    "the earthquake, are not in the analysis; the service combination of shear strains of AASHTO "
    "GSID (compression, rotation and non-seismic displacement) is not assembled."
)
DAMPING = {
    "modal": "a ratio for each mode of the structure without its bearings",
    "rayleigh": "Rayleigh, of the structure without its bearings",
    "element": "a dashpot parallel to every spring and hinge",
    "source": "Rayleigh as in Shen (2023), of the structure on its bearings",
    "source-with-bearings": "Rayleigh as in Eq. 3.3 of Shen (2023), with the stiffness of bearings",
}


def _input_tables(result: EarthquakeResult, case: Case) -> dict[str, Table]:
    """Return the inputs as tables, by name."""
    sources = case.get("sources", {})
    tables = {
        "structure": structure_table(case["structure"], sources.get(case["structure"]["name"])),
        "motions": given_motions_table(case["motions"], result),
    }
    for bearing in list_bearing_tables(case):
        tables |= reported.bearing_tables(bearing, sources.get(str(bearing["name"])))
    if len(vertical := reported.vertical_table(list_bearing_tables(case))):
        tables["vertical"] = vertical
    if case.get("lines"):
        tables["lines"] = _lines_table(case)
    if case["command"] == "bridge" and len(loads := dead_load_table(result)):
        tables["dead_loads"] = loads
    climate = {key: case[key] for key in ("ambient", "weather", "duration") if key in case}
    tables["climate"] = input_table("Ambient temperature and duration", climate, otherwise="input")
    if codes := case.get("codes"):
        tables["codes"] = _codes_table(case, codes)
    if "laboratory" in case:
        lab = {"laboratory": case["laboratory"]}
        tables["laboratory"] = input_table("Laboratory", lab, otherwise="input, or default")
    if "rig" in case:
        tables["rig"] = rig_table(case["rig"], sources.get(case["rig"].get("name")))
    # The table marks what differs from the defaults, which are those of the command and climate.
    defaults: dict[str, Any] = {}
    if case["command"] == "hybrid":
        defaults["method"] = "predictor-corrector"
    default_sources: dict[str, str] = {}
    if in_weather(case):
        outdoor, default_sources = outdoors()
        defaults |= outdoor
    tables["analysis"] = reported.analysis_table(
        case["analysis"], EarthquakeAnalysis(**defaults), default_sources
    )
    return tables


def _codes_table(case: Case, codes: list[str]) -> Table:
    """Return what the checks after codes count on, and which of it is the default."""
    checks = validated(CodeChecks, {key: case[key] for key in CODE_KEYS if key in case}, "codes")
    values: dict[str, Any] = {"codes": ", ".join(codes), "zone": checks.seismic_zone}
    values["rotation"] = with_unit(checks.design_rotation, "rad")
    sources = {key: "input" if key in case else reported.DEFAULT for key in values}
    return input_table("Checks of bearings after codes", values, sources)


def _lines_table(case: Case) -> Table:
    rows = []
    for line in case["lines"]:
        bearing = line.get("bearing")
        name = str(bearing["name"]) if bearing else "as of the analysis"
        ambient = line.get("weather") or "as of the analysis"
        ambient = quantity(line["ambient"]) if "ambient" in line else Path(ambient).name
        rubber = line.get("state", {})
        state = " after ".join(map(str, filter(None, (rubber.get("rubber"), rubber.get("after")))))
        rows.append((str(line["line"]), name, ambient, state or "as of the analysis"))
    columns = [Quantity("Line"), Quantity("Bearing"), Quantity("Ambient temperature")]
    if any("state" in line for line in case["lines"]):
        columns.append(Quantity("Rubber"))
    # Without a state of any line the rows lose their last cell, "as of the analysis".
    cells = [row[: len(columns)] for row in rows]
    return Table("Bearing lines with their own settings", columns, cells)


def _question(result: EarthquakeResult, case: Case) -> str:
    structure = case["structure"]
    description = f" ({text})" if (text := structure.get("description")) else ""
    bearings = _bearings_in_words(result, case)
    motions = list(dict.fromkeys(str(name) for name in result["motion"].values))
    motion_names = joined(motions) if len(motions) <= 6 else counted(len(motions), "motion")
    if case.get("weather"):
        climate = f"after the weather of {Path(case['weather']).name}"
    else:
        climate = f"at ambient {degrees(list(dict.fromkeys(result['ambient'].values.tolist())))}"
    noun = "motions" if len(motions) > 1 else "motion"
    demands = "the displacements and forces of the bearings"
    demands += " and the demand on the piers" if result.has_pier else ""
    shaking = f"in the ground {noun} {motion_names}, {climate}"
    if case["command"] == "hybrid":
        modes = joined(MODES[mode] for mode in dict.fromkeys(result.modes) if mode in MODES)
        return (
            f"This report gives {demands} in a hybrid test of {structure['name']}{description}, "
            f"{modes}, with a specimen of {bearings} in the loop, {shaking}."
        )
    return (
        f"This report gives {demands} of {structure['name']}{description} with {bearings}, "
        f"{shaking}."
    )


def _bearings_in_words(result: EarthquakeResult, case: Case) -> str:
    """Return the bearings of the analysis, with counts and lines where lines differ."""
    described = {str(table["name"]): table for table in list_bearing_tables(case)}
    if not result.line_bearings:
        return joined((reported.bearing_words(table) for table in case["bearings"]), "or")
    counts = result.lines.drop_duplicates("line").set_index("line")["count"].astype(int)
    choices = []
    for lines in result.line_bearings.values():
        groups: dict[str, list[str]] = {}
        for line, bearing in lines.items():
            groups.setdefault(bearing, []).append(line)
        choices.append(
            joined(
                f"{counts[names].sum()} bearings {reported.bearing_words(described[bearing])} on "
                f"{'lines' if len(names) > 1 else 'line'} {joined(names)}"
                for bearing, names in groups.items()
            )
        )
    return joined(choices, "or")


def _assumptions(result: EarthquakeResult, case: Case) -> list[str]:
    attrs, analysis = result.dataset.attrs, case["analysis"]
    kind = str(attrs["damping"])
    damping = f"Viscous damping: {kind}, {DAMPING[kind]}." if kind in DAMPING else ""
    if kind == "none":
        damping = "No viscous damping: only bearings and plastic hinges dissipate energy."
    plan = result.in_plan
    moves = "in one horizontal direction and rock"
    if plan:
        moves = "in both horizontal directions, rock and may twist"
    hinges = ""
    if case["structure"].get("hinges"):
        directions = ", each direction on its own" if plan else ""
        hinges = f"Plastic hinges lose stiffness as in Takeda's rules{directions}."
    start = "Each bearing starts at the ambient temperature, which stays constant."
    if "weather" in case:
        start = "Bearings start at the temperatures that the weather before the motion leaves."
    if "initial_state" in case:
        start = (
            "The bearing starts as the earlier test left it, with its temperatures and its history."
        )
    sentences = [
        f"Decks, piers and footings are rigid bodies that move {moves}, on linear springs of the "
        "foundations. P-delta effects are not included.",
        hinges,
        "All bearings of a line are identical; forces and energies are those of one bearing.",
        damping,
        _damping_note(result),
        f"Mass: {analysis['mass']}. Time integration: {analysis['method'].replace('-', ' ')}, "
        f"steps of at most {quantity(analysis['dt'])}.",
        start,
    ]
    if case["command"] == "bridge":
        sentences += [direction_note(result), NOT_ASSEMBLED]
    sentences += _laboratory(case)
    layered = any(table.get("kind") != "bilinear" for table in list_bearing_tables(case))
    sentences += [reported.undecided()] if layered and result.bands.empty else []
    sentences += reported.model_assumptions(analysis, list_bearing_tables(case), plane=plan)
    sentences += [temperature_note(case), strength_note(case)]
    return [text for text in sentences if text]


def _damping_note(result: EarthquakeResult) -> str:
    """Return the share of the damping in the input energy, unless it is small or a warning."""
    note = result.damping_note
    return tidy(note) if note and note not in result.warnings else ""


def _laboratory(case: Case) -> list[str]:
    lab = case.get("laboratory")
    if not lab:
        return []
    scales = {float(line.get("scale", 1.0)) for line in case["structure"]["bearings"]}
    sentences = []
    if scales != {1.0}:
        ratios = joined(f"1:{1.0 / scale:.3g}" for scale in sorted(scales))
        sentences.append(
            f"The specimen represents bearings of the structure at a scale of {ratios}."
        )
    if "pd" in lab["mode"]:
        sentences.append(
            f"The pseudo-dynamic test is slower than the earthquake: the actuator moves at "
            f"{quantity(lab['speed'])}, and the specimen cools meanwhile."
        )
    if lab.get("specimen"):
        sentences.append(
            f"A specimen at {lab['specimen']} took the place of the modelled bearing. Its force "
            "and energy were measured; temperatures and shares of the force were calculated along "
            "the same displacements."
        )
    if lab.get("compensation"):
        sentences.append(
            f"Commands are extrapolated by the delay, {quantity(lab['delay'])}, with a polynomial "
            f"of order {lab['compensation']} (Horiuchi et al., 1999)."
        )
    errors = [
        f"{name} {quantity(lab[key])}"
        for key, name in (("delay", "delay"), ("force_noise", "noise of the force"))
        if not (key == "delay" and lab.get("specimen"))  # its own
        and float(str(lab.get(key, "0")).split()[0]) > 0.0
    ]
    if errors:
        sentences.append(f"Errors of the laboratory: {joined(errors)}.")
    elif not lab.get("specimen"):  # a specimen outside has the errors of its own actuator
        sentences.append("The actuator is ideal.")
    return sentences


COMMANDS = {"bridge": "Earthquake analysis", "hybrid": "Hybrid test"}


def build_pieces(result: EarthquakeResult) -> Pieces:
    """Return the content of the document of `bridge` or `hybrid`, live or loaded again."""
    attrs = result.dataset.attrs
    case = tomllib.loads(attrs["case"])
    command, outside = str(attrs["command"]), bool(case.get("laboratory", {}).get("specimen"))
    energy = result.energy if result.runs else None
    bound = find_other_bound(result)
    strengths = run_strength_band(result)
    settled: dict[str, Settled] = {}  # by the state of the rubber; "" is that of the analysis
    if command == "bridge" and result.runs:
        settled[""] = settle_bridge(result)
        if isinstance(bound, OtherBound):
            settled[str(bound.state.rubber)] = settle_bridge(bound.result)
    properties, files = property_tables(*settled.values()) if settled else ({}, {})
    shared = content.result_parts(result, str(attrs["case"]), command)
    return content.build_pieces(
        command,
        f"{COMMANDS[command]} of {attrs['structure']}",
        _question(result, case),
        main_results(result, bound, strengths),
        judged=result.runs > 0,
        inputs=_input_tables(result, case),
        tables={**(result.tables() if result.runs else {}), **properties},
        files=files,
        figures=_report_figures(result),
        checks=_report_checks(result, case),
        rate_rows=tested_rows(result),
        lead_rise=float(np.fmax(result.largest_rises()["lead_rise_K"].max(), 0.0)),
        residuals=(
            ()
            if energy is None
            else reported.residual_rows(energy, case["analysis"], measured=outside)
        ),
        energy=structure_balance(result) if result.runs else None,
        assumptions=[
            *_assumptions(result, case),
            *filter(None, (step_note(item, rubber) for rubber, item in settled.items())),
        ],
        range_action=_range_action(result),
        first_actions=_first_actions(result, case, strengths),
        identity=shared["identity"],
        warnings=[
            *shared["warnings"],
            *filter(None, (step_warning(item, rubber) for rubber, item in settled.items())),
        ],
    )


def _first_actions(
    result: EarthquakeResult, case: Case, strengths: StrengthBand | None
) -> list[str]:
    """Return what to do before all that checks ask for: more motions, tests of bearings."""
    actions = [few_motions(result, more_motions_action)]
    if case["command"] == "bridge":
        actions.append(action_on_untested(case, strengths))
    return [text for text in actions if text]


def _range_action(result: EarthquakeResult) -> str:
    """Return what to do where ambient temperatures are outside the tests of a bearing; else ""."""
    outside: dict[str, set[float]] = {}
    for row in result.tested_range.to_dict("records"):
        if row["limit"] == "ambient" and row["outside"]:
            name = f"{str(row['run']).partition(', ')[0]} (tested at {row['lowest']:g} to "
            outside.setdefault(f"{name}{row['largest']:g} °C)", set()).add(float(row["demand"]))
    if not outside:
        return ""
    ambients = sorted(set().union(*outside.values()))
    return plain(
        f"All results at {degrees(ambients)} are outside the calibration range of "
        f"{joined(outside)}. Have the bearing tested at this temperature, or enter the maker's "
        "data of it; until then take the larger of the factors of a code and of this model at "
        "this temperature (`thermobearing lambda` states both). Extend the range by tests for "
        "other results outside it."
    )


def _report_checks(result: EarthquakeResult, case: Case) -> list[Check]:
    if not result.runs:
        return []
    names = [str(table["name"]) for table in list_bearing_tables(case)]
    source = f"{TESTED_RANGE} of the bearing"
    return _ductilities(result, case) + reported.result_checks(
        result, case, IN_EARTHQUAKES, source, names, tested_rows(result)
    )


def _ductilities(result: EarthquakeResult, case: Case) -> list[Check]:
    """Return whether each pier stays below the entered ductility, or elastic without one."""
    limits = validated(Limits, case["limits"], "limits") if case.get("limits") else None
    entered = None if limits is None else limits.of("pier", "ductility")
    limit, source = 1.0, "first yield of the hinge"
    if entered is not None:
        limit, source = entered.number, entered.describe()
    piers, names = result.piers, result.run_names
    if len(piers) and piers["ductility"].notna().any():
        columns = [
            (part_label("pier", str(name)), rows["ductility"].to_numpy(dtype=float))
            for name, rows in piers.groupby("pier", sort=False)
        ]
    else:
        columns = [("pier", result.table["pier_ductility"].to_numpy(dtype=float))]
    checks = []
    for subject, values in columns:
        if np.isfinite(values).any():
            place = place_of_largest(values)
            run = names[place]
            if result.line_bearings:  # a pier carries lines of several bearings
                run = run.removeprefix(f"{result['bearing'].values[place]}, ")
            label = f"ductility of {subject} ({plain(run)})"
            largest = float(values[place])
            verdict = PASSED if largest <= limit else EXCEEDED
            checks.append(Check(label, largest, limit, "", source, verdict))
    return checks


ALONG = {"x": "along the bridge", "y": "across the bridge"}
OF_LINES, OF_PIERS = ("loops", "strain"), ("pier", "hinge")  # figures of what governs
BY_MOTION = (  # figures with a column for each motion
    *OF_LINES,
    *OF_PIERS,
    "deck",
    "pier_acceleration",
    "temperature",
    "energy",
    "largest_loops",
    "orbit",
)
MOST_NAMES = 6  # of motions in a caption
OF_HEAT = ("temperature", "profiles")  # of the reported line only
OF_ALL = ("peaks", "parts", "deck", "motion_spectra")  # figures of the structure
LARGEST = {  # figure: column of the table, words for those who do not see the figure
    "loops": ("bearing_strain_max", "largest shear strain {:.0%}"),
    "strain": ("bearing_strain_max", "largest shear strain {:.0%}"),
    "pier": ("pier_displacement_max_mm", "largest {:.1f} mm"),
    "hinge": ("pier_ductility", "largest ductility {:.2f}"),
    "deck": ("deck_acceleration_max_m_s2", "largest {:.2f} m/s²"),
    "pier_acceleration": ("pier_top_acceleration_max_m_s2", "largest {:.2f} m/s²"),
}


def _report_figures(result: EarthquakeResult) -> dict[str, ReportFigure]:
    drawings = result.plot.draw_all() if result.runs else {}
    # Figures of the resultant, or of the only direction, have plain names; "loops_x" is of x.
    views = {"": result.resultant}
    views |= {direction: result.sel(direction=direction) for direction in result.directions}
    plots = {direction: _Plots(view) for direction, view in views.items()}
    plot_captions = content.figure_captions("earthquake_plots")
    several = result["bearing"].to_series().nunique() > 1
    compared = ", with all compared bearings in one diagram" if several else ""
    shown: dict[str, list[Shown]] = dict.fromkeys(OF_LINES, governing_lines(result))
    pier = governing_pier(result)
    shown |= dict.fromkeys(OF_PIERS, [pier] if pier else [])
    figures = {}
    for name, caption in content.figure_captions("earthquake").items():
        caption = caption.format(" and every ".join(result.part_kinds), compared)
        plot_caption = plot_captions.get(name, caption)
        caption += _without(result, name)
        for direction, view in views.items():
            figure_name = f"{name}_{direction}" if direction else name
            if figure_name not in drawings:
                continue
            along = f" Direction {direction}, {ALONG[direction]}." if direction else ""
            for number, item in enumerate(shown.get(name, []), 1):
                part = "line" if name in OF_LINES else "pier"
                limits = _limits(view, name, item.name)
                shown_part = f" {item.caption(part)}{along}"
                text = f"{caption}{limits.paper}{shown_part}"
                figures[f"{figure_name}_{number}" if number > 1 else figure_name] = ReportFigure(
                    text,
                    draw=partial(getattr(view.plot, name), **{part: item.name}),
                    alt=text + _largest_drawn(view, name, item.name),
                    plot=plots[direction].convert(name, **{part: item.name}),
                    plot_caption=f"{plot_caption}{limits.plot}{shown_part}",
                )
            if figure_name not in figures:
                shown_parts = f"{_reported_parts(result, name)}{along}"
                limits = _limits(view, name)
                text = f"{caption}{limits.paper}{shown_parts}"
                figures[figure_name] = ReportFigure(
                    text,
                    draw=drawings[figure_name],
                    alt=text + _largest_drawn(view, name),
                    plot=plots[direction].convert(name),
                    plot_caption=f"{plot_caption}{limits.plot}{shown_parts}",
                )
    return figures


class _Limits(NamedTuple):
    """How a figure of paper and an interactive plot show the tested strain, as sentences."""

    paper: str = ""
    plot: str = ""


def _limits(view: EarthquakeResult, name: str, line: str | None = None) -> _Limits:
    """Return how a figure of the strain of a line shows what its tests do not cover."""
    if name not in STRAIN_AXES:
        return _Limits()
    data = select_part(view.dataset, "line", line) if view.has_parts else view.dataset
    motions = list(dict.fromkeys(data["motion"].values.tolist()))[:MOST_COLUMNS]
    runs = [k for k, motion in enumerate(data["motion"].values.tolist()) if motion in motions]
    shaded = content.shaded_note([tested_to(EarthquakeResult(data), runs, "strain")])
    return _Limits(
        shaded, " Dashed where it is exceeded: the largest tested strain." if shaded else ""
    )


def _reported_parts(result: EarthquakeResult, name: str) -> str:
    """Return which line or pier the histories of a figure are of, why, and where others are."""
    if name in OF_ALL:
        return ""
    part, file = "line", LINES
    if name in (*OF_PIERS, "pier_acceleration"):
        part, file = "pier", PIERS
    names = part_names(result.dataset, [part])
    if not names:
        return ""
    others = f"Peaks of each {part} are in {file}."
    chosen = f" Shown: {names}, chosen by the table report of the structure. {others}"
    return f"{chosen}{_hottest_elsewhere(result)}" if name in OF_HEAT else chosen


def _hottest_elsewhere(result: EarthquakeResult) -> str:
    """Return where rubber and lead are hottest, if not on the reported line, as a sentence."""
    lines, reported_line = result.lines, str(result.dataset.attrs["line"])
    places = []
    for material in ("rubber", "lead"):
        values = lines[f"{material}_max_degC"].to_numpy(dtype=float)
        if np.isfinite(values).any():
            place = place_of_largest(np.nan_to_num(values, nan=-np.inf))
            row = lines.iloc[place]
            if row["line"] != reported_line:
                at = f"line {row['line']} ({row['line_bearing']}, {row['motion']})"
                places.append(f"the {material} of {at}, {values[place]:.1f} °C")
    return f" Hottest of all lines: {joined(places)}." if places else ""


def _without(result: EarthquakeResult, name: str) -> str:
    """Return which motions a figure leaves out, and where they are, as a sentence."""
    motions = list(dict.fromkeys(str(motion) for motion in result["motion"].values))
    missing = motions[MOST_COLUMNS:]
    if not missing or name not in BY_MOTION:
        return ""
    names = joined(missing) if len(missing) <= MOST_NAMES else counted(len(missing), "motion")
    return f" Not shown: {names} (the histories are in {HISTORY})."


def _largest_drawn(result: EarthquakeResult, name: str, shown: str | None = None) -> str:
    """Return the largest value that a figure of a line or pier shows, and its run, as a sentence.

    By default that of the reported line or pier.
    """
    if name not in LARGEST:
        return ""
    view, (column, words) = result.dataset, LARGEST[name]
    for part, names in (("line", OF_LINES), ("pier", OF_PIERS)) if result.has_parts else ():
        view = select_part(view, part, shown if name in names else None)
    value, run = largest_place(EarthquakeResult(view), column)
    text = words.format(value).replace("%", " %")
    return f" {text[:1].upper()}{text[1:]} ({run})." if run else ""


MOST_CHOICES = 40  # entries of a menu
MOMENTS = 24  # places of a slider
UNTESTED = "#aa3333"
PLACES = (("rubber", "inner layer", "-"), ("lead", "lead", "--"))
INTERACTIVE = ("loops", "strain", "pier", "deck", "hinge")  # as drawn, but for all of the motion
STRAIN_AXES = {"loops": "x", "strain": "y"}


class _Plots(EarthquakeFigures):
    """Interactive plots: each menu entry is a bearing and a motion, at all temperatures."""

    def __init__(self, result: EarthquakeResult) -> None:
        super().__init__(result)
        several = len(self._bearings) > 1
        self.groups: dict[str, list[int]] = {}
        for run, row in enumerate(self._table.to_dict("records")):
            name = f"{row['bearing']}, {row['motion']}" if several else str(row["motion"])
            if name in self.groups or len(self.groups) < MOST_CHOICES:
                self.groups.setdefault(name, []).append(run)

    def convert(self, name: str, **part: str) -> Plot | None:
        """Return a figure as a plot, of a line or pier; None where it has none or no data."""
        if name == "profiles":
            return self._through_height()
        if name not in (*INTERACTIVE, "temperature"):
            return None
        panels = {}
        for group, runs in self.groups.items():
            view = copy.copy(self)
            view._table = self._table.loc[runs]
            panels[group] = ax = blank_panel()
            with drawing.every_point():
                getattr(view, "_inner" if name == "temperature" else name)(ax, **part)
            if name in STRAIN_AXES and ax.lines:
                line = view._select("line", part.get("line"))
                end = 100.0 * line._result.tested_to(runs, "strain")
                _mark(ax, end, STRAIN_AXES[name], f"tested to {end:g} %", UNTESTED)
            if name == "hinge" and ax.lines:
                _mark(ax, *self._select("pier", part.get("pier"))._yield_moment(runs))
        plot = plot_from_axes(panels, self._handles())
        return plot if plot.choices else None

    def _yield_moment(self, runs: list[int]) -> tuple[float, str, str, str]:
        """Return the moment at first yielding [MN m], its axis, and name and colour of its line.

        The hinge is the same in all runs: the first one that moved it gives the moment.
        """
        moments = [MN_M * point[1] for point in map(self._yield_point, runs) if point]
        moment = abs(moments[0]) if moments else np.inf
        return moment, "y", f"yields at {moment:.3g} MN m", drawing.GREY

    def _label(self, run: int) -> str:
        ambient = degrees([float(self._table["ambient_degC"][run])])
        return f"{ambient}, {self._result.modes[run]}" if len(self._run_modes) > 1 else ambient

    def _inner(self, ax: Axes) -> None:
        """Draw the innermost rubber layer (full) and the lead (dashed) of every run."""
        for run in self._table.index:
            places, time = self._result.places(run), self._values("time", run)
            for material, place, line in PLACES:
                if len(places[place]) and np.isfinite(places[place]).all():
                    name = f"{material}, {self._label(run)}"
                    ax.plot(time, places[place], line, color=self._colour(run), label=name)
        drawing.name_axes(ax, "time [s]", "temperature [°C]")

    def _through_height(self) -> Plot | None:
        """Return temperatures through the height, moved through the motion by a slider."""
        if "temperature" not in self._data:
            return None
        moments = np.linspace(0.0, float(np.nanmax(self._data["time"].values)), MOMENTS)
        choices: dict[str, list[Trace]] = {}
        for name, runs in self.groups.items():
            for run in runs:
                depth = self._data["depth"].values[run]
                in_stack = np.isfinite(depth)
                if not in_stack.any():
                    continue
                time = self._values("time", run)
                steps = np.searchsorted(time, moments).clip(0, len(time) - 1)
                frames = self._data["temperature"].values[run][steps][:, in_stack]
                level = -depth[in_stack]
                levels = np.tile(level, (len(moments), 1))
                look = self._colour(run), "line with points"
                trace = Trace(self._label(run), frames[0], level, *look, levels, frames)
                choices.setdefault(name, []).append(trace)
        if not choices:
            return None
        titles = "temperature [°C]", "level relative to the upper face [mm]"
        entries = [f"{moment:.1f} s" for moment in moments]
        return Plot(*titles, choices, slider=entries, slider_title="time")


def _mark(ax: Axes, end: float, axis: str, label: str, colour: str) -> None:
    """Draw lines at a limit of an axis to either side, as long as the data; none at infinity."""
    if np.isfinite(end):
        low, high = ax.dataLim.intervaly if axis == "x" else ax.dataLim.intervalx
        # Two lines in one, which NaN separates.
        limits, extent = [end, end, np.nan, -end, -end], [low, high, np.nan, low, high]
        points = (limits, extent) if axis == "x" else (extent, limits)
        ax.plot(*points, "--", color=colour, label=label)
