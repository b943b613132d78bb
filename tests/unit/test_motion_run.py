"""The story of a ground motion in the library: examined, made as a case, written."""

import json
from pathlib import Path

import numpy as np
import pytest

import thermobearing.motions.run as story
from thermobearing.border.errors import InputError
from thermobearing.motions.library import load_motion
from thermobearing.motions.record import GroundMotion
from thermobearing.motions.run import MotionResult, Reference
from thermobearing.results.writing import write_summary

TILTED = GroundMotion("tilted", 0.01, np.sin(np.arange(2000) * 0.05) + 0.01)


def test_a_built_in_motion_is_compared_with_what_it_was_made_for() -> None:
    examined = story.examine_motion(load_motion("jra-i-iii-2"))
    assert examined.reference == Reference("I", "III", 1.0)
    assert examined.misfit is not None
    assert 0.0 < examined.misfit < 0.03
    asked = story.examine_motion(load_motion("jra-i-iii-2"), ground="II")
    assert asked.reference == Reference("II", "II", 1.0)
    assert story.examine_motion(TILTED).reference is None


def test_a_base_line_is_corrected_if_asked_for() -> None:
    assert story.examine_motion(TILTED).motion is TILTED
    for options in ({"baseline": True}, {"high_pass": 0.1}):
        ended = story.examine_motion(TILTED, **options).measures.end_displacement
        assert abs(ended) < 1e-6 < abs(story.examine_motion(TILTED).measures.end_displacement)


def test_a_case_names_its_directory() -> None:
    assert story.make_motion_case("ii", 3, seed=7).name == "jra-ii-iii-7"
    odd = GroundMotion("El Centro/NS", 0.01, np.ones(10))
    assert story.make_motion_case("I", "I", record=odd).name == "el-centro-ns-as-i-i"


def test_a_case_is_checked_before_its_record_is_read() -> None:
    with pytest.raises(InputError, match='type of earthquake: "V"'):
        story.make_motion_case("V", record="not-there.csv")


def _made(case: story.MotionCase, monkeypatch: pytest.MonkeyPatch) -> MotionResult:
    """The result of a case whose making is replaced by a look at the stored motion."""

    def stored(kind: str, ground: str, seed: int, dt: float, **_: object) -> GroundMotion:
        return load_motion(f"jra-{kind}-{ground}-{seed}".lower())

    monkeypatch.setattr(story, "make_motion", stored)
    return story.run_motion(case)


def test_a_motion_that_does_not_fit_has_an_outcome_that_tells_what_to_try(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    case = story.make_motion_case("II", "I", seed=1)
    good = _made(case, monkeypatch)
    assert (good.outcome, good.sentence) == ("completed", "")
    poor = _made(story.MotionCase("II", "I", zone_factor=0.7), monkeypatch)
    assert poor.outcome == "poor_fit"
    assert "try another record or seed" in poor.sentence
    assert poor.summary()["standard_spectrum"]["zone_factor"] == 0.7


def test_a_name_that_is_no_text_is_written_as_json(tmp_path: Path) -> None:
    name = "地震\udc80"
    write_summary(tmp_path, {"motion": name, "misfit": float("nan")})
    text = (tmp_path / "summary.json").read_text(encoding="utf-8")
    assert "地震" in text
    assert json.loads(text) == {"motion": name, "misfit": None}
