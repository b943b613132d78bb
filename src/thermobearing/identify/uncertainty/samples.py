"""Bearings of the samples of a posterior that a calibration wrote."""

import csv
import io
from pathlib import Path

import numpy as np

from thermobearing.bearing.library import as_bearing, load_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.bearing.scaling import compound_of, lead_cores, split_parts
from thermobearing.border.errors import InputError, is_file, nearest
from thermobearing.border.schema import validated
from thermobearing.identify.fit import parameters as kinds
from thermobearing.results.directory import IDENTIFIED, SAMPLES
from thermobearing.tables.text import read_text

MOST = 10_000  # of samples
SIZED = (kinds.K_R, kinds.D_Y, kinds.K_L, kinds.K_V, kinds.C_V)  # they go with the size
FAR = 10.0  # standard deviations from the mean of the samples, ...
APART = 0.2  # ... and this part of it: not the bearing that they are of
ALIKE = 1e-6  # relative difference of two compounds that are one, their files read and written


def posterior_bearings(
    bearing: Bearing | str | Path, path: str | Path, count: int = 20
) -> list[Bearing]:
    r"""The fitted bearing, then bearings of some samples of its posterior.

    Or a bearing of another size that is made of the fitted compound, with `bearing.toml` of the
    fit in the directory of the samples: each of them is then scaled to that size.

    Parameters
    ----------
    bearing : the fitted one, or one made of its compound: a name, a file or a Bearing.
    path : posterior.csv of `identify`: a column for each parameter, a row for each sample.
    count : of samples, evenly through the file, 1 to 10 000; all if the file has fewer.

    Returns
    -------
    list of Bearing : the bearing itself first, then the samples, each with a name of its own; for
        `tb.sweep`, `tb.bridge` and `temperature_factors`.

    Raises
    ------
    InputError : no such file, columns that are no parameters of the bearing, cells that are no
        numbers or that a bearing may not have; a bearing that the samples are not of.

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
    first, where = as_bearing(bearing), str(path)
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MOST:
        raise InputError(f"samples = {count!r}: must be a whole number from 1 to {MOST}")
    rows = [row for row in csv.reader(io.StringIO(read_text(Path(path)))) if any(row)]
    if len(rows) < 2:
        raise InputError("holds no samples: a line of symbols, then a row for each", where)
    fitted = _fitted(first, Path(path).parent / IDENTIFIED)
    keys = _keys(rows[0], fitted, where)
    chosen = np.unique(np.linspace(1, len(rows) - 1, min(count, len(rows) - 1)).round().astype(int))
    some = [_sample(fitted, keys, rows[k], k, where) for k in chosen.tolist()]
    if fitted is first:
        _refuse_others(first, keys, some, where)
        return [first, *some]
    sized = []
    for sample, number in zip(some, chosen, strict=True):
        parts = split_parts(compound_of(sample), first.geometry, lead_cores(first))
        parts |= {"scragging": sample.scragging, "name": f"{first.name}, sample {number}"}
        sized.append(first.model_copy(update=parts))
    return [first, *sized]


def _fitted(bearing: Bearing, place: Path) -> Bearing:
    """Return the bearing of the samples: that in their directory if its size is another one."""
    if not is_file(place):
        return bearing
    try:
        fitted = load_bearing(place)
    except InputError:  # a poor fit does not load: the given bearing's numbers must do
        return bearing
    if fitted.geometry == bearing.geometry and lead_cores(fitted) == lead_cores(bearing):
        return bearing
    other = compound_of(bearing).rubber
    for key, value in compound_of(fitted).rubber:
        mine = getattr(other, key)
        number = isinstance(mine, float) and isinstance(value, float)
        if abs(mine - value) > ALIKE * abs(value) if number else mine != value:
            shown, wanted = (f"{v:.6g}" if number else str(v) for v in (mine, value))
            raise InputError(
                f"{bearing.name} has another size than {fitted.name}, whose samples these are, "
                f"and is not made of its compound: {key} is {shown}, not {wanted}; make it with "
                f"thermobearing new --compound {place}",
                str(place.with_name(SAMPLES)),
            )
    return fitted


def _refuse_others(bearing: Bearing, keys: list[str], some: list[Bearing], where: str) -> None:
    """Refuse samples of a bearing of another size, by the numbers that depend on the size."""
    for key in set(keys) & set(SIZED):
        values = np.array([kinds.dotted_value(one, key) for one in some])
        own, mean = kinds.dotted_value(bearing, key) or 0.0, float(values.mean())
        if abs(own - mean) > max(FAR * float(values.std()), APART * abs(mean)):
            kind = kinds.BY_KEY[key]
            raise InputError(
                f"{kind.symbol} is {mean:.4g} {kind.unit} in the samples and {own:.4g} in "
                f"{bearing.name}: they are of another bearing; a bearing made of the fitted "
                f"compound takes them where {IDENTIFIED} of the fit lies in their directory",
                where,
            )


def _keys(head: list[str], bearing: Bearing, where: str) -> list[str]:
    known = {kind.symbol: kind.key for kind in kinds.KINDS}
    faults, keys = [], []
    data = bearing.model_dump()
    for symbol in (text.strip() for text in head):
        if symbol not in known:
            faults.append(f'no parameter is called "{symbol}"{nearest(symbol, known)}')
            continue
        key = known[symbol]
        if not isinstance(data.get(key.split(".")[0]), dict):
            faults.append(f'"{symbol}": {bearing.name} ({bearing.kind}) has none')
        keys.append(key)
    if len(set(keys)) < len(keys):
        faults.append("a parameter has two columns")
    if faults:
        raise InputError(faults, where)
    return keys


def _sample(bearing: Bearing, keys: list[str], cells: list[str], number: int, path: str) -> Bearing:
    where = f"{path}, row {number}"
    if len(cells) != len(keys):
        raise InputError(f"{len(cells)} numbers instead of {len(keys)}", where)
    data = bearing.model_dump()
    for key, cell in zip(keys, cells, strict=True):
        table, name = key.split(".")
        try:
            data[table][name] = float(cell)
        except ValueError:
            raise InputError(f'"{cell}" is not a number', where) from None
    data["name"] = f"{bearing.name}, sample {number}"
    return validated(Bearing, data, where, from_file=False)
