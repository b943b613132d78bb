"""Standard spectra of Level 2 earthquakes for highway bridges in Japan."""

from dataclasses import dataclass
from fractions import Fraction
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from thermobearing.border.errors import InputError
from thermobearing.border.library import data_path
from thermobearing.border.toml import read_toml
from thermobearing.border.units import HUGEST, number_list, parse_quantity
from thermobearing.core.types import Floats
from thermobearing.motions.record import acceleration_unit

KINDS, GROUNDS = ("I", "II"), ("I", "II", "III")
SMALLEST_ZONE_FACTOR, LARGEST_ZONE_FACTOR = 0.01, 2.0  # the specifications know 0.7 to 1.2


@dataclass(frozen=True)
class StandardSpectrum:
    """S(T) of one type of earthquake and one ground: a rise, a plateau and a fall.

    Attributes
    ----------
    rise, fall : the branches at T = 1 s [mm/s2].
    rise_power, fall_power : of the period.
    plateau : between the corners [mm/s2].
    corners : periods where the plateau begins and ends [s].
    """

    rise: float
    rise_power: float
    plateau: float
    fall: float
    fall_power: float
    corners: tuple[float, float]

    def at(self, periods: Floats) -> Floats:
        """The branches at periods > 0 [mm/s2]."""
        rise = self.rise * periods**self.rise_power
        fall = self.fall * periods**self.fall_power
        first, second = self.corners
        return np.where(
            periods < first,
            rise,
            np.where(periods > second, fall, np.full_like(fall, self.plateau)),
        )


def _gal(text: str) -> float:
    number, unit = text.split()
    return float(number) * acceleration_unit(unit)


@cache
def _spectra() -> dict[tuple[str, str], StandardSpectrum]:
    table = read_toml(data_path("spectra", "jra-level-2.toml"))
    found = {}
    for kind in KINDS:
        about = table[kind]
        for ground in GROUNDS:
            row = about["grounds"][ground]
            first, second = (parse_quantity(text, "s") for text in row["corners"])
            found[kind, ground] = StandardSpectrum(
                rise=_gal(row["rise"]),
                rise_power=float(Fraction(about["rise_power"])),
                plateau=_gal(row["plateau"]),
                fall=_gal(row["fall"]),
                fall_power=float(Fraction(about["fall_power"])),
                corners=(first, second),
            )
    return found


def kind_and_ground(kind: str | int, ground: str | int) -> tuple[str, str]:
    """Both as Roman numbers; InputError for others.

    Examples
    --------
    >>> kind_and_ground("ii", 3)
    ('II', 'III')
    """
    numbers = {"1": "I", "2": "II", "3": "III"}
    given = [numbers.get(str(text).strip(), str(text).strip().upper()) for text in (kind, ground)]
    problems = []
    if given[0] not in KINDS:
        problems.append(f'type of earthquake: "{kind}" is not one of {", ".join(KINDS)}')
    if given[1] not in GROUNDS:
        problems.append(f'ground: "{ground}" is not one of {", ".join(GROUNDS)}')
    if problems:
        raise InputError(problems)
    return given[0], given[1]


def standard_spectrum(
    kind: str | int, ground: str | int, periods: ArrayLike, *, zone_factor: float = 1.0
) -> Floats:
    """Standard acceleration response spectrum of a Level 2 earthquake, 5 % damping.

    Japan Road Association, Specifications for Highway Bridges, Part V (2012).

    Parameters
    ----------
    kind : "I" (plate boundary) or "II" (inland).
    ground : "I" (hard), "II" or "III" (soft).
    periods : natural periods [s], > 0.
    zone_factor : c_z of the region, in [0.01, 2].

    Returns
    -------
    array : acceleration [mm/s2] at each period.

    Raises
    ------
    InputError : an unknown type or ground, a period or factor out of range.

    Examples
    --------
    >>> standard_spectrum("II", "I", [0.5]).tolist()  # 2000 gal
    [20000.0]
    """
    key = kind_and_ground(kind, ground)
    values = number_list(periods, "periods [s]")
    if (values < 1.0 / HUGEST).any():
        raise InputError("periods [s]: must be > 0", "standard_spectrum")
    return zone_factor * standard_curve(*key, zone_factor).at(values)


def standard_curve(kind: str, ground: str, zone_factor: float = 1.0) -> StandardSpectrum:
    """The curve of `standard_spectrum` without a factor, which is checked only.

    Parameters
    ----------
    kind, ground : Roman numbers.
    zone_factor : c_z of the region, in [0.01, 2].

    Raises
    ------
    InputError : the factor is out of range.
    """
    if not SMALLEST_ZONE_FACTOR <= zone_factor <= LARGEST_ZONE_FACTOR:
        raise InputError(
            f"zone_factor: {zone_factor:g} is outside [{SMALLEST_ZONE_FACTOR:g}, "
            f"{LARGEST_ZONE_FACTOR:g}]",
            "standard_spectrum",
        )
    return _spectra()[kind, ground]
