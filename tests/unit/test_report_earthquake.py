"""What the document of an earthquake study says, against the result that it is about."""

import re

import numpy as np
import pytest

import thermobearing as tb
from tests.unit.report_words import as_data, assert_well_formed, numbers_in
from thermobearing.border.library import data_path
from thermobearing.earthquake.case import load_earthquake_case
from thermobearing.earthquake.report import build_pieces
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.report.pieces import EXCEEDED, NOT_ASSESSED, PASSED, Pieces
from thermobearing.report.template import _arranged
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


def test_question_and_answer(study: EarthquakeResult, pieces: Pieces) -> None:
    assert_well_formed(pieces)
    _arranged(pieces)
    assert "jra-ii-i-1 and jra-ii-i-2" in pieces.question
    assert "23 and −20 °C" in pieces.question
    table = study.table
    assert f"{table['bearing_strain_max'].max():.0%}".replace("%", " %") in pieces.answer[0]
    assert f"{table['pier_displacement_max_mm'].max():.3g} mm" in pieces.answer[0]
    assert f"{table['pier_ductility'].max():.3g}" in pieces.answer[0]
    lead = table[table["bearing"] == "shen-lhdr-bridge"]
    cold, warm = (lead[lead["ambient_degC"] == t] for t in (-20.0, 23.0))
    ratio = np.mean(cold["bearing_force_max_kN"].to_numpy() / warm["bearing_force_max_kN"])
    assert (
        f"force {100 * abs(ratio - 1):.0f} % {'more' if ratio > 1 else 'less'}" in pieces.answer[1]
    )
    assert "; shen-bilinear-bridge is " in pieces.answer[1]


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


def test_checks_and_validity(study: EarthquakeResult, pieces: Pieces) -> None:
    reported = {check.what.split(" (")[0]: check for check in pieces.checks}
    exceeded = sum(check.verdict == EXCEEDED for check in pieces.checks)
    assert exceeded > 0  # round-off of energy is no check
    assert [int(n) for n in re.findall(r"\d+", pieces.answer[-1])] == [len(pieces.checks), exceeded]
    assert not any("residual" in check.what for check in pieces.checks)
    quality = pieces.tables["quality"]
    assert [row[-1] for row in quality.rows] == [PASSED] * 3
    assert max(row[1] for row in quality.rows) < 1e-9
    # The rate of every earthquake: a note with its number, and neither check nor warning.
    assert "shen-lhdr-bridge: strain rate" not in reported
    rows = study.tested_range
    mine = rows[(rows["limit"] == "strain_rate") & rows["run"].str.startswith("shen-lhdr")]
    (note,) = [text for text in pieces.notes if "train rate" in text]
    assert f"{mine['asked'].max():.3g}/s" in note
    assert not any("strain rate" in text for text in study.warnings)
    cold = [check for check in pieces.checks if check.lower and "bilinear" in check.what]
    assert [check.value for check in cold] == [-20.0]
    assert reported["ductility of pier"].verdict == PASSED
    assert not any("tested" in text for text in pieces.warnings)
    assert "extrapolated" in pieces.answer[-1]


def test_a_pier_that_yields_has_no_limit(study: EarthquakeResult) -> None:
    data = study.dataset.assign(pier_ductility=1.4 + 0.0 * study.dataset["pier_ductility"])
    (check,) = [c for c in build_pieces(EarthquakeResult(data)).checks if "ductility" in c.what]
    assert (check.value, check.verdict) == (1.4, NOT_ASSESSED)
    assert np.isnan(check.limit)


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
    assert "temperature-independent" in far.answer[1]


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
    found = fixed_base(load_structure("pier-p1"))
    assert found.sources
    assert not any(key.startswith("springs") for key in found.sources)
    lines = [{"line": "G1-G5", "count": 4}]
    made = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", 23.0, duration=0.5, lines=lines)
    rows = {row[0]: row[2:] for row in build_pieces(made).inputs["structure"].rows}
    assert rows["Bearing line G1-G5: count"] == ("", "")
    assert rows["Bearing line G1-G5: height"][1].startswith("Table 6.2")
