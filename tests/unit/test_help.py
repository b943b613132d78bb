"""`--help` says what is written beside each option, units too."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import typer
from typer.testing import CliRunner

import thermobearing as tb
from tests.unit.inputs import cyclic
from thermobearing.cli import app
from thermobearing.commands.common import COMPILING
from thermobearing.cyclic.protocol import Cycles


def commands(group: Any, *words: str) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Every command with its words."""
    for name, item in group.commands.items():
        if hasattr(item, "commands"):
            yield from commands(item, *words, name)
        else:
            yield (*words, name), item.whole


COMMANDS = dict(commands(typer.main.get_command(app)))


def squeezed(text: str) -> str:
    """Without frames and the breaks of lines."""
    return re.sub(r"[\s│]+", "", text)


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_help_shows_every_word_of_every_option(words: tuple[str, ...]) -> None:
    done = CliRunner().invoke(app, [*words, "--help"], env={"COLUMNS": "400"})
    assert done.exit_code == 0
    shown = squeezed(done.output)
    helps = [item.help for item in COMMANDS[words].params if getattr(item, "help", None)]
    assert helps
    for text in helps:
        assert squeezed(text) in shown


def test_every_option_is_described() -> None:
    """The texts of most options are those of docstrings; a name alone is what is left without."""
    for words, item in COMMANDS.items():
        for one in item.params:
            text = getattr(one, "help", None)
            name = (one.name or "").replace("_", " ")
            assert text is None or text.split(";")[0].rstrip(".").lower() != name, (words, text)


def test_units_are_among_them() -> None:
    texts = [item.help or "" for command in COMMANDS.values() for item in command.params]
    assert sum("[degC]" in text for text in texts) >= 4
    assert sum("[s]" in text for text in texts) >= 4


# An option that takes numbers, as newer and older versions of typer write it.
NUMBER = r"(--[a-z-]+)[^<]*?(?:<[^>]*float|FLOAT)"
# Numbers without a unit; every other number says its own.
PURE = {"--capacity", "--tolerance", "--strain", "--damping", "--zone-factor", "--end-spreading"}


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_every_option_with_a_unit_shows_it(words: tuple[str, ...]) -> None:
    done = CliRunner().invoke(app, [*words, "--help"], env={"COLUMNS": "400"})
    for line in done.output.splitlines():
        option = re.search(NUMBER, line)
        if option and option[1] not in PURE:
            assert re.search(r"\[(s|mm|kN|mm/s|degC|Hz)\]", line), line


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_every_command_has_groups_and_an_example_that_parses(words: tuple[str, ...]) -> None:
    done = CliRunner().invoke(app, [*words, "--help"], env={"COLUMNS": "400"})
    given = COMMANDS[words]
    examples = [line.split() for line in given.epilog.split("\n\n")]
    assert examples
    for start, program, *example in examples:
        assert (start, program) == ("Example:", "thermobearing")
        assert tuple(example[: len(words)]) == words
        given.make_context(words[-1], example[len(words) :])  # an unknown option ends here
        assert squeezed("thermobearing" + "".join(example)) in squeezed(done.output)
    panels = {getattr(item, "rich_help_panel", None) for item in given.params} - {None}
    assert all(f"{panel}:" in done.output for panel in panels)
    if len(given.params) > 8:
        assert "Result" in panels


def test_commands_stand_in_groups() -> None:
    shown = CliRunner().invoke(app, ["--help"], env={"COLUMNS": "400"}).output
    groups = ("Tests and earthquakes:", "From laboratory tests:", "Design:", "Library and files:")
    places = [shown.index(group) for group in groups]
    assert len(set(places)) == len(groups)
    assert "Commands:" not in shown  # nothing is left without a group


def test_a_test_in_a_few_words(tmp_path: Path) -> None:
    words = ["--strain", 1.75, "--wave", "sine", "--frequency", 0.5, "--cycles", 11]
    done = cyclic(*words, "--dt", 0.05, "--ambient", 23, "-o", tmp_path / "out", "-q")
    assert done.exit_code == 0
    (step,) = tb.load_case(tmp_path / "out" / "case.resolved.toml").test.steps
    assert isinstance(step, Cycles)
    assert (step.strain, step.wave, step.frequency, step.count) == (1.75, "sine", 0.5, 11)
    assert step.speed is None


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--cycles", 3], "--cycles describes a test: give its --strain too"),
        (["--strain", 1, "--speed", 30, "--period", 2], "speed"),
        (["--strain", -1], "strain"),
        (["--strain", 1, "--wave", "square"], "wave"),
    ],
)
def test_bad_words_of_a_test(words: list[Any], message: str, tmp_path: Path) -> None:
    done = cyclic(*words, "-o", tmp_path / "out")
    assert done.exit_code == 2
    assert message in done.stderr
    assert not (tmp_path / "out").exists()


def test_completion_is_offered() -> None:
    done = CliRunner().invoke(app, ["--help"], env={"COLUMNS": "400"})
    assert "--install-completion" in done.output


def test_first_run_says_that_it_compiles(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    words = ["--strain", 0.5, "--cycles", 1, "--dt", 0.05, "--ambient", 23]
    assert COMPILING not in cyclic(*words, "-o", tmp_path / "warm").stderr
    monkeypatch.setattr("thermobearing.core.compile.cache_directory", lambda: tmp_path / "empty")
    assert COMPILING in cyclic(*words, "-o", tmp_path / "cold").stderr
    assert COMPILING not in cyclic(*words, "-o", tmp_path / "quiet", "-q").stderr


def test_numbers_are_among_the_options() -> None:
    """The one above would say nothing if help named the types otherwise."""
    done = CliRunner().invoke(app, ["hybrid", "--help"], env={"COLUMNS": "400"})
    assert len(re.findall(NUMBER, done.output)) >= 5
