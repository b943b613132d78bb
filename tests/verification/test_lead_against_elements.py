"""Lead on finite plates and between shims against axisymmetric finite elements, at every time."""

import pytest

from tests import tolerances as tol
from tests.conftest import Recorder
from tests.verification.lead_cases import CONFINED, SEALED, SIDES, Case, errors

pytest.importorskip("skfem", reason="scikit-fem is not installed")

ALWAYS = 2  # bearings of each kind; the others where everything is run
COMPARED = [
    pytest.param(how, name, case, limit, marks=[pytest.mark.thorough] if i >= ALWAYS else [])
    for how, cases, limit in (
        ("confined", CONFINED, tol.KERNEL_LEAD),
        ("between shims", SIDES, tol.KERNEL_LEAD),
        ("between shims and sealing plates", SEALED, tol.KERNEL_SEALED),
    )
    for i, (name, case) in enumerate(cases.items())
]


@pytest.mark.parametrize(("how", "name", "case", "limit"), COMPARED)
def test_lead_at_every_time(
    how: str, name: str, case: Case, limit: float, measured: Recorder
) -> None:
    """Loading, two minutes, the same loading, ten minutes; the default, and the formula."""
    ours, rise = errors(case)
    formula, _ = errors(case, lead_ends="half-space")
    measured(
        f"lead {how}, {name}: largest error, half-space and finite plates",
        f"{formula:+.1f} K, {ours:+.1f} K of {rise:.0f} K",
        f"{limit:g} K for finite plates",
    )
    assert abs(ours) < limit
    assert abs(ours) < 0.5 * abs(formula)
