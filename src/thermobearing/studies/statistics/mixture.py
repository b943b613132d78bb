"""Fragility over a climate: curves at some temperatures, each by its share of the time.

The temperature of the day of an earthquake is taken as independent of its size, so that the
probability of going beyond is the mean over the temperatures (total probability).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from thermobearing.border.errors import InputError
from thermobearing.studies.statistics.bootstrap import percentiles
from thermobearing.studies.statistics.fragility import Fragility
from thermobearing.studies.statistics.hazard import Hazard, annual_rate

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class ClimateFragility:
    """Fragility over all temperatures of a site.

    Attributes
    ----------
    parts : curve of each temperature [degC], from `fragilities`.
    shares : of the time, of each; their sum is 1.
    name : of the climate.
    """

    parts: Mapping[float, Fragility]
    shares: Floats
    name: str = "climate"

    def __post_init__(self) -> None:
        parts = list(self.parts.values())
        shares = np.asarray(self.shares, dtype=float)
        object.__setattr__(self, "shares", shares)
        if len(shares) != len(parts) or (shares < 0.0).any() or abs(shares.sum() - 1.0) > 1e-9:
            raise InputError("needs a share of the time for each temperature, 1 together")
        if any(part.band != "bootstrap" for part in parts):
            raise InputError('curves of a climate need bands by "bootstrap", of the same motions')
        if len({len(part.estimate.others.place) for part in parts}) > 1:
            raise InputError("curves of a climate need equally many bootstrap samples")

    def _used(self) -> list[tuple[float, Fragility]]:
        """Share and curve of each temperature that comes."""
        pairs = zip(self.shares, self.parts.values(), strict=True)
        return [(float(share), part) for share, part in pairs if share > 0.0]

    @property
    def known(self) -> bool:
        """Whether every temperature that comes has a curve, be it one of nothing or all."""
        return all(part.outcome != "not_rising" for _, part in self._used())

    def probability(self, intensity: Any) -> Floats:
        """Of going beyond the capacity, at intensities; NaN where a temperature has no curve.

        A temperature at which no run went beyond counts with 0, one at which all did with 1.
        """
        at = np.atleast_1d(np.asarray(intensity, dtype=float))
        if not self.known:
            return np.full(len(at), np.nan)
        return np.asarray(sum(s * part.estimate.probability(at) for s, part in self._used()))

    def family(self, intensity: Any, *, drawn: bool = False) -> Floats:
        """Return the same of every bootstrap sample, as `Fragility.family`."""
        parts = self._used()
        return np.asarray(sum(share * part.family(intensity, drawn=drawn) for share, part in parts))

    @property
    def groups(self) -> int:
        """Number of motions that the bootstrap draws from; 0 where it is no matter."""
        return self._used()[0][1].groups

    def ends(self, values: Floats) -> tuple[Floats, Floats]:
        """Ends of the band of what was computed from each curve of `family`."""
        if not self.known:
            nothing = np.full(values.shape[1:], np.nan)
            return nothing, nothing
        return percentiles(values, self._used()[0][1].level)

    def band_at(self, intensity: Any) -> tuple[Floats, Floats]:
        """Lower and upper end of the band of the probability, at each intensity by itself."""
        return self.ends(self.family(intensity))

    @property
    def sentence(self) -> str:
        """What became of runs that failed, and which temperatures have no curve of their own."""
        told = list(dict.fromkeys(part.sentence for _, part in self._used()))
        told += [f"{p.name}: {p.estimate.sentence}" for _, p in self._used() if p.estimate.sentence]
        return "; ".join(told)

    def rates(self, hazard: Hazard) -> pd.DataFrame:
        """Annual rate at each temperature, and how much of the whole it makes.

        Returns
        -------
        DataFrame : temperature, share of the time, rate with its band [1/year], `part` of the
            whole rate.
        """
        rows = []
        for (temperature, part), share in zip(self.parts.items(), self.shares, strict=True):
            alone = ClimateFragility({temperature: part}, np.ones(1))
            found = annual_rate(alone, hazard)
            row = {"temperature_degC": temperature, "share": share, "rate": found.rate}
            rows.append({**row, "rate_low": found.low, "rate_high": found.high})
        table = pd.DataFrame(rows)
        used = table["share"] > 0.0
        whole = (table["share"] * table["rate"])[used].sum(skipna=False)
        table["part"] = np.where(used, table["share"] * table["rate"] / whole, 0.0)
        return table


def shares_of_time(levels: Sequence[float], temperatures: Any) -> Floats:
    """How much of the time goes to each of some temperatures.

    An hour between two of them counts for both, by how close it is, so that what is linear in the
    temperature between them is met; one beyond the ends counts for the end.

    Parameters
    ----------
    levels : temperatures that have runs [degC].
    temperatures : of the site, such as one an hour [degC].

    Returns
    -------
    array : share of each level, in the order given; 1 together.

    Examples
    --------
    >>> shares_of_time([-20.0, 0.0, 20.0], [0.0, 10.0, 20.0, 25.0]).tolist()
    [0.0, 0.375, 0.625]
    """
    at = np.asarray(levels, dtype=float)
    values = np.asarray(temperatures, dtype=float).ravel()
    if len(at) == 0 or len(values) == 0 or not np.isfinite(values).all():
        raise InputError("needs temperatures: levels, and those of the site without gaps")
    order = np.argsort(at)
    known = at[order]
    if (np.diff(known) <= 0.0).any():
        raise InputError("a level of the temperature stands there twice")
    place = np.interp(values, known, np.arange(len(known), dtype=float))
    low = np.minimum(place.astype(int), max(len(known) - 2, 0))
    part = place - low
    shares = np.bincount(low, 1.0 - part, minlength=len(known))
    if len(known) > 1:
        shares += np.bincount(low + 1, part, minlength=len(known))
    found = np.empty(len(known))
    found[order] = shares / len(values)
    return found
