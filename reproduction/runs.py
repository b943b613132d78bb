"""Simulations that claims and figures need, each run once, and the numbers that are printed."""

import re
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import Field

from thermobearing.bearing.library import changed_bearing, load_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, nearest
from thermobearing.border.schema import Strict, validated
from thermobearing.border.toml import read_toml
from thermobearing.cyclic.protocol import CyclicTest, cyclic_test
from thermobearing.cyclic.result import Result
from thermobearing.cyclic.run import run
from thermobearing.earthquake.analysis import bridge, hybrid
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.model.options import ModelOptions, model_table
from thermobearing.motions.library import load_motion
from thermobearing.structure.model import Structure, load_structure

T = TypeVar("T")
S = TypeVar("S", bound=Strict)
DATA = Path(__file__).with_name("data")
AMBIENT = (23.0, 0.0, -20.0)  # of all tests and studies of the source, warm to cold [degC]
HDR, LHDR = "shen-hdr-specimen", "shen-lhdr-specimen"
HDR_BRIDGE, LHDR_BRIDGE = "shen-hdr-bridge", "shen-lhdr-bridge"
SPECIMENS, BRIDGES = (HDR, LHDR), (HDR_BRIDGE, LHDR_BRIDGE)
BILINEAR = "shen-bilinear-bridge"
HYBRID_PIER, TWO, PIER = "hybrid-pier", "hybrid-pier-two-bearings", "pier-p1"
MODES = ("rt", "pd")
MOTIONS = ("jra-i-i-1", "jra-i-i-2", "jra-ii-i-1", "jra-ii-i-2")
WAVES = 3  # built-in motions of each type and ground
PRINTED: dict[str, Any] = {"model": ModelOptions(scheme="published", integrator="euler")}
PART = re.compile(r"([a-z_]+)(?:\[(\d+)\])?")


class Parameter(Strict):
    """A number that may be changed: its key in the file of every bearing or structure that has it.

    `of` is "bearing", "structure", "motion" (its acceleration) or "print" (see `Printed`).
    """

    of: str
    key: str = ""
    means: str


class Printed(Strict):
    """A printed number that no bearing or structure file has, with its unit and place."""

    value: Annotated[float, Field(ge=-1e12, le=1e12)]
    unit: str
    source: Annotated[str, Field(min_length=1)]


class _Parameters(Strict):
    parameter: dict[str, Parameter]
    printed: dict[str, Printed]


def load_data(schema: type[S], name: str) -> S:
    """Return a file of `reproduction/data`, validated."""
    return validated(schema, read_toml(DATA / name), str(DATA / name))


@cache
def _numbers() -> _Parameters:
    return load_data(_Parameters, "parameters.toml")


def parameters() -> dict[str, Parameter]:
    """Return all numbers that may be changed, by symbol."""
    return _numbers().parameter


def source_bearing(name: str) -> Bearing:
    """Return a bearing of the library with the constant strength of lead of Shen (2023), 5.3.2."""
    bearing = load_bearing(name)
    return bearing if bearing.lead is None else changed_bearing(bearing, law="constant-lead")


def model_over(base: Mapping[str, Any], model: ModelOptions | str | None) -> ModelOptions:
    """Return a model with the options of all simulations where it does not set its own."""
    return ModelOptions(**(model_table(base.get("model"), {}) | model_table(model, {})))


class Runs:
    """Simulations, each run once.

    `change` has factors by symbol of `parameters.toml`, {"K_r": 1.05}, for every bearing, structure
    and motion with that number. `light` leaves out the temperatures of cells in cyclic tests, since
    many changes are kept at once. `stand_in` moves the waves of a type and ground on by so many
    places; they have the same spectrum. `records` is a folder of records of the tests, for rows
    that need them. `options` go to every simulation: model="adiabatic".
    """

    def __init__(
        self,
        change: Mapping[str, float] | None = None,
        *,
        light: bool = False,
        stand_in: int = 0,
        records: Path | None = None,
        **options: Any,
    ) -> None:
        self.change = dict(change or {})
        self.records = records
        self.light, self.stand_in = light, stand_in
        self.shaken = False  # whether a motion was asked for since this was last set so
        self.options = options
        symbols = parameters()
        wrong = [name for name in self.change if name not in symbols]
        if wrong:
            raise InputError([f'no parameter "{k}"{nearest(k, symbols)}' for k in wrong], "Runs()")
        self._kept: dict[str, tuple[Any, bool]] = {}

    def over_all(self, options: dict[str, Any]) -> dict[str, Any]:
        """Return options of a simulation, over those of all."""
        chosen: dict[str, Any] = self.options | options
        return chosen | {"model": model_over(self.options, options.get("model"))}

    @property
    def folder(self) -> Path:
        """The folder of records; InputError without one."""
        if self.records is None:
            raise InputError("give a folder of records of the tests", "Runs()")
        return self.records

    def varied(
        self, change: Mapping[str, float] | None = None, *, moved_on: int = 0, **options: Any
    ) -> "Runs":
        """Return the same simulations with other changes, stand-ins or options, made once."""

        def make() -> Runs:
            stand_in = self.stand_in + moved_on
            changes = self.change | dict(change or {})
            merged = self.options | options
            return Runs(changes, light=True, stand_in=stand_in, records=self.records, **merged)

        return self.once(make, "varied", change, moved_on, options)

    def bearing(self, name: str) -> Bearing:
        """Return a bearing of the library with the changes."""
        bearing = source_bearing(name)
        for symbol, factor in self.change.items():
            parameter = parameters()[symbol]
            if parameter.of == "bearing":
                bearing = _changed(bearing, parameter.key, factor)
        return bearing

    def number(self, symbol: str) -> float:
        """Return a printed number with the changes of `of = "print"`."""
        printed = _numbers().printed
        if symbol not in printed:
            raise InputError(f'no printed number "{symbol}"{nearest(symbol, printed)}', "number()")
        value = printed[symbol].value
        for name, factor in self.change.items():
            parameter = parameters()[name]
            value *= factor if parameter.of == "print" and parameter.key == symbol else 1.0
        return value

    def structure(self, name: str) -> Structure:
        """Return a structure of the library with the changes."""
        original = load_structure(name)
        data = original.model_dump()
        for symbol, factor in self.change.items():
            parameter = parameters()[symbol]
            if parameter.of == "structure":
                _multiply(data, parameter.key, factor)
        return validated(Structure, data, "Runs()", from_file=False)

    def motion(self, name: str) -> Any:
        """Return a built-in motion with the changes."""
        self.shaken = True
        start, _, wave = load_motion(name).name.rpartition("-")
        name = f"{start}-{(int(wave) - 1 + self.stand_in) % WAVES + 1}"
        factor = 1.0
        for symbol, multiplier in self.change.items():
            factor *= multiplier if parameters()[symbol].of == "motion" else 1.0
        return name if factor == 1.0 else {"name": name, "factor": factor}

    def cyclic(
        self,
        bearing: str | Bearing,
        ambient: float | Sequence[float] = AMBIENT,
        test: CyclicTest | None = None,
        **options: Any,
    ) -> Result:
        """Run a displacement-controlled test; that of Table 3.4 by default."""

        def make() -> Result:
            specimen = self.bearing(bearing) if isinstance(bearing, str) else bearing
            air = [ambient] if isinstance(ambient, int | float) else list(ambient)
            keep: dict[str, Any] = {"keep": ["rubber"]} if self.light else {}
            return run(specimen, test, air, **self.over_all(keep | options))

        return self.once(make, "cyclic", bearing, ambient, test, options)

    def bridge(
        self,
        bearing: str | Sequence[str],
        motion: str | Sequence[str],
        ambient: float | Sequence[float] = AMBIENT,
        **options: Any,
    ) -> EarthquakeResult:
        """Run pier P1 on bearings under built-in motions."""
        return self._study(bridge, PIER, bearing, motion, ambient, options)

    def hybrid(
        self,
        bearing: str | Sequence[str],
        ambient: float | Sequence[float] = AMBIENT,
        mode: str | Sequence[str] = "rt",
        motion: str = "jra-ii-ii-1",
        **options: Any,
    ) -> EarthquakeResult:
        """Run the hybrid test in real time ("rt"), pseudo-dynamically ("pd"), or in both."""
        modes = [mode] if isinstance(mode, str) else list(mode)
        merged = {"laboratory": {"mode": modes}} | options
        return self._study(hybrid, HYBRID_PIER, bearing, motion, ambient, merged)

    def _study(
        self,
        command: Any,
        structure: str,
        bearing: str | Sequence[str],
        motion: str | Sequence[str],
        ambient: float | Sequence[float],
        options: dict[str, Any],
    ) -> EarthquakeResult:
        def make() -> EarthquakeResult:
            names = [bearing] if isinstance(bearing, str) else bearing
            motions = [motion] if isinstance(motion, str) else motion
            merged = {"structure": structure} | self.over_all(options)
            if isinstance(merged["structure"], str):
                merged["structure"] = self.structure(merged["structure"])
            devices = [self.bearing(name) if name != BILINEAR else name for name in names]
            shakings = [self.motion(name) for name in motions]
            air = [ambient] if isinstance(ambient, int | float) else list(ambient)
            result: EarthquakeResult = command(devices, shakings, air, **merged)
            return result

        return self.once(make, command.__name__, bearing, motion, ambient, options)

    def once(self, make: Callable[[], T], *words: Any) -> T:
        """Return what `make` returns, called once for these words."""
        key = repr(words)
        if key not in self._kept:
            # Whether this simulation asks for a motion is kept with it, for each later caller.
            shaken_before, self.shaken = self.shaken, False
            self._kept[key] = make(), self.shaken
            self.shaken = shaken_before
        value: T
        value, shaken = self._kept[key]
        self.shaken |= shaken
        return value


def full_cycles(strain: Sequence[float], count: int = 5, **options: Any) -> CyclicTest:
    """Return a cyclic test at some amplitudes, as Table 3.4 otherwise."""
    return cyclic_test(strain=list(strain), cycles=count, **options)


def _changed(bearing: Bearing, key: str, factor: float) -> Bearing:
    data = bearing.model_dump()
    if not _multiply(data, key, factor):
        return bearing
    top = key.partition(".")[0]
    return changed_bearing(bearing, **{top: data[top]})


def _multiply(data: dict[str, Any], key: str, factor: float) -> bool:
    """Multiply a number by its key, "masses[0].mass"; return False if there is none."""
    table: Any = data
    *above, last = key.split(".")
    for part in above:
        match = PART.fullmatch(part)
        table = table.get(match.group(1)) if match else None
        if table is not None and match and match.group(2) is not None:
            place = int(match.group(2))
            table = table[place] if place < len(table) else None
        # Parameters of lead or rate dependence are none of a bearing without them.
        if table is None:
            return False
    if table.get(last) is None:
        return False
    table[last] *= factor
    return True
