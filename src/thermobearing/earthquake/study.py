"""`bridge` and `hybrid`: what the user gave becomes a case, and the case a result."""

from collections.abc import Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import Any, TypeAlias, TypedDict, TypeVar, Unpack

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.exposure import Exposure
from thermobearing.bearing.model import Bearing, Clock, SmallLoops
from thermobearing.border.errors import InputError, nearest
from thermobearing.cyclic.rig import Rig
from thermobearing.cyclic.start import Earlier
from thermobearing.earthquake.case import Command, Kept, Laboratory, make_earthquake_case
from thermobearing.earthquake.motion import Motion
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.run import Progress, run_earthquake
from thermobearing.model.constants import Hardening, HeatSource, Integrator, LeadEnds
from thermobearing.model.earlier import Model
from thermobearing.model.handover import SpecimenState
from thermobearing.model.options import EndFace, Side, Stacked
from thermobearing.model.stack import Scheme
from thermobearing.motions.record import GroundMotion
from thermobearing.structure.model import DampingKind, MassModel, Structure
from thermobearing.structure.run import Method

T = TypeVar("T")
OneOrMore: TypeAlias = T | Sequence[T]


class StudyOptions(TypedDict, total=False):
    """What `bridge` and `hybrid` take by name; their docstrings say what each is."""

    structure: Structure | str | Path | None
    fixed_base: bool | None
    lines: Sequence[dict[str, Any]] | None
    weather: str | Path | None
    duration: float | None
    dt: float | None
    method: Method | None
    mass: MassModel | None
    damping: DampingKind | None
    scheme: Scheme | None
    integrator: Integrator | None
    hardening: Hardening | None
    small_loops: SmallLoops | None
    heat_source: HeatSource | None
    lead_ends: LeadEnds | None
    clock: Clock | None
    upper_face: EndFace | None
    lower_face: EndFace | None
    side: Side | None
    stack: Stacked | None
    model: Model | None
    exposure: Exposure | dict[str, Any] | None
    keep: Sequence[Kept] | None
    keep_every: int | None
    laboratory: Laboratory | dict[str, Any] | None
    initial_state: SpecimenState | None
    initial_result: Earlier | str | Path | None
    rig: Rig | str | Path | dict[str, Any] | None


def bridge(
    bearing: OneOrMore[Bearing | BilinearBearing | str | Path] | None = None,
    motion: OneOrMore[GroundMotion | Motion | str | Path | dict[str, Any]] | None = None,
    ambient: OneOrMore[float] | None = None,
    *,
    executor: Executor | None = None,
    progress: Progress | None = None,
    **options: Unpack[StudyOptions],
) -> EarthquakeResult:
    """A bridge pier on isolation bearings in earthquakes: every combination is one run.

    Parameters
    ----------
    bearing : one or several of: library name, TOML file, Bearing, BilinearBearing; the three
        bridge bearings of the library by default.
    motion : one or several of: built-in name, file, GroundMotion, or table with name, unit, dt,
        component, factor, label; four built-in ones by default.
    ambient : one or several temperatures [degC], in [-100, 100]; 23, 0 and -20 by default.
    structure : a Structure, the name of one, or a TOML file; "pier-p1" by default.
    fixed_base : leave out the springs of the foundation; what stands on them is held.
    lines : a table for each bearing line that differs from the others: its name `line`, and
        `bearing`, `count`, `ambient` (text with its unit), `weather`, `equivalent_stiffness`.
    weather : file of the temperature, a table or EPW, that ends when the earthquake begins,
        instead of `ambient`.
    duration : cut motions to this [s], in [0.001, 1e6].
    dt : largest time step [s], in [1e-6, 0.1]; 0.005 by default.
    method : "average-acceleration" (default), "linear-acceleration" or "predictor-corrector".
    mass : "consistent" (default) or "published".
    damping : "modal", "rayleigh", "element", "none" or "source"; by default what the structure
        says (pier-p1 and your own: modal; hybrid-pier: source).
    scheme : "conservative" (default) or "published" heat scheme.
    integrator : "exact" (default) or "euler" integration of Z.
    hardening : "printed" (default, Eq. 4.34), or "monotone": unloading that never goes up.
    small_loops : "published" (Eq. 4.35), after which a small reversal does not come back to the
        force where it began, or "closed": it does. By default that of the bearing, "published"
        unless it says otherwise.
    heat_source : "work" (Eq. 4.22) or "dissipation"; by default dissipation for natural rubber
        (LRB), which gives its elastic work back, and work for the others.
    lead_ends : how lead passes heat to steel: "finite-plate" (default) or "half-space"
        (Eq. 5.4-5.5), which the published scheme and the earlier models have.
    clock : of lead on a half-space, "lead" (Eq. 5.6 as printed) or "steel"; by default that of the
        bearing, or, if it says none, lead with the published scheme and steel otherwise.
    upper_face, lower_face : heat exchange of the end faces; eta_B = 2 by default, after weather a
        film of 12 W/(m2 K).
    side : heat exchange of the side, a `tb.model.Side`; by default the film of the bearing's
        materials, after weather 12 W/(m2 K) and 10 mm of cover rubber.
    stack : "auto" (default), "half" or "full" height.
    model : "multi-layer" (default) or an earlier model to compare with (model/earlier.py).
    exposure : factors for long cold and age, {"stiffness": 1.3, "strength": 1.2, "source": "..."};
        by default those of the bearing, which is none.
    keep : histories of temperatures: ["rubber"] by default; ["rubber", "cells"] for the profiles
        through the height too.
    keep_every : keep every n-th step of the histories, >= 1; 2 by default.
    laboratory : of a specimen in the loop, see `hybrid`; none by default.
    initial_state : where an earlier test left the one bearing; virgin by default.
    initial_result : the earlier result itself instead, of `run`, `hybrid` or `bridge`, or its
        directory; of several runs that of this bearing at this ambient temperature.
    rig : limits of force [kN], stroke [mm] and speed [mm/s] that are told when a run passes them:
        a name ("shen-rig"), a file or a table; none by default.
    executor : any `concurrent.futures` executor; threads by default.
    progress : called with (runs done, all runs).
    options : anything else is an InputError that says the nearest name.

    Returns
    -------
    EarthquakeResult

    Raises
    ------
    InputError : anything that cannot be used, named with what is allowed.

    Examples
    --------
    >>> study = bridge("shen-hdr-bridge", "jra-ii-i-1", [23, -20], duration=5)
    >>> warm, cold = study.table["bearing_strain_max"]
    >>> bool(cold < warm)
    True
    """
    given = {"bearings": bearing, "motions": motion, "ambient": ambient}
    return _study("bridge", given, options, executor, progress)


def hybrid(
    bearing: OneOrMore[Bearing | BilinearBearing | str | Path] | None = None,
    motion: OneOrMore[GroundMotion | Motion | str | Path | dict[str, Any]] | None = None,
    ambient: OneOrMore[float] | None = None,
    *,
    executor: Executor | None = None,
    progress: Progress | None = None,
    **options: Unpack[StudyOptions],
) -> EarthquakeResult:
    """A hybrid test, simulated: a specimen in the loop with a calculated pier.

    Parameters
    ----------
    bearing, motion, ambient : as of `bridge`; by default the two specimens of the library, one
        built-in motion of 20 s, and 23, 0 and -20 degC.
    structure : as of `bridge`; "hybrid-pier" by default.
    method : as of `bridge`; "predictor-corrector" by default, which moves the specimen once in
        each step.
    laboratory : a table with `mode`, "rt" (real time, the default), "pd" (the actuator moves
        at `speed`, "10 mm/s" by default, and the specimen lives on that slower clock) or both in
        a list, which makes two runs of each, beside each other in `modes_table`; `delay`
        of the actuator, `force_noise` (standard deviation of the measured force) and its
        `seed`; numbers as text with their unit.
    fixed_base, lines, weather, duration, dt, mass, damping, scheme, integrator : as of `bridge`.
    hardening, small_loops, heat_source, lead_ends, clock : as of `bridge`.
    upper_face, lower_face, side, stack, model, exposure : as of `bridge`.
    keep, keep_every, initial_state, initial_result, rig : as of `bridge`.
    executor, progress, options : as of `bridge`.

    Returns
    -------
    EarthquakeResult

    Raises
    ------
    InputError : anything that cannot be used, named with what is allowed.

    Examples
    --------
    >>> lab = {"mode": "pd", "delay": "10 ms"}
    >>> test = hybrid("shen-hdr-specimen", ambient=-20, duration=2, laboratory=lab)
    >>> test.outcome
    'completed'
    """
    given = {"bearings": bearing, "motions": motion, "ambient": ambient}
    return _study("hybrid", given, options, executor, progress)


def _study(
    command: Command,
    given: dict[str, Any],
    options: StudyOptions,
    executor: Executor | None,
    progress: Progress | None,
) -> EarthquakeResult:
    """What `bridge` and `hybrid` do with their arguments."""
    where = f"{command}()"
    known = {*StudyOptions.__annotations__, "bearing", "motion", "ambient", "executor", "progress"}
    misspelt = [name for name in options if name not in known]
    if misspelt:
        raise InputError([f'unknown key "{k}"{nearest(k, known)}' for k in misspelt], where)
    if options.get("weather") is not None:
        options["weather"] = str(options["weather"])
    case = make_earthquake_case({"command": command}, where, **given, **options)
    return run_earthquake(case, executor=executor, progress=progress)
