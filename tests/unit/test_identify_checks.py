"""Tests of a laboratory: read, checked and treated before a fit."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.border.errors import InputError
from thermobearing.border.library import data_path
from thermobearing.border.toml import read_toml
from thermobearing.identify.case import make_identify_case
from thermobearing.identify.fit.forward import ForwardModel
from thermobearing.identify.fit.synthetic import synthetic_record
from thermobearing.identify.records import checks, treatment
from thermobearing.identify.records.checks import CheckReport, check_test
from thermobearing.identify.records.cycles import estimate_noise
from thermobearing.identify.records.figures import draw_record
from thermobearing.identify.records.limits import CheckLimits, check_limits
from thermobearing.identify.records.record import (
    ASSUMED_AMBIENT,
    TestRecord,
    _describe_drift,
    load_test,
    record_from_arrays,
)
from thermobearing.identify.run import identify_bearing
from thermobearing.tables.laboratory import ASSUMED_SPEED

BEARING = tb.load_bearing("shen-hdr-specimen")


@pytest.fixture(scope="module")
def good() -> TestRecord:
    test = tb.cyclic_test(strain=[0.5, 1.5], cycles=3, rest=600.0)
    return synthetic_record(BEARING, 23.0, test, noise=0.005)


def sentences(report: CheckReport, level: str, check: str = "") -> str:
    findings = [f for f in report.findings if f.level == level and check in ("", f.check)]
    return "\n".join(f.sentence for f in findings)


def levels_and_checks(report: CheckReport) -> set[tuple[str, str]]:
    return {(finding.level, finding.check) for finding in report.findings}


def rows(record: TestRecord, kept: slice | np.ndarray) -> TestRecord:
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
    "gap": (lambda r: without(r, slice(-300, -285)), "warning", "sampling", "missing from"),
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
    assert (level, check) in levels_and_checks(report), report.findings
    assert words in sentences(report, level)


def test_a_refused_record_is_not_fitted(good: TestRecord) -> None:
    with pytest.raises(InputError, match="swapped"):
        identify_bearing(SWAP(good), BEARING)


def test_one_cycle_only() -> None:
    test = tb.cyclic_test(strain=[1.0], cycles=1, closing_strain=None)
    record = synthetic_record(BEARING, 23.0, test, noise=0.0)
    assert ("warning", "cycles") in levels_and_checks(check_test(record, BEARING))


@pytest.mark.parametrize(("low", "high"), [(-0.85, 0.85), (-0.6, 1.0)], ids=["both", "below"])
def test_clipped_force(good: TestRecord, low: float, high: float) -> None:
    ends = low * good.peak_force, high * good.peak_force
    clipped = replace(good, force=np.clip(good.force, *ends))
    report = check_test(clipped, BEARING)
    assert ("warning", "saturation") in levels_and_checks(report)
    assert report.clipped.sum() > 10
    assert np.isin(clipped.force[report.clipped], ends).all()
    assert not report.clipped[(good.force > ends[0]) & (good.force < ends[1])].any()


@pytest.mark.parametrize("zero", [-1.6, 1.6])
def test_a_slight_zero_of_the_force_is_reported(zero: float) -> None:
    steps = tb.cyclic_test(strain=[0.5, 1.0, 1.5], cycles=4, rest=None)
    cold = synthetic_record(BEARING, -20.0, steps, noise=0.01, seed=3)
    assert ("note", "zero") in levels_and_checks(check_test(cold, BEARING))
    assert ("warning", "offset") not in levels_and_checks(check_test(cold, BEARING))
    peak = cold.peak_force
    shifted = replace(cold, force=cold.force + zero / 160.0 * peak)
    reported = sentences(check_test(shifted, BEARING), "warning")
    number = float(re.findall(r'force_offset = "(.*) kN"', reported)[0])
    assert number == pytest.approx(zero / 160.0 * peak, rel=0.15)


@pytest.mark.parametrize(("sign", "subtracted"), [(1.0, 0.0), (-1.0, 0.0), (-1.0, 2.0)])
def test_the_offset_of_the_message_is_that_of_the_readings(
    good: TestRecord, tmp_path: Path, sign: float, subtracted: float
) -> None:
    """The sidecar subtracts it before it reverses the sign, and may have subtracted a part."""
    zero = 12.0
    columns = {"time_s": good.time, "displacement_mm": good.displacement}
    write(tmp_path / "t.csv", columns | {"force_kN": sign * good.force + zero})
    keys = f'ambient = "23 degC"\nflip_force = {str(sign < 0.0).lower()}\n'
    (tmp_path / "t.toml").write_text(f'{keys}force_offset = "{subtracted} kN"\n')
    reported = sentences(check_test(load_test(tmp_path / "t.toml"), BEARING), "warning")
    offset = re.findall(r'force_offset = "(.*) kN"', reported)[0]
    assert float(offset) == pytest.approx(zero, rel=0.1)
    (tmp_path / "t.toml").write_text(f'{keys}force_offset = "{offset} kN"\n')
    assert ("warning", "offset") not in levels_and_checks(
        check_test(load_test(tmp_path / "t.toml"), BEARING)
    )


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
def test_a_wrong_unit_is_reported_by_the_slip_behind_it(
    way: float, force: float, slip: str
) -> None:
    t = np.linspace(0.0, 4.0, 2001)
    x = 60.0 * np.sin(np.pi * t)
    scale = 1.25 * BEARING.area / BEARING.total_rubber_thickness / 1e3
    f = scale * (x + 10.0 * np.cos(np.pi * t))
    f *= scale * 60.0 / np.abs(f).max()
    report = check_test(record_from_arrays(t, way * x, force * f, 23.0), BEARING)
    assert slip in sentences(report, "refused")


@pytest.mark.parametrize(("offset", "level"), [(0.0, "note"), (2.9, "warning")])
def test_offset_is_judged_by_the_smallest_cycles(offset: float, level: str) -> None:
    """2.9 kN are 6 % of the cycles of 48 kN, although 2 % of those of 145 kN."""
    turn = np.linspace(0.0, 6.0 * np.pi, 601)[:-1]
    x = np.concatenate([15.0 * np.sin(turn), 45.0 * np.sin(turn)])
    force = 3.2 * x + np.concatenate([5.0 * np.cos(turn), 15.0 * np.cos(turn)]) + offset
    record = record_from_arrays(0.05 * np.arange(len(x)), x, force, -20.0)
    (finding,) = (
        one
        for one in check_test(record).findings
        if one.check in ("zero", "offset") and "kN" in one.sentence
    )
    assert finding.level == level
    assert f"{offset:.2g} kN" in finding.sentence
    share = float(re.findall(r"([\d.]+) %", finding.sentence)[-1])
    assert share == pytest.approx(100.0 * offset / 48.3, abs=0.1)


def test_the_drift_of_a_force_that_softens() -> None:
    """Of a drift of 20 kN the middles of the loops, which lean in the cold, make 22.2 kN."""
    steps = tb.cyclic_test(strain=[0.5, 1.0, 1.75], cycles=4, rest=60.0)
    cold = synthetic_record(BEARING, -20.0, steps, noise=0.003, seed=5)
    line = 20.0 * (cold.time - cold.time[0]) / np.ptp(cold.time)
    treated = check_test(replace(cold, force=cold.force + line)).treatment
    assert treated is not None
    assert treated.drifts["force"].total == pytest.approx(20.0, rel=0.02)


def test_a_chamber_that_wanders_states_its_extremes() -> None:
    """It ends where it began, so that its first and last values would say that nothing happened."""
    time = np.linspace(0.0, 100.0, 2001)
    sentence = _describe_drift(time, -20.0 + 0.65 * np.sin(0.04 * np.pi * time))
    low, high = map(float, re.findall(r"-?\d+\.\d", sentence)[:2])
    assert (low, high) == pytest.approx((-20.65, -19.35), abs=0.06)


def test_offset_is_the_middle_of_the_middles(good: TestRecord) -> None:
    """One cycle of six that sits 30 % too high is no offset of the record."""
    force = good.force.copy()
    cycle = check_test(good, BEARING).cycles[1]
    force[cycle.first : cycle.last] += 0.3 * good.peak_force
    reported = sentences(check_test(replace(good, force=force), BEARING), "warning")
    assert "zero of the force is off" not in reported


@pytest.mark.parametrize("memory", [0.0, 0.8])
def test_noise_of_a_synthetic_record(memory: float) -> None:
    """Its standard deviation is what was asked for, of the peak, however it is correlated."""
    test = tb.cyclic_test(strain=[1.0], cycles=5, rest=None)
    clean = synthetic_record(BEARING, 23.0, test, noise=0.0, sampling=200.0)
    noisy = synthetic_record(BEARING, 23.0, test, noise=0.02, memory=memory, sampling=200.0)
    noise = (noisy.force - clean.force) / clean.peak_force
    assert noise.std() == pytest.approx(0.02, rel=0.15)
    assert np.corrcoef(noise[1:], noise[:-1])[0, 1] == pytest.approx(memory, abs=0.1)


TIME = np.arange(400) * 0.02
X = 30.0 * np.sin(2.0 * np.pi * 0.5 * TIME)
FORCE = 2.0 * X + 10.0 * np.cos(2.0 * np.pi * 0.5 * TIME)


def write(
    path: Path,
    columns: dict[str, np.ndarray],
    before: str = "",
    after: str = "",
    encoding: str = "utf-8",
) -> Path:
    rows = np.column_stack(list(columns.values()))
    lines = [",".join(f"{v!r}" for v in row.tolist()) for row in rows]
    text = before + ",".join(columns) + "\n" + after + "\n".join(lines) + "\n"
    path.write_bytes(text.encode(encoding))
    return path


def plain(path: Path) -> Path:
    return write(path, {"time_s": TIME, "displacement_mm": X, "force_kN": FORCE})


def test_plain_csv(tmp_path: Path) -> None:
    record = load_test(plain(tmp_path / "a.csv"))
    assert_allclose(record.force, FORCE, rtol=tol.CONVERSION)
    assert record.ambient == ASSUMED_AMBIENT
    assert any("ambient" in text for text in record.assumptions)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp932"])
def test_japanese_laboratory_file(tmp_path: Path, encoding: str) -> None:
    """Three lines before the header, a line of channels after it, cm and tonf."""
    columns = {"時間(s)": TIME, "変位": X / 10.0, "荷重(tonf)": FORCE / 9.80665}
    before, after = "試験体,HDR\n日付,2020/1/1\n担当,\n", "ch1,ch2,ch3\n"
    write(tmp_path / "t.csv", columns, before, after, encoding)
    (tmp_path / "t.toml").write_text(
        'ambient = "-20 degC"\nlines_before = 3\nlines_after = 1\n'
        '[columns]\ntime = "時間(s)"\ndisplacement = "変位"\nforce = "荷重(tonf)"\n'
        '[units]\ndisplacement = "cm"\n',
        encoding="utf-8",
    )
    record = load_test(tmp_path / "t.csv")
    assert_allclose(record.displacement, X, rtol=tol.CONVERSION, atol=tol.CONVERSION)
    assert_allclose(record.force, FORCE, rtol=tol.CONVERSION)
    assert record.ambient == -20.0
    assert record.assumptions == ()


@pytest.mark.parametrize(
    ("sidecar", "name", "wanted"),
    [
        ('[units]\nforce = "tonf"', "force", 9.80665 * FORCE),
        ('flip_force = true\nforce_offset = "3 kN"', "force", -(FORCE - 3.0)),
        ('displacement_offset = "1 mm"', "displacement", X - 1.0),
    ],
)
def test_units_signs_and_offsets(
    tmp_path: Path, sidecar: str, name: str, wanted: np.ndarray
) -> None:
    plain(tmp_path / "t.csv")
    (tmp_path / "t.toml").write_text(f'ambient = "0 degC"\n{sidecar}\n')
    converted = getattr(load_test(tmp_path / "t.toml"), name)
    assert_allclose(converted, wanted, rtol=tol.CONVERSION, atol=tol.CONVERSION)


def test_blocks_with_rests_make_one_line_of_time(tmp_path: Path) -> None:
    plain(tmp_path / "a.csv")
    plain(tmp_path / "b.csv")
    (tmp_path / "all.toml").write_text(
        'ambient = "0 degC"\nblocks = [{ file = "a.csv" }, { file = "b.csv", '
        'rest_before = "75 min" }]\n'
    )
    record = load_test(tmp_path / "all.toml")
    assert (np.diff(record.time) > 0.0).all()
    assert_allclose(record.time[400] - record.time[399], 4500.0, rtol=tol.CONVERSION)
    assert record.block.tolist() == [0] * 400 + [1] * 400


def test_without_a_clock_a_speed_is_assumed_and_said(tmp_path: Path) -> None:
    write(tmp_path / "t.csv", {"displacement_mm": X, "force_kN": FORCE})
    record = load_test(tmp_path / "t.csv")
    assert any(f"{ASSUMED_SPEED:g} mm/s" in text for text in record.assumptions)
    path = np.abs(np.diff(X)).sum()
    assert_allclose(record.time[-1], path / ASSUMED_SPEED, rtol=1e-3)
    (tmp_path / "t.toml").write_text('sampling = "50 Hz"\n')
    record = load_test(tmp_path / "t.csv")
    assert_allclose(record.time, TIME, atol=tol.CONVERSION)
    assert not any("Hz" in text for text in record.assumptions)


@pytest.mark.parametrize(
    ("sidecar", "message"),
    [
        ('ambiant = "0 degC"\n', "ambient"),
        ("ambient = 0\n", "no unit"),
        ('file = "t.csv"\nblocks = [{ file = "t.csv" }]\n', "either file or blocks"),
        ('speed = "3 mm/s"\nsampling = "3 Hz"\n', "either speed or sampling"),
        ('[columns]\nforce = "Kraft"\n', 'no column "Kraft"'),
        ('[units]\nforce = "mm"\n', "cannot be converted"),
        ('[columns]\nForce = "x"\n', "known: ambient, axial_force, displacement, force, time"),
        ('[thermocouples]\nT = "steel 1"\n', "must be"),
        ("lines_before = 900\n", "lines"),
    ],
)
def test_faults_are_named(tmp_path: Path, sidecar: str, message: str) -> None:
    plain(tmp_path / "t.csv")
    (tmp_path / "t.toml").write_text(sidecar)
    with pytest.raises(InputError, match=message):
        load_test(tmp_path / "t.csv")


HDR = BEARING
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


@pytest.mark.parametrize("points", [40, 200, 2000])
def test_noise_is_measured_beside_the_motion(points: int) -> None:
    """A sine of so many samples a cycle, with noise of 1e-3 of its amplitude, and with none."""
    t = np.arange(10 * points) / points
    motion = 50.0 * np.sin(2.0 * np.pi * t)
    noisy = motion + np.random.default_rng(0).normal(0.0, 0.05, len(t))
    assert estimate_noise(noisy) == pytest.approx(0.05, rel=0.15)
    assert estimate_noise(motion) < 1e-4


def test_rests_are_where_nothing_moves(record: TestRecord) -> None:
    (rest,) = treatment._find_rests(record)
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
    assert treatment._find_rests(tb.record_from_arrays(t, x, 2.0 * x, 23.0)) == []


def test_a_slow_creep_is_not_held_as_one_rest() -> None:
    t = np.linspace(0.0, 1000.0, 10001)
    x = np.where(t < 20.0, 50.0 * np.sin(np.pi * t / 5.0), 0.005 * (t - 20.0))
    record = tb.record_from_arrays(t, x, 2.0 * x, 23.0)
    assert all(
        np.ptp(x[a : b + 1]) <= 0.004 * 50.0 + 1e-9 for a, b in treatment._find_rests(record)
    )


def test_a_fit_sees_a_rest_as_a_gap(record: TestRecord) -> None:
    found = treatment.treat(record)
    short, left_out = found.to_fit(np.zeros(len(record.time), dtype=bool))
    ((first, last),) = found.rests
    assert len(short.time) == len(record.time) - (last - first + 1) + 2
    assert int(left_out.sum()) == 2
    a, b = np.flatnonzero(left_out)
    assert short.displacement[a] == short.displacement[b]
    assert short.displacement[a] == pytest.approx(0.0, abs=0.1 * JITTER)
    assert short.time[b] - short.time[a] == pytest.approx(record.time[last] - record.time[first])


def test_thermocouples_of_a_rest_are_kept(record: TestRecord) -> None:
    cooling = replace(record, temperatures={"T": 23.0 + 9.0 * np.exp(-record.time / 100.0)})
    rests = treatment._find_rests(record)
    short, kept, resting = treatment._thin_rests(cooling, rests)
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
    ((first, last),) = treatment._find_rests(noisy)
    middle = slice(first + 20, last - 20)
    assert np.ptp(forces[0][middle]) < 0.01 * clean.peak_force


def test_a_logger_that_runs_through_rests(record: TestRecord) -> None:
    """Read as motion, the rests of this record gave R2 = 0.1, and no word of it."""
    found = identify_bearing(record, HDR, starts=1)
    assert found.outcome == "completed"
    assert found.fits[0].R2 > 0.99
    assert found.values["hysteresis.layer_stiffness"] == pytest.approx(30.738, rel=0.05)
    reported = found.summary()["records"][0]["treatment"]
    assert reported["rests"] == 1
    assert reported["noise"]["displacement_mm"] == pytest.approx(JITTER, rel=0.1)


def test_spikes_are_found_one_by_one(spiky: tuple[TestRecord, list[int]]) -> None:
    record, at = spiky
    report = check_test(record, HDR)
    assert np.flatnonzero(treatment.treat(record).spikes["force"]).tolist() == at
    assert "10 spikes in the force, the largest 3" in sentences(report, "warning", "spikes")
    assert "despike = true" in sentences(report, "warning", "spikes")
    assert "offset" not in {finding.check for finding in report.findings}
    title = draw_record(report).axes[1].get_title(loc="left")
    assert "crosses: spikes" in title.replace("\n", " ")


def test_spikes_of_the_displacement(record: TestRecord) -> None:
    x = record.displacement.copy()
    x[[200, 400]] += 30.0
    spoilt = replace(record, displacement=x)
    assert np.flatnonzero(treatment.treat(spoilt).spikes["displacement"]).tolist() == [200, 400]
    assert len(treatment.treat(spoilt).rests) == 1
    cured = treatment.treat(replace(spoilt, despike=True)).cleaned
    assert cured.peak_displacement < 46.0


@pytest.mark.parametrize("name", ["shen-hdr-specimen", "shen-lhdr-specimen", "lrb-example"])
@pytest.mark.parametrize("sampling", [10.0, 50.0])
def test_good_records_have_no_spikes_and_no_drift(name: str, sampling: float) -> None:
    test = tb.cyclic_test(strain=[0.5, 1.5, 2.5], cycles=2, wave="sine", rest=60.0)
    found = treatment.treat(synthetic_record(name, -20.0, test, sampling=sampling))
    assert not any(flags.any() for flags in found.spikes.values())
    assert not found.drifts


def test_spikes_are_taken_out_only_when_reported(spiky: tuple[TestRecord, list[int]]) -> None:
    record, at = spiky
    left, none = treatment.treat(record).to_fit(np.zeros(len(record.time), dtype=bool))
    assert left.peak_force > 250.0
    assert not none[np.abs(left.force) > 200.0].any()
    (reported,) = treatment.request_treatment([record], True, "")
    report = check_test(reported, HDR)
    assert "removed" in sentences(report, "note", "spikes")
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
def test_drift_is_found_and_taken_out_when_reported(record: TestRecord, name: str) -> None:
    spoilt = drifting(record, name, 0.08)
    report = check_test(spoilt, HDR)
    assert f"the zero of the {name} drifts by" in sentences(report, "warning", "drift")
    assert treatment.treat(spoilt).cleaned.force[-50:].mean() == spoilt.force[-50:].mean()
    reported = treatment.treat(drifting(record, name, 0.08, detrend=name))
    off = getattr(reported.cleaned, name) - getattr(treatment.treat(record).cleaned, name)
    peak = float(np.abs(getattr(record, name)).max())
    assert np.abs(off).max() < 0.025 * peak
    assert "removed" in sentences(check_test(reported.record, HDR), "note", "drift")


def test_a_certain_drift_that_is_small_is_a_note() -> None:
    """It is above 1 % of the peak of the smallest cycles, and below 3 %."""
    steps = tb.cyclic_test(strain=[0.5, 1.0, 1.75], cycles=5, rest=60.0)
    record = synthetic_record(HDR, 23.0, steps, noise=0.001, seed=5)
    full = [cycle for cycle in treatment.treat(record).cycles if not cycle.closing]
    smallest = min(full, key=lambda cycle: cycle.amplitude)
    peak = 0.5 * float(np.ptp(record.force[smallest.first : smallest.last + 1]))
    report = check_test(drifting(record, "force", 0.02 * peak / record.peak_force), HDR)
    assert "the zero of the force drifts by" in sentences(report, "note", "drift")
    assert not sentences(report, "warning", "drift")


def test_a_drift_that_is_small_is_removed_on_request(record: TestRecord) -> None:
    """1 % of the peak is not reported, but removed where the sidecar asks for it."""
    part = 0.01
    assert not sentences(check_test(drifting(record, "force", part), HDR), "warning", "drift")
    treated = treatment.treat(drifting(record, "force", part, detrend="force"))
    assert treated.summary()["drift_removed"] == ["force"]
    plain = treatment.treat(replace(record, detrend="force"))
    assert_allclose(treated.cleaned.force, plain.cleaned.force, atol=1e-3 * record.peak_force)


def test_a_drift_of_few_cycles_is_not_reported_as_removed() -> None:
    test = tb.cyclic_test(strain=[1.0], cycles=3, rest=None)
    short = replace(synthetic_record(HDR, 23.0, test), detrend="force")
    assert treatment.treat(short).summary()["drift_removed"] == []
    assert "not removed" in sentences(check_test(short, HDR), "warning", "drift")


def test_tests_of_one_name_are_told_apart_by_their_folders() -> None:
    time = np.linspace(0.0, 40.0, 401)
    moved = 30.0 * np.sin(0.5 * time)
    records = [
        replace(
            record_from_arrays(time, moved, 2.0 * moved, ambient=20.0, name=name),
            file=f"{folder}/{name}.csv",
        )
        for folder, name in (("warm", "history"), ("cold", "history"), ("cold", "other"))
    ]
    names = [record.name for record in make_identify_case(records, "shen-hdr-specimen").records]
    assert names == ["warm-history", "cold-history", "other"]


@pytest.mark.parametrize("ambient", [-20.0, 23.0])
def test_a_drift_of_three_amplitudes_is_removed_with_its_interval(ambient: float) -> None:
    """Of 4 kN over 3 x 5 cycles, at least 90 % is removed, and the interval contains the drift.

    The offset is what remains without the drift, so that both can be removed.
    """
    drift = 4.0
    steps = tb.cyclic_test(strain=[0.5, 1.0, 1.75], cycles=5, rest=60.0)
    plain = synthetic_record(HDR, ambient, steps, noise=0.001, seed=5)
    line = drift * (plain.time - plain.time[0]) / np.ptp(plain.time)
    report = check_test(replace(plain, force=plain.force + line), HDR)
    assert ("warning", "drift") in levels_and_checks(report)
    assert ("warning", "offset") not in levels_and_checks(report)
    assert report.treatment is not None
    measured = report.treatment.drifts["force"]
    assert abs(measured.total - drift) < 0.1 * drift
    assert abs(measured.total - drift) < measured.error < 0.1 * drift


def test_the_removal_of_a_drift_is_a_note_with_what_may_remain() -> None:
    """Cycles of one amplitude in the cold, whose zeros scatter: the interval is wide."""
    steps = tb.cyclic_test(strain=[1.0], cycles=5, rest=None)
    plain = synthetic_record(HDR, -20.0, steps, noise=0.001, seed=5)
    line = 4.0 * (plain.time - plain.time[0]) / np.ptp(plain.time)
    report = check_test(replace(plain, force=plain.force + line, detrend="force"), HDR)
    assert report.treatment is not None
    measured = report.treatment.drifts["force"]
    assert measured.error > 0.1 * measured.total
    assert ("note", "drift") in levels_and_checks(report)
    assert ("warning", "drift") not in levels_and_checks(report)
    assert f"Up to {measured.error:.2g} kN" in sentences(report, "note", "drift")
    assert report.treatment.summary()["drift_error"]["force_kN"] == measured.error


def test_a_drift_that_may_be_chance_is_none() -> None:
    """Of 100 records with noise but no drift, 95 % finds 3 in the force, and 99 % none."""
    steps = tb.cyclic_test(strain=[0.5, 1.0, 1.75], cycles=3, rest=5.0)
    plain = synthetic_record(HDR, 0.0, steps, noise=0.0, seed=5)
    rng, reported, significant = np.random.default_rng(11), 0, 0
    for _ in range(100):
        noise = rng.normal(size=(2, len(plain.time)))
        noisy = replace(
            plain,
            displacement=plain.displacement + 0.005 * noise[0],
            force=plain.force + 0.01 * plain.peak_force * noise[1],
        )
        reported += len(treatment.treat(noisy).drifts)
        line = treatment.treat(replace(noisy, detrend="force"))
        significant += line.summary()["drift_significant"]["force_kN"]
        if not line.drifts["force"].significant:
            assert any("may be chance" in f.sentence for f in treatment.describe_treatment(line))
    assert reported == 0
    assert significant <= 1


def test_limits_are_those_of_the_data_file(
    good: TestRecord, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A file with another number of samples changes the finding; each limit states its reason."""
    table = read_toml(data_path("identify", "checks.toml"))
    assert set(table) == set(CheckLimits.model_fields)
    assert all(entry["source"] and entry["note"] for entry in table.values())
    assert not sentences(check_test(good), "warning", "sampling")
    many = check_limits().model_copy(update={"few_samples": 100_000})
    monkeypatch.setattr(checks, "check_limits", lambda: many)
    assert "100000 or more" in sentences(check_test(good), "warning", "sampling")


def test_the_stated_modulus_is_that_of_the_later_cycles() -> None:
    """Three cycles of 30 mm whose forces are 3, 2 and 1 kN/mm: the first does not count."""
    t = np.linspace(0.0, 3.0, 3001)
    stiffness = 3.0 - np.minimum(np.floor(t), 2.0)
    x = 30.0 * np.sin(2.0 * np.pi * t)
    force = stiffness * 30.0 * np.sin(2.0 * np.pi * t + 0.1)
    report = check_test(tb.record_from_arrays(t, x, force, 23.0), HDR)
    (stated,) = (f.sentence for f in report.findings if f.check == "unit")
    rubber, area = HDR.total_rubber_thickness, HDR.area
    assert f"{1e3 * 1.5 * rubber / area:.3g} MPa" in stated
