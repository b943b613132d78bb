"""Hazard curve and fragility together: how often a year a capacity is passed.

The rate is the integral of the probability of going beyond over the rates of intensities,
lambda = int P(beyond | im) |dH(im)| (Cornell 1996; Cornell and others 2002), done numerically.
Between its points a hazard curve is a power law. For a hazard H = k0 im^-k and a lognormal
fragility it is

    lambda = H(median) exp(k^2 beta^2 / 2)

the closed form of Cornell, C.A. (1996), Calculating building seismic performance reliability: a
basis for multi-level design norms, 11th World Conference on Earthquake Engineering, paper 2122.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from thermobearing.border.errors import InputError
from thermobearing.studies.definition.factors import INTENSITY_UNITS
from thermobearing.studies.statistics.bootstrap import LEVEL, percentiles, widened
from thermobearing.tables.columns import plain_title, read_columns

Floats = NDArray[np.float64]
STEP = 0.02  # of the logarithm of intensity, at most, in the integral
MOST_STEPS = 10_000
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(4)  # of Gauss, in each step
TOO_LATE = 0.01  # probability of going beyond at the least intensity of a hazard curve
TOO_EARLY = 0.05  # of the rate, that intensities beyond the last one may add


class Curve(Protocol):
    """What a hazard curve is held beside: `Fragility`, or that of a climate."""

    def probability(self, intensity: Any) -> Floats:
        """Of going beyond, at intensities."""

    def family(self, intensity: Any, *, drawn: bool = False) -> Floats:
        """Return the same of all curves of the band, or of the bootstrap as it drew them."""

    @property
    def groups(self) -> int:
        """Number of motions that the bootstrap draws from; 0 where it is no matter."""

    def ends(self, values: Floats) -> tuple[Floats, Floats]:
        """Ends of the band of what was computed from them."""


@dataclass(frozen=True)
class Hazard:
    """How often a year an intensity is exceeded at a site.

    Attributes
    ----------
    intensity : increasing, > 0, in the unit of the measure.
    rate : of exceedance [1/year], decreasing, > 0.
    measure : of the intensity: "PGA" [m/s2], "PGV" [m/s], "Sa" [m/s2], or your own word.

    Examples
    --------
    >>> site = Hazard([1.0, 2.0, 4.0], [1e-2, 2.5e-3, 6.25e-4], "PGA")
    >>> float(site.at(3.0)[0]).__round__(6)
    0.001111
    """

    intensity: Floats
    rate: Floats
    measure: str = ""

    def __post_init__(self) -> None:
        for name in ("intensity", "rate"):
            try:
                values = np.asarray(getattr(self, name), dtype=float)
            except (TypeError, ValueError):
                raise InputError(f"{name} of a hazard curve: expected a list of numbers") from None
            object.__setattr__(self, name, values)
        im, rate = self.intensity, self.rate
        if im.ndim != 1 or im.shape != rate.shape or len(im) < 2:
            raise InputError("a hazard curve needs two equally long lists of 2 numbers or more")
        for name, values, way in (("intensity", im, 1.0), ("rate", rate, -1.0)):
            if not (np.isfinite(values) & (values > 0.0)).all():
                raise InputError(f"{name} of a hazard curve: above 0 only")
            steps = way * np.diff(values)
            if not (steps > 0.0).all():
                k = int(np.argmin(steps > 0.0))
                word = "increase" if way > 0 else "decrease"
                raise InputError(
                    f"{name} of a hazard curve does not {word} from {values[k]:g} to "
                    f"{values[k + 1]:g}"
                )

    def at(self, intensity: Any) -> Floats:
        """Rate of exceedance of intensities [1/year]; NaN beyond the ends of the curve."""
        x = np.log(np.atleast_1d(np.asarray(intensity, dtype=float)))
        known = np.log(self.intensity)
        found = np.interp(x, known, np.log(self.rate), left=np.nan, right=np.nan)
        return np.asarray(np.exp(found))

    def points(self) -> tuple[Floats, Floats]:
        """Intensities that an integral is taken on, and how often a year each of them stands for.

        Those of Gauss in short steps, none of which holds a kink of the curve.
        """
        x = np.log(self.intensity)
        steps = min(int(np.ceil((x[-1] - x[0]) / STEP)), MOST_STEPS)
        ends = np.unique(np.concatenate([x, np.linspace(x[0], x[-1], steps + 1)]))
        middle, half = 0.5 * (ends[1:] + ends[:-1]), 0.5 * np.diff(ends)
        at = middle[:, None] + half[:, None] * POINTS
        fall = -np.diff(np.log(self.rate)) / np.diff(x)
        piece = np.clip(np.searchsorted(x, middle, side="right") - 1, 0, len(fall) - 1)
        intensity = np.exp(at)
        weight = (
            (half * fall[piece])[:, None] * WEIGHTS * self.at(intensity.ravel()).reshape(at.shape)
        )
        return np.asarray(intensity.ravel()), np.asarray(weight.ravel())


def load_hazard(path: str | Path, measure: str = "PGA", unit: str | None = None) -> Hazard:
    r"""A hazard curve from a file with columns of intensity and rate.

    Parameters
    ----------
    path : text with any separator, or `.xlsx`. One column is called as the measure, with its unit,
        the other `rate [1/year]` or `return_period [year]`.
    measure : "PGA", "PGV", "Sa", or the name of your own column.
    unit : of your own column.

    Returns
    -------
    Hazard

    Raises
    ------
    InputError : unreadable, a column or unit is missing, or rates do not fall.

    Examples
    --------
    >>> import tempfile
    >>> file = Path(tempfile.mkdtemp()) / "site.csv"
    >>> _ = file.write_text("PGA [cm/s^2],return_period [year]\n100,50\n400,1000\n")
    >>> load_hazard(file).intensity.tolist(), load_hazard(file).rate.tolist()
    ([1.0, 4.0], [0.02, 0.001])
    """
    unit = unit or INTENSITY_UNITS.get(measure)
    if unit is None:
        known = ", ".join(INTENSITY_UNITS)
        raise InputError(f'the unit of "{measure}" is missing; known without: {known}')
    name, period = plain_title(measure), "return period"
    wanted = {name: unit, "rate": "1/year", period: "year"}
    found = read_columns(path, wanted, optional=("rate", period))
    if ("rate" in found) == (period in found):
        raise InputError("needs a column rate [1/year], or return_period [year]", str(path))
    try:
        if "rate" not in found:
            if not (found[period] > 0.0).all():
                raise InputError(f"{period}: above 0 only")
            found["rate"] = 1.0 / found[period]
        return Hazard(found[name], found["rate"], measure)
    except InputError as error:
        raise InputError(error.problems, str(path)) from None


@dataclass(frozen=True)
class Rate:
    """How often a year a capacity is passed.

    Attributes
    ----------
    rate : [1/year]; NaN where there is no fragility curve.
    low, high : ends of its band; where no motion went beyond the rate is 0, and below `high`.
    family : of each bootstrap sample.
    notes : sentences on what the ends of the hazard curve leave out.
    groups : that the bootstrap draws from; 0 where it is no matter.
    """

    rate: float
    low: float
    high: float
    family: Floats
    notes: tuple[str, ...] = ()
    groups: int = 0

    @property
    def return_period(self) -> float:
        """Mean time between two such earthquakes [year]."""
        return 1.0 / self.rate if self.rate > 0.0 else float("inf")

    def probability(self, years: float) -> float:
        """Of at least one such earthquake in so many years (a Poisson process)."""
        return float(-np.expm1(-self.rate * years))


def annual_rate(curve: Curve, hazard: Hazard) -> Rate:
    """Rate at which a capacity is passed: fragility and hazard integrated.

    Earthquakes beyond the last intensity of the hazard curve count with the probability there,
    those below the first not at all; notes tell where that may matter.

    Parameters
    ----------
    curve : `Fragility`, or that of a climate, in the intensity of the hazard curve.
    hazard : of the site.

    Returns
    -------
    Rate

    Examples
    --------
    >>> import pandas as pd
    >>> from thermobearing.studies.statistics.fragility import fragility_curve
    >>> runs = pd.DataFrame({"PGA": [1.0] * 4 + [2.0] * 4, "drift": [1, 1, 1, 3, 1, 3, 3, 3]})
    >>> curve = fragility_curve(runs, "drift", 2.0, "PGA")
    >>> site = Hazard([0.01, 100.0], [100.0, 1e-6], "PGA")
    >>> round(annual_rate(curve, site).rate, 5)
    0.00848
    """
    at, weights = hazard.points()
    start, stop, last = hazard.intensity[:1], hazard.intensity[-1:], float(hazard.rate[-1])

    def whole(probability: Callable[[Any], Floats]) -> Floats:
        inner: Floats = probability(at) @ weights
        return np.asarray(inner + last * probability(stop)[..., 0])

    rate = float(whole(curve.probability))
    low, high = curve.ends(whole(curve.family)[:, None])
    family = whole(partial(curve.family, drawn=True))
    unit = INTENSITY_UNITS.get(hazard.measure, "").replace("^2", "\N{SUPERSCRIPT TWO}")
    begins, ends = (f"{float(im):.4g} {unit}".strip() for im in hazard.intensity[[0, -1]])
    notes = []
    first, end = float(curve.probability(start)[0]), float(curve.probability(stop)[0])
    if first > TOO_LATE:
        notes.append(
            f"the hazard curve begins at {begins}, where more than "
            f"{100.0 * TOO_LATE:g} % go beyond: smaller earthquakes are not counted"
        )
    if last * (1.0 - end) > TOO_EARLY * rate:
        notes.append(
            f"the hazard curve ends at {ends}: larger earthquakes may add more "
            f"than {100.0 * TOO_EARLY:g} % to the rate"
        )
    least = float(low[0]) if rate != 0.0 else 0.0
    return Rate(rate, least, float(high[0]), family, tuple(notes), curve.groups)


def ratio(rate: Rate, to: Rate, level: float = LEVEL) -> tuple[float, float, float]:
    """One rate over another with its band, of curves whose bootstrap drew the same motions.

    Parameters
    ----------
    rate, to : of `annual_rate`.
    level : confidence of the band.

    Returns
    -------
    three numbers : ratio, lower and upper end; NaN where either has no rate.
    """
    if len(rate.family) != len(to.family):
        raise InputError("the bands of two rates must be of the same bootstrap samples")
    if np.isnan(rate.rate + to.rate) or rate.rate == to.rate == 0.0:
        return np.nan, np.nan, np.nan
    whole = np.append(rate.family, rate.rate), np.append(to.family, to.rate)
    with np.errstate(divide="ignore", invalid="ignore"):
        each = whole[0] / whole[1]
    told = each[:-1][~np.isnan(each[:-1])]  # samples in which neither goes beyond tell nothing
    if len(told) == 0:
        return float(each[-1]), np.nan, np.nan
    low, high = percentiles(told[:, None], widened(level, rate.groups))
    return float(each[-1]), float(low[0]), float(high[0])


def closed_form(median: float, dispersion: float, factor: float, exponent: float) -> float:
    """Cornell's closed form of the rate, for a hazard of factor * im ** -exponent [1/year].

    Parameters
    ----------
    median, dispersion : of a lognormal fragility.
    factor : rate at an intensity of one.
    exponent : slope of the hazard curve in logarithms, > 0.

    Examples
    --------
    >>> round(closed_form(2.0, 0.4, 1e-2, 2.0), 6)
    0.003443
    """
    return float(factor * median**-exponent * np.exp(0.5 * (exponent * dispersion) ** 2))
