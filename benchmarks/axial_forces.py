"""What axial forces that change in time cost a pier: dead load, overturning, vertical motion."""

import time

import numpy as np

import thermobearing as tb
from benchmarks.rows import Row, at_most
from benchmarks.structure import AMBIENT, DT, ground
from thermobearing.model.axial import column_of
from thermobearing.model.constants import build_constants
from thermobearing.model.stack import EndFace, build_stack
from thermobearing.structure.model import load_structure
from thermobearing.structure.run import Line, PressedLine, prepare_structure, run_structure

BEARINGS = ("shen-hdr-bridge", "shen-lhdr-bridge")
SPACING, HEIGHT = 3000.0, 1800.0  # of the bearings across, and of the deck [mm]
DEAD_LOAD = 1500.0  # of one bearing [kN]
LIMIT = 1.10
ROUNDS = 15


def rows() -> list[Row]:
    """Return the ratio of the times with and without axial forces, in turn, the fastest of each."""
    upwards, measured = ground("jra-ii-i-2"), []
    for name in BEARINGS:
        bearing = tb.load_bearing(name)
        constants = build_constants(
            bearing, build_stack(bearing, half=True), upper=EndFace(eta=2.0), lower=None
        )
        structure = load_structure("pier-p1")
        prepared, count = prepare_structure(structure), structure.bearings[0].count
        start = np.full(len(constants.cells.capacity), AMBIENT)
        pressed = PressedLine(
            columns=column_of(bearing),
            dead_loads=np.full(count, DEAD_LOAD),
            places=SPACING * (np.arange(count) - 0.5 * (count - 1)),
            moves=True,
            overturns=True,
            height=HEIGHT,
            mass=DEAD_LOAD * count / 9806.65,
            damping_ratio=0.03,
        )
        air = np.full(len(upwards) - 1, AMBIENT)
        lines = Line(constants, start), Line(constants, start, pressed=pressed)
        fastest = [np.inf, np.inf]
        for _ in range(1 + ROUNDS):  # the first one compiles
            for place, (line, vertical) in enumerate(zip(lines, (None, upwards), strict=True)):
                begin = time.process_time()
                run_structure(prepared, [line], ground(), DT, air, vertical=vertical)
                fastest[place] = min(fastest[place], 1e3 * (time.process_time() - begin))
        without, with_forces = fastest
        note = f"{count} bearings, {without:.1f} and {with_forces:.1f} ms"
        what = f"pier P1 on {name}, axial forces in time, over without"
        measured.append(at_most(what, with_forces / without, LIMIT, "", note))
    return measured
