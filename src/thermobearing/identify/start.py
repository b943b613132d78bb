"""A starting set made from the loops themselves, so that a fit needs none.

Where a layer has moved far since the last turn, Z is at d_y (Eq. 4.35) and the force of the
bearing is  sigma Q (1 + b (x/H)^2) + K x, sigma the sign of motion and H the total rubber
thickness: linear in Q, Q b and K, so one small regression gives them for each record, and
their change with the ambient temperature gives m_T and n_T (Eq. 4.34). Yield displacement
and shape, which act near the turns only, are picked from a short list by running the model.
"""

from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

from thermobearing.bearing.model import Bearing
from thermobearing.border.units import NEWTON_PER_KILONEWTON
from thermobearing.identify.forward import TURN, ForwardModel, turning_points
from thermobearing.identify.kinds import (
    ALPHA,
    C_V,
    D_Y,
    HARDENING,
    K_L,
    K_R,
    K_V,
    M_T,
    N_T,
    SHAPE,
    SIGMA_Y,
)
from thermobearing.identify.parameters import ParameterSet, with_values
from thermobearing.identify.record import TestRecord

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
    >>> from thermobearing.identify.record import record_from_arrays
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
    >>> from thermobearing.identify.parameters import parameter_set
    >>> bearing = tb.load_bearing("shen-hdr-specimen")
    >>> test = tb.cyclic_test(strain=[0.5, 1.5], cycles=1, rest=None)
    >>> record = tb.identify.synthetic_record(bearing, 23.0, test, noise=0.0)
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
