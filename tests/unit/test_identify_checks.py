"""Bad records are refused or warned about, with the reason; good ones pass."""

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import thermobearing as tb
from thermobearing.border.errors import InputError
from thermobearing.identify.fit.synthetic import synthetic_record
from thermobearing.identify.records.checks import CheckReport, check_test
from thermobearing.identify.records.record import TestRecord, record_from_arrays
from thermobearing.identify.records.treatment import Finding
from thermobearing.identify.run import identify_bearing

BEARING = tb.load_bearing("shen-hdr-specimen")


@pytest.fixture(scope="module")
def good() -> TestRecord:
    test = tb.cyclic_test(strain=[0.5, 1.5], cycles=3, rest=600.0)
    return synthetic_record(BEARING, 23.0, test, noise=0.005)


def said(report: CheckReport, level: str) -> str:
    return "\n".join(f.sentence for f in report.findings if f.level == level)


def found(report: CheckReport) -> set[tuple[str, str]]:
    return {(finding.level, finding.check) for finding in report.findings}


def rows(record: TestRecord, kept: slice | np.ndarray) -> TestRecord:
    """Some samples of a record."""
    names = ("time", "displacement", "force", "block")
    return replace(record, **{name: getattr(record, name)[kept] for name in names})


def without(record: TestRecord, part: slice) -> TestRecord:
    kept = np.ones(len(record.time), dtype=bool)
    kept[part] = False
    return rows(record, kept)


def back_in_time(record: TestRecord) -> TestRecord:
    time = record.time.copy()
    time[100] = time[50]
    return replace(record, time=time)


def scaled(record: TestRecord, way: float = 1.0, force: float = 1.0) -> TestRecord:
    return replace(record, displacement=way * record.displacement, force=force * record.force)


def plus(record: TestRecord, force: np.ndarray | float) -> TestRecord:
    return replace(record, force=record.force + force * record.peak_force)


def test_a_good_record_is_good(good: TestRecord) -> None:
    report = check_test(good, BEARING)
    assert report.outcome == "good", report.findings
    assert [c.number for c in report.cycles if not c.closing] == [1, 2, 3, 1, 2, 3]


SWAP: Callable[[TestRecord], TestRecord] = lambda r: replace(  # noqa: E731
    r, displacement=r.force, force=r.displacement
)
BROKEN = {"places": {"T": "rubber 1"}}
BAD: dict[str, tuple[Callable[[TestRecord], TestRecord], str, str, str]] = {
    "truncated": (
        lambda r: rows(r, slice(int(np.argmax(r.displacement)) + 1)), "warning", "end", ""
    ),
    "swapped": (SWAP, "refused", "columns", "swapped"),
    "flipped": (lambda r: scaled(r, force=-1.0), "refused", "sign", "flip_force"),
    "tonf": (lambda r: scaled(r, force=1 / 9.80665), "refused", "unit", "tonf labelled kN"),
    "kN": (lambda r: scaled(r, force=9.80665), "refused", "unit", "kN labelled tonf"),
    "metres": (lambda r: scaled(r, way=100.0), "refused", "strain", ""),
    "no cycle": (
        lambda r: rows(r, slice(int(np.argmax(r.displacement[:60])))), "refused", "cycles", ""
    ),
    "still": (
        lambda r: replace(r, displacement=0.0 * r.time + 3.0), "refused", "displacement", "3 mm"
    ),
    "no force": (lambda r: replace(r, force=0.0 * r.time + 3.0), "refused", "force", "3 kN"),
    "drift": (lambda r: plus(r, np.linspace(0.0, 0.3, len(r.time))), "warning", "drift", ""),
    "offset": (lambda r: plus(r, 0.1), "warning", "offset", "force_offset"),
    "gap": (lambda r: without(r, slice(-300, -285)), "warning", "sampling", "no samples from"),
    "time": (back_in_time, "refused", "time", ""),
    # Refused in words, although no cycle of so few samples can be measured.
    "few samples": (
        lambda r: rows(r, slice(None, None, round(len(r.time) / 36))), "refused", "sampling", ""
    ),
    "thermocouple": (
        lambda r: replace(r, temperatures={"T": np.full(len(r.time), 850.0)}, **BROKEN),
        "warning", "thermocouple", "",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_records(good: TestRecord, name: str) -> None:
    change, level, check, words = BAD[name]
    report = check_test(change(good), BEARING)
    assert (level, check) in found(report), report.findings
    assert words in said(report, level)


def test_a_refused_record_is_not_fitted(good: TestRecord) -> None:
    with pytest.raises(InputError, match="swapped"):
        identify_bearing(SWAP(good), BEARING)


def test_one_cycle_only() -> None:
    test = tb.cyclic_test(strain=[1.0], cycles=1, closing_strain=None)
    record = synthetic_record(BEARING, 23.0, test, noise=0.0)
    assert ("warning", "cycles") in found(check_test(record, BEARING))


@pytest.mark.parametrize(("low", "high"), [(-0.85, 0.85), (-0.6, 1.0)], ids=["both", "below"])
def test_clipped_force(good: TestRecord, low: float, high: float) -> None:
    ends = low * good.peak_force, high * good.peak_force
    clipped = replace(good, force=np.clip(good.force, *ends))
    report = check_test(clipped, BEARING)
    assert ("warning", "saturation") in found(report)
    assert report.clipped.sum() > 10
    assert np.isin(clipped.force[report.clipped], ends).all()
    assert not report.clipped[(good.force > ends[0]) & (good.force < ends[1])].any()


@pytest.mark.parametrize("zero", [-1.6, 1.6])
def test_a_slight_zero_of_the_force_is_told(zero: float) -> None:
    """Before: 1.4 % of the peak passed without a word. In the cold, where every side is weaker."""
    steps = tb.cyclic_test(strain=[0.5, 1.0, 1.5], cycles=4, rest=None)
    cold = synthetic_record(BEARING, -20.0, steps, noise=0.01, seed=3)
    assert ("note", "zero") in found(check_test(cold, BEARING))
    assert ("warning", "offset") not in found(check_test(cold, BEARING))
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


def test_the_gravest_finding_is_the_outcome(good: TestRecord) -> None:
    report = CheckReport(good)
    for level, outcome in (
        ("note", "good"), ("warning", "warning"), ("refused", "refused"), ("warning", "refused"),
    ):  # fmt: skip
        report.findings.append(Finding(level, "x", "x"))  # type: ignore[arg-type]
        assert report.outcome == outcome


@pytest.mark.parametrize("memory", [0.0, 0.8])
def test_noise_of_a_synthetic_record(memory: float) -> None:
    """Its standard deviation is what was asked for, of the peak, however it is correlated."""
    test = tb.cyclic_test(strain=[1.0], cycles=5, rest=None)
    clean = synthetic_record(BEARING, 23.0, test, noise=0.0, sampling=200.0)
    noisy = synthetic_record(BEARING, 23.0, test, noise=0.02, memory=memory, sampling=200.0)
    noise = (noisy.force - clean.force) / clean.peak_force
    assert noise.std() == pytest.approx(0.02, rel=0.15)
    assert np.corrcoef(noise[1:], noise[:-1])[0, 1] == pytest.approx(memory, abs=0.1)
