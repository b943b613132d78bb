"""Whether the air around a test stayed as warm as it was."""

from functools import cache
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from thermobearing.border.library import data_path
from thermobearing.border.schema import Strict, in_unit, validated
from thermobearing.border.toml import read_toml, split_sources

Floats = NDArray[np.float64]

PARTS = 20  # of the test, in time: noise and a door that was opened are no drift
READ_TO = 1  # decimals of a temperature in K


class ChamberNumbers(Strict):
    """What data/identify/ambient.toml says [K]."""

    ambient_drift: Annotated[float, in_unit("K"), Field(gt=0)]


@cache
def chamber_numbers() -> ChamberNumbers:
    """The numbers, read once."""
    path = data_path("identify", "ambient.toml")
    return validated(ChamberNumbers, split_sources(read_toml(path))[0], str(path))


def told_drift(time: Floats, ambient: Floats) -> str:
    """A sentence where the ambient temperature drifts within a test; "" where it does not.

    Parameters
    ----------
    time : of the samples [s].
    ambient : the column of the file [degC].

    Returns
    -------
    str

    Examples
    --------
    >>> t = np.linspace(0.0, 600.0, 601)
    >>> told_drift(t, -20.0 + t / 1200.0)[:59]
    'the ambient temperature rises by 0.5 K within the test, fro'
    >>> told_drift(t, -20.0 + t / 1500.0)
    ''
    """
    if not (np.diff(time) > 0.0).all():  # a look at the test refuses it
        return ""
    part = np.minimum((time - time[0]) / np.ptp(time) * PARTS, PARTS - 1).astype(np.int64)
    middles = np.array([np.median(ambient[part == k]) for k in np.unique(part)])
    line = float(np.polyfit(time - time.mean(), ambient, 1)[0] * np.ptp(time))
    wandered = max(abs(line), float(np.ptp(middles)))
    if round(wandered, READ_TO) < chamber_numbers().ambient_drift:
        return ""
    straight = abs(line) >= 0.5 * wandered
    way = "wanders" if not straight else "rises" if line > 0.0 else "falls"
    return (
        f"the ambient temperature {way} by {wandered:.1f} K within the test, from "
        f"{middles[0]:.1f} to {middles[-1]:.1f} degC: its mean, {ambient.mean():.1f} degC, stands "
        "for all of it; cut the file where that is too much, or give ambient"
    )
