"""Runs that are killed, and runs that write to the same place at the same time."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

import thermobearing.results.directory as directory
from tests.quick import quick_cases
from tests.unit.inputs import content, cyclic, quick_case, summary
from thermobearing.border.errors import OutputError
from thermobearing.border.text_file import write_through
from thermobearing.results.directory import write_directory

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork, as POSIX has it")
MOMENTS = 50  # at least
TraceFunction = Callable[[FrameType, str, Any], Any]
NO_FILES = ("os.kill", "os.putenv", "os.unsetenv")
NEW_SIBLING, PUT_IN_PLACE = directory.new_sibling, directory._put_in_place
EARLIER, LATER = 23.0, 5.0  # ambient temperatures that tell two results apart


def killed(action: Callable[[], object], moment: int) -> bool:
    """Fork, act, and die by SIGKILL at the event of that number; whether it came to that.

    Events are files opened, folders made, renamed and removed (Python audits them), and every
    second line of the module that puts a result in its place.
    """
    child = os.fork()
    if child == 0:
        count = 0.0

        def event(steps: float = 1.0) -> None:
            nonlocal count
            count += steps
            if count >= moment:
                os.kill(os.getpid(), signal.SIGKILL)

        def hook(name: str, _: object) -> None:
            if name.split(".")[0] in ("open", "os", "shutil") and name not in NO_FILES:
                event()

        def line(_: FrameType, kind: str, __: object) -> TraceFunction:
            if kind == "line":
                event(0.5)
            return line

        def call(frame: FrameType, _: str, __: object) -> TraceFunction | None:
            return line if frame.f_code.co_filename == directory.__file__ else None

        @contextmanager
        def sibling(final: Path) -> Iterator[Path]:
            sys.settrace(call)
            with NEW_SIBLING(final) as partial:
                sys.settrace(None)
                try:
                    yield partial
                finally:
                    sys.settrace(call)
            sys.settrace(None)

        def put(*given: Any) -> None:
            sys.settrace(call)
            PUT_IN_PLACE(*given)
            sys.settrace(None)

        # Lines are looked at inside of these two alone: a trace of the whole run takes as long
        # as the run.
        directory.new_sibling, directory._put_in_place = sibling, put
        sys.addaudithook(hook)
        try:
            action()
        finally:
            os._exit(0)
    return os.WIFSIGNALED(os.waitpid(child, 0)[1])


@pytest.mark.thorough
def test_a_killed_run_loses_no_earlier_result(tmp_path: Path) -> None:
    case, out = quick_case(tmp_path / "case.toml"), tmp_path / "out"

    def run(ambient: float) -> int:
        words = (case, "-o", out, "-q", "--overwrite", "--no-figures", "--ambient", ambient)
        return cyclic(*words).exit_code

    assert run(EARLIER) == 0
    files = sorted(content(out))
    seen, moment = set(), 1
    while killed(lambda: run(LATER), moment):
        moment += 1
        seen.add(summary(out)["runs"][0]["ambient_degC"])
        assert sorted(content(out)) == files
        left = [path.name for path in tmp_path.iterdir() if path.name.startswith(".")]
        assert len(left) <= 1  # what the runs before had left is gone
    assert moment > MOMENTS
    assert sorted(path.name for path in tmp_path.iterdir()) == ["case.toml", "out"]
    assert seen == {EARLIER, LATER}  # killed before the swap, and after it


def test_a_file_is_flushed_before_it_is_synchronized(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sizes: list[int] = []
    monkeypatch.setattr(os, "fsync", lambda number: sizes.append(os.fstat(number).st_size))
    write_through(tmp_path / "file", b"three")
    assert sizes == [5]


def filled(folder: Path) -> None:
    (folder / "summary.json").write_text("{}")


@pytest.mark.parametrize("every", [5, pytest.param(1, marks=pytest.mark.thorough)])
@pytest.mark.parametrize("exchange", quick_cases([True, False], 0))
def test_killed_between_two_renames(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, exchange: bool, every: int
) -> None:
    """The events of the swap, also where the system cannot swap in one step."""
    if not exchange:
        monkeypatch.setattr(directory, "_exchange", lambda *_: False)
    out = tmp_path / "out"
    write_directory(out, filled)

    def run() -> Path:
        return write_directory(out, filled, overwrite=True)

    moment = 1
    while killed(run, moment):
        moment += every
        run()
        assert [path.name for path in tmp_path.iterdir()] == ["out"]
        assert list(content(out)) == ["summary.json"]


def test_a_run_that_still_writes_is_left_alone(tmp_path: Path) -> None:
    out = tmp_path / "out"

    def slow(folder: Path) -> None:
        (folder / "summary.json").write_text("slow")
        write_directory(out, filled)  # another one begins and ends meanwhile

    with pytest.raises(OutputError, match="--overwrite"):
        write_directory(out, slow)
    assert (out / "summary.json").read_text() == "{}"
    write_directory(out, lambda folder: slow_with_force(folder, out), overwrite=True)
    assert (out / "summary.json").read_text() == "slow"
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def slow_with_force(folder: Path, out: Path) -> None:
    (folder / "summary.json").write_text("slow")
    write_directory(out, filled, overwrite=True)


WRITER = """
import sys
from pathlib import Path
from thermobearing.results.directory import write_directory
for number in range(200):
    write_directory(
        Path(sys.argv[1]), lambda f: (f / "summary.json").write_text(sys.argv[2]), overwrite=True
    )
    text = (Path(sys.argv[1]) / "summary.json").read_text()
    assert text in "AB", text
"""


def test_two_processes_with_one_target(tmp_path: Path) -> None:
    """Both end well, whoever is last; at every moment there is a whole result."""
    out = tmp_path / "out"
    write_directory(out, filled)
    both = [
        subprocess.Popen(
            [sys.executable, "-c", WRITER, str(out), name], stderr=subprocess.PIPE, text=True
        )
        for name in "AB"
    ]
    output = [process.communicate()[1] for process in both]
    assert [process.returncode for process in both] == [0, 0], output
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
