"""Analyse bridges and hybrid tests for bearings, motions and ambient temperatures."""

from collections.abc import Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import Any, TypeAlias, TypeVar, Unpack, get_args

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.border.keywords import checked_keywords
from thermobearing.border.lazy import pd, xr
from thermobearing.cyclic.case import Earlier, InitialState, Keep, Rig
from thermobearing.cyclic.protocol import CyclicTest
from thermobearing.cyclic.run import run
from thermobearing.earthquake.case import EarthquakeCase, Kept, Laboratory, make_earthquake_case
from thermobearing.earthquake.motions import Motion
from thermobearing.earthquake.result import COMPONENTS, EarthquakeResult
from thermobearing.earthquake.run import Progress, run_earthquake
from thermobearing.earthquake.tables import components_frame
from thermobearing.model.earlier import REFERENCE, Model, models_that_fit
from thermobearing.model.handover import SpecimenState
from thermobearing.model.options import ModelKeywords, ModelOptions, model_table
from thermobearing.motions.pair import MotionPair
from thermobearing.motions.record import GroundMotion
from thermobearing.results.writing import as_attribute
from thermobearing.structure.model import DampingKind, MassModel, Structure
from thermobearing.structure.run import Method

T = TypeVar("T")
OneOrMore: TypeAlias = T | Sequence[T]
AnyMotion: TypeAlias = GroundMotion | MotionPair | Motion | str | Path | dict[str, Any]


class EarthquakeKeywords(ModelKeywords, total=False):
    """What `bridge` and `hybrid` take besides: `axial_force`, and fields of their options."""

    axial_force: float | None
    fixed_base: bool | None
    duration: float | None
    dt: float | None
    method: Method | None
    mass: MassModel | None
    damping: DampingKind | None


@checked_keywords
def bridge(
    bearing: OneOrMore[Bearing | BilinearBearing | str | Path] | None = None,
    motion: OneOrMore[AnyMotion] | None = None,
    ambient: OneOrMore[float] | str | Path | None = None,
    *,
    structure: Structure | str | Path | None = None,
    lines: Sequence[dict[str, Any]] | None = None,
    model: ModelOptions | Model | None = None,
    initial: InitialState | SpecimenState | Earlier | str | Path | None = None,
    keep: Keep | Sequence[Kept] | None = None,
    rig: Rig | str | Path | dict[str, Any] | None = None,
    components: int | Sequence[int] | None = None,
    executor: Executor | None = None,
    progress: Progress | None = None,
    **options: Unpack[EarthquakeKeywords],
) -> EarthquakeResult:
    """Analyse a bridge pier on isolation bearings in earthquakes: every combination is one run.

    Parameters
    ----------
    bearing : one or several of: library name, TOML file, Bearing, BilinearBearing; the three
        bridge bearings of the library by default.
    motion : one or several of: built-in name, file, GroundMotion, MotionPair, or table with
        name, unit, dt, component, across, angle, factor, label; four built-in ones by default.
    ambient : one or several temperatures [degC], in [-100, 100]; 23, 0 and -20 by default. Or a
        weather file, a table or EPW, that ends when the earthquake begins; faces and sides of the
        bearings then have a film of 12 W/(m2 K), sides 10 mm of cover rubber.
    structure : a Structure, the name of one, or a TOML file; "pier-p1" by default.
    lines : a table for each bearing line that differs from the others: its name `line`, and
        `bearing`, `count`, `ambient` (text with its unit), `weather`, `equivalent_stiffness`.
    model : `ModelOptions`, or the name of an earlier model to compare with (model/earlier.py);
        "multi-layer" by default.
    initial : an earlier result of the one bearing, of `run`, `hybrid` or `bridge`, its directory,
        or its state (`end_state`); virgin by default. Of several runs that of this bearing at
        this ambient temperature counts.
    keep : histories of temperatures: ["rubber"] by default; ["rubber", "cells"] for the profiles
        through the height too. `Keep` also states the interval of steps (2 by default).
    rig : limits of force [kN], stroke [mm] and speed [mm/s]; a warning says which a run exceeds:
        a name ("shen-rig"), a file or a table; none by default.
    axial_force : on one bearing [kN], positive in compression, in [-1e6, 1e6]; a table of `lines`
        may have its own (text with its unit). It changes no motion; the result then has checks of
        stress and critical load.
    components : of a structure in plan: horizontal components of the ground motion that act
        together, 2 by default in plan; with 1 each direction is analysed on its own. With both
        in a list they are compared in `result.one_component` and a table.
    executor : any `concurrent.futures` executor; threads by default.
    progress : called with (runs done, all runs).
    fixed_base : omit the foundation springs; bodies on them are fixed.
    duration : cut motions to this [s], in [0.001, 1e6].
    dt : largest time step [s], in [1e-6, 0.1]; 0.005 by default.
    method : "average-acceleration" (default), "linear-acceleration" or "predictor-corrector".
    mass : "consistent" (default) or "published".
    damping : "modal", "rayleigh", "element", "none" or "source"; by default that of the structure
        (pier-p1 and your own: modal; hybrid-pier: source).
    options : fields of `ModelOptions`, such as scheme or lead_ends.

    Raises
    ------
    InputError : invalid input; the message names the key and the allowed range.

    Examples
    --------
    >>> found = bridge("shen-hdr-bridge", "jra-ii-i-1", [23, -20], duration=5)
    >>> warm, cold = found.table["bearing_strain_max"]
    >>> bool(cold < warm)
    True
    """
    table = _table(bearing, motion, ambient, model, initial, keep, options)
    table |= {"structure": structure, "lines": lines, "rig": rig}
    table["components"], several = one_or_both(components)
    case = make_earthquake_case({"command": "bridge"}, "bridge()", **table)
    run = compare_components if several else run_earthquake
    return run(case, executor=executor, progress=progress)


def one_or_both(components: Any) -> tuple[Any, bool]:
    """Return the number of components of a case, and whether one and two are compared."""
    if not isinstance(components, list | tuple):  # the case checks one
        return components, False
    if len(components) > 1 and sorted(components) != [1, 2]:
        raise InputError(f"components = {components!r}: must be 1, 2, or both")
    return (max(components) if components else None), len(components) > 1


@checked_keywords
def hybrid(
    bearing: OneOrMore[Bearing | BilinearBearing | str | Path] | None = None,
    motion: OneOrMore[AnyMotion] | None = None,
    ambient: OneOrMore[float] | str | Path | None = None,
    *,
    structure: Structure | str | Path | None = None,
    lines: Sequence[dict[str, Any]] | None = None,
    specimen: str | None = None,
    laboratory: Laboratory | dict[str, Any] | None = None,
    model: ModelOptions | Model | None = None,
    initial: InitialState | SpecimenState | Earlier | str | Path | None = None,
    keep: Keep | Sequence[Kept] | None = None,
    rig: Rig | str | Path | dict[str, Any] | None = None,
    executor: Executor | None = None,
    progress: Progress | None = None,
    **options: Unpack[EarthquakeKeywords],
) -> EarthquakeResult:
    """Simulate a hybrid test: a specimen in the loop with a calculated pier.

    Parameters
    ----------
    bearing, motion, ambient : as of `bridge`; by default the two specimens of the library, one
        built-in motion of 20 s, and 23, 0 and -20 degC.
    structure : as of `bridge`; "hybrid-pier" by default.
    laboratory : a table with `mode`, "rt" (real time, the default), "pd" (the actuator moves
        at `speed`, "10 mm/s" by default, on a slower clock) or both in a list, compared in
        `modes_table`; `delay` of the actuator, `compensation` (order of the extrapolation of the
        command by the delay), `force_noise` (standard deviation of the measured force) and its
        `seed`; with a specimen also `time_out`, `force_limit` and `displacement_limit`; numbers as
        text with their unit.
    specimen : address of a specimen or program outside, "tcp://HOST:PORT", which moves and gives
        the force in place of the modelled bearing of the reported line (wire format of OpenSees'
        genericClient, one degree of freedom at two nodes, mm and kN). There is one run then; force
        and energy are measured, temperatures are those of `bearing`, calculated along its path.
    lines, model, initial, keep, rig, executor, progress : as of `bridge`.
    method : as of `bridge`; "predictor-corrector" by default, which moves the specimen once in
        each step.
    axial_force, fixed_base, duration, dt, mass, damping, options : as of `bridge`.

    Raises
    ------
    InputError : invalid input; the message names the key and the allowed range.

    Examples
    --------
    >>> lab = {"mode": "pd", "delay": "10 ms"}
    >>> test = hybrid("shen-hdr-specimen", ambient=-20, duration=2, laboratory=lab)
    >>> test.outcome
    'completed'
    """
    table = _table(bearing, motion, ambient, model, initial, keep, options)
    if isinstance(laboratory, Laboratory):
        laboratory = laboratory.model_dump(exclude_unset=True)
    if specimen is not None:
        laboratory = {**(laboratory or {}), "specimen": specimen}
    table |= {
        "structure": structure,
        "lines": lines,
        "rig": rig,
        "laboratory": laboratory,
    }
    case = make_earthquake_case({"command": "hybrid"}, "hybrid()", **table)
    return run_earthquake(case, executor=executor, progress=progress)


def _table(
    bearing: Any,
    motion: Any,
    ambient: Any,
    model: ModelOptions | Model | None,
    initial: Any,
    keep: Any,
    options: EarthquakeKeywords,
) -> dict[str, Any]:
    """Return what `bridge` and `hybrid` have in common as keys of a case."""
    weather = isinstance(ambient, str | Path)
    start = InitialState.of(initial)
    if start.temperature is not None or start.lead is not None:
        rule = "begins at the ambient temperature, or where an earlier result ends"
        raise InputError(f"initial = {initial!r}: an earthquake {rule}")
    return {
        "bearings": bearing,
        "motions": motion,
        "ambient": None if weather else ambient,
        "weather": str(ambient) if weather else None,
        **start.table(),
        **Keep.of(keep).table(),
        **model_table(model, options),
    }


Named = Bearing | str | Path


def sweep(
    bearing: Named | Sequence[Named],
    *,
    test: CyclicTest | None = None,
    motion: Any = None,
    ambient: float | Sequence[float] = 23.0,
    **options: Any,
) -> "xr.Dataset":
    """Return one labelled dataset of all combinations of bearings, motions and temperatures.

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
        raise InputError(f"bearing: names must be unique; got {names}", "sweep()")
    parts = [run(item, test, ambient, **options).to_dataset() for item in bearings]
    return xr.concat(
        parts, pd.Index(names, name="bearing"), join="outer", data_vars="all", combine_attrs="drop"
    )


def compare_models(case: EarthquakeCase) -> dict[str, EarthquakeResult]:
    """Return the results of each model for the bearings that it fits, the multi-layer one first.

    Each model makes its own motion of the structure. Bilinear bearings, without heat, are left out.
    """
    refuse_incomparable(case)
    results: dict[str, EarthquakeResult] = {}
    for model in get_args(Model):
        fitting = [bearing for bearing in _warm_bearings(case) if model in models_that_fit(bearing)]
        if fitting:
            analysis = case.analysis.model_copy(update={"model": model})
            mine = case.model_copy(update={"analysis": analysis, "bearings": fitting})
            results[model] = run_earthquake(mine)
    return results


def compare_components(
    case: EarthquakeCase, *, executor: Executor | None = None, progress: Progress | None = None
) -> EarthquakeResult:
    """Return the result with two components, that with one at a time as its `one_component`."""
    cases = [
        case.model_copy(update={"analysis": case.analysis.model_copy(update={"components": count})})
        for count in (2, 1)
    ]
    faults = cases[0].faults()
    if not any(motion.is_pair or motion.angle is not None for motion in case.motions):
        faults.append("components: no motion has a component across the bridge; give pairs")
    if faults:
        raise InputError(faults, case.command)
    found, one = (run_earthquake(own, executor=executor, progress=progress) for own in cases)
    rows = as_attribute(components_frame(found, one).to_dict("records"))
    found = EarthquakeResult(found.dataset.assign_attrs({COMPONENTS: rows}))
    found.one_component = one
    return found


def _warm_bearings(case: EarthquakeCase) -> list[Bearing]:
    return [bearing for bearing in case.bearings if isinstance(bearing, Bearing)]


def refuse_incomparable(case: EarthquakeCase) -> None:
    """Refuse a case without the scheme, stack and bearings that earlier models have."""
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
        raise InputError([f"{fault} (required by --compare)" for fault in faults], case.command)
