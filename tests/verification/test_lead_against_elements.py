"""Lead on finite plates and between shims against axisymmetric finite elements, at every time."""

import pytest

from tests import tolerances as tol
from tests.conftest import Recorder
from tests.verification.lead_cases import CONFINED, SEALED, SIDES, Case, errors

pytest.importorskip("skfem", reason="scikit-fem is not installed")

COMPARED = [
    *(pytest.param("confined", name, case, tol.KERNEL_LEAD) for name, case in CONFINED.items()),
    *(pytest.param("between shims", name, case, tol.KERNEL_LEAD) for name, case in SIDES.items()),
    *(
        pytest.param("between shims and sealing plates", name, case, tol.KERNEL_SEALED)
        for name, case in SEALED.items()
    ),
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
