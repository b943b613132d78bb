"""The kernels of `make kernels` on each level of x86-64, compared with those of numba."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from tests import tolerances as tol
from thermobearing.core.compiled import native
from thermobearing.core.compiled.sources import sources_digest

ROOT = Path(__file__).parents[2]
# Those that this processor has.
LEVELS = list(native.LEVELS)[[*native.LEVELS].index(native._level()) :]
NOISE = ("mismatch", "iterations", "substeps")
RUNS = """
import sys
import numpy as np
import thermobearing as tb
from tests.verification.test_lockstep import shakes
from thermobearing.structure.lanes import run_lanes, run_peaks

histories = {}
for name in ("shen-hdr-specimen", "shen-lhdr-specimen"):
    test = tb.cyclic_test(strain=[0.5, 1.75], cycles=2, dt=0.05)
    for data, values in tb.run(name, test, ambient=-20.0).dataset.data_vars.items():
        histories[f"{name} {data}"] = values.values
for quake in (
    tb.bridge("shen-lhdr-bridge", "jra-ii-i-1", -20.0, duration=6.0),
    tb.hybrid("shen-lhdr-specimen", ambient=-20.0, duration=2.0, laboratory={"mode": "pd"}),
):
    for data, values in quake.dataset.data_vars.items():
        histories[f"{type(quake).__name__} {data}"] = values.values
spectrum = tb.response_spectrum(tb.load_motion("jra-ii-i-1"), [0.1, 1.0, 3.0])
histories["spectrum"] = spectrum.peaks
element = tb.element("shen-lhdr-bridge", ambient=-20.0)
steps = []
for x in 80.0 * np.sin(0.1 * np.arange(1, 200)):
    steps.append(element.set_trial(x, dt=0.02).force)
    element.commit()
histories["element"] = np.array(steps)
runs = shakes(duration=3.0)[:16]
for k, one in enumerate(run_lanes(runs) if "lanes" in sys.argv else [run_peaks(runs[0])]):
    for group in ("watches", "lines", "energies", "bearings"):
        rows = getattr(one, group)
        for name in rows.dtype.names:
            histories[f"{k} {group} {name}"] = rows[name]
np.savez(sys.argv[1], **{k: v for k, v in histories.items() if v.dtype.kind == "f"})
"""


def numbers(folder: Path, level: str, *words: str) -> dict[str, np.ndarray]:
    file = folder / f"{level}.npz"
    subprocess.run(
        [sys.executable, "-W", "error::UserWarning", "-c", RUNS, str(file), *words],
        cwd=ROOT,
        env={**os.environ, native.CHOICE: level},
        check=True,
    )
    with np.load(file) as result:
        return dict(result)


@pytest.fixture(scope="module")
def by_numba(tmp_path_factory: pytest.TempPathFactory) -> dict[str, np.ndarray]:
    return numbers(tmp_path_factory.mktemp("numba"), "jit", "lanes")


@pytest.mark.thorough
@pytest.mark.parametrize("level", LEVELS)
def test_levels_give_the_numbers_of_numba(
    level: str, by_numba: dict[str, np.ndarray], tmp_path: Path
) -> None:
    """With fused multiplication and addition the same bits, without it to rounding."""
    if not (native.FOLDER / native.DESCRIPTION).is_file():
        pytest.skip("the kernels are not built: make kernels")
    if sources_digest() not in (native.FOLDER / native.DESCRIPTION).read_text():
        pytest.skip("the kernels are built from other sources: make kernels")
    result = numbers(tmp_path, level, "lanes")
    assert result.keys() == by_numba.keys()
    for name, expected in by_numba.items():
        if level != "v1":
            assert_array_equal(result[name], expected, err_msg=name)
        elif not any(word in name for word in NOISE):
            scale = np.nanmax(np.abs(expected), initial=0.0)
            apart = np.nanmax(np.abs(result[name] - expected), initial=0.0)
            assert apart <= tol.WITHOUT_FUSING * scale, name
