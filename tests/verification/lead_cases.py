"""Bearings whose lead is compared with finite elements. No tests."""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import thermobearing as tb
from tests.verification.models import changed
from thermobearing.bearing.model import Bearing, CircularPlan

AMBIENT = -20.0  # [degC]


@dataclass(frozen=True)
class Case:
    """Loading, a rest of two minutes, the same loading, a rest of ten minutes.

    `film` [W/(m2 K)] is that of both faces; None for eta = 2.
    """

    bearing: Bearing
    strain: float
    count: int
    period: float  # [s]
    film: float | None = None


def touching(name: str, sides: bool) -> Bearing:
    return changed(tb.load_bearing(name), lead={"confined": not sides})


def lead_rubber(
    diameter: float, core: float, layers: tuple[int, float, float], plate: float, **lead: Any
) -> Bearing:
    """A round LRB of G = 0.4 MPa: number of layers, their thickness and that of the shims."""
    count, thickness, shim = layers
    stiffness = 0.4e-3 * math.pi / 4.0 * diameter**2 / thickness
    return changed(
        tb.load_bearing("lrb-example"),
        geometry={
            "plan": CircularPlan(shape="circular", diameter=diameter),
            "rubber_layers": count,
            "rubber_thickness": thickness,
            "shim_thickness": shim,
            "end_plate_thickness": plate,
        },
        hysteresis={"layer_stiffness": stiffness},
        lead={"diameter": core, "stiffness": 9.0 * stiffness / count, **lead},
        cells={"rubber": 4},
    )


def sealed(bearing: Bearing, thickness: float) -> Bearing:
    """With other sealing plates [mm], or none, and its cores in touch with them and the shims."""
    return changed(
        bearing,
        geometry={"sealing_plate_thickness": thickness},
        lead={"confined": False, "end_spreading": 1.0},
        cells={"rubber": 4},
    )


LARGE = (900.0, 180.0, (24, 9.0, 3.0), 40.0)
SLENDER = (500.0, 60.0, (20, 5.0, 3.0), 25.0)
SPECIMEN, BRIDGE = "shen-lhdr-specimen", "shen-lhdr-bridge"

CONFINED = {
    "specimen, 250 %": Case(tb.load_bearing(SPECIMEN), 2.5, 5, 10.0),
    "specimen, 100 %": Case(tb.load_bearing(SPECIMEN), 1.0, 10, 1.25),
    "bridge, 175 %": Case(tb.load_bearing(BRIDGE), 1.75, 5, 3.0),
    "LRB 700/150": Case(touching("lrb-example", False), 1.0, 5, 3.0),
    "900/180, film of 20 W/(m2 K)": Case(lead_rubber(*LARGE, confined=True), 1.0, 10, 2.0, 20.0),
}
SIDES = {
    "900/180": Case(lead_rubber(*LARGE), 1.0, 10, 2.0),
    "500/60": Case(lead_rubber(*SLENDER), 1.5, 10, 2.0),
    "LRB 700/150, slow": Case(touching("lrb-example", True), 2.0, 5, 20.0),
    "LRB 700/150, film of 20 W/(m2 K)": Case(touching("lrb-example", True), 1.5, 10, 2.0, 20.0),
    "four of 1000/100": Case(
        lead_rubber(1000.0, 100.0, (26, 8.0, 4.0), 35.0, cores=4), 1.0, 6, 2.5
    ),
    "thin layers, 300/60": Case(lead_rubber(300.0, 60.0, (30, 2.0, 2.0), 20.0), 1.5, 5, 2.0),
    "HDR with four cores, 480": Case(sealed(tb.load_bearing(BRIDGE), 0.0), 1.75, 5, 3.0),
    "HDR with four cores, 240": Case(sealed(tb.load_bearing(SPECIMEN), 0.0), 1.75, 5, 3.0),
}
SEALED = {
    "specimen": Case(touching(SPECIMEN, True), 1.0, 10, 2.0),
    "bridge": Case(touching(BRIDGE, True), 1.75, 5, 3.0),
    "900/180, 20 mm": Case(sealed(lead_rubber(*LARGE), 20.0), 1.0, 10, 2.0),
    "500/60, 15 mm": Case(sealed(lead_rubber(*SLENDER), 15.0), 1.0, 10, 2.0),
}


def errors(case: Case, **options: Any) -> tuple[float, float]:
    """Largest error of the lead temperature at any time, and its largest rise [K].

    `options` are fields of `ModelOptions`.

    The finite elements get the heat of our own run, so that only the heat flow is compared.
    """
    from thermobearing.verify.finite_elements import FILM, FiniteElements, bearing_problem, released

    wave = {"step": "cycles", "wave": "sine", "strain": case.strain, "count": case.count}
    cycles = wave | {"period": case.period}
    steps = [cycles, {"step": "rest", "duration": 120.0}] * 2
    steps[-1] = {"step": "rest", "duration": 600.0}
    problem = bearing_problem(case.bearing)
    if case.film is not None:
        face = tb.EndFace(film=case.film)
        options |= {"upper_face": face, "lower_face": face}
        problem = replace(problem, face_film=case.film * FILM)
    result = tb.run(
        case.bearing,
        tb.CyclicTest(dt=0.01, steps=steps),
        ambient=AMBIENT,
        model=tb.ModelOptions(heat_source="work", **options),
        keep=("rubber", "layer_displacement", "cells"),
    )
    loading = case.count * case.period
    heating = (loading / 100.0, 100)
    cooling = [(0.5, 20), (2.0, 55)]
    stages = [heating, *cooling, heating, *cooling, (10.0, 48)]
    history = FiniteElements(problem).march(stages, released(case.bearing, result))
    rise = np.interp(history.time, result.time(0), result["lead_temperature"].values[0] - AMBIENT)
    error = rise - history.means["lead"]
    return float(error[np.argmax(np.abs(error))]), float(history.means["lead"].max())
