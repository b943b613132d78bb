"""Parameters that a calibration may free: names, ranges, scales and ties."""

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, nearest
from thermobearing.border.library import data_path
from thermobearing.border.schema import Strict, validated
from thermobearing.border.toml import read_toml
from thermobearing.border.units import HUGEST
from thermobearing.core.records import Floats
from thermobearing.laws import find_law

SHAPE, D_Y = "hysteresis.shape", "hysteresis.yield_displacement"
ALPHA, K_R = "hysteresis.post_yield_ratio", "hysteresis.layer_stiffness"
HARDENING = "hysteresis.hardening"
# Of registered laws, before the name of a parameter.
LAW, HYSTERESIS = "temperature_law.parameters.", "hysteresis_law.parameters."
LAWS = (LAW, HYSTERESIS)
M_T = "hysteresis.elastic_temperature_coefficient"
N_T = "hysteresis.hysteretic_temperature_coefficient"
K_L, SIGMA_Y = "lead.stiffness", "lead.yield_stress"
K_V, C_V = "rate.stiffness", "rate.damping"
SPAN = 10.0  # between ambient temperatures that identify m_T and n_T [K]
TIE = re.compile(r"([^=]+)=(?:([^=*]+)\*)?([^=*]+)")


class Kind(Strict):
    """A number of a bearing that may be identified; data/identify/parameters.toml says more."""

    key: str
    symbol: str
    aliases: tuple[str, ...] = ()
    unit: str = ""
    scale: Literal["linear", "log", "log1p"]  # on which the search moves
    lower: float
    upper: float
    relative: bool = False  # bounds multiply the starting value, which depends on the size
    end: float | None = None  # bound at which the law itself ends
    of_yielding: bool = False  # linear rubber has none
    usual: bool = True  # free by default
    optional: bool = False  # of an effect that a bearing may lack
    group: str = ""  # of the remedies
    generic: float | None = None  # starting value that belongs to no bearing


class Enough(Strict):
    """Numbers of tests that determine a group of parameters; the words of remedies name them."""

    temperature: float  # between two ambient temperatures [K]
    rate: float  # ratio of two loading speeds
    lead: float  # strain below which lead acts before rubber [%]
    hardening: float  # largest strain of several [%]


class Kinds(Strict):
    """Content of data/identify/parameters.toml."""

    remedies: dict[str, str]
    enough: Enough
    parameters: list[Kind]


_PATH = data_path("identify", "parameters.toml")
_DATA = validated(Kinds, read_toml(_PATH), str(_PATH))
ENOUGH = _DATA.enough
KINDS = {kind.key: kind for kind in _DATA.parameters}
ALIASES = {name: kind.key for kind in KINDS.values() for name in (kind.symbol, *kind.aliases)}
OF_YIELDING = {kind.key for kind in KINDS.values() if kind.of_yielding}


def remedy_group(*kinds: Kind) -> str:
    """Return the group of remedies that determines parameters; "" without any."""
    groups = {kind.group for kind in kinds}
    return next((group for group in _DATA.remedies if group in groups), "")


def remedy(*kinds: Kind) -> str:
    """Return a sentence on the tests that would determine parameters."""
    if not (group := remedy_group(*kinds)):
        return "Other tests would be needed"
    return _DATA.remedies[group].format(**{k: f"{v:g}" for k, v in ENOUGH.model_dump().items()})


def _full_key(name: str, bearing: Bearing, prefix: str = "") -> str:
    """Return the dotted key of a parameter by its key or symbol; `before` begins the message."""
    keys = keys_by_name(bearing)
    key = keys.get(name.strip(), name.strip())
    if key not in keys.values():
        raise InputError(f'{prefix}no parameter "{name}"{nearest(name, [*keys, *keys.values()])}')
    return key


def keys_by_name(bearing: Bearing) -> dict[str, str]:
    """Return the dotted keys of all parameters and of those of a bearing's laws, by symbol."""
    return ALIASES | {kind.symbol: kind.key for kind in _law_kinds(bearing)}


Scale = dict[str, Callable[[float], float]]  # to that of the search, and back
FORWARD: Scale = {"linear": float, "log": math.log, "log1p": math.log1p}
BACKWARD: Scale = {"linear": float, "log": math.exp, "log1p": math.expm1}


@dataclass(frozen=True)
class Parameter:
    """A number of a bearing in a fit: free between its bounds, fixed, or tied to another.

    `tie` is (key, factor): the value is factor times that of the other parameter. `bounded` means
    that the user chose the bounds: another starting value does not move them.
    """

    kind: Kind
    value: float
    lower: float
    upper: float
    free: bool = True
    tie: tuple[str, float] | None = None
    bounded: bool = False

    @property
    def ends(self) -> tuple[float, float]:
        """The bounds on the scale of the search."""
        scale = FORWARD[self.kind.scale]
        return scale(self.lower), scale(self.upper)

    def at(self, unit: float) -> float:
        """Return the value at a place in [0, 1] between the bounds."""
        low, high = self.ends
        value = BACKWARD[self.kind.scale](low + unit * (high - low))
        return min(max(value, self.lower), self.upper)

    def place(self, value: float) -> float:
        """Return the place of a value between the bounds, in [0, 1]."""
        low, high = self.ends
        inside = min(max(value, self.lower), self.upper)
        return (FORWARD[self.kind.scale](inside) - low) / (high - low)

    def slope(self, unit: float) -> float:
        """Return the derivative of the value by the place."""
        value, (low, high) = self.at(unit), self.ends
        factors = {"log": value, "log1p": 1.0 + value}
        return (high - low) * factors.get(self.kind.scale, 1.0)


@dataclass(frozen=True)
class ParameterSet:
    """All parameters of a fit; the search moves in the unit cube of the free ones."""

    base: Bearing
    parameters: tuple[Parameter, ...]

    @property
    def free(self) -> list[Parameter]:
        """Parameters that the search moves."""
        return [p for p in self.parameters if p.free and p.tie is None]

    @property
    def start(self) -> Floats:
        """Place of the starting values in the unit cube."""
        return np.array([p.place(p.value) for p in self.free])

    def values(self, cube: Floats) -> dict[str, float]:
        """Return all values by dotted key, tied ones too, at a point of the unit cube."""
        numbers = {p.kind.key: p.value for p in self.parameters}
        numbers |= {p.kind.key: p.at(float(u)) for p, u in zip(self.free, cube, strict=True)}
        for p in self.parameters:
            if p.tie is not None:
                key, factor = p.tie
                numbers[p.kind.key] = factor * numbers[key]
        return numbers

    def bearing(self, cube: Floats) -> Bearing:
        """Return the bearing at a point of the unit cube, not validated: quick, for the search."""
        return with_values(self.base, self.values(cube))

    def with_start(self, values: dict[str, float]) -> "ParameterSet":
        """Return the set with other starting values, by dotted key.

        Relative bounds move along, unless the user chose them.
        """
        moved = []
        for p in self.parameters:
            value = values.get(p.kind.key, p.value)
            # Relative bounds are multiples of the value, which depends on the size of the bearing.
            if p.kind.relative and p.free and not p.bounded:
                p = replace(p, lower=p.kind.lower * value, upper=p.kind.upper * value)
            moved.append(replace(p, value=value))
        return replace(self, parameters=tuple(moved))

    def without(self, keys: Sequence[str]) -> "ParameterSet":
        """Return the set with some parameters, by dotted key, held at the values of the bearing."""
        values = {key: dotted_value(self.base, key) or 0.0 for key in keys}
        moved = (
            replace(p, value=values[p.kind.key], free=False) if p.kind.key in values else p
            for p in self.parameters
        )
        return replace(self, parameters=tuple(moved))

    def checked(self, cube: Floats) -> Bearing:
        """Return the validated bearing at a point of the unit cube, for the result."""
        data = self.base.model_dump()
        for key, value in self.values(cube).items():
            *tables, name = key.split(".")
            inner = data
            for table in tables:
                inner[table] = inner = inner[table] or {}
            inner[name] = value
        bearing = validated(Bearing, data, "identified bearing", from_file=False)
        return bearing.with_sources(self.base.sources)


def dotted_value(bearing: Bearing, key: str) -> float | None:
    """Return a number of a bearing by its dotted key; None if the bearing has no such part."""
    part: Any = bearing
    for name in key.split("."):
        part = part.get(name) if isinstance(part, Mapping) else getattr(part, name, None)
    # A parameter that the bearing's file does not give has the value of the law.
    if part is None and key.startswith(LAWS):
        return next((kind.generic for kind in _law_kinds(bearing) if kind.key == key), None)
    return None if part is None else float(part)


def with_values(bearing: Bearing, values: Mapping[str, float]) -> Bearing:
    """Return a bearing with other numbers, by dotted key, not validated."""
    for key, value in values.items():
        bearing = _replace_value(bearing, key.split("."), value)
    return bearing


def _replace_value(part: Any, names: Sequence[str], value: float) -> Any:
    first, *inner_names = names
    # A bearing without the table of a law gets one with this parameter alone.
    if part is None or isinstance(part, dict):  # the parameters of a law
        return (part or {}) | {first: value}
    inner = _replace_value(getattr(part, first), inner_names, value) if inner_names else value
    return part.model_copy(update={first: inner})


def available(bearing: Bearing) -> list[Kind]:
    """Return the kinds of parameters that a bearing has."""
    kinds = [k for k in KINDS.values() if getattr(bearing, k.key.split(".")[0]) is not None]
    return [*kinds, *_law_kinds(bearing)]


def _law_kinds(bearing: Bearing) -> Iterator[Kind]:
    """Yield the parameters of the registered laws of a bearing."""
    for prefix, part in zip(LAWS, (bearing.temperature_law, bearing.hysteresis_law), strict=True):
        if part is None or part.law is None:
            continue
        law = find_law(part.law)
        for name, (low, high) in law.bounds.items():
            yield Kind(
                key=f"{prefix}{name}",
                symbol=f"{law.name}.{name}",
                scale="log" if low > 0.0 else "linear",
                lower=low,
                upper=high,
                of_yielding=prefix == HYSTERESIS,
                generic=law.parameters[name],
                group="temperature" if prefix == LAW else "turns",
            )


def at_one_temperature(ambients: Iterable[float]) -> bool:
    """Return whether ambient temperatures [degC] are too alike to identify m_T and n_T."""
    return float(np.ptp(list(ambients))) < SPAN


def split_at_one_temperature(bearing: Bearing, free: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return the other free parameters, and the symbols of those of temperature."""
    keys = {name: _full_key(name.split("=")[0], bearing, "free: ") for name in free}
    symbols = {kind.key: kind.symbol for kind in available(bearing)}
    temperature_symbols = {
        name: symbols[key] for name, key in keys.items() if is_of_temperature(key)
    }
    return [name for name in free if name not in temperature_symbols], [
        temperature_symbols[n] for n in free if n in temperature_symbols
    ]


def replaced_by_laws(bearing: Bearing) -> set[str]:
    """Return the keys of what the registered laws of a bearing stand for."""
    law = bearing.temperature_law
    keys = {M_T, N_T} if law is not None and law.law is not None else set()
    return keys if bearing.hysteresis_law is None else {*keys, SHAPE}


def is_of_temperature(key: str) -> bool:
    """Return whether a parameter, by dotted key, is one of a temperature law."""
    return key in (M_T, N_T) or key.startswith(LAW)


def default_free(bearing: Bearing, ambients: Iterable[float]) -> list[str]:
    """Return the keys that are free unless the tests say nothing about them; see start.py.

    Temperature coefficients, or the parameters of a registered law in their place, need tests at
    two temperatures. Linear rubber (post-yield ratio 1, as
    in an LRB) has one stiffness and one coefficient.
    """
    linear = bearing.hysteresis.post_yield_ratio == 1.0
    replaced, one_temperature = replaced_by_laws(bearing), at_one_temperature(ambients)
    kinds = (
        kind
        for kind in available(bearing)
        if kind.usual
        and kind.key not in replaced
        and not (one_temperature and is_of_temperature(kind.key))
    )
    return [kind.key for kind in kinds if not (linear and kind.of_yielding)]


def _chosen(bearing: Bearing, free: Sequence[str]) -> tuple[set[str], dict[str, tuple[str, float]]]:
    """Return free keys and ties from names such as "K_r" and "n_T = 2.4 * m_T"."""
    keys, ties = set(), {}
    available_keys = {kind.key for kind in available(bearing)}
    for name in free:
        match = TIE.fullmatch(name)
        key = _full_key(match[1] if match else name, bearing, "free: ")
        if key not in available_keys:
            table = key.split(".")[0]
            raise InputError(f'free: "{name}": the bearing "{bearing.name}" has no {table}')
        if match is None:
            keys.add(key)
            continue
        try:
            factor = float(match[2] or 1.0)
        except ValueError:
            factor = 0.0
        # Zero too is refused: a value times 0 would be fixed and not tied.
        if not 1.0 / HUGEST <= abs(factor) <= HUGEST:
            reason = f'"{match[2]}" is not a number a parameter can be multiplied by'
            raise InputError(f'"{name}": {reason}')
        ties[key] = (_full_key(match[3], bearing, "free: "), factor)
    return keys, ties


def parameter_set(
    bearing: Bearing | str | Path,
    free: Sequence[str] | None,
    ambients: Iterable[float],
    bounds: dict[str, tuple[float, float]] | None = None,
) -> ParameterSet:
    """Return the parameters of a bearing, free, fixed and tied.

    `free` holds keys, symbols and ties such as "n_T = 2.4 * m_T", None for the default ones of
    tests at the temperatures `ambients` [degC]; `bounds` replaces default bounds, by key or symbol.
    """
    bearing = as_bearing(bearing)
    names = default_free(bearing, ambients) if free is None else list(free)
    keys, ties = _chosen(bearing, names)
    if not keys:
        raise InputError("free: nothing is free; name at least one parameter")
    chosen_bounds = {_full_key(name, bearing): pair for name, pair in (bounds or {}).items()}
    parameters = []
    for kind in available(bearing):
        value = dotted_value(bearing, kind.key) or 0.0
        scale = value if kind.relative else 1.0
        lower, upper = chosen_bounds.get(kind.key, (kind.lower * scale, kind.upper * scale))
        if not lower < upper:
            raise InputError(f"{kind.symbol}: bounds {lower:g} to {upper:g} {kind.unit} are empty")
        options = {"free": kind.key in keys, "bounded": kind.key in chosen_bounds}
        parameters.append(Parameter(kind, value, lower, upper, tie=ties.get(kind.key), **options))
    return ParameterSet(bearing, tuple(parameters))
