"""Measures of the rule for layers that soften: jumps of F(x), tangent, time step. No tests."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from tests.verification.models import Run, assembled, changed, marched, sine
from thermobearing.bearing.model import Bearing
from thermobearing.core.march import copy_state
from thermobearing.core.records import Floats
from thermobearing.core.step import step
from thermobearing.core.types import SOFTENED, Constants, State, new_state, new_workspace
from thermobearing.model.constants import Hardening

PERIOD, SLOW = 4.0, 12.0  # of the sine [s]; slow is 30 mm/s at 300 %, the speed of Table 3.4
CYCLES = 5
CUTS = 12  # trial displacements in one step
SUSPECT = 2e-4  # change of force between two of them, of the peak, that is looked into
CLOSED = 1e-6  # of the peak: an interval of trial displacements with less holds no jump
HALVINGS = 40  # of that interval: to 1e-12 of a step
H = 1e-5  # central difference of the force [mm]


class Trials:
    def __init__(self, constants: Constants, temperature: float, dt: float) -> None:
        start = np.full(len(constants.cells.capacity), temperature)
        self.constants, self.work = constants, new_workspace(constants)
        self.state, self.trial = new_state(constants, start), new_state(constants, start)
        self.air, self.dt = temperature, dt

    def step(self, x: float, new: State) -> tuple[float, float, int]:
        """Force [kN], tangent [kN/mm] and outcome at x [mm]."""
        return step(self.constants, self.work, self.state, x, self.dt, self.air, new)

    def force(self, x: float) -> float:
        """Force at x [kN], leaving everything as it is."""
        return self.step(x, self.trial)[0]

    def jump(self, low: float, high: float, peak: float) -> float:
        """Discontinuity of the force between two displacements [kN], 0 for none."""
        at_low, at_high = self.force(low), self.force(high)
        for _ in range(HALVINGS):
            if abs(at_high - at_low) < CLOSED * peak:
                return 0.0
            middle = 0.5 * (low + high)
            force = self.force(middle)
            if abs(force - at_low) > abs(at_high - force):
                high, at_high = middle, force
            else:
                low, at_low = middle, force
        return abs(at_high - at_low)


@dataclass(frozen=True)
class Continuity:
    steps: int
    softened: int
    jumps: Floats  # discontinuities of F(x) inside one step, of the peak force
    tangent_errors: Floats  # of softened steps, relative

    @property
    def tangent_quantile(self) -> float:
        """90 % of the softened steps have at most this error of the tangent."""
        return float(np.quantile(self.tangent_errors, 0.9))


def continuity(
    bearing: Bearing, temperature: float, strain: float, *, dt: float, period: float = PERIOD
) -> Continuity:
    """Is the force a continuous function of x within each step, and the tangent its slope?

    In each step trial displacements are tried, from the start of the step to half a step beyond
    its end; where the force changes much between two, halving finds out whether it jumps.
    """
    trials = Trials(assembled(bearing), temperature, dt)
    x = sine(bearing, strain=strain, period=period, cycles=CYCLES, dt=dt)
    new, softened, peak = new_state(trials.constants, trials.state.temperature), 0, 0.0
    jumps, errors = [], []
    for before, target in zip([0.0, *x], x, strict=False):
        force, tangent, outcome = trials.step(target, new)
        peak = max(peak, abs(force))
        if outcome == SOFTENED:
            softened += 1
            slope = (trials.force(target + H) - trials.force(target - H)) / (2.0 * H)
            errors.append(abs(tangent / slope - 1.0))
            cuts = np.linspace(before, 1.5 * target - 0.5 * before, CUTS + 1)
            changes = np.abs(np.diff([trials.force(at) for at in cuts]))
            for i in np.flatnonzero(changes > SUSPECT * peak):
                jumps.append(trials.jump(cuts[i], cuts[i + 1], peak))
        copy_state(new, trials.state)
    result = np.array([jump for jump in jumps if jump > 0.0])
    return Continuity(len(x), softened, result / peak, np.array(errors))


def full_cycles(
    bearing: Bearing,
    temperature: float,
    strain: float,
    dt: float,
    *,
    period: float = PERIOD,
    hardening: Hardening = "printed",
) -> Run:
    x = sine(bearing, strain=strain, period=period, cycles=CYCLES, dt=dt)
    return marched(assembled(bearing, hardening=hardening), x, dt, temperature, temperature)


def halving_errors(
    bearing: Bearing, temperature: float, strain: float, steps: tuple[float, ...], **how: Any
) -> Floats:
    """Rms difference of the forces from one time step to the next finer, of the peak force."""
    runs = [full_cycles(bearing, temperature, strain, dt, **how) for dt in steps]
    every = [round(steps[0] / dt) for dt in steps]
    forces = [
        run.response["force"][each - 1 :: each] for run, each in zip(runs, every, strict=True)
    ]
    peak = np.abs(forces[-1]).max()
    apart = [float(np.sqrt(np.mean((a - b) ** 2))) for a, b in pairwise(forces)]
    return np.array(apart) / peak


def moved_by_a_parameter(
    bearing: Bearing, temperature: float, strain: float, *, change: float = 2.5e-5, **how: Any
) -> float:
    """Largest change of a force sample, of the peak, when b, n_T, d_y or K_r changes by that."""
    names = (
        "hardening",
        "hysteretic_temperature_coefficient",
        "yield_displacement",
        "layer_stiffness",
    )
    force = full_cycles(bearing, temperature, strain, 5e-3, **how).response["force"]
    largest = 0.0
    for name in names:
        value = getattr(bearing.hysteresis, name) * (1.0 + change)
        moved = changed(bearing, hysteresis={name: value})
        other = full_cycles(moved, temperature, strain, 5e-3, **how)
        largest = max(largest, float(np.abs(other.response["force"] - force).max()))
    return largest / float(np.abs(force).max())
