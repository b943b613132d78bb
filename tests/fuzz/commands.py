"""Command lines: every command with its options, right and wrong, in this process. No tests."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from hypothesis import strategies as st
from typer.testing import CliRunner, Result

from tests.fuzz import grammar, sheets
from tests.fuzz.borders import Border, beside
from tests.fuzz.judge import CLEAN, COMPLETED, TYPED, Example, check_numbers
from tests.fuzz.mutations import damaged, plain_numbers, rows_of_numbers, toml_files
from thermobearing.cli import app

NAMES = ["shen-hdr-specimen", "shen-lhdr-specimen", "bearing.toml", "shen-hdr-brige", "a.toml"]
MOTIONS = ["jra-ii-i-1", "motion.csv", "motion.at2", "motion.jma", "motion.knet", "jra-ii-i-9"]
WORDS = ["", "x", "nan", "-1", "0", "1e-308", "1e309", "inf", "²", "x" * 300, "--", "免震", "1,2",
         "-", "/dev/null", ".", "\udc80", "a\tb", "9" * 400]  # fmt: skip
TEMPERATURES = ["-20", "23", "0.5"]
Values = st.SearchStrategy[str]


@st.composite
def some(draw: st.DrawFn, *right: str) -> str:
    kind = draw(st.integers(0, 15))
    if kind == 15:
        return draw(st.sampled_from(WORDS))
    return repr(draw(plain_numbers())) if kind == 14 else draw(st.sampled_from(right))


CYCLIC: dict[str, Values] = {
    "--bearing": some(*NAMES), "--ambient": some(*TEMPERATURES), "--dt": some("0.1", "0.05"),
    "--scheme": some("published", "conservative"), "--integrator": some("euler", "exact"),
    "--heat-source": some("work", "dissipation"), "--keep-every": some("1", "3"),
    "--lead-ends": some("half-space", "finite-plate"),
    "--model": some("adiabatic", "bilinear", "per-cycle"),
}  # fmt: skip
STUDY: dict[str, Values] = {
    "--bearing": some(*NAMES, "shen-hdr-bridge", "shen-bilinear-bridge"),
    "--motion": some(*MOTIONS), "--ambient": some(*TEMPERATURES),
    "--structure": some("pier-p1", "hybrid-pier", "structure.toml"),
    "--method": some("linear-acceleration", "predictor-corrector"), "--dt": some("0.01", "0.02"),
    "--duration": some("0.1", "0.3"),
    "--damping": some("modal", "rayleigh", "element", "none", "source"),
}  # fmt: skip
BRIDGE = STUDY | {"--mass": some("consistent", "published"), "--weather": some("night.csv")}
HYBRID = STUDY | {
    "--mode": some("rt", "pd"), "--delay": some("0", "0.01"), "--force-noise": some("0", "0.5"),
    "--seed": some("0", "7"),
}  # fmt: skip
LOOK: dict[str, Values] = {
    "--unit": some("gal", "g"), "--dt": some("0.01"), "--component": some("NS", "1"),
    "--high-pass": some("0.5", "0.1"), "--type": some("I", "II"), "--ground": some("I", "III"),
}  # fmt: skip
MAKE: dict[str, Values] = {
    "--type": some("II"), "--ground": some("I", "II", "III"), "--seed": some("1", "77"),
    "--from": some("motion.csv", "motion.at2"), "--dt": some("0.02"),
    "--zone-factor": some("1", "0.7"), "--unit": some("gal"), "--component": some("NS"),
}  # fmt: skip
IDENTIFY: dict[str, Values] = {
    "--start": some("shen-hdr-specimen", "bearing.toml"),
    "--free": some("K_r", "K_r,d_y", "n_T=2.4*m_T,K_r", "K_r=2*K_r", "n_T=e*m_T"),
    "--method": some("least-squares", "krill-herd", "differential-evolution"),
    "--seed": some("1"), "--starts": some("1"),
    "--evaluations": some("40"), "--loss": some("huber", "linear"), "--predict": some("0"),
}  # fmt: skip
VALIDATE: dict[str, Values] = {
    "--compare-with": some(*NAMES), "--model": some("adiabatic", "lead-alone", "bilinear"),
    "--limit": some("K_eq=0.1", "NRMSE=1", "K_eg=1", "h_eq", "h_eq=15 %", "energy=nan"),
}  # fmt: skip
HELD_OUT: dict[str, Values] = {
    "--folds": some("2", "1", "99"), "--hold-out": some("test.csv", "none.csv", "a.toml"),
    "--limit": VALIDATE["--limit"], "--free": some("K_r"), "--loss": some("huber"),
}  # fmt: skip
SEQUENCE: dict[str, Values] = {
    "--bearing": some(*NAMES), "--ambient": some("0"), "--rig": some("shen-rig", "shen-rigg"),
}  # fmt: skip
DESIGN: dict[str, Values] = {
    "--start": some("150"), "--compound": some("G8", "G12"), "--kind": some("HDR", "HDR-S"),
    "--motion": some("motion.csv", "motion.at2"), "--weight": some("700"),
    "--tolerance": some("0.1"),
}  # fmt: skip
LAMBDA: dict[str, Values] = {
    "--reference": some("23"), "--temperature": some("0", "-20"), "--strain": some("1", "0.5"),
    "--period": some("2"), "--speed": some("100"), "--cycles": some("3", "1-3", "²,3", "1,2"),
}  # fmt: skip
BOUNDS: dict[str, Values] = {
    "--bearing": some("shen-hdr-bridge"), "--motion": some("motion.csv"),
    "--strain": some("1", "1.75"),
}  # fmt: skip
INTAKE: dict[str, Values] = {"--bearing": some(*NAMES)}
MEASURE: dict[str, Values] = {"--bearing": some(*NAMES)}


@st.composite
def _words(draw: st.DrawFn, options: dict[str, Values], most: int = 3) -> list[str]:
    words: list[str] = []
    for _ in range(draw(st.integers(0, most)) if options else 0):
        name = draw(st.sampled_from(sorted(options)))
        words += [name, draw(options[name])]
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
    status, told = done.exit_code, done.output + done.stderr
    assert status in (0, 2, 3, 4), f"status {status}"
    for piece in ("Traceback", "Exception ignored", "Warning:", "not enough memory"):
        assert piece not in told, f"{piece!r} was printed: {told[-300:]}"
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
    """A refusal is told on stderr and leaves nothing, but for the report of refused tests."""
    if "--check" in words and any(name.endswith("summary.json") for name in new):
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
    name: list[str],
    options: dict[str, Values],
    files: st.SearchStrategy[tuple[list[str], dict[str, bytes]]],
    fixed: tuple[str, ...] = (),
    output: bool = True,
) -> Example:
    arguments, given = draw(files)
    words = [*name, *arguments, *fixed, *draw(_words(options))]
    words += draw(_output()) if output else (["--json"] if draw(st.booleans()) else [])
    named = " ".join(words).encode("utf-8", "replace")
    content = {**beside(named + b"".join(given.values())), **given}
    call: Callable[[Path], str] = lambda folder: run_command(words, folder)  # noqa: E731
    about = f"{words} with {[raw[:400] for raw in given.values()]}"
    return Example(content, call, about)


def _no_file() -> st.SearchStrategy[Any]:
    return st.just(([], {}))


def _toml(tables: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    return tables.flatmap(lambda table: toml_files(table, calm=True)).map(
        lambda raw: (["a.toml"], {"a.toml": raw})
    )


def _table(text: str, name: str) -> st.SearchStrategy[Any]:
    return rows_of_numbers(text).map(lambda raw: ([name], {name: raw}))


@st.composite
def _motion(draw: st.DrawFn) -> Any:
    name = draw(st.sampled_from([*sorted(grammar.MOTIONS), "jra-ii-i-1", "no-such", "x" * 300]))
    if name not in grammar.MOTIONS or draw(st.booleans()):
        return [name], {}
    return [name], {name: draw(damaged(grammar.MOTIONS[name].encode()))}


SHORT = ("--dt", "0.1")  # what a command line without a case would otherwise take long for
ONE_RUN = ("--duration", "0.2", "--ambient", "0", "--motion", "jra-ii-i-1", "--bearing",
           "shen-hdr-bridge")  # fmt: skip
TWO_RUNS = ("--ambient", "0", "--ambient", "23", "--motion", "motion.csv", "--bearing",
            "shen-hdr-bridge")  # fmt: skip


def command_borders() -> list[Border]:
    record = st.just((["test.csv"], {"test.csv": sheets.TEST.encode()}))
    judged = st.one_of(record, _table(sheets.TEST, "t.csv"))
    sequences = _toml(grammar.sequence_cases())
    case = _toml(grammar.cyclic_cases())
    study = _toml(grammar.earthquake_cases())
    files = {
        "check": _command(["check"], {}, _toml(grammar.cyclic_cases()), output=False),
        "measure": _command(["measure"], MEASURE, _table(sheets.MEASURED, "m.csv"), output=False),
        "list": _command(["list"], {}, _no_file(), output=False),
        "none": st.lists(st.sampled_from([*WORDS, "cyclic", "motions", "-h"]), max_size=3).map(
            lambda words: Example({}, lambda folder: run_command(words, folder), f"{words}")
        ),
    }
    looked = ["show", "spectrum"]
    books = damaged(sheets.workbook()).map(lambda raw: (["t.xlsx"], {"t.xlsx": raw}))
    tables = sheets.laboratory_files().flatmap(lambda text: _table(text, "t.csv"))
    return [
        Border("command", st.one_of(*files.values()), 60),
        Border(
            "command intake", _command(["intake"], INTAKE, st.one_of(tables, tables, books)), 60
        ),
        Border("command cyclic", _command(["cyclic"], CYCLIC, case), 32),
        Border("command bridge", _command(["bridge"], BRIDGE, study), 16),
        Border("command bridge, no case", _command(["bridge"], BRIDGE, _no_file(), ONE_RUN), 10),
        Border("command hybrid", _command(["hybrid"], HYBRID, study), 16),
        Border(
            "command motions",
            st.one_of(*(_command(["motions", name], LOOK, _motion()) for name in looked)),
            50,
        ),
        Border("command motions make", _command(["motions", "make"], MAKE, _no_file()), 20),
        *_fit_borders(),
        Border("command validate", _command(["validate", NAMES[0]], VALIDATE, judged), 24),
        Border("command sequence", _command(["sequence"], SEQUENCE, sequences), 24),
        Border("command design", _command(["design"], DESIGN, _toml(grammar.design_cases())), 8),
        Border(
            "command lambda",
            _command(["lambda", "shen-hdr-bridge"], LAMBDA, _no_file(), ("--temperature", "0")),
            10,
        ),
        Border("command bounds", _command(["bounds"], BOUNDS, _no_file(), TWO_RUNS), 8),
    ]


def _fit_borders() -> list[Border]:
    """Those of `identify`."""
    record = st.just((["test.csv"], {"test.csv": sheets.TEST.encode()}))
    held = {"test.csv": sheets.TEST.encode(), "other.csv": sheets.TEST.encode()}
    two = st.just((sorted(held), held))
    return [
        Border(
            "command identify --check",
            _command(["identify"], IDENTIFY, _table(sheets.TEST, "t.csv"), ("--check",)),
            40,
        ),
        Border(
            "command identify",
            _command(
                ["identify"], IDENTIFY, record, ("--starts", "1", "--start", "shen-hdr-specimen")
            ),
            10,
        ),
        Border(
            "command identify, tests held out",
            _command(
                ["identify"], HELD_OUT, two, ("--starts", "1", "--start", "shen-hdr-specimen")
            ),
            10,
        ),
    ]
