"""Report sections built from a saved result."""

import json
import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd

from thermobearing.report.pieces import Column, Pieces, Plot, ReportFigure, ReportTable
from thermobearing.report.words import identity_rows, tidy
from thermobearing.results.directory import COMPARISON, FIGURES, SUMMARY
from thermobearing.results.ranges import NOT_GIVEN, parted
from thermobearing.results.saved import SavedResult


def saved_figures(saved: SavedResult, captions: Mapping[str, str]) -> dict[str, ReportFigure]:
    """Pictures of a result directory with their captions: lines where there is an SVG.

    Parameters
    ----------
    saved : the result.
    captions : by the beginning of the file's name; the longest that fits counts. Those come
        first, in this order.
    """
    names = {path.stem: path for path in saved.figures}

    def beginning(name: str) -> str:
        fitting = [start for start in captions if name.startswith(start)]
        return max(fitting, key=len, default="")

    order = list(captions)
    chosen = sorted(names, key=lambda n: order.index(b) if (b := beginning(n)) else len(order))
    found = {}
    for name in chosen:
        vector = names[name].with_suffix(".svg")
        image = (vector if vector.is_file() else names[name]).read_bytes()
        own = name.replace("_", " ").replace("-", " ")
        caption = captions.get(beginning(name), f"{own[:1].upper()}{own[1:]}.")
        found[name] = ReportFigure(caption, image=image, alt=caption)
    return found


def with_plot(
    found: dict[str, ReportFigure], name: str, plot: Plot, captions: Mapping[str, str]
) -> dict[str, ReportFigure]:
    """Figures with a plot beside one of them; first, and without a picture, where it has none."""
    if name in found:
        return {**found, name: replace(found[name], plot=plot)}
    return {name: ReportFigure(captions[name], alt=captions[name], plot=plot), **found}


def saved_identity(saved: SavedResult, otherwise: str) -> dict[str, str]:
    """Version, hash of what went in, and the command that was typed.

    Parameters
    ----------
    saved : the result.
    otherwise : what made it, where no command was typed.
    """
    summary = saved.summary
    told = summary.get("inputs")
    what = "inputs and tests in summary.json" if told is not None else "summary.json"
    tests = [_content(one) for one in summary.get("records", summary.get("comparisons", []))]
    text = json.dumps([told, tests] if told is not None else summary, sort_keys=True)
    command = str(summary.get("command_line") or otherwise)
    return identity_rows(str(summary.get("version", "unknown")), text, command, what)


def _content(record: Mapping[str, Any]) -> str:
    """Hash of a test's samples, where it is known."""
    return str((record.get("conditions") or {}).get("sha256", ""))


def saved_validity(saved: SavedResult) -> tuple[list[str], str, list[str]]:
    """Sentences on validity, why there are none, and the other warnings."""
    told, others = parted(dict.fromkeys(saved.warnings))
    asked = bool(saved.summary.get("tested_range"))
    unknown = [text for text in told if NOT_GIVEN in text] if not asked else []
    validity = [] if unknown else list(map(tidy, told))
    return validity, " ".join(map(tidy, told)) if unknown else "", list(map(tidy, others))


# Ends of names of columns and of keys of a summary, and the unit that they say.
UNITS = {
    **{unit: unit for unit in ("mm", "kN", "MPa", "s", "K", "t", "Hz", "gal", "kJ", "m")},
    **{"degC": "°C", "kN_mm": "kN mm", "kN_per_mm": "kN/mm", "mm_s": "mm/s", "m_s2": "m/s²"},
    **{"cm_s": "cm/s", "cm": "cm", "kN_m": "kN m", "kNmm": "kN mm", "percent": "%"},
    **{"m_s": "m/s", "rad": "rad"},
}
MOST_ROWS = 400  # of a table in a document; longer ones stay in their files
TOLD_APART = {"command", "warnings", "outcome", "sentence", "version", "tested_range", "rig"}


def pieces_of_saved(saved: SavedResult) -> Pieces:
    """Summary, tables and pictures of a result directory.

    Parameters
    ----------
    saved : of any command.
    """
    summary = saved.summary
    sentence = str(summary.get("sentence") or f"The analysis ended: {saved.outcome}.")
    tables = {name: make_table(name, table) for name, table in saved.tables.items()}
    facts = [(words(key)[0], value, words(key)[1]) for key, value in _plain(summary)]
    columns = [Column("What"), Column("Value"), Column("Unit")]
    inputs = {"facts": ReportTable("What the summary says", columns, facts)} if facts else {}
    return Pieces(
        command=saved.command,
        title=f"Result of {saved.command}",
        question=f"What `thermobearing {saved.command}` was asked, and found.",
        answer=[sentence],
        inputs=inputs,
        tables=tables,
        figures=saved_figures(saved, {}),
        warnings=saved.warnings,
        identity={"Program": f"thermobearing {summary.get('version', '')}".strip()},
    )


def words(name: str) -> tuple[str, str]:
    """Words and unit of a column such as "peak_force_kN".

    Examples
    --------
    >>> words("peak_force_kN")
    ('peak force', 'kN')
    """
    if re.match(r"K_.*_kN_mm$", name):  # a stiffness; elsewhere kN_mm is an energy
        return re.sub(r"[_\s]+", " ", name.removesuffix("_kN_mm")), "kN/mm"
    for end in sorted(UNITS, key=len, reverse=True):
        if name.endswith(f"_{end}"):
            return re.sub(r"[_\s]+", " ", name.removesuffix(f"_{end}")), UNITS[end]
    return re.sub(r"[_\s]+", " ", name), ""


def make_table(name: str, table: pd.DataFrame) -> ReportTable:
    """A table of a result directory; of a long one its first rows."""
    shown = table.head(MOST_ROWS).dropna(axis="columns", how="all")
    rows = [tuple(row) for row in shown.itertuples(index=False, name=None)]
    left = len(table) - len(shown)
    note = f"The first {MOST_ROWS} of {len(table)} rows; all are in {name}.csv." if left else ""
    columns = [table_column(str(title), shown[title]) for title in shown.columns]
    return ReportTable(words(name)[0].capitalize(), columns, rows, note=note)


def table_column(title: str, values: "pd.Series[Any]") -> Column:
    """A column of a table of a result directory; symbols keep their small letters."""
    head, unit = words(title)
    begins = head.split(" ")[0]
    head = f"{head[:1].upper()}{head[1:]}" if len(begins) > 1 else head
    return Column(head, unit, _number_form(values))


def _number_form(values: "pd.Series[Any]") -> str:
    """How numbers of a column are written: four digits that count, or as many as are whole."""
    if not pd.api.types.is_numeric_dtype(values) or pd.api.types.is_bool_dtype(values):
        return ".4g"
    largest = float(values.abs().max())
    return f".{max(4, len(f'{largest:.0f}'))}g"


def _plain(summary: dict[str, Any]) -> list[tuple[str, Any]]:
    """Single values of a summary; the rest is in tables."""
    found = []
    for key, value in summary.items():
        if isinstance(value, list) and all(isinstance(item, str | int | float) for item in value):
            value = ", ".join(map(str, value))
        if isinstance(value, str | int | float) and key not in TOLD_APART:
            found.append((key, value))
    return found


CAPTIONS = {
    "comparison": "Earlier models beside the multi-layer one.",
    "comparison_loops": "Loops of the multi-layer model and of a single temperature.",
}
NOTE = "Model less multi-layer model; rms: root mean square."
UNIT_WORDS = ("K", "%")  # last words of titles of columns
ALIKE = ("motion", "mode")  # told once where all runs have the same


def comparison_pieces(directory: Path) -> tuple[ReportTable, dict[str, ReportFigure]]:
    """Table and pictures of a comparison.

    Parameters
    ----------
    directory : with comparison.csv.
    """
    told = pd.read_csv(directory / COMPARISON)
    if "outcome" in told and (told["outcome"] == "completed").all():
        told = told.drop(columns="outcome")
    told = told.dropna(axis="columns", how="all")
    alike = {key: told[key].iloc[0] for key in ALIKE if key in told and told[key].nunique() == 1}
    told = told.drop(columns=list(alike))
    columns = [_column(str(name), told[name]) for name in told.columns]
    rows = told.astype(object).where(told.notna(), None).to_numpy().tolist()
    verdict = json.loads((directory / SUMMARY).read_text(encoding="utf-8")).get("verdict")
    note = "".join(f"{key.capitalize()}: {value}. " for key, value in alike.items()) + NOTE
    note = f"{note} {tidy(verdict[:1].upper() + verdict[1:])}." if verdict else note
    table = ReportTable("Earlier models beside the multi-layer one", columns, rows, note=note)
    found = {
        name: ReportFigure(caption, image=file.read_bytes(), alt=caption)
        for name, caption in CAPTIONS.items()
        if (file := directory / FIGURES / f"{name}.png").is_file()
    }
    return table, found


def _column(name: str, values: "pd.Series[float]") -> Column:
    """A column of comparison.csv: its unit is the last word of its title, or the end of its key."""
    title, _, unit = name.rpartition(" ")
    if unit in UNIT_WORDS:
        return Column(f"{title[:1].upper()}{title[1:]}", unit, "+.1f")
    return table_column(name, values)
