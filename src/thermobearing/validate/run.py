"""The story of a validation: bearings as they are, moved as the tests were, beside the tests.

    tests, bearings -> checks -> model at every sample -> ratios per cycle -> verdicts

Nothing is fitted: displacement and ambient temperature come from the test, the numbers from the
bearing's file (4.4.2 and 5.4.2 of the source).
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from thermobearing.bearing.exposure import describe_all, exposures
from thermobearing.bearing.model import Bearing, calibration_ranges
from thermobearing.border.errors import InputError
from thermobearing.border.toml import to_table
from thermobearing.core.records import Floats
from thermobearing.identify.fit.forward import ForwardModel, Prediction
from thermobearing.identify.records.checks import check_test
from thermobearing.identify.records.cycles import compare_largest_loops, compare_loops
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.uncertainty.agreement import determination, reached_in
from thermobearing.model.earlier import Model
from thermobearing.model.options import ModelOptions
from thermobearing.results.ranges import asked_of_tests, outside_tests
from thermobearing.validate.case import (
    Chosen,
    Test,
    ValidateCase,
    make_validate_case,
    possible_models,
)
from thermobearing.validate.result import Comparison, Validation

ASSUMED = ("assumed", "rubber")  # checks whose warnings a comparison repeats
NOT_NEEDED = ("cycles", "sampling")  # checks of a fit that any history may fail


def validate_bearing(
    bearings: Sequence[Chosen] | Chosen,
    records: Sequence[Test] | Test,
    *,
    models: Sequence[Model] | Model = "multi-layer",
    limits: Mapping[str, float] | None = None,
) -> Validation:
    """Judge bearings, as they are, by tests that they were not fitted to.

    Parameters
    ----------
    bearings : one or more: a Bearing, a library name, or a TOML file.
    records : one or more tests of any history: from `load_test`, `record_from_arrays`, or paths.
    models : "multi-layer" (default) and earlier models, side by side.
    limits : largest relative error by quantity: K_eq, h_eq (0.15 each unless given), energy,
        force, temperature, NRMSE.

    Returns
    -------
    Validation

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
    return run_validate(make_validate_case(bearings, records, models=models, limits=limits))


def run_validate(case: ValidateCase) -> Validation:
    """Run a case from `make_validate_case`; a test that cannot be used is refused."""
    assumed = refuse_unusable(case.records, case.bearings[0])
    found = judge(replace(case, records=[as_fitted(record) for record in case.records]))
    return replace(found, warnings=[*assumed, *found.warnings])


def judge(case: ValidateCase) -> Validation:
    """Compare bearings with tests that are checked and treated already (`as_fitted`)."""
    found, said = [], []
    for bearing in case.bearings:
        mine = [
            _comparison(bearing, model, record)
            for model in possible_models(case, bearing)
            for record in case.records
        ]
        said += describe_all(exposures([bearing], None))
        rows = [row for item in mine for row in item.asked]
        said += outside_tests(bearing.name, rows, calibration_ranges(bearing))
        found += mine
    went_in = {one.name: {"table": to_table(one), "sources": one.sources} for one in case.bearings}
    return Validation(found, dict(case.limits), said, {"bearings": went_in})


def as_fitted(record: TestRecord) -> TestRecord:
    """Return a test as a fit sees it: rests held and thinned, spikes and drift removed if asked.

    Otherwise a bearing would be judged by how logged rests relax, and by spikes.
    """
    found = check_test(record)
    if found.treatment is None:
        return record
    seen, _ = found.treatment.to_fit(found.clipped)
    pairs = [(getattr(seen, name), getattr(record, name)) for name in ("displacement", "force")]
    return record if all(np.array_equal(new, old) for new, old in pairs) else seen


def refuse_unusable(records: Sequence[TestRecord], bearing: Bearing) -> list[str]:
    """Return what had to be assumed about tests; refuse those that no model can be judged by."""
    found = [(one, check_test(one, bearing).findings) for one in records]
    refused = [
        f"{record.file or record.name}: {finding.sentence}"
        for record, findings in found
        for finding in findings
        if finding.level == "refused" and finding.check not in NOT_NEEDED
    ]
    if refused:
        raise InputError(refused)
    return [
        f"{record.name}: {finding.sentence}"
        for record, findings in found
        for finding in findings
        if finding.level == "warning" and finding.check in ASSUMED
    ]


def _comparison(bearing: Bearing, model: Model, record: TestRecord) -> Comparison:
    options, record = ModelOptions(model=model), record.of_bearing(bearing)
    forward = ForwardModel(record, bearing, fine=True, options=options)
    found = forward.run()
    lead = found.lead if found else None
    reached = reached_in(record, bearing.total_rubber_thickness, record.ambient, lead)
    name = f"{bearing.name}, {model}, {record.name}, {record.ambient:g} degC"
    asked = asked_of_tests(name, reached, calibration_ranges(bearing))
    rubber = bearing.total_rubber_thickness
    item = Comparison(bearing.name, model, record, forward.ended, asked, rubber)
    if found is None:
        return item
    loops = compare_loops(record, found.force)
    return replace(
        item,
        prediction=found,
        R2=determination(record.force, found.force),
        NRMSE=float(np.sqrt(np.mean((found.force - record.force) ** 2))) / record.peak_force,
        loops=loops,
        largest=compare_largest_loops(record, found.force, loops),
        temperature_errors=rise_errors(record, found),
    )


def rise_errors(record: TestRecord, found: Prediction) -> dict[str, Floats]:
    """Return the error of the rise in time by thermocouple, relative to the test's largest rise.

    Eq. 4.39 with its sign, but its denominator is not the rise so far: half a kelvin at the start
    of a test would be an error of 50 %. Thermocouples that do not rise are left out.
    """
    rises = {title: values - values[0] for title, values in record.temperatures.items()}
    return {
        title: (found.temperatures[title] - found.temperatures[title][0] - rise) / rise.max()
        for title, rise in rises.items()
        if rise.max() > 0.0
    }
