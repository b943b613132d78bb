"""A reproduction on the terminal: counts, and what does not hold."""

from thermobearing.reproduce.claims import group_of
from thermobearing.reproduce.judge import CONTRADICTED, FAILED, VERDICTS
from thermobearing.reproduce.result import Reproduction
from thermobearing.results.screen import print_table, print_warnings, say

LONGEST = 70  # letters of a statement


def print_reproduction(found: Reproduction) -> None:
    """Print counts by verdict, the statements that are contradicted, and what broke.

    Parameters
    ----------
    found : from `reproduce_source`.
    """
    groups = found.groups
    kinds = [(name, [str(counts[name]) for counts in groups.values()]) for name in VERDICTS]
    sums = [str(sum(counts.values())) for counts in groups.values()]
    rows = [(name, *numbers) for name, numbers in [*kinds, ("all", sums)] if set(numbers) != {"0"}]
    print_table(("verdict", *groups), rows)
    against = [
        (row.claim.place, _short(row.claim.statement), row.verdict.words)
        for row in found.rows
        if row.verdict.kind == CONTRADICTED and group_of(row.claim.id) != "misprints"
    ]
    if against:
        print_table(("place", "statement", "verdict"), against, title="contradicted", keys=2)
    firm = [row for row in found.rows if row.verdict.settled and row.smallest]
    if firm:
        least = min(firm, key=lambda row: abs(row.smallest.change or 0.0) if row.smallest else 1.0)
        if least.smallest:
            say(f"\nmost easily flipped: {least.claim.id} ({least.smallest.words})")
    pictures = sum(item.image is not None for item in found.figures)
    if found.figures or found.tables:
        say(f"figures: {pictures}, tables: {len(found.tables)}")
    print_warnings(f"{name}: {why}" for name, why in found.broken.items())
    failed = sum(row.verdict.kind == FAILED for row in found.rows)
    if failed:
        say(f"{failed} rows failed")


def _short(text: str) -> str:
    return text if len(text) <= LONGEST else text[: LONGEST - 1].rstrip() + "…"
