"""Ground motions from files: every format, every fault; the command."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from tests.shared_data import shared_data
from tests.unit.inputs import assert_told, command
from thermobearing.drive.motions.process import (
    baseline_corrected,
    padded,
    resampled,
    scaled,
    trimmed,
)
from thermobearing.drive.motions.readers import read_motion
from thermobearing.drive.motions.record import GroundMotion

# File, options, PGA [gal] and dt [s] as told beside the records.
REAL = [
    ("jma_kobe_ns_ew_gal_dt0.005.txt", {"component": "NS"}, 825.0, 0.005),
    ("jma_kobe_ns_ew_gal_dt0.005.txt", {"component": 2}, 619.0, 0.005),
    ("TAK000.AT2", {}, 605.8, 0.01),
    ("RSN6_IMPVALL.I_I-ELC180.AT2", {}, 275.4, 0.01),
    ("STAIRlab_elCentro.at2", {}, 313.0, 0.02),
    ("RSN1546_CHICHI_TCU122-N.AT2", {}, 256.0, 0.005),
    ("TKYH121103111446.NS2", {}, 157.2, 0.01),
    ("TKYH121103111446.EW2", {}, 105.9, 0.01),
    ("TKYH121103111446.UD2", {}, 65.5, 0.01),
    ("Q4149CF2.csv", {"component": "NS"}, 327.0, 0.01),
    ("KNG007_NS_t_g.txt", {}, 230.3, 0.02),
    ("II-I-1_like_JMA_NS.csv", {}, 827.0, 0.01),
    ("II-I-2_like_JMA_EW.csv", {}, 802.0, 0.01),
    ("II-II-1_like_TAK000.csv", {}, 607.0, 0.01),
]


@pytest.mark.parametrize(("name", "options", "pga", "dt"), REAL)
def test_real_records(name: str, options: dict[str, Any], pga: float, dt: float) -> None:
    motion = read_motion(shared_data(f"motions/{name}"), **options)
    assert motion.dt == pytest.approx(dt)
    assert motion.pga / 10.0 == pytest.approx(pga, rel=tol.RECORD_PGA)
    assert np.isfinite(motion.acceleration).all()
    assert motion.duration > 20.0


AT2 = """PEER NGA STRONG MOTION DATABASE RECORD
SOMEWHERE, 01/01/2000
ACCELERATION TIME SERIES IN UNITS OF {unit}
{header}
 0.0 .1E+00 -.2E+00
 .3E+00 0.1 -0.1
"""
NPTS = "NPTS=   6, DT=   .0100 SEC,"
CSV = "t_s,acc_gal\n0.00,0\n0.01,300\n0.02,-200\n0.03,100\n"


def test_at2_with_touching_columns_and_windows_ends(tmp_path: Path) -> None:
    text = AT2.format(unit="G", header=NPTS).replace("0.1 -0.1", "0.1-0.1").replace("\n", "\r\n")
    path = tmp_path / "a.at2"
    path.write_bytes(text.encode())
    motion = read_motion(path)
    assert_allclose(motion.acceleration / 9806.65, [0.0, 0.1, -0.2, 0.3, 0.1, -0.1])
    assert (motion.dt, motion.name) == (0.01, "a")


BAD: list[tuple[str, str, dict[str, Any], list[str]]] = [
    ("empty", "", {}, ["empty"]),
    ("words", "hello\nworld\n", {}, ["no numbers"]),
    ("no unit", "t,acc\n0,0\n0.01,300\n0.02,1\n", {}, ["unit"]),
    ("no time step", "acc_gal\n0\n300\n-200\n", {}, ["time step", "dt"]),
    ("NaN", CSV.replace("-200", "nan"), {}, ["line 4", "nan"]),
    ("infinite", CSV.replace("-200", "inf"), {}, ["line 4", "inf"]),
    ("a word among numbers", CSV.replace("-200", "x"), {}, ["line 4", "x"]),
    ("gap", CSV + "0.10,5\n", {}, ["0.03", "0.1"]),
    ("uneven", CSV.replace("0.02,", "0.024,"), {}, ["even"]),
    ("time goes back", CSV.replace("0.02,", "0.005,"), {}, ["line 4"]),
    ("g labelled gal", "t_s,acc_gal\n0,0\n0.01,0.3\n0.02,-0.2\n0.03,0.1\n", {}, ["gal", "g"]),
    ("gal labelled g", CSV.replace("gal", "g").replace("100\n", "1\n"), {}, ["g"]),
    ("m/s2 labelled gal", CSV.replace("300", "3").replace("-200", "-2").replace("100", "1"), {},
     ["gal"]),
    ("unknown unit", CSV.replace("gal", "furlong"), {}, ["furlong"]),
    ("unknown unit given", CSV, {"unit": "gall"}, ["gall", "gal"]),
    ("contradiction of units", CSV, {"unit": "g"}, ["g"]),
    ("contradiction of steps", CSV, {"dt": 0.02}, ["0.01", "0.02"]),
    ("negative step", "acc_gal\n0\n300\n-200\n", {"dt": -0.01}, ["-0.01"]),
    ("one sample", "t_s,acc_gal\n0,300\n", {}, []),
    ("several components", "t_s,ns_gal,ew_gal\n0,0,0\n.01,300,1\n.02,1,2\n", {}, ["component"]),
    ("unknown component", "t_s,ns_gal,ew_gal\n0,0,0\n.01,300,1\n.02,1,2\n", {"component": "NW"},
     ["NW", "NS"]),
    ("truncated AT2", AT2.format(unit="G", header=NPTS.replace("6", "60")), {}, ["60", "6"]),
    ("AT2 of velocity", AT2.format(unit="CM/S", header=NPTS), {}, ["CM/S"]),
    ("AT2 without points", AT2.format(unit="G", header="NPTS= 0, DT= .01 SEC"), {}, ["0"]),
    ("AT2 in gal said to be g", AT2.format(unit="G", header=NPTS).replace(".3E+00", "300."), {},
     ["g"]),
    ("zero throughout", "t_s,acc_gal\n0,0\n0.01,0\n0.02,0\n", {}, []),
]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "options", "pieces"), [pytest.param(*row[1:], id=row[0]) for row in BAD]
)
def test_bad_files(tmp_path: Path, text: str, options: dict[str, Any], pieces: list[str]) -> None:
    path = tmp_path / ("a.at2" if text.startswith("PEER") else "a.csv")
    path.write_text(text)
    with pytest.raises(tb.InputError) as caught:
        read_motion(path, **options)
    assert str(path) in str(caught.value)
    assert_told(str(caught.value).lower(), [piece.lower() for piece in pieces])


def test_files_that_are_none(tmp_path: Path) -> None:
    for path in (tmp_path, tmp_path / "none.csv"):
        with pytest.raises(tb.InputError):
            read_motion(path)
    binary = tmp_path / "b.csv"
    binary.write_bytes(b"\0\1\2")
    with pytest.raises(tb.InputError, match="null bytes"):
        read_motion(binary)
    with pytest.raises(tb.InputError, match="jra-ii-i-1"):
        tb.load_motion("jra-ii-i-11")
    with pytest.raises(tb.InputError, match="built in"):
        tb.load_motion("jra-ii-i-1", unit="gal")


def test_a_size_that_is_meant(tmp_path: Path) -> None:
    path = tmp_path / "weak.csv"
    path.write_text(CSV.replace("300", "3").replace("-200", "-2").replace("100", "1"))
    assert read_motion(path, trust_unit=True).pga == 30.0


def sine(frequency: float, dt: float, duration: float = 10.0) -> GroundMotion:
    time = dt * np.arange(round(duration / dt) + 1)
    return GroundMotion("sine", dt, 1000.0 * np.sin(2.0 * np.pi * frequency * time))


def test_resampling_keeps_what_fits_and_drops_what_does_not() -> None:
    """30 Hz does not fit into 0.02 s samples (25 Hz): it must vanish, not come back as 20 Hz."""
    low, high = resampled(sine(5.0, 0.005), 0.02), resampled(sine(30.0, 0.005), 0.02)
    inner = slice(50, -50)
    expected = sine(5.0, 0.02).acceleration
    assert_allclose(low.acceleration[inner], expected[inner], atol=tol.RESAMPLED * 1000.0)
    assert np.abs(high.acceleration[inner]).max() < 10.0 * tol.RESAMPLED * 1000.0
    finer = resampled(sine(5.0, 0.02), 0.005)
    reference = np.interp(finer.time, sine(5.0, 0.02).time, sine(5.0, 0.02).acceleration)
    assert_allclose(finer.acceleration, reference, atol=1e-9)  # linear between samples


def test_baseline_correction_ends_at_rest() -> None:
    motion = tb.load_motion("jra-ii-i-1")
    drifting = GroundMotion("drift", motion.dt, motion.acceleration + 20.0)
    assert abs(drifting.displacement[-1]) > 1e4
    mended = baseline_corrected(drifting)
    assert abs(mended.velocity[-1]) < tol.QUIET_END
    assert abs(mended.displacement[-1]) < tol.QUIET_END
    assert np.abs(mended.acceleration - motion.acceleration).max() < 0.05 * motion.pga
    assert np.abs(mended.displacement).max() < 3.0 * np.abs(motion.displacement).max()


def test_scaling_cutting_padding() -> None:
    motion = tb.load_motion("jra-ii-i-1")
    assert scaled(motion, 2.0).pga == 2.0 * motion.pga
    part = trimmed(motion, 5.0, 15.0)
    assert part.duration == pytest.approx(10.0)
    assert part.acceleration[0] == motion.acceleration[500]
    longer = padded(motion, 1.0, 2.0)
    assert longer.duration == pytest.approx(motion.duration + 3.0)
    assert longer.pga == motion.pga
    for call in (
        lambda: scaled(motion, float("nan")),
        lambda: trimmed(motion, 60.0, 70.0),
        lambda: padded(motion, -1.0),
        lambda: resampled(motion, 0.0),
    ):
        with pytest.raises(tb.InputError):
            call()


def test_command(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    time = 0.01 * np.arange(1001)
    acceleration = 300.0 * np.sin(2.0 * np.pi * time) * np.exp(-(((time - 5.0) / 2.0) ** 2))
    rows = "\n".join(f"{t:.2f},{a:.4f}" for t, a in zip(time, acceleration, strict=True))
    path.write_text("t_s,acc_gal\n" + rows + "\n")
    shown = command("motions", "show", path, "-o", tmp_path / "out", "--json")
    assert shown.exit_code == 0, shown.output
    assert "gal" in shown.output
    names = {p.name for p in (tmp_path / "out").iterdir()}
    assert names == {"summary.json", "motion.csv", "spectrum.csv", "figures"}
    again = read_motion(tmp_path / "out" / "motion.csv")
    assert_allclose(again.acceleration / 10.0, acceleration, atol=1e-3)
    json.loads((tmp_path / "out" / "summary.json").read_text())
    listed = command("motions", "list")
    assert listed.output.count("NOT an accelerogram") == 18
    spectrum = command("motions", "spectrum", "jra-ii-i-1", "--damping", 0.05)
    assert "Type II, ground I" in spectrum.output
    for bad in (["show", "jra-ii-i-11"], ["spectrum", path, "--damping", 2.0],
                ["make", "--type", "III"], ["make", "--ground", "IV"],
                ["show", tmp_path / "none.csv"]):  # fmt: skip
        refused = command("motions", *bad, "-o", tmp_path / "no")
        assert refused.exit_code == 2, bad
        assert not (tmp_path / "no").exists()
