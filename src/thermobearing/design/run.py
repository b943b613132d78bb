"""The design loop of Fig. 6.4 for every group of bearing lines, bounds, temperature factors.

    assume a displacement of each group -> size -> analyse the bridge -> compare -> again

One turn of the loop of `run_design` is `_one_turn`, and `_ended` says when to stop. `run_bounds`
and `run_factors` gather what bounds.py and factors.py find into one result.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing, Validity
from thermobearing.border.cases import made_case
from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.border.units import one_or_several
from thermobearing.climate.hourly import Hourly
from thermobearing.climate.site import RETURN_PERIOD, find_cold
from thermobearing.cyclic.equivalent import DESIGN_STRAIN
from thermobearing.design import factors, sizing
from thermobearing.design.bounds import AIR, BEARINGS, bounds_study, first_motions
from thermobearing.design.case import DesignCase, bearing_weight, load_design_case, make_design_case
from thermobearing.design.peaks import collect_peaks, counted
from thermobearing.design.result import USABLE, BoundsReport, Design, FactorReport
from thermobearing.earthquake.case import EarthquakeCase, make_earthquake_case
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.run import run_earthquake
from thermobearing.model.checks import Check
from thermobearing.model.outcomes import PIER_BEYOND_LIMIT
from thermobearing.quantities.governing import order_from_largest
from thermobearing.structure.model import list_piers

BLIND = 23.0  # degC: the bilinear bearing does not care


def _round_analysis(
    case: DesignCase,
    bearings: Sequence[Bearing | BilinearBearing],
    stiffnesses: Sequence[float],
    ambient: Sequence[float] = (BLIND,),
) -> EarthquakeCase:
    """Return the analysis of a turn; its eigenvalues and damping follow K_B of each group."""
    groups = case.groups
    place = {line: k for k, group in enumerate(groups) for line in group.lines}
    lines = [
        line.model_copy(update={"equivalent_stiffness": stiffnesses[place[line.name]]})
        for line in case.structure.bearings
    ]
    own = [  # the first group has the bearing of the study
        {"line": line, "bearing": bearing}
        for group, bearing in zip(groups[1:], bearings[1:], strict=True)
        for line in group.lines
    ]
    return make_earthquake_case(
        {"command": "bridge"},
        "design",
        structure=case.structure.model_copy(update={"bearings": lines}),
        bearings=[bearings[0]],
        lines=own or None,
        motions=list(case.motions),
        ambient=list(ambient),
        dt=case.dt,
        mass=case.mass,
    )


@dataclass(frozen=True)
class Turn:
    """One turn of the loop: a round, a bearing for each group, the checks, the dynamic analysis."""

    rounds: list[sizing.Round]
    checks: list[Check]
    bearings: list[BilinearBearing]
    study: EarthquakeResult


def _sized(
    case: DesignCase, place: int, number: int, assumed: float
) -> tuple[sizing.Round, BilinearBearing]:
    """Return the round of a group before its analysis, and its bilinear bearing."""
    group, compound = case.groups[place], sizing.load_rubber(case.compound, case.compound_kind)
    size = sizing.size_bearing(assumed, bearing_weight(case, group), case.sizing)
    effective = case.effective_displacement_factor * assumed
    thickness = size.total_rubber_thickness
    curves = sizing.load_curves()  # a first guess may lie outside the strains of the curves
    low, high = curves.smallest_strain * thickness, curves.largest_strain * thickness
    effective = min(max(effective, low), high)
    stiffness, damping = sizing.design_values(compound, size, effective)
    model = sizing.equivalent_bilinear(stiffness, damping, effective, case.stiffness_ratio)
    name = f"{case.compound}-{size.side:g}-{size.layers}x{size.layer_thickness:g}"
    bearing = BilinearBearing(
        name=f"{name}-{place + 1}" if len(case.groups) > 1 else name,
        description=f"{case.compound_kind} {case.compound}, designed for {assumed:.0f} mm",
        total_rubber_thickness=thickness,
        strength=model.strength,
        initial_stiffness=model.initial,
        post_yield_stiffness=model.post_yield,
        tested_range=Validity(strain=[curves.smallest_strain, curves.largest_strain]),
    )
    values = (model.strength, model.post_yield, model.initial, math.nan, math.nan)
    turn = sizing.Round(number, assumed, size, stiffness, damping, *values, group=group.name)
    return turn, bearing


def _one_turn(case: DesignCase, number: int, assumed: Sequence[float]) -> Turn:
    """Size every group for its displacement and analyse the bridge."""
    groups = case.groups
    rounds, bearings = zip(
        *(_sized(case, k, number, float(u)) for k, u in enumerate(assumed)), strict=True
    )
    study = run_earthquake(_round_analysis(case, bearings, [turn.stiffness for turn in rounds]))
    names = [line.name for line in case.structure.bearings]
    lines = counted(study.dataset, "bearing_displacement_max", case.motions, case.peaks)
    most = counted(study.dataset, "bearing_displacement_max", case.motions, "largest")
    piers = counted(study.dataset, "pier_ductility", case.motions, case.peaks)
    turns, checks = [], []
    for turn, group in zip(rounds, groups, strict=True):
        places = [names.index(line) for line in group.lines]
        found, largest = float(lines[places].max()), float(most[places].max())
        ductility = float(np.fmax.reduce(piers))
        turns.append(replace(turn, found=found, largest=largest, ductility=ductility))
        strain = found / turn.size.total_rubber_thickness
        weight = bearing_weight(case, group)
        checks += sizing.report_checks(turn.size, weight, strain, case.sizing, turn.group)
    known = list_piers(case.structure) if len(piers) > 1 else []
    ductilities = dict(zip([pier.name for pier in known] or [""], piers.tolist(), strict=True))
    checks += sizing.pier_checks(ductilities, case.sizing)
    order = list(dict.fromkeys(check.what for check in checks))
    checks.sort(key=lambda check: (order.index(check.what), -check.used))
    return Turn(turns, checks, list(bearings), study)


def _ended(
    case: DesignCase, turns: list[Turn], searches: Sequence[sizing.Search]
) -> tuple[str, str, Turn]:
    """Return the outcome and sentence, when the loop ends with these turns, and which is taken."""
    last, tolerance = turns[-1], case.tolerance
    if last.study.outcome not in ("completed", PIER_BEYOND_LIMIT):  # a first size may be far off
        return last.study.outcome, last.study.sentence, last
    held = [turns[search.held[1].number - 1] for search in searches if search.held]
    for turn in (last, *held):
        pairs = list(zip(searches, turn.rounds, strict=True))
        if all(search.settled(one, tolerance) for search, one in pairs):
            exact = all(abs(one.difference) <= tolerance for one in turn.rounds)
            said = [_settled(search, one, tolerance) for search, one in pairs]
            return "converged" if exact else "two_sizes", " ".join(said), turn
    if len(turns) == case.most_rounds:
        both = zip(searches, last.rounds, strict=True)
        far = [one for search, one in both if not search.settled(one, tolerance)]
        said = [
            f"{_prefix(one)}After {case.most_rounds} rounds the displacement still changes by "
            f"{one.difference:+.0%}: assumed {one.assumed:.0f}, found {one.found:.0f} mm."
            for one in far
        ]
        tried = "Try thinner layers (the size changes by full layers), more rounds, or a larger "
        tried += "tolerance."
        return "not_converged", " ".join([*said, tried]), last
    return "", "", last


def _settled(search: sizing.Search, turn: sizing.Round, tolerance: float) -> str:
    """Return how the search of a group ended."""
    if abs(turn.difference) <= tolerance or search.held is None:
        return (
            f"{_prefix(turn)}The displacement of {turn.found:.0f} mm is within {tolerance:.0%} of "
            f"the assumed {turn.assumed:.0f} mm after {turn.number} rounds."
        )
    small, large = (
        f"{sizing.size_name(one)}, sized for {one.assumed:.0f} mm, moves {one.found:.0f} mm"
        for one in search.held
    )
    return (
        f"{_prefix(turn)}Two sizes alternate: {small}, and {large}; neither displacement agrees "
        f"within {tolerance:.0%}. The larger size, {sizing.size_name(search.held[1])}, is adopted."
    )


def _prefix(turn: sizing.Round) -> str:
    """Return the group that a sentence is about, where there are several."""
    return f"{turn.group}: " if turn.group else ""


def _at_every_air(
    case: DesignCase,
    rounds: Sequence[sizing.Round],
    equal: Sequence[Sequence[sizing.EqualBearing]],
    checks: Sequence[Check],
) -> "pd.DataFrame":
    """Return the peaks of layered bearings on the bridge at every temperature."""
    if not equal or not case.ambient:
        return pd.DataFrame()
    stiffnesses = [turn.stiffness for turn in rounds]
    used = [turn.found / turn.size.total_rubber_thickness for turn in rounds]
    groups = [case.groups[k] for k in order_from_largest(used) if case.line_groups]
    tables = []
    for items in equal:
        shaken = _round_analysis(case, [one.bearing for one in items], stiffnesses, case.ambient)
        tables.append(
            collect_peaks(run_earthquake(shaken), case.motions, case.peaks, checks, groups)
        )
    found = pd.concat(tables, ignore_index=True)
    found.attrs["tested_range"] = [row for t in tables for row in t.attrs["tested_range"]]
    return found


def run_design(
    case: DesignCase | str | Path | dict[str, Any] | None = None,
    progress: Callable[[sizing.Round], None] | None = None,
    *,
    templates: Sequence[Bearing] = (),
    **overrides: Any,
) -> Design:
    """Size the bearings of a bridge: assume a displacement, size, analyse, compare, repeat.

    The found displacement of each group of lines replaces the assumed one (6.2.2) until all agree
    within the tolerance, with the bridge analysed in every round; see `Search`. Where two sizes of
    a group alternate, the outcome is "two_sizes" with the larger one. Layered bearings are then
    checked on the bridge at every temperature of the case.

    Parameters
    ----------
    case : a case file, a table such as that of a file (every number has its unit as text), or a
        case; the bridge of Shen (2023), section 6.2, by default.
    progress : called with each round of each group of bearing lines.
    templates : layered bearings to scale to the stiffness of each group, once it converged.
    overrides : values that replace those of a file or table, by key, such as motions, compound,
        start [mm] and weight [kN].

    Raises
    ------
    InputError : a bearing that cannot be sized, or a template that cannot be scaled.

    Examples
    --------
    >>> design = run_design(motions=["jra-ii-i-1"])
    >>> design.outcome, design.last.size.side >= 400.0
    ('converged', True)
    """
    how = (DesignCase, load_design_case, make_design_case, "run_design()")
    case = made_case(case, *how, overrides)
    turns: list[Turn] = []
    searches = [sizing.Search(case.start) for _ in case.groups]
    outcome = ""
    while not outcome:
        turns.append(_one_turn(case, len(turns) + 1, [search.assumed for search in searches]))
        for search, one in zip(searches, turns[-1].rounds, strict=True):
            search.advance(one, case.tolerance)
            if progress:
                progress(one)
        outcome, sentence, turn = _ended(case, turns, searches)
    strain = case.sizing.design_strain
    equal = [
        [
            replace(
                sizing.equal_bearing(template, one.stiffness, one.assumed, strain), group=one.group
            )
            for one in turn.rounds
        ]
        for template in templates
        if outcome in USABLE
    ]
    return Design(
        case=case,
        rounds=[one for each in turns for one in each.rounds],
        outcome=outcome,
        sentence=sentence,
        checks=turn.checks,
        bearings=turn.bearings,
        study=turn.study,
        equal=[item for items in equal for item in items],
        chosen=turn.rounds[0].number,
        temperatures=_at_every_air(case, turn.rounds, equal, turn.checks),
    )


def run_bounds(
    bearings: Sequence[Bearing | str | Path] = BEARINGS,
    motions: Sequence[Any] | None = None,
    ambient: Sequence[float] = AIR,
    *,
    strain: float = DESIGN_STRAIN,
    **options: Any,
) -> BoundsReport:
    """Compare a bounding analysis with the coupled model: `bounds_study` of some bearings.

    `ambient` [degC] has two different temperatures at least, `strain` of the bilinear models is in
    [0.1, 3]; `options` are further keys of an earthquake case.
    """
    if len(set(ambient)) < 2:
        raise InputError("ambient: give at least two different temperatures")
    if not 0.1 <= strain <= 3.0:
        raise InputError(f"strain = {strain:g}: must be between 0.1 and 3 (a ratio: 1 is 100 %)")
    shaken = first_motions() if motions is None else motions
    studied = map(as_bearing, bearings)
    return BoundsReport(
        {b.name: bounds_study(b, shaken, ambient, strain=strain, **options) for b in studied}
    )


def run_factors(
    bearings: Sequence[Bearing | str | Path],
    *,
    reference: float | None = None,
    temperatures: Sequence[float] = factors.TEMPERATURES,
    strains: Sequence[float] = factors.STRAINS,
    period: float | None = None,
    speed: float | None = None,
    cycles: str | Sequence[int] = "1-3",
    scale: bool = False,
    weather: str | Path | Hourly | None = None,
    return_period: int | None = None,
) -> FactorReport:
    """Return temperature factors of a bearing, its bounds, and the size effect if wanted.

    The first bearing gives the values, several (samples of a posterior) make bands. Temperatures
    are [degC] in [-60, 60], strains in [0.1, 3]; `period` of the sine [s] or its mean `speed`
    [mm/s]; `cycles` a name of `PRESETS` or numbers from 1 to 100. `weather` (hourly, a file of it,
    or a climate) adds the cold of a site, and its design temperature of `return_period` [year] (50
    by default) to the temperatures.
    """
    if weather is None and return_period is not None:
        raise InputError("return_period is that of a site: give its weather too")
    years = RETURN_PERIOD if return_period is None else return_period
    site = None if weather is None else find_cold(weather, years)
    if site is not None:
        temperatures = [*one_or_several(temperatures), round(site.design_temperature, 1)]
    chosen = [as_bearing(item) for item in bearings]
    first = chosen[0]
    at = first.hysteresis.reference_temperature if reference is None else reference
    common: dict[str, Any] = {"reference_temperature": at, "temperatures": temperatures}
    common |= {"strains": strains, "cycles": cycles}
    if speed is None:
        period = factors.PERIOD if period is None else period
        table = factors.temperature_factors(chosen, period=period, **common)
        motion = f"sine of {period:g} s"
    else:
        table = factors.factors_at_speed(chosen, speed=speed, **common)
        motion = f"sine at a mean speed of {speed:g} mm/s"
    numbers = cycles if isinstance(cycles, str) else ",".join(str(number) for number in cycles)
    sizes = factors.scale_study(first) if scale else None
    return FactorReport(chosen, table, at, motion, numbers, sizes, site)
