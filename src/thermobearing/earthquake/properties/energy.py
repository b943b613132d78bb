"""Energy of bearings compared with the warmest run: of the same line, between runs of one kind."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermobearing.border.lazy import pd
from thermobearing.earthquake.measures import key_columns
from thermobearing.quantities.governing import places_of_largest


def energy_of_warmest(
    table: "pd.DataFrame",
    energies: NDArray[np.float64] | None,
    line_bearings: Mapping[str, Mapping[str, str]],
) -> "pd.Series[float]":
    """Return the energy of a bearing over that of the same line in the warmest run.

    The line is that with the largest energy in the warmest run. NaN where the lines of a run have
    bearings of several kinds: a ratio of one kind says nothing of the others.

    Parameters
    ----------
    table : of runs, with their largest energies.
    energies : of runs by line, where there are several lines [kN mm].
    line_bearings : as of `EarthquakeResult`.
    """
    # Sorted from cold to warm, the last run of each group is the warmest.
    keys = [name for name in key_columns(table) if name != "ambient_degC"]
    order = table[keys].assign(run=np.arange(len(table)))
    order = order.loc[table["ambient_degC"].sort_values(kind="stable").index]
    runs = order.groupby(keys, sort=False)["run"].transform("last")
    warmest = runs.loc[table.index].to_numpy()
    if energies is None:
        energies = table[["bearing_energy_kN_mm"]].to_numpy(dtype=float)
    lines = places_of_largest(energies[warmest])
    energy, reference = energies[np.arange(len(table)), lines], energies[warmest, lines]
    kinds: dict[Any, int] = {name: len(set(of.values())) for name, of in line_bearings.items()}
    several = table["bearing"].map(kinds).fillna(1) > 1
    ratios = pd.Series(energy, table.index) / pd.Series(reference, table.index)
    return ratios.mask(several)
