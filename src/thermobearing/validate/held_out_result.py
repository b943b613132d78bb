"""What a fit is worth on tests it has not seen: the fits, and both kinds of tests judged alike."""

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from thermobearing.identify.record import TestRecord
from thermobearing.identify.result import Identification
from thermobearing.validate.result import Validation

if TYPE_CHECKING:
    from thermobearing.identify.posterior import Forecast
    from thermobearing.validate.held_out_figures import CrossValidationFigures

FITTED, HELD_OUT = "fitted", "held out"
OF_A_FOLD = "The fit of a fold stopped before it converged. Give more --starts."


@dataclass(frozen=True)
class CrossValidation:
    """Fits, and tests that each of them has and has not seen.

    Attributes
    ----------
    final : the fit to every test that is not held out; with folds to all of them.
    folds : one fit without each group of tests; none where the user said what is held out.
    groups : tests held out, by fold; the one group of the user's without folds.
    fitted : the final fit beside its own tests.
    held_out : every test held out, beside the fit that has not seen it.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
    >>> tests = [tb.identify.synthetic_record("shen-hdr-specimen", t, test) for t in (23, -9)]
    >>> fit = {"free": ["K_r"], "starts": 1}
    >>> found = tb.validate.cross_validate(tests, "shen-hdr-specimen", folds=2, **fit)
    >>> found.table["role"].tolist()
    ['fitted', 'fitted', 'held out', 'held out']
    """

    final: Identification
    folds: list[Identification]
    groups: list[list[TestRecord]]
    fitted: Validation
    held_out: Validation

    @property
    def outcome(self) -> str:
        """Of the fits, and whether each got through the tests that it had not seen."""
        fits = [self.final, *self.folds]
        stopped = [found.outcome for found in fits if found.outcome != "completed"]
        return stopped[0] if stopped else self.held_out.outcome

    @property
    def sentence(self) -> str:
        """What the outcome means and what to try; empty when it completed."""
        if self.outcome == self.held_out.outcome:
            return self.held_out.sentence
        return self.final.sentence or OF_A_FOLD

    @property
    def verdict(self) -> str:
        """On the tests held out: "beyond" if one of them passes a limit, else "within"."""
        return self.held_out.verdict

    @cached_property
    def judged(self) -> Validation:
        """Tests of both kinds in one, for figures: the bearing's name says which."""
        both = ((FITTED, self.fitted), (HELD_OUT, self.held_out))
        items = [
            replace(item, bearing=f"{item.bearing}, {role}")
            for role, found in both
            for item in found.comparisons
        ]
        return Validation(items, self.held_out.limits)

    def fold_of(self, record: TestRecord) -> int:
        """The fold that a test is held out of, from 1; 0 if none."""
        if not self.folds:
            return 0
        inside = [any(record is other for other in group) for group in self.groups]
        return inside.index(True) + 1

    @cached_property
    def table(self) -> pd.DataFrame:
        """One row for each test in each role: R2, largest errors and verdicts, largest loop."""
        parts = []
        for role, found in ((FITTED, self.fitted), (HELD_OUT, self.held_out)):
            part = found.table.copy()
            if role == HELD_OUT:
                part.insert(0, "fold", [self.fold_of(item.record) for item in found.comparisons])
            else:
                part.insert(0, "fold", 0)
            part.insert(0, "role", role)
            parts.append(part)
        return pd.concat(parts, ignore_index=True)

    @cached_property
    def parameters(self) -> pd.DataFrame:
        """One row for the final fit (fold 0) and one for each fold: values of what any has free."""
        fits = [self.final, *self.folds]
        keys = list(dict.fromkeys(key for fit in fits for key in fit.uncertainty.estimates))
        names = {p.kind.key: p.kind for fit in fits for p in fit.pset.parameters}
        rows: list[dict[str, Any]] = []
        for fold, fit in enumerate(fits):
            row: dict[str, Any] = {"fold": fold, "tests": len(fit.records), "outcome": fit.outcome}
            for key in keys:
                item = fit.uncertainty.estimates.get(key)
                row[names[key].symbol] = fit.values.get(key, float("nan"))
                row[f"{names[key].symbol}_stderr"] = float("nan") if item is None else item.stderr
            rows.append(row)
        return pd.DataFrame(rows)

    @property
    def free(self) -> dict[str, str]:
        """Units of what any fit has free, by symbol."""
        found: dict[str, str] = {}
        for fit in (self.final, *self.folds):
            kinds = [item.parameter.kind for item in fit.uncertainty.estimates.values()]
            found |= {kind.symbol: kind.unit for kind in kinds}
        return found

    @cached_property
    def spread(self) -> dict[str, float]:
        """Standard error of each parameter by the jackknife over folds, by symbol.

        sqrt((K - 1) / K sum (theta_k - mean)^2), theta_k without group k: what the scatter from
        test to test does to the numbers, which no residual of one fit tells. Empty without folds.
        """
        rows = self.parameters.iloc[1:]
        if not len(rows):
            return {}
        part = (len(rows) - 1.0) / len(rows)
        return {
            symbol: float(np.sqrt(part * ((rows[symbol] - rows[symbol].mean()) ** 2).sum()))
            for symbol in self.free
        }

    def summary(self) -> dict[str, Any]:
        """The content of summary.json: that of the final fit, and `held_out`.

        Returns
        -------
        dict : verdict, limits, tests of both kinds, and the parameters of each fold.
        """
        told = {
            "verdict": self.verdict,
            "outcome": self.outcome,
            "limits": self.held_out.limits,
            "tests": self.table.to_dict("records"),
            "folds": self.parameters.to_dict("records") if self.folds else [],
            "jackknife_stderr": self.spread,
        }
        final = self.final.summary()
        said = [*final["warnings"], *self.held_out.warnings]
        return final | {"outcome": self.outcome, "warnings": said, "held_out": told}

    @property
    def plot(self) -> "CrossValidationFigures":
        """Figures: those of the final fit are `found.final.plot`, tests `found.judged.plot`."""
        from thermobearing.validate.held_out_figures import CrossValidationFigures

        return CrossValidationFigures(self)

    def save(
        self,
        directory: str | Path,
        *,
        force: bool = False,
        figures: bool = True,
        forecast: "Forecast | None" = None,
    ) -> Path:
        """Write a result directory; see `save_cross_validation`.

        Parameters
        ----------
        directory, force, figures, forecast : as in `save_cross_validation`.

        Returns
        -------
        Path : the directory.

        Raises
        ------
        OutputError : the directory exists and `force` is False, or it cannot be written.
        """
        from thermobearing.validate.files import save_cross_validation

        return save_cross_validation(
            self, Path(directory), force=force, figures=figures, forecast=forecast
        )
