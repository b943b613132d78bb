"""How every analysis writes: JSON without NaN, CSV with seven digits, attributes of datasets."""

import errno
import json
import math
import os
import shlex
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from thermobearing.results.directory import RIG, SUMMARY, TESTED_RANGE

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

# Commands whose inputs are files and options, and no case that is written whole.
WITHOUT_CASE = {"identify", "validate", "lambda", "bounds"}
WITHOUT_CASE |= {"motions show", "motions make", "motions spectrum"}
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


def command_line() -> str | None:
    """The command that was typed, where the command line runs; None in somebody's own program."""
    if Path(sys.argv[0]).stem != "thermobearing":
        return None
    return shlex.join(["thermobearing", *sys.argv[1:]])


def write_summary(folder: Path, content: dict[str, Any]) -> None:
    """Write summary.json into a folder; of what is not to be repeated by a case, the command."""
    if content.get("command") in WITHOUT_CASE and (typed := command_line()):
        content = content | {"command_line": typed}
    text = json.dumps(without_nan(content), indent=2, allow_nan=False, ensure_ascii=False)
    # A file name that is no text keeps its bytes as lone surrogates; JSON has an escape for them.
    (folder / SUMMARY).write_text(text + "\n", encoding="utf-8", errors="backslashreplace")


def limits_summary(rig: "pd.DataFrame", tested: "pd.DataFrame") -> dict[str, Any]:
    """What summary.json says of the limits of a rig and of the range of the bearing's tests."""
    tables = {"rig": rig, "tested_range": tested}
    return {name: table.to_dict("records") for name, table in tables.items() if len(table)}


def exposure_summary(dataset: "xr.Dataset") -> dict[str, Any]:
    """What summary.json says of the exposure factors; nothing where all are 1."""
    told = "exposure" in dataset.attrs
    return {"exposure": from_attribute(dataset, "exposure")} if told else {}


def write_limits(folder: Path, rig: "pd.DataFrame", tested: "pd.DataFrame") -> None:
    """Write rig.csv and tested_range.csv, where there is something to write."""
    for name, table in ((RIG, rig), (TESTED_RANGE, tested)):
        if len(table):
            write_csv(folder / name, table)


def limits_of(dataset: "xr.Dataset", name: str) -> "pd.DataFrame":
    """Rows of `results.ranges.compared` that an analysis left in its dataset; empty without."""
    import pandas as pd

    told = name in dataset.attrs  # results of 0.1 have none
    return pd.DataFrame(from_attribute(dataset, name) if told else [])


def write_csv(path: Path, table: "pd.DataFrame", *, below: bool = False) -> None:
    """Write a table without its index, with seven digits; or below one that is there.

    The numbers become text here: pandas asks of each whether it is missing, and takes longer.
    """
    texts = {
        str(name): ["" if value != value else DIGITS % value for value in column.tolist()]
        for name, column in table.items()
        if column.dtype.kind == "f"
    }
    table.assign(**texts).to_csv(path, mode="a" if below else "w", header=not below, index=False)


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
