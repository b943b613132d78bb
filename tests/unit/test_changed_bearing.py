"""A bearing with other numbers, made in Python: checked, told apart from the old one, and saved."""

from pathlib import Path

import pytest

import thermobearing as tb
from thermobearing.bearing.model import Cells

SPECIMEN = "shen-hdr-specimen"


def test_what_is_told_changes_and_nothing_else() -> None:
    before = tb.load_bearing(SPECIMEN)
    made = tb.changed_bearing(
        SPECIMEN, name="mine", hysteresis={"layer_stiffness": "40 kN/mm", "hardening": 0.3}
    )
    assert (made.name, made.hysteresis.layer_stiffness, made.hysteresis.hardening) == (
        "mine",
        40.0,
        0.3,
    )
    expected = before.model_dump()
    expected["name"] = "mine"
    expected["hysteresis"] |= {"layer_stiffness": 40.0, "hardening": 0.3}
    assert made.model_dump() == expected
    assert before == tb.load_bearing(SPECIMEN)  # untouched


def test_sources_follow_the_numbers() -> None:
    before = tb.load_bearing(SPECIMEN)
    made = tb.changed_bearing(before, hysteresis={"layer_stiffness": 40.0})
    assert made.sources["hysteresis.layer_stiffness"] == "changed, was 30.738"
    assert made.sources["hysteresis.hardening"] == before.sources["hysteresis.hardening"]


def test_plans_and_records_are_taken_whole() -> None:
    made = tb.changed_bearing(
        SPECIMEN,
        geometry={"plan": {"shape": "circular", "diameter": 270.0}},
        cells=Cells(rubber=4, shim=2),
        tested_range=None,
    )
    assert (made.geometry.plan.breadth, made.cells.rubber, made.tested_range) == (270.0, 4, None)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"hysteresis": {"layer_stiffness": -40.0}}, "hysteresis.layer_stiffness = -40.0"),
        ({"hysteresis": {"stiffnes": 1.0}}, 'unknown key "hysteresis.stiffnes"'),
        ({"hysteresis": {"layer_stiffness": 4e5}}, "shear modulus"),
        ({"lead": None, "kind": "LHDR"}, "needs the tables lead"),
    ],
)
def test_nonsense_is_refused(changes: dict[str, object], said: str) -> None:
    with pytest.raises(tb.InputError, match="changed_bearing") as told:
        tb.changed_bearing(SPECIMEN, **changes)
    assert said in str(told.value)


def test_a_file_reads_back_and_is_not_written_over(tmp_path: Path) -> None:
    made = tb.changed_bearing("shen-lhdr-specimen", name="mine", lead={"yield_stress": 9.0})
    path = tb.save_bearing(made, tmp_path / "mine.toml")
    again = tb.load_bearing(path)
    assert again == made
    assert again.sources == made.sources
    with pytest.raises(tb.OutputError, match="overwrite=True"):
        tb.save_bearing(made, path)
    tb.save_bearing(tb.load_bearing(SPECIMEN), path, overwrite=True)
    assert tb.load_bearing(path).name == SPECIMEN


def test_assignment_says_what_to_do_instead() -> None:
    bearing = tb.load_bearing(SPECIMEN)
    with pytest.raises(
        tb.InputError, match=r"layer_stiffness: records are frozen.*changed_bearing"
    ):
        bearing.hysteresis.layer_stiffness = 40.0
