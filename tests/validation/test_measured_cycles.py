"""A real test record of a high damping rubber bearing: cycles found, and measured as published.

Gallardo, de la Llera, Restrepo, Chen (2023), Eng. Struct. 289:116234: 26 372 points, cycles at
24, 49, 98 and 148 %, displacement in cm, force in kN too. The test begins to the negative side; the
published cycles begin to the positive one, so that one at a mean strain is between two levels.
"""

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from typer.testing import CliRunner

import thermobearing as tb
from tests import tolerances as tol
from tests.shared_data import shared_data
from tests.unit.inputs import changed_table, specimen_table, write_toml
from thermobearing.cli import app
from thermobearing.results.metrics import CycleMeasures

RUBBER = 156.0  # total rubber height [mm]; the plan is not published
CYCLES = 27


@pytest.fixture(scope="module")
def table() -> dict[str, np.ndarray]:
    path = shared_data("bearing_tests/cycle_table.csv")
    rows = np.genfromtxt(path, delimiter=",", names=True)
    return {name: rows[name] for name in rows.dtype.names or ()}


@pytest.fixture(scope="module")
def measured() -> list[CycleMeasures]:
    path = shared_data("bearing_tests/Test_2D_shear.csv")
    data = tb.read_columns(path, {"displacement": "mm", "force": "kN"})
    assert len(data["force"]) == 26_372
    return tb.measure_history(
        data["displacement"], data["force"], area=1.0, total_rubber_thickness=RUBBER, side=1.0
    )


def test_every_cycle_is_found(measured: list[CycleMeasures], table: dict[str, np.ndarray]) -> None:
    assert len(measured) == len(table["W_kJ"]) == CYCLES
    strain = [cycle.amplitude_mm / RUBBER for cycle in measured]
    assert_allclose(strain, table["gamma"], rtol=tol.RECORD_STRAIN)


def test_energy(measured: list[CycleMeasures], table: dict[str, np.ndarray]) -> None:
    energy = np.array([cycle.energy_kN_mm for cycle in measured]) / 1e3
    assert_allclose(energy, table["W_kJ"], rtol=tol.RECORD_ENERGY)


def test_command_measures_the_record(table: dict[str, np.ndarray], tmp_path: Path) -> None:
    path = shared_data("bearing_tests/Test_2D_shear.csv")
    changes = {"geometry.rubber_layers": 26, "geometry.rubber_thickness": "6 mm"}
    bearing = write_toml(tmp_path / "b.toml", changed_table(specimen_table(), changes))
    done = CliRunner().invoke(app, ["measure", str(path), "--bearing", str(bearing), "--json"])
    assert done.exit_code == 0
    cycles = json.loads(done.stdout.splitlines()[-1])["cycles"]
    # Begun to the negative side, as the test, each cycle has one amplitude on both sides.
    levels = table["gamma"][[0, 7, 14, 21]]
    strain = np.repeat(levels, [7, 7, 7, 6])
    assert_allclose(
        [cycle["amplitude_mm"] / RUBBER for cycle in cycles], strain, rtol=tol.RECORD_LEVEL
    )
