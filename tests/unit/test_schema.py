"""What a field may be, said in words: limits on either side, sizes that must be slips."""

from typing import Annotated, Any

import pytest
from pydantic import Field

import thermobearing as tb
from thermobearing.border.schema import Strict, in_unit


class Walk(Strict):
    """Every kind of limit."""

    length: Annotated[float, in_unit("mm"), Field(gt=0)] = 1.0
    share: Annotated[float, Field(ge=0, lt=1)] = 0.0
    steps: Annotated[int, Field(gt=2, le=5)] = 3
    drift: float = 0.0


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"length": 0.0}, "length = 0.0: must be a number greater than 0 mm"),
        ({"share": -0.1}, "share = -0.1: must be a number at least 0 and less than 1"),
        ({"share": 1.0}, "share = 1.0: must be a number at least 0 and less than 1"),
        ({"steps": 2}, "steps = 2: must be a whole number greater than 2 and at most 5"),
        ({"steps": 6}, "steps = 6: must be a whole number greater than 2 and at most 5"),
        ({"length": 1.1e12}, "length = 1100000000000.0: must be at most 1e+12 mm in size"),
        ({"length": 0.9e-12}, "length = 9e-13: must be at least 1e-12 mm in size"),
        ({"drift": -2e12}, "drift = -2000000000000.0: must be at most 1e+12 in size"),
        ({"drift": float("nan")}, "drift = nan: must be a finite number"),
        ({"steps": True}, "steps = True: must be a whole number"),
        ({"lenght": 2.0}, 'unknown key "lenght"; did you mean "length"?'),
    ],
)
def test_what_is_allowed(given: dict[str, Any], said: str) -> None:
    with pytest.raises(tb.InputError) as caught:
        Walk(**given)
    assert said in str(caught.value)


@pytest.mark.parametrize("given", [{"length": 1e12}, {"length": 1e-12}, {"drift": 1e-300}])
def test_sizes_that_are_no_slip(given: dict[str, float]) -> None:
    assert Walk(**given).model_dump() | given == Walk(**given).model_dump()
