"""A specimen or program outside, in place of the modelled bearing of one line, reached over TCP.

The wire format is that of OpenSees' `genericClient` (opensees/wire.py), of which this is the client
with one degree of freedom of two nodes: displacements of the faces of the specimen [mm], of which
the lower one stays, and forces [kN] as the reply. In each step the specimen is moved once, its
force is read, and the step is committed. A bearing served by this package, a server for OpenSees in
front of the controller of a rig, and another program are addressed in the same way.

What a sensor sends is not believed without limits: the bearing of the line is calculated along with
the specimen (its twin), and a force, stiffness or energy far from that of the twin, or a force that
does not change, ends the test.
"""

import contextlib
import ipaddress
import math
import re
import socket
from typing import Any, NoReturn

from pydantic import Field

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.border.library import read_data
from thermobearing.border.schema import Strict
from thermobearing.model.checks import secant_stiffness
from thermobearing.model.element import BearingElement
from thermobearing.opensees import wire
from thermobearing.structure.run import (
    DISPLACEMENT_LIMIT,
    FORCE_LIMIT,
    IMPLAUSIBLE_ENERGY,
    IMPLAUSIBLE_FORCE,
    IMPLAUSIBLE_STIFFNESS,
    SENSOR_STUCK,
    SPECIMEN_LOST,
    SpecimenError,
)

_ADDRESS = re.compile(r"tcp://(\[[0-9A-Fa-f:.]+\]|[\w.-]+):([0-9]{1,5})/?")


def read_address(text: str) -> tuple[str, int]:
    """Return host and port of an address such as "tcp://192.168.0.5:8090"."""
    match = _ADDRESS.fullmatch(text)
    if match is None or not 1 <= int(match[2]) <= 65535:
        raise ValueError("must be tcp://HOST:PORT, as tcp://127.0.0.1:8090")
    host = match[1].strip("[]")
    try:
        host.encode("idna")  # as the socket does, which raises no OSError for such a host
    except UnicodeError:
        raise ValueError(f"must be tcp://HOST:PORT: {host} is no name of a host") from None
    return host, int(match[2])


def refuse_remote(table: Any, where: str) -> None:
    """Raise InputError for a specimen of a case file that is on another machine.

    A file that somebody else has written must not make this program connect to any machine, or move
    a rig: the address has to be repeated by the one who runs the test.
    """
    laboratory = table.get("laboratory")
    address = laboratory.get("specimen") if isinstance(laboratory, dict) else None
    if not isinstance(address, str):
        return
    try:
        host, _ = read_address(address)
    except ValueError:
        return  # the check of the key reports it
    if not _is_this_machine(host):
        raise InputError(
            f'laboratory.specimen = "{address}": a case file may only name a specimen on this '
            f"machine (127.0.0.1); to connect to {host}, give the address on the command line too, "
            f"--specimen {address}, or in Python, laboratory={{'specimen': {address!r}}}",
            where,
        )


def _is_this_machine(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host.lower() == "localhost"


class TwinLimits(Strict):
    """How far a specimen may be from its twin; data/materials/specimen.toml."""

    force_largest: float = Field(gt=1)
    stiffness_least: float = Field(gt=0, lt=1)
    stiffness_largest: float = Field(gt=1)
    stiffness_strain: float = Field(gt=0)
    stiffness_range: float = Field(gt=0, lt=1)
    energy_least: float = Field(gt=0, lt=1)
    energy_largest: float = Field(gt=1)
    still_force: float = Field(gt=0, lt=1)
    still_twin: float = Field(gt=0, lt=1)


class TwinCheck:
    """Limits of what a specimen may do, from the bearing that is calculated along with it.

    Forces count from those at the start: a load cell may have an offset, and an earlier test may
    have left a force.
    """

    def __init__(self, bearing: Bearing | BilinearBearing, ambient: float) -> None:
        self._limits = read_data(TwinLimits, "materials", "specimen.toml")
        self._height = bearing.total_rubber_thickness
        self._reference = _reference_force(bearing, ambient)
        # Displacement [mm], force [kN] and force of the twin [kN].
        self._start: tuple[float, float, float] | None = None
        self._last = self._reversal = (0.0, 0.0, 0.0)
        self._direction = 0.0
        self._range = (0.0, 0.0)  # of the displacement so far [mm]
        self._twin_max = 0.0  # largest force of the twin so far [kN]
        self._work = self._twin_work = 0.0  # [kN mm]
        self._still_force = 0.0  # at which the sensor has been since the twin had these forces
        self._still_twin = (0.0, 0.0)

    def force_limit(self, twin: float) -> float:
        """Return the largest plausible force [kN], given that of the twin."""
        self._twin_max = max(self._twin_max, abs(twin))
        return self._limits.force_largest * max(self._reference, self._twin_max)

    def problem(self, displacement: float, force: float, twin: float) -> tuple[str, str]:
        """Return the outcome, and numbers for the reader, if a force is not plausible."""
        if self._start is None:
            self._start = self._last = self._reversal = displacement, force, twin
            self._range = displacement, displacement
            self._still_force, self._still_twin = force, (twin, twin)
            return "", ""
        point = displacement, force, twin
        text = self._stuck(force, twin)
        outcome = SENSOR_STUCK if text else ""
        if not text and (text := self._stiffness(point)):
            outcome = IMPLAUSIBLE_STIFFNESS
        if not text and (text := self._energy(point, self._start)):
            outcome = IMPLAUSIBLE_ENERGY
        self._last = point
        return outcome, text

    def _stuck(self, force: float, twin: float) -> str:
        """Return how long the force has been the same while that of the twin changed."""
        limits = self._limits
        if abs(force - self._still_force) > limits.still_force * self._reference:
            self._still_force, self._still_twin = force, (twin, twin)
            return ""
        lowest, highest = min(self._still_twin[0], twin), max(self._still_twin[1], twin)
        self._still_twin = lowest, highest
        if highest - lowest <= limits.still_twin * self._reference:
            return ""
        return (
            f"measured force {force:.4g} kN: the same while that of the calculated bearing went "
            f"from {lowest:.4g} to {highest:.4g} kN"
        )

    def _stiffness(self, point: tuple[float, float, float]) -> str:
        """Return a secant stiffness since the last reversal that is far from that of the twin."""
        limits, displacement = self._limits, point[0]
        step = displacement - self._last[0]
        if step * self._direction < 0.0:
            self._reversal = self._last
        if step:
            self._direction = math.copysign(1.0, step)
        self._range = min(self._range[0], displacement), max(self._range[1], displacement)
        distance, force, twin = (
            end - begin for end, begin in zip(point, self._reversal, strict=True)
        )
        smallest_distance = max(
            limits.stiffness_strain * self._height,
            limits.stiffness_range * (self._range[1] - self._range[0]),
        )
        if abs(distance) < smallest_distance or twin * distance <= 0.0:
            return ""
        ratio = force / twin
        if limits.stiffness_least <= ratio <= limits.stiffness_largest:
            return ""
        return (
            f"measured stiffness {force / distance:.4g} kN/mm since the last reversal: must be "
            f"from {limits.stiffness_least:g} to {limits.stiffness_largest:g} times that of the "
            f"calculated bearing, {twin / distance:.4g} kN/mm"
        )

    def _energy(self, point: tuple[float, float, float], start: tuple[float, float, float]) -> str:
        """Return a work that a bearing cannot take up, or give back."""
        limits, step = self._limits, point[0] - self._last[0]
        self._work += 0.5 * (point[1] + self._last[1] - 2.0 * start[1]) * step
        self._twin_work += 0.5 * (point[2] + self._last[2] - 2.0 * start[2]) * step
        allowance = limits.energy_least * self._reference * self._height
        lowest = -max(allowance, limits.energy_least * self._twin_work)
        highest = limits.energy_largest * max(allowance, self._twin_work)
        if lowest <= self._work <= highest:
            return ""
        return (
            f"work done on the specimen {self._work:.4g} kN mm: must be from {lowest:.4g} to "
            f"{highest:.4g} kN mm, where that on the calculated bearing is {self._twin_work:.4g} "
            "kN mm"
        )


def _reference_force(bearing: Bearing | BilinearBearing, ambient: float) -> float:
    """Return the force of a bearing at 100 % shear strain in the first loading [kN]."""
    height = bearing.total_rubber_thickness
    if isinstance(bearing, BilinearBearing):
        return bearing.strength + bearing.post_yield_stiffness * height
    element = BearingElement(bearing, ambient)
    secant_stiffness(element, height)  # moves it to this strain
    return abs(float(element.state.response["force"][0]))


class TcpSpecimen:
    """A specimen behind a TCP connection, in place of the bearing of a line; see `Specimen`."""

    def __init__(
        self,
        address: str,
        line: int,
        check: TwinCheck,
        *,
        time_out: float,
        displacement_limit: float | None = None,
        force_limit: float | None = None,
    ) -> None:
        self._check, self._time_out = check, time_out
        self._displacement_limit, self._force_limit = displacement_limit, force_limit
        self.line, self._setup = line, wire.Setup.smallest(2)
        self.note = ""  # which limit was exceeded, how far, and the last good step
        self._good = "none"  # the last step whose force was plausible
        self._last: tuple[float, float] | None = None  # displacement and time of the last command
        try:
            self._socket = socket.create_connection(read_address(address), time_out)
            try:
                wire.prepare(self._socket)
                self._socket.sendall(self._setup.encode())
            except OSError:
                self._socket.close()
                raise
        except OSError as error:
            raise InputError(
                f'laboratory.specimen = "{address}": no connection '
                f"({error.strerror or error}); start the program of the specimen first"
            ) from None

    def move(self, displacement: float, speed: float, time: float, twin: float) -> float:
        """Move to a displacement [mm] at a speed [mm/s] and a time [s]; return the force [kN].

        `twin` is the force of the calculated bearing there [kN].
        """
        if abs(displacement) > (self._displacement_limit or math.inf):
            raise SpecimenError(DISPLACEMENT_LIMIT)
        self._last = displacement, time
        try:
            self._send(speed, wire.Action.SET_TRIAL, wire.Action.FORCE)
            reply = wire.receive_exactly(self._socket, self._setup.length, self._time_out)
            force = float(wire.decode_reply(reply, wire.Action.FORCE, self._setup)[1])
            self._judge(displacement, force, twin)
            self._send(speed, wire.Action.COMMIT)
        except (OSError, wire.WireError):
            raise SpecimenError(SPECIMEN_LOST) from None
        self._good = f"{time:.4g} s, {displacement:.4g} mm, {force:.4g} kN"
        return force

    def _judge(self, displacement: float, force: float, twin: float) -> None:
        """Raise SpecimenError for a force beyond a limit of the laboratory or of the twin."""
        # A limit that the laboratory gives is that of its rig and replaces the one of the twin.
        largest, limit = self._check.force_limit(twin), self._force_limit
        if abs(force) > (limit or math.inf):
            self._end(
                FORCE_LIMIT, f"measured force {force:.4g} kN: beyond force_limit, {limit:g} kN"
            )
        if not math.isfinite(force):
            raise SpecimenError(SPECIMEN_LOST)
        if limit is None and abs(force) > largest:
            text = (
                f"measured force {force:.4g} kN: beyond {largest:.4g} kN, by the calculated bearing"
            )
            self._end(IMPLAUSIBLE_FORCE, text)
        outcome, text = self._check.problem(displacement, force, twin)
        if outcome:
            self._end(outcome, text)

    def _end(self, outcome: str, text: str) -> NoReturn:
        self.note = f"{text}; last good step: {self._good}"
        raise SpecimenError(outcome)

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
