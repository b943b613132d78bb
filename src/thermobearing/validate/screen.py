"""The tables of a validation on the terminal."""

from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from thermobearing.results.screen import print_warnings
from thermobearing.validate.case import QUANTITIES
from thermobearing.validate.result import BEYOND, Validation

HEADS = ("test", "degC", "R²", "K_eq", "h_eq", "energy", "force", "rise", "NRMSE")


def print_validation(found: Validation) -> None:
    """Largest errors of each comparison, those beyond their limit marked, and the verdict.

    Parameters
    ----------
    found : from `validate`.
    """
    console = Console()
    for (bearing, model), rows in found.table.groupby(["bearing", "model"], sort=False):
        title = f"\n{bearing}, {model}: largest errors, model against test"
        table = Table(title=escape(title), title_justify="left", box=None, pad_edge=False)
        for head in HEADS:
            table.add_column(head, justify="left" if head == "test" else "right", no_wrap=True)
        for row in rows.to_dict("records"):
            cells = [escape(row["test"]), f"{row['ambient_degC']:g}", f"{row['R2']:.3f}"]
            table.add_row(*cells, *(_cell(row, name) for name in QUANTITIES))
        console.print(table)
    limits = ", ".join(f"{name} {limit:.0%}" for name, limit in found.limits.items())
    console.print(f"limits: {limits}; verdict: {found.verdict} (! beyond its limit)")
    print_warnings(console, found.warnings)


def _cell(row: dict[Any, Any], name: str) -> str:
    error = row[f"{name}_error"]
    if error != error:
        return "-"
    shown = f"{error:.0%}" if name == "NRMSE" else f"{error:+.0%}"
    return f"[yellow]{shown}![/]" if row[f"{name}_verdict"] == BEYOND else shown
