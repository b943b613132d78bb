"""The numbers of a bearing that may be identified: keys, symbols, bounds, scales."""

import math
from dataclasses import dataclass
from typing import Literal

from thermobearing.border.errors import InputError, nearest

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


def backward(transform: Transform, scaled: float) -> float:
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
    >>> backward("log1p", forward("log1p", 0.0))
    0.0
    """
    if transform == "log":
        return math.exp(scaled)
    return math.expm1(scaled) if transform == "log1p" else scaled
