"""Motions that once ended in a traceback or without end; see test_hostile_input.py."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tests.unit.motion_files as files
from tests.unit.inputs import told
from thermobearing.motions import matching
from thermobearing.motions.library import load_motion
from thermobearing.motions.process import baseline_corrected, padded, resampled
from thermobearing.motions.record import GroundMotion
from thermobearing.motions.synthesis import make_motion, match_spectrum

MOTION = GroundMotion("test", 0.01, files.shaking(3000.0))


@pytest.mark.parametrize(
    ("call", "pieces"),
    [
        (lambda: baseline_corrected(MOTION, high_pass=1e-308), ["high_pass: 1e-308 Hz", "outside"]),
        (lambda: resampled(MOTION, 1e-9), ["dt: 1e-09 s", "samples"]),
        (lambda: resampled(MOTION, 0.01 * 7 / 1e9), ["samples"]),
        (lambda: padded(MOTION, 1e5, 1e5), ["samples", "2000000"]),
        (lambda: make_motion("II", "I", 1, zone_factor=1e-300), ["zone_factor: 1e-300"]),
        (lambda: match_spectrum(padded(MOTION, 0.0, 5000.0), "II", "I"), ["at most 120000"]),
    ],
    ids=["corner", "finer", "odd", "padded", "zone", "long"],
)
def test_arguments_beyond_sense(call: Callable[[], Any], pieces: list[str]) -> None:
    told(call, *pieces)


@pytest.mark.parametrize(
    ("text", "options", "pieces"),
    [
        ("t_s,acc_gal\n0,0\n0.01,1e300\n0.02,0\n", {}, ["line 3", "too large"]),
        ("t_s,acc_gal\n0,0\n0.01,1e-200\n0.02,0\n", {"trust_unit": True}, ["less than 1e-09"]),
        (files.at2_text(line="NPTS= 400, DT= 1D400 SEC"), {}, ["not a finite number"]),
        (files.at2_text(line=f"NPTS= {'9' * 5000}, DT= 0.01 SEC"), {}, [""]),
        (files.knet_text(frequency="1D2Hz", largest=300.0), {"component": "EW"}, ["NS"]),
        (files.knet_text(frequency="1e-320Hz"), {}, [""]),
        (files.knet_text(duration="1e300"), {}, ["too large"]),
        (files.knet_text(scale="2000(gal)/1e-300"), {}, ["Scale Factor"]),
        (files.jma_text(rate=" SAMPLING RATE= 1e-320Hz"), {"component": "NS"}, ["time step"]),
        (files.jma_text(), {"component": "²"}, ['no component "²"']),
        (files.csv_text("t_s,a_gal,b_gal").replace("\n0", ",1\n0"), {"component": "²"}, [""]),
    ],
    ids=range(11),
)
def test_numbers_of_a_motion_that_overflow(
    text: str, options: dict[str, Any], pieces: list[str], tmp_path: Path
) -> None:
    path = files.write(tmp_path / "a.txt", text)
    told(lambda: load_motion(path, **options), str(path), *pieces)


def test_exponents_as_fortran_writes_them_in_a_header(tmp_path: Path) -> None:
    path = files.write(tmp_path / "a.knet", files.knet_text(frequency="1D2Hz"))
    assert load_motion(path).dt == 0.01


def test_search_for_a_spectrum_ends_where_it_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    rounds: list[tuple[int, int]] = []
    monkeypatch.setattr(matching, "GOAL", 0.0)
    monkeypatch.setattr(matching, "ENOUGH", 0.0)
    noise = np.random.default_rng(0).standard_normal(1500) * files.shaking(count=1500)
    effort = matching.Effort(12, lambda done, most: rounds.append((done, most)))
    fit = matching.matched(noise, 0.02, lambda t: 1e3 + 0.0 * t, finer=True, effort=effort)
    assert rounds == [(k, 12) for k in range(1, 13)]
    assert np.isfinite(fit.acceleration).all()
    assert 0.0 < fit.misfit < 1.0


def test_search_that_is_stuck_far_away_ends_early() -> None:
    """Nothing but one short wave: no multipliers make the long periods of the target of it."""
    wave = np.sin(2.0 * np.pi * 20.0 * 0.01 * np.arange(1000)) * files.shaking(count=1000)
    effort = matching.Effort()
    fit = matching.matched(1e-9 * wave, 0.01, lambda t: 1e4 + 0.0 * t, effort=effort)
    assert effort.done < 60
    assert fit.misfit > matching.LARGEST_MISFIT


def test_progress_of_a_motion_that_is_made(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(matching, "MOST_ROUNDS", 3)
    rounds: list[int] = []
    motion = make_motion("II", "I", 1, 0.02, progress=lambda done, most: rounds.append(done))
    assert rounds[-1] >= 3
    assert "misfit" in motion.description
