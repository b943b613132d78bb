"""How the rubber layers in series share the bearing displacement (Shen 2023, 4.3.1).

Every layer carries the same force and the layer displacements add up to that of the
bearing; Newton's method finds them. The layer law (Eq. 4.34)

    f = ke d + (1 + B d^2) kh Z(d),   B = b/t_r^2

has the tangent ke + (1 + B d^2) kh Z'(d) + 2 B d kh Z. Its last term is negative while a
strained layer unloads (d and Z of opposite sign) and outweighs the others in the cold at
large strain: then equal forces no longer fix the displacements (the layers would snap
through one by one). The rule used there, and only there:

    the hardening factor is taken at  s = (1 - w) d + w x/N  instead of at d,

between the layer's own displacement (w = 0) and the mean one (w = 1). The tangent becomes
ke + (1 + B s^2) kh Z' + (1 - w) 2 B s kh Z, which is positive for every layer at w = 1
(Z' >= 0), so the sharing is unique however cold or strained the bearing is. w is a smooth
function of the smallest layer tangent that equal increments x/N would give: 0 above
`sharing_start` times ke, 1 below `sharing_full` times ke. It asks for no solution, so force
and tangent are continuous in x, and dw/dx is known. All layers still carry one force F, so the
work F dd_j of the layers adds up to F dx and the energy balance needs no extra term; the price is
the difference between F and the force of the unmodified layer law, reported as the mismatch.

In a plane forces and displacements are vectors, and tangents are matrices: d^2 is |d|^2, the last
term of the tangent is (1 - w) 2 B kh Z s', and what is said of a tangent holds for the smallest
eigenvalue of its symmetric part.
"""

import math

from thermobearing.core.compiled.kernel import compiled, compiled_apart, compiled_once
from thermobearing.core.hardening import force_and_tangent, hardening_strain, weight
from thermobearing.core.hysteresis import NO_MOTION, advance, leaves_branch, start_slope
from thermobearing.core.lanes.choose import all_lanes, any_lane, no, select
from thermobearing.core.records import Floats, Rows
from thermobearing.core.types import (
    COMPLETED,
    EULER_UNSTABLE,
    NOT_CONVERGED,
    NOT_FINITE,
    SOFTENED,
    Layer,
    LayerWork,
    Rubber,
    State,
)
from thermobearing.core.vector import (
    Matrix,
    Pair,
    Square,
    Vector,
    choice,
    direction,
    dot,
    inverse,
    isotropic,
    lowest,
    minus,
    no_slope,
    norm,
    outer,
    pick,
    plus,
    product,
    scaled,
    solve,
    times,
    total,
    zero,
)

PLAIN_NEWTON = 10  # iterations before each Newton step is searched along its line
ALL_NEWTON = 60
LINE_SEARCH = 30
LAST_CORRECTION = 1e-6  # relative force difference that one more correction squares away
EULER_LIMIT = 4.0  # |Z| / d_y beyond which explicit Euler has clearly lost its way


@compiled
def _layer_law(
    rubber: Rubber,
    old: State,
    work: LayerWork,
    j: int,
    d: Vector,
    mean: Vector,
    w: float,
) -> tuple[Vector, Matrix, Vector, Matrix]:
    """Force [kN], tangent [kN/mm], Z [mm] and dZ/dd of layer j at displacement d (Eq. 4.34)."""
    z, slope = advance(rubber, old, j, d, minus(d, old.layers[j].d))
    ke, kh = work.elastic[j], work.hysteretic[j]
    force, tangent = force_and_tangent(rubber, ke, kh, d, z, slope, mean, w)
    return force, tangent, z, slope


@compiled_once
def evaluate(
    rubber: Rubber, old: State, work: LayerWork, mean: Vector, w: float, new: Rows[Layer]
) -> float:
    """Forces and tangents of all layers at the trial, their Z into `new`; smallest tangent."""
    smallest = math.inf
    for j in range(len(new)):
        force, tangent, z, slope = _layer_law(rubber, old, work, j, work.trial[j], mean, w)
        work.force[j] = force
        work.tangent[j] = tangent
        work.slope[j] = slope
        new[j].z = z
        smallest = min(smallest, lowest(tangent))
    return smallest


@compiled
def _line_slope(
    rubber: Rubber,
    multiplicity: Floats,
    old: State,
    work: LayerWork,
    mean: Vector,
    w: float,
    a: float,
) -> float:
    """Slope, along the Newton direction, of the convex energy that sharing minimises."""
    slope = 0.0
    for j in range(len(multiplicity)):
        d = plus(work.trial[j], scaled(work.direction[j], a))
        force, _, _, _ = _layer_law(rubber, old, work, j, d, mean, w)
        slope += dot(scaled(force, multiplicity[j]), work.direction[j])
    return slope


@compiled_apart
def search(
    rubber: Rubber,
    multiplicity: Floats,
    old: State,
    work: LayerWork,
    mean: Vector,
    w: float,
) -> float:
    """Step length in (0, 1] that clearly reduces the slope along the Newton direction."""
    start = abs(_line_slope(rubber, multiplicity, old, work, mean, w, 0.0))
    low, high, a = 0.0, 1.0, 1.0
    for _ in range(LINE_SEARCH):
        slope = _line_slope(rubber, multiplicity, old, work, mean, w, a)
        # Half of the slope is enough, and so is the full step where it stays before the minimum.
        # `no(... > ...)` lets NaN end the loop.
        enough = no(abs(slope) > 0.5 * start) | ((slope <= 0.0) & (a == 1.0))
        if all_lanes(enough):
            break
        too_far = slope > 0.0
        high, low = select(too_far, a, high), select(too_far, low, a)
        a = select(enough, a, 0.5 * (low + high))
    return a


@compiled
def _mean_strain_on_line(
    rubber: Rubber, per: float, kh: float, z: float, s: float, w: float
) -> float:
    """`per` times the derivative of a layer force by the mean displacement."""
    return per * w * 2.0 * rubber.hardening * s * kh * z


@compiled
def _mean_strain_in_plane(
    rubber: Rubber, per: Square, kh: float, z: Pair, s: Pair, w: float
) -> Square:
    """`_by_mean_strain` in a plane."""
    return outer(times(per, z), scaled(s, w * 2.0 * rubber.hardening * kh))


_by_mean_strain = choice(_mean_strain_on_line, _mean_strain_in_plane, at=3)


@compiled_apart
def _by_mean(
    rubber: Rubber,
    multiplicity: Floats,
    work: LayerWork,
    new: Rows[Layer],
    mean: Vector,
    w: float,
) -> Matrix:
    """Derivative, by the mean displacement, of the layer displacements at a common force."""
    by_mean = no_slope(mean)
    for j in range(len(work.trial)):
        per = scaled(work.flexibility[j], multiplicity[j])
        s = hardening_strain(work.trial[j], mean, w)
        by_strain = _by_mean_strain(rubber, per, work.hysteretic[j], new[j].z, s, w)
        by_mean = plus(by_mean, by_strain)
    return by_mean


@compiled_once
def _common_force(
    rubber: Rubber,
    multiplicity: Floats,
    work: LayerWork,
    new: Rows[Layer],
    x: Vector,
    mean: Vector,
    w: float,
) -> tuple[Vector, Matrix, float]:
    """Newton's common force, its tangent at fixed w, and how far the layer forces are apart."""
    # Newton's d_j + C_j (F - f_j), with C_j the inverse of the tangent, and sum m_j d_j = x give F
    # = gap/compliance.
    compliance = no_slope(x)
    gap = x
    for j in range(len(work.trial)):
        flexibility = inverse(work.tangent[j], 1.0)
        work.flexibility[j] = flexibility
        compliance = plus(compliance, scaled(flexibility, multiplicity[j]))
        ahead = minus(times(flexibility, work.force[j]), work.trial[j])
        gap = plus(gap, scaled(ahead, multiplicity[j]))
    tangent = inverse(compliance, 1.0)
    force = times(tangent, gap)
    mismatch = 0.0
    for j in range(len(work.trial)):
        difference = minus(force, work.force[j])
        mismatch = max(mismatch, norm(difference))
        work.direction[j] = times(work.flexibility[j], difference)
    if any_lane(w > 0.0):
        # The forces depend on x also by the mean strain x/N.
        by_x = scaled(_by_mean(rubber, multiplicity, work, new, mean, w), rubber.layer_share)
        tangent = product(tangent, plus(isotropic(x, 1.0), by_x))
    return force, tangent, mismatch


@compiled_apart
def _force_by_weight(
    rubber: Rubber,
    multiplicity: Floats,
    work: LayerWork,
    new: Rows[Layer],
    mean: Vector,
    w: float,
) -> Vector:
    """Derivative of the common force by w [kN]."""
    compliance, by_w = no_slope(mean), zero(mean)
    for j in range(len(work.trial)):
        flexibility = inverse(work.tangent[j], multiplicity[j])
        compliance = plus(compliance, flexibility)
        s = hardening_strain(work.trial[j], mean, w)
        by_s = outer(new[j].z, scaled(scaled(s, 2.0 * rubber.hardening), work.hysteretic[j]))
        # s = (1 - w) d + w x/N, so that ds/dw = x/N - d.
        by_weight = times(product(flexibility, by_s), minus(mean, work.trial[j]))
        by_w = plus(by_w, by_weight)
    return solve(compliance, by_w)


@compiled
def _crosses_jump(rubber: Rubber, old: State, work: LayerWork) -> bool:
    """Return whether the Newton correction takes a layer across a jump of dZ/dd.

    It does where the increment turns round, and where an inner branch ends.
    """
    crosses = False
    for j in range(len(work.trial)):
        moved, by = minus(work.trial[j], old.layers[j].d), work.direction[j]
        jumps = norm(moved) + dot(direction(moved), by) < 0.0
        if rubber.closed_loops:
            jumps = jumps | leaves_branch(rubber, old, j, work.trial[j], by)
        crosses = crosses | (jumps & (norm(by) > NO_MOTION * rubber.yield_displacement))
    return crosses


@compiled
def correct(work: LayerWork, new: Rows[Layer]) -> None:
    """The last correction: the next iterate differs by its square, so the law is not evaluated."""
    for j in range(len(new)):
        work.trial[j] = plus(work.trial[j], work.direction[j])
        new[j].z = plus(new[j].z, times(work.slope[j], work.direction[j]))


@compiled
def newton(
    rubber: Rubber,
    multiplicity: Floats,
    old: State,
    work: LayerWork,
    x: Vector,
    mean: Vector,
    w: float,
    new: Rows[Layer],
    smallest: float,
) -> tuple[Vector, Matrix, float, int]:
    """Equal layer forces at fixed w, from the trial that `work` and `smallest` describe.

    Returns the bearing force [kN], its tangent at fixed w [kN/mm], the smallest layer
    tangent [kN/mm], and COMPLETED, NOT_CONVERGED or NOT_FINITE.
    """
    stiffness = rubber.elastic_stiffness + rubber.hysteretic_stiffness
    # The tolerance is relative to the force, and near zero force to that at d_y.
    floor = stiffness * rubber.yield_displacement
    force, tangent, converged = zero(x), no_slope(x), False
    for iteration in range(ALL_NEWTON):
        force, tangent, mismatch = _common_force(rubber, multiplicity, work, new, x, mean, w)
        not_finite = no(math.isfinite(total(force) + mismatch))
        converged = mismatch <= LAST_CORRECTION * (norm(force) + floor)
        if any_lane(converged):
            # The last correction is only good where dZ/dd does not jump on its way.
            converged = converged & no(_crosses_jump(rubber, old, work))
        if all_lanes(converged | not_finite):
            correct(work, new)
            return force, tangent, smallest, select(not_finite, NOT_FINITE, COMPLETED)
        a = 1.0
        if iteration >= PLAIN_NEWTON:
            a = search(rubber, multiplicity, old, work, mean, w)
        for j in range(len(new)):
            # In lockstep, runs that have converged stay where they are.
            ahead = plus(work.trial[j], scaled(work.direction[j], a))
            work.trial[j] = pick(converged, work.trial[j], ahead)
        smallest = evaluate(rubber, old, work, mean, w, new)
    correct(work, new)
    return force, tangent, smallest, select(converged, COMPLETED, NOT_CONVERGED)


@compiled
def _start_tangents(
    rubber: Rubber, old: State, work: LayerWork, mean: Vector, step: Vector
) -> bool:
    """Forces and tangents of all layers at the start, in the direction of motion.

    Returns whether they may be trusted: no tangent is below the margin and the step is short.
    """
    healthy = norm(step) < rubber.yield_displacement
    for j in range(len(work.trial)):
        d, z = old.layers[j].d, old.layers[j].z
        slope = start_slope(rubber, old, j, step)
        force, tangent = force_and_tangent(
            rubber, work.elastic[j], work.hysteretic[j], d, z, slope, mean, 0.0
        )
        work.trial[j] = d
        work.force[j] = force
        work.tangent[j] = tangent
        healthy = healthy & (lowest(tangent) >= rubber.sharing_start * work.elastic[j])
    return healthy


@compiled
def _first_trial(
    rubber: Rubber,
    multiplicity: Floats,
    old: State,
    work: LayerWork,
    x: Vector,
    mean: Vector,
    step: Vector,
    w: float,
    new: Rows[Layer],
) -> None:
    """Layer displacements to begin with: one Newton step from the tangents at the start.

    It needs no closed-form solution. The same increment in every layer where tangents cannot be
    trusted, or are not those of the plain law (w > 0).
    """
    uniform = w > 0.0
    if not all_lanes(uniform):
        healthy = _start_tangents(rubber, old, work, mean, step)
        uniform = uniform | no(healthy)
        if not all_lanes(uniform):
            _common_force(rubber, multiplicity, work, new, x, mean, 0.0)
            for j in range(len(new)):
                ahead = plus(work.trial[j], work.direction[j])
                work.trial[j] = pick(uniform, plus(old.layers[j].d, step), ahead)
            return
    for j in range(len(new)):
        work.trial[j] = plus(old.layers[j].d, step)


@compiled
def solve_sharing(
    rubber: Rubber,
    multiplicity: Floats,
    old: State,
    work: LayerWork,
    x: Vector,
    mean: Vector,
    step: Vector,
    w: float,
    new: Rows[Layer],
) -> tuple[Vector, Matrix, float, int]:
    """Equal layer forces at fixed w from the start of a step; returns what `newton` does."""
    _first_trial(rubber, multiplicity, old, work, x, mean, step, w, new)
    smallest = evaluate(rubber, old, work, mean, w, new)
    return newton(rubber, multiplicity, old, work, x, mean, w, new, smallest)


@compiled
def largest_mismatch(rubber: Rubber, work: LayerWork, new: Rows[Layer], force: Vector) -> float:
    """Largest difference between the bearing force and a layer's unmodified law [kN]."""
    largest = 0.0
    for j in range(len(work.trial)):
        law, _ = force_and_tangent(
            rubber,
            work.elastic[j],
            work.hysteretic[j],
            new[j].d,
            new[j].z,
            no_slope(force),
            zero(force),
            0.0,
        )
        largest = max(largest, norm(minus(law, force)))
    return largest


@compiled
def share(
    rubber: Rubber,
    multiplicity: Floats,
    old: State,
    work: LayerWork,
    x_old: Vector,
    x: Vector,
    new: Rows[Layer],
) -> tuple[Vector, Matrix, float, int]:
    """Layer displacements and Z at the bearing displacement x [mm], into `new`.

    Returns the bearing force [kN], the tangent [kN/mm], w and the outcome.
    """
    mean, step = scaled(x, rubber.layer_share), scaled(minus(x, x_old), rubber.layer_share)
    w, rate = weight(rubber, old, work, step)
    force, tangent, outcome = zero(x), no_slope(x), NOT_CONVERGED
    # At most twice: with w by the tangents of equal increments, and with w = 1.
    for _ in range(2):
        force, tangent, smallest, outcome = solve_sharing(
            rubber, multiplicity, old, work, x, mean, step, w, new
        )
        good = (w == 1.0) | ((outcome == COMPLETED) & (smallest > 0.0))
        if all_lanes(good):
            break
        # Layers so unlike that equal increments say nothing: always unique.
        w, rate = select(good, w, 1.0), pick(good, rate, zero(x))
    if any_lane(norm(rate) != 0.0):
        # w depends on x too: dF/dx has the part dF/dw dw/dx.
        by_w = _force_by_weight(rubber, multiplicity, work, new, mean, w)
        tangent = plus(tangent, scaled(outer(by_w, rate), rubber.layer_share))
    if all_lanes(outcome != COMPLETED):
        return force, tangent, w, outcome
    diverged = False
    for j in range(len(new)):
        new[j].d = work.trial[j]
        # Exact integration keeps |Z| within d_y; explicit Euler may run away where its steps are
        # long.
        diverged = diverged | (norm(new[j].z) > EULER_LIMIT * rubber.yield_displacement)
    outcome = select((outcome == COMPLETED) & diverged, EULER_UNSTABLE, outcome)
    outcome = select((outcome == COMPLETED) & (w > 0.0), SOFTENED, outcome)
    return force, tangent, w, outcome
