"""`thermobearing start`: four answers become a case, and the commands to run next."""

import shlex
from pathlib import Path
from types import SimpleNamespace

import pytest
import typer

import thermobearing as tb
from tests.docs.test_coverage import nothing_wrong_with_command
from tests.unit.inputs import command
from thermobearing.climate.site import find_cold
from thermobearing.commands import start
from thermobearing.cyclic.case import load_case
from thermobearing.earthquake.case import load_earthquake_case


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_without_a_terminal_all_answers_have_defaults(folder: Path) -> None:
    done = command("start", "--quiet")
    assert done.exit_code == 0, done.stderr
    assert done.stdout.splitlines() == ["thermobearing cyclic case.toml -o first"]
    case = load_case(folder / "case.toml")
    assert (case.bearing.name, case.ambient) == (start.BEARING, [23.0, -20.0])
    assert case.test.steps[0].count == 3
    lines = (folder / "case.toml").read_text(encoding="utf-8").splitlines()
    assert all(lines[lines.index(key) - 1].startswith("# ") for key in ("steps = [", "[test]"))
    run = command(*shlex.split(done.stdout)[1:], "--no-figures")
    assert run.exit_code == 0, run.stderr
    printed = run.stdout + run.stderr
    assert "warning" not in printed
    assert not tb.load_result(folder / "first").warnings


def test_a_bridge_with_a_bearing_of_ones_own(folder: Path) -> None:
    new = command(
        "new", "mine", "--compound", "natural-rubber", "--plan", "500x500mm", "--layers", "6x17mm",
        "--shim", "6mm", "--lead", "100mm",
    )  # fmt: skip
    assert new.exit_code == 0, new.stderr
    words = ["--bearing", "mine.toml", "--bridge", "pier-p1", "--ambient", "-5.5"]
    done = command("start", *words, "-o", "cases/winter.toml")
    assert done.exit_code == 2  # the folder of the case must be there
    (folder / "cases").mkdir()
    done = command("start", *words, "-o", "cases/winter.toml", "-q")
    assert done.exit_code == 0, done.stderr
    assert done.stdout.splitlines() == [
        "thermobearing bridge cases/winter.toml -o first",
        "thermobearing report first",
    ]
    case = load_earthquake_case(folder / "cases" / "winter.toml")
    assert case.structure.name == "pier-p1"
    assert [bearing.name for bearing in case.bearings] == ["mine"]
    assert case.ambient == [23.0, -5.5]
    again = command("start", *words, "-o", "cases/winter.toml")
    assert again.exit_code == 2
    assert "--overwrite" in again.stderr


def test_tests_and_a_climate(folder: Path) -> None:
    for name in ("cold test.csv", "warm.csv"):
        (folder / name).touch()
    done = command(
        "start", "--tests", "cold test.csv", "--tests", "warm.csv", "--ambient", "cold-town", "-q"
    )
    assert done.exit_code == 0, done.stderr
    lines = [shlex.split(line) for line in done.stdout.splitlines()]
    assert [line[1] for line in lines] == ["intake", "identify", "cyclic"]
    assert lines[1][2:4] == ["cold test.csv", "warm.csv"]
    assert "fit/bearing.toml" in lines[2]
    for line in lines:
        nothing_wrong_with_command(
            [word if word.startswith("-") else word.replace(".csv", ".txt") for word in line[1:]]
            if line[1] != "cyclic"
            else line[1:2]
        )
    low = find_cold("cold-town").design_temperature
    (cold,) = [value for value in load_case(folder / "case.toml").ambient if value != 23.0]
    assert low - 1.0 < cold <= low


def test_the_questions_are_asked_at_a_terminal(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers = {"bearing": "shen-lhdr-bridge", "tests": "", "bridge": "pier-p1", "ambient": "-15"}
    asked = []

    def answer(question: str, default: str) -> str:
        asked.append((question, default))
        return answers[question]

    monkeypatch.setattr(start, "_answer", answer)
    assert command("start").exit_code == 0
    assert [question for question, _ in asked] == list(start.QUESTIONS) == list(answers)
    case = load_earthquake_case(folder / "case.toml")
    assert case.ambient == [23.0, -15.0]
    assert case.bearings[0].name == "shen-lhdr-bridge"


def test_a_broken_answer_and_an_interruption_end_with_a_status(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(start, "_answer", lambda question, default: default or "it's.csv")
    done = command("start")
    assert done.exit_code == 2
    assert "it's.csv" in done.stderr
    monkeypatch.undo()
    monkeypatch.chdir(folder)

    def abort(*_: object, **__: object) -> None:
        raise typer.Abort

    terminal = SimpleNamespace(isatty=lambda: True)
    monkeypatch.setattr(start, "sys", SimpleNamespace(stdin=terminal, stdout=terminal))
    monkeypatch.setattr(typer, "prompt", abort)
    assert command("start").exit_code == 130
    assert list(folder.iterdir()) == []


@pytest.mark.parametrize(
    ("words", "parts"),
    [
        (["--bearing", "shen-hdr-brigde"], ["shen-hdr-bridge"]),
        (["--bearing", "mine.toml"], ["mine.toml", "thermobearing new"]),
        (["--bearing", "natural-rubber"], ["thermobearing new", "--compound natural-rubber"]),
        (["--bearing", "mine.toml"], ["thermobearing new mine "]),
        (["--tests", "nothing.csv"], ["nothing.csv"]),
        (["--bridge", "pier-p2"], ["pier-p1"]),
        (["--ambient", "-200"], ["-100 to 100"]),
        (["--ambient", "nan"], ["-100 to 100"]),
        (["--ambient", "cold-twon"], ["cold-town"]),
    ],
)
def test_a_wrong_answer_writes_nothing(words: list[str], parts: list[str], folder: Path) -> None:
    done = command("start", *words)
    assert done.exit_code == 2
    assert all(part in done.stderr for part in parts), done.stderr
    assert list(folder.iterdir()) == []
