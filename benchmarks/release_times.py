"""Times of a few calculations of the version that is imported, printed as JSON.

benchmarks/releases.py runs this file with the sources of each release, whose own benchmarks it
calls: these names have stayed since 0.2.0. What a release did not have yet is left out.
"""

import json
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from benchmarks.specimen import step_microseconds

if TYPE_CHECKING:
    from thermobearing.model.constants import LeadEnds

LEAD = "shen-lhdr-specimen"
REPEATS = 15


def step(name: str, lead_ends: "LeadEnds") -> float:
    """Return the fastest time of a coupled step over Table 3.4 at -20 degC [us]."""
    return step_microseconds(-20.0, REPEATS, name, lead_ends)[0]


def pier() -> float:
    """Return the time of pier P1 with every step kept [ms]."""
    from benchmarks.structure import one_analysis

    return one_analysis()


def lockstep() -> float:
    """Return the time of a history of pier P1 in lockstep, peaks only [ms]."""
    from benchmarks.lockstep import seconds, shakes
    from thermobearing.structure.lanes import run_lanes

    runs = shakes()
    run_lanes(runs)
    return 1e3 * min(seconds(partial(run_lanes, runs)) for _ in range(3)) / len(runs)


CALCULATIONS: dict[str, Callable[[], float]] = {
    "step, HDR specimen [us]": partial(step, "shen-hdr-specimen", "half-space"),
    "step, LHDR specimen, lead on a half-space [us]": partial(step, LEAD, "half-space"),
    "step, LHDR specimen, lead on finite plates [us]": partial(step, LEAD, "finite-plate"),
    "pier P1 on LHDR, 8000 steps, one by one [ms]": pier,
    "pier P1 on LHDR, 8000 steps, in lockstep [ms]": lockstep,
}


def measured() -> dict[str, float]:
    """Return the time of each calculation that this version has."""
    times = {}
    for name, calculate in CALCULATIONS.items():
        try:
            times[name] = calculate()
        except ImportError:
            continue
    return times


if __name__ == "__main__":
    print(json.dumps(measured()))
