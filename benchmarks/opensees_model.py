"""The OpenSees model, run by benchmarks/opensees.py; the last line printed is JSON."""

import json
import tempfile
import time
from pathlib import Path

from tests.opensees import ops

STEPS, DT, REPEATS = 4000, 0.005, 7
# N, m, kg: 20 layers of 10 mm, 0.8 m wide, a lead core of 0.15 m.
BEARING = (2e5, 0.1, 0.6e6, 2e9, 0.15, 0.8, 0.003, 0.01, 20)
VERTICAL = (0.0, 0.0, 1.0, 0.0, 1.0, 0.0)
# The last of these is tag5: without it, the lead stays cold.
LEAD = (10.0, 0.5, 1.0, 0.5, 0.0, 0.0, 0.0, 11200.0, 130.0, 50.0, 1.41e-5, 0, 0, 0, 0, 1)
MASS, PERIOD, PEAK = 5e5, 2.0, 0.8  # [kg, s, m/s2]


def build() -> None:
    """One mass, free to move sideways, on one bearing under a sine ground acceleration."""
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    for node, height in ((1, 0.0), (2, 0.3)):
        ops.node(node, 0.0, 0.0, height)
        ops.fix(node, int(node == 1), 1, 1, 1, 1, 1)
    ops.mass(2, MASS, 0.0, 0.0, 0.0, 0.0, 0.0)
    ops.element("LeadRubberX", 1, 1, 2, *BEARING, *VERTICAL, *LEAD)
    ops.timeSeries("Trig", 1, 0.0, 2.0 * STEPS * DT, PERIOD, "-factor", PEAK)
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    ops.constraints("Transformation")
    ops.numberer("Plain")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-8, 50)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    ops.analyze(1, DT)  # heating divides by the time: the first step is no measure


def fastest(folder: Path | None) -> float:
    """Time per step [us], histories recorded if there is a folder for them."""
    times = []
    for _ in range(REPEATS):
        build()
        if folder:
            ops.recorder("Node", "-file", f"{folder}/x", "-time", "-node", 2, "-dof", 1, "disp")
            for what in ("force", "parameters"):
                ops.recorder("Element", "-file", f"{folder}/{what}", "-ele", 1, what)
        begin = time.process_time()
        if ops.analyze(STEPS, DT):
            raise RuntimeError("OpenSees stopped")
        times.append(time.process_time() - begin)
    return 1e6 * min(times) / STEPS


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        found = {"bare": fastest(None), "recorded": fastest(Path(name))}
    found |= {"iterations": ops.testIter(), "rise": ops.eleResponse(1, "parameters")[4]}
    assert found["rise"] > 1.0, "the lead was not heated"
    print(json.dumps(found))
