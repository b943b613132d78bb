"""A bearing under an axial force: critical load, vertical stiffness, tension, and lost shear force.

Compression is positive, and so is the shortening v; an extension is e = -v, a tension N = -P. The
compression flexibility c = sum t_r / E_c of the layers, each at its own temperature, gives

    K_v = A / (c (1 + (3/pi^2) (x/r)^2)),   P_cr = (P_S/2) (sqrt(1 + 4 P_E/P_S) - 1) a(x)

(Haringx; a is the overlap of top and bottom), and the force that tilted shims pass from the axial
force to the shear: -kappa x with kappa = 3 c P^2 / (pi^2 I a^2), which Koh & Kelly's two springs
leave if P_E is much larger than P_S. Lead and viscous branch are not multiplied by anything.

Tension of bolted bearings is that of Kumar, Whittaker & Constantinou (2014): the rubber cavitates
at F_c, a multiple of G A, and what it has lost depends on the largest extension so far, relative to
that of cavitation (`memory`, at least 1).
"""

import math

from thermobearing.core.compiled.kernel import compiled
from thermobearing.core.lanes.choose import all_lanes, select
from thermobearing.core.records import Floats, Rows
from thermobearing.core.step import stiffness_at
from thermobearing.core.types import AxialResponse, Constants


class Column:
    """A bearing as a column of layers under an axial force."""

    area: float  # of rubber in compression, A [mm2]
    inertia_x: float  # second moment of A for bending along x [mm4]
    inertia_y: float
    length: float  # of the plan along x, or its diameter [mm]
    width: float  # across [mm]
    circular: int  # 1 for a round plan, else 0
    modulus_ratio: float  # C S^2: compression modulus over shear modulus of incompressible rubber
    volumetric: float  # 4/(3 K) [mm2/kN]
    layer_thickness: float  # t_r [mm]
    layer_count: float  # N
    height: float  # of rubber, shims and sealing plates, h [mm]
    least_overlap: float  # below it the critical load no longer falls, as a share of the plan
    cavitation: float  # F_c / (G A)
    secant: float  # (1 + b) d_y/t_r: share of the hysteretic stiffness at 100 % strain
    damage: float  # phi: largest share of F_c that cavitation takes
    damage_rate: float  # a_c
    strengthening: float  # k, of the force beyond cavitation [1/mm]
    by_overlap: int  # 1 where kappa grows as the overlap falls, else 0


@compiled
def overlap_share(column: Column, x: float, y: float) -> float:
    """Overlap of top and bottom over the plan, 0 to 1."""
    if column.circular == 1:
        share = min(math.sqrt(x * x + y * y) / column.length, 1.0)
        # arccos without another function for lanes: 2 atan(sqrt((1 - s)/(1 + s))).
        angle = 4.0 * math.atan(math.sqrt((1.0 - share) / (1.0 + share)))
        return (angle - 2.0 * share * math.sqrt(1.0 - share * share)) / math.pi
    along = max(1.0 - abs(x) / column.length, 0.0)
    return along * max(1.0 - abs(y) / column.width, 0.0)


@compiled
def layer_compression(column: Column, flexibility: float) -> float:
    """1/E_c of a layer [mm2/kN] by 1/G [1/GPa]."""
    return flexibility / column.modulus_ratio + column.volumetric


@compiled
def compliance(
    column: Column, multiplicity: Floats, elastic: Floats, hysteretic: Floats
) -> tuple[float, float, float]:
    """Return what the layers give, from their two stiffness terms without scragging.

    These are c [mm3/kN], the same in shear, sum t_r/G [mm3/kN], and the smallest G [GPa].
    """
    flexibility, largest, layers = 0.0, 0.0, 0.0
    per_modulus = column.area / column.layer_thickness
    for j in range(len(multiplicity)):
        of_layer = per_modulus / (elastic[j] + column.secant * hysteretic[j])  # 1/G
        flexibility += multiplicity[j] * of_layer
        largest = max(largest, of_layer)
        layers += multiplicity[j]
    # 1/E_c is linear in 1/G, so that its mean is that of the mean. Models with one cell have one
    # layer for all.
    mean, rubber = flexibility / layers, column.layer_thickness * column.layer_count
    return layer_compression(column, mean) * rubber, mean * rubber, 1.0 / largest


@compiled
def buckling_load(column: Column, compression: float, shear_flexibility: float) -> float:
    """Critical load without displacement, about the weaker axis [kN]; arguments as `compliance`."""
    shear = column.area / shear_flexibility * column.height
    inertia = min(column.inertia_x, column.inertia_y)
    euler = math.pi * math.pi / 3.0 * inertia / (compression * column.height)
    return 0.5 * shear * (math.sqrt(1.0 + 4.0 * euler / shear) - 1.0)


@compiled
def counted_overlap(column: Column, x: float, y: float) -> float:
    """Overlap that the critical load counts, which has a least value."""
    return max(overlap_share(column, x, y), column.least_overlap)


@compiled
def vertical_stiffness(column: Column, compression: float, x: float, y: float) -> float:
    """Tangent in compression at a displacement [kN/mm]."""
    along, across = x * x / column.inertia_x, y * y / column.inertia_y
    offset = 3.0 / (math.pi * math.pi) * column.area * (along + across)
    return column.area / (compression * (1.0 + offset))


@compiled
def stiffness_reduction(
    column: Column, compression: float, axial_force: float, overlap: float
) -> tuple[float, float]:
    """Return kappa along x and y [kN/mm]; `overlap` is 1 for the form with a potential."""
    share = axial_force / (math.pi * overlap)
    square = 3.0 * compression * share * share
    return square / column.inertia_x, square / column.inertia_y


@compiled
def cavitated_strength(column: Column, strength: float, memory: float) -> float:
    """F_cn: tension at which a bearing that has cavitated leaves its vertical stiffness [kN]."""
    return strength * (1.0 - column.damage * (1.0 - math.exp(-column.damage_rate * (memory - 1.0))))


@compiled
def tension(
    column: Column, extension: float, stiffness: float, strength: float, memory: float
) -> tuple[float, float]:
    """Tension N [kN] and tangent dN/de [kN/mm] of a bolted bearing; negative in compression.

    `strength` is F_c, `stiffness` that in compression at the present displacement.
    """
    # Exponentials are for tension only, in which few steps are.
    if all_lanes(extension <= 0.0):
        return stiffness * extension, stiffness
    least = strength / stiffness
    weakened = cavitated_strength(column, strength, memory)
    first, last = weakened / stiffness, memory * least
    reach = column.layer_thickness * column.layer_count * column.strengthening

    # The virgin curve, beyond all that was seen; on it `e` is at least that of cavitation.
    e = max(extension, last)
    decay = math.exp(-column.strengthening * (e - least))
    virgin = strength * (1.0 + (1.0 - decay) / reach)
    virgin_slope = strength * decay * column.strengthening / reach
    at_last = select(extension > last, math.exp(-column.strengthening * (last - least)), decay)
    top = strength * (1.0 + (1.0 - at_last) / reach)

    # From the weakened strength back to that curve; it has no length before the first cavitation.
    length = last - first
    between = (extension > first) & (extension <= last) & (length > 0.0)
    slope = (top - weakened) / select(length > 0.0, length, 1.0)
    force = select(between, weakened + slope * (extension - first), virgin)
    tangent = select(between, slope, virgin_slope)
    elastic = extension <= first
    return select(elastic, stiffness * extension, force), select(elastic, stiffness, tangent)


@compiled
def axial_march(
    constants: Constants,
    columns: Rows[Column],
    x: Floats,
    y: Floats,
    axial_force: Floats,
    temperature: Floats,
    elastic: Floats,
    hysteretic: Floats,
    rows: Rows[AxialResponse],
) -> None:
    """Compute what prescribed axial forces do along prescribed displacements.

    Parameters
    ----------
    columns : [1] of the bearing.
    x, y : [steps + 1] displacements [mm], the start first.
    axial_force : [steps + 1] [kN].
    temperature : [steps + 1, L] of the layers at mid-thickness [degC].
    elastic, hysteretic : [L] scratch.
    rows : [steps + 1] results.
    """
    column = columns[0]
    mismatch, lent, work = 0.0, 0.0, 0.0
    for i in range(len(x)):
        for j in range(len(elastic)):
            elastic[j], hysteretic[j] = stiffness_at(
                constants.rubber, constants.law, temperature[i, j]
            )
        compression, shear, softest = compliance(
            column, constants.multiplicity, elastic, hysteretic
        )
        force, overlap = axial_force[i], counted_overlap(column, x[i], y[i])
        row = rows[i]
        row.axial_force = force
        row.critical_load = buckling_load(column, compression, shear) * overlap
        row.vertical_stiffness = vertical_stiffness(column, compression, x[i], y[i])
        row.cavitation_force = column.cavitation * softest * column.area
        row.shortening = force / row.vertical_stiffness
        row.axial_stored = 0.5 * force * row.shortening
        by = overlap if column.by_overlap == 1 else 1.0
        next_x, next_y = stiffness_reduction(column, compression, force, by)
        row.stiffness_reduction, row.stiffness_reduction_y = next_x, next_y
        if i > 0:
            # With force, place and temperatures of the start of the step, as in a structure.
            before = rows[i - 1]
            along, across = before.next_reduction, before.next_reduction_y
            half_x = 0.5 * (x[i] * x[i] - x[i - 1] * x[i - 1])
            half_y = 0.5 * (y[i] * y[i] - y[i - 1] * y[i - 1])
            lent += along * half_x + across * half_y
            mismatch += (along - before.next_potential) * half_x
            mismatch += (across - before.next_potential_y) * half_y
            work += 0.5 * (force + before.axial_force) * (row.shortening - before.shortening)
            row.stiffness_reduction, row.stiffness_reduction_y = along, across
        row.lent = lent
        row.axial_mismatch = mismatch
        row.axial_work = work
        potential_x, potential_y = stiffness_reduction(column, compression, force, 1.0)
        row.next_potential = potential_x
        row.next_potential_y = potential_y
        row.next_reduction = next_x
        row.next_reduction_y = next_y
