"""What a calibration predicts: quantities and forces of a test with their 95 % bands."""

from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from thermobearing.core.records import Floats
from thermobearing.identify.properties import FIRST_CYCLE, LATER, LATER_CYCLES
from thermobearing.results.ranges import widened

LOW, HIGH = 0.025, 0.975
UNITS = {"force": "kN", "K_eq": "kN/mm", "h_eq": "", "Q_d": "kN", "energy": "kN mm"}
MAIN = "K_eq"  # whose interval sentences state, and what would narrow it
MEAN = "mean "  # begins the name of a quantity that is one of later cycles
UNITS |= {f"{MEAN}{name}": unit for name, unit in LATER.items()}
OUTSIDE = "outside the tests"  # among the causes of a band


@dataclass(frozen=True)
class Samples:
    """Points of the unit cube from the posterior, and how they were drawn."""

    cube: Floats  # [samples, parameters]
    source: str  # "laplace" or "emcee"
    held: Floats  # [samples, groups] change of each assumed group, in standard uncertainties
    acceptance: float = 1.0
    autocorrelation: float = 1.0  # steps of a walker until it forgets; nan if not known


@dataclass(frozen=True)
class Predicted:
    """A quantity of a predicted test with its 95 % band, and where the band comes from."""

    quantity: str  # "force", "K_eq", "h_eq", "Q_d", "energy", or "mean G_e", "mean h_eq", ...
    best: float  # [kN], [kN/mm], [1], [kN], [kN mm], [MPa]
    lower: float
    upper: float
    # Share of its variance by each cause: "tests" for their scatter, and the assumed groups.
    shares: dict[str, float] = field(default_factory=dict)
    held_share: float = 0.0  # of numbers of the bearing that the tests did not determine
    draws: Floats = field(default_factory=lambda: np.zeros(0), repr=False)  # that completed

    @property
    def half_width(self) -> float:
        """Half the width of the band, over the best estimate."""
        return 0.5 * (self.upper - self.lower) / self.best

    @property
    def _cycles(self) -> str:
        """Return the cycles of the test that the quantity is of."""
        if self.quantity.startswith(MEAN):
            return LATER_CYCLES
        return "all" if self.quantity == "force" else FIRST_CYCLE

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json about the quantity."""
        return {
            "quantity": self.quantity.removeprefix(MEAN),
            "cycles": self._cycles,
            "unit": UNITS[self.quantity],
            "best": self.best,
            "lower": self.lower,
            "upper": self.upper,
            "share_not_determined": self.held_share,
            "shares": self.shares,
        }


@dataclass(frozen=True)
class PredictedCycle:
    """A cycle of a predicted test, and its quantities."""

    cycle: int  # of the test, from 1
    number: int  # within its amplitude, from 1
    strain: float  # amplitude
    predicted: tuple[Predicted, ...]  # the peak force first

    def summary(self) -> list[dict[str, Any]]:
        """Return the rows of predicted.csv about the cycle."""
        place = {"cycle": self.cycle, "number": self.number, "strain": self.strain}
        return [
            place
            | {
                "quantity": item.quantity,
                "unit": UNITS[item.quantity],
                "best": item.best,
                "lower": item.lower,
                "upper": item.upper,
                "share_not_determined": item.held_share,
            }
            for item in self.predicted
        ]


@dataclass(frozen=True)
class Band:
    """95 % band of the force at the samples of a test, and of its measures.

    It contains the uncertainty of the free parameters and of all that are held, neither noise nor
    model error.
    """

    ambient: float  # [degC]
    displacement: Floats  # at the samples [mm]
    best: Floats  # force [kN]
    lower: Floats
    upper: Floats
    predicted: tuple[Predicted, ...]  # the peak force first
    lead: tuple[float, float] | None = None  # coldest and warmest lead [degC]
    beyond_tested: str = ""  # quantities outside the calibration range
    cycles: tuple[PredictedCycle, ...] = ()  # all but closing ones

    @property
    def main(self) -> Predicted:
        """K_eq, or the peak force of a record without a loop."""
        return next((p for p in self.predicted if p.quantity == MAIN), self.predicted[0])

    @property
    def peak(self) -> float:
        """Largest force with the calibrated parameters [kN]."""
        return self.predicted[0].best

    @property
    def peak_lower(self) -> float:
        """Lower end of the 95 % band of the largest force [kN]."""
        return self.predicted[0].lower

    @property
    def peak_upper(self) -> float:
        """Upper end of the 95 % band of the largest force [kN]."""
        return self.predicted[0].upper


class Narrowing(NamedTuple):
    """Knowledge that would narrow a band."""

    what: str
    half_width: float  # of the 95 % band with it, over the best estimate


@dataclass(frozen=True)
class Forecast:
    """Draws of the parameters, and their bands at some temperatures."""

    samples: Samples
    bands: tuple[Band, ...] = ()
    warnings: tuple[str, ...] = ()  # statements on extrapolation beyond the tests
    notes: tuple[str, ...] = ()  # where the bands come from
    columns: dict[str, Floats] = field(default_factory=dict)  # of posterior.csv, by symbol or key
    narrowing: tuple[Narrowing, ...] = ()  # of the coldest band

    def summary(self) -> dict[str, Any]:
        """Return the content of summary.json about the forecast."""
        return {
            "source": self.samples.source,
            "samples": len(self.samples.cube),
            "acceptance": self.samples.acceptance,
            "autocorrelation_steps": self.samples.autocorrelation,
            "warnings": list(self.warnings),
            "notes": list(self.notes),
            "narrowing": [item._asdict() for item in self.narrowing],
            "peak_force": [
                {
                    "ambient_degC": band.ambient,
                    "best_kN": band.peak,
                    "lower_kN": band.peak_lower,
                    "upper_kN": band.peak_upper,
                    "beyond_tested": band.beyond_tested,
                }
                for band in self.bands
            ],
            "predicted": [
                {
                    "ambient_degC": band.ambient,
                    **item.summary(),
                    "beyond_tested": band.beyond_tested,
                }
                for band in self.bands
                for item in band.predicted
            ],
            "predicted_cycles": self.cycles,
        }

    @property
    def cycles(self) -> list[dict[str, Any]]:
        """The rows of predicted.csv: the quantities of each cycle at each temperature."""
        return [
            {"ambient_degC": band.ambient, **row, "beyond_tested": band.beyond_tested}
            for band in self.bands
            for cycle in band.cycles
            for row in cycle.summary()
        ]


def widened_outside(band: Band, beyond: str, uncertainty: float) -> Band:
    """Return a band with the quantities outside the tests, and as wide as that makes it.

    `uncertainty` is the relative standard uncertainty of forces there.
    """
    # Within the range of the tests the band stays as it is.
    if not uncertainty:
        return replace(band, beyond_tested=beyond)
    lower, upper = widened(band.lower, band.upper, band.best, uncertainty, HIGH)
    return replace(
        band,
        lower=lower,
        upper=upper,
        predicted=tuple(_wider(item, uncertainty) for item in band.predicted),
        cycles=tuple(
            replace(cycle, predicted=tuple(_wider(item, uncertainty) for item in cycle.predicted))
            for cycle in band.cycles
        ),
        beyond_tested=beyond,
    )


def _wider(item: Predicted, uncertainty: float) -> Predicted:
    """Return a quantity with a relative standard uncertainty more, outside the tests."""
    low, high = map(float, widened(item.lower, item.upper, item.best, uncertainty, HIGH))
    grown = ((high - low) / max(item.upper - item.lower, 1e-300)) ** 2  # of the variance
    shares = {name: share / grown for name, share in item.shares.items()}
    shares[OUTSIDE] = 1.0 - 1.0 / grown
    held_share = item.held_share / grown + shares[OUTSIDE]
    return replace(item, lower=low, upper=high, shares=shares, held_share=held_share)
