"""The records of a study: case, factors with levels or distributions, design."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import tomli_w
from pydantic import Field, PrivateAttr, field_validator

from thermobearing.bearing.bilinear import BilinearBearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.border.schema import Name, OneLine, Strict, in_unit
from thermobearing.border.toml import to_table
from thermobearing.border.units import parse_quantity
from thermobearing.climate.generator import generate_weather
from thermobearing.climate.hourly import Hourly
from thermobearing.climate.readers import read_weather
from thermobearing.core.records import Floats
from thermobearing.cyclic.case import Temperature
from thermobearing.earthquake.case import EarthquakeCase
from thermobearing.earthquake.motions import Motion
from thermobearing.motions.pair import MotionPair, pair_direction, rotation_measures
from thermobearing.motions.record import GroundMotion, parse_acceleration
from thermobearing.motions.spectrum import ANGLES, DAMPING, response_spectrum, rotated_spectrum
from thermobearing.motions.synthesis import LARGEST_SEED
from thermobearing.results.sums import product_in_order
from thermobearing.structure.model import Structure

Kind = Literal["normal", "lognormal", "uniform", "triangular"]
Number = float | str | None  # text where the factor has a unit
# Parameters of each distribution; `low` and `high` can also truncate the first two.
PARAMETERS: dict[str, tuple[tuple[str, ...], ...]] = {
    "normal": (("mean", "sd"), ("mean", "cov")),
    "lognormal": (("median", "cov"), ("median", "log_sd"), ("mean", "cov")),
    "uniform": (("low", "high"),),
    "triangular": (("low", "mode", "high"),),
}
TRUNCATED = ("normal", "lognormal")  # can be truncated
PURE = ("cov", "log_sd")  # dimensionless for every number
ACCELERATION = "m/s^2"
MM_PER_M = 1000.0
RARE = 1e-6  # probability of the extremes that are checked


@dataclass(frozen=True)
class Distribution:
    """A distribution of one number, truncated at `low` and `high`."""

    kind: Kind  # "normal", "lognormal", "uniform" or "triangular"
    centre: float  # mean, median, or mode
    spread: float  # standard deviation, of a lognormal one that of the logarithm; others 0
    low: float = -math.inf  # ends
    high: float = math.inf

    @cached_property
    def _whole(self) -> Any:
        from scipy import stats  # takes a second to read; processes that run need it not

        width = self.high - self.low
        match self.kind:
            case "normal":
                return stats.norm(self.centre, self.spread)
            case "lognormal":
                return stats.lognorm(self.spread, scale=self.centre)
            case "uniform":
                return stats.uniform(self.low, width)
        return stats.triang((self.centre - self.low) / width, self.low, width)

    @cached_property
    def _ends(self) -> tuple[float, float]:
        """Probabilities below `low` and `high` without truncation."""
        return float(self._whole.cdf(self.low)), float(self._whole.cdf(self.high))

    def at(self, probability: Floats) -> Floats:
        """Return the quantiles at probabilities in [0, 1]."""
        below, above = self._ends
        inside = below + np.asarray(probability, dtype=np.float64) * (above - below)
        return np.clip(np.asarray(self._whole.ppf(inside), np.float64), self.low, self.high)

    @property
    def reach(self) -> tuple[float, float]:
        """Smallest and largest value of a million runs."""
        smallest, largest = self.at(np.array([RARE, 1.0 - RARE]))
        return float(smallest), float(largest)


def parse_number(value: float | str, unit: str | None) -> float:
    """Return a number of a study file: text with a unit, or a plain one if `unit` is None."""
    if unit is None:
        if isinstance(value, str):
            raise InputError(f'"{value}": must be a plain number, without a unit')
        return float(value)
    if not isinstance(value, str):
        raise InputError(f'{value!r} has no unit; write "{value} {unit}" if that is meant')
    if unit != ACCELERATION:
        return parse_quantity(value, unit)
    return parse_acceleration(value) / MM_PER_M


class Drawn(Strict):
    """Keys of a number with a distribution; see `PARAMETERS`."""

    distribution: Kind | None = None
    mean: Number = None
    median: Number = None
    mode: Number = None
    sd: Number = None
    cov: Number = None
    log_sd: Number = None
    low: Number = None
    high: Number = None

    def _read(self, unit: str | None, key: str) -> Distribution:
        """Return the distribution of a number in `unit`; errors name `key`."""
        kind = self.distribution
        assert kind is not None
        parameters = {
            name: getattr(self, name) for name in Drawn.model_fields if name != "distribution"
        }
        parameters = {name: value for name, value in parameters.items() if value is not None}
        ends = {"low", "high"} if kind in TRUNCATED else set()
        if not any(set(required) == set(parameters) - ends for required in PARAMETERS[kind]):
            choices = " or ".join(" and ".join(required) for required in PARAMETERS[kind])
            option = ", optionally with low and high" if ends else ""
            names = ", ".join(parameters) or "nothing"
            raise InputError(f"{key}: a {kind} distribution takes {choices}{option}; got {names}")
        if unit == "degC" and (kind == "lognormal" or "cov" in parameters):
            raise InputError(
                f"{key}: a temperature must be normal with mean and sd, uniform or triangular"
            )
        numbers, faults = {}, []
        for name, value in parameters.items():
            parameter_unit = unit
            if name in PURE:
                parameter_unit = None
            elif name == "sd" and unit == "degC":
                parameter_unit = "K"  # a difference of temperatures
            try:
                numbers[name] = parse_number(value, parameter_unit)
            except InputError as error:
                faults += error.lines(f"{key}.{name}")
        if faults:
            raise InputError(faults)
        return _distribution(kind, numbers, key)


def _distribution(kind: Kind, numbers: dict[str, float], key: str) -> Distribution:
    low, high = numbers.get("low", -math.inf), numbers.get("high", math.inf)
    for name in ("sd", "cov", "log_sd"):
        if not numbers.get(name, 1.0) > 0.0:
            raise InputError(f"{key}.{name} = {numbers[name]:g}: must be greater than 0")
    if not low < high:
        raise InputError(f"{key}: low = {low:g} must be less than high = {high:g}")
    cov = numbers.get("cov", 0.0)
    if kind == "normal":
        centre = numbers["mean"]
        spread = numbers["sd"] if "sd" in numbers else abs(centre) * cov
        if spread == 0.0:
            raise InputError(f"{key}: with a mean of 0 give sd instead of cov")
    elif kind == "lognormal":
        # With cov, the variance of the logarithm is ln(1 + cov^2), and the median is that of the
        # mean over sqrt(1 + cov^2).
        spread = numbers["log_sd"] if "log_sd" in numbers else math.sqrt(math.log1p(cov * cov))
        centre = numbers["median"] if "median" in numbers else numbers["mean"]
        if not centre > 0.0:
            raise InputError(
                f"{key}: a lognormal distribution needs a median or mean greater than 0"
            )
        centre = centre if "median" in numbers else centre / math.sqrt(1.0 + cov * cov)
    else:
        mode = numbers.get("mode", low)
        if not low <= mode <= high:
            raise InputError(f"{key}: mode = {mode:g} must be between low and high")
        return Distribution(kind, mode, 0.0, low, high)
    distribution = Distribution(kind, centre, spread, low, high)
    if not distribution._ends[1] - distribution._ends[0] > RARE:
        raise InputError(f"{key}: the distribution has almost no probability between low and high")
    return distribution


MOST_LEVELS = 10_000
Weights = Annotated[tuple[Annotated[float, Field(gt=0, le=1e9)], ...], Field(min_length=1)]
Measure = Literal["PGA", "PGV", "Sa"]
INTENSITY_UNITS = {"PGA": "m/s^2", "PGV": "m/s", "Sa": "m/s^2"}


class Picked(Strict):
    """How levels are combined: in all combinations with other factors, or drawn at random.

    `random` draws one level for each sample, with probabilities proportional to `weights` (equal
    by default).
    """

    random: bool = False
    weights: Weights | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        faults = []
        if "weights" in values and values.get("random") is not True:
            faults.append("weights: only with random = true")
        levels, weights = values.get("levels"), values.get("weights")
        if isinstance(levels, list) and isinstance(weights, list) and len(levels) != len(weights):
            faults.append(f"weights: {len(weights)} weights for {len(levels)} levels")
        return faults


class Posterior(Strict):
    """Posterior samples of a calibration, of which each run draws one.

    `count` evenly spaced samples of the file `posterior`; `bearing`: the calibrated bearing, or one
    of another size from its compound.
    """

    kind: Literal["posterior"] = "posterior"
    name: Name
    posterior: Annotated[str, Field(min_length=1)]
    bearing: Bearing
    count: Annotated[int, Field(ge=1, le=MOST_LEVELS)] = 1000


class BearingFactor(Picked):
    """Bearings of the lines without their own bearing."""

    levels: Annotated[
        list[Annotated[Bearing | BilinearBearing | Posterior, Field(discriminator="kind")]],
        Field(min_length=1, max_length=MOST_LEVELS),
    ]


def stated_laws(bearing: Any) -> list[str]:
    """Return the laws of a user that a bearing names, each with the parameters that it states."""
    laws = [getattr(bearing, name, None) for name in ("temperature_law", "hysteresis_law")]
    return [
        " ".join(
            [law.law, *(f"{name} = {value}" for name, value in (law.parameters or {}).items())]
        )
        for law in laws
        if law is not None and law.law is not None
    ]


class StructureFactor(Picked):
    """Structures."""

    levels: Annotated[list[Structure], Field(min_length=1, max_length=MOST_LEVELS)]


@dataclass(frozen=True, eq=False)
class MatchedMotions:
    """Matched motions of a factor, compared by identity."""

    motions: tuple[GroundMotion, ...]


class MotionFactor(Picked):
    """Ground motions, or motions `matched` to a standard spectrum or that of a file.

    Matched motions keep the phases of records (`levels`), or have `count` sets of random phases,
    from `seed` (1) on, with the envelope of the spectrum `phases` ("jra-ii-i" with a file).
    `zone_factor` (1) multiplies the spectrum; `dt`: time step (0.01 s, or that of a record);
    `tolerance` (0.03): largest root mean square misfit from 0.1 to 3 s.
    """

    levels: Annotated[list[Motion], Field(min_length=1, max_length=MOST_LEVELS)] | None = None
    matched: Annotated[str, Field(min_length=1)] | None = None
    count: Annotated[int, Field(ge=1, le=MOST_LEVELS)] | None = None
    seed: Annotated[int, Field(ge=0, le=LARGEST_SEED - MOST_LEVELS)] | None = None
    phases: Annotated[str, Field(min_length=1)] | None = None
    zone_factor: Annotated[float, Field(ge=0.01, le=2)] | None = None
    dt: Annotated[float, in_unit("s"), Field(ge=0.001, le=0.02)] | None = None
    tolerance: Annotated[float, Field(gt=0, le=1)] | None = None
    _motions: MatchedMotions | None = PrivateAttr(default=None)

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        faults = super()._conflicts(values)
        count, weights = values.get("count"), values.get("weights")
        if isinstance(count, int) and isinstance(weights, list) and len(weights) != count:
            faults.append(f"weights: {len(weights)} weights for {count} motions")
        if "matched" not in values:
            matched_keys = ("count", "seed", "phases", "zone_factor", "dt", "tolerance")
            faults += [f"{key}: only with matched motions" for key in matched_keys if key in values]
            if "levels" not in values:
                faults.append('missing key "levels"; or matched = "jra-ii-i" with count')
        elif "levels" not in values and count is None:
            faults.append("matched: give count, or levels (records whose phases are kept)")
        elif "levels" in values:
            faults += [
                f"{key}: only with random phases, not with levels"
                for key in ("count", "seed", "phases")
                if key in values
            ]
        return faults

    @property
    def names(self) -> list[str]:
        """Names of the motions."""
        level_names = [str(level.label or level.name) for level in self.levels or ()]
        if self.matched is None:
            return level_names
        spectrum = Path(self.matched).stem
        if level_names:
            return [f"{name}-as-{spectrum.removeprefix('jra-')}" for name in level_names]
        first = 1 if self.seed is None else self.seed
        return [f"{spectrum}-{first + place}" for place in range(self.count or 0)]

    def matched_motions(self, new: Sequence[GroundMotion] = ()) -> tuple[GroundMotion, ...]:
        """Return the matched motions, none before they are computed; `new` ones are stored."""
        if new:
            self._motions = MatchedMotions(tuple(new))
        return self._motions.motions if self._motions else ()


YEARS = 50  # of generated weather, by default
Levels = Annotated[list[float | str], Field(min_length=1, max_length=MOST_LEVELS)]


class ScaleFactor(Drawn, Picked):
    """Scale factor of a motion, or with `of` = "intensity" the `measure` that it is scaled to.

    "Sa" is the spectral acceleration at `period` and `damping` (0.05).
    """

    levels: Levels | None = None
    of: Literal["factor", "intensity"] = "factor"
    measure: Measure = "PGA"
    period: Annotated[float, in_unit("s"), Field(ge=0.01, le=100)] | None = None
    damping: Annotated[float, Field(gt=0, lt=1)] | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        faults = super()._conflicts(values)
        if (values.get("measure") == "Sa") != ("period" in values):
            faults.append('period: required with measure = "Sa", and only with it')
        if "damping" in values and values.get("measure") != "Sa":
            faults.append('damping: only with measure = "Sa"')
        return faults

    @property
    def unit(self) -> str | None:
        """Unit of the numbers; None for a factor."""
        return INTENSITY_UNITS[self.measure] if self.of == "intensity" else None


class AmbientFactor(Drawn, Picked):
    """Ambient temperature [degC]: levels, a distribution, or hourly weather.

    Each run draws an hour of the file `weather`, or of `years` (50) that a `climate` generates with
    `seed` (0). The bearing follows the weather for `history` [h] before the earthquake; by default
    from the beginning.
    """

    levels: Annotated[list[Temperature], Field(min_length=1, max_length=MOST_LEVELS)] | None = None
    weather: Annotated[str, Field(min_length=1)] | None = None
    climate: Annotated[str, Field(min_length=1)] | None = None
    years: Annotated[int, Field(ge=1, le=1000)] | None = None
    seed: Annotated[int, Field(ge=0)] | None = None
    history: Annotated[float, in_unit("h"), Field(ge=1, le=1e5)] | None = None
    _series: Hourly | None = PrivateAttr(default=None)

    def read_weather(self) -> Hourly | None:
        """Return hourly weather, read or generated once; None with levels or a distribution."""
        if self._series is None and self.weather is not None:
            self._series = read_weather(self.weather)
        if self._series is None and self.climate is not None:
            self._series = generate_weather(self.climate, self.years or YEARS, self.seed or 0)
        return self._series

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        sources = [key for key in ("levels", "distribution", "weather", "climate") if key in values]
        faults = super()._conflicts(values)
        if len(sources) != 1:
            listed = f"; got {', '.join(sources)}" if sources else ""
            faults.append(f"give one of levels, distribution, weather and climate{listed}")
        generator_keys = [key for key in ("years", "seed") if key in values]
        if generator_keys and "climate" not in values:
            faults.append(f"{generator_keys[0]}: only with a climate")
        if "history" in values and not {"weather", "climate"} & set(values):
            faults.append("history: only with weather or a climate")
        return faults

    @property
    def hourly(self) -> bool:
        """Whether the ambient temperature is that of an hour of weather."""
        return self.weather is not None or self.climate is not None


class NumberFactor(Drawn, Picked):
    """Any number of the bearing, the structure or the case, by its dotted name.

    `of` = "factor" multiplies the number, "value" replaces it.
    """

    levels: Levels | None = None
    of: Literal["factor", "value"] = "factor"


COLUMNS = {"PGA": "PGA_m_s2", "PGV": "PGV_m_s", "Sa": "Sa_m_s2"}


def _directional(pair: MotionPair, scale: ScaleFactor) -> Floats:
    """Return a measure of an unscaled pair [angle] along one axis: mm/s2 or mm/s."""
    if scale.measure == "Sa":
        period = np.array([scale.period])
        spectrum = rotated_spectrum(pair, period, scale.damping or DAMPING)
        return np.asarray(spectrum.acceleration[:, 0])
    histories = np.array(
        [[record.acceleration, record.velocity] for record in (pair.first, pair.second)]
    )
    directions = np.array([pair_direction(float(angle)) for angle in ANGLES])
    # A sum in a fixed order, since ids of runs depend on the last bits.
    components = product_in_order(directions, histories[:, int(scale.measure == "PGV")])
    return np.asarray(np.abs(components).max(axis=1))


def intensity(motion: GroundMotion | MotionPair, scale: ScaleFactor) -> float:
    """Return PGA, Sa [m/s2] or PGV [m/s] of an unscaled motion; of a pair their RotD50."""
    if isinstance(motion, MotionPair):
        value = float(rotation_measures(_directional(motion, scale)).rotd50)
    elif scale.measure == "PGA":
        value = motion.pga
    elif scale.measure == "PGV":
        value = float(np.abs(motion.velocity).max())
    else:
        period = np.array([scale.period])
        value = float(response_spectrum(motion, period, scale.damping or DAMPING).acceleration[0])
    if not value > 0.0:
        raise InputError(f'motion "{motion.name}" is zero and has no {scale.measure}')
    return value / MM_PER_M


MOST_RUNS = 10_000_000
DesignKind = Literal["factorial", "latin-hypercube", "sobol", "monte-carlo"]
OF_FACTORS = ("structure", "bearings", "motions", "ambient")  # keys of a case that factors hold
Samples = Annotated[int, Field(ge=1, le=MOST_RUNS)]


class Design(Strict):
    """Design of the study.

    Attributes
    ----------
    kind : sampling of factors with a distribution; levels are crossed.
    samples : draws for each combination of levels.
    seed : of the draws.
    paired : every combination of levels has the same draws (default), or separate draws.
    arrangement : "plain" (default), or "saltelli" for Sobol' indices: two sets of draws A and B,
        and for each drawn factor A with that factor from B.
    lockstep : compute runs of one shape together (docs/theory.md), which differ from single runs by
        rounding. By default studies of 5000 runs or more do, unless all histories are kept or
        thermal properties vary.
    """

    kind: DesignKind = "factorial"
    samples: Samples | None = None
    seed: Annotated[int, Field(ge=0)] = 0
    paired: bool = True
    arrangement: Literal["plain", "saltelli"] = "plain"
    lockstep: bool | None = None

    @classmethod
    def _conflicts(cls, values: dict[str, Any]) -> list[str]:
        kind, samples = values.get("kind", "factorial"), values.get("samples")
        faults = []
        if isinstance(samples, float) and samples.is_integer():
            samples = int(samples)  # "1e3" is a whole number too, as the schema reads it later
        if kind != "factorial" and samples is None:
            faults.append(f'missing key "samples": required with kind = "{kind}"')
        if kind == "sobol" and isinstance(samples, int) and samples > 0 and samples.bit_count() > 1:
            below = 1 << (samples.bit_length() - 1)
            faults.append(
                f"samples = {samples}: must be a power of two for Sobol, {below} or {2 * below}"
            )
        if kind == "factorial" and values.get("arrangement") == "saltelli":
            faults.append(
                'arrangement = "saltelli": needs kind = "sobol", "latin-hypercube" or "monte-carlo"'
            )
        return faults


class Keep(Strict):
    """Histories that are kept: "none", "all" or "worst 10" (any number)."""

    histories: str = "none"

    @property
    def worst(self) -> int:
        """Number of the worst runs whose histories are kept."""
        kind, _, count = self.histories.partition(" ")
        return int(count) if kind == "worst" else 0

    @field_validator("histories")
    @classmethod
    def _which(cls, histories: str) -> str:
        if not re.fullmatch(r"none|all|worst [1-9][0-9]{0,5}", histories):
            raise ValueError(f'"{histories}": must be "none", "all", or "worst 10" (any number)')
        return histories


class Factors(Strict):
    """Factors of a study; `numbers` are those with a dotted name."""

    structure: StructureFactor
    bearing: BearingFactor
    motion: MotionFactor
    scale: ScaleFactor = ScaleFactor(levels=[1.0])
    ambient: AmbientFactor
    numbers: dict[str, NumberFactor] = Field(default_factory=dict)


class Study(Strict):
    """A study: the common case of all runs, the factors, and their design."""

    kind: Literal["study"] = "study"
    name: Annotated[str, Field(min_length=1, max_length=100, pattern=r"^[^/\\]*$"), OneLine]
    case: EarthquakeCase
    design: Design = Design()
    factors: Factors
    keep: Keep = Keep()

    def to_toml(self) -> str:
        """Return the study as TOML with names resolved and defaults filled in."""
        table = to_table(self)
        for key in OF_FACTORS:
            table["case"].pop(key, None)
        table["factors"] |= {
            name: to_table(factor) for name, factor in table["factors"].pop("numbers").items()
        }
        return tomli_w.dumps(table)
