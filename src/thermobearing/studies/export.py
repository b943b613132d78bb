"""All runs of a study as one file for anybody: text or a workbook."""

from io import BytesIO
from pathlib import Path

import pandas as pd

from thermobearing.border.errors import InputError
from thermobearing.border.text_file import write_file
from thermobearing.results.writing import without_formulas

MOST_ROWS = 1_048_575  # of a sheet of a workbook, beside its head


def write_table(table: pd.DataFrame, path: Path, *, force: bool = False) -> None:
    """A table of runs as text (.csv) or as a workbook (.xlsx).

    Parameters
    ----------
    table : of runs.
    path : of the file.
    force : replace one that is there.

    Raises
    ------
    InputError : another ending, more runs than a sheet has rows, openpyxl is not installed.
    OutputError : the file is there, or cannot be written.
    """
    if path.suffix == ".csv":
        write_file(path, without_formulas(table).to_csv(index=False), force=force)
        return
    if path.suffix != ".xlsx":
        raise InputError(f'"{path}": a table of runs is written as .csv or .xlsx')
    if len(table) > MOST_ROWS:
        raise InputError(f"{len(table)} runs; a sheet has room for {MOST_ROWS}: write .csv")
    from thermobearing.report.workbook import the_writer

    the_writer()
    book = BytesIO()
    table.to_excel(book, index=False, sheet_name="runs", engine="openpyxl")
    write_file(path, book.getvalue(), force=force)
