"""The wire format of OpenSees' `genericClient` element, for both ends of the connection.

The format has no handshake, no frames and no checksum. Numbers are in the byte order of the
machine. After the connection, the client sends eleven 32-bit integers (`Setup`). Every later
message, in either direction, is a vector of `Setup.size` doubles. A request holds the action code,
the displacements, velocities and accelerations of all degrees of freedom in the order of the
`-dof` lists, and the time of the domain. A reply holds a vector of forces, or a matrix by columns.
`SET_TRIAL`, `COMMIT` and `END` have no reply.

The format is that of OpenSees 3.7 (`SRC/element/generic/GenericClient.cpp`,
`SRC/actor/channel/TCP_Socket.cpp`); the client of xara is the same.
"""

import contextlib
import math
import socket
import struct
import time
from collections.abc import Sequence
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

SETUP = struct.Struct("=11i")
DOUBLE = 8  # [bytes]
MOST_DOFS = 120
MOST_SIZE = 65536  # of a message [doubles]: 512 KiB


class WireError(RuntimeError):
    """Bytes that are not those of the wire format."""


class Action(IntEnum):
    """Codes at the start of a request, of which there are others that OpenSees does not send."""

    SET_TRIAL = 3
    COMMIT = 5
    FORCE = 10
    INITIAL_STIFFNESS = 12
    TANGENT = 13
    DAMPING = 14
    MASS = 15
    END = 99


SILENT = frozenset((Action.SET_TRIAL, Action.COMMIT, Action.END))  # have no reply
MATRICES = frozenset((Action.INITIAL_STIFFNESS, Action.TANGENT, Action.DAMPING, Action.MASS))
ZERO = frozenset((Action.DAMPING, Action.MASS))  # zero: the force of a bearing contains both
CODES = {float(action): action for action in Action}


class Setup(NamedTuple):
    """Sizes that a client announces once."""

    dofs: int  # of all nodes of the element
    size: int  # length of every later message [doubles]

    @classmethod
    def smallest(cls, dofs: int, size: int = 0) -> "Setup":
        """Return the setup of an element; messages have at least `size` doubles, as in OpenSees."""
        return cls(dofs, max(size, 3 * dofs + 2, dofs * dofs))

    @property
    def length(self) -> int:
        """Length of every later message [bytes]."""
        return DOUBLE * self.size

    def encode(self) -> bytes:
        """Return the bytes that a client sends first."""
        n = self.dofs
        return SETUP.pack(n, n, n, 0, 1, 0, 0, 0, n, 0, self.size)

    @classmethod
    def decode(cls, data: bytes) -> "Setup":
        """Return the setup from the first bytes of a client, or raise WireError."""
        numbers = SETUP.unpack(data)
        n, size = numbers[0], numbers[-1]
        if not 1 <= n <= MOST_DOFS or numbers[:-1] != (n, n, n, 0, 1, 0, 0, 0, n, 0):
            raise WireError(
                f"the first {SETUP.size} bytes are {numbers} as 32-bit integers, not the setup of "
                "a genericClient element with displacements, velocities, accelerations and forces "
                "of the same degrees of freedom; another program may have connected"
            )
        smallest_size = cls.smallest(n).size
        if not smallest_size <= size <= MOST_SIZE:
            raise WireError(
                f"dataSize = {size}: must be from {smallest_size} to {MOST_SIZE} for {n} degrees "
                "of freedom"
            )
        return cls(n, size)

    def take(self, buffer: bytearray) -> "Request | None":
        """Remove a message from the buffer and return its request; None while it is incomplete."""
        if len(buffer) < self.length:
            return None
        request = Request.decode(buffer, self)
        del buffer[: self.length]
        return request

    def reply(self, values: Sequence[float] | NDArray[np.float64]) -> bytes:
        """Return the answer with a vector or a matrix; without values, zeros."""
        return encode_reply(values, self) if len(values) else bytes(self.length)

    def without_result(self) -> bytes:
        """Return an answer of NaN."""
        return b"\xff" * self.length  # a double with all bits set is NaN


class Request(NamedTuple):
    """One request of a client, in the units of the client."""

    action: Action
    displacement: Sequence[float]  # trial response of all degrees of freedom
    velocity: Sequence[float]
    acceleration: Sequence[float]
    time: float  # of the domain at the last `SET_TRIAL`; the load factor of a static analysis

    def encode(self, setup: Setup) -> bytes:
        """Return the message of this request."""
        n = setup.dofs
        groups = (self.displacement, self.velocity, self.acceleration)
        if any(len(group) != n for group in groups):
            raise WireError(f"a request must have {n} displacements, velocities and accelerations")
        flat = [value for group in groups for value in group]
        return encode_reply([float(self.action), *flat, self.time], setup)

    @classmethod
    def decode(cls, data: bytes | bytearray | memoryview, setup: Setup) -> "Request":
        """Return the request in a message, or raise WireError for an unknown action code."""
        n = setup.dofs
        numbers = struct.unpack_from(f"={3 * n + 2}d", data)
        action = CODES.get(numbers[0])
        if action is None:
            raise WireError(
                f"{numbers[0]!r} is not an action code of genericClient; messages of another "
                f"length than {setup.size} doubles, or of another program, have arrived"
            )
        response = numbers[1:-1]  # displacements, velocities and accelerations, one after another
        displacement, velocity, acceleration = response[:n], response[n : 2 * n], response[2 * n :]
        return cls(action, displacement, velocity, acceleration, numbers[-1])

    @property
    def finite(self) -> bool:
        """Whether displacements and time are finite; velocities and accelerations are not used."""
        return math.isfinite(self.time) and all(map(math.isfinite, self.displacement))


def encode_reply(values: Sequence[float] | NDArray[np.float64], setup: Setup) -> bytes:
    """Return the message of a vector, or of a matrix by columns; the rest is zero."""
    if isinstance(values, np.ndarray):
        data = np.ravel(values, order="F").astype(np.float64).tobytes()
    else:
        data = struct.pack(f"={len(values)}d", *values)
    if len(data) > setup.length:
        count = len(data) // DOUBLE
        raise WireError(f"{count} numbers do not fit into a message of {setup.size} doubles")
    return data.ljust(setup.length, b"\0")


def decode_reply(data: bytes | bytearray, action: Action, setup: Setup) -> NDArray[np.float64]:
    """Return the force vector or the matrix of a reply."""
    if len(data) != setup.length:
        raise WireError(f"a reply has {len(data)} bytes instead of {setup.length}")
    n = setup.dofs
    if action in MATRICES:
        return np.frombuffer(data, count=n * n).reshape((n, n), order="F").copy()
    return np.frombuffer(data, count=n).copy()


def prepare(connection: socket.socket) -> None:
    """Switch off the waiting of a TCP connection for more bytes to send (Nagle's algorithm)."""
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)


def acknowledge(connection: socket.socket) -> None:
    """Acknowledge at once what has been received; to be called after each receive.

    OpenSees leaves Nagle's algorithm on and writes twice before it reads. Its second message waits
    for the acknowledgement of the first, which Linux delays by 40 ms unless the
    option is set again.
    """
    if hasattr(socket, "TCP_QUICKACK"):
        with contextlib.suppress(OSError):  # closed meanwhile: the next receive reports it
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_QUICKACK, 1)


def receive_exactly(connection: socket.socket, count: int, limit: float) -> bytes:
    """Return `count` bytes; TimeoutError or ConnectionError unless they arrive in `limit` [s]."""
    data = bytearray(count)
    view, received, end = memoryview(data), 0, time.monotonic() + limit
    while received < count:
        remaining = end - time.monotonic()
        try:
            if remaining <= 0.0:
                raise TimeoutError
            connection.settimeout(remaining)
            length = connection.recv_into(view[received:])
        except TimeoutError:
            raise TimeoutError(
                f"{received} of {count} bytes of a message arrived within {limit:g} s"
            ) from None
        if not length:
            raise ConnectionError(
                f"the connection was closed after {received} of {count} bytes of a message"
            )
        acknowledge(connection)
        received += length
    return bytes(data)
