"""Checks of bearings: one row for each limit, of the lead and under a vertical load.

The vertical load is an input; without `axial` it changes neither force nor heat of a bearing.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from thermobearing.bearing.model import Bearing, CircularPlan, Geometry
from thermobearing.border.library import data_path
from thermobearing.border.toml import read_toml
from thermobearing.border.units import NEWTON_PER_KILONEWTON
from thermobearing.core.records import Floats
from thermobearing.model.axial import (
    AxialPeak,
    compression_constants,
    critical_load,
    overlap_area,
    second_moments,
    shear_modulus,
)
from thermobearing.model.element import BearingElement
from thermobearing.model.outcomes import temperature_limits
from thermobearing.quantities.governing import largest_by, place_of_largest, place_of_least
from thermobearing.quantities.validity import FAILED, NOT_MODELLED
from thermobearing.quantities.warned import EXCEEDED, UNTESTED, Warned

PASSED = "OK"
NO_LIMIT, NO_VALUE = "limit not available", "demand not available"
TOO_FEW = "OK, with too few motions"
STEPS, STEP = 200, 0.005  # of the loading to 100 % shear strain: number and length [s]


@dataclass(frozen=True)
class Check:
    """One line of a calculation sheet.

    `least` says whether the limit is a lower one, `part` which line, group of lines or pier it is
    about (empty where there is one), `unverified` that no printed source was read for the limit,
    `of_model` that the limit is one of the model and not of a code. A NaN limit is not available.
    """

    what: str
    value: float
    limit: float
    unit: str
    source: str
    least: bool = False
    part: str = ""
    unverified: bool = False
    of_model: bool = False

    @property
    def used(self) -> float:
        """Return the share of the limit that is used; above 1 it is exceeded."""
        above, below = (self.limit, self.value) if self.least else (self.value, self.limit)
        return math.inf if below <= 0.0 else above / below

    @property
    def passed(self) -> bool:
        """Whether the value keeps the limit."""
        return self.value >= self.limit if self.least else self.value <= self.limit

    @property
    def verdict(self) -> str:
        """OK or NG; or that there is no value, no limit, or no model for the value."""
        if math.isnan(self.value) or math.isnan(self.limit):
            return NO_VALUE if math.isnan(self.value) else NO_LIMIT
        if self.passed:
            return PASSED
        return NOT_MODELLED if self.of_model else FAILED


def check_rows(
    run: str, bearing: str, checks: Iterable[Check], code: str = ""
) -> list[dict[str, Any]]:
    """Return checks of a run as rows, each with its verdict and the used share of its limit.

    `code` is that which the limits are of, if any.
    """
    first = {"run": run, "bearing": bearing, "code": code}
    return [
        first | asdict(check) | {"used": check.used, "verdict": check.verdict} for check in checks
    ]


def failed_checks(rows: Sequence[dict[str, Any]]) -> list[Warned]:
    """Return a sentence for each check that runs fail, or that the model does not cover."""
    # One sentence for all runs that fail the same check, with the worst of them.
    failures: dict[tuple[str, str, str], list[dict[str, Any]]] = {}
    for row in rows:
        if row["verdict"] in (FAILED, NOT_MODELLED):
            failures.setdefault((row["bearing"], row["part"], row["what"]), []).append(row)
    sentences = []
    for (bearing, part, quantity), failed_rows in failures.items():
        worst = largest_by(failed_rows, lambda row: float(row["used"]))
        unit = f" {worst['unit']}".removesuffix(" 1")
        limit = f"the limit is {worst['limit']:.3g}{unit}"
        reason = worst["source"] if worst["verdict"] == NOT_MODELLED else limit
        bearing_and_part = f"{bearing}, {part}" if part else bearing
        where = f"in {worst['run']}"
        if len(failed_rows) > 1:
            where = f"in {len(failed_rows)} runs; largest {where}"
        sentences.append(
            Warned(
                f"{quantity} {worst['value']:.3g}{unit}; {reason} ({where})",
                f"check.{quantity}",
                UNTESTED if worst["verdict"] == NOT_MODELLED else EXCEEDED,
                bearing_and_part,
            )
        )
    return sentences


def lead_check_rows(
    run: str, bearing: str, hottest: float, *, melted: bool = False
) -> list[dict[str, Any]]:
    """Return the rows of the warmest lead [degC] of a run: melting, and a share of it.

    A run that ended because its lead melted (`melted`) has reached the melting temperature.
    """
    limits, table = temperature_limits(), read_toml(data_path("materials", "limits.toml"))
    melting, share = limits.lead_melts, limits.lead_near_melting
    value = melting if melted else hottest
    sources = [str(table[name]["source"]) for name in ("lead_melts", "lead_near_melting")]
    rows = check_rows(
        run,
        bearing,
        [
            Check("lead: melting", value, melting, "degC", sources[0]),
            Check(f"lead: {share:g} of melting", value, share * melting, "degC", sources[1]),
        ],
    )
    # At the melting temperature itself the value equals its limit, which counts as kept.
    rows[0]["verdict"] = FAILED if melted else rows[0]["verdict"]
    return rows


def twisted_strain(geometry: Geometry, displacement: Floats, force: Floats) -> Floats:
    r"""Return the estimated largest shear strain in the plan of a bearing whose layers twist.

    .. math::
        \theta' = \frac{x F_\perp}{2 G J}, \quad G = \frac{F H}{A x}

    The force F of the bearing has a part across the displacement x, and with it a couple about the
    vertical that the ends, which do not turn, balance in halves. Next to them the layers twist by
    theta' for each height of rubber, which adds to the strain x/H; G is the secant modulus, J the
    polar second moment of area, H the total rubber thickness. The strain is largest at the rim, in
    a rectangle at a corner. `displacement` [mm] and `force` [kN] are pairs [..., 2]; x is along the
    `length` of a rectangle. A lead core counts as rubber.

    >>> geometry = Geometry(
    ...     plan={"shape": "circular", "diameter": 400}, rubber_layers=10, rubber_thickness=10,
    ...     shim_thickness=3, end_plate_thickness=20,
    ... )
    >>> twisted_strain(geometry, np.array([[100.0, 0.0]]), np.array([[0.0, 50.0]])).tolist()
    [1.5]
    """
    moved, push = np.asarray(displacement, dtype=float), np.asarray(force, dtype=float)
    plan, height = geometry.plan, geometry.total_rubber_thickness
    distance, resultant = np.hypot(*moved.T).T, np.hypot(*push.T).T
    couple = moved[..., 0] * push[..., 1] - moved[..., 1] * push[..., 0]
    across = np.divide(
        couple, distance * resultant, out=np.zeros_like(distance), where=distance * resultant > 0.0
    )
    # With G = F H/(A x) the force cancels: what is left of the couple is its direction.
    polar = sum(second_moments(plan))
    twist = across * distance**2 * plan.area / (2.0 * height * polar)
    strain = moved / height
    if isinstance(plan, CircularPlan):
        return np.asarray(distance / height + np.abs(twist) * 0.5 * plan.diameter)
    # The rim is farthest from the axis at the corners of a rectangle.
    half_length, half_width = (0.5 * side for side in plan._sides())
    corners = [
        np.hypot(strain[..., 0] - twist * y, strain[..., 1] + twist * x)
        for x in (-half_length, half_length)
        for y in (-half_width, half_width)
    ]
    return np.asarray(np.max(corners, axis=0))


TWISTED = "estimated local strain"


def limit_keys() -> dict[str, str]:
    """Return the keys of a file of limits of checks that have none here, by what they check."""
    constants = compression_constants()["checks"]
    return {constants[key]["what"]: key for key in ("stress", "overlap_stress")} | {
        TWISTED: "local_strain"
    }


def with_limit(row: dict[str, Any], limit: float, source: str) -> dict[str, Any]:
    """Return a row of `check_rows` with another limit, in its unit, and where that is from."""
    names = ("what", "value", "unit", "least", "part", "of_model")
    check = Check(**{name: row[name] for name in names}, limit=limit, source=source)
    more = asdict(check) | {"used": check.used, "verdict": check.verdict}
    return {name: more.get(name, value) for name, value in row.items()}


def twist_check(geometry: Geometry, displacement: Floats, force: Floats, part: str = "") -> Check:
    """Return the largest `twisted_strain` of a motion in a plane, which has no limit, as a check.

    `part` is a bearing line, where there are several.
    """
    local = twisted_strain(geometry, displacement, force)
    place = place_of_largest(local)
    nominal = float(np.hypot(*displacement[place])) / geometry.total_rubber_thickness
    ratio = float(local[place]) / nominal if nominal > 0.0 else 1.0
    source = f"twist of the layers, {ratio:.2f} times the nominal strain of {nominal:.0%}"
    return Check(TWISTED, float(local[place]), math.nan, "1", source, part=part)


def secant_stiffness(element: BearingElement, height: float) -> float:
    """Return the secant stiffness of rubber at 100 % strain in the first loading [kN/mm].

    `height` is the total rubber thickness [mm] of the bearing, which starts where it is.
    """
    begin = float(element.state.response["displacement"][0])
    # By steps as in a test: the hysteretic variable depends on the way.
    for x in np.linspace(begin, begin + height, STEPS + 1)[1:]:
        element.set_trial(float(x), dt=STEP)
        element.commit()
    return float(element.state.response["rubber_force"][0]) / height


def secant_modulus(bearing: Bearing, temperature: float) -> float:
    """Return the secant modulus of scragged rubber at 100 % strain and a temperature [GPa]."""
    height = bearing.total_rubber_thickness
    element = BearingElement(bearing.model_copy(update={"scragging": None}), temperature)
    return shear_modulus(bearing, secant_stiffness(element, height))


def checked_modulus(bearing: Bearing, ambient: float) -> float:
    """Return the secant modulus that checks count on at an ambient temperature [degC, GPa].

    That of the reference temperature in the cold, where the rubber is stiffer.
    """
    return secant_modulus(bearing, max(ambient, bearing.hysteresis.reference_temperature))


def vertical_checks(
    bearing: Bearing | None,
    axial_force: float,
    displacement: Floats,
    temperature: float,
    part: str = "",
) -> list[Check]:
    """Return the checks of a bearing under a vertical load [kN] along its way [mm].

    They are the compressive stress on the plan and on the smallest overlap of top and bottom, whose
    limits are not available, and the axial force compared with the critical load without
    displacement and with the reduced area. The shear modulus is that of scragged rubber at 100 %
    strain at the ambient `temperature` [degC], at least at the reference temperature of the rubber.
    Tension is outside the model: the only row then says so. There are no rows for a bearing of
    unknown plan (None), such as a bilinear one. `part` is a bearing line, where there are several.
    """
    table = compression_constants()["checks"]
    if axial_force < 0.0:
        row = table["tension"]
        options: dict[str, Any] = {"least": True, "part": part, "of_model": True}
        return [Check(row["what"], axial_force, 0.0, "kN", row["source"], **options)]
    if bearing is None:
        return []
    plan = bearing.geometry.plan
    areas = overlap_area(plan, displacement)
    least = float(areas[place_of_least(areas)])
    # Without an overlap, the farthest of all displacements without one.
    moved = np.linalg.norm(np.reshape(displacement, (len(areas), -1)), axis=1)
    travel = float(np.max(moved[areas <= least], initial=0.0))
    degrees = max(temperature, bearing.hysteresis.reference_temperature)
    modulus = checked_modulus(bearing, temperature)
    critical = critical_load(bearing.geometry, modulus, bearing.lead)
    conditions = {"modulus": f"{NEWTON_PER_KILONEWTON * modulus:.3g} MPa at {degrees:g} degC"}
    conditions["overlap"] = f"{100.0 * least / plan.area:.0f} % at {travel:.0f} mm"

    def _row(name: str, value: float, limit: float, unit: str) -> Check:
        entry = table[name]
        source, unverified = entry["source"].format(**conditions), bool(entry.get("unverified"))
        return Check(entry["what"], value, limit, unit, source, part=part, unverified=unverified)

    force = axial_force * NEWTON_PER_KILONEWTON
    on_overlap = force / least if least > 0.0 else math.inf
    return [
        _row("stress", force / plan.area, math.nan, "MPa"),
        _row("overlap_stress", on_overlap, math.nan, "MPa"),
        _row("critical", axial_force, critical, "kN"),
        _row("reduced", axial_force, critical * least / plan.area, "kN"),
    ]


def axial_checks(peaks: Mapping[str, AxialPeak], part: str = "") -> list[Check]:
    """Return the checks of an axial force that acted in an analysis.

    `peaks` are its largest shares of the critical load, "analysis", and of the tension at which the
    rubber cavitates, "cavitation". `part` is a bearing line, where there are several.
    """
    table = compression_constants()["checks"]
    return [
        Check(
            table[name]["what"],
            peak.force,
            peak.limit,
            "kN",
            table[name]["source"].format(moment=peak.time),
            part=part,
            unverified=bool(table[name]["unverified"]),
        )
        for name, peak in peaks.items()
    ]
