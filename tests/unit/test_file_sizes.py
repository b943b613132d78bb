"""Files are as small as they can be without losing anything."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from numpy.testing import assert_allclose
from PIL import Image

import thermobearing as tb
from tests import tolerances as tol
from tests.quick import quick_cases
from thermobearing.results.drawing import DPI, save_figure
from thermobearing.results.writing import write_dataset

pytestmark = pytest.mark.drawn(fine=True)


@pytest.fixture(scope="module")
def result() -> tb.Result:
    test = tb.cyclic_test(strain=[0.5, 1.0], cycles=2, dt=0.01)
    return tb.run(
        "shen-lhdr-specimen", test, ambient=[-20.0, 23.0], keep=tb.Keep(histories="complete")
    )


def test_netcdf_is_compressed_without_loss(result: tb.Result, tmp_path: Path) -> None:
    path = tmp_path / "result.nc"
    write_dataset(result.dataset, path)
    assert xr.load_dataset(path, engine="netcdf4").identical(result.dataset)
    assert path.stat().st_size < 0.6 * result.dataset.nbytes


def test_history_has_the_digits_that_count(result: tb.Result, tmp_path: Path) -> None:
    result.save(tmp_path / "out", figures=False)
    table = pd.read_csv(tmp_path / "out" / "history.csv")
    assert len(table) == 2 * result.dataset.sizes["time"]
    assert_allclose(table["time_s"], np.tile(result.time(0), 2), rtol=tol.NINE_DIGITS)
    for column, name in (
        ("displacement_mm", "displacement"),
        ("force_kN", "force"),
        ("stress_MPa", "stress"),
        ("strain", "strain"),
        ("lead_degC", "lead_temperature"),
    ):
        assert_allclose(table[column], result[name].values.ravel(), rtol=tol.SEVEN_DIGITS)
    layers = result["rubber_temperature"].values
    for layer in range(layers.shape[2]):
        actual = table[f"rubber{layer + 1}_degC"]
        assert_allclose(actual, layers[:, :, layer].ravel(), rtol=tol.SEVEN_DIGITS)


@pytest.mark.parametrize("name", quick_cases(["loops", "layer_temperatures"], 0))
def test_figures_have_a_palette_and_look_the_same(
    name: str, result: tb.Result, tmp_path: Path
) -> None:
    full, small = tmp_path / "full.png", tmp_path / "small.png"
    getattr(result.plot, name)().savefig(full, dpi=DPI)
    save_figure(getattr(result.plot, name)(), small)
    assert small.stat().st_size < 0.5 * full.stat().st_size
    one, other = (
        np.asarray(Image.open(path).convert("RGB"), dtype=np.float64) for path in (full, small)
    )
    assert one.shape == other.shape
    apart = np.abs(one - other).max(axis=2)
    assert apart.mean() < tol.PALETTE_MEAN
    assert (apart > tol.PALETTE_FAR).mean() < tol.PALETTE_SHARE
