"""Samples of a posterior as bearings, from the files of a calibration."""

import csv
import io
from pathlib import Path

import numpy as np

from thermobearing.bearing.library import as_bearing, load_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.scaling import extract_compound, lead_cores, split_parts
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError, nearest
from thermobearing.border.opener import is_file
from thermobearing.border.schema import validated
from thermobearing.identify.fit import parameters as kinds
from thermobearing.identify.uncertainty.groups import chosen_groups
from thermobearing.results.directory import IDENTIFIED, SAMPLES
from thermobearing.tables.text import read_text

MOST = 10_000  # of samples
HEAT = "materials."  # thermal numbers, which have no size
FAR = 10.0  # standard deviations from the mean of the samples, ...
APART = 0.2  # ... and this part of it: not the bearing that they are of
ALIKE = 1e-6  # relative difference of two compounds that are one, their files read and written


@checked
def posterior_bearings(
    bearing: Bearing | str | Path, path: str | Path, count: int = 20, *, heat: bool = True
) -> list[Bearing]:
    r"""Return the calibrated bearing, followed by bearings of samples of its posterior.

    A bearing of another size, made of the calibrated compound, is possible if `bearing.toml` of the
    calibration is in the directory of the samples: each sample is then scaled to that size.

    Parameters
    ----------
    bearing : the calibrated one, or one made of its compound: a name, a file or a Bearing.
    path : posterior.csv of `identify`: a column for each parameter, a row for each sample.
    count : number of samples, 1 to 10 000, evenly through the file; all if it has fewer.
    heat : draw the thermal numbers and the thickness of the rubber too. Studies leave them out,
        since runs in lockstep have the same cells.

    Returns
    -------
    list of Bearing : the bearing itself first, then the samples, each with a unique name; for
        `tb.sweep`, `tb.bridge` and `temperature_factors`.

    Raises
    ------
    InputError : no such file, columns that are no parameters of the bearing, cells that are no
        numbers or that a bearing may not have; samples of another bearing.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "posterior.csv")
    ...     _ = file.write_text("K_r,m_T\n30,-1.1\n31,-1.2\n")
    ...     bearings = posterior_bearings("shen-hdr-specimen", file)
    >>> [(item.name, item.hysteresis.layer_stiffness) for item in bearings[1:]]
    [('shen-hdr-specimen, sample 1', 30.0), ('shen-hdr-specimen, sample 2', 31.0)]
    """
    first, file = as_bearing(bearing), str(path)
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MOST:
        raise InputError(f"samples = {count!r}: must be an integer from 1 to {MOST}")
    lines = "\n".join(read_text(Path(path)).splitlines())
    try:
        rows = [row for row in csv.reader(io.StringIO(lines)) if any(row)]
    except csv.Error as error:  # a field of more than 131072 characters
        raise InputError(f"is no table of values between commas: {error}", file) from None
    if len(rows) < 2:
        raise InputError(
            "contains no samples: a line of symbols and a row for each sample are needed", file
        )
    fitted = _fitted(first, Path(path).parent / IDENTIFIED)
    keys = _keys(rows[0], fitted, file)
    numbers = np.unique(
        np.linspace(1, len(rows) - 1, min(count, len(rows) - 1)).round().astype(int)
    )
    samples = [_sample(fitted, keys, rows[k], k, file) for k in numbers.tolist()]
    if fitted is first:
        _refuse_others(first, keys, samples, file)
        cells = {} if heat else {"geometry": first.geometry, "materials": first.materials}
        return [first, *(sample.model_copy(update=cells) for sample in samples)]
    thermal_keys = [key for key in keys if heat and key.startswith(HEAT)]
    sized = []
    for sample, number in zip(samples, numbers, strict=True):
        parts = split_parts(extract_compound(sample), first.geometry, lead_cores(first))
        parts |= {"scragging": sample.scragging, "name": f"{first.name}, sample {number}"}
        scaled = first.model_copy(update=parts)
        sized.append(_with_ratios(scaled, sample, fitted, thermal_keys))
    return [first, *sized]


def _with_ratios(bearing: Bearing, sample: Bearing, fitted: Bearing, keys: list[str]) -> Bearing:
    """Return a bearing whose thermal numbers differ as those of a sample from the calibration's."""
    values = {}
    for key in keys:
        numbers = [kinds.dotted_value(item, key) for item in (bearing, sample, fitted)]
        nominal, drawn, middle = (0.0 if value is None else value for value in numbers)
        if middle:
            values[key] = nominal * drawn / middle
    return kinds.with_values(bearing, values)


def _fitted(bearing: Bearing, place: Path) -> Bearing:
    """Return the bearing of the samples: the one in their directory if it has another size."""
    if not is_file(place):
        return bearing
    try:
        fitted = load_bearing(place)
    except InputError:  # a poor fit does not load: the given bearing's numbers must do
        return bearing
    if fitted.geometry == bearing.geometry and lead_cores(fitted) == lead_cores(bearing):
        return bearing
    rubber = extract_compound(bearing).rubber
    for key, value in extract_compound(fitted).rubber:
        present = getattr(rubber, key)
        number = isinstance(present, float) and isinstance(value, float)
        # Numbers went through a file and back, so that they differ by rounding; texts may not.
        if abs(present - value) > ALIKE * abs(value) if number else present != value:
            present_text, wanted_text = (f"{v:.6g}" if number else str(v) for v in (present, value))
            message = (
                f"{bearing.name} differs in size from {fitted.name}, to which the samples belong, "
                f"and is not made of its compound: {key} is {present_text}, not {wanted_text}; "
                f"create it with thermobearing new --compound {place}"
            )
            raise InputError(message, str(place.with_name(SAMPLES)))
    return fitted


def _refuse_others(bearing: Bearing, keys: list[str], samples: list[Bearing], where: str) -> None:
    """Refuse samples of a bearing of another size, by the numbers that depend on the size."""
    for kind in kinds.available(bearing):
        # Numbers without bounds relative to the size are alike for all sizes and show nothing.
        if kind.key not in keys or not kind.relative:
            continue
        values = np.array([kinds.dotted_value(sample, kind.key) for sample in samples])
        actual, mean = kinds.dotted_value(bearing, kind.key) or 0.0, float(values.mean())
        if abs(actual - mean) > max(FAR * float(values.std()), APART * abs(mean)):
            message = (
                f"{kind.symbol} is {mean:.4g} {kind.unit} in the samples and {actual:.4g} in "
                f"{bearing.name}: they belong to another bearing. A bearing of the same compound "
                f"can use them if {IDENTIFIED} of the calibration is in their directory"
            )
            raise InputError(message, where)


def _keys(head: list[str], bearing: Bearing, where: str) -> list[str]:
    assumed = [key for group in chosen_groups(None) if not group.of_tests for key in group.keys]
    keys_by_name = kinds.keys_by_name(bearing) | {key: key for key in assumed}
    faults, keys = [], []
    data = bearing.model_dump()
    for symbol in (text.strip() for text in head):
        if symbol not in keys_by_name:
            faults.append(f'no parameter is called "{symbol}"{nearest(symbol, keys_by_name)}')
            continue
        key = keys_by_name[symbol]
        if not isinstance(data.get(key.split(".")[0]), dict):
            faults.append(f'"{symbol}": {bearing.name} ({bearing.kind}) has none')
        keys.append(key)
    if len(set(keys)) < len(keys):
        faults.append("a parameter has two columns")
    if faults:
        raise InputError(faults, where)
    return keys


def _sample(bearing: Bearing, keys: list[str], cells: list[str], number: int, path: str) -> Bearing:
    location = f"{path}, row {number}"
    if len(cells) != len(keys):
        raise InputError(f"{len(cells)} numbers instead of {len(keys)}", location)
    data = bearing.model_dump()
    for key, cell in zip(keys, cells, strict=True):
        *tables, name = key.split(".")
        inner = data
        for table in tables:
            inner = inner[table]
        try:
            inner[name] = float(cell)
        except ValueError:
            raise InputError(f'"{cell}" is not a number', location) from None
    data["name"] = f"{bearing.name}, sample {number}"
    return validated(Bearing, data, location, from_file=False)
