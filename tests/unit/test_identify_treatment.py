"""Loggers that run through rests, spikes, drift: found, told, and treated as the record says."""

from dataclasses import replace

import numpy as np
import pytest

import thermobearing as tb
from thermobearing.identify.figures import check_figure
from thermobearing.identify.fit.forward import ForwardModel
from thermobearing.identify.fit.synthetic import synthetic_record
from thermobearing.identify.records.checks import CheckReport, check_test
from thermobearing.identify.records.cycles import estimate_noise
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.records.treatment import (
    _find_rests,
    _find_spikes,
    _thin_rests,
    to_be_treated,
    treat,
)
from thermobearing.identify.run import identify_bearing

HDR = tb.load_bearing("shen-hdr-specimen")
TEST = tb.cyclic_test(strain=[0.5, 1.5], cycles=3, rest=300.0)
JITTER = 0.02  # [mm]


def logged(**changes: float) -> TestRecord:
    given = {"noise": 0.01, "jitter": JITTER, "sampling": 20.0, "through_rests": True} | changes
    return synthetic_record(HDR, 23.0, TEST, **given)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def record() -> TestRecord:
    return logged()


@pytest.fixture(scope="module")
def spiky(record: TestRecord) -> tuple[TestRecord, list[int]]:
    """Ten spikes of 300 kN, half of them while the bearing moves."""
    moving = np.flatnonzero(np.abs(np.gradient(record.displacement)) > 0.5)
    still = np.flatnonzero(np.abs(np.gradient(record.displacement)) < 0.1)
    rng = np.random.default_rng(1)
    at = sorted([*rng.choice(moving, 5, replace=False), *rng.choice(still, 5, replace=False)])
    force = record.force.copy()
    force[at] += 300.0 * rng.choice([-1.0, 1.0], size=len(at))
    return replace(record, force=force), [int(k) for k in at]


def said(report: CheckReport, level: str, check: str) -> str:
    found = [f.sentence for f in report.findings if f.level == level and f.check == check]
    return "\n".join(found)


@pytest.mark.parametrize("points", [40, 200, 2000])
def test_noise_is_measured_beside_the_motion(points: int) -> None:
    """A sine of so many samples a cycle, with noise of 1e-3 of its amplitude, and with none."""
    t = np.arange(10 * points) / points
    motion = 50.0 * np.sin(2.0 * np.pi * t)
    noisy = motion + np.random.default_rng(0).normal(0.0, 0.05, len(t))
    assert estimate_noise(noisy) == pytest.approx(0.05, rel=0.15)
    assert estimate_noise(motion) < 1e-4


def test_rests_are_where_nothing_moves(record: TestRecord) -> None:
    (rest,) = _find_rests(record)
    begin, end = record.time[rest[0]], record.time[rest[1]]
    clean = synthetic_record(HDR, 23.0, TEST, noise=0.0)
    moved = np.flatnonzero(np.abs(np.diff(clean.displacement)) > 1e-9)
    gap = int(np.argmax(np.diff(clean.time[moved])))
    assert begin == pytest.approx(clean.time[moved[gap] + 1], abs=0.2)
    assert end == pytest.approx(clean.time[moved[gap + 1]], abs=0.2)


@pytest.mark.parametrize("period", [0.5, 10.0, 2000.0])
def test_slow_turns_are_no_rests(period: float) -> None:
    t = np.linspace(0.0, 4.0, 4001) * period
    x = 50.0 * np.sin(2.0 * np.pi * t / period)
    x = x + np.random.default_rng(0).normal(0.0, JITTER, len(t))
    assert _find_rests(tb.record_from_arrays(t, x, 2.0 * x, 23.0)) == []


def test_a_slow_creep_is_not_held_as_one_rest() -> None:
    t = np.linspace(0.0, 1000.0, 10001)
    x = np.where(t < 20.0, 50.0 * np.sin(np.pi * t / 5.0), 0.005 * (t - 20.0))
    record = tb.record_from_arrays(t, x, 2.0 * x, 23.0)
    assert all(np.ptp(x[a : b + 1]) <= 0.004 * 50.0 + 1e-9 for a, b in _find_rests(record))


def test_a_fit_sees_a_rest_as_a_gap(record: TestRecord) -> None:
    found = treat(record)
    short, left_out = found.to_fit(np.zeros(len(record.time), dtype=bool))
    ((first, last),) = found.rests
    assert len(short.time) == len(record.time) - (last - first + 1) + 2
    assert int(left_out.sum()) == 2
    a, b = np.flatnonzero(left_out)
    assert short.displacement[a] == short.displacement[b]
    assert short.displacement[a] == pytest.approx(0.0, abs=0.1 * JITTER)
    assert short.time[b] - short.time[a] == pytest.approx(record.time[last] - record.time[first])


def test_thermocouples_of_a_rest_are_kept(record: TestRecord) -> None:
    """Cooling is what a rest tells."""
    cooling = replace(record, temperatures={"T": 23.0 + 9.0 * np.exp(-record.time / 100.0)})
    rests = _find_rests(record)
    short, kept, resting = _thin_rests(cooling, rests)
    assert 15 <= int(resting.sum()) <= 20
    assert np.abs(short.temperatures["T"] - cooling.temperatures["T"][kept]).max() < 0.5


@pytest.mark.parametrize("fine", [True, False], ids=["fine", "coarse"])
def test_jitter_does_not_walk_the_force_down(fine: bool) -> None:
    """The model through a whole record with jitter is that through the motion alone."""
    noisy, clean = (logged(noise=0.0, jitter=jitter) for jitter in (JITTER, 0.0))
    forces = []
    for record in (noisy, clean):
        predicted = ForwardModel(record, HDR, fine=fine).run(HDR)
        assert predicted is not None
        forces.append(predicted.force)
    loading = np.abs(np.gradient(clean.displacement)) > 0.5
    off = np.abs(forces[0] - forces[1]).max(where=loading, initial=0.0)
    assert off < 0.03 * clean.peak_force
    ((first, last),) = _find_rests(noisy)
    middle = slice(first + 20, last - 20)
    assert np.ptp(forces[0][middle]) < 0.01 * clean.peak_force


def test_a_logger_that_runs_through_rests(record: TestRecord) -> None:
    """Read as motion, the rests of this record gave R2 = 0.1, and no word of it."""
    found = identify_bearing(record, HDR, starts=1)
    assert found.outcome == "completed"
    assert found.fits[0].R2 > 0.99
    assert found.values["hysteresis.layer_stiffness"] == pytest.approx(30.738, rel=0.05)
    told = found.summary()["records"][0]["treatment"]
    assert told["rests"] == 1
    assert told["noise"]["displacement_mm"] == pytest.approx(JITTER, rel=0.1)


def test_spikes_are_found_one_by_one(spiky: tuple[TestRecord, list[int]]) -> None:
    record, at = spiky
    report = check_test(record, HDR)
    assert np.flatnonzero(treat(record).spikes["force"]).tolist() == at
    assert "10 spikes in the force, the largest 3" in said(report, "warning", "spikes")
    assert "despike = true" in said(report, "warning", "spikes")
    assert "offset" not in {finding.check for finding in report.findings}
    assert "dots: spikes" in check_figure(report).axes[0].get_title(loc="left")


def test_spikes_of_the_displacement(record: TestRecord) -> None:
    x = record.displacement.copy()
    x[[200, 400]] += 30.0
    spoilt = replace(record, displacement=x)
    assert np.flatnonzero(treat(spoilt).spikes["displacement"]).tolist() == [200, 400]
    assert len(treat(spoilt).rests) == 1
    cured = treat(replace(spoilt, despike=True)).cleaned
    assert cured.peak_displacement < 46.0


@pytest.mark.parametrize("name", ["shen-hdr-specimen", "shen-lhdr-specimen", "lrb-example"])
@pytest.mark.parametrize("sampling", [10.0, 50.0])
def test_good_records_have_no_spikes_and_no_drift(name: str, sampling: float) -> None:
    test = tb.cyclic_test(strain=[0.5, 1.5, 2.5], cycles=2, wave="sine", rest=60.0)
    found = treat(synthetic_record(name, -20.0, test, sampling=sampling))
    assert not any(flags.any() for flags in found.spikes.values())
    assert not found.drifts


def test_spikes_are_taken_out_only_when_told(spiky: tuple[TestRecord, list[int]]) -> None:
    record, at = spiky
    left, none = treat(record).to_fit(np.zeros(len(record.time), dtype=bool))
    assert left.peak_force > 250.0
    assert not none[np.abs(left.force) > 200.0].any()
    (told,) = to_be_treated([record], True, "")
    report = check_test(told, HDR)
    assert "removed" in said(report, "note", "spikes")
    assert report.treatment is not None
    assert report.treatment.cleaned.peak_force < 150.0
    found = identify_bearing(replace(record, despike=True), HDR, starts=1)
    assert found.fits[0].R2 > 0.99
    assert identify_bearing(record, HDR, starts=1).outcome == "poor_fit"
    assert len(at) == 10


def drifting(record: TestRecord, name: str, part: float, detrend: str = "") -> TestRecord:
    values = getattr(record, name)
    off = part * np.abs(values).max() * record.time / record.time[-1]
    return replace(record, detrend=detrend, **{name: values + off})


@pytest.mark.parametrize("name", ["force", "displacement"])
def test_drift_is_found_and_taken_out_when_told(record: TestRecord, name: str) -> None:
    spoilt = drifting(record, name, 0.08)
    report = check_test(spoilt, HDR)
    assert f"the zero of the {name} drifts by" in said(report, "warning", "drift")
    assert treat(spoilt).cleaned.force[-50:].mean() == spoilt.force[-50:].mean()
    told = treat(drifting(record, name, 0.08, detrend=name))
    off = getattr(told.cleaned, name) - getattr(treat(record).cleaned, name)
    peak = float(np.abs(getattr(record, name)).max())
    assert np.abs(off).max() < 0.025 * peak
    assert "removed" in said(check_test(told.record, HDR), "note", "drift")


def test_detrend_takes_known_words_only(record: TestRecord) -> None:
    with pytest.raises(tb.InputError, match='detrend = "forc"'):
        to_be_treated([record], False, "forc")


def test_a_flat_signal_has_no_spikes() -> None:
    assert not _find_spikes(np.ones(50)).any()
