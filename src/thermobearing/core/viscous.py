"""Rate dependence: a dashpot and a spring in series, parallel to the rubber (Eq. 5.38-5.39).

    f_v' + f_v / tau = K_v x',   tau = c_v / K_v

Exact for a displacement that changes linearly over the step.
"""

import math

from thermobearing.core.compiled.kernel import compiled
from thermobearing.core.vector import Vector, plus, scaled


@compiled
def maxwell(
    stiffness: float, relaxation: float, force: Vector, dx: Vector, dt: float
) -> tuple[Vector, float]:
    """Force [kN] and tangent [kN/mm], the same in all directions, after dx [mm] in dt [s].

    `stiffness` is K_v [kN/mm], `relaxation` tau = c_v/K_v [s].
    """
    decay = math.exp(-dt / relaxation)
    tangent = -math.expm1(-dt / relaxation) * stiffness * relaxation / dt
    return plus(scaled(force, decay), scaled(dx, tangent)), tangent
