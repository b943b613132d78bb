"""Calibrations validated against tests that were not used.

    tests -> some are held out -> fit to the others -> the fitted bearing beside those held out

Either the user says which tests are held out, or every test is once: `folds` groups of them, one
fit without each group, and a last one to all of them. Tests are judged as `validate` does.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from thermobearing.bearing.model import Bearing
from thermobearing.border.deprecated import renamed
from thermobearing.border.errors import InputError, shortened
from thermobearing.border.units import is_number
from thermobearing.identify.case import IdentifyCase, Test, make_identify_case
from thermobearing.identify.records.checks import check_test
from thermobearing.identify.records.record import TestRecord, load_test
from thermobearing.identify.result import Identification
from thermobearing.identify.run import run_identify
from thermobearing.validate.case import LIMITS, ValidateCase, checked_limits
from thermobearing.validate.result import Validation
from thermobearing.validate.run import as_fitted, judge, refuse_unusable

if TYPE_CHECKING:
    from thermobearing.identify.uncertainty.posterior import Forecast
    from thermobearing.validate.figures import CrossValidationFigures

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
    >>> tests = [tb.synthetic_record("shen-hdr-specimen", t, test) for t in (23, -9)]
    >>> fit = {"free": ["K_r"], "starts": 1}
    >>> found = tb.cross_validate(tests, "shen-hdr-specimen", folds=2, **fit)
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

    def find_fold(self, record: TestRecord) -> int:
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
                part.insert(0, "fold", [self.find_fold(item.record) for item in found.comparisons])
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
        from thermobearing.validate.figures import CrossValidationFigures

        return CrossValidationFigures(self)

    @renamed(force="overwrite")
    def save(
        self,
        directory: str | Path,
        *,
        overwrite: bool = False,
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
        from thermobearing.validate.output import save_cross_validation

        return save_cross_validation(
            self, Path(directory), overwrite=overwrite, figures=figures, forecast=forecast
        )


Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class HoldOutCase:
    """Everything that a fit with tests held out needs; see `make_hold_out_case`.

    Attributes
    ----------
    fit : of the tests that the last fit is to, with its options.
    held_out : tests that no fit sees; empty with folds.
    folds : groups of the tests, each of which one fit does not see; 0 with tests held out.
    limits : largest relative error by quantity.
    """

    fit: IdentifyCase
    held_out: list[TestRecord]
    folds: int = 0
    limits: dict[str, float] = field(default_factory=lambda: dict(LIMITS))


def cross_validate(
    records: Sequence[Test] | Test,
    bearing: Bearing | str | Path,
    *,
    hold_out: Sequence[Test] | Test = (),
    folds: int | None = None,
    limits: Mapping[str, float] | None = None,
    progress: Progress | None = None,
    **fit: Any,
) -> CrossValidation:
    """Fit a bearing to some tests and judge it by the others.

    Parameters
    ----------
    records : tests of one bearing (`load_test`, `record_from_arrays`, or paths).
    bearing : geometry and materials, and the values of what is not free.
    hold_out : tests that are not fitted, of any history; one that is among `records` too is taken
        from them.
    folds : instead: every test is held out once, in so many groups, from 2 to the number of tests.
        Tests near each other in temperature go to different groups, so that every fit has
        warm and cold ones.
    limits : largest relative error by quantity, as of `validate`.
    progress : called with (fits done, all).
    fit : the other arguments of `identify_bearing`.

    Returns
    -------
    CrossValidation

    Raises
    ------
    InputError : nothing is held out, or everything; a test that cannot be used; what
        `identify_bearing` and `validate` refuse.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
    >>> warm, cold = (tb.synthetic_record("shen-hdr-specimen", t, test) for t in (23, -9))
    >>> found = cross_validate(warm, "shen-hdr-specimen", hold_out=cold, free=["K_r"], starts=1)
    >>> found.verdict
    'within'
    """
    case = make_hold_out_case(
        records, bearing, hold_out=hold_out, folds=folds, limits=limits, **fit
    )
    return run_hold_out(case, progress=progress)


def make_hold_out_case(
    records: Sequence[Test] | Test,
    bearing: Bearing | str | Path,
    *,
    hold_out: Sequence[Test] | Test = (),
    folds: int | None = None,
    limits: Mapping[str, float] | None = None,
    **fit: Any,
) -> HoldOutCase:
    """A checked case of a fit with tests held out.

    Parameters
    ----------
    records, bearing, hold_out, folds, limits, fit : as of `cross_validate`.

    Returns
    -------
    HoldOutCase

    Raises
    ------
    InputError : nothing is held out, or everything; folds out of range; what
        `make_identify_case` refuses.

    Examples
    --------
    >>> import numpy as np
    >>> from thermobearing.identify.records.record import record_from_arrays
    >>> t = np.linspace(0.0, 10.0, 200)
    >>> tests = [record_from_arrays(t, np.sin(t), 2.0 * np.sin(t), at) for at in (23.0, 0.0)]
    >>> case = make_hold_out_case(tests, "shen-hdr-specimen", hold_out=tests[1])
    >>> len(case.fit.records), len(case.held_out)
    (1, 1)
    """
    kept, out = _records(records), _records(hold_out)
    if bool(out) == (folds is not None):
        raise InputError("give either tests to hold out or a number of folds")
    kept = [record for record in kept if not any(_same(record, other) for other in out)]
    if not kept:
        raise InputError("every test is held out: none is left to fit")
    if folds is not None:
        _check_folds(folds, len(kept))
    once = [record for i, record in enumerate(out) if not any(_same(record, o) for o in out[:i])]
    return HoldOutCase(
        fit=make_identify_case(kept, bearing, **fit),
        held_out=once,
        folds=folds or 0,
        limits=dict(LIMITS) | checked_limits(limits or {}),
    )


def _records(given: Sequence[Test] | Test) -> list[TestRecord]:
    several = [given] if isinstance(given, TestRecord | str | Path) else list(given)
    return [item if isinstance(item, TestRecord) else load_test(item) for item in several]


def _same(one: TestRecord, other: TestRecord) -> bool:
    """Whether two records are one test: the same object, or of the same file."""
    if one is other:
        return True
    return bool(one.file and other.file) and Path(one.file).resolve() == Path(other.file).resolve()


def _check_folds(folds: int, tests: int) -> None:
    if tests < 2:
        raise InputError("folds: one test alone cannot be held out of itself; give more tests")
    if not isinstance(folds, int) or isinstance(folds, bool) or not 2 <= folds <= tests:
        said = shortened(str(folds)) if is_number(folds) else "that"
        raise InputError(
            f"folds = {said}: must be a whole number from 2 to the number of tests, {tests}"
        )


def run_hold_out(case: HoldOutCase, *, progress: Progress | None = None) -> CrossValidation:
    """Carry out a complete case.

    Parameters
    ----------
    case : from `make_hold_out_case`.
    progress : called with (fits done, all).

    Returns
    -------
    CrossValidation

    Raises
    ------
    InputError : a test that cannot be used, before anything is fitted; a fit that does not get
        through, with the number of its fold.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
    >>> tests = [tb.synthetic_record("shen-hdr-specimen", t, test) for t in (23, -9)]
    >>> case = make_hold_out_case(tests, "shen-hdr-specimen", folds=2, free=["K_r"], starts=1)
    >>> found = run_hold_out(case)
    >>> len(found.folds), found.verdict
    (2, 'within')
    """
    tests, base = case.fit.records, case.fit.bearing
    refused = [line for record in tests for line in check_test(record, base).refusals]
    if refused:
        raise InputError(refused)
    refuse_unusable(case.held_out, base)
    groups = _groups(tests, case.folds) or [case.held_out]
    told = progress or (lambda done, of: None)
    many = case.folds + 1
    told(0, many)
    final, folds = run_identify(case.fit), []
    told(1, many)
    for number, group in enumerate(groups if case.folds else [], start=1):
        seen = [record for record in tests if not any(record is other for other in group)]
        try:
            folds.append(run_identify(replace(case.fit, records=seen)))
        except InputError as error:
            raise InputError(error.lines(f"fold {number}")) from None
        told(number + 1, many)
    alike = {id(record): as_fitted(record) for record in [*tests, *case.held_out]}
    groups = [[alike[id(record)] for record in group] for group in groups]
    judged = [_judged(found, group) for found, group in zip(folds or [final], groups, strict=True)]
    return CrossValidation(
        final=final,
        folds=folds,
        groups=groups,
        fitted=replace(_judged(final, [alike[id(r)] for r in tests]), limits=case.limits),
        held_out=Validation(
            [item for found in judged for item in found.comparisons],
            case.limits,
            _warnings(judged, folds=bool(folds)),
        ),
    )


def _groups(tests: list[TestRecord], folds: int) -> list[list[TestRecord]]:
    """Tests dealt out by their temperature, like cards: none of the groups has the cold ones."""
    order = sorted(range(len(tests)), key=lambda i: tests[i].ambient)
    return [[tests[i] for i in sorted(order[k::folds])] for k in range(folds)]


def _judged(found: Identification, records: list[TestRecord]) -> Validation:
    return judge(ValidateCase([found.bearing], records))


def _warnings(judged: list[Validation], *, folds: bool) -> list[str]:
    """What tests that were held out ask beyond those of their fit."""
    return [
        f"held out{f' of fold {number}' if folds else ''}: {text}"
        for number, found in enumerate(judged, start=1)
        for text in found.warnings
    ]
