"""Tables as Parquet: unit and meaning of each column beside it, the whole file or none.

The notes of a file hold the SHA-256 of the whole file, taken with zeros in its own place: Parquet
checks nothing by itself, and a changed bit often reads as another number.

pyarrow is an extra: without it one sentence says what to install.
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from thermobearing.border.errors import InputError
from thermobearing.border.text_file import write_file, write_whole
from thermobearing.results.writing import without_formulas

EXTRA = 'needs pyarrow: pip install "thermobearing[study]"'
UNIT, MEANING, NOTES = b"unit", b"meaning", b"thermobearing"
DIGEST, EMPTY = b'"sha256": "', b"0" * 64
LEVEL = 3  # of compression
KINDS = {"i": "int64", "u": "int64", "f": "float64", "b": "bool_"}  # the rest is text


class About(NamedTuple):
    """What a column is: its unit ("1" of a ratio or a count, none of text), and what it says."""

    unit: str = ""
    meaning: str = ""


def the_parquet() -> Any:
    """The modules pyarrow and pyarrow.parquet.

    Raises
    ------
    InputError : pyarrow is not there.
    """
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise InputError(f"the table of a study {EXTRA}") from None
    return pyarrow, pyarrow.parquet


def parquet_bytes(
    table: pd.DataFrame, about: Mapping[str, About], notes: Mapping[str, Any]
) -> bytes:
    """A table as the content of a file; equal tables make equal bytes, and NaN is null there.

    Parameters
    ----------
    table : numbers and text.
    about : what its columns are.
    notes : of the whole, for `read_notes`.
    """
    arrow, parquet = the_parquet()
    fields, arrays = [], []
    for name, column in table.items():
        kind = getattr(arrow, KINDS.get(column.dtype.kind, "string"))()
        told = about.get(str(name), About())
        marks = {UNIT: told.unit.encode(), MEANING: told.meaning.encode()}
        fields.append(arrow.field(str(name), kind, metadata=marks))
        values = column if kind != arrow.string() else [str(value) for value in column]
        # A number that a run has not is null: others' means would be NaN with it.
        arrays.append(arrow.array(values, type=kind, from_pandas=kind == arrow.float64()))
    sealed = json.dumps({**notes, "sha256": EMPTY.decode()}).encode()
    stream = arrow.BufferOutputStream()
    whole = arrow.Table.from_arrays(arrays, schema=arrow.schema(fields, metadata={NOTES: sealed}))
    parquet.write_table(whole, stream, compression="zstd", compression_level=LEVEL)
    before, _, after = _around_digest(bytes(stream.getvalue()))
    return before + _digest(before, after) + after


def _around_digest(content: bytes) -> tuple[bytes, bytes, bytes]:
    """Split a file into what is before its digest, the digest, and what is after it."""
    place = content.rfind(DIGEST) + len(DIGEST)
    return content[:place], content[place : place + len(EMPTY)], content[place + len(EMPTY) :]


def _digest(before: bytes, after: bytes) -> bytes:
    return hashlib.sha256(before + EMPTY + after).hexdigest().encode()


def write_parquet(
    path: Path, table: pd.DataFrame, about: Mapping[str, About], notes: Mapping[str, Any]
) -> None:
    """Write a table; OSError where the disk is full, and nothing of it is there."""
    write_whole(path, parquet_bytes(table, about, notes))


def read_parquet(paths: Sequence[Path], columns: Sequence[str] | None = None) -> pd.DataFrame:
    """Tables of some files below each other.

    Raises
    ------
    InputError : a file cannot be read.
    """
    arrow, parquet = the_parquet()
    names = None if columns is None else list(columns)
    found = []
    for path in paths:
        try:
            found.append(parquet.ParquetFile(path).read(columns=names))
        except (OSError, arrow.ArrowException) as error:
            raise InputError(f"cannot be read: {error}", str(path)) from None
    whole = arrow.concat_tables([one.replace_schema_metadata(None) for one in found])
    return pd.DataFrame(whole.to_pandas())


def about_columns(path: Path) -> dict[str, About]:
    """What the columns of a file are."""
    schema = the_parquet()[1].read_schema(path)
    return {
        field.name: About(*[(field.metadata or {}).get(k, b"").decode() for k in (UNIT, MEANING)])
        for field in schema
    }


def read_notes(path: Path, *, sealed: bool = True) -> tuple[dict[str, Any], int] | None:
    """Notes and number of rows of a file; None if there is none, or it is damaged.

    Parameters
    ----------
    path : of the file.
    sealed : whether its digest must be right; files of version 0.2.0 have none.
    """
    arrow, parquet = the_parquet()
    try:
        content = path.read_bytes()
        before, told, after = _around_digest(content)
        if sealed and told != _digest(before, after):
            return None
        with parquet.ParquetFile(arrow.BufferReader(content)) as file:
            notes = json.loads((file.schema_arrow.metadata or {})[NOTES])
            notes.pop("sha256", None)
            return notes, int(file.metadata.num_rows)
    except (OSError, arrow.ArrowException, KeyError, ValueError):
        return None


MOST_ROWS = 1_048_575  # of a sheet of a workbook, beside its head


def write_table(table: pd.DataFrame, path: Path, *, overwrite: bool = False) -> None:
    """A table of runs as text (.csv) or as a workbook (.xlsx).

    Parameters
    ----------
    table : of runs.
    path : of the file.
    overwrite : replace one that is there.

    Raises
    ------
    InputError : another ending, more runs than a sheet has rows, openpyxl is not installed.
    OutputError : the file is there, or cannot be written.
    """
    if path.suffix == ".csv":
        write_file(path, without_formulas(table).to_csv(index=False), overwrite=overwrite)
        return
    if path.suffix != ".xlsx":
        raise InputError(f'"{path}": a table of runs is written as .csv or .xlsx')
    if len(table) > MOST_ROWS:
        raise InputError(f"{len(table)} runs; a sheet has room for {MOST_ROWS}: write .csv")
    from thermobearing.report.workbook import the_writer

    the_writer()
    book = BytesIO()
    table.to_excel(book, index=False, sheet_name="runs", engine="openpyxl")
    write_file(path, book.getvalue(), overwrite=overwrite)
