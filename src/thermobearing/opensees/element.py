"""One element of an OpenSees model: requests in, forces and matrices out, histories kept.

A trial starts from the committed state only. The duration of a step is the difference of the times
of the domain; heat comes from work, never from velocities. The element recognises `reset` by a
trial at time zero without any displacement, which the reset of a domain sends, and begins again
with a new bearing.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from thermobearing.core.records import Floats
from thermobearing.model.element import BearingElement
from thermobearing.opensees.case import Layout, ServedCase, Units, spring_constants
from thermobearing.opensees.wire import Action, Request

SHORTEST = 1e-6  # duration of a step in which the time does not advance [s]
RESTING = 0.1  # displacement of a bearing that a gravity stage may cause [mm]
NOT_ADVANCING = (
    "the time of the model goes back from {0:g} to {1:g} while the bearing moves without velocity, "
    "as in displacement control, where the time is the load factor: give the speed of the static "
    "analysis, rate, in mm/s"
)

NO_VELOCITY = (
    "a step displaces the bearing without velocity, as in displacement control, and lasts as long "
    "as the time of the model advances, {0:g} s: if that is a load factor, give the speed of the "
    "static analysis, rate, in mm/s"
)
REFUSED = "connection_failed"


class StepError(RuntimeError):
    """A step that cannot be computed; OpenSees may try a smaller one."""


class Served(NamedTuple):
    """The history of one bearing in one direction, from the start or a reset to the end."""

    tag: int
    pair: int  # place of the bearing in its element, from 1
    direction: int
    run: int  # 1, and one more for each reset or new element of the same tag
    outcome: str
    time: Floats  # of the model
    books: dict[str, Floats]  # of core.types.Books; energies are those of both directions
    rubber: Floats  # temperatures of the layers [degC]
    initial: Floats  # temperatures of the cells [degC]
    final: Floats


class _Recorded:
    """A bearing that keeps the end of every committed step."""

    def __init__(self, bearing: BearingElement) -> None:
        self.bearing = bearing
        cells = bearing.constants.layer_cells
        self._upper, self._lower = cells["upper_middle"], cells["lower_middle"]
        self.initial = bearing.state.temperature.copy()
        self._rows: list[tuple[float, Any, Floats]] = []  # time, books, rubber
        self.outcome = "completed"
        self.keep(0.0)

    def keep(self, time: float) -> None:
        """Append the committed state."""
        state = self.bearing.state
        rubber = 0.5 * (state.temperature[self._upper] + state.temperature[self._lower])
        self._rows.append((time, state.books.copy(), rubber))

    @property
    def moved(self) -> bool:
        """Whether the bearing was displaced: a gravity stage alone leaves no history."""
        at = [books["displacement"][0] for _, books, _ in self._rows]
        return bool(np.ptp(at, axis=0).any())

    def served(self, tag: int, pair: int, directions: Sequence[int], run: int) -> list[Served]:
        """Return the history so far, in each direction."""
        times, each, rubber = zip(*self._rows, strict=True)
        kept = np.concatenate(each)
        books = {name: kept[name].copy() for name in kept.dtype.names or ()}
        return [
            Served(
                *(tag, pair, direction, run, self.outcome, np.array(times)),
                {key: one[:, place] if one.ndim > 1 else one for key, one in books.items()},
                *(np.array(rubber), self.initial, self.bearing.state.temperature.copy()),
            )
            for place, direction in enumerate(directions)
        ]


class ServedElement:
    """Bearings between pairs of nodes, as OpenSees sees them."""

    def __init__(self, case: ServedCase, layout: Layout, tag: int, run: int = 1) -> None:
        self.case, self.layout, self.tag, self.run = case, layout, tag, run
        units = Units.named(case.units)
        self._length = units.length
        self._force = case.count / units.force  # of the element in the units of the client, per kN
        rotations = np.array([dof > 3 and layout.vertical is not None for dof in layout.dofs])
        stiffness = spring_constants(layout, case) * self._force
        self._linear = stiffness * np.where(rotations, 1.0 / units.length, units.length)
        self._any_linear = bool(self._linear.any())
        d = len(layout.dofs)
        places = [layout.dofs.index(direction) for direction in layout.directions]
        self._ends = [  # of each bearing, in each direction: places of the first and second node
            [(2 * pair * d + place, (2 * pair + 1) * d + place) for place in places]
            for pair in range(layout.pairs)
        ]
        self.finished: list[Served] = []
        self.note = ""  # what the user should know about the steps so far
        self._begin()

    def _begin(self) -> None:
        """Put new bearings at the start."""
        ways = len(self.layout.directions)
        self._bearings = [_Recorded(self.case.new_bearing(ways)) for _ in self._ends]
        books = [b.bearing.state.books for b in self._bearings]
        self._at = [np.ravel(one["displacement"]).tolist() for one in books]
        self._zero = list(self._at)  # displacement of the bearings where the model has none
        self._forces = [np.ravel(one["force"]).tolist() for one in books]
        pairs = zip(self._bearings, self._at, strict=True)
        self._tangents = [_moved(b, x, SHORTEST)[1] for b, x in pairs]
        self._time = 0.0
        self._trial_time = 0.0
        self._pending = self._pushed = False
        self._last: tuple[Any, ...] = ()
        self._problem = ""
        self._x: list[float] = [0.0] * self.layout.size
        self._f, self._k = list(self._forces), list(self._tangents)

    def reset(self) -> None:
        """Keep the history so far, and begin again."""
        if any(bearing.moved for bearing in self._bearings):
            self.finished += self._present()
            self.run += 1
        self._begin()

    def _present(self) -> list[Served]:
        return [
            history
            for pair, bearing in enumerate(self._bearings, 1)
            for history in bearing.served(self.tag, pair, self.layout.directions, self.run)
        ]

    def histories(self) -> list[Served]:
        """Return the histories of all bearings so far."""
        return [*self.finished, *self._present()]

    def answer(self, request: Request) -> Floats | list[float] | None:
        """Carry out a request; return its force vector or matrix, or raise StepError."""
        match request.action:
            case Action.SET_TRIAL:
                self._try(request)
            case Action.COMMIT:
                self._commit()
            case Action.FORCE:
                self._check()
                return self._vector()
            case Action.TANGENT | Action.INITIAL_STIFFNESS:
                self._check()
                return self._matrix()
        return None

    def _check(self) -> None:
        if self._problem:
            raise StepError(self._problem)

    def _try(self, request: Request) -> None:
        """Move the bearings from the committed state to a trial displacement."""
        x, time = request.displacement, request.time
        moving = any(request.velocity) or any(request.acceleration)
        if self._last == (x, time, moving):
            return  # OpenSees sends each trial twice
        self._last, self._problem = (x, time, moving), ""
        if not request.finite:
            self._problem = "OpenSees sends a displacement or a time that is not finite"
            return
        if time == 0.0 and self._time != 0.0 and not any(x):
            self.reset()
            self._last = (x, time, moving)
        self._x = list(x)
        goals = [
            [at + self._length * (x[j] - x[i]) for (i, j), at in zip(ends, zero, strict=True)]
            for ends, zero in zip(self._ends, self._zero, strict=True)
        ]
        most = max(map(math.dist, goals, self._at))
        self._pushed = not moving and max(map(math.dist, goals, self._zero)) > RESTING
        try:
            dt = self._duration(time, most, moving)
        except StepError as error:
            self._problem = str(error)
            for bearing in self._bearings:
                bearing.outcome = REFUSED
            return
        self._pending = dt > 0.0
        self._trial_time = time
        if not self._pending:
            self._f, self._k = list(self._forces), list(self._tangents)
            return
        for k, (bearing, goal) in enumerate(zip(self._bearings, goals, strict=True)):
            self._f[k], self._k[k], bearing.outcome = _moved(bearing, goal, dt)
            if bearing.outcome != "completed":
                where = ", ".join(f"{x:.6g}" for x in goal)
                self._problem = f"the step to {where} mm in {dt:.3g} s ended: {bearing.outcome}"
                return

    def _duration(self, time: float, most: float, moving: bool) -> float:
        """Return how long a step lasts [s]; zero where there is nothing to compute."""
        dt = time - self._time
        if self.case.rate is not None and not moving:
            return max(most / self.case.rate, SHORTEST) if most else 0.0
        if dt > 0.0:
            return dt
        if dt < 0.0:
            if most and not moving:
                raise StepError(NOT_ADVANCING.format(self._time, time))
            if time > 0.0:
                return time  # the clock was set to zero, as after a gravity stage
        return SHORTEST if most else 0.0

    def _commit(self) -> None:
        self._check()
        duration, self._time = self._trial_time - self._time, self._trial_time
        if not self._pending:
            return
        clocked = self.case.rate is not None or self.case.step is not None
        if self._pushed and not (clocked or self.note):
            self.note = NO_VELOCITY.format(duration)
        for k, bearing in enumerate(self._bearings):
            bearing.bearing.commit()
            bearing.keep(self._trial_time)
            self._at[k] = np.ravel(bearing.bearing.state.books["displacement"]).tolist()
        self._forces, self._tangents = list(self._f), list(self._k)
        self._pending = False
        self._last = ()

    def _vector(self) -> Floats | list[float]:
        """Return the resisting forces, in the units and the order of the client."""
        found = [0.0] * self.layout.size
        for ends, forces in zip(self._ends, self._f, strict=True):
            for (first, second), force in zip(ends, forces, strict=True):
                found[second] = self._force * force
                found[first] = -found[second]
        if not self._any_linear:
            return found
        x = np.reshape(self._x, (self.layout.pairs, 2, -1))
        springs = self._linear * (x[:, 1] - x[:, 0])
        total: Floats = np.array(found) + np.stack([-springs, springs], axis=1).ravel()
        return total

    def _matrix(self) -> Floats | list[float]:
        """Return the tangent stiffness."""
        n, d = self.layout.size, len(self.layout.dofs)
        scale = self._force * self._length
        if n == 2:  # nothing but one shear spring
            k = scale * self._k[0][0][0]
            return [k, -k, -k, k]
        found = np.zeros((n, n))
        for pair, (ends, tangent) in enumerate(zip(self._ends, self._k, strict=True)):
            spring = np.diag(self._linear)
            places = [first - 2 * pair * d for first, _ in ends]
            spring[np.ix_(places, places)] += scale * np.asarray(tangent)
            block = slice(2 * pair * d, 2 * (pair + 1) * d)
            found[block, block] = np.kron([[1.0, -1.0], [-1.0, 1.0]], spring)
        return found


def _moved(bearing: _Recorded, goal: list[float], dt: float) -> tuple[Any, Any, str]:
    """Return forces, tangent by rows and outcome of a trial."""
    if len(goal) == 1:
        trial = bearing.bearing.set_trial(goal[0], dt)
        return [trial.force], [[trial.tangent]], trial.outcome
    plane: Any = bearing.bearing.set_trial(goal, dt)
    return plane.force.tolist(), plane.tangent, plane.outcome


def finite(values: Floats | list[float]) -> bool:
    """Return whether a reply can be sent."""
    total: float = values.sum() if isinstance(values, np.ndarray) else sum(values)
    return math.isfinite(total)
