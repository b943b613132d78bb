"""How much the step size matters: G_e and h_eq of every cycle of Table 3.4."""

from itertools import pairwise

import pandas as pd

import thermobearing as tb
from benchmarks.rows import Row, at_most, plain
from benchmarks.specimen import AMBIENTS, NAME

LIMIT = 0.1  # [%], from 10 ms on
STEPS = (10.0, 5.0, 2.5, 1.25)  # [ms]; the exact integrator at the last is the reference
MEASURES = {"G_e": "G_eq_MPa", "h_eq": "h_eq"}


def cycles(dt: float, integrator: str) -> pd.DataFrame:
    """The table of cycles at the three temperatures, with a step of dt [ms]."""
    test = tb.cyclic_test(dt=1e-3 * dt)
    return tb.run(
        NAME, test, ambient=AMBIENTS, model=tb.ModelOptions(integrator=integrator), keep=()
    ).cycles


def change(table: pd.DataFrame, reference: pd.DataFrame, measure: str) -> tuple[float, str]:
    """Largest relative difference [%], and where it is."""
    difference = 100.0 * (table[measure] / reference[measure] - 1.0).abs()
    worst = table.iloc[int(difference.to_numpy().argmax())]
    where = (
        f"largest at {worst['ambient_degC']:g} degC, {100 * worst['amplitude_strain']:.0f} %, "
        f"cycle {worst['cycle']:.0f}"
    )
    return float(difference.max()), where


def rows() -> list[Row]:
    """Halving the step with the exact integrator; then both against the finest."""
    exact = {dt: cycles(dt, "exact") for dt in STEPS}
    measured = []
    for coarse, fine in pairwise(STEPS[:3]):
        for name, measure in MEASURES.items():
            value, where = change(exact[coarse], exact[fine], measure)
            label = f"{name} of any cycle, exact, dt {coarse:g} -> {fine:g} ms"
            measured.append(at_most(label, value, LIMIT, "%", where))
    for dt in STEPS[:3]:
        euler = cycles(dt, "euler")
        for name, measure in MEASURES.items():
            good, _ = change(exact[dt], exact[STEPS[-1]], measure)
            poor, where = change(euler, exact[STEPS[-1]], measure)
            label = f"{name}, Euler, dt {dt:g} ms, against exact at {STEPS[-1]:g} ms"
            measured.append(plain(label, poor, "%", f"exact {good:.1e} %; {where}"))
    return measured
