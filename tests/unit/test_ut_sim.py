"""A client of UT-SIM, written from its published format, at the server of bearings."""

import socket
import struct
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests.unit.test_served import LIMIT, PATH, Running, case, expected
from thermobearing.opensees.case import Layout
from thermobearing.opensees.server import LOOPBACK
from thermobearing.opensees.wire import UtSim, WireError, receive_exactly

DT = 0.1  # of PATH [s]
FORCE, BOTH, STIFFNESS = 8, 9, 16  # content
ABAQUS = 3


class Client:
    """What the user element for Abaqus sends and receives."""

    def __init__(self, port: int, dofs: int = 2, precision: int = 2) -> None:
        self.dofs, self.precision, self.step = dofs, precision, 1
        self.kind = "f" if precision == 1 else "d"
        self.socket = socket.create_connection((LOOPBACK, port), timeout=LIMIT)
        self.send(0, 0)

    def send(self, command: int, content: int, numbers: Any = ()) -> None:
        one_byte = bytes([1, command, 4, ABAQUS, self.precision, content])
        rest = struct.pack(">HHHI", self.dofs, self.step % 65536, 0, 0)
        data = struct.pack(f"<{len(numbers)}{self.kind}", *numbers)
        self.socket.sendall(one_byte + rest + data)

    def ask(self, command: int, content: int, count: int) -> list[float]:
        self.send(command, content)
        size = struct.calcsize(f"<{count}{self.kind}")
        reply = receive_exactly(self.socket, 16 + size, LIMIT)
        assert reply[1] == command
        assert struct.unpack_from(">H", reply, 6) == (self.dofs,)
        return list(struct.unpack_from(f"<{count}{self.kind}", reply, 16))

    def force(self, x: float) -> float:
        self.send(3, 1)
        self.send(3, 1, [0.0] * (self.dofs - 1) + [x])
        found = self.ask(10, BOTH, 2 * self.dofs)
        assert found[self.dofs - 1] == pytest.approx(x, rel=1e-6)
        return found[-1]


@pytest.fixture
def running() -> Any:
    made = Running(case(step=DT))
    yield made
    made.stop()


@pytest.mark.parametrize("precision", [1, 2])
def test_a_new_number_of_the_step_commits(running: Running, precision: int) -> None:
    client, found = Client(running.port, precision=precision), []
    client.step = 65534  # the number begins again on the way
    for _, x in PATH:
        assert np.isfinite(client.force(x + 40.0))  # an iteration
        found.append(client.force(x))
        assert client.force(x) == found[-1]
        client.step += 1
    assert_allclose(found, expected(PATH), rtol=1e-6 if precision == 1 else 1e-12)
    client.socket.close()
    (history,) = running.stop().histories()
    assert history.time == pytest.approx([0.0, *(t for t, _ in PATH)])
    assert not running.server.problems


def test_the_stiffness_is_that_of_the_start(running: Running) -> None:
    client = Client(running.port)
    k = np.reshape(client.ask(12, STIFFNESS, 4), (2, 2))
    start = tb.element("shen-hdr-bridge", ambient=-20).set_trial(0.0, dt=1e-6).tangent
    assert_allclose(k, start * np.array([[1.0, -1.0], [-1.0, 1.0]]))
    client.force(3.0)
    client.send(99, 0)
    assert client.socket.recv(1) == b""
    (history,) = running.stop().histories()
    assert history.time == pytest.approx([0.0, DT])


def test_forces_may_come_alone_and_ends_of_messages_may_be_late(running: Running) -> None:
    client = Client(running.port)
    force = client.force(3.0)
    for byte in bytes([1, 10, 4, ABAQUS, 2, FORCE, 0, 2, 0, 1, *bytes(6)]):
        client.socket.sendall(bytes([byte]))
    reply = receive_exactly(client.socket, 32, LIMIT)
    assert struct.unpack_from("<2d", reply, 16) == (-force, force)
    assert client.ask(10, FORCE, 2) == [-force, force]


def test_several_degrees_of_freedom() -> None:
    made = Running(case(step=DT), Layout.of(1, (1, 2), None, "test"))
    client = Client(made.port, dofs=4)
    alone = expected([(DT, 5.0)])[0]
    assert client.force(5.0) == pytest.approx(alone, rel=1e-12)  # as on a line
    client.socket.close()
    assert len(made.stop().histories()) == 2


@pytest.mark.parametrize(
    ("given", "first", "word"),
    [
        ({}, bytes([1, 0, 4, 3, 2, 0, 0, 2]), "step"),
        ({"step": DT}, bytes([1, 0, 4, 3, 7, 0, 0, 2]), "precision 7"),
        ({"step": DT}, bytes([1, 0, 4, 3, 2, 0, 0, 6]), "6"),
        ({"step": DT}, bytes([1, 0, 4, 3, 2, 0, 0, 2, *bytes(8), 1, 5, 4, 3, 2]), "5"),
    ],
)
def test_what_cannot_be_served_is_a_problem(given: Any, first: bytes, word: str) -> None:
    made = Running(case(**given))
    client = socket.create_connection((LOOPBACK, made.port), timeout=LIMIT)
    client.sendall(first.ljust(32, b"\0"))
    assert word in made.wait_for_problem()
    assert np.isnan(np.frombuffer(receive_exactly(client, 16, LIMIT))).all()
    client.close()
    made.stop()


def test_contents_that_do_not_exist_are_refused() -> None:
    header = bytes([1, 10, 4, 3, 2, 2, 0, 2, *bytes(8)])
    assert UtSim.sends(header[:1] + b"\0" + header[2:])
    assert not UtSim.sends(struct.pack("=11i", 2, 2, 2, 0, 1, 0, 0, 0, 2, 0, 8))
    codec = UtSim(header, DT)
    (request,) = codec.take(bytearray(header))
    with pytest.raises(WireError):
        codec.reply([1.0, 2.0], request.action)
