"""Pier P1 on LeadRubberX with its lead heating, in OpenSees; the last line printed is JSON.

One element carries the line of five bearings (five times its strength and stiffness).
"""

import json
import time

import numpy as np

from benchmarks.opensees_model import BEARING, LEAD, VERTICAL
from benchmarks.structure import DT, LINE, STRUCTURE, ground
from tests.opensees import ops
from tests.reference.opensees_pier import build
from thermobearing.structure.model import load_structure
from thermobearing.structure.run import prepare_structure

REPEATS = 3
STRENGTH, SHEAR = 0.4 * LINE * 1e5, 0.35 * LINE * 0.6e6  # N, Pa: as strong as the line of LHDR


def lead_rubber(tag: int, lower: int, upper: int) -> None:
    """LeadRubberX with lead heating."""
    shape = (STRENGTH, BEARING[1], SHEAR, *BEARING[3:])
    ops.element("LeadRubberX", tag, lower, upper, *shape, *VERTICAL, *LEAD)


def main() -> None:
    """Fastest of a few analyses."""
    prepared = prepare_structure(load_structure(STRUCTURE))
    acceleration = ground()
    times = []
    for _ in range(REPEATS):
        build(prepared, lead_rubber, acceleration, DT, (0.36, 0.0086))
        ops.system("BandGeneral")
        ops.test("NormDispIncr", 1e-8, 50)
        ops.analysis("Transient")
        ops.analyze(1, DT)  # heating divides by the time
        begin = time.process_time()
        if ops.analyze(len(acceleration) - 2, DT):
            raise RuntimeError("OpenSees stopped")
        times.append(time.process_time() - begin)
    rise = ops.eleResponse(10, "parameters")[4]
    results = {
        "seconds": min(times),
        "steps": len(acceleration) - 1,
        "rise": rise,
        "peak_mm": float(1e3 * np.abs(ops.nodeDisp(9, 1))),
        "iterations": ops.testIter(),
    }
    assert rise > 1.0, "the lead was not heated"
    print(json.dumps(results))


if __name__ == "__main__":
    main()
