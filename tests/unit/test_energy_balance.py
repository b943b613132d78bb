"""Residuals of the energy balance of a bearing, from plain numbers."""

import numpy as np
import pytest

from thermobearing.results.metrics import BALANCE, LEAST_HEAT, LEAST_WARMING, energy_balance


def test_each_energy_counts_once() -> None:
    """Work = heat + recoverable and heat = stored + ends + sides, relative to the largest."""
    energies = dict(zip(BALANCE, (100.0, 88.0, 10.0, 70.0, 12.0, 5.0), strict=True))
    balance = energy_balance(energies, capacity=1.0)
    assert balance["mechanical_residual"] == pytest.approx((100.0 - 88.0 - 10.0) / 100.0)
    assert balance["thermal_residual"] == pytest.approx((88.0 - 70.0 - 17.0) / 100.0)
    closed = energy_balance(energies | {"work_in": 98.0, "heat_lost_sides": 6.0}, capacity=1.0)
    assert closed["mechanical_residual"] == closed["thermal_residual"] == 0.0


def test_a_bearing_that_hardly_warms_has_no_large_residual() -> None:
    """The thermal residual is relative to a least warming of the whole capacity."""
    energies = dict(zip(BALANCE, (0.0, 1e-9, -1e-9, 0.0, 0.0, 0.0), strict=True))
    balance = energy_balance(energies, capacity=1e6)
    assert balance["thermal_residual"] == pytest.approx(1e-9 / (LEAST_WARMING * 1e6))
    without_capacity = energy_balance(energies)
    assert without_capacity["thermal_residual"] == pytest.approx(1e-9 / LEAST_HEAT)


def test_a_column_of_runs_has_the_residuals_of_each_run() -> None:
    """The second run loses more heat than its work, which is the scale of both residuals."""
    runs = [(100.0, 88.0, 10.0, 70.0, 12.0, 5.0), (10.0, 8.0, 1.0, -40.0, 30.0, 20.0)]
    columns = dict(zip(BALANCE, np.array(runs).T, strict=True))
    balance = energy_balance(columns)
    assert balance["mechanical_residual"] == pytest.approx([0.02, 1.0 / 50.0])
    assert balance["thermal_residual"] == pytest.approx([0.01, -2.0 / 50.0])
