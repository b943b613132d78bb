"""Checks of bearings: one row for each limit, of the lead and under a vertical load.

The vertical load is an input; it changes neither force nor heat of a bearing.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from typing import Any

import numpy as np

from thermobearing.bearing.model import Bearing, CircularPlan, Geometry, Plan
from thermobearing.border.library import data_path
from thermobearing.border.toml import read_toml, split_sources
from thermobearing.border.units import NEWTON_PER_KILONEWTON
from thermobearing.core.records import Floats
from thermobearing.model.element import BearingElement
from thermobearing.model.outcomes import temperature_limits
from thermobearing.quantities.governing import largest_by, place_of_least

PASSED, FAILED = "OK", "NG"
NO_LIMIT, NO_VALUE = "limit not available", "demand not available"
NOT_MODELLED = "outside the model"
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
        return PASSED if self.passed else NOT_MODELLED if self.of_model else FAILED


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


def failed_checks(rows: Sequence[dict[str, Any]]) -> list[str]:
    """Return a sentence for each check that runs fail, or that the model does not cover."""
    found: dict[tuple[str, str, str], list[dict[str, Any]]] = {}
    for row in rows:
        if row["verdict"] in (FAILED, NOT_MODELLED):
            found.setdefault((row["bearing"], row["part"], row["what"]), []).append(row)
    said = []
    for (bearing, part, what), mine in found.items():
        worst = largest_by(mine, lambda row: float(row["used"]))
        unit = f" {worst['unit']}".removesuffix(" 1")
        limit = f"the limit is {worst['limit']:.4g}{unit}"
        says = worst["source"] if worst["verdict"] == NOT_MODELLED else limit
        of = f"{bearing}, {part}" if part else bearing
        where = f"{len(mine)} runs, most: {worst['run']}" if len(mine) > 1 else worst["run"]
        said.append(f"{of}: {what} {worst['value']:.4g}{unit}: {says} ({where})")
    return said


def lead_check_rows(
    run: str, bearing: str, hottest: float, *, melted: bool = False
) -> list[dict[str, Any]]:
    """Return the rows of the warmest lead [degC] of a run: melting, and a share of it.

    A run that ended because its lead melted (`melted`) has reached the melting temperature.
    """
    limits, table = temperature_limits(), read_toml(data_path("materials", "limits.toml"))
    melting, near = limits.lead_melts, limits.lead_near_melting
    value = melting if melted else hottest
    sources = [str(table[name]["source"]) for name in ("lead_melts", "lead_near_melting")]
    rows = check_rows(
        run,
        bearing,
        [
            Check(f"lead: melting {int(melting)} degC", value, melting, "degC", sources[0]),
            Check(f"lead: {near:g} of melting", value, near * melting, "degC", sources[1]),
        ],
    )
    rows[0]["verdict"] = FAILED if melted else rows[0]["verdict"]
    return rows


@cache
def _constants() -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the constants of bearings in compression, and the checks of the vertical load."""
    table, _ = split_sources(read_toml(data_path("materials", "vertical.toml")))
    return dict(table), dict(table["checks"])


def overlap_area(plan: Plan, displacement: Floats) -> Floats:
    """Return the area of a plan that still lies above itself when the top has moved [mm2].

    It is (a - abs(x)) (b - abs(y)) of a rectangle, the lens of two circles of a round plan.
    `displacement` [mm] has a number for each place, or pairs (x, y) on the last axis of two
    dimensions; x is along the `length` of a rectangular plan.

    >>> from thermobearing.bearing.model import RectangularPlan
    >>> plan = RectangularPlan(shape="rectangular", length=400, width=300)
    >>> overlap_area(plan, np.array([[100.0, -50.0], [500.0, 0.0]])).tolist()
    [75000.0, 0.0]
    """
    moved = np.asarray(displacement, dtype=float)
    pairs = moved if moved.ndim > 1 else np.stack([moved, np.zeros_like(moved)], axis=-1)
    along, across = plan._sides()
    if isinstance(plan, CircularPlan):
        share = np.minimum(np.hypot(pairs[..., 0], pairs[..., 1]) / along, 1.0)
        angle = 2.0 * np.arccos(share)
        return np.asarray(0.25 * along**2 * (angle - np.sin(angle)))
    left = np.maximum(np.array([along, across]) - np.abs(pairs), 0.0)
    return np.asarray(left[..., 0] * left[..., 1])


def compression_modulus(geometry: Geometry, shear_modulus: float) -> float:
    r"""Return the compression modulus E_c of a layered pad, in the unit of its shear modulus, GPa.

    .. math::
        E_c = (1 / (c G S^2) + 4 / (3 K))^{-1}

    with the shape factor S of one layer, c = 6 for round and 6.73 for other plans and the bulk
    modulus K (data/materials/vertical.toml). A lead core counts as rubber.
    """
    known, _ = _constants()
    bulk = float(str(known["bulk_modulus"]).split()[0]) / NEWTON_PER_KILONEWTON
    round_plan = isinstance(geometry.plan, CircularPlan)
    factor = known["compression_round" if round_plan else "compression_square"]
    shape = geometry.first_shape_factor
    return float(1.0 / (1.0 / (factor * shear_modulus * shape**2) + 4.0 / (3.0 * bulk)))


def second_moments(plan: Plan) -> tuple[float, float]:
    """Return the second moments of area of a plan about the axes along and across [mm4]."""
    along, across = plan._sides()
    share = math.pi / 64.0 if isinstance(plan, CircularPlan) else 1.0 / 12.0
    return share * along * across**3, share * across * along**3


def critical_load(geometry: Geometry, shear_modulus: float) -> float:
    r"""Return the load at which a bearing buckles without displacement [kN].

    .. math::
        P_{cr} = \frac{P_S}{2} \left(\sqrt{1 + 4 P_E / P_S} - 1\right), \quad
        P_S = G A \frac{h}{T_r}, \quad P_E = \frac{\pi^2}{h^2} \frac{E_c I}{3} \frac{h}{T_r}

    of Haringx's column, with both ends held against rotation, between the end plates (height h of
    rubber and shims, T_r of rubber), about the weaker axis; `shear_modulus` is the secant modulus
    of the rubber [GPa].

    >>> import thermobearing as tb
    >>> geometry = tb.load_bearing("shen-hdr-bridge").geometry
    >>> 9e3 < critical_load(geometry, 1e-3) < 10e3
    True
    """
    rubber = geometry.total_rubber_thickness
    height = rubber + (geometry.rubber_layers - 1) * geometry.shim_thickness
    height += 2.0 * geometry.sealing_plate_thickness
    stretch = height / rubber
    bending = compression_modulus(geometry, shear_modulus) * min(second_moments(geometry.plan))
    euler = (math.pi / height) ** 2 * bending / 3.0 * stretch
    shear = shear_modulus * geometry.plan.area * stretch
    return 0.5 * shear * (math.sqrt(1.0 + 4.0 * euler / shear) - 1.0)


def secant_stiffness(element: BearingElement, height: float) -> float:
    """Return the secant stiffness of rubber at 100 % strain in the first loading [kN/mm].

    `height` is the total rubber thickness [mm] of the bearing, which starts where it is.
    """
    begin = float(element.state.books["displacement"][0])
    for x in np.linspace(begin, begin + height, STEPS + 1)[1:]:
        element.set_trial(float(x), dt=STEP)
        element.commit()
    return float(element.state.books["rubber_force"][0]) / height


def secant_modulus(bearing: Bearing, temperature: float) -> float:
    """Return the secant modulus of scragged rubber at 100 % strain and a temperature [GPa]."""
    height = bearing.total_rubber_thickness
    element = BearingElement(bearing.model_copy(update={"scragging": None}), temperature)
    return secant_stiffness(element, height) * height / bearing.area


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
    known = _constants()[1]
    if axial_force < 0.0:
        row = known["tension"]
        about: dict[str, Any] = {"least": True, "part": part, "of_model": True}
        return [Check(row["what"], axial_force, 0.0, "kN", row["source"], **about)]
    if bearing is None:
        return []
    plan = bearing.geometry.plan
    areas = overlap_area(plan, displacement)
    place = place_of_least(areas)
    least, moved = float(areas[place]), float(np.linalg.norm(displacement[place]))
    degrees = max(temperature, bearing.hysteresis.reference_temperature)
    modulus = checked_modulus(bearing, temperature)
    critical = critical_load(bearing.geometry, modulus)
    given = {"modulus": f"{NEWTON_PER_KILONEWTON * modulus:.3g} MPa at {degrees:g} degC"}
    given["overlap"] = f"{100.0 * least / plan.area:.0f} % at {moved:.0f} mm"

    def _row(name: str, value: float, limit: float, unit: str) -> Check:
        one = known[name]
        source, unverified = one["source"].format(**given), bool(one.get("unverified"))
        return Check(one["what"], value, limit, unit, source, part=part, unverified=unverified)

    force = axial_force * NEWTON_PER_KILONEWTON
    on_overlap = force / least if least > 0.0 else math.inf
    return [
        _row("stress", force / plan.area, math.nan, "MPa"),
        _row("overlap_stress", on_overlap, math.nan, "MPa"),
        _row("critical", axial_force, critical, "kN"),
        _row("reduced", axial_force, critical * least / plan.area, "kN"),
    ]
