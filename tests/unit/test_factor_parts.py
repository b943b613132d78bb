"""Temperature factors and sizes by hand: the runs inside are replaced by known numbers."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.design import bounds, factors, run
from thermobearing.design import factors as scale
from thermobearing.design import sizing as equal

LHDR = tb.load_bearing("shen-lhdr-bridge")


def measured_of(
    bearing: Any, air: list[float], strain: float, *_: Any
) -> tuple[pd.DataFrame, list[Any]]:
    """Values that are 1 at 23 degC and more in the cold, the more the larger the plan."""
    rows = [
        {"strain": strain, "basis": "first", "ambient_degC": t, "quantity": "K_eq", "unit": "",
         "value": 2.0 * (1.0 + (t < 0.0) * bearing.area / 1e6)}
        for t in air
    ]  # fmt: skip
    return pd.DataFrame(rows), []


def test_band_of_several_bearings_is_from_5_to_95_percent(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(factors, "_measured", measured_of)
    sides = np.linspace(400.0, 600.0, 21)
    bearings = [equal._with_side(tb.load_bearing("shen-hdr-bridge"), side, 6) for side in sides]
    options = {"reference_temperature": 23.0, "temperatures": [-20.0], "strains": [1.0]}
    table = factors.temperature_factors(bearings, **options)  # type: ignore[arg-type]
    cold = table[table["ambient_degC"] == -20.0].iloc[0]
    low, high = np.quantile(1.0 + sides**2 / 1e6, [0.05, 0.95])
    assert cold["factor"] == pytest.approx(1.16)  # of the first bearing
    assert cold["value"] == pytest.approx(2.32)
    assert (cold["factor_low"], cold["factor_high"]) == pytest.approx((low, high))
    warm = table[table["ambient_degC"] == 23.0].iloc[0]
    assert (warm["factor"], warm["factor_low"], warm["factor_high"]) == (1.0, 1.0, 1.0)
    alone = factors.temperature_factors(bearings[0], **options)  # type: ignore[arg-type]
    assert alone["factor_low"].isna().all()


def test_first_heated_and_mean_cycles(monkeypatch: pytest.MonkeyPatch) -> None:
    """Four cycles are run, numbers 2 and 4 were chosen."""
    cycles = pd.DataFrame(
        {
            "ambient_degC": 0.0,
            "cycle": [1, 2, 3, 4],
            "G_eq_MPa": [4.0, 3.0, 2.5, 2.0],
            "characteristic_strength_kN": [40.0, 30.0, 25.0, 20.0],
            "post_yield_stiffness_kN_mm": [1.4, 1.3, 1.25, 1.2],
            "h_eq": [0.2, 0.19, 0.18, 0.17],
            "energy_kN_mm": [400.0, 300.0, 250.0, 200.0],
        }
    )
    asked: list[Any] = []

    def fake(bearing: Any, test: Any, air: Any, **_: Any) -> Any:
        asked.append(test)
        return SimpleNamespace(outcome="completed", cycles=cycles, tested_range=pd.DataFrame())

    monkeypatch.setattr(factors, "run", fake)
    bearing = tb.load_bearing("shen-hdr-bridge")
    table, _ = factors._measured(bearing, [0.0], 1.0, 2.0, (2, 4), {})
    assert asked[0].steps[0].count == 4
    values = table.pivot_table(index="quantity", columns="basis", values="value")
    scale_to_stiffness = bearing.area / bearing.total_rubber_thickness / 1e3
    for quantity, wanted in (
        ("K_eq", np.array([4.0, 2.0, 2.5]) * scale_to_stiffness), ("Q_d", [40.0, 20.0, 25.0]),
        ("K_d", [1.4, 1.2, 1.25]), ("h_eq", [0.2, 0.17, 0.18]), ("energy", [400.0, 200.0, 250.0]),
    ):  # fmt: skip
        assert_allclose(values.loc[quantity, ["first", "heated", "mean"]], wanted, rtol=tol.LOOP)


def test_presets_of_cycles() -> None:
    assert factors._chosen_cycles("2-11") == (2, 3, 4, 5, 6, 7, 8, 9, 10, 11)
    assert factors._chosen_cycles("all-but-first") == (2, 3, 4, 5)
    assert factors._chosen_cycles("3") == (3,)
    assert factors._chosen_cycles([4, 2, 4]) == (2, 4)


def test_period_from_a_speed_is_that_of_each_strain(monkeypatch: pytest.MonkeyPatch) -> None:
    """Once there and back and there again: 4 a / v, a = 102 mm times the strain."""
    asked: list[float] = []

    def table(bearings: Any, *, strains: list[float], period: float, **_: Any) -> pd.DataFrame:
        asked.append(period)
        found = pd.DataFrame({"strain": strains, "ambient_degC": 23.0})
        found.attrs["tested_range"] = []
        return found

    monkeypatch.setattr(factors, "temperature_factors", table)
    bearing = tb.load_bearing("shen-hdr-bridge")
    found = factors.factors_at_speed([bearing], speed=51.0, strains=[1.0, 1.75])
    assert_allclose(asked, [8.0, 14.0])
    assert found["strain"].tolist() == [1.0, 1.75]


def test_study_of_sizes_reads_its_histories_at_the_right_times(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Layers that warm by 1 and 2 mK a second: after 10 s, 70 s and 610 s from -20 degC."""
    time = np.arange(0.0, 3610.0, 0.5)
    layers = -20.0 + np.column_stack([0.001 * time, 0.0015 * time, 0.002 * time])
    values = {
        "rubber_temperature": SimpleNamespace(values=layers[np.newaxis]),
        "lead_temperature": SimpleNamespace(values=(-20.0 + 0.01 * time)[np.newaxis]),
    }

    class Fake:
        has_lead = True
        cycles = pd.DataFrame({"stress_max_MPa": [2.0, 1.8, 1.7, 1.6, 1.5]})

        def time(self, run: int) -> np.ndarray:
            return time

        def __getitem__(self, name: str) -> Any:
            return values[name]

    monkeypatch.setattr(scale, "run", lambda *_, **__: Fake())
    row = scale.scale_study(LHDR, [1.0])[0].iloc[0]
    for name, at in (("at_end", 10.0), ("after_1_min", 70.0), ("after_10_min", 610.0)):
        assert row[f"outer_{name}_K"] == pytest.approx(0.001 * at)
        assert row[f"inner_{name}_K"] == pytest.approx(0.002 * at)
        assert row[f"lead_{name}_K"] == pytest.approx(0.01 * at)
    assert row["stress_cycle_5_over_1"] == 0.75


@pytest.mark.parametrize(("given", "used"), [(None, 23.0), (5.0, 5.0)])
def test_reference_is_that_of_the_rubber(
    given: float | None, used: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: dict[str, Any] = {}
    monkeypatch.setattr(run, "temperature_factors", lambda _, **options: asked.update(options))
    report = run.run_factors(["shen-hdr-bridge", "shen-lhdr-bridge"], reference=given)
    assert (asked["reference_temperature"], report.reference) == (used, used)
    assert (asked["period"], report.motion) == (2.0, "sine of 2 s")
    assert [bearing.name for bearing in report.bearings] == ["shen-hdr-bridge", "shen-lhdr-bridge"]


def test_bounds_are_shaken_by_the_motions_of_hard_ground() -> None:
    assert bounds.first_motions() == [
        f"jra-{kind}-i-{seed}" for kind in ("i", "ii") for seed in (1, 2, 3)
    ]
