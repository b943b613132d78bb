"""The measures of cycles, as a labelled dataset and as summary.json holds them."""

from typing import Any

import pandas as pd
import xarray as xr

UNITS = {"_kN_mm": "kN mm", "_kN": "kN", "_MPa": "MPa", "_degC": "degC"}
LABELS = ("ambient", "strain", "cycle")


def unit_of(column: str) -> str:
    """Unit of a column of `Result.cycles`, from its name.

    Examples
    --------
    >>> unit_of("K_eq_kN_mm"), unit_of("energy_kN_mm"), unit_of("h_eq")
    ('kN/mm', 'kN mm', '1')
    """
    if column.endswith(("stiffness_kN_mm", "K_eq_kN_mm")):
        return "kN/mm"
    return next((unit for end, unit in UNITS.items() if column.endswith(end)), "1")


def measures_dataset(cycles: pd.DataFrame, *, recorded: bool) -> xr.Dataset:
    """Columns of `Result.cycles` as variables over ambient temperature, strain and cycle.

    Where a strain comes twice, and in `recorded` histories, whose cycles have each their own, the
    dimensions are ambient temperature and `number` of the cycle in the test.
    """
    table = cycles.rename(columns={"ambient_degC": "ambient", "amplitude_strain": "strain"})
    labels = list(LABELS)
    if not len(table):
        return xr.Dataset()
    if recorded or table.duplicated(labels).any():
        table["number"] = table.groupby("ambient").cumcount() + 1
        labels = ["ambient", "number"]
    found = table.set_index(labels).to_xarray()
    for name in found.variables:
        found[name].attrs["units"] = unit_of(str(name))
    found["ambient"].attrs["units"] = "degC"
    return found


def cycle_summary(row: dict[Any, Any]) -> dict[str, Any]:
    """One cycle of summary.json from a row of `Result.cycles`."""
    rubber = [float(value) for key, value in row.items() if str(key).startswith("rubber")]
    plain = {
        str(key): value
        for key, value in row.items()
        if key != "ambient_degC" and not str(key).startswith("rubber")
    }
    return {"lead_degC": None} | plain | {"rubber_degC": rubber}
