"""What was done to records before their fit: numbers in summaries, and the words of documents."""

import re
from pathlib import Path

import numpy as np
import pytest

import thermobearing as tb
from thermobearing.cyclic.tables import measured_table
from thermobearing.identify.comparison import LIMITS, limit_source
from thermobearing.identify.fit.forward import ForwardModel
from thermobearing.identify.misfit import FORCE, describe_differences
from thermobearing.identify.records.checks import check_test
from thermobearing.identify.records.measured import _draw_loops, measure_cycles
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.records.treatment import treat
from thermobearing.identify.treatments import (
    REST_AND_JITTER,
    describe_treatments,
    motion_notes,
    treatment_table,
)

AMPLITUDE = 52.5  # [mm]
PERIOD, RATE = 7.0, 20.0  # [s], [Hz]: no sample is at a turn
CYCLES = 3


def moved(time: np.ndarray, x: np.ndarray) -> TestRecord:
    return tb.record_from_arrays(time, x, 2.0 * x + 20.0 * np.sign(np.gradient(x)), 23.0, name="a")


@pytest.fixture
def cut() -> TestRecord:
    """Triangular cycles, whose turns are between two samples."""
    time = np.arange(0.0, CYCLES * PERIOD, 1.0 / RATE) + 0.013
    phase = np.mod(time / PERIOD + 0.25, 1.0)
    return moved(time, AMPLITUDE * (1.0 - 4.0 * np.abs(phase - 0.5)))


@pytest.fixture
def smooth() -> TestRecord:
    """Cycles of a sine, whose turns are rounded."""
    time = np.arange(0.0, CYCLES * PERIOD, 1.0 / RATE)
    return moved(time, AMPLITUDE * np.sin(2.0 * np.pi * time / PERIOD))


def summary(record: TestRecord) -> dict:
    return {"name": record.name, "treatment": treat(record).summary()}


def test_turns_that_are_added_are_stated_with_the_displacement_that_they_change(
    cut: TestRecord,
) -> None:
    treated = summary(cut)
    treatment, largest = treated["treatment"], float(np.abs(cut.displacement).max())
    assert treatment["turns_added"] == 2 * CYCLES
    assert treatment["largest_displacement_mm"] == pytest.approx(AMPLITUDE, rel=1e-9)
    assert treatment["largest_sample_mm"] == largest < AMPLITUDE
    # What the model follows has these turns.
    steps = ForwardModel(cut, tb.load_bearing("shen-hdr-specimen"), fine=True)._grid.x
    assert len(steps) - len(cut.time) == treatment["turns_added"]
    assert np.abs(steps).max() == pytest.approx(treatment["largest_displacement_mm"])
    (sentence,) = describe_treatments([treated])
    assert sentence.startswith("a: 6 turning points")
    change = 100.0 * (AMPLITUDE / largest - 1.0)
    numbers = [float(text) for text in re.findall(r"[-+]?\d+\.\d+", sentence)]
    assert numbers == [
        AMPLITUDE,
        pytest.approx(largest, abs=0.01),
        pytest.approx(change, abs=0.01),
    ]
    assert len(motion_notes([treated])) == 1
    table = treatment_table([treated])
    (row,) = table.rows
    cells = dict(zip((column.name for column in table.columns), row, strict=True))
    assert cells["turns_added"] == 6
    assert cells["largest_change"] == pytest.approx(change)


def test_only_a_record_without_any_change_is_used_as_recorded(smooth: TestRecord) -> None:
    treated = summary(smooth)
    treatment = treated["treatment"]
    assert treatment["turns_added"] == 0
    assert treatment["largest_displacement_mm"] == treatment["largest_sample_mm"]
    assert describe_treatments([treated]) == ["a: used as recorded."]
    assert motion_notes([treated]) == []
    for key, value in (("rests", 1), ("dead_band_mm", 0.2)):
        changed = {**treated, "treatment": treatment | {key: value}}
        assert describe_treatments([changed]) == [f"a: {REST_AND_JITTER}."]
    clipped = {**treated, "treatment": treatment | {"clipped_samples": 12}}
    weighted = {**treated, "conditions": {"weight": 1.0, "first_cycle_weight": 0.0}}
    for changed, words in ((clipped, "12 clipped"), (weighted, "weight of first cycles 0")):
        (sentence,) = describe_treatments([changed])
        assert sentence.startswith(f"a: {words}")


def test_a_chamber_is_at_its_beginning_for_the_bearing_and_at_its_mean_for_the_air(
    tmp_path: Path, smooth: TestRecord
) -> None:
    """A hump of the chamber during the test is no temperature of the soaked specimen."""
    chamber = 23.0 + 0.5 * np.sin(np.pi * smooth.time / smooth.time[-1])
    columns = (smooth.time, smooth.displacement, smooth.force, chamber)
    np.savetxt(
        tmp_path / "hump.csv",
        np.column_stack(columns),
        delimiter=",",
        header="time_s,displacement_mm,force_kN,chamber_degC",
        comments="",
    )
    record = tb.load_test(tmp_path / "hump.csv")
    mean = float(chamber.mean())
    assert record.ambient == pytest.approx(23.0, abs=0.02)
    assert record.ambient + record.air_offset == pytest.approx(mean, abs=0.006)
    bearing = tb.load_bearing("shen-hdr-specimen")
    model = ForwardModel(record, bearing)
    assert np.unique(model._initial).tolist() == [record.ambient]
    assert model._ambient.at(0.0) == pytest.approx(mean, abs=0.006)
    (stated,) = (f.sentence for f in check_test(record).findings if f.check == "ambient")
    assert f"{record.ambient:.4g} degC when the test begins" in stated
    assert f"{record.ambient + record.air_offset:.4g} degC on average" in stated
    # A prediction is at one temperature.
    assert ForwardModel(record, bearing, ambient=-30.0)._ambient.at(0.0) == -30.0


def test_a_misfit_is_stated_with_its_signal_test_size_and_noise() -> None:
    """One of two tests is noisy, the other has a force that is 5 % too large."""
    test = tb.cyclic_test(strain=[1.0], cycles=2, rest=None)
    pair = [
        tb.synthetic_record("shen-hdr-specimen", at, test, noise=noise, seed=1)
        for at, noise in ((23.0, 0.01), (-10.0, 0.001))
    ]
    noisy, other = pair
    times = np.where(other.displacement > 0.0, 1.05, 1.0)
    wrong = tb.record_from_arrays(
        other.time, other.displacement, times * other.force, -10.0, name="wrong"
    )
    calibration = tb.identify_bearing([noisy, wrong], "shen-hdr-specimen", free=["K_r"], starts=1)
    forces = {item.test: item for item in calibration.differences if item.signal == FORCE}
    assert forces["wrong"].times_noise > 3.0
    assert forces[noisy.name].times_noise < 2.0
    error = calibration.predictions[1].force - wrong.force
    assert forces["wrong"].rms == pytest.approx(float(error.std()), rel=0.02)
    assert forces["wrong"].noise == pytest.approx(0.001 * wrong.peak_force, rel=0.5)
    assert "wrong" in describe_differences(calibration.differences)
    assert calibration.summary()["difference"] == describe_differences(calibration.differences)


def test_measured_strains_are_one_number(cut: TestRecord, tmp_path: Path) -> None:
    """In the table, the file and the title of the figure: that of the turns, not of the samples."""
    np.savetxt(
        tmp_path / "cut.csv",
        np.column_stack((cut.time, cut.displacement, cut.force)),
        delimiter=",",
        header="time_s,displacement_mm,force_kN",
        comments="",
    )
    measured = measure_cycles(tmp_path / "cut.csv", tb.load_bearing("shen-hdr-specimen"))
    assert measured.strains == pytest.approx([AMPLITUDE / 30.0] * len(measured.strains), rel=1e-6)
    assert measured.table["strain"].tolist() == measured.strains
    assert all(cycle.amplitude_mm < AMPLITUDE - 0.1 for cycle in measured.measures)
    cut_by = max(AMPLITUDE / cycle.amplitude_mm - 1.0 for cycle in measured.measures)
    assert sum(f"+{100.0 * cut_by:.1f} %" in note for note in measured.notes) == 1
    axes = _draw_loops(measured).axes
    (title,) = (ax.get_title(loc="left") or ax.get_title() for ax in axes if ax.axison)
    assert title.startswith("175 %:")
    table = measured_table(measured.measures, measured.ends, measured.strains)
    assert {row[1] for row in table.texts()} == {"175.0"}


def test_limits_of_errors_have_a_source() -> None:
    assert limit_source("K_eq", LIMITS["K_eq"]) != limit_source("K_eq", 0.1)
    assert limit_source("energy", 0.15) == limit_source("K_eq", 0.1)
