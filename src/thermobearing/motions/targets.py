"""Spectra that motions are made to fit: a standard one by name, or a table of one's own."""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from thermobearing.border.errors import InputError, is_file
from thermobearing.border.layout import Table, table_of
from thermobearing.border.library import unknown_name
from thermobearing.border.sheets import read_sheets
from thermobearing.core.types import Floats
from thermobearing.motions.jra import GROUNDS, KINDS, StandardSpectrum, standard_curve
from thermobearing.motions.matching import FIRST, LAST
from thermobearing.motions.record import acceleration_unit

CITATION = (
    "Standard spectrum: Japan Road Association, Specifications for Highway Bridges, Part V (2012)"
)
STANDARD = re.compile(r"jra-(i|ii)-(i|ii|iii)")
SECONDS = ("", "s", "sec")
PERIOD, ACCELERATION = ("period", "t"), ("acceleration", "sa", "s")  # titles in lower case


@dataclass(frozen=True)
class TableSpectrum:
    """S(T) on straight lines between points, both axes logarithmic.

    Below the first period it stays as it is, above the last it falls with 1/T: motions are
    compared from 0.1 to 3 s, and adjusted a little beyond.

    Attributes
    ----------
    periods : increasing [s].
    values : there [mm/s2].
    """

    periods: tuple[float, ...]
    values: tuple[float, ...]

    def at(self, periods: Floats) -> Floats:
        """Acceleration at periods > 0 [mm/s2]."""
        x, y = np.log(self.periods), np.log(self.values)
        inside = np.exp(np.interp(np.log(periods), x, y))
        return np.asarray(inside * np.minimum(1.0, self.periods[-1] / periods))


@dataclass(frozen=True)
class DesignSpectrum:
    """A spectrum of 5 % damping that motions are made to fit.

    Attributes
    ----------
    name : "jra-ii-i", or that of a file.
    told : the same in words.
    curve : its shape.
    factor : what multiplies that; c_z of a standard one.
    citation : where it comes from.
    caveat : what a motion that fits it is not.
    """

    name: str
    told: str
    curve: StandardSpectrum | TableSpectrum
    factor: float = 1.0
    citation: str = ""
    caveat: str = ""

    def at(self, periods: Floats) -> Floats:
        """Absolute acceleration at periods > 0 [mm/s2]."""
        return self.factor * self.curve.at(periods)


def standard_target(kind: str, ground: str, zone_factor: float = 1.0) -> DesignSpectrum:
    """A standard spectrum of Level 2 as a target.

    Parameters
    ----------
    kind, ground : Roman numbers.
    zone_factor : c_z.

    Raises
    ------
    InputError : a factor out of range.
    """
    return DesignSpectrum(
        name=f"jra-{kind}-{ground}".lower(),
        told=f"the standard spectrum of Level 2 Type {kind}, ground {ground}, "
        f"c_z = {zone_factor:g}",
        curve=standard_curve(kind, ground, zone_factor),
        factor=zone_factor,
        citation=CITATION,
        caveat="NOT an accelerogram of the specifications",
    )


def list_spectra() -> list[str]:
    """Names of the standard spectra, `jra-<type>-<ground>`.

    Examples
    --------
    >>> list_spectra()[:2]
    ['jra-i-i', 'jra-i-ii']
    """
    return [f"jra-{kind}-{ground}".lower() for kind in KINDS for ground in GROUNDS]


def kind_of(name: str) -> tuple[str, str]:
    """Type and ground of a standard spectrum by its name.

    Raises
    ------
    InputError : there is none of that name.

    Examples
    --------
    >>> kind_of("jra-ii-i")
    ('II', 'I')
    """
    named = STANDARD.fullmatch(name)
    if named is None:
        raise unknown_name("standard spectrum", name, list_spectra())
    return named[1].upper(), named[2].upper()


def load_spectrum(name_or_path: str | Path, factor: float = 1.0) -> DesignSpectrum:
    r"""A spectrum that motions can be made to fit.

    Parameters
    ----------
    name_or_path : one of `list_spectra()`, or a file with columns `period` [s] and `acceleration`
        (with its unit: gal, g, m/s2 ...), of 5 % damping, from 0.1 s or less to 3 s or more.
    factor : what multiplies it, c_z of a standard one, in [0.01, 2].

    Raises
    ------
    InputError : no such spectrum, faults in the file.

    Examples
    --------
    >>> import tempfile
    >>> file = Path(tempfile.mkdtemp()) / "site.csv"
    >>> _ = file.write_text("period_s,acceleration_gal\n0.1,400\n0.5,800\n4,100\n")
    >>> load_spectrum(file).at(np.array([0.5])).round(6).tolist()
    [8000.0]
    """
    text = str(name_or_path)
    if STANDARD.fullmatch(text):
        return standard_target(*kind_of(text), factor)
    path = Path(name_or_path)
    if not (is_file(path) or isinstance(name_or_path, Path) or path.suffix or "/" in text):
        raise unknown_name("standard spectrum", text, list_spectra())
    curve, told = _read(path), f'the spectrum "{path.stem}"'
    if factor != 1.0:
        told += f" times {factor:g}"
    return DesignSpectrum(path.stem, told, curve, factor)


def _read(path: Path) -> TableSpectrum:
    """The points of a file."""
    tables = [table_of(sheet) for sheet in read_sheets(path)]
    table = next((one for one in tables if one is not None), None)
    if table is None:
        raise InputError("is empty", str(path))
    try:
        periods = _periods(table)
        column = _column(table, "acceleration", ACCELERATION)
        values = table.numbers(column, acceleration_unit(_unit(table, column)))
        _check(periods, values)
    except InputError as error:
        raise InputError(error.problems, str(path)) from None
    return TableSpectrum(tuple(periods.tolist()), tuple(values.tolist()))


def _periods(table: Table) -> Floats:
    """The column of periods [s]."""
    column = _column(table, "period", PERIOD)
    said = table.unit(column)
    if said not in SECONDS:
        raise InputError(f'column "{table.titles[column]}": periods are in s')
    return table.numbers(column)


def _column(table: Table, what: str, names: tuple[str, ...]) -> int:
    """Number of a column by its title."""
    for number, title in enumerate(table.titles):
        plain = re.split(r"[\s_,(\[]", title.strip().lower(), maxsplit=1)[0]
        if plain in names:
            return number
    held = ", ".join(table.titles)
    raise InputError(f'no column "{what}" with its unit; known: {held}')


def _unit(table: Table, column: int) -> str:
    """Unit of the acceleration, from its title or the row of units."""
    said = table.unit(column)
    if not said:
        raise InputError(
            f'column "{table.titles[column]}" has no unit; write "acceleration [gal]", or g, m/s2'
        )
    return said


def _check(periods: Floats, values: Floats) -> None:
    """InputError for points that no motion can be fitted to."""
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
