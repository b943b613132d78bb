"""Post-processing options of a study: checked, changed, and those of the documentation."""

import tomllib
from pathlib import Path
from typing import Any

import pytest

from tests.unit.inputs import assert_refused
from tests.unit.made_up_study import SITE
from thermobearing.border.errors import InputError
from thermobearing.studies.question import Question, _make_question, change_question, describe_kept


def test_another_demand_does_not_take_over_the_capacity_of_the_last_one() -> None:
    saved = Question(capacity=4.0, failed="collapse", method="cloud", weather="cold-town")
    strain = {"demand": "bearing_strain_max"}
    other = change_question(saved, strain, default_demand="pier_ductility")
    assert (other.capacity, other.failed) == (None, "computed")
    assert (other.method, other.weather) == ("cloud", "cold-town")
    kept, dropped = describe_kept(saved, strain, other, "question.toml")
    assert "method = cloud" in kept
    assert "weather = cold-town" in kept
    assert dropped.endswith("capacity = 4, failed = collapse")
    with_capacity = change_question(saved, strain | {"capacity": 2.5})
    assert (with_capacity.capacity, with_capacity.failed) == (2.5, "computed")
    # The demand of the options without one, and that which they have, are the same one.
    same = {"demand": "pier_ductility"}
    assert change_question(saved, same, default_demand="pier_ductility").capacity == 4.0
    assert change_question(other, strain | {"capacity": 2.5}).capacity == 2.5
    assert change_question(change_question(other, {"capacity": 2.5}), strain).capacity == 2.5
    assert describe_kept(Question(), same, Question(demand="pier_ductility"), "") == []


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"capcity": 1.0}, 'did you mean "capacity"'),
        ({"capacity": -1.0}, "capacity = -1"),
        ({"hazard": "none.csv"}, "no such file"),
        ({"hazard": {"intensity": ["1 m/s2", "2 m/s2"]}}, "give rate, or return_period"),
        (
            {"hazard": {"intensity": ["1 m/s2", "2 m/s2"], "rate": ["1 1/year", "2 1/year"]}},
            "rate of a hazard curve",
        ),
        ({"hazard": {"intensity": ["1", "2"], "rate": ["2 1/year", "1 1/year"]}}, "has no unit"),
        ({"weather": "warm-town"}, "no climate"),
        ({"failed": "ignored"}, "left-out"),
    ],
)
def test_bad_questions(table: dict[str, Any], message: str, tmp_path: Path) -> None:
    assert_refused(lambda: _make_question(table, "question.toml", tmp_path), message)


def test_the_question_of_the_docs_can_be_asked(tmp_path: Path) -> None:
    text = (Path(__file__).parents[2] / "docs" / "files" / "study.md").read_text(encoding="utf-8")
    block = text.split("## Post-processing")[1].split("```")[1].removeprefix("text\n")
    (tmp_path / "site.csv").write_text(SITE)
    assert set(tomllib.loads(block)) == set(Question.model_fields)
    assert _make_question(tomllib.loads(block), "question.toml", tmp_path).capacity == 1.0


@pytest.mark.parametrize("head", ["Sa [g]", "Sa [gal]", "Sa(1.2 s) [m/s^2]"])
def test_heads_of_a_hazard_curve_that_can_be_read_are_named(head: str, tmp_path: Path) -> None:
    """Neither message sends a reader with a curve in Sa to PGA."""
    file = tmp_path / "site.csv"
    file.write_text(f"{head},rate [1/year]\n1,0.1\n5,0.01\n")
    with pytest.raises(InputError) as refused:
        _make_question({"hazard": str(file)}, "options")
    message = str(refused.value)
    assert f"{head}" in message
    assert "Sa [m/s^2]" in message
    assert "pga_" not in message
    file.write_text("Sa [m/s^2],rate [1/year]\n1,0.1\n5,0.01\n")
    hazard = _make_question({"hazard": str(file)}, "options").hazard
    assert hazard is not None
    assert hazard.measure == "Sa"
