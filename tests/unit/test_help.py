"""The command: help, names of options, progress, tables on the screen."""

import io
import itertools
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import typer
from rich.console import Console
from typer.testing import CliRunner

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.inputs import command, cyclic
from thermobearing.cli import app
from thermobearing.commands.common import COMPILING
from thermobearing.commands.descriptions import describe, descriptions_text
from thermobearing.commands.options import COMMAND_FIELDS, DESCRIPTIONS
from thermobearing.commands.progress import Rate, progress_bar
from thermobearing.cyclic.protocol import Cycles
from thermobearing.motions.readers import read_motion
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table
from thermobearing.results.screen import _laid_out, say, show_table


def commands(group: Any, *words: str) -> Iterator[tuple[tuple[str, ...], Any]]:
    for name, item in group.commands.items():
        if hasattr(item, "commands"):
            yield from commands(item, *words, name)
        else:
            yield (*words, name), item.full


COMMANDS = dict(commands(typer.main.get_command(app)))


@cache
def help_of(words: tuple[str, ...]) -> str:
    """Return what a command prints for --help, which it does once for all tests."""
    result = CliRunner().invoke(app, [*words, "--help"], env={"COLUMNS": "400"})
    assert result.exit_code == 0
    return result.output


def squeezed(text: str) -> str:
    return re.sub(r"[\s│]+", "", text)


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_help_shows_every_word_of_every_option(words: tuple[str, ...]) -> None:
    shown = squeezed(help_of(words))
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


def test_stored_descriptions_are_those_of_the_records() -> None:
    """Help reads the file in place of the records; an option that is not in it has the same."""
    text = DESCRIPTIONS.read_text(encoding="utf-8")
    assert text == descriptions_text(COMMAND_FIELDS), "python -m docs.generate --texts-only"
    assert describe("cyclic.protocol:CyclicTest", "dt") == {
        "kind": "float",
        "text": "Largest time step while the bearing moves [s], in [1e-6, 10]; 0.005 by default.",
    }


def test_help_imports_no_analysis() -> None:
    code = (
        "import contextlib, sys, thermobearing.cli\n"
        "with contextlib.suppress(SystemExit): thermobearing.cli.main()\n"
        "print(*sys.modules)"
    )
    words = [sys.executable, "-c", code, "bridge", "--help"]
    process = subprocess.run(words, capture_output=True, text=True, check=True)
    modules = set(process.stdout.splitlines()[-1].split())
    assert "thermobearing.commands.earthquake" in modules
    heavy = {"numpy", "scipy", "pandas", "xarray", "matplotlib", "rich.progress"}
    assert not modules & (heavy | {"thermobearing.border.schema", "thermobearing.earthquake.case"})


def test_units_are_among_them() -> None:
    texts = [item.help or "" for command in COMMANDS.values() for item in command.params]
    assert sum("[degC]" in text for text in texts) >= 4
    assert sum("[s]" in text for text in texts) >= 4


# An option that takes numbers, as newer and older versions of typer write it.
NUMBER = r"(--[a-z-]+)[^<]*?(?:<[^>]*float|FLOAT)"
# Numbers without a unit; every other number says its own.
PURE = {
    "--capacity",
    "--tolerance",
    "--strain",
    "--damping",
    "--ratio",
    "--zone-factor",
    "--end-spreading",
}


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_every_option_with_a_unit_shows_it(words: tuple[str, ...]) -> None:
    for line in help_of(words).splitlines():
        option = re.search(NUMBER, line)
        if option and option[1] not in PURE:
            assert re.search(r"\[(s|h|mm|kN|mm/s|degC|Hz|rad)\]", line), line


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_every_command_has_groups_and_an_example_that_parses(words: tuple[str, ...]) -> None:
    output, given = help_of(words), COMMANDS[words]
    examples = [line.split() for line in given.epilog.split("\n\n")]
    assert examples
    for start, program, *example in examples:
        assert (start, program) == ("Example:", "thermobearing")
        assert tuple(example[: len(words)]) == words
        given.make_context(words[-1], example[len(words) :])  # an unknown option ends here
        assert squeezed("thermobearing" + "".join(example)) in squeezed(output)
    panels = {getattr(item, "rich_help_panel", None) for item in given.params} - {None}
    assert all(f"{panel}:" in output for panel in panels)
    if len(given.params) > 8:
        assert "Result" in panels


def test_commands_stand_in_groups() -> None:
    shown = help_of(())
    groups = ("Tests and earthquakes:", "From laboratory tests:", "Design:", "Library and files:")
    places = [shown.index(group) for group in groups]
    assert len(set(places)) == len(groups)
    assert "Commands:" not in shown  # nothing is left without a group


def test_a_test_in_a_few_words(tmp_path: Path) -> None:
    words = ["--strain", 1.75, "--wave", "sine", "--frequency", 0.5, "--cycles", 11]
    result = cyclic(*words, "--dt", 0.05, "--ambient", 23, "-o", tmp_path / "out", "-q")
    assert result.exit_code == 0
    (step,) = tb.load_case(tmp_path / "out" / "case.resolved.toml").test.steps
    assert isinstance(step, Cycles)
    assert (step.strain, step.wave, step.frequency, step.count) == (1.75, "sine", 0.5, 11)
    assert step.speed is None


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--cycles", 3], "--cycles requires --strain"),
        (["--strain", 1, "--speed", 30, "--period", 2], "speed"),
        (["--strain", -1], "strain"),
        (["--strain", 1, "--wave", "square"], "wave"),
    ],
)
def test_bad_words_of_a_test(words: list[Any], message: str, tmp_path: Path) -> None:
    result = cyclic(*words, "-o", tmp_path / "out")
    assert result.exit_code == 2
    assert message in result.stderr
    assert not (tmp_path / "out").exists()


def test_completion_is_offered() -> None:
    assert "--install-completion" in help_of(())


def test_first_run_says_that_it_compiles(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    words = ["--strain", 0.5, "--cycles", 1, "--dt", 0.05, "--ambient", 23]
    assert COMPILING not in cyclic(*words, "-o", tmp_path / "warm").stderr
    monkeypatch.setattr("thermobearing.core.compiled.native.open_library", lambda: (None, ""))
    monkeypatch.setattr(
        "thermobearing.core.compiled.runners.cache_directory", lambda: tmp_path / "empty"
    )
    assert COMPILING in cyclic(*words, "-o", tmp_path / "cold").stderr
    assert COMPILING not in cyclic(*words, "-o", tmp_path / "quiet", "-q").stderr


def test_numbers_are_among_the_options() -> None:
    """The one above would say nothing if help named the types otherwise."""
    assert len(re.findall(NUMBER, help_of(("cyclic",)))) >= 5


def test_an_option_of_several_keys_lists_choices_and_units() -> None:
    shown = help_of(("hybrid",))
    assert "scheme=conservative|published" in shown
    for key in ("delay [s]", "force_noise [kN]", "speed [mm/s]", "side.film"):
        assert key in shown
    described = describe("model.options:ModelOptions", "side")
    assert described["entries"] == ["film", "cover"]


TEST = "time_s,displacement_mm,force_kN\n" + "".join(
    f"{0.1 * k},{10 - abs(k % 40 - 20)},{23 - 2 * abs(k % 40 - 20) - 6 * (k % 40 > 20)}\n"
    for k in range(10, 130)
)
STRONG = "time_s,acceleration_gal\n" + "".join(f"{0.01 * k},{5e4 * (-1) ** k}\n" for k in range(99))


def said(folder: Path, *words: str) -> str:
    files = {"t.csv": TEST, "strong.csv": STRONG, "case.toml": "[analysis]\nkeep_every = 0\n"}
    for name, text in files.items():
        (folder / name).write_text(text)
    given = [str(folder / word) if word in files else word for word in words]
    result = CliRunner().invoke(app, [*given, "-o", str(folder / "out")])
    assert result.exit_code == 2, result.output
    assert not (folder / "out").exists()
    return result.stderr


FIT = ("identify", "t.csv", "--bearing", "shen-hdr-specimen")


@pytest.mark.parametrize(
    ("words", "reported"),
    [
        (("cyclic", "--dt", "-1"), "--dt = '-1.0 s': must be"),
        (("cyclic", "--keep-every", "0"), "--keep-every = 0: must be"),
        (("cyclic", "--ambient", "500"), "--ambient = '500.0 degC': must be"),
        (("cyclic", "--strain", "1", "--wave", "saw"), "--wave = 'saw': must be"),
        (("hybrid", "--mode", "q"), "--mode = 'q': must be"),
        (("lambda", "shen-hdr-bridge", "--strain", "-1"), "--strain = -1.0: must be"),
        (("cyclic", "--strain", "1", "--rest", "-5"), "thermobearing: --rest = -5.0: must be"),
        (("cyclic", "--strain", "1", "--cycles", "0"), "thermobearing: --cycles = 0: must be"),
        (("cyclic", "--strain", "1", "--ratio", "1"), "thermobearing: --ratio: applies only"),
        (("bridge", "--axial-force", "1", "--codes", "x"), "--codes = 'x': must be"),
        (("design", "--group", "x,y"), '--group: no bearing line is called "x"'),
        (("bridge", "--exposure", "stiffness=-1"), "--exposure stiffness = -1.0: must be"),
        (("bridge", "--exposure", "foo=1"), 'unknown key "--exposure foo"'),
        (("cyclic", "--strain", "1", "--path", "circle", "--ratio", "1"), ": --ratio: a circle"),
        (("motions", "make", "--dt", "0"), "thermobearing: --dt: 0 s is outside"),
        ((*FIT, "--predict", "900"), ": --predict = 900.0 degC: must be"),
        (("motions", "show", "strong.csv"), "confirm it with --trust-unit"),
        ((*FIT, "--free", "K_x"), '--free: no parameter "K_x"'),
        ((*FIT, "--free", "sigma_Y"), '--free: "sigma_Y": the bearing'),
        ((*FIT, "--starts", "0"), "--starts = 0: must be"),
        ((*FIT, "--start-from", "file"), '--start-from = "file": '),
        (("cyclic", "case.toml"), "case.toml: analysis.keep_every = 0: must be"),
    ],
    ids=lambda value: " ".join(value[-2:]) if isinstance(value, tuple) else None,
)
def test_the_command_names_its_options(
    tmp_path: Path, words: tuple[str, ...], reported: str
) -> None:
    assert reported in said(tmp_path, *words)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (
            ["cyclic", "--ambient", "5", "--ambient", "abc"],
            "--ambient = 'abc': must be a number in",
        ),
        (["cyclic", "--axial-force=5MN"], "--axial-force = '5MN': must be a number in kN, without"),
        (["cyclic", "--cycles", "1.5"], "--cycles = '1.5': must be an integer"),
        (["cyclic", "--strain", "x"], "--strain = 'x': must be a number"),
        (["study", "worst", "p", "--count", "0"], "--count = 0: "),
        (["cyclic", "--bearing"], "--bearing requires a value: Bearing: library name or TOML file"),
        (["check"], "missing argument file"),
        (["measure", "t.csv"], "missing option --bearing: Bearing"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_a_wrong_word_is_one_sentence(words: list[str], sentence: str) -> None:
    shown = command(*words)
    assert (shown.exit_code, shown.stderr.count("\n")) == (2, 1)
    assert shown.stderr.startswith(f"thermobearing: {sentence}")


def test_a_wrong_word_ends_with_json() -> None:
    (line,) = command("cyclic", "--ambient", "abc", "--json").stdout.splitlines()
    assert json.loads(line)["outcome"] == "bad_input"


def test_python_names_its_keywords(tmp_path: Path) -> None:
    said(tmp_path, "cyclic", "--dt", "-1")  # a command that ran before leaves nothing behind
    with pytest.raises(tb.InputError, match=r"analysis\.keep_every = 0"):
        tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[1.0], cycles=1), keep=tb.Keep(every=0))
    with pytest.raises(tb.InputError, match="confirm it with trust_unit"):
        read_motion(tmp_path / "strong.csv")
    with pytest.raises(tb.InputError, match=r'^free: no parameter "K_x"'):
        tb.identify_bearing(tmp_path / "t.csv", "shen-hdr-specimen", free=["K_x"])


@pytest.mark.parametrize(
    ("seconds", "reported"),
    [(0.5, "2 per second"), (0.01, "100 per second"), (120.0, "0.5 per minute")],
)
def test_rate(seconds: float, reported: str) -> None:
    """Of those that were done since the first call, which may bring many from an earlier start."""
    bar = progress_bar(Console(file=io.StringIO()))
    now = [0.0]
    bar.get_time = lambda: now[0]
    task = bar.add_task("runs", total=None)
    bar.start_task(task)
    for completed in (700, 701, 702, 703):
        bar.update(task, completed=completed, total=1000)
        now[0] += seconds
    assert Rate().render(bar.tasks[0]).plain == reported


def test_bar_is_whole() -> None:
    console = Console(file=io.StringIO(), width=100)
    bar = progress_bar(console)
    bar.add_task("runs", total=10, completed=3)
    console.print(bar.get_renderable())
    shown = console.file.getvalue()
    assert shown.startswith("runs")
    assert "3/10" in shown
    assert shown.rstrip().endswith("left")


HEADS = ("motion", "degC", "strain", "force kN", "lead degC")
ROWS = [("jra-ii-ii-1", "-20", "175%", "1234.5", "161.25"), ("x", "23", "9%", "7.0", "-3.10")]
FRAMES = re.compile(r"[\x1b\u2500-\u257f…]")  # colours, boxes, what was cut


@pytest.mark.parametrize("width", [1, 20, 27, 40, 80, None])
def test_blocks_hold_every_number_once_and_the_keys_in_each(width: int | None) -> None:
    blocks = _laid_out(HEADS, ROWS, 2, width)
    for line, row in enumerate(ROWS, -len(ROWS)):
        shown = [block[line] for block in blocks]
        for key in row[:2]:
            assert all(key in text for text in shown)
        for number in row[2:]:
            assert sum(number in text for text in shown) == 1
    heads = " ".join(text for block in blocks for text in block[: -len(ROWS)])
    assert all(word in heads for head in HEADS for word in head.split())
    narrowest = max(len("jra-ii-ii-1  degC  ") + len(head) for head in HEADS[2:])
    if width is None:
        assert len(blocks) == 1
    elif width >= narrowest:
        assert max(map(len, itertools.chain(*blocks))) <= width
        assert len(blocks) == (1 if width == 80 else len(blocks))


def test_nothing_is_markup_or_cut(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    say("a bearing [bold] of " + 60 * "many words ")
    show_table(Table("[red]", list(map(Quantity, HEADS)), ROWS, 2, failed=frozenset({0})))
    shown = capsys.readouterr().out
    assert "[bold]" in shown
    assert "[red]" in shown
    assert not FRAMES.search(shown)
    assert len(shown.splitlines()) == 6  # the sentence is one of them: a pipe has no width


def test_table_of_cycles_is_whole_and_has_the_lead(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    test = tb.cyclic_test(strain=[0.5], cycles=1, dt=0.02)
    result = tb.run("shen-lhdr-specimen", test, ambient=-20)
    row = result.cycles.iloc[0]
    stiffness = 1e-3 * row["G_eq_MPa"] * 240.0**2 / 30.0  # of the specimen [kN/mm]
    assert row["K_eq_kN_mm"] == pytest.approx(stiffness, rel=tol.ROUNDING)
    numbers = {f"{row['G_eq_MPa']:.3f}", f"{1e-3 * row['energy_kN_mm']:.2f}", f"{stiffness:.3f}"}
    numbers |= {f"{row[name]:.1f}".replace("-", "−") for name in result.cycles.columns[-4:]}
    for columns in ("", "50", "80"):
        monkeypatch.setenv("COLUMNS", columns)
        result.show()
        shown = capsys.readouterr().out
        assert not FRAMES.search(shown)
        assert numbers | {"Lead", "[°C]"} <= set(shown.split())
        if columns == "80":
            assert max(len(line) for line in shown.splitlines() if "%" in line) <= 80


def test_study_shows_rubber_and_lead_in_a_pipe(tmp_path: Path) -> None:
    words = ["--bearing", "shen-lhdr-bridge", "--motion", "jra-ii-i-1", "--duration", "2"]
    result = command("bridge", *words, "--no-figures", "-o", tmp_path / "out")
    assert not FRAMES.search(result.stdout)
    assert {"Strain", "Ductility", "Deck", "Rubber", "Lead", "[°C]"} <= set(result.stdout.split())


def test_a_program_in_a_pipe_writes_plain_text() -> None:
    plain = {k: v for k, v in os.environ.items() if not k.startswith(("FORCE", "TERM", "GITHUB"))}
    words = [sys.executable, "-m", "thermobearing.cli", "cyclic", "--wrong"]
    process = subprocess.run(words, capture_output=True, text=True, env=plain, check=False)
    assert "Usage" in process.stderr
    assert not FRAMES.search(process.stdout + process.stderr)


@pytest.mark.parametrize(("ambients", "shown"), [((0,), False), ((0, 23), True)])
def test_energy_ratio_needs_a_warmer_run(
    tmp_path: Path, ambients: tuple[int, ...], shown: bool
) -> None:
    words = ["--bearing", "shen-hdr-bridge", "--motion", "jra-ii-i-1", "--duration", "0.5"]
    words += [word for at in ambients for word in ("--ambient", str(at))]
    result = command("bridge", *words, "--no-figures", "-o", tmp_path / "out")
    assert ("ratio" in result.stdout.split()) is shown
