"""Hours in a chamber: start temperatures of tests, records and factors, and their use in fits."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import thermobearing as tb
from tests import tolerances as tol
from tests.quick import quick_cases
from tests.unit.inputs import command
from thermobearing.cyclic.conditioning import soaked_start
from thermobearing.identify.fit.forward import ForwardModel
from thermobearing.identify.fit.parameters import M_T, with_values
from thermobearing.identify.records.checks import check_test
from thermobearing.identify.records.record import TestRecord, record_from_arrays
from thermobearing.model.options import ModelOptions
from thermobearing.tables.conditioning import Conditioning

LRB = tb.load_bearing("lrb-example")  # 700 mm
COLD = -1.92  # m_T of the issue: exp(1.92 * 0.43) = 2.28
SPECIMEN = with_values(LRB, {M_T: COLD})
SPAN = 0.43  # of 100 K, from 23 to -20 degC
HALF_SOAKED = Conditioning(conditioned=6.0, before=23.0)
SHORT = tb.cyclic_test(strain=[0.5, 1.0], cycles=2, wave="sine", frequency=0.25, rest=None)


def make_record(ambient: float, conditioning: dict[str, float] | None = None) -> TestRecord:
    """A test without noise of the specimen, which does not say how long it was in its chamber."""
    initial = None if conditioning is None else tb.InitialState(conditioning=conditioning)
    result = tb.run(SPECIMEN, SHORT, ambient=ambient, keep=[], dt=0.02, initial=initial)
    x, force = (result[name].values[0] for name in ("displacement", "force"))
    return record_from_arrays(result.time(0), x, force, ambient, name=f"{ambient:g}")


@pytest.mark.thorough
def test_a_fit_learns_the_temperature_law_of_a_half_soaked_specimen() -> None:
    """Factor of the rubber at -20 degC after 6 h there: 2.28; 1.49 if the chamber is believed."""
    warm, cold = make_record(23.0), make_record(-20.0, {"conditioned": 6.0, "before": 23.0})
    read = HALF_SOAKED.model_copy(
        update={"inside": soaked_start(LRB, HALF_SOAKED, -20.0).layers[-1]}
    )
    factors, errors = [], []
    for stated in (None, HALF_SOAKED, read):
        records = [warm, replace(cold, conditioning=stated)]
        fit = tb.identify_bearing(records, LRB, free=["K_r", "m_T", "sigma_Y", "E2"], starts=1)
        names = {item.group.name for item in fit.uncertainty.assumed.evidence}
        assert ("film coefficient of the chamber" in names) == (stated is not None)
        errors.append(fit.uncertainty.estimates[M_T].stderr)
        factors.append(np.exp(-fit.bearing.hysteresis.elastic_temperature_coefficient * SPAN))
        suspects = [item["key"] for item in fit.summary()["suspects"]]
        assert suspects[:1] == ([] if stated else ["conditioning"])
    truth = np.exp(-COLD * SPAN)
    assert_allclose(factors[0], 1.5, atol=0.1)
    assert_allclose(factors[1:], truth, rtol=5e-3)
    assert errors[2] < 0.5 * errors[1] < 0.25 * errors[0]  # a reading replaces the film


def test_all_callers_have_one_start() -> None:
    start = soaked_start(LRB, HALF_SOAKED, -20.0)
    state = tb.InitialState(conditioning={"conditioned": 6.0, "before": 23.0})
    result = tb.run(LRB, SHORT, ambient=-20.0, dt=0.02, initial=state)
    assert_allclose(result["initial_temperature"].values[0], start.temperature, rtol=1e-12)
    assert result["lead_temperature"].values[0, 0] == start.lead
    record = replace(make_record(-20.0), conditioning=HALF_SOAKED, start_offset=1.0)
    forward = ForwardModel(record, LRB)
    assert_array_equal(forward._initial, start.temperature + 1.0)
    assert forward._initial_lead == (start.lead or 0.0) + 1.0
    other = ForwardModel(record, LRB, ambient=-10.0)  # a prediction: soaked through
    assert set(other._initial) == {-9.0}
    thicker = LRB.model_copy(
        update={"geometry": LRB.geometry.model_copy(update={"rubber_thickness": 9.0})}
    )
    assert forward.rebuilt(thicker)._initial.mean() > forward._initial.mean()


def test_factors_are_of_the_stated_hours() -> None:
    options = {"reference_temperature": 23.0, "temperatures": [-20.0], "strains": [1.0]}
    factors = []
    for conditioning in (None, {"conditioned": 6.0}, {"conditioned": 500.0}):
        state = tb.InitialState(conditioning=conditioning)
        table = tb.temperature_factors(SPECIMEN, cycles=[1], **options, initial=state)
        chosen = table.query("basis == 'first' and quantity == 'K_d' and ambient_degC == -20")
        factors.append(float(chosen["factor"].iloc[0]))
    assert_allclose(factors[0], np.exp(-COLD * SPAN), rtol=0.01)
    assert_allclose(factors[1], 1.55, atol=0.05)  # K_d of a half-soaked specimen
    assert_allclose(factors[2], factors[0], rtol=1e-6)


def test_command_file_and_keywords_are_one(tmp_path: Path) -> None:
    case = tmp_path / "case.toml"
    case.write_text(
        'bearing = "lrb-example"\nambient = ["-20 degC"]\nconditioned = "360 min"\n'
        "[[test.steps]]\n"
        'step = "cycles"\nstrain = 0.5\ncount = 1\nwave = "sine"\nfrequency = "0.5 Hz"\n'
    )
    words = ["--conditioned", "6", "--bearing", "lrb-example", "--ambient", "-20"]
    words += ["--strain", "0.5", "--cycles", "1", "--wave", "sine", "--frequency", "0.5"]
    for name, given in (("file", [str(case)]), ("words", words)):
        command("cyclic", *given, "-o", str(tmp_path / name), "--no-figures", "-q")
    saved = [tb.load_result(tmp_path / name) for name in ("file", "words")]
    test = tb.cyclic_test(strain=[0.5], cycles=1, wave="sine", frequency=0.5, rest=None)
    state = tb.InitialState(conditioning={"conditioned": 6.0})
    saved.append(tb.run("lrb-example", test, ambient=-20.0, initial=state))
    peaks = [float(np.abs(one["force"].values).max()) for one in saved]
    assert_allclose(peaks, peaks[0], rtol=tol.SEVEN_DIGITS)
    resolved = (tmp_path / "words" / "case.resolved.toml").read_text()
    assert 'before = "23.0 degC"' in resolved
    assert 'chamber_film = "12.0 W/(m^2 K)"' in resolved


@pytest.mark.parametrize(
    ("place", "reading"), [(None, -5.0), ("rubber 1", 10.0), ("rubber 20", 10.0), ("lead", -19.0)]
)
def test_a_reading_inside_decides(place: str | None, reading: float) -> None:
    starts = []
    for film in (6.0, 25.0):
        asked = HALF_SOAKED.model_copy(
            update={"inside": reading, "inside_place": place, "chamber_film": film}
        )
        starts.append(soaked_start(LRB, asked, -20.0))
    for start in starts:
        layer = {None: -1, "rubber 1": 0, "rubber 20": 0}.get(place, 0)
        there = start.lead if place == "lead" else start.layers[layer]
        assert_allclose(there, reading, atol=0.02)
        assert start.layers.min() > -20.0
        assert start.layers.max() < 23.0
    assert starts[0].hours > starts[1].hours
    free = [soaked_start(LRB, Conditioning(conditioned=6, chamber_film=f), -20.0) for f in (6, 25)]
    spread = [np.ptp([start.rubber for start in pair]) for pair in (starts, free)]
    assert spread[0] < 0.5 * spread[1]  # the film matters less


@pytest.mark.parametrize(("reading", "outer"), [(-20.0, -20.0), (23.0, 23.0)])
def test_readings_at_the_ends(reading: float, outer: float) -> None:
    asked = HALF_SOAKED.model_copy(update={"inside": reading})
    assert_allclose(soaked_start(LRB, asked, -20.0).layers, outer, atol=0.2)


def test_no_difference_of_temperature() -> None:
    asked = HALF_SOAKED.model_copy(update={"inside": 23.0})
    start = soaked_start(LRB, asked, 23.0)
    assert_allclose(start.layers, 23.0, atol=1e-9)
    assert start.hours == 6.0


@pytest.mark.parametrize(
    "options",
    [
        ModelOptions(stack="full"),
        ModelOptions(upper_face={"film": 12.0, "heat_capacity": 1000.0}),
        ModelOptions(model="single-temperature"),
        ModelOptions(scheme="published"),
    ],
)
def test_any_model_of_the_test_has_the_start(options: ModelOptions) -> None:
    half = soaked_start(LRB, HALF_SOAKED, -20.0)
    other = soaked_start(LRB, HALF_SOAKED, -20.0, options)
    assert_allclose(other.rubber, half.rubber, atol=0.05)
    parts = options.build_stack(LRB).part
    if options.model == "single-temperature":
        assert len(other.temperature) == 1
        assert half.layers.min() < other.temperature[0] < half.layers.max()
    else:
        assert len(other.temperature) == len(parts)
        masses = other.temperature[[part == "mass" for part in parts]]
        assert_array_equal(masses, -20.0)


@pytest.mark.parametrize(
    ("keys", "ambient", "words"),
    [
        ({"before": 20.0}, -20.0, ["before", "conditioned"]),
        ({"conditioned": 6.0, "inside_place": "lead"}, -20.0, ["inside_place", "inside"]),
        ({"conditioned": 6.0, "inside": 0.0, "inside_place": "shim 1"}, -20.0, ["rubber 1"]),
        ({"conditioned": 6.0, "inside": 0.0, "inside_place": "rubber 21"}, -20.0, ["20 rubber"]),
        ({"conditioned": 6.0, "inside": 30.0}, -20.0, ["inside", "-20 to 23 degC"]),
        ({"conditioned": 6.0, "inside": 0.0}, [-20.0, -10.0], ["one ambient"]),
        ({"conditioned": 0.0}, -20.0, ["conditioned", "greater than 0", "h"]),
        ({"conditioned": 6.0, "chamber_film": -1.0}, -20.0, ["chamber_film", "W/(m^2 K)"]),
    ],
)
def test_faults(keys: dict[str, object], ambient: float, words: list[str]) -> None:
    start = tb.InitialState(conditioning=keys)
    with pytest.raises(tb.InputError) as caught:
        tb.run("lrb-example", SHORT, ambient, initial=start)
    for word in words:
        assert word in str(caught.value)


def test_a_temperature_and_the_hours_are_refused() -> None:
    start = tb.InitialState(temperature=0.0, conditioning={"conditioned": 6.0})
    with pytest.raises(tb.InputError, match="only one of"):
        tb.run("lrb-example", SHORT, -20.0, initial=start)


def test_lead_place_needs_lead() -> None:
    reading = {"conditioned": 1.0, "inside": 0.0, "inside_place": "lead"}
    with pytest.raises(tb.InputError, match='"lead"'):
        tb.run("shen-hdr-specimen", SHORT, -20.0, initial=tb.InitialState(conditioning=reading))


def write_test(folder: Path, sidecar: str) -> Path:
    record = make_record(-20.0)
    file = folder / "cold.csv"
    rows = np.c_[record.time, record.displacement, record.force]
    np.savetxt(file, rows, delimiter=",", header="time_s,displacement_mm,force_kN", comments="")
    file.with_suffix(".toml").write_text(f'ambient = "-20 degC"\n{sidecar}')
    return file


def test_sidecar_states_the_hours(tmp_path: Path) -> None:
    file = write_test(tmp_path, 'conditioned = "6 h"\ninside = "-1 degC"\n')
    record = tb.load_test(file)
    assert record.conditioning == Conditioning(
        conditioned=6.0, before=23.0, inside=-1.0, chamber_film=12.0
    )
    assert sum("before" in text for text in record.assumptions) == 1
    bad = write_test(tmp_path, 'before = "20 degC"\n')
    with pytest.raises(tb.InputError, match="conditioned"):
        tb.load_test(bad)


@pytest.mark.parametrize(
    ("sidecar", "bearing", "level"),
    quick_cases(
        [
            ('conditioned = "6 h"\nbefore = "23 degC"\n', "lrb-example", "warning"),
            ('conditioned = "60 h"\nbefore = "23 degC"\n', "lrb-example", None),
            ("", "lrb-example", "note"),
            ("", "shen-hdr-specimen", None),
            ('conditioned = "6 h"\nbefore = "-20 degC"\n', "lrb-example", None),
            ('conditioned = "6 h"\ninside = "30 degC"\n', "lrb-example", "refused"),
        ],
        0,
        4,
    ),
)
def test_intake_warns_of_a_bearing_that_cannot_be_cold(
    tmp_path: Path, sidecar: str, bearing: str, level: str | None
) -> None:
    record = tb.load_test(write_test(tmp_path, sidecar))
    report = check_test(record, bearing)
    levels = [item.level for item in report.findings if item.check == "conditioning"]
    assert levels == ([] if level is None else [level])


def test_intake_command_writes_the_finding(tmp_path: Path) -> None:
    file = write_test(tmp_path, 'conditioned = "6 h"\n')
    command("intake", str(file), "--bearing", "lrb-example", "-o", str(tmp_path / "in"), "-q")
    summary = json.loads((tmp_path / "in" / "summary.json").read_text())
    (result,) = summary["files"]
    assert "conditioning" in [item["check"] for item in result["findings"]]
    assert result["sidecar"]["conditioned"] == "6 h"
