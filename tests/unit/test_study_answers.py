"""The directory of a study as a result: loaded, asked, reported, drawn by the command."""

import json
import shutil
import tomllib
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import thermobearing as tb
from thermobearing.border.errors import InputError
from thermobearing.commands.study import app
from thermobearing.studies.options import Asked, _make_asked, asked_over, keep_asked, kept_asked
from thermobearing.studies.report import build_pieces
from thermobearing.studies.result import StudyResult, study_result

SITE = "PGA [m/s^2],return_period [year]\n0.05,2\n1,20\n5,400\n10,2000\n20,20000\n"
CAPACITY = 0.00035  # strain, in a study of half a second


@pytest.fixture
def directory(small_done: Path, tmp_path: Path) -> Path:
    (tmp_path / "site.csv").write_text(SITE)
    return Path(shutil.copytree(small_done, tmp_path / "p1"))


def run(words: list[Any]) -> tuple[int, str]:
    found = CliRunner().invoke(app, [str(word) for word in words])
    return found.exit_code, found.output


def test_a_question_is_kept_and_read_back(directory: Path) -> None:
    options = {"capacity": CAPACITY, "hazard": "site.csv", "weather": "cold-town", "failed": None}
    asked = asked_over(kept_asked(directory), options, directory.parent)
    keep_asked(directory, asked)
    again = kept_asked(directory)
    assert again == asked
    question = study_result(directory).asked
    assert question.capacity == CAPACITY
    assert question.hazard is not None
    assert question.hazard.rate.tolist() == [0.5, 0.05, 0.0025, 0.0005, 0.00005]
    assert len(question.temperatures) > 8000
    keep_asked(directory, asked_over(again, {"capacity": 2.0}))
    assert kept_asked(directory).hazard == asked.hazard


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ({"capcity": 1.0}, 'did you mean "capacity"'),
        ({"capacity": -1.0}, "capacity = -1"),
        ({"hazard": "none.csv"}, "no such file"),
        ({"hazard": {"intensity": ["1 m/s2", "2 m/s2"]}}, "give rate, or return_period"),
        (
            {"hazard": {"intensity": ["1 m/s2", "2 m/s2"], "rate": ["1 1/year", "2 1/year"]}},
            "does not decrease",
        ),
        ({"hazard": {"intensity": ["1", "2"], "rate": ["2 1/year", "1 1/year"]}}, "has no unit"),
        ({"weather": "warm-town"}, "no climate"),
        ({"failed": "ignored"}, "left-out"),
    ],
)
def test_bad_questions(table: dict[str, Any], said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        _make_asked(table, "question.toml", tmp_path)
    assert said in str(caught.value)


def test_a_document_answers(directory: Path) -> None:
    options = {"capacity": CAPACITY, "demand": "bearing_strain_max", "hazard": "site.csv"}
    keep_asked(directory, asked_over(kept_asked(directory), options, directory.parent))
    result = tb.load_result(directory)
    assert isinstance(result, StudyResult)
    assert result.asked.capacity == CAPACITY
    pieces = build_pieces(result)
    assert "largest bearing strain exceed 0.00035, by 8 runs" in pieces.question
    assert pieces.answer[0] == "All 8 runs are done."
    assert {"demand", "variance", "worst", "fragility-shen-hdr-bridge"} <= set(pieces.tables)
    assert list(pieces.figures)[:3] == ["demand", "variance", "ida-shen-hdr-bridge"]
    assert pieces.identity["Command"] == "thermobearing study study.toml -o p1"
    files = tb.make_report(directory, title={"project": "Bridge 12"}, pdf=False)
    page = files[0].read_text()
    assert "Bridge 12" in page
    assert "Shares of the variance" in page


def test_figures_by_the_command(directory: Path) -> None:
    words = ["figures", directory, "--demand", "bearing_strain_max", "--capacity", CAPACITY]
    status, said = run([*words, "--hazard", directory.parent / "site.csv", "--json"])
    assert status == 0, said
    told = json.loads(said.splitlines()[-1])
    names = [Path(name).stem for name in told["files"]]
    assert {"demand", "variance", "ida-shen-hdr-bridge", "rates-shen-hdr-bridge"} <= set(names)
    assert "Annual rates, shen-hdr-bridge" in said
    assert kept_asked(directory).capacity == CAPACITY
    status, said = run(["figures", directory, "--capacity", "-1"])
    assert status == 2


def test_worst_and_repeat_by_the_command(directory: Path, tmp_path: Path) -> None:
    words = ["worst", directory, "--count", 2, "--demand", "bearing_strain_max", "--json"]
    status, said = run(words)
    assert status == 0, said
    worst = json.loads(said.splitlines()[-1])["runs"]
    assert len(worst) == 2
    assert worst[0]["command"] in said
    number = worst[0]["run"]
    status, said = run(["repeat", directory, number, "-o", tmp_path / "again", "--no-figures"])
    assert status == 0, said
    again = tb.load_result(tmp_path / "again")
    strain = study_result(directory).table.set_index("run")["bearing_strain_max"][number]
    assert again.table["bearing_strain_max"].tolist() == [strain]
    status, said = run(["repeat", directory, 8])
    assert status == 2
    assert "no run 8" in said


def test_a_study_without_a_run_has_no_result(directory: Path) -> None:
    for file in (directory / "shards").glob("*.parquet"):
        file.unlink()
    with pytest.raises(InputError, match="no run is done yet"):
        study_result(directory)


def test_the_question_of_the_docs_can_be_asked(tmp_path: Path) -> None:
    text = (Path(__file__).parents[2] / "docs" / "files" / "study.md").read_text(encoding="utf-8")
    block = text.split("## Post-processing")[1].split("```")[1].removeprefix("text\n")
    (tmp_path / "site.csv").write_text(SITE)
    asked = _make_asked(tomllib.loads(block), "question.toml", tmp_path)
    assert set(tomllib.loads(block)) == set(Asked.model_fields)
    assert asked.question().capacity == 1.0
