"""Units and numbers, parsed once at the border: known conversions, exact round trips, refusals."""

import math
import subprocess
import sys
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.border.errors import InputError
from thermobearing.border.units import (
    LARGEST,
    _common_factors,
    _pint_conversion,
    conversion,
    is_number,
    number_list,
    parse_quantity,
    with_unit,
)


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("5 mm", "mm", 5.0),
        ("5mm", "mm", 5.0),
        ("  0.5 cm ", "mm", 5.0),
        ("2 inch", "mm", 50.8),
        ("1e3 um", "mm", 1.0),
        (".5 m", "mm", 500.0),
        ("+5. mm", "mm", 5.0),
        ("30.738 kN/mm", "kN/mm", 30.738),
        ("20 tonf/cm", "kN/mm", 19.6133),
        ("1 tonf/mm", "kN/mm", 9.80665),
        ("1 kgf/cm^2", "MPa", 0.0980665),
        ("11.6 W/(m^2 K)", "W/(m^2 K)", 11.6),
        ("11.6 W/(m2 K)", "W/(m^2 K)", 11.6),
        ("11.6 W/(m²·K)", "W/(m^2 K)", 11.6),
        ("11.6 W m^-2 K^-1", "W/(m^2 K)", 11.6),
        ("10 kcal/(m^2 h degC)", "W/(m^2 K)", 11.622222222222222),
        ("1.146 g/cm^3", "kg/m^3", 1146.0),
        ("1146 kg/m3", "kg/m^3", 1146.0),
        ("-20 degC", "degC", -20.0),
        ("-20 °C", "degC", -20.0),
        ("-20 C", "degC", -20.0),
        ("253.15 K", "degC", -20.0),
        ("-4 degF", "degC", -20.0),
        ("5 K", "K", 5.0),
        ("5 delta_degC", "K", 5.0),
        ("9 delta_degF", "K", 5.0),
        ("1.25 h", "s", 4500.0),
        ("5 ms", "s", 0.005),
        ("\N{MINUS SIGN}10.5 °C", "degC", -10.5),
        ("30 1/min", "Hz", 0.5),
    ],
)
def test_known_conversions(text: str, unit: str, value: float) -> None:
    assert_allclose(parse_quantity(text, unit), value, rtol=tol.CONVERSION, atol=tol.ZERO_DEGREES)


def test_own_unit_is_exact() -> None:
    """A number in the wanted unit keeps its bits: conversions by way of SI would not."""
    rng = np.random.default_rng(5)
    for value in [0.1, 1.0 / 3.0, 1e-12, 1e12, *rng.normal(size=200)]:
        for unit in ("mm", "kN/mm", "W/(m K)", "J/(kg K)", "degC", "s", "K"):
            assert parse_quantity(with_unit(float(value), unit), unit) == value


@pytest.mark.parametrize(
    ("text", "unit", "words"),
    [
        ("5", "mm", ['"5" has no unit', '"5 mm"']),
        ("mm", "mm", ["not a number with a unit", '"1.5 mm"']),
        ("", "mm", ["not a number with a unit"]),
        ("5 kg", "mm", ['"kg"', "to mm"]),
        ("5 mm mm", "mm", ['"mm mm"', "to mm"]),
        ("5 (mm^9)^9", "mm", ["to mm"]),
        ("5 furlongz", "mm", ['unknown unit "furlongz"', "mm"]),
        ("5 mm**", "mm", ["unknown unit"]),
        ("5 mm))", "mm", ["unknown unit"]),
        ("5 /mm", "mm", ["unknown unit"]),
        ("5 mm 6", "mm", ["unknown unit"]),
        ("5 mm^99", "mm", ["unknown unit"]),
        ("5 mm^9^9^9", "mm", ["unknown unit"]),  # evaluated, it would take forever
        ("5 mm**9**9**9", "mm", ["unknown unit"]),
        ("5 " + "(" * 2000 + "mm", "mm", ["is not a number", "..."]),
        ("5,0 mm", "mm", ["use a decimal point"]),
        ("nan mm", "mm", ["not a finite number"]),
        ("-inf mm", "mm", ["not a finite number"]),
        ("1e400 mm", "mm", ["not a finite number"]),
        ("5 degC", "K", ["temperature", "difference", "K"]),
        ("5 degF", "K", ["temperature", "difference", "K"]),
        ("3 rad/s", "Hz", ["angular", "Hz"]),
        ("3 rpm", "Hz", ["angular", "Hz"]),
    ],
)
def test_refusals(text: str, unit: str, words: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        parse_quantity(text, unit)
    for word in words:
        assert word in str(caught.value)
    assert len(str(caught.value)) < 200


def test_scale_and_offset() -> None:
    assert conversion("mm", "mm") == (1.0, 0.0)
    assert conversion("inch", "mm") == (25.4, 0.0)
    scale, offset = conversion("degF", "degC")
    assert math.isclose(scale, 5.0 / 9.0, rel_tol=tol.CONVERSION)
    assert math.isclose(offset, -160.0 / 9.0, rel_tol=tol.CONVERSION)


def test_zero_has_no_sign() -> None:
    assert with_unit(-0.0, "mm") == "0.0 mm"


def test_a_unit_that_is_wanted_needs_no_pint(monkeypatch: pytest.MonkeyPatch) -> None:
    def imported() -> None:
        raise AssertionError("pint is used")

    conversion.cache_clear()
    monkeypatch.setattr("thermobearing.border.units._registry", imported)
    assert parse_quantity("30.738 kN/mm", "kN/mm") == 30.738
    assert parse_quantity("-20 degC", "degC") == -20.0
    assert parse_quantity("1.5 m", "mm") == 1500.0
    with pytest.raises(AssertionError, match="pint is used"):
        parse_quantity("1 km", "mm")


def test_usual_units_are_as_pint_finds_them() -> None:
    for target, units in _common_factors().items():
        for unit, factor in units.items():
            assert (factor, 0.0) == _pint_conversion(unit, target), (unit, target)


@pytest.mark.thorough
def test_files_of_the_library_need_no_pint() -> None:
    """Nor do the programs that read them; that xarray imports pint takes less than its units."""
    program = (
        "import sys, thermobearing as tb; from thermobearing.border import units; "
        "tb.load_bearing('lrb-example'); "
        "tb.bridge('shen-lhdr-bridge', 'jra-ii-i-1', -20.0, duration=0.1); "
        "sys.exit(units._registry.cache_info().currsize)"
    )
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0


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
