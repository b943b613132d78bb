"""The real cyclic test of a high damping rubber bearing, with what had to be assumed."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from tests import tolerances as tol
from tests.conftest import Recorder
from tests.shared_data import shared_data
from thermobearing.identify.records.record import load_test
from thermobearing.identify.result import Identification
from thermobearing.identify.run import identify_bearing

# The files that docs/files.md gives, "First cycles": one command repeats the figures of README.
RUBBER = 156.0  # total thickness [mm]
REAL_TEST = Path(__file__).parents[2] / "docs" / "real_test"


def identified(folder: Path, *, virgin: bool) -> Identification:
    shutil.copy(shared_data("bearing_tests/Test_2D_shear.csv"), folder)
    for path in REAL_TEST.iterdir():
        shutil.copy(path, folder)
    if not virgin:
        bearing, _, _ = (folder / "bearing.toml").read_text().partition("[scragging]")
        (folder / "bearing.toml").write_text(bearing)
        (folder / "Test_2D_shear.toml").write_text('bearing = "bearing.toml"')
    record = load_test(folder / "Test_2D_shear.csv")
    assert len(record.assumptions) == 2  # 30 mm/s, 23 degC
    assert record.bearing is not None
    return identify_bearing(record, record.bearing)


@pytest.mark.thorough
def test_real_hdr_test(tmp_path: Path, measured: Recorder) -> None:
    """No clock, no temperature, no plan size are given; only the rubber height of 156 mm is."""
    result = identified(tmp_path, virgin=False)
    (fit,) = result.fits
    measured("NRMSE of a real HDR test, no scragging", fit.NRMSE, f"<= {tol.MEASURED_NRMSE:g}")
    assert fit.NRMSE <= tol.MEASURED_NRMSE
    assert len(fit.loops) == 27  # the 28th is cut off by the end of the file
    worst = max(abs(c.errors["energy_error"]) for c in fit.loops)
    measured("largest energy error of a cycle of that test", worst, "reported, not limited")
    firsts = [round(c.amplitude / RUBBER, 1) for c in fit.loops if c.number == 1]
    assert firsts == [0.2, 0.5, 1.0, 1.5]
    output = "\n".join(result.warnings)
    for words in ("first cycles", "no column of time", "no ambient temperature"):
        assert words in output
    # Causes first: a drift of the zero of the force, and the first cycles; none of their effects.
    assert "drifts" in result.warnings[0]
    assert "first cycles" in result.warnings[1]
    assert len(result.warnings) <= 7  # one of them on m_T and n_T, which one temperature holds


@pytest.mark.thorough
def test_real_hdr_test_as_virgin_rubber(tmp_path: Path, measured: Recorder) -> None:
    """What scragging buys: the first cycles, the fall over the later ones, and the energies."""
    result = identified(tmp_path, virgin=True)
    (fit,) = result.fits
    energy = np.array([c.errors["energy_error"] for c in fit.loops])
    firsts = np.array([c.errors["force_max_error"] for c in fit.loops if c.number == 1])
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
    assert result.values["scragging.amplitude"] > 0.5
    assert result.values["scragging.mullins_amplitude"] == pytest.approx(0.19, abs=0.06)
