"""What the document of a cyclic test says, against the result that it is about."""

import re

import numpy as np
import pytest
from matplotlib.figure import Figure

import thermobearing as tb
from tests.unit.report_words import as_data, assert_well_formed, numbers_in
from thermobearing.bearing.library import BEARINGS
from thermobearing.cyclic.report import build_pieces
from thermobearing.cyclic.result import Result
from thermobearing.report import content
from thermobearing.report.content import value_and_unit
from thermobearing.report.pieces import EXCEEDED, PASSED, Pieces
from thermobearing.report.template import _arranged
from thermobearing.reported import model_assumptions
from thermobearing.results.ranges import NOT_GIVEN


def short_test(strain: list[float], cycles: int = 2) -> tb.CyclicTest:
    return tb.cyclic_test(strain=strain, cycles=cycles, rest=60.0, dt=0.02)


@pytest.fixture(scope="module")
def result() -> Result:
    """A bearing with lead, cold and warm; the last strain is beyond its tests."""
    return tb.run("shen-lhdr-specimen", short_test([1.0, 3.0]), ambient=[23, -20], rig="shen-rig")


@pytest.fixture(scope="module")
def pieces(result: Result) -> Pieces:
    return build_pieces(result)


def test_question_and_answer(result: tb.Result, pieces: Pieces) -> None:
    assert_well_formed(pieces)
    _arranged(pieces)
    assert "shen-lhdr-specimen" in pieces.question
    assert "100 and 300 %" in pieces.question
    cycles = result.cycles
    last = cycles[cycles["amplitude_strain"] == 3.0].groupby("ambient_degC").last()
    for ambient in (23.0, -20.0):
        assert f"{last['G_eq_MPa'][ambient]:.3f} MPa" in pieces.answer[0]
    ratio = last["G_eq_MPa"][-20.0] / last["G_eq_MPa"][23.0]
    assert f"{100 * (ratio - 1):.0f} %" in pieces.answer[1]
    force = float(np.abs(result["force"].values).max())
    assert f"{force:.3g} kN" in pieces.answer[0]


def test_table_of_cycles(result: Result, pieces: Pieces) -> None:
    table = pieces.tables["cycles"]
    assert numbers_in(table, "G_e") == result.cycles["G_eq_MPa"].tolist()
    energy = 1e-3 * result.cycles["energy_kN_mm"]
    assert np.allclose(numbers_in(table, "Energy"), energy, rtol=1e-12)
    strain = [column.head for column in table.columns].index("Strain")
    beyond = {k for k, s in enumerate(numbers_in(table, "Strain")) if s > 250.0}
    assert {row for row, column in table.marked if column == strain} == beyond
    assert len(beyond) == 4


def test_checks(result: Result, pieces: Pieces) -> None:
    reported = {check.what.split(" (")[0]: check for check in pieces.checks}
    assert reported["shear strain"].value == pytest.approx(300.0)
    assert reported["shear strain"].limit == 250.0
    assert reported["shear strain"].verdict == EXCEEDED
    assert reported["force"].limit == 400.0
    assert reported["force"].value == pytest.approx(float(np.abs(result["force"].values).max()))
    assert [row[-1] for row in pieces.tables["quality"].rows] == [PASSED] * 2
    assert not any("residual" in name for name in reported)
    beyond = [check.of_tests for check in pieces.checks if check.verdict == EXCEEDED]
    assert sorted(beyond) == [False, True]  # the force of the rig, the tested strain
    # Of what the table of engineering limits shows, one is exceeded.
    inside = sum(not check.of_tests for check in pieces.checks) - 1
    assert [int(n) for n in re.findall(r"\d+", pieces.answer[-1])] == [1, 1, 2, inside]  # in 2 runs


def test_validity(result: tb.Result, pieces: Pieces) -> None:
    """What left the tests is under validity and not among the warnings; the rig the reverse."""
    assert any("300 %" in text for text in pieces.validity)
    assert not any("tested" in text for text in pieces.warnings)
    assert any("shen-rig" in text for text in pieces.warnings)
    assert len(pieces.notes) == 1  # of the rubber around the lead
    assert len(pieces.validity) + len(pieces.warnings) == len(result.warnings)


def test_validity_within_the_tests_and_without_a_range() -> None:
    bearing = tb.load_bearing("shen-hdr-specimen")
    inside = build_pieces(tb.run(bearing, short_test([1.0]), ambient=0))
    assert_well_formed(inside)
    assert not inside.validity
    assert not inside.validity_unknown
    assert "cold" not in inside.tables  # one temperature
    assert not any(table.marked for table in inside.tables.values())
    bearing = bearing.model_copy(update={"tested_range": None})
    unknown = build_pieces(tb.run(bearing, short_test([3.0]), ambient=0))
    assert not unknown.validity
    assert unknown.validity_unknown


def test_a_range_that_is_not_stated_is_neither_inside_nor_outside() -> None:
    """Of two bearings, one without a range: only what is known to lie outside is counted."""
    unstated = f"pier: {NOT_GIVEN}; state it; abutment: {NOT_GIVEN}; state it"
    outside = "bearing: strain 300 %, above the 250 % tested (in all runs)"
    for warnings, beyond in (([unstated], 0), ([unstated, outside], 1)):
        pieces = content.build_pieces("cyclic", "", "", [], identity={}, warnings=warnings)
        assert len(pieces.validity) == beyond
        verdict = pieces.answer[-1]
        assert "pier and abutment" in verdict
        assert "unknown" in verdict
        assert (content.OUTSIDE in verdict) == bool(beyond)
        assert content.INSIDE not in verdict
        warned = [text for text in map(str, _arranged(pieces)) if "kind='warning'" in text]
        assert any(NOT_GIVEN in text for text in warned)


def test_reports_say_that_axial_forces_act() -> None:
    table = tb.load_bearing("lrb-example").model_dump()
    for plane in (False, True):
        off, unset, acting = (
            model_assumptions(analysis, [table], plane=plane)
            for analysis in ({"axial": "off"}, {}, {"axial": "overturning"})
        )
        assert off == unset
        assert "overturning" not in off[0]
        assert "overturning" in acting[0]
        assert acting[1:] == off[1:]


def test_a_table_of_inputs_without_sources_has_no_column_for_them() -> None:
    heads = [
        [column.head for column in content.input_table("Inputs", {"count": 5}, sources).columns]
        for sources in ({}, {"count": "drawing 7"})
    ]
    assert heads == [["What", "Value", "Unit"], ["What", "Value", "Unit", "Source"]]


def test_inputs_have_units_and_sources(pieces: Pieces) -> None:
    rows = {row[0]: row for row in pieces.inputs["shen-lhdr-specimen.parameters"].rows}
    assert rows["Initial stiffness of one layer K_r"][1:] == (26.783, "kN/mm", "Table 5.2")
    rig = {row[0]: row for row in pieces.inputs["rig"].rows}
    assert rig["Rig: largest force"][1:] == (400.0, "kN", "Table 3.2; either way")
    model = {row[0]: row for row in pieces.inputs["analysis"].rows}
    assert model["Heat scheme"][3] == "default of the program"


@pytest.mark.parametrize(
    ("value", "ends", "expected"),
    [
        (["1 mm", "3 mm"], True, ("1 to 3", "mm")),
        (["3 mm", "3 mm"], True, (3.0, "mm")),
        (["1 mm", "3 mm"], False, ("1, 3", "mm")),
        (["1 mm", "2 mm", "3 mm"], True, ("1, 2, 3", "mm")),
        (["1 mm", "3 kN"], True, ("1 mm, 3 kN", "")),
    ],
)
def test_a_range_is_one_cell(value: list[str], ends: bool, expected: tuple[object, str]) -> None:
    assert value_and_unit(value, ends=ends) == expected


def test_sources_of_an_own_file(tmp_path) -> None:
    """They come from the file, of which the resolved case has only the numbers."""
    text = BEARINGS.path("shen-hdr-specimen").read_text(encoding="utf-8")
    text = text.replace('name = "shen-hdr-specimen"', 'name = "mine"')
    path = tmp_path / "mine.toml"
    path.write_text(text.replace('source = "Table 4.2"', 'source = "our test 12"'))
    own = build_pieces(tb.run(path, short_test([0.5]), ambient=23))
    reported = {row[0]: row[3] for row in own.inputs["mine.parameters"].rows}
    assert reported["Initial stiffness of one layer K_r"] == "our test 12"


def test_what_was_asked_for_is_no_default() -> None:
    slow = build_pieces(
        tb.run(
            "shen-hdr-specimen",
            short_test([0.5]),
            ambient=23,
            model=tb.ModelOptions(scheme="published"),
        )
    )
    model = {row[0]: row for row in slow.inputs["analysis"].rows}
    assert model["Heat scheme"][1:] == ("published", "", "input")
    assert any("Published heat scheme" in text for text in slow.assumptions)
    assert slow.tables["quality"].rows[1][-1] == "not assessed"


def test_lead_of_one_bearing_among_others_is_reported() -> None:
    tables = [tb.load_bearing(name).model_dump() for name in ("shen-hdr-bridge", "lrb-example")]
    alone, both = (model_assumptions({}, some) for some in (tables[:1], tables))
    heat, strength = (text for text in both if text not in alone)
    assert heat.startswith("Lead")
    assert "0.0069/K" in strength


def test_live_and_loaded_are_the_same(result: Result, pieces: Pieces, tmp_path) -> None:
    saved = result.save(tmp_path / "out", figures=False)
    assert as_data(build_pieces(tb.load_result(saved))) == as_data(pieces)


def test_plots(result: Result, pieces: Pieces) -> None:
    loops = pieces.figures["loops"].plot
    assert loops is not None
    strain = 100.0 * np.abs(result["strain"].values).max()
    for trace in loops.choices["all"]:
        assert np.nanmax(np.abs(trace.x)) == pytest.approx(strain, rel=1e-3)
        assert len(trace.x) < 60_000
    (low, high), (lowest, end) = (band[:2] for band in loops.bands)
    assert (low, end) == (250.0, -250.0)
    # The bands reach beyond the loops.
    assert high == -lowest == pytest.approx(1.1 * strain, rel=1e-3)
    profile = pieces.figures["profiles"].plot
    assert profile is not None
    warmest = max(float(np.nanmax(trace.frames_x)) for trace in profile.choices["all"])
    assert warmest <= float(np.nanmax(result["temperature"].values)) + 0.01
    assert isinstance(pieces.figures["loops"].draw(), Figure)


def test_ended_early() -> None:
    test = tb.cyclic_test(strain=[2.5], cycles=60, frequency=2.0, rest=None, dt=0.01)
    early = build_pieces(tb.run("shen-lhdr-specimen", test, ambient=[23, -20]))
    assert_well_formed(early)
    assert early.answer[0].startswith("The analysis ended early at 23")
    assert "lead melted" in early.answer[0]
    assert "fewer cycles" in early.answer[0]


def test_no_cycle() -> None:
    steps = [{"step": "ramp", "to_strain": 1.0, "speed": 30.0}, {"step": "rest", "duration": 5.0}]
    ramp = build_pieces(tb.run("shen-hdr-specimen", tb.CyclicTest(dt=0.02, steps=steps), ambient=0))
    assert_well_formed(ramp)
    assert "No cycle was closed" in ramp.answer[0]
    _arranged(ramp)
