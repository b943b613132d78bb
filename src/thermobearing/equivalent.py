"""The bilinear model that is equivalent to a bearing: what design would use instead of it."""

import numpy as np

from thermobearing.bearing.model import Bearing
from thermobearing.drive.ambient import Ambient
from thermobearing.drive.assemble import build_constants
from thermobearing.drive.baselines import (
    STIFFNESS_RATIO,
    BilinearParameters,
    isothermal,
)
from thermobearing.drive.protocol import build_segments, cyclic_test
from thermobearing.drive.run import run_segments
from thermobearing.results.metrics import measure_cycle
from thermobearing.stack import Face, build_stack

DESIGN_STRAIN = 1.75  # usual in Japanese qualification tests
CYCLE = 3  # the cycle that standards measure


def bilinear_parameters(
    bearing: Bearing, *, strain: float = DESIGN_STRAIN, speed: float = 30.0
) -> BilinearParameters:
    """Bilinear model with the equivalent stiffness and the loop area of a bearing.

    The third cycle of a test at the reference temperature of the rubber, without heating:
    Q_d, K_2 and K_1 = 6.5 K_2 such that peak force and energy are those of the bearing.

    Parameters
    ----------
    bearing : any.
    strain : shear strain amplitude, > 0.
    speed : mean loading rate [mm/s]; matters with rate dependence only.

    Returns
    -------
    BilinearParameters
    """
    stack = build_stack(bearing, half=True)
    adiabatic = Face(eta=1.0)
    constants = isothermal(build_constants(bearing, stack, upper=adiabatic, lower=None))
    rubber = bearing.total_rubber_thickness
    test = cyclic_test(strain=[strain], cycles=CYCLE, speed=speed, closing_strain=None)
    reference = bearing.hysteresis.reference_temperature
    history = run_segments(
        constants,
        build_segments(test, rubber),
        Ambient.constant(reference),
        np.full(len(stack.part), reference),
        groups=(),
    )
    third = np.flatnonzero(history.cycle == CYCLE)
    rows = slice(third[0] - 1, third[-1] + 1)
    x, force = history.rows[rows, 1], history.rows[rows, 2]
    measured = measure_cycle(x, force, area=bearing.area, total_rubber_thickness=rubber)
    return backbone(measured.stiffness_kN_mm, measured.energy_kN_mm, strain * rubber)


def backbone(stiffness: float, energy: float, amplitude: float) -> BilinearParameters:
    """Q_d, K_2, K_1 from equivalent stiffness, loop area and amplitude.

    F_max = Q_d + K_2 u = K_B u, and the parallelogram 4 Q_d (u - u_y) = E with
    u_y = Q_d / (K_1 - K_2), K_1 = 6.5 K_2.
    """
    peak, ratio = stiffness * amplitude, STIFFNESS_RATIO - 1.0
    strength = 0.25 * energy / amplitude
    for _ in range(100):  # a contraction: the yield displacement is a small part of u
        post_yield = (peak - strength) / amplitude
        yielding = strength / (ratio * post_yield)
        strength = 0.25 * energy / (amplitude - yielding)
    return BilinearParameters(strength, post_yield, STIFFNESS_RATIO * post_yield)
