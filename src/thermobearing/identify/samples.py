"""Samples of a posterior, as a fit writes them, as bearings: what bands are made of."""

import csv
import io
from pathlib import Path

import numpy as np

from thermobearing.bearing.library import as_bearing
from thermobearing.bearing.model import Bearing
from thermobearing.border.encodings import read_text
from thermobearing.border.errors import InputError, nearest
from thermobearing.border.schema import validated
from thermobearing.identify.kinds import KINDS

MOST = 10_000  # samples that can be asked for


def posterior_bearings(
    bearing: Bearing | str | Path, path: str | Path, count: int = 20
) -> list[Bearing]:
    r"""The fitted bearing, then bearings of some samples of its posterior.

    Parameters
    ----------
    bearing : the fitted one (bearing.toml beside the samples), a name or a Bearing.
    path : posterior.csv of `identify`: a column for each parameter, a row for each sample.
    count : of samples, evenly through the file, 1 to 10 000; all if the file has fewer.

    Returns
    -------
    list of Bearing : the bearing itself first, then the samples, each with a name of its own; for
        `tb.sweep`, `tb.bridge` and `temperature_factors`.

    Raises
    ------
    InputError : no such file, columns that are no parameters of the bearing, cells that are no
        numbers or that a bearing may not have.

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
    keys = _keys(rows[0], first, where)
    chosen = np.unique(np.linspace(1, len(rows) - 1, min(count, len(rows) - 1)).round().astype(int))
    return [first, *(_sample(first, keys, rows[k], k, where) for k in chosen.tolist())]


def _keys(head: list[str], bearing: Bearing, where: str) -> list[str]:
    """Dotted keys of the columns."""
    known = {kind.symbol: kind.key for kind in KINDS}
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
    """The bearing with the numbers of one row."""
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
