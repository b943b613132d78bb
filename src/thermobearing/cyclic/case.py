"""A complete analysis as data: bearing, test, ambient temperatures and how to compute.

The same record is read from CASE.toml, built by `run(...)` in Python, and written as
case.resolved.toml beside every result; running that file again gives the same bits.
"""

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, field_validator, model_validator

from thermobearing.bearing.ambient import Ambient
from thermobearing.bearing.library import load_bearing, split_sources
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.border.schema import Strict, in_unit, read_toml, unit_of, validated
from thermobearing.border.units import with_unit
from thermobearing.cyclic.protocol import CyclicTest, cyclic_test, find_faults
from thermobearing.model.constants import HeatSource, Integrator, LeadEnds
from thermobearing.model.earlier import Model, needs_full_stack
from thermobearing.model.stack import Face, Scheme, build_stack

Group = Literal["rubber", "layer_displacement", "hysteretic", "cells"]
Temperature = Annotated[float, in_unit("degC"), Field(ge=-100, le=100)]
DEFAULT_BEARING = "shen-hdr-specimen"
DEFAULT_AMBIENT = (-20.0, 0.0, 23.0)  # the three chamber temperatures of Table 3.4
OVERRIDE_UNITS = {
    "ambient": "degC",
    "initial": "degC",
    "initial_profile": "degC",
    "initial_lead": "degC",
    "dt": "s",
}
DEFAULT_ETA = 2.0  # the source uses a "middle" value between 1 and 3 (Eq. 4.15)


class EndFace(Strict):
    """One end face: `eta` in [1, 3] (Eq. 4.15; 1 adiabatic, 3 at ambient) or a film coefficient."""

    eta: Annotated[float, Field(ge=1, le=3)] | None = None
    film: Annotated[float, in_unit("W/(m^2 K)"), Field(ge=0)] | None = None

    @classmethod
    def conflicts(cls, given: dict[str, Any]) -> list[str]:
        """One of the two."""
        if ("eta" in given) == ("film" in given):
            return ["give either eta (1 adiabatic to 3 at ambient) or film"]
        return []

    def face(self) -> Face:
        """The same, for the stack."""
        return Face(eta=self.eta, film=self.film)


class Analysis(Strict):
    """How to compute, and what to keep.

    `stack` "auto" models the upper half when both faces are alike, else the whole height.
    """

    model: Model = "multi-layer"
    scheme: Scheme = "conservative"
    integrator: Integrator = "exact"
    heat_source: HeatSource = "work"
    lead_ends: LeadEnds = "half-space"
    stack: Literal["auto", "half", "full"] = "auto"
    upper_face: EndFace = EndFace(eta=DEFAULT_ETA)
    lower_face: EndFace = EndFace(eta=DEFAULT_ETA)
    keep_every: Annotated[int, Field(ge=1)] = 1
    keep: tuple[Group, ...] = ("rubber", "cells")

    @model_validator(mode="after")
    def _stack_fits_faces(self) -> "Analysis":
        if self.stack == "half" and self.upper_face != self.lower_face:
            raise ValueError('stack "half" needs both faces alike; use "auto" or "full"')
        return self

    @model_validator(mode="after")
    def _model_fits(self) -> "Analysis":
        if self.model != "multi-layer" and self.scheme == "published":
            raise ValueError('an earlier model goes with scheme "conservative" only')
        if needs_full_stack(self.model) and self.stack == "half":
            raise ValueError(f'model "{self.model}" has one cell for all layers; use stack "auto"')
        if self.lead_ends != "half-space" and self.scheme == "published":
            raise ValueError('scheme "published" goes with lead_ends "half-space" only')
        return self

    @property
    def half(self) -> bool:
        """Whether only the upper half is modelled."""
        return self.stack == "half" or (self.stack == "auto" and self.upper_face == self.lower_face)


class Case(Strict):
    """Everything `cyclic` needs. Only one of the three ways to start may be given."""

    bearing: Bearing
    test: CyclicTest
    ambient: Annotated[list[Temperature], Field(min_length=1)]
    # CSV with time and temperature, instead of `ambient`
    ambient_series: Annotated[str, Field(min_length=1)] | None = None
    initial: Temperature | None = None  # uniform; None: the ambient temperature
    initial_lead: Temperature | None = None  # None: the mean of the cells beside it
    initial_profile: list[Temperature] | None = None  # one per cell, upper face first
    analysis: Analysis = Analysis()

    @field_validator("ambient")
    @classmethod
    def _each_once(cls, ambient: list[float]) -> list[float]:
        for value in ambient:
            if ambient.count(value) > 1:
                raise ValueError(f"{value:g} degC is given more than once")
        return ambient

    def faults(self) -> list[str]:
        """What the parts do to each other: a test that cannot be done with this bearing, ..."""
        found = find_faults(self.test, self.bearing.total_rubber_thickness)
        found = [f"test.{fault}" for fault in found]
        if self.ambient_series is not None:
            try:
                Ambient.from_csv(self.ambient_series)
            except InputError as error:
                found += error.lines("ambient_series")
        if self.analysis.model == "lead-alone" and self.bearing.lead is None:
            found.append('analysis.model = "lead-alone": needs a bearing with lead')
        if self.analysis.lead_ends == "finite-plate":
            lead = self.bearing.lead
            if lead is None or not lead.confined:
                found.append(
                    'analysis.lead_ends = "finite-plate": needs a bearing with confined lead '
                    "cores (lead.confined = true), whose heat leaves through the ends only"
                )
        if self.initial_lead is not None and self.bearing.lead is None:
            found.append("initial_lead: needs a bearing with lead")
        cells = len(build_stack(self.bearing, half=self.analysis.half).part)
        cells = 1 if needs_full_stack(self.analysis.model) else cells
        if self.initial_profile is not None and len(self.initial_profile) != cells:
            found.append(
                f"initial_profile: has {len(self.initial_profile)} temperatures, "
                f"but the stack has {cells} cells"
            )
        return found


def load_case(path: str | Path, **overrides: Any) -> Case:
    """A case from TOML; `bearing` may be a name, a file beside the case, or a table.

    Parameters
    ----------
    path : the case file.
    overrides : values that replace those of the file, by key of `Case` or `Analysis`
        (`dt` goes to the test); None leaves the file's value.

    Raises
    ------
    InputError : all faults of the file in one message.
    """
    path = Path(path)
    table, _ = split_sources(read_toml(path))
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


def _final_temperatures(result: Path) -> dict[str, Any]:
    """Final temperatures of an earlier result with a single run, as text with units."""
    from thermobearing.cyclic.files import load_result

    earlier = load_result(result)
    final, lead = (earlier[f"final_{name}temperature"].values for name in ("", "lead_"))
    if len(final) != 1:
        raise InputError(
            f"initial_result has {len(final)} runs; use a result at a single ambient temperature",
            str(result),
        )
    found: dict[str, Any] = {"initial_profile": _said_with_unit(final[0], "degC")}
    if lead[0] == lead[0]:  # NaN without lead
        found["initial_lead"] = with_unit(float(lead[0]), "degC")
    return found


def _settle_start(table: dict[str, Any]) -> list[str]:
    """Replace `initial_result` by the profile in it; returns what is wrong with the start."""
    ways = [key for key in ("initial", "initial_profile", "initial_result") if key in table]
    if len(ways) > 1:
        return [f"give only one of initial, initial_profile, initial_result; got {ways}"]
    result = table.pop("initial_result", None)
    if result is None:
        return []
    if not isinstance(result, str) or not result:
        return [f"initial_result = {result!r}: must be the path of a result"]
    try:
        table |= _final_temperatures(Path(result))
    except InputError as error:
        return error.lines("initial_result")
    return []


def make_case(table: dict[str, Any], where: str, **overrides: Any) -> Case:
    """A checked case from a table and overrides, with the defaults filled in.

    Plain numbers among the overrides are in degC (`ambient`, `initial`, `initial_profile`)
    and s (`dt`); the table follows the rules of a file: every number says its unit.
    """
    given = {
        key: _said_with_unit(value, OVERRIDE_UNITS.get(key))
        for key, value in overrides.items()
        if value is not None
    }
    table = dict(table)
    chosen = {key: given.pop(key) for key in list(given) if key in Analysis.model_fields}
    if chosen:
        table["analysis"] = _updated(table.get("analysis", {}), chosen)
    dt = given.pop("dt", None)
    if "ambient" in given:
        table.pop("ambient_series", None)
    table |= given
    _make_absolute(table, Path())
    problems = _settle_start(table)
    if "ambient" in table and table.get("ambient_series") is not None:
        problems.append("give ambient or ambient_series, not both")
    bearing = table.setdefault("bearing", DEFAULT_BEARING)
    if isinstance(bearing, str | Path):
        try:
            table["bearing"] = load_bearing(bearing)
        except InputError as error:
            problems += error.lines("bearing")
            table["bearing"] = load_bearing(DEFAULT_BEARING)  # to find what else is wrong
    elif isinstance(bearing, dict):
        table["bearing"], _ = split_sources(bearing)
    _fill_defaults(table)
    if dt is not None:
        table["test"] = _updated(table["test"], {"dt": dt})
    try:
        case = validated(Case, table, where)
    except InputError as error:
        raise InputError([*problems, *error.problems], where) from None
    problems += case.faults() if not problems else []
    if problems:
        raise InputError(problems, where)
    return case


def _fill_defaults(table: dict[str, Any]) -> None:
    """Defaults; the wave of Table 3.4 and the heat of natural rubber depend on the bearing."""
    bearing = table["bearing"]
    kind = bearing.get("kind") if isinstance(bearing, dict) else getattr(bearing, "kind", "HDR")
    test = table.get("test", cyclic_test(wave="sine" if kind in ("LHDR", "LRB") else "triangular"))
    table["test"] = to_table(test) if isinstance(test, CyclicTest) else test
    if kind == "LRB":  # natural rubber gives its elastic work back
        analysis = table.get("analysis", {})
        if isinstance(analysis, dict):
            table["analysis"] = {"heat_source": "dissipation", **analysis}
    table.setdefault("ambient", _said_with_unit(DEFAULT_AMBIENT, "degC"))
    if not isinstance(table["ambient"], list):
        table["ambient"] = [table["ambient"]]


def _updated(table: Any, changes: dict[str, Any]) -> Any:
    """The table with changes; what is no table stays as it is, for the checks to find."""
    return {**table, **changes} if isinstance(table, dict) else table


def _said_with_unit(value: Any, unit: str | None) -> Any:
    """Plain numbers, alone or in a sequence, as text with their unit."""
    if hasattr(value, "tolist"):  # numpy arrays and scalars
        value = value.tolist()
    if isinstance(value, list | tuple) and unit is not None:
        return [_said_with_unit(item, unit) for item in value]
    if isinstance(value, int | float) and not isinstance(value, bool) and unit is not None:
        return with_unit(float(value), unit)
    return value


def to_table(model: Strict) -> dict[str, Any]:
    """A model as a TOML table: units on every number, unset choices left out."""
    table: dict[str, Any] = {}
    for name in type(model).model_fields:
        value = getattr(model, name)
        unit = unit_of(type(model), name)
        if value is None or value == "":
            continue
        table[name] = _entry(value, unit)
    return table


def _entry(value: Any, unit: str | None) -> Any:
    if isinstance(value, Strict):
        return to_table(value)
    if isinstance(value, list | tuple):
        return [_entry(item, unit) for item in value]
    if unit and isinstance(value, int | float):
        return with_unit(float(value), unit)
    return value


def resolved_toml(case: Case) -> str:
    """The case with every default filled in, as TOML text that reads back to the same bits."""
    import tomli_w

    table = to_table(case)
    if case.ambient_series is not None:
        del table["ambient"]
    return tomli_w.dumps(table)
