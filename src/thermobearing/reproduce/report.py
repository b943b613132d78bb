"""What the document of a reproduction says, from its directory."""

import pandas as pd

from thermobearing.report.identity import identity_of
from thermobearing.report.pieces import Column, Pieces, ReportFigure, ReportTable
from thermobearing.reproduce.claims import PARTS
from thermobearing.reproduce.judge import VERDICTS
from thermobearing.reproduce.report_tables import (
    FUNCTIONS,
    claims_tables,
    functions_table,
    table_of,
)
from thermobearing.results.directory import FIGURES, TABLES
from thermobearing.results.saved import SavedResult

QUESTION = (
    "Which of the tables, figures and statements of the source come out again from its data and "
    "equations alone, which do not, and what would have to change for the verdict to be another?"
)
READING = (
    "Every verdict is computed from a rule and the numbers beside it; none is typed.",
    "What flips it: the smallest relative change of a parameter (symbols of "
    "`data/claims/parameters.toml`) that turns a verdict that holds; then why 5 % more K_r does "
    "not, where it does not.",
    "Figures that the source shows of tests are predictions here: its measurements are not public, "
    "and nothing takes their place. Its accelerograms are replaced by motions made to their "
    "spectra.",
)
UNJUDGED = "Many of the source's runs leave the range that it identified its bearings in."


def pieces_of(saved: SavedResult) -> Pieces:
    """Everything that the document of a reproduction says.

    Parameters
    ----------
    saved : the directory, read back.
    """
    told = saved.summary
    groups: dict[str, dict[str, int]] = told["groups"]
    rows = saved["ledger"]
    ledger = rows.astype(object).where(rows.notna(), "").set_index("id")
    claims = {part: claims_tables(ledger, part) for part in PARTS}
    tables = {"counts": _counts(groups)}
    tables |= {part: table for part, table in claims.items() if table is not None}
    tables |= {
        str(name): table_of(str(name), pd.read_csv(saved.path / TABLES / f"{name}.csv"))
        for name in told["tables"]
    }
    tables[FUNCTIONS] = functions_table(list(ledger.index))
    return Pieces(
        command="reproduce",
        title="The source again: tables, figures and claims",
        question=QUESTION,
        answer=_answer(groups),
        tables=tables,
        figures=_figures(saved),
        validity_unknown=UNJUDGED,
        assumptions=READING,
        warnings=[str(text) for text in told["warnings"]],
        identity=identity_of(
            str(told["version"]), saved["ledger"].to_csv(), "thermobearing reproduce", "ledger.csv"
        ),
    )


def _answer(groups: dict[str, dict[str, int]]) -> list[str]:
    return [
        f"Of {sum(counts.values())} {group}, "
        + ", ".join(f"{number} {kind}" for kind, number in counts.items() if number)
        + "."
        for group, counts in groups.items()
    ]


def _counts(groups: dict[str, dict[str, int]]) -> ReportTable:
    columns = [Column("Verdict"), *(Column(group.capitalize(), form="d") for group in groups)]
    rows = [[name, *(counts[name] for counts in groups.values())] for name in VERDICTS]
    return ReportTable("Claims by verdict", columns, rows)


def _figures(saved: SavedResult) -> dict[str, ReportFigure]:
    captions: dict[str, str] = saved.summary["figures"]
    pictures = {file.stem: file for file in sorted((saved.path / FIGURES).glob("*.png"))}
    return {
        name: ReportFigure(caption, image=pictures[name].read_bytes())
        for name, caption in captions.items()
        if name in pictures
    }
