"""What a file says, without running it."""

from pathlib import Path

from thermobearing.bearing.bilinear import BilinearBearing, load_bilinear
from thermobearing.bearing.compound import Compound, load_compound
from thermobearing.bearing.library import load_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.temperature import TemperatureLaw
from thermobearing.border.errors import InputError
from thermobearing.border.toml import read_toml, split_sources
from thermobearing.cyclic.case import load_case
from thermobearing.cyclic.discretisation import REFERENCE, TOLERABLE, cells_error
from thermobearing.cyclic.segments import build_segments
from thermobearing.earthquake.case import EarthquakeCase, load_earthquake_case
from thermobearing.model.stack import build_stack
from thermobearing.sequences.case import SequenceCase, load_sequence_case
from thermobearing.structure.model import DampingKind, Structure, load_structure
from thermobearing.structure.run import prepare_structure


def describe_file(path: Path) -> tuple[str, dict[str, str]]:
    """Kind of a TOML file and its main facts, after full validation.

    Kinds: "bearing", "bilinear bearing", "compound", "structure", "earthquake case",
    "sequence case", and "case" of a cyclic test.

    Raises
    ------
    InputError : everything that is wrong with it.
    """
    table, _ = split_sources(read_toml(path))
    if table.get("kind") == "bilinear":
        return "bilinear bearing", bilinear_facts(load_bilinear(path))
    if table.get("kind") == "compound":
        return "compound", compound_facts(load_compound(path))
    if "bodies" in table:
        return "structure", structure_facts(load_structure(path))
    if "parts" in table:
        return "sequence case", sequence_facts(load_sequence_case(path))
    if "command" in table:
        return "earthquake case", earthquake_facts(load_earthquake_case(path))
    if {"geometry", "hysteresis", "materials", "kind"} & set(table):
        return "bearing", bearing_facts(load_bearing(path))
    case = load_case(path)
    segments = build_segments(case.test, case.bearing.total_rubber_thickness)
    time = sum(float(segment.dt.sum()) for segment in segments)
    steps = sum(len(segment.x) for segment in segments)
    until = "at most " if any(segment.settle for segment in segments) else ""
    ambient = case.ambient_series or ", ".join(f"{value:g} degC" for value in case.ambient)
    return "case", {
        "bearing": f"{case.bearing.name} ({case.bearing.description})",
        "ambient": ambient,
        "test": f"{case.test.name}: " + "; ".join(segment.label for segment in segments),
        "duration": f"{until}{time:g} s in {until}{steps} steps a run",
        "scheme": f"{case.analysis.scheme}, {case.analysis.integrator} integrator",
    }


def cells_facts(path: Path) -> dict[str, str]:
    """What the heat cells of a bearing's layers cost in accuracy, by a short test on it."""
    try:
        found = cells_error(load_bearing(path))
    except InputError:
        return {"their error": "not known: twice as many cells are more than a run can have"}
    if found is None:
        return {"their error": f"not known: {REFERENCE} do not run to their end"}
    facts = {
        "their error": f"G {100.0 * found.stiffness:+.1f} %, energy {100.0 * found.energy:+.1f} %, "
        f"hottest layer {found.warming:+.1f} of {found.rise:.1f} K",
        "estimated in": f"{REFERENCE}, the last, from twice as many cells",
    }
    if not found.enough:
        facts["advice"] = (
            f"{found.cells} cells a layer are few; cells.rubber = {found.advised}, shim = 2 would "
            f"leave about {100.0 * TOLERABLE:g} %"
        )
    return facts


def earthquake_facts(case: EarthquakeCase) -> dict[str, str]:
    """What a study would run."""
    climates = case.weather or ", ".join(f"{value:g} degC" for value in case.ambient)
    count = len(case.bearings) * len(case.motions) * (1 if case.weather else len(case.ambient))
    return {
        "command": case.command,
        "bearings": ", ".join(bearing.name for bearing in case.bearings),
        "motions": ", ".join(motion.name for motion in case.motions),
        "ambient": climates,
        "runs": f"{count}, {case.analysis.method}, dt {case.analysis.dt:g} s",
        **structure_facts(case.structure, case.analysis.damping),
    }


def sequence_facts(case: SequenceCase) -> dict[str, str]:
    """What a sequence would do."""
    return {
        "bearing": f"{case.bearing.name} ({case.bearing.description})",
        "ambient": f"{case.ambient:g} degC",
        "parts": ", ".join(case.label(number) for number in range(len(case.parts))),
        "rig": case.rig.name if case.rig else "not named",
    }


def structure_facts(structure: Structure, damping: DampingKind | None = None) -> dict[str, str]:
    """Coordinates, masses, periods and damping of a structure."""
    prepared = prepare_structure(structure, damping=damping)
    total = 1e3 * sum(item.mass for item in structure.masses)
    return {
        "structure": f"{structure.name} ({structure.description})",
        "coordinates": ", ".join(prepared.matrices.coordinates),
        "mass": f"{total:g} t",
        "periods": ", ".join(f"{value:.3f}" for value in prepared.modes.periods) + " s",
        "damping": prepared.structure.damping.kind,
        "damping ratios": ", ".join(f"{value:.3f}" for value in prepared.ratios),
    }


def bilinear_facts(bearing: BilinearBearing) -> dict[str, str]:
    """The backbone."""
    return {
        "name": bearing.name,
        "description": bearing.description,
        "Q_d": f"{bearing.strength:g} kN",
        "K_1, K_2": f"{bearing.initial_stiffness:g}, {bearing.post_yield_stiffness:g} kN/mm",
        "rubber": f"{bearing.total_rubber_thickness:g} mm",
    }


def bearing_facts(bearing: Bearing) -> dict[str, str]:
    """Main dimensions and derived numbers of a bearing."""
    g = bearing.geometry
    half, full = build_stack(bearing, half=True), build_stack(bearing, half=False)
    return {
        "name": bearing.name,
        "kind": bearing.kind,
        "description": bearing.description,
        "plan": f"{g.plan.shape}, {bearing.area:g} mm2",
        "rubber": f"{g.rubber_layers} x {g.rubber_thickness:g} = {g.total_rubber_thickness:g} mm",
        "end plates": f"{g.end_plate_thickness:g} mm",
        "shape factors": f"S1 = {g.first_shape_factor:.3g}, S2 = {g.second_shape_factor:.3g}",
        "temperatures": _range(bearing.temperature_law),
        "cells": f"{len(half.part)} in the half stack, {len(full.part)} in the full one",
    }


def compound_facts(compound: Compound) -> dict[str, str]:
    """Stresses and strains of a compound, and what it says nothing of."""
    rubber, lead, rate = compound.rubber, compound.lead, compound.rate
    facts = {
        "name": compound.name,
        "family": compound.family,
        "description": compound.description,
        "rubber": f"K_r t_r/A = {rubber.shear_modulus:.4g} MPa, alpha_0 = "
        f"{rubber.post_yield_ratio:.3g}, yield strain {rubber.yield_strain:.3g}, at "
        f"{rubber.reference_temperature:g} degC",
        "m_T, n_T": f"{rubber.elastic_temperature_coefficient:g}, "
        f"{rubber.hysteretic_temperature_coefficient:g} per 100 K",
        "temperatures": _range(compound.temperature_law),
        "lead": f"{lead.yield_stress:g} MPa at {lead.reference_temperature:g} degC"
        if lead
        else "nothing is said of it",
        "rate": f"K_v H/A = {rate.shear_modulus:.3g} MPa" if rate else "does not matter",
    }
    keys = ("rubber.elastic_temperature_coefficient", "rubber.hysteretic_temperature_coefficient")
    borrowed = sorted({compound.sources[key] for key in keys if key in compound.sources})
    return facts | {"source of m_T, n_T": "; ".join(borrowed)} if borrowed else facts


def _range(law: TemperatureLaw | None) -> str:
    """Where the temperature law is known."""
    if law is None or law.range is None:
        return "the range of the temperature law is not stated (temperature_law)"
    low, high = law.range
    table = f", a table of {len(law.temperatures)} times m_T and n_T" if law.temperatures else ""
    return f"law identified at {low:g} to {high:g} degC{table}"
