"""A study that is stopped in any way loses nothing and does nothing twice: real processes."""

import errno
import multiprocessing
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest

import thermobearing.studies.run.shard as peaks
from tests.unit.studies import kept, small_study
from thermobearing.border.errors import InputError, OutputError
from thermobearing.studies.run.engine import run_study, study_status
from thermobearing.studies.run.processes import PRELOADED
from thermobearing.studies.store import Store

needs_fork = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork, as POSIX has it")
PATIENCE = 120  # for what must come, however slow the machine [s]
WRITES = ("open", "os.rename", "os.mkdir", "os.remove", "os.rmdir")


def in_child(action: Callable[[], Any]) -> tuple[bool, str]:
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            action()
        except BaseException as error:
            os.write(writer, f"{type(error).__name__}: {error}".encode())
        finally:
            os._exit(0)
    os.close(writer)
    with os.fdopen(reader) as pipe:
        reported = pipe.read()
    return os.WIFSIGNALED(os.waitpid(child, 0)[1]), reported


@needs_fork
def test_killed_at_any_event(
    tmp_path: Path, small_files: dict[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    """SIGKILL when a file is opened, renamed or removed below the directory, one after the other.

    Each start goes on where the last was killed, and computes no run again that has its file.
    """
    out, study, last = tmp_path / "out", small_study(), ("", -1)
    run = peaks.run_task

    def counted(task: Any) -> Any:
        (tmp_path / "runs").open("a").write("x")
        return run(task)

    monkeypatch.setattr(peaks, "run_task", counted)

    def until(moment: int) -> None:
        count = 0

        def hook(name: str, details: tuple[Any, ...]) -> None:
            nonlocal count
            if name in WRITES and str(tmp_path) in str(details[0]) and "runs" not in str(details):
                count += 1
                if count == moment:
                    os.kill(os.getpid(), signal.SIGKILL)

        sys.addaudithook(hook)
        run_study(study, out, jobs=1, size=1)

    kills = 0
    for moment in (1, 3, 5, 8, 13, 18, 21, 26, 1000):
        done = study_status(out).done if (out / "manifest.json").exists() else 0
        before = len((tmp_path / "runs").read_text()) if (tmp_path / "runs").exists() else 0
        killed, reported = in_child(lambda moment=moment: until(moment))  # type: ignore[misc]
        assert not reported
        kills += killed
        after = study_status(out).done if (out / "manifest.json").exists() else 0
        computed = len((tmp_path / "runs").read_text()) - before if after else 0
        assert after >= done  # nothing is lost
        assert computed <= after - done + 1  # nothing is done twice but what had no file
        last = (reported, after)
    assert kills >= 6
    assert last == ("", 8)
    assert kept(out) == small_files
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".")] == []


def test_a_changed_bit_is_never_taken_for_a_result(
    tmp_path: Path, small_done: Path, small_files: dict[str, bytes]
) -> None:
    """A shard with one bit changed anywhere is not done; the next start computes it again."""
    out = shutil.copytree(small_done, tmp_path / "out")
    file = out / "shards" / "00003.parquet"
    content = file.read_bytes()
    for place in range(0, len(content), 61):
        changed = bytearray(content)
        changed[place] ^= 1 << place % 8
        file.write_bytes(changed)
        assert not Store(out)._is_done(3), place
    assert study_status(out).done == 7
    assert Store(out).table()["run"].tolist() == [0, 1, 2, 4, 5, 6, 7]
    plan = bytearray((out / "plan.parquet").read_bytes())
    plan[300] ^= 4
    (out / "plan.parquet").write_bytes(plan)
    assert run_study(small_study(), out, jobs=1, size=1).outcome == "completed"
    assert kept(out) == small_files


@needs_fork
def test_full_disk(tmp_path: Path, small_files: dict[str, bytes]) -> None:
    """The system refuses files of more than a few kB: those of shards are larger."""
    resource = pytest.importorskip("resource")
    out = tmp_path / "out"
    run_study(small_study(), out, jobs=1, size=1, shard="1/4")
    before = kept(out)

    def full() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (5_000, 5_000))
        run_study(small_study(), out, jobs=1, size=1)

    killed, reported = in_child(full)
    assert not killed
    assert "OutputError" in reported
    assert os.strerror(27) in reported
    assert kept(out) == before
    assert run_study(small_study(), out, jobs=1).outcome == "completed"
    assert kept(out) == small_files


def test_ctrl_c(
    tmp_path: Path, small_files: dict[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the middle of a run, in this process; then while separate processes are at work."""
    run, calls = peaks.run_task, []

    def interrupted(task: Any) -> Any:
        calls.append(task)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return run(task)

    monkeypatch.setattr(peaks, "run_task", interrupted)
    done = run_study(small_study(), tmp_path / "out", jobs=1, size=1)
    assert (done.outcome, done.done) == ("interrupted", 2)
    monkeypatch.setattr(peaks, "run_task", run)

    def third(done: int, _: int) -> None:
        if done == 3:
            raise KeyboardInterrupt

    done = run_study(small_study(), tmp_path / "out", jobs=2, progress=third)
    assert (done.outcome, done.done) == ("interrupted", 3)
    assert not multiprocessing.active_children()
    assert run_study(small_study(), tmp_path / "out", jobs=1).outcome == "completed"
    assert kept(tmp_path / "out") == small_files


def test_a_process_that_is_killed_is_replaced(
    tmp_path: Path, small_files: dict[str, bytes]
) -> None:
    killed = []

    def first(done: int, _: int) -> None:
        if done == 1:
            for one in multiprocessing.active_children():
                killed.append(one.pid)
                assert one.pid
                os.kill(one.pid, signal.SIGKILL)

    assert run_study(small_study(), tmp_path / "out", jobs=2, size=1, progress=first).done == 8
    assert len(killed) == 2
    assert kept(tmp_path / "out") == small_files


def test_processes_that_always_die_are_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # What a process does first breaks there, and the process with it.
    monkeypatch.setattr("thermobearing.studies.run.processes._set_up_process", divmod)
    with pytest.raises(OutputError, match="died 3 times in a row"):
        run_study(small_study(), tmp_path / "out", jobs=2, size=1)
    assert study_status(tmp_path / "out").done == 0


@pytest.mark.parametrize(
    "errors",
    [
        [OSError(errno.EBADF, "Bad file descriptor"), OSError("handle is closed")],
        [EOFError("unexpected EOF")],  # of the server that starts processes, which has ended
    ],
)
def test_a_pool_that_breaks_while_it_starts_a_process_is_replaced(
    errors: list[Exception],
    tmp_path: Path,
    small_files: dict[str, bytes],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # The pipes of the new process may be closed already by the thread that ends the pool.
    submit, errors = ProcessPoolExecutor.submit, list(errors)

    def submit_late(pool: ProcessPoolExecutor, *arguments: Any) -> Any:
        if errors:
            raise errors.pop()
        return submit(pool, *arguments)

    monkeypatch.setattr(ProcessPoolExecutor, "submit", submit_late)
    assert run_study(small_study(), tmp_path / "out", jobs=2, size=1).done == 8
    assert not errors
    assert kept(tmp_path / "out") == small_files


@pytest.mark.thorough
@pytest.mark.skipif(not Path("/proc").is_dir(), reason="looks at processes as Linux shows them")
def test_processes_end_with_the_one_that_made_them(
    tmp_path: Path, small_files: dict[str, bytes]
) -> None:
    """kill -9 of a real program in the middle of a study."""
    program = f"""
        import multiprocessing, time
        from tests.unit.studies import small_study
        from thermobearing.studies.run.engine import run_study

        def first(done, total):
            if done == 1:
                print(*[one.pid for one in multiprocessing.active_children()], flush=True)
                time.sleep({PATIENCE})

        if __name__ == "__main__":
            run_study(small_study(), {str(tmp_path / "out")!r}, jobs=2, size=1, progress=first)
    """
    (tmp_path / "program.py").write_text(dedent(program))
    here = Path(__file__).parents[2]
    command = [sys.executable, str(tmp_path / "program.py")]
    paths = [str(here), *filter(None, [os.environ.get("PYTHONPATH")])]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(paths)}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as running:
        assert running.stdout
        workers = [int(word) for word in running.stdout.readline().split()]
        running.kill()
    assert workers
    end = time.monotonic() + PATIENCE
    while any(_alive(worker) for worker in workers) and time.monotonic() < end:
        time.sleep(0.05)
    assert not any(_alive(worker) for worker in workers)
    assert study_status(tmp_path / "out").done >= 1
    assert run_study(small_study(), tmp_path / "out", jobs=1).outcome == "completed"
    assert kept(tmp_path / "out") == small_files


def _alive(process: int) -> bool:
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


@pytest.mark.thorough
def test_a_process_of_a_study_reads_only_what_it_runs_with() -> None:
    """Statistics and figures are of what is drawn from a study; they take longer to read."""
    code = f"import sys, {PRELOADED}; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = set(done.stdout.split())
    assert PRELOADED in loaded
    assert not loaded & {"scipy.stats", "scipy.optimize", "matplotlib", "distributed"}


def test_nobody_answers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("thermobearing.studies.run.shard.SCHEDULER_PATIENCE", 0.2)
    for address in ("tcp://127.0.0.1:9", "nonsense://x"):
        with pytest.raises(InputError, match=f'address "{address}": no Dask scheduler answers'):
            run_study(small_study(), tmp_path / "out", executor="dask", address=address)
    assert study_status(tmp_path / "out").done == 0


@pytest.mark.thorough
def test_dask(tmp_path: Path, small_files: dict[str, bytes]) -> None:
    """A real cluster: a worker is killed, the work goes on; the scheduler stops, all is kept."""
    import dask
    import distributed

    out = tmp_path / "out"
    with (
        dask.config.set({"distributed.worker.multiprocessing-method": "forkserver"}),
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=1, dashboard_address=None, host="127.0.0.1"
        ) as cluster,
    ):

        def stop(done: int, _: int) -> None:
            if done == 3:
                (worker,) = cluster.workers.values()
                os.kill(worker.pid, signal.SIGKILL)
            if done == 6:
                cluster.close()

        with pytest.raises(OutputError, match=r"scheduler has stopped|cluster was lost"):
            run_study(
                small_study(),
                out,
                executor="dask",
                address=cluster.scheduler_address,
                size=1,
                progress=stop,
            )
    assert 6 <= study_status(out).done < 8
    assert run_study(small_study(), out, jobs=1).outcome == "completed"
    assert kept(out) == small_files


def test_dask_by_a_client_of_the_user(tmp_path: Path, small_files: dict[str, bytes]) -> None:
    """Two threads of one process, which share nothing; the client goes on to be the user's."""
    import distributed

    with distributed.Client(
        processes=False, n_workers=1, threads_per_worker=2, dashboard_address=None
    ) as client:
        run_study(small_study(), tmp_path / "out", executor="dask", address=client, size=1)
        assert client.status == "running"
    assert kept(tmp_path / "out") == small_files


ENDLESS = """
import signal, time
from contextlib import closing
from thermobearing.studies.run.processes import call_on_processes, ended_by_sigterm

def work(shared, item):
    time.sleep(0.2)
    return item

if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.default_int_handler)
    with ended_by_sigterm(), closing(call_on_processes(work, None, range(9999), 2)) as all:
        for item, _ in all:
            print(item, flush=True)
"""


@needs_fork
@pytest.mark.parametrize("numbers", [(signal.SIGTERM,), (signal.SIGINT, signal.SIGINT)])
def test_an_interrupted_pool_ends_and_leaves_nothing(tmp_path: Path, numbers: Any) -> None:
    """Also if it is terminated, or interrupted again while its processes end."""
    script = tmp_path / "endless.py"
    script.write_text(ENDLESS)
    pipes: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen([sys.executable, str(script)], **pipes) as process:
        assert process.stdout is not None
        process.stdout.readline()
        for number in numbers:
            process.send_signal(number)
            time.sleep(0.1)
        try:
            _, errors = process.communicate(timeout=PATIENCE)
        finally:
            process.kill()
    terminated = signal.SIGTERM in numbers
    assert process.returncode == (128 + signal.SIGTERM if terminated else -signal.SIGINT)
    assert errors.count("KeyboardInterrupt") == (not terminated)
    assert "leaked" not in errors
