"""Documents of bridges whose lines have their own bearings: marks, shading, notes."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

import thermobearing as tb
from tests.unit.test_lines_and_piers import two_piers
from thermobearing.border.schema import validated
from thermobearing.border.toml import to_table
from thermobearing.earthquake.answer import (
    NO_CAPACITY,
    _governing_line,
    main_results,
    strength_note,
)
from thermobearing.earthquake.panels import select_part
from thermobearing.earthquake.report import build_pieces
from thermobearing.earthquake.tables import console_tables
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table
from thermobearing.report.pieces import MARK, Bullets, marked_note
from thermobearing.report.template import ACTIONS, OF_RANGE, _actions
from thermobearing.reported import model_assumptions, vertical_table
from thermobearing.results.drawing import UNTESTED
from thermobearing.structure.model import Structure

HDR, LRB = "shen-hdr-bridge", "lrb-example"
SHADED = "Shaded: outside the calibration range."


@pytest.fixture(scope="module")
def own_bearings() -> tb.EarthquakeResult:
    """Lines with lead bearings of unknown range, but one of rubber beyond its tests."""
    structure = validated(Structure, two_piers(), "test")
    lines = [{"line": "on A", "bearing": HDR}]
    motions = [{"name": "jra-ii-i-1", "factor": factor} for factor in (0.3, 3.0)]
    return tb.bridge(LRB, motions, [23, -30], duration=8, structure=structure, lines=lines)


def test_the_screen_marks_runs_outside_the_tests_of_the_bearing_of_a_line(
    own_bearings: tb.EarthquakeResult,
) -> None:
    """The screen shows a part of the result with each bearing; rows of other bearings stay."""
    limits = own_bearings.table["beyond_tested"].tolist()
    assert any("ambient" in text for text in limits)
    for part in (own_bearings.sel(bearing=LRB), own_bearings.sel(motion=motion_of(own_bearings))):
        kept = [text for text in part.table["beyond_tested"] if "ambient" in text]
        assert len(kept) == (part.table["ambient_degC"] == -30.0).sum()
    (peaks,) = [t for t in console_tables(own_bearings) if t.caption.startswith("Peaks of every")]
    in_report = own_bearings.tables()["peaks"]
    assert {row for row, _ in peaks.marked} == {row for row, _ in in_report.marked}
    assert peaks.marked


def motion_of(result: tb.EarthquakeResult) -> str:
    return str(result["motion"].values[0])


def test_a_temperature_outside_the_tests_has_its_own_action(
    own_bearings: tb.EarthquakeResult,
) -> None:
    """It says which results are concerned, and what bounds them until there is a test."""
    blocks = _actions(build_pieces(own_bearings))
    (actions,) = [block.items for block in blocks if isinstance(block, Bullets)]
    (action,) = [text for text in actions if "All results at −30 °C" in text]
    assert f"{HDR} (tested at −20 to 23 °C)" in action
    assert "the larger of the factors" in action  # those of a code may be smaller
    assert ACTIONS[OF_RANGE] not in actions
    warm = build_pieces(own_bearings.sel(ambient=23.0))
    assert warm.range_action == ""
    assert any("Not checked: thermal movement" in text for text in warm.assumptions)


def test_a_report_has_the_bulk_modulus_and_its_source(own_bearings: tb.EarthquakeResult) -> None:
    """HDR is square, the lead rubber bearing as its plan says; a bilinear bearing has neither."""
    table = build_pieces(own_bearings).inputs["vertical"]
    rows = {row[0]: row for row in table.rows}
    bulk = next(row for name, row in rows.items() if "Bulk modulus" in name)
    assert (float(bulk[1]), bulk[2]) == (2000.0, "MPa")
    assert "MCEER" in bulk[3]
    assert any("other layers" in name for name in rows)
    assert not vertical_table([{"name": "x", "kind": "bilinear"}]).rows


def test_captions_speak_of_shading_only_where_it_is(own_bearings: tb.EarthquakeResult) -> None:
    figures = build_pieces(own_bearings).figures
    loops = [figure for name, figure in figures.items() if name.startswith("loops")]
    assert len(loops) == 2
    for figure in loops:
        drawn = figure.draw()
        patches = [patch for ax in drawn.axes for patch in ax.patches]
        shaded = any(is_untested(patch.get_facecolor()) for patch in patches)
        assert (SHADED in figure.caption) == shaded
    assert [SHADED in figure.caption for figure in loops] == [
        beyond_tests(own_bearings, line) for line in shown_lines(loops)
    ]
    assert len({SHADED in figure.caption for figure in loops}) == 2


def is_untested(colour: object) -> bool:
    from matplotlib.colors import to_hex

    return to_hex(colour) == UNTESTED  # type: ignore[arg-type]


def shown_lines(figures: list) -> list[str]:
    return ["on A" if "on A" in figure.caption else "on B" for figure in figures]


def beyond_tests(result: tb.EarthquakeResult, line: str) -> bool:
    data = select_part(result.dataset, "line", line)
    view = tb.EarthquakeResult(data)
    return bool(np.isfinite(view.tested_to(range(view.runs), "strain")))


def test_captions_of_plots_are_those_of_the_page(own_bearings: tb.EarthquakeResult) -> None:
    figures = build_pieces(own_bearings).figures
    temperature, pier = figures["temperature"], figures["pier"]
    assert "rise" in temperature.caption
    assert "rise" not in temperature.plot_caption
    assert "strong part" in pier.caption
    assert "strong part" not in pier.plot_caption
    for name in ("loops", "strain", "loops_2", "strain_2"):
        figure = figures[name]
        assert SHADED not in figure.plot_caption
        dashed = "Dashed" in figure.plot_caption
        assert dashed == (SHADED in figure.caption), name
    assert "all compared bearings" not in figures["largest_loops"].caption


def test_a_limit_of_zero_is_no_share() -> None:
    row = {"part": "A1", "code": "", "what": "axial force", "limit": 0.0, "used": np.inf}
    result = SimpleNamespace(bearing_checks=pd.DataFrame([row]))
    reason = _governing_line(result, ["A1"]).reason  # type: ignore[arg-type]
    assert NO_CAPACITY in reason
    assert "inf" not in reason


def test_the_hottest_after_the_end_of_a_panel_has_its_time(
    own_bearings: tb.EarthquakeResult,
) -> None:
    for end, notes in ((-1.0, 1), (1e9, 0)):
        ax = Figure().add_subplot()
        own_bearings.plot._rise(ax, "rubber", [0], end)
        texts = [text.get_text() for text in ax.texts]
        assert sum(text.startswith("hottest at ") for text in texts) == notes, texts


def test_figures_of_one_line_say_where_the_others_are(own_bearings: tb.EarthquakeResult) -> None:
    pieces = build_pieces(own_bearings)
    assert "lines.csv" in pieces.figures["energy"].caption
    assert "lines.csv" in pieces.tables["loops"].note
    hottest = own_bearings.lines.sort_values("rubber_max_degC").iloc[-1]
    assert hottest["line"] != own_bearings.dataset.attrs["line"]
    assert f"the rubber of line {hottest['line']}" in pieces.figures["temperature"].caption


def test_the_summary_names_numbers_that_were_not_measured(
    own_bearings: tb.EarthquakeResult,
) -> None:
    sentence = main_results(own_bearings)[-1]
    lead = tb.load_bearing(LRB).lead
    assert lead is not None
    assert f"{lead.yield_stress:g} MPa (chosen" in sentence
    assert HDR not in sentence
    assert sentence in build_pieces(own_bearings).assumptions
    measured = {"bearings": [to_table(tb.load_bearing("shen-lhdr-bridge"))]}
    assert strength_note(measured) == ""


@pytest.mark.parametrize(("name", "tested"), [(LRB, False), ("shen-lhdr-bridge", True)])
def test_the_strength_of_lead_without_tests_follows_one_law_at_every_temperature(
    name: str, tested: bool
) -> None:
    sentences = model_assumptions({}, [to_table(tb.load_bearing(name))])
    assert any("No test of the lead" in text for text in sentences) == (not tested)
    assert any("Above the temperatures of its tests" in text for text in sentences) == tested


@pytest.mark.parametrize(
    ("note", "expected"),
    [
        ("", f"{MARK} outside the calibration range."),
        ("Marked: of others.", f"{MARK} of others."),
        ("A. Marked values are outside.", f"A. Values with {MARK} are outside."),
        ("*: not checked.", f"{MARK} outside the calibration range. *: not checked."),
    ],
)
def test_a_star_is_no_mark_of_cells(note: str, expected: str) -> None:
    table = Table("Caption", [Quantity("a")], [[1.0]], marked=frozenset({(0, 0)}), note=note)
    assert marked_note(table) == expected
    assert marked_note(replace(table, marked=frozenset(), note="*: n")) == "*: n"
