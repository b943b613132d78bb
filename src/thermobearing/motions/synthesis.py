"""Motions matched to a target spectrum.

They are stand-ins: they fit the spectrum, and are not the accelerograms of the specifications.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from thermobearing.border.errors import InputError, is_file
from thermobearing.border.library import unknown_name
from thermobearing.core.types import Floats
from thermobearing.motions.jra import (
    GROUNDS,
    KINDS,
    StandardSpectrum,
    kind_and_ground,
    standard_curve,
)
from thermobearing.motions.matching import (
    FIRST,
    LAST,
    LONGEST_FIT,
    Effort,
    Matched,
    Progress,
    matched,
)
from thermobearing.motions.phases import motion_name, near_fault, phases
from thermobearing.motions.process import padded
from thermobearing.motions.record import GroundMotion, acceleration_unit
from thermobearing.tables.columns import Table, make_table
from thermobearing.tables.text import read_sheets

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


def _standard_target(kind: str, ground: str, zone_factor: float = 1.0) -> DesignSpectrum:
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


def find_kind(name: str) -> tuple[str, str]:
    """Type and ground of a standard spectrum by its name.

    Raises
    ------
    InputError : there is none of that name.

    Examples
    --------
    >>> find_kind("jra-ii-i")
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
        return _standard_target(*find_kind(text), factor)
    path = Path(name_or_path)
    if not (is_file(path) or isinstance(name_or_path, Path) or path.suffix or "/" in text):
        raise unknown_name("standard spectrum", text, list_spectra())
    curve, told = _read(path), f'the spectrum "{path.stem}"'
    if factor != 1.0:
        told += f" times {factor:g}"
    return DesignSpectrum(path.stem, told, curve, factor)


def _read(path: Path) -> TableSpectrum:
    """The points of a file."""
    tables = [make_table(sheet) for sheet in read_sheets(path)]
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


ROOM = 4.0  # [s] of rest before and after a record, for the ringing of changed amplitudes
SHORTEST_RECORD = 5.0  # [s]
SMALLEST_DT, LARGEST_DT = 0.001, 0.02  # half a period of 0.1 s holds at least 2.5 steps
# Where waves cancel in a narrow band, no amplitudes fill the hole: then the phases are drawn
# again. The limit leaves room below the 3 % that are promised.
DRAWS, ACCEPTED = 8, 0.025
LARGEST_SEED = 2**32 - 1


def make_motion(
    kind: str | int,
    ground: str | int,
    seed: int,
    dt: float = 0.01,
    *,
    zone_factor: float = 1.0,
    spectrum: DesignSpectrum | None = None,
    progress: Progress | None = None,
) -> GroundMotion:
    """A ground motion that fits a standard spectrum, the same for the same seed.

    Type I shakes for long; Type II is short with a velocity pulse. It is a stand-in that fits
    the spectrum, not one of the accelerograms of the specifications. Seed 1 of Type II, ground
    II, has the envelope and the pulse of the record behind its accelerogram (`data/phases`) and,
    with the time step of 0.01 s, its largest acceleration at the same time, 8 s. Seeds 1 to 3 of
    Type II, ground I, have phases with which the design of the bridge of Shen (2023) closes.

    Parameters
    ----------
    kind : "I" (plate boundary) or "II" (inland).
    ground : "I" (hard), "II" or "III" (soft).
    seed : of the random phases, 0 to 4294967295.
    dt : time step [s], in [0.001, 0.02].
    zone_factor : c_z, in [0.01, 2].
    spectrum : to be fitted instead of the standard one, from `load_spectrum`; type and ground then
        say how it shakes.
    progress : called after each round of the fit with (rounds done, at most).

    Returns
    -------
    GroundMotion : velocity and displacement end at zero; its description tells the root mean
        square misfit of its spectrum over 0.1 to 3 s, at most 3 % unless 400 rounds were too few.

    Raises
    ------
    InputError : an argument out of range.

    Examples
    --------
    >>> make_motion("II", "I", seed=1).name
    'jra-ii-i-1'
    """
    kind, ground = kind_and_ground(kind, ground)
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed <= LARGEST_SEED:
        raise InputError(f"seed: {seed!r} is not a whole number from 0 to {LARGEST_SEED}")
    _check_step(dt, "make_motion")

    target = spectrum or _standard_target(kind, ground, zone_factor)
    fit: Matched | None = None
    effort = Effort(progress=progress)
    for draw in range(DRAWS):
        trial = matched(phases(kind, ground, seed, draw, dt), dt, target.at, effort=effort)
        if fit is None or trial.misfit < fit.misfit:
            fit = trial
        if fit.misfit <= ACCEPTED or effort.spent:
            break
    assert fit is not None
    own = near_fault().get(motion_name(kind, ground, seed))
    stand_in = f"Stand-in, {target.caveat}: synthetic" if target.caveat else "Synthetic"
    return GroundMotion(
        name=f"{target.name}-{seed}",
        dt=dt,
        acceleration=fit.acceleration,
        description=(
            f"{stand_in}, fits {target.told} "
            f"(seed {seed}, misfit {100 * fit.misfit:.1f} % rms over 0.1-3 s)"
        ),
        citation="; ".join(text for text in (target.citation, own and own.citation) if text),
    )


def _check_step(dt: float, where: str) -> None:
    if not SMALLEST_DT <= dt <= LARGEST_DT:
        raise InputError(f"dt: {dt:g} s is outside [{SMALLEST_DT:g}, {LARGEST_DT:g}] s", where)


def match_spectrum(
    record: GroundMotion,
    kind: str | int = "II",
    ground: str | int = "I",
    *,
    zone_factor: float = 1.0,
    spectrum: DesignSpectrum | None = None,
    progress: Progress | None = None,
) -> GroundMotion:
    """A recorded motion with its Fourier amplitudes adjusted to a standard spectrum.

    The phases are kept, as in the accelerograms of the specifications. Rest is added before
    and after the record, for the ringing that changed amplitudes bring.

    Parameters
    ----------
    record : the recorded motion; at least 5 s long and at most 120000 samples, time step at most
        0.02 s.
    kind, ground, zone_factor : as of `standard_spectrum`.
    spectrum : to be fitted instead of the standard one, from `load_spectrum`.
    progress : called after each round of the fit with (rounds done, at most).

    Returns
    -------
    GroundMotion : velocity and displacement end at zero; its description tells the misfit.

    Raises
    ------
    InputError : an argument out of range; a record too short, too long, too coarse or zero
        throughout.

    Examples
    --------
    >>> record = make_motion("II", "I", seed=1)
    >>> match_spectrum(record, "II", "II").name
    'jra-ii-i-1-as-ii-ii'
    """
    target = spectrum or _standard_target(*kind_and_ground(kind, ground), zone_factor)
    check_record(record)
    room = padded(record, ROOM, ROOM).acceleration
    fit = matched(room, record.dt, target.at, finer=True, effort=Effort(progress=progress))
    caveat = f"; {target.caveat}" if target.caveat else ""
    as_name = target.name.removeprefix("jra-")
    return GroundMotion(
        name=f"{record.name}-as-{as_name}".lower(),
        dt=record.dt,
        acceleration=fit.acceleration,
        description=(
            f"{record.name} with Fourier amplitudes adjusted to {target.told}, phases kept (misfit "
            f"{100 * fit.misfit:.1f} % rms over 0.1-3 s){caveat}"
        ),
        citation="; ".join(text for text in (record.citation, target.citation) if text),
    )


def check_record(record: GroundMotion) -> None:
    """Whether a motion can be adjusted to a spectrum.

    Raises
    ------
    InputError : it is too short, too long, too coarse or zero throughout.
    """
    _check_step(record.dt, record.name)
    if record.duration < SHORTEST_RECORD:
        raise InputError(
            f"lasts {record.duration:g} s; at least {SHORTEST_RECORD:g} s are needed to fit "
            "periods up to 3 s",
            record.name,
        )
    if record.pga == 0.0:
        raise InputError("is zero throughout: it has no phases to keep", record.name)
    count = len(record.acceleration) + 2 * round(ROOM / record.dt)
    if count > LONGEST_FIT:
        raise InputError(
            f"has {count} samples with the rest around it; at most {LONGEST_FIT} can be "
            "fitted: cut it to its strong part, or take a longer dt",
            record.name,
        )
