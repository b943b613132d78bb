"""Bad records are refused or warned of, with the reason; good ones are left in peace."""

import re
from dataclasses import replace

import numpy as np
import pytest

import thermobearing as tb
from thermobearing.border.errors import InputError
from thermobearing.identify.fit.synthetic import synthetic_record
from thermobearing.identify.records.checks import CheckReport, check_test
from thermobearing.identify.records.record import TestRecord, record_from_arrays
from thermobearing.identify.run import identify_bearing

BEARING = tb.load_bearing("shen-hdr-specimen")


@pytest.fixture(scope="module")
def good() -> TestRecord:
    test = tb.cyclic_test(strain=[0.5, 1.5], cycles=3, rest=600.0)
    return synthetic_record(BEARING, 23.0, test, noise=0.005)


def said(report: CheckReport, level: str) -> str:
    return "\n".join(f.sentence for f in report.findings if f.level == level)


def rows(record: TestRecord, kept: slice | np.ndarray) -> TestRecord:
    """Some samples of a record."""
    names = ("time", "displacement", "force", "block")
    return replace(record, **{name: getattr(record, name)[kept] for name in names})


def cut(record: TestRecord, stop: int) -> TestRecord:
    return rows(record, slice(stop))


def test_a_good_record_is_good(good: TestRecord) -> None:
    report = check_test(good, BEARING)
    assert report.outcome == "good", report.findings
    assert len([c for c in report.cycles if not c.closing]) == 6
    assert [c.number for c in report.cycles if not c.closing] == [1, 2, 3, 1, 2, 3]


def test_truncated(good: TestRecord) -> None:
    stop = int(np.argmax(good.displacement)) + 1
    assert "truncated" in said(check_test(cut(good, stop), BEARING), "warning")


def test_swapped_columns(good: TestRecord) -> None:
    swapped = replace(good, displacement=good.force, force=good.displacement)
    report = check_test(swapped, BEARING)
    assert "swapped" in said(report, "refused")
    with pytest.raises(InputError, match="swapped"):
        identify_bearing(swapped, BEARING)


def test_flipped_force(good: TestRecord) -> None:
    assert "flip_force" in said(check_test(replace(good, force=-good.force), BEARING), "refused")


def test_tonf_labelled_kilonewton(good: TestRecord) -> None:
    report = check_test(replace(good, force=good.force / 9.80665), BEARING)
    assert "tonf labelled kN" in said(report, "refused")


def test_kilonewton_labelled_tonf(good: TestRecord) -> None:
    report = check_test(replace(good, force=good.force * 9.80665), BEARING)
    assert "kN labelled tonf" in said(report, "refused")


def test_centimetres_labelled_metres(good: TestRecord) -> None:
    report = check_test(replace(good, displacement=100.0 * good.displacement), BEARING)
    assert "wrong unit" in said(report, "refused")


def test_one_cycle_only() -> None:
    test = tb.cyclic_test(strain=[1.0], cycles=1, closing_strain=None)
    record = synthetic_record(BEARING, 23.0, test, noise=0.0)
    assert "one cycle only" in said(check_test(record, BEARING), "warning")


def test_no_cycle(good: TestRecord) -> None:
    quarter = int(np.argmax(good.displacement[:60]))
    assert "no full cycle" in said(check_test(cut(good, quarter), BEARING), "refused")


@pytest.mark.parametrize("name", ["displacement", "force"])
def test_constant(good: TestRecord, name: str) -> None:
    still = replace(good, **{name: np.full(len(good.time), 3.0)})
    assert f"{name} is constant" in said(check_test(still, BEARING), "refused")


def test_clipped_force(good: TestRecord) -> None:
    limit = 0.85 * good.peak_force
    clipped = replace(good, force=np.clip(good.force, -limit, limit))
    report = check_test(clipped, BEARING)
    assert "clipped" in said(report, "warning")
    assert report.clipped.sum() > 10
    assert (np.abs(clipped.force[report.clipped]) == limit).all()


def test_drift_and_offset(good: TestRecord) -> None:
    ramp = np.linspace(0.0, 0.3, len(good.time)) * good.peak_force
    assert "drifts" in said(check_test(replace(good, force=good.force + ramp), BEARING), "warning")
    shifted = replace(good, force=good.force + 0.1 * good.peak_force)
    assert "force_offset" in said(check_test(shifted, BEARING), "warning")


def test_missing_samples(good: TestRecord) -> None:
    kept = np.ones(len(good.time), dtype=bool)
    kept[-300:-285] = False
    assert "no samples from" in said(check_test(rows(good, kept), BEARING), "warning")


def test_time_that_goes_back(good: TestRecord) -> None:
    time = good.time.copy()
    time[100] = time[50]
    assert "does not increase" in said(check_test(replace(good, time=time), BEARING), "refused")


def test_few_samples(good: TestRecord) -> None:
    report = check_test(rows(good, slice(None, None, 12)), BEARING)
    assert "only" in said(report, "refused") + said(report, "warning")


def test_far_too_few_samples(good: TestRecord) -> None:
    """Refused in words, although no cycle of so few samples can be measured."""
    every = round(len(good.time) / (6 * 6))
    report = check_test(rows(good, slice(None, None, every)), BEARING)
    assert "a cycle has only" in said(report, "refused")


def test_broken_thermocouple(good: TestRecord) -> None:
    broken = np.full(len(good.time), 850.0)
    record = replace(good, temperatures={"T": broken}, places={"T": "rubber 1"})
    assert "broken" in said(check_test(record, BEARING), "warning")


def test_force_clipped_below(good: TestRecord) -> None:
    limit = 0.7 * good.force.min()
    report = check_test(replace(good, force=np.maximum(good.force, limit)), BEARING)
    assert "clipped" in said(report, "warning")
    assert (good.force[report.clipped] <= limit).all()
    assert report.clipped.sum() > 10


@pytest.mark.parametrize("zero", [-1.6, 1.6])
def test_a_slight_zero_of_the_force_is_told(zero: float) -> None:
    """Before: 1.4 % of the peak passed without a word. In the cold, where every side is weaker."""
    steps = tb.cyclic_test(strain=[0.5, 1.0, 1.5], cycles=4, rest=None)
    cold = synthetic_record(BEARING, -20.0, steps, noise=0.01, seed=3)
    assert "no more than these cycles can tell" in said(check_test(cold, BEARING), "note")
    assert "offset" not in {finding.check for finding in check_test(cold, BEARING).findings}
    peak = cold.peak_force
    shifted = replace(cold, force=cold.force + zero / 160.0 * peak)
    told = said(check_test(shifted, BEARING), "warning")
    number = float(re.findall(r'force_offset = "(.*) kN"', told)[0])
    assert number == pytest.approx(zero / 160.0 * peak, rel=0.15)


@pytest.mark.parametrize(
    ("way", "force", "slip"),
    [
        (1.0, 1e3, "is force in N labelled kN (1.25 MPa)?"),
        (0.1, 1.0, "displacement in cm labelled mm (1.25 MPa)?"),
        (
            1.0,
            1.0 / 9.80665,
            "is force in tonf labelled kN (1.25 MPa) or displacement in mm labelled cm",
        ),
    ],
)
def test_a_wrong_unit_is_told_by_the_slip_behind_it(way: float, force: float, slip: str) -> None:
    """Before: "127 MPa if force is in kN labelled tonf?" for newtons, and that for centimetres."""
    t = np.linspace(0.0, 4.0, 2001)
    x = 60.0 * np.sin(np.pi * t)
    scale = 1.25 * BEARING.area / BEARING.total_rubber_thickness / 1e3
    f = scale * (x + 10.0 * np.cos(np.pi * t))
    f *= scale * 60.0 / np.abs(f).max()
    report = check_test(record_from_arrays(t, way * x, force * f, 23.0), BEARING)
    assert slip in said(report, "refused")


def test_offset_is_the_middle_of_the_middles(good: TestRecord) -> None:
    """One cycle of six that sits 30 % too high is no offset of the record."""
    force = good.force.copy()
    cycle = check_test(good, BEARING).cycles[1]
    force[cycle.first : cycle.last] += 0.3 * good.peak_force
    told = said(check_test(replace(good, force=force), BEARING), "warning")
    assert "middle of the force loops is at" not in told


def test_the_gravest_finding_is_the_outcome() -> None:
    report = CheckReport(synthetic_record(BEARING, 23.0, tb.cyclic_test(strain=[1.0])), [])
    for tell, outcome in (
        (report.note, "good"), (report.warn, "warning"), (report.refuse, "refused"),
    ):  # fmt: skip
        tell("x", "x")
        assert report.outcome == outcome
    report.warn("x", "x")
    assert report.outcome == "refused"


@pytest.mark.parametrize("memory", [0.0, 0.8])
def test_noise_of_a_synthetic_record(memory: float) -> None:
    """Its standard deviation is what was asked for, of the peak, however it is correlated."""
    test = tb.cyclic_test(strain=[1.0], cycles=5, rest=None)
    clean = synthetic_record(BEARING, 23.0, test, noise=0.0, sampling=200.0)
    noisy = synthetic_record(BEARING, 23.0, test, noise=0.02, memory=memory, sampling=200.0)
    noise = (noisy.force - clean.force) / clean.peak_force
    assert noise.std() == pytest.approx(0.02, rel=0.15)
    assert np.corrcoef(noise[1:], noise[:-1])[0, 1] == pytest.approx(memory, abs=0.1)
