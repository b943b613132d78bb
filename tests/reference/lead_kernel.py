"""A closure for the heat of confined lead cores without p and without a clock: one kernel.

The bulk of a core is warmer than the end plate under it (mean over the plan) by the
superposition of everything that passed between them,

    T_l - T_plate = sum of y_i,      dy_i/dt = (a_i q - y_i)/tau_i,

q the heat flow of one core into one plate. Exact series for two bodies give a_i and tau_i:

* the plate, thickness H, its far face at ambient temperature, around each core a disc of the
  plan's share, pi R^2. Modes J0(l r) cos(b z), l R a zero of J1, b = (m - 1/2) pi/H; the mode
  l = 0 is what the stack of cells solves already:
  a = 8 J1(l r_l)^2 / (l^2 R^2 J0(l R)^2) / (A_l H k_s (l^2 + b^2)), tau = 1/(alpha_s (l^2 + b^2))
* the core, half height h: bulk less end, when heat leaves at the end:
  a = 2 h/(n^2 pi^2 k_l A_l), tau = h^2/(n^2 pi^2 alpha_l)

`return_path` is for sealing plates: heat spreads past the edge of the core into the sealing
plate as well, which the disc on an insulated face knows nothing of. Finite elements say 0.8
with sealing plates (specimen and bridge), 1 without. Units: kN, mm, s, degC.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import j0, j1, jn_zeros

from thermobearing.bearing.model import Bearing

Floats = NDArray[np.float64]

RADIAL, AXIAL = 400, 200  # modes kept
SHORTEST = 1e-3  # s: what settles faster is one term


@dataclass(frozen=True)
class Kernel:
    """Resistances a [K s/(kN mm)] and times tau [s]."""

    a: Floats
    tau: Floats


def plate_modes(bearing: Bearing) -> Kernel:
    """Disc of the core on an end plate, less the mean over the plan."""
    lead, steel = bearing.lead, bearing.materials.steel
    assert lead is not None
    k, height = steel.conductivity * 1e-3, bearing.geometry.end_plate_thickness
    radius = math.sqrt(bearing.area / lead.cores / math.pi)
    wave = jn_zeros(1, RADIAL) / radius
    share = 8.0 * (j1(wave * lead.radius) / (wave * radius * j0(wave * radius))) ** 2
    rate = wave[:, None] ** 2 + ((np.arange(AXIAL) + 0.5) * math.pi / height) ** 2
    a = share[:, None] / (lead.core_area * height * k * rate)
    return Kernel(a.ravel(), (steel.volumetric_heat / k / rate).ravel())


def core_modes(bearing: Bearing, half_height: float) -> Kernel:
    """Bulk of the core less its end."""
    lead, material = bearing.lead, bearing.materials.lead
    assert lead is not None
    assert material is not None
    k, n = material.conductivity * 1e-3, np.arange(1, AXIAL + 1) * math.pi
    a = 2.0 * half_height / (n**2 * k * lead.core_area)
    return Kernel(a, half_height**2 * material.volumetric_heat / k / n**2)


def lumped(kernel: Kernel, per_decade: float = 2.0) -> Kernel:
    """Few terms for many: those whose times lie in one part of a decade become one."""
    part = np.floor(per_decade * np.log10(np.maximum(kernel.tau / SHORTEST, 1.0)))
    found = []
    for number in np.unique(part):
        a, tau = kernel.a[part == number], kernel.tau[part == number]
        found.append((a.sum(), math.exp(float(a @ np.log(tau) / a.sum()))))
    return Kernel(*np.array(found).T)


def end_kernel(bearing: Bearing, half_height: float, return_path: float = 1.0) -> Kernel:
    """Of one core and one end plate: some ten terms."""
    plate, core = plate_modes(bearing), core_modes(bearing, half_height)
    a = np.concatenate([return_path * plate.a, core.a])
    return lumped(Kernel(a, np.concatenate([plate.tau, core.tau])))


def lead_rise(
    kernel: Kernel, time: Floats, heat: Floats, plate: Floats, capacity: float
) -> tuple[Floats, Floats]:
    """Rise of the lead, and heat passed on, at the given times.

    `heat` of half a core until then [kN mm], rise of the plate under it [K], heat capacity of
    half a core. The flow is constant over a step and implicit in the lead: any step is stable.
    """
    rise, passed, y = np.zeros(len(time)), np.zeros(len(time)), np.zeros(len(kernel.a))
    for n in range(len(time) - 1):
        dt = time[n + 1] - time[n]
        keep = np.exp(-dt / kernel.tau)
        gain = kernel.a * (1.0 - keep)
        warm = rise[n] + (heat[n + 1] - heat[n]) / capacity
        flow = (warm - plate[n + 1] - keep @ y) / (gain.sum() + dt / capacity)
        y = keep * y + gain * flow
        rise[n + 1] = warm - flow * dt / capacity
        passed[n + 1] = passed[n] + flow * dt
    return rise, passed
