"""Rows of `thermobearing verify`: their definitions, and what comes of them here."""

import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np

from thermobearing.border.library import read_data
from thermobearing.border.schema import Strict
from thermobearing.verify import closed_forms, references
from thermobearing.verify.comparison import Comparison

GREEN, RED = "green", "red"
EVIDENCE = {
    "calculated": "",
    "stored": "stored reference",
    "recomputed": "recomputed here",
    "recorded": "recorded number",
}


class Row(Strict):
    """Definition of a row; data/verify/rows.toml describes the fields."""

    check: str
    what: str
    against: str
    unit: str
    limit: float
    red: str
    evidence: Literal["calculated", "stored", "recorded"] = "calculated"
    package: str = ""


class Rows(Strict):
    """Content of data/verify/rows.toml."""

    rows: tuple[Row, ...]


@dataclass(frozen=True)
class Verified:
    """A row with its error.

    Attributes
    ----------
    row : its definition.
    error : in the unit of the row; None where the comparison could not be made.
    evidence : "calculated", "stored", "recomputed" or "recorded".
    note : what is to be known of the comparison, or why it failed.
    seconds : time that it took.
    """

    row: Row
    error: float | None
    evidence: str
    note: str
    seconds: float

    @property
    def verdict(self) -> str:
        """Return "green" for an error within the limit; otherwise "red"."""
        within = self.error is not None and self.error <= self.row.limit
        return GREEN if within else RED

    @property
    def explanation(self) -> str:
        """Return what is wrong with a red row; "" for a green one."""
        if self.verdict == GREEN:
            return ""
        size = "no result" if self.error is None else f"{self.error:.2g} {self.row.unit}"
        sentence = f"{self.row.what}: {size}, limit {self.row.limit:.2g}. {self.row.red}"
        return f"{sentence} {self.note}".strip()

    def entry(self) -> dict[str, Any]:
        """Return the row for JSON."""
        keys = asdict(self) | {"row": None}
        names = ("what", "against", "unit", "limit")
        row = {name: getattr(self.row, name) for name in names}
        del keys["row"]
        return {"check": self.row.check, **row, **keys, "verdict": self.verdict}


def row_definitions() -> tuple[Row, ...]:
    """Return the definitions of all rows, in their order."""
    return read_data(Rows, "verify", "rows.toml").rows


CHECKS: Mapping[str, Callable[[], Comparison]] = {
    **closed_forms.CHECKS,
    **references.CHECKS,
}


def verify_rows(rows: Iterable[Row] | None = None) -> Iterator[Verified]:
    """Yield each row with its error; a comparison that fails is a red row with its reason."""
    for row in row_definitions() if rows is None else rows:
        begin = time.perf_counter()
        error, note, evidence = None, "", str(row.evidence)
        try:
            with np.errstate(all="ignore"):
                comparison = CHECKS[row.check]()
            note = comparison.note
            evidence = "recomputed" if comparison.recomputed else evidence
            error = float(comparison.error) if np.isfinite(comparison.error) else None
        except Exception as problem:  # whatever fails on a foreign machine is what a row is for
            note = f"{type(problem).__name__}: {problem}"
        yield Verified(row, error, evidence, note, time.perf_counter() - begin)
