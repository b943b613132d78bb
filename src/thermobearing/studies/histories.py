"""Histories of some runs of a study as one netCDF file, in the words of an earthquake analysis."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from thermobearing.border.text_file import replacing
from thermobearing.earthquake.traces import HISTORIES, padded
from thermobearing.results.writing import write_dataset
from thermobearing.studies.shard import Kept

LAYERS = ("rubber_temperature", "degC", "mid-thickness temperature of the rubber layers")


def histories_dataset(kept: Sequence[Kept]) -> xr.Dataset:
    """All that is kept of some runs; `run` and `id` say which, shorter ones end with NaN."""
    length = max((len(one.traces["time"]) for one in kept), default=0)
    data: dict[str, tuple[tuple[str, ...], Any, dict[str, str]]] = {}
    for name, unit, long_name in (("time", "s", "time"), *HISTORIES):
        rows = padded([one.traces[name] for one in kept], (length,))
        data[name] = (("run", "step"), rows, {"units": unit, "long_name": long_name})
    name, unit, long_name = LAYERS
    layers = max((one.traces[name].shape[1] for one in kept), default=0)
    rows = padded([one.traces[name] for one in kept], (length, layers))
    data[name] = (("run", "step", "layer"), rows, {"units": unit, "long_name": long_name})
    coords = {
        "run": np.array([one.run for one in kept], dtype=np.int64),
        "id": ("run", np.array([one.id for one in kept], dtype=str)),
    }
    return xr.Dataset(data, coords=coords)


def write_histories(path: Path, kept: Sequence[Kept]) -> None:
    """Write the file whole; OSError where the disk is full, and nothing of it is there."""
    path.parent.mkdir(exist_ok=True)
    with replacing(path) as part:
        write_dataset(histories_dataset(kept), part)
