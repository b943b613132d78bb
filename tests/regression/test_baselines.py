"""Numbers stay what they were, unless somebody says why they change (regenerate.py)."""

import json

import pytest
from numpy.testing import assert_allclose

from tests import tolerances as tol
from tests.regression.regenerate import BASELINE, CASES, compute

STORED = json.loads(BASELINE.read_text())


@pytest.fixture(scope="module")
def now() -> dict[str, list[list[float]]]:
    return compute()


@pytest.mark.parametrize("name", CASES)
def test_baseline(name: str, now: dict[str, list[list[float]]]) -> None:
    assert_allclose(now[name], STORED["values"][name], rtol=tol.REGRESSION)


def test_baseline_says_why() -> None:
    assert STORED["reason"]
    assert STORED["date"]
