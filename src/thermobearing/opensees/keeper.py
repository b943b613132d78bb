"""What keeps OpenSees from waiting for ever: NaN in place of answers that will not come.

The `genericClient` element of OpenSees waits without a limit for each answer, and goes round in an
endless loop where the connection is closed. openseespy does not run any Python code meanwhile. So a
connection of OpenSees must not be closed before OpenSees closes it, and must always be answered.
Where no true answer is possible the connection is flooded with NaN (all bits set, which needs no
alignment): the convergence test of OpenSees fails and `analyze` returns.

A keeper is a small process with copies of the connections. It does nothing until the server has
ended, for whatever reason (killed, out of memory), and then floods those that are open. A server
that gives no sign of life for a minute is ended, unless it has announced that it compiles kernels.
Systems without `fork` have no keeper.
"""

import contextlib
import os
import select
import signal
import socket
import time
from typing import Self

NOTHING = b"\xff" * 65536  # NaN, many times
PAUSE = 0.001  # of the keeper between two rounds [s]
STAY, LEAVE, QUIET, ALIVE, BUSY = b"s", b"l", b"q", b"a", b"b"
PATIENCE = 60.0  # of the keeper without a sign of life [s]
MESSAGE = (
    "thermobearing: the server of the bearings has ended during the analysis; OpenSees receives "
    "NaN from now on, so that its steps fail\n"
)


def flood(connection: socket.socket) -> bool:
    """Discard what has arrived, and send NaN as far as there is room; False once it is closed."""
    connection.setblocking(False)
    try:
        with contextlib.suppress(BlockingIOError):
            while received := connection.recv(len(NOTHING)):
                if len(received) < len(NOTHING):
                    break
            if not received:
                return False
        with contextlib.suppress(BlockingIOError):
            connection.send(NOTHING)
    except OSError:
        return False
    return True


class Keeper:
    """The process that holds copies of connections, seen from the server."""

    def __init__(self, channel: socket.socket) -> None:
        self._channel = channel

    @classmethod
    def start(cls, patience: float = PATIENCE) -> Self | None:
        """Start a keeper before any thread runs; None where the system has none."""
        if not hasattr(os, "fork") or not hasattr(socket, "send_fds"):
            return None
        ours, theirs = socket.socketpair()
        server = os.getpid()
        if os.fork() == 0:
            ours.close()
            try:
                _keep(theirs, server, patience)
            finally:
                os._exit(0)
        theirs.close()
        return cls(ours)

    def hold(self, connection: socket.socket) -> None:
        """Give the keeper a copy of a connection."""
        with contextlib.suppress(OSError):  # it was killed: the server works without
            socket.send_fds(self._channel, [STAY], [connection.fileno()])

    def alive(self) -> None:
        """Give a sign of life; from the first on the keeper expects others."""
        with contextlib.suppress(OSError):
            self._channel.send(ALIVE)

    def pause(self) -> None:
        """Expect no sign of life until the next one."""
        with contextlib.suppress(OSError):
            self._channel.send(BUSY)

    def release(self, *, stay: bool) -> None:
        """End the keeper, or let it flood the connections that are open."""
        with contextlib.suppress(OSError):
            self._channel.send(QUIET if stay else LEAVE)
            self._channel.close()


def _keep(channel: socket.socket, server: int, patience: float) -> None:
    """Hold connections until the server ends; flood them then until OpenSees closes them."""
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        signal.signal(getattr(signal, name), signal.SIG_IGN)
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1):  # readers of the output of the server must not wait for the keeper
        os.dup2(nowhere, stream)
    held: dict[int, socket.socket] = {}
    events = select.poll()
    events.register(channel, select.POLLIN)
    limit = None  # [ms]
    while True:
        found = events.poll(limit)
        if not found and os.getppid() == server:
            os.kill(server, signal.SIGKILL)
        for number, event in found:
            if number != channel.fileno():
                if event & (select.POLLHUP | select.POLLERR):  # the server closed it
                    events.unregister(number)
                    held.pop(number).close()
                continue
            data, numbers, _, _ = socket.recv_fds(channel, 1, 1)
            if data == LEAVE:
                return
            if not data:
                if held:
                    os.write(2, MESSAGE.encode())
                connections = list(held.values())
                while connections:  # until all are closed
                    connections = [one for one in connections if flood(one)]
                    time.sleep(PAUSE)
                return
            if data in (ALIVE, BUSY):
                limit = 1e3 * patience if data == ALIVE else None
            if data == QUIET:
                os.dup2(nowhere, 2)  # as above, and the end was wanted
            for new in numbers:
                held[new] = socket.socket(fileno=new)
                events.register(new, 0)  # no event but the end
