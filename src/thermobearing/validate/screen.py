"""The tables of a validation on the terminal."""

from collections.abc import Sequence
from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from thermobearing.identify.screen import (
    print_identification,
    print_thermocouples,
    print_unused,
)
from thermobearing.results.screen import print_warnings
from thermobearing.validate.case import QUANTITIES
from thermobearing.validate.held_out_result import CrossValidation
from thermobearing.validate.result import BEYOND, Validation

HEADS = ("test", "degC", "R²", "K_eq", "h_eq", "energy", "force", "rise", "NRMSE")


def print_validation(found: Validation, which: str = "tests") -> None:
    """Largest errors of each comparison, those beyond their limit marked, and the verdict.

    Parameters
    ----------
    found : from `validate`.
    which : what its tests are called.
    """
    console = Console()
    for (bearing, model), rows in found.table.groupby(["bearing", "model"], sort=False):
        title = f"\n{bearing}, {model}: largest errors, model against {which}"
        table = Table(title=escape(title), title_justify="left", box=None, pad_edge=False)
        for head in HEADS:
            table.add_column(head, justify="left" if head == "test" else "right", no_wrap=True)
        for row in rows.to_dict("records"):
            cells = [escape(row["test"]), f"{row['ambient_degC']:g}", f"{row['R2']:.3f}"]
            table.add_row(*cells, *(_cell(row, name) for name in QUANTITIES))
        console.print(table)
    shown = found.thermocouples
    for (bearing, model), rows in (
        shown.groupby(["bearing", "model"], sort=False) if len(shown) else ()
    ):
        some: list[dict[Any, Any]] = (
            rows.astype(object).where(rows.notna(), None).to_dict("records")
        )
        title = f"\n{bearing}, {model}: thermocouples, model beside test"
        print_thermocouples(console, some, title)
    print_unused([item.record for item in found.comparisons])
    limits = ", ".join(f"{name} {limit:.0%}" for name, limit in found.limits.items())
    console.print(f"limits: {limits}; verdict: {found.verdict} (! beyond its limit)")
    print_warnings(console, found.warnings)


def print_cross_validation(found: CrossValidation, more: Sequence[str] = ()) -> None:
    """The final fit, parameters by fold, and both kinds of tests.

    Parameters
    ----------
    found : from `cross_validate`.
    more : further warnings, of a prediction.
    """
    print_identification(found.final, more)
    if found.folds:
        Console().print(_folds(found))
    print_validation(found.fitted, "tests it is fitted to")
    print_validation(found.held_out, "tests held out")


def _folds(found: CrossValidation) -> Table:
    table = Table(title="without each fold", title_justify="left", box=None, pad_edge=False)
    symbols = list(found.free)
    for head in ("fold", "held out", *symbols):
        table.add_column(head, justify="left" if head == "held out" else "right")
    for row in found.parameters.to_dict("records"):
        group = found.groups[row["fold"] - 1] if row["fold"] else []
        names = ", ".join(record.name for record in group) or "none"
        shown = [f"{row[symbol]:.4g}" for symbol in symbols]
        table.add_row(str(row["fold"] or "all"), escape(names), *shown)
    table.add_row("", "jackknife standard error", *(f"{found.spread[s]:.2g}" for s in symbols))
    return table


def _cell(row: dict[Any, Any], name: str) -> str:
    error = row[f"{name}_error"]
    if error != error:
        return "-"
    shown = f"{error:.0%}" if name == "NRMSE" else f"{error:+.0%}"
    return f"[yellow]{shown}![/]" if row[f"{name}_verdict"] == BEYOND else shown
