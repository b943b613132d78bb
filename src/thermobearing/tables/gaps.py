"""Missing readings in the columns of temperatures of a test: their texts, counts and limits.

A sensor that fails for a few samples does not end a test: readings of thermocouples are left out
of comparisons there (they are NaN), and those of the chamber are filled. Force and displacement
have no gaps: the model follows each of their samples.
"""

from typing import NamedTuple

import numpy as np

from thermobearing.core.records import Floats
from thermobearing.quantities.words import counted, percent

# What data loggers and spreadsheets write in place of a reading, in lower case.
MISSING = frozenset(
    {"", "-", "--", "---", "\u2013", "\u2014", "nan", "na", "n/a", "#n/a", "#n/v", "#nv"}
)
MOST_MISSING = 0.5  # of the samples of a column: with fewer readings it is no record of the test
# Of the time or the samples of a test, without a reading. A temperature that rises as a parabola,
# from steep to level, departs from a line over a tenth of the test by 0.25 % of its rise.
LONGEST_GAP = 0.1
FIRST = 5  # readings from which the beginning of a temperature is taken: one has its noise


class Gaps(NamedTuple):
    """The missing readings of one column of temperatures."""

    title: str
    chamber: bool  # the column is that of the chamber, and was filled
    missing: int
    samples: int
    place: str  # of the first, "line 14"
    begins: float  # the first reading, after the first sample [s]
    share: float  # of the test in its longest gap, in time or in samples, whichever is larger

    @property
    def fault(self) -> str:
        """Why the column cannot be used; "" if it can."""
        where = f'{self.place}, "{self.title}": the first of {self.missing} missing readings'
        if self.missing > MOST_MISSING * self.samples:
            reason = f"{where}, {percent(self.missing / self.samples)} of the samples"
        elif self.share > LONGEST_GAP:
            reason = (
                f"{where}, one gap of which is {percent(self.share)} of the test, more than "
                f"{percent(LONGEST_GAP)}"
            )
        else:
            return ""
        cure = (
            'state ambient = "... degC" in the sidecar and remove ambient from [columns]'
            if self.chamber
            else "remove the column from [thermocouples] of the sidecar"
        )
        return f"{reason}. Name another sensor, or {cure}"

    @property
    def sentence(self) -> str:
        """How many readings are missing, and how they are treated."""
        are = "is" if self.missing == 1 else "are"
        treated = "filled in time from those next to them" if self.chamber else "left out"
        text = (
            f"{counted(self.missing, 'reading')} of {self.samples} of {self.title} {are} missing "
            f"(the first in {self.place}) and {are} {treated}"
        )
        if self.begins > 0.0:
            text += f"; the first reading, {self.begins:.3g} s after the first sample, begins it"
        return text


def is_missing(cell: str) -> bool:
    """Return whether a cell holds a text in place of a reading.

    >>> is_missing(" NaN"), is_missing("#N/A"), is_missing("0"), is_missing("lost")
    (True, True, False, False)
    """
    return cell.strip().lower() in MISSING


def initial_temperature(values: Floats) -> float:
    """Return where a temperature begins, as all messages and tables state it [degC]."""
    return float(np.median(values[~np.isnan(values)][:FIRST]))


def mean_reading(values: Floats) -> float:
    """Return the mean of the readings that are not missing; NaN without any."""
    readings = values[~np.isnan(values)]
    return float(readings.mean()) if len(readings) else float("nan")


def fill_gaps(places: Floats, values: Floats) -> Floats:
    """Return readings with straight lines across their gaps; there is one reading or more.

    Before the first reading stands where the readings begin, after the last one the last.

    >>> fill_gaps(np.arange(4.0), np.array([1.0, np.nan, 3.0, np.nan])).tolist()
    [1.0, 2.0, 3.0, 3.0]
    """
    missing = np.isnan(values)
    if not missing.any():
        return values
    begin = initial_temperature(values)
    filled = np.interp(places[missing], places[~missing], values[~missing], left=begin)
    result = values.copy()
    result[missing] = filled
    return result


def measure_gaps(title: str, place: str, time: Floats, values: Floats, *, chamber: bool) -> Gaps:
    """Return the missing readings of a column, of which there is one or more.

    `place` says where the first is in the file.
    """
    missing = np.flatnonzero(np.isnan(values))
    runs = np.split(missing, np.flatnonzero(np.diff(missing) > 1) + 1)
    # In time and in samples: loggers that sleep in rests take few samples in much time. A single
    # missing reading is no gap, however few samples a test has.
    longest = max(float(np.ptp(time[run])) / max(float(np.ptp(time)), 1e-12) for run in runs)
    most = max(len(run) for run in runs)
    share = max(longest, most / len(values) if most > 1 else 0.0)
    is_late = missing[0] == 0 and len(runs[0]) < len(values)
    begins = float(time[len(runs[0])] - time[0]) if is_late else 0.0
    return Gaps(title, chamber, len(missing), len(values), place, begins, share)
