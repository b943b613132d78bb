"""Bearings, motions and temperatures as dimensions of one labelled dataset."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pandas as pd
import xarray as xr

from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.errors import InputError
from thermobearing.cyclic.protocol import CyclicTest
from thermobearing.cyclic.run import run
from thermobearing.earthquake.study import bridge

Named = Bearing | str | Path


def sweep(
    bearing: Named | Sequence[Named],
    *,
    test: CyclicTest | None = None,
    motion: Any = None,
    ambient: float | Sequence[float] = 23.0,
    **options: Any,
) -> xr.Dataset:
    """Bearings, motions and temperatures, every combination: one labelled dataset.

    With a motion the dataset is that of `bridge(...).to_dataset()`: every peak and history with
    the dimensions bearing, motion and ambient. With a test it has the measures of each cycle
    with the dimensions bearing, ambient, strain and cycle, see `Result.to_dataset`.

    Parameters
    ----------
    bearing : one or several: a Bearing, a library name, or a TOML file.
    test : cyclic test of each; Table 3.4 without a test and a motion.
    motion : one or several, as of `bridge`; instead of a test.
    ambient : one or several temperatures [degC], in [-100, 100].
    options : any of `run` (with a test) or of `bridge` (with a motion).

    Returns
    -------
    xarray.Dataset

    Raises
    ------
    InputError : a test and a motion, or what `run` and `bridge` refuse.

    Examples
    --------
    >>> import thermobearing as tb
    >>> names = ["shen-hdr-specimen", "shen-lhdr-specimen"]
    >>> test = tb.cyclic_test(strain=[0.5, 1.0], cycles=2, rest=None)
    >>> found = sweep(names, test=test, ambient=[-20, 23])
    >>> dict(found.sizes) == {"bearing": 2, "ambient": 2, "strain": 2, "cycle": 2}
    True
    >>> cold, warm = found.G_eq_MPa.sel(bearing="shen-hdr-specimen", strain=1.0, cycle=2).values
    >>> bool(cold > warm)
    True
    """
    if test is not None and motion is not None:
        raise InputError("give a test or a motion, not both", "sweep()")
    if motion is not None:
        return bridge(bearing, motion, ambient, **options).to_dataset()
    several = list(bearing) if isinstance(bearing, list | tuple) else [bearing]
    bearings = [as_bearing(item) for item in several]
    names = [item.name for item in bearings]
    if len(set(names)) < len(names):
        raise InputError(f"bearing: each needs a name of its own; got {names}", "sweep()")
    parts = [run(item, test, ambient, **options).to_dataset() for item in bearings]
    return xr.concat(
        parts, pd.Index(names, name="bearing"), join="outer", data_vars="all", combine_attrs="drop"
    )
