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
    "Which tables, figures and statements of Shen (2023) follow from the printed data and "
    "equations alone, which do not, and which changes would turn a verdict?"
)
READING = (
    "Every verdict is computed from a rule and numbers; none is typed.",
    "Statements are of chapters 3 to 6; what chapter 7 repeats of them and what the print has "
    "wrong (a row says what would be true if the print were) are counted apart.",
    "*Not decidable without the motion*: the accelerograms are not free to ship, and another "
    "stand-in of the same spectrum (waves 2, 3 and 3, 1 for 1, 2) turns the verdict, either way.",
    "*Within 1 %*: comparisons closer than 1 % count neither for nor against; fewer than half of "
    "them are as said, and none is against.",
    '*Usually*: of statements with "usually", "typically" or "tends" more than two thirds of the '
    "comparisons beyond 1 % must be as said; of all others every one.",
    "*Echoes an input*: the number is an input or an identity, which no result can change.",
    "*As printed*: the verdict on the printed model (`scheme = published`, `integrator = euler`) "
    "with the same motions.",
    "*Flips*: the smallest relative change of a parameter (symbols of "
    "`data/claims/parameters.toml`) that turns a verdict that holds; *none*: none within reach. A "
    "verdict that 5 % more K_r does not turn says why.",
    "Figures of tests are predictions here: the measurements of Shen (2023) are not public, and "
    "nothing takes their place.",
)
UNJUDGED = "Many runs leave the range in which the bearings were calibrated."


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
        title="Reproduction of Shen (2023): tables, figures and claims",
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
