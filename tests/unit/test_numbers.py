"""What counts as a number among the arguments of Python functions."""

from typing import Any

import numpy as np
import pytest

import thermobearing as tb
from thermobearing.border.errors import InputError
from thermobearing.border.units import LARGEST, is_number, number_list


@pytest.mark.parametrize("value", [0, -3, 2.5, np.float64(1.0), np.int64(7), float("inf"), LARGEST])
def test_numbers(value: Any) -> None:
    assert is_number(value)


@pytest.mark.parametrize("value", [True, False, "3", None, [3], 10**400, -(10**400), 1j])
def test_what_is_no_number(value: Any) -> None:
    assert not is_number(value)


def test_lists_of_numbers() -> None:
    assert number_list((1, 2.5), "x").tolist() == [1.0, 2.5]
    assert number_list(4, "x").tolist() == [4.0]
    for values, words in (
        ([], "x: must be a list of numbers"), ([[1.0]], "x: must be"), ("one", "x: must be"),
        ([1.0, np.nan], "x: nan at place 2"), ([np.inf, 1.0], "x: inf at place 1"),
        ([10**400], "x: must be"),
    ):  # fmt: skip
        with pytest.raises(InputError, match=words):
            number_list(values, "x")


@pytest.mark.parametrize(
    "values",
    [
        np.ma.array([0.0, 1.0, 2.0], mask=[False, True, False]),
        [0.0, np.ma.masked, 2.0],
        np.array([0.0, 1.0 + 1.0j, 2.0]),
        [0.0, 1.0 + 0.0j, 2.0],
    ],
)
def test_masked_and_complex_numbers_are_refused(values: Any) -> None:
    """Before, hidden values and real parts were taken without a word."""
    time = [0.0, 0.5, 1.0]
    for use in (
        lambda: tb.run("shen-hdr-specimen", test=(time, values)),
        lambda: tb.run("shen-hdr-specimen", test=(values, time)),
        lambda: tb.motion_from_arrays(values, unit="m/s2", dt=0.01),
        lambda: tb.Ambient.series(time, values),
        lambda: tb.element("shen-hdr-specimen", initial=values),
    ):
        with pytest.raises(tb.InputError, match=r"masked|complex"):
            use()
    whole = np.ma.array([0.0, 1.0, 2.0])  # nothing hidden
    assert tb.motion_from_arrays(whole, unit="m/s2", dt=0.01).pga == 2000.0
