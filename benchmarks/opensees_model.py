"""The OpenSees model, run by benchmarks/opensees.py; the last line printed is JSON."""

import json
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import thermobearing as tb
from tests.opensees import analyse, ops

STEPS, DT, REPEATS = 4000, 0.005, 7
OURS, AMBIENT, UNITS = "lrb-example", 20.0, "N-m"
MANY, FEW = 10, 400  # bearings in one served element, and its steps, which take longer
# N, m, kg: 20 layers of 10 mm, 0.8 m wide, a lead core of 0.15 m.
BEARING = (2e5, 0.1, 0.6e6, 2e9, 0.15, 0.8, 0.003, 0.01, 20)
VERTICAL = (0.0, 0.0, 1.0, 0.0, 1.0, 0.0)
# The last of these is tag5: without it, the lead stays cold.
LEAD = (10.0, 0.5, 1.0, 0.5, 0.0, 0.0, 0.0, 11200.0, 130.0, 50.0, 1.41e-5, 0, 0, 0, 0, 1)
MASS, PERIOD, PEAK = 5e5, 2.0, 0.8  # [kg, s, m/s2]


def build(add: Callable[[], object], height: float = 0.0, pairs: int = 1) -> None:
    """Masses, free to move sideways, each on one bearing under a sine ground acceleration."""
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    for node in range(1, 2 * pairs + 1):
        free = node % 2 == 0
        ops.node(node, 0.0, 0.0, height if free else 0.0)
        ops.fix(node, int(not free), 1, 1, 1, 1, 1)
        if free:
            ops.mass(node, MASS, 0.0, 0.0, 0.0, 0.0, 0.0)
    add()
    ops.timeSeries("Trig", 1, 0.0, 2.0 * STEPS * DT, PERIOD, "-factor", PEAK)
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    analyse(tolerance=1e-8)
    ops.analyze(1, DT)  # heating divides by the time: the first step is no measure


def add_theirs() -> None:
    """Add OpenSees' own bearing."""
    ops.element("LeadRubberX", 1, 1, 2, *BEARING, *VERTICAL, *LEAD)


def add_material() -> None:
    """Add our bearing as a material."""
    tb.opensees.add_material(ops, 1, tb.element(OURS, AMBIENT), units=UNITS)
    ops.element("zeroLength", 1, 1, 2, "-mat", 1, "-dir", 1)


def fastest(
    folder: Path | None,
    add: Callable[[], object],
    *,
    height: float = 0.0,
    pairs: int = 1,
    steps: int = STEPS,
) -> float:
    """Time per step on the clock [us], histories recorded if there is a folder for them."""
    times = []
    for _ in range(REPEATS):
        build(add, height, pairs)
        if folder:
            ops.recorder("Node", "-file", f"{folder}/x", "-time", "-node", 2, "-dof", 1, "disp")
            for response in ("force", "parameters"):
                ops.recorder("Element", "-file", f"{folder}/{response}", "-ele", 1, response)
        begin = time.perf_counter()
        if ops.analyze(steps, DT):
            raise RuntimeError("OpenSees stopped")
        times.append(time.perf_counter() - begin)
    return 1e6 * min(times) / steps


def main() -> None:
    """Measure all, OpenSees' own bearing last."""
    results = {"material": fastest(None, add_material)}
    with tb.opensees.serve(OURS, AMBIENT, units=UNITS) as line:
        results["served"] = fastest(None, lambda: ops.element(*line.element(1, (1, 2))), steps=FEW)
        pairs = [(k, k + 1) for k in range(1, 2 * MANY, 2)]
        add = lambda: ops.element(*line.element(2, pairs))  # noqa: E731
        results["many"] = fastest(None, add, pairs=MANY, steps=FEW) / MANY
        ops.wipe()
    with tempfile.TemporaryDirectory() as name:
        results["bare"] = fastest(None, add_theirs, height=0.3)
        results["recorded"] = fastest(Path(name), add_theirs, height=0.3)
    results |= {"iterations": ops.testIter(), "rise": ops.eleResponse(1, "parameters")[4]}
    assert results["rise"] > 1.0, "the lead was not heated"
    print(json.dumps(results))


if __name__ == "__main__":
    main()
