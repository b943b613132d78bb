"""The wire format of genericClient: bytes of both ends, and what is refused."""

import socket
import struct
import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest

from thermobearing.opensees.wire import (
    Action,
    Request,
    Setup,
    WireError,
    decode_reply,
    encode_reply,
    prepare,
    receive_exactly,
)


@pytest.fixture
def ends() -> Iterator[tuple[socket.socket, socket.socket]]:
    """Two ends of a TCP connection on the loopback."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        client = socket.create_connection(listener.getsockname())
        server, _ = listener.accept()
    for end in (client, server):
        prepare(end)
    with client, server:
        yield client, server


def test_setup_has_the_bytes_of_the_client() -> None:
    """GenericClient.cpp: sizes of control, sizes of data acquisition, dataSize."""
    setup = Setup.smallest(2)
    assert struct.unpack("=11i", setup.encode()) == (2, 2, 2, 0, 1, 0, 0, 0, 2, 0, 8)
    assert Setup.decode(setup.encode()) == setup
    assert Setup.smallest(12).size == 144  # a matrix is longer than a request
    assert Setup.smallest(2, 256).length == 2048


@pytest.mark.parametrize(
    "data",
    [
        b"GET / HTTP/1.1\r\nHost: localhost:1\r\nAccept: *".ljust(44)[:44],
        struct.pack(">11i", 2, 2, 2, 0, 1, 0, 0, 0, 2, 0, 8),  # of the other byte order
        struct.pack("=11i", 2, 2, 2, 0, 1, 0, 0, 0, 2, 0, 7),  # too short for a request
        struct.pack("=11i", 2, 2, 2, 0, 1, 0, 0, 0, 2, 0, 2**30),
        struct.pack("=11i", 2, 2, 2, 0, 1, 0, 0, 0, 4, 0, 16),
        struct.pack("=11i", 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 8),
    ],
)
def test_a_wrong_setup_is_refused(data: bytes) -> None:
    with pytest.raises(WireError):
        Setup.decode(data)


def test_requests_pass_unchanged() -> None:
    setup = Setup.smallest(2, 16)
    request = Request(Action.SET_TRIAL, (1.0, -2.0), (3.0, 4.0), (5.0, 6.0), 0.25)
    data = request.encode(setup)
    assert struct.unpack("=16d", data) == (3, 1, -2, 3, 4, 5, 6, 0.25, *[0] * 8)
    assert Request.decode(data, setup) == request
    assert request.finite
    assert not request._replace(displacement=(1.0, np.nan)).finite
    assert not request._replace(time=np.inf).finite
    with pytest.raises(WireError):
        request._replace(velocity=(1.0,)).encode(setup)


@pytest.mark.parametrize("code", [0.0, 4.0, 3.5, np.nan, 1e300])
def test_unknown_actions_are_refused(code: float) -> None:
    setup = Setup.smallest(1)
    with pytest.raises(WireError):
        Request.decode(struct.pack("=5d", code, 0, 0, 0, 0), setup)


def test_matrices_are_sent_by_columns() -> None:
    setup = Setup.smallest(2)
    data = encode_reply(np.array([[1.0, 2.0], [3.0, 4.0]]), setup)
    assert struct.unpack("=8d", data) == (1, 3, 2, 4, 0, 0, 0, 0)
    assert decode_reply(data, Action.TANGENT, setup).tolist() == [[1, 2], [3, 4]]
    assert decode_reply(data, Action.FORCE, setup).tolist() == [1, 3]
    with pytest.raises(WireError):
        decode_reply(data[:-8], Action.FORCE, setup)
    with pytest.raises(WireError):
        encode_reply(np.zeros(9), setup)


def test_a_message_in_pieces_is_received_as_one(ends: tuple[socket.socket, socket.socket]) -> None:
    client, server = ends
    data = bytes(range(256)) * 4

    def _dribble() -> None:
        for first in range(0, len(data), 100):
            client.sendall(data[first : first + 100])
            time.sleep(0.002)

    thread = threading.Thread(target=_dribble)
    thread.start()
    assert receive_exactly(server, len(data), 10.0) == data
    thread.join()


def test_half_a_message_ends_in_time(ends: tuple[socket.socket, socket.socket]) -> None:
    client, server = ends
    client.sendall(b"12345")
    started = time.monotonic()
    with pytest.raises(TimeoutError, match="5 of 8"):
        receive_exactly(server, 8, 0.1)
    assert time.monotonic() - started < 5.0


def test_a_closed_connection_is_an_error(ends: tuple[socket.socket, socket.socket]) -> None:
    client, server = ends
    client.sendall(b"123")
    client.close()
    with pytest.raises(ConnectionError, match="3 of 8"):
        receive_exactly(server, 8, 10.0)
