"""What the document of an earthquake study says, against the result that it is about."""

import dataclasses
import re
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests.unit.report_words import as_data, assert_well_formed, numbers_in
from thermobearing.border.library import data_path
from thermobearing.earthquake import answer, measures
from thermobearing.earthquake.answer import governing_lines
from thermobearing.earthquake.case import load_earthquake_case
from thermobearing.earthquake.measures import limits_by_bearing
from thermobearing.earthquake.motions import given_motions_table, motion_targets
from thermobearing.earthquake.report import build_pieces
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.tables import console_tables, structure_balance
from thermobearing.motions.library import load_motion, save_motion
from thermobearing.motions.targets import load_spectrum
from thermobearing.quantities.governing import place_of_largest
from thermobearing.report.content import limit_checks, summarize_checks
from thermobearing.report.pieces import EXCEEDED, PASSED, Check, Pieces, calibration_table
from thermobearing.report.template import _arranged
from thermobearing.results import drawing
from thermobearing.results.ranges import runs_of
from thermobearing.results.writing import as_attribute
from thermobearing.structure.model import fixed_base, load_structure

BEARINGS = ["shen-bilinear-bridge", "shen-lhdr-bridge"]


@pytest.fixture(scope="module")
def study() -> EarthquakeResult:
    return tb.bridge(
        BEARINGS, ["jra-ii-i-1", "jra-ii-i-2"], [23, -20], duration=12, keep=["rubber", "cells"]
    )


@pytest.fixture(scope="module")
def pieces(study: EarthquakeResult) -> Pieces:
    return build_pieces(study)


@pytest.fixture(scope="module")
def plan_of_two() -> EarthquakeResult:
    """A bridge in plan whose abutments have another bearing than its piers."""
    lines = [{"line": name, "bearing": "shen-hdr-bridge"} for name in ("A1", "A2")]
    structure = "five-span-bridge"
    return tb.bridge(
        "shen-lhdr-bridge", "jra-ii-i-1", 23, structure=structure, lines=lines, duration=6
    )


def test_question_and_answer(study: EarthquakeResult, pieces: Pieces) -> None:
    assert_well_formed(pieces)
    _arranged(pieces)
    assert "jra-ii-i-1 and jra-ii-i-2" in pieces.question
    assert "23 and −20 °C" in pieces.question
    table = study.table
    assert f"{table['bearing_strain_max'].max():.0%}".replace("%", " %") in pieces.answer[3]
    assert f"{table['pier_displacement_max_mm'].max():.3g} mm" in pieces.answer[3]
    assert f"{table['pier_ductility'].max():.3g}" in pieces.answer[2]
    lead = table[table["bearing"] == "shen-lhdr-bridge"]
    cold, warm = (lead[lead["ambient_degC"] == t] for t in (-20.0, 23.0))
    ratio = cold["bearing_force_max_kN"].mean() / warm["bearing_force_max_kN"].mean()
    size = f"{100 * abs(ratio - 1):.0f} % {'larger' if ratio > 1 else 'smaller'}"
    assert f"with shen-lhdr-bridge the mean bearing force is {size}" in pieces.answer[1]
    assert "shen-bilinear-bridge" in pieces.answer[1]


def test_peaks(study: EarthquakeResult, pieces: Pieces) -> None:
    table, reported = pieces.tables["peaks"], study.table
    assert np.allclose(numbers_in(table, "Strain"), 100.0 * reported["bearing_strain_max"])
    assert numbers_in(table, "Ductility") == reported["pier_ductility"].tolist()
    place = [column.head for column in table.columns].index("Ambient")
    beyond = {k for k, text in enumerate(reported["beyond_tested"]) if "ambient" in text.split()}
    assert {row for row, column in table.marked if column == place} == beyond
    assert beyond  # the bilinear bearing in the cold


def test_cold(study: EarthquakeResult, pieces: Pieces) -> None:
    table = pieces.tables["cold"]
    rows = {row[0]: row for row in table.rows}
    assert rows["shen-bilinear-bridge"][2] == "1.00 (1.00–1.00)"
    assert set(rows) == set(BEARINGS)
    assert "−20 °C" in table.caption


def test_both_ends_of_a_range_are_one_quantity() -> None:
    """Runs below and above the tested strains: one quantity, and two rows of what is outside."""
    row = {"limit": "strain", "unit": "1", "lowest": 0.5, "largest": 2.5, "outside": True}
    rows = [row | {"run": f"b, {k}", "demand": d} for k, d in enumerate((0.3, 3.0))]
    checks = limit_checks(rows, {"strain": "shear strain"}, "calibration range", ["b"])
    checks.append(Check("stress", 1.0, 2.0, "MPa", "code", PASSED))
    text = summarize_checks(checks, "5 of 7 runs")
    assert [int(number) for number in re.findall(r"\d+", text)] == [1, 2, 5, 7, 1]
    assert len(calibration_table(checks).rows) == 2


def test_checks_and_validity(study: EarthquakeResult, pieces: Pieces) -> None:
    reported = {check.what.split(" (")[0]: check for check in pieces.checks}
    limits = [check for check in pieces.checks if not check.of_tests]
    assert not any(check.verdict == EXCEEDED for check in limits)
    outside = [check for check in pieces.checks if check.of_tests and check.verdict == EXCEEDED]
    assert outside  # round-off of energy is no check
    runs = set().union(*(check.runs for check in outside))
    assert runs <= set(study.run_names)
    # The others are rows of the table of limits, which has none of the calibration range.
    rates = study.tested_range.query("limit == 'strain_rate'")
    fast = sum(rates["outside"])
    assert 0 < fast <= len(rates)
    counts = [len({check.limited for check in outside}), len(runs), fast, len(rates), len(limits)]
    assert [int(n) for n in re.findall(r"\d+", pieces.answer[-1])] == counts
    assert limits
    assert f" {fast} of {len(rates)} runs" in pieces.tables["peaks"].note
    table = calibration_table(pieces.checks)
    shares = [check.outside_by / abs(check.limit) for check in outside]
    assert len(table.rows) == len(outside)
    assert numbers_in(table, "Outside by")[0] == pytest.approx(
        outside[place_of_largest(shares)].outside_by, rel=1e-2
    )
    assert not any("residual" in check.what for check in pieces.checks)
    quality = pieces.tables["quality"]
    assert [row[-1] for row in quality.rows] == [PASSED] * 3
    assert max(row[1] for row in quality.rows) < 1e-9
    # The rate of every earthquake: a note with its number, and neither check nor warning.
    assert "shen-lhdr-bridge: strain rate" not in reported
    rows = study.tested_range
    mine = rows[(rows["limit"] == "strain_rate") & rows["run"].str.startswith("shen-lhdr")]
    (note,) = [text for text in pieces.notes if "train rate" in text]
    assert f"{mine['demand'].max():.2g}/s" in note
    assert not any("strain rate" in text for text in study.warnings)
    cold = [check for check in pieces.checks if check.lower and "bilinear" in check.what]
    assert [check.value for check in cold] == [-20.0]
    assert reported["ductility of pier"].verdict == PASSED
    assert not any("tested" in text for text in pieces.warnings)


def test_a_pier_that_yields_exceeds_its_limit(study: EarthquakeResult) -> None:
    data = study.dataset.assign(pier_ductility=1.4 + 0.0 * study.dataset["pier_ductility"])
    pieces = build_pieces(EarthquakeResult(data))
    (check,) = [c for c in pieces.checks if "ductility" in c.what]
    assert (check.value, check.limit, check.verdict) == (1.4, 1.0, EXCEEDED)
    assert not check.of_tests
    assert "1.4" in pieces.answer[2]


def test_a_small_share_of_damping_is_no_assumption(
    study: EarthquakeResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No item of the list is a full stop alone."""
    monkeypatch.setattr("thermobearing.earthquake.measures.LARGEST_DAMPING_SHARE", 1.0)
    assert study.damping_note == ""
    assert all(re.search(r"\w", text) for text in build_pieces(study).assumptions)


def test_piers_that_yield_are_listed_in_the_order_of_the_structure(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Pier P2 yields in the first run already, P1 in the second."""
    piers = pd.DataFrame({"pier": ["P1", "P2"] * 2, "ductility": [0.9, 1.2, 1.1, 1.9]})
    monkeypatch.setattr(answer, "largest_place", lambda *_: (1.9, "cold, pier P2"))
    words = answer._yielding(cast("EarthquakeResult", SimpleNamespace(piers=piers)))
    assert re.findall(r"P\d", words) == ["P1", "P2", "P2"]


def test_motions_of_the_command_are_told_apart_by_their_folders() -> None:
    files = [{"name": f"/made/site-{seed}/motion.csv"} for seed in (1, 2)]
    rows = given_motions_table([*files, {"name": "/records/KOBE.AT2"}]).rows
    expected = ["file site-1/motion.csv", "file site-2/motion.csv", "file KOBE.AT2"]
    assert [row[-1] for row in rows] == expected


@pytest.mark.thorough
def test_lines_with_other_bearings_are_named(plan_of_two: EarthquakeResult) -> None:
    """The line that governs has its own bearing, not that of the analysis."""
    pieces = build_pieces(plan_of_two)
    lines = plan_of_two.lines
    governing = lines.iloc[place_of_largest(lines["strain_max"])]
    assert governing["line_bearing"] != governing["bearing"]
    assert f"line {governing['line']} with {governing['line_bearing']}" in pieces.answer[2]
    assert "10 bearings shen-hdr-bridge" in pieces.question
    assert "20 bearings shen-lhdr-bridge" in pieces.question
    assert plan_of_two.bearing_labels == {
        "shen-lhdr-bridge": "shen-hdr-bridge on A1 and A2, shen-lhdr-bridge on the other lines"
    }
    assert "shen-hdr-bridge on A1 and A2" in pieces.tables["piers"].caption
    shown = [table.caption for table in console_tables(plan_of_two)]
    named = [caption for caption in shown if "shen-lhdr-bridge" in caption]
    assert named
    assert all(caption.count("shen-hdr-bridge on A1 and A2") == 1 for caption in named)
    parts = {row[0]: row[2] for row in pieces.tables["governing"].rows}
    assert parts["Bearing strain [%]"] == f"{governing['line']} ({governing['line_bearing']})"
    assert "(" not in parts["Pier displacement [mm]"]


@pytest.mark.parametrize(
    ("bearing", "marked"), [("shen-lhdr-bridge", "motion"), ("shen-hdr-bridge", "strain")]
)
def test_the_calibration_range_is_that_of_the_bearing_of_each_line(
    plan_of_two: EarthquakeResult, bearing: str, marked: str
) -> None:
    """The limits of the bearings of all lines count, and mark the strain of their own line."""
    assert plan_of_two.table["strain_line"].iloc[0] == "A1"  # with shen-hdr-bridge
    data, rows = plan_of_two.dataset, plan_of_two.tested_range
    rows["outside"] = (rows["limit"] == "strain") & rows["run"].str.startswith(bearing)
    output = as_attribute(rows.to_dict("records"))
    result = EarthquakeResult(data.assign_attrs(data.attrs | {"tested_range": output}))
    assert list(result.table["beyond_tested"]) == ["strain"]
    assert {name: limits for name, limits in limits_by_bearing(result)[0].items() if limits} == {
        bearing: "strain"
    }
    peaks = result.tables()["peaks"]
    ((row, column),) = peaks.marked
    assert row == 0
    assert peaks.columns[column].name.removeprefix("bearing_").startswith(marked)
    assert "shen-hdr-bridge on A1 and A2" in str(structure_balance(result))


def test_shaded_ranges_are_those_of_the_line_that_is_shown(plan_of_two: EarthquakeResult) -> None:
    data, rows = plan_of_two.dataset, plan_of_two.tested_range
    rows.loc[rows["limit"] == "strain", "demand"] = 3.0
    of_abutments = rows["run"].str.startswith("shen-hdr-bridge")
    rows["largest"] = rows["largest"].mask(of_abutments & (rows["limit"] == "strain"), 2.0)
    attrs = data.attrs | {"tested_range": as_attribute(rows.to_dict("records"))}
    ends = {
        line: EarthquakeResult(data.assign_attrs(attrs | {"line": line})).tested_to([0], "strain")
        for line in ("A1", "P1")
    }
    assert ends == {"A1": 2.0, "P1": 2.5}


def test_figures_show_the_governing_line_of_each_kind_of_bearing(
    plan_of_two: EarthquakeResult,
) -> None:
    strains = plan_of_two.resultant.lines.set_index("line")["strain_max"]
    abutment, pier = (place_name(strains, f"{kind}\\d") for kind in "AP")
    assert [line.name for line in governing_lines(plan_of_two)] == [abutment, pier]
    figures = build_pieces(plan_of_two).figures
    for name, line in (("loops_x", abutment), ("loops_x_2", pier)):
        assert f"line {line} (" in figures[name].caption
        assert figures[name].draw is not None
        drawn = np.concatenate([path.get_ydata() for path in figures[name].draw().axes[0].lines])
        force = plan_of_two.sel(direction="x")["line_force"].sel(line=line).values
        assert np.abs(drawn).max() == pytest.approx(np.nanmax(np.abs(force)), rel=1e-3)
    # A limit decides before strains: the line that uses most of it.
    rows = [
        {"run": "", "bearing": "", "code": "", "what": "load", "part": part, "used": used}
        | {"value": 1.0, "limit": limit, "unit": "kN"}
        for part, used, limit in (("P3", 0.4, 1.0), ("P2", 0.9, None), ("A2", 0.2, 1.0))
    ]
    attrs = plan_of_two.dataset.attrs | {"bearing_checks": as_attribute(rows)}
    checked = EarthquakeResult(plan_of_two.dataset.assign_attrs(attrs))
    assert [line.name for line in governing_lines(checked)] == ["A2", "P3"]


def place_name(values: pd.Series, pattern: str) -> str:
    """Return the name of the largest value among those whose names match."""
    chosen = values[values.index.str.fullmatch(pattern)]
    return str(chosen.index[place_of_largest(chosen)])


def test_a_run_with_several_bearings_counts_once(plan_of_two: EarthquakeResult) -> None:
    rows = [row for row in measures.tested_rows(plan_of_two) if row["limit"] == "strain_rate"]
    assert len(rows) == 2  # of abutments and piers
    assert runs_of(rows) == set(plan_of_two.run_names)


def test_a_report_states_what_motions_were_made_to_fit(tmp_path: Path) -> None:
    target = load_spectrum({"shape": "aashto", "A_s": "0.4 g", "S_DS": "1 g", "S_D1": "0.6 g"})
    made = dataclasses.replace(load_motion("jra-ii-i-1"), target=target, description="seed 1 of 9")
    file = save_motion(made, tmp_path / "made.csv")
    motions = [{"name": str(file), "factor": 0.5}, "jra-ii-i-2"]
    result = tb.bridge("shen-bilinear-bridge", motions, 23, duration=5)
    # The name of a motion states its factor, in all tables and figures.
    assert list(motion_targets(result.dataset)) == ["made-x0.5"]
    spectrum = motion_targets(result.dataset)["made-x0.5"].spectrum
    assert spectrum.ground_acceleration == pytest.approx(0.5 * target.ground_acceleration)
    pieces = build_pieces(result)
    table = pieces.inputs["motions"]
    assert ["seed 1 of 9; as run, times 0.5" in row[-1] for row in table.rows] == [True, False]
    peak = float(np.nanmax(np.abs(result["ground_acceleration"].values[0]))) * 1e3
    assert f"{peak / spectrum.ground_acceleration:.2f} times (made-x0.5)" in table.note
    lines = result.plot.motion_spectra().axes[0].lines
    # All motions are drawn, also the one that was not made to fit a spectrum.
    words = target.words.removeprefix("the ") + ", times 0.5"
    assert [line.get_label() for line in lines] == ["jra-ii-i-2", "made-x0.5", words]
    assert lines[0].get_color() == drawing.GREY != lines[1].get_color()
    periods, values = lines[2].get_data()
    assert_allclose(values, 0.5 * target.at(periods) / 1e3)
    assert "motion_spectra" in pieces.figures
    # What is loaded again says the same.
    result.save(tmp_path / "out", figures=False)
    again = motion_targets(tb.load_result(tmp_path / "out").dataset)
    assert again == motion_targets(result.dataset)


def test_a_report_says_which_files_are_synthetic(tmp_path: Path) -> None:
    """An AT2 file has the description alone, by which a generated motion is recognised."""
    files = []
    for number, description in enumerate(("Synthetic, fits the spectrum of X", "Kobe, 1995")):
        motion = dataclasses.replace(load_motion("jra-ii-i-1"), description=description)
        files.append(str(save_motion(motion, tmp_path / f"motion-{number}.AT2")))
    result = tb.bridge("shen-bilinear-bridge", files, 23, duration=2)
    sources = [row[-1] for row in build_pieces(result).inputs["motions"].rows]
    assert ["Synthetic, fits the spectrum of X" in text for text in sources] == [True, False]
    assert "Kobe" not in sources[1]


def test_a_direction_without_motion_has_no_figures(plan_of_two: EarthquakeResult) -> None:
    """The symmetric bridge does not move across: its histories there are rounding."""
    assert plan_of_two.moves_along("x")
    assert not plan_of_two.moves_along("y")
    assert not any(name.endswith("_y") for name in plan_of_two.plot.draw_all())


@pytest.mark.thorough
def test_live_and_loaded_are_the_same(study: EarthquakeResult, pieces: Pieces, tmp_path) -> None:
    saved = study.save(tmp_path / "out", figures=False)
    assert as_data(build_pieces(tb.load_result(saved))) == as_data(pieces)


def test_plots(study: EarthquakeResult, pieces: Pieces) -> None:
    loops, profile = (pieces.figures[name].plot for name in ("loops", "profiles"))
    assert loops is not None
    assert profile is not None
    assert list(loops.choices) == [
        f"{b}, {m}" for b in BEARINGS for m in ("jra-ii-i-1", "jra-ii-i-2")
    ]
    run = 0
    trace = loops.choices["shen-bilinear-bridge, jra-ii-i-1"][0]
    strain = 100.0 * np.nanmax(np.abs(study["bearing_strain"].values[run]))
    assert np.nanmax(np.abs(trace.x)) == pytest.approx(strain, rel=1e-3)
    assert set(profile.choices) == {f"shen-lhdr-bridge, {m}" for m in ("jra-ii-i-1", "jra-ii-i-2")}
    assert {trace.name for trace in profile.choices["shen-lhdr-bridge, jra-ii-i-1"]} == {
        "23 °C",
        "−20 °C",
    }


def test_tested_strain_is_drawn_for_its_bearing() -> None:
    far = build_pieces(tb.bridge("shen-bilinear-bridge", "jra-ii-i-1", 23, duration=18))
    for name in ("loops", "strain"):
        plot = far.figures[name].plot
        assert plot is not None
        assert "tested to 160 %" in [trace.name for trace in plot.choices["jra-ii-i-1"]]
    assert "cold" not in far.tables
    assert "do not depend on temperature" in far.answer[3]


def test_hybrid_says_its_laboratory() -> None:
    hybrid = build_pieces(
        tb.hybrid(
            "shen-lhdr-specimen",
            "jra-ii-ii-1",
            -20,
            duration=4,
            laboratory={"mode": ["rt", "pd"]},
            rig="shen-rig",
        )
    )
    assert_well_formed(hybrid)
    _arranged(hybrid)
    assert "in real time and pseudo-dynamic" in hybrid.question
    assert "modes" in hybrid.tables
    assert any("1:6" in text for text in hybrid.assumptions)
    assert any(check.source == "rig shen-rig" for check in hybrid.checks)
    (balance,) = [row for row in hybrid.tables["quality"].rows if row[0] == "structure residual"]
    assert (balance[2], balance[4]) == (1e-2, PASSED)  # 1e-5, by the time integration
    assert "Takeda" not in " ".join(hybrid.assumptions)  # its pier has no hinge


def test_ended_early() -> None:
    motion = {"name": "jra-ii-i-1", "factor": 30.0}
    early = build_pieces(tb.bridge("shen-hdr-bridge", [motion], 23, duration=8))
    assert_well_formed(early)
    assert early.answer[0].startswith("The analysis ended early in 1 run")
    assert "Ended" in [column.head for column in early.tables["peaks"].columns]


def test_sources_of_a_users_own_files(tmp_path) -> None:
    """Of structure, bilinear bearing and rig: in the directory's document, and from its case."""
    for folder, name in (("structures", "pier-p1"), ("bilinear", "shen-bilinear-bridge")):
        text = data_path(folder, f"{name}.toml").read_text(encoding="utf-8")
        (tmp_path / f"{folder}.toml").write_text(text.replace(name, f"my-{folder}"))
    (tmp_path / "rig.toml").write_text(
        'name = "my-rig"\nforce = { value = "400 kN", source = "data sheet" }\n'
    )
    files = {key: str(tmp_path / f"{key}.toml") for key in ("structures", "bilinear", "rig")}
    made = tb.bridge(
        files["bilinear"], "jra-ii-i-1", 23.0, duration=1.0, structure=files["structures"],
        rig=files["rig"],
    )  # fmt: skip
    saved = made.save(tmp_path / "out", figures=False)
    again = tmp_path / "again.toml"
    again.write_text((saved / "case.resolved.toml").read_text())
    for case in (
        tb.load_result(saved).dataset.attrs["case"],
        load_earthquake_case(again).to_toml(),
    ):
        assert case == made.dataset.attrs["case"]
    inputs = build_pieces(tb.load_result(saved)).inputs
    masses = {row[0]: row[3] for row in inputs["structure"].rows}
    assert masses["Mass deck: mass"] == "Table 6.2; node 1"
    assert ("Initial stiffness K_1", 9.51, "kN/mm", "Table 6.3") in [
        tuple(row) for row in inputs["my-bilinear.parameters"].rows
    ]
    assert [tuple(row) for row in inputs["rig"].rows] == [
        ("Rig: largest force", 400.0, "kN", "data sheet")
    ]


def test_sources_of_what_a_case_changes_are_not_reported() -> None:
    result = fixed_base(load_structure("pier-p1"))
    assert result.sources
    assert not any(key.startswith("springs") for key in result.sources)
    lines = [{"line": "G1-G5", "count": 4}]
    made = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", 23.0, duration=0.5, lines=lines)
    rows = {row[0]: row[2:] for row in build_pieces(made).inputs["structure"].rows}
    assert rows["Bearing line G1-G5: count"] == ("", "")
    assert rows["Bearing line G1-G5: height"][1].startswith("Table 6.2")
