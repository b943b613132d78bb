"""The tables of a validation on the terminal."""

from collections.abc import Sequence
from typing import Any

from thermobearing.identify.screen import (
    print_identification,
    print_thermocouples,
    print_unused,
)
from thermobearing.results.screen import print_table, print_warnings, say
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
    for (bearing, model), rows in found.table.groupby(["bearing", "model"], sort=False):
        cells = [
            (
                str(row["test"]),
                f"{round(row['ambient_degC'], 2):g}",
                f"{row['R2']:.3f}",
                *(_cell(row, name) for name in QUANTITIES),
            )
            for row in rows.to_dict("records")
        ]
        title = f"{bearing}, {model}: largest errors, model against {which}"
        styles = ["yellow" if any("!" in cell for cell in line) else "" for line in cells]
        print_table(HEADS, cells, title=title, keys=2, styles=styles)
    shown = found.thermocouples
    for (bearing, model), rows in (
        shown.groupby(["bearing", "model"], sort=False) if len(shown) else ()
    ):
        some: list[dict[Any, Any]] = (
            rows.astype(object).where(rows.notna(), None).to_dict("records")
        )
        title = f"{bearing}, {model}: thermocouples, model beside test"
        print_thermocouples(some, title)
    print_unused([item.record for item in found.comparisons])
    limits = ", ".join(f"{name} {limit:.0%}" for name, limit in found.limits.items())
    say(f"limits: {limits}; verdict: {found.verdict} (! beyond its limit)")
    print_warnings(found.warnings)


def print_cross_validation(found: CrossValidation, more: Sequence[str] = ()) -> None:
    """The final fit, parameters by fold, and both kinds of tests.

    Parameters
    ----------
    found : from `cross_validate`.
    more : further warnings, of a prediction.
    """
    print_identification(found.final, more)
    if found.folds:
        _print_folds(found)
    print_validation(found.fitted, "tests it is fitted to")
    print_validation(found.held_out, "tests held out")


def _print_folds(found: CrossValidation) -> None:
    symbols = list(found.free)
    rows = []
    for row in found.parameters.to_dict("records"):
        group = found.groups[row["fold"] - 1] if row["fold"] else []
        names = ", ".join(record.name for record in group) or "none"
        shown = [f"{row[symbol]:.4g}" for symbol in symbols]
        rows.append((str(row["fold"] or "all"), names, *shown))
    rows.append(("", "jackknife standard error", *(f"{found.spread[s]:.2g}" for s in symbols)))
    print_table(("fold", "held out", *symbols), rows, title="without each fold", keys=2)


def _cell(row: dict[Any, Any], name: str) -> str:
    error = row[f"{name}_error"]
    if error != error:
        return "-"
    shown = f"{error:.0%}" if name == "NRMSE" else f"{error:+.0%}"
    return f"{shown}!" if row[f"{name}_verdict"] == BEYOND else shown
