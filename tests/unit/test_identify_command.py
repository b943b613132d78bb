"""`thermobearing identify`: from files to a result directory that the other commands take."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import thermobearing as tb
from tests.unit.inputs import command, write_test
from thermobearing.border.toml import DIGITS, to_table
from thermobearing.identify.fit.forward import ForwardModel
from thermobearing.identify.fit.synthetic import synthetic_record
from thermobearing.identify.result import Identification
from thermobearing.identify.run import identify_bearing
from thermobearing.identify.uncertainty import posterior

HDR = tb.load_bearing("shen-hdr-specimen")
SHORT = tb.cyclic_test(strain=[0.5, 2.0], cycles=2, rest=600.0)
AMBIENTS = (0.0, 23.0)


def invoke(*words: object) -> tuple[int, str]:
    result = command("identify", *words)
    return result.exit_code, result.output


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("tests")
    for at in AMBIENTS:
        write_test(path, synthetic_record(HDR, at, SHORT, sampling=25.0), f"at{at:g}")
    return path


@pytest.fixture(scope="module")
def result() -> Identification:
    records = [synthetic_record(HDR, at, SHORT, sampling=25.0) for at in AMBIENTS]
    return identify_bearing(records, HDR, starts=1)


def test_fit_of_two_files(folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    files = (folder / "at0.csv", folder / "at23.toml")
    status, text = invoke(*files, "-o", out, "--predict", -20, "--json")
    assert status == 0, text
    summary = json.loads((out / "summary.json").read_text())
    assert summary["command"] == "identify"
    assert summary["outcome"] == "completed"
    stiffness = summary["parameters"]["hysteresis.layer_stiffness"]
    assert {"value", "unit", "stderr", "lower", "upper", "at_bound"} <= set(stiffness)
    assert stiffness["lower"] < 30.738 < stiffness["upper"]
    for record in summary["records"]:
        assert {"file", "ambient_degC", "R2", "NRMSE", "cycles"} <= set(record)
        assert {"cycle", "G_eq_error", "energy_error", "force_max_error"} <= set(
            record["cycles"][0]
        )
    assert summary["posterior"]["peak_force"][0]["ambient_degC"] == -20.0
    names = {path.stem for path in (out / "figures").iterdir()}
    assert names == {"loops", "residuals", "convergence", "correlation", "cycles", "band_-20"}
    assert json.loads(text.splitlines()[-1])["outcome"] == "completed"


def test_fitted_bearing_is_a_library_file(folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert invoke(folder / "at23.csv", "-o", out, "--no-figures", "-q")[0] == 0
    bearing = tb.load_bearing(out / "bearing.toml")
    summary = json.loads((out / "summary.json").read_text())
    key = "hysteresis.layer_stiffness"
    value = summary["parameters"][key]["value"]
    assert bearing.hysteresis.layer_stiffness == value
    assert "identified from at23" in bearing.sources[key]
    assert bearing.sources["geometry.rubber_layers"] == "Table 3.1"
    again = tb.run(bearing, tb.cyclic_test(strain=[1.0], cycles=1), ambient=23)
    assert again.outcome == "completed"
    compound = tb.load_compound(out / "compound.toml")
    assert "identified from at23" in compound.sources["rubber.shear_modulus"]
    size = {"plan": "240x240mm", "layers": "6x5mm", "shim": "3.2mm"}
    made = tb.new_bearing("again", compound, **size)
    for key, value in bearing.hysteresis.model_dump().items():
        same = value if value is None else pytest.approx(value, rel=10.0 ** (1 - DIGITS))
        assert getattr(made.hysteresis, key) == same, key
    assert made.tested_range == bearing.tested_range
    assert invoke(folder / "at23.csv", "-o", out, "--no-figures", "-q", "--overwrite")[0] == 0


def test_check_alone(folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    status, text = invoke(folder / "at0.csv", "--check", "-o", out)
    assert status == 0
    assert "at0: good" in text
    assert (out / "figures" / "check_1_at0.png").exists()
    assert json.loads((out / "summary.json").read_text())["records"][0]["outcome"] == "good"


def test_bad_tests_write_nothing_and_say_why(folder: Path, tmp_path: Path) -> None:
    record = synthetic_record(HDR, 0.0, SHORT, sampling=25.0)
    bad = write_test(tmp_path, record, "bad", "flip_force = true\n")
    out = tmp_path / "out"
    status, text = invoke(bad, "-o", out)
    assert status == 2
    assert "flip_force" in text
    assert not out.exists()
    status, text = invoke(bad, "--check", "-o", out)
    assert status == 2
    assert "REFUSED" in text
    assert out.exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--free", "K_x"], "no parameter"),
        (["--loss", "cubic"], "soft_l1"),
        (["--starts", "0"], "from 1 to"),
        (["--start", "nobody"], "no bearing"),
        (["--bearing", "nobody"], "no bearing"),
        (["--predict", "400"], "between -100 and 100"),
        ([], "no bearing is given"),
    ],
)
def test_wrong_options(folder: Path, tmp_path: Path, words: list[str], message: str) -> None:
    path = folder / "at0.csv"
    if not words:  # a file without its sidecar
        path = tmp_path / "t.csv"
        path.write_bytes((folder / "at0.csv").read_bytes())
    status, text = invoke(path, "-o", tmp_path / "out", *words)
    assert status == 2
    assert message in text
    assert not (tmp_path / "out").exists()


@pytest.mark.thorough
def test_saved_from_python(result: Identification, tmp_path: Path) -> None:
    ahead = posterior.forecast(result, [-20.0, 10.0])
    out = result.with_forecast(ahead).save(tmp_path / "out", figures=False)
    reported = json.loads((out / "summary.json").read_text())
    assert reported["posterior"]["source"] == "laplace"
    assert [band["ambient_degC"] for band in reported["posterior"]["peak_force"]] == [-20.0, 10.0]
    cold, peak = reported["posterior"]["peak_force"][0], ahead.bands[0]
    assert (cold["lower_kN"], cold["best_kN"]) == (peak.peak_lower, peak.peak)
    assert cold["lower_kN"] < cold["best_kN"] < cold["upper_kN"]
    rows = (out / "posterior.csv").read_text().splitlines()
    assert len(rows) == 1 + len(ahead.samples.cube)
    saved, fitted = tb.load_bearing(out / "bearing.toml"), result.bearing
    assert to_table(saved.hysteresis, DIGITS) == to_table(fitted.hysteresis, DIGITS)


def test_names_are_not_markup(result: Identification, capsys: pytest.CaptureFixture[str]) -> None:
    records = [replace(record, name="[/x]") for record in result.records]
    replace(result, records=records).show()
    assert "[/x]" in capsys.readouterr().out


@pytest.mark.parametrize("name", ["K_r", "hysteresis.layer_stiffness"])
@pytest.mark.parametrize("start_from", ["loops", "bearing"])
def test_chosen_bounds_hold(name: str, start_from: str) -> None:
    """Of a stiffness too, whose usual bounds follow its starting value; the truth is 30.7."""
    record = synthetic_record(HDR, 23.0, SHORT, sampling=25.0)
    options = {"free": ["K_r"], "starts": 1, "start_from": start_from}
    result = identify_bearing(record, HDR, bounds={name: (35.0, 60.0)}, **options)
    (item,) = result.uncertainty.estimates.values()
    assert (item.parameter.lower, item.parameter.upper) == (35.0, 60.0)
    assert item.at_bound
    assert 35.0 <= item.value < 36.0
    assert any("at its bound" in text for text in result.warnings)


def test_draws_have_the_intervals_of_the_table(result: Identification) -> None:
    draws = posterior._laplace_samples(result, 4000).cube
    low, high = np.quantile(draws, [0.025, 0.975], axis=0)
    for item, *ends in zip(result.uncertainty.estimates.values(), low, high, strict=True):
        interval = item.parameter.place(item.lower), item.parameter.place(item.upper)
        np.testing.assert_allclose(ends, interval, atol=0.1 * np.ptp(interval))


def test_samples_do_not_depend_on_the_eigenvectors(monkeypatch: pytest.MonkeyPatch) -> None:
    """LAPACK may choose any signs, and any axes where eigenvalues are equal."""
    axes = np.linalg.qr(np.arange(9.0).reshape(3, 3) ** 2 + np.eye(3))[0]
    values = np.array([4.0, 1.0, 1.0])
    covariance = (axes * values) @ axes.T
    expected = posterior._normal_draws(covariance, 5, np.random.default_rng(1))
    turned = axes.copy()
    turned[:, 0] *= -1.0
    turned[:, 1:] = axes[:, 1:] @ np.array([[0.6, -0.8], [0.8, 0.6]])
    monkeypatch.setattr(np.linalg, "eigh", lambda _: (values, turned))
    np.testing.assert_allclose(
        posterior._normal_draws(covariance, 5, np.random.default_rng(1)), expected, rtol=1e-12
    )


@pytest.mark.thorough
def test_band_at_a_temperature_that_was_not_tested(result: Identification) -> None:
    band = posterior._predictive_band(result, posterior._laplace_samples(result), -20.0)
    truth = ForwardModel(result.records[0], HDR, fine=True, ambient=-20.0).run(HDR)
    assert truth is not None
    assert band.peak_lower < np.abs(truth.force).max() < band.peak_upper
    inside = (band.lower <= truth.force) & (truth.force <= band.upper)
    assert inside.mean() > 0.8


@pytest.mark.thorough  # a change is seen by the golden case identify-posterior
def test_posterior_agrees_with_the_normal_distribution() -> None:
    """Of three parameters, for which walkers enough are half as many as for all."""
    records = [synthetic_record(HDR, at, SHORT, sampling=25.0) for at in AMBIENTS]
    result = identify_bearing(records, HDR, free=["K_r", "d_y", "n_T"], starts=1)
    samples = posterior._posterior_samples(result, steps=150, burn=100)
    spread = posterior._laplace_samples(result).cube.std(axis=0)
    assert 0.2 < samples.acceptance < 0.8
    np.testing.assert_allclose(samples.cube.std(axis=0), spread, rtol=0.5)
    assert (np.abs(samples.cube.mean(axis=0) - result.cube) < spread).all()


@pytest.mark.thorough
def test_what_a_posterior_takes_is_reported_before(
    result: Identification, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    runs, seconds = posterior.posterior_effort(result, steps=8, burn=2)
    assert seconds > 0.0
    before = result.problem.evaluations
    posterior._posterior_samples(result, steps=8, burn=2)
    used = (result.problem.evaluations - before - 1) * len(AMBIENTS)  # one for the variance
    assert 0.6 * runs < used <= runs  # those beyond a bound are not run
    monkeypatch.setattr("thermobearing.identify.run.run_identify", lambda case: result)
    monkeypatch.setattr(
        "thermobearing.identify.uncertainty.posterior._posterior_samples",
        lambda given, seed: posterior._laplace_samples(given, 50, seed=seed),
    )
    write_test(tmp_path, result.records[0], "cold")
    words = (tmp_path / "cold.csv", "--posterior", "--no-figures", "-o", tmp_path / "out")
    status, text = invoke(*words)
    assert status == 0, text
    whole = posterior.posterior_effort(result)[0]
    output = f"posterior: up to {whole} runs of the model through 2 tests, about "
    assert output in text, text
    assert text.index(output) < text.index("written:")
    assert "posterior:" not in invoke(*words, "--overwrite", "-q")[1]


def test_a_missing_emcee_is_reported_before_the_fit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "emcee", None)
    monkeypatch.setattr("thermobearing.identify.run.run_identify", lambda case: pytest.fail("fit"))
    file = tmp_path / "t.csv"
    file.write_text("time_s,displacement_mm,force_kN\n0,0,0\n1,2,3\n2,0,-1\n")
    words = (file, "--bearing", "shen-hdr-specimen", "--posterior", "-o", tmp_path / "out")
    status, text = invoke(*words)
    assert (status, "thermobearing[bayes]" in text) == (2, True), text
