"""The coupled step against the step of 0.2.0 written by hand in C, which is frozen."""

import hashlib
import subprocess
from pathlib import Path

import numpy as np
import pytest

import thermobearing as tb
from benchmarks import scalar_c
from benchmarks.scalar_c import CLOSE, DIGEST, FLAGS, SOURCE, compiled_march, own_march, steps
from tests.conftest import Recorder
from tests.fixtures.kernels import c_compiler
from thermobearing.model.options import build_model


@pytest.mark.thorough
def test_march_of_the_specimen_agrees_with_c(tmp_path: Path, measured: Recorder) -> None:
    """Force, energies and temperatures after twenty cycles at 150 % strain and -20 degC."""
    library = tmp_path / "step.so"
    subprocess.run([*c_compiler(), *FLAGS, "-o", library, SOURCE, "-lm"], check=True)
    constants, path = build_model(tb.load_bearing("shen-hdr-specimen")).constants, steps(keep=False)
    ours, theirs = own_march(constants, path)(), compiled_march(constants, path, library)()
    error = float(np.max(np.abs(ours - theirs) / np.maximum(np.abs(ours), 1.0)))
    assert error <= CLOSE
    measured("core against scalar C, force, energies and temperatures", error, "1e-9")
    assert ours[1] > 2e5  # kN mm: it worked


def test_c_of_the_step_of_version_0_2_is_frozen() -> None:
    """Ratios to it are comparable between releases only as long as it does the same work."""
    text = SOURCE.read_text(encoding="utf-8")
    assert hashlib.sha256(text.encode()).hexdigest() == DIGEST


@pytest.mark.thorough
def test_benchmark_of_the_step_in_c_has_its_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without their values, which depend on the machine; without `cc` it says so."""
    if c_compiler() != ["cc"]:
        (row,) = scalar_c.rows()
        assert row.note == "there is no C compiler"
        return
    monkeypatch.setattr(scalar_c, "REPEATS", 1)
    rows = scalar_c.rows()
    assert [row.unit for row in rows] == ["", "%"]
    assert all(row.value is not None and row.value > 0.0 for row in rows)
