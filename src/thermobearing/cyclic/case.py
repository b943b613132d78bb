"""A displacement-controlled test as data: bearing, steps, options, initial state and rig.

The same record is read from CASE.toml, built by `run(...)` in Python, and written as
case.resolved.toml in every result; running that file again gives the same bits.
"""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal, Protocol, runtime_checkable

import numpy as np
from pydantic import AfterValidator, Field

from thermobearing.bearing.library import BEARINGS, as_bearing, load_bearing
from thermobearing.bearing.model import AxialForce, Bearing
from thermobearing.border.arguments import checked
from thermobearing.border.cases import absolute, load_all, read_case
from thermobearing.border.errors import InputError
from thermobearing.border.lazy import xr
from thermobearing.border.library import Library, Sourced, sources_to_keep
from thermobearing.border.schema import Name, Strict, in_unit, overridden, text_with_unit, updated
from thermobearing.border.title import case_table
from thermobearing.border.toml import split_sources, to_table, to_toml
from thermobearing.climate.readers import read_air
from thermobearing.core.records import Floats, labels
from thermobearing.core.types import BearingResponse
from thermobearing.cyclic.conditioning import conditioning_faults, filled, soaked_start
from thermobearing.cyclic.protocol import CyclicTest, cyclic_test, survey
from thermobearing.model.axial import AxialFactor
from thermobearing.model.earlier import ONE_CELL
from thermobearing.model.effort import too_much
from thermobearing.model.handover import (
    MEMORY,
    OF_LOOPS,
    PREFIX,
    SpecimenState,
    misfit,
    specimen_state,
)
from thermobearing.model.options import ModelOptions, build_model, line_only_faults
from thermobearing.quantities.warned import EXCEEDED, Warned
from thermobearing.results.ranges import Row, compared
from thermobearing.tables.conditioning import Conditioning

TEXTS = ("name", "description", "citation")  # of a bearing: nothing that it does


@runtime_checkable
class Earlier(Protocol):
    """A result of any analysis that leaves bearings behind, which stand in its dataset."""

    @property
    def dataset(self) -> "xr.Dataset":
        """Histories, ends and the case."""


@dataclass(frozen=True)
class InitialState:
    """Initial state of a bearing: a temperature, or the end of an earlier analysis.

    Attributes
    ----------
    temperature : uniform, or one per cell, upper face first [degC]; the ambient temperature by
        default.
    lead : temperature of the lead [degC]; that of the adjacent cells by default.
    result : an earlier result of the same bearing (of `run`, `hybrid` or `bridge`), or its
        directory: the bearing continues where that one ended, with temperatures, forces and
        history. Or its state, from `end_state`.
    conditioning : a table in place of these, of a specimen that had not reached the temperature of
        its chamber: the cells start at temperatures of the soaking model. Its keys are
        `conditioned`, the time in the chamber before the test [h], in (0, 10000]; `before`, the
        uniform temperature with which the specimen came [degC], 23 by default; `inside` and
        `inside_place`, the reading of a thermocouple when the test begins [degC] and its place,
        "rubber 1" (the outer layer), ... or "lead"; `chamber_film`, the film coefficient between
        specimen and air [W/(m^2 K)], 12 by default.
    """

    temperature: float | Sequence[float] | None = None
    lead: float | None = None
    result: "Earlier | SpecimenState | str | Path | None" = None
    conditioning: Mapping[str, Any] | None = None

    @classmethod
    def of(cls, value: Any) -> "InitialState":
        """Return a record of what may stand for one: a temperature, a result, a directory."""
        if isinstance(value, InitialState):
            return value
        is_result = isinstance(value, Earlier | SpecimenState | str | Path)
        return cls(result=value) if is_result else cls(temperature=value)

    def table(self) -> dict[str, Any]:
        """Return the same as keys of a case."""
        uniform = self.temperature is None or np.ndim(self.temperature) == 0
        state = isinstance(self.result, SpecimenState)
        return {
            "initial": self.temperature if uniform else None,
            "initial_profile": None if uniform else self.temperature,
            "initial_lead": self.lead,
            "initial_state": self.result if state else None,
            "initial_result": None if state else self.result,
            **(self.conditioning or {}),
        }


@dataclass(frozen=True)
class Keep:
    """Which histories a result holds.

    Attributes
    ----------
    groups : of "rubber", "layer_displacement", "hysteretic" and "cells", in addition to
        displacement, force and energy; of an earthquake "rubber" and, for profiles, "cells".
    every : keep every n-th step, and all turning points of a test.
    histories : in the files of `save`: "thinned" (default), turning points and 200 points a
        cycle, or "complete".
    """

    groups: Sequence[str] | None = None
    every: int | None = None
    histories: str | None = None

    @classmethod
    def of(cls, value: Any) -> "Keep":
        """Return a record of what may stand for one: a list of groups, or None."""
        return value if isinstance(value, Keep) else cls(groups=value)

    def table(self) -> dict[str, Any]:
        """Return the same as keys of a case."""
        return {"keep": self.groups, "keep_every": self.every, "histories": self.histories}


def settle_start(
    table: dict[str, Any], start_keys: Sequence[str]
) -> "tuple[list[str], xr.Dataset | None]":
    """Return faults of the start in a case, and the dataset that `initial_result` stands for."""
    set_keys = [key for key in start_keys if key in table]
    if len(set_keys) > 1:
        return [f"give only one of {', '.join(start_keys)}; got {set_keys}"], None
    result = table.pop("initial_result", None)
    if result is None or isinstance(result, Earlier):
        return [], None if result is None else result.dataset
    if not isinstance(result, str | Path) or not str(result):
        return [f"initial_result = {result!r}: must be the path of a result"], None
    from thermobearing.results.saved import read_dataset  # imports xarray

    try:
        return [], read_dataset(result, ("case",))
    except InputError as error:
        return error.lines("initial_result"), None


def left_by(
    data: "xr.Dataset", bearing: Bearing, ambient: list[float], where: str
) -> SpecimenState:
    """Return where an earlier result left a bearing, in the run at the same ambient temperature."""
    name, fault = _matching_bearing(data, bearing)
    try:
        state = final_state(data, ambient, name)
        if fault and state.complete:
            raise InputError(fault)
    except InputError as error:
        raise InputError(error.lines("initial_result"), where) from None
    return state


@checked
def end_state(
    result: Earlier | str | Path, bearing: Bearing | str | Path, ambient: float | None = None
) -> SpecimenState:
    """Return the final state of a bearing, for `tb.element(bearing, initial=...)`.

    Parameters
    ----------
    result : of a test, or of `bridge` or `hybrid` on one bearing line; or its directory.
    bearing : the same bearing, to which forces and history belong.
    ambient : which run, if the result has several [degC].

    Returns
    -------
    SpecimenState : displacement, forces, temperatures and history.

    Raises
    ------
    InputError : no such result, another bearing, or several runs.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[1.0], cycles=1, rest=None)
    >>> result = tb.run("shen-hdr-specimen", test, ambient=-20)
    >>> left = end_state(result, "shen-hdr-specimen")
    >>> element = tb.element("shen-hdr-specimen", ambient=-20, initial=left)
    >>> bool(element.state.response["force"][0] == result["force"].values[0, -1])
    True
    """
    faults, data = settle_start({"initial_result": result}, ("initial_result",))
    if data is None:
        raise InputError(faults or "result: give one", "end_state()")
    ambients = [] if ambient is None else [ambient]
    return left_by(data, as_bearing(bearing), ambients, "end_state()")


def final_state(data: "xr.Dataset", ambient: list[float], bearing: str = "") -> SpecimenState:
    """Return where a bearing was at the end of an earlier result, in the run at the same ambient.

    `bearing` is the name of one of several in an analysis. Results that hold no memory give
    temperatures only.
    """
    run = _same_run(data, ambient, bearing)
    if "final_temperature" not in data:
        raise InputError(
            "contains no final state of its bearings: they are bilinear or on several lines "
            "of a structure, or an earlier version wrote the result"
        )

    def _read(name: str) -> Any:
        values = data[name].values[run]
        if np.ndim(values) == 0:
            return values
        return values[np.isfinite(values.reshape(len(values), -1)).all(axis=1)]

    memory = None
    if PREFIX + MEMORY[0] in data:
        # A dataset has no variables without elements.
        memory = {key: _read(PREFIX + key) if PREFIX + key in data else [] for key in MEMORY}
        memory |= {key: _read(PREFIX + key) for key in OF_LOOPS if PREFIX + key in data}
    lead = float(data["final_lead_temperature"].values[run])
    return specimen_state(_read("final_temperature"), lead, memory)


def _same_run(data: "xr.Dataset", ambient: list[float], bearing: str) -> int:
    """Return the number of the run at an ambient temperature; of the only run, if there is one."""
    runs = np.arange(data["ambient"].size)
    if "bearing" in data.coords:
        runs = runs[data["bearing"].values == bearing]
    ambients = data["ambient"].values[runs]
    if len(runs) == 1:
        return int(runs[0])
    match: Any = runs[ambients == ambient[0]] if len(ambient) == 1 else []
    if len(match) != 1:
        raise InputError(f"has {len(runs)} runs, at {ambients} degC; choose one of them")
    return int(match[0])


def _matching_bearing(data: "xr.Dataset", bearing: Bearing) -> tuple[str, str]:
    """Return the name of this bearing in an earlier result, and why it is none of them."""
    case = tomllib.loads(data.attrs["case"])
    stored_tables = case["bearings"] if "bearings" in case else [case["bearing"]]
    bearing_table = to_table(bearing)
    faults = []
    for table in stored_tables:
        differing_keys = [
            key for key in bearing_table | table if table.get(key) != bearing_table.get(key)
        ]
        # A bearing with another description is the same specimen.
        if not set(differing_keys) - set(TEXTS):
            return table["name"], ""
        faults.append(
            f'is a test of "{table["name"]}", not of this "{bearing.name}" (they differ in '
            f"{', '.join(differing_keys)}); forces and history belong to the bearing; temperatures "
            "alone may be given as initial_profile of a cyclic test"
        )
    names = [table["name"] for table in stored_tables]
    return next((n for n in names if n == bearing.name), names[0]), faults[0]


def initial_temperatures(case: "Case", cells: int, ambient: float) -> tuple[Floats, float | None]:
    """Return the temperatures of cells and lead at the start [degC]; None: as the cells next to it.

    `ambient` is that of the chamber at the start.
    """
    if case.conditioning is not None:
        start = soaked_start(case.bearing, case.conditioning, ambient, case.analysis)
        return start.temperature, start.lead
    profile = case.initial_profile
    if case.initial_state is not None:
        profile = case.initial_state.temperature
    if profile is None:
        uniform = ambient if case.initial is None else case.initial
        return np.full(cells, uniform), case.initial_lead
    return np.array(profile), case.initial_lead


LIMITS = {  # of a rig: unit, and words for what a run requires
    "force": ("kN", "requires a force of {0:.4g} kN; the limit of {2} is {1:g} kN"),
    "stroke": ("mm", "requires a stroke of {0:.4g} mm; the limit of {2} is {1:g} mm"),
    "speed": ("mm/s", "requires a speed of {0:.4g} mm/s; the limit of {2} is {1:g} mm/s"),
}


class Rig(Sourced):
    """Largest force, stroke from the middle and speed of an actuator, either way.

    What is left out has no limit.
    """

    name: Name = "rig"
    description: str = ""
    citation: str = ""
    force: Annotated[float, in_unit("kN"), Field(ge=1e-3, le=1e6)] | None = None
    stroke: Annotated[float, in_unit("mm"), Field(ge=1e-3, le=1e5)] | None = None
    speed: Annotated[float, in_unit("mm/s"), Field(ge=1e-6, le=1e6)] | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        if set(values) & set(LIMITS):
            return []
        return ['give at least one limit: force = "... kN", stroke = "... mm", speed = "... mm/s"']


RIGS = Library("rig", "rigs")


def load_rig(name_or_path: str | Path) -> Rig:
    """Return a rig of the library by name, "shen-rig" (Shen 2023, Table 3.2), or of a file."""
    return RIGS.load(Rig, name_or_path)


LOADERS = {"bearing": load_bearing, "rig": load_rig}  # that a case names


def rig_demand(rig: Rig | None, run: str, peaks: Sequence[float]) -> list[Row]:
    """Compare a run with the limits of a rig: force [kN], stroke [mm] and speed [mm/s]."""
    limits = {name: (0.0, limit) for name in LIMITS if (limit := getattr(rig, name, None))}
    units = {name: unit for name, (unit, _) in LIMITS.items()}
    return compared(run, dict(zip(LIMITS, peaks, strict=True)), limits, units)


def beyond(rig: Rig | None, rows: Sequence[Row]) -> list[Warned]:
    """Return a sentence for each limit of a rig that a run passes."""
    if rig is None:
        return []
    name = "the rig" if rig.name == "rig" else rig.name
    return [
        Warned(
            f"{row['run']} {LIMITS[row['limit']][1].format(row['demand'], row['largest'], name)}",
            f"rig.{row['limit']}.{row['run']}",
            EXCEEDED,
        )
        for row in rows
        if row["outside"]
    ]


Group = Literal["rubber", "layer_displacement", "hysteretic", "cells"]
Temperature = Annotated[float, in_unit("degC"), Field(ge=-100, le=100)]
Histories = Literal["thinned", "complete"]
Time = Annotated[float, Field(ge=0, le=1e9)]
Force = Annotated[float, Field(ge=-1e6, le=1e6)]
# To start; only one of these may be given.
START_KEYS = ("initial", "initial_profile", "initial_result", "initial_state", "conditioned")
DEFAULT_BEARING = "shen-hdr-specimen"
DEFAULT_AMBIENT = (-20.0, 0.0, 23.0)  # the three chamber temperatures of Table 3.4


Axial = Literal["off", "constant", "history"]
MOST_POINTS = 1_000_000


class AxialHistory(Strict):
    """An axial force in time: straight lines between points, constant before and after them.

    Attributes
    ----------
    time_s : increasing times since the start of the test [s], in [0, 1e9].
    force_kN : axial force there [kN], positive in compression, in [-1e6, 1e6].

    Examples
    --------
    >>> AxialHistory(time_s=[0, 1], force_kN=[800, 1000]).at(np.array([0.5, 7.0])).tolist()
    [900.0, 1000.0]
    """

    time_s: Annotated[tuple[Time, ...], Field(min_length=1, max_length=MOST_POINTS)]
    force_kN: Annotated[tuple[Force, ...], Field(min_length=1, max_length=MOST_POINTS)]

    def model_post_init(self, context: Any) -> None:
        """Compare the two lists."""
        if len(self.time_s) != len(self.force_kN):
            raise ValueError(
                f"time_s has {len(self.time_s)} entries and force_kN {len(self.force_kN)}: both "
                "need one for each point"
            )
        if any(after <= before for before, after in pairwise(self.time_s)):
            raise ValueError("time_s must increase")

    def at(self, time: Floats) -> Floats:
        """Return the axial force at some times [kN]."""
        return np.interp(time, self.time_s, self.force_kN)


class Analysis(ModelOptions):
    """How to compute, and what to keep.

    Attributes
    ----------
    keep_every : keep every n-th step and all turning points; 1 by default.
    axial : whether the axial force acts on the shear force: "off" (default), "constant", with
        `axial_force`, or "history", with `axial_history`.
    axial_factor : what its part in the shear force counts on: "overlap" (default) of top and
        bottom, or "potential", the form that has an energy.
    """

    keep_every: Annotated[int, Field(ge=1, le=1_000_000_000)] = 1
    keep: tuple[Group, ...] = ("rubber", "cells")  # besides displacement, force and energy
    histories: Histories = "thinned"  # in files: turning points and 200 points a cycle
    axial: Axial | None = None  # None: off
    axial_factor: AxialFactor | None = None  # None: overlap

    @property
    def has_axial(self) -> bool:
        """Whether the axial force acts on the shear force."""
        return self.axial not in (None, "off")


def _check_distinct(ambient: list[float]) -> list[float]:
    if repeated := [value for k, value in enumerate(ambient) if value in ambient[:k]]:
        raise ValueError(f"{repeated[0]:g} degC is given more than once")
    return ambient


Ambients = Annotated[list[Temperature], AfterValidator(_check_distinct)]


class Case(Conditioning):
    """Everything that `cyclic` needs. Only one of the ways to start may be given.

    With `conditioned` the bearing starts as its time in the chamber left it, at each ambient
    temperature.

    Attributes
    ----------
    ambient : ambient temperature [degC], in [-100, 100]; one run for each.
    initial : temperature of the bearing at the start [degC]; the ambient temperature by default.
    rig : test rig (name or file); a warning names the limits that a run exceeds.
    axial_force : axial force on the bearing [kN], positive in compression; adds checks. It acts on
        the shear force with `axial = "constant"` in `analysis` only.
    axial_history : an axial force that varies in time, with `axial = "history"`.
    compare : compare the result with earlier models; for a path, with a test on a line.
    """

    bearing: Bearing
    test: CyclicTest
    ambient: Annotated[Ambients, Field(min_length=1, max_length=1000)]
    # CSV file with time and temperature of the air, instead of `ambient`
    ambient_series: Annotated[str, Field(min_length=1)] | None = None
    initial: Temperature | None = None
    initial_lead: Temperature | None = None  # None: the mean of the cells next to it
    initial_profile: list[Temperature] | None = None  # one per cell, upper face first
    initial_state: SpecimenState | None = None  # what `initial_result` of a file becomes
    rig: Rig | None = None
    axial_force: AxialForce | None = None
    axial_history: AxialHistory | None = None
    compare: bool | None = None
    analysis: Analysis = Analysis()
    # Of the numbers of bearing and rig, by name and dotted key; for documents only
    sources: dict[str, dict[str, str]] | None = None

    def to_toml(self) -> str:
        """Return the case with every default filled in, as TOML; reads back to the same bits."""
        return to_toml(self, without="" if self.ambient_series is None else "ambient")

    def faults(self) -> list[str]:
        """Return what the parts do to each other: a test that this bearing cannot do, ..."""
        messages, steps = survey(self.test, self.bearing.total_rubber_thickness, self.starts_at)
        messages = [f"test.{fault}" for fault in messages]
        if self.ambient_series is not None:
            try:
                read_air(self.ambient_series)
            except InputError as error:
                messages += error.lines("ambient_series")
        messages += [f"analysis.{text}" for text in self.analysis.misfits(self.bearing)]
        if self.conditioning is not None:
            for chamber in self.ambient:
                messages += conditioning_faults(self.conditioning, self.bearing, chamber)
            if self.inside is not None and len(self.ambient) > 1:
                messages.append("inside: is the reading of one test; give one ambient temperature")
            if self.initial_lead is not None:
                messages.append("initial_lead: not with conditioned, which says what the lead has")
        if self.initial_lead is not None and self.bearing.lead is None:
            messages.append("initial_lead: needs a bearing with lead")
        messages += self._axial_faults()
        cells = len(self.analysis.build_stack(self.bearing).part)
        cells = 1 if self.analysis.model in ONE_CELL else cells
        if self.initial_profile is not None and len(self.initial_profile) != cells:
            messages.append(
                f"initial_profile: has {len(self.initial_profile)} temperatures, "
                f"but the stack has {cells} cells"
            )
        # The constants of a bilinear model come from a test.
        needs_constants = self.initial_state is not None or self.test.in_plane
        if needs_constants and not messages and self.analysis.model != "bilinear":
            constants = build_model(self.bearing, self.analysis).constants
            state, components = self.initial_state, 2 if self.test.in_plane else 1
            fault = misfit(state, constants, components) if state else ""
            messages += [f"initial_state: {fault}"] if fault else []
            if self.test.in_plane:
                messages += line_only_faults(self.bearing, constants)
        if not messages:  # of a test that cannot be done the steps say nothing
            steps *= len(self.ambient)
            row = len(labels(BearingResponse)) + cells * len(self.analysis.keep)
            messages += too_much(steps, cells, steps / self.analysis.keep_every * row)
        return messages

    def _axial_faults(self) -> list[str]:
        """Return why the axial force cannot act on the shear force."""
        analysis, messages = self.analysis, []
        if self.axial_history is not None and analysis.axial != "history":
            messages.append('axial_history: needs analysis.axial = "history"')
        if not analysis.has_axial:
            if analysis.axial_factor is not None:
                messages.append(
                    'analysis.axial_factor: needs analysis.axial = "constant" or "history"'
                )
            return messages
        required = "axial_force" if analysis.axial == "constant" else "axial_history"
        if getattr(self, required) is None:
            messages.append(f'analysis.axial = "{analysis.axial}": needs {required}')
        if analysis.model == "bilinear":
            messages.append(
                f'analysis.axial = "{analysis.axial}": model "bilinear" has no rubber layers; use '
                'model = "multi-layer"'
            )
        if analysis.keep_every > 1:
            messages.append(
                f'analysis.axial = "{analysis.axial}": needs every step; use keep_every = 1'
            )
        return messages

    def axial_forces(self, time: Floats) -> Floats:
        """Return the axial force that acts on the shear force at some times [kN]."""
        if self.axial_history is not None:
            return self.axial_history.at(time)
        return np.full(len(time), self.axial_force or 0.0)

    @property
    def starts_at(self) -> float | Floats:
        """Displacement at the start [mm]; [2] in a plane."""
        state = self.initial_state
        along = 0.0 if state is None else state.reads
        if not self.test.in_plane:
            return along
        return np.array([along, state.across.displacement if state and state.across else 0.0])


@checked
def load_case(path: str | Path, **overrides: Any) -> Case:
    r"""Load a case from TOML; `bearing` may be a name, a file next to the case, or a table.

    Parameters
    ----------
    path : the case file.
    overrides : values that replace those of the file, by key of `Case` or `Analysis`
        (`dt` goes to the test); None leaves the file's value.

    Raises
    ------
    InputError : all faults of the file in one message.

    Examples
    --------
    >>> import tempfile
    >>> file = Path(tempfile.mkdtemp()) / "case.toml"
    >>> _ = file.write_text('bearing = "shen-hdr-specimen"\nambient = ["-20 degC"]')
    >>> load_case(file, ambient=[0.0, 23.0]).ambient
    [0.0, 23.0]
    """
    return make_case(case_table(Path(path)), str(path), Path(path).parent, **overrides)


def make_case(table: dict[str, Any], where: str, folder: Path = Path(), **overrides: Any) -> Case:
    """Check a case from a table and overrides, with the defaults filled in.

    Numbers of the table have a unit as text; those of `overrides`, keys of `Case` or `Analysis`,
    may be plain: in degC, and in s (`dt`, which goes to the test). None leaves the table's value.
    `where` names the file in messages; paths in the table are relative to `folder`.
    """
    dt = overrides.pop("dt", None)
    table = {"bearing": DEFAULT_BEARING} | table
    table, replacements, faults = load_all(table, overrides, LOADERS, folder)
    test = table.get("test")
    steps = test.get("steps") if isinstance(test, dict) else None
    for step in steps if isinstance(steps, list) else []:
        absolute(step, "file", folder)
    # Absolute paths: the resolved case is read again in another folder.
    for key in ("ambient_series", "initial_result"):
        absolute(table, key, folder)
    table = overridden(table, replacements, Case, {"analysis": Analysis})
    if "ambient" in replacements:
        table.pop("ambient_series", None)
    start_faults, earlier = settle_start(table, START_KEYS)
    faults += start_faults
    bearing_sources: dict[str, str] = {}
    if isinstance(table["bearing"], dict):
        table["bearing"], bearing_sources = split_sources(table["bearing"])
    if "ambient" in table and table.get("ambient_series") is not None:
        faults.append("give ambient or ambient_series, not both")
    _fill_defaults(table)
    # After the defaults, so that dt replaces that of the default test too.
    table["test"] = updated(table["test"], overridden({}, {"dt": dt}, CyclicTest))
    case = read_case(Case, table, where, faults)
    if earlier is not None:
        # After the check of the case: the earlier result must be of this bearing and temperature.
        state = left_by(earlier, case.bearing, case.ambient, where)
        case = case.model_copy(update={"initial_state": state})
    if faults := case.faults():
        raise InputError(faults, where)
    bearing = case.bearing.with_sources(bearing_sources | case.bearing.sources)
    rig = [(RIGS, case.rig)] if case.rig else []
    sources = sources_to_keep([(BEARINGS, bearing), *rig], case.sources)
    analysis = case.analysis.settled(case.bearing)
    update: dict[str, Any] = {"analysis": analysis, "sources": sources}
    if case.conditioning is not None:
        conditioning = filled(case.conditioning)
        update |= {"before": conditioning.before, "chamber_film": conditioning.chamber_film}
    return case.model_copy(update=update)


def _fill_defaults(table: dict[str, Any]) -> None:
    bearing = table["bearing"]
    kind = bearing.get("kind") if isinstance(bearing, dict) else getattr(bearing, "kind", "HDR")
    test = table.get("test", cyclic_test(wave="sine" if kind in ("LHDR", "LRB") else "triangular"))
    table["test"] = to_table(test) if isinstance(test, CyclicTest) else test
    table.setdefault("ambient", text_with_unit(DEFAULT_AMBIENT, "degC"))
    if not isinstance(table["ambient"], list):
        table["ambient"] = [table["ambient"]]
