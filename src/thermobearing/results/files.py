"""The result directory: files appear whole or not at all.

Everything is written into a hidden sibling directory that is renamed at the end, so a full
disk, an interruption or a crash leaves either the complete result or nothing.
"""

import json
import math
import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from thermobearing.errors import InputError, OutputError
from thermobearing.results.result import Result

SUMMARY, DATASET, HISTORY = "summary.json", "result.nc", "history.csv"
RESOLVED, FIGURES = "case.resolved.toml", "figures"
CSV_BLOCK = 50_000  # rows formatted at a time


def check_target(directory: Path, *, force: bool) -> None:
    """Refuse a target that a run may not write to, before anything is computed.

    Raises
    ------
    OutputError : it exists and `force` is False, or it is not a result directory.
    """
    if not directory.exists():
        return
    if not directory.is_dir():
        raise OutputError(f"{directory}: is a file; choose another directory with -o")
    names = {path.name for path in directory.iterdir()}
    if not names:
        return
    if SUMMARY not in names:
        raise OutputError(
            f"{directory}: exists and is not a result directory; choose another one with -o"
        )
    if not force:
        raise OutputError(
            f"{directory}: exists; give --force to replace it, or another directory with -o"
        )


def save_result(
    result: Result, directory: Path, *, force: bool = False, figures: bool = True
) -> Path:
    """Write summary.json, result.nc, history.csv, case.resolved.toml and figures.

    Parameters
    ----------
    result : what to write.
    directory : made if needed, with its parents.
    force : replace an earlier result directory.
    figures : draw the figures too.

    Returns
    -------
    Path : the directory.

    Raises
    ------
    OutputError : see `check_target`; or the disk is full or not writable. Nothing is left.
    """
    check_target(directory, force=force)
    partial = directory.parent / f".{directory.name}.writing-{os.getpid()}"
    try:
        partial.mkdir(parents=True)
        _write_all(result, partial, figures=figures)
        _replace(directory, partial)
    except OSError as error:
        raise OutputError(f"{directory}: cannot be written: {error.strerror or error}") from error
    finally:
        shutil.rmtree(partial, ignore_errors=True)
    return directory


def _replace(directory: Path, partial: Path) -> None:
    """Put the finished directory in place; an earlier one goes only when that has worked."""
    old = directory.parent / f".{directory.name}.old-{os.getpid()}"
    if directory.exists():
        directory.rename(old)
    try:
        partial.rename(directory)
    except OSError:
        if old.exists():
            old.rename(directory)
        raise
    shutil.rmtree(old, ignore_errors=True)


def _write_all(result: Result, folder: Path, *, figures: bool) -> None:
    text = json.dumps(_finite(result.summary()), indent=2, allow_nan=False)
    (folder / SUMMARY).write_text(text + "\n", encoding="utf-8")
    (folder / RESOLVED).write_text(result.dataset.attrs["case"], encoding="utf-8")
    with (folder / HISTORY).open("w", encoding="utf-8") as file:
        file.writelines(history_blocks(result))
    result.dataset.to_netcdf(folder / DATASET, engine="h5netcdf")
    if figures:
        (folder / FIGURES).mkdir()
        result.plot.save_all(folder / FIGURES)


def _finite(value: Any) -> Any:
    """JSON has no NaN: a number that does not exist becomes null."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_finite(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def history_blocks(result: Result) -> Iterator[str]:
    """Text of history.csv, block by block: one row per kept step and ambient temperature."""
    data = result.dataset
    layers = data.sizes["layer"] if "rubber_temperature" in data else 0
    rubber = [f"rubber{j}_degC" for j in range(1, layers + 1)]
    names = ["displacement_mm", "force_kN", "stress_MPa", "strain", *rubber, "lead_degC"]
    yield ",".join(["ambient_degC", "time_s", *names]) + "\n"
    for run, ambient in enumerate(data["ambient"].values):
        count = int((data["segment"].values[run] >= 0).sum())
        columns = [result.time(run)[:count]]
        columns += [
            data[name].values[run, :count] for name in ("displacement", "force", "stress", "strain")
        ]
        if layers:
            columns += list(data["rubber_temperature"].values[run, :count].T)
        last = ",\n"  # lead_degC stays empty where the bearing has no lead
        if result.has_lead:
            columns.append(data["lead_temperature"].values[run, :count])
            last = "\n"
        line = f"{ambient:.9g}," + ",".join(["%.9g"] * len(columns)) + last
        for first in range(0, count, CSV_BLOCK):
            block = np.column_stack([column[first : first + CSV_BLOCK] for column in columns])
            yield (line * len(block)) % tuple(block.ravel().tolist())


def load_result(path: str | Path) -> Result:
    """A saved result again, from its directory or its result.nc.

    Raises
    ------
    InputError : there is no readable result at that path.
    """
    path = Path(path)
    file = path / DATASET if path.is_dir() else path
    if not file.is_file():
        raise InputError("no result.nc there", str(path))
    try:
        dataset = xr.load_dataset(file, engine="h5netcdf")
    except (OSError, ValueError) as error:
        raise InputError(f"is not a result file: {error}", str(file)) from None
    missing = {"bearing", "case", "segments"} - set(dataset.attrs)
    if missing:
        raise InputError(f"is not a result of thermobearing: no {sorted(missing)}", str(file))
    return Result(dataset)
