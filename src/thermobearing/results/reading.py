"""Datasets of saved results, read back."""

from collections.abc import Iterable
from pathlib import Path

import xarray as xr

from thermobearing.border.errors import InputError
from thermobearing.results.directory import DATASET, IDENTIFIED


def read_dataset(path: str | Path, attributes: Iterable[str]) -> xr.Dataset:
    """The dataset of a result directory, or of the result.nc in it.

    Parameters
    ----------
    path : of either.
    attributes : what the dataset must have among its attributes.

    Raises
    ------
    InputError : there is no readable result of that kind at that path.
    """
    path = Path(path)
    file = path / DATASET if path.is_dir() else path
    if not file.is_file():
        fitted = "; read its bearing with load_bearing" if (path / IDENTIFIED).is_file() else ""
        raise InputError(f"no result.nc there{fitted}", str(path))
    try:
        dataset = xr.load_dataset(file, engine="h5netcdf")
    except (OSError, ValueError) as error:
        raise InputError(f"is not a result file: {error}", str(file)) from None
    missing = set(attributes) - set(dataset.attrs)
    if missing:
        raise InputError(f"is not a result of thermobearing: no {sorted(missing)}", str(file))
    return dataset
