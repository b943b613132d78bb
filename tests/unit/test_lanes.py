"""Lanes: what can be done with several numbers at once, and that it is done to each alone."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from tests import tolerances as tol
from tests.quick import quick_cases
from thermobearing.core.compiled.kernel import compiled
from thermobearing.core.lanes import functions
from thermobearing.core.lanes.choose import all_lanes, any_lane, no, select
from thermobearing.core.lanes.memory import (
    WIDTH,
    aligned,
    as_lanes,
    each_lane,
    refill,
    restore,
    side_by_side,
    twin,
)
from thermobearing.core.records import Floats, rows
from thermobearing.core.types import Layer, LeadCell

COUNT = 500 * WIDTH
RANDOM = np.random.default_rng(3)
SIGN = RANDOM.choice([-1.0, 1.0], COUNT)
SMALL = 10.0 ** RANDOM.uniform(-12.0, 0.0, COUNT)
ARGUMENTS: dict[str, tuple[Callable[[Floats], Floats], Floats]] = {
    "exp": (np.exp, RANDOM.uniform(-700.0, 700.0, COUNT)),
    "expm1": (np.expm1, 30.0 * SIGN * SMALL),
    "tanh": (np.tanh, 30.0 * SIGN * SMALL),
    "tan": (np.tan, 0.5 * math.pi * (1.0 - 1e-6) * SMALL),
    "atan": (np.arctan, SIGN * 10.0 ** RANDOM.uniform(-12.0, 12.0, COUNT)),
    "atanh": (np.arctanh, SIGN * RANDOM.uniform(1e-9, 1.0 - 1e-6, COUNT)),
    "log": (np.log, 10.0 ** RANDOM.uniform(-300.0, 300.0, COUNT)),
}


def of_lanes(function: Any) -> Any:
    @compiled
    def kernel(x: Floats, result: Floats) -> None:
        given, wanted = as_lanes(x, WIDTH), as_lanes(result, WIDTH)
        for i in range(len(given)):
            wanted[i] = function(given[i])

    return kernel


@pytest.mark.parametrize("name", quick_cases(ARGUMENTS, 0, 4, 5))
def test_functions_of_lanes_are_those_of_numbers(name: str) -> None:
    known, x = ARGUMENTS[name]
    result = aligned((COUNT // WIDTH, WIDTH), np.float64)
    of_lanes(getattr(math, name))(x.reshape(-1, WIDTH), result)
    wanted = known(x)
    units = np.abs(result.ravel() - wanted) / np.spacing(np.abs(wanted))
    assert units.max() <= tol.LANE_FUNCTION
    assert pytest.approx(math.tan(math.pi / 8.0)) == functions.TAN_PI_8


def test_functions_of_lanes_at_their_ends() -> None:
    x = np.array([[math.nan, 0.0, -0.0, math.inf, -math.inf, 1.0, 720.0, -800.0][:WIDTH]])
    result = aligned((1, WIDTH), np.float64)
    of_lanes(math.exp)(x, result)
    assert_array_equal(result[0, :5], [math.nan, 1.0, 1.0, math.inf, 0.0])
    assert result[0, 6] == math.inf
    assert result[0, 7] == 0.0
    of_lanes(math.tanh)(x, result)
    assert_array_equal(result[0, :5], [math.nan, 0.0, -0.0, 1.0, -1.0])
    assert math.copysign(1.0, result[0, 2]) == -1.0
    of_lanes(math.log)(x, result)
    assert_array_equal(result[0, :3], [math.nan, -math.inf, -math.inf])


@compiled
def halved(x: float, limit: float) -> float:
    """Halve until it is below the limit: another number of times for each number."""
    turns = 0.0
    done = x < limit
    while not all_lanes(done):
        x = select(done, x, 0.5 * x)
        turns += select(done, 0.0, 1.0)
        done = no(x >= limit)
    return turns + select(any_lane(done), 0.0, 1.0)


@compiled
def halved_lanes(x: Floats, limit: float, result: Floats) -> None:
    as_lanes(result, WIDTH)[0] = halved(as_lanes(x, WIDTH)[0], limit)


def test_a_loop_ends_when_all_have_what_they_want() -> None:
    x = np.array([3.0 ** (k + 1) for k in range(WIDTH)])
    x[2] = math.nan
    result = aligned((1, WIDTH), np.float64)
    halved_lanes(x.reshape(1, -1), 0.7, result)
    alone = [halved(one, 0.7) for one in x]
    assert_array_equal(result[0], alone)
    assert alone[2] == 1.0
    assert len(set(alone)) > 3
    plain: Any = halved
    assert [plain.py_func(one, 0.7) for one in x[3:]] == alone[3:]


def test_records_side_by_side_and_back() -> None:
    parts = []
    for k in range(WIDTH):
        cells, layers = rows(LeadCell, 2), rows(Layer, 3, 1)
        cells["cell"], cells["end"] = [4, 5], [k, 10.0 * k]
        layers["z"], layers["virgin"] = k, -k
        parts.append((cells, layers, np.full((3, 2), float(k)), 0.5 * k, 7, True))
    cells, layers, array, number, whole, choice = side_by_side(parts)
    assert (whole, choice) == (7, True)
    assert array.shape == (3, 2, WIDTH)
    assert array.ctypes.data % 64 == 0
    assert_array_equal(number, 0.5 * np.arange(WIDTH))
    assert_array_equal(cells["cell"], [4, 5])
    assert_array_equal(cells["end"][1], 10.0 * np.arange(WIDTH))
    assert_array_equal(layers["virgin"][2, 0], -1.0 * np.arange(WIDTH))
    own = each_lane((layers, array), (rows(Layer, 3, 1), np.zeros((3, 2))))[WIDTH - 2]
    assert_array_equal(own[0]["z"], parts[WIDTH - 2][1]["z"])
    assert_array_equal(own[0]["virgin"], parts[WIDTH - 2][1]["virgin"])
    assert_array_equal(own[0]["d"], 0.0)
    assert_array_equal(own[1], WIDTH - 2.0)


def test_other_records_in_the_same_lanes() -> None:
    """What was taken from the lanes before does not change with them."""
    parts, others = (
        [(np.full(1, k + first), np.full((2, 3), k - first)) for k in range(WIDTH)]
        for first in (0.0, 100.0)
    )
    lanes = side_by_side(parts)
    original = twin(lanes)
    taken = each_lane(lanes, parts[0])
    refill(lanes, others)
    for joined, expected in zip(lanes, side_by_side(others), strict=True):
        assert_array_equal(joined, expected)
    for lane, (one, several) in enumerate(taken):
        assert_array_equal(one, parts[lane][0])
        assert_array_equal(several, parts[lane][1])
    restore(lanes, original)
    for joined, expected in zip(lanes, side_by_side(parts), strict=True):
        assert_array_equal(joined, expected)


@pytest.mark.parametrize("spoilt", [(np.zeros(4), 1), (np.zeros(3), 2)])
def test_unlike_runs_are_refused(spoilt: Any) -> None:
    parts: list[Any] = [(np.zeros(3), 1)] * (WIDTH - 1)
    with pytest.raises(ValueError, match="unequal shape"):
        side_by_side([*parts, spoilt])
