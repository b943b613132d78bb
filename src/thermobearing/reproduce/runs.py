"""Every simulation that claims and figures need, made once and kept by its words."""

import re
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any, TypeVar

from thermobearing.bearing.library import changed_bearing, load_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, nearest
from thermobearing.border.library import data_path
from thermobearing.border.schema import Strict, validated
from thermobearing.border.toml import read_toml
from thermobearing.cyclic.protocol import CyclicTest, cyclic_test
from thermobearing.cyclic.result import Result
from thermobearing.cyclic.run import run
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.study import bridge, hybrid
from thermobearing.motions.library import load_motion
from thermobearing.structure.model import Structure, load_structure

T = TypeVar("T")
AMBIENT = (23.0, 0.0, -20.0)  # of all tests and studies of the source, warm to cold [degC]
WAVES = 3  # built-in motions of each type and ground
PRINTED: dict[str, Any] = {"scheme": "published", "integrator": "euler"}
PART = re.compile(r"([a-z_]+)(?:\[(\d+)\])?")


class Parameter(Strict):
    """A number that may be changed: its key in the file of every bearing or structure that has it.

    `of` is "bearing", "structure" or "motion" (whose one number is its acceleration).
    """

    of: str
    key: str = ""
    means: str


class _Parameters(Strict):
    """The file of them."""

    parameter: dict[str, Parameter]


@cache
def parameters() -> dict[str, Parameter]:
    """All that may be changed, by symbol."""
    path = data_path("claims", "parameters.toml")
    return validated(_Parameters, read_toml(path), str(path)).parameter


class Runs:
    """Simulations by their words; each is made once.

    Parameters
    ----------
    change : factors by symbol of `data/claims/parameters.toml`, {"K_r": 1.05}, on every bearing,
        structure and motion that has it.
    light : cyclic tests without the temperatures of every cell, unless `keep` asks for them: many
        changes are to be kept at once.
    stand_in : how many places the waves of a type and ground are moved on: 1 takes 2 for 1, 3 for
        2, 1 for 3. They have the same spectrum.
    options : for every simulation, scheme="published".

    Examples
    --------
    >>> stiff = Runs(change={"K_r": 1.05}).bearing("shen-hdr-specimen")
    >>> round(stiff.hysteresis.layer_stiffness, 3)
    32.275
    """

    def __init__(
        self,
        change: Mapping[str, float] | None = None,
        *,
        light: bool = False,
        stand_in: int = 0,
        **options: Any,
    ) -> None:
        self.change = dict(change or {})
        self.light, self.stand_in = light, stand_in
        self.shaken = False  # whether a motion was asked for since this was last set so
        self.options = options
        known = parameters()
        wrong = [name for name in self.change if name not in known]
        if wrong:
            raise InputError([f'no parameter "{k}"{nearest(k, known)}' for k in wrong], "Runs()")
        self._kept: dict[str, tuple[Any, bool]] = {}

    def beside(
        self, change: Mapping[str, float] | None = None, *, moved_on: int = 0, **options: Any
    ) -> "Runs":
        """Return the same simulations with other changes, stand-ins or options, made once."""

        def make() -> Runs:
            stand_in = self.stand_in + moved_on
            changes = self.change | dict(change or {})
            return Runs(changes, light=True, stand_in=stand_in, **self.options | options)

        return self.once(make, "beside", change, moved_on, options)

    def bearing(self, name: str) -> Bearing:
        """A bearing of the library with the changes."""
        found = load_bearing(name)
        for symbol, factor in self.change.items():
            parameter = parameters()[symbol]
            if parameter.of == "bearing":
                found = _changed(found, parameter.key, factor)
        return found

    def structure(self, name: str) -> Structure:
        """A structure of the library with the changes."""
        found = load_structure(name)
        data = found.model_dump()
        for symbol, factor in self.change.items():
            parameter = parameters()[symbol]
            if parameter.of == "structure":
                _multiply(data, parameter.key, factor)
        return validated(Structure, data, "Runs()", from_file=False)

    def motion(self, name: str) -> Any:
        """A built-in motion with the changes."""
        self.shaken = True
        start, _, wave = load_motion(name).name.rpartition("-")
        name = f"{start}-{(int(wave) - 1 + self.stand_in) % WAVES + 1}"
        factor = 1.0
        for symbol, own in self.change.items():
            factor *= own if parameters()[symbol].of == "motion" else 1.0
        return name if factor == 1.0 else {"name": name, "factor": factor}

    def cyclic(
        self,
        bearing: str | Bearing,
        ambient: float | Sequence[float] = AMBIENT,
        test: CyclicTest | None = None,
        **options: Any,
    ) -> Result:
        """A displacement-controlled test; that of Table 3.4 by default."""

        def make() -> Result:
            specimen = self.bearing(bearing) if isinstance(bearing, str) else bearing
            air = [ambient] if isinstance(ambient, int | float) else list(ambient)
            kept: dict[str, Any] = {"keep": ["rubber"]} if self.light else {}
            return run(specimen, test, air, **self.options | kept | options)

        return self.once(make, "cyclic", bearing, ambient, test, options)

    def bridge(
        self,
        bearing: str | Sequence[str],
        motion: str | Sequence[str],
        ambient: float | Sequence[float] = AMBIENT,
        **options: Any,
    ) -> EarthquakeResult:
        """Pier P1 on bearings under built-in motions."""
        return self._study(bridge, "pier-p1", bearing, motion, ambient, options)

    def hybrid(
        self,
        bearing: str | Sequence[str],
        ambient: float | Sequence[float] = AMBIENT,
        mode: str | Sequence[str] = "rt",
        motion: str = "jra-ii-ii-1",
        **options: Any,
    ) -> EarthquakeResult:
        """The hybrid test in real time ("rt"), pseudo-dynamically ("pd"), or in both."""
        modes = [mode] if isinstance(mode, str) else list(mode)
        told = {"laboratory": {"mode": modes}} | options
        return self._study(hybrid, "hybrid-pier", bearing, motion, ambient, told)

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
            told = {"structure": structure} | self.options | options
            if isinstance(told["structure"], str):
                told["structure"] = self.structure(told["structure"])
            devices = [
                self.bearing(name) if name != "shen-bilinear-bridge" else name for name in names
            ]
            shakings = [self.motion(name) for name in motions]
            air = [ambient] if isinstance(ambient, int | float) else list(ambient)
            found: EarthquakeResult = command(devices, shakings, air, **told)
            return found

        return self.once(make, command.__name__, bearing, motion, ambient, options)

    def once(self, make: Callable[[], T], *words: Any) -> T:
        """What `make` gives, made once for these words."""
        key = repr(words)
        if key not in self._kept:
            before, self.shaken = self.shaken, False
            self._kept[key] = make(), self.shaken
            self.shaken = before
        found: T
        found, shaken = self._kept[key]
        self.shaken |= shaken
        return found


def full_cycles(strain: Sequence[float], count: int = 5, **options: Any) -> CyclicTest:
    """A cyclic test at some amplitudes, as Table 3.4 otherwise."""
    return cyclic_test(strain=list(strain), cycles=count, **options)


def _changed(bearing: Bearing, key: str, factor: float) -> Bearing:
    """A bearing with one number multiplied; itself if it has no such number."""
    data = bearing.model_dump()
    if not _multiply(data, key, factor):
        return bearing
    top = key.partition(".")[0]
    return changed_bearing(bearing, **{top: data[top]})


def _multiply(data: dict[str, Any], key: str, factor: float) -> bool:
    """A number by its key, "masses[0].mass", multiplied in place; False if it is not there."""
    table: Any = data
    *above, last = key.split(".")
    for part in above:
        found = PART.fullmatch(part)
        table = table.get(found.group(1)) if found else None
        if table is not None and found and found.group(2) is not None:
            place = int(found.group(2))
            table = table[place] if place < len(table) else None
        if table is None:
            return False
    if table.get(last) is None:
        return False
    table[last] *= factor
    return True
