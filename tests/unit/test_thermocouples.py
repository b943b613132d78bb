"""Thermocouples beside the model: figure, table and CSV of a fit and of a validation."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.identify.fit.forward import ForwardModel
from thermobearing.identify.records.record import TestRecord

BEARING = "shen-hdr-specimen"


@pytest.fixture(scope="module")
def record() -> TestRecord:
    """A test whose thermocouple rises by a tenth less than the model, and a column not used."""
    test = tb.cyclic_test(strain=[1.5], cycles=3, rest=None)
    made = tb.synthetic_record(BEARING, 0.0, test)
    placed = replace(made, places={"T3, inside": "rubber 2"}, unused=("counter",))
    model = ForwardModel(placed, tb.load_bearing(BEARING)).run()
    assert model is not None
    rise = model.temperatures["T3, inside"] - model.temperatures["T3, inside"][0]
    return replace(placed, temperatures={"T3, inside": 0.9 * rise})


@pytest.mark.parametrize("command", ["identify", "validate"])
def test_beside_the_model(
    record: TestRecord, command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if command == "identify":
        fit = tb.identify_bearing(record, BEARING, free=["K_r"], starts=1)
        fit.save(tmp_path / "out")
        fit.show()
        listed = fit.summary()["records"][0]
    else:
        found = tb.validate_bearing(BEARING, record)
        found.save(tmp_path / "out")
        found.show()
        listed = found.summary()["comparisons"][0]
    assert listed["unused_columns"] == ["counter"]
    (row,) = pd.read_csv(tmp_path / "out" / "thermocouples.csv").to_dict("records")
    assert (row["thermocouple"], row["place"]) == ("T3, inside", "rubber 2")
    assert_allclose(row["rise_error"], 1.0 / 0.9 - 1.0, rtol=tol.FITTED_RISE)
    samples = pd.read_csv(tmp_path / "out" / "fit.csv")
    assert_allclose(samples["T3, inside"], record.temperatures["T3, inside"], rtol=tol.SEVEN_DIGITS)
    assert_allclose(
        samples["model_T3, inside"].max(), row["highest_model_degC"], rtol=tol.SEVEN_DIGITS
    )
    assert (tmp_path / "out" / "figures" / "temperatures.png").stat().st_size > 1000
    told = capsys.readouterr().out
    assert "columns not used: counter" in told
    assert "hermocouples, model compared with test" in told
    assert np.isfinite(row["rms_difference_K"])
