"""What the document of a reproduction says, from its directory."""

from typing import Any

import pandas as pd

from thermobearing.report.identity import identity_of
from thermobearing.report.pieces import Column, Pieces, ReportFigure, ReportTable
from thermobearing.reproduce.claims import PARTS, load_claims
from thermobearing.reproduce.files import CHAPTERS
from thermobearing.reproduce.judge import CONTRADICTED, HOLDS, NEEDS, REPRODUCED
from thermobearing.results.directory import FIGURES, TABLES
from thermobearing.results.saved import SavedResult

QUESTION = (
    "Which of the tables, figures and statements of the source come out again from its data and "
    "equations alone, which do not, and what would have to change for the verdict to be another?"
)
NOTE = (
    "Flip: the smallest change of a parameter that turns the verdict; none where no change within "
    "reach does. Function: in thermobearing.reproduce."
)
HEADS = {  # of the ledger: column, head
    "place": "Place",
    "statement": "Statement",
    "computed": "Computed",
    "words": "Verdict",
    "smallest_flip": "Flip",
    "why": "Why 5 % more K_r does not flip it",
    "figure": "Figure",
    "function": "Function",
}


def pieces_of(saved: SavedResult) -> Pieces:
    """Everything that the document of a reproduction says.

    Parameters
    ----------
    saved : the directory, read back.
    """
    counts: dict[str, int] = saved.summary["counts"]
    told = saved.summary
    return Pieces(
        command="reproduce",
        title="The source again: tables, figures and claims",
        question=QUESTION,
        answer=_answer(counts, int(told["claims"])),
        tables={"counts": _counts(counts), **_ledger(saved["ledger"]), **_tables(saved)},
        figures=_figures(saved),
        warnings=[str(text) for text in told["warnings"]],
        identity=identity_of(
            str(told["version"]), saved["ledger"].to_csv(), "thermobearing reproduce", "ledger.csv"
        ),
    )


def _answer(counts: dict[str, int], total: int) -> list[str]:
    holds = counts[REPRODUCED] + counts[HOLDS]
    return [
        f"Of {total} claims {holds} hold: {counts[REPRODUCED]} numbers are reproduced and "
        f"{counts[HOLDS]} trends hold.",
        f"{counts[CONTRADICTED]} are contradicted by what its own data and equations give.",
        f"{counts[NEEDS]} can be judged by its measurements only, which are not public.",
    ]


def _counts(counts: dict[str, int]) -> ReportTable:
    columns = [Column("Verdict"), Column("Claims", form="d")]
    return ReportTable("Claims by verdict", columns, [list(item) for item in counts.items()])


def _ledger(ledger: pd.DataFrame) -> dict[str, ReportTable]:
    """A table for each part of the source."""
    told = ledger.astype(object).where(ledger.notna(), "").set_index("id")
    columns = [Column(head) for head in HEADS.values()]
    found = {}
    for part in PARTS:
        ids = [claim.id for claim in load_claims(part) if claim.id in told.index]
        rows: list[list[Any]] = [[str(told.at[name, key]) for key in HEADS] for name in ids]
        if rows:
            found[part] = ReportTable(f"{CHAPTERS[part]}: claims", columns, rows, note=NOTE)
    return found


def _tables(saved: SavedResult) -> dict[str, ReportTable]:
    found = {}
    for name in saved.summary["tables"]:
        table = pd.read_csv(saved.path / TABLES / f"{name}.csv")
        columns = [Column(str(head)) for head in table.columns]
        rows = table.astype(object).where(table.notna(), None).to_numpy().tolist()
        found[str(name)] = ReportTable(str(name).replace("_", " ").replace("-", " "), columns, rows)
    return found


def _figures(saved: SavedResult) -> dict[str, ReportFigure]:
    captions: dict[str, str] = saved.summary["figures"]
    pictures = {file.stem: file for file in sorted((saved.path / FIGURES).glob("*.png"))}
    return {
        name: ReportFigure(caption, image=pictures[name].read_bytes())
        for name, caption in captions.items()
        if name in pictures
    }
