"""Constants of the coupled step, computed from a bearing."""

from collections.abc import Iterable
from typing import Any, Literal

import numpy as np

from thermobearing.bearing.exposure import exposed
from thermobearing.bearing.model import (
    Bearing,
    Clock,
    Hardening,
    LeadCores,
    Scragging,
    SmallLoops,
    TemperatureLaw,
    calibration_ranges,
)
from thermobearing.bearing.scaling import acting_rate
from thermobearing.border.units import parse_quantity
from thermobearing.core.numbers import (
    CoreSizes,
    LayerLaw,
    lead_numbers,
    rubber_numbers,
    source_rise,
)
from thermobearing.core.records import Floats, Rows, filled, rows
from thermobearing.core.types import (
    EULER,
    EXACT,
    HEAT_FROM_DISSIPATION,
    HEAT_FROM_WORK,
    Cells,
    Constants,
    LawPiece,
    Lead,
    Rubber,
    Viscous,
)
from thermobearing.laws import find_law, tabulate
from thermobearing.model.lead_ends import half_space, lead_network
from thermobearing.model.outcomes import limits_of_a_step
from thermobearing.model.stack import (
    MM_PER_M,
    EndFace,
    Scheme,
    Stack,
    conservative_rates,
    published_rates,
)
from thermobearing.quantities.governing import SLACK_KELVIN, place_words
from thermobearing.quantities.warned import BEYOND_LAW, UNTESTED, Warned

COLDER = -1e30  # lower bound of the first piece [degC]
SOFTENING_LEAD = "softening-lead"  # the law of lead beyond its tests, unless a bearing states E2


def _law_pieces(law: TemperatureLaw | None) -> Rows[LawPiece]:
    """Return cubics of log factors in T by piece (Fritsch & Carlson 1980), straight at the ends."""
    if law is None or not law.has_factors:
        return rows(LawPiece, 0)  # the exponential law alone
    from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

    if law.law is None:
        at = np.array(law.temperatures)
        columns = (law.elastic, law.hysteretic, law.viscosity)
        logs = np.log(np.array([column or [1.0] * len(at) for column in columns])).T
        cubics = [PchipInterpolator(at, values) for values in logs.T]
    else:
        registered = find_law(law.law, "temperature")
        at, logs, slopes = tabulate(registered, registered.values(law.parameters))
        # A registered law has factors on the two stiffness terms, none on the viscosity.
        viscosity = np.zeros(len(at))
        logs, slopes = np.column_stack([logs, viscosity]), np.column_stack([slopes, viscosity])
        cubics = [CubicHermiteSpline(at, *pair) for pair in zip(logs.T, slopes.T, strict=True)]
    # Below and above the table the slopes at its ends go on.
    coefficients = []
    for values, cubic in zip(logs.T, cubics, strict=True):
        ends = cubic.derivative()(at[[0, -1]])
        zero = np.zeros(2)
        lines = np.array([zero, zero, ends, values[[0, -1]]])
        # scipy has the highest power first, `LawPiece` the lowest.
        coefficients.append(np.column_stack([lines[:, :1], cubic.c, lines[:, 1:]])[::-1])
    elastic, hysteretic, viscous = coefficients
    return filled(
        LawPiece,
        lowest=np.array([COLDER, *at]),
        origin=np.array([at[0], *at]),
        **{f"elastic_{k}": elastic[k] for k in range(4)},
        **{f"hysteretic_{k}": hysteretic[k] for k in range(4)},
        **{f"viscous_{k}": viscous[k] for k in range(4)},
    )


LAW_RANGE = "temperature_law.coldest"  # key of the source of the range of a temperature law


def outside_law(
    name: str,
    law: TemperatureLaw | None,
    runs: Iterable[tuple[str, Floats, Floats]],
    source: str = "",
) -> list[Warned]:
    """Return a warning if rubber left the range in which its temperature law was identified.

    `name`: of the bearing; `law`: its temperature law; `runs`: for each its label, times [s]
    and layer temperatures [degC], a row a time. A run with several bearings has one entry for each,
    under the same name, and counts once. `source`: of the range, named where it is borrowed.
    """
    if law is None or law.range is None:
        return []
    low, high = law.range
    coldest, warmest, longest, worst = np.inf, -np.inf, 0.0, ""
    outside_runs: set[str] = set()
    labels: set[str] = set()
    for label, time, layers in runs:
        labels.add(label)
        # So little beyond the tested temperatures hardly changes the stiffness.
        out = ((layers < low - SLACK_KELVIN) | (layers > high + SLACK_KELVIN)).any(axis=1)
        if not out.any():
            continue
        outside_runs.add(label)
        coldest = min(coldest, float(np.nanmin(layers)))
        warmest = max(warmest, float(np.nanmax(layers)))
        # Each sample stands for the time since the one before.
        seconds = float(np.diff(time, prepend=time[0])[out].sum())
        if seconds >= longest:
            longest, worst = seconds, label
    if not outside_runs:
        return []
    beyond = []
    if coldest < low - SLACK_KELVIN:
        beyond.append(f"{coldest:.1f} degC, {low - coldest:.0f} K below")
    if warmest > high + SLACK_KELVIN:
        beyond.append(f"{warmest:.1f} degC, {warmest - high:.0f} K above")
    place = place_words(len(outside_runs), len(labels), worst, "longest")
    borrowed = f", {source.split(';')[0]}" if source.startswith("borrowed") else ""
    sentence = (
        f"rubber reaches {' and '.join(beyond)} the range of the temperature law, "
        f"{low:g} to {high:g} degC{borrowed} ({longest:.3g} s; {place})"
    )
    return [Warned(sentence, BEYOND_LAW, UNTESTED, name)]


Integrator = Literal["exact", "euler"]
HeatSource = Literal["work", "dissipation"]
LeadEnds = Literal["half-space", "finite-plate"]
SCRAGGED = Scragging(strain=1.0, mullins_decay=1.0, mullins_renewal=1.0)  # without effect
SHARING_START, SHARING_FULL = 0.2, -0.2  # see docs/theory.md, "When a layer softens"


def build_constants(
    bearing: Bearing,
    stack: Stack,
    *,
    upper: EndFace,
    lower: EndFace | None,
    scheme: Scheme = "conservative",
    integrator: Integrator = "exact",
    heat_source: HeatSource = "work",
    lead_ends: LeadEnds = "half-space",
    hardening: Hardening = "printed",
    small_loops: SmallLoops = "published",
    clock: Clock | None = None,
) -> Constants:
    """Return the constants of the coupled step of a bearing and its stack.

    `lower` is None for a half stack: its last cell lies at the symmetry plane. `lead_ends`
    "finite-plate" needs lead and the conservative scheme. `clock` is that of `lead_clock`.
    """
    make = conservative_rates if scheme == "conservative" else published_rates
    rates = make(stack, upper, lower)
    lead, end, side = _lead(bearing, stack, published=scheme == "published", clock=clock)
    network = half_space(end, side)
    if lead_ends == "finite-plate":
        network = lead_network(bearing, stack, upper, lower)
    return Constants(
        rubber=_rubber(
            bearing,
            EULER if integrator == "euler" else EXACT,
            hardening == "monotone",
            small_loops == "closed",
        ),
        lead=lead,
        viscous=_viscous(bearing, heats=scheme != "published"),
        law=_law_pieces(bearing.temperature_law),
        multiplicity=stack.multiplicity,
        layer_cells=stack.layers,
        cells=Cells(*rates, capacity=stack.heat_capacity, beside_lead=stack.beside_lead),
        lead_cells=network.cells,
        lead_ports=network.ports,
        lead_modes=network.modes,
        source_rise=source_rise(
            bearing.materials.rubber.volumetric_heat,
            bearing.area - bearing.lead_area,
            bearing.geometry.rubber_thickness,
        ),
        side_implicit=scheme == "conservative",
        heat_source=HEAT_FROM_DISSIPATION if heat_source == "dissipation" else HEAT_FROM_WORK,
        limits=limits_of_a_step(),
    )


def with_parameters(
    constants: Constants, bearing: Bearing, stack: Stack, *, only_tests: bool = True
) -> Constants:
    """Return constants of the same stack with rubber, lead and rate parameters of another bearing.

    For identification, where only those change from one evaluation to the next, and lead has no
    temperature beyond its tests, since the tests are simulated (`only_tests`). The bearing must
    have the geometry and materials that `constants` and `stack` were built from.
    """
    rubber, law = constants.rubber, bearing.temperature_law
    choices = rubber.integrator, rubber.monotone, rubber.closed_loops
    bearing = exposed(bearing)
    lead, _, _ = _lead(bearing, stack, published=constants.lead.published)
    lead = lead._replace(clock_rate=constants.lead.clock_rate)  # keep the chosen clock
    if only_tests:
        lead = lead._replace(softening_beyond=lead.softening)
    # Of temperature laws only a registered one has parameters that may have changed.
    return constants._replace(
        rubber=_rubber(bearing, *choices),
        lead=lead,
        viscous=_viscous(bearing, heats=constants.viscous.heats),
        law=constants.law if law is None or law.law is None else _law_pieces(law),
    )


def lead_clock(lead: LeadCores, *, published: bool, chosen: Clock | None = None) -> Clock:
    """Return whose diffusivity makes t+ dimensionless: as in the options, else the bearing, else
    lead (Eq. 5.6 as published) with the published scheme and steel with the conservative one.
    """
    return chosen or lead.clock or ("lead" if published else "steel")


def softening_beyond_tests(lead: LeadCores) -> float:
    """Return E2 of lead that is warmer than in its tests [1/K]: the published one by default."""
    if lead.softening_beyond_tests is not None:
        return lead.softening_beyond_tests
    return parse_quantity(find_law(SOFTENING_LEAD).value, "1/K")


def warmest_tested_lead(bearing: Bearing) -> float:
    """Return the temperature up to which the strength of lead is that of its tests [degC].

    Where the tests are not stated, it is that for which the yield stress is.
    """
    ranges = calibration_ranges(bearing) or {}
    reference = bearing.lead.reference_temperature if bearing.lead else 0.0
    return ranges.get("lead_temperature", (reference, reference))[1]


def _lead(
    bearing: Bearing, stack: Stack, *, published: bool, clock: Clock | None = None
) -> tuple[Lead, Floats, Floats]:
    """Return constants of the lead cores, and conductances to each cell: ends, sides (5.1-5.7)."""
    nothing = np.zeros(len(stack.part))
    lead_cores, material = bearing.lead, bearing.materials.lead
    if lead_cores is None or material is None:
        no_lead = Lead(
            cores=0.0,
            stiffness=1.0,
            strength=0.0,
            softening=0.0,
            softening_beyond=0.0,
            reference_temperature=0.0,
            warmest_tested=0.0,
            capacity=1.0,
            clock_rate=0.0,
            end_conductance=0.0,
            side_conductance=0.0,
            fold=float(stack.fold),
            published=published,
        )
        return no_lead, nothing, nothing
    steel = bearing.materials.steel
    conductivity = steel.conductivity / MM_PER_M
    clock_material = lead_clock(lead_cores, published=published, chosen=clock)
    medium = steel if clock_material == "steel" else material
    diffusivity = medium.conductivity / MM_PER_M / medium.volumetric_heat
    core = CoreSizes(
        cores=lead_cores.cores,
        diameter=lead_cores.diameter,
        yield_stress=lead_cores.yield_stress,
        surface_ratio=lead_cores.surface_ratio,
        confined=lead_cores.confined,
        volumetric_heat=material.volumetric_heat,
        steel_conductivity=conductivity,
        diffusivity=diffusivity,
    )
    end, side = np.zeros((2, len(stack.part)))
    touching = stack.touches_lead_end
    numbers = lead_numbers(core, stack.codes, stack.beside_lead, touching, stack.fold, end, side)
    strength, capacity, clock_rate, one_end, sides = numbers
    lead = Lead(
        cores=float(lead_cores.cores),
        stiffness=lead_cores.stiffness,
        strength=strength,
        softening=lead_cores.softening,
        softening_beyond=softening_beyond_tests(lead_cores),
        reference_temperature=lead_cores.reference_temperature,
        warmest_tested=warmest_tested_lead(bearing),
        capacity=capacity,
        clock_rate=clock_rate,
        end_conductance=one_end,
        side_conductance=sides,
        fold=float(stack.fold),
        published=published,
    )
    return lead, end, side


def _viscous(bearing: Bearing, *, heats: bool) -> Viscous:
    """Return the rate-dependent branch; Shen (2023) excludes its work from the heat."""
    branch = acting_rate(bearing)
    if branch is None:
        return Viscous(0.0, 1.0, heats)
    return Viscous(branch.stiffness, branch.damping / branch.stiffness, heats)


def _user_law_numbers(bearing: Bearing) -> dict[str, Any]:
    """Return the numbers of a registered law of hysteresis, by field of `Rubber`."""
    if bearing.hysteresis_law is None:
        return {}
    law = find_law(bearing.hysteresis_law.law, "hysteresis")
    on_line, in_plane = law.addresses
    values = law.values(bearing.hysteresis_law.parameters)
    numbers = {f"law_{k}": value for k, value in enumerate(values, 1)}
    return {"law": on_line, "law_in_plane": in_plane, **numbers}


def _rubber(bearing: Bearing, integrator: int, monotone: bool, closed_loops: bool) -> Rubber:
    """Return the constants of one rubber layer (Eq. 4.34-4.37)."""
    h, virgin = bearing.hysteresis, bearing.scragging or SCRAGGED
    law = LayerLaw(
        thickness=bearing.geometry.rubber_thickness,
        post_yield_ratio=h.post_yield_ratio,
        layer_stiffness=h.layer_stiffness,
        shape=h.shape,
        yield_displacement=h.yield_displacement,
        hardening=h.hardening,
        elastic_temperature_coefficient=h.elastic_temperature_coefficient,
        hysteretic_temperature_coefficient=h.hysteretic_temperature_coefficient,
        scragging_strain=virgin.strain,
    )
    elastic, hysteretic, m, n, hardening, per_yield, unloading, scragging = rubber_numbers(law)
    return Rubber(
        layer_count=float(bearing.geometry.rubber_layers),
        layer_share=1.0 / bearing.geometry.rubber_layers,
        elastic_stiffness=elastic,
        hysteretic_stiffness=hysteretic,
        elastic_exponent=m,
        hysteretic_exponent=n,
        reference_temperature=h.reference_temperature,
        hardening=hardening,
        monotone=monotone,
        yield_displacement=h.yield_displacement,
        per_yield_displacement=per_yield,
        unloading_curvature=unloading,
        integrator=integrator,
        closed_loops=closed_loops,
        virgin=bearing.scragging is not None,
        scragging_amplitude=virgin.amplitude,
        scragging_displacement=scragging,
        mullins_amplitude=virgin.mullins_amplitude,
        mullins_decay=virgin.mullins_decay,
        mullins_renewal=virgin.mullins_renewal,
        sharing_start=SHARING_START,
        sharing_full=SHARING_FULL,
        **_user_law_numbers(bearing),
    )
