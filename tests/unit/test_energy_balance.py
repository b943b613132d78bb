"""Residuals of the energy balance of a bearing, from plain numbers."""

import pytest

from thermobearing.results.metrics import LEAST_WARMING, energy_balance


def test_each_energy_counts_once() -> None:
    """Work = heat + recoverable and heat = stored + ends + sides, relative to the largest."""
    balance = energy_balance(100.0, 88.0, 10.0, 70.0, 12.0, 5.0, capacity=1.0)
    assert balance["mechanical_residual"] == pytest.approx((100.0 - 88.0 - 10.0) / 100.0)
    assert balance["thermal_residual"] == pytest.approx((88.0 - 70.0 - 17.0) / 100.0)
    closed = energy_balance(98.0, 88.0, 10.0, 70.0, 12.0, 6.0, capacity=1.0)
    assert closed["mechanical_residual"] == closed["thermal_residual"] == 0.0


def test_a_bearing_that_hardly_warms_has_no_large_residual() -> None:
    """The thermal residual is relative to a least warming of the whole capacity."""
    balance = energy_balance(0.0, 1e-9, -1e-9, 0.0, 0.0, 0.0, capacity=1e6)
    assert balance["thermal_residual"] == pytest.approx(1e-9 / (LEAST_WARMING * 1e6))
