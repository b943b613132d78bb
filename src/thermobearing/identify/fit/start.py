"""Start values, and the parameters to which the tests are sensitive.

Where a layer has moved far since the last turn, Z is at d_y (Eq. 4.35) and the force of the
bearing is  sigma Q (1 + b (x/H)^2) + K x, sigma the sign of motion and H the total rubber
thickness: linear in Q, Q b and K, so one small regression gives them for each record, and
their change with the ambient temperature gives m_T and n_T (Eq. 4.34). Yield displacement
and shape, which act near the turns only, are picked from a short list by running the model.

The derivatives of the forces at the starting values give the information of the tests (Fisher),
with a residual as fits of real tests leave it. Assumed values have the uncertainty of their source
as a prior. From all parameters of the bearing those are dropped, worst first, that the tests would
determine less well than their source does; each dropped one becomes an assumed value. The numbers
of Tables 4.2 and 5.2 and the yield stress of lead, which differ from bearing to bearing by more
than the spread of one compound, are dropped only where the tests contain no information on them.
"""

from collections.abc import Sequence
from itertools import pairwise, product
from typing import NamedTuple

import numpy as np

from thermobearing.bearing.model import Bearing
from thermobearing.border.units import NEWTON_PER_KILONEWTON
from thermobearing.core.records import Floats
from thermobearing.identify.fit import parameters as kinds
from thermobearing.identify.fit.forward import ForwardModel
from thermobearing.identify.fit.problem import AT_BOUND, Problem, half_cycles, linearise
from thermobearing.identify.records.cycles import TURN, turning_points
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.uncertainty.covariance import CLEAR, OPEN, linearise_assumed
from thermobearing.identify.uncertainty.groups import Group
from thermobearing.quantities.governing import place_of_largest, place_of_least

SATURATED = 0.55  # part of a leg after which Z counts as saturated
YIELD_STRAINS = (0.05, 0.1, 0.18, 0.3, 0.5, 0.8)  # d_y / t_r to try
SHAPES = (-0.9, -0.75, -0.4, 0.3)  # s to try
LEAD_YIELD = (0.01, 0.03, 0.1)  # yield displacement of lead / H to try
RELAXATION = 0.1  # c_v / K_v to begin with [s]
VISCOUS_SHARE = 0.3  # K_v / elastic stiffness of the bearing to begin with
LEAD_SHARE = 0.5  # of the strength, where that of the lead is free
SMALLEST = 1e-3  # of the force or stiffness: what must be positive stays so
MISFIT = 0.03  # residual to come, of the peak force: fits of real tests leave 2.6 to 3.8 %
WORTH = 4.0  # independent samples of a half cycle: residuals of a law are alike along a leg
WIDE = 10.0  # standard uncertainties of the source: prior of a free parameter
BETTER = 1.0  # of that of its source: what tests know better than this errs less when it is free
NOTHING = 0.9  # of WIDE: tests that leave so much say nothing


def _backbone(record: TestRecord, rubber: float) -> tuple[float, float, float]:
    """Return strength Q [kN], hardening b and stiffness K [kN/mm] of the loops of a record."""
    x, force = record.displacement, record.force
    turns = turning_points(x, TURN * record.peak_displacement)
    rows, values = [], []
    for a, b in pairwise(turns.tolist()):
        span = x[b] - x[a]
        # A short leg ends before Z has reached d_y.
        if abs(span) < 0.2 * record.peak_displacement:
            continue
        late = np.arange(a, b + 1)[np.abs(x[a : b + 1] - x[a]) > SATURATED * abs(span)]
        sign = np.full(len(late), np.sign(span))
        rows.append(np.column_stack([sign, sign * (x[late] / rubber) ** 2, x[late]]))
        values.append(force[late])
    solution = np.linalg.lstsq(np.concatenate(rows), np.concatenate(values), rcond=None)[0]
    smallest = SMALLEST * record.peak_force
    strength = max(float(solution[0]), smallest)
    stiffness = max(float(solution[2]), smallest / record.peak_displacement)
    return strength, float(np.clip(solution[1] / strength, 0.0, 1.9)), stiffness


def _with_temperature(
    values: list[float], ambients: Floats, reference: float, coefficient: float, free: bool
) -> tuple[float, float]:
    """Return the value at the reference temperature and its coefficient."""
    warmer = (ambients - reference) / 100.0
    logs = np.log(values)
    # A slope over a few kelvin would be noise divided by a small number.
    if free and np.ptp(ambients) > 5.0:
        coefficient, _ = np.polyfit(warmer, logs, 1)
    return float(np.exp(np.mean(logs - coefficient * warmer))), float(coefficient)


def loop_start(
    records: list[TestRecord], pset: kinds.ParameterSet, models: list[ForwardModel]
) -> dict[str, float]:
    """Return starting values of the free parameters by dotted key, from the coarse models."""
    base, fixed = pset.base, {p.kind.key for p in pset.parameters if not p.free}
    h, geometry = base.hysteresis, base.geometry
    layers = geometry.rubber_layers
    ambients = np.array([record.ambient for record in records])
    rubber = base.total_rubber_thickness
    strengths, hardenings, stiffnesses = zip(*(_backbone(r, rubber) for r in records), strict=True)
    lead = _lead_strength(base, min(strengths), free=kinds.SIGMA_Y not in fixed)
    rubber_strengths = [max(q - lead, 0.05 * q) for q in strengths]  # of the rubber
    reference = h.reference_temperature
    q, n_t = _with_temperature(
        rubber_strengths,
        ambients,
        reference,
        h.hysteretic_temperature_coefficient,
        kinds.N_T not in fixed,
    )
    layer = [layers * k for k in stiffnesses]
    elastic, m_t = _with_temperature(
        layer, ambients, reference, h.elastic_temperature_coefficient, kinds.M_T not in fixed
    )
    # The regression gives b of the complete strength; only that of the rubber hardens.
    hardening = float(np.mean(hardenings)) * max(strengths) / max(rubber_strengths)
    common = {kinds.HARDENING: min(hardening, 1.9), kinds.M_T: m_t, kinds.N_T: n_t}
    if base.rate is not None:
        common[kinds.K_V] = VISCOUS_SHARE * elastic / layers
        common[kinds.C_V] = common[kinds.K_V] * RELAXATION
    trials = []
    for strain, shape, lead_yield in product(*_lists(base, fixed)):
        trial = dict(common)
        if h.post_yield_ratio == 1.0:
            trial[kinds.K_R] = elastic
        else:
            d_y = strain * geometry.rubber_thickness if strain else h.yield_displacement
            trial |= {kinds.D_Y: d_y, kinds.SHAPE: shape, kinds.K_R: elastic + q / d_y}
            trial[kinds.ALPHA] = elastic / trial[kinds.K_R]
        if base.lead is not None:
            area = base.lead.core_area / NEWTON_PER_KILONEWTON
            stress = lead / (base.lead.cores * area) if lead else base.lead.yield_stress
            stiffness = stress * area / (lead_yield * rubber)
            trial |= {kinds.SIGMA_Y: stress, kinds.K_L: stiffness}
        trials.append({key: value for key, value in trial.items() if key not in fixed})
    costs = [_cost(base, trial, records, models) for trial in trials]
    return trials[place_of_least(costs)]


def _lists(base: Bearing, fixed: set[str]) -> tuple[tuple[float, ...], ...]:
    """Return yield strains, shapes and yield displacements of lead to try."""
    linear = base.hysteresis.post_yield_ratio == 1.0
    strains = YIELD_STRAINS if not linear and kinds.D_Y not in fixed else (0.0,)
    shapes = SHAPES if not linear and kinds.SHAPE not in fixed else (0.0,)
    lead = LEAD_YIELD if base.lead is not None and kinds.K_L not in fixed else LEAD_YIELD[1:2]
    return strains, shapes, lead


def _lead_strength(base: Bearing, strength: float, *, free: bool) -> float:
    """Return the share of the lead in the strength of a bearing [kN]."""
    if base.lead is None:
        return 0.0
    if not free:
        return base.lead.cores * base.lead.core_strength
    return strength if base.hysteresis.post_yield_ratio == 1.0 else LEAD_SHARE * strength


def _cost(
    base: Bearing, values: dict[str, float], records: list[TestRecord], models: list[ForwardModel]
) -> float:
    total = 0.0
    bearing = kinds.with_values(base, values)
    for record, model in zip(records, models, strict=True):
        predicted = model.run(bearing)
        if predicted is None:
            return float("inf")
        total += float(np.mean(((predicted.force - record.force) / record.peak_force) ** 2))
    return total


class Sensitivity(NamedTuple):
    """How well tests would determine a parameter."""

    key: str
    spread: float  # standard uncertainty of its source, in its unit; 0 if none is stated
    stderr: float  # standard error by the tests, in its unit
    free: bool  # by default
    usual: bool  # free unless the tests say nothing about it


def _candidates(problem: Problem, groups: Sequence[Group]) -> list[str]:
    """Return the usual keys, and all others whose source has an uncertainty."""
    bearing = problem.pset.base
    default_keys = kinds.default_free(bearing, [record.ambient for record in problem.records])
    linear = bearing.hysteresis.post_yield_ratio == 1.0
    uncertain = {key for group in groups for key in group.keys}
    uncertain -= kinds.replaced_by_laws(bearing)
    further = [kind.key for kind in kinds.available(bearing) if kind.key in uncertain]
    further = [key for key in further if not (linear and key in kinds.OF_YIELDING)]
    return list(dict.fromkeys([*default_keys, *further]))


def sensitivities(
    problem: Problem,
    start: dict[str, float],
    groups: Sequence[Group],
    bounds: dict[str, tuple[float, float]] | None = None,
) -> list[Sensitivity]:
    """Return how well tests would determine each candidate, and which are therefore free.

    `start` are starting values by dotted key, `bounds` replace default bounds.
    """
    base, ambients = problem.pset.base, [record.ambient for record in problem.records]
    pset = kinds.parameter_set(base, _candidates(problem, groups), ambients, bounds)
    problem = problem.with_parameters(pset.with_start(start))
    cube, free = problem.pset.start, [p.kind.key for p in problem.pset.free]
    default_keys = kinds.default_free(base, ambients)
    limits = np.array([NOTHING * WIDE if key in default_keys else BETTER for key in free])
    sources = {key: group for group in reversed(groups) for key in group.keys}
    sources_and_values = [(sources.get(key), kinds.dotted_value(base, key) or 0.0) for key in free]
    spreads = np.array(
        [source.step(value) if source else 0.0 for source, value in sources_and_values]
    )
    stated = spreads > 0.0
    slopes = np.array([p.slope(float(u)) for p, u in zip(problem.pset.free, cube, strict=True)])
    jacobian = problem.jacobian(cube) * (np.where(stated, spreads, 1.0) / slopes)
    assumed = linearise_assumed(problem, cube, groups, fine=False).columns
    columns = np.column_stack([jacobian, assumed])
    information = columns.T @ (columns * _independent_samples(problem)[:, None]) / MISFIT**2
    prior = np.array([WIDE**-2] * len(free) + [1.0] * assumed.shape[1])
    ratios, is_free = np.zeros(len(free)), np.ones(len(free), dtype=bool)
    movable = stated & (np.array(free) != kinds.K_R)
    # Worst first, one at a time: what one dropped parameter leaves changes the errors of the rest.
    while True:
        errors = np.sqrt(np.diag(np.linalg.inv(information + np.diag(prior))))[: len(free)]
        ratios = np.where(is_free, errors, ratios)
        excess = np.where(is_free & movable, ratios / limits, 0.0)
        worst = place_of_largest(excess)
        # All that are left are better determined by the tests than by their sources.
        if excess[worst] <= 1.0:
            break
        # A dropped parameter is an assumed value: its prior is the uncertainty of its source.
        is_free[worst], prior[worst] = False, 1.0
    return [
        Sensitivity(key, float(spread), float(spread * ratio), bool(keep), key in default_keys)
        for key, spread, ratio, keep in zip(free, spreads, ratios, is_free, strict=True)
    ]


def _independent_samples(problem: Problem) -> Floats:
    """Return the number of independent samples that each residual is worth."""
    shares = []
    for record, weight in zip(problem.records, problem.weights, strict=True):
        legs = half_cycles(record)
        counted = weight > 0.0
        count = np.bincount(legs, weights=counted)[legs]
        # Residuals of one half cycle are alike: together they count as WORTH samples.
        share = np.minimum(1.0, WORTH / np.maximum(count, 1.0))
        extra = len(record.temperatures) if problem.temperatures else 0
        shares.append(np.tile(share, 1 + extra))
    return np.concatenate(shares)


def drop_needless(problem: Problem, cube: Floats, added: Sequence[str]) -> tuple[Problem, Floats]:
    """Return a problem without the added parameters that ended at zero effect, as in the file.

    E2 of lead without softening is one: free, it would end at 0 in half of all calibrations.
    """
    law_ends = {p.kind.key: p.kind.end for p in problem.pset.free if p.kind.key in added}
    ends = {key: end for key, end in law_ends.items() if end is not None}
    if not ends:
        return problem, cube
    linear = linearise(problem, cube, fine=False)
    stderr = np.sqrt(np.diag(linear.covariance()))
    needless = []
    for p, u, error in zip(problem.pset.free, cube.tolist(), stderr.tolist(), strict=True):
        if p.kind.key in ends:
            file_value = kinds.dotted_value(problem.pset.base, p.kind.key) or 0.0
            # Near the end of the law and the value of the file: the tests ask for no other.
            reach = max(CLEAR * error, AT_BOUND)
            if abs(u - p.place(ends[p.kind.key])) < reach and abs(u - p.place(file_value)) < reach:
                needless.append(p.kind.key)
    return _hold_parameters(problem, cube, needless)


def _hold_parameters(problem: Problem, cube: Floats, keys: Sequence[str]) -> tuple[Problem, Floats]:
    """Return a problem with some parameters held at the values of the bearing."""
    if not keys:
        return problem, cube
    pset = problem.pset.without(keys)
    places = dict(zip((p.kind.key for p in problem.pset.free), cube.tolist(), strict=True))
    return problem.with_parameters(pset), np.array([places[p.kind.key] for p in pset.free])


def hold_undetermined(problem: Problem, cube: Floats) -> tuple[Problem, Floats, list[str]]:
    """Return a problem without the optional parameters that its tests leave open, and their keys.

    Such a parameter has an interval of half its range or more at the optimum, as the strain of a
    scragging of zero amplitude has. One parameter at least stays free.
    """
    optional = [p.kind.optional for p in problem.pset.free]
    if not any(optional) or all(optional):
        return problem, cube, []
    errors = np.sqrt(np.diag(linearise(problem, cube).covariance())).tolist()
    keys = [
        p.kind.key
        for p, error in zip(problem.pset.free, errors, strict=True)
        if p.kind.optional and 2.0 * CLEAR * error > OPEN
    ]
    return *_hold_parameters(problem, cube, keys), keys
