"""Calibrations to tests under several axial forces, which act on the shear force of the model."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import thermobearing as tb
from tests.conftest import Recorder
from thermobearing.identify.fit.forward import ForwardModel, unstable_tests
from thermobearing.identify.records.record import AxialRecord, TestRecord
from thermobearing.model.options import ModelOptions

PRESSURES = 2.0, 12.0  # MPa
NOISE = 0.01  # of the largest force
LAYER_STIFFNESS = "hysteresis.layer_stiffness"


@pytest.fixture(scope="module")
def slender() -> tb.Bearing:
    return tb.new_bearing("slender", "shen-hdr", plan="350x350mm", layers="8x17mm", shim="4 mm")


def pressed(bearing: tb.Bearing, force: float) -> tb.Result:
    """A cyclic test under a constant axial force [kN]."""
    test = tb.cyclic_test(strain=[0.5, 1.0], cycles=2, rest=60, wave="sine", dt=0.01)
    return tb.run(bearing, test, axial_force=force, axial="constant", ambient=23.0)


@pytest.fixture(scope="module")
def records(slender: tb.Bearing) -> list[TestRecord]:
    """Two tests of the bearing that differ in their axial force, which they state."""
    rng, made = np.random.default_rng(1), []
    for pressure in PRESSURES:
        force = pressure * slender.area / 1e3
        run = pressed(slender, force)
        assert run.outcome == "completed"
        rows = slice(None, None, 2)
        x, shear = (run[name].values[0][rows] for name in ("displacement", "force"))
        noisy = shear + NOISE * np.abs(shear).max() * rng.normal(size=len(shear))
        name = f"{pressure:g} MPa"
        record = tb.record_from_arrays(
            run.time(0)[rows], x, noisy, 23.0, name=name, axial_force=force
        )
        made.append(record)
    return made


def test_the_axial_force_of_a_test_is_no_stiffness(
    slender: tb.Bearing, records: list[TestRecord], measured: Recorder
) -> None:
    true = slender.hysteresis.layer_stiffness
    bias = {}
    for name, tests in {
        "without": [replace(record, axial=None) for record in records],
        "with": records,
    }.items():
        fit = tb.identify_bearing(tests, slender, free=["K_r", "d_y"], starts=1, accept_poor=True)
        bias[name] = fit.values[LAYER_STIFFNESS] / true - 1.0
    assert bias["without"] < -0.05
    assert abs(bias["with"]) < 0.01
    measured("K_r of tests at 2 and 12 MPa, with their axial forces", abs(bias["with"]), "0.01")


def test_steps_along_legs_follow_the_law(slender: tb.Bearing, records: list[TestRecord]) -> None:
    heavy, expected = records[-1], pressed(slender, PRESSURES[-1] * slender.area / 1e3)
    share = (expected["axial_force"].values / expected["critical_load"].values).max()
    assert 0.8 < share < 1.0
    runs = [ForwardModel(heavy, slender, fine=fine).run() for fine in (True, False)]
    plain = ForwardModel(replace(heavy, axial=None), slender, fine=True).run()
    assert plain is not None
    for run in runs:
        assert run is not None
        rms = float(np.sqrt(np.mean((run.force - heavy.force) ** 2))) / heavy.peak_force
        assert rms < 2.0 * NOISE
        assert run.critical_share == pytest.approx(share, rel=0.002)
    assert np.abs(plain.force - heavy.force).max() > 0.2 * heavy.peak_force
    assert plain.critical_share is None


def test_another_bearing_has_its_own_column(slender: tb.Bearing, records: list[TestRecord]) -> None:
    heavy = records[-1]
    wider = tb.new_bearing("wider", "shen-hdr", plan="400x400mm", layers="8x17mm", shim="4 mm")
    rebuilt = ForwardModel(heavy, slender).rebuilt(wider).run()
    expected = ForwardModel(heavy, wider).run()
    assert rebuilt is not None
    assert expected is not None
    assert (rebuilt.force == expected.force).all()


def test_a_history_acts_at_its_time(slender: tb.Bearing) -> None:
    """An axial force that changes with every sample, against the cyclic test under it."""
    time = 0.02 * np.arange(400)
    x = 120.0 * np.sin(time)
    pressing = 900.0 + 700.0 * np.sin(9.0 * time)
    run = tb.run(slender, (time, x), ambient=23.0, dt=0.03, axial_force=(time, pressing))
    force = run["force"].values[0]
    record = tb.record_from_arrays(time, x, force, 23.0, axial_force=pressing)
    predicted = ForwardModel(record, slender, fine=True).run()
    assert predicted is not None
    # Kappa of the end of each step, which is what the next step of the cyclic test takes.
    kappa = run["stiffness_reduction"].values[0]
    expected = force[:-1] + (kappa[:-1] - kappa[1:]) * x[:-1]
    assert np.abs(expected - force[:-1]).max() > 0.01 * np.abs(force).max()
    assert np.abs(predicted.force[:-1] - expected).max() < 1e-12 * np.abs(force).max()


def test_an_unstable_test_is_named(slender: tb.Bearing, records: list[TestRecord]) -> None:
    heavy = records[-1]
    assert heavy.axial is not None
    heavier = replace(heavy, axial=AxialRecord(heavy.axial.time, 1.3 * heavy.axial.force))
    tests = [heavy, heavier]
    runs = [ForwardModel(test, slender).run() for test in tests]
    (sentence,) = unstable_tests(tests, runs)
    assert sentence.startswith("12 MPa: ")
    with pytest.raises(tb.InputError, match="bilinear"):
        ForwardModel(heavy, slender, options=ModelOptions(model="bilinear"))


def write(folder: Path, keys: str) -> Path:
    rows = [f"{t:.2f},{np.sin(t):.4f},{3 * np.sin(t):.4f},{500 + t:.2f}" for t in np.arange(40) / 5]
    file = folder / "pressed.csv"
    file.write_text("time_s,displacement_mm,force_kN,N [kN]\n" + "\n".join(rows))
    file.with_suffix(".toml").write_text(f'ambient = "23 degC"\n{keys}')
    return file


COLUMN = '[columns]\naxial_force = "N [kN]"\n'


def test_sidecars_state_axial_forces(tmp_path: Path) -> None:
    history = tb.load_test(write(tmp_path, f'axial = "history"\n{COLUMN}'))
    assert history.axial is not None
    assert history.axial.at(np.array([0.0, 1.0, 9e9])).tolist() == [500.0, 501.0, 507.8]
    constant = tb.load_test(write(tmp_path, 'axial_force = "0.8 MN"\naxial = "constant"\n'))
    assert constant.axial is not None
    assert set(constant.axial.force) == {800.0}
    for keys in (COLUMN, 'axial_force = "800 kN"\n', f'axial = "off"\n{COLUMN}', ""):
        record = tb.load_test(write(tmp_path, keys))
        assert record.axial is None
        assert record.peak_force == pytest.approx(3.0, rel=0.01)


@pytest.mark.parametrize("keys", ['axial = "history"\n', 'axial = "constant"\n', 'axial = "on"\n'])
def test_sidecars_without_the_force_are_refused(tmp_path: Path, keys: str) -> None:
    with pytest.raises(tb.InputError, match="axial"):
        tb.load_test(write(tmp_path, keys))


@pytest.mark.parametrize("force", [[1.0, 2.0], float("nan"), "heavy"])
def test_axial_forces_that_are_no_samples_are_refused(force: object) -> None:
    time = np.linspace(0.0, 10.0, 50)
    with pytest.raises(tb.InputError):
        tb.record_from_arrays(time, np.sin(time), np.sin(time), 23.0, axial_force=force)  # type: ignore[arg-type]
