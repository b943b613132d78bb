"""One kernel for a confined core, without p and clock, against finite elements."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.special import j0, j1, jn_zeros

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.reference.lead_kernel import (
    RADIAL,
    core_modes,
    end_kernel,
    lead_rise,
    lumped,
    plate_modes,
)
from thermobearing.stack import build_stack

pytest.importorskip("skfem", reason="scikit-fem is not installed")

CASES = {  # bearing, strain, cycles, speed [mm/s], return path
    "specimen, 250 %, 30 mm/s": ("shen-lhdr-specimen", 2.5, 5, 30.0, 0.8),
    "specimen, 100 %, 150 mm/s": ("shen-lhdr-specimen", 1.0, 10, 150.0, 0.8),
    "bridge, 175 %, 200 mm/s": ("shen-lhdr-bridge", 1.75, 5, 200.0, 0.8),
    "bridge, 175 %, 50 mm/s": ("shen-lhdr-bridge", 1.75, 5, 50.0, 0.8),
    "LRB, confined, 100 %, 300 mm/s": ("lrb-example", 1.0, 5, 300.0, 1.0),
}


def confined(name: str) -> tb.Bearing:
    bearing = tb.load_bearing(name)
    assert bearing.lead is not None
    return bearing.model_copy(update={"lead": bearing.lead.model_copy(update={"confined": True})})


def test_terms_add_up_to_the_steady_resistances() -> None:
    """tanh(l H)/(k l) of each plate mode, h/(3 k A) of the core; lumping keeps the sum."""
    bearing = confined("shen-lhdr-specimen")
    lead, core = bearing.lead, bearing.materials.lead
    assert lead is not None
    assert core is not None
    k, height = bearing.materials.steel.conductivity * 1e-3, bearing.geometry.end_plate_thickness
    radius = math.sqrt(bearing.area / lead.cores / math.pi)
    wave = jn_zeros(1, RADIAL) / radius
    mean = 4.0 * (j1(wave * lead.radius) / (wave * radius * j0(wave * radius))) ** 2
    steady = float((mean * np.tanh(wave * height) / wave).sum()) / (k * lead.core_area)
    plate = plate_modes(bearing)
    assert_allclose(plate.a.sum(), steady, rtol=tol.KERNEL_SUM)
    along = 48.0 / (3.0 * core.conductivity * 1e-3 * lead.core_area)
    assert_allclose(core_modes(bearing, 48.0).a.sum(), along, rtol=tol.KERNEL_SUM)
    assert_allclose(lumped(plate).a.sum(), plate.a.sum(), rtol=tol.ROUNDING * len(plate.a))


@pytest.mark.parametrize("case", CASES)
def test_one_kernel_against_finite_elements(case: str, measured: Recorder) -> None:
    """The largest error at any time of loading and two minutes of cooling."""
    from tests.reference.fe_heat import FiniteElements, bearing_problem, released

    name, strain, count, speed, return_path = CASES[case]
    bearing = confined(name)
    assert bearing.lead is not None
    assert bearing.materials.lead is not None
    cycles = {"step": "cycles", "strain": strain, "wave": "sine", "speed": speed, "count": count}
    test = tb.CyclicTest(dt=0.01, steps=[cycles, {"step": "rest", "duration": 120.0}])
    keep = ("rubber", "layer_displacement", "cells")
    result = tb.run(bearing, test, ambient=-20.0, heat_source="work", keep=keep)
    heat = released(bearing, result)
    time = result.time(0)
    history = FiniteElements(bearing_problem(bearing)).march(
        [(0.1, int(time[-1] / 0.1 + 1e-6))], heat
    )
    stack = build_stack(bearing, half=True)
    under = int(np.flatnonzero(stack.touches_lead_end)[0])
    plate = result["temperature"].values[0, :, under].astype(float) + 20.0
    half = 0.5 * float(stack.beside_lead.sum())
    capacity = bearing.materials.lead.volumetric_heat * bearing.lead.core_area * half
    kernel = end_kernel(bearing, half, return_path)
    rise, _ = lead_rise(kernel, time, heat["lead"][1], plate, capacity)
    formula = result["lead_temperature"].values[0] + 20.0
    worst = []
    for ours in (formula, rise):
        error = np.interp(history.time, time, ours) - history.means["lead"]
        worst.append(float(error[np.argmax(np.abs(error))]))
    peak = float(history.means["lead"].max())
    measured(
        f"lead, {case}: largest error of the formula with p = 1/2, of one kernel",
        f"{worst[0]:+.1f} K, {worst[1]:+.1f} K of {peak:.0f} K",
        f"{tol.KERNEL_LEAD:g} K for the kernel",
    )
    assert abs(worst[1]) < tol.KERNEL_LEAD
    assert abs(worst[1]) < 0.25 * abs(worst[0])
