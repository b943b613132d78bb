"""Accelerograms of every format and header, written here, come back as they were."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import tests.unit.motion_files as files
from thermobearing.motions.library import load_motion
from thermobearing.motions.readers import read_motion

GOOD: list[tuple[str, str, dict[str, Any]]] = [
    ("csv", files.csv_text(), {}),
    ("csv crlf", files.csv_text().replace("\n", "\r\n"), {}),
    ("csv unit in brackets", files.csv_text("Time [sec], Acceleration [cm/s^2]"), {}),
    ("csv in g", files.csv_text("t_s,acc_g", 0.3 / 0.980665), {}),
    ("csv in m/s2", files.csv_text("time (s),acc (m/s2)", 3.0), {}),
    ("csv in mm/s2", files.csv_text("t_s,acc_mm/s2", 3000.0), {}),
    ("csv unit given", files.csv_text("t,a"), {"unit": "gal"}),
    ("csv without header", "\n".join(files.csv_rows()), {"unit": "gal"}),
    ("unit and file agree", files.csv_text(), {"unit": "cm/s2", "dt": 0.01}),
    ("semicolons", files.csv_text("t_s;acc_gal").replace(",", ";"), {}),
    ("tabs", files.csv_text("#Time [sec] \tAcceleration [gal]").replace(",", "\t"), {}),
    ("comment in between", files.csv_text() + "# the end\n", {}),
    (
        "csv in ms",
        "\n".join(
            ["time [ms],acc [gal]", *(f"{10 * i},{v:.5f}" for i, v in enumerate(files.shaking()))]
        ),
        {},
    ),
    ("one column", files.one_column(), {"unit": "gal", "dt": 0.01}),
    ("one column, all in the header", files.one_column("% acc in gal, dt = 0.01 s"), {}),
    ("one column, ms", files.one_column("# Acc. in cm/sec^2, time step: 10 ms"), {}),
    ("at2", files.at2_text(0.3 / 0.980665), {}),
    ("at2 crlf", files.at2_text(0.3 / 0.980665, end="\r\n"), {}),
    ("at2 old header", files.at2_text(0.3 / 0.980665, "  400   .01000  NPTS, DT"), {}),
    ("at2 named without comma", files.at2_text(0.3 / 0.980665, "NPTS= 400 DT= 0.01 SEC"), {}),
    (
        "at2 free header, end mark",
        files.at2_text(0.3 / 0.980665, unit="The units are (g)") + "*** End Data ***\n",
        {},
    ),
    ("at2 without unit", files.at2_text(300.0, unit="-"), {"unit": "gal"}),
    ("k-net", files.knet_text(), {}),
    ("k-net by direction", files.knet_text(), {"component": "NS"}),
    ("kik-net by number", files.knet_text(direction="4"), {"component": "NS"}),
    ("jma", files.jma_text(), {"component": "NS"}),
    ("jma by number", files.jma_text(), {"component": 1}),
]


@pytest.mark.parametrize(("text", "options"), [pytest.param(*row[1:], id=row[0]) for row in GOOD])
def test_format_is_found_and_read(text: str, options: dict[str, Any], tmp_path: Path) -> None:
    path = files.write(tmp_path / "record.dat", text)
    motion = read_motion(path, **options)
    assert motion.dt == pytest.approx(files.DT, rel=1e-9)
    assert motion.name == "record"
    wanted = files.shaking(3000.0)
    wanted = wanted - wanted.mean() if "Memo." in text else wanted
    assert_allclose(motion.acceleration, wanted, rtol=0.0, atol=0.2)


def test_jma_text_in_cp932_and_its_other_components(tmp_path: Path) -> None:
    path = files.write(tmp_path / "jma.csv", files.jma_text(), "cp932")
    east, up = (load_motion(path, component=name) for name in ("EW", "ud"))
    assert_allclose(east.acceleration, -0.5 * files.shaking(3000.0), atol=0.2)
    assert up.pga == pytest.approx(300.0, rel=1e-3)
    assert "宇城市松橋町" in east.description


def test_columns_of_fortran_may_touch(tmp_path: Path) -> None:
    """8F10.5 leaves no blank before -1.23456 in the worst case."""
    text = "record\nunits of g\nNPTS= 4, DT= .01 SEC\n   0.10000-12.20000  -0.20000   0.30000\n"
    motion = read_motion(files.write(tmp_path / "a.at2", text), trust_unit=True)
    assert_allclose(motion.acceleration / 9806.65, [0.1, -12.2, -0.2, 0.3])


def test_exponent_of_fortran(tmp_path: Path) -> None:
    text = "header\nunits of g\nNPTS= 2, DT= .01 SEC\n 0.1D+00 -2.0D-01\n"
    motion = read_motion(files.write(tmp_path / "a.at2", text))
    assert_allclose(motion.acceleration / 9806.65, [0.1, -0.2])


def test_two_components_named_by_the_comment(tmp_path: Path) -> None:
    rows = "\n".join(f"{v:.5f} {-2.0 * v:.5f}" for v in files.shaking())
    text = f"% first N-S, second E-W; Acc. in cm/sec^2 and dt=0.01 sec.\n{rows}\n"
    path = files.write(tmp_path / "kobe.txt", text)
    north, east = (read_motion(path, component=name) for name in ("NS", "E-W"))
    assert_allclose(east.acceleration, -2.0 * north.acceleration, atol=0.2)
    assert_allclose(read_motion(path, component=2).acceleration, east.acceleration)


def test_time_need_not_begin_at_zero(tmp_path: Path) -> None:
    rows = [f"{12.3 + i * 0.01:.3f} {v:.5f}" for i, v in enumerate(files.shaking())]
    motion = read_motion(files.write(tmp_path / "a.txt", "\n".join(rows)), unit="gal")
    assert motion.time[0] == 0.0
    assert motion.dt == pytest.approx(0.01)


@pytest.mark.parametrize("digits", [3, 4, 6])
def test_rounded_times_are_even(digits: int, tmp_path: Path) -> None:
    """1/128 s cannot be written with three digits."""
    rows = [f"{i / 128:.{digits}f},{v:.5f}" for i, v in enumerate(files.shaking())]
    path = files.write(tmp_path / "a.csv", "\n".join(["t_s,acc_gal", *rows]))
    assert read_motion(path).dt == pytest.approx(1.0 / 128.0, rel=2e-4)


def test_weak_motion_is_read_if_its_unit_is_trusted(tmp_path: Path) -> None:
    path = files.write(tmp_path / "weak.csv", files.csv_text(pga=3.0))
    assert read_motion(path, trust_unit=True).pga == pytest.approx(30.0, rel=1e-3)


def test_name_can_be_given(tmp_path: Path) -> None:
    path = files.write(tmp_path / "a.csv", files.csv_text())
    assert load_motion(path, name="Tokachi").name == "Tokachi"
    assert load_motion(str(path)).name == "a"


def test_unknown_rows_do_not_change_what_is_read(tmp_path: Path) -> None:
    text = "\n\n" + files.csv_text().replace("\n", "\n\n")
    motion = read_motion(files.write(tmp_path / "a.csv", text, "utf-8-sig"))
    assert len(motion.acceleration) == files.COUNT
    assert np.isfinite(motion.acceleration).all()
