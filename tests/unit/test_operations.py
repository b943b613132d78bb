"""Operations of a step, counted in plain Python: the same on every machine."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from benchmarks import operations
from benchmarks.operations import LIMITS, TALLY, Counted, CountedMath, Work, counting
from thermobearing.core.records import rows
from thermobearing.core.types import Layer
from thermobearing.structure.newmark import peaks_march


def counted(calculate: Callable[[], object]) -> Work:
    """What a calculation takes."""
    TALLY.clear()
    calculate()
    return TALLY.work


def test_each_operation_counts_once_and_signs_do_not():
    a, b = Counted(2.0), Counted(3.0)
    work = counted(lambda: abs(-(a + b) * 2.0 - 1.0 / b) + max(a, b, 0.0))
    assert (work.operations, work.divisions, work.functions) == (5, 1, 0)


def test_functions_count_as_their_series():
    kernels_math = CountedMath()
    work = counted(lambda: kernels_math.exp(Counted(1.0)) + kernels_math.sqrt(Counted(4.0)))
    assert (work.operations, work.divisions, work.functions) == (34 + 1 + 1, 0, 1)
    assert kernels_math.pi == math.pi


def test_views_of_one_array_stay_views():
    arrays = {}
    columns = np.zeros((2, 3))
    first, second = counting(columns[0], arrays), counting(columns[1], arrays)
    whole = counting(columns, arrays)
    first[1], second[2] = 5.0, 7.0
    assert (whole[0, 1], whole[1, 2]) == (5.0, 7.0)
    layer = counting(rows(Layer, 2), arrays)
    layer[1].d = Counted(1.0)
    assert (layer[0].d, layer[1].d) == (0.0, 1.0)


@pytest.mark.parametrize("name", LIMITS)
def test_a_step_takes_no_more_operations_than_before(name):
    before = peaks_march.run
    parts = operations.count(*operations.BEARINGS[name])
    step = operations.total(parts)
    most_operations, most_divisions = LIMITS[name]
    assert 0.9 * most_operations < step.operations <= most_operations
    assert step.divisions <= most_divisions
    # Kernels run as before afterwards, with the plain module `math`.
    assert peaks_march.run == before
    assert peaks_march.py_func.__globals__["math"] is math
