"""Which run governs: the largest of all runs of each bearing, where and at which air."""

from typing import TYPE_CHECKING

import pandas as pd

if TYPE_CHECKING:
    from thermobearing.earthquake.result import EarthquakeResult

# What: table of a study with several lines or piers, who, column; column of the table otherwise.
GOVERNED = {
    "bearing strain": ("lines", "line", "strain_max", "bearing_strain_max"),
    "bearing displacement [mm]": ("lines", "line", "displacement_max_mm", ""),
    "force of one bearing [kN]": ("lines", "line", "force_max_kN", "bearing_force_max_kN"),
    "lead [degC]": ("lines", "line", "lead_max_degC", ""),
    "pier displacement [mm]": (
        "piers",
        "pier",
        "displacement_max_mm",
        "pier_displacement_max_mm",
    ),
    "pier ductility": ("piers", "pier", "ductility", "pier_ductility"),
    "deck displacement [mm]": ("", "", "", "deck_displacement_max_mm"),
}


def governing_runs(result: "EarthquakeResult") -> pd.DataFrame:
    """The largest of every peak over all runs, lines and piers of each bearing.

    Parameters
    ----------
    result : a study.

    Returns
    -------
    DataFrame : bearing, what, largest, part (line or pier; empty where there is one), motion,
        ambient_degC; a row for each bearing and peak that is known. Of studies in a laboratory
        both modes count.

    Examples
    --------
    >>> import thermobearing as tb
    >>> study = tb.bridge("shen-hdr-bridge", "jra-ii-i-1", [23, -20], duration=12)
    >>> governing_runs(study).set_index("what").loc["pier ductility", "ambient_degC"]
    np.float64(-20.0)
    """
    rows = []
    whole = result.table  # each is made anew whenever it is asked for
    parts = {"": pd.DataFrame(), "lines": result.lines, "piers": result.piers}
    for bearing in dict.fromkeys(whole["bearing"]):
        for what, (name, who, column, plain) in GOVERNED.items():
            table = parts[name]
            column, part = (column, who) if len(table) else (plain, "")
            table = table if len(table) else whole
            mine = table[table["bearing"] == bearing]
            if column not in mine or not mine[column].notna().any():
                continue
            worst = mine.loc[mine[column].idxmax()]
            rows.append(
                {
                    "bearing": bearing,
                    "what": what,
                    "largest": float(worst[column]),
                    "part": str(worst[part]) if part else "",
                    "motion": str(worst["motion"]),
                    "ambient_degC": float(worst["ambient_degC"]),
                }
            )
    return pd.DataFrame(rows)
