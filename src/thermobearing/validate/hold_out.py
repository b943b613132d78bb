"""Calibrations validated against tests that were not used.

    tests -> some are held out -> fit to the others -> the fitted bearing beside those held out

Either the user says which tests are held out, or every test is once: `folds` groups of them, one
fit without each group, and a last one to all of them. Tests are judged as `validate` does.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, shortened
from thermobearing.border.units import is_number
from thermobearing.identify.case import IdentifyCase, Test, make_identify_case
from thermobearing.identify.records.checks import check_test
from thermobearing.identify.records.record import TestRecord, load_test
from thermobearing.identify.result import Identification
from thermobearing.identify.run import run_identify
from thermobearing.validate.case import LIMITS, ValidateCase, checked_limits
from thermobearing.validate.result import CrossValidation, Validation
from thermobearing.validate.run import as_fitted, judge, refuse_unusable

Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class HoldOutCase:
    """The fit to all tests but those held out; either `folds` (their number) or those.

    `limits` are largest relative errors by quantity.
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
    """Return a checked case of a fit with tests held out; arguments as of `cross_validate`."""
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
    """Run a case: a test that cannot be used is refused before anything is fitted.

    `progress` is called with (fits done, all); an error names the fold of its fit.
    """
    tests, base = case.fit.records, case.fit.bearing
    refused = [line for record in tests for line in check_test(record, base).refusals]
    if refused:
        raise InputError(refused)
    refuse_unusable(case.held_out, base)
    groups = _groups(tests, case.folds) or [case.held_out]
    fits: list[Identification] = []
    for number, group in enumerate([[], *groups] if case.folds else [[]]):
        if progress:
            progress(number, case.folds + 1)
        seen = [record for record in tests if not any(record is other for other in group)]
        try:
            fits.append(run_identify(replace(case.fit, records=seen)))
        except InputError as error:
            if not number:
                raise
            raise InputError(error.lines(f"fold {number}")) from None
    if progress:
        progress(case.folds + 1, case.folds + 1)
    final, *folds = fits
    alike = {id(record): as_fitted(record) for record in [*tests, *case.held_out]}
    groups = [[alike[id(record)] for record in group] for group in groups]
    judged = [_judged(found, group) for found, group in zip(folds or [final], groups, strict=True)]
    warnings = [
        f"held out{f' of fold {number}' if folds else ''}: {text}"
        for number, found in enumerate(judged, start=1)
        for text in found.warnings
    ]
    items = [item for found in judged for item in found.comparisons]
    return CrossValidation(
        final=final,
        folds=folds,
        groups=groups,
        fitted=replace(_judged(final, [alike[id(r)] for r in tests]), limits=case.limits),
        held_out=Validation(items, case.limits, warnings),
    )


def _groups(tests: list[TestRecord], folds: int) -> list[list[TestRecord]]:
    """Return tests dealt out by temperature, so that none of the groups has all cold ones."""
    order = sorted(range(len(tests)), key=lambda i: tests[i].ambient)
    return [[tests[i] for i in sorted(order[k::folds])] for k in range(folds)]


def _judged(found: Identification, records: list[TestRecord]) -> Validation:
    return judge(ValidateCase([found.bearing], records))
