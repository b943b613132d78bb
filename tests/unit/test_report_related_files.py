"""What documents say from files next to a result: earlier models; a structure that is looked at."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import thermobearing as tb
from tests.unit.inputs import command
from tests.unit.report_words import assert_well_formed, numbers_in
from thermobearing.border.errors import InputError
from thermobearing.report.template import _arranged
from thermobearing.reporting import build_pieces
from thermobearing.results.drawing import save_figures

TEST = ["--strain", "1", "--cycles", "1", "--no-figures", "-q"]


@pytest.fixture
def compared(tmp_path: Path) -> Path:
    out = tmp_path / "out"
    assert command("cyclic", "--compare", *TEST, "-o", out).exit_code == 0
    return out


@pytest.mark.thorough
def test_the_earlier_models_are_in_the_document(compared: Path) -> None:
    pieces = build_pieces(tb.load_result(compared), compared)
    assert_well_formed(pieces)
    table = pieces.tables["comparison"]
    reported = pd.read_csv(compared / "comparison.csv")
    assert numbers_in(table, "Peak force") == reported["peak force %"].tolist()
    units = {column.head: column.unit for column in table.columns}
    assert units["Inner layer rms"] == "K"
    assert units["Ambient"] == "°C"
    assert "Outcome" not in units  # all are completed
    assert "comparison" not in pieces.figures


def test_the_verdict_and_what_all_runs_share_stand_below(tmp_path: Path) -> None:
    case = ["--duration", "1", "--ambient", "-20", "--no-figures", "-q", "--compare"]
    out = tmp_path / "out"
    assert command("hybrid", "--bearing", "shen-hdr-specimen", *case, "-o", out).exit_code == 0
    (out / "figures").mkdir()
    result = tb.cyclic_test(strain=[0.5], cycles=1)
    drawn = tb.run("shen-hdr-specimen", result).plot.loops
    save_figures({"comparison": drawn}, out / "figures")
    pieces = build_pieces(tb.load_result(out), out)
    table = pieces.tables["comparison"]
    assert table.note.startswith("Motion: jra-ii-ii-1. ")
    assert "A single temperature underestimates" in table.note
    assert not {"Motion", "Mode"} & {column.head for column in table.columns}
    assert pieces.figures["comparison"].image is not None


def test_a_damaged_comparison_is_reported(compared: Path) -> None:
    (compared / "comparison.csv").write_text("")
    with pytest.raises(InputError, match=r"comparison\.csv: is not a table of a result"):
        build_pieces(tb.load_result(compared), compared)


def test_a_structure_has_words_of_its_own(tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert command("structures", "show", "pier-p1", "-o", out, "-q").exit_code == 0
    pieces = build_pieces(tb.load_result(out), out)
    assert_well_formed(pieces)
    headings = [block.text for block in _arranged(pieces) if type(block).__name__ == "Heading"]
    assert "Validity" not in headings  # no parameters of a bearing are in it
    first = json.loads((out / "summary.json").read_text())["modes"][0]
    assert f"is {first['period_s']:.3g} s, with a damping of 2.8 %" in pieces.answer[0]
    rows = {row[0]: row[1:] for row in pieces.inputs["structure"].rows}
    assert rows["Mass deck: mass"] == (400.0, "t", "Table 6.2; node 1")
    assert np.allclose(numbers_in(pieces.tables["periods"], "Period")[0], first["period_s"])
    assert set(pieces.figures) == {"model", "modes"}
