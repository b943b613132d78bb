"""The tables of a validation on the terminal."""

from typing import Any

from thermobearing.results.screen import print_table, say
from thermobearing.validate.case import QUANTITIES
from thermobearing.validate.result import BEYOND, Validation

HEADS = ("test", "degC", "R²", "K_eq", "h_eq", "energy", "force", "rise", "NRMSE")


def print_validation(found: Validation) -> None:
    """Largest errors of each comparison, those beyond their limit marked, and the verdict.

    Parameters
    ----------
    found : from `validate`.
    """
    for (bearing, model), rows in found.table.groupby(["bearing", "model"], sort=False):
        cells = [
            (
                str(row["test"]),
                f"{row['ambient_degC']:g}",
                f"{row['R2']:.3f}",
                *(_cell(row, name) for name in QUANTITIES),
            )
            for row in rows.to_dict("records")
        ]
        title = f"{bearing}, {model}: largest errors, model against test"
        styles = ["yellow" if any("!" in cell for cell in line) else "" for line in cells]
        print_table(HEADS, cells, title=title, keys=2, styles=styles)
    limits = ", ".join(f"{name} {limit:.0%}" for name, limit in found.limits.items())
    say(f"limits: {limits}; verdict: {found.verdict} (! beyond its limit)")


def _cell(row: dict[Any, Any], name: str) -> str:
    error = row[f"{name}_error"]
    if error != error:
        return "-"
    shown = f"{error:.0%}" if name == "NRMSE" else f"{error:+.0%}"
    return f"{shown}!" if row[f"{name}_verdict"] == BEYOND else shown
