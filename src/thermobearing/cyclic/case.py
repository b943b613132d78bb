"""A displacement-controlled test as data: bearing, steps, options, initial state and rig.

The same record is read from CASE.toml, built by `run(...)` in Python, and written as
case.resolved.toml in every result; running that file again gives the same bits.
"""

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, Protocol, runtime_checkable

import numpy as np
from pydantic import AfterValidator, Field

from thermobearing.bearing.library import BEARINGS, as_bearing, load_bearing
from thermobearing.bearing.model import AxialForce, Bearing
from thermobearing.border.cases import absolute, load_all, read_case
from thermobearing.border.errors import InputError
from thermobearing.border.lazy import xr
from thermobearing.border.library import Library, Sourced, sources_to_keep
from thermobearing.border.schema import Name, Strict, in_unit, overridden, text_with_unit, updated
from thermobearing.border.toml import split_sources, to_table, to_toml
from thermobearing.climate.readers import read_air
from thermobearing.core.records import Floats, labels
from thermobearing.core.types import Books
from thermobearing.cyclic.protocol import CyclicTest, cyclic_test, survey
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
from thermobearing.report.title import case_table
from thermobearing.results.ranges import Row, compared

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
    """

    temperature: float | Sequence[float] | None = None
    lead: float | None = None
    result: "Earlier | SpecimenState | str | Path | None" = None

    @classmethod
    def of(cls, value: Any) -> "InitialState":
        """Return a record of what may stand for one: a temperature, a result, a directory."""
        if isinstance(value, InitialState):
            return value
        known = isinstance(value, Earlier | SpecimenState | str | Path)
        return cls(result=value) if known else cls(temperature=value)

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
    table: dict[str, Any], ways: Sequence[str]
) -> "tuple[list[str], xr.Dataset | None]":
    """Return faults of the start in a case, and the dataset that `initial_result` stands for."""
    given = [key for key in ways if key in table]
    if len(given) > 1:
        return [f"give only one of {', '.join(ways)}; got {given}"], None
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
    name, fault = _whose(data, bearing)
    try:
        state = final_state(data, ambient, name)
        if fault and state.complete:
            raise InputError(fault)
    except InputError as error:
        raise InputError(error.lines("initial_result"), where) from None
    return state


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
    >>> bool(element.state.books["force"][0] == result["force"].values[0, -1])
    True
    """
    faults, data = settle_start({"initial_result": result}, ("initial_result",))
    if data is None:
        raise InputError(faults or "result: give one", "end_state()")
    known = [] if ambient is None else [ambient]
    return left_by(data, as_bearing(bearing), known, "end_state()")


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


def _whose(data: "xr.Dataset", bearing: Bearing) -> tuple[str, str]:
    """Return the name of this bearing in an earlier result, and why it is none of them."""
    case = tomllib.loads(data.attrs["case"])
    theirs = case["bearings"] if "bearings" in case else [case["bearing"]]
    ours = to_table(bearing)
    faults = []
    for table in theirs:
        differ = [key for key in ours | table if table.get(key) != ours.get(key)]
        if not set(differ) - set(TEXTS):
            return table["name"], ""
        faults.append(
            f'is a test of "{table["name"]}", not of this "{bearing.name}" (they differ in '
            f"{', '.join(differ)}); forces and history belong to the bearing; temperatures "
            "alone may be given as initial_profile of a cyclic test"
        )
    names = [table["name"] for table in theirs]
    return next((n for n in names if n == bearing.name), names[0]), faults[0]


def initial_temperatures(case: "Case", cells: int, ambient: float) -> Floats:
    """Return the cell temperatures at the start [degC]."""
    given = case.initial_profile
    if case.initial_state is not None:
        given = case.initial_state.temperature
    if given is None:
        return np.full(cells, ambient if case.initial is None else case.initial)
    return np.array(given)


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
    def _conflicts(cls, given: dict[str, Any]) -> list[str]:
        if set(given) & set(LIMITS):
            return []
        return ['give at least one limit: force = "... kN", stroke = "... mm", speed = "... mm/s"']


RIGS = Library("rig", "rigs")


def load_rig(name_or_path: str | Path) -> Rig:
    """Return a rig of the library by name, "shen-rig" (Shen 2023, Table 3.2), or of a file."""
    return RIGS.load(Rig, name_or_path)


THINGS = {"bearing": load_bearing, "rig": load_rig}  # that a case names


def rig_demand(rig: Rig | None, run: str, peaks: Sequence[float]) -> list[Row]:
    """Compare a run with the limits of a rig: force [kN], stroke [mm] and speed [mm/s]."""
    limits = {name: (0.0, limit) for name in LIMITS if (limit := getattr(rig, name, None))}
    units = {name: unit for name, (unit, _) in LIMITS.items()}
    return compared(run, dict(zip(LIMITS, peaks, strict=True)), limits, units)


def beyond(rig: Rig | None, rows: Sequence[Row]) -> list[str]:
    """Return a sentence for each limit of a rig that a run passes."""
    if rig is None:
        return []
    name = "the rig" if rig.name == "rig" else rig.name
    return [
        f"{row['run']} {LIMITS[row['limit']][1].format(row['asked'], row['largest'], name)}"
        for row in rows
        if row["passed"]
    ]


Group = Literal["rubber", "layer_displacement", "hysteretic", "cells"]
Temperature = Annotated[float, in_unit("degC"), Field(ge=-100, le=100)]
Histories = Literal["thinned", "complete"]
WAYS = ("initial", "initial_profile", "initial_result", "initial_state")  # to start
DEFAULT_BEARING = "shen-hdr-specimen"
DEFAULT_AMBIENT = (-20.0, 0.0, 23.0)  # the three chamber temperatures of Table 3.4


class Analysis(ModelOptions):
    """How to compute, and what to keep."""

    keep_every: Annotated[int, Field(ge=1, le=1_000_000_000)] = 1  # besides turning points
    keep: tuple[Group, ...] = ("rubber", "cells")  # besides displacement, force and energy
    histories: Histories = "thinned"  # in files: turning points and 200 points a cycle


def _each_once(ambient: list[float]) -> list[float]:
    if twice := [value for k, value in enumerate(ambient) if value in ambient[:k]]:
        raise ValueError(f"{twice[0]:g} degC is given more than once")
    return ambient


Ambients = Annotated[list[Temperature], AfterValidator(_each_once)]


class Case(Strict):
    """Everything that `cyclic` needs. Only one of the ways to start may be given."""

    bearing: Bearing
    test: CyclicTest
    ambient: Annotated[Ambients, Field(min_length=1, max_length=1000)]  # each is a separate run
    # CSV file with time and temperature of the air, instead of `ambient`
    ambient_series: Annotated[str, Field(min_length=1)] | None = None
    initial: Temperature | None = None  # uniform; None: the ambient temperature
    initial_lead: Temperature | None = None  # None: the mean of the cells next to it
    initial_profile: list[Temperature] | None = None  # one per cell, upper face first
    initial_state: SpecimenState | None = None  # what `initial_result` of a file becomes
    rig: Rig | None = None  # its limits give warnings
    axial_force: AxialForce | None = None  # on the bearing, positive in compression; for checks
    analysis: Analysis = Analysis()
    # Of the numbers of bearing and rig, by name and dotted key; for documents only
    sources: dict[str, dict[str, str]] | None = None

    def to_toml(self) -> str:
        """Return the case with every default filled in, as TOML; reads back to the same bits."""
        return to_toml(self, without="" if self.ambient_series is None else "ambient")

    def faults(self) -> list[str]:
        """Return what the parts do to each other: a test that this bearing cannot do, ..."""
        found, steps = survey(self.test, self.bearing.total_rubber_thickness, self.starts_at)
        found = [f"test.{fault}" for fault in found]
        if self.ambient_series is not None:
            try:
                read_air(self.ambient_series)
            except InputError as error:
                found += error.lines("ambient_series")
        found += [f"analysis.{text}" for text in self.analysis.misfits(self.bearing)]
        if self.initial_lead is not None and self.bearing.lead is None:
            found.append("initial_lead: needs a bearing with lead")
        cells = len(self.analysis.build_stack(self.bearing).part)
        cells = 1 if self.analysis.model in ONE_CELL else cells
        if self.initial_profile is not None and len(self.initial_profile) != cells:
            found.append(
                f"initial_profile: has {len(self.initial_profile)} temperatures, "
                f"but the stack has {cells} cells"
            )
        # The constants of a bilinear model come from a test.
        concerned = self.initial_state is not None or self.test.in_plane
        if concerned and not found and self.analysis.model != "bilinear":
            constants = build_model(self.bearing, self.analysis).constants
            state, components = self.initial_state, 2 if self.test.in_plane else 1
            fault = misfit(state, constants, components) if state else ""
            found += [f"initial_state: {fault}"] if fault else []
            if self.test.in_plane:
                found += line_only_faults(self.bearing, constants)
        if not found:  # of a test that cannot be done the steps say nothing
            steps *= len(self.ambient)
            row = len(labels(Books)) + cells * len(self.analysis.keep)
            found += too_much(steps, cells, steps / self.analysis.keep_every * row)
        return found

    @property
    def starts_at(self) -> float | Floats:
        """Displacement at the start [mm]; [2] in a plane."""
        state = self.initial_state
        along = 0.0 if state is None else state.reads
        if not self.test.in_plane:
            return along
        return np.array([along, state.across.displacement if state and state.across else 0.0])


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
    table, given, faults = load_all(table, overrides, THINGS, folder)
    test = table.get("test")
    steps = test.get("steps") if isinstance(test, dict) else None
    for step in steps if isinstance(steps, list) else []:
        absolute(step, "file", folder)
    for key in ("ambient_series", "initial_result"):
        absolute(table, key, folder)
    table = overridden(table, given, Case, {"analysis": Analysis})
    if "ambient" in given:
        table.pop("ambient_series", None)
    more, earlier = settle_start(table, WAYS)
    faults += more
    own: dict[str, str] = {}
    if isinstance(table["bearing"], dict):
        table["bearing"], own = split_sources(table["bearing"])
    if "ambient" in table and table.get("ambient_series") is not None:
        faults.append("give ambient or ambient_series, not both")
    _fill_defaults(table)
    table["test"] = updated(table["test"], overridden({}, {"dt": dt}, CyclicTest))
    case = read_case(Case, table, where, faults)
    if earlier is not None:
        state = left_by(earlier, case.bearing, case.ambient, where)
        case = case.model_copy(update={"initial_state": state})
    if faults := case.faults():
        raise InputError(faults, where)
    bearing = case.bearing.with_sources(own | case.bearing.sources)
    rig = [(RIGS, case.rig)] if case.rig else []
    sources = sources_to_keep([(BEARINGS, bearing), *rig], case.sources)
    analysis = case.analysis.settled(case.bearing)
    return case.model_copy(update={"analysis": analysis, "sources": sources})


def _fill_defaults(table: dict[str, Any]) -> None:
    bearing = table["bearing"]
    kind = bearing.get("kind") if isinstance(bearing, dict) else getattr(bearing, "kind", "HDR")
    test = table.get("test", cyclic_test(wave="sine" if kind in ("LHDR", "LRB") else "triangular"))
    table["test"] = to_table(test) if isinstance(test, CyclicTest) else test
    table.setdefault("ambient", text_with_unit(DEFAULT_AMBIENT, "degC"))
    if not isinstance(table["ambient"], list):
        table["ambient"] = [table["ambient"]]
