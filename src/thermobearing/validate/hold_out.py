"""Calibrations validated against tests that were not used.

    tests -> some are held out -> fit to the others -> the fitted bearing beside those held out

Either the user says which tests are held out, or every test is once: `folds` groups of them, one
fit without each group, and a last one to all of them. Tests are judged as `validate` does.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError, shortened
from thermobearing.border.units import is_number
from thermobearing.identify.case import IdentifyCase, Test, make_identify_case
from thermobearing.identify.records.checks import check_test
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.result import Identification
from thermobearing.identify.run import run_identify
from thermobearing.validate.result import CrossValidation, Validation
from thermobearing.validate.run import (
    as_fitted,
    check_limits,
    judge,
    load_tests,
    refuse_unusable,
)

Progress = Callable[[int, int], None]


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
    tests, out = split_tests(records, hold_out)
    if bool(out) == (folds is not None):
        raise InputError("give either tests to hold out or a number of folds")
    if not tests:
        raise InputError("every test is held out: none is left to fit")
    if folds is not None:
        _check_folds(folds, len(tests))
    case = make_identify_case(tests, bearing, **fit)
    largest = check_limits(limits)
    tests = case.records
    if refused := [line for one in tests for line in check_test(one, case.bearing).refusals]:
        raise InputError(refused)
    refuse_unusable(out, case.bearing)
    groups = _groups(tests, folds) if folds else [out]
    final, *fits = _fit(case, groups if folds else [], progress)
    alike = {id(record): as_fitted(record) for record in [*tests, *out]}
    groups = [[alike[id(record)] for record in group] for group in groups]
    judged = [
        judge([one.bearing], group) for one, group in zip(fits or [final], groups, strict=True)
    ]
    warnings = [
        f"held out{f' of fold {number}' if folds else ''}: {text}"
        for number, found in enumerate(judged, start=1)
        for text in found.warnings
    ]
    items = [item for found in judged for item in found.comparisons]
    return CrossValidation(
        final=final,
        folds=fits,
        groups=groups,
        fitted=judge([final.bearing], [alike[id(r)] for r in tests], limits=largest),
        held_out=Validation(items, largest, warnings),
    )


def split_tests(
    records: Sequence[Test] | Test, hold_out: Sequence[Test] | Test
) -> tuple[list[TestRecord], list[TestRecord]]:
    """Return the tests to fit and those held out, each once."""
    kept, out = load_tests(records), load_tests(hold_out)
    once = [one for i, one in enumerate(out) if not any(_same(one, other) for other in out[:i])]
    return [one for one in kept if not any(_same(one, other) for other in out)], once


def _same(one: TestRecord, other: TestRecord) -> bool:
    """Return whether two records are one test: the same object, or of the same file."""
    files = [Path(record.file).resolve() for record in (one, other) if record.file]
    return one is other or (len(files) == 2 and files[0] == files[1])


def _check_folds(folds: int, tests: int) -> None:
    if tests < 2:
        raise InputError("folds: one test alone cannot be held out of itself; give more tests")
    if not isinstance(folds, int) or isinstance(folds, bool) or not 2 <= folds <= tests:
        said = shortened(str(folds)) if is_number(folds) else "that"
        raise InputError(
            f"folds = {said}: must be a whole number from 2 to the number of tests, {tests}"
        )


def _groups(tests: list[TestRecord], folds: int) -> list[list[TestRecord]]:
    """Return tests dealt out by temperature, so that none of the groups has all cold ones."""
    order = sorted(range(len(tests)), key=lambda i: tests[i].ambient)
    return [[tests[i] for i in sorted(order[k::folds])] for k in range(folds)]


def _fit(
    case: IdentifyCase, groups: list[list[TestRecord]], progress: Progress | None
) -> list[Identification]:
    """Return the fit to all tests and one without each group; an error names its fold."""
    fits: list[Identification] = []
    for number, group in enumerate([[], *groups]):
        if progress:
            progress(number, len(groups) + 1)
        seen = [record for record in case.records if not any(record is other for other in group)]
        try:
            fits.append(run_identify(replace(case, records=seen)))
        except InputError as error:
            if not number:
                raise
            raise InputError(error.lines(f"fold {number}")) from None
    if progress:
        progress(len(groups) + 1, len(groups) + 1)
    return fits
