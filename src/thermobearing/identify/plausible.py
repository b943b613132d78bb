"""Strains and moduli that a rubber bearing can have, and the slip of a unit behind others."""

from collections.abc import Iterator
from typing import Literal

from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.identify.cycles import measures_of
from thermobearing.identify.record import TestRecord

Words = tuple[Literal["refused", "warning", "note"], str, str]

SOFTEST, STIFFEST = 0.2, 12.0  # equivalent shear modulus of bearings, cold ones too [MPa]
LARGEST_STRAIN, SMALLEST_STRAIN = 4.0, 0.05
OTHER_RUBBER = 0.02  # of the total rubber thickness: how far that of the file may be from it
TONF = 9.80665
SLIPS = (  # factors on force and displacement that would mend it, and what was then mixed up
    (TONF, 1.0, "force in tonf labelled kN"),
    (1.0 / TONF, 1.0, "force in kN labelled tonf"),
    (1e-3, 1.0, "force in N labelled kN"),
    (1e3, 1.0, "force in kN labelled N"),
    (1.0, 10.0, "displacement in cm labelled mm"),
    (1.0, 0.1, "displacement in mm labelled cm"),
)


def plausibility(record: TestRecord, bearing: Bearing) -> Iterator[Words]:
    """What the largest strain and the modulus there say of units, as level, check and sentence.

    Parameters
    ----------
    record : a test with rests held and spikes bridged, with one full cycle at least.
    bearing : plan area and rubber thickness.

    Yields
    ------
    tuple of str : "refused" for numbers that no bearing has.

    Examples
    --------
    >>> import numpy as np
    >>> from thermobearing.bearing.library import load_bearing
    >>> from thermobearing.identify.record import record_from_arrays
    >>> t = np.linspace(0.0, 1.0, 201)
    >>> x = 30.0 * np.sin(2.0 * np.pi * t)
    >>> record = record_from_arrays(t, x, 2000.0 * x, 23.0)
    >>> [words[2] for words in plausibility(record, load_bearing("shen-hdr-specimen"))]
    ... # doctest: +ELLIPSIS
    ['... is 1.04e+03 MPa, more than any bearing has; is force in N labelled kN (1.04 MPa)?']
    """
    rubber = bearing.total_rubber_thickness
    strain = record.peak_displacement / rubber
    if strain > LARGEST_STRAIN:
        yield (
            "refused",
            "strain",
            f"displacement reaches {record.peak_displacement:.4g} mm, {strain:.0%} of the total "
            f"rubber thickness of {rubber:g} mm: wrong unit, or the wrong bearing?",
        )
    elif strain < SMALLEST_STRAIN:
        yield (
            "warning",
            "strain",
            f"displacement reaches {strain:.1%} of the total rubber thickness only: wrong unit?",
        )
    told = record.rubber_thickness
    if told is not None and abs(told - rubber) > OTHER_RUBBER * rubber:
        yield (
            "warning",
            "rubber",
            f"displacement over strain gives a total rubber thickness of {told:.4g} mm, but "
            f"the bearing has {rubber:g} mm: the wrong bearing, or a wrong unit?",
        )
    try:
        measured = measures_of(record, record.force, bearing.area, rubber)
    except InputError:  # a cycle with too few samples, which the check of sampling has refused
        return
    modulus = max(measured, key=lambda m: m.amplitude_mm).G_eq_MPa
    stated = f"the equivalent shear modulus at the largest amplitude is {modulus:.3g} MPa"
    if modulus < SOFTEST:
        yield "refused", "unit", f"{stated}, less than any rubber has{_slip(modulus, strain)}"
    elif modulus > STIFFEST:
        yield "refused", "unit", f"{stated}, more than any bearing has{_slip(modulus, strain)}"
    else:
        yield "note", "unit", stated


def _slip(modulus: float, strain: float) -> str:
    """Slips of units that would make a modulus [MPa] and a largest strain plausible."""
    said = [
        f"{what} ({modulus * force / way:.3g} MPa)"
        for force, way, what in SLIPS
        if SOFTEST < modulus * force / way < STIFFEST
        and SMALLEST_STRAIN < strain * way < LARGEST_STRAIN
    ]
    return f"; is {' or '.join(said)}?" if said else ""
