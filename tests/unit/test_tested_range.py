"""The range that a bearing was tested in: its record in a file, and what every analysis says."""

import contextlib
import io
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest

import thermobearing as tb
from tests.unit.inputs import SPECIMEN, assert_refused, changed_table, specimen_table, write_toml
from thermobearing.bearing.bilinear import load_bilinear
from thermobearing.bearing.scaling import extract_compound
from thermobearing.bearing.sources import is_never_tested
from thermobearing.cyclic.report import build_pieces
from thermobearing.design import codes
from thermobearing.design.case import make_design_case
from thermobearing.design.run import run_bounds, run_factors
from thermobearing.earthquake.dataset import _reached
from thermobearing.earthquake.run import Device
from thermobearing.identify.uncertainty.posterior import forecast
from thermobearing.model.constants import with_parameters
from thermobearing.model.options import build_model
from thermobearing.quantities.warned import NO_RANGE
from thermobearing.results.ranges import (
    NEVER_TESTED,
    REST,
    compared,
    cycles_in_a_row,
    largest_speed,
    outside_tests,
)

LHDR = "shen-lhdr-specimen"


def test_ranges_of_the_specimens() -> None:
    result = {}
    for name in (SPECIMEN, "shen-lhdr-specimen"):
        law = tb.load_bearing(name).tested_range
        assert law is not None
        result[name] = law.ranges()
    plain, lead = result.values()
    assert plain == {
        "strain": (0.5, 2.5),
        "strain_rate": (0.333, 1.0),  # 10 and 30 mm/s over 30 mm
        "ambient": (-20.0, 23.0),
        "cycles": (0.0, 5.0),
    }
    assert lead["strain_rate"] == (0.333, 1.571)  # a sine is pi/2 faster than on average
    assert lead["lead_temperature"] == (-20.0, 96.0)
    bilinear = load_bilinear("shen-bilinear-bridge").tested_range
    assert bilinear is not None
    assert bilinear.ranges()["ambient"] == (23.0, 23.0)


def test_an_untested_bearing_has_none() -> None:
    assert tb.load_bearing("lrb-example").tested_range is None


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({}, "give at least one of strain, strain_rate, ambient, cycles, lead_temperature"),
        ({"strain": [2.5, 0.5]}, "strain: 2.5 is above 0.5; write [lowest, highest]"),
        ({"ambient": [-20, 23]}, 'has no unit; write "-20 degC"'),
        ({"strain": [0.5]}, "tested_range.strain = [0.5]: must have at least 2 entr"),
        ({"strains": [0.5, 2.5]}, 'unknown key "tested_range.strains"; did you mean "strain"'),
    ],
)
def test_bad_ranges(table: dict[str, object], message: str, tmp_path: Path) -> None:
    file = write_toml(
        tmp_path / "mine.toml", changed_table(specimen_table(), {"tested_range": table})
    )
    assert_refused(lambda: tb.load_bearing(file), message)


def history(strain: float = 1.0, speed: float = 30.0) -> tb.CyclicTest:
    cycle = {"step": "cycles", "strain": strain, "speed": speed, "count": 1}
    return tb.CyclicTest(dt=0.02, steps=[cycle])


def test_rows_take_the_end_that_is_farther_out() -> None:
    limits, units = {"air": (-20.0, 23.0)}, {"air": "degC"}
    for demand, end, passed in (
        ((-30.0, 25.0), -30.0, True),
        ((-21.0, 40.0), 40.0, True),
        ((-10.0, 10.0), 10.0, False),
        (24.9, 24.9, False),  # within 2 K, more than two hundredths of 43 K
        (25.1, 25.1, True),
    ):
        (row,) = compared("x", {"air": demand}, limits, units, slack=0.02)
        assert (row["demand"], row["outside"]) == (end, passed)
    assert compared("x", {"air": float("nan")}, limits, units) == []
    for strain, passed in ((2.54, False), (2.56, True)):  # within two hundredths of 2.5
        rows = compared(
            "x", {"strain": strain}, {"strain": (0.5, 2.5)}, {"strain": "1"}, slack=0.02
        )
        assert rows[0]["outside"] == passed


def test_cycles_in_a_row_begin_anew_after_a_rest() -> None:
    t = np.linspace(0.0, 10.0, 1001)
    x = np.sin(2.0 * np.pi * t / 4.0)
    assert cycles_in_a_row(t, x) == 2.5
    apart = np.concatenate([t, t + 10.0 + REST])
    assert cycles_in_a_row(apart, np.tile(x, 2)) == 2.5
    near = np.concatenate([t, t + 10.0 + 0.5 * REST])
    assert cycles_in_a_row(near, np.tile(np.where(t > 8.0, 0.0, x), 2)) == 4.0
    noise = 0.005 * np.random.default_rng(1).standard_normal(len(t))
    assert cycles_in_a_row(t, x + noise) == 2.5
    assert largest_speed(t, x + noise) == pytest.approx(0.5 * np.pi, rel=0.005)


def test_the_speed_of_a_test_is_that_of_its_protocol_in_spite_of_noise() -> None:
    # The noise of a laboratory record, 0.11 mm, and the smallest of its amplitudes.
    t = np.arange(0.0, 60.0, 0.02)
    noise = 0.11 * np.random.default_rng(1).standard_normal(len(t))
    triangles = np.interp((t * 30.0 / 24.0) % 4.0, [0.0, 1.0, 3.0, 4.0], [0.0, 24.0, -24.0, 0.0])
    assert largest_speed(t, triangles + noise) == pytest.approx(30.0, rel=0.005)
    # A rest within a leg, and steps of time that are not equal.
    rested = np.where(t > 30.0, t + 120.0, t)
    assert largest_speed(rested, triangles + noise) == pytest.approx(30.0, rel=0.005)
    # No leg is a line or a cubic.
    steps = np.sign(np.sin(t)) * 24.0
    assert largest_speed(t, steps) > 100.0


def test_the_test_of_table_3_4_is_inside() -> None:
    for name, wave in ((SPECIMEN, "triangular"), ("shen-lhdr-specimen", "sine")):
        result = tb.run(name, tb.cyclic_test(wave=wave, dt=0.05), [-20.0, 23.0])
        assert not result.tested_range["outside"].any()
        assert not any("tested" in text for text in result.warnings)


def test_a_test_says_what_it_leaves(tmp_path: Path) -> None:
    test = history(strain=3.5, speed=300.0)
    result = tb.run("shen-lhdr-specimen", test, [-60.0, 23.0])
    left = result.tested_range[result.tested_range["outside"]]
    cold, warm = ("the run at -60 degC", "the run at 23 degC")
    assert set(left["run"] + " " + left["limit"]) == {
        f"{cold} strain",
        f"{cold} strain_rate",
        f"{cold} ambient",
        f"{warm} strain",
        f"{warm} strain_rate",
    } | {f"{run} lead_temperature" for run in left[left["limit"] == "lead_temperature"]["run"]}
    output = " ".join(result.warnings)
    assert "shen-lhdr-specimen: strain 350 %, above the 250 % tested (in 2 of 2 runs" in output
    assert "strain rate 10/s, above the 1.57/s tested" in output
    assert "ambient -60 degC, below the -20 degC tested (in 1 of 2 runs" in output
    assert result.summary()["tested_range"] == result.tested_range.to_dict("records")
    shown = [text.get_text() for text in result.plot.loops().axes[0].texts]
    assert shown == ["shaded: outside calibration range"]
    assert "(outside" in result.plot.loops().axes[0].get_title(loc="left")
    folder = result.save(tmp_path / "out", figures=False)
    pd.testing.assert_frame_equal(pd.read_csv(folder / "tested_range.csv"), result.tested_range)
    again = tb.load_result(folder)
    assert again.tested_range.equals(result.tested_range)
    with contextlib.redirect_stdout(io.StringIO()) as screen:
        result.show()
    assert "−60!" in screen.getvalue()


def test_a_small_slow_test_is_outside_too() -> None:
    output = " ".join(tb.run(SPECIMEN, history(strain=0.2, speed=1.0)).warnings)
    assert "strain 20 %, below the 50 % tested (in the run at 23 degC)" in output
    assert "strain rate 0.0333/s, below the 0.333/s tested" in output


def test_a_rest_asks_nothing_of_the_rubber() -> None:
    rest = tb.CyclicTest(dt=1.0, steps=[{"step": "rest", "duration": 100.0}])
    assert list(tb.run(SPECIMEN, rest).tested_range["limit"]) == ["ambient"]


def test_a_range_that_is_not_given_is_said_once() -> None:
    result = tb.run("lrb-example", history(), [23.0, 0.0])
    reported = [text for text in result.warnings if "range not given" in text]
    assert len(reported) == 1
    assert NEVER_TESTED in reported[0]
    assert result.tested_range.empty


@pytest.mark.thorough
def test_a_study_says_what_it_leaves(tmp_path: Path) -> None:
    bearings = ["lrb-example", "shen-bilinear-bridge", "shen-lhdr-bridge"]
    strong = {"name": "jra-ii-i-1", "factor": 2.0}
    study = tb.bridge(bearings, strong, [23.0, -60.0], duration=14.0)
    beyond = dict(zip(study.run_names, study.table["beyond_tested"], strict=True))
    assert beyond["lrb-example, jra-ii-i-1-x2, 23 degC"] == ""
    assert "ambient" in beyond["shen-bilinear-bridge, jra-ii-i-1-x2, -60 degC"]
    assert beyond["shen-lhdr-bridge, jra-ii-i-1-x2, 23 degC"].startswith("strain strain_rate")
    # One warning a cause: the strains of two bearings are one.
    (output,) = [text for text in study.warnings if "shen-lhdr-bridge: strain " in text]
    assert output.startswith("shen-bilinear-bridge: strain ")
    assert "above the 250 % tested (in 1 of 2 runs; largest in jra-ii-i-1-x2 at 23 degC)" in output
    assert sum("ambient" in text for text in study.warnings) == 1
    assert sum("range not given" in text for text in study.warnings) == 1
    rows = study.tested_range
    worst = float(study["bearing_strain_max"].values[4])
    assert rows.set_index(["run", "limit"])["demand"][
        "shen-lhdr-bridge, jra-ii-i-1-x2, 23 degC", "strain"
    ] == pytest.approx(worst)
    assert study.summary()["runs"][4]["beyond_tested"].startswith("strain")
    shaded = [
        "shaded: outside calibration range" in [t.get_text() for t in ax.texts]
        for ax in study.plot.loops().axes
    ]
    assert shaded == [False, True, True]
    folder = study.save(tmp_path / "out", figures=False)
    assert len(pd.read_csv(folder / "tested_range.csv")) == len(rows) == 14
    with contextlib.redirect_stdout(io.StringIO()) as screen:
        study.show()
    assert f"{100.0 * worst:.0f}!" in screen.getvalue()


def test_parts_of_a_sequence_say_what_they_leave() -> None:
    ramp = {"step": "ramp", "to_strain": 3.0, "speed": "30 mm/s"}
    parts = [{"part": "cyclic", "steps": [ramp]}, {"part": "rest", "duration": "1 h"}]
    done = tb.sequence({"parts": parts, "bearing": SPECIMEN, "ambient": "-30 degC"})
    assert list(done.table["beyond_tested"]) == ["strain ambient", "ambient"]
    assert list(done.tested_range["part"].unique()) == ["01-cyclic", "02-rest"]
    assert any("strain 300 %, above the 250 %" in text for text in done.warnings)


@pytest.mark.thorough
def test_a_fit_says_what_its_tests_cover(tmp_path: Path) -> None:
    test = tb.cyclic_test(strain=[0.5, 1.5], cycles=1, rest=None, dt=0.02)
    record = tb.synthetic_record(SPECIMEN, 5.0, test)
    fit = tb.identify_bearing(record, SPECIMEN, free=["K_r"], starts=1)
    folder = fit.save(tmp_path / "fit", figures=False)
    again = tb.load_bearing(folder / "bearing.toml")
    assert again.tested_range is not None
    assert fit.bearing.tested_range == again.tested_range
    ranges = again.tested_range.ranges()
    assert ranges["strain"] == pytest.approx((0.5, 1.5), rel=0.01)
    assert ranges["strain_rate"] == pytest.approx((1.0, 1.0), rel=0.05)
    assert ranges["ambient"] == (5.0, 5.0)
    assert again.sources["tested_range.strain"].startswith("tests ")
    drawn = forecast(fit, [-30.0, 5.0], narrow=False)
    cold, same = drawn.bands
    assert (cold.beyond_tested, same.beyond_tested) == ("ambient", "")
    assert drawn.warnings == (
        f"{SPECIMEN}: ambient -30 degC, below the 5 degC tested "
        "(in 1 of 2 runs; largest in the prediction at -30 degC)",
    )
    assert drawn.summary()["peak_force"][0]["beyond_tested"] == "ambient"
    assert "outside calibration range" in fit.plot.band(cold).get_suptitle()


def test_a_validation_says_what_a_bearing_was_not_tested_at(tmp_path: Path) -> None:
    test = history(strain=3.0, speed=90.0)
    record = tb.synthetic_record("shen-lhdr-specimen", 30.0, test)
    result = tb.validate_bearing(["shen-lhdr-specimen", "lrb-example"], record)
    assert list(result.table["beyond_tested"]) == ["strain strain_rate ambient", ""]
    output = " ".join(result.warnings)
    assert "strain 300 %, above the 250 % tested" in output
    assert "lrb-example: calibration range not given" in output
    assert result.summary()["tested_range"] == result.tested_range.to_dict("records")
    folder = result.save(tmp_path / "out", figures=False)
    assert (folder / "tested_range.csv").exists()
    assert [t.get_text() for t in result.plot.loops().axes[0].texts] == [
        "shaded: outside calibration range"
    ]
    with contextlib.redirect_stdout(io.StringIO()) as screen:
        result.show()
    assert "above the 250 % tested" in screen.getvalue()


def test_an_example_was_never_tested_and_a_file_may_state_its_tests() -> None:
    """The sentence of a bearing of chosen numbers has no cure, as none of its tests exists."""
    warnings = {
        never: outside_tests("pier", [], None, never_tested=never)[0] for never in (False, True)
    }
    assert {warning.code for warning in warnings.values()} == {NO_RANGE}
    assert [NEVER_TESTED in text for text in warnings.values()] == [False, True]
    assert ["tested_range" in text for text in warnings.values()] == [True, False]
    example = tb.load_bearing("lrb-example")
    assert is_never_tested(example.sources)
    assert not is_never_tested(tb.load_bearing("shen-lhdr-specimen").sources)
    for bearing, words in (
        (example, NEVER_TESTED),
        (tb.load_bearing("shen-hdr-bridge"), "calibrated bearing"),
    ):
        first, *_ = codes.reasons(bearing, [], 0.5)
        assert words in first
    nameless = example.with_sources({})
    assert not {NEVER_TESTED, "calibrated"} & set(codes.reasons(nameless, [], 0.5)[0])


@pytest.mark.thorough
def test_factors_and_bounds_say_what_they_leave(tmp_path: Path) -> None:
    bearing = "shen-hdr-bridge"
    report = run_factors([bearing], temperatures=[-40.0], strains=[1.0])
    reported = report.table.drop_duplicates("ambient_degC").set_index("ambient_degC")[
        "beyond_tested"
    ]
    assert reported[-40.0] == "strain_rate ambient"
    assert reported[23.0] == "strain_rate"
    assert any("ambient -40 degC, below the -20 degC tested" in w for w in report.warnings)
    *panels, free = report.plot.factors().axes
    assert not any(ax.texts for ax in panels)  # the legend states what the shades mean
    assert "outside calibration range" in [t.get_text() for t in free.get_legend().get_texts()]
    bounds = run_bounds([bearing], ["jra-ii-i-1"], [23.0, -30.0])
    assert set(bounds.table["beyond_tested"]) == {"strain_rate ambient"}
    assert any("ambient -30 degC, below the -20 degC tested" in w for w in bounds.warnings)
    assert bounds.summary()["warnings"] == bounds.warnings
    for name, one in (("factors", report), ("bounds", bounds)):
        folder = one.save(tmp_path / name, figures=False)
        assert (folder / "tested_range.csv").exists()


def test_a_design_says_what_leaves_the_curves() -> None:
    strong = {"name": "jra-ii-i-1", "factor": 2.5}
    case = make_design_case({"most_rounds": 1}, "x", motions=[strong])
    design = tb.run_design(case)
    assert design.last.found / design.bearings[0].total_rubber_thickness > 2.6
    assert len(design.warnings) == 2  # the other one: too few motions for a mean
    assert "above the 250 % tested" in design.warnings[1]
    assert design.summary()["warnings"] == design.warnings
    assert design.plot.rounds().axes[0].texts[0].get_text() == "the curves end here"


def test_of_several_lines_the_one_that_goes_farthest_counts() -> None:
    clock = np.linspace(0.0, 1.0, 101)
    lines = [
        {"clock": clock, "displacement": size * np.sin(2.0 * np.pi * clock), "lead_temperature": t}
        for size, t in ((60.0, 20.0 + clock), (90.0, 20.0 - clock))
    ]
    bearing: Any = SimpleNamespace(total_rubber_thickness=30.0)
    constants: Any = SimpleNamespace(lead=SimpleNamespace(cores=4.0))
    stack: Any = object()
    device = Device(bearing=bearing, constants=constants, stack=stack)
    task: Any = SimpleNamespace(lines=[SimpleNamespace(device=device, ambient=20.0)] * 2)
    history: Any = SimpleNamespace(bearing=lambda line: lines[line])
    result = _reached(task, history, [0, 1])
    assert result["strain"] == pytest.approx(3.0)
    assert result["strain_rate"] == pytest.approx(6.0 * np.pi, rel=0.01)
    assert (result["ambient"], result["lead_temperature"]) == ((20.0, 20.0), (19.0, 21.0))


def test_lead_softens_beyond_the_warmest_of_its_tests() -> None:
    """At the published rate by default, from T_0 on where the tests are not stated."""
    specimen, natural = (build_model(tb.load_bearing(name)) for name in (LHDR, "lrb-example"))
    lead = specimen.constants.lead
    assert (lead.softening, lead.softening_beyond, lead.warmest_tested) == (0.0, 0.0069, 96.0)
    assert natural.constants.lead.warmest_tested == 20.0
    constant = tb.changed_bearing(LHDR, law="constant-lead")
    assert build_model(constant).constants.lead.softening_beyond == 0.0
    compound = extract_compound(constant)
    assert compound.lead is not None
    assert compound.lead.softening_beyond_tests == 0.0
    changed = tb.changed_bearing(LHDR, lead={"softening": 0.002})
    tests, others = (
        with_parameters(specimen.constants, changed, specimen.stack, only_tests=only).lead
        for only in (True, False)
    )
    assert (tests.softening, tests.softening_beyond) == (0.002, 0.002)  # of a calibration
    assert (others.softening, others.softening_beyond) == (0.002, 0.0069)


def test_reports_state_what_lead_does_beyond_its_tests() -> None:
    test = tb.cyclic_test(strain=[0.5], cycles=1)
    for law, rate in ((None, "0.0069"), ("constant-lead", "0/K")):
        bearing = tb.changed_bearing(LHDR, law=law) if law else LHDR
        assert any(rate in text for text in build_pieces(tb.run(bearing, test)).assumptions)
