"""The dataset of a study told of another line or pier than the one of its tables, for figures."""

import xarray as xr

from thermobearing.border.errors import InputError, nearest
from thermobearing.earthquake.parts import has_parts


def told_of(dataset: xr.Dataset, part: str, name: str | None) -> xr.Dataset:
    """The dataset whose displacement of the pier, or strain, is that of a part.

    Parameters
    ----------
    dataset : of a study.
    part : "pier" or "line".
    name : of the part; None for the one that the tables are about.

    Returns
    -------
    xarray.Dataset

    Raises
    ------
    InputError : no part has that name; the nearest is named.
    """
    if name is None or name == dataset.attrs.get(part):
        return dataset
    dimension = "line" if part == "line" else "pier_part"
    names = [str(one) for one in dataset[dimension].values] if has_parts(dataset) else []
    known = names or [str(dataset.attrs.get(part, ""))]
    if name not in names:
        raise InputError(f'{part} = "{name}": no {part} has that name{nearest(str(name), known)}')
    own = dataset.sel({dimension: name}, drop=True)
    if part == "pier":
        changed = {
            "pier_displacement": own["pier_part_displacement"],
            "pier_displacement_max": own["pier_part_displacement_max"],
        }
    else:
        way = own["line_displacement_max"]
        per_mm = own["line_strain_max"] / way.where(way > 0.0)
        changed = {
            "bearing_strain": own["line_displacement"] * per_mm,
            "bearing_strain_max": own["line_strain_max"],
        }
    kept = {key: value.variable for key, value in changed.items()}
    return dataset.assign(kept).assign_attrs({part: name})
