"""Residuals of energy books are relative to a stated least energy, however little happens."""

from pathlib import Path

import numpy as np
import pytest

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.results.metrics import LEAST_ENERGY, relative_residual

HDR = "shen-hdr-specimen"
RESIDUALS = ["mechanical_residual", "thermal_residual"]


def test_relative_to_the_largest_energy_or_the_least() -> None:
    assert relative_residual(3.0, [-6.0, 2.0]) == 0.5
    assert relative_residual(3.0, [-6.0, 2.0], least=12.0) == 0.25
    assert relative_residual(LEAST_ENERGY, [0.0]) == 1.0
    assert relative_residual(0.0, [0.0]) == 0.0
    assert relative_residual(5e-324, [5e-324, 0.0]) < 1e-300


@pytest.mark.parametrize("model", ["multi-layer", "lead-alone", "bilinear"])
@pytest.mark.parametrize("amplitude", [1e-5, 1e-4, 1e-3, 1e-2, 1.0])
def test_hardly_any_motion(amplitude: float, model: str) -> None:
    """Rounding of temperatures alone came to a residual of 0.99 at 1e-4 mm."""
    steps = [{"step": "cycles", "amplitude": amplitude, "period": 2.0, "count": 2}]
    result = tb.run("shen-lhdr-specimen", tb.CyclicTest(steps=steps), -20, model=model)
    assert result.outcome == "completed"
    assert result.energy[RESIDUALS].abs().max(axis=None) < tol.LEAST_RESIDUAL


@pytest.mark.parametrize("start", [None, 10.0], ids=["at ambient", "warmer"])
def test_no_motion(start: float | None) -> None:
    test = tb.CyclicTest(steps=[{"step": "rest", "duration": 100.0}])
    energy = tb.run(HDR, test, -20, initial=start).energy
    assert energy["work_in_kN_mm"][0] == 0.0
    assert energy[RESIDUALS].abs().max(axis=None) < tol.ENERGY_BOOKS


@pytest.mark.parametrize("factor", [1e-6, 1.0])
def test_study_of_hardly_any_motion(factor: float, tmp_path: Path) -> None:
    """A bearing that cools while next to nothing shakes it: the heat is the scale, not the work."""
    weather = tmp_path / "night.csv"
    weather.write_text("time_s,temperature_degC\n0,10\n3600,-20\n")
    motion = {"name": "jra-ii-i-1", "factor": factor}
    study = tb.bridge(HDR, motion, ambient=str(weather), duration=2)
    names = ["structure_residual", *RESIDUALS]
    assert np.isfinite(study.energy[names]).all(axis=None)
    assert study.energy[names].abs().max(axis=None) < tol.LEAST_RESIDUAL
