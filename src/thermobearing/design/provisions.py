"""Checks of the bearings of a bridge after codes, with the demand of the analysed motions."""

import math
import tomllib
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from textwrap import wrap
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import Field

from thermobearing.bearing.model import Bearing, CircularPlan, Plan
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.lazy import xr
from thermobearing.border.library import read_data
from thermobearing.border.schema import Strict, overridden, validated
from thermobearing.border.units import NEWTON_PER_KILONEWTON
from thermobearing.core.records import Floats
from thermobearing.design.peaks import (
    PeakRule,
    few_motions,
    mean_group,
    peaks_by_part,
    too_few_motions,
)
from thermobearing.earthquake.case import EarthquakeCase
from thermobearing.earthquake.measures import DIRECTION, DIRECTIONS
from thermobearing.earthquake.motions import Motion
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.model.axial import critical_load, find_section, overlap_area
from thermobearing.model.checks import (
    PASSED,
    TOO_FEW,
    Check,
    check_rows,
    checked_modulus,
    failed_checks,
    limit_keys,
    with_limit,
)
from thermobearing.model.limits import (
    PERCENT,
    ZONES,
    Code,
    CodeChecks,
    Limits,
    load_limits,
)
from thermobearing.quantities.warned import UNUSABLE, Warned
from thermobearing.results.ranges import Row
from thermobearing.results.writing import as_attribute, warnings_attributes

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
WIDTH = 98  # of comments in a file of limits, in letters
PLANE_DIRECTIONS = np.linspace(
    0.0, 0.5 * math.pi, 91
)  # directions of a displacement in a plane [rad]
NOT_CHECKED = "not checked, because the analysis ended as"


class _CodeCheck(Strict):
    """One check of a code; see data/design/provisions.toml."""

    key: str
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

    @property
    def of_motions(self) -> bool:
        """Whether its demand or its limit counts on the displacement in the motions."""
        if self.measure == "buckling":
            return self.displacement_factor > 0.0
        return self.measure in ("shear_strain", "total_strain", "overlap_stress")


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


_load_provisions = partial(read_data, _Codes, "design", "provisions.toml")


def load_codes(codes: Sequence[str] | str) -> list[_Code]:
    """Return codes by name, each once."""
    codes_by_name: dict[str, _Code] = {code.name: code for code in _load_provisions().codes}
    names = _as_settings(codes).codes or ()
    return [codes_by_name[name] for name in dict.fromkeys(names)]


def _as_settings(codes: Any, rotation: Any = None, zone: Any = None) -> CodeChecks:
    """Return what bearings are checked after; refuse what a case refuses too."""
    changes = {"codes": [None] if codes is None else codes, "rotation": rotation, "zone": zone}
    return validated(CodeChecks, overridden({}, changes, CodeChecks), "check_bearings()")


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
        unit_vectors = np.column_stack([np.cos(self.directions), np.sin(self.directions)])
        return float(overlap_area(self.bearing.geometry.plan, distance * unit_vectors).min())


def layer_strains(
    bearing: Bearing, axial_force: float, rotation: float, modulus: float
) -> tuple[float, float]:
    """Return the shear strains of a rubber layer under an axial force and under a rotation.

    D_a P / (A G S) and D_r L^2 theta / (t T_r), with P [kN], theta [rad], the secant modulus G
    [GPa] and the size L of the plan in the direction of motion (data/design/provisions.toml). A and
    S are those of the critical load: a single lead core in a round plan is left out.
    """
    geometry, provisions = bearing.geometry, _load_provisions()
    plan, thickness = geometry.plan, geometry.rubber_thickness
    section = find_section(geometry, bearing.lead)
    compression_ratio = axial_force / (section.area * modulus * section.shape_factor)
    rotation_ratio = plan.breadth**2 * rotation / (thickness * geometry.total_rubber_thickness)
    return provisions.compression.of(plan) * compression_ratio, provisions.rotation.of(
        plan
    ) * rotation_ratio


def _of_plan(check: _CodeCheck, demand: _Demand, bearing: Bearing) -> tuple[float, float, str]:
    """Return value, limit and unit of a check that needs the plan of the bearing."""
    displacement, plan = demand.displacement[check.level], bearing.geometry.plan
    # Under tension the checks of compression have no demand; `_uplift` compares the tension.
    force = demand.axial_force if demand.axial_force >= 0.0 else math.nan
    by_compression, by_rotation = layer_strains(bearing, force, demand.rotation, demand.modulus)
    if check.measure == "compression_strain":
        return by_compression, check.limit, "1"
    if check.measure == "total_strain":
        total = by_compression + displacement / demand.rubber + check.rotation_factor * by_rotation
        return total, check.limit, "1"
    if check.measure == "overlap_stress":
        area = demand.overlap(displacement)
        force *= NEWTON_PER_KILONEWTON
        # Without overlap the stress of any load is infinite, and of no load it is not defined.
        stress = force / area if area > 0.0 else force * math.inf
        return stress, check.limit, "MPa"
    area = demand.overlap(check.displacement_factor * displacement)
    critical = critical_load(bearing.geometry, demand.modulus, bearing.lead) * area / plan.area
    return check.load_factor * force, critical / check.reserve, "kN"


def _missing(check: _CodeCheck, demand: _Demand) -> str:
    """Return what a check without a value needs; empty under tension."""
    if math.isnan(demand.displacement[check.level]):
        return f"needs a Level {check.level} motion; "
    if math.isnan(demand.axial_force):
        return "needs the vertical load: give --axial-force; "
    return "needs the plan of the bearing; " if demand.bearing is None else ""


def _with_entered(check: _CodeCheck, code: _Code, limits: Limits | None) -> tuple[_CodeCheck, bool]:
    """Return a check with the limit that an office has entered, and whether it has."""
    limit = None if limits is None else limits.of(code.name, check.key)
    if limit is None:
        return check, False
    name = "reserve" if check.measure == "buckling" else "limit"
    return check.model_copy(update={name: limit.number, "clause": limit.describe()}), True


def _uplift(check: _CodeCheck, demand: _Demand) -> tuple[float, float, str]:
    """Return axial force, its least value and unit; the limit of a check is a tensile stress.

    Compression whose limit is not entered is returned as a stress on the plan.
    """
    # Where no tensile stress is stated, tension of any size exceeds the limit of zero, and
    # compression is not assessed.
    tension = demand.axial_force < 0.0
    if math.isnan(check.limit) and (tension or demand.bearing is None):
        return demand.axial_force, 0.0 if tension else math.nan, "kN"
    if demand.bearing is None:
        return math.nan, math.nan, "kN"
    area = demand.bearing.geometry.plan.area
    if math.isnan(check.limit):  # in the unit of the limit that an office may enter
        return NEWTON_PER_KILONEWTON * demand.axial_force / area, math.nan, "MPa"
    return demand.axial_force, -check.limit * area / NEWTON_PER_KILONEWTON, "kN"


def _checks(code: _Code, demand: _Demand, part: str, case: EarthquakeCase) -> list[Check]:
    """Return the rows of one bearing; those of other zones are left out."""
    checks = []
    for stated in code.checks:
        if case.seismic_zone not in stated.zones:
            continue
        check, entered = _with_entered(stated, code, case.limits)
        if check.measure == "shear_strain":
            displacement = demand.displacement[check.level]
            numbers = displacement / demand.rubber, check.limit, "1"
        elif check.measure == "rotation":
            numbers = demand.rotation, check.limit, "rad"
        elif check.measure == "tension":
            numbers = _uplift(check, demand)
        elif demand.bearing is None:
            numbers = math.nan, check.limit, ""
        else:
            numbers = _of_plan(check, demand, demand.bearing)
        tension = check.measure == "tension"
        properties: dict[str, Any] = {"least": tension, "of_model": tension and not entered}
        value, limit, _ = numbers
        clause = (_missing(check, demand) if math.isnan(value) else "") + check.clause
        clause += _counts_on(check, case)
        if math.isinf(value) or (check.measure == "buckling" and limit == 0.0):
            clause += "; top and bottom no longer overlap"
        checks.append(
            Check(check.what, *numbers, clause, part=part, unverified=not entered, **properties)
        )
    return checks


def _counts_on(check: _CodeCheck, case: EarthquakeCase) -> str:
    """Return the design rotation or zone that a check counts on, and whether it is the default."""
    default = " (default)"
    if check.measure in ("total_strain", "rotation"):
        marked = default * (case.rotation is None)
        return f"; design rotation {case.design_rotation:g} rad{marked}"
    if check.zones != ZONES:
        return f"; zone {case.seismic_zone}{default * (case.zone is None)}"
    return ""


def _displacements(
    data: "xr.Dataset", motions: Sequence[Motion], rule: PeakRule, runs: Any
) -> dict[int | None, Any]:
    """Return the displacements of lines by level of the motions [mm]; NaN without motions."""
    name = "bearing_displacement_max"
    if DIRECTION in data.dims:
        data = data.sel({DIRECTION: DIRECTIONS[-1]})  # the resultant of both directions
    of_all_motions = peaks_by_part(data, name, motions, rule, runs)
    by_level: dict[int | None, Any] = {None: of_all_motions}
    for level in (1, 2):
        chosen = _of_level(motions, level)
        places = [k for k, motion in enumerate(motions) if motion in chosen]
        by_level[level] = np.full_like(of_all_motions, np.nan)
        if places:
            by_level[level] = peaks_by_part(data, name, chosen, rule, runs[places])
    return by_level


@checked
def check_bearings(
    result: EarthquakeResult,
    codes: str | Sequence[Code] = ("jra",),
    *,
    rotation: float | None = None,
    zone: int | None = None,
    limits: Limits | str | Path | dict[str, Any] | None = None,
) -> EarthquakeResult:
    """Check the bearings of an analysed bridge according to design codes, without a new analysis.

    Every line of bearings is checked at every temperature, with the displacement that the rule of
    the code gives for the motions: the mean of three or more of each group (JRA), or of seven or
    more (AASHTO), otherwise the largest. Motions whose `group` begins with "level 1" are those of
    Level 1, all others of Level 2. Limits are those that an office has entered, otherwise those of
    data/design/provisions.toml: what could not be confirmed has no limit, and no limit was checked
    against the printed code.

    Parameters
    ----------
    result : of `bridge`, with an `axial_force`, without which the checks of compression and
        buckling have no demand.
    codes : codes to check the bearings after: "jra", JRA V (2017), and "aashto", AASHTO GSID
        (2014); may be empty with `limits`.
    rotation : design rotation of the bearings [rad], in [0, 0.2]; by default that of the analysis,
        or 0.
    zone : seismic zone of AASHTO, a number from 1 to 4; by default that of the analysis, or 4.
    limits : limits that an office has confirmed: a file (`thermobearing limits new` writes one) or
        a table by code and check, each with value, edition, clause and entered_by; those of the
        analysis by default.

    Returns
    -------
    EarthquakeResult : with further rows in `bearing_checks`, a table of each code, and checks in
        its report; its case states codes, rotation, zone and limits. Codes of an earlier check are
        checked again with this rotation and zone. Of an analysis that did not complete, no rows
        but a warning for each code.

    Raises
    ------
    InputError : no such code, or a number out of range.

    Examples
    --------
    >>> import thermobearing as tb
    >>> found = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", 23, duration=5, axial_force=800)
    >>> rows = tb.check_bearings(found, ["aashto"]).bearing_checks
    >>> rows["verdict"].tolist()[-4:-1]
    ['OK, with too few motions', 'OK', 'OK, with too few motions']
    """
    if isinstance(limits, str | Path):
        limits = load_limits(limits)
    elif limits is not None and not isinstance(limits, Limits):
        limits = validated(Limits, limits, "check_bearings(), limits")
    if not isinstance(result, EarthquakeResult):
        raise InputError(f"{type(result).__name__} is no result of a bridge", "check_bearings()")
    case = validated(EarthquakeCase, tomllib.loads(result.dataset.attrs["case"]), "result")
    # A mean over some of the motions would not be that of the code.
    if result.outcome == "completed" and result.table["motion"].nunique() < len(case.motions):
        raise InputError("the result has a part of its motions; give all", "check_bearings()")
    settings = _as_settings(codes, rotation, zone)
    # Rows of all codes count on one rotation and one zone, which the case states.
    update = {
        "limits": case.limits if limits is None else limits,
        "codes": tuple(dict.fromkeys((*(case.codes or ()), *(settings.codes or ())))),
        "rotation": case.rotation if settings.rotation is None else settings.rotation,
        "zone": case.zone if settings.zone is None else settings.zone,
    }
    case = case.model_copy(update=update)
    if faults := case.faults():
        raise InputError(faults, "check_bearings()")
    chosen, limits = load_codes(case.checked_codes or []), case.limits
    titles = [code.title for code in chosen]
    rows: list[Row] = [
        _limited(row, limits)
        for row in result.bearing_checks.to_dict("records")
        if row["code"] not in titles
    ]
    warnings: list[str] = [*result.stored_warnings]
    for code in chosen:
        if result.outcome == "completed":
            code_rows = _rows(result, case, code)
            starred = any(row["unverified"] and not math.isnan(row["limit"]) for row in code_rows)
            unverified = f"not checked against the published text: {code.citation}"
            code_warnings = [Warned(unverified, "unverified_code")] * starred
            code_warnings += few_motions(case.motions, code.peaks)
            code_warnings += failed_checks(code_rows)
        else:
            code_rows, code_warnings = (
                [],
                [Warned(f"{NOT_CHECKED} {result.outcome}", "not_checked", UNUSABLE)],
            )
        warnings += [
            text for message in code_warnings if (text := message.about(code.title)) not in warnings
        ]
        rows += code_rows
    attributes = {"bearing_checks": as_attribute(rows), "case": case.to_toml()}
    attributes |= warnings_attributes(warnings)
    checked = EarthquakeResult(result.dataset.assign_attrs(attributes))
    checked.compared, checked.one_component = result.compared, result.one_component
    return checked


def _limited(row: Row, limits: Limits | None) -> Row:
    """Return a row of a result, of no code, with the limit that an office has entered."""
    key = None if row["code"] else limit_keys().get(row["what"])
    limit = None if limits is None or key is None else limits.of("bearing", key)
    return row if limit is None else with_limit(dict(row), limit.number, limit.describe())


def _rows(result: EarthquakeResult, case: EarthquakeCase, code: _Code) -> list[Row]:
    """Return the rows of all bearings and temperatures."""
    device_by_line = {item.line: item.bearing for item in case.lines if item.bearing is not None}
    names, forces = [line.name for line in case.structure.bearings], case.axial_forces()
    devices = {item.name: item for item in case.bearings}
    rows: list[Row] = []
    table, data = result.table, result.dataset
    labels = [name for name in ("bearing", "ambient_degC", "mode", DIRECTION) if name in table]
    motions = dict(zip(dict.fromkeys(table["motion"]), case.motions, strict=True))
    for key, group in table.groupby(labels, sort=False):
        name, ambient, *qualifiers = map(str, key)
        # The overlap of a plan that is not square depends on the direction: of one component it is
        # x or y, of two that act together the resultant may have any.
        single_direction = PLANE_DIRECTIONS[-1:] if "y" in qualifiers else PLANE_DIRECTIONS[:1]
        directions = PLANE_DIRECTIONS if DIRECTION in data.dims else single_direction
        group_motions = [motions[motion] for motion in group["motion"]]
        displacements = _displacements(data, group_motions, code.peaks, group.index.to_numpy())
        for k, line in enumerate(names):
            device = device_by_line.get(line, devices[name])
            bearing = device if isinstance(device, Bearing) else None
            demand = _Demand(
                bearing,
                device.total_rubber_thickness,
                forces.get(line, math.nan),
                {level: float(values[k]) for level, values in displacements.items()},
                case.design_rotation,
                math.nan if bearing is None else checked_modulus(bearing, float(ambient)),
                directions,
            )
            checks = _checks(code, demand, line if len(names) > 1 else "", case)
            where = ", ".join([f"{float(ambient):g} degC", *qualifiers])
            line_rows = check_rows(where, device.name, checks, code.title)
            rows += [_qualified(row, code, group_motions) for row in line_rows]
    return rows


def _qualified(row: Row, code: _Code, motions: Sequence[Motion]) -> Row:
    """Return a row whose verdict and source say where motions are too few for the rule of a code.

    Rows without the displacement of the motions are as they were.
    """
    check = next(check for check in code.checks if check.what == row["what"])
    if not check.of_motions:
        return row
    reason = too_few_motions(_of_level(motions, check.level), code.peaks)
    if not reason or math.isnan(row["value"]):
        return row
    verdict = TOO_FEW if row["verdict"] == PASSED else row["verdict"]
    return {**row, "source": f"{row['source']}; {reason}", "verdict": verdict}


def _of_level(motions: Sequence[Motion], level: int | None) -> list[Motion]:
    """Return the motions of a level; all without one."""
    return [
        motion
        for motion in motions
        if level is None or mean_group(motion).startswith(LEVEL_1) == (level == 1)
    ]


FILE = """# Limits of checks of bearings, as this office has read them in the printed codes.
#
# To confirm a limit, read it in the code, remove the "# " before its lines, and fill in: edition,
# clause, value with its unit, and who entered it (name and date). The values below are unconfirmed:
# from memory or from other texts. Use: thermobearing bridge ... --limits FILE
"""
COMPARED = {  # by measure: what is compared with the value
    "shear_strain": "the displacement over the total rubber thickness",
    "total_strain": "the shear strain of a layer by compression, displacement and rotation",
    "compression_strain": "the shear strain of a layer by compression",
    "overlap_stress": "the axial force over the overlap of top and bottom",
    "buckling": "the critical load over the load; the value is the least ratio",
    "tension": "the tension over the plan; the value is the largest tensile stress",
    "rotation": "the design rotation",
}


def limits_text(codes: str | Sequence[str]) -> str:
    """Return a file of the limits of codes for an office to confirm: all of them as comments.

    >>> print(limits_text(["aashto"]).splitlines()[6])
    # AASHTO GSID (2014)
    """
    parts = [FILE]
    for code in load_codes(codes):
        parts.append(f"\n# {code.title}\n")
        parts += [_entry(code.name, check) for check in code.checks]
    parts.append("\n# Checks under a vertical load and in a plane, whatever the code\n")
    for name, key in limit_keys().items():
        unit = "%" if key == "local_strain" else "MPa"
        parts.append(_commented(f"bearing.{key}", name, f'"... {unit}"', "no limit is known here"))
    parts.append("\n# Checks of piers in the report, whatever the code\n")
    about = "ductility; compared: the largest rotation of the hinge over that at yield"
    parts.append(_commented("pier.ductility", about, "1.0", "first yield of the hinge"))
    return "".join(parts)


def _entry(code: str, check: _CodeCheck) -> str:
    """Return the lines of a check in a file of limits."""
    number = "..." if math.isnan(check.limit) else f"{check.limit:g}"
    if check.measure.endswith("strain"):
        number = number if number == "..." else f"{PERCENT * check.limit:g}"
        value = f'"{number} %"'
    elif check.measure == "buckling":
        value = f"{check.reserve:.1f}"
    else:
        value = f'"{number} {"rad" if check.measure == "rotation" else "MPa"}"'
    subject = f"{check.what}; compared: {COMPARED[check.measure]}"
    return _commented(f"{code}.{check.key}", subject, value, check.clause)


def _commented(table: str, subject: str, value: str, remark: str) -> str:
    """Return a limit as comments: what is compared, and the lines to be confirmed."""
    lines = [f"[{table}]", 'edition = ""', 'clause = ""', f"value = {value}", 'entered_by = ""']
    remarks = [part for line in (subject, f"unconfirmed: {remark}") for part in wrap(line, WIDTH)]
    return "\n" + "".join(f"# {line}\n" for line in (*remarks, *lines))
