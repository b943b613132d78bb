"""Thermocouples of a test before it is used: their units, their state, and where they begin."""

from collections.abc import Iterator, Sequence

import numpy as np

from thermobearing.border.units import conversion
from thermobearing.identify.records.limits import check_limits
from thermobearing.identify.records.record import ASSUMED_AMBIENT, TestRecord
from thermobearing.identify.records.treatment import Finding, note, refuse, warn
from thermobearing.tables.gaps import initial_temperature

ZERO_DEGC = -conversion("K", "degC")[1]  # [K]


def check_thermocouples(record: TestRecord) -> Iterator[Finding]:
    """Yield thermocouples in kelvin, that look broken, or do not start near the ambient."""
    limits = check_limits()
    for title, values in record.temperatures.items():
        # Before the range of the sensor: 296 K in a column of degC is a wrong unit, no broken
        # sensor. Where the ambient temperature is not known, it is near that of laboratories.
        begin = initial_temperature(values)
        ambient = ASSUMED_AMBIENT if np.isnan(record.ambient) else record.ambient
        if abs(begin - ZERO_DEGC - ambient) < limits.like_kelvin and begin > limits.lowest_kelvin:
            yield refuse(
                "thermocouple",
                f"{title} starts at {begin:.4g} degC; in kelvin that would be "
                f'{begin - ZERO_DEGC:.3g} degC: set units."{title}" = "K" in the sidecar',
            )
        elif np.nanmin(values) < limits.coldest or np.nanmax(values) > limits.hottest:
            ends = f"{np.nanmin(values):.3g} to {np.nanmax(values):.3g} degC"
            message = f"{title} reads {ends}: is the sensor broken?"
            yield warn("thermocouple", message)
        elif record.conditioning is None and abs(begin - record.ambient) > limits.far_start:
            message = (
                f"{title} starts at {begin:.3g} degC, but the chamber is at "
                f"{record.ambient:.3g} degC: was the specimen there long enough?"
            )
            yield warn("thermocouple", message)


def check_starts(record: TestRecord) -> Iterator[Finding]:
    """Yield thermocouples that do not begin where the model does: at the ambient temperature.

    A difference that a good sensor may have is a note, a larger one a warning; one that is larger
    still is that of `check_thermocouples`.
    """
    limits = check_limits()
    for title, difference in start_differences(record):
        if not limits.notable_start < abs(difference) <= limits.far_start:
            continue
        begin = record.ambient + difference
        message = (
            f"{title} ({record.places[title]}) begins at {begin:.1f} degC, and the model at "
            f"{record.ambient:.4g} degC, the ambient temperature of the test: set "
            f'ambient = "{begin:.1f} degC" in the sidecar, or explain the difference'
        )
        level = warn if abs(difference) > limits.sensor_class else note
        yield level("thermocouple", message)


def start_differences(record: TestRecord) -> list[tuple[str, float]]:
    """Return where each thermocouple begins above the start of the model [K].

    None of a test that states its conditioning: its model does not begin at one temperature.
    """
    if record.conditioning is not None or np.isnan(record.ambient):
        return []
    return [
        (title, initial_temperature(values) - record.ambient)
        for title, values in record.temperatures.items()
    ]


def measured_start(differences: Sequence[float]) -> float | None:
    """Return by how much tests begin warmer than their model [K], by their thermocouples.

    None without any, or where the difference may be that of a sensor.
    """
    if not differences:
        return None
    difference = float(np.median(differences))
    return difference if abs(difference) > check_limits().notable_start else None
