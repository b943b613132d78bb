"""What tests cover: the range that a fit is known in, and what a prediction asks beyond it."""

from collections.abc import Sequence

import numpy as np

from thermobearing.bearing.validity import Validity
from thermobearing.identify.cycles import cycles_of
from thermobearing.identify.forward import Prediction
from thermobearing.identify.record import TestRecord
from thermobearing.results.ranges import Ends, cycles_in_a_row, largest_speed, reached_by


def reached_in(
    record: TestRecord, rubber: float, ambient: float, lead: tuple[float, float] | None
) -> dict[str, float | Ends]:
    """What the history of a record asks of a bearing.

    Parameters
    ----------
    record : a test.
    rubber : total thickness of the bearing [mm].
    ambient : temperature of the air [degC].
    lead : coldest and warmest temperature of the lead [degC]; None where it is not known.

    Returns
    -------
    dict : as of `reached_by`.
    """
    time, x = record.time, record.displacement
    air, warm = (ambient, ambient), None if lead is None else np.array(lead)
    speed = largest_speed(time, x)
    return reached_by(time, x, speed, rubber=rubber, ambient=air, lead=warm)


def range_of_tests(
    records: Sequence[TestRecord], predictions: Sequence[Prediction], rubber: float
) -> Validity:
    """Lowest and highest value of each quantity in some tests, as a bearing's file holds it.

    Parameters
    ----------
    records : of the fit.
    predictions : of the fitted model, for the temperature of the lead.
    rubber : total thickness of the bearing [mm].

    Returns
    -------
    Validity : strains of the full cycles (of the whole test without any), largest speeds, air,
        most cycles in a row, and lead as the model has it.

    Examples
    --------
    >>> from thermobearing.identify.record import record_from_arrays
    >>> t = np.linspace(0.0, 8.0, 801)
    >>> tests = [record_from_arrays(t, a * np.sin(np.pi * t), t + 1.0, 5.0) for a in (15.0, 60.0)]
    >>> found = range_of_tests(tests, [], 30.0)
    >>> [round(end, 2) for end in found.strain], found.ambient, found.cycles
    ([0.5, 2.0], [5.0, 5.0], [0.0, 4.0])
    """
    strains, speeds = [], []
    for record in records:
        full = [cycle.amplitude for cycle in cycles_of(record) if not cycle.closing]
        strains += [float(size) / rubber for size in full or [record.peak_displacement]]
        speeds.append(largest_speed(record.time, record.displacement) / rubber)
    air = [float(record.ambient) for record in records]
    most = max(cycles_in_a_row(record.time, record.displacement) for record in records)
    leads = [found.lead for found in predictions if found.lead is not None]
    warm = (min(low for low, _ in leads), max(high for _, high in leads)) if leads else None
    return Validity(
        strain=_ends(strains),
        strain_rate=_ends(speeds),
        ambient=_ends(air),
        cycles=[0.0, most],
        lead_temperature=None if warm is None else _ends(warm),
    )


def _ends(values: Sequence[float]) -> list[float]:
    """Lowest and highest, to the digits that a test can know."""
    return [float(f"{end:.5g}") for end in (min(values), max(values))]
