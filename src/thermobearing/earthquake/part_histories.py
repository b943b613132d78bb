"""The histories of one line or pier with its own peaks, for figures."""

import xarray as xr

from thermobearing.border.errors import InputError, nearest
from thermobearing.earthquake.parts import GOVERNING, has_parts


def told_of(dataset: xr.Dataset, part: str, name: str | None) -> xr.Dataset:
    """Return the dataset whose peaks, and histories where it has them, are those of one part.

    Parameters
    ----------
    dataset : of a study.
    part : "pier" or "line".
    name : of the part; None for the one whose histories the dataset holds.

    Returns
    -------
    xarray.Dataset

    Raises
    ------
    InputError : no part has that name; the nearest is named.
    """
    name = dataset.attrs.get(part) if name is None else name
    if name is None or (name == dataset.attrs.get(part) and not has_parts(dataset)):
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
            "pier_rotation": own["pier_part_rotation"],
            "pier_moment": own["pier_part_moment"],
        }
        changed |= {key: own[of] for key, of in GOVERNING.items() if key.startswith("pier_")}
    else:
        way = own["line_displacement_max"]
        per_mm = own["line_strain_max"] / way.where(way > 0.0)
        changed = {
            "bearing_strain": own["line_displacement"] * per_mm,
            "bearing_strain_max": own["line_strain_max"],
        }
    kept = {key: value.variable for key, value in changed.items()}
    return dataset.assign(kept).assign_attrs({part: name})
