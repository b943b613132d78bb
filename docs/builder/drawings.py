"""Figures of README, tutorial and theory that no command draws as they are shown."""

import numpy as np
from matplotlib.figure import Figure

import thermobearing as tb
from thermobearing.design import figures
from thermobearing.design.factors import scale_study
from thermobearing.results import drawing


def draw_loops() -> Figure:
    """Draw the loops of the HDR specimen in the test programme, at three temperatures."""
    test = tb.cyclic_test()
    return tb.run("shen-hdr-specimen", test, ambient=[-20.0, 0.0, 23.0]).plot.loops()


def draw_bridge() -> Figure:
    """Draw the loops of both bridge bearings at three temperatures."""
    bearings, motions = ["shen-hdr-bridge", "shen-lhdr-bridge"], ["jra-i-i-1", "jra-ii-i-1"]
    return tb.bridge(bearings, motions, [23.0, 0.0, -20.0]).plot.loops()


def draw_bounds() -> Figure:
    """Draw bilinear bounds and coupled results of the HDR bridge bearing."""
    bearing = tb.load_bearing("shen-hdr-bridge")
    motions = [name for name in tb.list_motions() if name.split("-")[2] == "i"]
    title = "shen-hdr-bridge: bounds (bars), coupled (dots)"
    return figures.draw_bounds(tb.bounds_study(bearing, motions), title)


def draw_scale() -> Figure:
    """Draw the LHDR bridge bearing at two sizes."""
    lead = tb.load_bearing("shen-lhdr-bridge")
    return figures.draw_scale(lead, scale_study(lead)[1])


def draw_plan() -> Figure:
    """Draw the five-span bridge in plan."""
    return tb.examine_structure("five-span-bridge").plot.plan()


def draw_cold() -> Figure:
    """Draw the picture of the README: one bridge in one earthquake, warm and cold."""
    ambient = [23, -20]
    result = tb.bridge("shen-lhdr-bridge", "jra-ii-i-1", ambient=ambient)
    colours = drawing.ambient_colours(np.array(ambient, dtype=float))
    title = "The same bridge in the same earthquake"
    figure, (loops, moments) = drawing.panels(1, 2, (8.4, 3.4), title)
    for run, colour in enumerate(colours):
        history = result.history(run)
        look = {"color": colour, "linewidth": 1.0, "label": f"{ambient[run]} °C"}
        loops.plot(history["displacement_mm"], history["force_kN"], **look)
        shaken = history["time_s"].between(8.0, 20.0)
        moment = history["pier_moment_kN_m"][shaken] / 1e3
        moments.plot(history["time_s"][shaken], moment, **look)
    drawing.name_axes(loops, "bearing displacement [mm]", "bearing force [kN]")
    drawing.name_axes(moments, "time [s]", "moment at the pier base [MN m]")
    loops.legend(fontsize=drawing.SMALL, frameon=False)
    return figure
