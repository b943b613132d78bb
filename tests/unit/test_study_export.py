"""Studies as files of pelicun: demand samples with units, and fragility curves."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.special import ndtr

import thermobearing as tb
from tests import tolerances as tol
from tests.unit.inputs import command
from tests.unit.made_up_study import ask, beyond_limit
from tests.unit.studies import small_study
from thermobearing.studies.report import write_pelicun
from thermobearing.studies.result import StudyResult, study_result
from thermobearing.studies.run.engine import run_study

TEMPERATURES = {"minus20degC": -20.0, "23degC": 23.0}


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> StudyResult:
    folder = tmp_path_factory.mktemp("pelicun") / "study"
    factors = {
        "bearing": ["shen-hdr-bridge"],
        "motion": ["jra-ii-i-1", "jra-ii-i-2", "jra-ii-i-3"],
        "scale": [0.5, 1.0, 1.5],
    }
    run_study(small_study({"duration": "8 s"}, **factors), folder, jobs=1)
    return study_result(folder)


def test_demands_are_those_of_the_runs(study: StudyResult, tmp_path: Path) -> None:
    """A header of event, type, place and direction; a row of units; a row for each run."""
    assert write_pelicun(study, tmp_path / "out") == ([], [])
    assert not (tmp_path / "out" / "damage.csv").exists()
    for name, ambient in TEMPERATURES.items():
        table = pd.read_csv(tmp_path / "out" / f"demand-{name}.csv", index_col=0, dtype=str)
        runs = study.table[study.table["ambient_degC"] == ambient]
        assert table.loc["Units", "1-PFA-1-1"] == "mps2"
        assert all(len(head.split("-")) == 4 for head in table)
        values = table.drop("Units").astype(float)
        for head, column in (
            ("1-PGA-1-1", "PGA_m_s2"),
            ("1-PFA-1-1", "deck_acceleration_max_m_s2"),
            ("1-PID-1-1", "pier_drift_max"),
            ("1-BSS-1-1", "bearing_strain_max"),
        ):
            np.testing.assert_allclose(values[head], runs[column], rtol=tol.ROUNDING)


def test_components_are_the_fragility_curves(study: StudyResult, tmp_path: Path) -> None:
    """Median and dispersion of the curve of each temperature, in the unit of the demand file."""
    folder = tmp_path / "out"
    done = command(
        "study", "export", str(study.directory), "-o", str(folder),
        "--capacity", "pier_ductility=0.25", "--capacity", "bearing_strain_max=9",
    )  # fmt: skip
    assert done.exit_code == 0, done.stderr
    table = pd.read_csv(folder / "damage.csv", index_col="ID")
    curves = study.fragilities(0.25, "pier_ductility")
    known = {
        f"{name}.pier_ductility.0.25": curves[ambient]
        for name, ambient in TEMPERATURES.items()
        if np.isfinite(curves[ambient].dispersion)
    }
    assert known
    assert set(table.index) == set(known)
    assert set(table["Demand-Type"]) == {"Peak Ground Acceleration"}
    assert set(table["Demand-Unit"]) == {"mps2"}
    for name, curve in known.items():
        row = table.loc[name]
        assert row["LS1-Theta_0"] == pytest.approx(curve.median)
        assert row["LS1-Theta_1"] == pytest.approx(curve.dispersion)
    assert "bearing_strain_max.9" in done.stdout  # no run goes so far


def test_failed_runs_count_once(tmp_path: Path) -> None:
    """Demands are those of completed runs; curves count all runs, and so have all intensities."""
    result = ask(beyond_limit(), capacity=1.0).select(bearing="shen-hdr-bridge")
    exported = write_pelicun(result, tmp_path)
    damage = pd.read_csv(tmp_path / "damage.csv", index_col="ID")
    lost = {}
    for name, runs in result.table.groupby(
        result.table["ambient_degC"].map("{:g}degC".format).str.replace("-", "minus")
    ):
        completed = runs["outcome"] == "completed"
        demands = pd.read_csv(tmp_path / f"demand-{name}.csv", index_col=0)
        assert len(demands) - 1 == completed.sum()
        table = pd.read_csv(tmp_path / f"intensity-{name}.csv", index_col=0)
        intensity = table["1-PGA-1-1"].drop("Units").astype(float)
        np.testing.assert_allclose(intensity, runs["PGA_m_s2"], rtol=tol.ROUNDING)
        if not completed.all():
            lost[f"demand-{name}.csv"] = (~completed).sum(), len(runs)
        component = damage.loc[f"{name}.pier_ductility.1"]
        curve = np.log(intensity / component["LS1-Theta_0"]) / component["LS1-Theta_1"]
        # A lognormal curve repeats the share of all runs within the rounding of a few runs.
        by_hand = (~completed | (runs["pier_ductility"] > 1.0)).mean()
        assert ndtr(curve).mean() == pytest.approx(by_hand, abs=0.02)
    assert lost == {"demand-minus20degC.csv": (4, 36), "demand-0degC.csv": (1, 36)}
    assert len(exported.not_in_demand) == len(lost)
    for sentence, (file, (failed, runs)) in zip(
        exported.not_in_demand, sorted(lost.items(), reverse=True), strict=True
    ):
        assert sentence.startswith(f"{failed} of {runs} runs ")
        assert f"not in {file}: " in sentence
        assert "pier" in sentence


def test_outcomes_of_runs_that_are_not_exported(tmp_path: Path) -> None:
    """Several outcomes are counted by name."""
    result = beyond_limit().select(bearing="shen-hdr-bridge", ambient_degC=-20.0)
    failed = result.table.index[result.table["outcome"] != "completed"]
    result.table.loc[failed[0], "outcome"] = "lead_melted"
    (sentence,) = write_pelicun(result, tmp_path).not_in_demand
    assert f"{len(failed) - 1} pier_beyond_limit and 1 lead_melted" in sentence


def test_errors(study: StudyResult, tmp_path: Path) -> None:
    write_pelicun(study, tmp_path)
    with pytest.raises(tb.OutputError, match="--overwrite"):
        write_pelicun(study, tmp_path)
    with pytest.raises(tb.InputError, match="pier_ductility"):
        write_pelicun(study, tmp_path / "new", capacities={"pier_ductilty": 4.0})
    assert not (tmp_path / "new").exists()
