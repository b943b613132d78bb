"""Forces of devices parallel to bearings: viscous dampers, friction sliders and gaps.

Every device has a stretch, that of its body less that of its base, along its axis or, for a slider
in plan, in both directions. Its force is that of the end of a step, with the velocity of the time
integration, so that its work is trapezoidal as all works of a structure.

    damper   F = c f v (v^2 + v_0^2)^((alpha - 1)/2), which is c f |v|^alpha beyond v_0, with a
             factor f of the temperature of its oil
    slider   elastic up to the friction force, F_f - (F_f - F_s) exp(-a |v|)
    gap      F = k p max(1 + lambda p', 0), with the penetration p beyond the opening
"""

import math

from thermobearing.core.compiled.kernel import compiled
from thermobearing.core.lanes.choose import select
from thermobearing.core.vector import (
    Vector,
    along_x,
    components,
    dot,
    minus,
    norm,
    plus,
    scaled,
)
from thermobearing.structure.types import (
    DAMPER,
    SLIDER,
    Device,
    DeviceResponse,
    Devices,
)

SMOOTHED = 0.1  # mm/s: velocity v_0 below which a damper is linear, so that Newton converges


@compiled
def oil_factor(devices: Devices, d: int, temperature: float) -> float:
    """Factor of a damper at the temperature of its oil [degC], constant beyond its table."""
    factor: float = devices.factors[d, 0] + 0.0 * temperature
    for k in range(1, devices.factors.shape[1]):
        colder = devices.temperatures[d, k - 1]
        share = (temperature - colder) / (devices.temperatures[d, k] - colder)
        share = min(max(share, 0.0), 1.0)
        factor += share * (devices.factors[d, k] - devices.factors[d, k - 1])
    return factor


@compiled
def _damper(
    device: Device, factor: float, stretch: Vector, velocity: Vector, by_v: float
) -> tuple[Vector, float, float]:
    """Force of a damper, and its slopes as `device_force` has them."""
    v = along_x(velocity)
    square = v * v + SMOOTHED * SMOOTHED
    constant = device.damping * factor * square ** (0.5 * (device.exponent - 1.0))
    slope = constant * (device.exponent * v * v + SMOOTHED * SMOOTHED) / square
    force = constant * v
    return components(stretch, force, 0.0 * force), slope * by_v, 0.0 * slope


@compiled
def _slider(
    device: Device, old: DeviceResponse, stretch: Vector, velocity: Vector, by_v: float
) -> tuple[Vector, float, float]:
    """Force of a slider, and its slopes as `device_force` has them."""
    decay = math.exp(-device.rate * norm(velocity))
    drop = (device.friction - device.slow_friction) * decay
    limit = device.friction - drop
    trial = plus(old.force, scaled(minus(stretch, old.stretch), device.stiffness))
    size = norm(trial)
    slides = size > limit
    share = select(slides, limit / select(slides, size, 1.0), 1.0)
    stiffness = device.stiffness * share
    radial = select(slides, drop * device.rate * by_v - stiffness, 0.0)
    return scaled(trial, share), stiffness, radial


@compiled
def _penetrations(device: Device, stretch: Vector) -> tuple[float, float]:
    """Penetrations of a gap [mm] above and below, at least zero."""
    x = along_x(stretch)
    above = device.closes_above * max(x - device.gap, 0.0)
    below = device.closes_below * max(-x - device.gap, 0.0)
    return above, below


@compiled
def _gap(
    device: Device, stretch: Vector, velocity: Vector, by_v: float
) -> tuple[Vector, float, float]:
    """Force of a gap, and its slopes as `device_force` has them."""
    above, below = _penetrations(device, stretch)
    faster = device.dissipation * along_x(velocity)
    pressed_above, pressed_below = max(1.0 + faster, 0.0), max(1.0 - faster, 0.0)
    force = device.stiffness * (above * pressed_above - below * pressed_below)
    # The slope of what is in contact, less where it separates too fast to press.
    grows = device.dissipation * by_v
    slope_above = pressed_above + select(pressed_above > 0.0, grows * above, 0.0)
    slope_below = pressed_below + select(pressed_below > 0.0, grows * below, 0.0)
    slope = select(above > 0.0, slope_above, 0.0) + select(below > 0.0, slope_below, 0.0)
    return components(stretch, force, 0.0 * force), device.stiffness * slope, 0.0 * slope


@compiled
def device_force(
    device: Device,
    old: DeviceResponse,
    factor: float,
    stretch: Vector,
    velocity: Vector,
    by_v: float,
) -> tuple[Vector, float, float]:
    """Force of a device [kN], with the velocity that a stretch changes by `by_v` [1/s].

    The tangent is a I + b d d', d the direction of the force; the slopes a and b [kN/mm] follow
    the force.
    """
    if device.kind == DAMPER:
        force, isotropic_slope, radial_slope = _damper(device, factor, stretch, velocity, by_v)
    elif device.kind == SLIDER:
        force, isotropic_slope, radial_slope = _slider(device, old, stretch, velocity, by_v)
    else:
        force, isotropic_slope, radial_slope = _gap(device, stretch, velocity, by_v)
    return force, isotropic_slope, radial_slope


@compiled
def stored_energy(device: Device, stretch: Vector, force: Vector) -> float:
    """Energy that a device gives back [kN mm]."""
    if device.kind == DAMPER:
        return 0.0 * dot(force, force)
    if device.kind == SLIDER:
        return 0.5 * dot(force, force) / device.stiffness
    above, below = _penetrations(device, stretch)
    return 0.5 * device.stiffness * (above * above + below * below)
