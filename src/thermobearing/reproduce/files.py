"""The directory of a reproduction: ledger, tables, figures, index by chapter."""

import json
from pathlib import Path

from thermobearing.reproduce.result import Reproduction
from thermobearing.results.directory import (
    FIGURES,
    INDEX,
    LEDGER,
    LEDGER_JSON,
    TABLES,
    write_directory,
)
from thermobearing.results.writing import without_nan, write_csv, write_summary

CHAPTERS = {
    "chapter-3": "Chapter 3, tests",
    "chapter-4": "Chapter 4, high damping rubber",
    "chapter-5": "Chapter 5, lead cores",
    "chapter-6": "Chapter 6, bridge",
    "conclusions": "Chapter 7 and conclusions",
    "misprints": "Misprints",
}


def save_reproduction(found: Reproduction, directory: Path, *, force: bool = False) -> Path:
    """Write summary.json, ledger.csv, ledger.json, index.md, tables/ and figures/.

    Parameters
    ----------
    found : what to write.
    directory : made if needed, with its parents.
    force : replace an earlier result directory.

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
        text = json.dumps(without_nan(ledger_records(found)), indent=1, ensure_ascii=False)
        (folder / LEDGER_JSON).write_text(text + "\n", encoding="utf-8")
        (folder / INDEX).write_text(index_text(found), encoding="utf-8")
        (folder / TABLES).mkdir()
        for name, table in found.tables.items():
            if not isinstance(table, str):
                write_csv(folder / TABLES / f"{name}.csv", table)
        (folder / FIGURES).mkdir()
        for item in found.figures:
            if item.image is not None:
                (folder / FIGURES / f"{item.name}.png").write_bytes(item.image)

    return write_directory(directory, fill, force=force)


def ledger_records(found: Reproduction) -> list[dict[str, object]]:
    """The ledger with numbers as numbers."""
    records = []
    for row, told in zip(found.rows, found.ledger.to_dict("records"), strict=True):
        changes = {flip.parameter: flip.change for flip in row.flips}
        record = {str(key): value for key, value in told.items()}
        record |= {"numbers": row.computed, "flips": changes}
        records.append(record | {"stands_5_per_cent_more_K_r": row.stiffer})
    return records


def index_text(found: Reproduction) -> str:
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
