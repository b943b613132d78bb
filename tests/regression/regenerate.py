"""Rewrite the golden files: `python -m tests.regression.regenerate "reason" [CASE ...]`.

Run it only when a change of the numbers is meant. It prints what changed, and keeps the reason
next to the files, in golden/reasons.md. Without a reason it only prints.
"""

import argparse
import sys
import tempfile
from datetime import date
from pathlib import Path

import thermobearing as tb
from tests.regression.cases import CASES, case_results, case_tolerance
from tests.regression.comparison import GOLDEN, differences, stored

REASONS = GOLDEN / "reasons.md"
SHOWN = 8  # differences of a case


def compute(case: str) -> dict[str, str]:
    with tempfile.TemporaryDirectory() as folder:
        return case_results(case, Path(folder).resolve())


def write(case: str, texts: dict[str, str]) -> None:
    for name in stored(case):
        (GOLDEN / case / name).unlink()
    for name, text in texts.items():
        path = GOLDEN / case / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def words(given: list[str]) -> tuple[str, list[str]]:
    about = "Print what changed in the golden files; with a reason, rewrite them."
    parser = argparse.ArgumentParser("python -m tests.regression.regenerate", description=about)
    parser.add_argument("reason", nargs="?", default="", help="why, for reasons.md")
    known = f"all by default; there are {', '.join(CASES)}"
    parser.add_argument("cases", nargs="*", metavar="CASE", help=known)
    result = parser.parse_args(given)
    unknown = sorted(set(result.cases) - set(CASES))
    if unknown:
        parser.error(f"no case is called {unknown[0]}; {known}")
    return result.reason, result.cases


def main() -> None:
    reason, chosen = words(sys.argv[1:])
    changed = []
    for case in chosen or CASES:
        texts = compute(case)
        result = differences(stored(case), texts, case_tolerance(case))
        if not result:
            continue
        changed.append(f"{case} ({len(result)} lines)")
        print(f"{case}: {len(result)} lines differ")
        print("".join(f"  {line}\n" for line in result[:SHOWN]), end="")
        if reason:
            write(case, texts)
    if reason and changed:
        entry = f"- {date.today().isoformat()}, {tb.__version__}: {reason}\n"
        with REASONS.open("a") as file:
            file.write(f"{entry}  Changed: {', '.join(changed)}.\n")
    elif changed:
        sys.exit('nothing written; give a reason: python -m tests.regression.regenerate "..."')


if __name__ == "__main__":
    main()
