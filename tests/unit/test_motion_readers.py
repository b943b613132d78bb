"""Accelerograms of every format come back as they were; bad ones are refused."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from threadpoolctl import threadpool_info, threadpool_limits

import tests.unit.motion_files as files
from tests.unit.inputs import assert_mentions, assert_refused, command
from thermobearing.border.errors import InputError
from thermobearing.motions import matching
from thermobearing.motions.library import load_motion
from thermobearing.motions.measures import significant_interval
from thermobearing.motions.process import baseline_corrected, padded, resampled
from thermobearing.motions.readers import read_motion
from thermobearing.motions.record import ASSERTED, GroundMotion, acceleration_unit
from thermobearing.motions.run import make_motion_case
from thermobearing.motions.spectrum import response_spectrum
from thermobearing.motions.synthesis import make_motion, match_spectrum
from thermobearing.motions.targets import standard_spectrum

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


STANDARD = "Ⅱ－Ⅰ－１", "Ⅱ－Ⅰ－２", "Ⅱ－Ⅰ－３"


@pytest.mark.parametrize(
    ("titles", "component"),
    [
        (STANDARD, "Ⅱ－Ⅰ－２"),
        (STANDARD, "II-I-2"),
        (STANDARD, "ii−i‐2"),
        (("II-I-1", "II-I-2", "II-I-3"), "II-I-2"),
        (("II-I-1", "II-I-2", "II-I-3"), "Ⅱ－Ⅰ－２"),
        (("Type II-I-1 [gal]", "Type II-I-2 [gal]", "Type II-I-3 [gal]"), "type  II-I-2"),
        (("２－Ⅰ－１", "２－Ⅰ－２", "２－Ⅰ－３"), "2-I-2"),
        (("E-W", "N-S", "U-D"), "NS"),
        (STANDARD, "2"),
    ],
)
def test_component_by_title_in_any_width_and_hyphen(
    titles: tuple[str, ...], component: str, tmp_path: Path
) -> None:
    """Layout of the standard motions of JRA: a column of time and one of each motion."""
    rows = [f"{0.01 * k:.2f},{k % 7},{300 * (k % 2) - 150},{k % 5}" for k in range(400)]
    path = files.write(tmp_path / "jra9.csv", "\n".join([",".join(("時間(s)", *titles)), *rows]))
    record = read_motion(path, component=component, unit="gal")
    assert_allclose(np.abs(record.acceleration), 1500.0)


def test_component_of_two_titles_that_differ_by_hyphens_alone(tmp_path: Path) -> None:
    rows = [f"{0.01 * k:.2f},{300 * (k % 2) - 150},{k % 5}" for k in range(400)]
    path = files.write(tmp_path / "both.csv", "\n".join(["t_s,A-1,A−1", *rows]))
    record = read_motion(path, component="A-1", unit="gal")  # the same text
    assert_allclose(np.abs(record.acceleration), 1500.0)
    with pytest.raises(InputError, match='no component "a-1"'):
        read_motion(path, component="a-1", unit="gal")


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


def changed(text: str, line: int, new: str) -> str:
    """The text with one line (from 1) replaced."""
    lines = text.splitlines()
    lines[line - 1] = new
    return "\n".join(lines) + "\n"


def without(text: str, first: int, last: int) -> str:
    """The text without lines first to last (from 1)."""
    lines = text.splitlines()
    return "\n".join(lines[: first - 1] + lines[last:]) + "\n"


CSV, AT2, KNET, JMA = files.csv_text(), files.at2_text(), files.knet_text(), files.jma_text()
TWO = "\n".join(f"{v:.4f} {v:.4f}" for v in files.shaking())
NS = {"component": "NS"}
BAD: list[tuple[str, str, dict[str, Any], list[str]]] = [
    ("empty", "", {}, ["is empty"]),
    ("prose", "This is no record.\nNot at all.\n", {}, ["no numbers", "accelerogram"]),
    ("one sample", "t_s,acc_gal\n0.0,300\n", {"dt": 0.01}, ["1 samples", "at least 2"]),
    ("no unit", "\n".join(files.csv_rows()), {}, ["does not state the unit", "gal", "m/s2"]),
    ("unknown unit", CSV, {"unit": "furlong"}, ['unknown unit of acceleration "furlong"', "gal"]),
    ("misspelt unit", CSV, {"unit": "gals"}, ['"gals"', 'did you mean "gal"']),
    ("unit against file", CSV, {"unit": "g"}, ['"g" was given', 'the file states "gal"']),
    ("g taken for gal", files.csv_text(pga=0.3), {}, ["0.3 gal", "100 to 2000", "294 gal", "in g"]),
    ("gal taken for g", files.at2_text(300.0), {}, ["300 g", "300 gal if the numbers are in gal"]),
    ("m/s2 taken for gal", files.csv_text(pga=8.0), {}, ["8 gal", "800 gal", "in m/s2"]),
    ("gal taken for m/s2", files.csv_text("t_s,acc_m/s2"), {}, ["3e+04 gal", "300 gal", "in gal"]),
    ("mm/s2 taken for m/s2", files.csv_text("t_s,acc_m/s2", 4000.0), {}, ["400 gal", "in mm/s2"]),
    ("trust is offered", files.csv_text(pga=20.0), {}, ["20 gal", "trust_unit"]),
    ("zero throughout", files.csv_text(pga=0.0).replace("nan", "0"), {}, ["zero throughout"]),
    ("no dt", files.one_column(), {"unit": "gal"}, ["does not state the time step", "dt"]),
    ("dt against file", CSV, {"dt": 0.02}, ["0.02 s was given", "the file has 0.01 s"]),
    ("dt zero", files.one_column(), {"unit": "gal", "dt": 0.0}, ["dt = 0 s", "> 0"]),
    ("dt in ms", files.one_column(), {"unit": "gal", "dt": 10.0}, ["10 s", "in seconds?"]),
    ("time in ms", CSV.replace("t_s", "t_min"), {}, ["0.6 s is outside"]),
    ("gap in time", without(CSV, 100, 140), {}, ["line 100", "a gap of 0.42 s", "0.01 s else"]),
    ("uneven", changed(CSV, 101, "0.993,10"), {}, ["line 101", "uneven time steps"]),
    ("time repeats", changed(CSV, 101, "0.98,10"), {}, ["line 101", "does not increase"]),
    ("NaN", changed(CSV, 50, "0.48,NaN"), {}, ["line 50", '"NaN" is not a finite number']),
    ("too large", changed(CSV, 50, "0.48,1e999"), {}, ["line 50", "not a finite number"]),
    ("word", changed(CSV, 50, "0.48,lost"), {}, ["line 50", '"lost" is not a number']),
    ("missing cell", changed(CSV, 50, "0.48"), {}, ["line 50", "1 columns instead of 2"]),
    ("both decimal marks", "0.00;1,5\n0.01;2,5\n", {}, ["decimal point", "decimal comma"]),
    ("component not chosen", TWO, {"unit": "gal", "dt": 0.01}, ["2 components", "component"]),
    ("no such component", TWO, {"unit": "gal", "dt": 0.01, **NS}, ['no component "NS"']),
    ("time only", "t_s\n0\n0.01\n0.02\n", {}, ["none of acceleration"]),
    ("several units", files.one_column("# gal, or m/s2; dt=0.01"), {}, ["several units"]),
    ("at2 cut off", without(AT2, 60, 84), {}, ["NPTS = 400", "contains 275", "cut off"]),
    ("at2 too long", AT2 + " 0.1 0.1\n", {}, ["NPTS = 400", "contains 402", "more"]),
    ("at2 stars", changed(AT2, 9, "0.1 0.1 ****** 0.1 0.1"), {}, ["line 9", "not a number"]),
    ("at2 dt zero", files.at2_text(line="NPTS= 400, DT= 0.0 SEC"), {}, ["0 s", "outside"]),
    ("velocity", files.at2_text(unit="VELOCITY TIME SERIES IN UNITS OF CM/S"), {}, ["a velocity"]),
    ("at2 component", AT2, {"component": "EW"}, ["one component", 'no component "EW"']),
    ("k-net no memo", files.knet_text(memo="x"), {}, ['"Memo."']),
    ("k-net no frequency", files.knet_text(frequency="often"), {}, ["Sampling Freq"]),
    ("k-net no scale", files.knet_text(scale="1"), {}, ["Scale Factor", "3920(gal)/6170801"]),
    ("k-net wrong scale", files.knet_text(scale="2000(gal)/9810"), {}, ["Max. Acc. 300"]),
    (
        "k-net, 2 % off",
        files.knet_text(largest=306.0),
        {},
        ["Max. Acc. 306", "largest value is 300"],
    ),
    (
        "k-net cut off",
        files.knet_text(duration="300"),
        {},
        ["30000 samples", "contains 400", "a gap"],
    ),
    ("k-net component", KNET, {"component": "EW"}, ["component NS", 'no component "EW"']),
    ("jma no component", JMA, {}, ["NS, EW, UD", "give component"]),
    ("jma wrong component", JMA, {"component": "NE"}, ['no component "NE"']),
    ("jma no rate", files.jma_text(rate=" RATE"), NS, ["SAMPLING RATE"]),
    ("jma no unit", files.jma_text(unit=""), NS, ["does not state the unit"]),
    ("jma no titles", files.jma_text(titles=" A,B,C"), NS, ['"NS,EW,UD"']),
    ("jma gap", changed(JMA, 20, "0.1,0.2"), NS, ["line 20", "2 columns instead of 3"]),
    ("jma in g", files.jma_text(pga=0.3), NS, ["0.3 gal", "10 to 5000 gal"]),
]


@pytest.mark.parametrize(
    ("text", "options", "pieces"), [pytest.param(*row[1:], id=row[0]) for row in BAD]
)
def test_bad_record_is_refused_with_a_sentence(
    text: str, options: dict[str, Any], pieces: list[str], tmp_path: Path
) -> None:
    path = files.write(tmp_path / "bad.txt", text)
    with pytest.raises(InputError) as caught:
        load_motion(path, **options)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert_mentions(message, pieces)


@pytest.mark.parametrize("name", ["empty", "unit against file", "dt in ms"])
def test_the_command_prints_the_same(name: str, tmp_path: Path) -> None:
    text, options = next((row[1], row[2]) for row in BAD if row[0] == name)
    path = files.write(tmp_path / "bad.txt", text)
    words = [word for key, value in options.items() for word in (f"--{key}", value)]
    done = command("motions", "show", path, *words, "-o", tmp_path / "out")
    assert done.exit_code == 2
    with pytest.raises(InputError) as caught:
        load_motion(path, **options)
    assert done.stderr == f"thermobearing: {caught.value}\n"
    assert not (tmp_path / "out").exists()


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    for path, piece in (
        (tmp_path / "none.at2", "no such file"),
        (tmp_path, "is a directory, not a file"),
        (files.write(tmp_path / "b.csv", "t_s\0"), "null bytes"),
    ):
        with pytest.raises(InputError, match=piece):
            load_motion(path)


def test_unknown_name_brings_the_nearest() -> None:
    with pytest.raises(InputError, match='no motion is named "jra-ii-i-4"; did you mean "jra-ii-i'):
        load_motion("jra-ii-i-4")
    with pytest.raises(InputError, match="known: jra-i-i-1"):
        load_motion("xyz")
    with pytest.raises(InputError, match="does not accept dt, unit"):
        load_motion("jra-ii-i-1", dt=0.01, unit="gal", component=None)


MOTION = GroundMotion("test", 0.01, files.shaking(3000.0))
TINY = GroundMotion("tiny", 0.01, np.ones(3))
STILL = GroundMotion("still", 0.01, np.zeros(1000))
CALLS: list[tuple[str, Any, list[str]]] = [
    ("period", lambda: response_spectrum(MOTION, [-1.0]), ["periods", "not negative"]),
    ("damping", lambda: response_spectrum(MOTION, [1.0], 1.0), ["damping: 1", "[0, 1)"]),
    ("steps", lambda: response_spectrum(MOTION, [1.0], steps_per_period=0), ["steps_per_period"]),
    ("kind", lambda: standard_spectrum("IV", "I", [1.0]), ['"IV" is not one of I, II']),
    ("both", lambda: standard_spectrum(3, 4, [1.0]), ["type of earthquake", 'ground: "4"']),
    ("zero period", lambda: standard_spectrum("I", "I", [0.0]), ["periods", "> 0"]),
    ("factor", lambda: standard_spectrum("I", "I", [1.0], zone_factor=0.0), ["zone_factor: 0"]),
    ("bytes", lambda: make_motion_case(kind="II", zone_factor=b"x"), ["zone_factor = b'x'"]),
    ("seed", lambda: make_motion("I", "I", -1), ["seed: -1"]),
    ("coarse", lambda: make_motion("I", "I", 1, 0.05), ["0.05 s", "[0.001, 0.02]"]),
    ("short", lambda: match_spectrum(MOTION, "II", "I"), ["lasts 3.99 s", "at least 5 s"]),
    ("still", lambda: match_spectrum(STILL, "II", "I"), ["zero throughout"]),
    ("duration", lambda: significant_interval(STILL), ["zero throughout"]),
    ("shares", lambda: significant_interval(MOTION, 0.9, 0.1), ["0.9", "start < end"]),
    ("new step", lambda: resampled(MOTION, 0.0), ["dt: 0 s"]),
    ("long step", lambda: resampled(MOTION, 10.0), ["dt: 10 s", "3.99"]),
    ("odd step", lambda: resampled(MOTION, 0.01 / np.pi), ["not a simple fraction"]),
    ("pad", lambda: padded(MOTION, -1.0), ["before = -1 s"]),
    ("corner", lambda: baseline_corrected(MOTION, high_pass=60.0), ["60 Hz", "50"]),
    ("tiny", lambda: baseline_corrected(TINY), ["3 samples"]),
    ("unit", lambda: acceleration_unit("kn"), ['unknown unit of acceleration "kn"']),
    ("low corner", lambda: baseline_corrected(MOTION, high_pass=1e-308), ["high_pass: 1e-308 Hz"]),
    ("finer", lambda: resampled(MOTION, 1e-9), ["dt: 1e-09 s", "samples"]),
    ("odd", lambda: resampled(MOTION, 0.01 * 7 / 1e9), ["samples"]),
    ("long pad", lambda: padded(MOTION, 1e5, 1e5), ["samples", "2000000"]),
    ("zone", lambda: make_motion("II", "I", 1, zone_factor=1e-300), ["zone_factor: 1e-300"]),
    ("long", lambda: match_spectrum(padded(MOTION, 0.0, 5000.0), "II", "I"), ["at most 120000"]),
]


@pytest.mark.parametrize(("call", "pieces"), [pytest.param(*row[1:], id=row[0]) for row in CALLS])
def test_bad_argument_is_reported(call: Any, pieces: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        call()
    assert_mentions(str(caught.value), pieces)


@pytest.mark.parametrize("pga", [204.0, 300.0, 605.0, 825.0, 980.0])
@pytest.mark.parametrize("factor", [9.80665, 100.0, 980.665])
def test_wrong_unit_never_passes(pga: float, factor: float, tmp_path: Path) -> None:
    """Motions of 204 to 980 gal, reported too large or too small by the factors between units."""
    for wrong in (factor, 1.0 / factor):
        path = files.write(tmp_path / "a.csv", files.csv_text(pga=pga * wrong))
        with pytest.raises(InputError, match="is the unit wrong") as caught:
            load_motion(path)
        meant = [float(size) for size in re.findall(r"(\S+) gal if the numbers", str(caught.value))]
        assert all(ASSERTED[0] <= size <= ASSERTED[1] for size in meant)


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
    assert_refused(lambda: load_motion(path, **options), str(path), *pieces)


def test_exponents_as_fortran_writes_them_in_a_header(tmp_path: Path) -> None:
    path = files.write(tmp_path / "a.knet", files.knet_text(frequency="1D2Hz"))
    assert load_motion(path).dt == 0.01


def test_search_for_a_spectrum_ends_where_it_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    rounds: list[tuple[int, int]] = []
    monkeypatch.setattr(matching, "GOAL", 0.0)
    monkeypatch.setattr(matching, "ENOUGH", 0.0)
    noise = np.random.default_rng(0).standard_normal(1500) * files.shaking(count=1500)
    effort = matching.Effort(12, lambda done, most: rounds.append((done, most)))
    fit = matching.matched(noise, 0.02, lambda t: 1e3 + 0.0 * t, finer=True, effort=effort)
    assert rounds == [(k, 12) for k in range(1, 13)]
    assert np.isfinite(fit.acceleration).all()
    assert 0.0 < fit.misfit < 1.0


def test_a_search_uses_one_blas_thread_and_restores_the_others() -> None:
    def count_threads(*_: int) -> None:
        counts.append(max(one["num_threads"] for one in threadpool_info()))

    counts: list[int] = []
    wave = files.shaking(count=1500)
    with threadpool_limits(2, "blas"):
        matching.matched(
            wave, 0.02, lambda t: 1e3 + 0 * t, effort=matching.Effort(2, count_threads)
        )
        count_threads()
    assert counts == [1, 1, 2]


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
