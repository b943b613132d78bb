"""Displacement-controlled tests as a list of typed steps: cycles, paths, ramps, rests, recordings.

Steps are data: they come from TOML or Python and go back to it (cyclic/history.py turns them
into displacements and time steps for one bearing). Amplitudes are given as shear strain of
the total rubber thickness or in mm. A test with a path, or with a recording of two components,
moves the bearing in a plane; its other steps then move along x.
"""

import math
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.schema import RATIO, Name, Strict, in_unit, validated
from thermobearing.border.units import number_list
from thermobearing.core.records import Floats
from thermobearing.model.effort import MAX_STEPS
from thermobearing.tables.laboratory import read_laboratory

START = 1e-3  # of the largest displacement (1 mm at least): how far off a recording may start


def checked_history(
    times: Any, displacements: Any, start: float | Floats | None, where: str, across: Any = None
) -> tuple[Floats, Floats]:
    """Return the time between the points of a history [s], and its displacements [mm].

    With displacements `across` (y) there are two of them at each point. The history must begin at
    `start` [mm], if that is known; `where` names it in messages.
    """
    try:
        time = number_list(times, "time [s]")
        displacement = number_list(displacements, "displacement [mm]")
        displacement_y = (
            None if across is None else number_list(across, "displacement across (y) [mm]")
        )
    except InputError as error:
        raise InputError(error.problems, where) from None
    fault, gaps = "", np.diff(time)
    largest = max(1.0, float(np.abs(displacement).max())) if len(displacement) else 1.0
    if len(time) != len(displacement) or len(time) < 2:
        fault = (
            f"{len(time)} times and {len(displacement)} displacements; two equally long lists of "
            "at least 2 are needed"
        )
    elif displacement_y is not None and len(displacement_y) != len(time):
        fault = (
            f"{len(time)} times and displacements along x, but {len(displacement_y)} across (y); "
            "three equally long lists are needed"
        )
    elif not (gaps > 0).all():
        k = int(np.argmin(gaps > 0))
        fault = (
            f"time does not increase from {time[k]:g} to {time[k + 1]:g} s (rows {k + 1} and "
            f"{k + 2} of the numbers)"
        )
    else:
        if displacement_y is not None:
            displacement = np.column_stack([displacement, displacement_y])
            largest = max(largest, float(np.abs(displacement_y).max()))
        if start is not None and distance(displacement[0], start) > START * largest:
            # A ramp moves along x only: it does not reach a start off that axis.
            cure = "insert a ramp before it" if displacement_y is None else "subtract the offset"
            fault = (
                f"starts at {place_text(displacement[0])} mm but the bearing is at "
                f"{place_text(start)} mm; {cure}"
            )
    if fault:
        raise InputError(fault, where)
    return gaps, displacement


def lengths(places: Floats) -> Floats:
    """Return how far displacements [steps] or [steps, 2] are from the origin [mm]."""
    return np.abs(places) if places.ndim == 1 else np.hypot(*places.T)


def distance(place: Any, reference: Any = 0.0) -> float:
    """Return the distance between two places on a line or in a plane [mm]."""
    return math.hypot(*np.atleast_1d(np.subtract(place, reference)))


def place_text(place: Any) -> str:
    """Return a displacement in words, such as "3" or "(3, 4)"."""
    return f"{place:g}" if np.ndim(place) == 0 else f"({place[0]:g}, {place[1]:g})"


Wave = Literal["triangular", "sine"]
LONGEST = 1e8  # three years [s]
# Ranges are those of laboratories and earthquakes, with a factor of ten or more on either side.
Seconds = Annotated[float, in_unit("s"), Field(ge=1e-6, le=LONGEST)]
Strain = Annotated[float, RATIO, Field(ge=1e-6, le=5)]
Amplitude = Annotated[float, in_unit("mm"), Field(ge=1e-6, le=1e5)]
Speed = Annotated[float, in_unit("mm/s"), Field(ge=1e-6, le=1e6)]  # creep in a night to impact
REST_GROWTH = 1.05  # each step of a rest against the one before
FEWEST_STEPS = 2  # in a quarter of a cycle: fewer make no loop
REST_START = 0.1  # first step of a rest, at most: what a plate needs to even out [s]
REST_STEPS = 100  # no step of a rest is longer than this part of it
SETTLE_LIMIT = 14 * 24 * 3600.0  # "until within" gives up after two weeks [s]
MAX_CYCLES, MAX_PARTS = 20_000, 10_000  # of one test: more is surely an error
Count = Annotated[int, Field(ge=1, le=MAX_CYCLES)]
LARGEST_STRAIN = 5.0  # more is surely an error in a unit
TINY = 1e-9


def _exactly_one(values: dict[str, Any], *names: str) -> list[str]:
    chosen = [name for name in names if name in values]
    if len(chosen) == 1:
        return []
    return [f"give exactly one of {', '.join(names)}; got {' and '.join(chosen) or 'none'}"]


class Cycles(Strict):
    """Fully reversed cycles about zero.

    `speed` gives every cycle the period 4a/speed, for the triangle its constant speed, for
    the sine the same mean speed (Table 3.4).
    """

    step: Literal["cycles"] = "cycles"
    strain: Strain | None = None
    amplitude: Amplitude | None = None
    wave: Wave = "triangular"
    speed: Speed | None = None
    period: Seconds | None = None
    frequency: Annotated[float, in_unit("Hz"), Field(ge=1e-8, le=1e6)] | None = None
    count: Count = 5
    closing_strain: Strain | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        amplitude = _exactly_one(values, "strain", "amplitude")
        return amplitude + _exactly_one(values, "speed", "period", "frequency")

    def size(self, total_rubber_thickness: float) -> float:
        """Amplitude [mm]."""
        return self.amplitude or (self.strain or 0.0) * total_rubber_thickness

    def quarters(self, total_rubber_thickness: float) -> list[float]:
        """Duration of a quarter of the cycles, and of the closing cycle if there is one [s]."""
        sizes = [self.size(total_rubber_thickness)]
        period = self.period or (1.0 / self.frequency if self.frequency else None)
        # The closing cycle has the speed of the others, not their period.
        speed = (self.speed or 1.0) if period is None else 4.0 * sizes[0] / period
        if self.closing_strain is not None:
            sizes.append(self.closing_strain * total_rubber_thickness)
        return [size / speed for size in sizes]


Shape = Literal["circle", "ellipse", "eight", "square", "spiral", "cruciform"]
ACROSS = {"ellipse": 0.5, "eight": 0.5}  # amplitude across over that along x; 1 of other paths
CORNERS = {  # of straight paths, all sides of which take the same part of a turn per length
    "square": ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)),
    "cruciform": ((0, 0), (1, 0), (0, 0), (-1, 0), (0, 0), (0, 1), (0, 0), (0, -1), (0, 0)),
}
SIDES = 8  # parts of a turn between points that every sampling hits
FEWEST_ON_CURVE = 8  # steps in each of them: fewer make no curve
FINE = 512  # points in each of them for the length of a path


class PlanePath(Strict):
    """Turns on a path in the plane, reached by a ramp from the origin and left by one to it.

    `strain` or `amplitude` is that along x; `ratio` is the amplitude across (y) over it, 0.5 of an
    ellipse and a figure of eight and 1 of the others if it is not given (a circle and a spiral
    take none). A spiral grows evenly from the origin to its amplitude over its turns. Curves run
    at constant angular velocity, square and cruciform at constant speed; `speed` is the mean one.
    """

    step: Literal["path"] = "path"
    path: Shape
    strain: Strain | None = None
    amplitude: Amplitude | None = None
    ratio: Annotated[float, Field(ge=1e-3, le=1.0)] | None = None
    speed: Speed | None = None
    period: Seconds | None = None
    frequency: Annotated[float, in_unit("Hz"), Field(ge=1e-8, le=1e6)] | None = None
    count: Count = 5
    ramp: Seconds | None = None  # duration of each ramp; a quarter of a turn if not given

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        faults = _exactly_one(values, "strain", "amplitude")
        faults += _exactly_one(values, "speed", "period", "frequency")
        if "ratio" in values and values.get("path") in ("circle", "spiral"):
            faults.append(f"ratio: a {values['path']} has none; use an ellipse")
        return faults

    def size(self, total_rubber_thickness: float) -> float:
        """Amplitude along x [mm]."""
        return self.amplitude or (self.strain or 0.0) * total_rubber_thickness

    def turn_duration(self, total_rubber_thickness: float) -> float:
        """Duration of a turn [s]."""
        if self.speed is None:
            return self.period or 1.0 / (self.frequency or 1.0)
        points = self.size(total_rubber_thickness) * self.points(FINE)
        # The mean of all turns: those of a spiral differ in length.
        return float(lengths(np.diff(points, axis=0)).sum()) / self.speed / self.count

    def ramp_duration(self, total_rubber_thickness: float) -> float:
        """Duration of the ramps from the origin and to it [s]."""
        return self.ramp or 0.25 * self.turn_duration(total_rubber_thickness)

    def sides(self, duration: float, dt: float) -> int:
        """Number of time steps in each of the SIDES parts of a turn of some duration [s]."""
        return max(FEWEST_ON_CURVE, math.ceil(duration / SIDES / dt - TINY))

    def points(self, steps: int) -> Floats:
        """All turns for an amplitude of 1, with the point at which they begin, [points, 2]."""
        count = SIDES * steps
        if self.path in CORNERS:
            corners = np.array(CORNERS[self.path], dtype=float)
            at = np.arange(count) / steps
            turn = np.column_stack([np.interp(at, range(SIDES + 1), c) for c in corners.T])
        else:
            angle = 2.0 * np.pi * np.arange(count) / count
            waves = np.cos(angle), np.sin(angle)
            if self.path == "eight":
                waves = np.sin(angle), np.sin(2.0 * angle)
            turn = np.column_stack(waves)
        turn[:, 1] *= ACROSS.get(self.path, 1.0) if self.ratio is None else self.ratio
        # `turn` lacks its last point, which is the first one of the next turn.
        turns = np.concatenate([np.tile(turn, (self.count, 1)), turn[:1]])
        if self.path == "spiral":
            turns *= np.linspace(0.0, 1.0, len(turns))[:, np.newaxis]
        return np.asarray(turns)


class Ramp(Strict):
    """One straight move to a strain or displacement, at a speed or over a time."""

    step: Literal["ramp"] = "ramp"
    to_strain: Annotated[float, RATIO, Field(ge=-5, le=5)] | None = None
    to: Annotated[float, in_unit("mm"), Field(ge=-1e5, le=1e5)] | None = None
    speed: Speed | None = None
    duration: Seconds | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        return _exactly_one(values, "to_strain", "to") + _exactly_one(values, "speed", "duration")

    def target(self, total_rubber_thickness: float) -> float:
        """Return the displacement at the end [mm]."""
        return (self.to_strain or 0.0) * total_rubber_thickness if self.to is None else self.to

    def seconds(self, distance: float) -> float:
        """Return the time that the move takes [s]."""
        return self.duration or distance / (self.speed or 1.0)


class Rest(Strict):
    """No motion, for a time or until every cell is `within` some kelvin of the ambient."""

    step: Literal["rest"] = "rest"
    duration: Seconds | None = None
    within: Annotated[float, in_unit("K"), Field(ge=1e-6, le=1000)] | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        return _exactly_one(values, "duration", "within")

    @property
    def span(self) -> float:
        """Time that it may take [s]."""
        return self.duration or SETTLE_LIMIT

    def longest_step(self, dt: float) -> float:
        """Return the largest of its growing steps [s]."""
        return max(dt, min(self.span / REST_STEPS, 600.0))

    def _steps(self, dt: float) -> float:
        """Return the number of steps, or a few more: those that grow, and those that do not."""
        # Steps grow as a geometric series from the shortest to the longest; the others are equal.
        longest, shortest = self.longest_step(dt), min(dt, self.span, REST_START)
        return math.log(longest / shortest) / math.log(REST_GROWTH) + self.span / longest + 2.0


Moment = Annotated[float, Field(ge=-1e10, le=1e10)]  # [s]
Place = Annotated[float, Field(ge=-1e5, le=1e5)]  # [mm]


class Recorded(Strict):
    """A displacement history: a CSV file with columns time and displacement, or two lists.

    With a displacement across (`column_y` is the title of its column, `displacement_y_mm` a third
    list) the bearing moves in a plane.
    """

    step: Literal["recorded"] = "recorded"
    file: Annotated[str, Field(min_length=1)] | None = None
    time_s: Annotated[tuple[Moment, ...], Field(max_length=MAX_STEPS)] | None = None
    displacement_mm: Annotated[tuple[Place, ...], Field(max_length=MAX_STEPS)] | None = None
    column_y: Annotated[str, Field(min_length=1)] | None = None
    displacement_y_mm: Annotated[tuple[Place, ...], Field(max_length=MAX_STEPS)] | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        lists = {"time_s", "displacement_mm"} & set(values)
        if ("file" in values) == bool(lists) or len(lists) == 1:
            return ["give either file, or both time_s and displacement_mm"]
        if "column_y" in values and "file" not in values:
            return ["column_y is the title of a column of file; give displacement_y_mm with lists"]
        if "displacement_y_mm" in values and "file" in values:
            return ["displacement_y_mm goes with lists; give column_y with file"]
        return []

    @property
    def in_plane(self) -> bool:
        """Whether there is a displacement across."""
        return self.column_y is not None or self.displacement_y_mm is not None

    @property
    def name(self) -> str:
        """Name of the file, or "history"."""
        return "history" if self.file is None else Path(self.file).name

    def points(self, start: float | Floats | None) -> tuple[Floats, Floats, list[str]]:
        """Return the time between points [s], displacements [mm] and what was assumed."""
        if self.file is None:
            lists = self.time_s, self.displacement_mm, start, "history", self.displacement_y_mm
            return *checked_history(*lists), []
        readings = read_laboratory(self.file, optional=("force", "ambient"), across=self.column_y)
        across = readings.values["displacement_y"] if self.in_plane else None
        time, x = readings.values["time"], readings.displacement
        return *checked_history(time, x, start, self.file, across), readings.assumptions


AnyStep = Cycles | PlanePath | Ramp | Rest | Recorded
Step = Annotated[AnyStep, Field(discriminator="step")]


class CyclicTest(Strict):
    """The steps of a cyclic test; `cyclic_test` creates the usual ones.

    Attributes
    ----------
    name : for titles.
    dt : largest time step while the bearing moves [s], in [1e-6, 10].
    steps : of Cycles, PlanePath, Ramp, Rest and Recorded (tables with a key `step`), one after the
        other.

    Examples
    --------
    >>> steps = [{"step": "ramp", "to_strain": 1.0, "speed": 30.0}, {"step": "rest", "within": 1.0}]
    >>> [step.step for step in CyclicTest(dt=0.01, steps=steps).steps]
    ['ramp', 'rest']
    """

    name: Name = "test"
    dt: Annotated[float, in_unit("s"), Field(ge=1e-6, le=10)] = 0.005
    steps: Annotated[list[Step], Field(min_length=1, max_length=MAX_PARTS)]

    @property
    def in_plane(self) -> bool:
        """Whether the bearing moves in a plane."""
        return any(
            isinstance(step, PlanePath) or (isinstance(step, Recorded) and step.in_plane)
            for step in self.steps
        )


def lifted(x: float | Floats) -> Floats:
    """Return a displacement along x, or several [mm], as places in the plane."""
    return np.stack([x, np.zeros_like(x)], axis=-1)


def _step_faults(
    step: AnyStep, dt: float, rubber: float, at: float | Floats | None, plane: bool
) -> tuple[float, float | Floats | None, list[str]]:
    """Return number of time steps, displacement at the end and faults of one step."""
    faults, steps, peak, where = [], 0.0, 0.0, ""
    end: float | Floats | None = at
    origin = np.zeros(2) if plane else 0.0
    match step:
        case Cycles():
            # An estimate for the limit of steps: the test rounds each quarter up to whole steps.
            parts = zip((step.count, 1), step.quarters(rubber), strict=False)
            steps = sum(4.0 * n * max(FEWEST_STEPS, quarter / dt) for n, quarter in parts)
            end, peak = origin, step.size(rubber)
        case PlanePath():
            duration = step.turn_duration(rubber)
            steps = step.count * SIDES * max(FEWEST_ON_CURVE, duration / SIDES / dt)
            steps += 2.0 * step.ramp_duration(rubber) / dt
            peak = step.size(rubber) * float(lengths(step.points(1)).max())
            end = origin
        case Ramp():
            target = step.target(rubber)
            end = lifted(target) if plane else target
            steps, peak = step.seconds(distance(end, 0.0 if at is None else at)) / dt, abs(target)
        case Rest():
            steps = step._steps(dt)
        case Recorded():
            where = f"{step.file or step.name}: "
            try:
                gaps, x, _ = step.points(at)
            except InputError as error:
                # It is not known where the recording ends, so no start of the next step is checked.
                return 0.0, None, error.lines()
            if plane and x.ndim == 1:
                x = lifted(x)
            end = x[-1] if plane else float(x[-1])
            peak = float(lengths(x).max())
            steps = float(np.maximum(1.0, gaps / dt).sum())
    if isinstance(step, Cycles | PlanePath) and at is not None and distance(at) > TINY:
        faults.append(
            f"{step.step} start from zero, but the bearing is at {place_text(at)} mm; insert "
            "a ramp to 0 mm before them"
        )
    if peak > LARGEST_STRAIN * rubber * (1.0 + TINY):
        faults.append(
            f"{where}reaches {peak:g} mm, more than {LARGEST_STRAIN:.0%} of the total rubber "
            f"thickness of {rubber:g} mm; is the unit right?"
        )
    return steps, end, faults


def survey(
    test: CyclicTest, total_rubber_thickness: float, start: float | Floats = 0.0
) -> tuple[list[str], float]:
    """Return why a test cannot be done with a bearing, and how many time steps it takes.

    The bearing is at `start` [mm] when it begins. Recordings are read; nothing is sampled.
    """
    faults, total, plane = [], 0.0, test.in_plane
    at: float | Floats | None = lifted(start) if plane and np.ndim(start) == 0 else start
    for number, step in enumerate(test.steps):
        steps, at, step_faults = _step_faults(step, test.dt, total_rubber_thickness, at, plane)
        total += steps
        faults += [f"steps[{number}]: {fault}" for fault in step_faults]
    cycles = sum(step.count for step in test.steps if isinstance(step, Cycles | PlanePath))
    if cycles > MAX_CYCLES:
        faults.append(f"has {cycles} cycles; the limit for one test is {MAX_CYCLES}")
    if total > MAX_STEPS:
        faults.append(
            f"dt = {test.dt:g} s gives {total:.3g} steps; the limit is {MAX_STEPS}: use a "
            "larger dt, or look for an error in a speed, period or count"
        )
    return faults, total


SPEED = 30.0  # of Table 3.4, mean [mm/s]


class _TestArguments(Strict):
    """Arguments of `cyclic_test` under other names than the keys of its steps."""

    cycles: Count
    rest: Seconds | None


@checked
def cyclic_test(
    strain: float | list[float] | tuple[float, ...] = (0.5, 1.0, 1.5, 2.0, 2.5),
    *,
    cycles: int = 5,
    wave: Wave = "triangular",
    speed: float | None = None,
    frequency: float | None = None,
    period: float | None = None,
    rest: float | None = 4500.0,
    closing_strain: float | None = 0.1,
    path: Shape | None = None,
    ratio: float | None = None,
    dt: float = 0.005,
) -> CyclicTest:
    """Return a test of cycles at several amplitudes, with rests between them; default: Table 3.4.

    Parameters
    ----------
    strain : shear strain amplitudes, each > 0.
    cycles : fully reversed cycles at each amplitude.
    wave : "triangular" (constant speed) or "sine"; both have the period 4a/speed.
    speed : mean loading rate [mm/s]; 30 by default.
    frequency : frequency of the cycles [Hz], instead of the speed.
    period : period of the cycles [s], instead of the speed.
    rest : pause between amplitudes [s], 1.25 h by default (Shen (2023) gives 1 to 1.5 h);
        None for no pause.
    closing_strain : strain of the one small cycle that stops the loading smoothly after
        each amplitude (section 3.3.1; its size is not printed, 0.1 is our choice); None for
        none.
    path : turns in the plane instead of cycles on a line: "circle", "ellipse", "eight", "square",
        "spiral" or "cruciform", without closing cycle; `wave` does not apply.
    ratio : amplitude of the path across (y) over that along x, in [0.001, 1]; 0.5 of an ellipse
        and a figure of eight, 1 of a square and a cruciform by default.
    dt : largest time step while the bearing moves [s].

    Raises
    ------
    InputError : a value out of range; a ratio without a path.

    Examples
    --------
    >>> [step.step for step in cyclic_test(strain=[0.5, 1.0]).steps]
    ['cycles', 'rest', 'cycles']
    >>> cyclic_test(strain=[1.0], path="ellipse", ratio=0.3).in_plane
    True
    """
    levels = np.atleast_1d(np.asarray(strain, dtype=object)).ravel().tolist()
    if not levels:
        raise InputError("strain: give at least one amplitude", "cyclic_test()")
    repeated = {"cycles": cycles, "rest": rest}
    validated(_TestArguments, repeated, "cyclic_test()", from_file=False)  # even without any rest
    rates = {"speed": speed, "frequency": frequency, "period": period}
    rate = {key: value for key, value in rates.items() if value is not None} or {"speed": SPEED}
    common = {"step": "cycles", "wave": wave, "closing_strain": closing_strain}
    if path is not None:
        common = {"step": "path", "path": path, "ratio": ratio}
    elif ratio is not None:
        raise InputError("ratio: applies only to a path in the plane; give path", "cyclic_test()")
    steps: list[dict[str, object]] = []
    for level in levels:
        if steps and rest is not None:
            steps.append({"step": "rest", "duration": rest})
        steps.append({"strain": level, "count": cycles, **common, **rate})
    published_rate = {"speed": SPEED}
    as_published = levels == [0.5, 1.0, 1.5, 2.0, 2.5] and cycles == 5 and rate == published_rate
    as_published = as_published and bool(rest) and path is None
    data = {"name": "Table 3.4" if as_published else "cyclic test", "dt": dt, "steps": steps}
    return validated(CyclicTest, data, "cyclic_test()", from_file=False)
