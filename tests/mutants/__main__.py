"""`python -m tests.mutants`: which of the small errors do the tests notice?

Status 0: at least 90 % of the kept list are caught, all of it applies, its tests are green.
Changes by chance (--random) are for finding holes: some of them change nothing, so they set no
status.
"""

import argparse
import os
import re
import sys
from collections import Counter

from tests.mutants.kept import Mutant, kept_mutants
from tests.mutants.random_ones import random_mutants
from tests.mutants.sampler import (
    CAUGHT,
    SURVIVED,
    TOO_LONG,
    Copy,
    Verdict,
    failing_anyway,
    verdicts,
)

ENOUGH = 0.9  # of the kept list


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description=__doc__)
    parser.add_argument("--random", type=int, default=0, help="so many by chance instead")
    parser.add_argument("--seed", type=int, default=1, help="of the chance")
    parser.add_argument("--only", default="", help="those whose file or meaning it matches")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="copies at work")
    parser.add_argument("--list", action="store_true", help="say what they are, run nothing")
    parser.add_argument("--trust", action="store_true", help="skip the tests of unchanged code")
    return parser.parse_args()


def _line(verdict: Verdict) -> str:
    m = verdict.mutant
    by = f"  [{verdict.by}]" if verdict.by else ""
    return f"{verdict.verdict:8} {verdict.seconds:6.1f} s  {m.file}: {m.means}{by}"


def _report(result: list[Verdict], faults: list[str], used: float) -> None:
    """Survivors, counts of each room, processor time."""
    for name in (SURVIVED, TOO_LONG):
        items = [item for item in result if item.verdict == name]
        print(f"\n{name}:" if items else f"\n{name}: none")
        for item in sorted(items, key=lambda item: item.mutant.file):
            print(f"  {item.mutant.file}: {item.mutant.means}")
    for fault in faults:
        print(f"  {fault}")
    whole = Counter(item.mutant.room for item in result)
    caught = Counter(item.mutant.room for item in result if item.verdict == CAUGHT)
    print("\nroom          caught  of")
    for room in sorted(whole):
        print(f"{room:12} {caught[room]:7} {whole[room]:3}")
    total = caught.total()
    print(f"{'all':12} {total:7} {len(result):3}  {100.0 * total / max(len(result), 1):.1f} %")
    print(f"{used:.0f} s of processor time")


def main() -> int:
    """The exit status."""
    asked = _arguments()
    mutants: list[Mutant]
    faults: list[str]
    mutants, faults = (
        (random_mutants(asked.random, asked.seed), []) if asked.random else kept_mutants()
    )
    mutants = [m for m in mutants if re.search(asked.only, f"{m.file}: {m.means}")]
    if asked.list:
        for m in mutants:
            print(f"{m.file}: {m.means}")
        print(f"{len(mutants)} mutants")
        return 0
    copies = [Copy(number) for number in range(max(1, min(asked.jobs, len(mutants))))]
    broken = [] if asked.trust else failing_anyway(copies, mutants)
    faults += [f"fails without any mutant, and is left out: {test}" for test in broken]
    result = []
    for item in verdicts(copies, mutants):
        result.append(item)
        print(_line(item), flush=True)
    _report(result, faults, sum(copy.used for copy in copies))
    share = sum(item.verdict == CAUGHT for item in result) / max(len(result), 1)
    return 0 if asked.random or (share >= ENOUGH and not faults) else 1


if __name__ == "__main__":
    sys.exit(main())
