"""Random messages to a server of bearings, while ten clients exchange steps as OpenSees does.

Whatever is sent, the ten keep their bits and the server goes on. `make fuzz FUZZ=served` sends a
hundred thousand messages; `python -m tests.fuzz.test_served 100000 1` also prints how long the
exchanges take with and without them, which no test judges.
"""

import json
import os
import random
import re
import socket
import struct
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np
import pytest

import thermobearing as tb
from tests.fuzz.conftest import COUNT, SEED
from tests.unit.test_served import Client
from tests.verification.structures import follow
from thermobearing.opensees.server import LOOPBACK
from thermobearing.opensees.wire import Action, Request, Setup

BEARING, AMBIENT = "shen-hdr-bridge", -20
USUAL = 2000  # messages
HONEST = 10
STRANGE = (0.0, -1.0, 1e-300, 1e300, float("nan"), float("inf"), 1e6, 3.0)
MESSAGES_OF_A_SESSION = 100
CLIENTS = 3  # at the same time


class Outcome(NamedTuple):
    """What came of it."""

    rounds: list[float]  # duration of a step of all honest clients, one after another [s]
    quiet: list[float]  # the same without other clients
    same: bool  # whether the forces have the bits of the bearing itself
    sent: Counter[str]
    status: int | None  # of the server, which is to have gone on until it was asked to end


@contextmanager
def serving(folder: Path) -> "Iterator[tuple[subprocess.Popen[str], int]]":
    """The command, and its port."""
    words = ["serve", BEARING, "--ambient", str(AMBIENT), "--port", "0", "--no-figures", "--quiet"]
    command = [sys.executable, "-m", "thermobearing.cli", *words, "-o", str(folder / "out")]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as server:
        assert server.stderr is not None
        lines = iter(server.stderr)
        port = next(int(result[1]) for text in lines if (result := re.search(r"port (\d+)", text)))
        threading.Thread(target=lambda: list(lines), daemon=True).start()
        try:
            yield server, port
        finally:
            server.kill()


def exchange(
    clients: list[Client], start: int, go_on: Callable[[int], bool]
) -> tuple[list[float], list[float]]:
    """Make steps with all clients, one after another; return forces of the first and durations."""
    forces, durations, step = [], [], start
    while go_on(step - start):
        step += 1
        begun = time.perf_counter()
        of_step = {client.step(displacement(step), 0.01 * step) for client in clients}
        durations.append(time.perf_counter() - begun)
        (force,) = of_step  # equal for all
        forces.append(force)
    return forces, durations


def displacement(step: int) -> float:
    """Displacement of the honest clients [mm]."""
    return 20.0 * float(np.sin(0.05 * step))


def message(rng: random.Random, setup: Setup) -> tuple[str, bytes]:
    """One message, with its kind."""

    def numbers(count: int) -> list[float]:
        return [
            rng.choice(STRANGE) if rng.random() < 0.1 else rng.gauss(0, 5) for _ in range(count)
        ]

    kind = rng.choices(
        ["step", "request", "strange request", "bytes", "unknown action"], [60, 20, 10, 1, 1]
    )[0]
    n = setup.dofs
    if kind == "step":
        request = Request(
            Action.SET_TRIAL, [0.0, rng.gauss(0, 20)], [0.0, 1.0], [0.0] * n, rng.random()
        )
        return kind, request.encode(setup) + request._replace(action=Action.COMMIT).encode(setup)
    if kind == "bytes":
        return kind, rng.randbytes(rng.randrange(1, 2 * setup.length))
    if kind == "unknown action":
        return kind, struct.pack(f"={setup.size}d", *numbers(setup.size))
    action = rng.choice(list(Action)[:-1])
    values = [0.0, rng.gauss(0, 20)], [0.0, 1.0], [0.0] * n, rng.random()
    if kind == "strange request":
        values = numbers(n), numbers(n), numbers(n), numbers(1)[0]
    return kind, Request(action, *values).encode(setup)


def attack(port: int, count: int, seed: int) -> Counter[str]:
    """Send random messages in sessions, of which some read no answers and some end by force."""
    rng, sent = random.Random(seed), Counter[str]()
    while sum(sent.values()) < count:
        setup = Setup.smallest(2, rng.choice([0, 0, 0, 100, 5000]))
        with suppress(OSError), socket.create_connection((LOOPBACK, port), timeout=5.0) as client:
            first = setup.encode() if rng.random() < 0.9 else rng.randbytes(44)
            client.sendall(first)
            reads = rng.random() < 0.5
            client.settimeout(0.05)  # a server that has given the client up discards slowly
            for _ in range(min(rng.randrange(1, 2 * MESSAGES_OF_A_SESSION), count)):
                kind, data = message(rng, setup)
                sent[kind] += 1
                client.sendall(data)
                if reads:
                    with suppress(BlockingIOError):
                        client.recv(1 << 16, socket.MSG_DONTWAIT)
            if rng.random() < 0.3:
                client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    return sent


def run(count: int, seed: int, quiet_rounds: int = 20) -> Outcome:
    """Send so many messages while honest clients exchange steps."""
    sent, per_client = Counter[str](), -(-count // CLIENTS)
    code = "import json, sys; from tests.fuzz.test_served import attack; "
    code += "print(json.dumps(attack(*map(int, sys.argv[1:]))))"
    with TemporaryDirectory() as folder, serving(Path(folder)) as (server, port):
        clients = [Client(port) for _ in range(HONEST)]
        forces, quiet = exchange(clients, 0, lambda made: made < quiet_rounds)
        attackers = [
            subprocess.Popen(
                [sys.executable, "-c", code, str(port), str(per_client), str(seed + number)],
                stdout=subprocess.PIPE,
                text=True,
            )
            for number in range(CLIENTS)
        ]
        more, rounds = exchange(
            clients,
            quiet_rounds,
            lambda made: made < 1 or any(attacker.poll() is None for attacker in attackers),
        )
        for attacker in attackers:
            out, _ = attacker.communicate()
            sent.update(json.loads(out))
        for client in clients:
            client.end()
        server.terminate()
        status = server.wait(120.0)
    forces += more
    x = [displacement(step) for step in range(1, 1 + len(forces))]
    times = [0.01 * step for step in range(len(forces) + 1)]
    exact, _ = follow(tb.element(BEARING, ambient=AMBIENT), np.array(x), np.diff(times))
    return Outcome(rounds, quiet, forces == exact.tolist(), sent, status)


@pytest.mark.thorough
def test_honest_clients_keep_their_bits() -> None:
    count, seed = int(os.environ.get(COUNT, str(USUAL))), int(os.environ.get(SEED, "0"))
    outcome = run(count, seed % 2**31)
    assert outcome.same
    assert sum(outcome.sent.values()) >= count
    assert outcome.status in (0, 3)  # written; 3: clients were given up, as the result says


def main(count: int, seed: int) -> None:
    """Print numbers."""
    outcome = run(count, seed, 500)
    print(f"{sum(outcome.sent.values())} messages: {dict(outcome.sent)}")
    print(f"honest steps of {HONEST} clients: {len(outcome.rounds)}, same bits: {outcome.same}")
    for name, values in (("alone", outcome.quiet), ("with them", outcome.rounds)):
        parts = 1e3 * np.quantile(values, [0.1, 0.5, 0.9])
        print(f"{name}: 10, 50 and 90 % of rounds take {parts.round(2).tolist()} ms")
    print(f"status of the server {outcome.status}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
