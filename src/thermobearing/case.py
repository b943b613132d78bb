"""A complete analysis as data: bearing, test, ambient temperatures and how to compute.

The same record is read from CASE.toml, built by `run(...)` in Python, and written as
case.resolved.toml beside every result; running that file again gives the same bits.
"""

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from thermobearing.bearing.library import bearing_from_table, load_bearing, split_sources
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.schema import Strict, in_unit, read_toml, unit_of, validated
from thermobearing.drive.assemble import HeatSource, Integrator
from thermobearing.drive.baselines import Model, needs_full_stack
from thermobearing.drive.protocol import CyclicTest, cyclic_test
from thermobearing.errors import InputError
from thermobearing.stack import Face, Scheme
from thermobearing.units import with_unit

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

    @model_validator(mode="after")
    def _one(self) -> "EndFace":
        if (self.eta is None) == (self.film is None):
            raise ValueError("give either eta (1 adiabatic to 3 at ambient) or film")
        return self

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
    ambient_series: str | None = None  # CSV with time and temperature, instead of `ambient`
    initial: Temperature | None = None  # uniform; None: the ambient temperature
    initial_lead: Temperature | None = None  # None: the mean of the cells beside it
    initial_profile: list[Temperature] | None = None  # one per cell, upper face first
    analysis: Analysis = Analysis()

    @model_validator(mode="after")
    def _consistent(self) -> "Case":
        if self.initial is not None and self.initial_profile is not None:
            raise ValueError("give initial or initial_profile, not both")
        if self.analysis.model == "lead-alone" and self.bearing.lead is None:
            raise ValueError('model "lead-alone" needs a bearing with lead')
        if len(set(self.ambient)) < len(self.ambient):
            raise ValueError("ambient: every temperature only once")
        return self


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
    for step in _steps(table):
        if isinstance(step.get("file"), str):
            step["file"] = str(path.parent / step["file"])
    if isinstance(table.get("ambient_series"), str):
        table["ambient_series"] = str(path.parent / table["ambient_series"])
    bearing = table.get("bearing")
    if isinstance(bearing, str) and bearing.endswith(".toml") and overrides.get("bearing") is None:
        table["bearing"] = str(path.parent / bearing)
    if isinstance(table.get("initial_result"), str):
        table |= _final_temperatures(path.parent / table.pop("initial_result"))
    return make_case(table, str(path), **overrides)


def _final_temperatures(result: Path) -> dict[str, Any]:
    """Final temperatures of an earlier result with a single run, as text with units."""
    from thermobearing.results.files import load_result

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


def _steps(table: dict[str, Any]) -> list[dict[str, Any]]:
    test = table.get("test")
    steps = test.get("steps") if isinstance(test, dict) else None
    return [step for step in steps if isinstance(step, dict)] if isinstance(steps, list) else []


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
        table["analysis"] = {**_plain_table(table.get("analysis", {}), where), **chosen}
    dt = given.pop("dt", None)
    table |= given
    bearing = table.get("bearing", DEFAULT_BEARING)
    if isinstance(bearing, str | Path):
        table["bearing"] = load_bearing(bearing)
    elif isinstance(bearing, dict):
        table["bearing"] = bearing_from_table(bearing, f"{where}, bearing")
    _fill_defaults(table, where)
    if dt is not None:
        table["test"] = {**_plain_table(table["test"], where), "dt": dt}
    return validated(Case, table, where)


def _fill_defaults(table: dict[str, Any], where: str) -> None:
    """Defaults that depend on the bearing: wave of Table 3.4, heat of natural rubber."""
    bearing = table["bearing"]
    kind = bearing.kind if isinstance(bearing, Bearing) else "HDR"
    test = table.get("test", cyclic_test(wave="triangular" if kind == "HDR" else "sine"))
    table["test"] = to_table(test) if isinstance(test, CyclicTest) else test
    analysis = _plain_table(table.get("analysis", {}), where)
    if kind == "LRB":  # natural rubber gives its elastic work back
        analysis = {"heat_source": "dissipation", **analysis}
    table["analysis"] = analysis
    table.setdefault("ambient", _said_with_unit(DEFAULT_AMBIENT, "degC"))
    if not isinstance(table["ambient"], list):
        table["ambient"] = [table["ambient"]]


def _plain_table(value: Any, where: str) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise InputError("analysis and test must be tables", where)
    return value


def _said_with_unit(value: Any, unit: str | None) -> Any:
    """Plain numbers, alone or in a sequence, as text with their unit."""
    if isinstance(value, str | bytes | dict | Strict | Path) or unit is None:
        return value
    if hasattr(value, "__iter__"):
        return [_said_with_unit(item, unit) for item in value]
    return with_unit(float(value), unit)


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

    return tomli_w.dumps(to_table(case))
