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
from thermobearing.bearing.state import RubberState, has_excess
from thermobearing.border.arguments import checked
from thermobearing.border.cases import made_case
from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.border.schema import validated
from thermobearing.border.units import one_or_several
from thermobearing.climate.hourly import Hourly
from thermobearing.climate.site import RETURN_PERIOD, find_cold
from thermobearing.cyclic.equivalent import DESIGN_STRAIN
from thermobearing.design import factors, sizing
from thermobearing.design.bounds import AMBIENT, BEARINGS, bounds_study, first_motions
from thermobearing.design.case import DesignCase, bearing_weight, load_design_case, make_design_case
from thermobearing.design.peaks import collect_peaks, peaks_by_part
from thermobearing.design.result import USABLE, VIRGIN, BoundsReport, Design, FactorReport
from thermobearing.earthquake.case import EarthquakeCase, make_earthquake_case
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.run import run_earthquake
from thermobearing.model.checks import Check
from thermobearing.model.options import ModelOptions
from thermobearing.model.outcomes import PIER_BEYOND_LIMIT
from thermobearing.quantities.governing import order_from_largest
from thermobearing.structure.model import list_piers

NOMINAL_TEMPERATURE = 23.0  # [degC] of rounds: the bilinear bearing is independent of temperature


def _round_analysis(
    case: DesignCase,
    bearings: Sequence[Bearing | BilinearBearing],
    stiffnesses: Sequence[float],
    ambient: Sequence[float] = (NOMINAL_TEMPERATURE,),
    state: RubberState | None = None,
) -> EarthquakeCase:
    """Return the analysis of a turn; its eigenvalues and damping follow K_B of each group."""
    groups = case.groups
    group_of_line = {line: k for k, group in enumerate(groups) for line in group.lines}
    lines = [
        line.model_copy(update={"equivalent_stiffness": stiffnesses[group_of_line[line.name]]})
        for line in case.structure.bearings
    ]
    line_bearings = [  # the first group has the bearing of the study
        {"line": line, "bearing": bearing}
        for group, bearing in zip(groups[1:], bearings[1:], strict=True)
        for line in group.lines
    ]
    layered = all(isinstance(bearing, Bearing) for bearing in bearings)
    return make_earthquake_case(
        {"command": "bridge"},
        "design",
        structure=case.structure.model_copy(update={"bearings": lines}),
        bearings=[bearings[0]],
        lines=line_bearings or None,
        motions=list(case.motions),
        ambient=list(ambient),
        dt=case.dt,
        mass=case.mass,
        state=state,
        axial=case.axial if layered else None,
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
    # The curves hold for a range of strains, and a first guess may lie outside of it.
    curves = sizing.load_curves()
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
    sizing_round = sizing.Round(
        number=number,
        assumed=assumed,
        size=size,
        stiffness=stiffness,
        damping=damping,
        strength=model.strength,
        post_yield=model.post_yield,
        initial=model.initial,
        found=math.nan,  # until the bridge has been analysed
        ductility=math.nan,
        group=group.name,
    )
    return sizing_round, bearing


def _one_turn(case: DesignCase, number: int, assumed: Sequence[float]) -> Turn:
    """Size every group for its displacement and analyse the bridge."""
    groups = case.groups
    sized = [
        _sized(case, place, number, float(displacement))
        for place, displacement in enumerate(assumed)
    ]
    rounds = [sizing_round for sizing_round, _ in sized]
    bearings = [bearing for _, bearing in sized]
    # All groups act on the same bridge: one analysis gives the displacements of all.
    study = run_earthquake(_round_analysis(case, bearings, [turn.stiffness for turn in rounds]))
    names = [line.name for line in case.structure.bearings]
    line_displacements = peaks_by_part(
        study.dataset, "bearing_displacement_max", case.motions, case.peaks
    )
    largest_displacements = peaks_by_part(
        study.dataset, "bearing_displacement_max", case.motions, "largest"
    )
    pier_ductilities = peaks_by_part(study.dataset, "pier_ductility", case.motions, case.peaks)
    turns, checks = [], []
    for turn, group in zip(rounds, groups, strict=True):
        places = [names.index(line) for line in group.lines]
        displacement = float(line_displacements[places].max())
        largest = float(largest_displacements[places].max())
        ductility = float(np.fmax.reduce(pier_ductilities))
        turns.append(replace(turn, found=displacement, largest=largest, ductility=ductility))
        strain = displacement / turn.size.total_rubber_thickness
        weight = bearing_weight(case, group)
        checks += sizing.report_checks(turn.size, weight, strain, case.sizing, turn.group)
    # The check of a single pier names no part.
    pier_names = [""]
    if len(pier_ductilities) > 1:
        pier_names = [pier.name for pier in list_piers(case.structure)]
    ductilities = dict(zip(pier_names, pier_ductilities.tolist(), strict=True))
    checks += sizing.pier_checks(ductilities, case.sizing)
    # Of each kind of check, in the order of the sheet, the governing one first.
    order = list(dict.fromkeys(check.what for check in checks))
    checks.sort(key=lambda check: (order.index(check.what), -check.used))
    return Turn(turns, checks, bearings, study)


def _ended(
    case: DesignCase, turns: list[Turn], searches: Sequence[sizing.Search]
) -> tuple[str, str, Turn]:
    """Return the outcome and sentence, when the loop ends with these turns, and which is taken."""
    last, tolerance = turns[-1], case.tolerance
    if last.study.outcome not in ("completed", PIER_BEYOND_LIMIT):  # a first size may be far off
        return last.study.outcome, last.study.sentence, last
    # Where sizes alternate, the turn with the larger one was analysed before the last: it is the
    # design if the other groups agree in it too.
    alternating = [
        turns[search.alternating[1].number - 1] for search in searches if search.alternating
    ]
    for turn in (last, *alternating):
        pairs = list(zip(searches, turn.rounds, strict=True))
        if all(search.settled(sizing_round, tolerance) for search, sizing_round in pairs):
            exact = all(abs(sizing_round.difference) <= tolerance for sizing_round in turn.rounds)
            sentences = [
                _settled_sentence(search, sizing_round, tolerance) for search, sizing_round in pairs
            ]
            return "converged" if exact else "two_sizes", " ".join(sentences), turn
    if len(turns) == case.most_rounds:
        unsettled = [
            sizing_round
            for search, sizing_round in zip(searches, last.rounds, strict=True)
            if not search.settled(sizing_round, tolerance)
        ]
        sentences = [
            f"{_prefix(sizing_round)}After {case.most_rounds} rounds the displacement still "
            f"changes by {sizing_round.difference:+.0%}: assumed {sizing_round.assumed:.0f}, "
            f"found {sizing_round.found:.0f} mm."
            for sizing_round in unsettled
        ]
        advice = (
            "Try thinner layers (the size changes by full layers), more rounds, or a larger "
            "tolerance."
        )
        return "not_converged", " ".join([*sentences, advice]), last
    return "", "", last


def _settled_sentence(search: sizing.Search, turn: sizing.Round, tolerance: float) -> str:
    """Return how the search of a group ended."""
    if abs(turn.difference) <= tolerance or search.alternating is None:
        return (
            f"{_prefix(turn)}The displacement of {turn.found:.0f} mm is within {tolerance:.0%} of "
            f"the assumed {turn.assumed:.0f} mm after {turn.number} rounds."
        )
    small, large = (
        f"{sizing.size_name(alternative)}, sized for {alternative.assumed:.0f} mm, moves "
        f"{alternative.found:.0f} mm"
        for alternative in search.alternating
    )
    return (
        f"{_prefix(turn)}Two sizes alternate: {small}, and {large}; neither displacement agrees "
        f"within {tolerance:.0%}. The larger size, {sizing.size_name(search.alternating[1])}, is "
        "adopted."
    )


def _prefix(turn: sizing.Round) -> str:
    """Return the group that a sentence is about, where there are several."""
    return f"{turn.group}: " if turn.group else ""


def _peaks_by_temperature(
    case: DesignCase,
    rounds: Sequence[sizing.Round],
    equal: Sequence[Sequence[sizing.EqualBearing]],
    checks: Sequence[Check],
    state: RubberState | None = None,
) -> "pd.DataFrame":
    """Return the peaks of layered bearings on the bridge at every temperature, in a state."""
    if not equal or not case.ambient:
        return pd.DataFrame()
    stiffnesses = [turn.stiffness for turn in rounds]
    # The group with the largest strain comes first.
    strains = [turn.found / turn.size.total_rubber_thickness for turn in rounds]
    groups = [case.groups[k] for k in order_from_largest(strains) if case.line_groups]
    tables = []
    for items in equal:
        analysis = _round_analysis(
            case, [item.bearing for item in items], stiffnesses, case.ambient, state
        )
        tables.append(
            collect_peaks(run_earthquake(analysis), case.motions, case.peaks, checks, groups)
        )
    table = pd.concat(tables, ignore_index=True)
    table.attrs["tested_range"] = [row for t in tables for row in t.attrs["tested_range"]]
    return table


@checked
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
    checked on the bridge at every temperature of the case, and again with virgin rubber.

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
    case = made_case(
        case, DesignCase, load_design_case, make_design_case, "run_design()", overrides
    )
    turns: list[Turn] = []
    searches = [sizing.Search(case.start) for _ in case.groups]
    outcome = ""
    while not outcome:
        turns.append(_one_turn(case, len(turns) + 1, [search.assumed for search in searches]))
        for search, sizing_round in zip(searches, turns[-1].rounds, strict=True):
            search.advance(sizing_round, case.tolerance)
            if progress:
                progress(sizing_round)
        outcome, sentence, turn = _ended(case, turns, searches)
    strain = case.sizing.design_strain
    equal = [
        [
            replace(
                sizing.equal_bearing(
                    template, sizing_round.stiffness, sizing_round.assumed, strain
                ),
                group=sizing_round.group,
            )
            for sizing_round in turn.rounds
        ]
        for template in templates
        if outcome in USABLE
    ]
    return Design(
        case=case,
        rounds=[sizing_round for finished_turn in turns for sizing_round in finished_turn.rounds],
        outcome=outcome,
        sentence=sentence,
        checks=turn.checks,
        bearings=turn.bearings,
        study=turn.study,
        equal=[item for items in equal for item in items],
        chosen=turn.rounds[0].number,
        temperatures=_peaks_by_temperature(case, turn.rounds, equal, turn.checks),
        virgin=_peaks_by_temperature(case, turn.rounds, equal, turn.checks, VIRGIN),
    )


def run_bounds(
    bearings: Sequence[Bearing | str | Path] = BEARINGS,
    motions: Sequence[Any] | None = None,
    ambient: Sequence[float] = AMBIENT,
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
    studied_motions = first_motions() if motions is None else motions
    studied = map(as_bearing, bearings)
    return BoundsReport(
        {
            b.name: bounds_study(b, studied_motions, ambient, strain=strain, **options)
            for b in studied
        }
    )


def _tables_by_state(
    bearing: Bearing,
    state: RubberState | None,
    table: "pd.DataFrame",
    compute: Callable[[str], "pd.DataFrame"],
) -> dict[str, "pd.DataFrame"]:
    """Return the factors of tested and virgin rubber; none where these are the same.

    By default rubber is virgin where its scragging is known, and tested otherwise; the table of
    that state, which is given, is not computed twice.
    """
    if not has_excess(bearing):
        return {}
    analysed_share = float(bearing.scragging is not None) if state is None else state.share
    return {
        name: table if analysed_share == share else compute(name)
        for name, share in (("tested", 0.0), ("virgin", 1.0))
    }


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
    state: RubberState | str | None = None,
    **options: Any,
) -> FactorReport:
    """Return temperature factors of a bearing, its bounds, and the size effect if wanted.

    The first bearing gives the values, several (samples of a posterior) make bands. `cycles` is a
    name of `PRESETS` or numbers from 1 to 100; `options` are those of `run`, such as `initial`.

    Parameters
    ----------
    reference : reference temperature [degC]; that of the bearing's rubber by default.
    temperatures : ambient temperature [degC], in [-60, 60]; -40 to 40 in steps of 10 by default.
    strains : shear strain, in [0.1, 3]; 1 and 1.75 by default.
    period : period of the sinusoidal test [s], in [0.2, 1000]; 2 by default.
    speed : mean speed [mm/s], instead of the period.
    weather : hourly weather of the site: a file or a climate; adds its cold, and factors at its
        design temperature.
    return_period : return period of the design temperature [year], in [2, 1000]; 50 by default.
    state : state of the rubber of the factors: tested, virgin or "recovered after 5 years"; tested
        by default. Bounds are of tested and of virgin rubber.
    """
    if weather is None and return_period is not None:
        raise InputError("return_period is that of a site: give its weather too")
    years = RETURN_PERIOD if return_period is None else return_period
    site = None if weather is None else find_cold(weather, years)
    if site is not None:
        temperatures = [*one_or_several(temperatures), round(site.design_temperature, 1)]
    chosen = [as_bearing(item) for item in bearings]
    first = chosen[0]
    reference_temperature = (
        first.hysteresis.reference_temperature if reference is None else reference
    )
    common: dict[str, Any] = {"reference_temperature": reference_temperature}
    common |= {"temperatures": temperatures} | options
    test: dict[str, Any] = {"strains": strains, "cycles": cycles}
    compute: Callable[..., pd.DataFrame] = factors.temperature_factors
    if speed is None:
        test["period"] = factors.PERIOD if period is None else period
        motion = f"sine of {test['period']:g} s"
    else:
        compute, test["speed"] = factors.factors_at_speed, speed
        motion = f"sine at a mean speed of {speed:g} mm/s"
    model_options = ModelOptions()
    if state is not None:
        model_options = validated(ModelOptions, {"state": state}, "run_factors()", from_file=False)
    table = compute(chosen, state=model_options.state, **common, **test)

    def _of_state(state: str) -> "pd.DataFrame":
        return compute([first], state=state, **common, **test)

    tables_by_state = _tables_by_state(first, model_options.state, table, _of_state)
    bands = factors.rate_bands(first, table, reference_temperature, **test)
    numbers = cycles if isinstance(cycles, str) else ",".join(str(number) for number in cycles)
    sizes = factors.scale_study(first) if scale else None
    return FactorReport(
        chosen,
        table,
        reference_temperature,
        motion,
        numbers,
        sizes,
        site,
        bands,
        model_options.state,
        tables_by_state,
    )
