"""Golden files: what a case writes as comparable text, and where two such texts differ."""

import json
import re
import tomllib
from itertools import zip_longest
from pathlib import Path

import netCDF4
import numpy as np

import thermobearing as tb
from tests import tolerances as tol
from thermobearing.quantities.register import MINUS

GOLDEN = Path(__file__).with_name("golden")
LONG = 40  # rows of a table; of a longer one every n-th is kept
KEPT = 12
# Numbers below it are rounding: of the largest value of a variable, and in kN, mm, s, K and MPa.
NO_DIGITS, DECIMALS = 1e-12, 12
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?(?![\w.])")
ROUNDED = re.compile(r"< \d+e-\d+(?![\w.])")  # a residual that is rounding only, on the screen
FRAMES = re.compile(r"[^\S\n]+|[\u2500-\u259f]+")  # spaces and lines around tables on the screen
CHANGING = (
    (re.compile(r'("seconds": )[\d.e+-]+'), r'\1"<seconds>"'),
    (re.compile(r"(?<=\()\d+(\.\d+)? MB(?=\)$)", re.M), "<size>"),
    (re.compile(r"(?<=[a-z], )\d+\.\d s$", re.M), "<seconds>"),
    (re.compile(r"(?<=, about )\d[\d.e+]* (s|min|h|d)$", re.M), "<time>"),
    (re.compile(rf"(?<![\d.]){re.escape(tb.__version__)}(?![\d.])"), "<version>"),
)
TEXTS = {".json", ".csv", ".toml", ".tcl"}


def collect_texts(screen: str, directory: Path | None) -> dict[str, str]:
    result = {"screen.txt": _squeezed(screen)} if screen else {}
    paths = sorted(directory.rglob("*")) if directory else []
    for path in paths:
        name = str(path.relative_to(directory or Path()))
        if path.suffix == ".nc":
            result[f"{name}.txt"] = _digest(path)
        elif path.suffix == ".py":  # no code of ours
            result[f"{name}.txt"] = path.read_text()
        elif path.suffix in TEXTS:
            result[name] = _plain(path).replace(str((directory or path).parent), "<here>")
    for pattern, instead in CHANGING:
        result = {name: pattern.sub(instead, text) for name, text in result.items()}
    return result


def _squeezed(screen: str) -> str:
    lines = (FRAMES.sub(" ", line).strip() for line in screen.splitlines())
    return "\n".join(line for line in lines if line) + "\n"


def _plain(path: Path) -> str:
    """Text of a file: long tables thinned, nested data as JSON without margins.

    TOML is sorted: where its writer puts a table depends on the length of the paths in it.
    """
    text, toml = path.read_text(), path.suffix == ".toml"
    if toml or path.suffix == ".json":
        data = tomllib.loads(text) if toml else json.loads(text, parse_float=_without_rounding)
        return json.dumps(data, indent=0, ensure_ascii=False, sort_keys=toml) + "\n"
    if path.suffix != ".csv":
        return text
    return _thinned(NUMBER.sub(_without_digits, text))


def _without_digits(number: re.Match[str]) -> str:
    """Return the text of a number, "0" for one that is rounding only."""
    return "0" if 0.0 < abs(float(number[0])) < NO_DIGITS else number[0]


def _without_rounding(number: str) -> float:
    """Return a number; one within the floor of the comparison without the digits of rounding."""
    value = float(number)
    return round(value, DECIMALS) + 0.0 if abs(value) < tol.GOLDEN_FLOOR else value


def _thinned(table: str) -> str:
    head, *rows = table.splitlines()
    if len(rows) <= LONG:
        return table
    every = -(-len(rows) // KEPT)
    kept = [*rows[::every], rows[-1]]
    return "\n".join([f"# every {every}th of {len(rows)} rows", head, *kept]) + "\n"


def _digest(path: Path) -> str:
    """One line for each variable of a netCDF file: shape, unit, first, last, extremes, mean."""
    with netCDF4.Dataset(path) as data:
        data.set_auto_maskandscale(False)
        lines = [
            f"{name} {variable.shape} [{getattr(variable, 'units', '')}]: {_numbers(variable[...])}"
            for name, variable in sorted(data.variables.items())
        ]
        lines.append(f"attributes: {', '.join(sorted(data.ncattrs()))}")
    return "\n".join(lines) + "\n"


def _numbers(values: np.ndarray) -> str:
    values = values.ravel()
    if values.dtype.kind not in "fi":
        return " ".join(dict.fromkeys(map(str, values)))
    known = values[np.isfinite(values)]
    if not len(known):
        return "no numbers"
    digits = 6 if values.dtype == np.float32 else 12
    measures = (known[0], known[-1], known.min(), known.max(), known.mean(dtype=np.float64))
    least = max(NO_DIGITS * float(np.abs(known).max()), tol.GOLDEN_FLOOR)  # rounding, or ignored
    return " ".join("0" if abs(value) < least else f"{value:.{digits}g}" for value in measures)


def stored(case: str) -> dict[str, str]:
    folder = GOLDEN / case
    paths = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_text() for path in paths}


def differences(old: dict[str, str], new: dict[str, str], relative: float) -> list[str]:
    """Lines of two sets of files that differ; text exactly, numbers beyond the tolerances."""
    result = [f"{name}: is gone" for name in old if name not in new]
    result += [f"{name}: is new" for name in new if name not in old]
    for name in old:
        lines = zip_longest(old[name].splitlines(), new.get(name, old[name]).splitlines())
        result += [
            f"{name}:{at}: {before!r} -> {after!r}"
            for at, (before, after) in enumerate(lines, 1)
            if before is None or after is None or not _alike(before, after, relative)
        ]
    return result


def _alike(old: str, new: str, relative: float) -> bool:
    """Whether two lines have the same words, and numbers within the tolerances."""
    if old == new:
        return True
    # Readers see true minus signs, and a bound instead of the digits of rounding.
    old, new = (ROUNDED.sub("0.0", line.replace(MINUS, "-")) for line in (old, new))
    if NUMBER.sub("#", old) != NUMBER.sub("#", new):
        return False
    pairs = zip(NUMBER.findall(old), NUMBER.findall(new), strict=True)
    return all(_close(a, b, relative) for a, b in pairs)


def _close(old: str, new: str, relative: float) -> bool:
    """Counts exactly; other numbers within the tolerances and one unit of the last digit.

    The unit is that of the number with more digits, so that digits cannot get lost.
    """
    if old.lstrip("+-").isdigit() and new.lstrip("+-").isdigit():
        return int(old) == int(new)
    a, b = float(old), float(new)
    unit = min(_last_digit(old), _last_digit(new))
    return abs(a - b) <= relative * max(abs(a), abs(b)) + tol.GOLDEN_FLOOR + 1.01 * unit


def _last_digit(number: str) -> float:
    mantissa, _, power = number.lower().partition("e")
    return float(10.0 ** (int(power or 0) - len(mantissa.partition(".")[2])))
