"""The command report, and the options of analyses: what is written, kept, refused; nothing half."""

import errno
import os
import re
import shutil
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest

import thermobearing as tb
import thermobearing.reporting as files
from tests.unit.inputs import assert_refused, command, content, cyclic, last_line, quick_case
from tests.unit.report_pieces import EVIL, LOGO, saved_directory
from tests.unit.test_killed_and_together import killed
from thermobearing.border.title import read_title
from thermobearing.results.directory import check_target
from thermobearing.results.saved import SavedResult

WITH_OPTIONS = {"cyclic", "bridge", "hybrid", "sequence", "validate", "identify", "design"}
WITH_OPTIONS |= {"lambda", "bounds", "motions show"}


@pytest.fixture
def saved(tmp_path: Path) -> Path:
    return saved_directory(tmp_path / "out")


@pytest.fixture(scope="module")
def reported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = saved_directory(tmp_path_factory.mktemp("reported") / "out")
    assert command("report", folder, "--xlsx", "--title", "project=First").exit_code == 0
    return folder


@pytest.fixture
def earlier(reported: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(reported, tmp_path / "out"))


def test_overwrite_is_accepted(earlier: Path) -> None:
    assert command("report", earlier, "--overwrite", "-q", "--no-pdf").exit_code == 0


def test_a_document_of_a_directory(saved: Path) -> None:
    done = command("report", saved, "--xlsx", "--title", f"project={EVIL}", "--json")
    assert done.exit_code == 0
    names = ["report.html", "report.pdf", "report.xlsx"]
    assert re.findall(r"written: .*/(\S+) \(", done.stdout) == names
    assert [Path(file).name for file in last_line(done)["files"]] == names
    assert {path.name for path in saved.iterdir()} == {
        *(*names, "report.toml", "summary.json", "table.csv")
    }
    assert "evil" in (saved / "report.html").read_text(encoding="utf-8")
    assert isinstance(tb.load_result(saved), SavedResult)
    check_target(saved, overwrite=True)


def test_the_title_block_is_kept_and_said_again(earlier: Path, tmp_path: Path) -> None:
    (tmp_path / "logo.svg").write_bytes(LOGO)
    words = ["--title", f"logo={tmp_path / 'logo.svg'}", "--title", "revision=B"]
    words += ["--title", "checked=K. Sato"]
    assert command("report", earlier, "-q", "--no-pdf", *words).exit_code == 0
    (tmp_path / "logo.svg").unlink()  # a copy is next to the document
    kept = tomllib.loads((earlier / "report.toml").read_text())["report"]
    assert kept == {
        "project": "First", "checked": "K. Sato", "revision": "B", "logo": "report-logo",
    }  # fmt: skip
    first = (earlier / "report.html").read_bytes()
    assert command("report", earlier, "-q", "--no-pdf").exit_code == 0
    assert (earlier / "report.html").read_bytes() == first
    assert read_title(earlier / "report.toml").logo_bytes() == LOGO


def test_without_pdf_an_earlier_one_goes(earlier: Path) -> None:
    assert command("report", earlier, "--no-pdf", "-q").exit_code == 0
    assert not (earlier / "report.pdf").exists()
    assert (earlier / "report.xlsx").exists()


@pytest.mark.parametrize(
    ("words", "piece"),
    [
        (["--title", "clint=me"], 'did you mean "client"'),
        (["--title", "client"], "KEY=VALUE"),
        (["--title", "client=a", "--title", "client=b"], "more than once"),
        (["--title", "client="], "must not be empty"),
        (["--title", "logo=nothing.png"], "no such file"),
        (["--title", f"logo={__file__}"], "PNG or an SVG"),
        (["--template", "nothing.md"], "no such file"),
        (["--template", __file__], "a placeholder must be alone on its line"),
    ],
)
def test_what_is_wrong_is_reported_and_nothing_is_touched(
    words: list[str], piece: str, earlier: Path, tmp_path: Path
) -> None:
    before = content(tmp_path)
    done = command("report", earlier, *words)
    assert done.exit_code == 2
    assert piece in done.stderr
    assert done.stderr.startswith("thermobearing: ")
    assert content(tmp_path) == before


@pytest.mark.parametrize(
    ("harm", "piece"),
    [
        (shutil.rmtree, "is not a directory"),
        (lambda folder: (folder / "summary.json").unlink(), "no result.nc"),
        (lambda folder: (folder / "summary.json").write_text("{"), "is not valid JSON"),
        (lambda folder: (folder / "summary.json").write_text("[1]"), "has no command"),
        (lambda folder: (folder / "table.csv").write_bytes(b'"\x00\xff'), "table.csv"),
        (lambda folder: (folder / "result.nc").write_bytes(b"no"), "is not a result file"),
        (lambda folder: (folder / "report.toml").write_text("[report"), "report.toml"),
        (lambda folder: (folder / "report.toml").write_text("[report]\nlogo = 'x'"), "no such"),
    ],
    ids=["gone", "no summary", "cut", "foreign", "table", "dataset", "title", "logo"],
)
def test_damaged_directories_are_reported_in_one_message(
    harm: Any, piece: str, earlier: Path, tmp_path: Path
) -> None:
    harm(earlier)
    before = content(tmp_path)
    done = command("report", earlier, "--json")
    assert done.exit_code == 2
    assert piece in done.stderr
    assert last_line(done)["exit_status"] == 2
    assert content(tmp_path) == before
    assert [path.name for path in tmp_path.iterdir()] in (["out"], [])


def test_a_directory_in_the_place_of_a_document(saved: Path, tmp_path: Path) -> None:
    (saved / "report.html").mkdir()
    (saved / "report.html" / "thesis.tex").write_text("years of work")
    before = content(tmp_path)
    done = command("report", saved)
    assert done.exit_code == 2
    assert "report.html: is a directory" in done.stderr
    assert content(tmp_path) == before


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_a_full_disk_leaves_what_was_there(
    number: int, earlier: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before, count, whole = content(tmp_path), 0, files.write_through

    def full(file: Path, raw: bytes) -> None:
        nonlocal count
        count += 1
        if count == number:
            file.write_bytes(raw[: len(raw) // 2])
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        whole(file, raw)

    monkeypatch.setattr(files, "write_through", full)
    with pytest.raises(tb.OutputError, match="No space left on device"):
        files.put_files(earlier, dict.fromkeys(files.WRITTEN, b"new"))
    assert content(tmp_path) == before
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


@pytest.mark.parametrize("stop", [1, 2, 3])
def test_an_exchange_that_is_stopped_goes_back(
    stop: int, earlier: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before, count, replace = content(tmp_path), 0, os.replace

    def stopped(old: Any, new: Any) -> None:
        nonlocal count
        count += 1
        if count == stop:
            raise KeyboardInterrupt
        replace(old, new)

    monkeypatch.setattr(os, "replace", stopped)
    with pytest.raises(KeyboardInterrupt):
        files.put_files(earlier, dict.fromkeys(files.WRITTEN, b"new"))
    assert content(tmp_path) == before


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork, as POSIX has it")
def test_a_kill_at_any_moment_leaves_whole_files(tmp_path: Path) -> None:
    """Each document is the earlier or the later one; other files left over are removed."""
    out = tmp_path / "out"
    moment, ended = 1, False
    while not ended:
        shutil.rmtree(out, ignore_errors=True)
        out.mkdir()
        for name in files.WRITTEN[:3]:
            (out / name).write_bytes(b"old")
        ended = not killed(
            lambda: files.put_files(out, dict.fromkeys(files.WRITTEN[:3], b"new")), moment
        )
        assert set(content(out).values()) <= {b"old", b"new"}
        assert set(content(out)) == set(files.WRITTEN[:3])
        moment += 6  # each is a process
    assert moment > 30
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_every_analysing_command_has_the_options() -> None:
    from tests.unit.test_help import COMMANDS

    options = {"--report", "--xlsx", "--title", "--template"}
    result = {
        " ".join(words)
        for words, item in COMMANDS.items()
        if options <= {name for p in item.params for name in p.opts}
    }
    assert result >= WITH_OPTIONS


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("run")
    title = {"project": "Bridge 12", "logo": "mine.svg"}
    (folder / "mine.svg").write_bytes(LOGO)
    case = quick_case(folder / "case.toml", report=title)
    done = cyclic(case, "-o", folder / "out", "--report", "--xlsx", "--title", "number=7")
    assert done.exit_code == 0
    assert done.stdout.splitlines()[-1].endswith("; report.html, report.pdf, report.xlsx")
    return folder


def test_a_run_with_a_report(run: Path) -> None:
    kept = tomllib.loads((run / "out" / "report.toml").read_text())["report"]
    assert kept == {"project": "Bridge 12", "number": "7", "logo": "report-logo"}
    assert (run / "out" / "report.pdf").read_bytes().startswith(b"%PDF")
    assert tb.load_result(run / "out").outcome == "completed"


@pytest.mark.thorough
def test_a_document_made_later_has_the_same_bytes(run: Path, tmp_path: Path) -> None:
    """From the directory or its result.nc, by the command or in Python, nothing being run."""
    before = content(run / "out")
    assert command("report", run / "out" / "result.nc", "-q").exit_code == 0
    assert content(run / "out") == before
    tb.make_report(tb.load_result(run / "out"), run / "out", workbook=True)
    assert content(run / "out") == before


def test_the_title_block_changes_no_bit_of_a_run(run: Path, tmp_path: Path) -> None:
    cyclic(quick_case(tmp_path / "case.toml"), "-o", tmp_path / "out", "-q")
    plain = content(tmp_path / "out")
    assert {name: content(run / "out")[name] for name in plain} == plain


def test_a_title_block_of_a_case_is_kept_without_a_report(run: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert cyclic(run / "case.toml", "-o", out, "-q").exit_code == 0
    assert read_title(out / "report.toml").project == "Bridge 12"
    assert not (out / "report.html").exists()


@pytest.mark.parametrize(
    ("table", "piece"),
    [
        ({"projct": "x"}, 'unknown key "projct"; did you mean "project"?'),
        ({"number": 7}, "report: number = 7: must be text"),
        ({"logo": "gone.png"}, "gone.png: no such file"),
        ("Bridge", "expected a table"),
    ],
)
def test_a_wrong_title_block_is_reported_before_the_run(
    table: Any, piece: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("thermobearing.cyclic.history.march", lambda *_: pytest.fail("it was run"))
    case = quick_case(tmp_path / "case.toml", report=table)
    done = cyclic(case, "-o", tmp_path / "out", "--report")
    assert done.exit_code == 2
    assert piece in done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("module", "option"),
    [("typst", "--report"), ("jinja2", "--report"), ("openpyxl", "--xlsx"), ("jinja2", "--xlsx")],
)
def test_what_is_not_installed_is_reported_before_the_run(
    module: str, option: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    done = cyclic(quick_case(tmp_path / "case.toml"), "-o", tmp_path / "out", option)
    assert done.exit_code == 2
    assert 'pip install "thermobearing[report]"' in done.stderr
    assert not (tmp_path / "out").exists()


def test_a_report_that_cannot_be_written_leaves_the_result(tmp_path: Path) -> None:
    (tmp_path / "mine.md").write_text("{{ figure nothing }}")
    case, out = quick_case(tmp_path / "case.toml"), tmp_path / "out"
    done = cyclic(case, "-o", out, "--report", "--template", tmp_path / "mine.md")
    assert done.exit_code == 2
    assert f"the result is in {out}" in done.stderr
    assert tb.load_result(out).outcome == "completed"
    assert not (out / "report.html").exists()


@pytest.mark.parametrize(
    ("words", "piece"),
    [
        (["cyclic", "--title", "client=me"], "--report"),
        (["motions", "show", "jra-ii-i-1", "--report"], "-o"),
    ],
)
def test_options_that_make_nothing_are_refused(words: list[str], piece: str) -> None:
    done = command(*words)
    assert done.exit_code == 2
    assert piece in done.stderr


def test_python_wants_a_place_for_a_live_result(tmp_path: Path) -> None:
    result = tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1, dt=0.05), ambient=5)
    assert_refused(lambda: tb.make_report(result), "save the result first")
    assert_refused(lambda: tb.make_report(tmp_path, title={"projct": "x"}), "projct")


def test_files_that_do_not_fit_together_are_reported(
    saved: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def unfit(_: object) -> None:
        raise KeyError("bearing")

    monkeypatch.setattr("thermobearing.reporting.pieces_of_saved", unfit)
    assert_refused(lambda: tb.make_report(saved), str(saved), "'bearing'")
