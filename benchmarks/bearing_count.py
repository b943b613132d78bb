"""How many bearings does the specimen of the hybrid test stand for?

`python -m benchmarks.bearing_count` prints the evidence of chapter 3 for 2, 4, 6 and 8 as a
Markdown table: the numbers of docs/verification.md, "Two bearings or eight". `--motion FILE` takes
another motion, `--factor` scales it.
"""

import argparse
from typing import Any

from tests.validation.hybrid_source import HARD, SOFT, evidence, score

COUNTS = (2, 4, 6, 8)
OTHERS = (1, 12)  # the specimen alone; a force scale of 1/s^3 on two
MARKS = {True: " (yes)", False: " (**no**)"}


def table(motion: Any = None) -> str:
    """Ours for each number of bearings, and the source's."""
    results = {count: evidence(count, motion) for count in (*COUNTS, *OTHERS)}
    heads = ["", *(f"{count} bearings" for count in COUNTS), "source"]
    lines = ["| " + " | ".join(heads) + " |", "|---" * len(heads) + "|"]
    for criterion in (*HARD, *SOFT):
        name = f"**{criterion.what}**" if criterion.hard else criterion.what
        cells = [
            criterion.numbers(results[count]) + MARKS[criterion.holds(results[count])]
            for count in COUNTS
        ]
        lines.append("| " + " | ".join([name, *cells, criterion.source]) + " |")
    for label, criteria in (("printed numbers and limits (bold)", HARD), ("trends", SOFT)):
        cells = [f"{score(criteria, results[count])} of {len(criteria)}" for count in COUNTS]
        lines.append("| " + " | ".join([f"agree: {label}", *cells, ""]) + " |")
    other_counts = "; ".join(
        f"{count} bearing{'s' * (count > 1)}: {score(HARD, results[count])} of {len(HARD)}, "
        f"{score(SOFT, results[count])} of {len(SOFT)}"
        for count in OTHERS
    )
    return "\n".join([*lines, "", f"The same of {other_counts}."])


def main() -> None:
    """Print it."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.bearing_count", description=__doc__)
    parser.add_argument("--motion", help="name or file, instead of the default")
    parser.add_argument("--factor", type=float, default=1.0)
    arguments = parser.parse_args()
    motion = {"name": arguments.motion, "factor": arguments.factor} if arguments.motion else None
    print(table(motion))


if __name__ == "__main__":
    main()
