"""How every analysis writes its tables: JSON without NaN, CSV with seven digits."""

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd

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


def write_json(path: Path, value: Any) -> None:
    """Write a value as indented JSON; numbers that do not exist become null."""
    text = json.dumps(without_nan(value), indent=2, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8")


def write_csv(path: Path, table: "pd.DataFrame") -> None:
    """Write a table without its index, with seven digits."""
    table.to_csv(path, index=False, float_format=DIGITS)
