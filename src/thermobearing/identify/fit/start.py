"""Start values, and the parameters to which the tests are sensitive.

Where a layer has moved far since the last turn, Z is at d_y (Eq. 4.35) and the force of the
bearing is  sigma Q (1 + b (x/H)^2) + K x, sigma the sign of motion and H the total rubber
thickness: linear in Q, Q b and K, so one small regression gives them for each record, and
their change with the ambient temperature gives m_T and n_T (Eq. 4.34). Yield displacement
and shape, which act near the turns only, are picked from a short list by running the model.

The derivatives of the forces at the starting values give the information of the tests (Fisher),
with a residual as fits of real tests leave it. What is assumed beside has the spread of its source
as a prior. From all parameters of the bearing those are dropped, worst first, that the tests would
know less well than their source does; each dropped one joins what is assumed. The numbers of
Tables 4.2 and 5.2 and the yield stress of lead, which differ from bearing to bearing by more than
the spread of one compound, are dropped only where the tests tell nothing of them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermobearing.bearing.model import Bearing
from thermobearing.border.units import NEWTON_PER_KILONEWTON
from thermobearing.identify.fit.forward import TURN, ForwardModel, turning_points
from thermobearing.identify.fit.parameters import (
    ALPHA,
    C_V,
    D_Y,
    ENDS,
    HARDENING,
    K_L,
    K_R,
    K_V,
    M_T,
    N_T,
    SHAPE,
    SIGMA_Y,
    ParameterSet,
    available,
    default_free,
    with_values,
)
from thermobearing.identify.fit.problem import AT_BOUND, Problem, half_cycles, linearised
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.uncertainty.assumed import (
    CLEAR,
    OF_YIELDING,
    Group,
    dotted_value,
    linearise_assumed,
)

Floats = NDArray[np.float64]
SATURATED = 0.55  # part of a leg after which Z counts as saturated
YIELD_STRAINS = (0.05, 0.1, 0.18, 0.3, 0.5, 0.8)  # d_y / t_r to try
SHAPES = (-0.9, -0.75, -0.4, 0.3)  # s to try
LEAD_YIELD = (0.01, 0.03, 0.1)  # yield displacement of lead / H to try
RELAXATION = 0.1  # c_v / K_v to begin with [s]
VISCOUS_SHARE = 0.3  # K_v / elastic stiffness of the bearing to begin with
LEAD_SHARE = 0.5  # of the strength, where that of the lead is free
SMALLEST = 1e-3  # of the force or stiffness: what must be positive stays so


def backbone(record: TestRecord, rubber: float) -> tuple[float, float, float]:
    """Strength Q [kN], hardening b and stiffness K [kN/mm] of a record's loops.

    Parameters
    ----------
    record : a test with reversals.
    rubber : total rubber thickness H [mm], > 0.

    Returns
    -------
    Q [kN], b and K [kN/mm], each > 0 but b, which is in [0, 1.9].

    Examples
    --------
    >>> from thermobearing.identify.records.record import record_from_arrays
    >>> t = np.linspace(0.0, 4.0, 4001)
    >>> x = 30.0 * np.sin(2.0 * np.pi * t)
    >>> force = 2.0 * x + 10.0 * np.sign(np.cos(2.0 * np.pi * t)) * (1.0 + 0.2 * (x / 30.0) ** 2)
    >>> q, b, k = backbone(record_from_arrays(t, x, force, 23.0), 30.0)
    >>> round(q, 2), round(b, 2), round(k, 2)
    (10.0, 0.19, 2.0)
    """
    x, force = record.displacement, record.force
    turns = turning_points(x, TURN * record.peak_displacement)
    rows, values = [], []
    for a, b in pairwise(turns.tolist()):
        way = x[b] - x[a]
        if abs(way) < 0.2 * record.peak_displacement:
            continue
        late = np.arange(a, b + 1)[np.abs(x[a : b + 1] - x[a]) > SATURATED * abs(way)]
        sign = np.full(len(late), np.sign(way))
        rows.append(np.column_stack([sign, sign * (x[late] / rubber) ** 2, x[late]]))
        values.append(force[late])
    solution = np.linalg.lstsq(np.concatenate(rows), np.concatenate(values), rcond=None)[0]
    least = SMALLEST * record.peak_force
    strength = max(float(solution[0]), least)
    stiffness = max(float(solution[2]), least / record.peak_displacement)
    return strength, float(np.clip(solution[1] / strength, 0.0, 1.9)), stiffness


def _with_temperature(
    values: list[float], ambients: Floats, reference: float, coefficient: float, free: bool
) -> tuple[float, float]:
    """Value at the reference temperature and coefficient, from values at the ambients."""
    warmer = (ambients - reference) / 100.0
    logs = np.log(values)
    if free and np.ptp(ambients) > 5.0:
        coefficient, _ = np.polyfit(warmer, logs, 1)
    return float(np.exp(np.mean(logs - coefficient * warmer))), float(coefficient)


def loop_start(
    records: list[TestRecord], pset: ParameterSet, models: list[ForwardModel]
) -> dict[str, float]:
    """Starting values of the free parameters by dotted key; fixed ones stay as they are.

    Parameters
    ----------
    records : tests with reversals.
    pset : what is free.
    models : coarse, one for each record.

    Returns
    -------
    dict : values by dotted key, in the units of the parameters.

    Examples
    --------
    >>> import thermobearing as tb
    >>> from thermobearing.identify.fit.parameters import parameter_set
    >>> bearing = tb.load_bearing("shen-hdr-specimen")
    >>> test = tb.cyclic_test(strain=[0.5, 1.5], cycles=1, rest=None)
    >>> record = tb.synthetic_record(bearing, 23.0, test, noise=0.0)
    >>> pset = parameter_set(bearing, ["K_r"], [23.0])
    >>> start = loop_start([record], pset, [ForwardModel(record, bearing)])
    >>> 10.0 < start[K_R] < 90.0
    True
    """
    base, fixed = pset.base, {p.kind.key for p in pset.parameters if not p.free}
    h, geometry = base.hysteresis, base.geometry
    layers = geometry.rubber_layers
    ambients = np.array([record.ambient for record in records])
    loops = [backbone(record, base.total_rubber_thickness) for record in records]
    strengths = [q for q, _, _ in loops]
    lead = _lead_strength(base, min(strengths), free=SIGMA_Y not in fixed)
    rubber = [max(q - lead, 0.05 * q) for q in strengths]
    reference = h.reference_temperature
    q, n_t = _with_temperature(
        rubber, ambients, reference, h.hysteretic_temperature_coefficient, N_T not in fixed
    )
    layer = [layers * k for _, _, k in loops]
    elastic, m_t = _with_temperature(
        layer, ambients, reference, h.elastic_temperature_coefficient, M_T not in fixed
    )
    hardening = float(np.mean([b for _, b, _ in loops])) * max(strengths) / max(rubber)
    common = {HARDENING: min(hardening, 1.9), M_T: m_t, N_T: n_t}
    if base.rate is not None:
        common[K_V] = VISCOUS_SHARE * elastic / layers
        common[C_V] = common[K_V] * RELAXATION
    trials = []
    for strain, shape, lead_yield in product(*_lists(base, fixed)):
        trial = dict(common)
        if h.post_yield_ratio == 1.0:
            trial[K_R] = elastic
        else:
            d_y = strain * geometry.rubber_thickness if D_Y not in fixed else h.yield_displacement
            trial |= {D_Y: d_y, SHAPE: shape, K_R: elastic + q / d_y}
            trial[ALPHA] = elastic / trial[K_R]
        if base.lead is not None:
            area = base.lead.core_area / NEWTON_PER_KILONEWTON
            trial[SIGMA_Y] = lead / (base.lead.cores * area) if lead else base.lead.yield_stress
            trial[K_L] = trial[SIGMA_Y] * area / (lead_yield * base.total_rubber_thickness)
        trials.append({key: value for key, value in trial.items() if key not in fixed})
    costs = [_cost(base, trial, records, models) for trial in trials]
    return trials[int(np.argmin(costs))]


def _lists(base: Bearing, fixed: set[str]) -> tuple[tuple[float, ...], ...]:
    """Yield strains, shapes and yield displacements of lead to try."""
    linear = base.hysteresis.post_yield_ratio == 1.0
    strains = YIELD_STRAINS if not linear and D_Y not in fixed else (0.0,)
    shapes = SHAPES if not linear and SHAPE not in fixed else (0.0,)
    lead = LEAD_YIELD if base.lead is not None and K_L not in fixed else LEAD_YIELD[1:2]
    return strains, shapes, lead


def _lead_strength(base: Bearing, strength: float, *, free: bool) -> float:
    """Share of the lead in a bearing's strength [kN]."""
    if base.lead is None:
        return 0.0
    if not free:
        return base.lead.cores * base.lead.core_strength
    return strength if base.hysteresis.post_yield_ratio == 1.0 else LEAD_SHARE * strength


def _cost(
    base: Bearing, values: dict[str, float], records: list[TestRecord], models: list[ForwardModel]
) -> float:
    total = 0.0
    bearing = with_values(base, values)
    for record, model in zip(records, models, strict=True):
        predicted = model.run(bearing)
        if predicted is None:
            return float("inf")
        total += float(np.mean(((predicted.force - record.force) / record.peak_force) ** 2))
    return total


MISFIT = (
    0.03  # residual to come, of the peak force: fits of the real tests at hand leave 2.6 to 3.8 %
)
WORTH = 4.0  # independent samples of a half cycle: residuals of a law are alike along a leg
WIDE = 10.0  # standard uncertainties of the source: what a free parameter may be off
BETTER = 1.0  # of that of its source: what tests know better than this errs less when it is free
NOTHING = 0.9  # of WIDE: tests that leave so much have told nothing


@dataclass(frozen=True)
class Sensitivity:
    """What tests would tell of one parameter.

    Attributes
    ----------
    key : dotted key.
    spread : standard uncertainty of its source, in its unit; 0 where none is stated.
    stderr : what the tests would leave, in the unit of the parameter.
    free : whether it is free by default.
    usual : whether it is one of those that are free unless the tests tell nothing of them.
    """

    key: str
    spread: float
    stderr: float
    free: bool
    usual: bool

    @property
    def added(self) -> bool:
        """Whether it is free because of these tests."""
        return self.free and not self.usual

    @property
    def dropped(self) -> bool:
        """Whether it would be free if these tests told anything of it."""
        return self.usual and not self.free

    def summary(self) -> dict[str, Any]:
        """What summary.json says of it."""
        known = self.spread > 0.0
        return {
            "free": self.free,
            "stderr_of_source": self.spread if known else None,
            "stderr_expected": self.stderr if known else None,
        }


def candidates(problem: Problem, groups: Sequence[Group]) -> list[str]:
    """Parameters that the default free set is chosen from.

    Parameters
    ----------
    problem : residuals of the tests.
    groups : from `chosen_groups`.

    Returns
    -------
    list of str : dotted keys: the usual ones, and all others whose source has an uncertainty.
    """
    bearing = problem.pset.base
    usual = default_free(bearing, [record.ambient for record in problem.records])
    linear = bearing.hysteresis.post_yield_ratio == 1.0
    known = {key for group in groups for key in group.keys}
    more = [
        kind.key
        for kind in available(bearing)
        if kind.key in known and not (linear and kind.key in OF_YIELDING)
    ]
    return list(dict.fromkeys([*usual, *more]))


def sensitivities(problem: Problem, cube: Floats, groups: Sequence[Group]) -> list[Sensitivity]:
    """How well tests would know each parameter, and which of them are therefore free.

    Parameters
    ----------
    problem : residuals of the tests, with the candidates free.
    cube : the starting values, in [0, 1] for each candidate.
    groups : from `chosen_groups`.

    Returns
    -------
    list of Sensitivity : one for each candidate.
    """
    free = [p.kind.key for p in problem.pset.free]
    usual = default_free(problem.pset.base, [record.ambient for record in problem.records])
    limits = np.array([NOTHING * WIDE if key in usual else BETTER for key in free])
    spreads = np.array([_spread(problem, key, groups) for key in free])
    stated = spreads > 0.0
    slopes = np.array([p.slope(float(u)) for p, u in zip(problem.pset.free, cube, strict=True)])
    jacobian = problem.jacobian(cube) * (np.where(stated, spreads, 1.0) / slopes)
    beside = linearise_assumed(problem, cube, groups, fine=False).columns
    columns = np.column_stack([jacobian, beside])
    information = columns.T @ (columns * _worth(problem)[:, None]) / MISFIT**2
    prior = np.array([WIDE**-2] * len(free) + [1.0] * beside.shape[1])
    ratios, kept = np.zeros(len(free)), np.ones(len(free), dtype=bool)
    movable = stated & (np.array(free) != K_R)
    while True:
        left = np.sqrt(np.diag(np.linalg.inv(information + np.diag(prior))))[: len(free)]
        ratios = np.where(kept, left, ratios)
        over = np.where(kept & movable, ratios / limits, 0.0)
        worst = int(np.argmax(over))
        if over[worst] <= 1.0:
            break
        kept[worst], prior[worst] = False, 1.0
    return [
        Sensitivity(key, float(spread), float(spread * ratio), bool(keep), key in usual)
        for key, spread, ratio, keep in zip(free, spreads, ratios, kept, strict=True)
    ]


def _spread(problem: Problem, key: str, groups: Sequence[Group]) -> float:
    """Standard uncertainty of a parameter's source, in its unit; 0 where none is stated."""
    for group in groups:
        if key in group.keys:
            return group.step(dotted_value(problem.pset.base, key) or 0.0)
    return 0.0


def _worth(problem: Problem) -> Floats:
    """How many independent samples each residual is."""
    found = []
    for record, weight in zip(problem.records, problem.weights, strict=True):
        legs = half_cycles(record)
        counted = weight > 0.0
        count = np.bincount(legs, weights=counted)[legs]
        share = np.minimum(1.0, WORTH / np.maximum(count, 1.0))
        extra = len(record.temperatures) if problem.temperatures else 0
        found.append(np.tile(share, 1 + extra))
    return np.concatenate(found)


def without_needless(
    problem: Problem, cube: Floats, added: Sequence[str]
) -> tuple[Problem, Floats]:
    """A fit without those added parameters that came out as nothing, as the file has them.

    E2 of lead without softening is one: free it would stop at its end of 0 in half of all fits.

    Parameters
    ----------
    problem : residuals of the tests.
    cube : the optimum, in [0, 1] for each free parameter.
    added : dotted keys that are free because of these tests.

    Returns
    -------
    Problem, ndarray : the same ones where all are needed.
    """
    ends = {key: end for key, end in ENDS if key in added}
    if not ends:
        return problem, cube
    linear = linearised(problem, cube, fine=False)
    stderr = np.full(len(cube), np.inf)
    stderr[linear.inside] = np.sqrt(np.diag(linear.covariance()))
    needless = []
    for p, u, error in zip(problem.pset.free, cube.tolist(), stderr.tolist(), strict=True):
        if p.kind.key in ends:
            file = dotted_value(problem.pset.base, p.kind.key) or 0.0
            reach = CLEAR * error if np.isfinite(error) else AT_BOUND
            if abs(u - p.place(ends[p.kind.key])) < reach and abs(u - p.place(file)) < reach:
                needless.append(p.kind.key)
    if not needless:
        return problem, cube
    pset = problem.pset.without(needless)
    places = dict(zip((p.kind.key for p in problem.pset.free), cube.tolist(), strict=True))
    return problem.with_parameters(pset), np.array([places[p.kind.key] for p in pset.free])
