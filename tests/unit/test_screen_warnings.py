"""Warnings on the screen: few, merged by cause, the largest effect first; all are in the files."""

import pytest

import thermobearing as tb
from tests.unit.inputs import SPECIMEN
from thermobearing.results.screen import MORE, MOST_WARNINGS, shown_warnings


def test_warnings_are_merged_by_cause_and_ordered_by_effect() -> None:
    said = [
        "line on A stays at -10 degC in all runs",
        "viscous damping takes 30 % of the input energy",
        "hdr: strain 300 %, above the 250 % tested (in a)",
        "hdr: ambient 40 degC, above the 23 degC tested (in a)",
        "the run requires a force of 200 kN; the limit of the rig is 150 kN",
        "this is a poor fit: R2 = 0.5",
    ]
    shown = shown_warnings(said)
    assert [text.split(":")[0].split()[0] for text in shown[:3]] == ["this", "the", "hdr"]
    assert "300 %" in shown[2]
    assert "40 degC" in shown[2]
    assert shown[3].startswith(f"{MORE}2 more warnings")
    assert len(shown) == MOST_WARNINGS + 1
    assert shown_warnings(said[:2]) == [said[1], said[0]]
    assert shown_warnings([said[0], said[0]]) == [said[0]]


def test_quantities_of_one_bearing_beyond_three_are_counted() -> None:
    said = [f"hdr: quantity {k}, above the 1 tested (in a)" for k in range(5)]
    first, last = shown_warnings(said)
    assert first.count("tested") == MOST_WARNINGS
    assert last.startswith(f"{MORE}2 more warnings")


def test_files_have_what_the_screen_only_counts(capsys: pytest.CaptureFixture[str]) -> None:
    test = tb.cyclic_test(strain=[3.5], speed=300.0, cycles=1, rest=None, dt=0.01)
    result = tb.run("shen-lhdr-specimen", test, [-60.0, 60.0])
    assert len(result.warnings) > MOST_WARNINGS
    result.show()
    lines = capsys.readouterr().out.splitlines()
    printed = [text for text in lines if text.startswith(("warning: ", MORE))]
    assert len(printed) <= MOST_WARNINGS + 1
    assert printed[-1].startswith(MORE)
    assert result.summary()["warnings"] == result.warnings


def test_the_first_examples_have_no_warning() -> None:
    """`make demo` and the tutorial stay inside the calibration range."""
    assert tb.run(SPECIMEN, tb.cyclic_test(dt=0.05), [23.0]).warnings == []
    sine = tb.cyclic_test(strain=[1.75], cycles=3, wave="sine", frequency=0.08, dt=0.1)
    assert tb.run(SPECIMEN, sine, [23.0]).warnings == []
