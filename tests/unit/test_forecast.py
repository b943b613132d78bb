"""A fit in Python to the end: a band of prediction, and no causes for a misfit that is none."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import thermobearing as tb
from thermobearing.identify.uncertainty import covariance as uncertainty

BEARING = "shen-hdr-specimen"
SHORT = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)


@pytest.fixture(scope="module")
def exact() -> tb.Identification:
    """A fit to what the model itself said, of a bearing whose film and b are the file's."""
    record = tb.synthetic_record(BEARING, 23.0, SHORT, noise=2e-4, memory=0.9)
    return tb.identify_bearing(record, BEARING, free=["K_r"], starts=1)


def test_a_forecast_is_public(exact: tb.Identification) -> None:
    drawn = tb.forecast(exact, [-20.0])
    (band,) = drawn.bands
    assert band.peak_lower < band.peak < band.peak_upper
    assert np.all(band.lower <= band.upper)
    assert any("-20 degC" in text for text in drawn.warnings)


def test_no_cause_is_named_for_no_misfit(exact: tb.Identification) -> None:
    """Residuals of 0.02 % are no misfit, whatever takes them away."""
    assumed = exact.uncertainty.assumed
    told = tuple(replace(item, explained=0.9, sigmas=50.0, stderr=1.0) for item in assumed.evidence)
    found = replace(exact.uncertainty, assumed=replace(assumed, evidence=told))
    assert found.rms < uncertainty.NEGLIGIBLE
    tests: Any = SimpleNamespace(records=[SimpleNamespace(ambient=t) for t in (23.0, -20.0)])
    assert uncertainty._misfit(tests, found) == []
    large = replace(found, rms=2.0 * uncertainty.NEGLIGIBLE)
    said = " ".join(uncertainty._misfit(tests, large))
    assert "the tests ask for" in said
