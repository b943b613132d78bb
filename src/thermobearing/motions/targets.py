"""Target spectra: Level 2 earthquakes in Japan, shapes of other codes, and user files."""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike
from pydantic import AfterValidator, Field

from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, printable, short_repr
from thermobearing.border.library import data_path, unknown_name
from thermobearing.border.opener import is_file
from thermobearing.border.schema import Strict, in_unit, validated
from thermobearing.border.toml import read_toml, split_sources
from thermobearing.border.units import HUGEST, is_number, number_list, parse_quantity
from thermobearing.core.types import Floats
from thermobearing.motions.matching import FIRST, LAST
from thermobearing.motions.record import (
    STANDARD_GRAVITY,
    acceleration_unit,
    parse_acceleration,
)
from thermobearing.quantities.words import joined
from thermobearing.tables.columns import Table, make_table
from thermobearing.tables.text import read_sheets

KINDS, GROUNDS = ("I", "II"), ("I", "II", "III")
SMALLEST_ZONE_FACTOR, LARGEST_ZONE_FACTOR = 0.01, 2.0  # the specifications have 0.7 to 1.2
CITATION = (
    "Standard spectrum: Japan Road Association, Specifications for Highway Bridges, Part V (2012)"
)
STANDARD = re.compile(r"jra-(i|ii)-(i|ii|iii)")
STANDARD_NAMES = [f"jra-{kind}-{ground}".lower() for kind in KINDS for ground in GROUNDS]
Positive = Annotated[float, Field(gt=0, lt=HUGEST)]
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

    Below the first period it stays as it is, or is straight in T from `start`, the acceleration of
    the ground at T = 0, if that is stated. Above the last period it falls with 1/T: motions are
    compared from 0.1 to 3 s, and adjusted a little beyond.
    """

    periods: tuple[float, ...]
    values: tuple[float, ...]
    start: float | None = None

    def at(self, periods: Floats) -> Floats:
        """Return the acceleration at periods > 0 [mm/s2]."""
        x, y = np.log(self.periods), np.log(self.values)
        inside = np.exp(np.interp(np.log(periods), x, y))
        if self.start is not None:
            share = np.minimum(periods / self.periods[0], 1.0)
            inside = inside * share + self.start * (1.0 - share)
        return np.asarray(inside * np.minimum(1.0, self.periods[-1] / periods))


class CodeSpectrum(NamedTuple):
    """S(T) of a code: a straight rise, a plateau, a fall with 1/T and then with 1/T^2.

    `start` is the acceleration at T = 0 and `plateau` that between the first two of the `corners`
    [mm/s2]; after the third corner the spectrum falls with 1/T^2 (infinite: it never does) [s].
    """

    start: float
    plateau: float
    corners: tuple[float, float, float]

    def at(self, periods: Floats) -> Floats:
        """Return the acceleration at periods > 0 [mm/s2]."""
        first, second, third = self.corners
        rise = self.start + (self.plateau - self.start) * np.minimum(periods / first, 1.0)
        fall = np.minimum(1.0, second / periods) * np.minimum(1.0, third / periods)
        return np.asarray(rise * fall)


@checked
@dataclass(frozen=True)
class DesignSpectrum:
    """A spectrum of 5 % damping that motions are made to fit, from `load_spectrum`.

    Attributes
    ----------
    name : "jra-ii-i", the shape of a code, or the name of a file.
    words : the same in words.
    curve : the acceleration against the period.
    factor : multiplies the curve; c_z of a standard spectrum.
    citation : source of the curve.
    caveat : a restriction of motions that fit it.

    Examples
    --------
    >>> load_spectrum("jra-ii-i").words
    'the standard spectrum of Level 2 Type II, ground I, c_z = 1'
    """

    name: str
    words: str
    curve: StandardSpectrum | TableSpectrum | CodeSpectrum
    factor: float = 1.0
    citation: str = ""
    caveat: str = ""

    @property
    def standard(self) -> bool:
        """Whether it is a standard spectrum of Level 2."""
        return isinstance(self.curve, StandardSpectrum)

    @property
    def ground_acceleration(self) -> float | None:
        """Acceleration at period zero [mm/s2], such as A_s of a code; None if it is not stated."""
        start = None if isinstance(self.curve, StandardSpectrum) else self.curve.start
        return None if start is None else self.factor * start

    def scaled(self, factor: float) -> "DesignSpectrum":
        """Return the spectrum that a motion fits that is run times a factor; words state it."""
        if factor == 1.0:
            return self
        words = f"{self.words}, times {factor:g}"
        return replace(self, factor=factor * self.factor, words=words)

    def at(self, periods: ArrayLike) -> Floats:
        """Return the absolute acceleration at natural periods > 0 [mm/s2].

        Parameters
        ----------
        periods : natural periods [s], > 0.

        Raises
        ------
        InputError : a period that is not greater than 0.
        """
        values = number_list(periods, "periods [s]")
        if (values < 1.0 / HUGEST).any():
            raise InputError("periods [s]: must be > 0", "spectrum")
        return np.asarray(self.factor * self.curve.at(values))


class _SavedTarget(Strict):
    """A target spectrum in the header of a file; accelerations in mm/s2, periods in s.

    A standard spectrum is known by its name, the shape of a code by `start`, `plateau` and
    `corners`, a table by `periods` and `values`, with the `start` at T = 0 where it has one.
    """

    name: str
    words: str
    factor: Positive = 1.0
    citation: str = ""
    caveat: str = ""
    periods: tuple[Positive, ...] = ()
    values: tuple[Positive, ...] = ()
    start: Positive | None = None
    plateau: Positive | None = None
    corners: tuple[Positive, ...] = ()

    def spectrum(self) -> DesignSpectrum:
        """Return the spectrum; InputError where its curve is not complete."""
        curve: StandardSpectrum | TableSpectrum | CodeSpectrum
        increasing = bool(np.all(np.diff(self.periods) > 0.0))
        if self.start is not None and self.plateau is not None and 2 <= len(self.corners) <= 3:
            first, second, third = (*self.corners, np.inf)[:3]
            curve = CodeSpectrum(self.start, self.plateau, (first, second, third))
        elif len(self.periods) == len(self.values) > 1 and increasing:
            curve = TableSpectrum(self.periods, self.values, self.start)
        elif STANDARD.fullmatch(self.name):
            curve = _spectra()[find_kind(self.name)]
        else:
            raise InputError("states neither a standard spectrum nor a curve")
        return DesignSpectrum(self.name, self.words, curve, self.factor, self.citation, self.caveat)


def target_text(target: DesignSpectrum) -> str:
    """Return a target spectrum as one line of JSON, which `read_target` reads."""
    entries = {"name": target.name, "words": target.words, "factor": target.factor}
    texts = {"citation": target.citation, "caveat": target.caveat}
    curve: dict[str, Any] = {}
    if not isinstance(target.curve, StandardSpectrum):
        curve = {k: value for k, value in target.curve._asdict().items() if value is not None}
    if isinstance(target.curve, CodeSpectrum):  # JSON has no infinity
        curve["corners"] = [corner for corner in target.curve.corners if np.isfinite(corner)]
    return json.dumps(entries | {key: text for key, text in texts.items() if text} | curve)


def read_target(text: str) -> DesignSpectrum:
    """Return the target spectrum of a line of `target_text`; InputError where it is damaged."""
    try:
        return validated(_SavedTarget, json.loads(text), "target").spectrum()
    except (InputError, ValueError, RecursionError):
        raise InputError(
            "the target spectrum in the header cannot be read; delete the line that begins with "
            '"# target:"'
        ) from None


LARGEST_G = 10.0  # of a spectrum [g]; a larger number has a wrong unit


def _spectral(text: str) -> str:
    """Check an acceleration of the shape of a code."""
    if not 0.0 < parse_acceleration(text) <= LARGEST_G * STANDARD_GRAVITY:
        raise InputError(f'"{text}" is not greater than 0 and at most {LARGEST_G:g} g')
    return text


Spectral = Annotated[str, AfterValidator(_spectral)]
Corner = Annotated[float, in_unit("s"), Field(ge=1.0, le=30.0)]


class _ThreePoints(Strict):
    """Keys of the shapes of AASHTO and ASCE 7; accelerations in g, gal or m/s2.

    Attributes
    ----------
    shape : "aashto" or "asce-7".
    S_DS : acceleration of the plateau.
    S_D1 : acceleration at a period of 1 s.
    A_s : of the ground, F_pga PGA ("aashto" only, which needs it).
    T_L : corner to the fall with 1/T^2 ("asce-7" only; none by default) [s].
    """

    shape: Literal["aashto", "asce-7"]
    S_DS: Spectral
    S_D1: Spectral
    A_s: Spectral | None = None
    T_L: Corner | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        aashto = values.get("shape") == "aashto"
        if aashto and "A_s" not in values:
            return ['missing key "A_s": the shape "aashto" starts at F_pga PGA, such as "0.4 g"']
        excluded_key = "T_L" if aashto else "A_s"
        if excluded_key not in values:
            return []
        return [f'{excluded_key}: not of the shape "{values.get("shape")}"']

    def _curve(self, numbers: Mapping[str, Any]) -> CodeSpectrum:
        plateau = parse_acceleration(self.S_DS)
        second = parse_acceleration(self.S_D1) / plateau  # S_D1 is at 1 s
        start = parse_acceleration(self.A_s) if self.A_s else numbers["start"] * plateau
        third = np.inf if self.T_L is None else self.T_L
        if start > plateau:
            raise InputError(f'S_DS = "{self.S_DS}" must be at least A_s = "{self.A_s}"')
        return CodeSpectrum(start, plateau, (numbers["first_corner"] * second, second, third))

    @property
    def _words(self) -> str:
        parts = {"A_s": self.A_s, "S_DS": self.S_DS, "S_D1": self.S_D1}
        sizes = [f"{key} = {size}" for key, size in parts.items() if size is not None]
        sizes += [] if self.T_L is None else [f"T_L = {self.T_L:g} s"]
        return f"the spectrum of {self.shape.upper().replace('-', ' ')}, {', '.join(sizes)}"


class _Eurocode(Strict):
    """Keys of the shape of EN 1998-1.

    Attributes
    ----------
    shape : "en-1998-1".
    type : 1, or 2 for earthquakes with a surface-wave magnitude of at most 5.5.
    ground : "A" to "E".
    a_g : design acceleration on ground A, in g, gal or m/s2.
    """

    shape: Literal["en-1998-1"]
    type: Literal[1, 2]
    ground: Literal["A", "B", "C", "D", "E"]
    a_g: Spectral

    def _curve(self, numbers: Mapping[str, Any]) -> CodeSpectrum:
        row = numbers["types"][str(self.type)][self.ground]
        first, second, third = (parse_quantity(text, "s") for text in row["corners"])
        ground = row["soil_factor"] * parse_acceleration(self.a_g)
        return CodeSpectrum(ground, numbers["plateau"] * ground, (first, second, third))

    @property
    def _words(self) -> str:
        where = f"Type {self.type}, ground {self.ground}"
        return f"the spectrum of EN 1998-1, {where}, a_g = {self.a_g}"


SHAPES: dict[str, type[_ThreePoints] | type[_Eurocode]] = {
    **dict.fromkeys(get_args(_ThreePoints.model_fields["shape"].annotation), _ThreePoints),
    **dict.fromkeys(get_args(_Eurocode.model_fields["shape"].annotation), _Eurocode),
}


def _code_spectrum(
    table: Mapping[str, Any], name: str, factor: float, where: str
) -> DesignSpectrum:
    """Return the spectrum of a code from its shape and its numbers."""
    shape = table.get("shape")
    if shape not in SHAPES:
        hint = f'shape: "{shape}" is not' if shape is not None else 'missing key "shape":'
        raise InputError(f"{hint} one of {', '.join(SHAPES)}", where)
    numbers = read_toml(data_path("spectra", "codes.toml"))[shape]
    checked = validated(SHAPES[shape], dict(table), where)
    try:
        curve = checked._curve(numbers)
    except InputError as error:
        raise error.located(where) from None
    words = checked._words + _times(factor)
    return DesignSpectrum(name or shape, words, curve, factor, numbers["citation"])


def _times(factor: float) -> str:
    return f" times {factor:g}" if factor != 1.0 else ""


@cache
def _spectra() -> dict[tuple[str, str], StandardSpectrum]:
    table = read_toml(data_path("spectra", "jra-level-2.toml"))

    def _in_mm_s2(text: str) -> float:
        number, unit = text.split()
        return float(number) * acceleration_unit(unit)

    spectra = {}
    for kind in KINDS:
        kind_table = table[kind]
        for ground in GROUNDS:
            row = kind_table["grounds"][ground]
            first, second = (parse_quantity(text, "s") for text in row["corners"])
            sizes = {key: _in_mm_s2(row[key]) for key in ("rise", "plateau", "fall")}
            powers = {k: float(Fraction(kind_table[k])) for k in ("rise_power", "fall_power")}
            spectra[kind, ground] = StandardSpectrum(**sizes, **powers, corners=(first, second))
    return spectra


def kind_and_ground(kind: str | int, ground: str | int) -> tuple[str, str]:
    """Return both as Roman numbers; InputError for others.

    >>> kind_and_ground("ii", 3)
    ('II', 'III')
    """
    numbers = {"1": "I", "2": "II", "3": "III"}
    numerals, problems = [], []
    arguments = (("type of earthquake", kind, KINDS), ("ground", ground, GROUNDS))
    for label, text, names in arguments:
        numerals.append(numbers.get(str(text).strip(), str(text).strip().upper()))
        if numerals[-1] not in names:
            problems.append(f'{label}: "{text}" is not one of {", ".join(names)}')
    if problems:
        raise InputError(problems)
    return numerals[0], numerals[1]


def standard_spectrum(
    kind: str | int, ground: str | int, periods: ArrayLike, *, zone_factor: float = 1.0
) -> Floats:
    """Return the standard acceleration spectrum of a Level 2 earthquake [mm/s2], 5 % damping.

    Japan Road Association, Specifications for Highway Bridges, Part V (2012), for type "I" (plate
    boundary) or "II" (inland), ground "I" (hard), "II" or "III" (soft), natural periods > 0 [s] and
    the factor c_z of the region in [0.01, 2].
    """
    key = kind_and_ground(kind, ground)
    return standard_target(*key, zone_factor).at(periods)


def standard_target(kind: str, ground: str, zone_factor: float = 1.0) -> DesignSpectrum:
    """Return a standard spectrum of Level 2 as a target; type and ground are Roman numbers."""
    if not is_number(zone_factor):
        raise InputError(
            f"zone_factor = {short_repr(zone_factor)}: must be a number", "standard_spectrum()"
        )
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
    match = STANDARD.fullmatch(name)
    if match is None:
        raise unknown_name("standard spectrum", name, STANDARD_NAMES)
    return match[1].upper(), match[2].upper()


@checked
def load_spectrum(
    name_or_path: str | Path | Mapping[str, Any], factor: float = 1.0
) -> DesignSpectrum:
    """Return a spectrum of 5 % damping that motions can be made to fit or be compared with.

    Parameters
    ----------
    name_or_path : a standard spectrum of Level 2, "jra-<type>-<ground>", such as "jra-ii-i"; a file
        with columns `period` [s] and `acceleration` (with its unit: gal, g, m/s2 ...), from 0.1 s
        or less to 3 s or more, and the acceleration of the ground in a first row of period 0 if
        it is known; or the shape of a code with its numbers, as a mapping or a TOML
        file: `shape` "aashto" with A_s, S_DS and S_D1, "asce-7" with S_DS, S_D1 and T_L, or
        "en-1998-1" with `type` (1 or 2), `ground` ("A" to "E") and a_g.
    factor : multiplies the spectrum, in [0.01, 2] of a standard spectrum (c_z).

    Returns
    -------
    DesignSpectrum : for `make_motion`, `match_spectrum` and `examine_motion`; its method `at` gives
        the acceleration at periods [mm/s2].

    Raises
    ------
    InputError : no such name or file, faults in it, or a factor that is not greater than 0.

    Notes
    -----
    Between the points of a file the spectrum is straight where both axes are logarithmic. The
    numbers of the codes (`data/spectra/codes.toml`) were not compared with their text.

    Examples
    --------
    >>> site = {"shape": "aashto", "A_s": "0.4 g", "S_DS": "1 g", "S_D1": "0.6 g"}
    >>> spectrum = load_spectrum(site)
    >>> [round(float(value)) for value in spectrum.at([0.3, 1.0, 2.0])]  # [mm/s2]
    [9807, 5884, 2942]
    """
    if not (is_number(factor) and 0.0 < factor < HUGEST):
        raise InputError(f"factor = {factor!r}: must be a number greater than 0", "load_spectrum()")
    if isinstance(name_or_path, Mapping):
        return _code_spectrum(name_or_path, "", factor, "load_spectrum()")
    text = str(name_or_path)
    if STANDARD.fullmatch(text):
        return standard_target(*find_kind(text), factor)
    path = Path(name_or_path)
    if not (is_file(path) or isinstance(name_or_path, Path) or path.suffix or "/" in text):
        raise unknown_name("standard spectrum", text, STANDARD_NAMES)
    if path.suffix.lower() == ".toml":
        table = split_sources(read_toml(path))[0]
        return _code_spectrum(table, printable(path.stem), factor, str(path))
    words = f'the spectrum "{path.stem}"{_times(factor)}'
    try:
        return DesignSpectrum(path.stem, words, _read_points(path), factor)
    except InputError as error:
        raise error.located(path) from None


def _read_points(path: Path) -> TableSpectrum:
    """Return the points of a file."""
    tables = (make_table(sheet) for sheet in read_sheets(path))
    table = next((candidate for candidate in tables if candidate is not None), None)
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
    if periods[0] < 0.0 or values.min() <= 0.0:
        raise InputError(
            "accelerations must be greater than 0, and periods too, but for a first row of period "
            "0 with the acceleration of the ground"
        )
    start = None
    if periods[0] == 0.0:  # no logarithm: the peak ground acceleration
        start, periods, values = float(values[0]), periods[1:], values[1:]
    if not len(periods):
        raise InputError("has the acceleration of the ground alone")
    if periods[0] > FIRST or periods[-1] < LAST:
        ground = "" if start is None else "has a row of period 0, and after it "
        ends = [f"{FIRST:g} s or less"] if periods[0] > FIRST else []
        ends += [f"{LAST:g} s or more"] if periods[-1] < LAST else []
        raise InputError(
            f"{ground}reaches from {periods[0]:g} to {periods[-1]:g} s; motions are fitted from "
            f"{FIRST:g} to {LAST:g} s: add a row at {joined(ends)}"
        )
    return TableSpectrum(tuple(periods.tolist()), tuple(values.tolist()), start)


def _find_column(table: Table, quantity: str, names: tuple[str, ...]) -> int:
    """Return the number of a column by the first word of its title."""
    firsts = [re.split(r"[\s_,(\[]", t.strip().lower(), maxsplit=1)[0] for t in table.titles]
    for number, first in enumerate(firsts):
        if first in names:
            return number
    titles = ", ".join(table.titles)
    raise InputError(f'no column "{quantity}" with its unit; known: {titles}')
