"""Parts of a sequence are one history: the same as in one run, whatever drives the specimen."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests import tolerances as tol
from thermobearing.earthquake.run import build_tasks, run_task
from thermobearing.model.handover import MEMORY, PREFIX
from thermobearing.sequences.case import SequenceCase, make_sequence_case
from thermobearing.sequences.run import run_sequence

SINE = {"step": "cycles", "strain": 1.5, "wave": "sine", "period": "3 s", "count": 1}
LOADED = {"step": "ramp", "to_strain": 0.8, "speed": "40 mm/s"}
BACK = {"step": "ramp", "to": "0 mm", "speed": "25 mm/s"}
HYBRID = {"part": "hybrid", "duration": "6 s", "motion": {"name": "jra-ii-ii-1", "factor": 0.7}}
DT = "30 ms"


def case_of(*parts: dict[str, Any], **table: Any) -> SequenceCase:
    usual = {"bearing": "shen-lhdr-specimen", "ambient": "-20 degC", "between": "as-left"}
    return make_sequence_case({**usual, **table, "parts": list(parts)}, "test")


def cyclic(*steps: dict[str, Any], **table: Any) -> dict[str, Any]:
    return {"part": "cyclic", "dt": DT, "steps": list(steps), **table}


def the_same_end(found: Any, wanted: Any) -> None:
    for key in (*(PREFIX + key for key in MEMORY), "final_temperature", "final_lead_temperature"):
        scale = max(float(np.abs(wanted[key]).max()), 1e-300)
        one, other = found[key].values / scale, wanted[key].values / scale
        assert_allclose(one, other, rtol=0, atol=tol.CUT, err_msg=key)


def test_cyclic_parts_are_one_test() -> None:
    rest = {"step": "rest", "duration": "20 s"}
    whole = run_sequence(case_of(cyclic(SINE, LOADED, rest, BACK, SINE)))
    rest_part = {"part": "rest", "duration": "20 s"}
    # A part of rest has its own longest step; the default of a test is what both have here.
    parts = run_sequence(case_of(cyclic(SINE, LOADED), cyclic(rest), cyclic(BACK, SINE)))
    the_same_end(parts[2], whole[0])
    assert run_sequence(case_of(cyclic(LOADED), rest_part))[1].outcome == "completed"
    assert_allclose(
        parts.table["energy_kN_mm"].sum(), whole.table["energy_kN_mm"].sum(), rtol=tol.CUT
    )


def test_a_hybrid_part_is_the_history_that_it_imposed(tmp_path: Path) -> None:
    """Its displacements recorded, and imposed on the same specimen together with what follows."""
    case = case_of(cyclic(SINE), HYBRID, cyclic(BACK, SINE))
    found = run_sequence(case)
    hybrid = case.whole_part(1, None).model_copy(
        update={"initial_state": _state_after(case_of(cyclic(SINE)))}
    )
    (task,) = build_tasks(hybrid)  # type: ignore[arg-type]
    books = run_task(task).rows.bearings[:, 0]
    rows = zip(books["clock"].tolist(), books["displacement"].tolist(), strict=True)
    file = tmp_path / "hybrid.csv"
    text = "".join(f"{t!r},{x!r}\n" for t, x in rows)
    file.write_text("time_s,displacement_mm\n" + text)
    assert np.abs(books["displacement"]).max() > 15.0
    recorded = {"step": "recorded", "file": str(file)}
    whole = run_sequence(case_of(cyclic(SINE, recorded, BACK, SINE)))
    the_same_end(found[2], whole[0])


def _state_after(case: SequenceCase) -> Any:
    from thermobearing.cyclic.case import final_state

    return final_state(run_sequence(case)[0].dataset, [-20.0])


@pytest.mark.parametrize("method", ["predictor-corrector", "average-acceleration"])
def test_the_force_at_rest_moves_no_structure(method: str) -> None:
    """It is in balance when the hybrid part begins; and the books of all parts close."""
    still = {**HYBRID, "motion": {"name": "jra-ii-ii-1", "factor": 1e-6}, "method": method}
    cooled = {"part": "rest", "duration": "24 h"}  # the rate branch has relaxed
    found = run_sequence(case_of(cyclic(LOADED), cooled, still))
    history = found.history(2)
    assert history["force_kN"].iloc[0] > 100.0
    assert_allclose(history["displacement_mm"], 24.0, atol=tol.STILL)
    shaken = run_sequence(case_of(cyclic(LOADED), {**HYBRID, "method": method}))
    energy = shaken[1].energy.iloc[0]
    assert abs(energy["mechanical_residual"]) < tol.ENERGY_BOOKS
    assert abs(energy["thermal_residual"]) < tol.ENERGY_BOOKS
    if method == "average-acceleration":
        assert abs(energy["structure_residual"]) < tol.STRUCTURE_BOOKS


def test_unloaded_specimens_start_from_zero() -> None:
    case = case_of(cyclic(LOADED), cyclic(SINE), between="unloaded")
    found = run_sequence(case)
    table = found.table
    assert abs(table["force_start_kN"][1]) < tol.UNLOADED
    assert table["displacement_start_mm"][1] == 0.0
    assert table["force_end_kN"][0] > 100.0
    state = found.parts[1].dataset
    zero = float(state[PREFIX + "displacement"][0])  # the cycle ends at the zero of instruments
    assert 1.0 < zero < 24.0
    # A loop around it: its mean force is the elastic one of the rubber there.
    loop = found.history(1)
    assert loop["displacement_mm"].max() == pytest.approx(45.0)
    assert loop["force_kN"].max() > -loop["force_kN"].min()
    left = run_sequence(case_of(cyclic(LOADED), cyclic(BACK, SINE)))
    assert abs(left.table["force_start_kN"][1]) > 100.0


@pytest.mark.thorough
def test_a_second_hybrid_test_is_that_of_a_specimen_without_force() -> None:
    """Second over first peak: an offset of force made it 1.05, without it 0.996."""
    steps = [BACK, SINE | {"strain": 2.5, "count": 5, "closing_strain": 0.1}]
    rest = {"part": "rest", "duration": "1.25 h"}
    first = {"part": "hybrid", "duration": "20 s"}
    for between, ratio, start in (("unloaded", 0.996, 0.0), ("as-left", 1.05, 56.0)):
        parts = (first, rest, cyclic(*steps, dt="5 ms"), rest, first)
        table = run_sequence(case_of(*parts, between=between)).table
        peaks = np.maximum(table["force_max_kN"], -table["force_min_kN"])
        assert peaks.iloc[-1] / peaks.iloc[0] == pytest.approx(ratio, abs=0.01)
        assert table["force_start_kN"].iloc[-1] == pytest.approx(start, abs=0.5)
