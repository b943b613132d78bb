"""Rate dependence: a dashpot and a spring in series, parallel to the rubber (Eq. 5.38-5.39).

    f_v' + f_v / tau = K_v x',   tau = c_v / K_v

Exact for a displacement that changes linearly over the step.
"""

import math

from thermobearing.core.compiled.kernel import compiled


@compiled
def maxwell(
    stiffness: float, relaxation: float, force: float, dx: float, dt: float
) -> tuple[float, float]:
    """Force [kN] and tangent [kN/mm] of the branch after dx [mm] in dt [s].

    `stiffness` is K_v [kN/mm], `relaxation` tau = c_v/K_v [s].
    """
    decay = math.exp(-dt / relaxation)
    tangent = -math.expm1(-dt / relaxation) * stiffness * relaxation / dt
    return force * decay + tangent * dx, tangent
