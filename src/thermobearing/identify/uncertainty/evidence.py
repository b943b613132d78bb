"""What tests say about assumed numbers, and the uncertainty of a calibration with it.

The causes of a misfit have one order, in which warnings, certificate and report name them.
"""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from thermobearing.core.records import Floats
from thermobearing.identify.fit.parameters import Parameter
from thermobearing.identify.uncertainty.groups import AMBIENT, CELLS, CONDITIONING, STATE, Group
from thermobearing.quantities.governing import order_from_largest

SURE, BEYOND = 5.0, 3.0  # standard errors of the tests, of tests and source together
NEGLIGIBLE = 1e-3  # of the peak force: smaller residuals are no matter for a warning
MAIN = 0.2  # of the squared residuals: what a mistake of a usual size explains to be a suspect
LAST = 1e6  # standard uncertainties: more than any that is wanted
TENFOLD = 10.0
AS_LIKELY = 0.7  # of what the likeliest cause explains
MUCH = 0.1  # of the squared misfit, which one more free parameter would take away ...
# Usual errors, of an assumed value and of a mistake in a test: what has to be off by more stands
# for another cause, such as a wrong description of the bearing.
LARGEST_ERROR, LARGEST_MISTAKE = 3.0, 10.0
AS_MEASURED = 3.0  # times the start that thermocouples show: a change that it confirms
COOLEST_ROOM, WARMEST_ROOM = 15.0, 30.0  # [degC], from which a specimen comes into its chamber


@dataclass(frozen=True)
class Evidence:
    """Evidence of the tests on one group, with the others as in the file."""

    group: Group
    sigmas: float  # wanted change of the file's values, in standard uncertainties
    stderr: float  # of `sigmas`, by the tests
    # Share of the squared residuals that this would remove, at most 1; negative where more heat
    # cells, whose effect is not scaled, would add to them.
    explained: float
    # [residual, 1 or test] change by one standard uncertainty that no parameter can imitate.
    columns: Floats = field(default_factory=lambda: np.zeros((0, 0)), repr=False, compare=False)
    imitated: bool = False  # with a possible cause of the misfit, the tests require no such change

    @property
    def contradicted(self) -> bool:
        """Whether the tests show that the values of the file are outside their uncertainty.

        A value that moves only because model and test differ by another cause is not contradicted.
        """
        return self.beyond and not self.imitated

    @property
    def beyond(self) -> bool:
        """Whether tests require a value beyond its uncertainty, all others as in the file."""
        change = abs(self.sigmas)
        return change > SURE * self.stderr and change > BEYOND * float(np.hypot(1.0, self.stderr))

    @property
    def is_main_mistake(self) -> bool:
        """Whether it is no assumed value, and would remove much of the squared residuals."""
        return self.group.mistake and self.explained > MAIN

    @property
    def conceivable(self) -> bool:
        """Whether the tests require less than a tenfold value, which no mistake explains.

        More heat cells are in one direction, and a cause only where they take a notable share
        of the squared residuals away. So is a specimen that comes from a room: it is warmer than a
        cold chamber, or cooler than a warm one, and never the reverse.
        """
        if self.group.key == CONDITIONING and self.group.at is not None:
            room = WARMEST_ROOM if self.sigmas > 0.0 else COOLEST_ROOM
            return (room - self.group.at) * self.sigmas > 0.0
        if self.group.key == CELLS:
            return self.sigmas > 0.0 and self.explained > MUCH
        return abs(self.sigmas) * (self.group.relative or 0.0) < math.log(TENFOLD)

    @property
    def plausible(self) -> bool:
        """Whether the tests require no more than some usual errors, or what was measured."""
        limit = LARGEST_MISTAKE if self.group.mistake else LARGEST_ERROR
        return self.seen or abs(self.sigmas) <= limit

    @property
    def seen(self) -> bool:
        """Whether thermocouples begin away from the model to the same side, and not much less."""
        measured = self.group.measured
        return measured is not None and 0.0 < self.size[0] / measured <= AS_MEASURED

    @property
    def size(self) -> tuple[float, str]:
        """The change that the tests require, and its unit: that of the key, or %."""
        if self.group.absolute is not None:
            return self.sigmas * self.group.absolute, self.group.unit
        return 100.0 * float(np.expm1(self.sigmas * (self.group.relative or 0.0))), "%"

    @property
    def cause(self) -> str:
        """What else the change stands for; "" for nothing else."""
        state = "cold" if self.sigmas > 0.0 else "warm"
        return self.group.cause.replace(STATE, state)

    @property
    def surprise(self) -> float:
        """How little it is expected: the part of its usual error, and more for stronger reasons.

        A start that a thermocouple shows comes first, then the sizes that are plausible.
        """
        return abs(self.sigmas) + LAST * (not self.seen) + 2.0 * LAST * (not self.plausible)

    def suspicion(self) -> dict[str, Any]:
        """Return the content of summary.json about the group as a suspect."""
        size, unit = self.size
        return {
            "name": self.group.name,
            "key": self.group.keys[0],
            "ambient_degC": self.group.at,
            "size": size,
            "unit": unit,
            "usual_errors": abs(self.sigmas),
            "plausible": self.plausible,
            "cause": self.cause,
            "measured_K": self.group.measured,
            "explained": self.explained,
        }

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json about the group."""
        size, unit = self.size
        return {
            "name": self.group.name,
            "keys": self.group.keys,
            "relative_uncertainty": self.group.relative,
            "absolute_uncertainty": self.group.absolute,
            "unit": self.group.unit,
            "source": ", ".join(filter(None, (self.group.source, self.group.note))),
            "tests_ask_for_sigmas": self.sigmas,
            "tests_ask_for": size,
            "unit_of_that": unit,
            "stderr_of_that": self.stderr if np.isfinite(self.stderr) else None,
            "contradicted": self.contradicted,
            "imitated": self.imitated,
        }


@dataclass(frozen=True)
class Propagated:
    """Effect of the uncertainty of the assumed numbers on the identified ones."""

    evidence: tuple[Evidence, ...]  # what the tests say about each group
    shifts: Floats  # [parameter, group] of the optimum by one standard uncertainty
    spread: Floats  # [group, group] mean square of the errors of the groups, given the tests

    @property
    def groups(self) -> tuple[Group, ...]:
        """The groups, in the order of the columns."""
        return tuple(item.group for item in self.evidence)

    @property
    def enlarging(self) -> Floats:
        """The factors on the uncertainty of each group that a misfit of model and tests requires.

        At most 1 where the tests agree with the assumed values.
        """
        return np.sqrt(np.diag(self.spread))

    @property
    def widening(self) -> Floats:
        """The factors on the uncertainty of each group, for intervals and draws."""
        return np.array([group.widening for group in self.groups])

    def _covariance(self, factors: Floats | float = 1.0) -> Floats:
        """Return the covariance of the parameters; `factors` multiply the uncertainty of groups."""
        shifts = self.shifts * factors
        return np.asarray(shifts @ self.spread @ shifts.T)


@dataclass(frozen=True)
class Estimate:
    """A free parameter at the optimum, in its unit."""

    parameter: Parameter
    value: float
    stderr: float  # by the tests and the assumed values
    stderr_of_tests: float  # by the tests alone
    lower: float  # of the 95 % interval
    upper: float
    at_bound: bool
    lost: bool  # near a bound that is not an end of the law itself, as b = 0 is
    determined: bool  # by the tests, and not by a bound of the search
    well_determined: bool  # three standard errors are within 3 % of the value
    relative_error: float  # standard error over the value; infinite if not determined
    where: str  # how near to a bound it ended, or how uncertain it is, in words


@dataclass(frozen=True)
class Uncertainty:
    """Uncertainty of all free parameters."""

    estimates: dict[str, Estimate]  # by dotted key
    covariance: Floats  # in the unit cube, by the tests and the assumed values
    of_tests: Floats  # in the unit cube, by the tests alone
    widening: float  # factor on the errors by the tests, for intervals and draws
    stretching: Floats  # factor on the errors of draws of each parameter, at least 1
    correlation: Floats  # by the tests alone
    assumed: Propagated
    mistakes: tuple[Evidence, ...]  # what the tests say about each
    samples: int
    effective_samples: float  # independent samples that they are worth
    rms: float  # of the residuals, relative to the peak force
    warnings: list[str] = field(default_factory=list)
    misfit: list[str] = field(default_factory=list)  # causes of residuals that are not noise

    @property
    def of_cells(self) -> Evidence | None:
        """What the tests say about more heat cells; None where that was not computed."""
        return next((item for item in self.mistakes if item.group.key == CELLS), None)

    @property
    def suspects(self) -> list[Evidence]:
        """Possible causes of residuals that are not noise, the least surprising first.

        These remove the residuals about as well as the best of all does. Which of them is the
        cause is not known by the residuals, so that the one is first that is off by the least
        part of its usual error, after those of a plausible size those of larger sizes. A start
        temperature whose sign a thermocouple measured comes before both. None where the tests
        require no value beyond its uncertainty.
        """
        evidence = [item for item in (*self.assumed.evidence, *self.mistakes) if item.conceivable]
        clear = [item for item in evidence if abs(item.sigmas) > SURE * item.stderr]
        if self.rms <= NEGLIGIBLE or not clear:
            return []
        best = max(item.explained for item in clear)
        similar = [item for item in clear if item.explained > AS_LIKELY * best]
        if not any(item.beyond or item.is_main_mistake for item in similar):
            return []
        # No bearing has heat cells: they come first only where nothing else explains more.
        last = [item.group.key == CELLS and item.explained < best for item in similar]
        surprises = [
            item.surprise + 4.0 * LAST * is_last
            for item, is_last in zip(similar, last, strict=True)
        ]
        order = order_from_largest([-surprise for surprise in surprises])
        return [similar[k] for k in order]

    @property
    def causes(self) -> list[Evidence]:
        """The suspects in their order, of those that stand for the same cause the first."""
        return [items[0] for items in self._by_cause.values()]

    def sizes(self, cause: Evidence) -> tuple[float, float]:
        """Return the sizes of a cause: by each suspect that stands for it, the smallest first."""
        sizes = [item.size[0] for item in self._by_cause.get(_common_cause(cause), [cause])]
        return min(sizes, key=abs), max(sizes, key=abs)

    @property
    def _by_cause(self) -> dict[Any, list[Evidence]]:
        """The suspects in their order, together those that stand for the same cause."""
        by_cause: dict[Any, list[Evidence]] = {}
        for item in self.suspects:
            by_cause.setdefault(_common_cause(item), []).append(item)
        return by_cause


def _common_cause(item: Evidence) -> tuple[str, float | None, bool]:
    """Return what stands for the same cause.

    A warmer specimen and a warmer chamber than stated are one, in tests at one temperature.
    """
    key = item.group.key
    if key in (AMBIENT, CONDITIONING):
        return AMBIENT, item.group.at, item.sigmas > 0.0
    return key, None, True
