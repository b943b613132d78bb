"""Analyse bridges and hybrid tests for bearings, motions and ambient temperatures."""

import tomllib
from collections.abc import Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias, TypeVar, Unpack, get_args

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.state import RubberState, has_excess, opposite, scragging_of
from thermobearing.bearing.undecided import SMALL_LOOPS, UNDECIDED_OF, alternatives, undecided_of
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd, xr
from thermobearing.cyclic.case import Earlier, InitialState, Keep, Rig
from thermobearing.cyclic.protocol import CyclicTest
from thermobearing.cyclic.run import run
from thermobearing.earthquake.case import (
    AxialLevel,
    EarthquakeCase,
    Kept,
    Laboratory,
    make_earthquake_case,
)
from thermobearing.earthquake.motions import Motion
from thermobearing.earthquake.result import BANDS, COMPONENTS, EarthquakeResult
from thermobearing.earthquake.run import Progress, run_earthquake
from thermobearing.earthquake.tables import bands_frame, changes_by_run, components_frame
from thermobearing.model.axial import AxialFactor
from thermobearing.model.earlier import REFERENCE, Model, models_that_fit
from thermobearing.model.handover import SpecimenState
from thermobearing.model.limits import Limits
from thermobearing.model.options import ModelKeywords, ModelOptions, model_table
from thermobearing.model.outcomes import INTERRUPTED
from thermobearing.motions.pair import MotionPair
from thermobearing.motions.record import GroundMotion
from thermobearing.quantities.governing import place_of_largest
from thermobearing.quantities.validity import stable_rows
from thermobearing.results.writing import as_attribute
from thermobearing.structure.model import DampingKind, MassModel, Structure
from thermobearing.structure.run import Method

T = TypeVar("T")
OneOrMore: TypeAlias = T | Sequence[T]
AnyMotion: TypeAlias = GroundMotion | MotionPair | Motion | str | Path | dict[str, Any]


class EarthquakeKeywords(ModelKeywords, total=False):
    """What `bridge` and `hybrid` take besides: loads, limits, and fields of their options."""

    axial_force: float | None
    axial: AxialLevel | None
    axial_factor: AxialFactor | None
    limits: Limits | str | Path | dict[str, Any] | None
    fixed_base: bool | None
    duration: float | None
    dt: float | None
    method: Method | None
    mass: MassModel | None
    damping: DampingKind | None


@checked
def bridge(
    bearing: OneOrMore[Bearing | BilinearBearing | str | Path] | None = None,
    motion: OneOrMore[AnyMotion] | None = None,
    ambient: OneOrMore[float] | str | Path | None = None,
    *,
    structure: Structure | str | Path | dict[str, Any] | None = None,
    lines: Sequence[dict[str, Any]] | None = None,
    model: ModelOptions | Model | None = None,
    initial: InitialState | SpecimenState | Earlier | str | Path | None = None,
    keep: Keep | Sequence[Kept] | None = None,
    rig: Rig | str | Path | dict[str, Any] | None = None,
    components: int | Sequence[int] | None = None,
    bands: bool = False,
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
        `bearing`, `count`, `ambient` (text with its unit), `weather`, `equivalent_stiffness`,
        `state` (of its rubber: "tested", "virgin" or "recovered after 5 years"), `axial` (a table
        of its axial forces: `dead_load`, `places` and others).
    model : `ModelOptions`, or the name of an earlier model to compare with (model/earlier.py);
        "multi-layer" by default.
    initial : an earlier result of the one bearing, of `run`, `hybrid` or `bridge`, its directory,
        or its state (`end_state`); none by default. Of several runs that of this bearing at
        this ambient temperature counts.
    keep : histories of temperatures: ["rubber"] by default; ["rubber", "cells"] for the profiles
        through the height too. `Keep` also states the interval of steps (2 by default).
    rig : limits of force [kN], stroke [mm] and speed [mm/s]; a warning says which a run exceeds:
        a name ("shen-rig"), a file or a table; none by default.
    axial_force : on one bearing [kN], positive in compression, in [-1e6, 1e6]; a table of `lines`
        may have its own (text with its unit). It changes no motion; the result then has checks of
        stress and critical load.
    axial : axial forces that act on the shear force, of lines with a table `axial`: "off"
        (default), "dead" (constant), "overturning" or "vertical" (with the vertical motion too).
    axial_factor : what their part in the shear force counts on: "overlap" (default) of top and
        bottom, or "potential".
    limits : limits of checks that an office has confirmed, a file or a table by code and check, for
        `check_bearings`.
    components : of a structure in plan: horizontal components of the ground motion that act
        together, 2 by default in plan; with 1 each direction is analysed on its own. With both
        in a list they are compared in `result.one_component` and a table.
    bands : also analyse what tests do not decide, the rate dependence above their rates and small
        loops, and state how much it changes peaks and energy, in `result.bands`.
    executor : any `concurrent.futures` executor; threads by default.
    progress : called with (runs done, all runs).
    fixed_base : omit the foundation springs; bodies on them are fixed.
    duration : cut motions to this [s], in [0.001, 1e6].
    dt : largest time step [s], in [1e-6, 0.1]; 0.005 by default.
    method : "average-acceleration" (default), "linear-acceleration" or "predictor-corrector".
    mass : "consistent" (default) or "published".
    damping : "modal", "rayleigh", "element", "none" or "source"; by default that of the structure
        (pier-p1 and your own: modal; hybrid-pier: source).
    exposure, state : fields of `ModelOptions`, in place of those of `model`.

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
    table |= {"structure": structure, "lines": lines, "rig": rig, "bands": bands or None}
    table |= one_or_both(components)
    case = make_earthquake_case({"command": "bridge"}, "bridge()", **table)
    return analyse(case, executor=executor, progress=progress)


def analyse(
    case: EarthquakeCase,
    *,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> EarthquakeResult:
    """Return the result of a case, with the further analyses that it states."""
    if case.compare:
        refuse_incomparable(case)
    run = compare_components if case.compare_components else run_earthquake
    result = run(case, executor=executor, progress=progress)
    if case.bands and result.outcome != INTERRUPTED:
        result = with_bands(result, case, executor=executor, progress=progress)
    if case.compare and result.outcome == "completed":
        result.compared = compare_models(case)
    return result


def one_or_both(components: Any) -> dict[str, Any]:
    """Return what a case states for one or several numbers of components."""
    if not isinstance(components, list | tuple):  # the case checks one
        return {"components": components}
    if len(components) > 1 and sorted(components) != [1, 2]:
        raise InputError(f"components = {components!r}: must be 1, 2, or both")
    both = len(components) > 1 or None
    return {"components": max(components) if components else None, "compare_components": both}


@checked
def hybrid(
    bearing: OneOrMore[Bearing | BilinearBearing | str | Path] | None = None,
    motion: OneOrMore[AnyMotion] | None = None,
    ambient: OneOrMore[float] | str | Path | None = None,
    *,
    structure: Structure | str | Path | dict[str, Any] | None = None,
    lines: Sequence[dict[str, Any]] | None = None,
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
        `seed`; numbers as text with their unit. Its `specimen` is the address of a specimen or
        program outside, "tcp://HOST:PORT", which moves and gives the force in place of the
        modelled bearing of the reported line (wire format of OpenSees' genericClient, one degree
        of freedom at two nodes, mm and kN); with `time_out`, `force_limit` and
        `displacement_limit`. There is one run then; force and energy are measured, temperatures
        are those of `bearing`, calculated along its path.
    lines, model, initial, keep, rig, executor, progress : as of `bridge`.
    method : as of `bridge`; "predictor-corrector" by default, which moves the specimen once in
        each step.
    limits, axial, axial_factor : not of a hybrid test.
    axial_force, fixed_base, duration, dt, mass, damping, exposure, state : as of `bridge`.

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
    if (start.temperature, start.lead, start.conditioning) != (None, None, None):
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


@checked
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
    if not several:
        raise InputError("bearing: needs a bearing or several", "sweep()")
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
            model_case = case.model_copy(update={"analysis": analysis, "bearings": fitting})
            results[model] = run_earthquake(model_case)
    return results


def compare_components(
    case: EarthquakeCase, *, executor: Executor | None = None, progress: Progress | None = None
) -> EarthquakeResult:
    """Return the result with two components, that with one at a time as its `one_component`."""
    # Two components first: faults of its case, such as a structure in one direction, stop both.
    cases = [
        case.model_copy(update={"analysis": case.analysis.model_copy(update={"components": count})})
        for count in (2, 1)
    ]
    faults = cases[0].faults()
    if not any(motion.is_pair or motion.angle is not None for motion in case.motions):
        faults.append("components: no motion has a component across the bridge; give pairs")
    if faults:
        raise InputError(faults, case.command)
    result, single = (
        run_earthquake(component_case, executor=executor, progress=progress)
        for component_case in cases
    )
    rows = as_attribute(components_frame(result, single).to_dict("records"))
    result = EarthquakeResult(result.dataset.assign_attrs({COMPONENTS: rows}))
    result.one_component = single
    return result


def with_bands(
    result: EarthquakeResult,
    case: EarthquakeCase,
    *,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> EarthquakeResult:
    """Return a result with the bands of what tests do not decide, from analyses of the same case.

    Every layered bearing has each of its `alternatives` once. One that the case does not allow,
    such as closed small loops in a plane, is left out.
    """
    law = case.analysis.small_loops
    devices = [*case.bearings, *(line.bearing for line in case.lines)]
    layered = [bearing for bearing in devices if isinstance(bearing, Bearing)]
    pairs = dict.fromkeys(key for bearing in layered for key in alternatives(bearing, law))
    rows: list[dict[str, Any]] = []
    on_lines = [line.bearing for line in case.lines if line.bearing is not None]
    concerned = {bearing.name: undecided_of([bearing, *on_lines], law) for bearing in case.bearings}
    for undecided, alternative in pairs:

        def _changed(device: Any, key: tuple[str, str] = (undecided, alternative)) -> Any:
            return alternatives(device, law).get(key) if isinstance(device, Bearing) else None

        changed = [_changed(bearing) for bearing in case.bearings]
        # Bearings without this alternative are not run again, unless lines have bearings of their
        # own: those may have it, and are on a bridge with every bearing of the analysis.
        if case.lines:
            changed = [new or bearing for new, bearing in zip(changed, case.bearings, strict=True)]
        lines = [
            line.model_copy(update={"bearing": _changed(line.bearing) or line.bearing})
            for line in case.lines
        ]
        # A law of small loops stated for the analysis would replace that of the changed bearings.
        law_changes = {"small_loops": None} if undecided == SMALL_LOOPS else {}
        changed_case = case.model_copy(
            update={
                "bearings": [bearing for bearing in changed if bearing is not None],
                "lines": tuple(lines),
                "analysis": case.analysis.model_copy(update=law_changes),
            }
        )
        if not changed_case.bearings or changed_case.faults():
            continue
        changed_result = run_earthquake(changed_case, executor=executor, progress=progress)
        changes = changes_by_run(result, changed_result, undecided)
        rows += [
            row | {UNDECIDED_OF: concerned[row["bearing"]][undecided]}
            for row in changes
            if undecided in concerned[row["bearing"]]
        ]
    bands = as_attribute(bands_frame(rows).to_dict("records"))
    banded = EarthquakeResult(result.dataset.assign_attrs({BANDS: bands}), result.compared)
    banded.one_component = result.one_component
    return banded


FORCE, STRAIN, DUCTILITY = "bearing_force_max_kN", "bearing_strain_max", "pier_ductility"


class OtherPeak(NamedTuple):
    """The largest value of a peak in an analysis, and with rubber in another state."""

    column: str  # of the table of runs
    place: int  # of its run in the analysis
    other_place: int  # of the run with the other state that has the largest, among these runs


class OtherBound(NamedTuple):
    """Runs of an analysis with rubber in the state of the other bound."""

    state: RubberState
    assumed: bool  # whether its scragging is that of another compound
    result: EarthquakeResult  # of these runs
    peaks: list[OtherPeak]


def run_other_bound(result: EarthquakeResult) -> OtherBound | None:
    """Run a bridge again with rubber in the state of the other bound, where that governs.

    Virgin rubber is the bound of forces and of the demand on piers, tested rubber that of
    displacements: an analysis of tested rubber gets the largest force and ductility of virgin
    rubber, any other the largest strain of tested rubber. Rubber in another state may have its
    largest peak in another motion: the runs are those of all layered bearings and motions, at the
    ambient temperatures of the governing runs and at the coldest (of tested rubber the warmest).
    None for hybrid tests, bilinear bearings and models, rubber that is as stiff while virgin, and
    a bearing that an earlier test left.
    """
    table = tomllib.loads(result.dataset.attrs["case"])
    if table["command"] != "bridge" or "initial_state" in table:
        return None
    case = make_earthquake_case(table, "result")
    bearings = {bearing.name: bearing for bearing in _warm_bearings(case)}
    layered = result.table["bearing"].isin(list(bearings))
    if case.analysis.model == "bilinear" or not layered.any():
        return None
    devices = [*bearings.values(), *(item.bearing for item in case.lines)]
    stiffer = [device for device in devices if isinstance(device, Bearing) and has_excess(device)]
    if not stiffer:
        return None
    state = opposite(case.analysis.state, stiffer[0])
    places = {
        column: int(rows.index[place_of_largest(rows[column])])
        for column in ((FORCE, DUCTILITY) if state.share else (STRAIN,))
        if len(rows := stable_rows(result.table[layered & result.table[column].notna()]))
    }
    if not places:
        return None
    update: dict[str, Any] = {"bearings": list(bearings.values())}
    if case.weather is None:
        outermost = min(case.ambient) if state.share else max(case.ambient)
        governing = {float(result.table["ambient_degC"][place]) for place in places.values()}
        chosen = governing | {outermost}
        update["ambient"] = [ambient for ambient in case.ambient if ambient in chosen]
    other = run_earthquake(case.model_copy(update=update).with_state(state))
    peaks = [
        OtherPeak(column, place, int(rows.index[place_of_largest(rows[column])]))
        for column, place in places.items()
        if len(rows := stable_rows(other.table[other.table[column].notna()]))
    ]
    assumed = state.share > 0.0 and any(scragging_of(device)[1] for device in stiffer)
    return OtherBound(state, assumed, other, peaks)


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
