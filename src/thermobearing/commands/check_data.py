"""The package's own data files for `thermobearing check`, as the package itself reads them."""

from pathlib import Path

from thermobearing.bearing.plausible import Usuals
from thermobearing.border.schema import Strict, validated
from thermobearing.border.toml import read_toml, split_sources
from thermobearing.climate.generator import Climate
from thermobearing.design.peaks import Rules
from thermobearing.design.published import Published
from thermobearing.design.rubber import Curves
from thermobearing.identify.assumed import Groups
from thermobearing.identify.chamber import ChamberNumbers
from thermobearing.model.limits import TemperatureLimits

# Kind: keys that tell it, and the record that it is; None where it is read key by key.
DATA: dict[str, tuple[set[str], type[Strict] | None]] = {
    "rubber curves": ({"compounds", "smallest_strain"}, Curves),
    "published factors": ({"tables"}, Published),
    "assumed uncertainties": ({"groups"}, Groups),
    "ambient temperature of tests": ({"ambient_drift"}, ChamberNumbers),
    "usual values": ({"usual"}, Usuals),
    "climate": ({"monthly_mean", "daily_range"}, Climate),
    "temperature limits": ({"absolute_zero"}, TemperatureLimits),
    "standard spectra": ({"I", "II"}, None),
    "design of the source": ({"more"}, None),
    "phases of motions": ({"jra-ii-ii-1"}, None),
    "rules of peaks": ({"rules"}, Rules),
    "stiffness ratios": ({"HDR", "LHDR", "LRB"}, None),
    "words of tables": ({"names"}, None),
    "claims of the source": ({"claim"}, None),
    "parameters of claims": ({"parameter"}, None),
    "printed numbers": ({"u_B", "K_B"}, None),
    "printed tables": ({"table"}, None),
    "choices and statements": ({"choice"}, None),
    "code of others": ({"plotly"}, None),
    "usual units": ({"factors"}, None),
    "limits of piers": ({"ductility", "drift"}, None),
    "surroundings in the weather": ({"upper_face", "lower_face"}, None),
    "figures of Shen (2023)": ({"figures"}, None),
}


def data_facts(kind: str, path: Path) -> dict[str, str]:
    """What a data file holds.

    Raises
    ------
    InputError : everything that is wrong with it.
    """
    table, _ = split_sources(read_toml(path))
    record = DATA[kind][1]
    if record is not None:
        validated(record, table, str(path))
    return {"entries": ", ".join(str(key) for key in table if key != "citation")}
