"""A small result for tests of documents, with names that mean something to other programs."""

import dataclasses
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table
from thermobearing.report.pieces import Check, Pieces, ReportFigure
from thermobearing.results.writing import write_summary

EVIL = '=1+1 #evil[ $x$ \\n "<b>*_`@[1]~//'
LOGO = (
    b'<svg xmlns="http://www.w3.org/2000/svg" width="60" height="20">'
    b'<rect width="60" height="20" fill="#0072b2"/></svg>'
)


def line() -> Figure:
    figure = Figure(figsize=(5.0, 3.0))
    figure.subplots().plot(np.arange(5.0), np.arange(5.0) ** 2)
    return figure


def wide() -> Figure:
    figure = Figure(figsize=(12.0, 5.0))
    figure.subplots().plot([0.0, 1.0], [0.0, 1.0])
    return figure


TABLE = Table(
    "Peaks of every run",
    [Quantity("Run"), Quantity("Force", "kN", ".1f"), Quantity("Strain", "%", ".0f")],
    [(EVIL, -312.64, 175.0), ("θ₀ Δ", 280.0, None), ("three", float("nan"), 352.0)],
    marked=frozenset({(2, 2)}),
)
PIECES = Pieces(
    "intake",
    "Two tests in the cold",
    f"How large is the force of {EVIL.replace('*', '').replace('`', '').replace('_', '')}?",
    ["**313 kN** at -20 °C.", "Warm: less."],
    inputs={"bearing": Table("The bearing", [Quantity("What"), Quantity("Value")], [("K_r", 30)])},
    tables={"peaks": TABLE},
    figures={"line": ReportFigure("A parabola", line, alt="It rises.")},
    checks=[
        Check("force", 312.6, 400.0, "kN", "Table 3.2", "within"),
        Check("strain", 3.52, 2.5, "", "the tests behind the bearing", "exceeded"),
    ],
    warnings=["it is cold"],
    identity={"Version": "thermobearing 0.2.0", "Input (SHA-256)": "0123456789abcdef" * 4},
)


def many_columns(count: int, rows: int = 3) -> Pieces:
    columns = [Quantity("Run"), *(Quantity(f"Quantity {k}", "kN", ".1f") for k in range(count - 1))]
    body = [(f"run {j}", *(100.0 * k + j for k in range(count - 1))) for j in range(rows)]
    return dataclasses.replace(PIECES, tables={"wide": Table("Wide", columns, body)})


def saved_directory(folder: Path) -> Path:
    """A result directory of a command whose documents have no specific text."""
    folder.mkdir()
    write_summary(folder, {"command": "intake", "outcome": "completed", "version": "0.2.0"})
    pd.DataFrame({"file": [EVIL], "force_kN": [312.6]}).to_csv(folder / "table.csv", index=False)
    return folder
