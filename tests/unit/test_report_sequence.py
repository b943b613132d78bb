"""What the document of a sequence says, against the result that it is about."""

import numpy as np
import pytest

import thermobearing as tb
from tests.unit.report_words import as_data, assert_well_formed, numbers_in
from thermobearing.report.pieces import EXCEEDED, Pieces
from thermobearing.report.template import _arranged
from thermobearing.sequences.case import make_sequence_case
from thermobearing.sequences.report import build_pieces
from thermobearing.sequences.result import SequenceResult
from thermobearing.sequences.run import run_sequence

CYCLE = {"step": "cycles", "strain": 3.0, "speed": "60 mm/s", "count": 1}
BACK = {"step": "ramp", "to": "0 mm", "speed": "10 mm/s"}
PARTS = [
    {"part": "hybrid", "name": "first", "duration": "3 s", "motion": "jra-ii-ii-1"},
    {"part": "cyclic", "name": "loading", "dt": "20 ms", "steps": [BACK, CYCLE]},
    {"part": "rest", "name": "pause", "duration": "10 min"},
    {"part": "hybrid", "name": "second", "duration": "3 s", "motion": "jra-ii-ii-1"},
]
TABLE = {"name": "short", "bearing": "shen-lhdr-specimen", "ambient": "-20 degC", "parts": PARTS}


@pytest.fixture(scope="module")
def result() -> SequenceResult:
    return run_sequence(make_sequence_case(TABLE, "case.toml", rig="shen-rig"))


@pytest.fixture(scope="module")
def pieces(result: SequenceResult) -> Pieces:
    return build_pieces(result)


def test_form(pieces: Pieces) -> None:
    assert_well_formed(pieces)
    _arranged(pieces)


def test_question_and_answer(result: SequenceResult, pieces: Pieces) -> None:
    for words in (
        "1. first: hybrid test of hybrid-pier under jra-ii-ii-1",
        "3. pause: rest of 600 s",
    ):
        assert words in pieces.question
    assert "at ambient temperature −20 °C" in pieces.question
    table = result.table
    force = float(np.abs(table[["force_max_kN", "force_min_kN"]]).to_numpy().max())
    assert f"{force:.4g} kN (02-loading)" in pieces.answer[0]
    first, last = (np.abs(table.loc[k, ["force_max_kN", "force_min_kN"]]).max() for k in (0, 3))
    assert (
        f"04-second compared with 01-first: force {100 * abs(last / first - 1):.0f} %"
        in pieces.answer[1]
    )


def test_parts_and_marks(result: SequenceResult, pieces: Pieces) -> None:
    table = pieces.tables["parts"]
    assert numbers_in(table, "Displacement") == result.table["displacement_max_mm"].tolist()
    strain = [column.head for column in table.columns].index("Strain")
    beyond = {k for k, x in enumerate(numbers_in(table, "Strain")) if not 50.0 <= x <= 250.0}
    beyond -= {2}  # a rest asks nothing
    assert {row for row, column in table.marked if column == strain} == beyond
    assert 1 in beyond  # 300 %


def test_checks_and_validity(pieces: Pieces) -> None:
    reported = {check.what: check for check in pieces.checks}
    assert reported["shear strain (02-loading)"].verdict == EXCEEDED
    assert reported["force (02-loading)"].source == "rig shen-rig"
    assert any("02-loading: shen-lhdr-specimen: strain 300 %" in text for text in pieces.validity)
    assert not any("tested" in text for text in pieces.warnings)


@pytest.mark.thorough
def test_live_and_loaded_are_the_same(result: SequenceResult, pieces: Pieces, tmp_path) -> None:
    saved = result.save(tmp_path / "out", figures=False)
    assert as_data(build_pieces(tb.load_result(saved))) == as_data(pieces)
