"""The live section of reports without a browser: which results have one, and what it contains."""

import base64
import gzip
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import thermobearing as tb
from tests.unit.inputs import command
from thermobearing.border.title import TitleBlock
from thermobearing.cyclic.protocol import CyclicTest
from thermobearing.live import report as live
from thermobearing.report.pieces import Live
from thermobearing.reporting import build_pieces, make_report, report_files

HDR, BRIDGE, MOTION = "shen-hdr-specimen", "shen-hdr-bridge", "jra-ii-i-1"
TEST = tb.cyclic_test(strain=[1.0], cycles=2, rest=None, dt=0.05)
RAMP: list[Any] = [
    {"step": "ramp", "to_strain": 0.5, "speed": "30 mm/s"},
    {"step": "ramp", "to": "0 mm", "speed": "30 mm/s"},
    {"step": "cycles", "strain": 1.0, "speed": "30 mm/s", "count": 1},
]


@pytest.fixture(autouse=True)
def module(monkeypatch: pytest.MonkeyPatch) -> None:
    """An installation with a module that cannot be run."""
    monkeypatch.setattr(live, "live_module", lambda: b"module")
    monkeypatch.setattr(
        live, "engine_data", lambda models: {"bearings": [m.name for m, _ in models]}
    )


HALVED = f"{MOTION}-x0.5"  # as a result names it


def content(section: Live | None) -> dict[str, Any]:
    assert section is not None
    result: dict[str, Any] = json.loads(gzip.decompress(base64.b64decode(section.data)))
    return result


def shaken(bearings: Any = BRIDGE, motion: Any = MOTION, **options: Any) -> Any:
    return tb.bridge(bearings, motion, [23.0, -20.0], **{"duration": 1.0} | options)


def test_a_test_has_the_numbers_that_are_printed() -> None:
    result = tb.run(HDR, TEST, ambient=[-20.0, 23.0])
    section = live.live_section(result)
    actual = content(section)
    assert section is not None
    assert section.runs == ["−20 °C", "23 °C"]
    assert section.strain
    assert actual["strain"] == pytest.approx(1.0)
    assert actual["test"] == {"dt_s": 0.05, "steps": live.engine_steps(TEST)}
    cycles = result.cycles[result.cycles["ambient_degC"] == 23.0]
    numbers = actual["runs"][1]["numbers"]
    for which, place in (("first", 0), ("last", -1)):
        assert numbers[f"{which}.stiffness_kN_mm"] == cycles["K_eq_kN_mm"].iloc[place]
    keys = [row["key"] for row in actual["rows"]]
    assert set(numbers) <= set(keys)
    assert {row["ratio"] for row in actual["rows"] if "temperature" in row["key"]} == {False}


def test_a_bridge_has_its_peaks_and_as_many_motions_as_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    motions = [{"name": MOTION, "factor": 0.5}, "jra-ii-ii-1"]
    result = shaken(["shen-bilinear-bridge", BRIDGE], motions)
    actual = content(live.live_section(result))
    assert actual["engine"]["bearings"] == [BRIDGE]
    assert actual["factors"] == {HALVED: 0.5, "jra-ii-ii-1": 1.0}
    assert [run["motion"] for run in actual["runs"]] == [
        HALVED,
        HALVED,
        "jra-ii-ii-1",
        "jra-ii-ii-1",
    ]
    row = result.table[result.table["bearing"] == BRIDGE].iloc[1]
    assert actual["runs"][1]["numbers"]["bearing_force_kN"] == row["bearing_force_max_kN"]
    monkeypatch.setattr(live, "MOST_SAMPLES", 150)
    assert {run["motion"] for run in content(live.live_section(result))["runs"]} == {HALVED}


def test_a_motion_that_is_cut_within_an_interval_is_sampled_more_finely() -> None:
    result = content(
        live.live_section(shaken(motion={"name": MOTION, "factor": 2.0}, duration=0.995))
    )
    assert result["factors"] == {f"{MOTION}-x2": 1.0}
    assert result["engine"]["motions"][f"{MOTION}-x2"]["dt_s"] == 0.005
    assert result["engine"]["motions"][f"{MOTION}-x2"]["acceleration_mm_s2"]["shape"] == [200]


@pytest.mark.parametrize(
    ("test", "options"),
    [
        (CyclicTest(steps=RAMP, dt=0.05), {}),
        (TEST, {"initial": 10.0}),
        (TEST, {"keep": tb.Keep(every=2)}),
        (TEST, {"model": "bilinear"}),
        (TEST, {"ambient": tb.Ambient.series([0.0, 50.0], [0.0, 20.0])}),
    ],
)
def test_other_tests_have_none(test: CyclicTest, options: dict[str, Any]) -> None:
    assert live.live_section(tb.run(HDR, test, **options)) is None


@pytest.mark.parametrize(
    "options",
    [
        {"bearings": "shen-bilinear-bridge"},
        {"method": "predictor-corrector"},
        {"model": "bilinear"},
    ],
)
def test_other_bridges_have_none(options: dict[str, Any]) -> None:
    assert live.live_section(shaken(**options)) is None


def test_hybrid_tests_and_other_results_have_none() -> None:
    assert live.live_section(tb.hybrid(HDR, ambient=23.0, duration=0.5)) is None
    assert live.live_section(object()) is None


@pytest.fixture
def saved(tmp_path: Path) -> Path:
    return tb.run(HDR, TEST).save(tmp_path / "out", figures=False)


def test_the_page_allows_its_script_and_hides_the_section(saved: Path) -> None:
    html = make_report(saved, pdf=False)[0].read_text(encoding="utf-8")
    allowed = re.search(r'Content-Security-Policy" content="([^"]+)"', html)
    assert allowed is not None
    assert "'wasm-unsafe-eval'" in allowed[1]
    assert re.search(r'<section aria-labelledby="live-calculation" class="live-only" hidden>', html)
    assert re.search(r'<li class="live-only" hidden><a href="#live-calculation">', html)


def test_without_it_the_page_is_as_ever(saved: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def _missing() -> bytes:
        raise tb.InputError("make kernels")

    without = make_report(saved, pdf=False, live=False)[0].read_bytes()
    assert b"live" not in without.replace(b"live-only", b"").replace(b"#live", b"")
    assert command("report", saved, "--no-pdf", "--no-live").exit_code == 0
    assert (saved / "report.html").read_bytes() == without
    monkeypatch.setattr(live, "live_module", _missing)
    assert make_report(saved, pdf=False)[0].read_bytes() == without


def test_a_pdf_has_neither_section_nor_heading(saved: Path) -> None:
    result: Any = tb.load_result(saved)
    pieces = build_pieces(result, saved)
    section = live.live_section(result)
    files = [report_files(replace(pieces, live=one), TitleBlock()) for one in (section, None)]
    assert files[0]["report.pdf"] == files[1]["report.pdf"]
    assert files[0]["report.html"] != files[1]["report.html"]
