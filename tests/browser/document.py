"""A document with every kind of piece, small, for a browser to open."""

import numpy as np
from matplotlib.figure import Figure

from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table
from thermobearing.report import pieces

HOSTILE = '<script>window.hurt = true</script><img src=x onerror="window.hurt = true">'
TIME = np.linspace(0.0, 20.0, 401)
DEPTH = np.linspace(0.0, 80.0, 30)
PLACES = 11
FORCES = (200.0, -30.0, 1000.0, np.nan)


def drawn() -> Figure:
    figure = Figure(figsize=(8.0, 6.0))
    axes = figure.subplots()
    axes.plot(TIME, np.sin(TIME))
    axes.set_title("drawn")
    return figure


def peaks() -> Table:
    """Forces that are sorted otherwise as text than as numbers, one of them not there."""
    columns = [Quantity("Run"), Quantity("Force", "kN", ".0f")]
    rows = [(f"run {name}", force) for name, force in zip("bcad", FORCES, strict=True)]
    marked = frozenset({(2, 1)})
    return Table("Peaks", columns, rows, marked=marked, note="Force: of one bearing.")


def long_table() -> Table:
    columns = [Quantity(f"Quantity {place}", "kN/mm", ".3f") for place in range(18)]
    rows = [[1234.5678 * k] * 18 for k in range(60)]
    return Table("Long and broad", columns, rows, marked=frozenset({(3, 17)}))


def loops() -> pieces.Plot:
    lines = {
        words: [
            pieces.Trace("23 °C", size * np.cos(TIME), np.sin(TIME), "#CC3311"),
            pieces.Trace(HOSTILE, size * np.cos(TIME), 2.0 * np.sin(TIME), "#1a1a1a", "dashed"),
        ]
        for words, size in (("first motion", 1.0), ("second motion", 3.0))
    }
    bands = [(2.5, np.inf, "strain beyond 250 %"), (-np.inf, -2.5, "strain beyond 250 %")]
    return pieces.Plot("strain", "force [kN]", lines, bands=bands)


def profile() -> pieces.Plot:
    warmth = np.stack([20.0 + k * np.sin(np.pi * DEPTH / 80.0) for k in range(PLACES)])
    depths = np.stack([DEPTH] * PLACES)
    line = pieces.Trace("profile", warmth[0], DEPTH, "#0077BB", frames=depths, frames_x=warmth)
    words = [f"{k} s" for k in range(PLACES)]
    return pieces.Plot("temperature [°C]", "depth [mm]", {"": [line]}, words, "time")


def orbit() -> pieces.Plot:
    return pieces.Plot(
        "x [mm]",
        "y [mm]",
        {"": [pieces.Trace("orbit", np.cos(TIME), np.sin(2.0 * TIME))]},
        equal=True,
    )


def document() -> pieces.Document:
    """Every kind of block, in an order in which figures meet the ends of pages."""
    figures = {
        "loops": pieces.ReportFigure("Loops", alt="Two loops", plot=loops()),
        "drawn": pieces.ReportFigure("Drawn", draw=drawn),
        "profile": pieces.ReportFigure("Profile", plot=profile()),
        "orbit": pieces.ReportFigure("Orbit", plot=orbit()),
        "again": pieces.ReportFigure("Loops again", plot=loops()),
        "last": pieces.ReportFigure("Drawn again", draw=drawn),
    }
    checks = [
        pieces.Check("strain of run 7", 2.81, 2.5, "", "Table 4.2", "exceeded"),
        pieces.Check("force", 312.0, 400.0, "kN", "data sheet", "within"),
        pieces.Check(HOSTILE, 80.0, float("nan"), "°C", HOSTILE, "not assessed"),
    ]
    blocks = [
        pieces.Heading(1, "What was asked"),
        pieces.Paragraph(f"Does **it** hold what {HOSTILE} says?"),
        pieces.Heading(1, "The answer"),
        pieces.Bullets(["It holds.", "It is warm.", "All is well."], "answer"),
        pieces.Heading(1, "Checks"),
        pieces.TableBlock("checks", pieces.checks_table(checks)),
        pieces.Bullets(["The strain left the tested range."], "warning"),
        pieces.Heading(1, "Results"),
        pieces.Heading(3, "Tables"),
        pieces.TableBlock("peaks", peaks()),
        pieces.TableBlock("long", long_table()),
        pieces.Heading(2, "Figures"),
        *(pieces.FigureBlock(name, figure) for name, figure in figures.items()),
        pieces.Heading(1, "How to make it again"),
        pieces.Paragraph("Run it `again`."),
    ]
    block = {"Project": "Bridge 12", "Client": HOSTILE}
    return pieces.Document(
        "A report", block, None, blocks, {"Version": "1.0", "Input hash": "0a" * 32}
    )
