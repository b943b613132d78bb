"""When is one dimension good enough: layers and lead against axisymmetric finite elements.

The finite elements get the heat of our own run, so only the heat flow is compared: five cycles
of 250 % at -20 degC, then two minutes of rest.
"""

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from thermobearing.core.lead import half_space_factor

pytest.importorskip("skfem", reason="scikit-fem is not installed")

AMBIENT, END = -20.0, 50.0  # degC, s of loading
REST = (60.0, 110.0, 170.0)  # s, when the cooling is looked at
MODELS: dict[str, dict[str, Any]] = {
    "conservative": {},
    "conservative, half-space": {"lead_ends": "half-space"},
    "published": {"scheme": "published"},
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
    from tests.reference.fe_heat import FiniteElements, bearing_problem, released

    keep = ("rubber", "layer_displacement", "cells")
    result = tb.run(bearing, loading(bearing), ambient=AMBIENT, keep=keep)
    stages = [(dt, round(END / dt)), (4.0 * dt, round(120.0 / dt / 4.0))]
    problem = bearing_problem(bearing, fineness=fineness)
    return FiniteElements(problem).march(stages, released(bearing, result))


def rises(result: tb.Result, time: float) -> dict[str, float]:
    """Above the ambient, at a time [s], by the names of the finite element history."""
    row = int(np.searchsorted(result.time(0), time - 1e-6))
    layers = result["rubber_temperature"].values[0, row] - AMBIENT
    found = {"middle of rubber 1": layers[0], "middle of rubber 3": layers[2]}
    if result.has_lead:
        found["lead"] = result["lead_temperature"].values[0, row] - AMBIENT
    return {name: float(value) for name, value in found.items()}


def errors(history: Any, result: tb.Result, time: float) -> dict[str, float]:
    row = int(np.searchsorted(history.time, time - 1e-6))
    return {name: value - history.means[name][row] for name, value in rises(result, time).items()}


@pytest.mark.parametrize("name", ["HDR", "LHDR", "LHDR unconfined"])
def test_one_dimension_against_two(name: str, measured: Recorder) -> None:
    bearing = variant(name)
    history = finite_elements(bearing)
    assert_allclose(history.released, history.stored + history.lost, rtol=tol.FE_BOOKS)
    found = {}
    for model, options in MODELS.items():
        if bearing.lead is None and "lead_ends" in options:
            continue
        result = tb.run(bearing, loading(bearing), ambient=AMBIENT, **options)
        found[model] = errors(history, result, END)
        rest = [errors(history, result, time) for time in REST]
        for place, error in found[model].items():
            row = int(np.searchsorted(history.time, END - 1e-6))
            whole = history.means[place][row]
            worst = max((after[place] for after in rest), key=abs)
            label = f"{name}, {place}, {model} against finite elements, after loading"
            measured(label, f"{error:+.1f} of {whole:.1f} K; cooling {worst:+.1f} K", "told")
    best = found["conservative"]
    assert abs(best["middle of rubber 1"]) < tol.FE_LAYER
    assert abs(best["middle of rubber 3"]) < tol.FE_LAYER
    if name != "HDR":
        assert abs(best["lead"]) < tol.KERNEL_LEAD
    if name == "LHDR":
        assert abs(found["conservative, half-space"]["lead"]) < tol.FE_LEAD
        assert abs(found["published"]["lead"]) > 10.0 * abs(best["lead"])


def test_the_error_of_the_layers_is_that_of_two_cells(measured: Recorder) -> None:
    """Two cells a layer (Fig. 4.2b) miss the middle of its parabola; eight do not.

    Each with the heat of its own run: a layer that is warmer at mid-thickness releases less.
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
            result = tb.run(other, loading(bearing), ambient=AMBIENT, lead_ends="half-space")
            error[p] = errors(history, result, END)["lead"]
        assert abs(error[better]) < 3.0
        assert all(abs(error[better]) <= abs(e) for e in error.values())
        text = ", ".join(f"{p:g}: {e:+.1f} K" for p, e in error.items())
        measured(
            f"{name}: lead after loading by surface_ratio p, against finite elements", text, "told"
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


def test_exact_superposition_is_no_better_with_p_one_half(measured: Recorder) -> None:
    """The formula takes the flux as constant since the start; that error and p partly cancel."""
    from tests.reference.fe_heat import released

    bearing = variant("LHDR")
    history = finite_elements(bearing)
    keep = ("rubber", "layer_displacement", "cells")
    result = tb.run(bearing, loading(bearing), ambient=AMBIENT, keep=keep, lead_ends="half-space")
    row = int(np.searchsorted(history.time, END - 1e-6))
    heat = released(bearing, result)["lead"]
    error = {p: superposed_lead(result, heat, p) - history.means["lead"][row] for p in (0.42, 0.5)}
    formula = errors(history, result, END)["lead"]
    assert abs(error[0.5]) > abs(formula)
    assert abs(error[0.42]) < abs(error[0.5])
    text = ", ".join(f"p = {p:g}: {e:+.1f} K" for p, e in error.items())
    measured(
        "LHDR: lead after loading by exact superposition, against finite elements", text, "told"
    )
