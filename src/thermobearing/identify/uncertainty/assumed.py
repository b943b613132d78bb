"""Values that a fit takes from the bearing's file, and their uncertainty.

Each number that is not identified has a standard uncertainty (data/identify/assumed.toml). The
columns of derivatives by them carry it into the identified ones (covariance.py), and show when the
tests ask for another value than the file has.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from pydantic import Field, model_validator

from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, nearest
from thermobearing.border.library import data_path
from thermobearing.border.schema import Strict, validated
from thermobearing.border.toml import read_toml
from thermobearing.core.records import Floats
from thermobearing.identify.fit import parameters as kinds
from thermobearing.identify.fit.problem import Linear, Problem
from thermobearing.identify.records.cycles import dead_band, estimate_noise, turning_points
from thermobearing.identify.records.record import TestRecord

PART = 0.25  # of a standard uncertainty: the step of a derivative
LARGEST_SPREAD = 2.0  # relative standard uncertainty
SURE, BEYOND = 5.0, 3.0  # standard errors of the tests, of tests and source together
CLEAR = 2.0  # standard errors between a determined number and its bounds
NORMAL = 10**6  # degrees of freedom with which Student's distribution is the normal one
AMBIENT = "ambient"
OF_TESTS = (AMBIENT, "turns", "force")  # keys of the tests, not of the bearing
UNSEEN = 1e-3  # of the variance: numbers that move the residuals less are not seen by the tests


class Group(Strict):
    """Numbers of a bearing with one uncertainty: they are off together."""

    name: str  # or the symbol of a parameter
    keys: list[str]  # dotted keys of a bearing
    relative: float | None = None  # standard uncertainty over the value, or
    absolute: float | None = None  # in the unit of the key
    source: str
    note: str = ""
    unit: str = ""  # of `absolute`; empty where the key says it
    # Degrees of freedom (JCGM 100:2008, G.4.2): how well the uncertainty itself is known.
    freedom: float = Field(default=NORMAL, gt=0.0)
    cause: str = ""  # what else makes tests ask for another value

    @model_validator(mode="after")
    def _one_uncertainty(self) -> "Group":
        if (self.relative is None) == (self.absolute is None):
            raise ValueError("needs relative or absolute, one of them")
        return self

    def step(self, value: float) -> float:
        """Return the standard uncertainty of a value, in its unit."""
        return self.absolute if self.absolute is not None else (self.relative or 0.0) * abs(value)


class Groups(Strict):
    """Content of data/identify/assumed.toml."""

    groups: list[Group]


@cache
def usual_groups() -> tuple[Group, ...]:
    """Return the uncertainties that the package comes with."""
    path = data_path("identify", "assumed.toml")
    return tuple(validated(Groups, read_toml(path), str(path)).groups)


def chosen_groups(given: Mapping[str, float] | None) -> tuple[Group, ...]:
    """Return the default uncertainties, some of them replaced.

    `given` holds relative standard uncertainties in [0, 2] by the name of a group or a key of one;
    that of "ambient" is in K.
    """
    groups = list(usual_groups())
    for name, value in (given or {}).items():
        places = [i for i, g in enumerate(groups) if name == g.name or name in g.keys]
        if not places:
            known = [word for group in groups for word in (group.name, *group.keys)]
            raise InputError(f'assumed: nothing is called "{name}"{nearest(name, known)}')
        number = isinstance(value, int | float) and not isinstance(value, bool)
        if not (number and 0.0 <= value <= LARGEST_SPREAD):
            raise InputError(
                f"assumed: {name} = {value!r} must be a relative standard uncertainty, "
                f"0 to {LARGEST_SPREAD:g}"
            )
        which = "absolute" if groups[places[0]].keys == [AMBIENT] else "relative"
        change: dict[str, Any] = {"relative": None, "absolute": None, which: float(value)}
        change |= {"source": "given", "note": ""}
        groups[places[0]] = groups[places[0]].model_copy(update=change)
    return tuple(groups)


@dataclass(frozen=True)
class Assumed:
    """What a fit does not identify."""

    groups: tuple[Group, ...]  # of the bearing, not free and not known exactly
    columns: Floats  # [residual, group] change by one standard uncertainty


def shifted(bearing: Bearing, group: Group, sigmas: float) -> Bearing:
    """Return a bearing whose numbers of a group are off by so many standard uncertainties."""
    values = {key: kinds.dotted_value(bearing, key) for key in group.keys}
    known = {key: value for key, value in values.items() if value is not None}
    return kinds.with_values(
        bearing, {key: round(v + sigmas * group.step(v), 12) for key, v in known.items()}
    )


def _assumed_groups(
    bearing: Bearing, identified: Sequence[str], groups: Sequence[Group]
) -> list[Group]:
    """Return the groups that a fit of a bearing assumes.

    Those that are identified (dotted keys, free or tied), known exactly, zero or without effect are
    left out.
    """
    linear = bearing.hysteresis.post_yield_ratio == 1.0
    found = []
    for group in groups:
        keys = [key for key in group.keys if key not in identified]
        if linear:
            keys = [key for key in keys if key not in kinds.OF_YIELDING]
        values = [kinds.dotted_value(bearing, key) for key in keys]
        if any(value is not None and group.step(value) > 0.0 for value in values):
            found.append(group.model_copy(update={"keys": keys}))
    return found


def linearise_assumed(
    problem: Problem, cube: Floats, groups: Sequence[Group], *, fine: bool = True
) -> Assumed:
    """Return the assumed numbers of a fit and the derivatives of its residuals by them."""
    identified = [p.kind.key for p in problem.pset.parameters if p.free or p.tie is not None]
    bearing = problem.pset.bearing(cube)
    here = np.concatenate(problem.parts(cube, fine=fine))
    kept, columns = [], []

    def _add(group: Group, bearing: Bearing, records: Sequence[TestRecord], part: float) -> None:
        moved = problem.split_parts(bearing, records, fine=fine)
        column = np.zeros(0) if moved is None else (np.concatenate(moved) - here) / part
        if column.any():
            kept.append(group)
            columns.append(column)

    for group in _assumed_groups(bearing, identified, groups):
        _add(group, shifted(bearing, group, PART), problem.records, PART)
    for group, records in _other_tests(problem.records, groups):
        _add(group, bearing, records, 1.0)
    shape = (len(here), len(kept))
    return Assumed(tuple(kept), np.array(columns).T if columns else np.zeros(shape))


def _other_tests(
    records: Sequence[TestRecord], groups: Sequence[Group]
) -> Iterator[tuple[Group, list[TestRecord]]]:
    """Yield the tests, off by one standard uncertainty of each thing that shifts a whole test.

    Tests at the same temperature share its error: they had one chamber and thermometer.
    """
    if not groups:  # everything is known exactly
        return
    by_key = {group.keys[0]: group for group in groups}
    air, turns, scale = (by_key[key] for key in OF_TESTS)
    known = [record.ambient_uncertainty for record in records]
    steps = [air.step(0.0) if u is None else u for u in known]
    for ambient in dict.fromkeys(record.ambient for record in records):
        off = [u if r.ambient == ambient else 0.0 for r, u in zip(records, steps, strict=True)]
        update = {"name": f"{air.name} of {ambient:.4g} degC", "absolute": max(off)}
        warmer = [replace(r, ambient=r.ambient + u) for r, u in zip(records, off, strict=True)]
        yield air.model_copy(update=update), warmer
    shorter = []  # their turns less far out, by the uncertainty from the noise
    for record in records:
        x, less = record.displacement, record.displacement.copy()
        at = turning_points(x, dead_band(x))[1:-1]
        less[at] -= turns.step(estimate_noise(x)) * np.sign(x[at] - x[at - 1])
        shorter.append(replace(record, displacement=less))
    yield turns, shorter
    yield scale, [replace(r, force=(1.0 + scale.step(1.0)) * r.force) for r in records]


@dataclass(frozen=True)
class Evidence:
    """What the tests say about one group, the others as in the file."""

    group: Group
    sigmas: float  # wanted change of the file's values, in standard uncertainties
    stderr: float  # of `sigmas`, by the tests
    explained: float  # share of the squared residuals that this would remove, in [0, 1]

    @property
    def contradicted(self) -> bool:
        """Whether the tests are sure that the file's values are beyond their uncertainty."""
        off = abs(self.sigmas)
        return off > SURE * self.stderr and off > BEYOND * float(np.hypot(1.0, self.stderr))

    def summary(self) -> dict[str, Any]:
        """Return what summary.json says of the group."""
        return {
            "name": self.group.name,
            "keys": self.group.keys,
            "relative_uncertainty": self.group.relative,
            "absolute_uncertainty": self.group.absolute,
            "unit": self.group.unit,
            "source": ", ".join(filter(None, (self.group.source, self.group.note))),
            "tests_ask_for_sigmas": self.sigmas,
            "stderr_of_that": self.stderr if np.isfinite(self.stderr) else None,
            "contradicted": self.contradicted,
        }


@dataclass(frozen=True)
class Propagated:
    """Effect of the uncertainty of the assumed numbers on the identified ones."""

    evidence: tuple[Evidence, ...]  # what the tests say about each group
    shifts: Floats  # [parameter inside, group] of the optimum by one standard uncertainty
    spread: Floats  # [group, group] mean square of the errors of the groups, given the tests

    def covariance(self, factors: Floats | float = 1.0) -> Floats:
        """Return the covariance of the parameters inside by the assumed numbers, in the unit cube.

        `factors` multiply the uncertainty of each group.
        """
        shifts = self.shifts * factors
        return np.asarray(shifts @ self.spread @ shifts.T)


def propagate(linear: Linear, assumed: Assumed) -> Propagated:
    """Carry the uncertainty of what is assumed into what is identified.

    The optimum moves by -(J^T J)^-1 J^T c for a column c (a "consider" analysis; Schmidt 1966).
    How far the groups may be off is what their sources leave open given the tests: with the
    information H of the tests and b = H times what they ask for, the posterior of a normal prior
    has the covariance P = (1 + H)^-1 and the mean P b. The fit stays at the file's values, so that
    it is off by both.
    """
    columns = linear.weights[:, None] * assumed.columns
    shifts = -linear.solved(columns)
    apart = columns + linear.jacobian @ shifts  # what no change of the parameters can imitate
    evidence = [_weigh(linear, group, apart[:, i]) for i, group in enumerate(assumed.groups)]
    inner = apart.T @ apart
    wanted = -np.linalg.pinv(inner, rcond=1e-10, hermitian=True) @ (apart.T @ linear.residuals)
    left_over = linear.residuals + apart @ wanted
    meat = linear.meat(apart, left_over) + np.diag(np.diag(inner)) * np.mean(left_over**2)
    against = np.linalg.pinv(meat, rcond=1e-10, hermitian=True)
    # By eigenvalues: exact tests know nearly everything, and an inverse would not stay positive.
    known, axes = np.linalg.eigh(inner @ against @ inner)
    known = np.maximum(known, 0.0)
    posterior = (axes / (1.0 + known)) @ axes.T
    mean = axes @ (known / (1.0 + known) * (axes.T @ wanted))
    return Propagated(tuple(evidence), shifts, posterior + np.outer(mean, mean))


def _weigh(linear: Linear, group: Group, column: Floats) -> Evidence:
    """Return what the tests say about a group, by its column less what parameters can imitate."""
    residuals = linear.residuals
    norm = float(column @ column)
    if norm <= UNSEEN * max(linear.variance, 1e-300):
        return Evidence(group, 0.0, float("inf"), 0.0)
    sigmas = -float(column @ residuals) / norm
    left_over = residuals + sigmas * column  # or the error of the file would be taken for noise
    meat = float(linear.meat(column[:, None], left_over)[0, 0])
    least = norm * float(left_over @ left_over) / len(left_over)
    explained = sigmas**2 * norm / max(float(residuals @ residuals), 1e-300)
    return Evidence(group, sigmas, float(np.sqrt(max(meat, least))) / norm, explained)
