"""Spectra of codes and files as targets, and motions written to files."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests import tolerances as tol
from tests.unit.inputs import command, summary
from thermobearing.border.errors import InputError, OutputError
from thermobearing.motions.library import load_motion, save_motion
from thermobearing.motions.matching import misfit
from thermobearing.motions.record import STANDARD_GRAVITY, GroundMotion
from thermobearing.motions.run import examine_motion, make_motion_case, run_motion
from thermobearing.motions.targets import load_spectrum, read_target, target_text

AASHTO: dict[str, Any] = {"shape": "aashto", "A_s": "0.4 g", "S_DS": "1 g", "S_D1": "0.6 g"}
ASCE: dict[str, Any] = {"shape": "asce-7", "S_DS": "9.80665 m/s2", "S_D1": "0.5 g", "T_L": "4 s"}
EUROCODE: dict[str, Any] = {"shape": "en-1998-1", "type": 1, "ground": "C", "a_g": "0.2 g"}
# Period [s] and acceleration [g] by the formulas of the codes, at corners, between and beyond.
POINTS = {
    "aashto": (
        AASHTO,
        [(0.06, 0.7), (0.12, 1.0), (0.6, 1.0), (1.0, 0.6), (3.0, 0.2), (8.0, 0.075)],
    ),
    "asce": (
        ASCE,
        [(0.05, 0.7), (0.1, 1.0), (0.5, 1.0), (2.0, 0.25), (4.0, 0.125), (8.0, 0.03125)],
    ),
    "eurocode": (
        EUROCODE,
        [(0.1, 0.4025), (0.2, 0.575), (0.6, 0.575), (1.2, 0.2875), (2.0, 0.1725), (4.0, 0.043125)],
    ),
    "type 2": (EUROCODE | {"type": 2, "ground": "D"}, [(0.1, 0.9), (0.3, 0.9), (1.2, 0.225)]),
}


@pytest.mark.parametrize("name", POINTS)
def test_corners_of_the_shapes_of_codes(name: str) -> None:
    table, points = POINTS[name]
    periods, wanted = np.array(points).T
    assert_allclose(load_spectrum(table).at(periods) / STANDARD_GRAVITY, wanted, rtol=1e-12)
    assert_allclose(load_spectrum(table, 0.5).at(periods) / STANDARD_GRAVITY, 0.5 * wanted)


def test_a_motion_for_a_file_fits_it_as_built_in_ones_do(tmp_path: Path) -> None:
    site = tmp_path / "site.csv"
    periods = np.geomspace(0.05, 4.0, 80)
    values = load_spectrum(EUROCODE).at(periods) / STANDARD_GRAVITY
    rows = [f"{t:.6g},{a:.6g}" for t, a in zip(periods, values, strict=True)]
    site.write_text("\n".join(["period [s],acceleration [g]", *rows]) + "\n")
    result = run_motion(make_motion_case("II", "I", seed=3, dt=0.02, spectrum=site))
    assert (result.motion.name, result.outcome) == ("site-3", "completed")
    assert misfit(result.motion, load_spectrum(EUROCODE).at) <= tol.MISFIT
    assert result.warnings == []
    compared = examine_motion(result.motion, compare=site)
    assert compared.misfit == result.misfit
    assert compared.summary()["standard_spectrum"]["name"] == "site"
    assert "target_gal" in compared.table
    # From the command: the shape of a code as a file, compared with what it was made for.
    (tmp_path / "code.toml").write_text(
        "".join(f"{key} = {value!r}\n".replace("'", '"') for key, value in EUROCODE.items())
    )
    saved, out = save_motion(result.motion, tmp_path / "site-3.AT2"), tmp_path / "out"
    words = ["motions", "spectrum", saved, "--compare", tmp_path / "code.toml", "--trust-unit"]
    done = command(*words, "-o", out, "--no-figures")
    assert done.exit_code == 0
    assert summary(out)["standard_spectrum"]["misfit_rms"] <= tol.MISFIT


@pytest.mark.parametrize(("ending", "digits"), [("AT2", 8), ("csv", 9)])
def test_a_saved_motion_is_read_back_to_its_digits(
    ending: str, digits: int, tmp_path: Path
) -> None:
    motion = load_motion("jra-i-ii-2")
    file = tmp_path / f"mine.{ending}"
    assert command("motions", "save", motion.name, file).exit_code == 0
    again = load_motion(file)
    assert (again.name, again.dt) == ("mine", motion.dt)
    assert_allclose(again.acceleration, motion.acceleration, rtol=0.6 * 10.0 ** (1 - digits))
    with pytest.raises(OutputError):
        save_motion(motion, file)
    assert command("motions", "save", motion.name, file, "--overwrite").exit_code == 0
    with pytest.raises(InputError):
        save_motion(motion, tmp_path / "mine.txt")


BAD = {
    "no shape": ({}, "shape"),
    "another shape": ({"shape": "asce"}, '"asce"'),
    "no ground": (AASHTO | {"A_s": None}, "A_s"),
    "not of this shape": (ASCE | {"A_s": "0.4 g"}, "A_s"),
    "unknown key": (ASCE | {"SDS": "1 g"}, "SDS"),
    "no unit": (AASHTO | {"S_DS": 1.0}, "S_DS"),
    "another unit": (AASHTO | {"S_DS": "1 m"}, '"m"'),
    "negative": (AASHTO | {"S_D1": "-1 g"}, "S_D1"),
    "a percentage": (AASHTO | {"S_DS": "100 g"}, "10 g"),
    "falls from the start": (AASHTO | {"A_s": "1.5 g"}, "A_s"),
    "type": (EUROCODE | {"type": 3}, "type"),
    "ground": (EUROCODE | {"ground": "S1"}, "ground"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_shapes(case: str) -> None:
    table, word = BAD[case]
    with pytest.raises(InputError) as caught:
        load_spectrum({key: value for key, value in table.items() if value is not None})
    assert word in str(caught.value)
    assert len(caught.value.problems) == 1


@pytest.mark.parametrize("factor", [0.0, -1.0, float("nan"), "2"])
def test_bad_factors(factor: Any) -> None:
    with pytest.raises(InputError):
        load_spectrum(AASHTO, factor)


def test_a_file_is_named_once_with_its_fault(tmp_path: Path) -> None:
    out, site = tmp_path / "out", tmp_path / "site.csv"
    for text in ("", "period_s,acceleration\n0.1,1\n3,1\n", "period_s,acceleration_gal\n1,1\n"):
        site.write_text(text)
        for words in (["make", "--spectrum", site], ["spectrum", "jra-ii-i-1", "--compare", site]):
            done = command("motions", *words, "-o", out)
            assert (done.exit_code, done.stderr.count("site.csv")) == (2, 1)
            assert "Traceback" not in done.stderr
            assert not out.exists()
    both = ["motions", "spectrum", "jra-ii-i-1", "--compare", "jra-ii-ii", "--ground", "II"]
    assert command(*both).exit_code == 2


def test_a_named_standard_spectrum_has_its_own_envelope() -> None:
    case = make_motion_case(spectrum="jra-i-iii")
    assert (case.kind, case.ground, case.name) == ("I", "III", "jra-i-iii-1")
    assert make_motion_case(spectrum=load_spectrum(AASHTO)).kind == "II"


def test_a_ground_that_drifts_is_warned_of() -> None:
    """An offset of 0.4 % of PGA makes 466 cm of a record of 28 s; a permanent offset is none."""
    time = 0.01 * np.arange(2801)
    shaking = 3000.0 * np.sin(np.pi * time) * np.exp(-(((time - 10.0) / 4.0) ** 2))
    drifting = GroundMotion("drifting", 0.01, shaking + 11.89)
    result = examine_motion(drifting)
    assert result.measures.pgd == pytest.approx(4660.0, rel=0.01)
    assert len(result.warnings) == 1
    assert examine_motion(drifting, baseline=True).warnings == []
    fling = np.where((time > 8.0) & (time < 12.0), np.sin(0.5 * np.pi * (time - 8.0)), 0.0)
    moved = examine_motion(GroundMotion("fling", 0.01, shaking + 400.0 * fling))
    assert abs(moved.measures.end_displacement) > 900.0
    assert moved.warnings == []


def test_a_first_row_of_period_zero_is_the_acceleration_of_the_ground(tmp_path: Path) -> None:
    file = tmp_path / "site.csv"
    rows = ["0,0.4", "0.1,1.0", "0.5,1.0", "4,0.125"]
    file.write_text("\n".join(["period [s],acceleration [g]", *rows]))
    spectrum = load_spectrum(file)
    assert spectrum.ground_acceleration == pytest.approx(0.4 * STANDARD_GRAVITY)
    values = spectrum.at([0.025, 0.05, 0.1, 0.5]) / STANDARD_GRAVITY
    assert_allclose(values, [0.55, 0.7, 1.0, 1.0], rtol=1e-12)
    assert read_target(target_text(spectrum)) == spectrum  # in the header of a motion
    file.write_text("\n".join(["period [s],acceleration [g]", *rows[1:]]))
    assert load_spectrum(file).ground_acceleration is None
    file.write_text("\n".join(["period [s],acceleration [g]", "-0.1,0.4", *rows[1:]]))
    with pytest.raises(InputError):
        load_spectrum(file)
