"""Which cases of a parametrization `make test` runs."""

from collections.abc import Iterable
from typing import Any

import pytest


def quick_cases(cases: Iterable[Any], *kept: int) -> list[Any]:
    """Return all cases, those that are not at the places `kept` with the mark `thorough`."""
    params = [
        case
        if hasattr(case, "marks")
        else pytest.param(*(case if isinstance(case, tuple) else (case,)))
        for case in cases
    ]
    assert kept, "no case is left for make test"
    assert max(kept) < len(params)
    return [
        param
        if place in kept
        else pytest.param(*param.values, id=param.id, marks=[*param.marks, pytest.mark.thorough])
        for place, param in enumerate(params)
    ]
