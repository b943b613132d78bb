"""Devices parallel to bearings as data: viscous dampers, friction sliders, gaps."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, NamedTuple

import numpy as np
import scipy
from pydantic import Field, model_validator

from thermobearing.border.schema import Strict, in_unit
from thermobearing.core.records import Floats, Rows, rows
from thermobearing.structure.fields import GROUND, Force, Height, Length, Name, Speed, Stiffness
from thermobearing.structure.types import DAMPER, GAP, SLIDER, Device

METRE = 1e3  # mm


class DeviceConstant(NamedTuple):
    """A number of one device as other programs take it, in kN, m and s."""

    name: str
    value: float
    unit: str = ""

    def __str__(self) -> str:
        return f"{self.name} {self.value:.5g} {self.unit}".strip()


class DeviceTable(Strict):
    """What all devices state: where they are.

    Attributes
    ----------
    name : of the device.
    line : bearing line that it is parallel to, whose body, base, heights and place it has.
    body, base, height : what it connects, without a `line`; base "ground" by default.
    x, y : its place in plan [mm], without a `line`; by default that of the body.
    count : of equal devices side by side, 1 by default.
    angle : of its axis in plan, from x towards y [rad]. Dampers and gaps act along x by default,
        sliders in both directions.
    """

    _together: ClassVar[tuple[str, str]]  # keys of a kind that need each other
    _title: ClassVar[str]  # of one device of the kind

    name: Name
    line: Name | None = None
    body: Name | None = None
    base: Name | None = None
    height: Height | None = None
    x: Length | None = None
    y: Length | None = None
    count: Annotated[int, Field(ge=1, le=10_000)] = 1
    angle: Annotated[float, in_unit("rad"), Field(ge=-2.0 * math.pi, le=2.0 * math.pi)] | None = (
        None
    )

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        """A line says where the device is, or a body does; some keys need each other."""
        if ("line" in values) == ("body" in values):
            return ["line, body: give the line that the device is parallel to, or a body"]
        places = [key for key in ("base", "height", "x", "y") if key in values]
        if "line" in values and places:
            return [f"{', '.join(places)}: the line has it; remove it, or line"]
        first, second = cls._together
        if (first in values) != (second in values):
            return [f"{first}, {second}: give both, or neither"]
        return []

    @property
    def in_both_directions(self) -> bool:
        """Whether it acts in both directions of a plan."""
        return False

    def fill(self, device: Device) -> None:
        """Write the numbers of all `count` devices together."""
        raise NotImplementedError

    def oil(self) -> tuple[Sequence[float], Sequence[float]]:
        """Return temperatures of the oil [degC] and factors of the force."""
        return (0.0,), (1.0,)

    def describe(self) -> str:
        """Return number, size and axis of the device in words."""
        return f"{self.count} x {self._size()}{self._axis()}"

    def _axis(self) -> str:
        return "" if self.angle is None else f", axis at {math.degrees(self.angle):g}°"

    def title(self) -> str:
        """Return the name of the device, how many it is, and where, for a reader elsewhere."""
        number, place = f"{self.count} {self._title}", f"parallel to the line {self.line}"
        if self.line is None:
            place = f"between {self.body} and {self.base or GROUND}"
        return f"{self.name}: {number}{'s' * (self.count > 1)} {place}{self._axis()}"

    def constants(self) -> list[DeviceConstant]:
        """Return the numbers of one device in kN, m and s, as links of other programs take them."""
        raise NotImplementedError

    def _size(self) -> str:
        raise NotImplementedError


class Damper(DeviceTable):
    """A viscous damper with a rigid brace: F = `force` (|v|/`velocity`)^`exponent`.

    Attributes
    ----------
    force : of one damper at `velocity` [kN].
    velocity : [mm/s], 1 m/s by default.
    exponent : alpha, in [0.1, 2].
    temperatures : of the oil [degC], rising, at which `factors` multiply the force; linear between
        and constant beyond. Without them the temperature does not matter.
    factors : of the force at the `temperatures`.
    heat_capacity : of the oil and body of one damper, warmed by its work [kN mm/K]; without it the
        oil keeps the temperature of the air.
    """

    _together: ClassVar = ("temperatures", "factors")
    _title: ClassVar = "viscous damper"

    kind: Literal["damper"]
    force: Force
    velocity: Speed = 1e3
    exponent: Annotated[float, Field(ge=0.1, le=2)]
    temperatures: (
        Annotated[
            tuple[Annotated[float, in_unit("degC"), Field(ge=-100, le=200)], ...],
            Field(min_length=2, max_length=100),
        ]
        | None
    ) = None
    factors: (
        Annotated[
            tuple[Annotated[float, Field(ge=0.01, le=100)], ...],
            Field(min_length=2, max_length=100),
        ]
        | None
    ) = None
    heat_capacity: Annotated[float, in_unit("kN mm/K"), Field(ge=1, le=1e9)] | None = None

    @model_validator(mode="after")
    def _table_rises(self) -> "Damper":
        temperatures, factors = self.temperatures or (), self.factors or ()
        if len(temperatures) != len(factors):
            raise ValueError(
                f"factors: has {len(factors)} entries; give {len(temperatures)}, one for each of "
                "temperatures"
            )
        if any(warmer <= colder for colder, warmer in pairwise(temperatures)):
            raise ValueError("temperatures: must rise")
        return self

    def fill(self, device: Device) -> None:
        """Write the numbers of all `count` dampers together."""
        device.kind, device.exponent = DAMPER, self.exponent
        device.damping = self.count * self.force / self.velocity**self.exponent
        device.heat_capacity = self.count * (self.heat_capacity or 0.0)

    def _size(self) -> str:
        return f"{self.force:g} kN at {self.velocity:g} mm/s, exponent {self.exponent:g}"

    def constants(self) -> list[DeviceConstant]:
        """Return C and alpha of F = C |v|^alpha, and what the temperature makes of C."""
        coefficient = self.force / (self.velocity / METRE) ** self.exponent
        oil = zip(self.temperatures or (), self.factors or (), strict=True)
        return [
            DeviceConstant("damping coefficient C", coefficient, "kN (s/m)^alpha"),
            DeviceConstant("damping exponent alpha", self.exponent),
            *(DeviceConstant(f"factor of C with oil at {t:g} degC", f) for t, f in oil),
        ]

    def oil(self) -> tuple[Sequence[float], Sequence[float]]:
        """Return temperatures of the oil [degC] and factors of the force."""
        if self.temperatures is None or self.factors is None:
            return super().oil()
        return self.temperatures, self.factors


class Slider(DeviceTable):
    """A friction slider under a constant normal force.

    Attributes
    ----------
    normal_force : on one slider [kN].
    friction : coefficient, of a fast slider if `slow_friction` is given.
    slow_friction : coefficient as the velocity goes to zero, at most `friction`.
    friction_rate : a [s/mm] of the coefficient, friction - (friction - slow_friction) exp(-a |v|).
    elastic_displacement : at which it begins to slide at `friction` [mm], 0.2 mm by default.
    """

    _together: ClassVar = ("slow_friction", "friction_rate")
    _title: ClassVar = "friction slider"

    kind: Literal["slider"]
    normal_force: Force
    friction: Annotated[float, Field(ge=1e-3, le=1)]
    slow_friction: Annotated[float, Field(ge=1e-3, le=1)] | None = None
    friction_rate: Annotated[float, in_unit("s/mm"), Field(ge=1e-5, le=10)] | None = None
    elastic_displacement: Annotated[float, in_unit("mm"), Field(ge=1e-3, le=100)] = 0.2

    @model_validator(mode="after")
    def _faster_is_stronger(self) -> "Slider":
        if self.slow_friction is not None and self.slow_friction > self.friction:
            raise ValueError(
                f"slow_friction: {self.slow_friction:g} exceeds friction, {self.friction:g}; "
                "friction that falls with velocity is not modelled"
            )
        return self

    def _size(self) -> str:
        slow = "" if self.slow_friction is None else f"{self.slow_friction:g} to "
        return f"{slow}{self.friction:g} of {self.normal_force:g} kN"

    def constants(self) -> list[DeviceConstant]:
        """Return normal force, friction and the stiffness before sliding."""
        slow = []
        if self.slow_friction is not None and self.friction_rate is not None:
            slow = [
                DeviceConstant("slow friction coefficient", self.slow_friction),
                DeviceConstant("rate parameter", METRE * self.friction_rate, "s/m"),
            ]
        stiffness = METRE * self.friction * self.normal_force / self.elastic_displacement
        return [
            DeviceConstant("normal force", self.normal_force, "kN"),
            DeviceConstant("fast friction coefficient", self.friction),
            *slow,
            DeviceConstant("stiffness before sliding", stiffness, "kN/m"),
        ]

    @property
    def in_both_directions(self) -> bool:
        """Whether it acts in both directions of a plan."""
        return self.angle is None

    def fill(self, device: Device) -> None:
        """Write the numbers of all `count` sliders together."""
        load = self.count * self.normal_force
        slow = self.friction if self.slow_friction is None else self.slow_friction
        device.kind, device.rate = SLIDER, self.friction_rate or 0.0
        device.friction, device.slow_friction = self.friction * load, slow * load
        device.stiffness = device.friction / self.elastic_displacement


class Gap(DeviceTable):
    """A gap that closes on an elastic stop, or a stopper (opening zero).

    Attributes
    ----------
    gap : opening [mm], 0 by default.
    stiffness : of one stop in contact [kN/mm].
    sides : "both" (default); "positive" or "negative": the direction of the motion of the body,
        relative to the base, in which it closes.
    restitution : velocity after an impact over that before it, at `closing_speed`; without it the
        stop is elastic.
    closing_speed : [mm/s] at which `restitution` holds; faster impacts lose more.
    """

    _together: ClassVar = ("restitution", "closing_speed")
    _title: ClassVar = "gap"

    kind: Literal["gap"]
    gap: Annotated[float, in_unit("mm"), Field(ge=0, le=1e5)] = 0.0
    stiffness: Stiffness
    sides: Literal["both", "positive", "negative"] = "both"
    restitution: Annotated[float, Field(ge=0.05, lt=1)] | None = None
    closing_speed: Speed | None = None

    def constants(self) -> list[DeviceConstant]:
        """Return opening, stiffness, and what an impact loses."""
        impact = []
        if self.restitution is not None and self.closing_speed is not None:
            speed = self.closing_speed / METRE
            name = f"coefficient of restitution at {speed:g} m/s"
            impact = [DeviceConstant(name, self.restitution)]
        return [
            DeviceConstant(
                f"opening ({self.sides}{' sides' * (self.sides == 'both')})", self.gap / METRE, "m"
            ),
            DeviceConstant("stiffness in contact", METRE * self.stiffness, "kN/m"),
            *impact,
        ]

    def _size(self) -> str:
        side = "" if self.sides == "both" else f", {self.sides} side"
        return f"{self.stiffness:g} kN/mm beyond {self.gap:g} mm{side}"

    def fill(self, device: Device) -> None:
        """Write the numbers of all `count` gaps together."""
        device.kind, device.gap, device.stiffness = GAP, self.gap, self.count * self.stiffness
        device.closes_above = float(self.sides != "negative")
        device.closes_below = float(self.sides != "positive")
        if self.restitution is not None and self.closing_speed is not None:
            device.dissipation = relative_dissipation(self.restitution) / self.closing_speed


AnyDevice = Annotated[Damper | Slider | Gap, Field(discriminator="kind")]


def relative_dissipation(restitution: float) -> float:
    """Return lambda times the closing speed for a coefficient of restitution.

    With F = k p (1 + lambda p') an impact at v that leaves at e v has, exactly and for any mass and
    stiffness, a - ln(1 + a) = -e a - ln(1 - e a) with a = lambda v.
    """

    def imbalance(a: float) -> float:
        return (1.0 + restitution) * a - math.log1p(a) + math.log1p(-restitution * a)

    # The imbalance rises from zero at a = 0 and falls without limit towards 1/e.
    highest = 1.0 / restitution
    lowest = 1e-6 * highest
    return float(scipy.optimize.brentq(imbalance, lowest, highest * (1.0 - 1e-15)))


def build_devices(
    tables: Sequence[DeviceTable], warmer: Sequence[float]
) -> tuple[Rows[Device], Floats, Floats]:
    """Return numbers of devices, temperatures of their oil [d, k] and factors.

    `warmer` [d] is the air around each than that of the run [K].
    """
    devices = rows(Device, len(tables))
    oils = [table.oil() for table in tables]
    length = max((len(temperatures) for temperatures, _ in oils), default=1)
    temperatures, factors = np.zeros((2, len(tables), length))
    for d, (table, (oil_temperatures, oil_factors)) in enumerate(zip(tables, oils, strict=True)):
        table.fill(devices[d])
        devices[d].warmer = warmer[d]
        # Shorter tables go on with their last factor.
        beyond = length - len(oil_temperatures)
        warmest = oil_temperatures[-1]
        temperatures[d] = [*oil_temperatures, *(warmest + k for k in range(1, beyond + 1))]
        factors[d] = [*oil_factors, *[oil_factors[-1]] * beyond]
    return devices, temperatures, factors
