"""What no test decides about a bearing: its force at rates above theirs, and after small reversals.

Each alternative is the bearing with other parameters or another law. What a result changes by is
reported as a band.
"""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from thermobearing.bearing.model import Bearing, SmallLoops
from thermobearing.quantities.words import joined

RATE, SMALL_LOOPS = "rate", "small loops"
UNDECIDED_OF = "undecided_of"  # column of bands: the bearings of which something is not decided
OTHER: dict[SmallLoops, SmallLoops] = {"published": "closed", "closed": "published"}


def rate_alternatives(bearing: Bearing) -> dict[str, Bearing]:
    """Return a bearing with the ends of its rate band that do not act, by the name of the end."""
    band = bearing.rate_band
    if band is None or (bearing.rate is None and band.shear_modulus is None):
        return {}
    ends = {"lowest": band.lowest, "highest": band.highest}
    return {
        end: bearing.model_copy(update={"rate_band": band.model_copy(update={"factor": factor})})
        for end, factor in ends.items()
        if factor != band.factor
    }


def alternatives(
    bearing: Bearing, small_loops: SmallLoops | None = None
) -> dict[tuple[str, str], Bearing]:
    """Return the alternatives of a bearing by what is not decided and the name of the alternative.

    `small_loops` is the law of the analysis, where it states one. Linear rubber has no loops, and a
    law of the user its own.
    """
    by_name = {(RATE, end): alternative for end, alternative in rate_alternatives(bearing).items()}
    rubber = bearing.hysteresis
    if bearing.hysteresis_law is None and rubber.post_yield_ratio < 1.0:
        law = OTHER[small_loops or rubber.small_loops or "published"]
        closed = rubber.model_copy(update={"small_loops": law})
        by_name[SMALL_LOOPS, law] = bearing.model_copy(update={"hysteresis": closed})
    return by_name


def undecided_of(
    devices: Iterable[object], small_loops: SmallLoops | None = None
) -> dict[str, str]:
    """Return the names of the bearings that have alternatives, by what is not decided of them."""
    names: dict[str, dict[str, None]] = {}
    for device in devices:
        if isinstance(device, Bearing):
            for undecided, _ in alternatives(device, small_loops):
                names.setdefault(undecided, {})[device.name] = None
    return {undecided: joined(bearings) for undecided, bearings in names.items()}


def band(changes: Iterable[float]) -> tuple[float, float]:
    """Return the lowest and highest of relative changes and of none, without unknown ones.

    >>> band([-0.1, np.nan, -0.02])
    (-0.1, 0.0)
    """
    # Zero is the bearing as it is; a failed alternative has no number.
    finite = [0.0, *(float(change) for change in changes if np.isfinite(change))]
    return min(finite), max(finite)


def band_text(low: float, high: float) -> str:
    """Return a band of relative changes in percent.

    >>> band_text(-0.104, 0.0)
    '-10 to 0 %'
    """
    # A change that rounds to zero has no sign.
    ends = [f"{round(100.0 * end) + 0:+d}" if round(100.0 * end) else "0" for end in (low, high)]
    return f"{ends[0]} to {ends[1]} %"


def band_sentences(rows: Iterable[Mapping[Any, Any]], names: Mapping[str, str]) -> list[str]:
    """Return a sentence for each bearing: the bands of what is not decided, by quantity.

    `rows` have `bearing`, `undecided`, `undecided_of`, `quantity`, `lowest` and `highest`; `names`
    the words of quantities. A sentence names the bearings of which something is not decided, which
    are not that of the analysis where lines have their own.
    """
    ends: dict[tuple[str, str], dict[str, dict[str, list[float]]]] = {}
    for row in rows:
        # A result of an earlier version has the bearing of the analysis only.
        key = str(row["bearing"]), str(row.get(UNDECIDED_OF) or row["bearing"])
        of_bearing = ends.setdefault(key, {}).setdefault(str(row["undecided"]), {})
        changes = of_bearing.setdefault(str(row["quantity"]), [])
        changes += [float(row["lowest"]), float(row["highest"])]
    sentences = []
    for (_, bearings), undecided in ends.items():
        texts = [
            f"{cause}: "
            + ", ".join(
                f"{band_text(*band(quantities[name]))} {names[name]}"
                for name in names
                if name in quantities
            )
            for cause, quantities in undecided.items()
        ]
        sentences.append(f"not decided by tests, {bearings}: {'; '.join(texts)}")
    return sentences
