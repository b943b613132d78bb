"""All runs of a study as one file for anybody: text or a workbook."""

from pathlib import Path

import pandas as pd

from thermobearing.border.errors import InputError, OutputError
from thermobearing.border.text_file import write_text_file

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
        write_text_file(path, table.to_csv(index=False), force=force)
        return
    if path.suffix != ".xlsx":
        raise InputError(f'"{path}": a table of runs is written as .csv or .xlsx')
    if len(table) > MOST_ROWS:
        raise InputError(f"{len(table)} runs; a sheet has room for {MOST_ROWS}: write .csv")
    from thermobearing.report.workbook import the_writer

    the_writer()
    if path.exists() and not force:
        raise OutputError(f"{path} exists; give another name, or replace it with --force")
    beside = path.with_name(f".{path.name}.part.xlsx")
    try:
        table.to_excel(beside, index=False, sheet_name="runs")
        beside.replace(path)
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror or error}") from None
    finally:
        beside.unlink(missing_ok=True)
