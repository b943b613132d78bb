"""The reproduction as a result: counts, console, directory, document."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from reproduction.claims import (
    CHAPTERS,
    CONTRADICTED,
    FAILED,
    GROUPS,
    VERDICTS,
    Row,
    computed_words,
    group_by_id,
    load_claims,
    rule_words,
)
from reproduction.measures import functions
from reproduction.runs import DATA
from reproduction.slips import QUANTITIES
from reproduction.tables import printed_tables
from thermobearing import __version__
from thermobearing.border.title import TitleBlock
from thermobearing.quantities.register import Quantity
from thermobearing.quantities.tables import Table
from thermobearing.quantities.words import identity_rows
from thermobearing.report.pieces import Link, Pieces, ReportFigure
from thermobearing.reporting import put_files, report_files
from thermobearing.results.base import Result
from thermobearing.results.directory import FIGURES, RESULT_NAMES
from thermobearing.results.screen import print_warnings, say, show_table
from thermobearing.results.writing import without_nan, write_csv

LEDGER, LEDGER_JSON, INDEX, TABLES = "ledger.csv", "ledger.json", "index.md", "tables"
RESULT_NAMES.update({LEDGER, LEDGER_JSON, INDEX, TABLES})  # what may be replaced
PARTLY = "Rows, figures or tables broke; each says why. The others are whole."
LONGEST = 70  # letters of a statement
EXPRESSIONS, NAMES = "expressions", "names"
BEST = 12  # sets of choices that are shown
CHANGE = "_change_percent"
HEADS = (
    "Place",
    "Statement",
    "Computed",
    "Verdict",
    "As printed",
    "Flips",
    "Figure",
    "Expression",
)
OF_TABLE = (
    Quantity("Quantity"),
    Quantity("Of"),
    Quantity("Unit"),
    Quantity("Printed", form=".6g"),
    Quantity("Here", form=".6g"),
    Quantity("Difference", "%", ".2f"),
    Quantity("By"),
    Quantity("Note"),
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
    f"joint_{study}{kind}": f"{name}: {words}"
    for study, name in (("bridge", "Bridge (chapter 6)"), ("hybrid", "Hybrid test (chapter 3)"))
    for kind, words in (
        ("", "sets of choices that meet most statements, best first"),
        ("_choices", "how much one choice changes the count of statements met, all else equal"),
        ("_conflicts", "sets that meet a statement; pairs that no set meets"),
    )
}
QUESTION = (
    "Which tables, figures and statements of Shen (2023) follow from the printed data and "
    "equations alone, which do not, and which changes would turn a verdict?"
)
READING = (
    "Every verdict is computed from a rule and numbers; none is typed.",
    "The statements are those of chapters 3 to 6. Repetitions in chapter 7 and misprints (the row "
    "states the corrected value) are counted separately.",
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
    "`reproduction/data/parameters.toml`) that turns a verdict that holds; *none*: none within "
    "reach. A verdict that 5 % more K_r does not turn says why.",
    "Figures of tests are predictions here: the measurements of Shen (2023) are not public, and "
    "nothing takes their place.",
)
UNJUDGED = "Many runs leave the range in which the bearings were calibrated."


class Drawn(NamedTuple):
    """A figure ("fig_4_07") with its caption as PNG; none and the reason if it broke."""

    name: str
    caption: str
    image: bytes | None = None


@dataclass(frozen=True, repr=False)
class Reproduction(Result):
    """Shen (2023) again: rows in order, figures, and tables by name (words where one broke)."""

    chapter: int | None
    rows: Sequence[Row]
    figures: Sequence[Drawn] = ()
    tables_by_name: Mapping[str, pd.DataFrame | str] = field(default_factory=dict)
    records: Mapping[str, str] = field(default_factory=dict)  # of the tests: files by name

    @property
    def groups(self) -> dict[str, dict[str, int]]:
        """Count rows by verdict of each group of claims: statements, repeats, misprints."""
        totals = {group: dict.fromkeys(VERDICTS, 0) for group in GROUPS}
        for row in self.rows:
            totals[group_by_id(row.claim.id)][row.verdict.kind] += 1
        return {group: counts for group, counts in totals.items() if any(counts.values())}

    @property
    def headline(self) -> str:
        """Return the counts in a line."""
        return "Reproduction: " + "; ".join(sentence[3:-1] for sentence in self._answer())

    def _answer(self) -> list[str]:
        return [
            f"Of {sum(counts.values())} {group}, "
            + ", ".join(f"{number} {kind}" for kind, number in counts.items() if number)
            + "."
            for group, counts in self.groups.items()
        ]

    @property
    def broken(self) -> dict[str, str]:
        """Return what broke, and why."""
        reasons = {
            row.claim.id: row.verdict.words for row in self.rows if row.verdict.kind == FAILED
        }
        reasons |= {item.name: item.caption for item in self.figures if item.image is None}
        return reasons | {
            name: item for name, item in self.tables_by_name.items() if isinstance(item, str)
        }

    @property
    def warnings(self) -> list[str]:
        """Return what broke as sentences."""
        return [f"{name}: {reason}" for name, reason in self.broken.items()]

    @property
    def outcome(self) -> str:
        """Return whether all is whole: "completed" or "partly"."""
        return "partly" if self.broken else "completed"

    @property
    def sentence(self) -> str:
        """Return what the outcome means; empty when it completed."""
        return PARTLY if self.broken else ""

    @cached_property
    def table(self) -> pd.DataFrame:
        """The ledger: place, statement, verdict, numbers, printed model, rule and flips by row."""
        return pd.DataFrame([_ledger_row(row) for row in self.rows])

    def summary(self) -> dict[str, Any]:
        """Return counts by verdict, what broke, captions of the figures."""
        records = {"records": dict(self.records)} if self.records else {}
        return records | {
            "command": "reproduce",
            "version": __version__,
            "outcome": self.outcome,
            "chapter": self.chapter,
            "claims": len(self.rows),
            "groups": self.groups,
            "broken": self.broken,
            "warnings": self.warnings,
            "figures": {item.name: item.caption for item in self.figures if item.image},
            "tables": sorted(
                name for name, t in self.tables_by_name.items() if not isinstance(t, str)
            ),
        }

    def _write(self, folder: Path) -> None:
        write_csv(folder / LEDGER, self.table)
        records = []
        for row, record in zip(self.rows, self.table.to_dict("records"), strict=True):
            numbers = {"numbers": row.computed, "flips": dict(row.flips)}
            stiffer = {"stands_5_per_cent_more_K_r": row.stiffer}
            records.append({str(k): v for k, v in record.items()} | numbers | stiffer)
        text = json.dumps(without_nan(records), indent=1, ensure_ascii=False)
        (folder / LEDGER_JSON).write_text(text + "\n", encoding="utf-8")
        (folder / INDEX).write_text(self._index(), encoding="utf-8")
        (folder / TABLES).mkdir()
        for name, table in self.tables_by_name.items():
            if not isinstance(table, str):
                write_csv(folder / TABLES / f"{name}.csv", table)
        (folder / FIGURES).mkdir()
        for item in self.figures:
            if item.image is not None:
                (folder / FIGURES / f"{item.name}.png").write_bytes(item.image)

    def _index(self) -> str:
        """Return Markdown: each claim by chapter, with its verdict, its figure, its expression."""
        by_id = {row.claim.id: row for row in self.rows}
        drawn = {item.name: item.caption for item in self.figures if item.image is not None}
        lines = ["# Reproduction of Shen (2023)", "", self.headline + ".", ""]
        for part, title in CHAPTERS.items():
            rows = [by_id[claim.id] for claim in load_claims(part) if claim.id in by_id]
            if not rows:
                continue
            lines += [f"## {title}", "", "| place | statement | verdict | figure | expression |"]
            lines += ["|---|---|---|---|---|"]
            for row in rows:
                claim, name = row.claim, row.claim.figure
                figure = f"[{name}]({FIGURES}/{name}.png)" if name in drawn else ""
                computed = f"`{claim.computed}`" if claim.computed else ""
                cells = (claim.place, claim.statement, row.verdict.words, figure, computed)
                lines.append("| " + " | ".join(cells) + " |")
            lines.append("")
        if drawn:
            lines += ["## Figures", ""]
            lines += [f"- [{k}]({FIGURES}/{k}.png): {caption}" for k, caption in drawn.items()]
        return "\n".join(lines).rstrip() + "\n"

    def show(self) -> None:
        """Print counts by verdict, the statements that are contradicted, and what broke."""
        groups = self.groups
        kinds = [(name, [str(counts[name]) for counts in groups.values()]) for name in VERDICTS]
        kinds.append(("all", [str(sum(counts.values())) for counts in groups.values()]))
        rows = [(name, *numbers) for name, numbers in kinds if set(numbers) != {"0"}]
        show_table(Table("", list(map(Quantity, ("verdict", *groups))), rows))
        against = [
            (row.claim.place, _short(row.claim.statement), row.verdict.words)
            for row in self.rows
            if row.verdict.kind == CONTRADICTED and group_by_id(row.claim.id) != "misprints"
        ]
        if against:
            columns = list(map(Quantity, ("place", "statement", "verdict")))
            show_table(Table("contradicted", columns, against, keys=2))
        firm = [(abs(row.smallest.change or 0.0), row) for row in self.rows if row.smallest]
        if firm:
            most_fragile = min(firm, key=lambda pair: pair[0])[1]
            say(f"\nmost easily flipped: {most_fragile.claim.id} ({most_fragile.flip_words})")
        pictures = sum(item.image is not None for item in self.figures)
        if self.figures or self.tables_by_name:
            say(f"figures: {pictures}, tables: {len(self.tables_by_name)}")
        print_warnings(self.warnings)

    def pieces(self) -> Pieces:
        """Return everything that the document of the reproduction says."""
        groups = self.groups
        columns = [
            Quantity("Verdict"),
            *(Quantity(group.capitalize(), form="d") for group in groups),
        ]
        counts = [
            [name, *(group_counts[name] for group_counts in groups.values())] for name in VERDICTS
        ]
        tables = {"counts": Table("Claims by verdict", columns, counts)}
        for part, title in CHAPTERS.items():
            ids = {claim.id for claim in load_claims(part)}
            rows = [_claim_row(row) for row in self.rows if row.claim.id in ids]
            if rows:
                heads = [Quantity(head) for head in HEADS]
                tables[part] = Table(f"{title}: claims", heads, rows)
        for name, table in self.tables_by_name.items():
            if not isinstance(table, str):
                tables[name] = report_table(name, table)
        expressions = [[row.claim.id, row.claim.computed] for row in self.rows if row.computed]
        columns = [Quantity("Claim"), Quantity("Expression")]
        tables[EXPRESSIONS] = Table("Expressions of the claims", columns, expressions)
        tables[NAMES] = names_table([str(text) for _, text in expressions])
        return Pieces(
            command="reproduce",
            title="Reproduction of Shen (2023): tables, figures and claims",
            question=QUESTION,
            answer=self._answer(),
            tables=tables,
            figures={
                item.name: ReportFigure(item.caption, image=item.image)
                for item in self.figures
                if item.image is not None
            },
            validity_unknown=UNJUDGED,
            assumptions=READING,
            warnings=self.warnings,
            identity=identity_rows(
                __version__, self.table.to_csv(), "python -m reproduction", LEDGER
            ),
        )

    def write_report(self, directory: Path, *, pdf: bool = True) -> list[Path]:
        """Write report.html and report.pdf into the directory of the reproduction."""
        template = DATA / "report.md"
        return put_files(directory, report_files(self.pieces(), TitleBlock(), template, pdf=pdf))


def _short(text: str) -> str:
    return text if len(text) <= LONGEST else text[: LONGEST - 1].rstrip() + "…"


def _ledger_row(row: Row) -> dict[str, Any]:
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
        "expression": claim.computed or "",
    }


def _claim_row(row: Row) -> list[Any]:
    cells, figure = _ledger_row(row), row.claim.figure or ""
    return [
        cells["place"],
        cells["statement"],
        cells["computed"],
        cells["words"],
        cells["printed_model"],
        "; ".join(filter(None, (cells["smallest_flip"], cells["why"]))),
        Link(_figure_words(figure), figure) if figure else "",
        Link(row.claim.id, EXPRESSIONS) if row.claim.computed else "",
    ]


def _figure_words(name: str) -> str:
    """Return "Fig. 3.8" for "fig_3_08", and other names as they are."""
    kind, _, numbers = name.partition("_")
    chapter, _, number = numbers.partition("_")
    return f"Fig. {chapter}.{int(number)}" if kind == "fig" else name


def names_table(expressions: Sequence[str]) -> Table:
    """Return what each function that some expressions name computes, in its own words."""
    text = "\n".join(expressions)
    rows = [
        [name, (function.__doc__ or "").strip().splitlines()[0].removeprefix("Return ")]
        for name, function in sorted(functions().items())
        if f"{name}(" in text
    ]
    columns = [Quantity("Function"), Quantity("What it returns")]
    return Table("Functions of the expressions", columns, rows)


def report_table(name: str, table: pd.DataFrame) -> Table:
    """Return a table of the directory as a reader wants it."""
    if name.startswith("table_"):
        (printed,) = [item for item in printed_tables() if item.name == name]
        caption = f"Table {printed.number}: {printed.title}"
        return Table(caption, OF_TABLE, _cells(table), keys=2, note=printed.note)
    if name == "slips":
        return _slips_table(table)
    # Without the numbers behind each statement, which are in the CSV file.
    shown = table[[head for head in table.columns if ": numbers" not in head and head != "why"]]
    note = f"{len(table)} sets; the numbers behind each statement are in tables/{name}.csv."
    if "met" in shown:
        shown = shown.head(BEST)
    else:
        note = ""
    columns = [Quantity(str(head).replace("_", " ")) for head in shown.columns]
    return Table(SETS[name], columns, _cells(shown), note=note)


def _cells(table: pd.DataFrame) -> list[list[Any]]:
    cells: list[list[Any]] = table.astype(object).where(table.notna(), None).to_numpy().tolist()
    return cells


def _slips_table(table: pd.DataFrame) -> Table:
    """Changes in per cent: of a chain against the row above, of a slip alone against the first."""
    columns = [Quantity("Bearing"), Quantity("Slips"), Quantity("What the published scheme does")]
    columns += [Quantity(SHORT[key], "%", ".1f") for key in QUANTITIES]
    columns_shown = ["bearing", "kind", "means", *(f"{key}{CHANGE}" for key in QUANTITIES)]
    words = {"chain": "on top of those above", "alone": "alone"}
    shown = table[columns_shown].assign(kind=table["kind"].map(words))
    note = "; ".join(f"{SHORT[key]}: {means}" for key, means in QUANTITIES.items())
    caption = (
        "Change of the result by each slip of the printed heat scheme: on top of those above, "
        "against the row above; alone, against the scheme without any"
    )
    return Table(caption, columns, _cells(shown), keys=3, note=f"{note}. All at −20 °C.")
