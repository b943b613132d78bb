"""A calibration as a folder of quoFEM: its inputs, and a run of its model as quoFEM makes it."""

import json
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import thermobearing as tb
import thermobearing.validate.run  # before a test replaces what it imports
from tests import tolerances as tol
from tests.unit.inputs import command, write_test
from thermobearing.core.records import Floats
from thermobearing.identify import quofem
from thermobearing.identify.quofem import write_quofem

HDR = tb.load_bearing("shen-hdr-specimen")
SHORT = tb.cyclic_test(strain=[0.5, 2.0], cycles=2, rest=None)
# Of the three scales of the search: logarithm, logarithm of 1 + s, linear.
VALUES = {"ln_K_r": np.log(28.0), "ln1p_s": np.log1p(-0.8), "m_T": -1.2}
BEARING = {"layer_stiffness": 28.0, "shape": -0.8}
BEARING |= {"elastic_temperature_coefficient": -1.2, "hysteretic_temperature_coefficient": -3.0}


@pytest.fixture(scope="module")
def result() -> tb.Identification:
    """Two tests with weights, the second with a thermocouple in the rubber, and a tie."""
    cold, warm = (tb.synthetic_record(HDR, at, SHORT, sampling=25.0) for at in (0.0, 23.0))
    heat = 23.0 + 0.01 * warm.time
    places = {"inside": "rubber 3"}
    warm = replace(warm, weight=0.5, temperatures={"inside": heat}, places=places)
    cold = replace(cold, cycle_balance=0.5, first_cycle_weight=0.0)
    free = ["K_r", "s", "m_T", "n_T = 2.5 * m_T"]
    return tb.identify_bearing([cold, warm], HDR, free=free, starts=1, temperatures=True)


@pytest.fixture(scope="module")
def folder(result: tb.Identification, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_quofem(result, tmp_path_factory.mktemp("exchange") / "quofem")


def numbers(text: str) -> Floats:
    return np.array([float(word) for word in re.split(r"[ ,\t]+", text.strip())])


def run_as_quofem(folder: Path, work: Path, values: dict[str, float]) -> Floats:
    """Do what its driver does: templates, substitution, main script with the responses."""
    shutil.copytree(folder, work)
    table = json.loads((work / "bayesian.json").read_text())
    names = [variable["name"] for variable in table["randomVariables"]]
    values = dict.fromkeys((name for name in names if name.startswith("z_")), 0.0) | values
    assert set(names) == set(values)
    model = table["Applications"]["FEM"]["ApplicationData"]
    template = []
    for line in (work / model["parametersScript"]).read_text().splitlines():
        name = line.partition("=")[0].strip()
        template.append(f'{name} = "RV.{name}"' if name in names else line)
    text = "\n".join(template)
    for name in sorted(names, key=len, reverse=True):
        text = text.replace(f'"RV.{name}"', repr(float(values[name])))
    (work / model["parametersScript"]).write_text(text + "\n")
    words = [sys.executable, model["mainScript"], *(one["name"] for one in table["EDP"])]
    subprocess.run(words, cwd=work, check=True)
    return numbers((work / "results.out").read_text())


def test_residuals_are_those_of_identify(
    result: tb.Identification, folder: Path, tmp_path: Path
) -> None:
    """At other parameters than the start and the optimum; data and results have 12 digits."""
    results = run_as_quofem(folder, tmp_path / "work", VALUES)
    lines = (folder / "measured.csv").read_text().splitlines()
    assert len(lines) == 1  # one experiment
    measured = numbers(lines[0])
    values = {"K_r": 28.0, "s": -0.8, "m_T": -1.2}
    places = np.array([p.place(values[p.kind.symbol]) for p in result.pset.free])
    parts = result.problem.parts(places, fine=True)
    np.testing.assert_allclose(results - measured, np.concatenate(parts), atol=1e-10)
    # The force of the model, less its mean, on the weights; temperatures as they are.
    law = HDR.hysteresis.model_copy(update=BEARING)
    runs = [model.run(HDR.model_copy(update={"hysteresis": law})) for model in result.problem.fine]
    expected = []
    for record, weight, run in zip(
        result.problem.records, result.problem.weights, runs, strict=True
    ):
        assert run is not None
        for force, rows in ((run.force, expected), (record.force, [])):
            middle = (weight**2 * force).sum() / (weight**2).sum()
            rows.append(weight * (force - middle) / record.peak_force)
        expected += [np.sqrt(0.5) * 0.01 * values for values in run.temperatures.values()]
    np.testing.assert_allclose(results, np.concatenate(expected), atol=1e-10)


def test_what_is_held_moves_the_responses(
    result: tb.Identification, folder: Path, tmp_path: Path
) -> None:
    """The chamber 1.5 of its uncertainties (0.6 K) warmer, and more thickness by one of 2 %."""
    from thermobearing.identify.quofem import write_responses

    measured = numbers((folder / "measured.csv").read_text())
    work = shutil.copytree(folder, tmp_path / "work")
    moved = {"z_ambient_temperature_of_23_degC": 1.5, "z_thickness_of_the_rubber": 1.0}
    write_responses(VALUES | moved, work)
    places = [
        p.place({"K_r": 28.0, "s": -0.8, "m_T": -1.2}[p.kind.symbol]) for p in result.pset.free
    ]
    bearing = result.pset.bearing(np.array(places))
    thick = bearing.geometry.rubber_thickness * np.exp(0.02)
    geometry = bearing.geometry.model_copy(update={"rubber_thickness": thick})
    records = [replace(r, ambient=r.ambient + 0.9 * (r.ambient == 23.0)) for r in result.records]
    parts = result.problem.split_parts(bearing.model_copy(update={"geometry": geometry}), records)
    assert parts is not None
    results = numbers((work / "results.out").read_text())
    np.testing.assert_allclose(results - measured, np.concatenate(parts), atol=1e-9)


@pytest.mark.parametrize("engine", ["bayesian", "deterministic"])
def test_inputs_have_what_quofem_reads(
    engine: str, result: tb.Identification, folder: Path
) -> None:
    table = json.loads((folder / f"{engine}.json").read_text())
    assert {"Applications", "EDP", "FEM", "UQ", "randomVariables"} <= set(table)
    model = table["Applications"]["FEM"]
    assert model["Application"] == "OpenSeesPy"
    data = model["ApplicationData"]
    assert {"mainScript", "MS_Path", "parametersScript", "PA_Path", "postprocessScript"} == set(
        data
    )
    uq = table["UQ"]
    if engine == "bayesian":
        assert table["Applications"]["UQ"]["Application"] == "UCSD-UQ"
        assert {"seed", "numParticles", "logLikelihoodFile", "logLikelihoodPath"} <= set(uq)
        files = [uq["calDataFilePath"] + uq["calDataFile"]]
    else:
        assert table["Applications"]["UQ"]["Application"] == "Dakota-UQ"
        inner = uq["calibrationMethodData"]
        assert {"method", "maxIterations", "convergenceTol"} <= set(inner)
        files = [inner["calibrationDataFile"]]
    files += [data["MS_Path"] + data["mainScript"], data["PA_Path"] + data["parametersScript"]]
    for file in files:
        assert Path(file.replace("{Current_Dir}", str(folder))).is_file()
    assert {item["type"] for item in table["EDP"]} == {"field"}
    length = len(numbers((folder / "measured.csv").read_text()))
    assert sum(item["length"] for item in table["EDP"]) == length
    free = [item for item in table["randomVariables"] if not item["name"].startswith("z_")]
    changes = table["randomVariables"][len(free) :]
    for item, group in zip(changes, result.uncertainty.assumed.groups, strict=engine == "bayesian"):
        assert item["name"].isidentifier()
        assert (item["distribution"], item["mean"]) == ("Normal", 0.0)
        assert item["stdDev"] == group.widening >= 1.0
    assert bool(changes) is (engine == "bayesian")
    for item, parameter in zip(free, result.pset.free, strict=True):
        assert item["value"] == f"RV.{item['name']}"
        assert item["name"].isidentifier()
        back = {"ln_": np.exp, "ln1p_": np.expm1}.get(re.sub(r"_.*", "_", item["name"]), float)
        for end, value in (("lowerbound", parameter.lower), ("upperbound", parameter.upper)):
            assert back(item[end]) == pytest.approx(value, rel=tol.ROUNDING)
        if engine == "deterministic":
            assert item["distribution"] == "ContinuousDesign"
            assert back(item["initialpoint"]) == pytest.approx(parameter.value, rel=tol.ROUNDING)
        else:
            assert item["distribution"] == "Uniform"
    worth = result.uncertainty
    ratio = np.sqrt(worth.samples / worth.effective_samples)
    assert f"by {ratio:.2f}, the square root" in (folder / "README.md").read_text()


def test_a_test_that_ends_early_is_far_from_the_data(
    result: tb.Identification, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from thermobearing.identify.fit.forward import ForwardModel
    from thermobearing.identify.fit.problem import LOST
    from thermobearing.identify.quofem import write_responses

    monkeypatch.setattr(ForwardModel, "run", lambda *_: None)
    work = shutil.copytree(folder, tmp_path / "work")
    write_responses(VALUES, work)
    results = numbers((work / "results.out").read_text())
    np.testing.assert_allclose(results - numbers((folder / "measured.csv").read_text()), LOST)


def test_the_command_writes_the_folder(
    result: tb.Identification, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("thermobearing.identify.run.run_identify", lambda case: result)
    file, out = write_test(tmp_path, result.records[0], "cold"), tmp_path / "out"
    for more in ([], ["--overwrite"]):
        done = command("identify", file, "-o", out, "--quofem", "--no-figures", *more)
        assert done.exit_code == 0, done.output
        assert (out / "quofem" / "bayesian.json").is_file()
    assert "quofem" in done.output


def test_files_of_one_name_do_not_overwrite_each_other(
    result: tb.Identification, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Laws of two folders, and one that is named as the driver."""
    files = [tmp_path / name for name in ("a/law.py", "b/law.py", "c/Law.py", "c/model.py")]
    for file in files:
        file.parent.mkdir(exist_ok=True)
        file.write_text(f"# {file.parent.name}/{file.name}")
    monkeypatch.setattr(quofem, "loaded_files", lambda: list(map(str, files)))
    folder = write_quofem(result, tmp_path / "quofem")
    copies = json.loads((folder / "calibration.json").read_text())["laws"]
    texts = [(folder / name).read_text() for name in copies]
    assert texts == [file.read_text() for file in files]
    assert len({name.casefold() for name in [*copies, "model.py", "params.py"]}) == 6
