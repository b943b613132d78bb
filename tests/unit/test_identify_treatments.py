"""What was done to records before their fit: numbers in summaries, and the words of documents."""

import hashlib
import re
from pathlib import Path

import numpy as np
import pytest

import thermobearing as tb
from thermobearing.cyclic.tables import measured_table
from thermobearing.identify.comparison import LIMITS, Comparison, limit_source
from thermobearing.identify.fit.forward import ForwardModel, Prediction
from thermobearing.identify.fit.parameters import parameter_set
from thermobearing.identify.fit.problem import Problem
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


SENSOR = "Gummi 1 [°C]"
TITLES = ["time [s]", "displacement [mm]", "force [kN]", "Kammer [°C]", SENSOR]
WARMING = 6.0  # of the sensor over the test [K]


def with_cells(
    folder: Path, record: TestRecord, cells: dict[int, dict[int, str]], keys: str = ""
) -> Path:
    """Write a record with chamber and thermocouple; `cells` replaces texts by column and sample."""
    rise = WARMING * np.arange(len(record.time)) / (len(record.time) - 1)
    columns = [record.time, record.displacement, record.force, 23.0 + 0.0 * rise, 23.0 + rise]
    texts = [[f"{value:.6f}" for value in values] for values in columns]
    for column, changed in cells.items():
        for sample, text in changed.items():
            texts[column][sample] = text
    rows = [";".join(TITLES), *(";".join(row) for row in zip(*texts, strict=True))]
    file = folder / "gaps.csv"
    file.write_text("\n".join(rows) + "\n", encoding="utf-8")
    sidecar = f'{keys}\n[thermocouples]\n"{SENSOR}" = "rubber 1"\n'
    file.with_suffix(".toml").write_text(sidecar, encoding="utf-8")
    return file


@pytest.mark.parametrize("text", ["", "NaN", "nan", "---", "--", "-", "n/a", "NA", "#N/V", "#N/A"])
def test_missing_temperatures_are_left_out_and_counted(
    tmp_path: Path, smooth: TestRecord, text: str
) -> None:
    """Three readings of a thermocouple and two of the chamber, its first one among them."""
    gaps = {4: {7: text, 100: text, 101: text}, 3: {0: text, 50: text}}
    file = with_cells(tmp_path, smooth, gaps)
    record = tb.load_test(file)
    sensor = record.temperatures[SENSOR]
    assert np.flatnonzero(np.isnan(sensor)).tolist() == [7, 100, 101]
    assert (record.ambient, record.air_offset) == (23.0, 0.0)
    assert record.digests[str(file)] == hashlib.sha256(file.read_bytes()).hexdigest()
    sentences = [f.sentence for f in check_test(record).findings if f.check == "gaps"]
    assert [re.findall(r"\d+ readings|line \d+", one) for one in sentences] == [
        ["2 readings", "line 2"],
        ["3 readings", "line 9"],
    ]
    treated = summary(record)
    counts = treated["treatment"]["missing_readings"]
    assert counts[SENSOR] == {"readings": 3, "filled": False}
    assert counts["Kammer [°C]"] == {"readings": 2, "filled": True}
    (sentence,) = describe_treatments([treated])
    assert f"3 missing readings of {SENSOR}" in sentence
    assert "missing_readings" in {c.name for c in treatment_table([treated]).columns}
    notes = measure_cycles(file, tb.load_bearing("shen-hdr-specimen")).notes
    assert set(sentences) <= set(notes)


def test_a_comparison_leaves_missing_readings_out(tmp_path: Path, smooth: TestRecord) -> None:
    """A model that is 1 K too warm is 1 K too warm, and a calibration sees no error in a gap."""
    record = tb.load_test(with_cells(tmp_path, smooth, {4: {0: "---", 200: "---", 201: ""}}))
    sensor = record.temperatures[SENSOR]
    ramp = 23.0 + WARMING * np.arange(len(sensor)) / (len(sensor) - 1)
    prediction = Prediction(record.force, {SENSOR: ramp + 1.0})
    (row,) = Comparison(record, "b", "m", 100.0, prediction).thermocouples
    assert row["rms_difference_K"] == pytest.approx(1.0, abs=1e-5)
    assert row["rise_error"] == pytest.approx(0.0, abs=1e-5)
    bearing = tb.load_bearing("shen-hdr-specimen")
    pset = parameter_set(bearing, ["K_r"], [])
    problem = Problem([record], pset, temperatures=True)
    (weight,) = problem.weights
    rows = problem._weighted(record, weight, prediction)
    parts = rows[len(sensor) :]
    assert np.flatnonzero(parts == 0.0).tolist() == [0, 200, 201]
    short, _ = treat(record).to_fit(np.zeros(len(sensor), dtype=bool))
    assert np.isnan(short.temperatures[SENSOR]).sum() <= 3


def test_too_many_missing_readings_are_refused(tmp_path: Path, smooth: TestRecord) -> None:
    """More than half of the samples, or a gap of more than a tenth of the test."""
    count = len(smooth.time)
    half = dict.fromkeys(range(1, count, 2), "") | dict.fromkeys(range(0, count, 4), "")
    long = dict.fromkeys(range(20, 20 + count // 9), "")
    allowed = dict.fromkeys(range(20, 20 + count // 11), "")
    for cells, line in ((half, "line 2"), (long, "line 22")):
        with pytest.raises(tb.InputError) as refused:
            tb.load_test(with_cells(tmp_path, smooth, {4: cells}))
        for piece in ("gaps.csv", line, SENSOR, str(len(cells)), "[thermocouples]"):
            assert piece in str(refused.value)
        with pytest.raises(tb.InputError, match="ambient = "):
            tb.load_test(with_cells(tmp_path, smooth, {3: cells}))
        # A stated temperature is the cure; the column of the chamber is then left out.
        stated = with_cells(tmp_path, smooth, {3: cells}, 'ambient = "23 degC"')
        assert any(line in text for text in tb.load_test(stated).assumptions)
    assert tb.load_test(with_cells(tmp_path, smooth, {4: allowed})).gaps[0].missing == len(allowed)
    for column in (1, 2):
        with pytest.raises(tb.InputError, match=r"line 9, .*only temperatures"):
            tb.load_test(with_cells(tmp_path, smooth, {column: {7: "---"}}))
