"""Layers that soften: jumps of the force within a step, tangent, mismatch, time step."""

from benchmarks.rows import Row, at_most, plain
from tests.tolerances import FIRST_ORDER, MOVED, SOFTENED_TANGENT
from tests.verification.softened import (
    PERIOD,
    SLOW,
    continuity,
    full_cycles,
    halving_errors,
    moved_by_a_parameter,
)
from tests.verification.test_softening import COLD
from thermobearing.bearing.library import load_bearing
from thermobearing.core.records import Floats

STEPS = (10e-3, 5e-3, 2.5e-3, 1.25e-3)  # [s]


def rows() -> list[Row]:
    """Five cycles each, of 4 s and at the speed of Table 3.4; then the monotone form."""
    measured = []
    for period in (PERIOD, SLOW):
        for name, temperature, strain in COLD:
            measured += _case(name, temperature, strain, period)
    for name, temperature, strain in COLD:
        bearing = load_bearing(name)
        errors = halving_errors(
            bearing, temperature, strain, STEPS, period=SLOW, hardening="monotone"
        )
        conditions = f"{bearing.kind}, {temperature:g} degC, {100.0 * strain:g} %, {SLOW:g} s"
        measured.append(_halving(f"monotone, {conditions}", errors))
    return measured


def _halving(conditions: str, errors: Floats) -> Row:
    note = "rms of the force from 10, 5, 2.5 to 1.25 ms: " + ", ".join(f"{e:.1e}" for e in errors)
    ratio = float((errors[1:] / errors[:-1]).max())
    return at_most(f"left by halving the step, {conditions}", ratio, FIRST_ORDER, note=note)


def _case(name: str, temperature: float, strain: float, period: float) -> list[Row]:
    bearing, measured = load_bearing(name), []
    conditions = f"{bearing.kind}, {temperature:g} degC, {100.0 * strain:g} %, {period:g} s"
    for dt in (5e-3, 20e-3):
        seen = continuity(bearing, temperature, strain, dt=dt, period=period)
        worst = 100.0 * seen.jumps.max() if len(seen.jumps) else 0.0
        note = f"in {seen.softened} softened of {seen.steps} steps, largest {worst:.2g} % of peak"
        label = f"{conditions}, dt {1e3 * dt:g} ms"
        measured.append(at_most(f"jumps of F(x), {label}", len(seen.jumps), 0, note=note))
        error = seen.tangent_quantile
        measured.append(
            at_most(f"tangent error, 90 % of those steps, {label}", error, SOFTENED_TANGENT)
        )
    balances = full_cycles(bearing, temperature, strain, 5e-3, period=period).response
    apart = float(balances["layer_force_mismatch"].max())
    note = f"of {abs(balances['force']).max():.0f} kN"
    measured.append(plain(f"layer law from the force at most, {conditions}", apart, "kN", note))
    moved = 100.0 * moved_by_a_parameter(bearing, temperature, strain, period=period)
    label = f"a sample moves when a parameter changes by 0.0025 %, {conditions}"
    measured.append(at_most(label, moved, MOVED * 2.5e-3, "%"))
    errors = halving_errors(bearing, temperature, strain, STEPS, period=period)
    return [*measured, _halving(conditions, errors)]
