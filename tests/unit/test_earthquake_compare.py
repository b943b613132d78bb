"""Earlier models in earthquakes: which run, how their errors are reported, and the verdict."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import thermobearing as tb
from tests.unit.inputs import command
from thermobearing.earthquake.analysis import compare_models, refuse_incomparable
from thermobearing.earthquake.case import make_earthquake_case
from thermobearing.earthquake.earlier import _underestimates, comparison_table, verdict
from thermobearing.model.earlier import models_that_fit

HDR, LHDR = "shen-hdr-specimen", "shen-lhdr-specimen"


@pytest.fixture(scope="module")
def results() -> Any:
    table = {"command": "hybrid", "bearings": [HDR, LHDR], "duration": "11 s"}
    return compare_models(make_earthquake_case(table, "test", ambient=[-20.0, 23.0]))


def test_every_model_runs_with_the_bearings_that_it_fits(results: Any) -> None:
    assert list(results) == models_that_fit(tb.load_bearing(LHDR))
    for name, result in results.items():
        reported = set(result["bearing"].values)
        assert reported == ({LHDR} if name == "lead-alone" else {HDR, LHDR})
        assert f'model = "{name}"' in result.dataset.attrs["case"]


def test_errors_are_those_of_the_same_run(results: Any) -> None:
    rows = comparison_table(results)
    assert len(rows) == 5 * 4 + 2
    row = rows.query("model == 'single-temperature' and bearing == @LHDR and ambient_degC == -20")
    assert len(row) == 1
    row = row.iloc[0]
    truth, other = results["multi-layer"], results["single-temperature"]
    run = int(truth.table.query("bearing == @LHDR and ambient_degC == -20").index[0])
    inner = [r["rubber_temperature"].values[run, :, k] for r, k in ((truth, 2), (other, 3))]
    error = (inner[1] - inner[0]).astype(float)
    assert row["inner layer rms K"] == pytest.approx(np.sqrt(np.mean(error**2)))
    assert row["inner layer largest K"] == pytest.approx(error[np.abs(error).argmax()])
    assert row["inner layer rise K"] == pytest.approx(inner[1].max() - inner[0].max(), rel=1e-5)
    assert row["underestimates inner layer"]
    lead = [r["lead_temperature"].values[run].astype(float) for r in (truth, other)]
    assert row["lead rms K"] == pytest.approx(np.sqrt(np.mean((lead[1] - lead[0]) ** 2)))
    for column, name in (
        ("peak strain %", "bearing_strain_max"),
        ("energy %", "bearing_energy_end"),
    ):
        ratio = float(other[name].values[run] / truth[name].values[run])
        assert row[column] == pytest.approx(100.0 * (ratio - 1.0))
    alone = rows.query("model == 'lead-alone' and ambient_degC == -20").iloc[0]
    first = results["lead-alone"]["lead_temperature"].values[0].astype(float)
    assert alone["lead rms K"] == pytest.approx(np.sqrt(np.mean((first - lead[0]) ** 2)))
    hdr = rows[rows["bearing"] == HDR]
    assert hdr["lead rms K"].isna().all()
    blind = rows[rows["model"] == "bilinear"]
    assert (blind["inner layer rise K"] < 0.0).all()


@pytest.mark.parametrize(
    ("result", "lower"),
    [
        ([0.0, 1.0, 2.0], True),
        ([0.0, 0.5, 4.0], False),  # in the mean only
        ([0.0, 2.9, 2.9], False),  # at its largest only
        ([0.0, 2.5, 4.0], False),
    ],
)
def test_underestimated(result: list[float], lower: bool) -> None:
    expected = np.array([0.0, 2.0, 3.0])
    assert _underestimates(np.array(result) + 20.0, expected + 20.0) == lower


@pytest.mark.parametrize(
    ("rises", "pieces"),
    [
        ((-2.0, -1.0), ["in 2 of 2 runs", "-2.0 to -1.0 K"]),
        ((-2.0, 1.5), ["in 1 of 2 runs", "-2.0 to +1.5 K", "not in b, m, 0"]),
    ],
)
def test_verdict(rises: tuple[float, float], pieces: list[str]) -> None:
    rows = pd.DataFrame(
        {
            "bearing": ["a", "b", "b"],
            "motion": "m",
            "ambient_degC": 0,
            "model": ["single-temperature", "single-temperature", "adiabatic"],
            "inner layer rise K": [*rises, 9.0],
            "underestimates inner layer": [rises[0] < 0.0, rises[1] < 0.0, False],
        }
    )
    for piece in pieces:
        assert piece in verdict(rows)


@pytest.mark.thorough
def test_compare_on_the_command_line(tmp_path: Path) -> None:
    words = ["--bearing", HDR, "--bearing", "shen-bilinear-bridge", "--ambient", 0]
    out = tmp_path / "out"
    done = command("hybrid", *words, "--duration", 3, "--compare", "-o", out)
    assert done.exit_code == 0, done.output
    reported = json.loads((out / "summary.json").read_text())["verdict"]
    assert reported.startswith("a single temperature underestimates the inner layer in")
    rows = pd.read_csv(out / "comparison.csv")
    assert set(rows["bearing"]) == {HDR}
    assert {"comparison.png", "comparison_loops.png"} <= {p.name for p in out.glob("figures/*")}
    assert "adiabatic" in done.output


def test_a_model_on_the_command_line(tmp_path: Path) -> None:
    words = ["--bearing", HDR, "--ambient", 0, "--duration", 1, "--no-figures"]
    done = command("hybrid", *words, "--model", "single-temperature", "-o", tmp_path / "one")
    assert done.exit_code == 0, done.output
    assert 'model = "single-temperature"' in (tmp_path / "one" / "case.resolved.toml").read_text()


@pytest.mark.parametrize(
    ("words", "piece"),
    [
        (["--bearing", "shen-bilinear-bridge"], "--bearing: all are bilinear"),
        (["--bearing", HDR, "--model", "adiabatic"], '--model = "adiabatic"'),
    ],
)
def test_what_cannot_be_compared(words: list[str], piece: str, tmp_path: Path) -> None:
    done = command("bridge", *words, "--compare", "-o", tmp_path / "out")
    assert done.exit_code == 2
    assert piece in done.output
    assert "Traceback" not in done.output
    assert not (tmp_path / "out").exists()


def test_only_the_conservative_scheme_can_be_compared() -> None:
    case = make_earthquake_case({"command": "bridge"}, "test", scheme="published", stack="half")
    with pytest.raises(tb.InputError) as caught:
        refuse_incomparable(case)
    assert len(caught.value.problems) == 2
