"""How warm lead gets, and what would tell why: `python -m benchmarks.lead_rise`.

Five cycles of 250 % at -20 degC and two minutes of rest of the LHDR specimen, printed as two
Markdown tables: the numbers of docs/verification.md, "How warm does the lead get?".
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

import thermobearing as tb
from tests.verification.test_fe_heat import AMBIENT, END, loading, variant

Floats = NDArray[np.float64]
TIMES = (10.0, 20.0, 30.0, 40.0, END, 60.0, 80.0, 110.0, 170.0)  # [s]
INTERFACE = 9  # cell of the end plate at 48 mm, next to the sealing plate
STEP = 0.1  # of the finite elements [s]
WAYS: dict[str, tuple[str, dict[str, Any]]] = {
    "default": ("LHDR", {}),
    "as printed": ("LHDR", {"model": tb.ModelOptions(scheme="published")}),
    "touching the shims": ("LHDR unconfined", {}),
}
FIELDS = {"default": "LHDR", "touching the shims": "LHDR unconfined"}  # by finite elements
# Radius from the axis of a core and depth from the upper face [mm]: the core has 17.25 mm and goes
# from the end plate at 35 mm to mid-height at 83 mm; rubber 3 lies between 76.4 and 81.4 mm.
POINTS = {
    "lead at mid-height": (0.0, 82.9),
    "lead 15 mm from its end": (0.0, 50.0),
    "lead 2 mm from its end": (0.0, 37.0),
    "end plate 2 mm above a core": (0.0, 33.0),
    "rubber 3, mid-thickness, 2 mm from a core": (19.25, 78.9),
    "rubber 3, mid-thickness, between the cores": (60.0, 78.9),
}


def rises(case: str) -> tuple[Floats, float]:
    """Of the lead at the times, and of the steel at 48 mm at the end of the loading [K]."""
    name, options = WAYS[case]
    bearing = variant(name)
    result = tb.run(bearing, loading(bearing), ambient=AMBIENT, **options)
    time, lead = result.time(0), result["lead_temperature"].values[0]
    steel = result["temperature"].values[0][:, INTERFACE]
    rise = np.interp(TIMES, time, lead) - AMBIENT
    return rise, float(np.interp(END, time, steel)) - AMBIENT


def elements(case: str) -> tuple[Floats, dict[str, float]]:
    """The lead's mean at the times, and the points at the end of the loading [K]."""
    from thermobearing.verify.finite_elements import FiniteElements, bearing_problem, released

    bearing = variant(FIELDS[case])
    keep = ("rubber", "layer_displacement", "cells")
    result = tb.run(bearing, loading(bearing), ambient=AMBIENT, keep=keep)
    heat, problem = released(bearing, result), FiniteElements(bearing_problem(bearing))
    heating = (STEP, round(END / STEP))
    history = problem.march([heating, (4.0 * STEP, 300)], heat)
    warm = problem.basis.probes(np.array(list(POINTS.values())).T)
    at_points = warm @ problem.march([heating], heat).final
    lead = np.interp(TIMES, history.time, history.means["lead"])
    return lead, dict(zip(POINTS, map(float, at_points), strict=True))


def tables() -> str:
    """Both tables."""
    ours = {case: rises(case) for case in WAYS}
    fields = {case: elements(case) for case in FIELDS}
    columns = {case: lead for case, (lead, _) in ours.items()}
    columns |= {f"{case}, finite elements": lead for case, (lead, _) in fields.items()}
    order = sorted(columns, key=lambda name: list(WAYS).index(name.split(",")[0]))
    lines = ["| rise of the lead [K] after | " + " | ".join(order) + " |"]
    lines += ["|---" * (len(order) + 1) + "|"]
    for k, time in enumerate(TIMES):
        when = f"{time:g} s" + ("" if time <= END else f", {time - END:g} s of rest")
        lines += [f"| {when} | " + " | ".join(f"{columns[name][k]:.1f}" for name in order) + " |"]
    steel = {case: f"{warm:.1f}" for case, (_, warm) in ours.items()}
    lines += ["", f"| rise at {END:g} s [K] | " + " | ".join(WAYS) + " |", "|---|---|---|---|"]
    lines += [
        "| steel at 48 mm, mean of the plan | " + " | ".join(steel[case] for case in WAYS) + " |"
    ]
    for point in POINTS:
        cells = [f"{fields[case][1][point]:.1f}" if case in fields else "" for case in WAYS]
        lines += [f"| {point}, finite elements | " + " | ".join(cells) + " |"]
    return "\n".join(lines)


def main() -> None:
    """Print them."""
    print(tables())


if __name__ == "__main__":
    main()
