"""The ledger in its short form: every verdict as listed, and flips of some rows as listed.

All flips: THERMOBEARING_LEDGER=all; a new list: baseline.py.
"""

import os
from functools import cache
from typing import Any

import pytest

from reproduction.claims import (
    FAILED,
    PARTS,
    SETTLED,
    Claim,
    Variants,
    compute,
    computed_words,
    judge,
    last_that_stands,
    load_claims,
    make_row,
)
from reproduction.runs import Runs
from tests.reproduction.baseline import load_baseline

CLAIMS = {claim.id: claim for claim in load_claims()}
LISTED = load_baseline()
EACH = 1 if os.environ.get("THERMOBEARING_LEDGER") == "all" else 18  # of the rows that flip


# Several seconds each: parts, and claims whose flip is searched for.
LONG = ("chapter-3", "chapter-5", "chapter-6", "conclusions")
LONG += ("6-4-2-strain-reduced", "fig-6-14-strain", "stress-of-lead", "hybrid-energy-in-the-cold")


def smallest(row: dict[str, Any]) -> tuple[str, float] | None:
    known = [(name, change) for name, change in row["flips"].items() if change is not None]
    return min(known, key=lambda item: abs(item[1]), default=None)


FLIPPING = [name for name, row in LISTED.items() if smallest(row)]


def test_the_list_has_every_claim() -> None:
    assert list(LISTED) == list(CLAIMS)


@pytest.mark.parametrize(
    "part",
    [pytest.param(part, marks=pytest.mark.thorough if part in LONG else ()) for part in PARTS],
)
def test_every_verdict_is_as_listed(part: str, runs: Runs) -> None:
    """The verdict, the numbers, and the verdict on the printed model of each claim of a part."""
    for claim in load_claims(part):
        row, listed = make_row(claim, runs), LISTED[claim.id]
        assert row.verdict.kind == listed["verdict"] != FAILED, (claim.id, row.verdict.words)
        assert computed_words(claim, row.computed) == listed["computed"], claim.id
        assert (row.printed.words if row.printed else "") == listed["printed_model"], claim.id
        if row.verdict.settled and part not in PARTS[:2]:
            assert claim.flips or claim.depends, claim.id


def test_of_the_misprints_only_mended_readings_hold() -> None:
    ids = {claim.id for claim in load_claims("misprints")}
    assert {name for name in ids if LISTED[name]["verdict"] in SETTLED} == {
        *("3-4-1-eight-bearings", "eq-4-25-mended", "eq-4-28-mended", "table-6-4-swapped"),
        "eq-6-2-degree",
    }


@cache
def variants() -> Variants:
    return Variants()


def settled(claim: Claim, parameter: str, change: float) -> bool:
    return judge(claim.rule, compute(claim, variants().runs(parameter, change))).settled


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.thorough if name in LONG else ())
        for name in FLIPPING[::EACH]
    ],
)
def test_the_flip_is_as_listed(name: str) -> None:
    flip = smallest(LISTED[name])
    assert flip is not None
    parameter, change = flip
    assert not settled(CLAIMS[name], parameter, change)
    stands = last_that_stands(change)
    assert stands == 0.0 or settled(CLAIMS[name], parameter, stands)


def test_what_stands_more_stiffness_says_why() -> None:
    for name, row in LISTED.items():
        if row["verdict"] in SETTLED:
            assert row["stands_5_per_cent_more_K_r"] in (True, False)
            assert CLAIMS[name].depends or not row["stands_5_per_cent_more_K_r"], name
