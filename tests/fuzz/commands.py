"""Command lines: every command with its options, right and wrong, in this process. No tests."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from hypothesis import strategies as st
from typer.testing import CliRunner, Result

from tests.fuzz import grammar, sheets
from tests.fuzz.borders import Border, companion_files
from tests.fuzz.judge import CLEAN, COMPLETED, TYPED, Example, check_numbers
from tests.fuzz.mutations import damaged, plain_numbers, rows_of_numbers, toml_files
from thermobearing.cli import app

WORDS = ["", "x", "nan", "-1", "0", "1e-308", "1e309", "inf", "²", "x" * 300, "--", "免震", "1,2",
         "-", "/dev/null", ".", "\udc80", "a\tb", "9" * 400]  # fmt: skip
Options = dict[str, list[str]]
OPTIONS: dict[str, Options] = grammar.ENTRIES["options"]


@st.composite
def _value(draw: st.DrawFn, right: list[str]) -> str:
    """One of the right values; one in eight is a number or a word that is not."""
    kind = draw(st.integers(0, 15))
    if kind == 15:
        return draw(st.sampled_from(WORDS))
    return repr(draw(plain_numbers())) if kind == 14 else draw(st.sampled_from(right))


@st.composite
def _words(draw: st.DrawFn, options: Options, most: int = 3) -> list[str]:
    words: list[str] = []
    for _ in range(draw(st.integers(0, most)) if options else 0):
        name = draw(st.sampled_from(sorted(options)))
        words += [name, draw(_value(options[name]))]
    if draw(st.integers(0, 19)) == 0:
        words.append(draw(st.sampled_from(["--zzz", "-x", "--dt", "extra", "--help", "--version"])))
    return words


WRONG_TARGETS = ["x" * 300, "a.toml", ".", "taken", "\0", "", "/proc/none", "\udc80"]


@st.composite
def _targets(draw: st.DrawFn) -> str:
    right = draw(st.integers(0, 9)) < 9
    return draw(st.sampled_from(["out", "a/b/out", "免 震"] if right else WRONG_TARGETS))


@st.composite
def _output(draw: st.DrawFn) -> list[str]:
    words = ["-o", draw(_targets()), "--no-figures"]
    return words + [w for w in ("--json", "-q", "--overwrite") if draw(st.booleans())]


def _names(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*")}


def run_command(words: list[str], folder: Path) -> str:
    """Run one command line; how it ended, after a look at all it left and said."""
    if "taken" in words:
        (folder / "taken").mkdir()
        (folder / "taken" / "thesis.tex").write_text("years of work")
    before = _names(folder)
    done = CliRunner().invoke(app, words)
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise done.exception
    status, reported = done.exit_code, done.output + done.stderr
    assert status in (0, 2, 3, 4), f"status {status}"
    for piece in ("Traceback", "Exception ignored", "Warning:", "not enough memory"):
        assert piece not in reported, f"{piece!r} was printed: {reported[-300:]}"
    new = _names(folder) - before
    if status == 2:
        _check_refused(words, done, new)
        return CLEAN
    for name in new:
        if name.endswith("summary.json"):
            _check_summary(folder / name)
    if "--json" in words and "--help" not in words and "--version" not in words:
        json.loads(done.stdout.splitlines()[-1], parse_constant=_no_constant)
    return COMPLETED if status == 0 else TYPED


def _check_refused(words: list[str], done: Result, new: set[str]) -> None:
    """A refusal is reported on stderr and leaves nothing, but for the report of refused tests.

    `intake` writes what it could read of several files.
    """
    reports = "--check" in words or words[:1] == ["intake"]
    if reports and any(name.endswith("summary.json") for name in new):
        return
    assert done.output.strip(), "status 2 without a word"
    assert not new, f"refused, and left {sorted(new)[:5]}"


def _check_summary(path: Path) -> None:
    summary = json.loads(path.read_text(encoding="utf-8"), parse_constant=_no_constant)
    check_numbers(summary, str(summary.get("outcome")))


def _no_constant(word: str) -> None:
    raise AssertionError(f"{word} in JSON")


@st.composite
def _command(
    draw: st.DrawFn,
    line: str,
    options: str,
    files: st.SearchStrategy[tuple[list[str], dict[str, bytes]]],
    fixed: str = "",
    *,
    output: bool = True,
) -> Example:
    """Draw command lines: `options` names tables of valid.toml, `fixed` stands in each line."""
    arguments, given = draw(files)
    known = {name: right for part in options.split() for name, right in OPTIONS[part].items()}
    words = [*line.split(), *arguments, *fixed.split(), *draw(_words(known))]
    words += draw(_output()) if output else (["--json"] if draw(st.booleans()) else [])
    named = " ".join(words).encode("utf-8", "replace")
    content = {**companion_files(named + b"".join(given.values())), **given}
    call: Callable[[Path], str] = lambda folder: run_command(words, folder)  # noqa: E731
    about = f"{words} with {[raw[:400] for raw in given.values()]}"
    return Example(content, call, about)


def _toml(entry: str) -> st.SearchStrategy[Any]:
    return (
        grammar.valid(entry)
        .flatmap(lambda table: toml_files(table, calm=True))
        .map(lambda raw: (["a.toml"], {"a.toml": raw}))
    )


def _table(text: str, name: str) -> st.SearchStrategy[Any]:
    return rows_of_numbers(text).map(lambda raw: ([name], {name: raw}))


@st.composite
def _motion(draw: st.DrawFn) -> Any:
    name = draw(st.sampled_from([*sorted(grammar.MOTIONS), "jra-ii-i-1", "no-such", "x" * 300]))
    if name not in grammar.MOTIONS or draw(st.booleans()):
        return [name], {}
    return [name], {name: draw(damaged(grammar.MOTIONS[name].encode()))}


NO_FILE: st.SearchStrategy[Any] = st.just(([], {}))
# What a command line without a case would otherwise take long for.
ONE_RUN = "--duration 0.2 --ambient 0 --motion jra-ii-i-1 --bearing shen-hdr-bridge"
TWO_RUNS = "--ambient 0 --ambient 23 --motion motion.csv --bearing shen-hdr-bridge"
ONE_START = "--starts 1 --start shen-hdr-specimen"


def command_borders() -> list[Border]:
    raw = sheets.TEST.encode()
    record, table = st.just((["test.csv"], {"test.csv": raw})), _table(sheets.TEST, "t.csv")
    two = st.just((["other.csv", "test.csv"], {"other.csv": raw, "test.csv": raw}))
    case, study = _toml("cyclic_case"), _toml("earthquake_case")
    response = damaged(sheets.workbook()).map(lambda raw: (["t.xlsx"], {"t.xlsx": raw}))
    sheet = sheets.laboratory_files().flatmap(lambda text: _table(text, "t.csv"))
    words = st.lists(st.sampled_from([*WORDS, "cyclic", "motions", "-h"]), max_size=3)
    plain = st.one_of(
        _command("check", "", case, output=False),
        _command("measure", "file", _table(sheets.MEASURED, "m.csv"), output=False),
        _command("list", "", NO_FILE, output=False),
        words.map(lambda line: Example({}, lambda folder: run_command(line, folder), f"{line}")),
    )
    looks = [_command(f"motions {name}", "look", _motion()) for name in ("show", "spectrum")]
    return [
        Border("command", plain, 60),
        Border("command intake", _command("intake", "file", st.one_of(sheet, sheet, response)), 60),
        Border("command cyclic", _command("cyclic", "cyclic", case), 32),
        Border("command bridge", _command("bridge", "study bridge", study), 16),
        Border("command bridge, no case", _command("bridge", "study bridge", NO_FILE, ONE_RUN), 10),
        Border("command hybrid", _command("hybrid", "study hybrid", study), 16),
        Border("command motions", st.one_of(looks), 50),
        Border("command motions make", _command("motions make", "make", NO_FILE), 20),
        Border("command identify --check", _command("identify", "identify", table, "--check"), 40),
        Border("command identify", _command("identify", "identify", record, ONE_START), 10),
        Border(
            "command identify, tests held out", _command("identify", "held_out", two, ONE_START), 10
        ),
        Border(
            "command validate",
            _command("validate shen-hdr-specimen", "validate", st.one_of(record, table)),
            24,
        ),
        Border("command sequence", _command("sequence", "sequence", _toml("sequence_case")), 24),
        Border("command design", _command("design", "design", _toml("design_case")), 8),
        Border(
            "command lambda",
            _command("lambda shen-hdr-bridge", "lambda", NO_FILE, "--temperature 0"),
            10,
        ),
        Border("command bounds", _command("bounds", "bounds", NO_FILE, TWO_RUNS), 8),
    ]
