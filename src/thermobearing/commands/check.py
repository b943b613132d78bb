"""What a file says, without running it."""

from pathlib import Path

from thermobearing.bearing.bilinear import BilinearBearing, load_bilinear
from thermobearing.bearing.library import load_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.toml import read_toml, split_sources
from thermobearing.cyclic.case import load_case
from thermobearing.cyclic.segments import build_segments
from thermobearing.earthquake.case import EarthquakeCase, load_earthquake_case
from thermobearing.model.stack import build_stack
from thermobearing.structure.model import DampingKind, Structure, load_structure
from thermobearing.structure.run import prepare_structure


def describe_file(path: Path) -> tuple[str, dict[str, str]]:
    """Kind of a TOML file and its main facts, after full validation.

    Kinds: "bearing", "bilinear bearing", "structure", "earthquake case", "case" (of a cyclic test).

    Raises
    ------
    InputError : everything that is wrong with it.
    """
    table, _ = split_sources(read_toml(path))
    if table.get("kind") == "bilinear":
        return "bilinear bearing", bilinear_facts(load_bilinear(path))
    if "bodies" in table:
        return "structure", structure_facts(load_structure(path))
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
        "shape factors": f"S1 = {g.first_shape_factor:.3g}, S2 = {g.second_shape_factor:.3g}",
        "cells": f"{len(half.part)} in the half stack, {len(full.part)} in the full one",
    }
