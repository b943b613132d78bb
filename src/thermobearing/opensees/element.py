"""One element of an OpenSees model: requests in, forces and matrices out, histories kept.

A trial starts from the committed state only. The duration of a step is the difference of the times
of the domain; heat comes from work, never from velocities. The element recognises `reset` by a
trial at time zero without any displacement, which the reset of a domain sends, and begins again
with a new bearing.
"""

import math
from typing import Any

import numpy as np

from thermobearing.core.records import Floats
from thermobearing.model.axial import DOWELLED
from thermobearing.model.element import BearingElement
from thermobearing.model.outcomes import UNSTABLE
from thermobearing.opensees.axial import ServedColumn
from thermobearing.opensees.case import Layout, ServedCase, Units, spring_constants
from thermobearing.opensees.recording import Journal, Label, Recording, Served
from thermobearing.opensees.wire import Action, Request

SHORTEST_STEP = 1e-6  # duration of a step in which the time does not advance [s]
GRAVITY_DISPLACEMENT = 0.1  # displacement of a bearing that a gravity stage may cause [mm]
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
CONNECTION_FAILED = "connection_failed"


class StepError(RuntimeError):
    """A step that cannot be computed; OpenSees may try a smaller one."""


class ServedElement:
    """Bearings between pairs of nodes, as OpenSees sees them."""

    def __init__(
        self,
        case: ServedCase,
        layout: Layout,
        tag: int,
        run: int = 1,
        journal: Journal | None = None,
    ) -> None:
        self._journal = journal
        self.case, self.layout, self.tag, self.run = case, layout, tag, run
        units = Units.named(case.units)
        self._length_factor = units.length
        # Force of the element in the units of the client, per kN of one bearing.
        self._force_factor = case.count / units.force
        rotations = np.array([dof > 3 and layout.vertical is not None for dof in layout.dofs])
        # A translation is converted from force per length, a rotation from moment per radian.
        stiffness = spring_constants(layout, case) * self._force_factor
        self._linear = stiffness * np.where(rotations, 1.0 / units.length, units.length)
        self._any_linear = bool(self._linear.any())
        d = len(layout.dofs)
        places = [layout.dofs.index(direction) for direction in layout.directions]
        self._ends = [  # of each bearing, in each direction: places of the first and second node
            [(2 * pair * d + place, (2 * pair + 1) * d + place) for place in places]
            for pair in range(layout.pairs)
        ]
        self._vertical_ends: list[
            tuple[int, int]
        ] = []  # of each bearing, where its axial force acts
        if case.has_axial and layout.vertical is not None:
            place = layout.dofs.index(layout.vertical)
            pairs = range(layout.pairs)
            self._vertical_ends = [(2 * k * d + place, (2 * k + 1) * d + place) for k in pairs]
        self._finished: list[Recording] = []
        self.note = ""  # what the user should know about the steps so far
        self._begin()

    def _begin(self) -> None:
        """Put new bearings at the start."""
        components = len(self.layout.directions)
        self._bearings = [self.case.new_bearing(components) for _ in self._ends]
        dowelled, dowel_length = self.case.joint == DOWELLED, self.case.dowel_length
        self._columns = [
            ServedColumn(self.case.bearing, bearing, dowelled=dowelled, dowel_length=dowel_length)
            for bearing, _ in zip(self._bearings, self._vertical_ends, strict=False)
        ]
        starts = [column.row for column in self._columns] or [None] * len(self._bearings)
        self._recordings = [
            Recording(
                Label(self.tag, pair, self.layout.directions, self.run),
                bearing,
                self._journal,
                start,
            )
            for pair, (bearing, start) in enumerate(zip(self._bearings, starts, strict=True), 1)
        ]
        response = [bearing.state.response for bearing in self._bearings]
        self._committed = [np.ravel(row["displacement"]).tolist() for row in response]
        self._origins = list(self._committed)  # where the displacement of the model is zero
        self._forces = [np.ravel(row["force"]).tolist() for row in response]
        # OpenSees may ask for the tangent before the first trial.
        pairs = zip(self._bearings, self._committed, strict=True)
        self._tangents = [_trial_response(b, x, SHORTEST_STEP)[1] for b, x in pairs]
        self._time = 0.0
        self._trial_time = 0.0
        self._pending = self._static_step = False
        self._last_trial: tuple[Any, ...] = ()
        self._problem = ""
        self._trial_displacement: list[float] = [0.0] * self.layout.size
        self._targets = list(self._committed)
        self._extensions = [0.0] * len(self._columns)
        self._set_trial_axial()
        self._trial_forces, self._trial_tangents = list(self._forces), list(self._tangents)

    def reset(self) -> None:
        """Keep the history so far, and begin again."""
        if any(recording.displaced for recording in self._recordings):
            self._finished += self._recordings
            self.flush()
            self.run += 1
        else:
            for recording in self._recordings:
                recording.discard()
        self._begin()

    def flush(self) -> None:
        """Write committed steps that are still in memory into the journal."""
        for recording in self._recordings:
            recording.flush()

    def histories(self) -> list[Served]:
        """Return the histories of all bearings so far."""
        recordings = [*self._finished, *self._recordings]
        return [history for recording in recordings for history in recording.served()]

    def answer(self, request: Request) -> Floats | list[float] | None:
        """Carry out a request; return its force vector or matrix, or raise StepError."""
        match request.action:
            case Action.SET_TRIAL:
                self._set_trial(request)
            case Action.COMMIT:
                self._commit()
            case Action.FORCE:
                self._raise_problem()
                return self._vector()
            case Action.TANGENT | Action.INITIAL_STIFFNESS:
                self._raise_problem()
                return self._matrix()
        return None

    def _raise_problem(self) -> None:
        if self._problem:
            raise StepError(self._problem)

    def _set_trial(self, request: Request) -> None:
        """Move the bearings from the committed state to a trial displacement."""
        x, time = request.displacement, request.time
        moving = any(request.velocity) or any(request.acceleration)
        if self._last_trial == (x, time, moving):
            return  # OpenSees sends each trial twice
        self._last_trial, self._problem = (x, time, moving), ""
        if not request.finite:
            self._problem = "OpenSees sends a displacement or a time that is not finite"
            return
        # The reset of a domain sends this trial and no message of its own.
        if time == 0.0 and self._time != 0.0 and not any(x):
            self.reset()
            self._last_trial = (x, time, moving)
        self._trial_displacement = list(x)
        targets = [
            [
                start + self._length_factor * (x[second] - x[first])
                for (first, second), start in zip(ends, origin, strict=True)
            ]
            for ends, origin in zip(self._ends, self._origins, strict=True)
        ]
        self._targets = targets
        self._extensions = [
            self._length_factor * (x[second] - x[first]) for first, second in self._vertical_ends
        ]
        self._set_trial_axial()
        distance = max(map(math.dist, targets, self._committed))
        # A gravity stage displaces bearings a little without velocity; more than that is a
        # static analysis, whose time may be a load factor.
        offset = max(map(math.dist, targets, self._origins))
        self._static_step = not moving and offset > GRAVITY_DISPLACEMENT
        try:
            dt = self._duration(time, distance, moving)
        except StepError as error:
            self._problem = str(error)
            for recording in self._recordings:  # unless a later trial succeeds
                recording.outcome = CONNECTION_FAILED
            return
        self._pending = dt > 0.0
        self._trial_time = time
        if not self._pending:
            self._trial_forces, self._trial_tangents = list(self._forces), list(self._tangents)
            return
        for k, (bearing, target) in enumerate(zip(self._bearings, targets, strict=True)):
            response = _trial_response(bearing, target, dt)
            self._trial_forces[k], self._trial_tangents[k], outcome = response
            self._recordings[k].outcome = self._outcome(k, outcome)
            if outcome != "completed":
                where = ", ".join(f"{x:.6g}" for x in target)
                self._problem = f"the step to {where} mm in {dt:.3g} s ended: {outcome}"
                return

    def _set_trial_axial(self) -> None:
        """Pull or press the bearings, with the law of the committed state."""
        # Kept until the next trial: OpenSees asks for the force of a step after its commit too,
        # when the law is already that of the next step.
        components = len(self.layout.directions)
        extended = zip(self._columns, self._extensions, strict=True)
        self._trial_axial = [
            (column.trial(extension), column.reduction[:components])
            for column, extension in extended
        ]

    def _duration(self, time: float, distance: float, moving: bool) -> float:
        """Return how long a step lasts [s]; zero where there is nothing to compute."""
        dt = time - self._time
        # A static analysis has no velocity, and its time is a load factor, not a clock.
        if self.case.rate is not None and not moving:
            return max(distance / self.case.rate, SHORTEST_STEP) if distance else 0.0
        if dt > 0.0:
            return dt
        if dt < 0.0:
            if distance and not moving:
                raise StepError(NOT_ADVANCING.format(self._time, time))
            if time > 0.0:
                return time  # the clock was set to zero, as after a gravity stage
        # The time stands still: a step that moves is given the shortest duration, since heat and
        # rate dependence divide by it; one that does not move changes nothing.
        return SHORTEST_STEP if distance else 0.0

    def _commit(self) -> None:
        self._raise_problem()
        duration, self._time = self._trial_time - self._time, self._trial_time
        if not self._pending:
            self._commit_axial()  # a gravity stage with a rate moves nothing in shear
            return
        # With a rate, the duration is not that of the model, and the note would mislead.
        if self._static_step and self.case.rate is None and not self.note:
            self.note = NO_VELOCITY.format(duration)
        for k, bearing in enumerate(self._bearings):
            bearing.commit()
            self._committed[k] = np.ravel(bearing.state.response["displacement"]).tolist()
        self._commit_axial()
        rows = [column.row for column in self._columns] or [None] * len(self._bearings)
        for recording, bearing, row in zip(self._recordings, self._bearings, rows, strict=True):
            recording.keep(self._trial_time, bearing, row)
        self._forces, self._tangents = list(self._trial_forces), list(self._trial_tangents)
        self._pending = False
        self._last_trial = ()  # the same trial again is a step from the new committed state

    def _commit_axial(self) -> None:
        """Accept the axial forces of the last trial."""
        for k, column in enumerate(self._columns):
            column.commit(self._extensions[k])
            self._recordings[k].outcome = self._outcome(k, "completed")

    def _outcome(self, k: int, outcome: str) -> str:
        """Return the outcome of a bearing whose last step had an outcome."""
        if not self._columns or self._columns[k].outcome == "completed":
            return outcome
        # What follows from a bearing that has buckled does not hide it.
        if outcome == "completed" or self._columns[k].outcome == UNSTABLE:
            return self._columns[k].outcome
        return outcome

    def _vector(self) -> Floats | list[float]:
        """Return the resisting forces, in the units and the order of the client."""
        forces_of_dofs = [0.0] * self.layout.size
        for ends, forces in zip(self._ends, self._trial_forces, strict=True):
            for (first, second), force in zip(ends, forces, strict=True):
                forces_of_dofs[second] = self._force_factor * force
                forces_of_dofs[first] = -forces_of_dofs[second]
        for k, (lower, upper) in enumerate(self._vertical_ends):
            axial, reduction = self._trial_axial[k]
            shear = [kappa * x for kappa, x in zip(reduction, self._targets[k], strict=True)]
            for (first, second), force in zip(self._ends[k], shear, strict=True):
                forces_of_dofs[second] -= self._force_factor * force
                forces_of_dofs[first] += self._force_factor * force
            forces_of_dofs[upper] = -self._force_factor * axial.force
            forces_of_dofs[lower] = -forces_of_dofs[upper]
        if not self._any_linear:
            return forces_of_dofs
        x = np.reshape(self._trial_displacement, (self.layout.pairs, 2, -1))
        springs = self._linear * (x[:, 1] - x[:, 0])
        total: Floats = np.array(forces_of_dofs) + np.stack([-springs, springs], axis=1).ravel()
        return total

    def _matrix(self) -> Floats | list[float]:
        """Return the tangent stiffness."""
        n, d = self.layout.size, len(self.layout.dofs)
        scale = self._force_factor * self._length_factor
        if n == 2:  # nothing but one shear spring
            k = scale * self._trial_tangents[0][0][0]
            return [k, -k, -k, k]
        stiffness = np.zeros((n, n))
        for pair, (ends, tangent) in enumerate(zip(self._ends, self._trial_tangents, strict=True)):
            spring = np.diag(self._linear)
            places = [first - 2 * pair * d for first, _ in ends]
            spring[np.ix_(places, places)] += scale * np.asarray(tangent)
            if self._vertical_ends:
                axial, reduction = self._trial_axial[pair]
                spring[places, places] -= scale * np.array(reduction)
                vertical = self._vertical_ends[pair][0] - 2 * pair * d
                spring[vertical, vertical] = scale * axial.tangent
            block = slice(2 * pair * d, 2 * (pair + 1) * d)
            stiffness[block, block] = np.kron([[1.0, -1.0], [-1.0, 1.0]], spring)
        return stiffness


def _trial_response(
    bearing: BearingElement, target: list[float], dt: float
) -> tuple[Any, Any, str]:
    """Return forces, tangent by rows and outcome of a trial."""
    if len(target) == 1:
        trial = bearing.set_trial(target[0], dt)
        return [trial.force], [[trial.tangent]], trial.outcome
    plane: Any = bearing.set_trial(target, dt)
    return plane.force.tolist(), plane.tangent, plane.outcome


def finite(values: Floats | list[float]) -> bool:
    """Return whether a reply can be sent."""
    total: float = values.sum() if isinstance(values, np.ndarray) else sum(values)
    return math.isfinite(total)
