"""Real time beside pseudo-dynamic: what the slow test of the same specimen gets otherwise."""

from typing import Any

import numpy as np
import pandas as pd

from thermobearing.earthquake.result import EarthquakeResult

FAST, SLOW = "rt", "pd"
RATIOS = {  # of the real-time test over the pseudo-dynamic one: column of the table
    "force": "bearing_force_max_kN",
    "strain": "bearing_strain_max",
    "energy": "bearing_energy_kN_mm",
}


def has_both(result: EarthquakeResult) -> bool:
    """Whether a study was run in both modes."""
    return {FAST, SLOW} <= set(result.modes)


def modes_table(result: EarthquakeResult) -> pd.DataFrame:
    """Real time over pseudo-dynamic, one row per bearing, motion and ambient temperature.

    Parameters
    ----------
    result : of a study in both modes.

    Returns
    -------
    DataFrame : ratios of the peak force, the peak strain and the energy of the specimen; the
        largest rise of the outer and the innermost rubber layer and of the lead in both [K], and
        their ratios. Empty if the study was not run in both modes.
    """
    table = result.table
    rows: list[dict[str, Any]] = []
    if not has_both(result):
        return pd.DataFrame(rows)
    for (bearing, motion, ambient), pair in table.groupby(
        ["bearing", "motion", "ambient_degC"], sort=False
    ):
        runs = dict(zip(pair["mode"].tolist(), pair.index.tolist(), strict=True))
        if not {FAST, SLOW} <= set(runs):  # interrupted
            continue
        fast, slow = (table.loc[runs[mode]].to_dict() for mode in (FAST, SLOW))
        row: dict[str, Any] = {"bearing": bearing, "motion": motion, "ambient_degC": ambient}
        row |= {
            f"{name}_ratio": _over(fast[column], slow[column]) for name, column in RATIOS.items()
        }
        rises = {mode: result.rises(run) for mode, run in runs.items()}
        for place, rise in rises[FAST].items():
            row[f"{place}_rise_rt_K"], row[f"{place}_rise_pd_K"] = rise, rises[SLOW][place]
            row[f"{place}_rise_ratio"] = _over(rise, rises[SLOW][place])
        rows.append(row)
    return pd.DataFrame(rows)


def _over(fast: float, slow: float) -> float:
    """Their ratio; NaN where nothing happened."""
    return fast / slow if slow else np.nan
