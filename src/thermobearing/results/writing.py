"""Files of results: JSON without NaN, CSV with seven digits, netCDF with JSON attributes."""

import errno
import json
import math
import os
import re
import shlex
import shutil
import sys
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from thermobearing.border.lazy import pd, xr
from thermobearing.border.units import NUMBER
from thermobearing.quantities.register import registered_quantities
from thermobearing.quantities.warned import Warned
from thermobearing.results.directory import SUMMARY

# Commands whose inputs are files and options instead of a case.
WITHOUT_CASE = {"identify", "validate", "lambda", "bounds"}
WITHOUT_CASE |= {"motions show", "motions make", "motions spectrum"}
FORMULA = ("=", "+", "-", "@", "\t", "\r")  # first characters of formulas in spreadsheets
SIGNED = re.compile(rf"-+|{NUMBER}(?: [^\W\d]*%?)?")  # "-20 degC"
DIGITS = "%.7g"  # in tables; the netCDF file has them all
FEW = 1000  # numbers below which compression has no benefit
NETCDF = threading.Lock()  # HDF5 crashes where two threads use it
NETCDF_NAME = re.compile(r"[A-Za-z_][\w .:+-]{0,60}(?<! )$", re.ASCII)  # valid in netCDF
OTHERS = "other_attributes"  # JSON of those that have other names
NETCDF_EXTRA = 500_000  # attributes, names and tables of the netCDF file [bytes]


def without_nan(value: Any) -> Any:
    """Return a value with None for NaN, which JSON does not have."""
    if isinstance(value, dict):
        return {key: without_nan(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [without_nan(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def without_rounding(value: Any) -> Any:
    """Return content of a JSON file with 0 for numbers of residuals that are rounding only."""
    if isinstance(value, dict):
        return {key: _cleared(key, without_rounding(item)) for key, item in value.items()}
    return [without_rounding(item) for item in value] if isinstance(value, list) else value


def _cleared(name: Any, value: Any) -> Any:
    """Return a number of a quantity, or an array, with 0 for what is rounding only."""
    row = registered_quantities().get(str(name))
    return row.without_rounding(value) if row and row.rounding else value


def clear_rounding(table: "pd.DataFrame") -> "pd.DataFrame":
    """Return a table with 0 for numbers of residuals that are rounding only."""
    cleared = {
        str(name): values
        for name, column in table.items()
        if column.dtype.kind == "f" and (values := _cleared(name, column)) is not column
    }
    return table.assign(**cleared) if cleared else table


def json_line(value: Any) -> str:
    """Return a value as one line of JSON, for programs that read the last line of a command."""
    return json.dumps(without_nan(without_rounding(value)), allow_nan=False)


def _command_line() -> str | None:
    """Return the command that was typed; None in a program of the user."""
    if Path(sys.argv[0]).stem != "thermobearing":
        return None
    return shlex.join(["thermobearing", *sys.argv[1:]])


def write_summary(folder: Path, content: dict[str, Any]) -> None:
    """Write summary.json into a folder; with the command line where no case is written."""
    if content.get("command") in WITHOUT_CASE and (command_line := _command_line()):
        content = content | {"command_line": command_line}
    content = without_nan(without_rounding(content))
    text = json.dumps(content, indent=2, allow_nan=False, ensure_ascii=False)
    # A file name that is no text keeps its bytes as lone surrogates; JSON has an escape for them.
    (folder / SUMMARY).write_text(text + "\n", encoding="utf-8", errors="backslashreplace")


def write_csv(path: Path, table: "pd.DataFrame", *, below: bool = False) -> None:
    """Write a table without its index, with seven digits; or below one that is there.

    Numbers are converted to text here: pandas checks each for missing values, which is slower.
    """
    table = without_formulas(clear_rounding(table))
    # Only NaN differs from itself; its cell is empty.
    texts = {
        str(name): ["" if value != value else DIGITS % value for value in column.tolist()]
        for name, column in table.items()
        if column.dtype.kind == "f"
    }
    table.assign(**texts).to_csv(path, mode="a" if below else "w", header=not below, index=False)


def without_formulas(table: "pd.DataFrame") -> "pd.DataFrame":
    """Return a table with escaped text, so that a spreadsheet reads no cell as a formula.

    Names come from files of others; `=HYPERLINK(...)` would be carried out. Such text gets an
    apostrophe in front; numbers with a sign and a unit ("-20 degC") stay as they are.
    """
    escaped = table.rename(columns=_no_formula)
    for name, column in escaped.items():
        if column.dtype.kind not in "biufcmM" and column.map(_is_formula).any():
            escaped[name] = column.map(_no_formula)
    return escaped


def _is_formula(value: Any) -> bool:
    return isinstance(value, str) and value[:1] in FORMULA and not SIGNED.fullmatch(value)


def _no_formula(value: Any) -> Any:
    return f"'{value}" if _is_formula(value) else value


def as_attribute(value: Any) -> str | int | float:
    """Return an attribute of a dataset: text and numbers as they are, the rest as JSON."""
    return value if isinstance(value, str | int | float) else json.dumps(value)


def from_attribute(dataset: "xr.Dataset", name: str) -> Any:
    """Return what `as_attribute` stored as JSON: a list or a dictionary."""
    return json.loads(dataset.attrs[name])


RECORDS = "warning_records"  # beside the sentences: code, effect and place of each


def warnings_attributes(warnings: Sequence[str]) -> dict[str, Any]:
    """Return warnings as attributes of a dataset: their sentences, and their records."""
    attributes = {"warnings": as_attribute([*warnings])}
    if any(isinstance(warning, Warned) for warning in warnings):
        records = [
            [warning.sentence, warning.code, warning.effect, warning.place]
            if isinstance(warning, Warned)
            else None
            for warning in warnings
        ]
        attributes[RECORDS] = as_attribute(records)
    return attributes


def warnings_of(dataset: "xr.Dataset") -> list[str]:
    """Return the warnings of a dataset; those of an earlier version are sentences alone."""
    sentences: list[str] = from_attribute(dataset, "warnings")
    if RECORDS not in dataset.attrs:
        return sentences
    records = from_attribute(dataset, RECORDS)
    return [
        text if record is None else Warned(*record)
        for text, record in zip(sentences, records, strict=True)
    ]


def labelled_dataset(
    data: Mapping[str, Any], coords: Mapping[str, Any], attrs: Mapping[str, Any] | None = None
) -> "xr.Dataset":
    """Return the dataset of numpy arrays, given as `xarray.Dataset` takes them.

    xarray asks whether an array is one of dask, pint or sparse, and imports these packages for it,
    which takes up to a second. `labelled_variable` omits the question.
    """
    variables = {name: labelled_variable(name, item) for name, item in data.items()}
    labels = {name: labelled_variable(name, item) for name, item in coords.items()}
    return xr.Dataset(variables, coords=labels, attrs=attrs)


def labelled_variable(name: str, item: Any) -> Any:
    """Return an array, or (dimensions, array, attributes), as a variable of xarray."""
    dims: Any = name
    array, attributes = item, None
    if isinstance(item, tuple):
        dims, array = item[:2]
        attributes = item[2] if len(item) > 2 else None
    dims = (dims,) if isinstance(dims, str) else tuple(dims)
    values = np.asarray(array)
    if dims != (name,):
        return xr.Variable(dims, values, attributes, fastpath=True)
    if values.dtype.kind == "U":  # pandas would make objects of them
        return dims, values, attributes
    index: Any = xr.IndexVariable
    return index(
        dims, pd.Index(values, dtype=object if values.dtype.kind == "O" else None), attributes
    )


def write_dataset(dataset: "xr.Dataset", path: Path) -> None:
    """Write netCDF, with numbers compressed without loss.

    Attributes whose names hold the name of a thing, which netCDF may not take ("HDR 1/6"), are
    written as one; `read_dataset` takes them apart.
    """
    unsupported = {
        name: value for name, value in dataset.attrs.items() if not NETCDF_NAME.match(name)
    }
    if unsupported:
        supported = {
            name: value for name, value in dataset.attrs.items() if name not in unsupported
        }
        dataset = dataset.copy(deep=False)
        dataset.attrs = supported | {OTHERS: json.dumps(unsupported)}
    _reserve(path, dataset.nbytes + NETCDF_EXTRA)
    numbers = [name for name, values in dataset.variables.items() if values.dtype.kind in "fi"]
    large = [name for name in numbers if dataset.variables[name].size > FEW]
    compressed = {name: {"zlib": True, "complevel": 1, "shuffle": True} for name in large}
    with NETCDF:
        dataset.to_netcdf(path, engine="netcdf4", encoding=compressed)


def _reserve(path: Path, size: int) -> None:
    """Raise OSError if the disk has no room for a file [bytes]: HDF5 would crash."""
    try:
        with path.open("wb") as file:
            if hasattr(os, "posix_fallocate"):
                os.posix_fallocate(file.fileno(), 0, size)
            elif shutil.disk_usage(path.parent).free < size:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    finally:
        path.unlink(missing_ok=True)
