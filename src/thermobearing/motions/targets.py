"""Target spectra: standard spectra of Level 2 earthquakes in Japan, and user files."""

import re
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from thermobearing.border.errors import InputError, is_file
from thermobearing.border.library import data_path, unknown_name
from thermobearing.border.toml import read_toml
from thermobearing.border.units import HUGEST, number_list, parse_quantity
from thermobearing.core.types import Floats
from thermobearing.motions.matching import FIRST, LAST
from thermobearing.motions.record import acceleration_unit
from thermobearing.tables.columns import Table, make_table
from thermobearing.tables.text import read_sheets

KINDS, GROUNDS = ("I", "II"), ("I", "II", "III")
SMALLEST_ZONE_FACTOR, LARGEST_ZONE_FACTOR = 0.01, 2.0  # the specifications have 0.7 to 1.2
CITATION = (
    "Standard spectrum: Japan Road Association, Specifications for Highway Bridges, Part V (2012)"
)
STANDARD = re.compile(r"jra-(i|ii)-(i|ii|iii)")
STANDARD_NAMES = [f"jra-{kind}-{ground}".lower() for kind in KINDS for ground in GROUNDS]
SECONDS = ("", "s", "sec")
PERIOD, ACCELERATION = ("period", "t"), ("acceleration", "sa", "s")  # titles in lower case


class StandardSpectrum(NamedTuple):
    """S(T) of one type of earthquake and one ground: a rise, a plateau and a fall.

    `rise` and `fall` are the branches at T = 1 s [mm/s2] with their powers of the period, `plateau`
    [mm/s2] lies between the corners [s].
    """

    rise: float
    rise_power: float
    plateau: float
    fall: float
    fall_power: float
    corners: tuple[float, float]

    def at(self, periods: Floats) -> Floats:
        """Return the acceleration at periods > 0 [mm/s2]."""
        rise = self.rise * periods**self.rise_power
        fall = self.fall * periods**self.fall_power
        first, second = self.corners
        flat = np.full_like(fall, self.plateau)
        return np.where(periods < first, rise, np.where(periods > second, fall, flat))


class TableSpectrum(NamedTuple):
    """S(T) on straight lines between points [s], [mm/s2], both axes logarithmic.

    Below the first period it stays as it is, above the last it falls with 1/T: motions are
    compared from 0.1 to 3 s, and adjusted a little beyond.
    """

    periods: tuple[float, ...]
    values: tuple[float, ...]

    def at(self, periods: Floats) -> Floats:
        """Return the acceleration at periods > 0 [mm/s2]."""
        x, y = np.log(self.periods), np.log(self.values)
        inside = np.exp(np.interp(np.log(periods), x, y))
        return np.asarray(inside * np.minimum(1.0, self.periods[-1] / periods))


@dataclass(frozen=True)
class DesignSpectrum:
    """A spectrum of 5 % damping that motions are made to fit.

    `name` is "jra-ii-i", or that of a file, and `words` the same in words; `factor` multiplies the
    curve (c_z of a standard one); `caveat` states a restriction of motions that fit it.
    """

    name: str
    words: str
    curve: StandardSpectrum | TableSpectrum
    factor: float = 1.0
    citation: str = ""
    caveat: str = ""

    def at(self, periods: Floats) -> Floats:
        """Absolute acceleration at periods > 0 [mm/s2]."""
        return self.factor * self.curve.at(periods)


@cache
def _spectra() -> dict[tuple[str, str], StandardSpectrum]:
    table = read_toml(data_path("spectra", "jra-level-2.toml"))

    def _in_mm_s2(text: str) -> float:
        number, unit = text.split()
        return float(number) * acceleration_unit(unit)

    found = {}
    for kind in KINDS:
        about = table[kind]
        for ground in GROUNDS:
            row = about["grounds"][ground]
            first, second = (parse_quantity(text, "s") for text in row["corners"])
            sizes = {key: _in_mm_s2(row[key]) for key in ("rise", "plateau", "fall")}
            powers = {k: float(Fraction(about[k])) for k in ("rise_power", "fall_power")}
            found[kind, ground] = StandardSpectrum(**sizes, **powers, corners=(first, second))
    return found


def kind_and_ground(kind: str | int, ground: str | int) -> tuple[str, str]:
    """Return both as Roman numbers; InputError for others.

    >>> kind_and_ground("ii", 3)
    ('II', 'III')
    """
    numbers = {"1": "I", "2": "II", "3": "III"}
    found, problems = [], []
    known = (("type of earthquake", kind, KINDS), ("ground", ground, GROUNDS))
    for what, text, names in known:
        found.append(numbers.get(str(text).strip(), str(text).strip().upper()))
        if found[-1] not in names:
            problems.append(f'{what}: "{text}" is not one of {", ".join(names)}')
    if problems:
        raise InputError(problems)
    return found[0], found[1]


def standard_spectrum(
    kind: str | int, ground: str | int, periods: ArrayLike, *, zone_factor: float = 1.0
) -> Floats:
    """Return the standard acceleration spectrum of a Level 2 earthquake [mm/s2], 5 % damping.

    Japan Road Association, Specifications for Highway Bridges, Part V (2012), for type "I" (plate
    boundary) or "II" (inland), ground "I" (hard), "II" or "III" (soft), natural periods > 0 [s] and
    the factor c_z of the region in [0.01, 2].
    """
    key = kind_and_ground(kind, ground)
    values = number_list(periods, "periods [s]")
    if (values < 1.0 / HUGEST).any():
        raise InputError("periods [s]: must be > 0", "standard_spectrum()")
    return standard_target(*key, zone_factor).at(values)


def standard_target(kind: str, ground: str, zone_factor: float = 1.0) -> DesignSpectrum:
    """Return a standard spectrum of Level 2 as a target; type and ground are Roman numbers."""
    if not SMALLEST_ZONE_FACTOR <= zone_factor <= LARGEST_ZONE_FACTOR:
        raise InputError(
            f"zone_factor: {zone_factor:g} is outside [{SMALLEST_ZONE_FACTOR:g}, "
            f"{LARGEST_ZONE_FACTOR:g}]",
            "standard_spectrum()",
        )
    words = f"the standard spectrum of Level 2 Type {kind}, ground {ground}, c_z = {zone_factor:g}"
    caveat, curve = "NOT an accelerogram of the specifications", _spectra()[kind, ground]
    name = f"jra-{kind}-{ground}".lower()
    return DesignSpectrum(name, words, curve, zone_factor, CITATION, caveat)


def find_kind(name: str) -> tuple[str, str]:
    """Return type and ground of a standard spectrum by its name; InputError for another name."""
    named = STANDARD.fullmatch(name)
    if named is None:
        raise unknown_name("standard spectrum", name, STANDARD_NAMES)
    return named[1].upper(), named[2].upper()


def load_spectrum(name_or_path: str | Path, factor: float = 1.0) -> DesignSpectrum:
    r"""Return a spectrum that motions can be made to fit, times a factor (c_z of a standard one).

    `name_or_path` is one of `STANDARD_NAMES`, or a file with columns `period` [s] and
    `acceleration` (with its unit: gal, g, m/s2 ...), of 5 % damping, from 0.1 s or less to 3 s or
    more.
    """
    text = str(name_or_path)
    if STANDARD.fullmatch(text):
        return standard_target(*find_kind(text), factor)
    path = Path(name_or_path)
    if not (is_file(path) or isinstance(name_or_path, Path) or path.suffix or "/" in text):
        raise unknown_name("standard spectrum", text, STANDARD_NAMES)
    words = f'the spectrum "{path.stem}"'
    if factor != 1.0:
        words += f" times {factor:g}"
    try:
        return DesignSpectrum(path.stem, words, _read_points(path), factor)
    except InputError as error:
        raise error.located(path) from None


def _read_points(path: Path) -> TableSpectrum:
    """Return the points of a file."""
    tables = (make_table(sheet) for sheet in read_sheets(path))
    table = next((one for one in tables if one is not None), None)
    if table is None:
        raise InputError("is empty")
    column = _find_column(table, "period", PERIOD)
    if table.units[column] not in SECONDS:
        raise InputError(f'column "{table.titles[column]}": periods are in s')
    periods = table.numbers(column)
    column = _find_column(table, "acceleration", ACCELERATION)
    if not table.units[column]:
        raise InputError(
            f'column "{table.titles[column]}" has no unit; write "acceleration [gal]", or g, m/s2'
        )
    values = table.numbers(column, acceleration_unit(table.units[column]))
    if not (np.diff(periods) > 0.0).all():
        k = int(np.argmin(np.diff(periods) > 0.0))
        raise InputError(f"periods do not increase from {periods[k]:g} to {periods[k + 1]:g} s")
    if not (periods[0] > 0.0 and values.min() > 0.0):
        raise InputError("periods and accelerations must be greater than 0")
    if periods[0] > FIRST or periods[-1] < LAST:
        raise InputError(
            f"reaches from {periods[0]:g} to {periods[-1]:g} s; motions are fitted from {FIRST:g} "
            f"to {LAST:g} s"
        )
    return TableSpectrum(tuple(periods.tolist()), tuple(values.tolist()))


def _find_column(table: Table, what: str, names: tuple[str, ...]) -> int:
    """Return the number of a column by the first word of its title."""
    firsts = [re.split(r"[\s_,(\[]", t.strip().lower(), maxsplit=1)[0] for t in table.titles]
    for number, first in enumerate(firsts):
        if first in names:
            return number
    held = ", ".join(table.titles)
    raise InputError(f'no column "{what}" with its unit; known: {held}')
