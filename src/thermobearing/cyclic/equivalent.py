"""The bilinear model that is equivalent to a bearing: what design would use instead of it."""

import math
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from thermobearing.bearing.ambient import Ambient
from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.border.library import data_path
from thermobearing.border.schema import Strict, validated
from thermobearing.border.toml import read_toml
from thermobearing.cyclic.history import build_segments, run_segments
from thermobearing.cyclic.protocol import cyclic_test
from thermobearing.model.earlier import BilinearParameters, without_heating
from thermobearing.model.options import ModelOptions, build_model
from thermobearing.model.stack import EndFace
from thermobearing.results.metrics import THIRD_CYCLE, CycleMeasures, measure_cycle

DESIGN_STRAIN = 1.75  # usual in Japanese qualification tests
FATTEST = 0.6  # damping ratio; 2/pi = 0.64 is that of a rectangle
LEAST_DAMPING = 0.05  # damping ratio of a loop in which a yield can be found; usual while elastic
ROUNDING = 1e-9  # of a ratio
SAME_LOOP = 0.01  # of K_eff D and K_eff D^2, by which force and energy of a loop may differ
SAME_ENERGY = 0.01  # by which the energy of a bilinear loop may differ from that of a cycle
MOST_STEPS = 5000  # in a quarter of a cycle, which a slow test of a large bearing would exceed


class PostYieldRatio(Strict):
    """K_2/K_1 of the bilinear model of a kind of bearing; `unverified`: its source was not read."""

    K_2_over_K_1: Annotated[float, Field(gt=0, lt=1)]
    source: str
    unverified: bool


@cache
def post_yield_ratio(kind: str) -> PostYieldRatio:
    """Return K_2/K_1 of a kind of bearing, with its source."""
    path = data_path("equivalent", "stiffness-ratios.toml")
    return validated(PostYieldRatio, read_toml(path)[kind], f"{path}, {kind}")


def bilinear_parameters(
    bearing: Bearing | str | Path,
    *,
    strain: float = DESIGN_STRAIN,
    speed: float = 30.0,
    temperature: float | None = None,
    cycle: int = THIRD_CYCLE,
) -> BilinearParameters:
    """Return the bilinear model with the equivalent stiffness and the loop area of a bearing.

    One cycle (the third by default) of a test without heating at a strain amplitude, a mean speed
    [mm/s] and a temperature [degC] (that of the law of the rubber by default): Q_d, K_2 and K_1 in
    the ratio of the bearing's kind (data/equivalent) such that peak force and energy are those of
    the bearing.
    """
    bearing = as_bearing(bearing)
    measured = isothermal_cycle(bearing, strain, speed, temperature, cycle)
    amplitude = strain * bearing.total_rubber_thickness
    return backbone(measured.stiffness_kN_mm, measured.energy_kN_mm, amplitude, bearing.kind)


def isothermal_cycle(
    bearing: Bearing | str | Path,
    strain: float,
    speed: float = 30.0,
    temperature: float | None = None,
    cycle: int = THIRD_CYCLE,
    lead: float | None = None,
) -> CycleMeasures:
    """Return the measures of a cycle, the third by default, of a bearing that does not warm.

    Units and default of the temperature are those of `bilinear_parameters`; `lead` is that of the
    lead [degC], by default as the rubber.
    """
    bearing = as_bearing(bearing)
    # Nothing is released or lost, so that the bearing keeps its temperature.
    adiabatic = EndFace(eta=1.0)
    model = build_model(bearing, ModelOptions(upper_face=adiabatic, lower_face=adiabatic))
    rubber = bearing.total_rubber_thickness
    test = cyclic_test(strain=[strain], cycles=cycle, speed=speed, closing_strain=None)
    quarter = strain * rubber / speed
    test = test.model_copy(update={"dt": max(test.dt, quarter / MOST_STEPS)})
    at = bearing.hysteresis.reference_temperature if temperature is None else temperature
    history = run_segments(
        without_heating(model.constants),
        build_segments(test, rubber),
        Ambient.constant(at),
        np.full(len(model.stack.part), at),
        initial_lead=lead,
        groups=(),
    )
    rows = np.flatnonzero(history.cycle == cycle)
    # From the row that closes the cycle before.
    quantities = history.rows.response[slice(max(rows[0] - 1, 0), rows[-1] + 1)]
    x, force = quantities["displacement"], quantities["force"]
    return measure_cycle(x, force, area=bearing.area, total_rubber_thickness=rubber)


def first_loading(
    bearing: Bearing | str | Path,
    strain: float,
    speed: float,
    temperature: float,
    lead: float | None = None,
) -> CycleMeasures:
    """Return the first cycle with its largest force as stiffness, and with the energy of the third.

    Rubber that is virgin has the additional force of its first loading once, and its additional
    energy once, while a bilinear loop repeats both: with the energy of the first cycle its damping
    would lower displacements and forces. Arguments are those of `isothermal_cycle`.
    """
    first = isothermal_cycle(bearing, strain, speed, temperature, 1, lead)
    third = isothermal_cycle(bearing, strain, speed, temperature, THIRD_CYCLE, lead)
    largest = max(abs(first.force_max_kN), abs(first.force_min_kN))
    stiffness = largest / first.amplitude_mm
    return replace(first, stiffness_kN_mm=stiffness, energy_kN_mm=third.energy_kN_mm)


def backbone(
    stiffness: float, energy: float, amplitude: float, kind: str = "LRB", *, smallest: bool = False
) -> BilinearParameters:
    """Return Q_d, K_2, K_1 from equivalent stiffness [kN/mm], loop area [kN mm] and amplitude [mm].

    K_1/K_2 is that of the kind of bearing, or as much more as a fat loop needs: with K_1 = 6.5 K_2
    no bilinear loop has more than 28 % of damping. It is more in steps of a quarter, or by as
    little as can be (`smallest`), as links of a bridge have it.
    """
    damping = energy / (2.0 * math.pi * stiffness * amplitude**2)
    ratio = 1.0 / post_yield_ratio(kind).K_2_over_K_1
    if not damping < FATTEST:
        raise InputError(f"no bilinear loop has a damping ratio of {damping:.2f}")
    if smallest:
        ratio = max(ratio, 1.0 / _largest_ratio(damping))
    while (parameters := solve_backbone(stiffness, damping, amplitude, 1.0 / ratio)) is None:
        ratio *= 1.25
    return parameters


def _largest_ratio(damping: float) -> float:
    """Return the largest K_2/K_1 of a bilinear loop with a damping ratio; see `solve_backbone`.

    >>> solve_backbone(1.0, 0.3, 1.0, _largest_ratio(0.3)) is None
    False
    >>> solve_backbone(1.0, 0.3, 1.0, 1.001 * _largest_ratio(0.3)) is None
    True
    """
    target = 0.5 * math.pi * damping
    # Where the discriminant vanishes; less by rounding, so that it is not negative.
    return (1.0 - 4.0 * target / (1.0 + target) ** 2) * (1.0 - ROUNDING)


def stated_backbone(
    bearing: Bearing, cycle: CycleMeasures, amplitude: float
) -> BilinearParameters | None:
    """Return the bilinear loop that a bearing states itself; None where its loop is not bilinear.

    Rubber with one linear branch, parallel to lead cores, has the stiffness K_2 after the lead has
    yielded and K_1 = K_2 + n_l K_l before. K_2 is that of a cycle of an amplitude [mm], and Q_d
    that of its peak force, which is the force at zero displacement beyond twice the yield
    displacement.
    """
    hysteresis, lead = bearing.hysteresis, bearing.lead
    if lead is None or hysteresis.post_yield_ratio < 1.0 or hysteresis.hardening != 0.0:
        return None
    post_yield = cycle.post_yield_stiffness_kN_mm
    strength = (cycle.stiffness_kN_mm - post_yield) * amplitude
    loop = BilinearParameters(strength, post_yield, post_yield + lead.cores * lead.stiffness)
    # A first cycle, virgin rubber and viscous layers have another energy.
    difference = abs(loop.energy(amplitude) - cycle.energy_kN_mm)
    return loop if difference < SAME_ENERGY * cycle.energy_kN_mm else None


def find_backbone(
    bearing: Bearing,
    cycle: CycleMeasures,
    amplitude: float,
    speed: float,
    temperature: float,
    lead: float | None = None,
) -> tuple[BilinearParameters | None, bool]:
    """Return the bilinear loop of a bearing, None without a yield, and whether it is its own.

    Its own loop (`stated_backbone`) is that of a cycle of an amplitude [mm]; up to yield and
    somewhat beyond it, that of a cycle at `DESIGN_STRAIN`, where it has the force and energy of
    the cycle. Other loops are those of `backbone`; in one with less than `LEAST_DAMPING` no yield
    can be found. Speed, temperature and lead are those of the cycle, see `isothermal_cycle`.
    """
    loop = stated_backbone(bearing, cycle, amplitude)
    size = cycle.stiffness_kN_mm * amplitude
    if loop is None and bearing.lead is not None:
        beyond = DESIGN_STRAIN * bearing.total_rubber_thickness
        same_period = speed * beyond / amplitude
        larger = isothermal_cycle(
            bearing, DESIGN_STRAIN, same_period, temperature, cycle=THIRD_CYCLE, lead=lead
        )
        loop = stated_backbone(bearing, larger, beyond)
        if loop is not None and not (
            abs(loop.stiffness(amplitude) * amplitude - size) < SAME_LOOP * size
            and abs(loop.energy(amplitude) - cycle.energy_kN_mm) < SAME_LOOP * size * amplitude
        ):
            loop = None
    if loop is not None:
        return loop, True
    if cycle.energy_kN_mm < 2.0 * math.pi * LEAST_DAMPING * size * amplitude:
        return None, False
    size_of_loop = (cycle.stiffness_kN_mm, cycle.energy_kN_mm, amplitude)
    return backbone(*size_of_loop, bearing.kind, smallest=True), False


def solve_backbone(
    stiffness: float, damping: float, amplitude: float, stiffness_ratio: float
) -> BilinearParameters | None:
    """Return the bilinear model of an equivalent stiffness and damping ratio; None if too fat.

    With q = Q_d/(K_B u), alpha = K_2/K_1: peak force K_B u = Q_d + K_2 u, loop area
    2 pi h K_B u^2 = 4 Q_d (u - u_y), u_y = Q_d/(K_1 - K_2), so that
    pi h/2 = q - q^2 alpha/((1 - alpha)(1 - q)), of which the smaller root is taken.
    """
    target = 0.5 * math.pi * damping
    ratio = stiffness_ratio / (1.0 - stiffness_ratio)
    discriminant = (1.0 + target) ** 2 - 4.0 * (1.0 + ratio) * target
    if discriminant < 0.0:
        return None
    share = (1.0 + target - math.sqrt(discriminant)) / (2.0 * (1.0 + ratio))
    post_yield = stiffness * (1.0 - share)
    strength = share * stiffness * amplitude
    return BilinearParameters(strength, post_yield, post_yield / stiffness_ratio)
