"""Checks of the bearings of a bridge after codes, with the demand of the analysed motions."""

import math
import tomllib
from collections.abc import Sequence
from functools import partial
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import Field

from thermobearing.bearing.model import Bearing, CircularPlan, Plan
from thermobearing.border.errors import InputError, nearest
from thermobearing.border.lazy import xr
from thermobearing.border.library import read_data
from thermobearing.border.schema import Strict, validated
from thermobearing.border.units import NEWTON_PER_KILONEWTON, is_number, one_or_several
from thermobearing.core.records import Floats
from thermobearing.design.peaks import PeakRule, counted, few_motions, mean_group
from thermobearing.earthquake.case import EarthquakeCase
from thermobearing.earthquake.measures import DIRECTION, DIRECTIONS
from thermobearing.earthquake.motions import Motion
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.model.checks import (
    Check,
    check_rows,
    checked_modulus,
    critical_load,
    failed_checks,
    overlap_area,
)
from thermobearing.results.ranges import Row
from thermobearing.results.writing import as_attribute, from_attribute

Code = Literal["jra", "aashto"]
Measure = Literal[
    "shear_strain",
    "total_strain",
    "compression_strain",
    "overlap_stress",
    "buckling",
    "tension",
    "rotation",
]
LEVEL_1 = "level 1"  # begins the groups of motions of Level 1
LARGEST_ROTATION, ZONES = 0.2, (1, 2, 3, 4)  # [rad]; of AASHTO
ALL_WAYS = np.linspace(0.0, 0.5 * math.pi, 91)  # directions of a displacement in a plane [rad]


class _CodeCheck(Strict):
    """One check of a code; see data/design/provisions.toml."""

    what: str
    measure: Measure
    clause: str
    level: Literal[1, 2] | None = None
    limit: float = math.nan
    load_factor: float = 1.0
    displacement_factor: float = 1.0
    rotation_factor: float = 1.0
    reserve: float = 1.0
    zones: tuple[int, ...] = ZONES


class _Code(Strict):
    """A code and its checks; `peaks` is its rule for several motions."""

    name: Code
    title: str
    citation: str
    peaks: PeakRule
    checks: Annotated[list[_CodeCheck], Field(min_length=1)]


class _Share(Strict):
    """Factor of the shear strain of a layer by the shape of the plan."""

    round: float
    rectangular: float
    source: str
    unverified: bool

    def of(self, plan: Plan) -> float:
        """Return the factor of a plan."""
        return self.round if isinstance(plan, CircularPlan) else self.rectangular


class _Codes(Strict):
    """Content of data/design/provisions.toml."""

    compression: _Share
    rotation: _Share
    codes: list[_Code]


_known = partial(read_data, _Codes, "design", "provisions.toml")


def load_codes(codes: Sequence[str], rotation: float = 0.0, zone: int = 4) -> list[_Code]:
    """Return codes by name; refuse other arguments that `check_bearings` does."""
    known: dict[str, _Code] = {code.name: code for code in _known().codes}
    names = [str(name) for name in one_or_several(codes) or [""]]
    faults = [
        f'codes: "{name}" must be "jra" or "aashto"{nearest(name, known)}'
        for name in names
        if name not in known
    ]
    if not (is_number(rotation) and 0.0 <= rotation <= LARGEST_ROTATION):
        faults.append(f"rotation = {rotation!r}: must be 0 to {LARGEST_ROTATION:g} rad")
    if isinstance(zone, bool) or zone not in ZONES:
        faults.append(f"zone = {zone!r}: must be 1, 2, 3 or 4")
    if faults:
        raise InputError(faults, "check_bearings()")
    return [known[name] for name in dict.fromkeys(names)]


class _Demand(NamedTuple):
    """Demand on one bearing; NaN where it is not known."""

    bearing: Bearing | None  # None for one of which the plan is not known
    rubber: float  # total rubber thickness [mm]
    axial_force: float  # [kN]
    displacement: dict[int | None, float]  # by level of the motions; None: of all [mm]
    rotation: float  # [rad]
    modulus: float  # secant modulus of the rubber [GPa]
    directions: Floats  # that the displacement may have, from the length of the plan [rad]

    def overlap(self, distance: float) -> float:
        """Return the overlap area of top and bottom at a displacement [mm2]."""
        assert self.bearing is not None
        ways = np.column_stack([np.cos(self.directions), np.sin(self.directions)])
        return float(overlap_area(self.bearing.geometry.plan, distance * ways).min())


def layer_strains(
    bearing: Bearing, axial_force: float, rotation: float, modulus: float
) -> tuple[float, float]:
    """Return the shear strains of a rubber layer under an axial force and under a rotation.

    D_a P / (A G S) and D_r L^2 theta / (t T_r), with P [kN], theta [rad], the secant modulus G
    [GPa] and the size L of the plan in the direction of motion (data/design/provisions.toml).
    """
    geometry, known = bearing.geometry, _known()
    plan, thickness = geometry.plan, geometry.rubber_thickness
    pressed = axial_force / (plan.area * modulus * geometry.first_shape_factor)
    turned = plan.breadth**2 * rotation / (thickness * geometry.total_rubber_thickness)
    return known.compression.of(plan) * pressed, known.rotation.of(plan) * turned


def _of_plan(check: _CodeCheck, demand: _Demand, bearing: Bearing) -> tuple[float, float, str]:
    """Return value, limit and unit of a check that needs the plan of the bearing."""
    moved, plan = demand.displacement[check.level], bearing.geometry.plan
    force = demand.axial_force if demand.axial_force >= 0.0 else math.nan
    pressed, turned = layer_strains(bearing, force, demand.rotation, demand.modulus)
    if check.measure == "compression_strain":
        return pressed, check.limit, "1"
    if check.measure == "total_strain":
        total = pressed + moved / demand.rubber + check.rotation_factor * turned
        return total, check.limit, "1"
    if check.measure == "overlap_stress":
        area = demand.overlap(moved)
        force *= NEWTON_PER_KILONEWTON
        return (force / area if area > 0.0 else force * math.inf), check.limit, "MPa"
    area = demand.overlap(check.displacement_factor * moved)
    critical = critical_load(bearing.geometry, demand.modulus) * area / plan.area
    return check.load_factor * force, critical / check.reserve, "kN"


def _missing(check: _CodeCheck, demand: _Demand) -> str:
    """Return what a check without a value needs; empty under tension."""
    if math.isnan(demand.displacement[check.level]):
        return f"needs a Level {check.level} motion; "
    if math.isnan(demand.axial_force):
        return "needs the vertical load: give --axial-force; "
    return "needs the plan of the bearing; " if demand.bearing is None else ""


def _checks(code: _Code, demand: _Demand, part: str, zone: int) -> list[Check]:
    """Return the rows of one bearing; those of other zones are left out."""
    found = []
    for check in (one for one in code.checks if zone in one.zones):
        if check.measure == "shear_strain":
            moved = demand.displacement[check.level]
            numbers = moved / demand.rubber, check.limit, "1"
        elif check.measure == "rotation":
            numbers = demand.rotation, check.limit, "rad"
        elif check.measure == "tension":
            numbers = demand.axial_force, 0.0 if demand.axial_force < 0.0 else math.nan, "kN"
        elif demand.bearing is None:
            numbers = math.nan, check.limit, ""
        else:
            numbers = _of_plan(check, demand, demand.bearing)
        tension = check.measure == "tension"
        about: dict[str, Any] = {"least": tension, "of_model": tension, "part": part}
        value, limit, _ = numbers
        clause = (_missing(check, demand) if math.isnan(value) else "") + check.clause
        if math.isinf(value) or (check.measure == "buckling" and limit == 0.0):
            clause += "; top and bottom no longer overlap"
        found.append(Check(check.what, *numbers, clause, unverified=True, **about))
    return found


def _displacements(
    data: "xr.Dataset", motions: Sequence[Motion], rule: PeakRule, runs: Any
) -> dict[int | None, Any]:
    """Return the displacements of lines by level of the motions [mm]; NaN without motions."""
    name = "bearing_displacement_max"
    if DIRECTION in data.dims:
        data = data.sel({DIRECTION: DIRECTIONS[-1]})
    every = counted(data, name, motions, rule, runs)
    found: dict[int | None, Any] = {None: every}
    for level in (1, 2):
        lower = [mean_group(motion).startswith(LEVEL_1) for motion in motions]
        mine = [k for k, first in enumerate(lower) if first == (level == 1)]
        chosen = [motions[k] for k in mine]
        found[level] = np.full_like(every, np.nan)
        if mine:
            found[level] = counted(data, name, chosen, rule, runs[mine])
    return found


def check_bearings(
    result: EarthquakeResult,
    codes: Sequence[Code] = ("jra",),
    *,
    rotation: float = 0.0,
    zone: int = 4,
) -> EarthquakeResult:
    """Check the bearings of an analysed bridge according to design codes, without a new analysis.

    Every line of bearings is checked at every temperature, with the displacement that the rule of
    the code gives for the motions: the mean of three or more of each group (JRA), or of seven or
    more (AASHTO), otherwise the largest. Motions whose `group` begins with "level 1" are those of
    Level 1, all others of Level 2. Limits are those of data/design/provisions.toml: what could not
    be confirmed has no limit, and no limit was checked against the printed code.

    Parameters
    ----------
    result : of `bridge`, with an `axial_force`, without which the checks of compression and
        buckling have no demand.
    codes : of "jra", JRA V (2017), and "aashto", AASHTO GSID (2014).
    rotation : design rotation of the bearings [rad], in [0, 0.2].
    zone : seismic zone of AASHTO, a number from 1 to 4.

    Returns
    -------
    EarthquakeResult : with further rows in `bearing_checks`, a table of each code, and checks in
        its report. Of an analysis that did not complete, no rows but a warning for each code.

    Raises
    ------
    InputError : no such code, or a number out of range.

    Examples
    --------
    >>> import thermobearing as tb
    >>> found = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", 23, duration=5, axial_force=800)
    >>> rows = tb.check_bearings(found, ["aashto"]).bearing_checks
    >>> rows["verdict"].tolist()[-5:]
    ['limit not available', 'OK', 'OK', 'OK', 'limit not available']
    """
    chosen = load_codes(codes, rotation, zone)
    if not isinstance(result, EarthquakeResult):
        raise InputError(f"{type(result).__name__} is no result of a bridge", "check_bearings()")
    case = validated(EarthquakeCase, tomllib.loads(result.dataset.attrs["case"]), "result")
    if result.outcome == "completed" and result.table["motion"].nunique() < len(case.motions):
        raise InputError("the result has a part of its motions; give all", "check_bearings()")
    titles = [code.title for code in chosen]
    rows: list[Row] = [
        row for row in result.bearing_checks.to_dict("records") if row["code"] not in titles
    ]
    said = list(from_attribute(result.dataset, "warnings"))
    for code in chosen:
        if result.outcome == "completed":
            found = _rows(result, case, code, rotation, zone)
            more = [f"not checked against the published text: {code.citation}"]
            more += few_motions(case.motions, code.peaks) + failed_checks(found)
        else:
            found, more = [], [f"not checked, because the analysis ended as {result.outcome}"]
        said += [text for one in more if (text := f"{code.title}: {one}") not in said]
        rows += found
    attributes = {"bearing_checks": as_attribute(rows), "warnings": as_attribute(said)}
    checked = EarthquakeResult(result.dataset.assign_attrs(attributes))
    checked.compared, checked.one_component = result.compared, result.one_component
    return checked


def _rows(
    result: EarthquakeResult, case: EarthquakeCase, code: _Code, rotation: float, zone: int
) -> list[Row]:
    """Return the rows of all bearings and temperatures."""
    own = {item.line: item.bearing for item in case.lines if item.bearing is not None}
    names, forces = [line.name for line in case.structure.bearings], case.axial_forces()
    devices, found = {one.name: one for one in case.bearings}, []
    table, data = result.table, result.dataset
    labels = [name for name in ("bearing", "ambient_degC", "mode", DIRECTION) if name in table]
    motions = dict(zip(dict.fromkeys(table["motion"]), case.motions, strict=True))
    for key, mine in table.groupby(labels, sort=False):
        name, ambient, *others = map(str, key)
        alone = ALL_WAYS[-1:] if "y" in others else ALL_WAYS[:1]
        directions = ALL_WAYS if DIRECTION in data.dims else alone
        shaken = [motions[motion] for motion in mine["motion"]]
        moved = _displacements(data, shaken, code.peaks, mine.index.to_numpy())
        for k, line in enumerate(names):
            device = own.get(line, devices[name])
            bearing = device if isinstance(device, Bearing) else None
            demand = _Demand(
                bearing,
                device.total_rubber_thickness,
                forces.get(line, math.nan),
                {level: float(values[k]) for level, values in moved.items()},
                rotation,
                math.nan if bearing is None else checked_modulus(bearing, float(ambient)),
                directions,
            )
            checks = _checks(code, demand, line if len(names) > 1 else "", zone)
            where = ", ".join([f"{float(ambient):g} degC", *others])
            found += check_rows(where, device.name, checks, code.title)
    return found
