"""Report of an analysis of earthquakes: scope, inputs, summary, checks, figures."""

import math
import tomllib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np

from thermobearing.border.lazy import pd
from thermobearing.cyclic import reported
from thermobearing.cyclic.report import rig_table
from thermobearing.earthquake.case import EarthquakeAnalysis, in_weather
from thermobearing.earthquake.figures import EarthquakeFigures
from thermobearing.earthquake.panels import part_names, select_part
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.tables import balance_table, cold_ratios
from thermobearing.model.options import outdoors
from thermobearing.model.outcomes import INTERRUPTED, MELTED
from thermobearing.quantities.governing import place_of_largest
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table, make_table
from thermobearing.report import content
from thermobearing.report.content import IN_EARTHQUAKES, TESTED_RANGE, input_table
from thermobearing.report.pieces import (
    NOT_ASSESSED,
    PASSED,
    Check,
    Pieces,
    Plot,
    ReportFigure,
    Trace,
)
from thermobearing.report.words import (
    change,
    counted,
    degrees,
    joined,
    number,
    percent,
    plain,
    quantity,
    tidy,
)
from thermobearing.results.base import COMPLETED
from thermobearing.results.writing import from_attribute
from thermobearing.structure.report import structure_table

Case = Mapping[str, Any]
MODES = {"rt": "in real time", "pd": "pseudo-dynamic"}
DAMPING = {
    "modal": "a ratio for each mode of the structure without its bearings",
    "rayleigh": "Rayleigh, of the structure without its bearings",
    "element": "a dashpot parallel to every spring and hinge",
    "source": "Rayleigh as in Shen (2023), of the structure on its bearings",
}


def _input_tables(result: EarthquakeResult, case: Case) -> dict[str, Table]:
    """Return the inputs as tables, by name."""
    sources = case.get("sources", {})
    found = {
        "structure": structure_table(case["structure"], sources.get(case["structure"]["name"])),
        "motions": given_motions_table(case["motions"], result),
    }
    for bearing in _list_all_bearings(case):
        found |= reported.bearing_tables(bearing, sources.get(str(bearing["name"])))
    if case.get("lines"):
        found["lines"] = _lines_table(case)
    climate = {key: case[key] for key in ("ambient", "weather", "duration") if key in case}
    found["climate"] = input_table("Ambient temperature and duration", climate, otherwise="input")
    if "laboratory" in case:
        lab = {"laboratory": case["laboratory"]}
        found["laboratory"] = input_table("Laboratory", lab, otherwise="input, or default")
    if "rig" in case:
        found["rig"] = rig_table(case["rig"], sources.get(case["rig"].get("name")))
    usual: dict[str, Any] = {}
    if case["command"] == "hybrid":
        usual["method"] = "predictor-corrector"
    known: dict[str, str] = {}
    if in_weather(case):
        outdoor, known = outdoors()
        usual |= outdoor
    found["analysis"] = reported.analysis_table(
        case["analysis"], EarthquakeAnalysis(**usual), known
    )
    return found


def _list_all_bearings(case: Case) -> list[Mapping[str, Any]]:
    """Return the bearings of the analysis and of its lines, each once."""
    found = {str(one["name"]): one for one in case["bearings"]}
    for line in case.get("lines", []):
        if isinstance(line.get("bearing"), Mapping):
            found.setdefault(str(line["bearing"]["name"]), line["bearing"])
    return list(found.values())


def given_motions_table(
    motions: Sequence[Mapping[str, Any]], result: EarthquakeResult | None = None
) -> Table:
    """Return the motions of a resolved case; with a result their length and peak as run."""
    rows: list[dict[str, Any]] = []
    for one in motions:
        records = [Path(str(one[key])).stem for key in ("name", "across") if one.get(key)]
        name = str(one.get("label") or "+".join(dict.fromkeys(records)))
        row = {"motion": name, "motion_factor": float(one.get("factor", 1.0))}
        row |= {"motion_angle": quantity(one["angle"])} if one.get("angle") else {}
        if result is not None:
            names = [str(label) for label in result["motion"].values]
            if name not in names:  # interrupted before it
                continue
            run = names.index(name)
            row["motion_length_s"] = float(np.nanmax(result["time"].values[run]))
            row["motion_peak_m_s2"] = float(
                np.nanmax(np.abs(result["ground_acceleration"].values[run]))
            )
        rows.append(row | {"source": _motion_source(one)})
    note = "" if result is None else "Lengths and peaks as run, after factor and cut."
    return make_table(pd.DataFrame(rows), None, "Ground motions", note=note)


def _motion_source(motion: Mapping[str, Any]) -> str:
    from thermobearing.motions.library import list_motions

    name = str(motion.get("name", ""))
    if "acceleration" in motion:
        return "samples given in Python"
    if {name, str(motion.get("across", name))} <= set(list_motions()):
        return "synthetic stand-in fitted to the Level 2 standard spectrum of JRA"
    files = [Path(str(motion[key])).name for key in ("name", "across") if motion.get(key)]
    return f"file {' and '.join(files)}" if files else ""


def _lines_table(case: Case) -> Table:
    rows = []
    for line in case["lines"]:
        bearing = line.get("bearing")
        name = str(bearing["name"]) if bearing else "as of the analysis"
        ambient = line.get("weather") or "as of the analysis"
        ambient = quantity(line["ambient"]) if "ambient" in line else Path(ambient).name
        rows.append((str(line["line"]), name, ambient))
    columns = [Quantity("Line"), Quantity("Bearing"), Quantity("Ambient temperature")]
    return Table("Bearing lines with their own settings", columns, rows)


def _question(result: EarthquakeResult, case: Case) -> str:
    structure = case["structure"]
    about = f" ({text})" if (text := structure.get("description")) else ""
    bearings = joined((reported.bearing_words(one) for one in case["bearings"]), "or")
    motions = list(dict.fromkeys(str(name) for name in result["motion"].values))
    shown = joined(motions) if len(motions) <= 6 else counted(len(motions), "motion")
    if case.get("weather"):
        climate = f"after the weather of {Path(case['weather']).name}"
    else:
        climate = f"at ambient {degrees(list(dict.fromkeys(result['ambient'].values.tolist())))}"
    which = "motions" if len(motions) > 1 else "motion"
    demands = "the displacements and forces of the bearings"
    demands += " and the demand on the piers" if result.has_pier else ""
    shaking = f"in the ground {which} {shown}, {climate}"
    if case["command"] == "hybrid":
        modes = joined(MODES[mode] for mode in dict.fromkeys(result.modes) if mode in MODES)
        return (
            f"This report gives {demands} in a hybrid test of {structure['name']}{about}, "
            f"{modes}, with a specimen of {bearings} in the loop, {shaking}."
        )
    return f"This report gives {demands} of {structure['name']}{about} with {bearings}, {shaking}."


def _assumptions(result: EarthquakeResult, case: Case) -> list[str]:
    attrs, analysis = result.dataset.attrs, case["analysis"]
    kind = str(attrs["damping"])
    damping = f"Viscous damping: {kind}, {DAMPING[kind]}." if kind in DAMPING else ""
    if kind == "none":
        damping = "Without viscous damping only bearings and hinges dissipate energy."
    constant = "weather" not in case
    plan, hinged = result.in_plan, bool(case["structure"].get("hinges"))
    moves = (
        "in both horizontal directions, rock and may twist"
        if plan
        else ("in one horizontal direction and rock")
    )
    found = [
        f"Bodies are rigid; they move {moves}; foundations rest on "
        "linear springs. Second-order effects of gravity are not in the model.",
        "Hinges follow the rules of Takeda with stiffness degradation"
        + (", each direction on its own." if plan else ".")
        if hinged
        else "",
        "All bearings of a line are identical; forces and energies are those of one bearing.",
        damping,
        f"Mass: {analysis['mass']}. Time integration: {analysis['method'].replace('-', ' ')}, "
        f"steps of at most {quantity(analysis['dt'])}.",
        "Every bearing starts at the ambient temperature throughout, which then stays constant."
        if constant
        else "Bearings start with the temperatures that result from the weather before the motion.",
    ]
    if "initial_state" in case:
        found[-1] = (
            "The bearing starts in the final state of an earlier test, including its history."
        )
    found += _laboratory(case)
    found += reported.model_assumptions(analysis, _list_all_bearings(case), plane=plan)
    return [text for text in found if text]


def _laboratory(case: Case) -> list[str]:
    lab = case.get("laboratory")
    if not lab:
        return []
    scales = {float(line.get("scale", 1.0)) for line in case["structure"]["bearings"]}
    found = []
    if scales != {1.0}:
        ratios = joined(f"1:{1.0 / scale:.3g}" for scale in sorted(scales))
        found.append(f"The specimen represents bearings of the structure at a scale of {ratios}.")
    if "pd" in lab["mode"]:
        found.append(
            f"Pseudo-dynamic: the actuator moves at {quantity(lab['speed'])}, so that the specimen "
            "is loaded and cools on a slower time scale."
        )
    if lab.get("specimen"):
        found.append(
            f"A specimen at {lab['specimen']} took the place of the modelled bearing. Its force "
            "and energy were measured; temperatures and shares of the force were calculated along "
            "the same displacements."
        )
    if lab.get("compensation"):
        found.append(
            f"Commands are extrapolated by the delay, {quantity(lab['delay'])}, with a polynomial "
            f"of order {lab['compensation']} (Horiuchi et al., 1999)."
        )
    errors = [
        f"{name} {quantity(lab[key])}"
        for key, name in (("delay", "delay"), ("force_noise", "noise of the force"))
        if not (key == "delay" and lab.get("specimen"))  # its own
        and float(str(lab.get(key, "0")).split()[0]) > 0.0
    ]
    if errors or not lab.get("specimen"):
        given = joined(errors)
        found.append(f"Errors of the laboratory: {given}." if errors else "The actuator is ideal.")
    return found


COMMANDS = {"bridge": "Earthquake analysis", "hybrid": "Hybrid test"}


def build_pieces(result: EarthquakeResult) -> Pieces:
    """Return the content of the document of `bridge` or `hybrid`, live or loaded again."""
    attrs = result.dataset.attrs
    case = tomllib.loads(attrs["case"])
    command, outside = str(attrs["command"]), bool(case.get("laboratory", {}).get("specimen"))
    energy = result.energy if result.runs else None
    given = any(one.get("tested_range") is not None for one in _list_all_bearings(case))
    return content.build_pieces(
        command,
        f"{COMMANDS[command]} of {attrs['structure']}",
        _question(result, case),
        _answer(result),
        judged=result.runs > 0,
        inputs=_input_tables(result, case),
        tables=result.tables() if result.runs else {},
        figures=_report_figures(result),
        checks=_report_checks(result, case),
        rate_rows=result.tested_range.to_dict("records"),
        lead_rise=float(np.fmax(result.largest_rises()["lead_rise_K"].max(), 0.0)),
        residuals=(
            ()
            if energy is None
            else reported.residual_rows(energy, case["analysis"], measured=outside)
        ),
        books=balance_table(result) if result.runs else None,
        assumptions=_assumptions(result, case),
        **content.result_parts(result, str(attrs["case"]), command, range_given=given),
    )


def _answer(result: EarthquakeResult) -> list[str]:
    """Return what governs and the effect of the cold; an early end comes first."""
    if not result.runs:
        return [f"No run was completed ({result.outcome}): {tidy(result.sentence)}"]
    return [*_early_words(result), _governing(result), _cold(result)]


def _early_words(result: EarthquakeResult) -> list[str]:
    """Return a sentence on each failure mode and on missing runs, those of melted lead first."""
    modes: dict[str, list[str]] = {}
    for name, outcome in zip(result.run_names, result["outcome"].values, strict=True):
        if outcome != COMPLETED:
            modes.setdefault(str(outcome), []).append(name)
    if result.outcome == INTERRUPTED:
        modes.setdefault(INTERRUPTED, [])
    sentences = from_attribute(result.dataset, "sentences")
    return [
        reported.early_sentence(
            "The analysis",
            f" in {counted(len(names), 'run')}, first {plain(names[0])}" if names else "",
            outcome,
            str(sentences.get(outcome, "")),
        )
        for outcome, names in sorted(modes.items(), key=lambda mode: mode[0] != MELTED)
    ]


def _largest(result: EarthquakeResult, column: str, part: str = "") -> tuple[float, str]:
    """Return the largest value of a column, and its run and line or pier in words."""
    table = result.table
    if not table[column].notna().any():
        return float("nan"), ""
    place = place_of_largest(table[column])
    where = f", {_named(part, table[part].iloc[place])}" if part in table else ""
    return float(table[column].iloc[place]), plain(result.run_names[place] + where)


def _named(column: str, name: str) -> str:
    """Return a line or pier as "line A1"; a name that begins so stands alone."""
    kind = column.rpartition("_")[2]
    return name if name.lower().startswith(kind) else f"{kind} {name}"


def _governing(result: EarthquakeResult) -> str:
    """Return the largest strain, force and pier demand, each with its run."""
    strain, where = _largest(result, "bearing_strain_max", "strain_line")
    force, pushed = _largest(result, "bearing_force_max_kN", "force_line")
    which = "a" if len(result.piers) else "the"
    pier, moved = _largest(result, "pier_displacement_max_mm", "displacement_pier")
    phrases = [
        f"the largest shear strain is {percent(strain)} ({where})",
        f"the largest force of one bearing {number(force)} kN"
        + (f" ({pushed})" if pushed != where else " (the same run)"),
    ]
    if pier == pier:
        phrases.append(f"{which} pier top moves {number(pier)} mm relative to its base ({moved})")
    ductility, bent = _largest(result, "pier_ductility", "ductility_pier")
    hinge = "the hinge that turns most" if len(result.piers) else "its hinge"
    if ductility == ductility:
        if ductility > 1.0:
            phrases.append(f"{hinge} yields, to a ductility of {number(ductility)} ({bent})")
        else:
            phrases.append(
                f"{hinge} does not yield (ductility {number(ductility)} at most, {bent})"
            )
    many = f"Of {counted(result.runs, 'run')}, " if result.runs > 1 else ""
    text = f"{many}{joined(phrases)}."
    return f"{text[:1].upper()}{text[1:]}"


def _cold(result: EarthquakeResult) -> str:
    """Return the effect of the coldest temperature by bearing; heating where there is no cold."""
    ratios = cold_ratios(result)
    blind = {str(n) for n in result["bearing"].values if result.dataset.attrs.get(f"bilinear:{n}")}
    if len(ratios):
        ratios = ratios[~ratios["bearing"].isin(blind)]
    if not len(ratios):
        return _heating(result)
    coldest, warmest = ratios["ambient_degC"].min(), result.table["ambient_degC"].max()
    cold = ratios[ratios["ambient_degC"] == coldest]
    changes = [_cold_ratio(str(name), group) for name, group in cold.groupby("bearing", sort=False)]
    motions = cold["motion"].nunique()
    mean = " on average over the motions" if motions > 1 else ""
    only = f"; {', '.join(sorted(blind))} is temperature-independent" if blind else ""
    temperatures = f"{degrees([coldest])} compared with {degrees([warmest])}"
    return f"{temperatures} changes{mean}: {'; '.join(changes)}{only}."


def _cold_ratio(name: str, group: "pd.DataFrame") -> str:
    parts = []
    for column, what in (
        ("bearing_force_max_kN", "force"),
        ("bearing_strain_max", "strain"),
        ("pier_displacement_max_mm", "pier displacement"),
    ):
        values = group[column].dropna()
        if len(values):
            parts.append(f"{what} {change(float(values.mean()), 'more', 'less')}")
    return f"{name}: {joined(parts)}"


def _heating(result: EarthquakeResult) -> str:
    """Return the largest rises of rubber and lead, each with its run and line, as a sentence."""
    found: dict[str, list[tuple[float, str]]] = {"rubber": [], "lead": []}
    for run, name in enumerate(result.run_names):
        for place, rise in result.rises(run).items():
            found["lead" if place == "lead" else "rubber"].append((rise, name))
    if result.has_parts:
        names = np.repeat(result.run_names, len(result.lines) // result.runs)
        lines = [_named("line", line) for line in result.lines["line"]]
        where = [f"{run}, {line}" for run, line in zip(names, lines, strict=True)]
        found = {k: list(zip(result.lines[f"{k}_rise_K"], where, strict=True)) for k in found}
    warmed = []
    for what, rises in found.items():
        if known := [one for one in rises if np.isfinite(one[0])]:
            rise, where_ = max(known)
            warmed.append(f"the {what} by up to {rise:.1f} K ({plain(where_)})")
    if not warmed:
        return "The bearings of the analysis are temperature-independent."
    return f"The motions warm {joined(warmed)}."


def _report_checks(result: EarthquakeResult, case: Case) -> list[Check]:
    if not result.runs:
        return []
    names = [str(one["name"]) for one in _list_all_bearings(case)]
    source = f"{TESTED_RANGE} of the bearing"
    return _ductilities(result) + reported.result_checks(
        result, case, IN_EARTHQUAKES, source, names
    )


def _ductilities(result: EarthquakeResult) -> list[Check]:
    """Return whether each pier stays elastic; of one that yields no limit is in the input."""
    source = "first yield of the hinge"
    unlimited = math.nan, "", f"none beyond {source}", NOT_ASSESSED
    piers, names = result.piers, result.run_names
    if len(piers) and piers["ductility"].notna().any():
        groups = [(f"pier {name}", mine) for name, mine in piers.groupby("pier", sort=False)]
        columns = [(what, mine["ductility"].to_numpy(dtype=float)) for what, mine in groups]
    else:
        columns = [("pier", result.table["pier_ductility"].to_numpy(dtype=float))]
    found = []
    for what, values in columns:
        if np.isfinite(values).any():
            place = place_of_largest(values)
            label = f"ductility of {what} ({plain(names[place])})"
            largest = float(values[place])
            judged = (1.0, "", source, PASSED) if largest <= 1.0 else unlimited
            found.append(Check(label, largest, *judged))
    return found


CAPTIONS = {  # in this order
    "peaks": "Peaks of every run against the ambient temperature.",
    "loops": "Force of one bearing and its shear strain. Shaded: outside the calibration range.",
    "strain": "Shear strain of one bearing in the strong part of each motion; dots are peaks.",
    "pier": "Displacement of the pier top relative to its base in the strong part of each motion.",
    "hinge": "Moment against rotation of the pier base; dashed lines: yield moment.",
    "deck": "Absolute acceleration of the deck.",
    "pier_acceleration": "Absolute acceleration of the pier top.",
    "temperature": "Temperature rise of the rubber layers and of the lead since the start.",
    "energy": "Energy dissipated by one bearing.",
    "parts": "Every bearing {} side by side.",
    "largest_loops": "The largest loop of each run, with all bearings in one diagram.",
    "modes": "Real time over pseudo-dynamic: loops of the specimen.",
    "profiles": "Temperature through the height of the bearings.",
    "shares": "Shares of rubber, lead and rate-dependent branch in the force of the largest loop.",
    "speed": "Loading speed of the specimen on its own clock.",
    "orbit": "Paths of the displacement and of the force of one bearing in plan.",
    "components": "Peaks with two components of the ground motion over those with one at a time.",
}
ALONG = {"x": "along the bridge", "y": "across the bridge"}
OF_ALL = ("peaks", "parts", "deck")  # figures of the structure
LARGEST = {  # figure: column of the table, words for those who do not see the figure
    "loops": ("bearing_strain_max", "largest shear strain {:.0%}"),
    "strain": ("bearing_strain_max", "largest shear strain {:.0%}"),
    "pier": ("pier_displacement_max_mm", "largest {:.1f} mm"),
    "hinge": ("pier_ductility", "largest ductility {:.2f}"),
    "deck": ("deck_acceleration_max_m_s2", "largest {:.2f} m/s²"),
    "pier_acceleration": ("pier_top_acceleration_max_m_s2", "largest {:.2f} m/s²"),
}


def _report_figures(result: EarthquakeResult) -> dict[str, ReportFigure]:
    held = result.plot.draw_all() if result.runs else {}
    shown, views = part_names(result.dataset), {"": result.resultant}
    views |= {f"_{way}": result.sel(direction=way) for way in result.directions}
    plots = {end: _interactive_plots(view) for end, view in views.items()}
    found = {}
    for name, about in CAPTIONS.items():
        about = about.format(" and every ".join(result.part_kinds))
        about += f" Shown: {shown}." if shown and name not in OF_ALL else ""
        for end in views:
            if (own := name + end) in held:
                text = f"{about} Direction {end[1:]}, {ALONG[end[1:]]}." if end else about
                alt = text + _largest_drawn(views[end], name)
                plot = plots[end].get(name)
                found[own] = ReportFigure(text, draw=held[own], alt=alt, plot=plot)
    return found


def _largest_drawn(result: EarthquakeResult, name: str) -> str:
    """Return the largest value that a figure shows, and its run, as a sentence."""
    if name not in LARGEST:
        return ""
    view, (column, words) = result.dataset, LARGEST[name]
    for part in ("line", "pier") if result.has_parts else ():
        view = select_part(view, part, None)
    value, run = _largest(EarthquakeResult(view), column)
    text = words.format(value).replace("%", " %")
    return f" {text[:1].upper()}{text[1:]} ({run})." if run else ""


MOST_CHOICES = 40  # entries of a menu
MOMENTS = 24  # places of a slider
UNTESTED = "#aa3333"
PLACES = (("rubber", "inner layer", "line"), ("lead", "lead", "dashed"))


def _interactive_plots(result: EarthquakeResult) -> dict[str, Plot]:
    """Return plots by the name of the figure that they replace in an HTML page."""
    if not result.runs or (result.directions and not result.in_plan):
        return {}
    plots = _Plots(result)
    force, strain = "force of one bearing [kN]", "shear strain [%]"
    pier, deck = "pier top relative to its base [mm]", "acceleration of the deck [m/s²]"
    bent = ("rotation [mrad]", "moment [kN m]")
    found = {
        "loops": plots._curves("bearing_strain", "bearing_force", (strain, force), 100.0, "x"),
        "strain": plots._curves("time", "bearing_strain", ("time [s]", strain), 100.0, "y"),
        "pier": plots._curves("time", "pier_displacement", ("time [s]", pier)),
        "deck": plots._curves("time", "deck_acceleration", ("time [s]", deck)),
        "hinge": plots._curves("pier_rotation", "pier_moment", bent, 1e3),
        "temperature": plots._temperatures(),
        "profiles": plots._through_height(),
    }
    return {name: plot for name, plot in found.items() if plot is not None}


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

    def _label(self, run: int) -> str:
        ambient = degrees([float(self._table["ambient_degC"][run])])
        return f"{ambient}, {self._result.modes[run]}" if len(self._run_modes) > 1 else ambient

    def _plot(
        self,
        titles: tuple[str, str],
        make: Callable[[int], list[Trace]],
        tested: Literal["x", "y"] | None = None,
        **slider: Any,
    ) -> Plot | None:
        """Return the traces of every run, with lines at the tested strain on the axis `tested`."""
        choices = {}
        for name, runs in self.groups.items():
            traces = [trace for run in runs for trace in make(run)]
            end = 100.0 * self._result.tested_to(runs, "strain")
            if traces and tested and np.isfinite(end):
                across = [trace.y if tested == "x" else trace.x for trace in traces]
                low, high = (float(f([f(v) for v in across])) for f in (np.nanmin, np.nanmax))
                at = np.array([end, end, np.nan, -end, -end])
                other = np.array([low, high, np.nan, low, high])
                points = (at, other) if tested == "x" else (other, at)
                traces.append(Trace(f"tested to {end:g} %", *points, UNTESTED, "dashed"))
            if traces:
                choices[name] = traces
        return Plot(*titles, choices, **slider) if choices else None

    def _curves(
        self,
        x: str,
        y: str,
        titles: tuple[str, str],
        factor: float = 1.0,
        tested: Literal["x", "y"] | None = None,
    ) -> Plot | None:
        """Return a history y over time, or over another history x; `factor` is of the latter."""

        def _make(run: int) -> list[Trace]:
            a, b = self._values(x, run), self._values(y, run)
            a, b = (a, factor * b) if x == "time" else (factor * a, b)
            if not len(a) or not np.isfinite([a, b]).all():
                return []
            look = "dashed" if self._line(run) == "--" else "line"
            return [Trace(self._label(run), a, b, self._colour(run), look)]

        return self._plot(titles, _make, tested)

    def _temperatures(self) -> Plot | None:
        """Return the innermost rubber layer (full) and the lead (dashed) of every run."""

        def _make(run: int) -> list[Trace]:
            places, time = self._result.places(run), self._values("time", run)
            found = []
            for what, place, look in PLACES:
                if len(places[place]) and np.isfinite(places[place]).all():
                    label = f"{what}, {self._label(run)}"
                    found.append(Trace(label, time, places[place], self._colour(run), look))
            return found

        return self._plot(("time [s]", "temperature [°C]"), _make)

    def _through_height(self) -> Plot | None:
        """Return temperatures through the height, moved through the motion by a slider."""
        if "temperature" not in self._data:
            return None
        moments = np.linspace(0.0, float(np.nanmax(self._data["time"].values)), MOMENTS)

        def _make(run: int) -> list[Trace]:
            depth = self._data["depth"].values[run]
            own = np.isfinite(depth)
            if not own.any():
                return []
            time = self._values("time", run)
            at = np.searchsorted(time, moments).clip(0, len(time) - 1)
            frames = self._data["temperature"].values[run][at][:, own]
            level = -depth[own]
            y = np.tile(level, (len(moments), 1))
            look = (self._colour(run), "line with points")
            return [Trace(self._label(run), frames[0], level, *look, y, frames)]

        titles = "temperature [°C]", "level relative to the upper face [mm]"
        steps = [f"{moment:.1f} s" for moment in moments]
        return self._plot(titles, _make, slider=steps, slider_title="time")
