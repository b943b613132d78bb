"""Where a run starts: temperatures uniform or cell by cell, or the end of an earlier result."""

import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.border.toml import to_table
from thermobearing.model.handover import MEMORY, OF_LOOPS, PREFIX, SpecimenState, specimen_state
from thermobearing.results.reading import read_dataset

if TYPE_CHECKING:
    from thermobearing.cyclic.case import Case

Floats = NDArray[np.float64]
TEXTS = ("name", "description", "citation")  # of a bearing: nothing that it does


@runtime_checkable
class Earlier(Protocol):
    """A result of any analysis that leaves bearings behind, which stand in its dataset."""

    @property
    def dataset(self) -> xr.Dataset:
        """Histories, ends and the case."""


def settle_start(table: dict[str, Any], ways: Sequence[str]) -> tuple[list[str], xr.Dataset | None]:
    """What is wrong with the start in a case, and the dataset that `initial_result` stands for."""
    given = [key for key in ways if key in table]
    if len(given) > 1:
        return [f"give only one of {', '.join(ways)}; got {given}"], None
    result = table.pop("initial_result", None)
    if result is None or isinstance(result, Earlier):
        return [], None if result is None else result.dataset
    if not isinstance(result, str | Path) or not str(result):
        return [f"initial_result = {result!r}: must be the path of a result"], None
    try:
        return [], read_dataset(result, ("case",))
    except InputError as error:
        return error.lines("initial_result"), None


def left_by(data: xr.Dataset, bearing: Bearing, ambient: list[float], where: str) -> SpecimenState:
    """Where an earlier result left a bearing, in the run at the same ambient temperature.

    Raises
    ------
    InputError : a whole state of another bearing, none, or several runs; `where` names the file.
    """
    name, fault = _whose(data, bearing)
    try:
        state = final_state(data, ambient, name)
        if fault and state.whole:
            raise InputError(fault)
    except InputError as error:
        raise InputError(error.lines("initial_result"), where) from None
    return state


def end_state(
    result: Earlier | str | Path, bearing: Bearing | str | Path, ambient: float | None = None
) -> SpecimenState:
    """Where an earlier result left a bearing, for `tb.element(bearing, initial=...)`.

    Parameters
    ----------
    result : of a test, or of `bridge` or `hybrid` on one bearing line; or its directory.
    bearing : the same bearing, with which the forces and the memory go.
    ambient : which run, if the result has several [degC].

    Returns
    -------
    SpecimenState : displacement, forces, temperatures and all memory.

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
    air = [] if ambient is None else [ambient]
    return left_by(data, as_bearing(bearing), air, "end_state()")


def final_state(data: xr.Dataset, ambient: list[float], bearing: str = "") -> SpecimenState:
    """Where a bearing was at the end of an earlier result, in the run at the same ambient.

    Results of tests that hold no state (before 0.2) give temperatures only. `bearing` is the name
    of one of a study of several.

    Raises
    ------
    InputError : several runs, and none or several of them asked for; a study that holds no ends.
    """
    run = _same_run(data, ambient, bearing)
    if "final_temperature" not in data:
        raise InputError(
            "holds no ends of its bearings: they are bilinear, on several lines of a structure, or "
            "of a version that did not keep them"
        )
    memory = None
    if PREFIX + MEMORY[0] in data:
        memory = {
            key: _there(data[PREFIX + key].values[run]) if PREFIX + key in data else []
            for key in MEMORY
        }
        turns = {key: data[PREFIX + key].values[run] for key in OF_LOOPS if PREFIX + key in data}
        memory |= {key: _there(values) for key, values in turns.items()}
    return specimen_state(
        _there(data["final_temperature"].values[run]),
        float(data["final_lead_temperature"].values[run]),
        memory,
    )


def _there(values: Any) -> Any:
    """Without the NaN that fill up the tables of smaller bearings of a study."""
    return values[np.isfinite(values)] if np.ndim(values) else values


def _same_run(data: xr.Dataset, ambient: list[float], bearing: str) -> int:
    """Number of the run of a result at an ambient temperature; the only run, if there is one."""
    runs = np.arange(data["ambient"].size)
    if "bearing" in data.coords:
        runs = runs[data["bearing"].values == bearing]
    air = data["ambient"].values[runs]
    if len(runs) == 1:
        return int(runs[0])
    match: Any = runs[air == ambient[0]] if len(ambient) == 1 else []
    if len(match) != 1:
        raise InputError(f"has {len(runs)} runs, at {air} degC; start at one of them only")
    return int(match[0])


def _whose(data: xr.Dataset, bearing: Bearing) -> tuple[str, str]:
    """Name of the bearing in an earlier result that this is, and why it is none of them."""
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
            f"{', '.join(differ)}); forces and memory go with the bearing, temperatures alone may "
            "be given as initial_profile of a cyclic test"
        )
    names = [table["name"] for table in theirs]
    return next((n for n in names if n == bearing.name), names[0]), faults[0]


def initial_temperatures(case: "Case", cells: int, ambient: float) -> Floats:
    """Cell temperatures at the start [degC]."""
    given = case.initial_profile
    if case.initial_state is not None:
        given = case.initial_state.temperature
    if given is not None:
        if len(given) != cells:
            raise InputError(
                f"initial_profile has {len(given)} temperatures, but the stack has {cells} cells"
            )
        return np.array(given)
    return np.full(cells, ambient if case.initial is None else case.initial)
