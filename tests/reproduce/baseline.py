"""The ledger as it was last made: what a verdict and a flip were, to see when one changes.

`python -m tests.reproduce.baseline DIR` writes it anew from a directory of `thermobearing
reproduce`; why a verdict changed belongs into the commit.
"""

import json
import sys
from pathlib import Path
from typing import Any

BASELINE = Path(__file__).with_name("ledger.json")
KEPT = ("verdict", "words", "computed", "flips", "stands_5_per_cent_more_K_r")


def load_baseline() -> dict[str, dict[str, Any]]:
    """Rows by the id of their claim."""
    found: dict[str, dict[str, Any]] = json.loads(BASELINE.read_text(encoding="utf-8"))
    return found


def main() -> None:
    """Write it."""
    records = json.loads((Path(sys.argv[1]) / "ledger.json").read_text(encoding="utf-8"))
    rows = {record["id"]: {key: record[key] for key in KEPT} for record in records}
    BASELINE.write_text(json.dumps(rows, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
