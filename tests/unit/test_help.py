"""`--help` says what is written beside each option, units too."""

import re
from collections.abc import Iterator
from typing import Any

import pytest
import typer
from typer.testing import CliRunner

from thermobearing.cli import app


def commands(group: Any, *words: str) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Every command with its words."""
    for name, item in group.commands.items():
        if hasattr(item, "commands"):
            yield from commands(item, *words, name)
        else:
            yield (*words, name), item


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


def test_units_are_among_them() -> None:
    texts = [item.help or "" for command in COMMANDS.values() for item in command.params]
    assert sum("[degC]" in text for text in texts) >= 4
    assert sum("[s]" in text for text in texts) >= 4


# An option that takes numbers, as newer and older versions of typer write it.
NUMBER = r"(--[a-z-]+)[^<]*?(?:<[^>]*float|FLOAT)"
# Numbers without a unit; every other number says its own.
PURE = {"--tolerance", "--strain", "--damping", "--zone-factor", "--end-spreading"}


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_every_option_with_a_unit_shows_it(words: tuple[str, ...]) -> None:
    done = CliRunner().invoke(app, [*words, "--help"], env={"COLUMNS": "400"})
    for line in done.output.splitlines():
        option = re.search(NUMBER, line)
        if option and option[1] not in PURE:
            assert re.search(r"\[(s|mm|kN|mm/s|degC|Hz)\]", line), line


def test_numbers_are_among_the_options() -> None:
    """The one above would say nothing if help named the types otherwise."""
    done = CliRunner().invoke(app, ["hybrid", "--help"], env={"COLUMNS": "400"})
    assert len(re.findall(NUMBER, done.output)) >= 5
