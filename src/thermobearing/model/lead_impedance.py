"""What heat from a lead core meets on its ways out, in Laplace's domain.

Each function gives, at `FREQUENCIES` s on the positive real axis, an impedance Z(s): how much
warmer a place becomes by a flow of one [K s/(kN mm)], or an admittance. Such a Z is a sum of
a/(1 + s tau) with a > 0, which `fitted` finds. Means over the plan are left out: the stack of
cells has them already.
"""

from functools import cache
from typing import Any

import numpy as np

from thermobearing.bearing.model import Material
from thermobearing.core.records import Floats
from thermobearing.model.stack import MM_PER_M

RADIAL = 400  # modes of a disc on a plate
AXIAL = 200  # modes of a core
ACROSS = 60  # modes across one shim and one layer
BELOW = 4  # layers and shims that a hot spot of the plate above reaches
FREQUENCIES = np.logspace(-5.0, 1.0, 65)  # 1/s: what tenths of a second to a day show
RELAXATIONS = np.logspace(-1.5, 4.5, 11)  # s, to choose from
SMALL = 1e-3  # below it a series is exact to rounding


def numbers(material: Material) -> tuple[float, float]:
    """Conductivity [kN/(s K)] and heat capacity [kN mm/(mm3 K)]."""
    return material.conductivity / MM_PER_M, material.volumetric_heat


def fitted(impedance: Floats) -> Floats:
    """[2, K] a and tau of the terms of an impedance: relative least squares with a >= 0."""
    from scipy.optimize import nnls  # a third of a second, only for lead

    terms = 1.0 / (1.0 + FREQUENCIES[:, None] * RELAXATIONS) / impedance[:, None]
    size = np.linalg.norm(terms, axis=0)
    weight, _ = nnls(terms / size, np.ones(len(impedance)), maxiter=100 * len(size))
    kept = weight > 0.0
    return np.array([(weight / size)[kept], RELAXATIONS[kept]])


@cache
def plan_modes() -> tuple[Floats, Floats]:
    """Zeros of J1, and J0 there: modes of a disc that is insulated at its edge."""
    from scipy.special import j0, jn_zeros

    zeros = jn_zeros(1, RADIAL)
    return zeros, j0(zeros)


def disc_on_plate(
    steel: Material,
    height: float,
    film: float,
    radius: float,
    plan: float,
    below: tuple[Material, float, float] | None = None,
) -> Floats:
    """Mean over a disc that heats the near face of a plate, less the mean over the plan.

    Parameters
    ----------
    steel, height : of the plate; height [mm].
    film : at its far face [kN/(s mm K)], 0 to inf.
    radius : of the disc [mm].
    plan : radius at which the plate is insulated [mm].
    below : rubber, thickness of its layers and of the shims [mm], if layers lie against the
        near face around the disc; they take heat from the hot spot.
    """
    from scipy.special import j1

    k, heat = numbers(steel)
    zeros, j0_there = plan_modes()
    wave = zeros / plan
    share = 4.0 * (j1(wave * radius) / (zeros * j0_there)) ** 2
    own = k * np.sqrt(wave**2 + FREQUENCIES[:, None] * heat / k)
    admittance = _through(own, np.tanh(own / k * height), film)
    if below is not None:
        around = 1.0 - (radius / plan) ** 2
        admittance = admittance + around * _layers(steel, *below, wave=wave)
    return np.asarray((share / admittance).sum(axis=1) / (np.pi * radius**2))


def _through(own: Any, tangent: Any, beyond: Any) -> Any:
    """Admittance of a slab with another one beyond it; `own` k beta, `tangent` tanh(beta H)."""
    if np.isscalar(beyond) and np.isinf(beyond):
        return own / tangent
    return own * (beyond + own * tangent) / (own + beyond * tangent)


def _layers(steel: Material, rubber: Material, layer: float, shim: float, wave: Floats) -> Floats:
    """Admittance of layers and shims to radial modes, per area."""
    k, heat = numbers(steel)
    k_rubber, heat_rubber = numbers(rubber)
    s = FREQUENCIES[:, None]
    own = k_rubber * np.sqrt(wave**2 + s * heat_rubber / k_rubber)
    tangent = np.tanh(own / k_rubber * layer)
    total = np.zeros_like(own)
    for _ in range(BELOW):
        total = _through(own, tangent, total + shim * (heat * s + k * wave**2))
    return total


def core_modes(lead: Material, half_height: float, radius: float, beside: Any = 0.0) -> Floats:
    """[AXIAL, s] modes cos(n pi z/h) of a core, heated by one at z = 0.

    `beside` is what else takes heat from them, per height [kN/(s K)].
    """
    k, heat = numbers(lead)
    area = np.pi * radius**2
    wave = np.arange(1, AXIAL + 1)[:, None] * np.pi / half_height
    return np.asarray(2.0 / half_height / (area * (heat * FREQUENCIES + k * wave**2) + beside))


def core_to_wall(lead: Material, height: float, radius: float) -> Floats:
    """Mean of a core less its wall, when heat leaves evenly through the wall."""
    from scipy.special import ive

    k, heat = numbers(lead)
    x = radius * np.sqrt(FREQUENCIES * heat / k)
    large = np.maximum(x, SMALL)
    whole = (large * ive(0, large) / ive(1, large) - 2.0) / large**2
    return np.asarray(np.where(x > SMALL, whole, 0.25) / (2.0 * np.pi * k * height))


def to_edges(lead: Material, height: float, shim: float, layer: float, radius: float) -> Floats:
    """Wall at the edges of the shims less all the wall, when heat leaves through them only."""
    from scipy.special import ive

    k, heat = numbers(lead)
    n = np.arange(1, ACROSS + 1)
    wave = np.sqrt((2.0 * np.pi * n / (shim + layer)) ** 2 + FREQUENCIES[:, None] * heat / k)
    mode = 2.0 * np.sinc(n * shim / (shim + layer)) ** 2
    field = ive(0, wave * radius) / ive(1, wave * radius) / wave
    return np.asarray((mode * field).sum(axis=1) / (2.0 * np.pi * radius * height * k))


def fin_heat(
    steel: Material, thickness: float, rubber: Material, layer: float, faces: int
) -> Floats:
    """Admittance per area of a fin with half a layer of rubber on one or two faces."""
    _, heat = numbers(steel)
    k, heat_rubber = numbers(rubber)
    beta = np.sqrt(FREQUENCIES * heat_rubber / k)
    return np.asarray(
        thickness * heat * FREQUENCIES + faces * k * beta * np.tanh(0.5 * beta * layer)
    )


def fin(steel: Material, thickness: float, per_area: Floats, radius: float, plan: float) -> Floats:
    """Inner edge of an annular fin that is heated there, less its mean: Bessel's functions."""
    from scipy.special import ive, kve

    across = numbers(steel)[0] * thickness
    m = np.sqrt(per_area / across)
    inner, outer = m * radius, m * plan
    damped = np.exp(-2.0 * (outer - inner))
    above = kve(0, inner) * ive(1, outer) + ive(0, inner) * kve(1, outer) * damped
    below = kve(1, inner) * ive(1, outer) - ive(1, inner) * kve(1, outer) * damped
    whole = above / below / (2.0 * np.pi * radius * across * m)
    return np.asarray(whole - 1.0 / (np.pi * (plan**2 - radius**2) * per_area))


def rubber_at_wall(rubber: Material, layer: float, radius: float) -> Floats:
    """Admittance of a layer that touches the wall, beyond what the shims beside it give."""
    k, heat = numbers(rubber)
    odd = np.pi * (2.0 * np.arange(RADIAL) + 1.0)
    rate = FREQUENCIES[:, None] * heat / k
    each = 8.0 / odd**2 * rate / np.sqrt((odd / layer) ** 2 + rate)
    return np.asarray(2.0 * np.pi * radius * layer * k * each.sum(axis=1))
