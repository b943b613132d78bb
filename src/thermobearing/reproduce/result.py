"""Result of the reproduction: counts, directory, console tables."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd

from thermobearing import __version__
from thermobearing.border.deprecated import renamed
from thermobearing.border.showing import Shown
from thermobearing.reproduce.claims import (
    CONTRADICTED,
    FAILED,
    GROUPS,
    VERDICTS,
    Row,
    computed_words,
    mean_group,
    rule_words,
)
from thermobearing.reproduce.work import Drawn
from thermobearing.results.directory import (
    FIGURES,
    INDEX,
    LEDGER,
    LEDGER_JSON,
    TABLES,
    write_directory,
)
from thermobearing.results.screen import print_table, print_warnings, say
from thermobearing.results.writing import without_nan, write_csv, write_summary

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
            found[mean_group(row.claim.id)][row.verdict.kind] += 1
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

    @renamed(force="overwrite")
    def save(self, directory: str | Path, *, overwrite: bool = False) -> Path:
        """Write a result directory; see `_save_reproduction`.

        Parameters
        ----------
        directory, overwrite : as in `_save_reproduction`.

        Returns
        -------
        Path : the directory.

        Raises
        ------
        OutputError : the directory exists and `force` is False, or it cannot be written.
        """
        return _save_reproduction(self, Path(directory), overwrite=overwrite)


CHAPTERS = {
    "chapter-3": "Chapter 3, tests",
    "chapter-4": "Chapter 4, high damping rubber",
    "chapter-5": "Chapter 5, lead cores",
    "chapter-6": "Chapter 6, bridge",
    "conclusions": "Chapter 7 and conclusions",
    "misprints": "Misprints",
}


def _save_reproduction(found: Reproduction, directory: Path, *, overwrite: bool = False) -> Path:
    """Write summary.json, ledger.csv, ledger.json, index.md, tables/ and figures/.

    Parameters
    ----------
    found : what to write.
    directory : made if needed, with its parents.
    overwrite : replace an earlier result directory.

    Returns
    -------
    Path : the directory.

    Raises
    ------
    OutputError : see `write_directory`; nothing is left.
    """

    def fill(folder: Path) -> None:
        write_summary(folder, found.summary())
        write_csv(folder / LEDGER, found.ledger)
        text = json.dumps(without_nan(_ledger_records(found)), indent=1, ensure_ascii=False)
        (folder / LEDGER_JSON).write_text(text + "\n", encoding="utf-8")
        (folder / INDEX).write_text(_index_text(found), encoding="utf-8")
        (folder / TABLES).mkdir()
        for name, table in found.tables.items():
            if not isinstance(table, str):
                write_csv(folder / TABLES / f"{name}.csv", table)
        (folder / FIGURES).mkdir()
        for item in found.figures:
            if item.image is not None:
                (folder / FIGURES / f"{item.name}.png").write_bytes(item.image)

    return write_directory(directory, fill, overwrite=overwrite)


def _ledger_records(found: Reproduction) -> list[dict[str, object]]:
    """The ledger with numbers as numbers."""
    records = []
    for row, told in zip(found.rows, found.ledger.to_dict("records"), strict=True):
        changes = {flip.parameter: flip.change for flip in row.flips}
        record = {str(key): value for key, value in told.items()}
        record |= {"numbers": row.computed, "flips": changes}
        records.append(record | {"stands_5_per_cent_more_K_r": row.stiffer})
    return records


def _index_text(found: Reproduction) -> str:
    """Markdown: each claim by chapter, with its verdict, its figure and its function."""
    from thermobearing.reproduce.claims import load_claims

    known = {row.claim.id: row for row in found.rows}
    drawn = {item.name for item in found.figures if item.image is not None}
    lines = ["# Reproduction of Shen (2023)", "", found.headline + ".", ""]
    for part, title in CHAPTERS.items():
        rows = [known[claim.id] for claim in load_claims(part) if claim.id in known]
        if not rows:
            continue
        lines += [f"## {title}", "", "| place | statement | verdict | figure | function |"]
        lines += ["|---|---|---|---|---|"]
        for row in rows:
            claim = row.claim
            name = claim.figure if claim.figure in drawn else None
            figure = f"[{name}]({FIGURES}/{name}.png)" if name else ""
            function = f"`{claim.computed}`" if claim.computed else ""
            cells = (claim.place, claim.statement, row.verdict.words, figure, function)
            lines.append("| " + " | ".join(cells) + " |")
        lines.append("")
    if drawn:
        lines += ["## Figures", ""]
        shown = [item for item in found.figures if item.image is not None]
        lines += [f"- [{item.name}]({FIGURES}/{item.name}.png): {item.caption}" for item in shown]
    return "\n".join(lines).rstrip() + "\n"


LONGEST = 70  # letters of a statement


def print_reproduction(found: Reproduction) -> None:
    """Print counts by verdict, the statements that are contradicted, and what broke.

    Parameters
    ----------
    found : from `reproduce_source`.
    """
    groups = found.groups
    kinds = [(name, [str(counts[name]) for counts in groups.values()]) for name in VERDICTS]
    sums = [str(sum(counts.values())) for counts in groups.values()]
    rows = [(name, *numbers) for name, numbers in [*kinds, ("all", sums)] if set(numbers) != {"0"}]
    print_table(("verdict", *groups), rows)
    against = [
        (row.claim.place, _short(row.claim.statement), row.verdict.words)
        for row in found.rows
        if row.verdict.kind == CONTRADICTED and mean_group(row.claim.id) != "misprints"
    ]
    if against:
        print_table(("place", "statement", "verdict"), against, title="contradicted", keys=2)
    firm = [row for row in found.rows if row.verdict.settled and row.smallest]
    if firm:
        least = min(firm, key=lambda row: abs(row.smallest.change or 0.0) if row.smallest else 1.0)
        if least.smallest:
            say(f"\nmost easily flipped: {least.claim.id} ({least.smallest.words})")
    pictures = sum(item.image is not None for item in found.figures)
    if found.figures or found.tables:
        say(f"figures: {pictures}, tables: {len(found.tables)}")
    print_warnings(f"{name}: {why}" for name, why in found.broken.items())
    failed = sum(row.verdict.kind == FAILED for row in found.rows)
    if failed:
        say(f"{failed} rows failed")


def _short(text: str) -> str:
    return text if len(text) <= LONGEST else text[: LONGEST - 1].rstrip() + "…"
