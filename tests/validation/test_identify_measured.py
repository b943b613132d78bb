"""The real cyclic test of a high damping rubber bearing, with what had to be assumed."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from tests import tolerances as tol
from tests.conftest import Recorder
from tests.shared_data import shared_data
from tests.unit.inputs import GALLARDO
from thermobearing.identify.record import load_test
from thermobearing.identify.result import Identification
from thermobearing.identify.run import identify_bearing

# Virgin rubber: every cycle counts relative to its own peak, first cycles four times.
VIRGIN = "\n[scragging]\namplitude = 0.5\nstrain = 0.3\nmullins_amplitude = 0.3\n"
BALANCED = "cycle_balance = 1.0\nfirst_cycle_weight = 4.0\n"


def identified(folder: Path, bearing: str, sidecar: str) -> Identification:
    shutil.copy(shared_data("bearing_tests/Test_2D_shear.csv"), folder / "test.csv")
    (folder / "bearing.toml").write_text(bearing)
    (folder / "test.toml").write_text('bearing = "bearing.toml"\n' + sidecar)
    record = load_test(folder / "test.csv")
    assert len(record.assumptions) == 2  # 30 mm/s, 23 degC
    assert record.bearing is not None
    return identify_bearing(record, record.bearing)


def test_real_hdr_test(tmp_path: Path, measured: Recorder) -> None:
    """No clock, no temperature, no plan size are given; only the rubber height of 156 mm is."""
    found = identified(tmp_path, GALLARDO, "")
    (fit,) = found.fits
    measured("NRMSE of a real HDR test, no scragging", fit.NRMSE, f"<= {tol.MEASURED_NRMSE:g}")
    assert fit.NRMSE <= tol.MEASURED_NRMSE
    assert len(fit.cycles) == 27  # the 28th is cut off by the end of the file
    worst = max(abs(c.energy_error) for c in fit.cycles)
    measured("largest energy error of a cycle of that test", worst, "told, not limited")
    firsts = [round(c.amplitude_strain, 1) for c in fit.cycles if c.number == 1]
    assert firsts == [0.2, 0.5, 1.0, 1.5]
    said = "\n".join(found.warnings)
    for words in ("not noise", "first cycles", "no time column", "no ambient temperature"):
        assert words in said


@pytest.mark.thorough
def test_real_hdr_test_as_virgin_rubber(tmp_path: Path, measured: Recorder) -> None:
    """What scragging buys: the first cycles, the fall over the later ones, and the energies."""
    found = identified(tmp_path, GALLARDO + VIRGIN, BALANCED)
    (fit,) = found.fits
    energy = np.array([c.energy_error for c in fit.cycles])
    firsts = np.array([c.force_max_error for c in fit.cycles if c.number == 1])
    measured("NRMSE of the real HDR test, with scragging", fit.NRMSE, f"<= {tol.VIRGIN_NRMSE:g}")
    measured(
        "energy errors of its cycles, with scragging",
        f"{100 * energy.min():+.1f} to {100 * energy.max():+.1f} %",
        f"+-{100 * tol.VIRGIN_ENERGY:g} %",
    )
    measured(
        "peak force errors of its first cycles, with scragging",
        ", ".join(f"{100 * value:+.1f} %" for value in firsts),
        "-18 to -19 % without",
    )
    assert fit.NRMSE <= tol.VIRGIN_NRMSE
    assert np.abs(energy).max() <= tol.VIRGIN_ENERGY
    assert np.abs(firsts).max() < 0.08
    assert found.values["scragging.amplitude"] > 0.5
    assert found.values["scragging.mullins_amplitude"] == pytest.approx(0.19, abs=0.06)
