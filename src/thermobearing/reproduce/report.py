"""Report of the reproduction."""

from collections.abc import Callable, Sequence
from typing import Any

import pandas as pd

from thermobearing.report.pieces import Column, Link, Pieces, ReportFigure, ReportTable
from thermobearing.report.words import identity_rows
from thermobearing.reproduce.claims import PARTS, VERDICTS, Claim, claim_function, load_claims
from thermobearing.reproduce.result import CHAPTERS
from thermobearing.reproduce.slips import QUANTITIES
from thermobearing.reproduce.tables import printed_tables
from thermobearing.results.directory import FIGURES, TABLES
from thermobearing.results.saved import SavedResult

FUNCTIONS = "functions"
BEST = 12  # sets of choices that are shown
CHANGE = "_change_percent"
HEADS = (
    *("Place", "Statement", "Computed", "Verdict", "As printed"),
    *("Flips", "Figure", "Function"),
)
OF_SOURCE = (
    *(Column("Quantity"), Column("Of"), Column("Unit"), Column("Printed", form=".6g")),
    *(Column("Here", form=".6g"), Column("Difference", "%", ".2f"), Column("By"), Column("Note")),
)
SHORT = {  # of QUANTITIES
    "inner_layer_K": "Inner layer",
    "lead_K": "Lead",
    "steel_at_lead_K": "Steel at lead",
    "force_kN": "Force",
    "energy_kN_mm": "Energy",
    "bridge_inner_layer_K": "Inner layer, bridge",
    "bridge_force_kN": "Force, bridge",
    "bridge_energy_kN_mm": "Energy, bridge",
    "pier_ductility": "Ductility, bridge",
}
SETS = {
    "joint_bridge": "Bridge (chapter 6): sets of choices that meet most statements, best first",
    "joint_bridge_choices": "Bridge: how much one choice changes the count of statements met, all "
    "else equal",
    "joint_bridge_conflicts": "Bridge: sets that meet a statement; pairs that no set meets",
    "joint_hybrid": "Hybrid test (chapter 3): sets of choices that meet most statements, best "
    "first",
    "joint_hybrid_choices": "Hybrid test: how much one choice changes the count of statements met, "
    "all else equal",
    "joint_hybrid_conflicts": "Hybrid test: sets that meet a statement; pairs that no set meets",
}


def _claims_tables(ledger: pd.DataFrame, part: str) -> ReportTable | None:
    """The claims of a part of the source that are in a ledger; None without any.

    Parameters
    ----------
    ledger : of a reproduction, by the ids of claims, without missing cells.
    part : "chapter-3".
    """
    known = [claim for claim in load_claims(part) if claim.id in ledger.index]
    rows = [_claim_row(claim, ledger) for claim in known]
    columns = [Column(head) for head in HEADS]
    return ReportTable(f"{CHAPTERS[part]}: claims", columns, rows) if rows else None


def _claim_row(claim: Claim, ledger: pd.DataFrame) -> list[Any]:
    told = {key: str(ledger.at[claim.id, key]) for key in ledger.columns}
    flip = "; ".join(filter(None, (told["smallest_flip"], told["why"])))
    figure = claim.figure or ""
    return [
        *(told["place"], told["statement"], told["computed"], told["words"]),
        *(told["printed_model"], flip),
        Link(_figure_words(figure), figure) if figure else "",
        Link(told["function"], FUNCTIONS) if told["function"] else "",
    ]


def _figure_words(name: str) -> str:
    """Of a module's name.

    Examples
    --------
    >>> _figure_words("fig_3_08"), _figure_words("slips")
    ('Fig. 3.8', 'slips')
    """
    kind, _, rest = name.partition("_")
    chapter, _, number = rest.partition("_")
    return f"Fig. {chapter}.{int(number)}" if kind == "fig" else name


def functions_table(ids: Sequence[str]) -> ReportTable:
    """What each function that some claims name computes, in its own words."""
    claims = [claim for claim in load_claims() if claim.id in ids and claim.computed]
    told: dict[str, str] = {}
    for claim in claims:
        words = (claim_function(claim).__doc__ or "").strip().splitlines()
        told.setdefault(str(claim.computed), words[0] if words else "")
    columns = [Column("Function"), Column("What it computes")]
    rows = [list(item) for item in sorted(told.items())]
    note = "In thermobearing.reproduce; each takes `Runs()`."
    return ReportTable("Functions of the claims", columns, rows, note=note)


def make_table(name: str, table: pd.DataFrame) -> ReportTable:
    """A table of the directory as a reader wants it."""
    for start, make in MAKERS.items():
        if name.startswith(start):
            return make(name, table)
    columns = [Column(str(head)) for head in table.columns]
    return ReportTable(name.replace("_", " "), columns, _rows(table))


def _rows(table: pd.DataFrame) -> list[list[Any]]:
    found: list[list[Any]] = table.astype(object).where(table.notna(), None).to_numpy().tolist()
    return found


def _of_source(name: str, table: pd.DataFrame) -> ReportTable:
    (printed,) = [item for item in printed_tables() if item.name == name]
    caption = f"Table {printed.number}: {printed.title}"
    rows = [[_number(value) for value in row] for row in _rows(table)]
    return ReportTable(caption, OF_SOURCE, rows, keys=2, note=printed.note)


def _number(value: Any) -> Any:
    """A column with words among its numbers is read as words."""
    try:
        return float(value)
    except (TypeError, ValueError):
        return value


def _slips(_name: str, table: pd.DataFrame) -> ReportTable:
    """Changes in per cent: of a chain against the row above, of a slip alone against the first."""
    columns = [Column("Bearing"), Column("Slips"), Column("What the print does")]
    columns += [Column(SHORT[key], "%", ".1f") for key in QUANTITIES]
    chosen = ["bearing", "kind", "means", *(f"{key}{CHANGE}" for key in QUANTITIES)]
    words = {"chain": "on top of those above", "alone": "alone"}
    shown = table[chosen].assign(kind=table["kind"].map(words))
    note = "; ".join(f"{SHORT[key]}: {means}" for key, means in QUANTITIES.items())
    caption = (
        "Change of the result by each slip of the printed heat scheme: on top of those above, "
        "against the row above; alone, against the scheme without any"
    )
    return ReportTable(caption, columns, _rows(shown), keys=3, note=f"{note}. All at −20 °C.")


def _sets(name: str, table: pd.DataFrame) -> ReportTable:
    """Without the numbers behind each statement, which are in the CSV file."""
    shown = table[[head for head in table.columns if ": numbers" not in head and head != "why"]]
    note = f"{len(table)} sets; the numbers behind each statement are in tables/{name}.csv."
    if "met" in shown:
        shown = shown.head(BEST)
    else:
        note = ""
    columns = [Column(str(head).replace("_", " ")) for head in shown.columns]
    return ReportTable(SETS.get(name, name), columns, _rows(shown), note=note)


MAKERS: dict[str, Callable[[str, pd.DataFrame], ReportTable]] = {
    "table_": _of_source,
    "slips": _slips,
    "joint_": _sets,
}
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


def build_pieces(saved: SavedResult) -> Pieces:
    """Everything that the document of a reproduction says.

    Parameters
    ----------
    saved : the directory, read back.
    """
    told = saved.summary
    groups: dict[str, dict[str, int]] = told["groups"]
    rows = saved["ledger"]
    ledger = rows.astype(object).where(rows.notna(), "").set_index("id")
    claims = {part: _claims_tables(ledger, part) for part in PARTS}
    tables = {"counts": _counts(groups)}
    tables |= {part: table for part, table in claims.items() if table is not None}
    tables |= {
        str(name): make_table(str(name), pd.read_csv(saved.path / TABLES / f"{name}.csv"))
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
        identity=identity_rows(
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
