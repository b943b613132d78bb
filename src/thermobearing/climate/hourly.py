"""Hourly ambient temperature, and the hours at which an earthquake may occur."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from thermobearing.bearing.ambient import COLDEST, HOTTEST, Ambient
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.lazy import pd
from thermobearing.border.units import is_number, refuse_hidden
from thermobearing.core.records import Floats, Ints

Dates = NDArray[np.datetime64]

HOUR, DAY = 3600.0, 24  # [s], [h]
MOST_HOURS = 10_000_000  # a thousand years


@checked
@dataclass(frozen=True)
class Hourly:
    """Ambient temperature at consecutive full hours.

    Attributes
    ----------
    temperature : at hour 0, 1, 2, ... [degC], in [-100, 100]; linear between the hours.
    begins : date of hour 0, where the file has dates.
    recurs : a typical year: its last hour precedes its first.
    name : for messages and figures.
    assumptions : properties that its file did not state.

    Raises
    ------
    InputError : fewer than two hours, a temperature that is not finite or not plausible.

    Examples
    --------
    >>> night = Hourly([-8.0, -10.0, -13.0], begins=np.datetime64("2024-01-31T22"))
    >>> night.months.tolist(), night.before(2, history=2).at(3600.0)
    ([1, 1, 2], -10.0)
    """

    temperature: Floats
    begins: np.datetime64 | None = None
    recurs: bool = False
    name: str = "weather"
    assumptions: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        refuse_hidden(self.temperature, self.name)
        try:
            values = np.array(self.temperature, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise InputError("needs a list of temperatures in degC", self.name) from None
        if values.ndim != 1 or not 2 <= len(values) <= MOST_HOURS:
            raise InputError(f"needs 2 to {MOST_HOURS} hours in one list", self.name)
        good = (values >= COLDEST) & (values <= HOTTEST)  # what is not finite is neither
        if not good.all():
            k = int(np.argmin(good))
            limits = f"{COLDEST:g} to {HOTTEST:g} degC"
            raise InputError(f"hour {k}: {values[k]:g} degC is outside {limits}", self.name)
        values.flags.writeable = False
        object.__setattr__(self, "temperature", values)
        if self.begins is not None:
            object.__setattr__(self, "begins", self.begins.astype("datetime64[h]"))

    def __len__(self) -> int:
        """Return the number of hours."""
        return len(self.temperature)

    @property
    def years(self) -> float:
        """Length in years of 365.25 days."""
        return len(self) / (DAY * 365.25)

    @property
    def dates(self) -> Dates:
        """Date of each hour; InputError without dates."""
        if self.begins is None:
            raise InputError("has no dates; write time as 2024-01-31 22:00", self.name)
        return np.asarray(self.begins + np.arange(len(self), dtype="m8[h]"))

    @property
    def months(self) -> Ints:
        """Month of each hour, 1 to 12; InputError without dates."""
        return np.asarray(self.dates.astype("datetime64[M]").astype(np.int64) % 12 + 1)

    def before(self, hour: int, history: float) -> Ambient:
        """Return the ambient temperature before an earthquake at the end of the series.

        Parameters
        ----------
        hour : number of the hour, from 0.
        history : how far back the series goes [h], at least 1; rounded up to full hours.
        """
        back = self.full_hours(history)
        first = int(hour) - back
        if not (0 <= hour < len(self) and (self.recurs or first >= 0)):
            raise InputError(
                f"hour {hour} with {back} h before it: must be {0 if self.recurs else back} to "
                f"{len(self) - 1}",
                self.name,
            )
        temperature = np.take(self.temperature, np.arange(first, hour + 1), mode="wrap")
        return Ambient(HOUR * np.arange(back + 1.0), temperature)

    def hours_at(self, shares: Floats, history: float = 0.0) -> Ints:
        """Return equally probable hours of an earthquake, from uniform numbers.

        Parameters
        ----------
        shares : uniform numbers in [0, 1), of any design: random, Latin hypercube, Sobol.
        history : required length of the series before each hour [h].

        Examples
        --------
        >>> Hourly([5.0, 4.0, 2.0, 3.0]).hours_at([0.0, 0.5, 0.99], history=2).tolist()
        [2, 3, 3]
        """
        shares = np.asarray(shares, dtype=np.float64)
        if not ((shares >= 0.0) & (shares < 1.0)).all():
            raise InputError("shares of the hours must be at least 0 and less than 1", self.name)
        back = self.full_hours(history) if history else 0
        first = 0 if self.recurs else back
        if back >= len(self):
            raise InputError(
                f"has {len(self)} hours; a history of {back} h needs more of them", self.name
            )
        hours = first + np.floor(shares * (len(self) - first)).astype(np.int64)
        # A share next to one may round up to the hour past the end.
        return np.asarray(np.minimum(hours, len(self) - 1))

    def full_hours(self, history: float) -> int:
        """Return a history in full hours, rounded up; InputError if it is not positive."""
        if not is_number(history) or not 1.0 <= history <= MOST_HOURS:
            raise InputError(f"history = {history!r}: must be 1 to {MOST_HOURS} h", self.name)
        return int(np.ceil(history - 1e-9))

    def to_frame(self) -> "pd.DataFrame":
        """Return hour, date if known, and temperature as columns."""
        frame = pd.DataFrame({"hour": np.arange(len(self)), "ambient_degC": self.temperature})
        if self.begins is not None:
            frame.insert(1, "date", self.dates.astype("datetime64[s]"))
        return frame
