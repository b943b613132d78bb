"""The temperature law of a bearing as numbers of the coupled step, and where it was left."""

from collections.abc import Iterable

import numpy as np

from thermobearing.bearing.temperature import TemperatureLaw
from thermobearing.core.records import Floats, Rows, filled, rows
from thermobearing.core.types import LawPiece

SLACK = 0.1  # beyond the range that nobody can measure [K]
COLDER = -1e30  # where the first piece begins


def no_table() -> Rows[LawPiece]:
    """The exponential law alone."""
    return rows(LawPiece, 0)


def law_pieces(law: TemperatureLaw | None) -> Rows[LawPiece]:
    """Logarithms of the table's factors as cubics in T, piece by piece (Fritsch & Carlson 1980).

    The first and last piece are straight lines that go on beyond the table with its slope there.
    """
    if law is None or law.temperatures is None:
        return no_table()
    from scipy.interpolate import PchipInterpolator

    at = np.array(law.temperatures)
    coefficients = []
    for factors in (law.elastic, law.hysteretic):
        values = np.log(np.array(factors))
        cubic = PchipInterpolator(at, values)
        ends = cubic.derivative()(at[[0, -1]])
        zero = np.zeros(2)
        lines = np.array([zero, zero, ends, values[[0, -1]]])
        coefficients.append(np.column_stack([lines[:, :1], cubic.c, lines[:, 1:]])[::-1])
    elastic, hysteretic = coefficients
    return filled(
        LawPiece,
        lowest=np.array([COLDER, *at]),
        origin=np.array([at[0], *at]),
        **{f"elastic_{k}": elastic[k] for k in range(4)},
        **{f"hysteretic_{k}": hysteretic[k] for k in range(4)},
    )


def outside_law(
    name: str, law: TemperatureLaw | None, runs: Iterable[tuple[str, Floats, Floats]]
) -> list[str]:
    """A sentence where rubber left the range in which its temperature law was identified.

    Parameters
    ----------
    name : of the bearing.
    law : its temperature law.
    runs : of each what it is called, times [s] and layer temperatures [degC], a row a time. A run
        with several bearings has one entry for each, under the same name, and counts once.
    """
    if law is None or law.range is None:
        return []
    low, high = law.range
    coldest, warmest, longest, worst = np.inf, -np.inf, 0.0, ""
    left: set[str] = set()
    for label, time, layers in runs:
        out = ((layers < low - SLACK) | (layers > high + SLACK)).any(axis=1)
        if not out.any():
            continue
        left.add(label)
        coldest = min(coldest, float(np.nanmin(layers)))
        warmest = max(warmest, float(np.nanmax(layers)))
        seconds = float(np.diff(time, prepend=time[0])[out].sum())
        if seconds >= longest:
            longest, worst = seconds, label
    if not left:
        return []
    runs_left = "1 run" if len(left) == 1 else f"{len(left)} runs"
    return [
        f"{name}: the temperature law was identified at {low:g} to {high:g} degC, and is "
        f"extrapolated in {runs_left}, where rubber layers are at {coldest:.1f} to {warmest:.1f} "
        f"degC, outside for at most {longest:.3g} s ({worst})"
    ]
