"""The process that answers OpenSees: one loop over listeners, connections and its parent.

`thermobearing serve` runs it in the foreground, `thermobearing.opensees.serve` as a child process:
commands of the parent are pickled on the standard input, answers on the standard output. The end
of the standard input is the end of the parent, on every system.
"""

import contextlib
import os
import pickle
import queue
import selectors
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Sequence
from typing import Any

from thermobearing.border.errors import InputError
from thermobearing.opensees import wire
from thermobearing.opensees.case import Layout, ServedCase
from thermobearing.opensees.element import Served, ServedElement, StepError, finite
from thermobearing.opensees.keeper import Keeper, flood

HALF = 10.0  # longest time for the rest of a message [s]
TICK = 0.5  # between two looks at unfinished messages [s]
FULL = 20.0  # longest time in which OpenSees does not read an answer [s]
MOST_NOTES = 20
CHUNK = 1 << 20
LOOPBACK = "127.0.0.1"
Say = Callable[[str], None]


class Connection:
    """One `genericClient` element that has connected."""

    def __init__(self, client: socket.socket, layout: Layout, tag: int, run: int) -> None:
        self.client, self.layout, self.tag, self.run = client, layout, tag, run
        self.buffer = bytearray()
        self.since = 0.0  # when the first bytes of an unfinished message arrived
        self.setup: wire.Setup | wire.UtSim | None = None
        self.element: ServedElement | None = None
        self.lost = False  # receives NaN from now on
        self.answered = False  # whether the last bytes received had an answer

    def __str__(self) -> str:
        return f"element {self.tag}"


class Server:
    """Listeners and connections of one process; `say` takes messages for the user at once."""

    def __init__(self, case: ServedCase, say: Say, keeper: Keeper | None = None) -> None:
        self.case, self._say, self._keeper = case, say, keeper
        self.problems: list[str] = []  # each ended the service of an element
        self.notes: list[str] = []  # steps that failed, and that OpenSees may have repeated
        self.stopped = False
        self._selector = selectors.DefaultSelector()
        self._listeners: list[socket.socket] = []
        self._open: dict[socket.socket, Connection] = {}
        self._ended: list[Connection] = []
        self._runs: dict[int, int] = {}
        self._looked = 0.0

    def listen(self, layout: Layout, tag: int | None, address: str, port: int) -> int:
        """Listen for an element, or several without a tag; return the port (0 takes a free one)."""
        try:
            listener = socket.create_server((address, port), backlog=128)
        except (OSError, OverflowError) as error:
            why = getattr(error, "strerror", None) or error
            raise InputError(
                f"port = {port}: cannot listen at {address}: {why}; choose another port, or 0 for "
                "a free one"
            ) from None
        listener.setblocking(False)
        self._listeners.append(listener)

        def _accept() -> None:
            self._accept(listener, layout, tag)

        self._selector.register(listener, selectors.EVENT_READ, _accept)
        return int(listener.getsockname()[1])

    def _accept(self, listener: socket.socket, layout: Layout, tag: int | None) -> None:
        try:
            client, _ = listener.accept()
        except OSError:
            return  # gone before it was accepted
        number = len(self._runs) + 1 if tag is None else tag
        for earlier in [one for one in self._open.values() if one.tag == number]:
            if not earlier.lost:
                self._receive(earlier)  # its end may have arrived
        run = self._runs[number] = self._runs.get(number, 0) + 1
        client.setblocking(False)
        wire.prepare(client)
        wire.acknowledge(client)
        connection = Connection(client, layout, number, run)
        if any(other.tag == number and not other.lost for other in self._open.values()):
            self.problem(connection, "a second client connects while the first is served")
            connection.lost = True
        self._open[client] = connection
        if self._keeper is not None:
            self._keeper.hold(client)
        if connection.lost:
            self._drown(connection)
        else:
            self._selector.register(client, selectors.EVENT_READ, lambda: self._receive(connection))

    def watch(self, file: Any, handle: Callable[[], None]) -> None:
        """Call a function whenever something can be read from a socket."""
        self._selector.register(file, selectors.EVENT_READ, handle)

    def run(self, done: Callable[[], bool] = lambda: False) -> None:
        """Serve until stopped, or until `done`, which is looked at every half a second."""
        while not self.stopped:
            for key, _ in self._selector.select(TICK):
                key.data()
            now = time.monotonic()
            if now - self._looked > TICK:
                self._looked = now
                if self._keeper is not None:
                    self._keeper.alive()
                self._look_for_halves(now)
                if done():
                    return

    def expect_silence(self) -> None:
        """Let the keeper expect no sign of life until `run` goes on: kernels are compiled."""
        if self._keeper is not None:
            self._keeper.pause()

    @property
    def clients(self) -> tuple[int, int]:
        """Numbers of connections that are open, and of all so far."""
        return len(self._open), len(self._open) + len(self._ended)

    def problem(self, connection: Connection, text: str) -> None:
        """Keep and say what went wrong with an element."""
        message = f"{connection}: {text}"
        if message not in self.problems:
            self.problems.append(message)
            self._say(message)

    def note(self, connection: Connection, text: str) -> None:
        """Keep a step that failed; say the first ones."""
        message = f"{connection}: {text}"
        if len(self.notes) < MOST_NOTES and message not in self.notes:
            self.notes.append(message)
            self._say(message)

    def _receive(self, connection: Connection) -> None:
        """Answer messages until none is left, which is quicker than to look for each."""
        client = connection.client
        while client in self._open and not connection.lost:
            try:
                data = client.recv(CHUNK)
            except BlockingIOError:
                return
            except OSError as error:
                self._leave(connection, f"the connection was lost: {error.strerror or error}")
                return
            if not data:
                cut = f"OpenSees closed it after {len(connection.buffer)} bytes of a message"
                self._finish(connection)
                self._leave(connection, cut if connection.buffer else "")
                return
            connection.buffer += data
            connection.answered = False
            try:
                self._answer_all(connection)
                if not connection.answered:  # else the answer has acknowledged
                    wire.acknowledge(client)
            except (wire.WireError, StepError, InputError) as error:
                self.problem(connection, str(error))
                self._drown(connection)
            except OSError as error:
                self._leave(connection, f"an answer could not be sent: {error.strerror or error}")

    def _answer_all(self, connection: Connection) -> None:
        """Answer the complete messages in the buffer."""
        buffer = connection.buffer
        if connection.setup is None:
            if wire.UtSim.sends(buffer):
                self._begin(connection, wire.UtSim(buffer[: wire.HEADER.size], self.case.step))
                del buffer[: wire.HEADER.size]
            elif len(buffer) >= wire.SETUP.size:
                self._begin(connection, wire.Setup.decode(bytes(buffer[: wire.SETUP.size])))
                del buffer[: wire.SETUP.size]
            else:
                connection.since = connection.since or time.monotonic()
                return
        setup, element = connection.setup, connection.element
        assert setup is not None
        assert element is not None
        while requests := setup.take(buffer):
            for request in requests:
                if request.action == wire.Action.END:
                    self._leave(connection, "")
                    return
                self._answer(connection, element, request, setup)
        connection.since = time.monotonic() if buffer else 0.0

    def _begin(self, connection: Connection, setup: wire.Setup | wire.UtSim) -> None:
        """Begin to serve an element whose sizes are known."""
        layout = connection.layout
        connection.setup = setup
        if setup.dofs != layout.size:
            raise wire.WireError(
                f"OpenSees lists {setup.dofs} degrees of freedom, but the bearing has "
                f"{layout.size}: {len(layout.dofs)} ({', '.join(map(str, layout.dofs))}) of each "
                f"of {2 * layout.pairs} nodes; use the arguments of line.element()"
            )
        connection.element = ServedElement(self.case, layout, connection.tag, connection.run)

    def _answer(
        self,
        connection: Connection,
        element: ServedElement,
        request: wire.Request,
        setup: wire.Setup | wire.UtSim,
    ) -> None:
        """Carry out one request; NaN answers a step that fails, so that OpenSees tries another."""
        connection.answered = request.action not in wire.SILENT
        if request.action in wire.ZERO:
            _send(connection.client, setup.reply([], request.action))
            return
        try:
            values = element.answer(request)
        except StepError as error:
            if request.action != wire.Action.COMMIT:
                self.note(connection, str(error))
            else:
                raise StepError(f"OpenSees committed a step that had failed: {error}") from None
            _send(connection.client, setup.nothing(request.action))
            return
        if element.note:
            self.note(connection, element.note)
        if request.action in wire.SILENT:
            return
        assert values is not None
        if not finite(values):
            raise StepError(f"the answer to {request.action.name} is not finite")
        _send(connection.client, setup.reply(values, request.action))

    @staticmethod
    def _finish(connection: Connection) -> None:
        """Commit the last step of a client that does not do so itself, unless it failed."""
        if connection.setup is not None and connection.element is not None:
            with contextlib.suppress(StepError):
                for request in connection.setup.finish():
                    connection.element.answer(request)

    def _drown(self, connection: Connection) -> None:
        """Send NaN from now on: the element cannot be served, and must not wait for ever."""
        connection.lost = True
        client = connection.client
        if client in self._selector.get_map():
            self._selector.unregister(client)

        def _flood() -> None:
            if not flood(client):
                self._leave(connection, "")

        both = selectors.EVENT_READ | selectors.EVENT_WRITE
        self._selector.register(client, both, _flood)

    def _leave(self, connection: Connection, why: str) -> None:
        """Close a connection that OpenSees has closed; its history is kept."""
        if why:
            self.problem(connection, why)
        client = connection.client
        if client in self._selector.get_map():
            self._selector.unregister(client)
        del self._open[client]
        self._ended.append(connection)
        with contextlib.suppress(OSError):
            client.shutdown(socket.SHUT_RDWR)
        client.close()

    def _look_for_halves(self, now: float) -> None:
        for connection in list(self._open.values()):
            if connection.since and now - connection.since > HALF and not connection.lost:
                count = len(connection.buffer)
                self.problem(
                    connection, f"the rest of a message did not arrive: {count} bytes in {HALF:g} s"
                )
                self._drown(connection)

    def reset(self) -> None:
        """Put all bearings of open connections at the start."""
        for connection in self._open.values():
            if connection.element is not None:
                connection.element.reset()

    def histories(self) -> list[Served]:
        """Return the histories of all elements so far, in the order in which they began."""
        everyone = [*self._ended, *self._open.values()]
        elements = [one.element for one in everyone if one.element is not None]
        return [history for element in elements for history in element.histories()]

    def close(self) -> None:
        """Stop listening; the keeper answers what is still connected."""
        self.stopped = True
        for listener in self._listeners:
            listener.close()
        self._selector.close()
        if self._keeper is not None:
            self._keeper.release(stay=bool(self._open))


def _send(client: socket.socket, data: bytes) -> None:
    """Send an answer; OSError if OpenSees does not read it."""
    try:
        sent = client.send(data)
    except BlockingIOError:
        sent = 0
    if sent < len(data):  # a large matrix
        client.settimeout(FULL)
        try:
            client.sendall(memoryview(data)[sent:])
        finally:
            client.setblocking(False)


def load_kernels(case: ServedCase, directions: Sequence[int] = (1,)) -> None:
    """Load the kernels, or compile them, which may take a minute, before anybody waits."""
    ServedElement(case, Layout.of(1, tuple(directions), None, "serve"), 0)


def serve_until(
    case: ServedCase, layout: Layout, address: str, port: int, *, once: bool, say: Say
) -> Server:
    """Serve elements at a port until Ctrl-C, or `once`, until the last element has left."""
    server = Server(case, say, Keeper.start())
    port = server.listen(layout, None, address, port)
    load_kernels(case, layout.directions)

    def _stop(*_: Any) -> None:
        server.stopped = True

    def _all_left() -> bool:
        still, all_of_them = server.clients
        return once and all_of_them > 0 and not still

    earlier = {one: signal.signal(one, _stop) for one in (signal.SIGINT, signal.SIGTERM)}
    dofs = " ".join(["-dof", *map(str, layout.dofs)])
    try:
        say(
            f"serving {case.bearing.name} at {address}, port {port}, in {case.units}-s; "
            f"{2 * layout.pairs} nodes with {dofs}; Ctrl-C ends"
        )
        server.run(_all_left)
    finally:
        server.close()
        for one, handler in earlier.items():
            signal.signal(one, handler)
    return server


class _Child:
    """The server as a child of a Python process: commands in, answers out."""

    def __init__(self) -> None:
        keeper = Keeper.start()  # before the copy of the standard output, whose end must be seen
        self._answers = os.fdopen(os.dup(1), "wb")
        os.dup2(2, 1)  # what is printed by accident is no answer
        self.case: ServedCase = pickle.load(sys.stdin.buffer)
        self.server = Server(self.case, self._say, keeper)
        load_kernels(self.case)
        self._commands: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._bell, self._rung = socket.socketpair()
        self.server.watch(self._rung, self._obey)
        self._reply(None)

    @staticmethod
    def _say(message: str) -> None:
        sys.stderr.write(f"thermobearing: {message}\n")
        sys.stderr.flush()

    def _reply(self, answer: Any) -> None:
        try:
            pickle.dump(answer, self._answers)
            self._answers.flush()
        except OSError:
            self.server.stopped = True  # the parent is gone

    def listen(self) -> None:
        """Wait for commands; None, and the end of the parent, end the server."""
        command: Any = ()
        while command is not None:
            try:
                command = pickle.load(sys.stdin.buffer)
            except (EOFError, OSError, pickle.UnpicklingError):
                command = None
            self._commands.put(command)
            self._bell.send(b"!")

    def _obey(self) -> None:
        self._rung.recv(1)
        command = self._commands.get()
        if command is None:
            self.server.stopped = True
            return
        server, (name, *arguments) = self.server, command
        orders: dict[str, Callable[..., Any]] = {
            "listen": self._wait_for_element,
            "problems": lambda: (list(server.problems), list(server.notes)),
            "histories": server.histories,
            "reset": server.reset,
        }
        try:
            answer = orders[name](*arguments)
        except Exception as error:
            answer = error
        self._reply(answer)

    def _wait_for_element(self, layout: Layout, tag: int | None) -> int:
        if len(layout.directions) > 1:
            self.server.expect_silence()
            load_kernels(self.case, layout.directions)
        return self.server.listen(layout, tag, LOOPBACK, 0)


def main() -> None:
    """Serve as a child process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides
    child = _Child()
    threading.Thread(target=child.listen, daemon=True).start()
    child.server.run()
    child.server.close()
    os._exit(0)  # the thread may be waiting for the standard input


if __name__ == "__main__":
    main()
