"""Figure and table: a girder bridge in OpenSees on served bearings, and as our own structure.

Five spans of 40 m on four piers of 12 m and two abutments, with five bearings on each of six lines.
In OpenSees it is a frame in space (kN, m, s, t); the bearings of a line are one element, served by
a process for each temperature. Here it is the structure "five-span-girder", whose deck is rigid,
and whose piers are rigid on rotational springs; in OpenSees they can be so too. The ground moves
along the bridge.

`python -m benchmarks.opensees_girder` prints the table.
"""

from contextlib import ExitStack
from functools import cache
from itertools import product
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

import thermobearing as tb
from tests.opensees import analyse, ops
from thermobearing.core.types import Floats
from thermobearing.results import drawing
from thermobearing.structure.model import load_structure

LINES = ("A1", "P1", "P2", "P3", "P4", "A2")
WARMER = {"P2": 4.0, "P3": 4.0}  # bearings over the river, than the others [K]
SPAN, HEIGHT, DECK = 40.0, 12.0, 400.0  # m, m, t of a span
BENDING, COLUMN, CAP = 65e6, 25.0, 100.0  # E I [kN m2], mass [t/m] of a column, of a cap [t]
PARTS = 4  # elements of a column
DAMPING = 2.0 * 0.05 / 25.71  # s, times the stiffness of the columns: 5 % in the mode of a pier
ACROSS, VERTICAL = 2.5e3, 7e5  # kN/m: linear springs of a bearing across the bridge and vertical
MOTION, DT = "jra-ii-i-1", 0.01  # s
BEARINGS, AMBIENTS = ("shen-hdr-bridge", "shen-lhdr-bridge"), (-20.0, 23.0)
DURATION = 20.0  # s


class Histories(NamedTuple):
    """Histories of a run from the start, in mm and kN, by line or pier."""

    displacement: dict[str, Floats]  # of the bearings
    force: dict[str, Floats]  # of one bearing
    top: dict[str, Floats]  # of the piers


def line_ambient(line: str, ambient: float) -> float:
    """Return the temperature of a line in a run [degC]."""
    return ambient + WARMER.get(line, 0.0)


def _add_rigid_pier(first: int, x: float) -> int:
    """Add the pier of the structure here: rigid on a spring; return the node at its top."""
    column, cap = load_structure("five-span-girder").masses[2:0:-1]
    heights = (0.0, 0.0, column.height / 1e3, HEIGHT)
    for node, height in enumerate(heights, first):
        ops.node(node, x, 0.0, height)
    ops.fix(first, *[1] * 6)
    ops.fix(first + 1, 1, 1, 1, 1, 0, 1)
    stiff = (10.0, 1e10, 1e10, 20.0, 13.0, 13.0)
    for node, item in ((first + 2, column), (first + 3, cap)):
        mass = item.mass * 1e3
        ops.mass(node, mass, mass, mass, 0.0, 0.0, 0.0)
        ops.element("elasticBeamColumn", node, node - 1, node, *stiff, 1)
    ops.uniaxialMaterial("Elastic", first, 3.0 * BENDING / HEIGHT)
    ends = (first, first + 1)
    ops.element("zeroLength", first + 1, *ends, "-mat", first, "-dir", 5, "-doRayleigh", 1)
    ops.region(first, "-ele", first + 1, "-rayleigh", 0.0, 0.0, DAMPING, 0.0)
    return first + 3


def _add_pier(first: int, x: float) -> int:
    """Add a column with lumped masses; return the node at its top."""
    ops.node(first, x, 0.0, 0.0)
    ops.fix(first, *[1] * 6)
    tags = range(first + 1, first + PARTS + 1)
    for top in tags:
        ops.node(top, x, 0.0, HEIGHT * (top - first) / PARTS)
        section = (10.0, 2.5e7, 1e7, 20.0, 13.0, BENDING / 2.5e7)  # A, E, G, J, I_y, I_z
        ops.element("elasticBeamColumn", top, top - 1, top, *section, 1)
        share = COLUMN * HEIGHT / PARTS
        mass = share if top < tags[-1] else 0.5 * share + CAP
        ops.mass(top, mass, mass, mass, 0.0, 0.0, 0.0)
    ops.region(first, "-ele", *tags, "-rayleigh", 0.0, 0.0, DAMPING, 0.0)
    return tags[-1]


def build(served: dict[str, tb.opensees.Line], *, rigid: bool = False) -> dict[str, int]:
    """Build the model on bearings by line; return the nodes at the tops of the piers."""
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    ops.geomTransf("Linear", 1, 0.0, 1.0, 0.0)  # columns
    ops.geomTransf("Linear", 2, 0.0, 0.0, 1.0)  # girders
    ops.uniaxialMaterial("Elastic", 1, ACROSS)
    ops.uniaxialMaterial("Elastic", 2, VERTICAL)
    tops = {}
    for place, line in enumerate(LINES):
        x, number, abutment = SPAN * place, 100 * (place + 1), line.startswith("A")
        deck = number + 10
        ops.node(deck, x, 0.0, HEIGHT)
        mass = DECK * (0.5 if abutment else 1.0)
        ops.mass(deck, mass, mass, mass, 10.0 * mass, 0.0, 0.0)
        if place:
            section = (6e4 if rigid else 6.0, 3e7, 1.2e7, 20.0, 5.0, 100.0)
            ops.element("elasticBeamColumn", deck, deck - 100, deck, *section, 2)
        if not abutment:
            tops[line] = (_add_rigid_pier if rigid else _add_pier)(number, x)
        pairs = [(number + 20 + side, number + 30 + side) for side in range(5)]
        for (lower, upper), y in zip(pairs, np.linspace(-5.0, 5.0, 5), strict=True):
            ops.node(lower, x, y, HEIGHT)
            ops.node(upper, x, y, HEIGHT)
            if abutment:
                ops.fix(lower, *[1] * 6)
            else:
                ops.rigidLink("beam", tops[line], lower)
            ops.rigidLink("beam", deck, upper)
            ops.element("zeroLength", upper, lower, upper, "-mat", 1, 2, "-dir", 2, 3)
        ops.element(*served[line].element(number + 40, pairs))
    return tops


def cut(begin: float, length: float) -> tb.GroundMotion:
    """Return a part of the motion [s], which grows from zero over the first 0.2 s."""
    motion = tb.load_motion(MOTION)
    first, last = round(begin / motion.dt), round((begin + length) / motion.dt)
    part = motion.acceleration[first : last + 1]
    grown = part * np.minimum(1.0, np.arange(len(part)) * motion.dt / 0.2)
    return tb.motion_from_arrays(grown, unit="mm/s2", dt=motion.dt, name=MOTION)


def shake(tops: dict[str, int], motion: tb.GroundMotion) -> dict[str, Floats]:
    """Move the ground along the bridge; return the displacements of the tops of the piers [mm]."""
    ops.timeSeries("Path", 1, "-dt", motion.dt, "-values", *(motion.acceleration / 1e3))
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    analyse(tolerance=1e-8, most=20, numberer="RCM", system="UmfPack")
    displacements: dict[str, list[float]] = {line: [0.0] for line in tops}
    for _ in range(round(motion.duration / DT)):
        assert ops.analyze(1, DT) == 0
        for line, top in tops.items():
            displacements[line].append(1e3 * ops.nodeDisp(top, 1))
    return {line: np.array(values) for line, values in displacements.items()}


def in_opensees(
    bearing: str, ambient: float, motion: tb.GroundMotion, *, rigid: bool = False
) -> Histories:
    """Return the histories of the model in OpenSees."""
    with ExitStack() as stack:
        servers = {
            t: stack.enter_context(tb.opensees.serve(bearing, t, units="kN-m"))
            for t in sorted({line_ambient(line, ambient) for line in LINES})
        }
        served = {line: servers[line_ambient(line, ambient)] for line in LINES}
        tops = build(served, rigid=rigid)
        moved = shake(tops, motion)
        results = {t: server.results() for t, server in servers.items()}
        ops.wipe()
    x, force = {}, {}
    for place, line in enumerate(LINES):
        data = results[line_ambient(line, ambient)].dataset
        element = data.sel(element=data["tag"] == 100 * (place + 1) + 40)
        assert np.ptp(element["displacement"].values, axis=0).max() < 1e-6  # five alike
        x[line], force[line] = (element[name].values[2] for name in ("displacement", "force"))
    return Histories(x, force, moved)


def ours(bearing: str, ambient: float, motion: tb.GroundMotion) -> Histories:
    """Return the histories of the structure of this package."""
    warm = [{"line": n, "ambient": f"{line_ambient(n, ambient)} degC"} for n in WARMER]
    options = {"structure": "five-span-girder", "lines": warm, "dt": DT}
    data = tb.bridge(bearing, motion, ambient, keep=tb.Keep(every=1), **options).dataset.isel(run=0)

    def histories(name: str, parts: str) -> dict[str, Floats]:
        return dict(zip(map(str, data[parts].values), data[name].values.T, strict=True))

    return Histories(
        histories("line_displacement", "line"),
        histories("line_force", "line"),
        histories("pier_part_displacement", "pier_part"),
    )


def peaks(ours: Histories, theirs: Histories) -> pd.DataFrame:
    """Return the peaks of both, and the difference in per cent of that of OpenSees."""
    rows = []
    for kind, our_values, their_values in zip(Histories._fields, ours, theirs, strict=True):
        for line in ("A1", "P1", "P2"):  # the others are alike
            if line in their_values:
                our_peak, their_peak = (
                    float(np.abs(values[line]).max()) for values in (our_values, their_values)
                )
                rows.append(
                    (f"{kind} {line}", our_peak, their_peak, 100.0 * (our_peak / their_peak - 1.0))
                )
    return pd.DataFrame(rows, columns=["peak", "here", "OpenSees", "difference_%"])


@cache
def carry_out() -> dict[tuple[str, float], tuple[Histories, Histories]]:
    """Run both models for both bearings and temperatures."""
    motion = cut(0.0, DURATION)
    return {
        (bearing, ambient): (ours(bearing, ambient, motion), in_opensees(bearing, ambient, motion))
        for bearing, ambient in product(BEARINGS, AMBIENTS)
    }


def draw(runs: dict[tuple[str, float], tuple[Histories, Histories]]) -> Figure:
    """Loops of a bearing over the river and displacement of its pier, ours over theirs."""
    title = "Bearing and pier P2: OpenSees (grey) and this package (dashed)"
    figure, axes = drawing.panels(len(runs), 2, (8.0, 2.3 * len(runs)), title)
    for row, ((bearing, ambient), histories) in enumerate(runs.items()):
        loop, pier = axes[2 * row], axes[2 * row + 1]
        styles = ({"color": "#CC3311", "linewidth": 0.8, "linestyle": "--"}, {"color": "#bbbbbb"})
        for history, style in reversed(list(zip(histories, styles, strict=True))):
            loop.plot(history.displacement["P2"], history.force["P2"], **style)
            pier.plot(DT * np.arange(len(history.top["P2"])), history.top["P2"], **style)
        loop.set_title(f"{bearing}, {ambient:g} °C", fontsize=9)
        drawing.name_axes(loop, "bearing [mm]", "force [kN]")
        drawing.name_axes(pier, "time [s]", "pier top [mm]")
    return figure


def draw_all() -> Figure:
    """Draw both bearings at both temperatures (minutes)."""
    return draw(carry_out())


if __name__ == "__main__":
    for (name, temperature), both in carry_out().items():
        print(f"{name}, {temperature:g} degC")
        print(peaks(*both).to_string(index=False, float_format="%.2f"), flush=True)
