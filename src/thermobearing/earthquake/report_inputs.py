"""What went into an earthquake study, as tables and sentences of its document."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from thermobearing.cyclic.report import rig_table
from thermobearing.cyclic.reported import (
    analysis_table,
    bearing_tables,
    bearing_words,
    model_assumptions,
)
from thermobearing.earthquake.case import EarthquakeAnalysis, in_weather
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.model.options import outdoors
from thermobearing.report.inputs import input_table
from thermobearing.report.pieces import Column, ReportTable
from thermobearing.report.words import counted, degrees, joined, quantity
from thermobearing.structure.report import structure_table

Case = Mapping[str, Any]
MODES = {"rt": "in real time", "pd": "pseudo-dynamic"}
DAMPING = {
    "modal": "a ratio for each mode of the structure without its bearings",
    "rayleigh": "Rayleigh, of the structure without its bearings",
    "element": "a dashpot beside every spring and hinge",
    "source": "Rayleigh as in the source, of the structure on its bearings",
}


def inputs_of(result: EarthquakeResult, case: Case) -> dict[str, ReportTable]:
    """Tables of what went in: structure, bearings, motions, air, laboratory, model."""
    sources = case.get("sources", {})
    found = {
        "structure": structure_table(case["structure"], sources.get(case["structure"]["name"])),
        "motions": motions_table(result, case),
    }
    for bearing in bearings_of(case):
        found |= bearing_tables(bearing, sources.get(str(bearing["name"])))
    if case.get("lines"):
        found["lines"] = lines_table(case)
    air = {key: case[key] for key in ("ambient", "weather", "duration") if key in case}
    found["air"] = input_table("Air and duration", air, otherwise="as asked for")
    if "laboratory" in case:
        lab = {"laboratory": case["laboratory"]}
        found["laboratory"] = input_table("Laboratory", lab, otherwise="as asked for, or default")
    if "rig" in case:
        found["rig"] = rig_table(case["rig"], sources.get(case["rig"].get("name")))
    usual: dict[str, Any] = {}
    if case["command"] == "hybrid":
        usual["method"] = "predictor-corrector"
    known: dict[str, str] = {}
    if in_weather(case):
        told, known = outdoors()
        usual |= told
    found["analysis"] = analysis_table(case["analysis"], EarthquakeAnalysis(**usual), known)
    return found


def bearings_of(case: Case) -> list[Mapping[str, Any]]:
    """Bearings of the study and those that lines have of their own, each once."""
    found = {str(one["name"]): one for one in case["bearings"]}
    for line in case.get("lines", []):
        if isinstance(line.get("bearing"), Mapping):
            found.setdefault(str(line["bearing"]["name"]), line["bearing"])
    return list(found.values())


def motions_table(result: EarthquakeResult, case: Case) -> ReportTable:
    """Motions as they were run: factor, length, peak acceleration."""
    data = result.dataset
    names = [str(name) for name in data["motion"].values]
    labels = [str(one.get("label") or Path(str(one["name"])).stem) for one in case["motions"]]
    about = dict(zip(labels, case["motions"], strict=True))
    columns = (
        Column("Motion"),
        Column("Factor", "", "g"),
        Column("Length", "s", ".1f"),
        Column("Peak ground acceleration", "m/s²", ".2f"),
        Column("Source"),
    )
    rows = []
    for name in dict.fromkeys(names):
        run = names.index(name)
        one = about.get(name, {})
        ground = data["ground_acceleration"].values[run]
        rows.append(
            (
                name,
                float(one.get("factor", 1.0)),
                float(np.nanmax(data["time"].values[run])),
                float(np.nanmax(np.abs(ground))),
                motion_source(one),
            )
        )
    note = "Lengths and peaks of what was run, after factor and cut."
    return ReportTable("Ground motions", columns, rows, note=note)


def given_motions_table(motions: Sequence[Mapping[str, Any]]) -> ReportTable:
    """Motions of a case, where what was run of them is not kept.

    Parameters
    ----------
    motions : of a resolved case.
    """
    columns = (Column("Motion"), Column("Factor", "", "g"), Column("Source"))
    rows = [
        (
            str(one.get("label") or Path(str(one["name"])).stem),
            float(one.get("factor", 1.0)),
            motion_source(one),
        )
        for one in motions
    ]
    return ReportTable("Ground motions", columns, rows)


def motion_source(motion: Mapping[str, Any]) -> str:
    """Where a motion is from."""
    from thermobearing.motions.library import list_motions

    name = str(motion.get("name", ""))
    if "acceleration" in motion:
        return "samples given in Python"
    if name in list_motions():
        return "synthetic stand-in fitted to the Level 2 standard spectrum of JRA"
    return f"file {Path(name).name}" if name else ""


def lines_table(case: Case) -> ReportTable:
    """Lines with a bearing or an air of their own."""
    columns = (Column("Line"), Column("Bearing"), Column("Air"))
    rows = []
    for line in case["lines"]:
        bearing = line.get("bearing")
        name = str(bearing["name"]) if bearing else "that of the study"
        air = line.get("weather") or "that of the study"
        air = quantity(line["ambient"]) if "ambient" in line else Path(air).name
        rows.append((str(line["line"]), name, air))
    return ReportTable("Bearing lines of their own", columns, rows)


def question(result: EarthquakeResult, case: Case) -> str:
    """What was asked: structure, bearings, motions, temperatures."""
    structure = case["structure"]
    about = structure.get("description") or structure["name"]
    bearings = joined((bearing_words(one) for one in case["bearings"]), "or")
    motions = list(dict.fromkeys(str(name) for name in result["motion"].values))
    shown = joined(motions) if len(motions) <= 6 else counted(len(motions), "motion")
    if case.get("weather"):
        air = f"after the weather of {Path(case['weather']).name}"
    else:
        air = f"at ambient {degrees(list(dict.fromkeys(result['ambient'].values.tolist())))}"
    asked = (
        "how far are the bearings sheared, what force do they pass on, and what is left for the "
        f"piers, in the ground motions {shown}, {air}?"
        if len(motions) > 1
        else "how far are the bearings sheared, what force do they pass on, and what is left for "
        f"the piers, in the ground motion {shown}, {air}?"
    )
    if case["command"] == "hybrid":
        modes = joined(MODES[mode] for mode in dict.fromkeys(result.modes) if mode in MODES)
        return (
            f"In a hybrid test of {structure['name']} ({about}), {modes}, with a specimen of "
            f"{bearings} in the loop: {asked}"
        )
    return f"On {structure['name']} ({about}) with {bearings}: {asked}"


def assumptions(result: EarthquakeResult, case: Case) -> list[str]:
    """What holds for every run, in sentences."""
    attrs, analysis = result.dataset.attrs, case["analysis"]
    kind = str(attrs["damping"])
    damping = f"Viscous damping: {kind}, {DAMPING[kind]}." if kind in DAMPING else ""
    if kind == "none":
        damping = "No viscous damping: energy goes into bearings and hinges only."
    air = "weather" not in case
    found = [
        "Bodies are rigid; they move in one horizontal direction and rock; foundations rest on "
        "linear springs. Second-order effects of gravity are not in the model.",
        "Hinges degrade after Takeda." if case["structure"].get("hinges") else "",
        "Bearings of one line are alike; forces and energies are those of one modelled bearing.",
        damping,
        f"Mass: {analysis['mass']}. Time integration: {analysis['method'].replace('-', ' ')}, "
        f"steps of at most {quantity(analysis['dt'])}.",
        "Every bearing begins at the temperature of the air throughout; the air keeps it."
        if air
        else "Bearings begin with the temperatures that the weather before the motion gives them.",
    ]
    if "initial_state" in case:
        found[-1] = (
            "The bearing begins where an earlier test left it, with temperatures and memory."
        )
    found += _laboratory(case)
    return [text for text in [*found, *model_assumptions(analysis, bearings_of(case))] if text]


def _laboratory(case: Case) -> list[str]:
    """How the specimen is moved."""
    lab = case.get("laboratory")
    if not lab:
        return []
    scales = {float(line.get("scale", 1.0)) for line in case["structure"]["bearings"]}
    found = []
    if scales != {1.0}:
        told = joined(f"1:{1.0 / scale:.3g}" for scale in sorted(scales))
        found.append(f"The specimen stands for bearings of the structure at a scale of {told}.")
    if "pd" in lab["mode"]:
        found.append(
            f"Pseudo-dynamic: the actuator moves at {quantity(lab['speed'])}, and the specimen "
            "lives on that slower clock."
        )
    errors = [
        f"{name} {quantity(lab[key])}"
        for key, name in (("delay", "delay"), ("force_noise", "noise of the force"))
        if float(str(lab.get(key, "0")).split()[0]) > 0.0
    ]
    said = joined(errors)
    found.append(f"Errors of the laboratory: {said}." if errors else "The actuator has no error.")
    return found
