"""Earlier models beside the result, as `--compare` left them in its directory."""

import json
from pathlib import Path

import pandas as pd

from thermobearing.report.generic import column_of
from thermobearing.report.pieces import Column, ReportFigure, ReportTable
from thermobearing.report.words import tidy
from thermobearing.results.directory import COMPARISON, FIGURES, SUMMARY

CAPTIONS = {
    "comparison": "Earlier models beside the multi-layer one.",
    "comparison_loops": "Loops of the multi-layer model and of a single temperature.",
}
NOTE = "Model less multi-layer model; rms: root mean square."
UNITS = ("K", "%")  # last words of titles of columns
ALIKE = ("motion", "mode")  # told once where all runs have the same


def comparison_of(directory: Path) -> tuple[ReportTable, dict[str, ReportFigure]]:
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
    if unit in UNITS:
        return Column(f"{title[:1].upper()}{title[1:]}", unit, "+.1f")
    return column_of(name, values)
