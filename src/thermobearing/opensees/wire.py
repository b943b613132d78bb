"""The wire format of OpenSees' `genericClient` element, for both ends of the connection.

The format has no handshake, no frames and no checksum. Numbers are in the byte order of the
machine. After the connection, the client sends eleven 32-bit integers (`Setup`). Every later
message, in either direction, is a vector of `Setup.size` doubles. A request holds the action code,
the displacements, velocities and accelerations of all degrees of freedom in the order of the
`-dof` lists, and the time of the domain. A reply holds a vector of forces, or a matrix by columns.
`SET_TRIAL`, `COMMIT` and `END` have no reply.

`UtSim` is another format with the same action codes, of the framework UT-SIM.

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

    def take(self, buffer: bytearray) -> "list[Request]":
        """Remove a message from the buffer and return its request; none while it is incomplete."""
        if len(buffer) < self.length:
            return []
        request = Request.decode(buffer, self)
        del buffer[: self.length]
        return [request]

    def reply(self, values: Sequence[float] | NDArray[np.float64], action: "Action") -> bytes:
        """Return the answer to an action."""
        return encode_reply(values, self) if len(values) else bytes(self.length)

    def nothing(self, _: "Action") -> bytes:
        """Return an answer of NaN."""
        return b"\xff" * self.length  # a double with all bits set is NaN

    def finish(self) -> "list[Request]":
        """Return what remains to be done when the client has left."""
        return []


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


HEADER = struct.Struct(">6B3HI")
STEPS = 1 << 16  # after which the numbers of steps begin again
DISPLACEMENTS, FORCES = 1, 8  # bits of the content of a message


class UtSim:
    """The messages of a client of UT-SIM, such as its user element for Abaqus.

    Each begins with a header of 16 bytes: version, command, type of test, type of substructure,
    precision (1: four bytes, 2: eight bytes) and content (a bit each for displacements, velocities,
    accelerations and forces) of one byte each; numbers of degrees of freedom and of the step and a
    reserved one of two bytes, and a time stamp of four, the first byte being the highest. A command
    is a header alone. After `SET_TRIAL`, displacements follow in a message of their own; answers
    repeat the header. There is no message for a commit, and no time: a new number of the step
    commits the last trial, and all steps have the same duration.

    The format is that of version 2.0.1 (DataExchange, Xu Huang, University of Toronto, 2021).
    """

    def __init__(self, first: bytes | bytearray, dt: float | None) -> None:
        self._header: tuple[int, ...] = HEADER.unpack(first)
        self.dofs, precision = self._header[6], self._header[4]
        if dt is None:
            raise WireError(
                "a client of UT-SIM sends no time: give the duration of its steps, step, in s"
            )
        if precision not in (1, 2) or not 1 <= self.dofs <= MOST_DOFS:
            raise WireError(
                f"a client of UT-SIM has {self.dofs} degrees of freedom of precision "
                f"{precision}: must be 1 to {MOST_DOFS} of precision 1 or 2"
            )
        self._dt, self._code = dt, "<f4" if precision == 1 else "<f8"
        self._step: int | None = None
        self._time = 0.0
        self._x = [0.0] * self.dofs
        self._data_follow = False

    @staticmethod
    def sends(data: bytes | bytearray) -> bool:
        """Return whether bytes begin like those of UT-SIM; in genericClient the third is zero."""
        return len(data) >= HEADER.size and data[1] == 0 and 1 <= data[2] <= 5 and 1 <= data[3] <= 8

    def _request(self, action: Action) -> Request:
        zeros = [0.0] * self.dofs
        return Request(action, self._x, zeros, zeros, self._time)

    def take(self, buffer: bytearray) -> list[Request]:
        """Remove messages from the buffer until one is a request, and return its content."""
        item = np.dtype(self._code).itemsize
        while len(buffer) >= (length := HEADER.size + self._data_follow * self.dofs * item):
            self._header = HEADER.unpack_from(buffer)
            data = np.frombuffer(bytes(buffer[HEADER.size : length]), self._code)
            del buffer[:length]
            command, number = self._header[1], self._header[7]
            if self._data_follow:
                self._data_follow = False
                return self._move(data.tolist(), number)
            if command == Action.SET_TRIAL:
                self._data_follow = True
            elif command == Action.END:
                return [*self.finish(), self._request(Action.END)]
            elif command in (Action.FORCE, Action.INITIAL_STIFFNESS):
                return [self._request(Action(command))]
            else:
                raise WireError(f"{command} is not a command of UT-SIM's elements")
        return []

    def _move(self, x: list[float], number: int) -> list[Request]:
        """Return a trial, after the commit of the last step if this is another one."""
        # The number of the step has 16 bits and begins again: the difference modulo 2^16 counts.
        requests = [] if number == self._step else self.finish()
        self._time += self._dt * (1 if self._step is None else (number - self._step) % STEPS)
        self._step, self._x = number, x
        return [*requests, self._request(Action.SET_TRIAL)]

    def reply(self, values: Sequence[float] | NDArray[np.float64], action: Action) -> bytes:
        """Return the answer to an action, with the content that the client wants."""
        content = self._header[5]
        numbers = np.ravel(values)
        if action == Action.FORCE:
            if content not in (FORCES, FORCES | DISPLACEMENTS):
                raise WireError(
                    f"a client of UT-SIM wants the content {content:#b}: must be forces, "
                    "or displacements and forces"
                )
            if content & DISPLACEMENTS:
                numbers = np.concatenate([self._x, numbers])
        return HEADER.pack(*self._header) + numbers.astype(self._code).tobytes()

    def nothing(self, action: Action) -> bytes:
        """Return an answer of NaN."""
        count = self.dofs**2 if action in MATRICES else self.dofs
        return self.reply(np.full(count, np.nan), action)

    def finish(self) -> list[Request]:
        """Return the commit of the last step, which no message commits."""
        return [] if self._step is None else [self._request(Action.COMMIT)]


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
