"""Accelerations, shares and largest loops of earthquake studies against what must hold."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.results.largest_loop import largest_loop
from thermobearing.structure.matrices import mean_height
from thermobearing.structure.model import load_structure

SHORT: dict[str, Any] = {"duration": 6.0, "keep_every": 1}


@pytest.fixture(scope="module")
def study() -> Any:
    return tb.bridge(["shen-lhdr-bridge", "shen-bilinear-bridge"], "jra-ii-i-1", -20, **SHORT)


def test_forces_on_all_masses_are_those_of_the_ground() -> None:
    """Newton's law of the whole hybrid pier: inertia of both masses, and the pier's spring."""
    lab = {"duration": 4.0, "damping": "none", "method": "average-acceleration", "keep_every": 1}
    data = tb.hybrid("shen-lhdr-specimen", "jra-ii-ii-1", 0, **lab).dataset.isel(run=0)
    masses = np.array([10.156, 3.385])  # kN s2/mm, Table 3.5
    inertia = 1e3 * data["body_acceleration"].values @ masses
    spring = 400.0 * data["pier_displacement"].values
    assert list(data["body"].values) == ["deck", "pier"]
    largest = np.abs(spring).max()
    assert_allclose(inertia + spring, 0.0, atol=tol.HISTORY_DIGITS * largest)
    for body, name in ((0, "deck_acceleration"), (1, "pier_top_acceleration")):
        assert_allclose(data["body_acceleration"].values[:, body], data[name].values, rtol=1e-6)


def test_acceleration_is_the_second_difference_of_displacement(study: Any) -> None:
    """Absolute less ground is what moves the pier top and the deck relative to the ground."""
    data = study.dataset.isel(run=0)
    dt = float(np.diff(data["time"].values[:2])[0])
    ground = data["ground_acceleration"].values
    for place in ("deck", "pier_top"):
        q = data[f"{place}_displacement"].values.astype(float)
        bent = np.diff(q, 2) / dt**2 / 1e3
        a = (data[f"{place}_acceleration"].values - ground).astype(float)
        mean = 0.25 * (a[:-2] + 2.0 * a[1:-1] + a[2:])  # of constant mean acceleration
        assert_allclose(bent, mean, atol=tol.SECOND_DIFFERENCE * np.abs(a).max())
    relative = data["deck_relative_acceleration"].values
    assert_allclose(relative, data["deck_acceleration"].values - ground, atol=1e-5)


def test_masses_of_a_body_are_at_their_mean_height() -> None:
    pier = load_structure("pier-p1")
    assert mean_height(pier, "deck") == 10e3
    assert mean_height(pier.model_copy(update={"masses": []}), "footing") == -2e3


def test_shares_in_the_history_add_up(study: Any) -> None:
    frame = study.history(0)
    parts = frame[["rubber_force_kN", "lead_force_kN", "viscous_force_kN"]].sum(axis=1)
    largest = frame["force_kN"].abs().max()
    assert_allclose(parts, frame["force_kN"], atol=tol.HISTORY_DIGITS * largest)
    assert frame["lead_force_kN"].abs().max() > 0.1 * largest
    for name in ("deck_displacement_mm", "deck_relative_acceleration_m_s2"):
        assert np.isfinite(frame[name]).all()
    assert "footing_acceleration_m_s2" in frame
    assert "deck_acceleration_m_s2" in frame


def test_largest_loop_of_a_run_is_that_of_its_history(study: Any) -> None:
    loops = study.largest_loops
    assert list(loops["bearing"]) == ["shen-lhdr-bridge", "shen-bilinear-bridge"]
    frame, row = study.history(0), loops.iloc[0]
    bearing = tb.load_bearing("shen-lhdr-bridge")
    found = largest_loop(
        frame["displacement_mm"].to_numpy(),
        frame["force_kN"].to_numpy(),
        frame["energy_kN_mm"].to_numpy(),
        area=bearing.area,
        total_rubber_thickness=bearing.total_rubber_thickness,
    )
    assert found is not None
    m = found.measures
    pairs = {
        "F_plus_kN": m.force_max_kN,
        "F_minus_kN": m.force_min_kN,
        "D_plus_mm": m.displacement_max_mm,
        "D_minus_mm": m.displacement_min_mm,
        "K_eq_kN_mm": m.stiffness_kN_mm,
        "h_eq": m.h_eq,
        "G_e_MPa": m.G_eq_MPa,
        "energy_kN_mm": m.energy_kN_mm,
        "start_s": frame["time_s"][found.first],
        "end_s": frame["time_s"][found.last],
    }
    for name, value in pairs.items():
        assert row[name] == pytest.approx(value, rel=tol.HISTORY_DIGITS), name
    farthest = frame["displacement_mm"].abs().max()
    assert max(row["D_plus_mm"], -row["D_minus_mm"]) == pytest.approx(farthest)
    assert np.isnan(loops["G_e_MPa"][1])
    assert study.table["loop_K_eq_kN_mm"][1] == loops["K_eq_kN_mm"][1] > 0.0


def test_a_history_without_a_closed_loop_says_so(tmp_path: Path) -> None:
    study = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", 23, duration=0.5)
    assert study.largest_loops[["K_eq_kN_mm", "h_eq", "start_s"]].isna().all(axis=None)
    study.save(tmp_path / "short")
