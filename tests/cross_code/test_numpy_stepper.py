"""The whole coupled step against a plain NumPy/SciPy stepper of the same equations.

Only where every layer tangent is healthy: the reference has no rule for softening layers.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import pytest

import thermobearing as tb
from tests import tolerances as tol
from tests.conftest import Recorder
from thermobearing.cyclic.history import build_segments
from thermobearing.verify.numpy_stepper import NumpyStepper


@dataclass(frozen=True)
class Situation:
    bearing: str
    ambient: float  # [degC]
    strain: tuple[float, ...]
    wave: Literal["triangular", "sine"] = "triangular"
    rest: float | None = None  # [s]
    start: float | None = None  # [degC]; None: the ambient temperature
    eta: float = 2.0


SITUATIONS = {
    "specimen 23 degC 250 %": Situation("shen-hdr-specimen", 23.0, (2.5,)),
    "specimen 0 degC 150 %": Situation("shen-hdr-specimen", 0.0, (1.5,)),
    "two amplitudes and a rest": Situation("shen-hdr-specimen", 23.0, (1.0, 2.0), rest=4500.0),
    "sine, warm bearing in cold air": Situation(
        "shen-hdr-specimen", -10.0, (1.0,), wave="sine", start=30.0, eta=3.0
    ),
    "bridge bearing": Situation("shen-hdr-bridge", 23.0, (1.0,), eta=1.0),
}


COVERED = set(SITUATIONS) - {"sine, warm bearing in cold air"}  # it takes least
NAMES = [pytest.param(n, marks=[pytest.mark.thorough] if n in COVERED else []) for n in SITUATIONS]


@pytest.mark.parametrize("name", NAMES)
def test_core_agrees_with_numpy(name: str, measured: Recorder) -> None:
    case = SITUATIONS[name]
    bearing = tb.load_bearing(case.bearing)
    test = tb.cyclic_test(strain=case.strain, cycles=2, wave=case.wave, rest=case.rest)
    face = tb.EndFace(eta=case.eta)
    result = tb.run(
        bearing,
        test,
        ambient=case.ambient,
        model=tb.ModelOptions(upper_face=face, lower_face=face),
        initial=case.start,
        keep=("rubber", "layer_displacement", "cells"),
    )
    assert result.outcome == "completed"
    assert int(result["softened_steps"][0]) == 0, "outside what the reference can do"

    other = NumpyStepper(bearing, case.start if case.start is not None else case.ambient, case.eta)
    rows = []
    for segment in build_segments(test, bearing.total_rubber_thickness):
        for x, dt in zip(segment.x, segment.dt, strict=True):
            row = other.step(float(x), float(dt), case.ambient)
            rows.append((row, other.layer_temperature, other.d, other.temperature))
    force, layer, d, cells = (np.array(column) for column in zip(*rows, strict=True))

    peak, range_of_layers = np.abs(force).max(), np.ptp(layer)
    assert range_of_layers > 1.0, "no heat: nothing coupled was compared"
    apart = {
        "force": np.abs(result["force"].values[0, 1:] - force).max() / peak,
        "displacement": np.abs(result["layer_displacement"].values[0, 1:] - d).max() / d.max(),
        "layer": np.abs(result["rubber_temperature"].values[0, 1:] - layer).max(),
        "cell": np.abs(result["temperature"].values[0, 1:] - cells).max(),
        "last cell": np.abs(result["final_temperature"].values[0] - cells[-1]).max(),
    }
    actual = ", ".join(f"{what} {value:.0e}" for what, value in apart.items())
    print(f"{name}: {len(force)} steps, layers range over {range_of_layers:.1f} K; {actual}")
    assert apart["force"] <= tol.STEPPER_FORCE
    assert apart["displacement"] <= tol.STEPPER_DISPLACEMENT
    assert apart["layer"] <= tol.STEPPER_TEMPERATURE
    assert apart["cell"] <= tol.SINGLE_PRECISION
    assert apart["last cell"] <= tol.STEPPER_TEMPERATURE
    measured("core against a plain NumPy stepper, force, of the peak", apart["force"], "1e-9")
    measured("core against a plain NumPy stepper, layers [K]", apart["layer"], "1e-9")
