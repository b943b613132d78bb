"""Warnings on the screen: few, merged by cause, the largest effect first; all are in the files."""

import pickle
from typing import Any

import pytest

import thermobearing as tb
from tests.unit.inputs import SPECIMEN
from thermobearing.quantities.warned import (
    ASSUMED,
    EXCEEDED,
    OTHER,
    UNTESTED,
    UNUSABLE,
    Warned,
    one_per_cause,
)
from thermobearing.results.screen import MORE, MOST_WARNINGS, shown_warnings
from thermobearing.results.writing import RECORDS


def beyond(quantity: str, effect: float = UNTESTED, bearing: str = "hdr") -> Warned:
    return Warned(f"{quantity} above the tests", f"beyond_tests.{quantity}", effect, bearing)


def test_warnings_are_merged_by_cause_and_ordered_by_effect() -> None:
    other = "line on A stays at -10 degC in all runs"
    poor, limit = Warned("poor", "fit", UNUSABLE), Warned("force", "rig", EXCEEDED)
    damping = Warned("damping", "damping", ASSUMED)
    shown = shown_warnings([other, damping, beyond("strain"), beyond("ambient"), limit, poor])
    assert shown[:2] == [poor, limit]
    assert shown[2] == "hdr: strain above the tests; ambient above the tests"
    assert shown[3].startswith(f"{MORE}2 more warnings")
    assert len(shown) == MOST_WARNINGS + 1
    assert shown_warnings([other, damping]) == [damping, other]
    assert shown_warnings([other, other]) == [other]


def test_words_of_a_sentence_do_not_order_it() -> None:
    assert shown_warnings(["y", "the limit is passed: a poor fit"])[0] == "y"


def test_the_bearing_with_the_largest_effect_on_the_force_is_first() -> None:
    small, large = beyond("strain", UNTESTED + 0.1, "a"), beyond("strain", UNTESTED + 0.4, "b")
    assert shown_warnings([small, large]) == [large, small]


def test_quantities_of_one_bearing_beyond_three_are_counted() -> None:
    first, last = shown_warnings([beyond(f"quantity {k}") for k in range(5)])
    assert first.count("quantity") == MOST_WARNINGS
    assert last.startswith(f"{MORE}2 more warnings")


def test_warnings_of_one_code_become_one_with_the_largest_effect() -> None:
    a, b = beyond("strain", 2.3, "a"), beyond("strain", 2.1, "b")
    merged, plain = one_per_cause([a, "cold", b])
    assert isinstance(merged, Warned)
    assert (merged, merged.effect, merged.place) == (f"{a}; {b}", 2.3, "a")
    assert isinstance(plain, Warned)
    assert (plain, plain.effect) == ("cold", OTHER)


def test_a_warning_keeps_its_record_in_another_process_and_in_files(
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    warning = beyond("strain", 2.4)
    again = pickle.loads(pickle.dumps(warning))
    assert vars(again) == vars(warning)
    test = tb.cyclic_test(strain=[3.5], speed=300.0, cycles=1, rest=None, dt=0.01)
    result = tb.run("shen-lhdr-specimen", test, [-60.0, 60.0])
    folder = result.save(tmp_path_factory.mktemp("saved") / "result", figures=False)
    loaded: Any = tb.load_result(folder)
    records = [vars(text) for text in result.warnings if isinstance(text, Warned)]
    assert {"beyond_tests.strain", "beyond_tests.ambient"} <= {item["code"] for item in records}
    assert [vars(text) for text in loaded.warnings if isinstance(text, Warned)] == records
    # A file of a version without records has sentences alone.
    earlier = result.dataset.copy()
    del earlier.attrs[RECORDS]
    assert type(result)(earlier).warnings == result.warnings


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
