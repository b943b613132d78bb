"""Parameters that a calibration may free: names, ranges, scales and ties."""

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, nearest
from thermobearing.border.schema import validated
from thermobearing.border.units import HUGEST

Floats = NDArray[np.float64]
Transform = Literal["linear", "log", "log1p"]
SHAPE, D_Y = "hysteresis.shape", "hysteresis.yield_displacement"
ALPHA, K_R, HARDENING = (
    "hysteresis.post_yield_ratio",
    "hysteresis.layer_stiffness",
    "hysteresis.hardening",
)
M_T = "hysteresis.elastic_temperature_coefficient"
N_T = "hysteresis.hysteretic_temperature_coefficient"
K_L, SIGMA_Y, E2 = "lead.stiffness", "lead.yield_stress", "lead.softening"
K_V, C_V = "rate.stiffness", "rate.damping"
SCRAGGING = "scragging.amplitude"
SCRAGGING_STRAIN = "scragging.strain"
MULLINS = "scragging.mullins_amplitude"
MULLINS_DECAY = "scragging.mullins_decay"
MULLINS_RENEWAL = "scragging.mullins_renewal"
VIRGIN = (SCRAGGING, SCRAGGING_STRAIN, MULLINS, MULLINS_DECAY, MULLINS_RENEWAL)


@dataclass(frozen=True)
class Kind:
    """One number that may be identified.

    `lower` and `upper` are bounds; with `relative` they multiply the starting value. A wide
    range is deliberate: a fit that ends at a bound says so. `transform` is the scale on
    which the search moves: stiffness and the like by their logarithm, s by that of 1 + s,
    because the steepness of unloading goes with 1/(1 + s).
    """

    key: str
    symbol: str
    unit: str
    transform: Transform
    lower: float
    upper: float
    relative: bool = False


KINDS = (
    Kind(ALPHA, "alpha_0", "", "log", 0.02, 1.0),
    Kind(K_R, "K_r", "kN/mm", "log", 0.1, 10.0, relative=True),
    Kind(SHAPE, "s", "", "log1p", -0.98, 1.0),
    Kind(D_Y, "d_y", "mm", "log", 0.1, 10.0, relative=True),
    Kind(HARDENING, "b", "", "linear", 0.0, 2.0),
    Kind(M_T, "m_T", "", "linear", -6.0, 2.0),
    Kind(N_T, "n_T", "", "linear", -8.0, 2.0),
    Kind(K_L, "K_l", "kN/mm", "log", 0.1, 10.0, relative=True),
    Kind(SIGMA_Y, "sigma_Y", "MPa", "log", 2.0, 40.0),
    Kind(E2, "E2", "1/K", "linear", 0.0, 0.03),
    Kind(K_V, "K_v", "kN/mm", "log", 0.05, 20.0, relative=True),
    Kind(C_V, "c_v", "kN s/mm", "log", 0.05, 20.0, relative=True),
    Kind(SCRAGGING, "b_s", "", "linear", 0.0, 8.0),
    Kind(SCRAGGING_STRAIN, "gamma_s", "", "log", 0.02, 3.0),
    Kind(MULLINS, "a_v", "", "linear", 0.0, 1.5),
    Kind(MULLINS_DECAY, "c_d", "", "log", 0.5, 100.0),
    Kind(MULLINS_RENEWAL, "l_r", "", "log", 0.01, 3.0),
)
BY_KEY = {kind.key: kind for kind in KINDS}
ALIASES = {kind.symbol: kind.key for kind in KINDS} | {"Q_l": SIGMA_Y, "alpha_1": ALPHA}
# Where the law itself ends: a value there says that a part of it is not needed, and is no failure.
ENDS = {
    (ALPHA, 1.0),
    (HARDENING, 0.0),
    (E2, 0.0),
    (SCRAGGING, 0.0),
    (MULLINS, 0.0),
}
# What tests would fix a parameter, by the group it belongs to.
REMEDIES = (
    ({M_T, N_T}, "tests at two ambient temperatures at least 20 K apart would fix it"),
    ({C_V, K_V}, "tests at two loading speeds, a factor of five apart, would fix it"),
    ({K_L, SIGMA_Y}, "cycles below 25 % strain, or a specimen without lead, would fix it"),
    ({HARDENING}, "cycles at several amplitudes up to 200 % and more would fix it"),
    ({D_Y, SHAPE, K_R}, "denser samples after each turn and cycles of small strain would fix it"),
    (set(VIRGIN), "more cycles at more amplitudes, growing, on a virgin specimen would fix it"),
    ({ALPHA}, "cycles at two or more amplitudes would fix it"),
)


def full_key(name: str, before: str = "") -> str:
    """Dotted key of a parameter from its key or symbol.

    Parameters
    ----------
    name : "hysteresis.layer_stiffness" or "K_r".
    before : what the message is about, "free: ".

    Returns
    -------
    str : the dotted key.

    Raises
    ------
    InputError : no parameter has that name; the nearest is named.

    Examples
    --------
    >>> full_key("K_r")
    'hysteresis.layer_stiffness'
    """
    key = ALIASES.get(name.strip(), name.strip())
    if key not in BY_KEY:
        raise InputError(f'{before}no parameter "{name}"{nearest(name, [*ALIASES, *BY_KEY])}')
    return key


def forward(transform: Transform, value: float) -> float:
    """Value on the scale of the search.

    Parameters
    ----------
    transform : "linear", "log" or "log1p".
    value : of the parameter, > 0 for "log", > -1 for "log1p".

    Returns
    -------
    float

    Examples
    --------
    >>> forward("log", 1.0), forward("linear", 2.0)
    (0.0, 2.0)
    """
    if transform == "log":
        return math.log(value)
    return math.log1p(value) if transform == "log1p" else value


def _backward(transform: Transform, scaled: float) -> float:
    """The value again.

    Parameters
    ----------
    transform : "linear", "log" or "log1p".
    scaled : from `forward`.

    Returns
    -------
    float

    Examples
    --------
    >>> _backward("log1p", forward("log1p", 0.0))
    0.0
    """
    if transform == "log":
        return math.exp(scaled)
    return math.expm1(scaled) if transform == "log1p" else scaled


SPAN = 10.0  # between ambient temperatures that tell anything of m_T and n_T [K]
TIE = re.compile(r"([^=]+)=(?:([^=*]+)\*)?([^=*]+)")


@dataclass(frozen=True)
class Parameter:
    """One number of a bearing in a fit: free between its bounds, fixed, or tied to another.

    `tie` is (key, factor): the value is factor times that of the other parameter. `bounded` says
    that the user chose the bounds: another starting value does not move them.

    Examples
    --------
    >>> from thermobearing.identify.fit.parameters import BY_KEY
    >>> stiffness = Parameter(BY_KEY[K_R], value=10.0, lower=1.0, upper=100.0)
    >>> round(stiffness.at(0.5), 6), round(stiffness.place(10.0), 6)
    (10.0, 0.5)
    """

    kind: Kind
    value: float
    lower: float
    upper: float
    free: bool = True
    tie: tuple[str, float] | None = None
    bounded: bool = False

    def at(self, unit: float) -> float:
        """Value at a place in [0, 1] between the bounds.

        Parameters
        ----------
        unit : the place, in [0, 1].

        Returns
        -------
        float : in the unit of the parameter.
        """
        low, high = (forward(self.kind.transform, v) for v in (self.lower, self.upper))
        value = _backward(self.kind.transform, low + unit * (high - low))
        return min(max(value, self.lower), self.upper)

    def place(self, value: float) -> float:
        """Place of a value between the bounds, in [0, 1].

        Parameters
        ----------
        value : in the unit of the parameter; beyond a bound it counts as at the bound.

        Returns
        -------
        float : in [0, 1].
        """
        t = self.kind.transform
        low, high = forward(t, self.lower), forward(t, self.upper)
        inside = min(max(value, self.lower), self.upper)
        return (forward(t, inside) - low) / (high - low)

    def slope(self, unit: float) -> float:
        """D value / d place.

        Parameters
        ----------
        unit : the place, in [0, 1].

        Returns
        -------
        float : in the unit of the parameter.
        """
        t, value = self.kind.transform, self.at(unit)
        span = forward(t, self.upper) - forward(t, self.lower)
        return span * {"log": value, "log1p": 1.0 + value}.get(t, 1.0)


@dataclass(frozen=True)
class ParameterSet:
    """All parameters of a fit; the search moves in the unit cube of the free ones.

    Attributes
    ----------
    base : the bearing to begin with.
    parameters : free, fixed and tied ones.

    Examples
    --------
    >>> from thermobearing.bearing.library import load_bearing
    >>> pset = parameter_set(load_bearing("shen-hdr-specimen"), ["K_r"], [23.0])
    >>> round(pset.bearing(pset.start).hysteresis.layer_stiffness, 3)
    30.738
    """

    base: Bearing
    parameters: tuple[Parameter, ...]

    @property
    def free(self) -> list[Parameter]:
        """Those that the search moves."""
        return [p for p in self.parameters if p.free and p.tie is None]

    @property
    def start(self) -> Floats:
        """Where the starting values lie in the unit cube."""
        return np.array([p.place(p.value) for p in self.free])

    def values(self, cube: Floats) -> dict[str, float]:
        """All values, tied ones too, at a point of the unit cube.

        Parameters
        ----------
        cube : a place in [0, 1] for each free parameter.

        Returns
        -------
        dict : values by dotted key, in the units of the parameters.
        """
        found = {p.kind.key: p.value for p in self.parameters}
        found |= {p.kind.key: p.at(float(u)) for p, u in zip(self.free, cube, strict=True)}
        for p in self.parameters:
            if p.tie is not None:
                key, factor = p.tie
                found[p.kind.key] = factor * found[key]
        return found

    def bearing(self, cube: Floats) -> Bearing:
        """The bearing at a point of the unit cube, unchecked: quick, for the search.

        Parameters
        ----------
        cube : a place in [0, 1] for each free parameter.

        Returns
        -------
        Bearing
        """
        return with_values(self.base, self.values(cube))

    def with_start(self, values: dict[str, float]) -> "ParameterSet":
        """The same with other starting values; relative bounds move along, unless they were chosen.

        Parameters
        ----------
        values : by dotted key, in the units of the parameters; others keep theirs.

        Returns
        -------
        ParameterSet
        """
        moved = []
        for p in self.parameters:
            value = values.get(p.kind.key, p.value)
            lower, upper = p.lower, p.upper
            if p.kind.relative and p.free and not p.bounded:
                lower, upper = p.kind.lower * value, p.kind.upper * value
            moved.append(replace(p, value=value, lower=lower, upper=upper))
        return replace(self, parameters=tuple(moved))

    def without(self, keys: Sequence[str]) -> "ParameterSet":
        """The same with some parameters held at the values of the bearing.

        Parameters
        ----------
        keys : dotted.

        Returns
        -------
        ParameterSet
        """
        table = self.base.model_dump()
        held = []
        for p in self.parameters:
            if p.kind.key in keys:
                part, name = p.kind.key.split(".")
                p = replace(p, value=float(table[part][name]), free=False)
            held.append(p)
        return replace(self, parameters=tuple(held))

    def checked(self, cube: Floats) -> Bearing:
        """The bearing at a point of the unit cube, validated: for the result.

        Parameters
        ----------
        cube : a place in [0, 1] for each free parameter.

        Returns
        -------
        Bearing

        Raises
        ------
        InputError : a value that a bearing may not have.
        """
        data = self.base.model_dump()
        for key, value in self.values(cube).items():
            table, name = key.split(".")
            data[table][name] = value
        bearing = validated(Bearing, data, "identified bearing", from_file=False)
        return bearing.with_sources(self.base.sources)


def with_values(bearing: Bearing, values: dict[str, float]) -> Bearing:
    """A copy of a bearing with some numbers changed, without checking them.

    Parameters
    ----------
    bearing : any.
    values : by dotted key, in the units of the parameters.

    Returns
    -------
    Bearing

    Examples
    --------
    >>> from thermobearing.bearing.library import load_bearing
    >>> other = with_values(load_bearing("shen-hdr-specimen"), {K_R: 12.0})
    >>> other.hysteresis.layer_stiffness
    12.0
    """
    tables: dict[str, dict[str, Any]] = {}
    for key, value in values.items():
        table, name = key.split(".")
        tables.setdefault(table, {})[name] = value
    update = {t: getattr(bearing, t).model_copy(update=v) for t, v in tables.items()}
    return bearing.model_copy(update=update)


def available(bearing: Bearing) -> list[Kind]:
    """What there is to identify in a bearing.

    Parameters
    ----------
    bearing : any.

    Returns
    -------
    list of Kind

    Examples
    --------
    >>> from thermobearing.bearing.library import load_bearing
    >>> "K_l" in [kind.symbol for kind in available(load_bearing("shen-lhdr-specimen"))]
    True
    """
    return [k for k in KINDS if getattr(bearing, k.key.split(".")[0]) is not None]


def at_one_temperature(ambients: Iterable[float]) -> bool:
    """Return whether the ambient temperatures of tests are too alike to tell m_T and n_T [degC]."""
    return float(np.ptp(list(ambients))) < SPAN


def split_at_one_temperature(free: Sequence[str]) -> tuple[list[str], list[str]]:
    """Separate the temperature coefficients from the other free parameters.

    Parameters
    ----------
    free : keys, symbols and ties.

    Returns
    -------
    the others, and symbols of the temperature coefficients, free or tied.

    Examples
    --------
    >>> split_at_one_temperature(["K_r", "m_T", "n_T = 2.4 * m_T"])
    (['K_r'], ['m_T', 'n_T'])
    """
    keys = {name: full_key(name.split("=")[0], "free: ") for name in free}
    warm = [name for name in free if keys[name] in (M_T, N_T)]
    return [name for name in free if name not in warm], [BY_KEY[keys[n]].symbol for n in warm]


def default_free(bearing: Bearing, ambients: Iterable[float]) -> list[str]:
    """Keys that are free unless the tests tell nothing of them; see sensitivity.py.

    Those of Tables 4.2 and 5.2, and the yield stress of lead: a fit that takes it from the file
    puts its error into the rubber. Temperature coefficients need tests at two temperatures.
    Linear rubber (post-yield ratio 1, as in an LRB) has one stiffness and one coefficient.
    Others come on top where the tests know them better than their source.

    Parameters
    ----------
    bearing : any.
    ambients : temperatures of the tests [degC], at least one.

    Returns
    -------
    list of str : dotted keys.

    Examples
    --------
    >>> from thermobearing.bearing.library import load_bearing
    >>> default_free(load_bearing("lrb-example"), [23.0])
    ['hysteresis.layer_stiffness', 'lead.stiffness', 'lead.yield_stress']
    """
    linear = bearing.hysteresis.post_yield_ratio == 1.0
    rubber = [K_R] if linear else [ALPHA, K_R, SHAPE, D_Y, HARDENING]
    warm = [] if at_one_temperature(ambients) else [M_T] if linear else [M_T, N_T]
    lead = [K_L, SIGMA_Y] if bearing.lead is not None else []
    rate = [K_V, C_V] if bearing.rate is not None else []
    virgin = VIRGIN if bearing.scragging is not None else ()
    return [*rubber, *warm, *rate, *lead, *virgin]


def _chosen(bearing: Bearing, free: Sequence[str]) -> tuple[set[str], dict[str, tuple[str, float]]]:
    """Free keys and ties from names such as "K_r" and "n_T = 2.4 * m_T"."""
    keys, ties = set(), {}
    there = {kind.key for kind in available(bearing)}
    for name in free:
        match = TIE.fullmatch(name)
        left = full_key(match[1] if match else name, "free: ")
        if left not in there:
            without = left.split(".")[0]
            raise InputError(f'free: "{name}": the bearing "{bearing.name}" has no {without}')
        if match:
            ties[left] = (full_key(match[3], "free: "), _factor(match[2], name))
        else:
            keys.add(left)
    return keys, ties


def _factor(text: str | None, tie: str) -> float:
    """Of a tie such as "n_T = 2.4 * m_T"."""
    try:
        factor = float(text or 1.0)
    except ValueError:
        factor = 0.0
    if not 1.0 / HUGEST <= abs(factor) <= HUGEST:
        raise InputError(f'"{tie}": "{text}" is not a number a parameter can be multiplied by')
    return factor


def parameter_set(
    bearing: Bearing | str | Path,
    free: Sequence[str] | None,
    ambients: Iterable[float],
    bounds: dict[str, tuple[float, float]] | None = None,
) -> ParameterSet:
    """Parameters of a bearing, free or fixed.

    Parameters
    ----------
    bearing : geometry, materials and starting values: a Bearing, a library name, or a TOML file.
    free : keys or symbols of what is free, ties as "n_T = 2.4 * m_T"; None for the usual.
    ambients : ambient temperatures of the tests [degC].
    bounds : other bounds than the usual, by key or symbol, in the unit of the parameter.

    Returns
    -------
    ParameterSet

    Raises
    ------
    InputError : an unknown name, or bounds that exclude each other.

    Examples
    --------
    >>> found = parameter_set("shen-hdr-specimen", ["K_r", "d_y"], [23.0])
    >>> [p.kind.symbol for p in found.free]
    ['K_r', 'd_y']
    """
    bearing = as_bearing(bearing)
    names = default_free(bearing, ambients) if free is None else list(free)
    keys, ties = _chosen(bearing, names)
    if not keys:
        raise InputError("free: nothing is free; name at least one parameter")
    given = {full_key(name): pair for name, pair in (bounds or {}).items()}
    made = []
    for kind in available(bearing):
        table, name = kind.key.split(".")
        value = float(getattr(getattr(bearing, table), name))
        scale = value if kind.relative else 1.0
        lower, upper = given.get(kind.key, (kind.lower * scale, kind.upper * scale))
        if not lower < upper:
            raise InputError(f"{kind.symbol}: bounds {lower:g} to {upper:g} {kind.unit} are empty")
        made.append(
            Parameter(
                kind,
                value,
                lower,
                upper,
                free=kind.key in keys,
                tie=ties.get(kind.key),
                bounded=kind.key in given,
            )
        )
    return ParameterSet(bearing, tuple(made))
