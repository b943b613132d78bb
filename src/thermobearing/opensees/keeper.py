"""What keeps OpenSees from waiting for ever: NaN in place of answers that will not come.

The `genericClient` element of OpenSees waits without a limit for each answer, and goes round in an
endless loop where the connection is closed. openseespy does not run any Python code meanwhile. So a
connection of OpenSees must not be closed before OpenSees closes it, and must always be answered.
Where no true answer is possible NaN is sent (all bits set, which needs no alignment): the
convergence test of OpenSees fails and `analyze` returns.

A keeper is a small process with copies of the connections. It does nothing until the server has
ended, for whatever reason (killed, out of memory). It then calls `save`, which keeps the histories,
and sends NaN through the connections that are open. A server that gives no sign of life for a
minute, unless it has announced that it compiles kernels, is asked to save its histories and end
(SIGTERM), and ended if it does not. Systems without `fork` have no keeper.
"""

import contextlib
import os
import select
import signal
import socket
import time
from collections.abc import Callable
from typing import Self

NAN_BYTES = b"\xff" * 65536  # NaN, many times
PAUSE = 0.001  # of the keeper between two rounds [s]
ADD, LEAVE, QUIET, ALIVE, BUSY = b"s", b"l", b"q", b"a", b"b"
PATIENCE = 60.0  # of the keeper without a sign of life [s]
GRACE = 5.0  # from the request to end until the server is killed [s]
MESSAGE = (
    "thermobearing: the server of the bearings has ended during the analysis; OpenSees receives "
    "NaN from now on, so that its steps fail\n"
)


def send_nan(connection: socket.socket) -> int | None:
    """Discard what has arrived, and send NaN as far as there is room.

    Returns the number of bytes sent, or None once the connection is closed.
    """
    connection.setblocking(False)
    try:
        # One buffer a call: a client that sends without a pause must not keep the caller here.
        with contextlib.suppress(BlockingIOError):
            if not connection.recv(len(NAN_BYTES)):
                return None
        with contextlib.suppress(BlockingIOError):
            return connection.send(NAN_BYTES)
    except OSError:
        return None
    return 0


class Keeper:
    """The process that holds copies of connections, seen from the server."""

    def __init__(self, channel: socket.socket) -> None:
        self._channel = channel

    @classmethod
    def start(
        cls,
        patience: float = PATIENCE,
        grace: float = GRACE,
        save: Callable[[], None] | None = None,
    ) -> Self | None:
        """Start a keeper before any thread runs; None where the system has none.

        `save` is called, in a process of its own, when the server has ended without `release`.
        """
        if not hasattr(os, "fork") or not hasattr(socket, "send_fds"):
            return None
        channel_of_server, channel_of_keeper = socket.socketpair()
        server = os.getpid()
        if os.fork() == 0:
            channel_of_server.close()
            try:
                _keep(channel_of_keeper, server, patience, grace, save)
            finally:
                os._exit(0)
        channel_of_keeper.close()
        return cls(channel_of_server)

    def add(self, connection: socket.socket) -> None:
        """Give the keeper a copy of a connection."""
        with contextlib.suppress(OSError):  # it was killed: the server works without
            socket.send_fds(self._channel, [ADD], [connection.fileno()])

    def report_progress(self) -> None:
        """Give a sign of life; from the first on the keeper expects others."""
        with contextlib.suppress(OSError):
            self._channel.send(ALIVE)

    def expect_silence(self) -> None:
        """Expect no sign of life until the next one."""
        with contextlib.suppress(OSError):
            self._channel.send(BUSY)

    def release(self, *, stay: bool) -> None:
        """End the keeper, or let it answer the connections that are open."""
        with contextlib.suppress(OSError):
            self._channel.send(QUIET if stay else LEAVE)
            self._channel.close()


def _keep(
    channel: socket.socket,
    server: int,
    patience: float,
    grace: float,
    save: Callable[[], None] | None,
) -> None:
    """Hold connections until the server ends; answer them then until OpenSees closes them."""
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        signal.signal(getattr(signal, name), signal.SIG_IGN)
    null_device = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1):  # readers of the output of the server must not wait for the keeper
        os.dup2(null_device, stream)
    connections: dict[int, socket.socket] = {}
    events = select.poll()
    events.register(channel, select.POLLIN)
    limit = None  # [ms]
    ending = False  # whether the server was asked to end
    while True:
        ready = events.poll(limit)
        # The parent is another process once the server has ended, and its number may be in use.
        if not ready and os.getppid() == server:
            # A server that is busy in Python still saves its histories; one that is stuck in
            # machine code, or stopped, does not, and is killed.
            os.kill(server, signal.SIGKILL if ending else signal.SIGTERM)
            ending, limit = True, 1e3 * grace
        for number, event in ready:
            if number != channel.fileno():
                if event & (select.POLLHUP | select.POLLERR):  # the server closed it
                    events.unregister(number)
                    connections.pop(number).close()
                continue
            message, numbers, _, _ = socket.recv_fds(channel, 1, 1)
            if message == LEAVE:
                return
            if not message:
                _take_over(list(connections.values()), save)
                return
            if message in (ALIVE, BUSY):
                ending, limit = False, 1e3 * patience if message == ALIVE else None
            if message == QUIET:
                os.dup2(null_device, 2)  # as above, and the end was wanted
                save = None
            for new in numbers:
                connections[new] = socket.socket(fileno=new)
                events.register(new, 0)  # no event but the end


def _take_over(connections: list[socket.socket], save: Callable[[], None] | None) -> None:
    """Save the histories of a server that has ended, and answer what is connected with NaN."""
    if connections:
        os.write(2, MESSAGE.encode())
    # OpenSees waits for its answer meanwhile, so that saving must not come first.
    if save is not None and os.fork() == 0:
        for connection in connections:
            connection.close()
        try:
            save()
        finally:
            os._exit(0)
    while connections:  # until all are closed
        connections = [connection for connection in connections if send_nan(connection) is not None]
        time.sleep(PAUSE)
