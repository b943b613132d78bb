"""Report of a displacement-controlled test."""

import tomllib
from collections.abc import Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from thermobearing.border.lazy import pd
from thermobearing.core.records import Floats
from thermobearing.cyclic.case import RIGS, Analysis, Rig
from thermobearing.cyclic.dataset import written_part
from thermobearing.cyclic.figures import ORBITS, TimeAxis
from thermobearing.cyclic.result import Result
from thermobearing.cyclic.tables import (
    cycles_table,
    energy_table,
    largest_cycles,
    ratio_table,
    warming,
)
from thermobearing.quantities.governing import largest_by, place_of_least
from thermobearing.quantities.tables import Table, make_table
from thermobearing.quantities.validity import VALID_UNTIL
from thermobearing.quantities.words import (
    change,
    counted,
    degrees,
    joined,
    number,
    percent,
    quantity,
)
from thermobearing.report import content
from thermobearing.report.content import RIG, TESTED_RANGE, TESTS, input_table
from thermobearing.report.figures import blank_panel, plot_from_axes
from thermobearing.report.pieces import Pieces, Plot, ReportFigure, Trace
from thermobearing.reported import (
    analysis_table,
    bearing_tables,
    bearing_words,
    early_end,
    model_assumptions,
    residual_rows,
    result_checks,
)
from thermobearing.results import drawing
from thermobearing.results.time_axis import duration

Case = Mapping[str, Any]
Step = Mapping[str, Any]
LOADINGS = ("cycles", "path")  # steps that have a count and an amplitude
MOST_STEPS = 40  # rows of the table of a test
MOMENTS = 24  # places of the slider
KJ = 1e-3


def build_pieces(result: Result) -> Pieces:
    """Return the content of the report of a cyclic test, run or loaded."""
    result = written_part(result)
    data, case = result.dataset, tomllib.loads(result.dataset.attrs["case"])
    lead = result["lead_temperature"].values if result.has_lead else np.zeros((1, 1))
    tables = {"cycles": cycles_table(result, brief=True)} if len(result.cycles) else {}
    tables |= {"cold": table} if (table := ratio_table(result)) else {}
    if len(rises := warming(result)):
        tables["warming"] = make_table(rises, caption="Warming during the test", keys=2)
    return content.build_pieces(
        "cyclic",
        f"Cyclic test of {data.attrs['bearing']}",
        _question(result, case),
        _answer(result),
        inputs=_input_tables(result, case),
        tables=tables,
        figures=_figures(result),
        checks=result_checks(result, case, TESTS, f"{TESTED_RANGE} of {data.attrs['bearing']}"),
        lead_rise=float(np.nanmax(lead - lead[:, :1])),
        residuals=residual_rows(result.energy, case["analysis"]),
        energy=energy_table(result.energy),
        assumptions=[
            *_start(case),
            *model_assumptions(case["analysis"], [case["bearing"]], plane=result.in_plane),
        ],
        **content.result_parts(result, str(data.attrs["case"]), "cyclic"),
    )


def words_of_test(test: Case) -> str:
    """Return the steps of a test of a resolved case in words."""
    moving = [step for step in test["steps"] if step["step"] != "rest"]
    phrases = [_words_of_group(list(same)) for _, same in groupby(moving, key=_group_key)]
    if rests := [step for step in test["steps"] if step["step"] == "rest"]:
        phrases.append(f"{counted(len(rests), 'rest') if phrases else 'rest'} ({_course(rests)})")
    return joined(phrases)


def _group_key(step: Step) -> tuple[str, ...]:
    """Return what steps have in common that are described together."""
    if step["step"] not in LOADINGS:
        return (str(step["step"]),)
    return (str(step["step"]), str(step["count"]), _course([step]))


def _words_of_group(steps: Sequence[Step]) -> str:
    first, sizes = steps[0], joined(_size(step) for step in steps)
    if first["step"] == "ramp":
        return f"{counted(len(steps), 'ramp')} to {sizes}"
    if first["step"] == "recorded":
        return f"the recorded displacement of {joined(_course([step]) for step in steps)}"
    if all(step.get("strain") is not None for step in steps):
        strains = joined(f"{100.0 * float(step['strain']):g}" for step in steps)
        sizes = f"{strains} % shear strain"
    suffix = " each" if len(steps) > 1 else ""
    unit = "cycle" if first["step"] == "cycles" else "turn"
    return f"{counted(int(first['count']), unit)}{suffix} of {sizes} ({_course([first])})"


def _size(step: Step) -> str:
    """Return the strain or displacement of a step; nothing of a rest or a recording."""
    strain = step.get("strain", step.get("to_strain"))
    displacement = step.get("amplitude", step.get("to"))
    if strain is not None:
        return percent(float(strain))
    return "" if displacement is None else quantity(displacement)


def _course(steps: Sequence[Step]) -> str:
    """Return how steps of one kind go: wave and rate, speed, durations, names of files."""
    courses = []
    for step in steps:
        rates = (("speed", "mean speed "), ("period", "period "), ("frequency", ""))
        match step["step"]:
            case "cycles" | "path":
                key, words = next(pair for pair in rates if step.get(pair[0]) is not None)
                shape = step.get("wave") or step["path"]
                courses.append(f"{shape}, {words}{quantity(step[key])}")
            case "ramp":
                courses.append(quantity(step.get("speed") or step["duration"]))
            case "rest" if step.get("duration") is not None:
                courses.append(duration(float(str(step["duration"]).split()[0])))
            case "rest":
                courses.append(f"until within {quantity(step['within'])} of the ambient")
            case _:
                file = step.get("file")
                courses.append(Path(str(file)).name if file else "a history given in Python")
    return joined(dict.fromkeys(courses), "or")


def _table_of_test(test: Case) -> Table:
    rows = []
    for place, step in enumerate(test["steps"][:MOST_STEPS], 1):
        row = {"step": str(place), "what": str(step["step"]), "size": _size(step)}
        row["course"] = _course([step])
        if step["step"] in LOADINGS:
            closing = step.get("closing_strain")
            row["cycles"] = str(step["count"])
            row["closing_cycle"] = percent(float(closing)) if closing is not None else "none"
        rows.append(row)
    notes = [
        f"Largest time step {quantity(test['dt'])}. Sizes are shear strains, or displacements in "
        "mm."
    ]
    if omitted := len(test["steps"]) - len(rows):
        notes.append(f"{counted(omitted, 'more step')}: see case.resolved.toml.")
    caption = f"Test: {test.get('name', 'test')}"
    return make_table(pd.DataFrame(rows), caption=caption, note=" ".join(notes))


def _question(result: Result, case: Case) -> str:
    ambient = f"ambient {degrees(result['ambient'].values.tolist())}"
    if case.get("ambient_series"):
        ambient = f"the ambient temperatures of {case['ambient_series']}"
    return (
        f"This report gives the stiffness, the dissipated energy and the temperatures of "
        f"{bearing_words(case['bearing'])} in a displacement-controlled test at {ambient}. "
        f'The test "{case["test"].get("name", "test")}" has {words_of_test(case["test"])}.'
    )


def _answer(result: Result) -> list[str]:
    cycles, data = result.cycles, result.dataset
    ended = [
        float(ambient) for ambient in data["ambient"].values[data["outcome"].values != "completed"]
    ]
    early = early_end("The analysis", f" at {degrees(ended)}" if ended else "", result)
    if len(cycles):
        largest = float(cycles["amplitude_strain"].max())
        rows = largest_cycles(cycles)
        return [*early, _governing(result, rows, largest), _changes(result, rows)]
    peaks = joined(
        f"{number(force)} kN at {percent(strain)} ({degrees([ambient])})"
        for ambient, force, strain in _peaks(result)
    )
    heated = f"; the test warms {warmed}" if (warmed := _warmest(result)) else ""
    return [*early, f"No cycle was closed; the largest force and shear strain are {peaks}{heated}."]


def _peaks(result: Result) -> list[tuple[float, float, float]]:
    """Return ambient temperature [degC], largest |force| [kN] and largest |strain| of each run."""
    force, strain = (np.nanmax(result.magnitude(n), axis=1) for n in ("force", "strain"))
    columns = (result["ambient"].values, force, strain)
    return list(zip(*(column.tolist() for column in columns), strict=True))


def _no_result(row: Mapping[Any, Any]) -> str:
    """Return that a cycle is no result, since the bearing had become unstable; else ""."""
    return ", unstable: no result" if np.isfinite(row.get(VALID_UNTIL, np.nan)) else ""


def _governing(result: Result, rows: "pd.DataFrame", largest: float) -> str:
    """Return stiffness and force in the last cycle of the largest amplitude."""
    last = rows.groupby("ambient_degC", sort=False).last().reset_index()
    moduli = [
        f"{row['G_eq_MPa']:.3f} MPa at {degrees([row['ambient_degC']])} (h_eq {row['h_eq']:.3f}, "
        f"{KJ * row['energy_kN_mm']:.2f} kJ a cycle{_no_result(row)})"
        for row in last.to_dict("records")
    ]
    ambient, force, _ = largest_by(_peaks(result), lambda peak: peak[1])
    return (
        f"At {percent(largest)} shear strain the equivalent shear modulus G_e of the last cycle is "
        f"{joined(moduli)}; the largest force is {number(force)} kN, at {degrees([ambient])}."
    )


def _changes(result: Result, rows: "pd.DataFrame") -> str:
    """Return what the cold changes at the largest amplitude, and what the test's own heat does."""
    groups = rows.groupby("ambient_degC")
    first, last, clauses = groups.first(), groups.last(), []
    if len(last) > 1:
        cold, warm = last.index.min(), last.index.max()
        stiffer = float(last["G_eq_MPa"][cold] / last["G_eq_MPa"][warm])
        energy = float(last["energy_kN_mm"][cold] / last["energy_kN_mm"][warm])
        clauses.append(
            f"At {degrees([cold])}, compared with {degrees([warm])}, the modulus is "
            f"{change(stiffer, 'higher', 'lower')} and the energy of a cycle "
            f"{change(energy, 'higher', 'lower')}"
        )
    heated = [f"the test itself warms {warmed}"] if (warmed := _warmest(result)) else []
    if (last["cycle"] > first["cycle"]).any():
        softer = last["G_eq_MPa"] / first["G_eq_MPa"]
        fall = change(float(softer.min()), "higher", "lower")
        ambient = degrees([softer.index.tolist()[place_of_least(softer)]])
        heated.append(
            f"the modulus of the last cycle of that strain is {fall} than that of its first "
            f"({ambient})"
        )
    clauses += [", and ".join(heated)] if heated else []
    sentence = "; ".join(clauses)
    return f"{sentence[:1].upper()}{sentence[1:]}." if sentence else "One cycle at one temperature."


def _warmest(result: Result) -> str:
    rises, phrases = warming(result), []
    if not len(rises):
        return ""
    lead = rises["part"] == "lead"
    for name, part_rises in (("rubber", rises[~lead]), ("lead", rises[lead])):
        if len(part_rises):
            rise, ambient = max(zip(part_rises["rise_K"], part_rises["ambient_degC"], strict=True))
            phrases.append(f"the {name} by up to {rise:.1f} K ({degrees([ambient])})")
    return joined(phrases)


def _input_tables(result: Result, case: Case) -> dict[str, Table]:
    sources = case.get("sources", {})
    bearing_sources = sources.get(result.dataset.attrs["bearing"])
    tables = {
        "test": _table_of_test(case["test"]),
        **bearing_tables(case["bearing"], bearing_sources),
    }
    starts = ("ambient", "ambient_series", "initial", "initial_lead")
    temperatures = {key: case[key] for key in starts if key in case}
    tables["temperatures"] = input_table("Temperatures", temperatures, otherwise="input")
    if "rig" in case:
        tables["rig"] = rig_table(case["rig"], sources.get(case["rig"].get("name")))
    tables["analysis"] = analysis_table(case["analysis"], Analysis())
    return tables


def rig_table(rig: Case, file_sources: Mapping[str, str] | None = None) -> Table:
    """Return the limits of a rig of a resolved case; `own` are the sources of its file, by key."""
    limits = {key: rig[key] for key in RIG if key in rig}
    texts = [str(rig[key]).rstrip(".") + "." for key in ("description", "citation") if rig.get(key)]
    rig_sources = RIGS.sources(Rig, rig) | dict(file_sources or {})
    sources = {f"rig.{key}": text for key, text in rig_sources.items()}
    title, note = f"Rig: {rig.get('name', 'rig')}", " ".join(texts)
    return input_table(title, {"rig": limits}, sources, otherwise="not stated", note=note)


def _start(case: Case) -> list[str]:
    start = "at the ambient temperature throughout"
    if "initial_state" in case:
        start = "in the final state of an earlier test, including its history"
    elif "initial_profile" in case:
        start = "with a given temperature in each cell"
    elif "conditioned" in case:
        start = (
            f"at the temperatures that the soaking model has after {quantity(case['conditioned'])} "
            f"in the chamber, from {quantity(case['before'])}"
        )
    elif "initial" in case:
        start = f"at {quantity(case['initial'])} throughout"
    series = "follows the series" if "ambient_series" in case else "is constant"
    return [
        f"The bearing starts {start}. The ambient temperature {series}.",
        "Displacements are imposed exactly; inertia is neglected.",
    ]


def _figures(result: Result) -> dict[str, ReportFigure]:
    """Return the figures that the result holds data for; most can be zoomed."""
    absent, captions = result.plot.absent(), content.figure_captions("cyclic")
    count = result.dataset.sizes["ambient"]
    captions["loops"] += content.shaded_note(result.tested_to(k, "strain") for k in range(count))
    plots = {
        "loops": _loops_plot,
        "orbit": _orbit_plot,
        "layer_temperatures": _temperature_plot,
        "profiles": _profile_plot,
    }
    peaks = "; ".join(
        f"at {degrees([float(ambient)])} up to {np.nanmax(np.abs(stress)):.2f} MPa and {strain:.0%}"
        for (ambient, _, strain), stress in zip(
            _peaks(result), result.magnitude("stress"), strict=True
        )
    )
    alternatives = {"loops": f"Hysteresis loops: {peaks}.".replace("%", " %")}
    return {
        name: ReportFigure(
            caption,
            draw=getattr(result.plot, name),
            alt=alternatives.get(name, caption),
            plot=plots[name](result) if name in plots else None,
        )
        for name, caption in captions.items()
        if name not in absent
    }


def _runs(result: Result) -> list[tuple[int, str, str]]:
    ambient = np.asarray(result["ambient"].values, dtype=float)
    colours = drawing.ambient_colours(ambient)
    return [
        (k, degrees([float(t)]), c) for k, (t, c) in enumerate(zip(ambient, colours, strict=True))
    ]


def _loops_plot(result: Result) -> Plot:
    ax = blank_panel()
    result.plot.loops(ax)
    end = 100.0 * min(result.tested_to(run, "strain") for run in range(len(ax.lines)))
    drawing.shade_untested([ax], [(-end, end)], note=False)
    return plot_from_axes({"all": ax})


def _orbit_plot(result: Result) -> Plot:
    """Return the paths in the plane, a menu entry for the displacement and one for the force."""
    return plot_from_axes(dict(zip(dict(ORBITS), result.plot.orbit().axes, strict=True)))


def _temperature_plot(result: Result) -> Plot:
    """Return temperatures of layers and lead by ambient temperature, without long rests."""
    time, lines, panels = TimeAxis(result, cut=True), result.plot.layer_lines(), {}
    if result.has_lead:
        look = {"color": drawing.INK, "linestyle": "--", "label": "lead"}
        lines.append((result.dataset["lead_temperature"].values, look))
    cut = ", long rests cut out" if time.shortened else ""
    for run, ambient, _ in _runs(result):
        panels[ambient] = ax = blank_panel()
        for values, look in lines:
            place, temperature = time.trace(run, values[run])
            ax.plot(place / time.unit, temperature, **look)
        drawing.name_axes(ax, f"time{cut} [{time.unit_name}]", "temperature [°C]")
    return plot_from_axes(panels)


def _profile_plot(result: Result) -> Plot:
    """Return the temperature through the height, moved through the test by a slider."""
    depth, time = result.dataset["depth"].values, TimeAxis(result)
    clock: Floats = time.times[time.farthest]
    # All runs are shown at the moments of the one that got farthest; one that ended early keeps
    # its last temperatures.
    rows = np.linspace(0, len(clock) - 1, min(MOMENTS, len(clock))).round().astype(int)
    moments, traces = clock[np.unique(rows)], []
    for run, name, colour in _runs(result):
        values = result["temperature"].values[run, : time.rows[run]]
        at = np.searchsorted(time.times[run], moments).clip(0, len(values) - 1)
        frames = values[at]
        y = np.tile(-depth, (len(moments), 1))
        traces.append(Trace(name, frames[0], -depth, colour, "line with points", y, frames))
    y_label, slider = "level relative to the upper face [mm]", [duration(float(t)) for t in moments]
    return Plot("temperature [°C]", y_label, {"all": traces}, slider=slider, slider_title="time")
