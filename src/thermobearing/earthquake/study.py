"""Analyse bridges and hybrid tests for bearings, motions and ambient temperatures."""

from collections.abc import Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import Any, TypeAlias, TypedDict, TypeVar, Unpack, get_args

import pandas as pd
import xarray as xr

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.exposure import Exposure
from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing, Clock, SmallLoops
from thermobearing.border.errors import InputError, nearest
from thermobearing.cyclic.case import Earlier, Rig
from thermobearing.cyclic.protocol import CyclicTest
from thermobearing.cyclic.run import run
from thermobearing.earthquake.case import (
    Command,
    EarthquakeCase,
    Kept,
    Laboratory,
    make_earthquake_case,
)
from thermobearing.earthquake.inputs import Motion
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.run import Progress, run_earthquake
from thermobearing.model.constants import Hardening, HeatSource, Integrator, LeadEnds
from thermobearing.model.earlier import REFERENCE, Model, models_that_fit
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
    side : heat exchange of the side, a `tb.Side`; by default the film of the bearing's
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


Named = Bearing | str | Path


def sweep(
    bearing: Named | Sequence[Named],
    *,
    test: CyclicTest | None = None,
    motion: Any = None,
    ambient: float | Sequence[float] = 23.0,
    **options: Any,
) -> xr.Dataset:
    """Bearings, motions and temperatures, every combination: one labelled dataset.

    With a motion the dataset is that of `bridge(...).to_dataset()`: every peak and history with
    the dimensions bearing, motion and ambient. With a test it has the measures of each cycle
    with the dimensions bearing, ambient, strain and cycle, see `Result.to_dataset`.

    Parameters
    ----------
    bearing : one or several: a Bearing, a library name, or a TOML file.
    test : cyclic test of each; Table 3.4 without a test and a motion.
    motion : one or several, as of `bridge`; instead of a test.
    ambient : one or several temperatures [degC], in [-100, 100].
    options : any of `run` (with a test) or of `bridge` (with a motion).

    Returns
    -------
    xarray.Dataset

    Raises
    ------
    InputError : a test and a motion, or what `run` and `bridge` refuse.

    Examples
    --------
    >>> import thermobearing as tb
    >>> names = ["shen-hdr-specimen", "shen-lhdr-specimen"]
    >>> test = tb.cyclic_test(strain=[0.5, 1.0], cycles=2, rest=None)
    >>> found = sweep(names, test=test, ambient=[-20, 23])
    >>> dict(found.sizes) == {"bearing": 2, "ambient": 2, "strain": 2, "cycle": 2}
    True
    >>> cold, warm = found.G_eq_MPa.sel(bearing="shen-hdr-specimen", strain=1.0, cycle=2).values
    >>> bool(cold > warm)
    True
    """
    if test is not None and motion is not None:
        raise InputError("give a test or a motion, not both", "sweep()")
    if motion is not None:
        return bridge(bearing, motion, ambient, **options).to_dataset()
    several = list(bearing) if isinstance(bearing, list | tuple) else [bearing]
    bearings = [as_bearing(item) for item in several]
    names = [item.name for item in bearings]
    if len(set(names)) < len(names):
        raise InputError(f"bearing: each needs a name of its own; got {names}", "sweep()")
    parts = [run(item, test, ambient, **options).to_dataset() for item in bearings]
    return xr.concat(
        parts, pd.Index(names, name="bearing"), join="outer", data_vars="all", combine_attrs="drop"
    )


def compare_models(
    case: EarthquakeCase,
    *,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> dict[str, EarthquakeResult]:
    """Results of models by name, the multi-layer one first.

    Each model makes its own motion of the structure. Bilinear bearings are left out: they have no
    heat. A model is run for the bearings that it fits (`lead-alone` needs lead).

    Parameters
    ----------
    case : with the conservative scheme and automatic stack, as earlier models use them.
    executor : any `concurrent.futures` executor; threads by default.
    progress : called with (runs done, all runs) of each model.

    Returns
    -------
    dict of EarthquakeResult

    Raises
    ------
    InputError : all bearings are bilinear; or scheme, stack or model are not those.

    Examples
    --------
    >>> from thermobearing.earthquake.case import make_earthquake_case
    >>> table = {"command": "hybrid", "bearings": ["shen-hdr-specimen"], "ambient": ["0 degC"]}
    >>> results = compare_models(make_earthquake_case(table | {"duration": "1 s"}, "example"))
    >>> list(results)[:2], "lead-alone" in results
    (['multi-layer', 'adiabatic'], False)
    """
    refuse_incomparable(case)
    results: dict[str, EarthquakeResult] = {}
    for model in get_args(Model):
        fitting = [bearing for bearing in _warm_bearings(case) if model in models_that_fit(bearing)]
        if fitting:
            analysis = case.analysis.model_copy(update={"model": model})
            mine = case.model_copy(update={"analysis": analysis, "bearings": fitting})
            results[model] = run_earthquake(mine, executor=executor, progress=progress)
    return results


def _warm_bearings(case: EarthquakeCase) -> list[Bearing]:
    """Those that have heat."""
    return [bearing for bearing in case.bearings if isinstance(bearing, Bearing)]


def refuse_incomparable(case: EarthquakeCase) -> None:
    """InputError for a study that earlier models cannot be compared in."""
    options, faults = case.analysis, []
    if not _warm_bearings(case):
        faults.append("bearings: all are bilinear, which no earlier model changes")
    if options.model != REFERENCE:
        faults.append(f'analysis.model = "{options.model}": all models are run; leave it out')
    if options.scheme != "conservative":
        faults.append(f'analysis.scheme = "{options.scheme}": earlier models need "conservative"')
    if options.stack == "half":
        faults.append('analysis.stack = "half": earlier models with one cell need "auto"')
    if faults:
        raise InputError([f"{fault} (asked for by --compare)" for fault in faults], case.command)
