"""How every analysis writes: JSON without NaN, CSV with seven digits, attributes of datasets."""

import errno
import json
import math
import os
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

from thermobearing.results.directory import SUMMARY

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

DIGITS = "%.7g"  # in tables; the netCDF file has them all
FEW = 1000  # numbers that are not worth compressing
NETCDF_EXTRA = 500_000  # attributes, names and tables of the netCDF file beside its numbers [bytes]


def without_nan(value: Any) -> Any:
    """JSON has no NaN: a number that does not exist becomes null."""
    if isinstance(value, dict):
        return {key: without_nan(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [without_nan(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def json_line(value: Any) -> str:
    """A value as one line of JSON, for a machine that reads the last line of a command."""
    return json.dumps(without_nan(value), allow_nan=False)


def write_summary(folder: Path, content: dict[str, Any]) -> None:
    """Write summary.json into a folder."""
    text = json.dumps(without_nan(content), indent=2, allow_nan=False, ensure_ascii=False)
    # A file name that is no text keeps its bytes as lone surrogates; JSON has an escape for them.
    (folder / SUMMARY).write_text(text + "\n", encoding="utf-8", errors="backslashreplace")


def rig_summary(table: "pd.DataFrame") -> dict[str, Any]:
    """What summary.json says of the limits of a rig; nothing where no rig was named."""
    return {"rig": table.to_dict("records")} if len(table) else {}


def limits_passed(table: "pd.DataFrame", runs: int) -> list[str]:
    """The limits of a rig that each run passes, from a table with as many rows for every run."""
    each = len(table) // max(runs, 1)
    parts = [table.iloc[k * each : (k + 1) * each] for k in range(runs)]
    return [" ".join(part["limit"][part["passed"]]) for part in parts]


def write_csv(path: Path, table: "pd.DataFrame") -> None:
    """Write a table without its index, with seven digits."""
    table.to_csv(path, index=False, float_format=DIGITS)


def as_attribute(value: Any) -> str | int | float:
    """What an attribute of a dataset can hold: text and numbers as they are, the rest as JSON."""
    return value if isinstance(value, str | int | float) else json.dumps(value)


def from_attribute(dataset: "xr.Dataset", name: str) -> Any:
    """What `as_attribute` put into an attribute as JSON: a list or a dictionary."""
    return json.loads(dataset.attrs[name])


def write_dataset(dataset: "xr.Dataset", path: Path) -> None:
    """Write netCDF, numbers compressed without loss."""
    _reserve(path, dataset.nbytes + NETCDF_EXTRA)
    numbers = [name for name, values in dataset.variables.items() if values.dtype.kind in "fi"]
    large = [name for name in numbers if dataset.variables[name].size > FEW]
    compressed = {name: {"zlib": True, "complevel": 1, "shuffle": True} for name in large}
    dataset.to_netcdf(path, engine="netcdf4", encoding=compressed)


def _reserve(path: Path, size: int) -> None:
    """OSError if the disk has no room for a file of this size [bytes]; leaves no file.

    HDF5 cannot close a file that it could not write: it crashes the process instead.
    """
    try:
        with path.open("wb") as file:
            if hasattr(os, "posix_fallocate"):
                os.posix_fallocate(file.fileno(), 0, size)
            elif shutil.disk_usage(path.parent).free < size:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    finally:
        path.unlink(missing_ok=True)
