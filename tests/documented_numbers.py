"""Whether a run measured what the README and the docs say (docs/measured.json)."""

import json
import re
from pathlib import Path

DOCUMENTED = Path(__file__).parents[1] / "docs" / "measured.json"
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
ROUNDING = 1e-6  # below it a number is a rounding error, which another machine has otherwise
AGREES = 0.05  # relative: errors of meshes and fits with other versions of the libraries


def disagreements(measured: list[dict[str, str]], reported: list[dict[str, str]]) -> list[str]:
    """Rows of a run whose numbers are not those of the row of the same name in the docs."""
    known = {row["what"]: row["value"] for row in reported}
    return [
        f"{row['what']}: the docs say {known[row['what']]}, this run {row['value']}"
        for row in measured
        if row["what"] in known and not alike(row["value"], known[row["what"]])
    ]


def alike(now: str, before: str) -> bool:
    """Same words, and numbers that agree but for one unit of their last digit."""
    if NUMBER.sub("#", now) != NUMBER.sub("#", before):
        return False
    pairs = zip(NUMBER.findall(now), NUMBER.findall(before), strict=True)
    return all(_close(a, b) for a, b in pairs)


def _close(now: str, before: str) -> bool:
    a, b = float(now), float(before)
    if max(abs(a), abs(b)) < ROUNDING:
        return True
    mantissa, _, power = before.partition("e")
    unit = 10.0 ** (int(power or 0) - len(mantissa.partition(".")[2]))
    return abs(a - b) <= AGREES * abs(b) + 1.01 * unit


def documented_rows() -> list[dict[str, str]]:
    """What the docs say."""
    return list(json.loads(DOCUMENTED.read_text()))
