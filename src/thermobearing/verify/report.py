"""Rows of `thermobearing verify` on the screen and as JSON."""

import platform
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import thermobearing
from thermobearing.core.compiled.native import open_library
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table
from thermobearing.quantities.words import counted
from thermobearing.results.screen import GAP
from thermobearing.verify.rows import EVIDENCE, GREEN, Verified

COLUMNS = [
    Quantity("What", name="what"),
    Quantity("Against", name="against"),
    Quantity("Error", form=".2g", name="error"),
    Quantity("Limit", form=".2g", name="limit"),
    Quantity("Unit", name="unit"),
    Quantity("Result", name="verdict"),
]
NARROW = ("what", "error", "limit", "verdict")  # columns that fit into 80 letters
OMITTED = "What each row is compared with, and the unit of its error: --html FILE, --json."


def verified_table(verified: Sequence[Verified]) -> Table:
    """Return all rows as a table; a red row counts as failed."""
    rows = []
    for item in verified:
        mark = EVIDENCE[item.evidence]
        against = f"{item.row.against} ({mark})" if mark else item.row.against
        error = "none" if item.error is None else item.error
        rows.append([item.row.what, against, error, item.row.limit, item.row.unit, item.verdict])
    failed = frozenset(k for k, item in enumerate(verified) if item.verdict != GREEN)
    return Table("Errors and their limits", COLUMNS, rows, failed=failed)


def screen_table(verified: Sequence[Verified], width: int | None) -> Table:
    """Return the table for a screen, on which each row is one line; `width` in letters."""
    table = verified_table(verified)
    texts = [[column.title for column in table.columns], *table.texts()]
    longest = sum(max(map(len, column)) + len(GAP) for column in zip(*texts, strict=True))
    if width is None or longest - len(GAP) <= width:
        return table
    places = [place for place, column in enumerate(COLUMNS) if column.name in NARROW]
    rows = [[row[place] for place in places] for row in table.rows]
    columns = [COLUMNS[place] for place in places]
    return replace(table, columns=columns, rows=rows, note=OMITTED)


def headline(verified: Sequence[Verified], seconds: float) -> str:
    """Return the result of all rows in a sentence."""
    red = sum(item.verdict != GREEN for item in verified)
    verdict = "all green" if not red else f"{red} red"
    return f"{counted(len(verified), 'comparison')} in {seconds:.0f} s: {verdict}"


def explanations(verified: Sequence[Verified]) -> list[str]:
    """Return a sentence for each red row."""
    return [item.explanation for item in verified if item.explanation]


def here() -> dict[str, str]:
    """Return versions and processor of this machine."""
    library, reason = open_library()
    kernels = "compiled ahead of time" if library is not None else f"numba ({reason})"
    return {
        "Version": f"thermobearing {thermobearing.__version__}",
        "Python": platform.python_version(),
        "Machine": f"{platform.system()} {platform.machine()}",
        "Kernels": kernels,
    }


def verified_summary(verified: Sequence[Verified], seconds: float) -> dict[str, Any]:
    """Return the content of the line that `--json` prints."""
    red = sum(item.verdict != GREEN for item in verified)
    return {
        "command": "verify",
        "exit_status": 1 if red else 0,
        "outcome": GREEN if not red else "red",
        "red": red,
        "seconds": seconds,
        "here": here(),
        "rows": [item.entry() for item in verified],
        "explanations": explanations(verified),
    }
