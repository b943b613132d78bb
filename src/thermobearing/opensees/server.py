"""The process that answers OpenSees: one loop over listeners, connections and its parent.

`thermobearing serve` runs it in the foreground, `thermobearing.opensees.serve` as a child process:
commands of the parent are pickled on the standard input, answers on the standard output. The end
of the standard input is the end of the parent, on every system.

No client can hold the others up. In each round the connections that have used the least time of
the server have a turn, in which a bounded number of messages is answered: a client that sends
without a pause has the time that others leave. An answer that a client does not read stays in a
buffer of its connection, and no request of this client is carried out meanwhile, so that the buffer
holds one answer at most.
"""

import contextlib
import errno
import heapq
import os
import pickle
import queue
import selectors
import shutil
import signal
import socket
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from thermobearing.border.errors import InputError
from thermobearing.opensees import wire
from thermobearing.opensees.case import Layout, ServedCase
from thermobearing.opensees.element import ServedElement, StepError, finite
from thermobearing.opensees.keeper import Keeper, send_nan
from thermobearing.opensees.recording import JOURNAL, Journal, Served
from thermobearing.opensees.wire import Action

MAX_NOTES = 20
MAX_PROBLEMS = 100
MORE_PROBLEMS = "further problems are not listed"
RECEIVED_AT_ONCE = 1 << 16  # [bytes]
SHARE_IN_ROUND = 8  # one of so many connections with messages has a turn
TURNS_AT_ONCE = 16  # of a connection whose last messages may have arrived
LOOPBACK = "127.0.0.1"
# Without descriptors or memory, `accept` fails at once and the listener stays readable.
NO_ROOM = {errno.EMFILE, errno.ENFILE, errno.ENOBUFS, errno.ENOMEM}
ShowMessage = Callable[[str], None]


class Limits(NamedTuple):
    """What a client may ask of a server."""

    messages: int = 3  # in one turn: OpenSees sends a trial twice, then asks for the force
    tick: float = 0.5  # between two looks at the clock, and writings of histories [s]
    message_time: float = 10.0  # for the rest of a message [s]
    reading_time: float = 20.0  # in which a client reads no answer before it receives NaN [s]
    closing_time: float = 60.0  # in which it does not read NaN either before it is closed [s]
    accept_pause: float = 1.0  # after a connection for which there is no room [s]
    nan_pause: float = 0.005  # between two rounds of sending NaN [s]


class Connection:
    """One `genericClient` element that has connected."""

    def __init__(self, client: socket.socket, layout: Layout, tag: int, run: int) -> None:
        self.client, self.layout, self.tag, self.run = client, layout, tag, run
        self.buffer = bytearray()
        self.since = 0.0  # when the first bytes of an unfinished message arrived
        self.setup: wire.Setup | None = None
        self.element: ServedElement | None = None
        self.lost = False  # receives NaN from now on
        self.answered = False  # whether the last bytes received had an answer
        self.time_used = 0.0  # of the server; half of it is forgotten at each look at the clock [s]
        self.backlog = False  # whether the buffer may hold a complete message
        self.outgoing = bytearray()  # the rest of an answer
        self.events = 0  # for which the selector waits
        self.unread_since = 0.0  # when the client last read a part of an answer that waits
        self.reads = True  # whether it was not given up because it reads no answers

    def __str__(self) -> str:
        return f"element {self.tag}"


class Server:
    """Listeners and connections of one process; `show` takes messages for the user at once."""

    def __init__(
        self,
        case: ServedCase,
        show: ShowMessage,
        keeper: Keeper | None = None,
        journal: Journal | None = None,
        limits: Limits | None = None,
    ) -> None:
        self.case, self._show, self._keeper, self._journal = case, show, keeper, journal
        self._limits = limits or Limits()
        self.problems: list[str] = []  # each ended the service of an element
        self.notes: list[str] = []  # steps that failed, and that OpenSees may have repeated
        self.stopped = False
        self._selector = selectors.DefaultSelector()
        self._listeners: dict[socket.socket, Callable[[], None]] = {}
        self._paused: dict[socket.socket, float] = {}  # listeners, and when they go on
        self._open: dict[socket.socket, Connection] = {}
        self._lost: list[Connection] = []
        self._backlog: set[Connection] = set()
        self._ended: list[Connection] = []  # with a history
        self._count = 0  # of connections so far
        self._runs: dict[int, int] = {}
        self._last_tick = self._last_nan = 0.0
        self._done: Callable[[], bool] = lambda: False

    def listen(self, layout: Layout, tag: int | None, address: str, port: int) -> int:
        """Listen for an element, or several without a tag; return the port (0 takes a free one)."""
        try:
            listener = socket.create_server((address, port), backlog=128)
        except (OSError, OverflowError, UnicodeError) as error:
            reason = getattr(error, "strerror", None) or error
            raise InputError(
                f"port = {port}: cannot listen at {address}: {reason}; choose another port, or 0 "
                "for a free one"
            ) from None
        listener.setblocking(False)

        def _accept() -> None:
            self._accept(listener, layout, tag)

        self._listeners[listener] = _accept
        self._selector.register(listener, selectors.EVENT_READ, _accept)
        return int(listener.getsockname()[1])

    def _accept(self, listener: socket.socket, layout: Layout, tag: int | None) -> None:
        try:
            client, _ = listener.accept()
        except OSError as error:
            if error.errno in NO_ROOM:
                self._pause_listener(listener, error)
            return  # otherwise it was gone before it was accepted
        number = len(self._runs) + 1 if tag is None else tag
        for predecessor in self._served(number):
            self._answer_what_has_arrived(predecessor)  # its end, perhaps
        run = self._runs[number] = self._runs.get(number, 0) + 1
        client.setblocking(False)
        wire.prepare(client)
        wire.acknowledge(client)
        connection = Connection(client, layout, number, run)
        # Otherwise a client that connects again and again would always come first.
        used = [peer.time_used for peer in self._open.values()]
        connection.time_used = max(used, default=0.0)
        occupied = bool(self._served(number))
        self._open[client] = connection
        self._count += 1
        if self._keeper is not None:
            self._keeper.add(client)
        if occupied:
            self.problem(connection, "a second client connects while the first is served")
            self._give_up(connection)
        self._update_events(connection)

    def _served(self, tag: int) -> list[Connection]:
        """Return the connections of an element that receive true answers."""
        return [
            connection
            for connection in self._open.values()
            if connection.tag == tag and not connection.lost
        ]

    def _pause_listener(self, listener: socket.socket, error: OSError) -> None:
        """Accept nothing for a while; the client waits in the queue of the system."""
        self._selector.unregister(listener)
        self._paused[listener] = time.monotonic() + self._limits.accept_pause
        self._keep_note(f"a connection cannot be accepted yet: {error.strerror or error}")

    def watch(self, file: Any, handle: Callable[[], None]) -> None:
        """Call a function whenever something can be read from a socket."""
        self._selector.register(file, selectors.EVENT_READ, handle)

    def run(self, done: Callable[[], bool] = lambda: False) -> None:
        """Serve until stopped, or until `done`, which is looked at every half a second."""
        self._done = done
        while not self.stopped:
            ready = set(self._backlog)
            for key, _ in self._selector.select(self._longest_wait()):
                if not isinstance(key.data, Connection):
                    key.data()
                elif key.data.outgoing:
                    self._send_rest(key.data)
                else:
                    ready.add(key.data)
            # The others are ready in the next round again, together with those that come first.
            count = -(-len(ready) // SHARE_IN_ROUND)
            for connection in heapq.nsmallest(count, ready, key=lambda waiting: waiting.time_used):
                self._serve_turn(connection)
                # In the loop, since there may be hundreds of connections: the keeper ends a
                # server that gives no sign of life.
                self._look_at_clock()
            self._look_at_clock()
        self.catch_up()

    def _longest_wait(self) -> float:
        """Return how long the loop may wait for events [s]."""
        if self._backlog:
            return 0.0
        return self._limits.nan_pause if self._lost else self._limits.tick

    def _look_at_clock(self) -> None:
        """Do what is due at certain times: NaN, sign of life, time limits, histories, the end."""
        now = time.monotonic()
        if now - self._last_nan > self._limits.nan_pause:
            self._last_nan = now
            self._send_nan(now)
        if now - self._last_tick <= self._limits.tick:
            return
        self._last_tick = now
        if self._keeper is not None:
            self._keeper.report_progress()
        self._check_time_limits(now)
        self.flush()
        if self._done():
            self.stopped = True

    def expect_silence(self) -> None:
        """Let the keeper expect no sign of life until `run` goes on: kernels are compiled."""
        if self._keeper is not None:
            self._keeper.expect_silence()

    @property
    def clients(self) -> tuple[int, int]:
        """Numbers of connections that are open, and of all so far."""
        return len(self._open), self._count

    def problem(self, connection: Connection, text: str) -> None:
        """Keep and show what went wrong with an element."""
        self.fail(f"{connection}: {text}")

    def fail(self, message: str) -> None:
        """Keep and show why the service ended for an element, or for all."""
        # A program that connects again and again must not fill the memory with its problems.
        if message in self.problems or len(self.problems) > MAX_PROBLEMS:
            return
        if len(self.problems) == MAX_PROBLEMS:
            message = MORE_PROBLEMS
        self.problems.append(message)
        self._show(message)

    def note(self, connection: Connection, text: str) -> None:
        """Keep a step that failed; show the first ones."""
        self._keep_note(f"{connection}: {text}")

    def _keep_note(self, message: str) -> None:
        if len(self.notes) < MAX_NOTES and message not in self.notes:
            self.notes.append(message)
            self._show(message)

    def _serve_turn(self, connection: Connection) -> bool:
        """Answer a bounded number of messages; return whether there may be others."""
        if connection.client not in self._open or connection.lost or connection.outgoing:
            return False
        received, begun = True, time.perf_counter()
        self._backlog.discard(connection)
        try:
            received = connection.backlog or self._receive(connection)
            if received and connection.client in self._open:
                connection.backlog = self._answer_messages(connection)
                if not connection.answered:  # else the answer has acknowledged
                    wire.acknowledge(connection.client)
        except (wire.WireError, StepError, InputError) as error:
            self.problem(connection, str(error))
            self._give_up(connection)
        except OSError as error:
            self._close(connection, f"an answer could not be sent: {error.strerror or error}")
        except Exception as error:  # of one element: others are served
            self.problem(connection, f"its bearing failed: {type(error).__name__}: {error}")
            self._give_up(connection)
        self._update_events(connection)
        connection.time_used += time.perf_counter() - begun
        return received

    def catch_up(self) -> None:
        """Answer what clients have sent before a signal or a command, which is in their history."""
        for connection in list(self._open.values()):
            self._answer_what_has_arrived(connection)

    def _answer_what_has_arrived(self, connection: Connection) -> None:
        """Give a connection several turns at once."""
        # A client that sends without a pause would never come to an end.
        for _ in range(TURNS_AT_ONCE):
            if not self._serve_turn(connection):
                return

    def _receive(self, connection: Connection) -> bool:
        """Take what has arrived into the buffer; return whether there was something."""
        try:
            data = connection.client.recv(RECEIVED_AT_ONCE)
        except BlockingIOError:
            return False
        except OSError as error:
            self._close(connection, f"the connection was lost: {error.strerror or error}")
            return False
        if not data:
            cut = f"OpenSees closed it after {len(connection.buffer)} bytes of a message"
            self._close(connection, cut if connection.buffer else "")
            return False
        connection.buffer += data
        connection.answered = False
        return True

    def _answer_messages(self, connection: Connection) -> bool:
        """Answer complete messages in the buffer; return whether others may be there."""
        buffer = connection.buffer
        if connection.setup is None:
            if len(buffer) < wire.SETUP.size:
                connection.since = connection.since or time.monotonic()
                return False
            self._begin(connection, wire.Setup.decode(bytes(buffer[: wire.SETUP.size])))
            del buffer[: wire.SETUP.size]
        setup, element = connection.setup, connection.element
        assert setup is not None
        assert element is not None
        for _ in range(self._limits.messages):
            request = setup.take(buffer)
            if request is None:
                connection.since = time.monotonic() if buffer else 0.0
                return False
            if request.action == Action.END:
                self._close(connection, "")
                return False
            self._answer(connection, element, request, setup)
            if connection.outgoing:
                break
        connection.since = 0.0
        return bool(buffer)

    def _begin(self, connection: Connection, setup: wire.Setup) -> None:
        """Begin to serve an element whose sizes are known."""
        layout = connection.layout
        connection.setup = setup
        if setup.dofs != layout.size:
            raise wire.WireError(
                f"OpenSees lists {setup.dofs} degrees of freedom, but the bearing has "
                f"{layout.size}: {len(layout.dofs)} ({', '.join(map(str, layout.dofs))}) of each "
                f"of {2 * layout.pairs} nodes; use the arguments of line.element()"
            )
        connection.element = ServedElement(
            self.case, layout, connection.tag, connection.run, self._journal
        )

    def _answer(
        self,
        connection: Connection,
        element: ServedElement,
        request: wire.Request,
        setup: wire.Setup,
    ) -> None:
        """Carry out one request; NaN answers a step that fails, so that OpenSees tries another."""
        connection.answered = request.action not in wire.SILENT
        if request.action in wire.ZERO:
            self._send(connection, setup.reply([]))
            return
        try:
            values = element.answer(request)
        except StepError as error:
            if request.action != Action.COMMIT:
                self.note(connection, str(error))
            else:
                raise StepError(f"OpenSees committed a step that had failed: {error}") from None
            self._send(connection, setup.without_result())
            return
        if element.note:
            self.note(connection, element.note)
        if request.action in wire.SILENT:
            return
        assert values is not None
        if not finite(values):
            raise StepError(f"the answer to {request.action.name} is not finite")
        self._send(connection, setup.reply(values))

    def _send(self, connection: Connection, data: bytes) -> None:
        """Send an answer; what does not fit into the buffer of the system is sent later."""
        try:
            sent = connection.client.send(data)
        except BlockingIOError:
            sent = 0
        if sent < len(data):
            connection.outgoing += memoryview(data)[sent:]
            connection.unread_since = time.monotonic()

    def _send_rest(self, connection: Connection) -> None:
        """Send more of an answer that waits; requests are carried out again after its end."""
        try:
            sent = connection.client.send(connection.outgoing)
        except BlockingIOError:
            return
        except OSError as error:
            self._close(connection, f"an answer could not be sent: {error.strerror or error}")
            return
        del connection.outgoing[:sent]
        connection.unread_since = time.monotonic()
        if not connection.outgoing:
            connection.backlog = bool(connection.buffer)
            self._update_events(connection)

    def _update_events(self, connection: Connection) -> None:
        """Wait for those events of a connection that its state needs, or put it in the backlog."""
        client = connection.client
        if client not in self._open:
            return
        if connection.lost:
            events = 0
        elif connection.outgoing:
            events = selectors.EVENT_WRITE
        elif connection.backlog:
            events = 0
            self._backlog.add(connection)
        else:
            events = selectors.EVENT_READ
        if events == connection.events:
            return
        if connection.events:
            self._selector.unregister(client)
        if events:
            self._selector.register(client, events, connection)
        connection.events = events

    def _give_up(self, connection: Connection) -> None:
        """Send NaN from now on: the element cannot be served, and must not wait for ever."""
        connection.lost = True
        self._lost.append(connection)
        connection.unread_since = time.monotonic()
        self._update_events(connection)

    def _send_nan(self, now: float) -> None:
        """Answer the elements that cannot be served."""
        for connection in list(self._lost):
            sent = send_nan(connection.client)
            if sent is None:
                self._close(connection, "")
            elif sent:
                connection.unread_since = now

    def _close(self, connection: Connection, problem: str) -> None:
        """Close a connection that OpenSees has closed; its history is kept."""
        if problem:
            self.problem(connection, problem)
        client = connection.client
        if connection.events:
            self._selector.unregister(client)
        del self._open[client]
        self._backlog.discard(connection)
        if connection.lost:
            self._lost.remove(connection)
        if connection.element is not None:
            connection.element.flush()
            self._ended.append(connection)
        with contextlib.suppress(OSError):
            client.shutdown(socket.SHUT_RDWR)
        client.close()

    def _check_time_limits(self, now: float) -> None:
        """Give up clients that do not go on, and let paused listeners accept again."""
        limits = self._limits
        for connection in list(self._open.values()):
            connection.time_used *= 0.5
            if connection.lost:
                # An analysis that has failed may pause for hours without reading: it is not
                # closed, since OpenSees would then go round for ever in its next step.
                if not connection.reads and now - connection.unread_since > limits.closing_time:
                    self._close(connection, "")
            elif connection.outgoing and now - connection.unread_since > limits.reading_time:
                connection.reads = False
                self.problem(
                    connection,
                    f"OpenSees has not read an answer for {limits.reading_time:g} s; it receives "
                    f"NaN, and is disconnected after {limits.closing_time:g} s without reading",
                )
                self._give_up(connection)
            elif connection.since and now - connection.since > limits.message_time:
                self.problem(
                    connection,
                    f"the rest of a message did not arrive: {len(connection.buffer)} bytes in "
                    f"{limits.message_time:g} s",
                )
                self._give_up(connection)
        for listener in [paused for paused, end in self._paused.items() if now >= end]:
            del self._paused[listener]
            self._selector.register(listener, selectors.EVENT_READ, self._listeners[listener])

    def reset(self) -> None:
        """Put all bearings of open connections at the start."""
        for connection in self._open.values():
            if connection.element is not None:
                connection.element.reset()

    def flush(self) -> None:
        """Write the histories so far into the journal, where a killed server leaves them."""
        for connection in self._open.values():
            if connection.element is not None:
                connection.element.flush()
        if self._journal is not None and self._journal.problem:
            self._keep_note(self._journal.problem)

    def histories(self) -> list[Served]:
        """Return the histories of all elements so far, in the order in which they began."""
        self.flush()
        connections = [*self._ended, *self._open.values()]
        elements = [connection.element for connection in connections]
        return [
            history
            for element in elements
            if element is not None
            for history in element.histories()
        ]

    def close(self) -> None:
        """Stop listening; the keeper answers what is still connected."""
        self.stopped = True
        self.flush()
        for listener in self._listeners:
            listener.close()
        self._selector.close()
        if self._keeper is not None:
            self._keeper.release(stay=bool(self._open))


def load_kernels(case: ServedCase, directions: Sequence[int] = (1,)) -> None:
    """Load the kernels, or compile them, which may take a minute, before anybody waits."""
    ServedElement(case, Layout.of(1, tuple(directions), None, "serve"), 0)


def serve_until(
    case: ServedCase,
    layout: Layout,
    address: str,
    port: int,
    *,
    once: bool,
    show: ShowMessage,
    save: Callable[[list[Served]], None] | None = None,
) -> Server:
    """Serve elements at a port until Ctrl-C, or `once`, until the last element has left.

    `save` takes the histories if this process is killed, and runs in another process then.
    """
    journal = Journal(tempfile.TemporaryFile())  # noqa: SIM115 - open as long as the server
    keeper = Keeper.start(save=None if save is None else lambda: save(journal.histories()))
    server = Server(case, show, keeper, journal)
    port = server.listen(layout, None, address, port)
    load_kernels(case, layout.directions)

    def _stop(*_: Any) -> None:
        server.stopped = True

    def _all_left() -> bool:
        open_now, all_so_far = server.clients
        return once and all_so_far > 0 and not open_now

    handlers = {number: signal.signal(number, _stop) for number in (signal.SIGINT, signal.SIGTERM)}
    dofs = " ".join(["-dof", *map(str, layout.dofs)])
    try:
        show(
            f"serving {case.bearing.name} at {address}, port {port}, in {case.units}-s; "
            f"{2 * layout.pairs} nodes with {dofs}; Ctrl-C ends"
        )
        server.run(_all_left)
    except Exception as error:  # what was served is saved all the same
        server.fail(f"the server failed: {type(error).__name__}: {error}")
    finally:
        server.close()
        for number, handler in handlers.items():
            signal.signal(number, handler)
    return server


class _Child:
    """The server as a child of a Python process: commands in, answers out."""

    def __init__(self) -> None:
        keeper = Keeper.start()  # before the copy of the standard output, whose end must be seen
        self._answers = os.fdopen(os.dup(1), "wb")
        os.dup2(2, 1)  # what is printed by accident is no answer
        self._parent = os.getppid()
        self.case: ServedCase
        self.case, self._folder = pickle.load(sys.stdin.buffer)
        journal = Journal(Path(self._folder, JOURNAL).open("w+b"))  # noqa: SIM115 - as above
        self.server = Server(self.case, self._show, keeper, journal)
        load_kernels(self.case)
        self._commands: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._wake_sender, self._wake_receiver = socket.socketpair()
        self.server.watch(self._wake_receiver, self._carry_out_command)
        self._reply(None)

    @staticmethod
    def _show(message: str) -> None:
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
            self._wake_sender.send(b"!")

    def _carry_out_command(self) -> None:
        self._wake_receiver.recv(1)
        command = self._commands.get()
        if command is None:
            self.server.stopped = True
            return
        server, (name, *arguments) = self.server, command
        server.catch_up()
        commands: dict[str, Callable[..., Any]] = {
            "listen": self._wait_for_element,
            "problems": lambda: (list(server.problems), list(server.notes)),
            "histories": server.histories,
            "reset": server.reset,
        }
        try:
            answer = commands[name](*arguments)
        except Exception as error:
            answer = error
        self._reply(answer)

    def remove_journal_of_nobody(self) -> None:
        """Remove the folder of the journal if the parent has ended, which removes it otherwise."""
        if os.getppid() != self._parent:
            shutil.rmtree(self._folder, ignore_errors=True)

    def _wait_for_element(self, layout: Layout, tag: int | None) -> int:
        if len(layout.directions) > 1:
            self.server.expect_silence()
            load_kernels(self.case, layout.directions)
        return self.server.listen(layout, tag, LOOPBACK, 0)


def main() -> None:
    """Serve as a child process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides
    child = _Child()

    def _stop(*_: Any) -> None:
        child.server.stopped = True

    signal.signal(signal.SIGTERM, _stop)
    threading.Thread(target=child.listen, daemon=True).start()
    try:
        child.server.run()
    except Exception as error:
        child.server.fail(f"the server failed: {type(error).__name__}: {error}")
        child.server.close()  # the parent reads the histories from the journal
        os._exit(1)
    child.server.close()
    child.remove_journal_of_nobody()
    os._exit(0)  # the thread may be waiting for the standard input


if __name__ == "__main__":
    main()
