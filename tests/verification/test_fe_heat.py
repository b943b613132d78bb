"""Layers and lead against axisymmetric finite elements, which are judged themselves first.

The finite elements get the heat of our own run, so only the heat flow is compared: five cycles
of 250 % at -20 degC, then two minutes of rest.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq
from scipy.special import j0, j1

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from tests.quick import quick_cases
from tests.verification import lead_cases
from tests.verification.lead_cases import CONFINED, SEALED, SIDES, Case
from thermobearing.bearing.model import Material
from thermobearing.core.lead import half_space_factor
from thermobearing.core.types import Floats

pytest.importorskip("skfem", reason="scikit-fem is not installed")

AMBIENT, END = -20.0, 50.0  # degC, s of loading
REST = (60.0, 110.0, 170.0)  # s, when the cooling is looked at
MODELS: dict[str, dict[str, Any]] = {
    "conservative": {},
    "conservative, half-space": {"model": tb.ModelOptions(lead_ends="half-space")},
    "published": {"model": tb.ModelOptions(scheme="published")},
    "single-temperature": {"model": "single-temperature"},
}


def variant(name: str) -> tb.Bearing:
    """HDR specimen, LHDR specimen, and the same without confinement of its cores."""
    if name == "HDR":
        return tb.load_bearing("shen-hdr-specimen")
    bearing = tb.load_bearing("shen-lhdr-specimen")
    assert bearing.lead is not None
    lead = bearing.lead.model_copy(update={"confined": name == "LHDR"})
    return bearing.model_copy(update={"lead": lead})


def loading(bearing: tb.Bearing) -> tb.CyclicTest:
    wave = "triangular" if bearing.lead is None else "sine"
    cycles = {"step": "cycles", "strain": 2.5, "wave": wave, "speed": 30.0, "count": 5}
    return tb.CyclicTest(dt=0.01, steps=[cycles, {"step": "rest", "duration": 120.0}])


def finite_elements(bearing: tb.Bearing, fineness: float = 1.0, dt: float = 0.1) -> Any:
    from thermobearing.verify.finite_elements import FiniteElements, bearing_problem, released

    keep = ("rubber", "layer_displacement", "cells")
    result = tb.run(bearing, loading(bearing), ambient=AMBIENT, keep=keep)
    stages = [(dt, round(END / dt)), (4.0 * dt, round(120.0 / dt / 4.0))]
    problem = bearing_problem(bearing, fineness=fineness)
    return FiniteElements(problem).march(stages, released(bearing, result))


def rises(result: tb.Result, time: float) -> dict[str, float]:
    """Above the ambient, at a time [s], by the names of the finite element history."""
    row = int(np.searchsorted(result.time(0), time - 1e-6))
    layers = result["rubber_temperature"].values[0, row] - AMBIENT
    actual = {"middle of rubber 1": layers[0], "middle of rubber 3": layers[2]}
    if result.has_lead:
        actual["lead"] = result["lead_temperature"].values[0, row] - AMBIENT
    return {name: float(value) for name, value in actual.items()}


def errors(history: Any, result: tb.Result, time: float) -> dict[str, float]:
    row = int(np.searchsorted(history.time, time - 1e-6))
    return {name: value - history.means[name][row] for name, value in rises(result, time).items()}


@pytest.mark.parametrize("name", quick_cases(["HDR", "LHDR", "LHDR unconfined"], 1))
def test_one_dimension_against_two(name: str, measured: Recorder) -> None:
    bearing = variant(name)
    history = finite_elements(bearing)
    assert_allclose(history.released, history.stored + history.lost, rtol=tol.FE_BALANCE)
    actual = {}
    for model, options in MODELS.items():
        if bearing.lead is None and "lead_ends" in options:
            continue
        result = tb.run(bearing, loading(bearing), ambient=AMBIENT, **options)
        actual[model] = errors(history, result, END)
        rest = [errors(history, result, time) for time in REST]
        for place, error in actual[model].items():
            row = int(np.searchsorted(history.time, END - 1e-6))
            whole = history.means[place][row]
            worst = max((after[place] for after in rest), key=abs)
            label = f"{name}, {place}, {model} against finite elements, after loading"
            measured(label, f"{error:+.1f} of {whole:.1f} K; cooling {worst:+.1f} K", "reported")
    best = actual["conservative"]
    assert abs(best["middle of rubber 1"]) < tol.FE_LAYER
    assert abs(best["middle of rubber 3"]) < tol.FE_LAYER
    if name != "HDR":
        assert abs(best["lead"]) < tol.KERNEL_LEAD
    if name == "LHDR":
        assert abs(actual["conservative, half-space"]["lead"]) < tol.FE_LEAD
        assert abs(actual["published"]["lead"]) > 10.0 * abs(best["lead"])


@pytest.mark.thorough
def test_the_error_of_the_layers_is_that_of_two_cells(measured: Recorder) -> None:
    """Two cells a layer (Fig. 4.2b) miss the middle of its parabola; eight do not.

    Each with the heat of its run: a layer that is warmer at mid-thickness releases less.
    """
    bearing = variant("HDR")
    cells = bearing.cells.model_copy(update={"rubber": 8, "shim": 2})
    fine = bearing.model_copy(update={"cells": cells})
    two, eight = (
        errors(finite_elements(b), tb.run(b, loading(b), ambient=AMBIENT), END)[
            "middle of rubber 3"
        ]
        for b in (bearing, fine)
    )
    assert abs(eight) < tol.FE_CELLS
    measured(
        "HDR, inner layer, 2 and 8 cells a layer against finite elements, each with its own heat",
        f"{two:+.2f} K, {eight:+.2f} K",
        f"8 cells: {tol.FE_CELLS:g} K",
    )


@pytest.mark.thorough
def test_finite_elements_are_fine_enough() -> None:
    bearing = variant("LHDR")
    coarse, fine = finite_elements(bearing), finite_elements(bearing, 1.7, 0.05)
    for place in ("middle of rubber 1", "middle of rubber 3", "lead"):
        ends = [h.means[place][int(np.searchsorted(h.time, END - 1e-6))] for h in (coarse, fine)]
        assert abs(ends[1] - ends[0]) < tol.FE_MESH


@pytest.mark.thorough
def test_surface_ratio_is_the_closure_that_matters(measured: Recorder) -> None:
    """On a half-space p = 1/2 suits the confined core after this loading, 0.7 the other.

    At that moment only: no p is right while the lead cools, nor for the bridge bearing.
    """
    for name, ratios, better in (
        ("LHDR", (0.45, 0.5, 0.55), 0.5),
        ("LHDR unconfined", (0.5, 0.7, 1.0), 0.7),
    ):
        bearing = variant(name)
        assert bearing.lead is not None
        history = finite_elements(bearing)
        error = {}
        for p in ratios:
            lead = bearing.lead.model_copy(update={"surface_ratio": p})
            other = bearing.model_copy(update={"lead": lead})
            result = tb.run(
                other,
                loading(bearing),
                ambient=AMBIENT,
                model=tb.ModelOptions(lead_ends="half-space"),
            )
            error[p] = errors(history, result, END)["lead"]
        assert abs(error[better]) < 3.0
        assert all(abs(error[better]) <= abs(e) for e in error.values())
        text = ", ".join(f"{p:g}: {e:+.1f} K" for p, e in error.items())
        measured(
            f"{name}: lead after loading by surface_ratio p, against finite elements",
            text,
            "reported",
        )


def superposed_lead(result: tb.Result, heat: tuple[Any, Any], p: float) -> float:
    """Rise of the lead after loading when the half-space answers to the flux as it varies.

    Duhamel's superposition of F(t+) instead of the flux over F(t+): p T_l less the plate's rise
    is r/k times the sum of flux increments of each step on F. `heat` is that of half a core.
    """
    lead = tb.load_bearing("shen-lhdr-specimen").lead
    assert lead is not None
    steel, capacity = 38.76e-3, 129.0 * 11360e-9 * lead.core_area * 96.0
    rate = 38.76 / (432.0 * 7740.0) * 1e6 / lead.radius**2
    dt = 0.05
    time = np.arange(0.0, END + dt / 2, dt)
    given = np.diff(2.0 * np.interp(time, *heat))
    plate = np.interp(time, result.time(0), result["temperature"].values[0, :, 9] - AMBIENT)
    step = np.diff([half_space_factor(max(t * rate, 1e-15)) for t in time])
    own = lead.radius / steel * step[0]
    flux, rise = np.zeros(len(given)), 0.0
    for n, warmed in enumerate(given):
        before = lead.radius / steel * float(flux[:n] @ step[n:0:-1])
        warm = rise + warmed / capacity
        drain = 2.0 * lead.core_area * dt / capacity
        flux[n] = (p * (warm - plate[n + 1]) - before) / (own + p * drain)
        rise = warm - drain * flux[n]
    return rise


@pytest.mark.thorough
def test_exact_superposition_is_no_better_with_p_one_half(measured: Recorder) -> None:
    """The formula takes the flux as constant since the start; that error and p partly cancel."""
    from thermobearing.verify.finite_elements import released

    bearing = variant("LHDR")
    history = finite_elements(bearing)
    keep = ("rubber", "layer_displacement", "cells")
    result = tb.run(
        bearing,
        loading(bearing),
        ambient=AMBIENT,
        keep=keep,
        model=tb.ModelOptions(lead_ends="half-space"),
    )
    row = int(np.searchsorted(history.time, END - 1e-6))
    heat = released(bearing, result)["lead"]
    error = {p: superposed_lead(result, heat, p) - history.means["lead"][row] for p in (0.42, 0.5)}
    formula = errors(history, result, END)["lead"]
    assert abs(error[0.5]) > abs(formula)
    assert abs(error[0.42]) < abs(error[0.5])
    text = ", ".join(f"p = {p:g}: {e:+.1f} K" for p, e in error.items())
    measured(
        "LHDR: lead after loading by exact superposition, against finite elements", text, "reported"
    )


RUBBER = Material(conductivity=0.31, specific_heat=1732.0, density=1146.0)
STEEL = Material(conductivity=38.76, specific_heat=432.0, density=7740.0)
R, H, B = 40.0, 30.0, 10.0  # mm: radius, height, thickness of the rubber at the symmetry plane
Mode = Callable[[Floats, Floats], Floats]  # of r and z
FACE, SIDE = 8e-4, 5e-4  # kN/(s mm K), films at z = 0 and r = R


def conductivity(material: Material) -> float:
    """[kN/(s K)]"""
    return material.conductivity * 1e-3


def diffusivity(material: Material) -> float:
    """[mm2/s]"""
    return conductivity(material) / material.volumetric_heat


def decayed(blocks: tuple[Any, ...], side: float, rate: float, mode: Mode) -> float:
    from thermobearing.verify.finite_elements import FiniteElements, Problem, graded

    count = 8
    z = np.concatenate([[0.0], graded(0.0, H - B, count), graded(H - B, H, count)])
    r = np.concatenate([[0.0], graded(0.0, R, count)])
    elements = FiniteElements(Problem(r, z, blocks, face_film=FACE, side_film=side))
    place = elements.basis.doflocs
    start = mode(place[0], place[1])
    steps = 200
    history = elements.march([(1.0 / rate / steps, steps)], start=start)
    assert_allclose(history.stored, -history.lost, rtol=tol.FE_BALANCE)
    return float(np.max(np.abs(history.final - start * math.exp(-1.0))) / np.max(np.abs(start)))


def test_cylinder_with_films_on_face_and_side(measured: Recorder) -> None:
    """J0(m r) cos(w (H - z)) with k m J1(m R) = film J0(m R) and k w tan(w H) = film."""
    from thermobearing.verify.finite_elements import Block

    k = conductivity(STEEL)
    m = brentq(lambda x: k * x * j1(x * R) - SIDE * j0(x * R), 1e-9, 2.4 / R)
    w = brentq(lambda x: k * x * math.sin(x * H) - FACE * math.cos(x * H), 1e-9, 0.5 * math.pi / H)
    error = decayed(
        (Block("steel", (0.0, R), (0.0, H), STEEL),),
        SIDE,
        diffusivity(STEEL) * (m * m + w * w),
        lambda r, z: j0(m * r) * np.cos(w * (H - z)),
    )
    measured("finite elements, cylinder with films: error, of the peak", error, f"{tol.FE_MODE:g}")
    assert error < tol.FE_MODE


def test_steel_on_rubber_with_a_film(measured: Recorder) -> None:
    """cos(p y) in the rubber, y = H - z; in the steel what fits it, with the film at the face."""
    from thermobearing.verify.finite_elements import Block

    k_r, k_s = conductivity(RUBBER), conductivity(STEEL)

    def waves(rate: float) -> tuple[float, float, float, float]:
        p, q = math.sqrt(rate / diffusivity(RUBBER)), math.sqrt(rate / diffusivity(STEEL))
        return p, q, math.cos(p * B), -k_r * p * math.sin(p * B) / (k_s * q)

    def gap(rate: float) -> float:
        _, q, a, d = waves(rate)
        sine, cosine = math.sin(q * (H - B)), math.cos(q * (H - B))
        return k_s * q * (d * cosine - a * sine) + FACE * (a * cosine + d * sine)

    longest = diffusivity(RUBBER) * (0.5 * math.pi / B) ** 2
    rate = brentq(gap, 1e-6 * longest, longest, xtol=1e-16)
    p, q, a, d = waves(rate)

    def mode(r: Floats, z: Floats) -> Floats:
        y = H - z
        steel = a * np.cos(q * (y - B)) + d * np.sin(q * (y - B))
        return np.where(y < B, np.cos(p * y), steel)

    blocks = (
        Block("steel", (0.0, R), (0.0, H - B), STEEL),
        Block("rubber", (0.0, R), (H - B, H), RUBBER),
    )
    error = decayed(blocks, 0.0, rate, mode)
    measured("finite elements, steel on rubber: error, of the peak", error, f"{tol.FE_MODE:g}")
    assert error < tol.FE_MODE


def test_a_gap_lets_no_heat_through() -> None:
    """A core with its wall doubled warms by its heat over c rho V everywhere; the rest does not."""
    from thermobearing.verify.finite_elements import Block, FiniteElements, Problem, graded

    core, heat = 15.0, 1000.0
    r = np.concatenate([[0.0], graded(0.0, core, 4), graded(core, R, 4)])
    z = np.concatenate([[0.0], graded(0.0, H, 6)])
    blocks = (
        Block("around", (core, R), (0.0, H), STEEL),
        Block("core", (0.0, core), (0.0, H), RUBBER),
    )
    elements = FiniteElements(Problem(r, z, blocks, slit=(core, -1.0)))
    history = elements.march([(0.5, 40)], {"core": (np.array([0.0, 20.0]), np.array([0.0, heat]))})
    rise = heat / (RUBBER.volumetric_heat * math.pi * core**2 * H)
    warm = np.abs(history.final - rise) < tol.FE_BALANCE * rise
    cold = np.abs(history.final) < tol.FE_BALANCE * rise
    assert (warm | cold).all()
    assert_allclose(history.means["core"][-1], rise, rtol=tol.FE_BALANCE)
    assert_allclose(history.means["around"], 0.0, rtol=0.0, atol=tol.FE_BALANCE * rise)


ALWAYS = ("specimen, 250 %",)  # it takes least
COMPARED = [
    pytest.param(how, name, case, limit, marks=[pytest.mark.thorough] if name not in ALWAYS else [])
    for how, cases, limit in (
        ("confined", CONFINED, tol.KERNEL_LEAD),
        ("between shims", SIDES, tol.KERNEL_LEAD),
        ("between shims and sealing plates", SEALED, tol.KERNEL_SEALED),
    )
    for name, case in cases.items()
]


@pytest.mark.parametrize(("how", "name", "case", "limit"), COMPARED)
def test_lead_at_every_time(
    how: str, name: str, case: Case, limit: float, measured: Recorder
) -> None:
    """Loading, two minutes, the same loading, ten minutes; the default, and the formula."""
    ours, rise = lead_cases.errors(case)
    formula, _ = lead_cases.errors(case, lead_ends="half-space")
    measured(
        f"lead {how}, {name}: largest error, half-space and finite plates",
        f"{formula:+.1f} K, {ours:+.1f} K of {rise:.0f} K",
        f"{limit:g} K for finite plates",
    )
    assert abs(ours) < limit
    assert abs(ours) < 0.5 * abs(formula)
