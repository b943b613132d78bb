"""The coupled step against the same step written by hand in C."""

import subprocess
from pathlib import Path

import numpy as np
import pytest

import thermobearing as tb
from benchmarks.scalar_c import CLOSE, FLAGS, SOURCE, compiled_march, own_march, steps
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
