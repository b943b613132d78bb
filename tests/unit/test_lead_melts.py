"""Lead that melts ends a run with that outcome, whatever analysis moves the bearing."""

from pathlib import Path

import numpy as np
import pytest

import thermobearing as tb
from thermobearing.design.run import run_bounds, run_factors
from thermobearing.model.earlier import Model
from thermobearing.model.outcomes import SENTENCES
from thermobearing.structure.run import Method

MELTS = "temperature_runaway"
LEAD = "shen-lhdr-specimen"
CYCLES = {"step": "cycles", "strain": 2.5, "speed": 1000.0, "count": 60}
HOT = tb.CyclicTest(dt=0.02, steps=[CYCLES])


@pytest.fixture(scope="module")
def shake(tmp_path_factory: pytest.TempPathFactory) -> dict[str, object]:
    """A sine near the period of a pier on its bearings, far beyond any earthquake."""
    file = tmp_path_factory.mktemp("motion") / "sine.csv"
    t = np.arange(0.0, 20.0, 0.01)
    a = 500.0 * np.sin(2.0 * np.pi * t / 1.2)
    rows = "\n".join(f"{x:.2f},{y:.3f}" for x, y in zip(t, a, strict=True))
    file.write_text(f"t_s,acc_gal\n{rows}\n")
    return {"name": str(file), "factor": 3.0}


def test_the_sentence_says_so() -> None:
    assert "the lead reached 327 degC (it melts)" in " ".join(SENTENCES[MELTS].split())


@pytest.mark.parametrize("model", ["multi-layer", "adiabatic", "lead-alone", "temperature-blind"])
def test_cyclic(model: Model) -> None:
    result = tb.run(LEAD, HOT, model=model)
    assert (result.outcome, result.sentence) == (MELTS, SENTENCES[MELTS])
    assert 320.0 < np.nanmax(result["lead_temperature"]) <= 327.5


@pytest.mark.parametrize("method", ["average-acceleration", "predictor-corrector"])
def test_structures(method: Method, shake: dict[str, object]) -> None:
    """With Newmark's method halving the step does not cool the lead (before: no_equilibrium)."""
    study = tb.bridge("shen-lhdr-bridge", shake, 23.0, method=method)
    assert study.outcome == MELTS
    assert any("lead 327" in text and "above the 96 degC" in text for text in study.warnings)


def test_validation(tmp_path: Path) -> None:
    t = np.arange(0.0, 12.0, 0.005)
    x = 75.0 * np.sin(2.0 * np.pi * t / 0.3)
    record = tb.record_from_arrays(t, x, 3.0 * x + 90.0 * np.sign(np.gradient(x)), 23.0)
    found = tb.validate_bearing(LEAD, record)
    assert list(found.table["outcome"]) == [MELTS]
    assert found.outcome == "partly"
    assert SENTENCES[MELTS] in found.sentence
    assert found.summary()["comparisons"][0]["outcome"] == MELTS


def test_factors_and_bounds(shake: dict[str, object]) -> None:
    with pytest.raises(tb.InputError, match=r"temperature_runaway at 250%: .* melts"):
        run_factors([LEAD], temperatures=[0.0], strains=[2.5], speed=1000.0, cycles=[100])
    pier = tb.load_structure("pier-p1")
    limits = pier.limits.model_copy(update={"ductility": 1000.0, "drift": 1.0})
    pier = pier.model_copy(update={"limits": limits})  # or the pier ends the run before
    report = run_bounds(["shen-lhdr-bridge"], [shake], [23.0, 0.0], structure=pier)
    assert report.outcome == MELTS
    assert report.summary()["outcome"] == MELTS
    assert report.sentence == SENTENCES[MELTS]
