"""What came of the source: rows of the ledger, figures, tables."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd

from thermobearing import __version__
from thermobearing.border.showing import Shown
from thermobearing.reproduce.claims import GROUPS, group_of
from thermobearing.reproduce.judge import FAILED, VERDICTS
from thermobearing.reproduce.rows import Row
from thermobearing.reproduce.told import computed_words, rule_words
from thermobearing.reproduce.work import Drawn

PARTLY = "Rows, figures or tables broke; each says why. The others are whole."


@dataclass(frozen=True, repr=False)
class Reproduction(Shown):
    """The source again.

    Attributes
    ----------
    chapter : the only one, or None.
    rows : of the ledger, in the order of the source.
    figures : drawn again.
    tables : by name; words where one broke.
    """

    chapter: int | None
    rows: Sequence[Row]
    figures: Sequence[Drawn] = ()
    tables: Mapping[str, pd.DataFrame | str] = field(default_factory=dict)

    @property
    def counts(self) -> dict[str, int]:
        """Rows by verdict."""
        kinds = [row.verdict.kind for row in self.rows]
        return {name: kinds.count(name) for name in VERDICTS}

    @property
    def groups(self) -> dict[str, dict[str, int]]:
        """Rows by verdict of each group of claims: statements, repeats, misprints."""
        found = {group: dict.fromkeys(VERDICTS, 0) for group in GROUPS}
        for row in self.rows:
            found[group_of(row.claim.id)][row.verdict.kind] += 1
        return {group: counts for group, counts in found.items() if any(counts.values())}

    @property
    def headline(self) -> str:
        """What it is, in a line."""
        parts = [
            f"{sum(counts.values())} {group} ("
            + ", ".join(f"{count} {name}" for name, count in counts.items() if count)
            + ")"
            for group, counts in self.groups.items()
        ]
        return "Reproduction: " + "; ".join(parts)

    def show(self) -> None:
        """Print the tables that the command prints."""
        from thermobearing.reproduce.screen import print_reproduction

        print_reproduction(self)

    @property
    def broken(self) -> dict[str, str]:
        """What broke, and why."""
        found = {row.claim.id: row.verdict.words for row in self.rows if row.verdict.kind == FAILED}
        found |= {item.name: item.caption for item in self.figures if item.image is None}
        return found | {name: item for name, item in self.tables.items() if isinstance(item, str)}

    @property
    def outcome(self) -> str:
        """Whether all is whole: "completed" or "partly"."""
        return "partly" if self.broken else "completed"

    @property
    def sentence(self) -> str:
        """What the outcome means; empty when it completed."""
        return PARTLY if self.broken else ""

    @cached_property
    def ledger(self) -> pd.DataFrame:
        """One row per claim: place, statement, verdict, computed, printed model, rule, flips."""
        return pd.DataFrame([self._told(row) for row in self.rows])

    def _told(self, row: Row) -> dict[str, Any]:
        claim = row.claim
        return {
            "id": claim.id,
            "place": claim.place,
            "statement": claim.statement,
            "verdict": row.verdict.kind,
            "words": row.verdict.words,
            "computed": computed_words(claim, row.computed),
            "printed_model": row.printed.words if row.printed else "",
            "rule": rule_words(claim.rule),
            "smallest_flip": row.flip_words,
            "flips": "; ".join(flip.words for flip in row.flips),
            "stands_5_per_cent_more_K_r": "" if row.stiffer is None else bool(row.stiffer),
            "why": claim.depends if row.stiffer else "",
            "figure": claim.figure or "",
            "function": claim.computed or "",
        }

    def summary(self) -> dict[str, Any]:
        """The content of summary.json.

        Returns
        -------
        dict : counts by verdict, what broke, captions of the figures.
        """
        return {
            "command": "reproduce",
            "version": __version__,
            "outcome": self.outcome,
            "chapter": self.chapter,
            "claims": len(self.rows),
            "counts": self.counts,
            "groups": self.groups,
            "broken": self.broken,
            "warnings": [f"{name}: {why}" for name, why in self.broken.items()],
            "figures": {item.name: item.caption for item in self.figures if item.image},
            "tables": sorted(name for name, t in self.tables.items() if not isinstance(t, str)),
        }

    def save(self, directory: str | Path, *, force: bool = False) -> Path:
        """Write a result directory; see `save_reproduction`.

        Parameters
        ----------
        directory, force : as in `save_reproduction`.

        Returns
        -------
        Path : the directory.

        Raises
        ------
        OutputError : the directory exists and `force` is False, or it cannot be written.
        """
        from thermobearing.reproduce.files import save_reproduction

        return save_reproduction(self, Path(directory), force=force)
