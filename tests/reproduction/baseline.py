"""The ledger as it was last made: what a verdict and a flip were, to see when one changes.

`python -m tests.reproduction.baseline DIR [DIR ...]` puts the rows of directories of `python -m
reproduction` (all of it, or `--chapter 4`) into it; why a verdict changed belongs into the commit.
"""

import json
import sys
from pathlib import Path
from typing import Any

from reproduction.claims import load_claims

BASELINE = Path(__file__).with_name("ledger.json")
KEPT = ("verdict", "words", "computed", "printed_model", "flips", "stands_5_per_cent_more_K_r")


def load_baseline() -> dict[str, dict[str, Any]]:
    result: dict[str, dict[str, Any]] = json.loads(BASELINE.read_text(encoding="utf-8"))
    return result


def main() -> None:
    """Write the rows of the directories, and those that were there of claims that are left."""
    rows = load_baseline()
    for folder in sys.argv[1:]:
        records = json.loads((Path(folder) / "ledger.json").read_text(encoding="utf-8"))
        rows |= {record["id"]: {key: record[key] for key in KEPT} for record in records}
    kept = {claim.id: rows[claim.id] for claim in load_claims() if claim.id in rows}
    BASELINE.write_text(json.dumps(kept, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
