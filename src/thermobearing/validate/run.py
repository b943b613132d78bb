"""Bearings compared with tests: as they are, or calibrated to other tests.

    tests, bearings -> checks -> model at every sample -> ratios per cycle -> verdicts
    tests -> some are held out -> calibration to the others -> validation with those held out

Displacement and ambient temperature come from the test (Shen 2023, 4.4.2 and 5.4.2). For a cross
validation either the user names the tests held out, or every test is once: `folds` groups of them,
one fit without each group, and a last one to all of them.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Unpack, get_args

import numpy as np

from thermobearing.bearing.exposure import describe_all, exposures
from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing, calibration_ranges
from thermobearing.bearing.sources import is_never_tested
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, nearest, shortened
from thermobearing.border.toml import to_table
from thermobearing.border.units import is_number
from thermobearing.identify.case import IdentifyCase, IdentifyKeywords, Test, make_identify_case
from thermobearing.identify.comparison import LIMITS, Comparison
from thermobearing.identify.fit.forward import ForwardModel, unstable_tests
from thermobearing.identify.records.checks import NOT_NEEDED, CheckReport, check_test
from thermobearing.identify.records.record import TestRecord, load_test, reached_values
from thermobearing.identify.result import Identification
from thermobearing.identify.run import run_identify
from thermobearing.model.earlier import Model
from thermobearing.model.options import ModelOptions
from thermobearing.quantities.warned import as_warned
from thermobearing.results.ranges import compare_with_tests, outside_tests
from thermobearing.validate.result import QUANTITIES, CrossValidation, Validation

ANY_HISTORY = (*NOT_NEEDED, "begin", "end")  # checks of which a comparison repeats no warning
LARGEST_LIMIT = 10.0
Chosen = Bearing | str | Path
Progress = Callable[[int, int], None]


@checked
def validate_bearing(
    bearings: Sequence[Chosen] | Chosen,
    records: Sequence[Test] | Test,
    *,
    models: Sequence[Model] | Model = "multi-layer",
    limits: Mapping[str, float] | None = None,
) -> Validation:
    """Validate bearings against tests that were not used in their calibration.

    Parameters
    ----------
    bearings : one or more: a Bearing, a library name, or a TOML file.
    records : one or more tests of any history: from `load_test`, `record_from_arrays`, or paths.
    models : "multi-layer" (default) and earlier models.
    limits : largest relative error by quantity: K_eq, h_eq (0.15 each unless given), energy,
        force, temperature, NRMSE.

    Raises
    ------
    InputError : a test that cannot be used, with the reason; unknown names; limits out of range.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
    >>> record = tb.synthetic_record("shen-hdr-specimen", -20.0, test)
    >>> found = validate_bearing("shen-hdr-specimen", record, models=["multi-layer", "adiabatic"])
    >>> [round(item.R2, 2) for item in found.comparisons][0] > 0.99
    True
    """
    chosen = [bearings] if isinstance(bearings, Bearing | str | Path) else list(bearings)
    model_names: list[Model] = [models] if isinstance(models, str) else list(models)
    tests = _load_tests(records)
    for kind, items in (("bearing", chosen), ("test", tests), ("model", model_names)):
        if not items:
            raise InputError(f"give at least one {kind}")
    for model in model_names:
        if model not in get_args(Model):
            raise InputError(f'model = "{model}"{nearest(model, get_args(Model))}')
    largest = check_limits(limits)
    chosen_bearings = [as_bearing(item) for item in chosen]
    assumed = _refuse_unusable(tests, chosen_bearings[0])
    judged = _judge(
        chosen_bearings, [_as_fitted(check_test(record)) for record in tests], model_names, largest
    )
    return replace(judged, warnings=[*assumed, *judged.warnings])


def _load_tests(tests: Sequence[Test] | Test) -> list[TestRecord]:
    items = [tests] if isinstance(tests, TestRecord | str | Path) else list(tests)
    return [item if isinstance(item, TestRecord) else load_test(item) for item in items]


def check_limits(limits: Mapping[str, float] | None) -> dict[str, float]:
    """Return the default limits updated by the given ones, in (0, 10]."""
    for name, value in (limits or {}).items():
        if name not in QUANTITIES:
            raise InputError(f'limit of "{name}"{nearest(name, QUANTITIES)}')
        if not is_number(value) or not 0.0 < value <= LARGEST_LIMIT:
            raise InputError(
                f"limit of {name} = {value!r}: must be a relative error, more than 0 and at most "
                f"{LARGEST_LIMIT:g} (0.15 is 15 %)"
            )
    return LIMITS | {name: float(value) for name, value in (limits or {}).items()}


def _judge(
    bearings: Sequence[Bearing],
    records: Sequence[TestRecord],
    models: Sequence[Model] = ("multi-layer",),
    limits: Mapping[str, float] = LIMITS,
) -> Validation:
    """Compare bearings with tests as fitted, in the models that each bearing supports."""
    comparisons, warnings = [], []
    for bearing in bearings:
        possible = [model for model in models if not ModelOptions(model=model).misfits(bearing)]
        if not possible:
            raise InputError(f'model "{models[0]}" needs lead, but {bearing.name} has none')
        bearing_comparisons = [
            _comparison(bearing, model, record)
            for model in dict.fromkeys(possible)
            for record in records
        ]
        warnings += describe_all(exposures([bearing], None))
        predictions = [item.prediction for item in bearing_comparisons]
        tests = [item.record for item in bearing_comparisons]
        warnings += dict.fromkeys(unstable_tests(tests, predictions))
        rows = [row for item in bearing_comparisons for row in item.compared]
        never = is_never_tested(bearing.sources)
        ranges = calibration_ranges(bearing)
        warnings += outside_tests(bearing.name, rows, ranges, never_tested=never)
        comparisons += bearing_comparisons
    inputs = {
        bearing.name: {"table": to_table(bearing), "sources": bearing.sources}
        for bearing in bearings
    }
    return Validation(comparisons, dict(limits), warnings, {"bearings": inputs})


def _as_fitted(report: CheckReport) -> TestRecord:
    """Return a test as a fit uses it: rests thinned, spikes and drift removed on request."""
    record = report.record
    if report.treatment is None:
        return record
    treated, _ = report.treatment.to_fit(report.clipped)
    pairs = [(getattr(treated, name), getattr(record, name)) for name in ("displacement", "force")]
    return record if all(np.array_equal(new, old) for new, old in pairs) else treated


def _refuse_unusable(records: Sequence[TestRecord], bearing: Bearing) -> list[str]:
    """Return the warnings about tests; reject tests that cannot be used."""
    findings_of_tests = [(test, check_test(test, bearing).findings) for test in records]
    refused = [
        f"{record.file or record.name}: {finding.sentence}"
        for record, findings in findings_of_tests
        for finding in findings
        if finding.level == "refused" and finding.check not in NOT_NEEDED
    ]
    if refused:
        raise InputError(refused)
    return [
        f"{record.name}: {finding.sentence}"
        for record, findings in findings_of_tests
        for finding in findings
        if finding.level == "warning" and finding.check not in ANY_HISTORY
    ]


def _comparison(bearing: Bearing, model: Model, record: TestRecord) -> Comparison:
    options, record = ModelOptions(model=model), record.of_bearing(bearing)
    forward = ForwardModel(record, bearing, fine=True, options=options)
    prediction = forward.run()
    lead = prediction.lead if prediction else None
    rubber = bearing.total_rubber_thickness
    reached = reached_values(record, rubber, record.ambient, lead)
    name = f"{bearing.name}, {model}, {record.name}, {record.ambient:g} degC"
    compared = compare_with_tests(name, reached, calibration_ranges(bearing))
    return Comparison(record, bearing.name, model, rubber, prediction, forward.ended, compared)


@checked
def cross_validate(
    records: Sequence[Test] | Test,
    bearing: Bearing | str | Path,
    *,
    hold_out: Sequence[Test] | Test = (),
    folds: int | None = None,
    limits: Mapping[str, float] | None = None,
    progress: Progress | None = None,
    **fit: Unpack[IdentifyKeywords],
) -> CrossValidation:
    """Calibrate a bearing with some tests and validate it with the others.

    Parameters
    ----------
    records : tests of one bearing (`load_test`, `record_from_arrays`, or paths).
    bearing : geometry and materials, and the values of what is not free.
    hold_out : tests that are not fitted, of any history; those also among `records` are removed
        from them.
    folds : instead of `hold_out`: number of groups, 2 to number of tests; each is held out once.
        Tests of similar temperature go to different groups, so that every fit has warm and cold
        tests.
    limits : largest relative error by quantity, as in `validate_bearing`.
    progress : called with (fits done, all).
    free, bounds, search, seed, starts, loss, temperatures, start_from, polish : as
        of `identify_bearing`; bounds are in the unit of the parameter.
    assumed, accept_poor, one_temperature : as of `identify_bearing`; the uncertainties that are
        assumed are relative.

    Raises
    ------
    InputError : no test or every test is held out; a test that cannot be used; any error of
        `identify_bearing` and `validate_bearing`.

    Examples
    --------
    >>> import thermobearing as tb
    >>> test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
    >>> warm, cold = (tb.synthetic_record("shen-hdr-specimen", t, test) for t in (23, -9))
    >>> found = cross_validate(warm, "shen-hdr-specimen", hold_out=cold, free=["K_r"], starts=1)
    >>> found.verdict
    'within'
    """
    tests, held_out = _split_tests(records, hold_out)
    if bool(held_out) == (folds is not None):
        raise InputError("give either tests to hold out or a number of folds")
    if not tests:
        raise InputError("every test is held out; none remains for the calibration")
    if folds is not None:
        _check_folds(folds, len(tests))
    case = make_identify_case(tests, bearing, **fit)
    largest = check_limits(limits)
    tests = case.records
    if refused := [line for test in tests for line in check_test(test, case.bearing).refusals]:
        raise InputError(refused)
    _refuse_unusable(held_out, case.bearing)
    groups = _groups(tests, folds) if folds else [held_out]
    final, *fits = _fit(case, groups if folds else [], progress)
    # One treated copy of each test: folds and comparisons find their tests by identity.
    checks = {id(record): check_test(record) for record in [*tests, *held_out]}
    as_fitted = {key: _as_fitted(check) for key, check in checks.items()}
    checks_of_held_out = [checks[id(record)] for group in groups for record in group]
    groups = [[as_fitted[id(record)] for record in group] for group in groups]
    pairs = zip(fits or [final], groups, strict=True)
    judged = [_judge([calibration.bearing], group) for calibration, group in pairs]
    warnings: list[str] = [
        as_warned(text).about(f"held out{f' of fold {number}' if folds else ''}")
        for number, validation in enumerate(judged, start=1)
        for text in validation.warnings
    ]
    items = [item for validation in judged for item in validation.comparisons]
    return CrossValidation(
        final=final,
        folds=fits,
        groups=groups,
        fitted=_judge([final.bearing], [as_fitted[id(r)] for r in tests], limits=largest),
        held_out=Validation(items, largest, warnings),
        checks=checks_of_held_out,
    )


def _split_tests(
    records: Sequence[Test] | Test, hold_out: Sequence[Test] | Test
) -> tuple[list[TestRecord], list[TestRecord]]:
    """Return the tests to fit and those held out, without duplicates."""
    tests, held_out = _load_tests(records), _load_tests(hold_out)
    distinct = [
        test
        for i, test in enumerate(held_out)
        if not any(_is_same_test(test, second) for second in held_out[:i])
    ]
    to_fit = [test for test in tests if not any(_is_same_test(test, second) for second in held_out)]
    return to_fit, distinct


def _is_same_test(first: TestRecord, second: TestRecord) -> bool:
    """Return whether two records are the same test: the same object or file."""
    files = [Path(record.file).resolve() for record in (first, second) if record.file]
    return first is second or (len(files) == 2 and files[0] == files[1])


def _check_folds(folds: int, tests: int) -> None:
    if tests < 2:
        raise InputError("folds: needs at least two tests")
    if not isinstance(folds, int) or isinstance(folds, bool) or not 2 <= folds <= tests:
        value_text = shortened(str(folds)) if is_number(folds) else "that"
        raise InputError(
            f"folds = {value_text}: must be an integer from 2 to the number of tests, {tests}"
        )


def _groups(tests: list[TestRecord], folds: int) -> list[list[TestRecord]]:
    """Return groups of tests of mixed temperatures."""
    # Each group takes every n-th test in the order of temperature, so that it spans all of them.
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
        remaining = [
            record for record in case.records if not any(record is held_out for held_out in group)
        ]
        try:
            fits.append(run_identify(replace(case, records=remaining)))
        except InputError as error:
            if not number:
                raise
            raise InputError(error.lines(f"fold {number}")) from None
    if progress:
        progress(len(groups) + 1, len(groups) + 1)
    return fits
