"""The stories of the room: the design loop of Fig. 6.4, bounding analyses, temperature factors.

    assume a displacement -> size -> analyse -> compare with what was found -> again

Read `run_design` from the bottom of the loop upwards: one turn is `one_turn`, and `_ended` says
when to stop. `run_bounds` and `run_factors` gather what their parts (bounds.py,
factors.py, scale.py) find into one report.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.library import load_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.validity import Validity
from thermobearing.border.errors import InputError
from thermobearing.cyclic.equivalent import DESIGN_STRAIN
from thermobearing.design.bounds import AIR, BEARINGS, bounds_study, first_motions
from thermobearing.design.case import DesignCase, bearing_weight
from thermobearing.design.equal import EqualBearing, equal_bearing
from thermobearing.design.factors import (
    PERIOD,
    STRAINS,
    TEMPERATURES,
    factors_at_speed,
    temperature_factors,
)
from thermobearing.design.peaks import combined, judged
from thermobearing.design.result import BoundsReport, Design, FactorReport
from thermobearing.design.rounds import Round, size_name, two_sizes
from thermobearing.design.rubber import bilinear_of, load_curves, load_rubber
from thermobearing.design.scale import scale_study
from thermobearing.design.sizing import Check, checks_of, design_values, size_bearing
from thermobearing.earthquake.case import EarthquakeCase, make_earthquake_case
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.run import run_earthquake

BLIND = 23.0  # degC: the bilinear bearing does not care


def earthquake_of(
    case: DesignCase,
    bearings: Sequence[Bearing | BilinearBearing],
    stiffness: float,
    ambient: Sequence[float] = (BLIND,),
) -> EarthquakeCase:
    """The dynamic analysis of one round; eigenvalues and damping follow the bearing's K_B.

    Parameters
    ----------
    case : what is designed.
    bearings : of the round, or layered ones of its stiffness.
    stiffness : K_B [kN/mm], > 0.
    ambient : temperatures [degC].

    Returns
    -------
    EarthquakeCase

    Examples
    --------
    >>> from thermobearing.bearing.bilinear import load_bilinear
    >>> from thermobearing.design.case import make_design_case
    >>> bearing = load_bilinear("shen-bilinear-bridge")
    >>> earthquake_of(make_design_case({}, "example"), [bearing], 2.6).ambient
    [23.0]
    """
    line = case.structure.bearings[0].model_copy(update={"equivalent_stiffness": stiffness})
    structure = case.structure.model_copy(update={"bearings": [line]})
    return make_earthquake_case(
        {"command": "bridge"},
        "design",
        structure=structure,
        bearings=list(bearings),
        motions=list(case.motions),
        ambient=list(ambient),
        dt=case.dt,
        mass=case.mass,
    )


@dataclass(frozen=True)
class Turn:
    """One turn of the loop with all that it made."""

    round: Round
    checks: list[Check]
    bearing: BilinearBearing
    study: EarthquakeResult


def one_turn(case: DesignCase, number: int, assumed: float) -> Turn:
    """Size for a displacement and analyse."""
    compound = load_rubber(case.compound, case.compound_kind)
    size = size_bearing(assumed, bearing_weight(case), case.sizing)
    effective = case.effective_displacement_factor * assumed
    thickness = size.total_rubber_thickness
    curves = load_curves()  # a first guess may lie outside the strains of the curves
    low, high = curves.smallest_strain * thickness, curves.largest_strain * thickness
    effective = min(max(effective, low), high)
    stiffness, damping = design_values(compound, size, effective)
    model = bilinear_of(stiffness, damping, effective, case.stiffness_ratio)
    bearing = BilinearBearing(
        name=f"{case.compound}-{size.side:g}-{size.layers}x{size.layer_thickness:g}",
        description=f"{case.compound_kind} {case.compound}, designed for {assumed:.0f} mm",
        total_rubber_thickness=thickness,
        strength=model.strength,
        initial_stiffness=model.initial,
        post_yield_stiffness=model.post_yield,
        tested_range=Validity(strain=[curves.smallest_strain, curves.largest_strain]),
    )
    study = run_earthquake(earthquake_of(case, [bearing], stiffness))
    peaks = np.asarray(study["bearing_displacement_max"])
    found = combined(peaks.tolist(), case.motions, case.peaks)
    ductility = combined(np.asarray(study["pier_ductility"]).tolist(), case.motions, case.peaks)
    turn = Round(
        number=number,
        assumed=assumed,
        size=size,
        stiffness=stiffness,
        damping=damping,
        strength=model.strength,
        post_yield=model.post_yield,
        initial=model.initial,
        found=found,
        largest=float(peaks.max()),
        ductility=ductility,
    )
    checks = checks_of(size, bearing_weight(case), found / thickness, ductility, case.sizing)
    return Turn(turn, checks, bearing, study)


def _ended(case: DesignCase, rounds: list[Round], study: EarthquakeResult) -> tuple[str, str]:
    """Outcome and sentence, when the loop ends with these rounds; empty when it goes on."""
    last = rounds[-1]
    if study.outcome != "completed":
        return study.outcome, study.sentence
    if abs(last.difference) <= case.tolerance:
        return "converged", (
            f"The displacement of {last.found:.0f} mm is within {case.tolerance:.0%} of the "
            f"assumed {last.assumed:.0f} mm after {last.number} rounds."
        )
    between = two_sizes(rounds, case.tolerance)
    if between is not None:
        small, large = between
        return "two_sizes", (
            f"Two sizes alternate: {size_name(small)}, sized for {small.assumed:.0f} mm, moves "
            f"{small.found:.0f} mm, and {size_name(large)}, sized for {large.assumed:.0f} mm, "
            f"moves {large.found:.0f} mm; none moves as far as it is sized for, within "
            f"{case.tolerance:.0%}. Taken is the safer one, {size_name(large)}."
        )
    if last.number == case.most_rounds:
        return "not_converged", (
            f"After {case.most_rounds} rounds the displacement still changes by "
            f"{last.difference:+.0%}: assumed {last.assumed:.0f}, found {last.found:.0f} mm. "
            "Try thinner layers (the size jumps by whole layers), more rounds, or a larger "
            "tolerance."
        )
    return "", ""


def at_every_air(
    case: DesignCase, last: Round, equal: Sequence[EqualBearing], checks: Sequence[Check]
) -> pd.DataFrame:
    """What the layered bearings of a design do at every temperature of the case; see `judged`.

    Parameters
    ----------
    case : what was designed.
    last : the round that was taken.
    equal : layered bearings of its stiffness.
    checks : their limits are kept.

    Returns
    -------
    DataFrame : empty without layered bearings, or without temperatures.

    Examples
    --------
    >>> from thermobearing.design.case import make_design_case
    >>> from thermobearing.design.sizing import Size
    >>> turn = Round(1, 178.0, Size(600.0, 8, 14.0), 2.6, 0.15, 125.4, 1.8, 9.5, 180.0, 1.2)
    >>> len(at_every_air(make_design_case({}, "example"), turn, [], []))
    0
    """
    if not equal or not case.ambient:
        return pd.DataFrame()
    bearings = [item.bearing for item in equal]
    shaken = earthquake_of(case, bearings, last.stiffness, case.ambient)
    return judged(run_earthquake(shaken), case.motions, case.peaks, checks)


def run_design(
    case: DesignCase,
    tell: Callable[[Round], None] | None = None,
    *,
    templates: Sequence[Bearing] = (),
) -> Design:
    """Carry out the loop; says why if it does not converge, never raises for that.

    The found displacement replaces the assumed one (6.2.2) until they agree within the
    tolerance. Sizes are whole layers, so the found displacement may jump between two of them:
    when the assumed displacement is about to repeat, it goes half-way only. Where no size moves as
    far as it is sized for, the loop ends as "two_sizes" with the safer of the two. Layered
    bearings are then judged at every temperature of the case.

    Parameters
    ----------
    case : from `load_design_case` or `make_design_case`.
    tell : called after each round.
    templates : layered bearings to scale to the stiffness of the design, once it converged.

    Returns
    -------
    Design

    Raises
    ------
    InputError : a bearing that cannot be sized, or a template that cannot be scaled.

    Examples
    --------
    >>> from thermobearing.design.case import make_design_case
    >>> design = run_design(make_design_case({}, "example", motions=["jra-ii-i-1"]))
    >>> design.outcome, design.last.size.side >= 400.0
    ('converged', True)
    """
    rounds: list[Round] = []
    turns: list[Turn] = []
    assumed, gain, outcome = case.start, 1.0, ""
    while not outcome:
        turn = one_turn(case, len(rounds) + 1, assumed)
        rounds.append(turn.round)
        turns.append(turn)
        if tell:
            tell(turn.round)
        outcome, sentence = _ended(case, rounds, turn.study)
        difference = turn.round.difference
        if len(rounds) > 1 and difference * rounds[-2].difference < 0.0:
            gain *= 0.5
        assumed += gain * (turn.round.found - assumed)
    if outcome == "two_sizes":
        safer = two_sizes(rounds, case.tolerance)
        assert safer is not None
        turn = turns[safer[1].number - 1]
    last, strain = turn.round, case.sizing.design_strain
    usable = outcome in ("converged", "two_sizes")
    equal = [
        equal_bearing(template, last.stiffness, last.assumed, strain)
        for template in templates
        if usable
    ]
    return Design(
        case=case,
        rounds=rounds,
        outcome=outcome,
        sentence=sentence,
        checks=turn.checks,
        bearing=turn.bearing,
        study=turn.study,
        equal=equal,
        chosen=last.number,
        temperatures=at_every_air(case, last, equal, turn.checks),
    )


def run_bounds(
    bearings: Sequence[Bearing | str | Path] = BEARINGS,
    motions: Sequence[Any] | None = None,
    ambient: Sequence[float] = AIR,
    *,
    strain: float = DESIGN_STRAIN,
    **options: Any,
) -> BoundsReport:
    """Is a bounding analysis good enough: `bounds_study` of some bearings.

    Parameters
    ----------
    bearings : layered ones, library names or TOML files; the two of the bridge by default.
    motions : names, files or tables as in an earthquake case; the first motion of each type
        and ground by default.
    ambient : temperatures at which the coupled model runs [degC]; at least two different ones.
    strain : of the bilinear models, in [0.1, 3].
    options : further keys of an earthquake case: structure, fixed_base, lines, duration, dt, ...

    Returns
    -------
    BoundsReport

    Raises
    ------
    InputError : anything out of range, unknown names.

    Examples
    --------
    >>> report = run_bounds(["shen-hdr-bridge"], ["jra-ii-i-1"], [23.0, -20.0])
    >>> report.paragraphs["shen-hdr-bridge"].split(":")[0]
    'shen-hdr-bridge on pier-p1'
    """
    if len(set(ambient)) < 2:
        raise InputError("ambient: give at least two different temperatures")
    if not 0.1 <= strain <= 3.0:
        raise InputError(f"strain = {strain:g}: must be between 0.1 and 3")
    chosen = [item if isinstance(item, Bearing) else load_bearing(item) for item in bearings]
    shaken = first_motions() if motions is None else motions
    return BoundsReport(
        {
            item.name: bounds_study(item, shaken, ambient, strain=strain, **options)
            for item in chosen
        }
    )


def run_factors(
    bearings: Sequence[Bearing | str | Path],
    *,
    reference: float | None = None,
    temperatures: Sequence[float] = TEMPERATURES,
    strains: Sequence[float] = STRAINS,
    period: float | None = None,
    speed: float | None = None,
    cycles: str | Sequence[int] = "1-3",
    scale: bool = False,
) -> FactorReport:
    """Temperature factors of a bearing, its bounds, and the size effect if wanted.

    Parameters
    ----------
    bearings : layered ones, library names or TOML files; the first gives the values, several
        (samples of a posterior) make bands.
    reference : temperature [degC], in [-60, 60]; that of the first bearing's rubber by default.
    temperatures : [degC], in [-60, 60].
    strains : shear strain amplitudes, in [0.1, 3].
    period : of the sine [s], in [0.2, 1000]; 2 by default.
    speed : mean speed [mm/s] instead of the period, > 0.
    cycles : "3", "1-3", "2-11", "all-but-first" (of five), or numbers from 1 to 100.
    scale : study the first bearing at 1/6 of its size too.

    Returns
    -------
    FactorReport

    Raises
    ------
    InputError : anything out of range; an analysis that did not complete.

    Examples
    --------
    >>> report = run_factors(["shen-hdr-bridge"], temperatures=[-20.0], strains=[1.0])
    >>> [bound.name for bound in report.bounds]
    ['lower', 'upper']
    """
    chosen = [item if isinstance(item, Bearing) else load_bearing(item) for item in bearings]
    first = chosen[0]
    at = first.hysteresis.reference_temperature if reference is None else reference
    common: dict[str, Any] = {"reference_temperature": at, "temperatures": temperatures}
    common |= {"strains": strains, "cycles": cycles}
    if speed is None:
        period = PERIOD if period is None else period
        table = temperature_factors(chosen, period=period, **common)
        motion = f"sine of {period:g} s"
    else:
        table = factors_at_speed(chosen, speed=speed, **common)
        motion = f"sine at a mean speed of {speed:g} mm/s"
    told = cycles if isinstance(cycles, str) else ",".join(str(number) for number in cycles)
    sizes = scale_study(first) if scale else None
    return FactorReport(chosen, table, at, motion, told, sizes)
