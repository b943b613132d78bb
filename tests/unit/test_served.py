"""Served bearings without OpenSees: a client of our own in its place, and its faults."""

import os
import re
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

import thermobearing as tb
from tests.unit import inputs
from tests.verification.structures import follow
from thermobearing.commands.check import check_file
from thermobearing.core.types import Floats
from thermobearing.opensees import server as server_module
from thermobearing.opensees.case import (
    Layout,
    ServedCase,
    linear_stiffness,
    make_served_case,
    spring_constants,
)
from thermobearing.opensees.element import ServedElement, StepError
from thermobearing.opensees.line import ServingError, serve
from thermobearing.opensees.recording import Journal
from thermobearing.opensees.result import ServedResult
from thermobearing.opensees.server import LOOPBACK, Limits, Server
from thermobearing.opensees.wire import Action, Request, Setup, decode_reply, receive_exactly

LIMIT = 20.0  # s, for what takes milliseconds
ONE = Layout(1, (1,), (1,), None)


def case(**given: Any) -> ServedCase:
    return make_served_case({}, "test", **({"bearing": "shen-hdr-bridge", "ambient": -20} | given))


class Client:
    """What OpenSees sends and receives."""

    def __init__(self, port: int, dofs: int = 2, size: int = 0) -> None:
        self.setup = Setup.smallest(dofs, size)
        self.socket = socket.create_connection((LOOPBACK, port), timeout=LIMIT)
        self.socket.sendall(self.setup.encode())

    def send(self, action: Action, x: list[float], time: float, moving: float = 1.0) -> None:
        zeros = [0.0] * self.setup.dofs
        v = [0.0] * (self.setup.dofs - 1) + [moving]
        self.socket.sendall(Request(action, x, v, zeros, time).encode(self.setup))

    def ask(self, action: Action, x: list[float], time: float, moving: float = 1.0) -> Floats:
        self.send(action, x, time, moving)
        return decode_reply(
            receive_exactly(self.socket, self.setup.length, LIMIT), action, self.setup
        )

    def force(self, x: float, time: float, moving: float = 1.0) -> float:
        """Force on the second node at a trial displacement."""
        self.send(Action.SET_TRIAL, [0.0, x], time, moving)
        return float(self.ask(Action.FORCE, [0.0, x], time, moving)[1])

    def step(self, x: float, time: float, moving: float = 1.0) -> float:
        force = self.force(x, time, moving)
        self.send(Action.COMMIT, [0.0, x], time, moving)
        return force

    def end(self) -> None:
        """Leave, and wait until the server has closed the connection too."""
        self.send(Action.END, [0.0] * self.setup.dofs, 0.0)
        assert self.socket.recv(1) == b""
        self.socket.close()


class Running:
    """A server in a thread, one port for elements that are numbered as they come."""

    def __init__(
        self,
        given: ServedCase,
        layout: Layout = ONE,
        tag: int | None = None,
        limits: Limits | None = None,
        journal: Journal | None = None,
    ) -> None:
        self.server = Server(given, lambda text: None, journal=journal, limits=limits)
        self.port = self.server.listen(layout, tag, LOOPBACK, 0)
        self.thread = threading.Thread(target=self.server.run, daemon=True)
        self.thread.start()

    def stop(self) -> Server:
        self.server.stopped = True
        self.thread.join(LIMIT)
        self.server.close()
        return self.server

    def wait_for_problem(self) -> str:
        end = time.monotonic() + LIMIT
        while not self.server.problems and time.monotonic() < end:
            time.sleep(0.01)
        return self.server.problems[0]


@pytest.fixture
def running() -> Iterator[Running]:
    made = Running(case())
    yield made
    made.stop()


@pytest.fixture
def client(running: Running) -> Iterator[Client]:
    made = Client(running.port)
    yield made
    made.socket.close()


def expected(path: list[tuple[float, float]]) -> list[float]:
    """Forces of `tb.element` at times and displacements."""
    times, x = np.transpose(path)
    forces, _ = follow(tb.element("shen-hdr-bridge", ambient=-20), x, np.diff(times, prepend=0.0))
    result: list[float] = forces.tolist()
    return result


PATH = [(0.1, 3.0), (0.2, 8.0), (0.3, 2.0), (0.4, -6.0), (0.5, 0.0)]


def assert_only_nan(client: Client) -> None:
    """Whatever is asked, the answer comes and is NaN."""
    for _ in range(3):
        assert np.isnan(client.force(1.0, 1.0))


def test_a_trial_starts_from_the_committed_state(running: Running) -> None:
    client = Client(running.port, size=100)
    result = []
    for t, x in PATH:
        assert np.isfinite(client.force(x + 40.0, t + 0.7))
        result.append(client.step(x, t))
    assert result == expected(PATH)
    client.end()
    server = running.stop()
    assert not server.notes
    (history,) = server.histories()
    assert history.time.tolist() == [0.0, *(t for t, _ in PATH)]
    assert history.response["force"][1:].tolist() == expected(PATH)


def test_after_a_gravity_stage_the_clock_may_be_set_to_zero(client: Client) -> None:
    for t in (0.5, 1.0):
        assert client.step(0.0, t, moving=0.0) == 0.0
    result = [client.step(x, t) for t, x in PATH]
    assert result == pytest.approx(expected(PATH), rel=1e-12)


def test_a_load_factor_is_no_clock_without_a_rate(running: Running, client: Client) -> None:
    assert client.step(5.0, 100.0, moving=0.0) > 0.0
    assert np.isnan(client.force(4.0, 90.0, moving=0.0))
    refused = running.server.histories()[0]
    assert np.isfinite(client.force(4.0, 101.0, moving=0.0))
    client.end()
    server = running.stop()
    assert len(server.notes) == 2  # at the first step, and at the one that is refused
    assert all("rate" in note for note in server.notes)
    result = ServedResult.of(server.case, [refused], server.problems, server.notes)
    assert result.outcome == "connection_failed"
    assert set(server.notes) < set(result.warnings)


def test_a_rate_makes_time_of_displacement() -> None:
    running = Running(case(rate=20.0))
    client = Client(running.port)
    result = [
        client.step(x, factor, 0.0) for x, factor in ((5.0, 80.0), (2.0, 10.0), (-3.0, -40.0))
    ]
    assert result == pytest.approx(expected([(0.25, 5.0), (0.4, 2.0), (0.65, -3.0)]), rel=1e-12)
    client.end()
    running.stop()


def test_a_reset_begins_again(running: Running, client: Client) -> None:
    for _ in range(2):
        assert [client.step(x, t) for t, x in PATH] == expected(PATH)
        assert client.force(0.0, 0.0) == 0.0  # sent by the reset of a domain
    client.end()
    first, second, third = running.stop().histories()
    assert [h.run for h in (first, second, third)] == [1, 2, 3]
    assert (first.response["force"] == second.response["force"]).all()
    assert len(third.time) == 1


def test_not_a_number_is_answered_by_not_a_number(client: Client) -> None:
    assert np.isnan(client.force(np.nan, 0.1))
    assert [client.step(x, t) for t, x in PATH] == expected(PATH)


def test_a_failed_step_that_is_committed_ends_the_service(running: Running, client: Client) -> None:
    assert client.step(3.0, 0.1) > 0.0
    client.step(np.inf, 0.2)
    assert_only_nan(client)
    server = running.stop()
    assert len(server.problems) == 1
    assert len(server.histories()[0].time) == 2  # what was committed before


TWO = Setup.smallest(2).encode()


@pytest.mark.parametrize(
    ("data", "word"),
    [
        (Setup.smallest(6).encode(), "6 degrees of freedom"),
        (b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nAccept: */*\r\n\r\n", "setup"),
        (TWO + struct.pack("=17d", 3, *[0.5] * 16), "action code"),  # messages are of 8 doubles
        (TWO + bytes(12), "12 bytes"),
    ],
    ids=["degrees of freedom", "another program", "wrong size", "half a message"],
)
def test_bytes_that_are_no_message_are_answered_by_nan(data: bytes, word: str) -> None:
    running = Running(case(), limits=Limits(message_time=0.1, tick=0.05))
    with socket.create_connection((LOOPBACK, running.port), timeout=LIMIT) as other:
        other.sendall(data)
        assert word in running.wait_for_problem()
        assert np.isnan(np.frombuffer(receive_exactly(other, 800, LIMIT))).all()
    client = Client(running.port)  # others are served
    assert [client.step(x, t) for t, x in PATH] == expected(PATH)
    client.end()
    running.stop()


def test_a_client_that_is_killed_leaves_its_history(running: Running, client: Client) -> None:
    forces = [client.step(x, t) for t, x in PATH]
    client.socket.sendall(bytes(20))
    client.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    client.socket.close()  # as the system does for a killed process: no END
    running.wait_for_problem()
    (history,) = running.stop().histories()
    assert history.response["force"][1:].tolist() == forces


def test_two_clients_of_one_element() -> None:
    running = Running(case(), tag=7)
    first, second = Client(running.port), Client(running.port)
    assert "second client" in running.wait_for_problem()
    assert_only_nan(second)
    assert [first.step(x, t) for t, x in PATH] == expected(PATH)
    first.end()
    third = Client(running.port)  # after the end of the first
    assert [third.step(x, t) for t, x in PATH] == expected(PATH)
    third.end()
    second.socket.close()
    assert sorted((h.tag, h.run) for h in running.stop().histories()) == [(7, 1), (7, 3)]


def test_a_port_in_use(running: Running) -> None:
    with pytest.raises(tb.InputError, match=str(running.port)):
        Server(case(), print).listen(ONE, None, LOOPBACK, running.port)


def test_several_bearings_in_one_element() -> None:
    layout = Layout.of(3, (1,), None, "test")
    running = Running(case(), layout)
    client = Client(running.port, dofs=6)
    forces = []
    for t, x in PATH:
        u = [0.0, x, 1.0, 1.0 + x, -2.0 * x, -x]
        client.send(Action.SET_TRIAL, u, t)
        forces.append(client.ask(Action.FORCE, u, t))
        client.send(Action.COMMIT, u, t)
    client.end()
    running.stop()
    for pair in range(3):
        assert np.array(forces)[:, 2 * pair + 1].tolist() == pytest.approx(expected(PATH))
        assert (np.array(forces)[:, 2 * pair] == -np.array(forces)[:, 2 * pair + 1]).all()


@pytest.mark.parametrize(
    ("units", "directions"), [("kN-mm", (2,)), ("N-m", (2,)), ("kip-in", (2,)), ("kN-m", (2, 1))]
)
def test_an_element_in_space_has_the_slope_of_its_forces(units: Any, directions: Any) -> None:
    layout = Layout.of(2, directions, 3, "test")
    element = ServedElement(case(units=units, count=2), layout, 1)
    n = layout.size
    rng = np.random.default_rng(1)
    x = 1e-3 * rng.standard_normal(n)

    def force(at: Floats) -> Floats:
        element.answer(Request(Action.SET_TRIAL, tuple(at), (1.0,) * n, (0.0,) * n, 0.01))
        return np.array(element.answer(Request(Action.FORCE, tuple(at), (), (), 0.01)))

    force(x)
    k = np.array(element.answer(Request(Action.TANGENT, (), (), (), 0.01)))
    assert len(directions) == 2 or (k == k.T).all()
    h = 1e-7
    for column in range(n):
        step = np.eye(n)[column] * h
        slope = (force(x + step) - force(x - step)) / (2 * h)
        assert slope == pytest.approx(k[:, column], rel=1e-4, abs=1e-6 * np.abs(k).max())
    rigid = np.tile(rng.standard_normal(6), 4)
    assert np.abs(k @ rigid).max() < 1e-9 * np.abs(k).max()


def test_springs_of_the_geometry() -> None:
    """Round and square: Kumar, Whittaker & Constantinou (2014), by hand."""
    given = case(bearing="shen-hdr-bridge", ambient=23)
    bearing, known = given.bearing, linear_stiffness(given)
    side, height = bearing.geometry.plan.breadth, bearing.total_rubber_thickness
    modulus = known.shear * height / side**2  # kN/mm2
    assert 0.5e-3 < modulus < 2e-3
    shape = side / (4 * bearing.geometry.rubber_thickness)
    e = 1 / (1 / (6.73 * modulus * shape**2) + 4 / (3 * 2.0))
    assert known.vertical == pytest.approx(e * side**2 / height, rel=1e-12)
    assert known.rotation == pytest.approx([e * side**4 / 36 / height] * 2, rel=1e-12)
    assert known.torsion == pytest.approx(modulus * side**4 / 6 / height, rel=1e-12)
    cold = linear_stiffness(case(ambient=-20))
    assert cold.shear > 1.2 * known.shear
    springs = spring_constants(Layout.of(1, (1,), 3, "test"), given)
    assert springs.tolist() == [0.0, known.shear, known.vertical, *known.rotation, known.torsion]


@pytest.mark.parametrize(
    "words",
    [
        {"directions": (1, 2, 3)},
        {"directions": (1, 1)},
        {"directions": (4,)},
        {"directions": (1,), "vertical": 1},
        {"directions": ()},
        {"pairs": 0},
        {"pairs": 11, "vertical": 3},
    ],
)
def test_layouts_that_cannot_be(words: dict[str, Any]) -> None:
    given = {"pairs": 1, "directions": (1,), "vertical": None} | words
    with pytest.raises(tb.InputError):
        Layout.of(**given, where="test")


def test_two_directions_are_a_plane() -> None:
    """The same path in another direction; the histories of both directions are kept."""
    element, bearing = ServedElement(case(), Layout.of(1, (1, 2), None, "test"), 1), expected(PATH)
    for (t, x), force in zip(PATH, bearing, strict=True):
        u = (0.0, 0.0, 0.6 * x, 0.8 * x)
        element.answer(Request(Action.SET_TRIAL, u, (1.0,) * 4, (0.0,) * 4, t))
        actual = element.answer(Request(Action.FORCE, u, (), (), t))
        assert actual == pytest.approx(force * np.array([-0.6, -0.8, 0.6, 0.8]), rel=1e-9)
        element.answer(Request(Action.COMMIT, u, (), (), t))
    along, across = element.histories()
    assert (along.direction, across.direction) == (1, 2)
    assert across.response["displacement"][1:].tolist() == pytest.approx([0.8 * x for _, x in PATH])
    result = ServedResult.of(case(), [along, across])
    assert result["element"].values.tolist() == ["1 x", "1 y"]
    assert result.energy["mechanical_residual"].abs().max() < 1e-12


def test_a_step_that_never_was_is_not_committed() -> None:
    element = ServedElement(case(), ONE, 1)
    element.answer(Request(Action.COMMIT, (), (), (), 0.0))
    assert len(element.histories()[0].time) == 1
    element.answer(Request(Action.SET_TRIAL, (0.0, np.nan), (0.0, 0.0), (0.0, 0.0), 1.0))
    with pytest.raises(StepError):
        element.answer(Request(Action.COMMIT, (), (), (), 1.0))


def read_port(arguments: tuple[Any, ...]) -> int:
    return int(arguments[arguments.index("-server") + 1])


def test_a_line_serves_and_keeps_its_result() -> None:
    with serve("shen-hdr-bridge", ambient=-20) as line:
        with pytest.raises(tb.InputError):
            line.results()
        client = Client(read_port(line.element(5, (1, 2))))
        assert [client.step(x, t) for t, x in PATH] == expected(PATH)
        line.reset()
        assert [client.step(x, t) for t, x in PATH] == expected(PATH)
        client.end()
        for nodes in ((1, 1), (1,), "ab", ((1, 2), (2, 3))):
            with pytest.raises(tb.InputError):
                line.element(6, nodes)  # type: ignore[arg-type]
        with pytest.raises(tb.InputError):
            line.element(5, (1, 2), (1, 2))
    result = line.results()
    assert result["element"].values.tolist() == ["5, run 1", "5, run 2"]
    assert (result["force"].values[0] == result["force"].values[1]).all()
    with pytest.raises(ServingError):
        line.element(8, (1, 2))


def test_a_killed_server_lets_nobody_wait() -> None:
    line = serve("shen-hdr-bridge", ambient=-20)
    client = Client(read_port(line.element(5, (1, 2))))
    assert client.step(3.0, 0.1) > 0.0
    served = line.results()
    line._process.kill()
    assert_only_nan(client)
    client.socket.close()
    with pytest.raises(ServingError, match="-9"):
        line.results()
    with pytest.raises(ServingError, match="-9"):
        line.check()
    kept = line.results()  # what the server had written before
    assert kept.outcome == "connection_failed"
    assert (kept["force"].values == served["force"].values).all()


def test_ctrl_c_in_the_script_marks_its_result() -> None:
    with suppress(KeyboardInterrupt), serve("shen-hdr-bridge", ambient=-20) as line:
        client = Client(read_port(line.element(5, (1, 2))))
        client.step(*PATH[0][::-1])
        client.end()
        assert line.results().outcome == "completed"
        raise KeyboardInterrupt
    assert line.results().outcome == "interrupted"
    assert line.results().sentence


def test_without_histories_there_is_no_result(monkeypatch: pytest.MonkeyPatch) -> None:
    line = serve("shen-hdr-bridge", ambient=-20)
    Client(read_port(line.element(5, (1, 2)))).socket.close()
    monkeypatch.setattr(line, "_take", Mock(side_effect=KeyboardInterrupt))
    with pytest.raises(KeyboardInterrupt):
        line.close()
    with pytest.raises(ServingError):
        line.results()


@pytest.mark.thorough
def test_a_killed_script_takes_its_server_along(tmp_path: Path) -> None:
    script = (
        "import time; from thermobearing.opensees.line import serve\n"
        "line = serve('shen-hdr-bridge'); print(line._process.pid, flush=True); time.sleep(99)"
    )
    parent = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert parent.stdout is not None
    child = int(parent.stdout.readline())
    parent.kill()
    parent.wait()
    parent.stdout.close()
    end = time.monotonic() + LIMIT
    while alive(child) and time.monotonic() < end:
        time.sleep(0.02)
    assert not alive(child)


def alive(process: int) -> bool:
    stat = Path(f"/proc/{process}/stat")
    try:
        return stat.read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def command(*words: str) -> "subprocess.Popen[str]":
    line = [sys.executable, "-m", "thermobearing.cli", "serve", *words]
    return subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def port_printed_by(running: "subprocess.Popen[str]") -> int:
    assert running.stderr is not None
    return next(
        int(result[1]) for text in running.stderr if (result := re.search(r"port (\d+)", text))
    )


@pytest.mark.thorough
def test_ctrl_c_ends_the_command_which_writes_what_it_served(tmp_path: Path) -> None:
    words = ["shen-hdr-bridge", "--ambient", "-20", "--port", "0", "--no-figures"]
    running = command(*words, "-o", str(tmp_path / "out"), "--units", "kN-mm")
    client = Client(port_printed_by(running))
    forces = [client.step(x, t) for t, x in PATH]
    running.send_signal(signal.SIGINT)
    running.communicate(timeout=LIMIT)
    assert running.returncode == 0
    assert_only_nan(client)  # which has not left
    client.socket.close()
    result = tb.load_result(tmp_path / "out")
    assert result["force"].values[0, 1:].tolist() == forces
    assert check_file(tmp_path / "out" / "case.resolved.toml").kind == "served case"


@pytest.mark.thorough
def test_a_command_that_served_nothing_writes_nothing(tmp_path: Path) -> None:
    running = command("shen-hdr-bridge", "--port", "0", "-o", str(tmp_path / "out"))
    assert port_printed_by(running)
    running.send_signal(signal.SIGTERM)
    _, text = running.communicate(timeout=LIMIT)
    assert running.returncode == 2
    assert "line.element" not in text
    assert not (tmp_path / "out").exists()


@pytest.mark.thorough
def test_a_case_is_served_again_until_the_last_element_has_left(tmp_path: Path) -> None:
    file = tmp_path / "case.toml"
    file.write_text(case().to_toml(), encoding="utf-8")
    running = command(str(file), "--port", "0", "--once", "-o", str(tmp_path / "out"))
    client = Client(port_printed_by(running))
    assert [client.step(x, t) for t, x in PATH] == expected(PATH)
    client.end()
    running.communicate(timeout=LIMIT)
    assert running.returncode == 0
    assert tb.load_result(tmp_path / "out").table["steps"].tolist() == [len(PATH)]


@pytest.mark.parametrize(
    "words", [["--port", "{used}"], ["--port", "0", "--direction", "7"], ["--port", "99999"]]
)
def test_a_command_that_cannot_serve(words: list[str], running: Running, tmp_path: Path) -> None:
    words = [word.format(used=running.port) for word in words]
    done = inputs.command("serve", "shen-hdr-bridge", *words, "-o", tmp_path / "out")
    assert done.exit_code == 2
    assert words[-1] in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.skipif(not hasattr(socket, "TCP_QUICKACK"), reason="no TCP_QUICKACK here")
def test_two_writes_in_a_row_do_not_wait_for_an_acknowledgement(client: Client) -> None:
    """As OpenSees writes, with Nagle's algorithm: a delayed acknowledgement costs 40 ms."""
    took = []
    for k in range(1, 41):
        begun = time.perf_counter()
        client.step(0.1 * k, 0.01 * k)
        took.append(time.perf_counter() - begun)
    assert np.median(took) < 0.02


STOPPED = """
import os, signal
from tests.unit.test_served import ONE, LOOPBACK, Server, case
from thermobearing.opensees.keeper import Keeper
from thermobearing.opensees.server import load_kernels
server = Server(case(), print, Keeper.start(1.5, 0.1))
load_kernels(server.case)
print(server.listen(ONE, None, LOOPBACK, 0), flush=True)
moved = lambda: any(len(history.time) > 1 for history in server.histories())
server.run(lambda: moved() and os.kill(os.getpid(), signal.SIGSTOP))
"""


@pytest.mark.thorough
def test_a_server_that_is_stuck_is_ended() -> None:
    stuck = subprocess.Popen(
        [sys.executable, "-c", STOPPED], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert stuck.stdout is not None
    client = Client(int(stuck.stdout.readline()))
    assert client.step(3.0, 0.1) > 0.0
    time.sleep(1.0)  # it is stopped
    assert_only_nan(client)
    client.socket.close()
    assert "receives NaN" in stuck.communicate(timeout=LIMIT)[1]
    assert stuck.returncode == -signal.SIGKILL


SILENT = """
import time
from thermobearing.opensees.keeper import Keeper
keeper = Keeper.start(0.2)
keeper.report_progress()
keeper.expect_silence()
time.sleep(1.0)
print("compiled", flush=True)
keeper.report_progress()
time.sleep(60.0)
"""


def test_a_server_that_compiles_is_not_ended() -> None:
    process = subprocess.run(
        [sys.executable, "-c", SILENT],
        capture_output=True,
        text=True,
        timeout=3 * LIMIT,
        check=False,
    )
    assert (process.stdout, process.returncode) == ("compiled\n", -signal.SIGTERM)


def test_kernels_of_two_directions_are_there_before_an_element_connects(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    loaded: list[tuple[int, ...]] = []

    def load(_: Any, directions: Any = (1,)) -> None:
        loaded.append(tuple(directions))

    monkeypatch.setattr(server_module, "load_kernels", load)
    layout = Layout.of(1, (1, 2), None, "test")
    served = server_module.serve_until(
        case(), layout, LOOPBACK, 0, once=True, show=lambda _: os.kill(os.getpid(), signal.SIGTERM)
    )
    assert served.stopped
    assert loaded == [(1, 2)]
