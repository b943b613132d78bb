"""Records of the tests of Shen (2023) as the model itself would make them."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from reproduction.records import HYBRID_MOTION
from reproduction.runs import AMBIENT, HDR, HYBRID_PIER, LHDR, MODES, MOTIONS, Runs, full_cycles
from thermobearing.earthquake.analysis import hybrid
from thermobearing.motions.library import load_motion

SPECIMENS = {"hdr": HDR, "lhdr": LHDR}
STAND_IN = "jra-ii-ii-1"
STRAINS = (0.5, 1.5)
EVERY = 3  # of the samples of the cyclic tests
SECONDS = 12.0  # of the motion of the hybrid tests
LATER = 0.9  # force of a second test over that of the first


def make_cyclic(folder: Path, specimen: str) -> None:
    result = Runs().cyclic(SPECIMENS[specimen], test=full_cycles(STRAINS))
    names = {"displacement_mm": "displacement", "force_kN": "force"}
    for run, air in enumerate(AMBIENT):
        columns = _columns(result, run, names).assign(time_s=result.time(run))
        write(folder, f"cyclic-{specimen}", columns[::EVERY], air)


def make_hybrid(folder: Path, specimen: str, mode: Any) -> None:
    """Write both tests of a specimen, of which the first is stronger."""
    options: Any = {"laboratory": {"mode": mode}, "duration": SECONDS}
    bearing = Runs().bearing(SPECIMENS[specimen])
    result = hybrid(bearing, STAND_IN, list(AMBIENT), structure=HYBRID_PIER, **options)
    names = {
        "time_s": "time" if mode == "rt" else "bearing_clock",
        "displacement_mm": "bearing_displacement",
        "force_kN": "bearing_force",
        "pier_displacement_mm": "pier_top_displacement",
        "pier_acceleration_m/s2": "pier_top_acceleration",
    }
    for run, air in enumerate(AMBIENT):
        columns = _columns(result, run, names)
        write(folder, f"hybrid-{specimen}-{mode}", columns, air)
        first = columns.assign(force_kN=columns["force_kN"] / LATER)
        write(folder, f"first-hybrid-{specimen}-{mode}", first, air)


def make_motion(folder: Path, name: str, stand_in: str, seconds: float) -> None:
    ground = load_motion(stand_in)
    columns = {"time_s": ground.time, "acceleration_mm/s2": ground.acceleration}
    table = pd.DataFrame(columns)[ground.time <= seconds]
    table.to_csv(folder / f"{name}.csv", index=False)


def make_all(folder: Path) -> None:
    """Write every record of the list."""
    make_motion(folder, HYBRID_MOTION, STAND_IN, SECONDS)
    for name in MOTIONS:
        make_motion(folder, name.replace("jra", "motion"), name, np.inf)
    for specimen in SPECIMENS:
        make_cyclic(folder, specimen)
        for mode in MODES:
            make_hybrid(folder, specimen, mode)


def _columns(result: Any, run: int, names: dict[str, str]) -> pd.DataFrame:
    columns = {title: np.asarray(result[name].values[run], float) for title, name in names.items()}
    layers = np.asarray(result["rubber_temperature"].values[run], float)
    columns |= {"rubber 1 [degC]": layers[:, 0], "rubber 3 [degC]": layers[:, 2]}
    if "lead_temperature" in result.dataset:
        lead = np.asarray(result["lead_temperature"].values[run], float)
        columns |= {"lead [degC]": lead} if np.isfinite(lead).all() else {}
    return pd.DataFrame(columns)


def write(folder: Path, kind: str, table: pd.DataFrame, air: float) -> None:
    name = f"{kind}-{air:g}".replace("--", "-minus")
    table.to_csv(folder / f"{name}.csv", index=False)
    places = {title: title.removesuffix(" [degC]") for title in table if "degC" in str(title)}
    lines = [f'ambient = "{air:g} degC"', "[thermocouples]"]
    lines += [f'"{title}" = "{place}"' for title, place in places.items()]
    (folder / f"{name}.toml").write_text("\n".join(lines), encoding="utf-8")
