"""What a file says, without running it."""

from pathlib import Path

from thermobearing.bearing.library import load_bearing, split_sources
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.schema import read_toml
from thermobearing.case import load_case
from thermobearing.drive.protocol import build_segments
from thermobearing.stack import build_stack


def describe_file(path: Path) -> tuple[str, dict[str, str]]:
    """Kind of a TOML file ("bearing" or "case") and its main facts, after full validation.

    Raises
    ------
    InputError : everything that is wrong with it.
    """
    table, _ = split_sources(read_toml(path))
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
