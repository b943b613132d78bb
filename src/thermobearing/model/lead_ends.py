"""Numbers of a confined lead core that stands on end plates of finite thickness.

Core and plate exchange heat through a kernel of exponentials (core/lead_ends.py). Exact
series of two bodies give resistances a and times tau:

* the plate, thickness H, its far face at ambient temperature, around each core a disc of the
  plan's share, pi R^2. Modes J0(l r) cos(b z), l R a zero of J1, b = (m - 1/2) pi/H; the mode
  l = 0 is what the stack of cells solves already:
  a = 8 J1(l r_l)^2 / (l^2 R^2 J0(l R)^2) / (A_l H k_s (l^2 + b^2)), tau = 1/(alpha_s (l^2 + b^2))
* the core, half height h: bulk less end, when heat leaves at the end:
  a = 2 h/(n^2 pi^2 k_l A_l), tau = h^2/(n^2 pi^2 alpha_l)

Terms whose times lie in one half of a decade become one: some ten remain.
"""

import math

import numpy as np

from thermobearing.bearing.model import Bearing
from thermobearing.core.records import Floats, Rows, filled, rows
from thermobearing.core.types import Mode
from thermobearing.model.stack import MM_PER_M

RADIAL, AXIAL = 400, 200  # modes summed
SHORTEST = 1e-3  # s: what settles faster counts as one term
PER_DECADE = 2.0


def no_modes() -> Rows[Mode]:
    """For cores on a half-space."""
    return rows(Mode, 0)


def plate_modes(bearing: Bearing) -> Floats:
    """[2, n] a and tau of a disc on an end plate, less the mean over the plan."""
    from scipy.special import j0, j1, jn_zeros  # a third of a second, only for this option

    lead, steel = bearing.lead, bearing.materials.steel
    assert lead is not None
    k, height = steel.conductivity / MM_PER_M, bearing.geometry.end_plate_thickness
    radius = math.sqrt(bearing.area / lead.cores / math.pi)
    wave = jn_zeros(1, RADIAL) / radius
    share = 8.0 * (j1(wave * lead.radius) / (wave * radius * j0(wave * radius))) ** 2
    rate = wave[:, None] ** 2 + ((np.arange(AXIAL) + 0.5) * math.pi / height) ** 2
    a = share[:, None] / (lead.core_area * height * k * rate)
    return np.array([a.ravel(), (steel.volumetric_heat / k / rate).ravel()])


def core_modes(bearing: Bearing, half_height: float) -> Floats:
    """[2, n] a and tau of the bulk of a core less its end."""
    lead, material = bearing.lead, bearing.materials.lead
    assert lead is not None
    assert material is not None
    k, n = material.conductivity / MM_PER_M, np.arange(1, AXIAL + 1) * math.pi
    a = 2.0 * half_height / (n**2 * k * lead.core_area)
    return np.array([a, half_height**2 * material.volumetric_heat / k / n**2])


def lumped(modes: Floats) -> Floats:
    """Few terms for many: sum of a, mean of log tau, in every half of a decade."""
    a, tau = modes
    part = np.floor(PER_DECADE * np.log10(np.maximum(tau / SHORTEST, 1.0)))
    found = []
    for number in np.unique(part):
        here = part == number
        total = a[here].sum()
        found.append((total, math.exp(float(a[here] @ np.log(tau[here]) / total))))
    return np.array(found).T


def end_modes(bearing: Bearing, half_height: float) -> Rows[Mode]:
    """[K] terms of one core and one end plate.

    Parameters
    ----------
    bearing : with confined lead cores; its `end_spreading` reduces the resistance of the plate.
    half_height : of a core [mm].
    """
    assert bearing.lead is not None
    plate, core = plate_modes(bearing), core_modes(bearing, half_height)
    plate[0] *= bearing.lead.end_spreading
    resistance, relaxation = lumped(np.concatenate([plate, core], axis=1))
    return filled(Mode, resistance=resistance, relaxation=relaxation)
