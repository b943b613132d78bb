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
    found = []
    for period in (PERIOD, SLOW):
        for name, temperature, strain in COLD:
            found += _case(name, temperature, strain, period)
    for name, temperature, strain in COLD:
        bearing = load_bearing(name)
        errors = halving_errors(
            bearing, temperature, strain, STEPS, period=SLOW, hardening="monotone"
        )
        given = f"{bearing.kind}, {temperature:g} degC, {100.0 * strain:g} %, {SLOW:g} s"
        found.append(_halving(f"monotone, {given}", errors))
    return found


def _halving(given: str, errors: Floats) -> Row:
    note = "rms of the force from 10, 5, 2.5 to 1.25 ms: " + ", ".join(f"{e:.1e}" for e in errors)
    ratio = float((errors[1:] / errors[:-1]).max())
    return at_most(f"left by halving the step, {given}", ratio, FIRST_ORDER, note=note)


def _case(name: str, temperature: float, strain: float, period: float) -> list[Row]:
    bearing, found = load_bearing(name), []
    given = f"{bearing.kind}, {temperature:g} degC, {100.0 * strain:g} %, {period:g} s"
    for dt in (5e-3, 20e-3):
        seen = continuity(bearing, temperature, strain, dt=dt, period=period)
        worst = 100.0 * seen.jumps.max() if len(seen.jumps) else 0.0
        note = f"in {seen.softened} softened of {seen.steps} steps, largest {worst:.2g} % of peak"
        what = f"{given}, dt {1e3 * dt:g} ms"
        found.append(at_most(f"jumps of F(x), {what}", len(seen.jumps), 0, note=note))
        error = seen.tangent_quantile
        found.append(
            at_most(f"tangent error, 90 % of those steps, {what}", error, SOFTENED_TANGENT)
        )
    books = full_cycles(bearing, temperature, strain, 5e-3, period=period).books
    apart = float(books["layer_force_mismatch"].max())
    note = f"of {abs(books['force']).max():.0f} kN"
    found.append(plain(f"layer law from the force at most, {given}", apart, "kN", note))
    moved = 100.0 * moved_by_a_parameter(bearing, temperature, strain, period=period)
    what = f"a sample moves when a parameter changes by 0.0025 %, {given}"
    found.append(at_most(what, moved, MOVED * 2.5e-3, "%"))
    errors = halving_errors(bearing, temperature, strain, STEPS, period=period)
    return [*found, _halving(given, errors)]
