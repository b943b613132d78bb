"""Clients that hold others up, servers that fail or are killed: who is served, and what is kept."""

import errno
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

import thermobearing as tb
from tests.unit.test_served import (
    LIMIT,
    ONE,
    PATH,
    Client,
    Running,
    assert_only_nan,
    case,
    expected,
)
from thermobearing.opensees import recording
from thermobearing.opensees import server as server_module
from thermobearing.opensees.case import Layout
from thermobearing.opensees.element import ServedElement
from thermobearing.opensees.recording import Journal, Served
from thermobearing.opensees.server import LOOPBACK, Limits, Server
from thermobearing.opensees.wire import Action, Request, decode_reply, receive_exactly


def stream(client: Client, count: int) -> bytes:
    """Trials and commits of a client that waits for nothing."""
    v = [0.0, 1.0]
    requests = [
        Request(action, [0.0, 1.0 + k % 2], v, [0.0, 0.0], 0.01 * (1 + k))
        for k in range(count)
        for action in (Action.SET_TRIAL, Action.COMMIT)
    ]
    return b"".join(request.encode(client.setup) for request in requests)


def test_a_stream_of_messages_holds_nobody_up() -> None:
    """Others are answered, and the keeper has its signs of life, before it is carried out."""
    keeper = Mock()
    server = Server(case(), lambda text: None, keeper, limits=Limits(tick=0.01))
    port = server.listen(ONE, None, LOOPBACK, 0)
    steps = 3000
    greedy, honest = Client(port), Client(port)
    sender = threading.Thread(
        target=greedy.socket.sendall, args=(stream(greedy, steps),), daemon=True
    )
    sender.start()
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    assert [honest.step(x, t) for t, x in PATH] == expected(PATH)
    # The first history is that of the greedy client, which has not come far.
    carried_out = server._open[next(iter(server._open))].element
    assert carried_out is not None
    assert carried_out._time < 0.01 * steps
    assert keeper.report_progress.called
    sender.join(LIMIT)
    server.stopped = True
    thread.join(LIMIT)
    server.close()
    greedy.socket.close()
    honest.socket.close()


def test_a_turn_has_few_messages() -> None:
    server = Server(case(), lambda text: None, limits=Limits(messages=3))
    client = Client(server.listen(ONE, None, LOOPBACK, 0))
    client.socket.sendall(stream(client, 50))
    (accept,) = server._listeners.values()
    accept()
    (connection,) = server._open.values()
    assert server._serve_turn(connection)
    (history,) = server.histories()
    assert len(history.time) <= 1 + 3
    assert connection in server._backlog
    client.socket.close()
    server.close()


def test_a_client_that_does_not_read_holds_nobody_up() -> None:
    """It receives NaN after a time, and is disconnected after another; others go on."""
    limits = Limits(reading_time=0.2, closing_time=0.1, tick=0.02, nan_pause=0.01)
    running = Running(case(), limits=limits)
    deaf = Client(running.port, size=65536)
    deaf.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 14)
    honest = Client(running.port)
    request = Request(Action.FORCE, [0.0, 0.0], [0.0, 0.0], [0.0, 0.0], 0.0).encode(deaf.setup)

    def _ask_without_reading() -> None:
        with suppress(OSError):
            while True:
                deaf.socket.sendall(request)

    asking = threading.Thread(target=_ask_without_reading, daemon=True)
    asking.start()
    assert [honest.step(x, t) for t, x in PATH] == expected(PATH)
    assert "has not read" in running.wait_for_problem()
    asking.join(LIMIT)
    assert not asking.is_alive()  # the connection was closed
    assert running.server.clients == (1, 2)
    honest.end()
    deaf.socket.close()
    running.stop()


def test_an_answer_that_waits_is_sent_when_it_is_read() -> None:
    """A reader that is slow has every bit of its answers."""
    running = Running(case())
    slow = Client(running.port, size=65536)
    slow.send(Action.SET_TRIAL, [0.0, 3.0], 0.1)
    count = 20

    def _ask() -> None:
        for _ in range(count):
            slow.send(Action.FORCE, [0.0, 3.0], 0.1)

    asking = threading.Thread(target=_ask, daemon=True)
    asking.start()
    end = time.monotonic() + LIMIT
    while not any(c.outgoing for c in list(running.server._open.values())):
        assert time.monotonic() < end
        time.sleep(0.01)
    for _ in range(count):
        reply = receive_exactly(slow.socket, slow.setup.length, LIMIT)
        assert decode_reply(reply, Action.FORCE, slow.setup)[1] == expected([(0.1, 3.0)])[0]
    asking.join(LIMIT)
    slow.end()
    assert not running.stop().problems


def test_without_descriptors_the_listener_waits(monkeypatch: pytest.MonkeyPatch) -> None:
    """As with a full table of files: accept fails at once, and the client stays in the queue."""
    server = Server(case(), lambda text: None, limits=Limits(accept_pause=0.2, tick=0.02))
    port = server.listen(ONE, None, LOOPBACK, 0)
    refused = 0

    def _accept(self: socket.socket) -> Any:
        nonlocal refused
        if refused < 2:
            refused += 1
            raise OSError(errno.EMFILE, "Too many open files")
        return accept(self)

    accept = socket.socket.accept
    monkeypatch.setattr(socket.socket, "accept", _accept)
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    begun = time.monotonic()
    client = Client(port)
    assert client.step(3.0, 0.1) == expected([(0.1, 3.0)])[0]
    assert time.monotonic() - begun >= 2 * 0.2
    assert len(server.notes) == 1
    client.end()
    server.stopped = True
    thread.join(LIMIT)
    server.close()


def test_an_error_of_one_bearing_is_not_that_of_others(monkeypatch: pytest.MonkeyPatch) -> None:
    running = Running(case())
    client, other = Client(running.port), Client(running.port)
    assert client.step(3.0, 0.1) > 0.0
    answer = ServedElement.answer

    def _answer(self: ServedElement, request: Request) -> Any:
        if request.displacement[1] == 99.0:
            raise ZeroDivisionError
        return answer(self, request)

    monkeypatch.setattr(ServedElement, "answer", _answer)
    assert np.isnan(client.force(99.0, 0.2))
    assert [other.step(x, t) for t, x in PATH] == expected(PATH)
    other.end()
    client.socket.close()
    server = running.stop()
    assert len(server.problems) == 1
    assert sorted(len(history.time) for history in server.histories()) == [2, 1 + len(PATH)]


def test_histories_leave_memory_and_keep_their_bits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Read from the file, from the file while it is written, and from memory alone."""
    monkeypatch.setattr(recording, "ROWS_IN_MEMORY", 2)
    with (tmp_path / "journal").open("w+b") as file:
        journal = Journal(file)
        written, in_memory = (
            ServedElement(case(), Layout.of(1, (1, 2), None, "test"), 1, journal=kept)
            for kept in (journal, None)
        )
        for element in (written, in_memory):
            for _ in range(2):  # a gravity stage, which leaves no history
                u, at_rest = (0.0,) * 4, (0.0,) * 4
                element.answer(Request(Action.SET_TRIAL, u, at_rest, at_rest, 1.0))
                element.answer(Request(Action.COMMIT, u, at_rest, at_rest, 1.0))
            element.reset()
            for t, x in PATH:
                u = (0.0, 0.0, 0.6 * x, 0.8 * x)
                element.answer(Request(Action.SET_TRIAL, u, (1.0,) * 4, at_rest, t))
                element.answer(Request(Action.COMMIT, u, (), (), t))
        assert all(len(kept._rows) < 2 for kept in written._recordings)
        same = in_memory.histories()
        assert_same(written.histories(), same)
        written.flush()
        assert_same(journal.histories(), same)
        file.write(b"\x80\x05half a part")  # as a process leaves it that is killed
        assert_same(Journal(file).histories(), same)


def assert_same(histories: list[Served], others: list[Served]) -> None:
    assert len(histories) == len(others) > 0
    for history, other in zip(histories, others, strict=True):
        for mine, its in zip(history, other, strict=True):
            np.testing.assert_equal(mine, its)


def test_a_full_disk_leaves_histories_in_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recording, "ROWS_IN_MEMORY", 2)
    file = Mock(write=Mock(side_effect=OSError(errno.ENOSPC, "No space left on device")))
    running = Running(case(), journal=Journal(file), limits=Limits(tick=0.01))
    client = Client(running.port)
    assert [client.step(x, t) for t, x in PATH] == expected(PATH)
    client.end()
    (history,) = running.stop().histories()
    assert history.response["force"][1:].tolist() == expected(PATH)
    assert len(running.server.notes) == 1


KILLED = """
import os, signal, sys
from thermobearing.opensees.case import Layout, make_served_case
from thermobearing.opensees.result import ServedResult
from thermobearing.opensees.server import LOOPBACK, Server, serve_until

def run_until_moved(self, done):
    moved = lambda: any(len(history.time) > 1 for history in self.histories())
    run(self, lambda: moved() and os.kill(os.getpid(), signal.SIGKILL))

run, Server.run = Server.run, run_until_moved
case = make_served_case({}, "test", bearing="shen-hdr-bridge", ambient=-20)
result = lambda histories: ServedResult.of(case, histories, ["killed"])
save = lambda histories: result(histories).save(sys.argv[1], figures=False)
show = lambda message: print(message, flush=True)
serve_until(case, Layout(1, (1,), (1,), None), LOOPBACK, 0, once=False, show=show, save=save)
"""


def test_a_killed_command_has_its_histories_saved(tmp_path: Path) -> None:
    words = [sys.executable, "-c", KILLED, str(tmp_path / "out")]
    killed = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert killed.stdout is not None
    port = re.search(r"port (\d+)", killed.stdout.readline())
    assert port is not None
    client = Client(int(port[1]))
    force = client.step(3.0, 0.1)
    assert killed.wait(LIMIT) == -signal.SIGKILL
    assert_only_nan(client)
    client.socket.close()
    killed.communicate(timeout=LIMIT)
    result = tb.load_result(tmp_path / "out")
    assert result.outcome == "connection_failed"
    assert result["force"].values[0].tolist() == [0.0, force]


def test_a_server_that_fails_returns_its_histories(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server_module, "load_kernels", Mock())
    monkeypatch.setattr(Server, "run", Mock(side_effect=MemoryError))
    server = server_module.serve_until(case(), ONE, LOOPBACK, 0, once=True, show=lambda text: None)
    assert server.stopped
    assert len(server.problems) == 1


def test_problems_do_not_fill_the_memory() -> None:
    server = Server(case(), lambda text: None)
    for number in range(3 * server_module.MAX_PROBLEMS):
        server.fail(f"element {number}: a port is scanned")
    assert len(server.problems) == server_module.MAX_PROBLEMS + 1
    server.close()
