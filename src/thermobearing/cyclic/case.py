"""A complete analysis as data: bearing, test, ambient temperatures and how to compute.

The same record is read from CASE.toml, built by `run(...)` in Python, and written as
case.resolved.toml beside every result; running that file again gives the same bits.
"""

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, field_validator

from thermobearing.bearing.library import BEARINGS, load_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.border.library import sources_to_keep
from thermobearing.border.overrides import overridden, said_with_unit, updated
from thermobearing.border.schema import Strict, in_unit, validated
from thermobearing.border.toml import split_sources, to_table, to_toml
from thermobearing.climate.readers import read_air
from thermobearing.core.records import labels
from thermobearing.core.types import Books
from thermobearing.cyclic.protocol import CyclicTest, cyclic_test, survey
from thermobearing.cyclic.rig import RIGS, Rig, settle_rig
from thermobearing.cyclic.start import left_by, settle_start
from thermobearing.model.earlier import needs_full_stack
from thermobearing.model.effort import too_much
from thermobearing.model.handover import SpecimenState, misfit
from thermobearing.model.options import ModelOptions, build_model
from thermobearing.report.title import case_table

Group = Literal["rubber", "layer_displacement", "hysteretic", "cells"]
Temperature = Annotated[float, in_unit("degC"), Field(ge=-100, le=100)]
Histories = Literal["thinned", "complete"]
WAYS = ("initial", "initial_profile", "initial_result", "initial_state")  # to start
DEFAULT_BEARING = "shen-hdr-specimen"
DEFAULT_AMBIENT = (-20.0, 0.0, 23.0)  # the three chamber temperatures of Table 3.4


class Analysis(ModelOptions):
    """How to compute, and what to keep."""

    keep_every: Annotated[int, Field(ge=1, le=1_000_000_000)] = 1
    keep: tuple[Group, ...] = ("rubber", "cells")
    histories: Histories = "thinned"  # in files (cyclic/thinning.py)


def each_once(ambient: list[float]) -> list[float]:
    """The temperatures [degC]; ValueError if one is given twice."""
    seen: set[float] = set()
    for value in ambient:
        if value in seen:
            raise ValueError(f"{value:g} degC is given more than once")
        seen.add(value)
    return ambient


class Case(Strict):
    """Everything `cyclic` needs. Only one of the ways to start may be given.

    Attributes
    ----------
    bearing : what is tested.
    test : what is done to it.
    ambient : temperatures of the air [degC], in [-100, 100]; each is a run of its own.
    ambient_series : CSV file with time and temperature of the air, instead of `ambient`.
    initial : uniform temperature at the start [degC]; the ambient temperature by default.
    initial_lead : of the lead at the start [degC]; the mean of the cells beside it by default.
    initial_profile : temperature of each cell at the start, upper face first [degC].
    initial_state : where an earlier test left the bearing; `initial_result` of a file becomes it.
    rig : limits of the rig that is to do it; a run that passes one says so.
    analysis : how to compute, and what to keep.
    sources : of the numbers of bearing and rig, by name and dotted key, where their own files have
        some; for documents only.
    """

    bearing: Bearing
    test: CyclicTest
    ambient: Annotated[list[Temperature], Field(min_length=1, max_length=1000)]
    # CSV with time and temperature, instead of `ambient`
    ambient_series: Annotated[str, Field(min_length=1)] | None = None
    initial: Temperature | None = None  # uniform; None: the ambient temperature
    initial_lead: Temperature | None = None  # None: the mean of the cells beside it
    initial_profile: list[Temperature] | None = None  # one per cell, upper face first
    initial_state: SpecimenState | None = None  # where an earlier test left the bearing
    rig: Rig | None = None
    analysis: Analysis = Analysis()
    sources: dict[str, dict[str, str]] | None = None

    @field_validator("ambient")
    @classmethod
    def _each_once(cls, ambient: list[float]) -> list[float]:
        return each_once(ambient)

    def to_toml(self) -> str:
        """The case with every default filled in, as TOML; reads back to the same bits."""
        return to_toml(self, without="" if self.ambient_series is None else "ambient")

    def faults(self) -> list[str]:
        """What the parts do to each other: a test that cannot be done with this bearing, ..."""
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
        cells = 1 if needs_full_stack(self.analysis.model) else cells
        if self.initial_profile is not None and len(self.initial_profile) != cells:
            found.append(
                f"initial_profile: has {len(self.initial_profile)} temperatures, "
                f"but the stack has {cells} cells"
            )
        if self.initial_state is not None and not found:
            found += self._misfits_of_state()
        if not found:  # of a test that cannot be done the steps say nothing
            steps *= len(self.ambient)
            row = len(labels(Books)) + cells * len(self.analysis.keep)
            found += too_much(steps, cells, steps / self.analysis.keep_every * row)
        return found

    @property
    def starts_at(self) -> float:
        """Displacement at the start [mm]."""
        return 0.0 if self.initial_state is None else self.initial_state.reads

    def _misfits_of_state(self) -> list[str]:
        """Whether the bearing can begin at the state that is given."""
        assert self.initial_state is not None
        if self.analysis.model == "bilinear":  # its constants come from a test
            return []
        constants = build_model(self.bearing, self.analysis).constants
        fault = misfit(self.initial_state, constants)
        return [f"initial_state: {fault}"] if fault else []


def load_case(path: str | Path, **overrides: Any) -> Case:
    r"""A case from TOML; `bearing` may be a name, a file beside the case, or a table.

    Parameters
    ----------
    path : the case file.
    overrides : values that replace those of the file, by key of `Case` or `Analysis`
        (`dt` goes to the test); None leaves the file's value.

    Returns
    -------
    Case

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
    path = Path(path)
    table = case_table(path)
    _make_absolute(table, path.parent)
    bearing = table.get("bearing")
    if isinstance(bearing, str) and bearing.endswith(".toml") and overrides.get("bearing") is None:
        table["bearing"] = str(path.parent / bearing)
    return make_case(table, str(path), **overrides)


def _make_absolute(table: dict[str, Any], folder: Path) -> None:
    """Paths of files, so that the resolved case finds them from wherever it is saved."""
    test = table.get("test")
    steps = test.get("steps") if isinstance(test, dict) else None
    named = [(step, "file") for step in steps] if isinstance(steps, list) else []
    for holder, key in [*named, (table, "ambient_series"), (table, "initial_result")]:
        if isinstance(holder, dict) and isinstance(holder.get(key), str) and holder[key]:
            holder[key] = str((folder / holder[key]).absolute())
    if str(table.get("rig", "")).endswith(".toml"):
        table["rig"] = str((folder / table["rig"]).absolute())


def make_case(table: dict[str, Any], where: str, **overrides: Any) -> Case:
    """A checked case from a table and overrides, with the defaults filled in.

    Parameters
    ----------
    table : keys of `Case`; as in a file, every number says its unit.
    where : names the file in messages.
    overrides : values that replace those of the table, by key of `Case` or `Analysis`; plain
        numbers are in degC (`ambient`, `initial`, `initial_lead`, `initial_profile`) and in s
        (`dt`, which goes to the test); None leaves the table's.

    Returns
    -------
    Case

    Raises
    ------
    InputError : all faults in one message.

    Examples
    --------
    >>> case = make_case({"ambient": ["-20 degC"]}, "example", dt=0.01)
    >>> case.bearing.name, case.test.dt
    ('shen-hdr-specimen', 0.01)
    """
    dt = overrides.pop("dt", None)
    table = overridden(table, overrides, Case, {"analysis": Analysis})
    if overrides.get("ambient") is not None:
        table.pop("ambient_series", None)
    _make_absolute(table, Path())
    problems, earlier = settle_start(table, WAYS)
    problems += settle_rig(table, Path())
    if "ambient" in table and table.get("ambient_series") is not None:
        problems.append("give ambient or ambient_series, not both")
    told: dict[str, str] = {}
    bearing = table.setdefault("bearing", DEFAULT_BEARING)
    if isinstance(bearing, str | Path):
        try:
            table["bearing"] = load_bearing(bearing)
        except InputError as error:
            problems += error.lines("bearing")
            table["bearing"] = load_bearing(DEFAULT_BEARING)  # to find what else is wrong
    elif isinstance(bearing, dict):
        table["bearing"], told = split_sources(bearing)
    _fill_defaults(table)
    table["test"] = updated(table["test"], overridden({}, {"dt": dt}, CyclicTest))
    try:
        case = validated(Case, table, where)
    except InputError as error:
        raise InputError([*problems, *error.problems], where) from None
    if earlier is not None and not problems:
        state = left_by(earlier, case.bearing, case.ambient, where)
        case = case.model_copy(update={"initial_state": state})
    problems += case.faults() if not problems else []
    if problems:
        raise InputError(problems, where)
    bearing = case.bearing.with_sources(told | case.bearing.sources)
    rig = [(RIGS, case.rig)] if case.rig else []
    sources = sources_to_keep([(BEARINGS, bearing), *rig], case.sources)
    return case.model_copy(
        update={"analysis": case.analysis.settled(case.bearing), "sources": sources}
    )


def _fill_defaults(table: dict[str, Any]) -> None:
    """Defaults; the wave of Table 3.4 depends on the bearing."""
    bearing = table["bearing"]
    kind = bearing.get("kind") if isinstance(bearing, dict) else getattr(bearing, "kind", "HDR")
    test = table.get("test", cyclic_test(wave="sine" if kind in ("LHDR", "LRB") else "triangular"))
    table["test"] = to_table(test) if isinstance(test, CyclicTest) else test
    table.setdefault("ambient", said_with_unit(DEFAULT_AMBIENT, "degC"))
    if not isinstance(table["ambient"], list):
        table["ambient"] = [table["ambient"]]
