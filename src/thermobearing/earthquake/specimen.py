"""A specimen or program outside, in place of the modelled bearing of one line, reached over TCP.

The wire format is that of OpenSees' `genericClient` (opensees/wire.py), of which this is the client
with one degree of freedom of two nodes: displacements of the faces of the specimen [mm], of which
the lower one stays, and forces [kN] as the reply. In each step the specimen is moved once, its
force is read, and the step is committed. A bearing served by this package, a server for OpenSees in
front of the controller of a rig, and another program are addressed in the same way.
"""

import contextlib
import math
import re
import socket
from typing import TYPE_CHECKING

from thermobearing.border.errors import InputError
from thermobearing.opensees import wire
from thermobearing.structure.run import (
    DISPLACEMENT_LIMIT,
    FORCE_LIMIT,
    SPECIMEN_LOST,
    SpecimenError,
)

if TYPE_CHECKING:
    from thermobearing.earthquake.case import Laboratory

_ADDRESS = re.compile(r"tcp://(\[[0-9A-Fa-f:.]+\]|[^\s:/\[\]]+):(\d{1,5})/?")


def read_address(text: str) -> tuple[str, int]:
    """Return host and port of an address such as "tcp://192.168.0.5:8090"."""
    found = _ADDRESS.fullmatch(text)
    if found is None or not 1 <= int(found[2]) <= 65535:
        raise ValueError("must be tcp://HOST:PORT, as tcp://127.0.0.1:8090")
    return found[1].strip("[]"), int(found[2])


class TcpSpecimen:
    """A specimen behind a TCP connection, in place of the bearing of a line; see `Specimen`."""

    def __init__(self, laboratory: "Laboratory", line: int) -> None:
        assert laboratory.specimen is not None
        self.line, self._lab, self._setup = line, laboratory, wire.Setup.smallest(2)
        self.note = ""  # which limit was exceeded, and how far
        self._last: tuple[float, float] | None = None  # displacement and time of the last command
        try:
            address = read_address(laboratory.specimen)
            self._socket = socket.create_connection(address, laboratory.time_out)
            try:
                wire.prepare(self._socket)
                self._socket.sendall(self._setup.encode())
            except OSError:
                self._socket.close()
                raise
        except OSError as error:
            raise InputError(
                f'laboratory.specimen = "{laboratory.specimen}": no connection '
                f"({error.strerror or error}); start the program of the specimen first"
            ) from None

    def move(self, displacement: float, speed: float, time: float) -> float:
        """Move to a displacement [mm] at a speed [mm/s] and a time [s]; return the force [kN]."""
        if abs(displacement) > (self._lab.displacement_limit or math.inf):
            raise SpecimenError(DISPLACEMENT_LIMIT)
        self._last = displacement, time
        try:
            self._send(speed, wire.Action.SET_TRIAL, wire.Action.FORCE)
            reply = wire.receive_exactly(self._socket, self._setup.length, self._lab.time_out)
            force = float(wire.decode_reply(reply, wire.Action.FORCE, self._setup)[1])
            if abs(force) > (limit := self._lab.force_limit or math.inf):
                self.note = f"measured force {force:.4g} kN: beyond force_limit, {limit:g} kN"
                raise SpecimenError(FORCE_LIMIT)
            if not math.isfinite(force):
                raise SpecimenError(SPECIMEN_LOST)
            self._send(speed, wire.Action.COMMIT)
        except (OSError, wire.WireError):
            raise SpecimenError(SPECIMEN_LOST) from None
        return force

    def stop(self) -> None:
        """Hold the specimen where it is, and end the test."""
        with contextlib.suppress(OSError), self._socket:
            if self._last is not None:
                self._send(0.0, wire.Action.SET_TRIAL)
            self._send(0.0, wire.Action.END)

    def _send(self, speed: float, *actions: wire.Action) -> None:
        """Send messages about the last command; in one packet, so that none waits for another."""
        x, time = self._last or (0.0, 0.0)
        requests = [wire.Request(act, [0.0, x], [0.0, speed], [0.0, 0.0], time) for act in actions]
        self._socket.sendall(b"".join(request.encode(self._setup) for request in requests))
