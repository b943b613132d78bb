"""Causes of a misfit: faults of synthetic tests, and the first cause that a calibration names."""

from collections.abc import Callable
from dataclasses import replace
from typing import get_type_hints

import numpy as np
import pytest

import thermobearing as tb
from thermobearing.identify.case import IdentifyCase, IdentifyKeywords
from thermobearing.identify.misfit import fit_lag, lagged
from thermobearing.identify.records.checks import check_test
from thermobearing.identify.records.record import TestRecord
from thermobearing.identify.uncertainty.evidence import Evidence
from thermobearing.identify.uncertainty.groups import CONDITIONING, chosen_groups

BEARING = tb.load_bearing("shen-hdr-specimen")
STEPS = tb.cyclic_test(strain=[0.5, 1.0, 1.75], cycles=4, rest=60.0)
Records = list[TestRecord]


def with_cells(rubber: int, shim: int) -> tb.Bearing:
    cells = BEARING.cells.model_copy(update={"rubber": rubber, "shim": shim})
    return BEARING.model_copy(update={"cells": cells})


def make_records(bearing: tb.Bearing) -> Records:
    return [
        tb.synthetic_record(bearing, ambient, STEPS, noise=0.003, seed=5 + k)
        for k, ambient in enumerate((-20.0, 23.0))
    ]


@pytest.fixture(scope="module")
def records() -> Records:
    return make_records(BEARING)


def course(record: TestRecord) -> np.ndarray:
    """Return a line through zero in the middle of the test, from -1/2 to 1/2."""
    return np.asarray((record.time - record.time[0]) / np.ptp(record.time) - 0.5)


def delayed(record: TestRecord) -> TestRecord:
    force = np.interp(record.time - 0.06, record.time, record.force)
    return replace(record, force=force)


FAULTS: dict[str, tuple[Callable[[TestRecord], TestRecord], str]] = {
    "force offset": (lambda r: replace(r, force=r.force + 3.0), "force_offset"),
    "small force drift": (lambda r: replace(r, force=r.force + 3.0 * course(r)), "force_drift"),
    "displacement offset": (
        lambda r: replace(r, displacement=r.displacement + 2.0),
        "displacement_offset",
    ),
    "displacement drift": (
        lambda r: replace(r, displacement=r.displacement + 4.0 * (course(r) + 0.5)),
        "displacement_drift",
    ),
    "delay": (delayed, "force_delay"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_the_first_cause_is_the_fault(records: Records, name: str) -> None:
    change, key = FAULTS[name]
    fit = tb.identify_bearing([change(record) for record in records], BEARING, starts=1)
    suspects = fit.summary()["suspects"]
    assert suspects[0]["key"] == key
    assert suspects[0]["size"] > 0.0
    heat = {"materials.rubber.conductivity", "materials.rubber.specific_heat"}
    assert not heat & {item["key"] for item in suspects}


def test_no_cause_is_named_without_a_fault(records: Records) -> None:
    fit = tb.identify_bearing(records, BEARING, starts=1)
    # The noise hides that turns are sharp here, so that 50 Hz may be too coarse for them.
    others = [warning for warning in fit.warnings if " Hz" not in warning]
    assert (fit.summary()["suspects"], others) == ([], [])


def test_heat_cells_are_no_cause_where_more_of_them_change_nothing() -> None:
    """Records of a coarser model: a finer calculation would not come nearer to them."""
    fit = tb.identify_bearing(make_records(with_cells(2, 1)), with_cells(6, 2), starts=1)
    summary = fit.summary()
    assert "cells" not in {item["key"] for item in summary["suspects"]}
    assert "materials.rubber.conductivity" in {item["key"] for item in summary["suspects"]}
    # The share that was computed is what twice the cells change after another calibration.
    twice = tb.identify_bearing(make_records(with_cells(2, 1)), with_cells(12, 4), starts=1)
    errors = [
        float(np.mean(np.concatenate(one.problem.parts(one.cube, fine=True)) ** 2))
        for one in (fit, twice)
    ]
    change = errors[1] / errors[0] - 1.0
    assert change > 0.02
    assert -summary["removed_by_finer_cells"] == pytest.approx(change, rel=0.2)


def test_heat_cells_of_a_synthetic_record() -> None:
    """They explain most, and other changes of heat nearly as much: all are possible causes."""
    fit = tb.identify_bearing(make_records(with_cells(6, 2)), with_cells(2, 1), starts=1)
    first, second = fit.summary()["suspects"][:2]
    assert (first["key"], second["key"]) == ("cells", "materials.rubber.conductivity")
    assert first["size"] == pytest.approx(1.0, abs=0.15)
    # What moves only because of them is not contradicted.
    evidence = fit.uncertainty.assumed.evidence
    assert any(item.beyond for item in evidence)
    assert [item.group.name for item in evidence if item.contradicted] == []
    assert all(item.imitated == item.beyond for item in evidence)


def test_heat_cells_are_the_last_cause_of_another_thickness(records: Records) -> None:
    geometry = BEARING.geometry
    thicker = {"rubber_thickness": 1.2 * geometry.rubber_thickness}
    bearing = BEARING.model_copy(update={"geometry": geometry.model_copy(update=thicker)})
    keys = [item["key"] for item in tb.identify_bearing(records, bearing).summary()["suspects"]]
    assert keys[0] == "materials.rubber.specific_heat"
    assert "cells" not in keys[:-1]
    assert "geometry.rubber_thickness" in keys


def test_a_value_is_contradicted_beside_another_cause(records: Records) -> None:
    """K_r is held at a value 40 % too small, and the force drifts: neither explains the other."""
    cold, warm = records
    drifting = replace(cold, force=cold.force + 80.0 * course(cold))
    weaker = {"layer_stiffness": 0.6 * BEARING.hysteresis.layer_stiffness}
    bearing = BEARING.model_copy(
        update={"hysteresis": BEARING.hysteresis.model_copy(update=weaker)}
    )
    fit = tb.identify_bearing([drifting, warm], bearing, starts=1, free=["s", "d_y"])
    evidence = {item.group.name: item for item in fit.uncertainty.assumed.evidence}
    assert [item.group.key for item in fit.uncertainty.suspects] == ["force_drift"]
    assert evidence["K_r"].contradicted
    assert not evidence["K_r"].imitated


@pytest.fixture(scope="module")
def two_starts() -> tb.Identification:
    """The sidecar of the cold test states 2 K less than its specimen had, as a thermocouple saw."""
    cold, warm = make_records(BEARING)
    readings = cold.ambient + np.zeros(len(cold.time))
    stated = replace(
        cold,
        ambient=cold.ambient - 2.0,
        temperatures={"T1": readings},
        places={"T1": "rubber 3"},
    )
    return tb.identify_bearing([stated, warm], BEARING, starts=1)


def test_each_temperature_is_a_cause_of_its_own(two_starts: tb.Identification) -> None:
    """Before, the first of a group of equal causes was the only one that was named."""
    suspects = [item for item in two_starts.summary()["suspects"] if item["named"]]
    first, starts = suspects[0], [item for item in suspects if item["ambient_degC"] is not None]
    signs = {item["ambient_degC"]: np.sign(item["size"]) for item in starts}
    assert signs == {-22.0: 1.0, 23.0: -1.0}
    assert first["plausible"]  # 3.5 usual errors, but measured
    assert (first["ambient_degC"], first["measured_K"]) == (-22.0, pytest.approx(2.0))
    assert first["sizes"][0] <= first["size"] <= first["sizes"][1]
    assert first["explains"] == "the difference of the force"
    (misfit,) = two_starts.uncertainty.misfit
    assert all(item["name"] in misfit for item in suspects)


@pytest.mark.parametrize(
    ("ambient", "sigmas", "possible", "state"),
    [
        (-10.0, -0.2, False, ""),
        (-10.0, 0.2, True, "yet as cold"),
        (40.0, -0.2, True, "yet as warm"),
        (40.0, 0.2, False, ""),
        (22.0, -0.2, True, "yet as warm"),  # rooms are cooler and warmer than that
        (22.0, 0.2, True, "yet as cold"),
    ],
)
def test_a_specimen_comes_from_a_room(
    ambient: float, sigmas: float, possible: bool, state: str
) -> None:
    (group,) = (item for item in chosen_groups(None) if item.key == CONDITIONING)
    evidence = Evidence(group.model_copy(update={"at": ambient}), sigmas, 0.01, 0.5)
    assert evidence.conceivable == possible
    assert state in evidence.cause


def test_the_lag_of_a_thermocouple_is_measured() -> None:
    time = np.linspace(0.0, 60.0, 3001)
    model = -20.0 + 15.0 * (1.0 - np.exp(-time / 8.0)) + np.sin(time)
    steady = lagged(time, np.where(time > 0.0, 1.0, 0.0), 2.0)
    np.testing.assert_allclose(steady[100], 1.0 - np.exp(-1.0), atol=0.005)  # after 2 s
    assert fit_lag(time, model, lagged(time, model, 2.0)) == (2.0, pytest.approx(1.0, abs=0.02))
    assert fit_lag(time, model, model) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("off", "level"), [(0.2, None), (-0.4, "note"), (0.6, "warning"), (-6.0, "warning")]
)
def test_a_thermocouple_that_begins_elsewhere_is_reported(off: float, level: str | None) -> None:
    cold, _ = make_records(BEARING)
    readings = {"T1": cold.ambient + off + np.zeros(len(cold.time))}
    report = check_test(replace(cold, temperatures=readings, places={"T1": "rubber 3"}))
    starts = [finding for finding in report.findings if finding.check == "thermocouple"]
    assert [finding.level for finding in starts] == ([] if level is None else [level])
    if abs(off) < 5.0:
        assert all(f'"{cold.ambient + off:.1f} degC"' in item.sentence for item in starts)


def test_keywords_of_a_calibration_are_the_fields_of_its_case() -> None:
    fields = get_type_hints(IdentifyCase)
    del fields["records"], fields["bearing"]
    assert get_type_hints(IdentifyKeywords) == fields


def test_ambient_temperatures_of_sentences_have_four_digits(records: Records) -> None:
    """The mean of the column of a chamber has all its digits."""
    cold = replace(records[0], ambient=-20.000857)
    fit = tb.identify_bearing(cold, BEARING, starts=1)
    held = [sentence for sentence in fit.warnings if "m_T" in sentence]
    assert held
    assert not any("-20.000" in sentence for sentence in fit.warnings)
