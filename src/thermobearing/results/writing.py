"""How every analysis writes: JSON without NaN, CSV with seven digits, attributes of datasets."""

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from thermobearing.results.directory import SUMMARY

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

DIGITS = "%.7g"


def without_nan(value: Any) -> Any:
    """JSON has no NaN: a number that does not exist becomes null."""
    if isinstance(value, dict):
        return {key: without_nan(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [without_nan(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def json_line(value: Any) -> str:
    """A value as one line of JSON, for a machine that reads the last line of a command."""
    return json.dumps(without_nan(value), allow_nan=False)


def write_summary(folder: Path, content: dict[str, Any]) -> None:
    """Write summary.json into a folder."""
    text = json.dumps(without_nan(content), indent=2, allow_nan=False, ensure_ascii=False)
    # A file name that is no text keeps its bytes as lone surrogates; JSON has an escape for them.
    (folder / SUMMARY).write_text(text + "\n", encoding="utf-8", errors="backslashreplace")


def write_csv(path: Path, table: "pd.DataFrame") -> None:
    """Write a table without its index, with seven digits."""
    table.to_csv(path, index=False, float_format=DIGITS)


def as_attribute(value: Any) -> str | int | float:
    """What an attribute of a dataset can hold: text and numbers as they are, the rest as JSON."""
    return value if isinstance(value, str | int | float) else json.dumps(value)


def from_attribute(dataset: "xr.Dataset", name: str) -> Any:
    """What `as_attribute` put into an attribute as JSON: a list or a dictionary."""
    return json.loads(dataset.attrs[name])
