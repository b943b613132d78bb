"""The real cyclic test of a high damping rubber bearing, with what had to be assumed."""

import shutil
from pathlib import Path

from tests import tolerances as tol
from tests.conftest import Recorder
from tests.shared_data import shared_data
from tests.unit.inputs import GALLARDO
from thermobearing.identify.fit import identify_bearing
from thermobearing.identify.record import load_test
from thermobearing.identify.report import fits


def test_real_hdr_test(tmp_path: Path, measured: Recorder) -> None:
    """No clock, no temperature, no plan size are given; only the rubber height of 156 mm is."""
    shutil.copy(shared_data("bearing_tests/Test_2D_shear.csv"), tmp_path / "test.csv")
    (tmp_path / "bearing.toml").write_text(GALLARDO)
    (tmp_path / "test.toml").write_text('bearing = "bearing.toml"\n')
    record = load_test(tmp_path / "test.csv")
    assert len(record.assumptions) == 2  # 30 mm/s, 23 degC
    assert record.bearing is not None
    found = identify_bearing(record, record.bearing)
    (fit,) = fits(found)
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
