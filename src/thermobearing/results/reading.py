"""Datasets of saved results, read back."""

import json
from collections.abc import Iterable
from pathlib import Path

import xarray as xr

from thermobearing.border.errors import LONGEST_NAME, InputError, is_file, shortened
from thermobearing.results.directory import DATASET, IDENTIFIED
from thermobearing.results.seal import check_seal
from thermobearing.results.writing import NETCDF, OTHERS


def read_dataset(path: str | Path, attributes: Iterable[str]) -> xr.Dataset:
    """The dataset of a result directory, or of the result.nc in it.

    Parameters
    ----------
    path : of either.
    attributes : what the dataset must have among its attributes.

    Raises
    ------
    InputError : there is no readable result of that kind at that path, or it is damaged.
    """
    path = Path(path)
    file = next((item for item in (path / DATASET, path) if is_file(item)), None)
    if file is None:
        fitted = "; read its bearing with load_bearing" if is_file(path / IDENTIFIED) else ""
        raise InputError(f"no result.nc there{fitted}", shortened(str(path), LONGEST_NAME))
    check_seal(file)
    try:
        with NETCDF:
            dataset = xr.load_dataset(file, engine="netcdf4")
        dataset.attrs |= json.loads(dataset.attrs.pop(OTHERS, "{}"))
    except Exception as error:  # whatever HDF5 meets in a file that was changed and sealed again
        about = shortened(str(error) or type(error).__name__)
        raise InputError(f"cannot be read: {about}", str(file)) from None
    missing = set(attributes) - set(dataset.attrs)
    if missing:
        raise InputError(f"is not a result of thermobearing: no {sorted(missing)}", str(file))
    return dataset
