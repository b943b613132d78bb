"""The five-span bridge with one and two components of the ground motion.

`python -m benchmarks.whole_bridge` prints what two components change, as the Markdown table of
docs/texts/structures.md.
"""

import time

import thermobearing as tb
from benchmarks.rows import Row, at_most
from thermobearing.earthquake.result import EarthquakeResult
from thermobearing.earthquake.tables import components_frame, components_summary

STRUCTURE = "five-span-bridge"
BEARINGS = ["shen-hdr-bridge", "shen-lhdr-bridge"]
PAIRS = [
    {"name": f"jra-{kind}-i-{first}", "across": f"jra-{kind}-i-{first + 1}"}
    for kind in ("i", "ii")
    for first in (1, 2)
]
AMBIENT = [23, 0, -20]
LIMIT, LIMIT_RATIO = 30.0, 3.0  # [s]; of processor time, which other programs leave as it is
SHOWN = {  # column: quantity, combination
    "strain, larger": ("bearing_strain_max", "larger"),
    "strain, 100 % + 30 %": ("bearing_strain_max", "rule"),
    "strain, SRSS": ("bearing_strain_max", "srss"),
    "force, larger": ("bearing_force_max_kN", "larger"),
    "ductility, larger": ("pier_ductility", "larger"),
    "rise of rubber, larger": ("rubber_rise_K", "larger"),
    "rise of lead, larger": ("lead_rise_K", "larger"),
}


def _study(components: int) -> tuple[EarthquakeResult, float, float]:
    """Return a study of four pairs, three temperatures, two bearings, its times by both clocks."""
    begin, busy = time.perf_counter(), time.process_time()
    result = tb.bridge(BEARINGS, PAIRS, AMBIENT, structure=STRUCTURE, components=components)
    return result, time.perf_counter() - begin, time.process_time() - busy


def rows() -> list[Row]:
    """Return the times of the study; kernels are ready after the first analysis."""
    tb.bridge(BEARINGS, PAIRS[:1], 23, structure=STRUCTURE, components=2, duration=0.1)
    _study(1)
    (two, wall, busy), (_, _, separate) = _study(2), _study(1)
    label = f"five-span bridge in plan, {two.runs} runs with two components"
    return [
        at_most(f"{label}, two cores", wall, LIMIT, "s", f"{busy:.0f} s of both cores"),
        at_most("the same over each direction alone, processor", busy / separate, LIMIT_RATIO),
    ]


def table() -> str:
    """Return two components over one at a time: mean, lowest and highest of the motions."""
    result, separate = _study(2)[0], _study(1)[0]
    rows = components_summary(components_frame(result, separate))
    lines = ["| | " + " | ".join(SHOWN) + " |", "|---" * (len(SHOWN) + 1) + "|"]
    for (bearing, ambient), group in rows.groupby(["bearing", "ambient_degC"], sort=False):
        values = group.set_index(["quantity", "combination"])[["mean", "min", "max"]]
        cells = [
            "{:.2f} ({:.2f}–{:.2f})".format(*values.loc[key]) if key in values.index else ""
            for key in SHOWN.values()
        ]
        lines.append(f"| `{bearing}`, {ambient:g} °C | " + " | ".join(cells) + " |")
    early = [
        f"{name} ended early: {outcome}"
        for study in (result, separate)
        for name, outcome in zip(study.run_names, study["outcome"].values, strict=True)
        if outcome != "completed"
    ]
    return "\n".join([*lines, "", *early])


if __name__ == "__main__":
    print(table())
